#!/usr/bin/env python3
"""The explicit microscopic solver next to LAMMPS: same packing, contacts and step, in one run.

    compare.py [--programs DIR] [--rounds N] [--parts N ...]
    compare.py --growth [--programs DIR] [--rounds N]

Disks lie hexagonally, 12 layers deep, before a plate that stands at 60 degrees to the belt, and are
pressed into a jam; more parts make the plate longer. The frame is turned so that the plate lies across
x, which leaves no empty cells to either program. The programs take turns, each figure is its best.
What both hold at the end is measured by one piece of code here and must agree, or the status is 1.

With --growth the solver alone, from 1,000 to 1,000,000 parts: the time of a part's step, and memory.

Needs LAMMPS as `lmp`, with `mpirun` for two cores:
    apt-get install -y --no-install-recommends lammps
"""

import argparse
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FOLDER = pathlib.Path(__file__).resolve().parent
RADIUS, MASS, SPEED = 0.012, 0.02841, 0.395
LAYERS = 12
CLEARANCE = 0.1  # upstream of the block, m
VELOCITY = (SPEED * math.sin(math.radians(60)), SPEED * math.cos(math.radians(60)))
STEP, WARMUP, REPETITIONS = 1e-5, 2000, 3
GROWTH, GROWTH_WARMUP = (1000, 10_000, 100_000, 1_000_000), 100  # the packing is in touch from the start
THREADS = 2

# The contacts as the solver has them: (4b) of steel on steel and of steel on the plate.
K, D, MU = 715.86, 119.0, 0.15
WALL_K, WALL_D, WALL_MU = 368.46, 120.0, 0.19
# The steepness of its frictions near v = 0, N s/m: mu lambda f with the few newton of this jam.
RUB, WALL_RUB = 3.0, 4.0
# Parts slide along the plate at v_T (cos - mu sin); there the belt pulls with m g tanh(10 s).
SLIP = math.hypot(VELOCITY[0], WALL_MU * VELOCITY[0])
BELT = MASS * 9.81 * math.tanh(10 * SLIP) / SLIP

LOOP = re.compile(r"Loop time of (\S+) on (\d+) procs for (\d+) steps with (\d+) atoms")


def make_packing(n):
    """Length up to the plate, width, and the centres of n disks in touch."""
    rows, pitch = n // LAYERS, 2 * RADIUS
    height = pitch * math.sqrt(3) / 2
    length = CLEARANCE + math.ceil(n / rows) * height + 2 * RADIUS
    places = []
    for number in range(n):
        layer, row = divmod(number, rows)
        places.append((length - RADIUS - layer * height, RADIUS + pitch * (row + layer % 2 / 2)))
    return length, rows * pitch + pitch / 2, places


def write_scene(path, packing):
    length, width, places = packing
    with open(path, "w", encoding="ascii") as file:
        file.write(f"{length:.12g} {width:.12g} {VELOCITY[0]:.12g} {VELOCITY[1]:.12g} {len(places)}\n")
        file.writelines(f"{x:.12g} {y:.12g}\n" for x, y in places)


def write_data(path, packing):
    """The same for LAMMPS. Its box is a radius wider, as walls and contacts are soft."""
    length, width, places = packing
    with open(path, "w", encoding="ascii") as file:
        file.write(f"jam\n\n{len(places)} atoms\n1 atom types\n\n"
                   f"0 {length + RADIUS:.12g} xlo xhi\n{-RADIUS} {width + RADIUS:.12g} ylo yhi\n"
                   f"{-RADIUS} {RADIUS} zlo zhi\n\nAtoms\n\n")
        file.writelines(f"{number} 1 {2 * RADIUS} 1 {x:.12g} {y:.12g} 0\n"
                        for number, (x, y) in enumerate(places, 1))


