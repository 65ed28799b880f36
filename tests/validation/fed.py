"""What the commands about fed lines have in common: their options, and the flow that left."""

import argparse
import csv
import os
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]


def options_of(description, chosen, substreams, add=lambda parser: None):
    """The command line; `chosen` says what its words name, None: it takes none. `add` declares more options."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    if chosen is not None:
        parser.add_argument("names", nargs="*", help=f"{chosen} (default all)")
    parser.add_argument("--substreams", type=int, default=substreams, help="runs of a row (default %(default)s)")
    parser.add_argument("--program", type=Path, default=TREE / "build/release/bin/beltflow")
    parser.add_argument("--out", type=Path, default=TREE / "build/release/validation")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    add(parser)
    return parser.parse_args()


def read_column(folder, column):
    """Times and values of a column of a run's curve."""
    with open(folder / "curve.csv", newline="") as file:
        return [(float(row["t_s"]), float(row[column])) for row in csv.DictReader(file)]


def rate(folder, warmup, columns=("left_domain",)):
    """Parts/s that left, or that columns count together, after the warm-up."""
    of_each = [read_column(folder, column) for column in columns]
    gone = [(rows[0][0], sum(n for _, n in rows)) for rows in zip(*of_each)]
    (t_0, n_0), (t_1, n_1) = next(row for row in gone if row[0] >= warmup - 1e-9), gone[-1]
    return (n_1 - n_0) / (t_1 - t_0)
