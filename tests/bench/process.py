#!/usr/bin/env python3
"""The whole process of `beltflow solve`: Example 1, macroscopic, one thread, next to the solver's own time in it; or, with
`memory`, the most that is resident while it solves Example 1 on 10,000 x 6,000 cells."""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("BELTFLOW_BIN_DIR", ROOT / "build/release/bin"))


EXAMPLE = ROOT / "api/scenario/examples/example-1.json"
N_PARTS = 192


def measure_memory():
    """The mollifier spans as many cells as on the usual grid."""
    scenario = json.loads(EXAMPLE.read_text(encoding="utf-8"))
    macro, refinement = scenario["macro"], round(scenario["macro"]["cell_m"] / 0.0001)
    for name in ("mollifier_per_m2", "initial_mollifier_per_m2"):
        macro[name] *= refinement ** 2
    macro |= {"cell_m": 0.0001, "step_s": "auto"}
    scenario |= {"duration_s": 5e-5, "output": {"curve_every_s": 5e-5, "snapshot_every_s": 5e-5}}
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "scenario.json")
        file.write_text(json.dumps(scenario), encoding="utf-8")
        with subprocess.Popen([BINARIES / "beltflow", "solve", file, "--model", "macro", "--out", f"{folder}/out"],
                              stdout=subprocess.DEVNULL) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise SystemExit("process: beltflow solve failed")
        *_, last = pathlib.Path(folder, "out/curve.csv").read_text(encoding="utf-8").split()
    if abs(float(last.split(",")[1]) - N_PARTS) > 1e-6:
        raise SystemExit(f"process: not all parts are there: {last}")
    print(f"beltflow solve, 10,000 x 6,000 cells: {usage.ru_maxrss / 2**20:.2f} GiB")


def solve():
    """Seconds of the process and of the solver, and what was computed."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        subprocess.run([BINARIES / "beltflow", "solve", EXAMPLE, "--model", "macro", "--out", f"{folder}/out"],
                       stdout=subprocess.DEVNULL, check=True)
        wall = time.perf_counter() - began
        summary = json.loads(pathlib.Path(folder, "out/summary.json").read_text(encoding="utf-8"))
    return wall, summary["wall_time_s"], summary["digest"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["time", "memory"], nargs="?", default="time")
    parser.add_argument("--rounds", type=int, default=9, help="of which the best time counts (9)")
    arguments = parser.parse_args()
    if arguments.what == "memory":
        measure_memory()
        return
    runs = [solve() for _ in range(arguments.rounds)]
    walls, solvers, digests = zip(*runs)
    if len(set(digests)) != 1:
        raise SystemExit("process: the runs differ")
    print(f"beltflow solve: {min(walls):.4f} s, its solver {min(solvers):.4f} s")


if __name__ == "__main__":
    main()
