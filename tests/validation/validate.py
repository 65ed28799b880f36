#!/usr/bin/env python3
"""Compare the closures of the macroscopic model with the microscopic model over a set of scenes."""

import argparse
import fnmatch
import os
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import report
from documents import CLOSURES, MICRO, macro_document, micro_documents
from pictures import picture
from plots import curve_plot
from scenes import SCENES
from solver import Failed, Program

TREE = Path(__file__).resolve().parents[2]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", default=["*"],
                        help="names, groups or sets, * and ? being wildcards (default: all)")
    parser.add_argument("--list", action="store_true", help="list the scenes and leave")
    parser.add_argument("--closures", default=",".join(CLOSURES), help="default %(default)s")
    parser.add_argument("--cells", default="5,10", help="edges of the cells in mm (default %(default)s)")
    parser.add_argument("--starts", type=int, default=4, help="microscopic runs of a scene (default %(default)s)")
    parser.add_argument("--micro", choices=MICRO, default="implicit", help="integration (default %(default)s)")
    parser.add_argument("--set", action="append", default=[], metavar="POINTER=VALUE",
                        help="another member of the scenarios of the macroscopic model, JSON or a word")
    parser.add_argument("--pictures", metavar="S,S,...", help="draw parts and densities, too, at these times (s)")
    parser.add_argument("--program", type=Path, default=TREE / "build/release/bin/beltflow")
    parser.add_argument("--out", type=Path, default=TREE / "build/release/validation",
                        help="folder of tables, plots and kept results (default build/release/validation)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at a time (default %(default)s)")
    parser.add_argument("--fresh", action="store_true", help="make all runs anew")
    return parser.parse_args()


def numbers(text):
    return [float(word) for word in text.split(",")]


def chosen_scenes(patterns):
    return [scene for scene in SCENES
            if any(fnmatch.fnmatchcase(name, pattern)
                   for name in (scene.name, scene.group, scene.set) for pattern in patterns)]


def known_closures(program, names):
    """The closures that the program has; is_named: whether scenarios name them. A program from before
    /macro/closure has the dispersive one alone."""
    if program.accepts(macro_document(SCENES[0], CLOSURES[0], 10.0, [])):
        return names, True
    print("The program has no /macro/closure: only the dispersive one is compared.", file=sys.stderr)
    return [name for name in names if name == CLOSURES[0]], False


class Progress:
    """A line on a terminal with how many runs have been made."""

    def __init__(self, n):
        self.n = n
        self.lock = threading.Lock()
        self.made = 0

    def count(self, _):
        with self.lock:
            self.made += 1
            if sys.stderr.isatty():
                end = "\n" if self.made == self.n else ""
                print(f"\r{self.made} of {self.n} runs", end=end, file=sys.stderr, flush=True)


def submit_all(options, program, scenes, variants, is_named):
    """Start all runs; returns the futures of each scene: those of micro, and {variant: future}."""
    pool = ThreadPoolExecutor(options.jobs)
    runs = {}
    for scene in scenes:
        micro = [pool.submit(program.solve, "micro", document)
                 for document in micro_documents(scene, options.micro, options.starts)]
        macro = {variant: pool.submit(program.solve, "macro",
                                      macro_document(scene, *variant, options.set, is_named))
                 for variant in variants}
        runs[scene.name] = micro, macro
    everything = [run for micro, macro in runs.values() for run in (*micro, *macro.values())]
    progress = Progress(len(everything))
    for run in everything:
        run.add_done_callback(progress.count)
    return runs


def write_pictures(options, scene, micro, results):
    """The outflow curves of a scene, and what the belt looks like if that was asked for."""
    plots = options.out / "plots"
    plots.mkdir(parents=True, exist_ok=True)
    curves = [(closure, cell_mm, result.curve) for (closure, cell_mm), result in results.items()]
    (plots / f"{scene.name}.svg").write_text(curve_plot(scene.name, [result.curve for result in micro], curves))
    if options.pictures:
        folders = [(f"{closure}, {cell_mm:g} mm", result.folder) for (closure, cell_mm), result in results.items()]
        drawn = picture(scene.layout.document(scene.name), numbers(options.pictures), micro[0].folder, folders)
        (plots / f"{scene.name}-belt.svg").write_text(drawn)


def collect(options, scene, micro_runs, macro_runs):
    """The rows of a scene, one for each variant; draws its plots."""
    micro = [run.result() for run in micro_runs]
    rows, results = [], {}
    for (closure, cell_mm), run in macro_runs.items():
        try:
            result = results[closure, cell_mm] = run.result()
        except Failed as failure:
            rows.append(report.Row(scene, closure, cell_mm, failure=str(failure).splitlines()[-1]))
            continue
        rows.append(report.compared(scene, closure, cell_mm, result, [start.curve for start in micro]))
    write_pictures(options, scene, micro, results)
    return rows


def main():
    options = arguments()
    scenes = chosen_scenes(options.scenes)
    if not scenes:
        sys.exit("No scene has such a name, group or set; --list shows them.")
    if options.list:
        for scene in scenes:
            print(f"{scene.set:12} {scene.group:10} {scene.name}")
        return
    program = Program(options.program, options.out / "runs", options.fresh, bool(options.pictures))
    closures, is_named = known_closures(program, options.closures.split(","))
    if not closures:
        sys.exit("Nothing to compare.")
    variants = [(closure, cell_mm) for closure in closures for cell_mm in numbers(options.cells)]
    runs = submit_all(options, program, scenes, variants, is_named)
    try:
        by_scene = [row for scene in scenes for row in collect(options, scene, *runs[scene.name])]
    except Failed as failure:
        sys.exit(f"A microscopic run failed: {failure}")
    rows = [row for variant in variants for row in by_scene if (row.closure, row.cell_mm) == variant]
    print(*report.table(rows), sep="\n")
    report.write_csv(options.out / "table.csv", rows)
    print(f"\nThe table is in {options.out / 'table.csv'}, the plots are in {options.out / 'plots'}")
    sys.exit(1 if any(row.failure for row in rows) else 0)


if __name__ == "__main__":
    main()
