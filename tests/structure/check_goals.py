"""The table of goals of the benchmarks is complete, and tests/bench/README.md has it."""

import pathlib
import re
import sys

import tree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench"))
import goals


def goal_faults(part, goal):
    where = f"tests/bench/goals.toml: {part['name']}, {goal.get('what')}"
    missing = {"what", "unit", "find"} - set(goal)
    if missing:
        yield f"{where}: lacks {', '.join(sorted(missing))}"
    if len({"at_least", "at_most"} & set(goal)) != 1:
        yield f"{where}: needs one of at_least and at_most"
    try:
        names = set(re.compile(goal.get("find", ""), re.MULTILINE).groupindex)
    except re.error as error:
        yield f"{where}: {error}"
        return
    if names not in ({"figure"}, {"figure", "peer"}):
        yield f"{where}: finds {sorted(names)}, not a figure and perhaps its peer"


def command_faults(bench, part):
    """A command is a script, or a program of a source."""
    name = part["command"].split()[0]
    if not (bench / name).is_file() and not (bench / f"{name}.c").is_file() and not part.get("needs"):
        yield f"tests/bench/goals.toml: {part['name']}: {name} is not there"


def check(root):
    bench = root / "tests" / "bench"
    path = bench / "goals.toml"
    if not path.is_file():
        return []
    parts = goals.load(path)
    found = [fault for part in parts for fault in command_faults(bench, part)]
    found += [fault for part in parts for goal in part["goal"] for fault in goal_faults(part, goal)]
    names = [part["name"] for part in parts]
    found += [f"tests/bench/goals.toml: {name} twice" for name in sorted(set(names)) if names.count(name) > 1]
    if not found and goals.table(parts) not in (bench / "README.md").read_text(encoding="utf-8"):
        found.append("tests/bench/README.md: its table is not what tests/bench/run --table prints")
    return found


if __name__ == "__main__":
    tree.main(check)
