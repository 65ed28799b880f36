"""Runs of `beltflow solve`, each made once: results are kept in a folder by what they follow from.

A microscopic result follows from the scenario and the version of the program, so that it outlives changes of the
macroscopic model; a macroscopic one from the scenario and the bytes of the program.
"""

import csv
import hashlib
import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from metrics import Curve


KEPT = ["curve.csv", "summary.json", "photo_eyes.csv"]
KEPT_SNAPSHOTS = ["snapshots.json", "snapshots", "parts"]


class Failed(Exception):
    """A run did not succeed; the text is what the program wrote."""


@dataclass
class Result:
    curve: Curve
    peak: float  # largest density of the run
    cpu_s: float  # seconds of CPU per simulated second
    folder: Path  # where its files are; snapshots only if they were asked for


class Program:
    def __init__(self, path, cache, is_fresh=False, has_snapshots=False):
        self.path = Path(path).resolve()
        self.cache = Path(cache)
        self.is_fresh = is_fresh
        self.has_snapshots = has_snapshots
        version = subprocess.run([self.path, "--version"], capture_output=True, check=True).stdout
        self.origins = {"micro": version, "macro": hashlib.sha256(self.path.read_bytes()).digest()}

    def accepts(self, document):
        """True if the program finds no fault in the scenario."""
        check = subprocess.run([self.path, "check", "-"], input=json.dumps(document).encode(), capture_output=True)
        return check.returncode == 0

    def solve(self, model, document):
        text = json.dumps(document, sort_keys=True).encode()
        key = hashlib.sha256(b"\0".join([model.encode(), self.origins[model], text])).hexdigest()[:24]
        kept = self.cache / f"{model}-{key}"
        last = kept / ("snapshots.json" if self.has_snapshots else "summary.json")
        if self.is_fresh or not last.is_file():
            self._run(model, text, kept)
        return read(kept)

    def _run(self, model, text, kept):
        self.cache.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(dir=self.cache))
        try:
            (folder / "scenario.json").write_bytes(text)
            cpu_s = self._solve(model, folder)
            (folder / "cpu_s").write_text(repr(cpu_s))
            for name in KEPT + (KEPT_SNAPSHOTS if self.has_snapshots else []):
                if (folder / "run" / name).exists():
                    (folder / "run" / name).rename(folder / name)
            shutil.rmtree(folder / "run")
            shutil.rmtree(kept, ignore_errors=True)
            folder.rename(kept)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _solve(self, model, folder):
        """Solve the scenario in the folder into run/ next to it; returns the seconds of CPU."""
        with open(folder / "log", "wb") as log:
            process = subprocess.Popen([self.path, "solve", folder / "scenario.json", "--model", model,
                                        "--out", folder / "run"], stdout=log, stderr=log)
            _, status, usage = os.wait4(process.pid, 0)
        if status != 0:
            raise Failed((folder / "log").read_text(errors="replace").strip())
        return usage.ru_utime + usage.ru_stime


def read(kept):
    with open(kept / "curve.csv", newline="") as file:
        rows = [(float(row["t_s"]), float(row["upstream"])) for row in csv.DictReader(file)]
    summary = json.loads((kept / "summary.json").read_text())
    cpu_s = float((kept / "cpu_s").read_text())
    t, upstream = map(list, zip(*rows))
    return Result(Curve(t, upstream), summary["largest_density"], cpu_s / summary["duration_s"], kept)
