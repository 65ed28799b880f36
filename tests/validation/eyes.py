#!/usr/bin/env python3
"""Photo eyes in both models: how often they change, and how long they stay blocked.

Cans of 66 mm on a belt of 0.4 m/s, at light load and at saturation: eyes that only see, without a time to wait, and eyes
that stop or slow the belt before them. Printed are the blocked states per minute, the seconds that each one lasts,
and the parts/s that left, all after the warm-up, of moving parts and of the density.
"""

import csv
import json
import math
import statistics
import sys

from fed import TREE, options_of, rate
from solver import Program

D, V, WARM_UP, DURATION = 0.066, 0.4, 30.0, 600.0
MOST_OFF = 0.03  # of a mean cycle
CAN = {"shape": {"type": "cylinder", "radius_m": D / 2, "height_m": 0.115}, "mass_kg": 0.35}


def line(width, rate_per_s, arrivals="poisson", eye=None, plate=None, actions=(), speed=V, at=1.6, **members):
    """A belt of 2.4 m in two parts, the second one from 1.2 m on with its own speed."""
    eye = {"id": "eye", "line_m": [[at, 0], [at, width]], **(eye or {})}
    ramps = {"acceleration_m_s2": 1, "deceleration_m_s2": 1}
    return {
        "duration_s": DURATION, "warmup_s": WARM_UP, "domain": {"x_m": [0, 2.4], "y_m": [0, width]},
        "belts": [{"id": "infeed", "velocity_m_s": [V, 0], **ramps,
                   "polygon_m": [[0, 0], [1.2, 0], [1.2, width], [0, width]]},
                  {"id": "buffer", "velocity_m_s": [speed, 0],
                   "polygon_m": [[1.2, 0], [2.4, 0], [2.4, width], [1.2, width]]}],
        "obstacles": [{"path_m": plate}] if plate else [],
        "cargo": CAN, "feeds": [{"edge": "west", "arrivals": arrivals, "rate_per_s": rate_per_s}],
        "photo_eyes": [eye], "actions": list(actions),
        "output": {"curve_every_s": 1.0, "snapshot_every_s": 100.0}, **members,
    }


def stops(factor, delay=0.5):
    """The infeed gets a factor while the eye is blocked, and its speed back some time after that."""
    return [{"when": {"photo_eye": "eye", "state": "blocked"}, "do": {"belt": "infeed", "factor": factor}},
            {"when": {"photo_eye": "eye", "state": "clear"}, "delay_s": delay, "do": {"belt": "infeed", "factor": 1}}]


def ready():
    document = json.loads((TREE / "api/scenario/examples/photo-eye.json").read_text())
    return {**document, "duration_s": DURATION, "warmup_s": WARM_UP,
            "counters": [{"id": "upstream", "x_m": [0, 1.1]}]}


PATIENT = {"block_time_s": 0.5, "clear_time_s": 0.3}
ROWS = {
    "one lane, regular 2/s, sees": line(0.075, 2.0, "regular"),
    "one lane, 1/s, sees": line(0.075, 1.0),
    "one lane, 3/s, sees": line(0.075, 3.0),
    "0.3 m, 2/s, sees": line(0.3, 2.0),
    "0.3 m, 6/s, sees": line(0.3, 6.0),
    "0.6 m, 6/s, sees": line(0.6, 6.0),
    "0.3 m, 5/s, stops the belt": line(0.3, 5.0, eye=PATIENT, actions=stops(0)),
    "0.3 m, 9/s, stops the belt": line(0.3, 9.0, eye=PATIENT, actions=stops(0)),
    "0.3 m, 5/s, slows the belt": line(0.3, 5.0, eye=PATIENT, actions=stops(0.3)),
    "0.6 m, plate, saturated, stops the belt": line(
        0.6, 45.0, eye=PATIENT, actions=stops(0), plate=[[1.9, 0], [2.05, 0.25]]),
    "0.6 m, slow buffer, saturated, stops the belt": line(
        0.6, 50.0, eye=PATIENT, actions=stops(0), speed=0.3),
    "eye at the end of the belt, 0.3 m, 5/s": line(0.3, 5.0, at=2.39),
    "ready scenario photo-eye": ready(),
}


def states(run):
    """Blocked states after the warm-up: per minute, and how long each one lasts, s."""
    with open(run.folder / "photo_eyes.csv", newline="") as file:
        changes = [(float(row["t_s"]), row["state"]) for row in csv.DictReader(file)]
    changes = [change for change in changes if change[0] >= WARM_UP]
    begun = [t for t, state in changes if state == "blocked"]
    lasted = [after - t for (t, state), (after, _) in zip(changes, changes[1:]) if state == "blocked"]
    return 60.0 * len(begun) / (DURATION - WARM_UP), statistics.mean(lasted) if lasted else math.nan


def figures(program, model, document, substreams):
    runs = [program.solve(model, {**document, "substream": k}) for k in range(substreams)]
    seen = [(*states(run), rate(run.folder, WARM_UP)) for run in runs]
    means = [statistics.mean(of) for of in zip(*seen)]
    spread = statistics.stdev(of[0] for of in seen) / math.sqrt(substreams) if substreams > 1 else math.nan
    return means, spread


def main():
    options = options_of(__doc__, "words of the rows' names", 3)
    program = Program(options.program, options.out / "runs")
    print(f"{'per min':>8} {'+-%':>5} {'lasts s':>8} {'parts/s':>8} | density: {'per min':>8} {'+-%':>5} {'lasts s':>8} "
          f"{'parts/s':>8} | {'cycle %':>8}")
    off = []
    for name, document in ROWS.items():
        if options.names and not any(word in name for word in options.names):
            continue
        parts, error = figures(program, "micro", document, options.substreams)
        density, spread = figures(program, "macro", document, options.substreams)
        off.append(parts[0] / density[0] - 1.0 if density[0] > 0 else math.inf)
        print(f"{parts[0]:8.2f} {100 * error / max(parts[0], 1e-9):5.1f} {parts[1]:8.3f} {parts[2]:8.3f} |          "
              f"{density[0]:8.2f} {100 * spread / max(density[0], 1e-9):5.1f} {density[1]:8.3f} {density[2]:8.3f} | "
              f"{100 * off[-1]:8.1f}  {name}{' *' if abs(off[-1]) > MOST_OFF else ''}", flush=True)
    sys.exit(any(abs(of) > MOST_OFF for of in off))


if __name__ == "__main__":
    main()
