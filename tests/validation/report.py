"""The table on the terminal, and as CSV."""

import csv
from dataclasses import dataclass

import metrics
from scenes import GOALS, LARGEST_PEAK, Scene

COLUMNS = [  # attribute of a row, heading, format
    ("micro_rate", "micro/s", "{:.1f}"),
    ("micro_rate_deviation", "+-", "{:.1f}"),
    ("rate", "macro/s", "{:.1f}"),
    ("rate_error", "error %", "{:+.1f}"),
    ("gap", "gap %", "{:.2f}"),
    ("delay_s", "delay s", "{:+.3f}"),
    ("peak", "peak", "{:.2f}"),
    ("cpu_s", "cpu s/s", "{:.3f}"),
]
GOAL_OF = {"rate_error": lambda goal: goal.rate_error, "gap": lambda goal: goal.gap,
           "peak": lambda goal: LARGEST_PEAK}
NAME_WIDTH, WIDTH = 26, 9


@dataclass
class Row:
    """The figures of one macroscopic run. None: the run failed, or it does not come to this figure."""

    scene: Scene
    closure: str
    cell_mm: float
    micro_rate: float = None
    micro_rate_deviation: float = None
    rate: float = None
    rate_error: float = None
    gap: float = None
    delay_s: float = None
    peak: float = None
    cpu_s: float = None
    failure: str = None

    def misses(self, attribute):
        """True if the figure is farther off than the goal of the scene's group."""
        limit = GOAL_OF[attribute](GOALS[self.scene.group]) if attribute in GOAL_OF else None
        value = getattr(self, attribute)
        return limit is not None and value is not None and abs(value) > limit


def compared(scene, closure, cell_mm, result, micro_curves):
    """The row of a macroscopic result; micro_curves are those of all starts."""
    micro = metrics.mean_curve(micro_curves)
    rates = [metrics.rate(curve) for curve in micro_curves]
    macro = result.curve
    return Row(scene, closure, cell_mm,
               micro_rate=metrics.rate(micro),
               micro_rate_deviation=None if None in rates else metrics.deviation(rates),
               rate=metrics.rate(macro), rate_error=metrics.rate_error(macro, micro),
               gap=metrics.gap(macro, micro), delay_s=metrics.delay(macro, micro),
               peak=result.peak, cpu_s=result.cpu_s)


def table(rows):
    """Lines of text: a table for each closure, grid and set, in the order of the rows."""
    titles = dict.fromkeys((row.closure, row.cell_mm, row.scene.set) for row in rows)
    for title in titles:
        chosen = [row for row in rows if (row.closure, row.cell_mm, row.scene.set) == title]
        closure, cell_mm, set_ = title
        yield ""
        yield f"{closure}, cells of {cell_mm:g} mm, {set_}; * misses its goal"
        yield "scene".ljust(NAME_WIDTH) + "".join(heading.rjust(WIDTH) for _, heading, _ in COLUMNS)
        yield from map(line, chosen)
        yield from group_lines(chosen)


def line(row):
    if row.failure:
        return f"{row.scene.name:{NAME_WIDTH}} failed: {row.failure}"
    return row.scene.name.ljust(NAME_WIDTH) + "".join(cell(row, *column) for column in COLUMNS)


def cell(row, attribute, _, style):
    value = getattr(row, attribute)
    text = "-" if value is None else style.format(value)
    return (text + ("*" if row.misses(attribute) else " ")).rjust(WIDTH)


def group_lines(rows):
    """Mean and largest of the absolute values, for each group and for all."""
    groups = list(dict.fromkeys(row.scene.group for row in rows))
    for name in [*groups, None] if len(groups) > 1 else groups:
        chosen = [row for row in rows if name in (None, row.scene.group)]
        figures = [of_values(heading, [abs(getattr(row, attribute)) for row in chosen
                                       if getattr(row, attribute) is not None], style)
                   for attribute, heading, style in COLUMNS if attribute in ("rate_error", "gap", "peak")]
        yield f"  {name or 'all'} ({len(chosen)}): " + ("; ".join(filter(None, figures)) or "no figures")


def of_values(heading, values, style):
    if not values:
        return None
    style = style.replace("+", "")
    return f"{heading} mean {style.format(sum(values) / len(values))}, largest {style.format(max(values))}"


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["set", "group", "scene", "closure", "cell_mm", *(column[0] for column in COLUMNS), "failure"])
        for row in rows:
            values = [getattr(row, column[0]) for column in COLUMNS]
            out.writerow([row.scene.set, row.scene.group, row.scene.name, row.closure, f"{row.cell_mm:g}",
                          *("" if value is None else f"{value:.6g}" for value in values), row.failure or ""])
