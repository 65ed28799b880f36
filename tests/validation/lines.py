#!/usr/bin/env python3
"""Fed lines of any goods in both models at their defaults: the rate of the density next to that of the parts.

Lengths are in diameters d of the parts, times in d/v, v the speed of the belt, so that a row says what is the same for
pills and for drums. Constants of the closure `congested` are chosen by the rows `development` alone; the rows `apart`
are drawn at random, but for those of belts that run backwards and of paths, and nothing is fitted to them.
"""

import math
import random
import statistics
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from fed import options_of, rate, read_column
from solver import Failed, Program

MOST_OFF, MOST_MEAN = 0.08, 0.04
WIDTH, LENGTH = 14.0, 40.0  # of a belt, d
WARM_UP, MEASURED = 60.0, 140.0  # d/v
# Contacts of boxes take some ten times as long as those of cylinders: a narrow belt and a short queue.
BESIDE_BOXES, WARM_UP_OF_BOXES, MEASURED_OF_BOXES = 5.5, 30.0, 90.0
BOXES = {"d": 0.3, "foot": 7.0, "load": 1.0}
HEIGHT = 0.8  # of a part, d
MASS = 900.0  # kg/m3: the rates of hard parts do not depend on it


@dataclass
class Line:
    set: str
    group: str
    layout: str = "plate"
    d: float = 0.066  # diameter of a part, m
    v: float = 0.4  # m/s
    angle: float = 60.0  # of the plates to the belt, degrees
    opening: float = 5.5  # d
    load: float = 1.4  # parts offered, of d/v for each d of the opening
    parts: float = 0.15  # friction of parts on each other
    plates: float = 0.19  # on plates and walls
    belt: float = 1.0
    sizes: tuple = (1.0,)  # of the kinds, d, in equal numbers
    box: float = 0.0  # length over width of boxes with the footprint of a cylinder of the diameter d, 0: cylinders
    turned: float = 0.0  # of the belt, degrees
    bend: float = 0.0  # by which the belt goes aside before the plates, along a path, and back, degrees
    foot: float = 20.0  # of belt upstream of the plates, d
    ratio: float = 1.0  # speed of the second belt to that of the first
    incline: float = 0.0  # of the belt, degrees
    stagger: float = 0.0  # by which the end of the second plate of "staggered" is farther down the belt, d
    behind: float = 8.0  # of belt behind the plates, d
    ramp: tuple = ()  # from where to where it has that incline, d, between level belts; (): everywhere
    back: tuple = ()  # for how long the belt, or the one that takes cargo over, runs forward and back in turn, d/v; (): forward
    sinks: tuple = ()  # from where to where each is along the belt and across it, d, and its rate as `load`, 0: without limit
    ends: bool = False  # the belt does at a wall
    arrivals: str = ""  # "": regular below a load of 1, else at random

    @property
    def name(self):
        told = [f"{self.layout} {self.angle:g}, {self.opening:g} d", f"{1000 * self.d:g} mm", f"{self.v:g} m/s",
                f"{self.parts:g}/{self.plates:g}/{self.belt:g}"]
        if self.load != 1.4:
            told.append(f"load {self.load:g}")
        if self.box:
            told.append(f"boxes {self.box:g} : 1")
        if len(self.sizes) > 1:
            told.append("sizes " + ", ".join(f"{size:g}" for size in self.sizes))
        if self.foot != 20.0:
            told.append(f"foot {self.foot:g}")
        if self.turned:
            told.append(f"turned {self.turned:g}")
        if self.bend:
            told.append(f"bend {self.bend:g}")
        if self.ratio != 1.0:
            told.append(f"ratio {self.ratio:g}")
        if self.stagger:
            told.append(f"stagger {self.stagger:g}")
        if self.behind != 8.0:
            told.append(f"behind {self.behind:g}")
        if self.incline:
            told.append(f"incline {self.incline:g}" + (f" from {self.ramp[0]:g} to {self.ramp[1]:g}" if self.ramp else ""))
        if self.back:
            told.append(f"forward {self.back[0]:g}, back {self.back[1]:g}")
        for s_0, s_1, e_0, e_1, rate in self.sinks:
            told.append(f"sink {s_0:g} to {s_1:g} by {e_0:g} to {e_1:g}" + (f" at {rate:g}" if rate else ""))
        told += [text for text, is_so in (("wall", self.ends), (self.arrivals, self.arrivals)) if is_so]
        return "; ".join(told)

    @property
    def width(self):
        return self.opening + BESIDE_BOXES if self.box else WIDTH

    def cargo(self):
        kinds = []
        for size in self.sizes:
            d = size * self.d
            shape = {"type": "cylinder", "radius_m": d / 2, "height_m": HEIGHT * d}
            volume = math.pi / 4 * d * d * HEIGHT * d
            if self.box:
                width = round(math.sqrt(math.pi / 4 / self.box), 4) * d
                length = round(math.sqrt(math.pi / 4 * self.box), 4) * d
                shape = {"type": "box", "length_m": length, "width_m": width, "height_m": HEIGHT * width}
                volume = length * width * HEIGHT * width
            kinds.append({"shape": shape, "mass_kg": MASS * volume})
        return kinds if len(kinds) > 1 else kinds[0]

    def plates_of(self, foot):
        """Paths of the plates in the frame of the belt, in d: s along it, e across it."""
        slope = 1.0 / math.tan(math.radians(self.angle))
        across = self.width - self.opening
        if self.layout == "plate":
            return [[(foot, 0.0), (foot + across * slope, across)]]
        if self.layout == "funnel":
            tip = foot + across / 2 * slope
            return [[(foot, 0.0), (tip, across / 2)], [(foot, self.width), (tip, self.width - across / 2)]]
        if self.layout == "staggered":  # of which each leaves the opening to its own wall
            tip = foot + across * slope
            return [[(foot, 0.0), (tip, across)],
                    [(foot + self.stagger, self.width), (tip + self.stagger, self.width - across)]]
        if self.layout == "free":
            gap = self.opening / 2
            return [[(foot, gap), (foot + across * slope, self.width - gap)]]
        if self.layout == "lane":  # guides that narrow the belt, and go on along it
            tip = foot + across / 2 * slope
            return [[(foot, 0.0), (tip, across / 2), (tip + 12.0, across / 2)],
                    [(foot, self.width), (tip, self.width - across / 2), (tip + 12.0, self.width - across / 2)]]
        if self.layout == "rail":  # one guide, with the other wall
            tip = foot + across * slope
            return [[(foot, 0.0), (tip, across), (tip + 12.0, across)]]
        return []

    def document(self, substream):
        d, v, unit = self.d, self.v, self.d / self.v
        foot = self.foot
        paths = self.plates_of(foot)
        ends = [s for path in paths for s, _ in path]
        length = (max(ends) if self.behind != 8.0 else max(ends + [0.0 if self.box else LENGTH - 8.0])) + self.behind
        warm_up, measured = (WARM_UP_OF_BOXES, MEASURED_OF_BOXES) if self.box else (WARM_UP, MEASURED)
        warm_up += 60.0 if self.bend else 0.0  # until cargo has come along the path
        placed = self.shuttle() if self.layout == "shuttle" else self.transfer(length) if self.layout == "transfer" else (
            self.along_path(paths, length) if self.bend else
            self.oblique(paths, length) if self.turned else self.straight(paths, length))
        if self.back:
            placed["belts"][-1].update(self.turns(warm_up + measured))
        arrivals = self.arrivals or ("regular" if self.load < 1.0 else "poisson")
        if self.sinks:
            placed["sinks"] = [self.sink(*of) for of in self.sinks]
        if self.ends:
            placed["edges"] = {"east": "wall"}
        feed = {"arrivals": arrivals, "rate_per_s": round(self.load * self.opening * v / d, 5), **placed.pop("feed")}
        return {
            "name": self.name, "duration_s": round((warm_up + measured) * unit, 4),
            "warmup_s": round(warm_up * unit, 4), "substream": substream, **placed, "feeds": [feed],
            "cargo": self.cargo(),
            "contacts": {"cargo_cargo": {"friction": self.parts}, "handling_cargo": {"friction": self.plates},
                         "conveyor_cargo": {"friction": self.belt}},
            "output": {"curve_every_s": round(unit, 5), "snapshot_every_s": round(40 * unit, 5)},
        }

    def sink(self, s_0, s_1, e_0, e_1, of):
        """Where goods are taken off the belt."""
        limit = {"rate_per_s": round(of * self.opening * self.v / self.d, 5)} if of else {}
        return {"polygon_m": self.scaled([(s_0, e_0), (s_1, e_0), (s_1, e_1), (s_0, e_1)]), **limit}

    def turns(self, until):
        """What lets a belt run back for a while again and again."""
        forward, back = self.back
        starts = range(math.ceil(until / (forward + back)))
        times = [k * (forward + back) + t for k in starts for t in (forward, forward + back)]
        return {"acceleration_m_s2": 1, "deceleration_m_s2": 1,
                "speed_schedule": {"t_s": [round(t * self.d / self.v, 5) for t in times], "factor": [-1, 1] * len(starts)}}

    def scaled(self, path):
        return [[round(s * self.d, 9), round(e * self.d, 9)] for s, e in path]

    def straight(self, paths, length):
        d = self.d
        belts = [{"velocity_m_s": [self.v, 0.0]}]
        slope = {"velocity_m_s": [self.v, 0.0], "incline_deg": self.incline}
        if self.ramp:
            low, high, width = round(self.ramp[0] * d, 6), round(self.ramp[1] * d, 6), self.width * d
            belts.append({**slope, "polygon_m": [[low, 0], [high, 0], [high, width], [low, width]]})
        elif self.incline:
            belts = [slope]
        if self.ratio != 1.0:
            at = round(0.6 * length * d, 6)
            belts.append({"velocity_m_s": [self.ratio * self.v, 0.0],
                          "polygon_m": [[at, 0], [length * d, 0], [length * d, self.width * d], [at, self.width * d]]})
        return {"domain": {"x_m": [0, length * d], "y_m": [0, self.width * d]}, "belts": belts,
                "obstacles": [{"path_m": self.scaled(path)} for path in paths], "feed": {"edge": "west"}}

    def oblique(self, paths, length):
        d = self.d
        cos, sin = math.cos(math.radians(self.turned)), math.sin(math.radians(self.turned))
        margin = 1.0

        def turned(place):
            s, e = place
            return [(margin + self.width * sin + s * cos - e * sin) * d, (margin + s * sin + e * cos) * d]

        corners = [turned((s, e)) for s in (0.0, length) for e in (0.0, self.width)]
        guides = [[(0.0, 0.0), (length, 0.0)], [(length, self.width), (0.0, self.width)]]
        return {
            "domain": {"x_m": [0, max(x for x, _ in corners) + margin * d],
                       "y_m": [0, max(y for _, y in corners) + margin * d]},
            "edges": {side: "outflow" for side in ("west", "east", "south", "north")},
            "belts": [{"velocity_m_s": [self.v * cos, self.v * sin]}],
            "obstacles": [{"path_m": [turned(place) for place in path]} for path in guides + paths],
            "feed": {"line_m": [turned((1.5, 1.0)), turned((1.5, self.width - 1.0))]},
        }

    def along_path(self, paths, length):
        """An S between rails, which are in pieces of 5 degrees on its arcs; the plates stand on its last straight."""
        d, w, bend, radius, before = self.d, self.width, math.radians(self.bend), 1.2 * self.width, 6.0
        cut, cos, sin = radius * math.tan(bend / 2), math.cos(bend), math.sin(bend)
        slant = before + 2 * cut
        first = (before + cut, w / 2)
        second = (first[0] + slant * cos, first[1] + slant * sin)
        corners = [(0.0, w / 2), first, second, (second[0] + cut + length, second[1])]
        start = second[0] + cut

        def rail(side):
            places, n = [(0.0, w / 2 + side * w / 2)], math.ceil(self.bend / 5)
            for (x, y), inner, turn in (((before, w / 2 + radius), -side, 1), ((start, second[1] - radius), side, -1)):
                r = radius + inner * w / 2
                for k in range(n + 1):
                    to = bend * (k if turn > 0 else n - k) / n
                    places.append((x + turn * r * math.sin(to), y - turn * r * math.cos(to)))
            return places + [(start + length, second[1] + side * w / 2)]

        moved = [[(start + s, second[1] - w / 2 + e) for s, e in path] for path in paths]
        return {
            "domain": {"x_m": [0, (start + length) * d], "y_m": [-d, (second[1] + w / 2 + 1) * d]},
            "belts": [{"velocity_m_s": [self.v, 0],
                       "path": {"points_m": self.scaled(corners), "radius_m": [radius * d] * 2, "width_m": w * d}}],
            "obstacles": [{"path_m": self.scaled(path)} for path in [rail(1), rail(-1)] + moved],
            "feed": {"edge": "west", "y_m": [round(0.6 * d, 6), round((w - 0.6) * d, 6)]},
        }

    def transfer(self, length):
        """A belt of the width `opening` onto another one of the same width at a right angle."""
        d, w, at = self.d, self.opening, 24.0
        east, north = at + w, w + 20.0
        return {
            "domain": {"x_m": [0, east * d], "y_m": [0, north * d]},
            "edges": {"west": "inflow", "east": "wall", "south": "wall", "north": "outflow"},
            "belts": [{"velocity_m_s": [self.v, 0], "polygon_m": self.scaled([(0, 0), (at, 0), (at, w), (0, w)])},
                      {"velocity_m_s": [0, self.ratio * self.v],
                       "polygon_m": self.scaled([(at, 0), (east, 0), (east, north), (at, north)])}],
            "obstacles": [{"path_m": self.scaled([(at, w), (0, w)])}],
            "feed": {"edge": "west", "y_m": [round(0.5 * d, 6), round((w - 0.5) * d, 6)]},
        }

    def shuttle(self):
        """A belt of the width `opening` onto the middle of another one, which hands on to either end; rails beside both."""
        d, w, at = self.d, self.opening, 10.0
        east, low, high, rail = at + w, at, at + w, 0.05
        rails = [[(0, high + rail), (at - rail, high + rail), (at - rail, high + at)],
                 [(0, low - rail), (at - rail, low - rail), (at - rail, 0)]]
        return {
            "domain": {"x_m": [0, east * d], "y_m": [0, (high + at) * d]},
            "edges": {"west": "inflow", "east": "wall", "south": "outflow", "north": "outflow"},
            "belts": [{"velocity_m_s": [self.v, 0], "polygon_m": self.scaled([(0, low), (at, low), (at, high), (0, high)])},
                      {"velocity_m_s": [0, self.ratio * self.v],
                       "polygon_m": self.scaled([(at, 0), (east, 0), (east, high + at), (at, high + at)])}],
            "obstacles": [{"path_m": self.scaled(path)} for path in rails],
            "feed": {"edge": "west", "y_m": [round((low + 0.6) * d, 6), round((high - 0.6) * d, 6)]},
        }


