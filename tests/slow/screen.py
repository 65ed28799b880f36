#!/usr/bin/python3
"""A study of method `screen` on the belt of Example 1 with a lasting feed, from a daemon that has just been started, next
to a search by brute force: the microscopic model at every angle with 20 replications. Exit status 1 unless the angle that
was screened is within 2 degrees of the best one by brute force. With --cans the belt is a line of cans, of which more are
offered than an opening lets through, brute force makes 40 replications at 13 angles, and its best one must be in the set. Some minutes; not a
test of every change."""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/bench/service"))

from daemon import BINARIES, Daemon  # noqa: E402

POINTER = "/obstacles/0/angle_deg"
FIGURE = "throughput_per_h"
CLOSE_DEG = 2.0
ARE_CANS = "--cans" in sys.argv


def scenario():
    """The opening of 0.1 m beside the deflector's tip stays; its foot is at the wall or behind it at every angle."""
    belt = json.loads((ROOT / "api/scenario/examples/example-1-implicit.json").read_text())
    del belt["initial"]
    belt |= {"duration_s": 10.0, "warmup_s": 4.0,
             "feeds": [{"id": "infeed", "edge": "west", "y_m": [0.02, 0.58], "arrivals": "poisson", "rate_per_s": 80.0}],
             "obstacles": [{"id": "deflector", "end_m": [0.75, 0.5], "angle_deg": 60.0, "length_m": 1.0}],
             "output": {"curve_every_s": 0.05, "snapshot_every_s": 10.0}}
    belt["macro"] |= {"cell_m": 0.01, "step_s": 0.0025}
    return belt


def cans():
    """A line of cans before a deflector that leaves 0.24 m, 3.6 diameters, at every angle."""
    return {"duration_s": 40.0, "warmup_s": 20.0, "domain": {"x_m": [0, 2.4], "y_m": [0, 0.8]},
            "belts": [{"velocity_m_s": [0.4, 0]}], "cargo": {"goods": "can-330"},
            "obstacles": [{"id": "deflector", "end_m": [2.0, 0.56], "angle_deg": 60.0, "length_m": 1.2}],
            "feeds": [{"id": "infeed", "edge": "west", "y_m": [0.05, 0.75], "arrivals": "poisson", "rate_per_s": 30.0}],
            "output": {"curve_every_s": 0.1, "snapshot_every_s": 40.0}}


def study(method, **members):
    belt, steps = (cans(), 13) if ARE_CANS else (scenario(), 31)
    return {"base": {"scenario": belt, "model": members.pop("model", "macro")},
            "parameters": [{"pointer": POINTER, "range": [30.0, 90.0], "steps": steps}],
            "objectives": [{"figure": FIGURE, "goal": "maximize"}], "method": method, **members}


def screen(data, indifference, confirm):
    document = study({"type": "screen", "sweep": "grid", "confirm": confirm, "indifference": indifference},
                     replications=4, limits={"trials": 400})
    began = time.perf_counter()
    with Daemon(data) as daemon:
        status, body = daemon.ask("POST", "/v1/studies", json.dumps(document))
        if status != 201:
            raise RuntimeError(body.decode())
        links = json.loads(body)["links"]
        daemon.ask("GET", links["events"])
        wall = time.perf_counter() - began
        now = json.loads(daemon.ask("GET", links["self"])[1])
        if now["status"] != "succeeded":
            raise RuntimeError(f"the study is {now['status']}")
        return json.loads(daemon.ask("GET", links["best"])[1]), now["trials"], wall


def search(folder):
    """The best point of all, and the mean of each angle."""
    file = folder / "in.json"
    file.write_text(json.dumps(study({"type": "grid"}, model="micro", replications=40 if ARE_CANS else 20)))
    subprocess.run([BINARIES / "beltflow", "study", file, "--out", folder / "out"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads((folder / "out/best.json").read_text())["best"]


def describe(point):
    value = point["values"][FIGURE]
    return f"{point['parameters'][POINTER]:g} deg, {value['mean']:.0f} parts/h in {value['interval_95']}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--indifference", type=float, default=2000.0, help="parts/h that do not matter")
    parser.add_argument("--confirm", type=int, default=8, help="angles for the microscopic model")
    parser.add_argument("--cans", action="store_true", help="a line of cans, and whether the set has the best angle")
    parser.add_argument("--no-search", action="store_true", help="the screen alone")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="beltflow-screen-") as name:
        folder = pathlib.Path(name)
        found, trials, wall = screen(folder / "data", arguments.indifference, arguments.confirm)
        print(f"screen       {describe(found['best'])}; {trials['succeeded']} trials, decided: {found['is_decided']}")
        print(f"             {wall:.1f} s from a daemon that was started, on {len(os.sched_getaffinity(0))} cores")
        if arguments.no_search:
            return 0
        best = search(folder)
        print(f"brute force  {describe(best)}")
        for verdict in found["verdicts"]:
            print(f"             {verdict['kind']}: {verdict['text']}")
        if ARE_CANS:
            angles = [point["parameters"][POINTER] for point in found["set"]]
            print(f"the set is {angles}")
            return 0 if best["parameters"][POINTER] in angles else 1
        away = abs(best["parameters"][POINTER] - found["best"]["parameters"][POINTER])
        print(f"{away:g} degrees apart")
        return 0 if away <= CLOSE_DEG else 1


if __name__ == "__main__":
    sys.exit(main())
