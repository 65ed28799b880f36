#!/usr/bin/env python3
"""Equipment of conveyors in both models at their defaults: curves, merges, pushers, gates, sorters, zones.

Each scene is solved at light load and saturated. Printed are the parts/s that left, of moving parts and of the density, how
far they are apart, and the mean difference of the contents of the line, as means over 8 s, of the largest content. Where goods leave at
several places what leaves at another one than the parts do counts as a difference, too, which has no sign where most is that. Last
comes what validity says of the density for the scene: `compared`, or the figures that are outside of what was compared. README.md has
these lines as its table.
"""

import itertools
import math
import statistics
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Callable

from fed import options_of, rate
from lines import Line
from solver import Failed, Program
from table import values_of

MOST_OFF, MOST_GAP = 0.08, 0.03
EVERY, SMOOTHING = 0.5, 16  # s between samples of the contents, and samples of a mean
CLOSE = 0.9069  # share of an area that close packed cylinders cover
RADIUS = {"can-330": 0.033, "keg-50": 0.204}
CAN, KEG = {"goods": "can-330"}, {"goods": "keg-50"}


@dataclass
class Scene:
    name: str
    at_load: Callable  # from the load, light or saturated, to a scenario
    loads: tuple  # light, saturated
    flows: tuple = ("left_domain",)

    def document(self, load, substream):
        return {**self.at_load(load), "name": f"{self.name}, {load:g}", "substream": substream,
                "output": {"curve_every_s": EVERY, "snapshot_every_s": 2.0}}


def packed(cargo, width, speed):
    """Parts/s that a belt of this width carries when they are close packed."""
    return CLOSE * width * speed / (math.pi * RADIUS[cargo["goods"]] ** 2)


def place(points):
    return [[round(x, 6), round(y, 6)] for x, y in points]


def box(x_0, x_1, y_0, y_1):
    return place([(x_0, y_0), (x_1, y_0), (x_1, y_1), (x_0, y_1)])


def around(centre, radius, begin_deg, end_deg):
    """Points of a rail along an arc, every 5 degrees."""
    n = math.ceil(abs(end_deg - begin_deg) / 5)
    angles = [math.radians(begin_deg + (end_deg - begin_deg) * k / n) for k in range(n + 1)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]


def line(x, y, cargo, belts, rails, feeds, warm_up, measured, **members):
    return {
        "duration_s": warm_up + measured, "warmup_s": warm_up,
        "domain": {"x_m": [0, round(x, 6)], "y_m": [0, round(y, 6)]}, "belts": belts,
        "obstacles": [{"path_m": place(path)} for path in rails], "cargo": cargo, "feeds": feeds,
        "counters": [{"id": "upstream", "x_m": [0, round(x, 6)]}], **members,
    }


def feed(edge, along, rate_per_s, cargo, **members):
    """Regular arrivals over the width of a belt, but for half a part at its sides."""
    radius, axis = 1.05 * RADIUS[cargo["goods"]], "y_m" if edge in ("west", "east") else "x_m"
    return {"edge": edge, axis: [round(along[0] + radius, 6), round(along[1] - radius, 6)], "arrivals": "regular",
            "rate_per_s": round(rate_per_s, 5), **members}


NORTHWARD = {"west": "inflow", "east": "wall", "south": "wall", "north": "outflow"}