def development():
    """The rows that constants were fitted to, by group; to `staggered` and `end` nothing was."""
    groups = {
        "plate": [dict(angle=a, opening=o, d=d) for a, o, d in (
            (30, 5.5, .066), (45, 4, .024), (45, 7, .2), (60, 3.5, .41), (60, 5.5, .066), (60, 8, .01), (75, 4.5, .066),
            (75, 7, .3), (90, 5, .041), (90, 8, .066), (50, 6, .6), (37, 5, .085))],
        "friction": [dict(parts=p, plates=h, belt=b, angle=a, opening=o) for p, h, b, a, o in (
            (.15, 0, 1, 60, 5.5), (.15, .1, 1, 60, 5.5), (.15, .4, 1, 60, 5.5), (.15, .8, 1, 60, 5.5), (.5, .19, 1, 60, 5.5),
            (.8, .5, 1, 60, 5.5), (.3, .3, .3, 60, 5.5), (.15, .19, .2, 60, 5.5), (.3, .2, .5, 45, 5.5),
            (.2, .35, .25, 75, 5.5), (.4, .4, .4, 45, 5.5), (.1, .3, .6, 90, 5.5), (.25, .12, .15, 75, 5.5),
            (0, 0, 1, 75, 5.5), (.5, .19, 1, 60, 4), (.5, .19, 1, 60, 9), (.5, .19, 1, 90, 5.5), (.3, .19, 1, 75, 7),
            (.3, .19, 1, 60, 5.5), (.8, .19, 1, 60, 8), (.5, .19, 1, 45, 5.5), (.4, .19, 1, 30, 6), (.05, .19, 1, 60, 6),
            (.05, .19, 1, 45, 8))],
        "speed": [dict(v=v, d=d, angle=a, opening=o) for v, d, a, o in (
            (.1, .066, 60, 5.5), (.2, .024, 60, 5.5), (.8, .066, 60, 5.5), (1.2, .1, 60, 5.5), (2, .066, 60, 5.5),
            (.15, .41, 60, 5.5), (.6, .3, 60, 5.5), (1, .024, 60, 5.5), (2, .066, 60, 4), (2, .066, 60, 9),
            (1.5, .066, 75, 6), (2, .066, 90, 6))],
        "fast": [dict(v=v, layout=l, angle=a, opening=o, belt=b, d=d) for v, l, a, o, b, d in (
            (2.5, "plate", 60, 5.5, 1, .066), (3.5, "plate", 60, 5.5, 1, .066), (5, "plate", 60, 5.5, 1, .066),
            (10, "plate", 60, 5.5, 1, .066), (3.5, "plate", 60, 9, 1, .066), (3, "plate", 90, 7, 1, .066),
            (1.5, "plate", 45, 7, .2, .066), (4, "funnel", 60, 7, 1, .066), (2, "plate", 60, 8, 1, .024))],
        "funnel": [dict(layout="funnel", angle=a, opening=o, parts=p, plates=h, v=v) for a, o, p, h, v in (
            (30, 6, .15, .19, .4), (45, 5, .15, .19, .4), (45, 8, .15, .19, .4), (60, 6, .15, .19, .4), (60, 9, .15, .19, .4),
            (70, 7, .15, .19, .4), (75, 5.5, .15, .19, .4), (80, 5.5, .15, .19, .4), (90, 6, .15, .19, .4),
            (90, 9, .15, .19, .4), (60, 6, .5, .19, .4), (75, 7, .4, .3, .4), (60, 6, .15, .19, 2), (80, 8, .15, .19, 1.2),
            (80, 8, .15, 0, .4), (80, 8, .15, .5, .4))],
        "queue": [dict(layout=l, angle=a, opening=o, foot=f, load=q, parts=p, d=d) for l, a, o, f, q, p, d in (
            ("plate", 60, 5.5, 8, 2.3, .15, .066), ("plate", 60, 5.5, 40, 2.3, .15, .066),
            ("funnel", 75, 7, 8, 1.9, .15, .066), ("funnel", 75, 7, 40, 1.9, .15, .066),
            ("plate", 60, 5.5, 40, 2.3, .5, .066), ("plate", 90, 7, 40, 1.9, .15, .024),
            ("plate", 60, 5.5, 40, 2.3, .15, .024), ("plate", 75, 5.5, 40, 2.3, .3, .2),
            ("funnel", 60, 7, 40, 1.9, .5, .066), ("plate", 45, 5.5, 40, 2.3, .15, .066))],
        "light": [dict(load=q, angle=a) for q, a in ((.4, 60), (.7, 60), (.85, 60), (.6, 45), (.9, 75), (.5, 90))],
        "free": [dict(layout="free", angle=a, opening=o) for a, o in ((60, 8), (45, 7))],
        "turned": [dict(turned=t, angle=a) for t, a in ((30, 60), (45, 60), (20, 75), (60, 45))],
        "lane": [dict(layout="lane", angle=a, opening=o, plates=h) for a, o, h in (
            (20, 4, .19), (15, 6, .3), (30, 5, .1), (30, 3.5, .3))]
        + [dict(layout="lane", angle=a, opening=o, v=.3) for a in (20, 45, 75) for o in (4.3, 5.2, 6.4, 8)]
        + [dict(layout="lane", angle=45, opening=5.2, v=.3, parts=p, plates=h) for p, h in (
            (.15, 0), (.15, .45), (.05, .19), (.45, .19))]
        + [dict(layout="lane", angle=45, opening=5.2, v=v) for v in (.1, .9)],
        "belts": [dict(layout="none", opening=WIDTH, load=q, ratio=r) for q, r in ((.55, .5), (.4, .6))]
        + [dict(ratio=1.6), dict(ratio=.7)],
        "transfer": [dict(layout="transfer", opening=10, load=q, ratio=r) for q, r in ((.4, 1), (.6, 1), (.8, .8), (1, 1))],
        "mix": [dict(sizes=z, angle=a) for z, a in (((1, 1.5), 60), ((.7, 1), 60), ((1, 1.3, 1.8), 60), ((.8, 1.2), 75))],
        "staggered": [dict(layout="staggered", angle=a, opening=o, stagger=t) for a, o, t in (
            (45, 5, 14), (60, 5, 10), (60, 5, 14), (60, 9, 4), (60, 9, 8), (75, 5, 10), (75, 5, 14), (75, 9, 8), (90, 5, 10),
            (90, 5, 14), (60, 10, 1.5), (60, 10, 3), (75, 10, 3), (90, 10, 3))],
        "end": [dict(angle=a, opening=o, behind=t) for a, o, t in (
            (45, 6, 1), (45, 6, 2), (45, 6, 4), (60, 5, 1), (60, 5, 4), (75, 5, 1), (75, 5, 4), (75, 5, 6))],
        "slope": [dict(incline=i, angle=a, opening=o, belt=b) for i, a, o, b in (
            (10, 60, 5.5, .3), (-10, 60, 5.5, .3), (5, 75, 7, .25), (-12, 90, 6, .4), (15, 45, 5.5, .5), (-8, 45, 5, .3),
            (10, 60, 5.5, 1))]
        + [dict(incline=i, layout="funnel", angle=75, opening=7, belt=.35) for i in (10, -10)]
        + [dict(incline=i, ramp=(8, 16), belt=.3) for i in (10, -10)],
        "box": [dict(box=b, opening=o, angle=a, **BOXES) for b, o, a in (
            (1.33, 5.5, 60), (1.33, 4, 60), (1.33, 8, 60), (1, 5.5, 60), (2.5, 5.5, 60), (1.33, 5.5, 90), (1.33, 5.5, 45),
            (1.33, 3.2, 60), (1.33, 2.6, 60), (1.33, 3.2, 90), (1.33, 3.4, 45), (1, 3.2, 60), (2.5, 4.2, 60), (2, 6, 45),
            (1.33, 5, 75), (1.33, 8, 45), (1.5, 6, 30))]
        + [dict(box=1.33, opening=5.5, angle=a, parts=p, plates=h, **BOXES) for a, p, h in (
            (60, .5, .19), (60, .15, .5), (45, .4, .3))]
        + [dict(box=b, layout="funnel", opening=o, angle=a, parts=p, plates=h, **BOXES) for b, o, a, p, h in (
            (1.33, 6, 60, .15, .19), (1, 5, 45, .15, .19), (1.33, 5, 75, .4, .3), (1.33, 6, 90, .15, .19))]
        + [dict(box=1.33, opening=5.5, **{**BOXES, "foot": 20.0})],
    }
    return [Line("development", group, **row) for group, rows in groups.items() for row in rows]