def run_program(command):
    environment = dict(os.environ, OMP_NUM_THREADS="1", OMP_PROC_BIND="true",
                       OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        sys.exit(f"compare: {command[0]} failed:\n{done.stdout[-2000:]}")
    return done.stdout


def time_ours(program, folder, warmup, steps):
    """Seconds of the best repetition by number of threads, and `bytes` of memory a part."""
    out = run_program([program, folder / "jam.scene", folder / "ours", str(warmup), str(steps),
                       str(REPETITIONS), str(THREADS)])
    return {name: float(value) for name, value in map(str.split, out.splitlines())}


def time_lammps(folder, packing, steps, cores):
    """The same of LAMMPS on a number of cores."""
    values = {
        "DATA": folder / "jam.data", "RESULT": folder / "lammps", "RADIUS": RADIUS, "MASS": MASS,
        "VX": VELOCITY[0], "VY": VELOCITY[1], "LENGTH": packing[0], "WIDTH": packing[1],
        "K": K, "GAMMA_N": 2 * D / MASS, "GAMMA_T": 2 * RUB / MASS, "MU": MU,
        "WALL_K": WALL_K, "WALL_GAMMA_N": WALL_D / MASS, "WALL_GAMMA_T": WALL_RUB / MASS,
        "WALL_MU": WALL_MU, "BELT": BELT, "DRAG": 0.1 * MASS, "SKIN": RADIUS / 4, "DT": STEP,
        "WARMUP": WARMUP, "STEPS": steps, "REPETITIONS": REPETITIONS,
    }
    command = ["lmp", "-in", FOLDER / "jam.in", "-log", "none"]
    for name, value in values.items():
        command += ["-var", name, str(value)]
    if cores > 1:
        command = ["mpirun", "-np", str(cores), "--bind-to", "core"] + command
    loops = [loop for loop in LOOP.findall(run_program(command)) if int(loop[2]) == steps]
    if len(loops) != REPETITIONS or any(int(loop[3]) != len(packing[2]) for loop in loops):
        sys.exit("compare: LAMMPS lost parts or did not make its steps")
    return min(float(loop[0]) for loop in loops)


def read_result(path):
    """Rows of x, y, vx, vy, spin; LAMMPS puts a header above and a number before them."""
    rows = []
    with open(path, encoding="ascii") as file:
        for line in file:
            values = line.split()
            if values[0] == "ITEM:":
                rows.clear()
            else:
                rows.append(tuple(map(float, values[-5:])))
    return rows


def measure(path, packing):
    """Largest overlap of parts, m; contacts a part; kinetic energy a part, J; mean distance to the plate, m."""
    rows, n = read_result(path), len(packing[2])
    if len(rows) != n:
        sys.exit(f"compare: {path} has {len(rows)} parts, not {n}")
    cells, reach = {}, 2 * RADIUS
    for number, (x, y, *_) in enumerate(rows):
        cells.setdefault((int(x // reach), int(y // reach)), []).append(number)
    overlap, contacts = 0.0, 0
    for (column, row), mine in cells.items():
        near = [b for i in (-1, 0, 1) for j in (-1, 0, 1) for b in cells.get((column + i, row + j), ())]
        for a in mine:
            for b in near:
                depth = reach - math.hypot(rows[a][0] - rows[b][0], rows[a][1] - rows[b][1])
                if a != b and depth > 0:
                    overlap = max(overlap, depth)
                    contacts += 1
    energy = sum(vx * vx + vy * vy + (RADIUS * spin) ** 2 / 2 for _, _, vx, vy, spin in rows)
    depth = sum(packing[0] - row[0] for row in rows) / n
    return {"overlap": overlap, "contacts": contacts / n, "energy": MASS * energy / 2 / n,
            "depth": depth}


# How far the two may differ: the frictions are not quite the same. The largest overlap is that of one
# contact; contacts come and go where layers just touch.
AGREEMENT = {"overlap": 0.15, "contacts": 0.15, "energy": 0.25, "depth": 0.02}


def steps_for(n):
    """About as much work for each number of parts, and no jam so long that its corner gives way."""
    return min(10000, max(500, 80_000_000 // n))


def compare(program, n, rounds):
    """Time both and print it. What they hold at the end is for report()."""
    packing, steps = make_packing(n), steps_for(n)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_scene(folder / "jam.scene", packing)
        write_data(folder / "jam.data", packing)
        best = {}
        for _ in range(rounds):
            ours = time_ours(program, folder, WARMUP, steps)
            for cores in (1, THREADS):
                theirs = time_lammps(folder, packing, steps, cores)
                for key, wall in ((("ours", cores), ours[str(cores)]), (("lammps", cores), theirs)):
                    best[key] = min(best.get(key, math.inf), wall)
        figures = [measure(folder / who, packing) for who in ("ours", "lammps")]
    for cores in (1, THREADS):
        ours, theirs = (n * steps / best[who, cores] / 1e6 for who in ("ours", "lammps"))
        print(f"{n:7} {cores:5} {ours:10.1f} {theirs:10.1f} {ours / theirs:7.2f}", flush=True)
    return n, figures


def grow(program, rounds):
    """Print the time of a part's step by number of parts, and the memory of the largest."""
    times = []
    for n in GROWTH:
        steps = max(20, 20_000_000 // n)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            write_scene(folder / "jam.scene", make_packing(n))
            runs = [time_ours(program, folder, GROWTH_WARMUP, steps) for _ in range(rounds)]
        times.append(min(run["1"] for run in runs) / steps / n * 1e9)
        print(f"{n:7} parts: {times[-1]:6.2f} ns a part and step, {runs[0]['bytes']:.0f} bytes a part", flush=True)
    print(f"the longest time is {max(times) / min(times):.2f} times the shortest")


def report(n, figures):
    """Print what both hold at the end; True if they agree."""
    agree = True
    for who, of in zip(("ours", "LAMMPS"), figures):
        print(f"{n:7} {who:7} {of['overlap'] * 1e3:11.3f} {of['contacts']:10.2f} "
              f"{of['energy'] * 1e6:11.2f} {of['depth'] * 1e3:11.2f}")
    for name, share in AGREEMENT.items():
        ours, theirs = (of[name] for of in figures)
        if abs(ours - theirs) > share * theirs:
            print(f"{n:7} {name} differs by more than {share:.0%}")
            agree = False
    return agree


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--programs", default=FOLDER.parents[2] / "build/release/bench",
                        help="folder of bench_jam")
    parser.add_argument("--rounds", type=int, default=2, help="how often the programs take turns")
    parser.add_argument("--parts", type=int, nargs="+", default=[192, 10000, 100000])
    parser.add_argument("--growth", action="store_true", help="without LAMMPS, up to 1,000,000 parts")
    options = parser.parse_args()
    program = pathlib.Path(options.programs) / "bench_jam"
    if not program.exists():
        sys.exit(f"compare: {program} is not there; cmake --build --preset release")
    if options.growth:
        grow(program, options.rounds)
        return 0
    if shutil.which("lmp") is None or shutil.which("mpirun") is None:
        print("skipped: LAMMPS is not installed; "
              "apt-get install -y --no-install-recommends lammps")
        return 0
    print("million particle-steps a second, explicit steps of 1e-5 s; "
          f"load before: {os.getloadavg()[0]:.1f}")
    print("  parts cores       ours     LAMMPS   ratio")
    held = [compare(program, n, options.rounds) for n in options.parts]
    print("what both hold at the end")
    print("  parts         overlap mm contacts/p energy uJ/p to plate mm")
    agree = [report(*what) for what in held]
    print("both computed the same" if all(agree) else "NOT the same")
    return 0 if all(agree) else 1


if __name__ == "__main__":
    sys.exit(main())