def curve(cargo, width, inner, opening=0.0, speed=0.4, straight=1.0, warm_up=30.0, measured=60.0):
    """A quarter of a turn between rails; with an opening a plate at 60 degrees stands behind it."""
    def at_load(load):
        x, y, centre = straight + inner + width, width + inner + straight, (straight, width + inner)
        rails = [[(0, width), *around(centre, inner, -90, 0), (straight + inner, y)],
                 [(0, 0), *around(centre, inner + width, -90, 0), (x, y)]]
        if opening:
            across, begin = width - opening, centre[1] + 0.3 * straight
            rails.append([(straight + inner, begin), (straight + inner + across, begin + across / math.tan(math.radians(60)))])
        belts = [{"velocity_m_s": [speed, 0], "polygon_m": box(0, straight, 0, width)},
                 {"velocity_m_s": [speed, 0], "arc": {"centre_m": place([centre])[0], "inner_radius_m": inner,
                                                      "outer_radius_m": round(inner + width, 6), "from_deg": -90, "to_deg": 0}},
                 {"velocity_m_s": [0, speed], "polygon_m": box(straight + inner, x, centre[1], y)}]
        offered = load * packed(cargo, opening or width, speed)
        return line(x, y, cargo, belts, rails, [feed("west", (0, width), offered, cargo)], warm_up, measured, edges=NORTHWARD)
    return at_load


def u_turn(cargo, width, inner, speed=0.5, slower=0.3, straight=1.0):
    """Half a turn onto a belt that is slower."""
    def at_load(load):
        y, centre = 2 * (width + inner), (straight, width + inner)
        x = straight + inner + width
        rails = [[(0, width), *around(centre, inner, -90, 90), (0, width + 2 * inner)],
                 [(0, 0), *around(centre, inner + width, -90, 90), (0, y)]]
        belts = [{"velocity_m_s": [speed, 0], "polygon_m": box(0, straight, 0, width)},
                 {"velocity_m_s": [speed, 0], "arc": {"centre_m": place([centre])[0], "inner_radius_m": inner,
                                                      "outer_radius_m": round(inner + width, 6), "from_deg": -90, "to_deg": 90}},
                 {"velocity_m_s": [-slower, 0], "polygon_m": box(0, straight, width + 2 * inner, y)}]
        offered = load * packed(cargo, width, slower)
        return line(x, y, cargo, belts, rails, [feed("west", (0, width), offered, cargo)], 25.0, 50.0,
                    edges={"west": "inflow", "east": "wall", "south": "wall", "north": "wall"},
                    sinks=[{"id": "out", "polygon_m": box(0, 0.15, width + 2 * inner, y)}])
    return at_load


def merge_45(cargo, width, speed=0.4):
    """A lane comes over the side of the line at 45 degrees."""
    def at_load(load):
        at, high, wide = 1.0, 0.8, math.sqrt(2) * width
        x, y = at + wide + 1.0, width + high
        to = speed / math.sqrt(2)
        rails = [[(0, width), (at, width), (at - high, y)], [(at + wide - high, y), (at + wide, width), (x, width)]]
        belts = [{"velocity_m_s": [speed, 0], "polygon_m": box(0, x, 0, width)},
                 {"velocity_m_s": [to, -to],
                  "polygon_m": place([(at, width), (at + wide, width), (at + wide - high, y), (at - high, y)])}]
        offered = load * packed(cargo, width, speed) / 2
        feeds = [feed("west", (0, width), offered, cargo), feed("north", (at - high, at + wide - high), offered, cargo)]
        return line(x, y, cargo, belts, rails, feeds, 25.0, 50.0,
                    edges={"west": "inflow", "east": "outflow", "south": "wall", "north": "inflow"})
    return at_load


