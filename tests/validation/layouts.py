"""Scenario documents of the scenes, from a few parameters each.

A layout is given in the frame of a belt: s along it, from 0, and e across it, from 0 (its right side) to its width
(its left side), in m. `Belt` places it in the domain: where the belt runs along +x or +y, the sides of the domain
are its walls; in any other direction two thin plates are.

The heap is a hexagonal packing of the paper's cylinders. `moved` is by how much it is moved, in spacings along and
across the belt.
"""

import math
from dataclasses import dataclass

RADIUS_M = 0.012
DIAMETER_M = 2 * RADIUS_M
SPACING_M = 1.02 * DIAMETER_M
ROW_M = SPACING_M * math.sqrt(3) / 2  # between rows of the heap
CARGO = {"shape": {"type": "cylinder", "radius_m": RADIUS_M, "height_m": 0.008}, "mass_kg": 0.02841}
SPEED_M_S = 0.395
WIDTH_M = 0.6
HEAP_FIRST_M = 0.10  # s of the first part
HEAP_GAP_M = 0.055  # from the heap to where the first plate begins
BEYOND_M = 0.25  # of belt downstream of the counted region
NOT_MOVED = (0.0, 0.0)


def up_to_cm(length):
    """The length rounded up to whole centimetres, so that both grids fit."""
    return math.ceil(round(length * 100, 6)) / 100


def rounded(places):
    """Coordinates to a micrometre: documents are read by people, too."""
    return [[round(s, 6), round(e, 6)] for s, e in places]


@dataclass
class Heap:
    """`rows` along the belt with `columns` parts each, the first one at first_e; in the middle if that is None."""

    rows: int = 16
    columns: int = 40
    first_e: float = 0.11

    def __post_init__(self):
        if self.first_e is None:
            self.first_e = (WIDTH_M - (self.rows - 1) * ROW_M) / 2

    @property
    def end(self):
        return HEAP_FIRST_M + (self.columns + 0.5) * SPACING_M

    def first(self, moved):
        return HEAP_FIRST_M + moved[0] * SPACING_M, self.first_e + moved[1] * SPACING_M

    def packing(self, moved):
        """The member /initial of a belt along +x."""
        return {"hexagonal": {"rows": self.rows, "columns": self.columns, "spacing_m": round(SPACING_M, 6),
                              "first_m": rounded([self.first(moved)])[0]}}

    def places(self, moved):
        """(s, e) of every part, as the packing has them."""
        s, e = self.first(moved)
        return [(s + (column + row % 2 / 2) * SPACING_M, e + row * ROW_M)
                for row in range(self.rows) for column in range(self.columns)]


@dataclass
class Belt:
    """A belt with plates, and where their last end is: parts are counted upstream of there."""

    heap: Heap
    plates: list  # of lists of (s, e)
    exit_s: float
    duration_s: float
    speed: float = SPEED_M_S
    turned_deg: float = 0.0  # direction of the belt, counter-clockwise from +x
    next_belt: tuple = None  # (s, speed): from s on the belt has another speed

    def document(self, name, moved=NOT_MOVED):
        length = up_to_cm(self.exit_s + BEYOND_M)
        placed = {0.0: self._along_x, 90.0: self._along_y}.get(self.turned_deg, self._oblique)
        return {"name": name, "duration_s": self.duration_s, **placed(length, moved), "cargo": CARGO}

    def _along_x(self, length, moved):
        belts = [{"velocity_m_s": [self.speed, 0.0]}]
        if self.next_belt:
            at, speed = self.next_belt
            belts.append({"velocity_m_s": [speed, 0.0],
                          "polygon_m": [[at, 0.0], [length, 0.0], [length, WIDTH_M], [at, WIDTH_M]]})
        return {
            "domain": {"x_m": [0.0, length], "y_m": [0.0, WIDTH_M]},
            "edges": {"west": "inflow", "east": "outflow", "south": "wall", "north": "wall"},
            "belts": belts,
            "obstacles": [{"path_m": rounded(path)} for path in self.plates],
            "initial": self.heap.packing(moved),
            "counters": [{"id": "upstream", "x_m": [0.0, round(self.exit_s, 6)]}],
        }

    def _along_y(self, length, moved):
        def turned(place):
            return WIDTH_M - place[1], place[0]

        return {
            "domain": {"x_m": [0.0, WIDTH_M], "y_m": [0.0, length]},
            "edges": {"west": "wall", "east": "wall", "south": "inflow", "north": "outflow"},
            "belts": [{"velocity_m_s": [0.0, self.speed]}],
            "obstacles": [{"path_m": rounded(map(turned, path))} for path in self.plates],
            "initial": {"positions_m": rounded(map(turned, self.heap.places(moved)))},
            "counters": [{"id": "upstream", "y_m": [0.0, round(self.exit_s, 6)]}],
        }

    def _oblique(self, length, moved):
        cos, sin = math.cos(math.radians(self.turned_deg)), math.sin(math.radians(self.turned_deg))
        margin = 0.05

        def turned(place):
            s, e = place
            return margin + WIDTH_M * sin + s * cos - e * sin, margin + s * sin + e * cos

        # The left side of a plate along the belt counts as upstream: here the one that faces the cargo. That it runs
        # along the belt must hold to rounding errors, so these coordinates are not rounded.
        end = length - 0.1
        guides = [[(0.0, 0.0), (end, 0.0)], [(end, WIDTH_M), (0.0, WIDTH_M)]]
        corners = [turned((s, e)) for s in (0.0, length) for e in (0.0, WIDTH_M)]
        # All of the belt upstream of exit_s lies below the line y = const through its left side there.
        line = turned((self.exit_s, WIDTH_M))[1]
        return {
            "domain": {"x_m": [0.0, up_to_cm(max(x for x, _ in corners) + margin)],
                       "y_m": [0.0, up_to_cm(max(y for _, y in corners) + margin)]},
            "edges": {"west": "inflow", "east": "outflow", "south": "inflow", "north": "outflow"},
            "belts": [{"velocity_m_s": [self.speed * cos, self.speed * sin]}],
            "obstacles": [{"path_m": list(map(turned, path))} for path in guides + self.plates],
            "initial": {"positions_m": rounded(map(turned, self.heap.places(moved)))},
            "counters": [{"id": "upstream", "y_m": [0.0, round(line, 6)]}],
        }


