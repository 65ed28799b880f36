#!/usr/bin/python3
"""How often the 95 % interval of one run covers the throughput in the long run: fed scenes of the microscopic model, from
light to saturated, regular and Poisson, with jams that come and go, each with many substreams. The throughput in the long
run is what is fed, or of saturated lines the mean of all substreams of the longest duration. Prints a table; exit status 1 unless intervals that are given
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


def scene(rate, arrivals="poisson", warmup=8.0, **members):
    """A belt of 0.4 m x 0.2 m for disks of 24 mm, of which it carries 160 /s."""
    return {"cargo": {"shape": {"type": "cylinder", "radius_m": 0.012, "height_m": 0.008}},
            "domain": {"x_m": [0, 0.4], "y_m": [0, 0.2]}, "belts": [{"id": "main", "velocity_m_s": [0.4, 0]}],
            "feeds": [{"edge": "west", "y_m": [0.03, 0.17], "arrivals": arrivals, "rate_per_s": rate}],
            "micro": {"integrator": "implicit"}, "warmup_s": warmup,
            "output": {"curve_every_s": 0.05, "snapshot_every_s": 1e4}} | members


def deflected(rate, arrivals="poisson", **members):
    """Before a deflector that leaves 3.3 diameters, through which 40 /s come."""
    return scene(rate, arrivals, obstacles=[{"end_m": [0.3, 0.12], "angle_deg": 60, "length_m": 0.3}], **members)


def saturated(arrivals="poisson"):
    """Before an opening of as much, a short and narrow belt that is fed more than it lets through."""
    belt = {"domain": {"x_m": [0, 0.25], "y_m": [0, 0.14]}, "obstacles": [{"end_m": [0.2, 0.06], "angle_deg": 60, "length_m": 0.2}]}
    line = deflected(60, arrivals, warmup=15.0) | belt
    line["feeds"][0]["y_m"] = [0.02, 0.12]
    return line


def gated(rate, arrivals="poisson", period=6.0):
    """Before a gate that is closed for half of the time."""
    present = {"t_s": [0, period / 2], "value": [True, False], "repeat_s": period}
    return scene(rate, arrivals, obstacles=[{"path_m": [[0.35, 0.0], [0.35, 0.2]], "present": present}], warmup=2 * period)


def watched(rate, arrivals="poisson"):
    """With an eye that slows the belt while something is under it."""
    return scene(rate, arrivals, photo_eyes=[{"id": "eye", "line_m": [[0.3, 0.0], [0.3, 0.2]], "block_time_s": 0.1}],
                 actions=[{"when": {"photo_eye": "eye", "state": state}, "do": {"belt": "main", "factor": factor}}
                          for state, factor in [("blocked", 0.3), ("clear", 1)]])


SCENES = {
    "light, Poisson": scene(3),
    "light, Poisson, no warm-up": scene(3, warmup=0.0),
    "light, regular": scene(3, "regular"),
    "dense, Poisson": scene(20),
    "dense, regular": scene(20, "regular"),
    "deflector, Poisson": deflected(12),
    "deflector, regular": deflected(12, "regular"),
    "queue comes and goes": deflected(32),
    "saturated, Poisson": saturated(),
    "saturated, regular": saturated("regular"),
    "gate of 6 s, Poisson": gated(3),
    "gate of 12 s, regular": gated(3, "regular", 12.0),
    "eye slows, Poisson": watched(4),
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
        fed = 3600.0 * document["feeds"][0]["rate_per_s"]
        truth = statistics.fmean(longest) if "saturated" in name else fed
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
