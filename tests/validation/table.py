#!/usr/bin/env python3
"""Writes core/advice/comparisons_table.c: the lines of lines.py and the goods of goods.py, and how far off each model was.

What was solved before is taken from the folder of results. Rows that fail, through which nothing passes or of which validity tells
no figure are left out, and so are boxes among the goods, which take hours with contacts 100 times as hard. Goods have twice as
many substreams as lines.
"""

import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import goods
import lines
from fed import TREE, options_of
from solver import Failed, Program

TABLE = TREE / "core/advice/comparisons_table.c"
HEAD = """// Written by tests/validation/table.py: scenes that were solved for comparison, in the order of comparisons_columns.

#include "core/advice/comparisons.h"

#include <math.h>

// clang-format off
const comparison_row comparisons_table[] = {
"""
TAIL = """};
// clang-format on

const size_t comparisons_table_n = sizeof comparisons_table / sizeof *comparisons_table;
"""


def error_of_line(program, line, substreams):
    of = lines.compare(program, line, substreams)
    return of["macro"] / of["micro"] - 1.0 if of["micro"] > 0 else None


def error_of_goods(program, scene, substreams):
    return goods.compare(program, scene, substreams)["off"]


def values_of(tool, model, documents):
    """The values of each document as C writes them."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{k}.json" for k in range(len(documents))]
        for path, document in zip(paths, documents):
            path.write_text(json.dumps(document))
        done = subprocess.run([tool, model, *paths], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()


def rows(program, tool, model, subject, scenes, error_of, substreams, jobs):
    def error(scene):
        try:
            return error_of(program, scene, substreams)
        except Failed as failure:
            print(f"{scene.name}: {failure}", file=sys.stderr)
            return None

    with ThreadPoolExecutor(jobs) as pool:
        errors = list(pool.map(error, scenes))
    for scene, off, values in zip(scenes, errors, values_of(tool, model, [scene.document(0) for scene in scenes])):
        if off is not None and set(values.split(", ")) != {"NAN"}:
            yield f"    {{ {subject}, {off:.4f}, {{ {values} }} }}, // {scene.name}\n"


def main():
    options = options_of(__doc__, None, 1)
    tool = options.program.parent.parent / "validation/scene_values"
    runs = options.out / "runs"
    cylinders = [scene for scene in goods.SCENES if scene.shape["type"] == "cylinder"]
    of_lines = rows(Program(options.program, runs), tool, "macro", "VALIDITY_CONGESTED",
                    lines.rows(), error_of_line, options.substreams, options.jobs)
    of_goods = rows(Program(options.program, runs, has_snapshots=True), tool, "micro", "VALIDITY_PARTS_MODEL", cylinders,
                    error_of_goods, 2 * options.substreams, options.jobs)
    text = HEAD + "".join(of_lines) + "".join(of_goods)
    TABLE.write_text(text + TAIL)


if __name__ == "__main__":
    main()