@dataclass
class Transfer:
    """A belt along +x that ends at the side of another one along +y, which is `onto_width` wide."""

    heap: Heap
    onto_width: float
    duration_s: float

    def document(self, name, moved=NOT_MOVED):
        at = up_to_cm(self.heap.end + HEAP_GAP_M)
        east = round(at + self.onto_width, 6)
        line = round(WIDTH_M + 0.1, 6)
        north = up_to_cm(line + BEYOND_M)
        return {
            "name": name,
            "duration_s": self.duration_s,
            "domain": {"x_m": [0.0, east], "y_m": [0.0, north]},
            "edges": {"west": "inflow", "east": "wall", "south": "wall", "north": "outflow"},
            "belts": [
                {"velocity_m_s": [SPEED_M_S, 0.0],
                 "polygon_m": [[0.0, 0.0], [at, 0.0], [at, WIDTH_M], [0.0, WIDTH_M]]},
                {"velocity_m_s": [0.0, SPEED_M_S],
                 "polygon_m": [[at, 0.0], [east, 0.0], [east, north], [at, north]]},
            ],
            "obstacles": [{"path_m": [[at, WIDTH_M], [0.0, WIDTH_M]]}],
            "initial": self.heap.packing(moved),
            "counters": [{"id": "upstream", "y_m": [0.0, line]}],
            "cargo": CARGO,
        }


def run_of(across, angle):
    """How far a plate at `angle` degrees to the belt goes along it while it goes `across`."""
    return across / math.tan(math.radians(angle))


def single(angle, opening, duration_s, heap=Heap(), foot=None, is_from_left=False, **belt):
    """A straight plate from the right side of the belt to `opening` before the left one, or mirrored."""
    across = WIDTH_M - opening
    foot = heap.end + HEAP_GAP_M if foot is None else foot
    tip = foot + run_of(across, angle)
    plate = [(foot, 0.0), (tip, across)]
    if is_from_left:
        plate = [(s, WIDTH_M - e) for s, e in plate]
    return Belt(heap, [plate], tip, duration_s, **belt)


def example(angle, opening, duration_s, rows=16, columns=12):
    """As in ready Examples 1 and 2: the tip at s = 0.75 m, or further where the heap would begin on the plate."""
    heap = Heap(rows, columns)
    foot = max(0.461325 + (columns - 12) * SPACING_M, 0.75 - run_of(WIDTH_M - opening, angle))
    return single(angle, opening, duration_s, heap, foot)


def funnel(angle, opening, duration_s, foot=None):
    """Straight plates from both sides at the same angle, the opening in the middle."""
    heap = Heap(first_e=None)
    across = (WIDTH_M - opening) / 2
    foot = heap.end + HEAP_GAP_M if foot is None else foot
    tip = foot + run_of(across, angle)
    plates = [[(foot, 0.0), (tip, across)], [(foot, WIDTH_M), (tip, WIDTH_M - across)]]
    return Belt(heap, plates, tip, duration_s)


def bent(angle, then_angle, opening, duration_s):
    """A plate from the right side, bent half the way to the opening."""
    heap = Heap()
    half = (WIDTH_M - opening) / 2
    foot = heap.end + HEAP_GAP_M
    bend = foot + run_of(half, angle)
    tip = bend + run_of(half, then_angle)
    return Belt(heap, [[(foot, 0.0), (bend, half), (tip, 2 * half)]], tip, duration_s)


def free(angle, opening, duration_s):
    """A straight plate that touches no side, with an opening on both."""
    heap = Heap(rows=20, columns=32, first_e=None)
    foot = heap.end + HEAP_GAP_M
    tip = foot + run_of(WIDTH_M - 2 * opening, angle)
    return Belt(heap, [[(foot, opening), (tip, WIDTH_M - opening)]], tip, duration_s)


def transfer(onto_width, duration_s):
    return Transfer(Heap(first_e=None), onto_width, duration_s)
