#!/usr/bin/env python3
"""Goods before a plate in the microscopic model: at its defaults, and with contacts 100 times as hard, or --harder N.

Each scene is a belt with a plate from its right side, fed with more parts than come through. What is asked: is the rate
that of parts 100 times as hard, within 3 %; is the largest overlap at most 5 % of a radius; is no part behind the plate.
The constants of core/micro/hardness.h and the steps in space were chosen with the set `development`; nothing is fitted to
the sets `apart` and `surfaces`. The latter has goods with their own frictions, on belts that they are conveyed on; the
others have the paper's.
"""

import ast
import json
import math
import statistics
import struct
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from fed import options_of
from solver import Failed, Program

MOST_OFF, MOST_OVERLAP = 0.03, 0.05


@dataclass
class Scene:
    group: str
    name: str
    shape: dict
    mass: float  # kg
    width: float  # of a part, m: lengths of the layout are multiples of it
    speed: float = 0.4  # of the belt, m/s
    angle: float = 60.0  # of the plate to the belt, degrees
    opening: float = 5.5  # widths
    across: float = 12.0  # width of the belt, widths
    along: float = 28.0  # its length, widths
    seconds: float = 60.0
    surface: str | None = None  # of the parts; None: the paper's frictions
    conveyor: str | None = None  # what the belt is made of

    @property
    def tip(self):
        return 0.75 * self.along * self.width, (self.across - self.opening) * self.width

    def document(self, substream):
        x, y = self.tip
        foot = x - y / math.tan(math.radians(self.angle))
        return {
            "name": self.name, "duration_s": self.seconds, "warmup_s": round(self.seconds / 4, 3),
            "substream": substream,
            "domain": {"x_m": [0, self.along * self.width], "y_m": [0, self.across * self.width]},
            "belts": [{"velocity_m_s": [self.speed, 0]}],
            "obstacles": [{"from_m": [foot, 0], "to_m": [x, y]}],
            "cargo": {"shape": self.shape, "mass_kg": self.mass, **({"surface": self.surface} if self.surface else {})},
            **({"surfaces": {"conveyor": self.conveyor}} if self.conveyor else {}),
            "feeds": [{"edge": "west", "arrivals": "poisson",
                       "rate_per_s": round(1.5 * self.opening * self.speed / self.width, 4)}],
            "output": {"curve_every_s": 0.1, "snapshot_every_s": self.seconds / 8},
        }

    def is_behind(self, x, y):
        """Whether a part is just behind the plate, far from its tip, where none comes that does not go through."""
        tip_x, tip_y = self.tip
        angle = math.radians(self.angle)
        along = (x - tip_x) * math.cos(angle) + (y - tip_y) * math.sin(angle)
        behind = (x - tip_x) * math.sin(angle) - (y - tip_y) * math.cos(angle)
        return 0.0 < behind < 0.5 * self.width and y > 0.0 and along < -2.0 * self.width


def cylinder(width, height):
    return {"type": "cylinder", "radius_m": width / 2, "height_m": height}


def box(length, width, height):
    return {"type": "box", "length_m": length, "width_m": width, "height_m": height}


HEXAGON = {"type": "prism", "height_m": 0.1,
           "outline_m": [[.06, 0], [.03, .052], [-.03, .052], [-.06, 0], [-.03, -.052], [.03, -.052]]}
# A belt fills within 10 s at the speeds of these, and few boxes pass in a second.
IN_SPACE = {"across": 9.0, "along": 14.0, "seconds": 80.0}

