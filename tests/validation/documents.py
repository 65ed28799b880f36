"""The scenario documents of the runs of a scene."""

import json
import sys

from starts import shifts

CLOSURES = ["dispersive", "congested"]
PAPER = "dispersive", 5.0, 0.00125  # closure, cell in mm and step of the paper; other steps are automatic
MICRO = {  # /micro of the scenarios
    "implicit": {"integrator": "implicit", "modulus_reduction": 1e4},
    "verlet": {"integrator": "verlet", "modulus_reduction": 1e6, "step_s": 1e-5},
}
OUTPUT = {"curve_every_s": 0.01, "snapshot_every_s": 0.5}


def set_member(document, setting):
    """Apply POINTER=VALUE."""
    pointer, equals, text = setting.partition("=")
    *path, last = pointer.split("/")[1:]
    if not equals or not pointer.startswith("/"):
        sys.exit(f"--set {setting}: not of the form /POINTER=VALUE")
    try:
        value = json.loads(text)
    except ValueError:
        value = text
    at = document
    for step in path:
        at = at[int(step)] if isinstance(at, list) else at.setdefault(step, {})
    if isinstance(at, list):
        at[int(last)] = value
    else:
        at[last] = value


def macro_document(scene, closure, cell_mm, settings, is_named=True):
    document = scene.layout.document(scene.name)
    document["output"] = dict(OUTPUT)
    document["macro"] = {"cell_m": cell_mm / 1000, "step_s": PAPER[2] if (closure, cell_mm) == PAPER[:2] else "auto"}
    if is_named:
        document["macro"]["closure"] = closure
    for setting in settings:
        set_member(document, setting)
    return document


def micro_documents(scene, micro, n_starts):
    for moved in shifts(n_starts):
        document = scene.layout.document(scene.name, moved)
        yield {**document, "output": OUTPUT, "micro": MICRO[micro]}