def apart():
    """Rows drawn at random over what planners build; their seed was fixed before any of them was solved."""
    draw, made = random.Random(20141), []

    def between(low, high, digits=2):
        return round(draw.uniform(low, high), digits)

    def log_between(low, high):
        return float(f"{math.exp(draw.uniform(math.log(low), math.log(high))):.2g}")

    for layout, n in (("plate", 16), ("funnel", 6), ("free", 2), ("transfer", 3), ("mix", 3)):
        for _ in range(n):
            row = dict(layout="plate" if layout == "mix" else layout, angle=between(30, 90, 0), opening=between(3.5, 9, 1),
                       d=log_between(.01, .6), v=log_between(.1, 1.2), parts=between(.05, .8), plates=between(.05, .8),
                       belt=between(.2, 1), foot=between(8, 40, 0), load=1.4)
            if layout == "transfer":
                row.update(opening=between(6, 12, 1), load=between(.4, 1), ratio=between(.8, 1.4), angle=60, foot=20.0)
            if layout == "free":
                row.update(opening=between(7, 9, 1))
            if layout == "mix":
                row.update(sizes=(1.0, between(1.1, 2)))
            made.append(Line("apart", layout, **row))
    draw = random.Random(30)
    for _ in range(8):
        row = dict(box=between(1, 2.5), opening=between(3, 8.5, 1), angle=between(45, 90, 0), parts=between(.1, .6),
                   plates=between(.1, .5))
        made.append(Line("apart", "box", **row, **BOXES))
    draw = random.Random(20261128)
    for _ in range(10):
        box = draw.choice((1.0, 1.33, 1.5, 2.0))
        circle = math.sqrt(math.pi / 4.0 * (box + 1.0 / box))  # about a box, d
        row = dict(box=box, layout=draw.choice(("plate", "funnel")), opening=round(between(2.6, 5) * circle, 1),
                   angle=between(30, 75, 0), parts=between(.1, .6), plates=between(.1, .5))
        made.append(Line("apart", "box", **row, **BOXES))
    draw = random.Random(35)
    for _ in range(8):
        belt = between(.2, .8)
        steepest = 0.8 * math.degrees(math.atan(belt))
        made.append(Line("apart", "slope", layout=draw.choice(("plate", "funnel")), angle=between(40, 90, 0),
                         opening=between(4.5, 8, 1), d=log_between(.02, .4), v=between(.2, .8), parts=between(.1, .5),
                         plates=between(.1, .5), belt=belt, incline=round(draw.uniform(-1, 1) * min(steepest, 18), 1)))
    for seed, n in ((36, 12), (37, 9)):
        draw = random.Random(seed)
        for k in range(n):
            made.append(Line("apart", "lane", layout="rail" if k % 3 == 2 else "lane", angle=between(15, 85, 0),
                             opening=between(4, 9, 1), d=log_between(.02, .4), v=log_between(.1, 1.2), parts=between(.05, .6),
                             plates=between(.05, .5), belt=between(.3, .8)))
    made += [Line("apart", "reverse", back=back, **row) for back, row in (
        ((30, 5), dict(layout="none", opening=WIDTH, load=.4)), ((30, 5), dict()), ((30, 5), dict(d=.41)),
        ((30, 5), dict(load=.4)), ((20, 8), dict(layout="funnel", angle=75, opening=7)),
        ((40, 40), dict(layout="shuttle", opening=6, load=.3)), ((40, 40), dict(layout="shuttle", opening=6, load=.3, d=.41)),
        ((40, 40), dict(layout="shuttle", opening=6, load=.7)), ((40, 40), dict(layout="shuttle", opening=6, load=.7, d=.41)),
        ((30, 5), dict(box=1.33, opening=5.5, angle=60, **BOXES)))]
    half, across, wide = (20, 24, 0, WIDTH / 2, 0), (20, 24, 0, WIDTH), dict(layout="none", opening=WIDTH)
    boxes = dict(layout="none", box=1.33, **{**BOXES, "load": .4})
    made += [Line("apart", "sinks", **{**wide, **row}) for row in (
        dict(load=.4, sinks=(half,)), dict(load=.4, sinks=(half,), d=.41), dict(load=.4, sinks=((*across, .2),)),
        dict(load=.4, sinks=((*across, .2),), d=.41), dict(load=.4, sinks=((*across, .2),), arrivals="poisson"),
        dict(load=.4, sinks=((*across, .35),), arrivals="poisson"),
        dict(sinks=((36, 40, 0, WIDTH, .2),), ends=True, load=1), dict(sinks=((36, 40, 0, WIDTH, .2),), ends=True, load=1, d=.41),
        dict(sinks=((32, 36, 0, 7, 0),), ends=True, load=.7), dict(sinks=((32, 36, 0, 7, 0),), ends=True, load=.7, d=.41),
        dict(load=.4, sinks=((16, 18, 3, 8, 0), (20, 24, 0, 14, .1))),
        dict(sinks=((24, 28, 0, 6, .15), (34, 38, 6, 14, .3)), ends=True, load=.9),
        dict(layout="plate", opening=5.5, sinks=((14, 18, 0, 4, 0),)), dict(layout="plate", opening=5.5, sinks=((14, 18, 0, 4, 0),), d=.41),
        dict(boxes, opening=5.5, sinks=((4, 6, 0, 5.5, 0),)), dict(boxes, opening=5.5, sinks=((4, 6, 0, 11, .15),)),
        dict(boxes, opening=5.5, sinks=((6, 8, 0, 11, .15),), ends=True, load=.7))]
    made += [Line("apart", "path", bend=bend, **row) for bend, row in (
        (45, dict(layout="none", opening=WIDTH, load=.4)), (90, dict(layout="none", opening=WIDTH, load=.4)),
        (45, dict()), (90, dict()), (45, dict(d=.41)), (30, dict(angle=75, opening=7)), (60, dict(load=.7)),
        (45, dict(layout="funnel", angle=75, opening=7)), (45, dict(box=1.33, opening=5.5, angle=60, **BOXES)))]
    return made


