"""Read the results of a run with NumPy, the standard library's XML parser and its zipfile, none of
which are ours: every format must hold the same numbers.

    read_back.py FOLDER

FOLDER holds snapshot.npy, .csv, .json and .vti of one snapshot, and where the run has parts parts.npy,
.csv, .json and .vtp of the same time, and results.zip with VTK's files, which is unpacked into
FOLDER/unpacked. Prints what it found as one JSON object; fails with what differs.
"""

import json
import pathlib
import sys
import xml.etree.ElementTree as xml
import zipfile

import numpy as np

TYPES = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4"}


def read_vtk(path):
    """The header of a file of VTK's, which is XML but for the raw bytes, and its arrays by name."""
    head, data = path.read_bytes().split(b'<AppendedData encoding="raw">\n_', 1)
    root = xml.fromstring(head + b"</VTKFile>")
    assert root.get("byte_order") == "LittleEndian" and root.get("header_type") == "UInt64"
    arrays = {}
    end = 0
    for item in root.iter("DataArray"):
        if item.get("format") == "ascii":
            arrays[item.get("Name")] = np.array(item.text.split(), dtype=TYPES[item.get("type")])
            continue
        offset = int(item.get("offset"))
        n_bytes = int(np.frombuffer(data, "<u8", 1, offset)[0])
        kind = np.dtype(TYPES[item.get("type")])
        values = np.frombuffer(data, kind, n_bytes // kind.itemsize, offset + 8)
        n = int(item.get("NumberOfComponents", 1))
        arrays[item.get("Name")] = values.reshape(-1, n) if n > 1 else values
        end = max(end, offset + 8 + n_bytes)
    assert data[end:] == b"\n</AppendedData>\n</VTKFile>\n", "what follows the last block"
    return root, arrays


def numbers_of(text):
    return [float(word) for word in text.split()]


def check_snapshot(folder):
    rho = np.load(folder / "snapshot.npy")
    assert rho.dtype == np.dtype("<f4") and rho.flags.c_contiguous, rho.dtype

    document = json.loads((folder / "snapshot.json").read_text())
    np.testing.assert_array_equal(np.array(document["density"], "f4"), rho)
    assert list(rho.shape) == document["shape"]
    origin, cell = (np.array(document[key], float) for key in ("origin_m", "cell_m"))

    table = np.genfromtxt(folder / "snapshot.csv", delimiter=",", skip_header=1)
    header = (folder / "snapshot.csv").read_text().split("\n", 1)[0].split(",")
    assert header[0] == "y_m/x_m"
    np.testing.assert_array_equal(table[:, 1:].astype("f4"), rho)
    np.testing.assert_allclose(np.array(header[1:], float),
                               origin[0] + (np.arange(rho.shape[1]) + 0.5) * cell[0], rtol=1e-14)
    np.testing.assert_allclose(table[:, 0], origin[1] + (np.arange(rho.shape[0]) + 0.5) * cell[1],
                               rtol=1e-14)

    root, arrays = read_vtk(folder / "snapshot.vti")
    image = root.find("ImageData")
    np.testing.assert_array_equal(arrays["density"].reshape(rho.shape), rho)
    assert numbers_of(image.get("Origin")) == [*origin, 0.0]
    assert numbers_of(image.get("Spacing")) == [*cell, 1.0]
    assert numbers_of(image.get("WholeExtent")) == [0, rho.shape[1], 0, rho.shape[0], 0, 0]
    assert arrays["TimeValue"][0] == document["t_s"]
    return {"shape": rho.shape, "origin_m": list(origin), "cell_m": list(cell),
            "t_s": document["t_s"], "mean": float(rho.mean(dtype="f8")), "top": float(rho.max())}


def check_parts(folder):
    rows = np.load(folder / "parts.npy")
    is_inside = ~np.isnan(rows[:, 0])

    document = json.loads((folder / "parts.json").read_text())
    blank = [None] * rows.shape[1]
    listed = np.array([row or blank for row in document["parts"]], float)
    np.testing.assert_array_equal(listed, rows)

    table = np.genfromtxt(folder / "parts.csv", delimiter=",", names=True)
    assert table.dtype.names == ("part", *document["columns"]), table.dtype.names
    for name, column in zip(document["columns"], rows.T):
        np.testing.assert_array_equal(table[name], column)

    root, arrays = read_vtk(folder / "parts.vtp")
    piece = root.find("PolyData/Piece")
    n = int(is_inside.sum())
    assert int(piece.get("NumberOfPoints")) == int(piece.get("NumberOfVerts")) == n
    np.testing.assert_array_equal(arrays["part"], np.flatnonzero(is_inside))
    np.testing.assert_array_equal(arrays["connectivity"], np.arange(n))
    np.testing.assert_array_equal(arrays["offsets"], np.arange(n) + 1)
    check_points(dict(zip(document["columns"], rows[is_inside].T)), arrays)
    return {"n": n, "columns": document["columns"]}


def check_points(columns, arrays):
    """Point data against the columns that they come from; there is no z in the plane."""
    zero = np.zeros(len(columns["x_m"]))

    def stack(*names):
        return np.stack([columns.get(name, zero) for name in names], axis=1)

    np.testing.assert_array_equal(arrays["position_m"], stack("x_m", "y_m", "z_m"))
    np.testing.assert_array_equal(arrays["velocity_m_s"], stack("vx_m_s", "vy_m_s", "vz_m_s"))
    if "heading_rad" in columns:
        np.testing.assert_array_equal(arrays["heading_rad"], columns["heading_rad"])
        np.testing.assert_array_equal(arrays["spin_rad_s"], columns["spin_rad_s"])
    else:
        np.testing.assert_array_equal(arrays["quaternion_wxyz"], stack("q_w", "q_x", "q_y", "q_z"))
        np.testing.assert_array_equal(arrays["spin_rad_s"],
                                      stack("wx_rad_s", "wy_rad_s", "wz_rad_s"))


def check_archive(folder):
    target = folder / "unpacked"
    with zipfile.ZipFile(folder / "results.zip") as archive:
        assert archive.testzip() is None
        archive.extractall(target)
        names = archive.namelist()
        times = {item.date_time for item in archive.infolist()}
    assert len(times) == 1, times
    listed = json.loads((target / "snapshots.json").read_text())["snapshots"]
    series = {path.name: check_series(path, listed) for path in sorted(target.glob("*.pvd"))}
    return {"names": names, "time": times.pop(), "series": series}


def check_series(path, listed):
    """A collection names a file for each snapshot, at its time, beside itself."""
    sets = xml.parse(path).getroot().findall("Collection/DataSet")
    assert [float(item.get("timestep")) for item in sets] == [item["t_s"] for item in listed]
    for item in sets:
        _, arrays = read_vtk(path.parent / item.get("file"))
        assert arrays["TimeValue"][0] == float(item.get("timestep"))
    return len(sets)


def main():
    folder = pathlib.Path(sys.argv[1])
    found = {"snapshot": check_snapshot(folder), "archive": check_archive(folder)}
    if (folder / "parts.npy").exists():
        found["parts"] = check_parts(folder)
    print(json.dumps(found))


main()