SCENES = [
    Scene("development", "can", cylinder(0.066, 0.115), 0.35, 0.066),
    Scene("development", "jar", cylinder(0.085, 0.12), 1.1, 0.085),
    Scene("development", "keg", cylinder(0.41, 0.4), 12.5, 0.41, speed=0.3, seconds=200.0),
    Scene("development", "heavy disk", cylinder(0.024, 0.008), 0.3, 0.024, seconds=30.0),
    Scene("development", "paper", cylinder(0.024, 0.008), 0.02841, 0.024, seconds=30.0),
    Scene("development", "can, 45 degrees", cylinder(0.066, 0.115), 0.35, 0.066, angle=45.0),
    Scene("development", "can, 90 degrees", cylinder(0.066, 0.115), 0.35, 0.066, angle=90.0),
    Scene("development", "can, 8 diameters", cylinder(0.066, 0.115), 0.35, 0.066, opening=8.0),
    Scene("development", "carton", box(0.24, 0.18, 0.12), 1.7, 0.24, 0.6, **IN_SPACE),
    Scene("development", "crate", box(0.6, 0.4, 0.3), 20.0, 0.6, **IN_SPACE),
    Scene("development", "hexagon", HEXAGON, 1.0, 0.12, **IN_SPACE),
    Scene("development", "long box", box(0.3, 0.06, 0.06), 0.8, 0.3, **IN_SPACE),
    Scene("apart", "pill box", cylinder(0.04, 0.03), 0.02, 0.04, speed=0.2),
    Scene("apart", "beer bottle", cylinder(0.061, 0.23), 0.56, 0.061, speed=0.6, opening=6.5),
    Scene("apart", "wine bottle", cylinder(0.076, 0.3), 1.3, 0.076, angle=70.0, opening=6.0),
    Scene("apart", "bucket", cylinder(0.3, 0.3), 14.8, 0.3, speed=0.5, seconds=120.0),
    Scene("apart", "drum", cylinder(0.58, 0.88), 220.0, 0.58, speed=0.2, seconds=300.0),
    Scene("apart", "coin", cylinder(0.02325, 0.0023), 0.0075, 0.02325, speed=0.3, seconds=30.0),
    Scene("apart", "can at 1 m/s", cylinder(0.066, 0.115), 0.35, 0.066, speed=1.0, seconds=30.0),
    Scene("apart", "can, 120 widths of belt", cylinder(0.066, 0.115), 0.35, 0.066, along=120.0, seconds=90.0),
    Scene("apart", "shoe box", box(0.33, 0.2, 0.12), 1.1, 0.33, 0.5, **IN_SPACE),
    Scene("apart", "tote", box(0.6, 0.4, 0.2), 8.0, 0.6, 0.8, **IN_SPACE),
    Scene("apart", "parcel", box(0.2, 0.2, 0.2), 3.0, 0.2, 0.5, **IN_SPACE),
    Scene("apart", "octagonal tub", {"type": "prism", "height_m": 0.06, "outline_m": [
        [0.05 * math.cos(math.radians(45 * k)), 0.05 * math.sin(math.radians(45 * k))] for k in range(8)]},
        0.25, 0.1, **IN_SPACE),
    Scene("surfaces", "can on acetal", cylinder(0.066, 0.115), 0.35, 0.066, surface="steel", conveyor="acetal"),
    Scene("surfaces", "can on acetal, 45 degrees", cylinder(0.066, 0.115), 0.35, 0.066, angle=45.0, opening=7.0,
          surface="steel", conveyor="acetal"),
    Scene("surfaces", "can on rubber", cylinder(0.066, 0.115), 0.35, 0.066, surface="steel", conveyor="rubber"),
    Scene("surfaces", "bottle on steel", cylinder(0.061, 0.23), 0.56, 0.061, speed=0.6, surface="glass", conveyor="steel"),
    Scene("surfaces", "jar on acetal, 75 degrees", cylinder(0.085, 0.12), 1.1, 0.085, angle=75.0, opening=8.0,
          surface="glass", conveyor="acetal"),
    Scene("surfaces", "PET bottle on acetal", cylinder(0.066, 0.2), 0.53, 0.066, speed=0.8, surface="pet", conveyor="acetal"),
    Scene("surfaces", "keg on steel", cylinder(0.41, 0.4), 12.5, 0.41, speed=0.3, seconds=200.0, surface="steel",
          conveyor="steel"),
    Scene("surfaces", "bucket on rubber, 90 degrees", cylinder(0.3, 0.3), 14.8, 0.3, speed=0.5, angle=90.0, opening=7.0,
          seconds=120.0, surface="pe", conveyor="rubber"),
]