def spur(cargo, width, speed=0.4, reach=0.5, every=5.0):
    """Every few seconds a pusher moves what lies along it off the line onto a spur."""
    def at_load(load):
        at, depth, x = 1.0, 0.5, 2.2
        spur_at = (at, at + reach + 0.3)
        y = width + depth
        rails = [[(0, width), (spur_at[0], width), (spur_at[0], y)], [(spur_at[1], y), (spur_at[1], width), (x, width)]]
        # Its side stops the line while it is out.
        pusher = place([(at + 0.05, 0.002 - width), (at + 0.05, 0.002), (at + 0.05 + reach, 0.002)])
        belts = [{"velocity_m_s": [speed, 0], "polygon_m": box(0, x, 0, width)},
                 {"velocity_m_s": [0, speed], "polygon_m": box(*spur_at, width, y)}]
        document = line(x, y, cargo, belts, rails, [feed("west", (0, width), load * packed(cargo, width, speed), cargo)],
                        15.0, 60.0, edges={"west": "inflow", "east": "wall", "south": "wall", "north": "wall"},
                        sinks=[{"id": "line", "polygon_m": box(x - 0.15, x, 0, width)},
                               {"id": "spur", "polygon_m": box(*spur_at, y - 0.15, y)}])
        document["obstacles"].append({
            "path_m": pusher,
            "motion": {"t_s": [0, every - 1.2, every - 0.6], "shift_m": [[0, 0], [0, 0], [0, width]], "repeat_s": every}})
        return document
    return at_load


def gate(cargo, width, opening, speed=0.4):
    """The outlet of a plate is shut for half of the time."""
    def at_load(load):
        x, begin, across = 2.4, 1.2, width - opening
        tip = begin + across / math.tan(math.radians(60))
        document = line(x, width, cargo, [{"velocity_m_s": [speed, 0]}], [[(begin, 0), (tip, across)]],
                        [feed("west", (0, width), load * packed(cargo, opening, speed) / 2, cargo)], 24.0, 64.0)
        document["obstacles"].append({"path_m": place([(tip, across), (tip, width)]),
                                      "present": {"t_s": [0, 4], "value": [True, False], "repeat_s": 8}})
        return document
    return at_load


def sorter(load):
    """Cans go to the left and jars to the right of a diverter that an eye turns, as in the ready scenario."""
    kinds = [{"id": "can", "goods": "can-330"}, {"id": "jar", "goods": "jar-440"}]
    turn = [{"when": {"photo_eye": "camera", "state": "blocked", "kind": kind}, "delay_s": 1.076,
             "do": {"obstacle": "diverter", "turn_deg": angle, "over_s": 0.2}} for kind, angle in (("can", 28), ("jar", -28))]
    document = line(2.0, 0.4, kinds, [{"velocity_m_s": [0.4, 0]}], [[(1.2, 0.2), (2.0, 0.2)]],
                    [{"edge": "west", "y_m": [0.19, 0.21], "arrivals": "regular", "rate_per_s": load}], 8.0, 90.0,
                    photo_eyes=[{"id": "camera", "line_m": [[0.5, 0.02], [0.5, 0.38]]}], actions=turn,
                    contacts={"cargo_cargo": {"friction": 0.26}, "conveyor_cargo": {"friction": 0.24},
                              "handling_cargo": {"friction": 0.26}},
                    sinks=[{"id": f"{kind}-{side}", "kinds": [kind], "polygon_m": box(1.85, 2.0, *y)}
                           for side, y in (("left", (0.2, 0.4)), ("right", (0, 0.2))) for kind in ("can", "jar")])
    document["obstacles"].insert(0, {"id": "diverter", "path_m": [[1.04, 0.2], [1.2, 0.2]],
                                     "motion": {"pivot_m": [1.2, 0.2], "t_s": [0], "turn_deg": [28]}})
    return document


def slope(load):
    opening = dict(incline=10, belt=0.5, angle=60, opening=5.5)
    return Line("equipment", "slope", load=load, **opening).document(0)


def path_s(load):
    plate = dict(layout="plate", angle=60, opening=5.5) if load > 1 else dict(layout="none", opening=14.0)
    return Line("equipment", "path", bend=45, d=0.41, belt=0.5, load=load, **plate).document(0)


