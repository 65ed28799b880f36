#!/usr/bin/python3
"""How often the 95 % interval of one run covers the throughput in the long run: fed scenes of the microscopic model, from
light to saturated, regular and Poisson, with jams and with a gate, each with many substreams. The throughput in the long
run is the mean of all substreams of the longest duration. Prints a table; exit status 1 unless intervals that are given
cover in 92 % to 98 %, but for three standard errors of the counting. Many minutes; not a test of every change."""

import argparse
import concurrent.futures
import copy
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def scene(rate, arrivals="poisson", opening=None, warmup=8.0, **members):
    """A belt of 0.8 m x 0.3 m for disks of 24 mm, with a deflector that leaves an opening, m."""
    out = {"cargo": {"shape": {"type": "cylinder", "radius_m": 0.012, "height_m": 0.008}},
           "domain": {"x_m": [0, 0.8], "y_m": [0, 0.3]}, "belts": [{"velocity_m_s": [0.4, 0]}],
           "feeds": [{"edge": "west", "y_m": [0.03, 0.27], "arrivals": arrivals, "rate_per_s": rate}],
           "micro": {"integrator": "implicit"}, "warmup_s": warmup,
           "output": {"curve_every_s": 0.05, "snapshot_every_s": 1e4}}
    if opening is not None:
        out["obstacles"] = [{"end_m": [0.6, 0.3 - opening], "angle_deg": 60, "length_m": 0.3}]
    return out | members


def gated(rate):
    gate = {"path_m": [[0.7, 0.0], [0.7, 0.3]], "present": {"t_s": [0, 3], "value": [True, False], "repeat_s": 6}}
    return scene(rate, obstacles=[gate])


SCENES = {
    "light, Poisson": scene(3),
    "light, Poisson, no warm-up": scene(3, warmup=0.0),
    "light, regular": scene(3, "regular"),
    "deflector, Poisson": scene(6, opening=0.08),
    "deflector, regular": scene(6, "regular", opening=0.08),
    "saturated, Poisson": scene(30, opening=0.08, warmup=15.0),
    "gate of 6 s": gated(3),
}


def solve(folder, document, substream):
    file = folder / f"{substream}.json"
    file.write_text(json.dumps(document | {"substream": substream}))
    out = folder / str(substream)
    subprocess.run([ARGUMENTS.program, "solve", file, "--model", "micro", "--out", out], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads((out / "summary.json").read_text())["key_figures"]


def measure(document, duration, n):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        document = copy.deepcopy(document) | {"duration_s": duration + document["warmup_s"]}
        with concurrent.futures.ThreadPoolExecutor(ARGUMENTS.workers) as pool:
            return list(pool.map(lambda k: solve(folder, document, k), range(n)))


def row(figures, truth):
    """Of runs: the share that has an interval, and the share of those that cover."""
    given = [f for f in figures if "throughput_error_per_h" in f]
    covering = [f for f in given if abs(f["throughput_per_h"] - truth) <= f["throughput_error_per_h"]]
    return len(given), len(covering)


def main():
    is_good = True
    print(f"{'scene':28} {'long run, /h':>14} " + " ".join(f"{d:>20.0f} s" for d in ARGUMENTS.durations))
    for name, document in SCENES.items():
        if ARGUMENTS.scene and ARGUMENTS.scene not in name:
            continue
        figures = {d: measure(document, d, ARGUMENTS.substreams) for d in ARGUMENTS.durations}
        longest = [f["throughput_per_h"] for f in figures[max(figures)]]
        truth = statistics.fmean(longest)
        if document["warmup_s"] == 0:
            truth = 3600.0 * document["feeds"][0]["rate_per_s"]
        cells = []
        for d in ARGUMENTS.durations:
            given, covering = row(figures[d], truth)
            share = covering / given if given else math.nan
            error = 3 * math.sqrt(0.95 * 0.05 / given) if given else 0.0
            is_good &= not given or 0.92 - error <= share <= 0.98 + error
            cells.append(f"{given:4} of {len(figures[d]):4}, {100 * share:5.1f} %")
        spread = statistics.stdev(longest) / math.sqrt(len(longest))
        print(f"{name:28} {truth:8.0f} ± {spread:3.0f} " + " ".join(f"{c:>22}" for c in cells), flush=True)
    return 0 if is_good else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--substreams", type=int, default=200)
    parser.add_argument("--durations", type=float, nargs="+", default=[40.0, 120.0, 400.0, 1200.0])
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/bin/beltflow")
    parser.add_argument("--scene", help="a part of its name")
    ARGUMENTS = parser.parse_args()
    sys.exit(main())