def harder(document, reduction, times):
    """The same with contacts so many times as stiff as with this modulus_reduction, and no change on the way."""
    cargo, factor = dict(document["cargo"]), 1.0
    if reduction < times:  # materials are made harder, where reductions below 1 would be asked for
        factor = times / reduction
    cargo["material"] = {"young_modulus_pa": 210e9 * factor, "poisson_ratio": 0.28}
    return {**document, "cargo": cargo, "micro": {"modulus_reduction": max(reduction / times, 1.0)},
            "materials": {"handling": {"young_modulus_pa": 70e9 * factor, "poisson_ratio": 0.34}}}


def read_rows(path):
    """The rows of a NumPy file of numbers."""
    data = path.read_bytes()
    begin = 10 + struct.unpack_from("<H", data, 8)[0]
    header = ast.literal_eval(data[10:begin].decode())
    assert header["descr"] == "<f8" and not header["fortran_order"]
    n, columns = header["shape"]
    return [struct.unpack_from(f"<{columns}d", data, begin + 8 * columns * k) for k in range(n)]


def figures(scene, result):
    """Rate, parts/h; largest overlap, of a radius; parts behind the plate; the summary."""
    summary = json.loads((result.folder / "summary.json").read_text())
    behind = 0
    for table in sorted((result.folder / "parts").glob("*.npy")):
        behind += sum(scene.is_behind(row[2], row[3]) for row in read_rows(table))  # behind id and kind
    return summary["key_figures"]["throughput_per_h"], summary["largest_overlap_share"], behind, summary


def compare(program, scene, substreams, times):
    soft, hard, overlap, behind, cpu_s = [], [], 0.0, 0, []
    for k in range(substreams):
        document = scene.document(k)
        result = program.solve("micro", document)
        rate, share, n, summary = figures(scene, result)
        soft.append(rate)
        cpu_s.append(result.cpu_s)
        overlap, behind = max(overlap, share), behind + n
        result = program.solve("micro", harder(document, summary["modulus_reduction_start"], times))
        hard.append(figures(scene, result)[0])
    off = statistics.mean(soft) / statistics.mean(hard) - 1.0
    spread = statistics.stdev([a / b for a, b in zip(soft, hard)]) / math.sqrt(substreams) if substreams > 1 else math.nan
    return {"rate": statistics.mean(soft), "hard": statistics.mean(hard), "off": off, "spread": spread,
            "overlap": overlap, "behind": behind, "cpu_s": statistics.mean(cpu_s)}


def add_harder(parser):
    parser.add_argument("--harder", type=float, default=100.0, help="times as hard (default %(default)s)")


def main():
    options = options_of(__doc__, "development, apart, surfaces, or names of scenes", 3, add_harder)
    program = Program(options.program, options.out / "runs", has_snapshots=True)
    chosen = [s for s in SCENES if not options.names or s.group in options.names or s.name in options.names]
    missed = 0
    print(f"{'set':12} {'scene':24} {'parts/h':>9} {'harder':>9} {'off %':>6} {'+-':>5} {'overlap %':>9} {'behind':>6} "
          f"{'cpu s/s':>8}")
    with ThreadPoolExecutor(options.jobs) as pool:
        runs = [pool.submit(compare, program, scene, options.substreams, options.harder) for scene in chosen]
        for scene, run in zip(chosen, runs):
            try:
                of = run.result()
            except Failed as failure:
                missed += 1
                print(f"{scene.group:12} {scene.name:24} failed: {failure} *", flush=True)
                continue
            is_missed = abs(of["off"]) > MOST_OFF or of["overlap"] > MOST_OVERLAP or of["behind"] > 0
            missed += is_missed
            print(f"{scene.group:12} {scene.name:24} {of['rate']:9.0f} {of['hard']:9.0f} {100 * of['off']:6.2f} "
                  f"{100 * of['spread']:5.2f} {100 * of['overlap']:9.2f} {of['behind']:6d} {of['cpu_s']:8.3f}"
                  f"{' *' if is_missed else ''}", flush=True)
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
