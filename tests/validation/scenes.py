"""The scenes, one row each. layouts.py says what the parameters of a layout are."""

from dataclasses import dataclass

from layouts import DIAMETER_M as D
from layouts import Belt, Heap, bent, example, free, funnel, single, transfer


@dataclass
class Scene:
    set: str  # development: constants are chosen by it; apart: it is kept apart while they are
    group: str
    name: str
    layout: Belt  # or another class with document() and duration_s


@dataclass
class Goal:
    """What a closure should reach: at most these absolute values, in percent."""

    rate_error: float
    gap: float


GOALS = {  # of each group
    "saturated": Goal(rate_error=5, gap=2),
    "paper": Goal(rate_error=None, gap=2),
    "small": Goal(rate_error=None, gap=2),
    "funnel": Goal(rate_error=8, gap=None),
    "speed": Goal(rate_error=8, gap=None),
    "opening": Goal(rate_error=8, gap=None),
    "plate": Goal(rate_error=8, gap=None),
    "direction": Goal(rate_error=8, gap=None),
    "belts": Goal(rate_error=8, gap=None),
}
LARGEST_PEAK = 1.1  # everywhere

# Angles to the belt in degrees, openings in m, durations in s: until a few percent of the parts are left, if that
# takes no more than 20 s (30 s before the smallest openings).
ROWS = [
    ("development", "saturated", "saturated-45-100", single(45, 0.10, 14)),
    ("development", "saturated", "saturated-60-100", single(60, 0.10, 14)),
    ("development", "saturated", "saturated-75-100", single(75, 0.10, 15)),
    ("development", "saturated", "saturated-90-100", single(90, 0.10, 20)),
    ("development", "saturated", "saturated-60-070", single(60, 0.07, 19)),
    ("development", "saturated", "saturated-60-150", single(60, 0.15, 11)),
    ("development", "saturated", "saturated-60-200", single(60, 0.20, 9)),
    ("development", "saturated", "saturated-75-150", single(75, 0.15, 12)),
    ("development", "saturated", "saturated-60-100-21-rows", single(60, 0.10, 17, Heap(rows=21))),
    ("development", "paper", "paper-40", example(40, 0.10, 6)),
    ("development", "paper", "paper-45", example(45, 0.10, 6)),
    ("development", "paper", "paper-50", example(50, 0.10, 6)),
    ("development", "paper", "paper-60", example(60, 0.10, 6)),
    ("development", "paper", "paper-70", example(70, 0.10, 9)),
    ("development", "paper", "paper-80", example(80, 0.10, 10)),
    ("development", "paper", "paper-90", example(90, 0.10, 10)),
    ("development", "small", "small-60-half", example(60, 0.10, 6, columns=6)),
    ("development", "small", "small-60-double", example(60, 0.10, 9, columns=24)),
    ("development", "small", "small-75-half", example(75, 0.10, 8, columns=6)),
    ("development", "small", "small-75-double", example(75, 0.10, 10, columns=24)),
    ("development", "small", "small-60-070", example(60, 0.07, 8)),
    ("development", "small", "small-60-150", example(60, 0.15, 6)),
    ("development", "small", "small-60-8-rows", example(60, 0.10, 7, rows=8, columns=24)),

    ("apart", "funnel", "funnel-10-6d", funnel(10, 6 * D, 10)),
    ("apart", "funnel", "funnel-20-6d", funnel(20, 6 * D, 9)),
    ("apart", "funnel", "funnel-30-6d", funnel(30, 6 * D, 8)),
    ("apart", "funnel", "funnel-45-6d", funnel(45, 6 * D, 8)),
    ("apart", "funnel", "funnel-60-6d", funnel(60, 6 * D, 9)),
    ("apart", "funnel", "funnel-75-6d", funnel(75, 6 * D, 10)),
    ("apart", "funnel", "funnel-90-6d", funnel(90, 6 * D, 14)),
    ("apart", "funnel", "funnel-10-10d", funnel(10, 10 * D, 8)),
    ("apart", "funnel", "funnel-20-10d", funnel(20, 10 * D, 6)),
    ("apart", "funnel", "funnel-30-10d", funnel(30, 10 * D, 6)),
    ("apart", "funnel", "funnel-45-10d", funnel(45, 10 * D, 6)),
    ("apart", "funnel", "funnel-60-10d", funnel(60, 10 * D, 6)),
    ("apart", "funnel", "funnel-75-10d", funnel(75, 10 * D, 7)),
    ("apart", "funnel", "funnel-90-10d", funnel(90, 10 * D, 8)),
    ("apart", "speed", "speed-01", single(60, 0.10, 44, speed=0.1)),
    ("apart", "speed", "speed-02", single(60, 0.10, 23, speed=0.2)),
    ("apart", "speed", "speed-03", single(60, 0.10, 16, speed=0.3)),
    ("apart", "speed", "speed-05", single(60, 0.10, 11, speed=0.5)),
    ("apart", "speed", "speed-06", single(60, 0.10, 9, speed=0.6)),
    ("apart", "opening", "opening-60-3d", single(60, 3 * D, 19)),
    ("apart", "opening", "opening-60-4d", single(60, 4 * D, 14)),
    ("apart", "opening", "opening-60-6d", single(60, 6 * D, 11)),
    ("apart", "opening", "opening-60-9d", single(60, 9 * D, 9)),
    ("apart", "opening", "opening-90-3d", single(90, 3 * D, 30)),
    ("apart", "opening", "opening-90-4d", single(90, 4 * D, 22)),
    ("apart", "opening", "opening-90-6d", single(90, 6 * D, 14)),
    ("apart", "opening", "opening-90-9d", single(90, 9 * D, 10)),
    ("apart", "plate", "bent-70-45", bent(70, 45, 0.10, 14)),
    ("apart", "plate", "bent-45-70", bent(45, 70, 0.10, 14)),
    ("apart", "plate", "north-60-100", single(60, 0.10, 14, is_from_left=True)),
    ("apart", "plate", "free-60", free(60, 0.12, 9)),
    ("apart", "plate", "free-90", free(90, 0.12, 10)),
    ("apart", "direction", "along-y-60-100", single(60, 0.10, 14, turned_deg=90.0)),
    ("apart", "direction", "turned-30-60-100", single(60, 0.10, 14, turned_deg=30.0)),
    ("apart", "direction", "turned-45-60-100", single(60, 0.10, 14, turned_deg=45.0)),
    ("apart", "belts", "belts-slower-60-100", single(60, 0.10, 20, next_belt=(1.15, 0.25))),
    ("apart", "belts", "belts-faster-60-100", single(60, 0.10, 12, next_belt=(1.15, 0.5))),
    ("apart", "belts", "transfer-200", transfer(0.20, 8)),
]

SCENES = [Scene(*row) for row in ROWS]
