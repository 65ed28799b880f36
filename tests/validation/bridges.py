#!/usr/bin/env python3
"""Openings that parts bridge: how likely a queue before a narrow outlet stops for good, measured by moving parts.

Lines of `lines.py` with parts of 66 mm on a belt of 0.4 m/s, an outlet of 1.25 to 5 diameters between a plate and a
guide, or between two plates, and more parts offered than pass; the microscopic model at its defaults. A queue has
stopped when nothing leaves for 60 diameters of belt until the end of the run. Each part that passes is taken as one
chance to stop (the sizes of avalanches are geometric), so that a cell's probability per part is

    h = stops / parts that passed before them

with the interval of a Poisson count, and that a queue stops within 1,000 parts 1 - (1 - h)^1000. Without names the
command writes the table of core/advice/bridges.h. It also says how h falls with the opening: in
experiments exponentially with its power of the dimension, here w^2 (Thomas and Durian, Phys. Rev. Lett. 114 (2015) 178001),
without an opening from which on it is 0 (Janda et al., EPL 84 (2008) 44002).
"""

import math
from fed import TREE, options_of, read_column
from lines import Line
from solver import Program

LAYOUTS = ("plate", "funnel")
ANGLES = (90.0, 60.0, 45.0)
FRICTIONS = ((0.05, 0.1), (0.15, 0.19), (0.5, 0.4))  # of parts on each other, on plates and walls
OPENINGS = (1.25, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0)
OFFERED = 8.0  # parts per d/v
SILENT = 60.0  # d/v without a part that leaves: it has stopped
RUN = {"plate": 200.0, "funnel": 120.0}  # d/v
STOPS = 8  # a cell is measured until it has stopped so often,
PARTS = {"plate": 3000, "funnel": 1500}  # or passed so many


def line(layout, angle, friction, opening):
    return Line("bridges", "bridges", layout=layout, angle=angle, opening=opening, parts=friction[0],
                plates=friction[1], foot=8.0, load=OFFERED / opening)


def avalanche(program, row, substream):
    """Parts that passed, and whether the queue stopped after them."""
    unit = row.d / row.v
    document = row.document(substream)
    document["duration_s"] = round(RUN[row.layout] * unit, 4)
    gone = read_column(program.solve("micro", document).folder, "left_domain")
    decided = gone[-1][0] - SILENT * unit
    passed = max(n for t, n in gone if t <= decided)
    return passed, passed == gone[-1][1]


def cell(program, row, substreams):
    passed = stops = 0
    for substream in range(substreams):
        parts, has_stopped = avalanche(program, row, substream)
        passed, stops = passed + parts, stops + has_stopped
        if stops >= STOPS or passed >= PARTS[row.layout]:
            break
    return passed, stops


def row(program, layout, angle, friction, substreams):
    """The cells of a row: parts that passed and stops, up to the second opening in turn at which nothing stopped."""
    cells = []
    for opening in OPENINGS:
        cells.append(cell(program, line(layout, angle, friction, opening), substreams))
        print(f"{layout:7} {angle:5g} {friction[0]:5g} {friction[1]:5g} {opening:5g} {cells[-1][0]:7.0f} {cells[-1][1]:6} "
              + "{:9.1e} {:9.1e} {:9.1e}  {:5.1f} %".format(*interval(*cells[-1]), probability(*cells[-1])), flush=True)
        if len(cells) > 1 and cells[-1][1] == cells[-2][1] == 0:
            break
    return cells + [(0, 0)] * (len(OPENINGS) - len(cells))


def interval(passed, stops):
    """h, and the ends of its interval of 95 % (Poisson, by Wilson and Hilferty's cubes)."""
    low = stops * (1 - 1 / (9 * stops) - 1.96 / (3 * math.sqrt(stops))) ** 3 if stops > 0 else 0.0
    more = stops + 1
    high = more * (1 - 1 / (9 * more) + 1.96 / (3 * math.sqrt(more))) ** 3
    return stops / passed, low / passed, high / passed


def probability(passed, stops):
    """That a queue stops within 1,000 parts, %."""
    return 100.0 * (1.0 - (1.0 - stops / passed) ** 1000)


def shape(layout, cells):
    """How the probability falls with the opening w: the most likely ln h = a - b w^k of all rows together from 2 diameters
    on, each with its own a, and what the counts deviate from it."""
    told = [[(w, *of) for w, of in zip(OPENINGS, of_row) if w >= 2 and of[0] > 0] for of_row in cells]
    for power in (1, 2):
        def deviance(b):
            sum_of = 0.0
            for of_row in told:
                scale = sum(n for _, _, n in of_row) / sum(m * math.exp(-b * w ** power) for w, m, _ in of_row)
                for w, m, n in of_row:
                    mean = scale * m * math.exp(-b * w ** power)
                    sum_of += 2 * (mean - n + (n * math.log(n / mean) if n > 0 else 0.0))
            return sum_of

        b = min((0.02 * k for k in range(500)), key=deviance)
        free = sum(len(of_row) - 1 for of_row in told) - 1
        print(f"{layout}: h ~ exp(-{b:.2f} w^{power}), deviance {deviance(b):.0f} of {free} degrees of freedom")


def write_table(cells):
    """core/advice/bridges_table.c from the cells of all rows."""
    def listed(values):
        return ", ".join(f"{value:.2f}" for value in values)

    text = [
        "// Written by tests/validation/bridges.py.", "", '#include "core/advice/bridges.h"', "", "// clang-format off",
        f"const double bridges_angles[BRIDGES_ANGLES] = {{ {listed(sorted(ANGLES))} }};",
        f"const double bridges_frictions[BRIDGES_FRICTIONS] = {{ {listed(map(sum, FRICTIONS))} }};",
        f"const double bridges_openings[BRIDGES_OPENINGS] = {{ {listed(OPENINGS)} }};", "",
        "const bridges_cell bridges_table[2][BRIDGES_ANGLES][BRIDGES_FRICTIONS][BRIDGES_OPENINGS] = {"]
    for layout in LAYOUTS:
        text.append("    { // " + {"plate": "of a plate and a wall", "funnel": "of two plates"}[layout])
        for angle in sorted(ANGLES):
            text.append(f"        {{ // {angle:g} degrees")
            for friction in FRICTIONS:
                told = ", ".join(f"{{ {m:.0f}, {n} }}" for m, n in cells[layout, angle, friction])
                text.append(f"            {{ {told} }},")
            text.append("        },")
        text.append("    },")
    (TREE / "core/advice/bridges_table.c").write_text("\n".join(text + ["};", "// clang-format on", ""]))


def main():
    options = options_of(__doc__, "kinds of outlet: plate, funnel", 40)
    program = Program(options.program, options.out / "runs")
    cells = {}
    print(f"{'':24} {'w/d':>5} {'parts':>7} {'stops':>6} {'h':>9} {'95 %':>9} {'':>9}  in 1,000")
    for layout in LAYOUTS:
        if options.names and layout not in options.names:
            continue
        for angle in ANGLES:
            for friction in FRICTIONS:
                cells[layout, angle, friction] = row(program, layout, angle, friction, options.substreams)
        shape(layout, [cells[key] for key in cells if key[0] == layout])
    if not options.names:
        write_table(cells)


if __name__ == "__main__":
    main()
