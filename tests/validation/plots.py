"""Outflow curves as SVG: the band of the microscopic starts, and a line for each closure and grid."""

from html import escape

import metrics

WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 640, 400, 56, 40, 28, 16
COLOURS = {"dispersive": "#c2571a", "congested": "#1a5fb4"}
DASHES = ["none", "6 3", "2 3"]  # from the finest grid on
POINTS = 300  # of a line at most


class Axes:
    def __init__(self, t_end, n):
        self.t_end, self.n = t_end, n

    def x(self, t):
        return LEFT + (WIDTH - LEFT - RIGHT) * t / self.t_end

    def y(self, upstream):
        return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * upstream / self.n

    def points(self, t, values):
        every = max(1, len(t) // POINTS)
        return " ".join(f"{self.x(t[i]):.1f},{self.y(values[i]):.1f}" for i in range(0, len(t), every))

    def drawn(self):
        for k in range(6):
            t, upstream = self.t_end * k / 5, self.n * k / 5
            yield (f'<path d="M{LEFT} {self.y(upstream):.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                   f'<text x="{LEFT - 6}" y="{self.y(upstream) + 4:.1f}" text-anchor="end">{upstream:g}</text>'
                   f'<text x="{self.x(t):.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{t:g}</text>')
        yield f'<text x="{WIDTH / 2}" y="{HEIGHT - 6}" text-anchor="middle">t, s</text>'


def curve_plot(title, micro_curves, macro):
    """The text of an SVG; macro is a list of (closure, cell_mm, curve)."""
    mean, deviation = metrics.mean_curve(micro_curves), metrics.deviation_curve(micro_curves)
    axes = Axes(mean.t[-1], mean.n)
    upper = [u + d for u, d in zip(mean.upstream, deviation.upstream)]
    lower = [u - d for u, d in zip(mean.upstream, deviation.upstream)]
    band = axes.points(mean.t, upper) + " " + axes.points(mean.t[::-1], lower[::-1])
    parts = [*axes.drawn(), f'<polygon points="{band}" fill="#bbb"/>']
    lines = [("microscopic", mean, "#000", "none")]
    cells = sorted({cell_mm for _, cell_mm, _ in macro})
    lines += [(f"{closure}, {cell_mm:g} mm", curve, COLOURS.get(closure, "#26a269"),
               DASHES[min(cells.index(cell_mm), len(DASHES) - 1)]) for closure, cell_mm, curve in macro]
    for k, (name, curve, colour, dash) in enumerate(lines):
        style = f'stroke="{colour}" stroke-dasharray="{dash}"'
        y = TOP + 16 + 16 * k
        parts.append(f'<polyline points="{axes.points(curve.t, curve.upstream)}" {style}/>'
                     f'<path d="M{WIDTH - 216} {y - 4}h24" {style}/><text x="{WIDTH - 186}" y="{y}">{name}</text>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">'
            '<style>text{font:12px sans-serif}polyline,path{fill:none}</style>'
            '<rect width="100%" height="100%" fill="#fff"/>'
            f'<text x="{LEFT}" y="18">{escape(title)}: parts upstream</text>'
            + "\n".join(parts) + "</svg>\n")