def zones(cargo, width, length=0.3, speed=0.4):
    """Five zones of a line in single file: each waits while its successor's eye is blocked; the last one stops by the clock."""
    def at_load(load):
        ids, at = [f"zone-{k + 1}" for k in range(5)], 0.04  # the eyes before the ends
        ramps = {"acceleration_m_s2": 4, "deceleration_m_s2": 4}
        belts = [{"id": name, "velocity_m_s": [speed, 0], **ramps,
                  "polygon_m": box(k * length, (k + 1) * length, 0, width)} for k, name in enumerate(ids)]
        belts[-1]["breaks"] = [{"start_s": 12, "every_s": 24, "duration_s": 8}]
        eyes = [{"id": f"eye-{k}", "line_m": place([((k + 1) * length - at, 0.01), ((k + 1) * length - at, width - 0.01)]),
                 "block_time_s": 0.3} for k in range(1, 5)]
        actions = [{"when": {"photo_eye": f"eye-{k}", "state": state}, "do": {"belt": ids[k - 1], "factor": factor}}
                   for k in range(1, 5) for state, factor in (("blocked", 0), ("clear", 1))]
        one = 2 * RADIUS[cargo["goods"]]
        return line(5 * length, width, cargo, belts, [], [feed("west", (0, width), load * speed / one, cargo)], 24.0, 96.0,
                    photo_eyes=eyes, actions=actions)
    return at_load


def rollers(cargo, width, speed=0.4):
    """Rollers that are skewed by 15 degrees bring the goods to a rail."""
    def at_load(load):
        to = [round(speed * math.cos(math.radians(15)), 6), round(speed * math.sin(math.radians(15)), 6)]
        return line(2.4, width, cargo, [{"velocity_m_s": to}], [],
                    [feed("west", (0, width), load * packed(cargo, width, to[0]), cargo)], 15.0, 40.0,
                    edges={"west": "inflow", "east": "outflow", "south": "wall", "north": "wall"})
    return at_load


def merge_in_turn(cargo, width, speed=0.4):
    """Two lanes let go one part each in turn, into a taper."""
    def at_load(load):
        gap, end, x, taper = 0.04, 0.6, 1.6, 0.2
        y = 2 * width + gap
        low, high = (y - 1.3 * width) / 2, (y + 1.3 * width) / 2
        rails = [[(0, y), (end, y), (end + taper, high), (x, high)], [(0, width + gap), (end, width + gap)],
                 [(0, width), (end, width)], [(0, 0), (end, 0), (end + taper, low), (x, low)]]
        belts = [{"id": "right", "velocity_m_s": [speed, 0], "polygon_m": box(0, end, 0, width)},
                 {"id": "left", "velocity_m_s": [speed, 0], "polygon_m": box(0, end, width + gap, y)},
                 {"velocity_m_s": [1.3 * speed, 0],
                  "polygon_m": place([(end, 0), (end + taper, low), (x, low), (x, high), (end + taper, high), (end, y)])}]
        feeds = [feed("west", (0, width), load, cargo), feed("west", (width + gap, y), load, cargo, id="other")]
        eyes = [{"id": f"eye-{name}", "line_m": place([(end - 0.02, at), (end - 0.02, at + width)])}
                for name, at in (("right", 0), ("left", width + gap))]
        lanes = [{"belt": name, "photo_eye": f"eye-{name}"} for name in ("left", "right")]
        return line(x, y, cargo, belts, rails, feeds, 20.0, 80.0, photo_eyes=eyes,
                    merges=[{"id": "merge", "lanes": lanes, "gap_s": 0.2}])
    return at_load


