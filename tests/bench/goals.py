"""The table of goals (goals.toml) as `run` and the tests of the tree's structure read it."""

import pathlib
import re
import tomllib

FOLDER = pathlib.Path(__file__).resolve().parent


def load(path=FOLDER / "goals.toml"):
    """The parts, in order."""
    with open(path, "rb") as file:
        return tomllib.load(file)["part"]


def is_peer_compared(goal):
    return "(?P<peer>" in goal["find"]


def bound(goal):
    """As it is written, with what it is about."""
    sign, value = ("≥", goal["at_least"]) if "at_least" in goal else ("≤", goal["at_most"])
    return f"{sign} {value:,g}" + (" ×" if is_peer_compared(goal) else f" {goal['unit']}".rstrip())


def is_reached(goal, value):
    return value >= goal["at_least"] if "at_least" in goal else value <= goal["at_most"]


def find(goal, text):
    """The figure and the peer's (None without one) in a command's output, or None if they are not there."""
    match = re.search(goal["find"], text, re.MULTILINE)
    if match is None:
        return None
    return [float(value.replace(",", "")) for value in (match["figure"], match.groupdict().get("peer")) if value]


def best(goal, found):
    """The best figure and, where there is one, the best peer of all rounds."""
    largest = goal.get("best", "largest" if "at_least" in goal else "least") == "largest"
    return [(max if largest else min)(values) for values in zip(*found)]


def table(parts):
    """The table of README.md."""
    rows = [f"| `{part['name']}` | {part['about']} | "
            + "; ".join(f"{goal['what']}: {bound(goal)}" for goal in part["goal"]) + " |" for part in parts]
    return "\n".join(["| part | measures | goals |", "|---|---|---|", *rows]) + "\n"
