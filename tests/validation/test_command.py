"""The scenes are what beltflow accepts, and the command compares one. BELTFLOW_BIN_DIR names the folder of the
programs, build/release/bin if unset."""

import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import equipment
import feeds
from documents import macro_document, micro_documents, set_member
from layouts import DIAMETER_M as D
from scenes import GOALS, SCENES
from table import values_of

HERE = Path(__file__).resolve().parent
PROGRAM = Path(os.environ.get("BELTFLOW_BIN_DIR", HERE.parents[1] / "build/release/bin")) / "beltflow"


def compare(out, *options):
    """The rows of the table that the command writes."""
    subprocess.run([sys.executable, "-B", HERE / "validate.py", "--program", PROGRAM, "--out", out, "--starts", "2",
                    "--closures", "dispersive", "--cells", "10", *options], check=True, capture_output=True)
    with open(out / "table.csv", newline="") as file:
        return list(csv.DictReader(file))


def cells_of(line):
    """The cells of a line of a table in Markdown."""
    return [cell.strip() for cell in line.strip("|").split("|")]


class Scenes(unittest.TestCase):
    def test_names_are_unique_and_groups_have_goals(self):
        self.assertEqual(len({scene.name for scene in SCENES}), len(SCENES))
        self.assertLessEqual({scene.group for scene in SCENES}, set(GOALS))

    def test_both_models_accept_every_scene(self):
        for scene in SCENES:
            micro = list(micro_documents(scene, "implicit", 4))
            macro = macro_document(scene, "dispersive", 5.0, [], is_named=False)
            for model, document in [("macro", macro), ("micro", micro[0]), ("micro", micro[-1])]:
                with self.subTest(scene=scene.name, model=model):
                    check = subprocess.run([PROGRAM, "check", "--model", model, "-"], input=json.dumps(document),
                                           capture_output=True, text=True)
                    self.assertEqual(check.returncode, 0, check.stderr)

    def test_the_microscopic_model_accepts_every_fed_scene(self):
        for row in feeds.rows():
            with self.subTest(row=row.name):
                check = subprocess.run([PROGRAM, "check", "--model", "micro", "-"], text=True, capture_output=True,
                                       input=json.dumps(feeds.fed(row, 0)))
                self.assertEqual(check.returncode, 0, check.stderr)

    def test_both_models_accept_all_equipment(self):
        for scene in equipment.scenes():
            for load in scene.loads:
                with self.subTest(scene=scene.name, load=load):
                    check = subprocess.run([PROGRAM, "check", "-"], text=True, capture_output=True,
                                           input=json.dumps(scene.document(load, 0)))
                    self.assertEqual(check.returncode, 0, check.stderr)

    def test_what_validity_calls_compared_was_within_the_goals(self):
        scenes = [(scene, load, word) for scene in equipment.scenes() for load, word in zip(scene.loads, ("light", "saturated"))]
        rows = {(row[0], row[1]): row for row in map(cells_of, (HERE / "README.md").read_text().splitlines())
                if len(row) == 7 and row[1] in ("light", "saturated")}
        self.assertEqual(set(rows), {(scene.name, word) for scene, _, word in scenes})
        verdicts = values_of(PROGRAM.parent.parent / "validation/scene_values", "validity",
                             [scene.document(load, 0) for scene, load, _ in scenes])
        for (scene, _, word), verdict in zip(scenes, verdicts):
            *_, off, contents, told = rows[scene.name, word]
            off, contents = (abs(float(cell.split()[0])) / 100 for cell in (off, contents))
            is_beyond = off > equipment.MOST_OFF or contents > equipment.MOST_GAP
            with self.subTest(scene=scene.name, load=word):
                self.assertEqual(verdict, told)
                self.assertFalse(is_beyond and verdict == "compared", (off, contents))
        self.assertEqual(sum(verdict == "compared" for verdict in verdicts), 4)

    def test_funnels_pass_what_was_published(self):
        for n, ratio in [(6, 1.31), (10, 1.125)]:
            self.assertAlmostEqual(feeds.wang(80, n * D) / feeds.wang(0, n * D), ratio, delta=0.005)

    def test_members_are_set_by_pointer(self):
        document = {"belts": [{"velocity_m_s": [1, 0]}]}
        for setting in ("/belts/0/velocity_m_s/1=0.5", "/macro/scheme=roe", '/macro/step_s="auto"'):
            set_member(document, setting)
        self.assertEqual(document, {"belts": [{"velocity_m_s": [1, 0.5]}],
                                    "macro": {"scheme": "roe", "step_s": "auto"}})


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name)

    def test_a_scene_is_compared_and_drawn(self):
        row, = compare(self.out, "small-60-half", "--pictures", "2")
        self.assertEqual((row["scene"], row["closure"], row["cell_mm"]), ("small-60-half", "dispersive", "10"))
        rates = float(row["rate"]), float(row["micro_rate"])
        self.assertAlmostEqual(float(row["rate_error"]), 100 * (rates[0] / rates[1] - 1), places=2)
        # An opening of 0.1 m lets at most close packing through, at the speed of the belt.
        self.assertTrue(all(0 < rate < 2004 * 0.1 * 0.395 for rate in rates), rates)
        for drawn in ("small-60-half.svg", "small-60-half-belt.svg"):
            self.assertIn("</svg>", (self.out / "plots" / drawn).read_text())

    def test_what_was_solved_is_not_solved_again(self):
        first = compare(self.out, "small-60-half")
        runs = {run: run.stat().st_mtime_ns for run in (self.out / "runs").iterdir()}
        self.assertEqual(len(runs), 3)
        self.assertEqual(compare(self.out, "small-60-half"), first)
        self.assertEqual({run: run.stat().st_mtime_ns for run in (self.out / "runs").iterdir()}, runs)

    def test_members_of_the_macroscopic_runs_can_be_changed(self):
        first, = compare(self.out, "small-60-half")
        changed, = compare(self.out, "small-60-half", "--set", "/macro/dispersion_m_s=0.4")
        self.assertEqual(changed["micro_rate"], first["micro_rate"])
        self.assertNotEqual(changed["rate"], first["rate"])


if __name__ == "__main__":
    unittest.main()
