#!/usr/bin/env python3
"""What 10 % of each constant of the closure `congested` does to the rate of the density, over twelve rows of lines.py.

Each constant is changed in a copy of its source, which is compiled and linked as the build did it, so that the program that is
run differs in that constant alone. No moving part is solved: a change of the rate says how well a constant has to be known,
and the rows' errors (lines.py) how well all of them are. The table is that of core/macro/congested/README.md.
"""

import json
import re
import shlex
import statistics
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from fed import TREE, options_of, rate
from lines import BOXES, Line
from solver import Program

LAWS, APERTURE = "core/macro/congested/laws.c", "core/macro/aperture.c"
CHANGE = 0.1

# What README.md calls it, its file, and what stands before its number there.
CONSTANTS = [
    ("k λ v_T", LAWS, "forward_slope = "),
    ("most beyond the belt's speed", LAWS, "forward_most = "),
    ("most across and back", LAWS, "lateral_most = "),
    ("tanφ", LAWS, " friction = "),
    ("slide zone", "core/macro/regions.c", "congested_slide = "),
    ("end, c: 1.2", APERTURE, "end_law = { "),
    ("end, a: 2", APERTURE, "end_law = { 1.2, "),
    ("end, b: 0.4", APERTURE, "end_law = { 1.2, 2.0, "),
    ("wall, c: 0.9", APERTURE, "wall_law = { "),
    ("wall, a: 0.7", APERTURE, "wall_law = { 0.9, "),
    ("wall, b: 0.4", APERTURE, "wall_law = { 0.9, 0.7, "),
    ("lane, sin²θ: 0.5", APERTURE, "lane_law = { "),
    ("lane, a: 0.95", APERTURE, "lane_law = { 0.5, "),
    ("lane, b: 0.63", APERTURE, "lane_law = { 0.5, 0.95, "),
    ("s, arches: 10", APERTURE, "arch_length = "),
    ("s, shallow plates: 2.5", APERTURE, "arch_slope = "),
    ("f, funnels: 2", APERTURE, "most_gained = "),
    ("v_T²/(μ_b g o): 0.9", APERTURE, "acceleration = "),
    ("w: 4", APERTURE, "shallow = "),
]

ROWS = {
    "plate 30°": dict(angle=30, opening=5.5),
    "plate 60°": dict(angle=60, opening=5.5),
    "plate 90°": dict(angle=90, opening=8),
    "rough parts": dict(angle=60, opening=5.5, parts=0.5),
    "rough plates": dict(angle=60, opening=5.5, plates=0.4),
    "fast belt": dict(angle=60, opening=5.5, v=2),
    "funnel 45°": dict(layout="funnel", angle=45, opening=5),
    "funnel 75°": dict(layout="funnel", angle=75, opening=5.5),
    "lane 45°": dict(layout="lane", angle=45, opening=5.2, v=0.3, plates=0.45),
    "rough lane": dict(layout="lane", angle=45, opening=5.2, v=0.3, parts=0.45),
    "transfer": dict(layout="transfer", opening=10, load=1),
    "boxes": dict(box=1.33, opening=5.5, angle=60, **BOXES),
}


def changed(source, before, factor):
    """The source with the number behind `before` times a factor."""
    found = re.search(re.escape(before) + r"([0-9.]+)", source)
    number = repr(float(found[1]) * factor)
    return source[: found.start(1)] + number + source[found.end(1):]


def build(folder, file, text, program):
    """The program with another text of one source file."""
    made = program.parents[1]
    commands = json.loads((made / "compile_commands.json").read_text())
    compile_ = next(shlex.split(of["command"]) for of in commands if of["file"] == str(TREE / file))
    (folder / "changed.c").write_text(text)
    compile_[compile_.index("-o") + 1] = str(folder / "changed.o")
    compile_[-1] = str(folder / "changed.c")
    subprocess.run(compile_, cwd=made, check=True)
    links = subprocess.run(["ninja", "-t", "commands", "bin/beltflow"], cwd=made, check=True, capture_output=True, text=True)
    link = shlex.split(links.stdout.splitlines()[-1].split("&&")[1])
    at = link.index("-o")
    link[at:at + 2] = [str(folder / "changed.o"), "-o", str(folder / "beltflow")]  # before the archive that has the other one
    subprocess.run(link, cwd=made, check=True)
    return folder / "beltflow"


def rates(path, cache, macro=None):
    """The rate of each row, parts/s."""
    program = Program(path, cache)
    documents = [Line("development", name, **row).document(0) for name, row in ROWS.items()]
    return [rate(program.solve("macro", {**document, "macro": macro} if macro else document).folder, document["warmup_s"])
            for document in documents]


def told(now, before):
    """The mean of the rates' changes, that of their sizes, and the largest, %, with its row."""
    changes = [100.0 * (a / b - 1.0) for a, b in zip(now, before)]
    largest = max(zip(changes, ROWS), key=lambda of: abs(of[0]))
    size = statistics.mean(map(abs, changes))
    return f"{size:.2f}; {largest[0]:+.1f} {largest[1] if abs(largest[0]) >= 0.05 else ''}".replace("-", "−").strip()


def main():
    options = options_of(__doc__, None, 1)
    program, cache = options.program.resolve(), options.out / "runs"
    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(options.jobs) as pool:
        before = rates(program, cache)

        def of(job):
            number, (_, file, text), factor = job
            folder = Path(place) / str(number)
            folder.mkdir()
            return told(rates(build(folder, file, changed((TREE / file).read_text(), text, factor), program), folder / "runs"), before)

        factors = (1.0 - CHANGE, 1.0 + CHANGE)
        jobs = [(2 * k + m, constant, factor) for k, constant in enumerate(CONSTANTS) for m, factor in enumerate(factors)]
        jam = pool.submit(rates, program, cache, {"jam_density": 0.93 * factors[0]})
        found = list(pool.map(of, jobs))
        print("| constant | −10 % | +10 % |\n|---|---|---|")
        print(f"| ρ_j | {told(jam.result(), before)} | |")
        for k, (name, _, _) in enumerate(CONSTANTS):
            print(f"| {name} | {found[2 * k]} | {found[2 * k + 1]} |")


if __name__ == "__main__":
    main()
