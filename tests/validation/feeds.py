#!/usr/bin/env python3
"""Saturated rates of the microscopic model under a lasting feed, next to what is known of them.

A feed offers more than the outlet passes, so that the queue reaches back to the inlet. The rate is that of parts which
leave the domain after the warm-up. Known are

    the queue   its length does not change the rate; walls slip freely in `queue` and have the friction of plates in
                queue-paper (the paper's frictions), queue-rough (large ones) and queue-smooth (none);
    speed       the rate is proportional to the speed of the belt;
    funnel      X. Wang et al., Chinese Physics B 29 (2020) 044502: Q ~ 1 - 0.74 exp(-0.19 D/(d cos theta)) for an opening
                D and parts of diameter d, theta = 90 degrees minus the angle of the plates to the belt;
    closure     that of the microscopic model, which both closures of the macroscopic model should have at any load.
"""

import math
import statistics
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

from documents import CLOSURES, MICRO
from fed import options_of, rate
from layouts import DIAMETER_M as D
from layouts import SPEED_M_S, WIDTH_M, funnel, single
from solver import Program

OFFERED_PER_M = 700.0  # parts offered for each metre that the belt moves: more than any outlet here passes
FILLED_M = 8.0  # the belt has moved so far when the queue is there
MEASURED_M = 30.0
LOADED_M = 12.0  # the same in the group "closure"
PACKING_PER_M2 = 2004.0


@dataclass
class Row:
    group: str
    name: str
    layout: object
    tolerance: float  # of the ratio to the first row of the group, relative
    expected: float = 1.0  # that ratio
    contacts: dict = field(default_factory=lambda: {"wall_friction": 0.0})  # /contacts of the scenario


def wang(theta_deg, opening):
    """The factor of the rate of a funnel, see above."""
    return 1.0 - 0.74 * math.exp(-0.19 * opening / (D * math.cos(math.radians(theta_deg))))


def frictions(part, plate, rate):
    """Those of parts on parts and of parts on plates and walls, and lambda of all contacts, s/m."""
    return {"cargo_cargo": {"friction": part, "tanh_linear_s_m": rate},
            "handling_cargo": {"friction": plate, "tanh_linear_s_m": rate},
            "conveyor_cargo": {"tanh_linear_s_m": rate}}


def fed(row, substream, offered_per_m=OFFERED_PER_M, measured_m=MEASURED_M):
    """The scenario of a row: its layout, with a feed instead of the heap."""
    layout = row.layout
    document = layout.document("fed")
    del document["initial"]
    warmup = round(FILLED_M / layout.speed, 3)
    return {
        **document,
        "duration_s": warmup + round(measured_m / layout.speed, 3),
        "warmup_s": warmup,
        "substream": substream,
        "feeds": [{"id": "infeed", "edge": "west", "arrivals": "poisson",
                   "rate_per_s": round(offered_per_m * layout.speed, 3)}],
        "output": {"curve_every_s": 0.1, "snapshot_every_s": 10.0},
        "micro": MICRO["implicit"],
        "contacts": row.contacts,
    }


def queue(length):
    return single(60, 0.10, 1.0, foot=length)


def rows():
    yield from (Row("queue", f"queue of {length} m", queue(length), 0.02) for length in (0.4, 0.8, 1.6))
    for group, contacts in {"queue-paper": {}, "queue-rough": frictions(1.0, 1.0, 1000.0)}.items():
        yield from (Row(group, f"queue of {length} m", funnel(90, 10 * D, 1.0, length), 0.02, contacts=contacts)
                    for length in (0.4, 1.6))
    yield from (Row("queue-smooth", f"queue of {length} m", single(90, 0.10, 1.0, foot=length), 0.02,
                    contacts=frictions(0.0, 0.0, 10.0)) for length in (0.4, 1.6))
    yield from (Row("speed", f"{speed} m/s", single(60, 0.10, 1.0, foot=0.5, speed=speed), 0.04, speed / SPEED_M_S)
                for speed in (SPEED_M_S, 0.1, 0.2, 0.3, 0.5, 0.6))
    for n in (6, 10):
        for theta in (0, 80):
            yield Row(f"funnel-{n}d", f"theta {theta}, {n} d", funnel(90 - theta, n * D, 1.0), 0.05,
                      wang(theta, n * D) / wang(0, n * D))


def loads():
    """Angle, opening in m, and what the feed offers as a share of what a packed outlet would carry."""
    yield from ((60, 0.10, load) for load in (0.3, 0.6, 0.8, 1.0, 1.65))
    yield from ((angle, 0.10, load) for angle in (45, 75, 90) for load in (0.5, 1.65))
    yield from ((60, opening, 1.65) for opening in (0.07, 0.15))


def compare_closures(program, pool, substreams):
    """The rates of both closures next to that of the parts. True if that of `congested` is off by more than 8 %."""
    made = []
    for angle, opening, load in loads():
        row = Row("closure", f"{angle} deg", single(angle, opening, 1.0, foot=0.75), 0.08, contacts={})
        documents = [fed(row, k, load * PACKING_PER_M2 * opening, LOADED_M) for k in range(substreams)]
        jobs = [[pool.submit(program.solve, "micro", document) for document in documents]]
        for closure in CLOSURES:
            macro = {"cell_m": 0.005, "step_s": "auto", "closure": closure}
            jobs.append([pool.submit(program.solve, "macro", {**documents[0], "macro": macro})])
        made.append((angle, opening, load, documents[0]["warmup_s"], jobs))
    is_missed = False
    print(f"{'angle':>5} {'m':>5} {'load %':>6} {'micro/s':>8} "
          + " ".join(f"{closure + ' %':>13}" for closure in CLOSURES))
    for angle, opening, load, warmup, jobs in made:
        micro, *others = [statistics.mean(rate(run.result().folder, warmup) for run in runs) for runs in jobs]
        errors = [100 * (other / micro - 1) for other in others]
        is_missed |= abs(errors[CLOSURES.index("congested")]) > 8.0
        print(f"{angle:5} {opening:5.2f} {100 * load:6.0f} {micro:8.2f} " + " ".join(f"{e:13.1f}" for e in errors),
              flush=True)
    return is_missed


def main():
    options = options_of(__doc__, "queue, queue-paper, queue-rough, queue-smooth, speed, funnel-6d, funnel-10d, closure", 3)
    program = Program(options.program, options.out / "runs")
    chosen = [row for row in rows() if not options.names or row.group in options.names]
    with ThreadPoolExecutor(options.jobs) as pool:
        runs = [[pool.submit(program.solve, "micro", fed(row, k)) for k in range(options.substreams)]
                for row in chosen]
        first, missed = {}, 0
        if not options.names or "closure" in options.names:
            missed += compare_closures(program, pool, options.substreams)
        print(f"{'group':12} {'row':16} {'parts/s':>8} {'+-':>6} {'ratio':>7} {'known':>7} {'off %':>6} {'most':>5}")
        for row, made in zip(chosen, runs):
            warmup = fed(row, 0)["warmup_s"]
            rates = [rate(run.result().folder, warmup) for run in made]
            mean = statistics.mean(rates)
            ratio = mean / first.setdefault(row.group, mean)
            off = ratio / row.expected - 1.0
            is_missed = abs(off) > row.tolerance
            missed += is_missed
            spread = statistics.stdev(rates) if len(rates) > 1 else math.nan
            print(f"{row.group:12} {row.name:16} {mean:8.2f} {spread:6.2f} {ratio:7.4f} {row.expected:7.4f} "
                  f"{100 * off:6.2f} {100 * row.tolerance:5.1f}{' *' if is_missed else ''}", flush=True)
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