def scenes():
    return [
        Scene("curve of 90 degrees, free, inner radius 0.75 widths", curve(KEG, 1.6, 1.2, straight=1.6), (0.3, 0.65)),
        Scene("curve of 90 degrees, a plate of 60 degrees behind it", curve(CAN, 0.5, 0.4, opening=0.33), (0.5, 1.15)),
        Scene("path along an S of 45 degrees; saturated a plate", path_s, (0.4, 1.4)),
        Scene("merge of a lane at 45 degrees", merge_45(CAN, 0.4), (0.4, 1.4)),
        Scene("spur with a pusher", spur(CAN, 0.3), (0.15, 0.6), ("line.taken", "spur.taken")),
        Scene("gate in the outlet of a plate, open half of the time", gate(CAN, 0.5, 0.33), (0.5, 1.4)),
        Scene("sorter of two kinds", sorter, (0.7, 1.4),
              tuple(f"{kind}-{side}.taken" for side in ("left", "right") for kind in ("can", "jar"))),
        Scene("slope of 10 degrees with a plate of 60 degrees", slope, (0.5, 1.4)),
        Scene("five zones in single file, the last one stops for 8 of 24 s", zones(CAN, 0.072), (0.2, 0.8)),
        Scene("rollers skewed by 15 degrees", rollers(CAN, 0.4), (0.2, 0.6)),
        Scene("merge of two lanes in turn, part by part", merge_in_turn(CAN, 0.072), (0.5, 2.0)),
        Scene("half a turn onto a belt of 0.6 times its speed", u_turn(CAN, 0.3, 0.3), (0.5, 1.3), ("out.taken",)),
    ]


def smoothed(contents):
    """Means over some seconds: parts are whole."""
    sums = [0.0, *itertools.accumulate(contents)]
    return [(high - low) / SMOOTHING for low, high in zip(sums, sums[SMOOTHING:])]


def compare(program, scene, load, substreams):
    documents = [scene.document(load, k) for k in range(substreams)]
    warm_up = documents[0]["warmup_s"]
    micro = [program.solve("micro", document) for document in documents]
    macro = [program.solve("macro", document) for document in documents]  # kinds are those of the substream, too
    parts, density = ([statistics.mean(rate(run.folder, warm_up, (column,)) for run in runs) for column in scene.flows]
                      for runs in (micro, macro))
    more = sum(density) - sum(parts)
    elsewhere = (sum(abs(a - b) for a, b in zip(density, parts)) - abs(more)) / 2
    off = abs(more) + elsewhere
    mean, other = (smoothed([statistics.mean(values) for values in zip(*[run.curve.upstream for run in runs])])
                   for runs in (micro, macro))
    gap = statistics.mean(abs(a - b) for a, b in zip(mean, other)) / max(mean)
    sign = "" if elsewhere > abs(more) else "-" if more < 0 else "+"
    return {"micro": sum(parts), "macro": sum(density), "off": off / sum(parts) if sum(parts) > 0 else math.inf, "sign": sign,
            "gap": gap}


def main():
    options = options_of(__doc__, "words of the scenes' names", 2)
    program = Program(options.program, options.out / "runs", has_snapshots=True)
    chosen = [(scene, load, word) for scene in scenes() for load, word in zip(scene.loads, ("light", "saturated"))
              if not options.names or any(name in scene.name for name in options.names)]
    n_beyond = 0
    verdicts = values_of(options.program.parent.parent / "validation/scene_values", "validity",
                         [scene.document(load, 0) for scene, load, _ in chosen])
    print("| scene | load | parts/s | density | off | contents | validity |\n|---|---|---|---|---|---|---|")
    with ThreadPoolExecutor(options.jobs) as pool:
        runs = [pool.submit(compare, program, scene, load, options.substreams) for scene, load, _ in chosen]
        for (scene, _, word), run, verdict in zip(chosen, runs, verdicts):
            try:
                of = run.result()
            except Failed as failure:
                print(f"{scene.name}, {word}, failed: {failure}", file=sys.stderr, flush=True)
                n_beyond += 1
                continue
            is_beyond = of["off"] > MOST_OFF or of["gap"] > MOST_GAP
            n_beyond += is_beyond
            print(f"| {scene.name} | {word} | {of['micro']:.3f} | {of['macro']:.3f} | {of['sign']}{100 * of['off']:.1f} % | "
                  f"{100 * of['gap']:.1f} %{' *' if is_beyond else ''} | {verdict} |", flush=True)
    sys.exit(n_beyond > 0)


if __name__ == "__main__":
    main()
