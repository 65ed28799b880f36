"""Pictures as SVG: the parts of one microscopic start above the densities of the closures, a column for each time."""

import array
import ast
import base64
import json
import struct
import zlib
from html import escape
from math import isfinite

from layouts import RADIUS_M

PIXELS = 400  # to a metre
HEAD, GAP = 24, 8
# Colour at a density; linear between. Beyond close packing the colour changes to red.
RAMP = [(0.0, (255, 255, 255)), (0.5, (140, 190, 230)), (1.0, (20, 60, 120)), (1.1, (230, 60, 30)), (3.0, (90, 0, 0))]


def read_npy(path):
    """Shape and values of a NumPy file of floats."""
    data = path.read_bytes()
    start = 10 + struct.unpack_from("<H", data, 8)[0]
    header = ast.literal_eval(data[10:start].decode())
    values = array.array({"<f4": "f", "<f8": "d"}[header["descr"]])
    values.frombytes(data[start:])
    return header["shape"], values


def snapshot_at(folder, t):
    """The entry of snapshots.json nearest to a time."""
    snapshots = json.loads((folder / "snapshots.json").read_text())["snapshots"]
    return min(snapshots, key=lambda snapshot: abs(snapshot["t_s"] - t))


def colour(density):
    for (below, first), (above, last) in zip(RAMP, RAMP[1:]):
        if density <= above:
            weight = max(density - below, 0.0) / (above - below)
            return bytes(round(a + weight * (b - a)) for a, b in zip(first, last))
    return bytes(RAMP[-1][1])


def png(shape, values):
    """The picture of a density, a pixel for each cell, as the text of a data: address."""
    rows, columns = shape
    lines = b"".join(b"\0" + b"".join(colour(values[row * columns + column]) for column in range(columns))
                     for row in range(rows - 1, -1, -1))
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(lines)),
              (b"IEND", b"")]
    data = b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        for kind, body in chunks)
    return "data:image/png;base64," + base64.b64encode(data).decode()


def density_panel(folder, snapshot, width, height):
    shape, values = read_npy(folder / snapshot["file"])
    return (f'<image width="{width:g}" height="{height:g}" preserveAspectRatio="none" '
            f'style="image-rendering:pixelated" href="{png(shape, values)}"/>')


def parts_panel(folder, snapshot, origin, height):
    (rows, columns), values = read_npy(folder / snapshot["parts_file"])
    return "".join(
        f'<circle cx="{PIXELS * (values[k] - origin[0]):.1f}" cy="{height - PIXELS * (values[k + 1] - origin[1]):.1f}" '
        f'r="{PIXELS * RADIUS_M:.1f}" fill="#8cbee6" stroke="#143c78"/>' for k in range(0, rows * columns, columns)
        if isfinite(values[k]))  # parts that have left the domain have no place


def plates(document, origin, height):
    return "".join(
        '<polyline fill="none" stroke="#000" stroke-width="2" points="'
        + " ".join(f"{PIXELS * (x - origin[0]):.1f},{height - PIXELS * (y - origin[1]):.1f}"
                   for x, y in obstacle["path_m"]) + '"/>' for obstacle in document["obstacles"])


def picture(document, times, micro_folder, macro):
    """The text of an SVG; macro is a list of (title, folder)."""
    (west, east), (south, north) = document["domain"]["x_m"], document["domain"]["y_m"]
    width, height = PIXELS * (east - west), PIXELS * (north - south)
    rows = [("microscopic, one start", micro_folder, True), *((title, folder, False) for title, folder in macro)]
    panels = []
    for row, (title, folder, is_micro) in enumerate(rows):
        for column, t in enumerate(times):
            snapshot = snapshot_at(folder, t)
            drawn = (parts_panel(folder, snapshot, (west, south), height) if is_micro
                     else density_panel(folder, snapshot, width, height))
            panels.append(
                f'<g transform="translate({GAP + column * (width + GAP):g} {row * (height + HEAD) + HEAD:g})">'
                f'<text y="-6">{escape(title)}, {snapshot["t_s"]:.4g} s</text>'
                f'<svg width="{width:g}" height="{height:g}">{drawn}{plates(document, (west, south), height)}</svg>'
                f'<rect width="{width:g}" height="{height:g}" fill="none" stroke="#888"/></g>')
    size = GAP + len(times) * (width + GAP), len(rows) * (height + HEAD) + GAP
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]:g}" height="{size[1]:g}">'
            '<style>text{font:14px sans-serif}</style><rect width="100%" height="100%" fill="#fff"/>'
            + "\n".join(panels) + "</svg>\n")
