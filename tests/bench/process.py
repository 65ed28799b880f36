#!/usr/bin/env python3
"""The whole process of `beltflow solve` next to the solver's own time in it: Example 1, macroscopic, one thread."""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARIES = pathlib.Path(os.environ.get("BELTFLOW_BIN_DIR", ROOT / "build/release/bin"))


def solve():
    """Seconds of the process and of the solver, and what was computed."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        subprocess.run([BINARIES / "beltflow", "solve", ROOT / "api/scenario/examples/example-1.json", "--model",
                        "macro", "--out", f"{folder}/out"], stdout=subprocess.DEVNULL, check=True)
        wall = time.perf_counter() - began
        summary = json.loads(pathlib.Path(folder, "out/summary.json").read_text(encoding="utf-8"))
    return wall, summary["wall_time_s"], summary["digest"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=9, help="of which the best counts (9)")
    runs = [solve() for _ in range(parser.parse_args().rounds)]
    walls, solvers, digests = zip(*runs)
    if len(set(digests)) != 1:
        raise SystemExit("process: the runs differ")
    print(f"beltflow solve: {min(walls):.4f} s, its solver {min(solvers):.4f} s")


if __name__ == "__main__":
    main()
