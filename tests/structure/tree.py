"""The source tree as the structure checks see it. Python's standard library only."""

import inspect
import pathlib
import re
import sys

FLOORS = ("core", "api", "server")
SKIPPED = {".git", "build", "node_modules"}


def files(root, *patterns):
    """The files below root that match one of the glob patterns, without what is built."""
    found = set()
    for pattern in patterns:
        for path in pathlib.Path(root).glob(pattern):
            parts = path.relative_to(root).parts
            if path.is_file() and not SKIPPED.intersection(parts):
                found.add(path)
    return sorted(found)


def name(root, path):
    """The path as it is written in the tree, from the root."""
    return path.relative_to(root).as_posix()


def sources(root, *folders):
    """The C files and headers of the folders."""
    patterns = [f"{folder}/**/*.{ending}" for folder in folders for ending in ("c", "h")]
    return files(root, *patterns)


def lines(path):
    """The lines of a text file, without their ends."""
    return path.read_text(encoding="utf-8").splitlines()


def code(text):
    """C text with comments and the contents of literals blanked; lines stay where they are."""
    pattern = re.compile(
        r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.DOTALL)

    def blank(match):
        found = match.group(0)
        if found[0] in "\"'":
            return found[0] * 2
        return "\n" * found.count("\n")

    return pattern.sub(blank, text)


def main(check):
    """Run a check on the root and, where it asks for it, the build folder of the command line."""
    n_wanted = len(inspect.signature(check).parameters)
    found = check(*[pathlib.Path(argument) for argument in sys.argv[1:1 + n_wanted]])
    for fault in found:
        print(fault)
    print(f"{len(found)} fault{'' if len(found) == 1 else 's'}")
    sys.exit(1 if found else 0)