def rows():
    return development() + apart()


def upstream(run):
    return [n for _, n in read_column(run.folder, "upstream")]


def compare(program, line, substreams):
    document = line.document(0)
    warm_up = document["warmup_s"]
    micro = [program.solve("micro", line.document(k)) for k in range(substreams)]
    macro = program.solve("macro", document)
    columns = [f"sink-{k + 1}.taken" for k in range(len(line.sinks))] or ["left_domain"]
    rates = [rate(run.folder, warm_up, columns) for run in micro]
    mean = [statistics.mean(values) for values in zip(*[upstream(run) for run in micro])]
    gap = statistics.mean(abs(a - b) for a, b in zip(mean, upstream(macro))) / max(mean)
    return {"micro": statistics.mean(rates), "spread": statistics.stdev(rates) if substreams > 1 else math.nan,
            "macro": rate(macro.folder, warm_up, columns), "gap": gap}


def main():
    options = options_of(__doc__, "development, apart, or groups", 2)
    program = Program(options.program, options.out / "runs")
    chosen = [row for row in rows() if not options.names or {row.set, row.group} & set(options.names)]
    errors = {"development": [], "apart": []}
    print(f"{'set':11} {'group':9} {'parts/s':>8} {'+-%':>5} {'density':>8} {'off %':>6} {'gap %':>5}  row")
    with ThreadPoolExecutor(options.jobs) as pool:
        runs = [pool.submit(compare, program, row, options.substreams) for row in chosen]
        for row, run in zip(chosen, runs):
            try:
                of = run.result()
            except Failed as failure:
                print(f"{row.set:11} {row.group:9} failed: {failure} {row.name}", flush=True)
                continue
            off = of["macro"] / of["micro"] - 1.0 if of["micro"] > 0 else math.inf
            errors[row.set].append(abs(off))
            print(f"{row.set:11} {row.group:9} {of['micro']:8.2f} {100 * of['spread'] / max(of['micro'], 1e-9):5.1f} "
                  f"{of['macro']:8.2f} {100 * off:6.1f} {100 * of['gap']:5.1f}  {row.name}"
                  f"{' *' if abs(off) > MOST_OFF else ''}", flush=True)
    for name, of in errors.items():
        if of:
            print(f"{name}: mean {100 * statistics.mean(of):.1f} %, largest {100 * max(of):.1f} %, "
                  f"{sum(e > MOST_OFF for e in of)} of {len(of)} beyond {100 * MOST_OFF:g} %")
    sys.exit(any(max(of) > MOST_OFF or statistics.mean(of) > MOST_MEAN for of in errors.values() if of))


if __name__ == "__main__":
    main()
