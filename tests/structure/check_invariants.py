"""The numbered invariants of the store are numbered without gap, and a test cites each."""

import re

import tree


def stated(text):
    """Numbers of the invariants that a header states."""
    return [int(number) for number in re.findall(r"^///\s+I(\d+)\s", text, re.MULTILINE)]


def cited(text):
    """Numbers of the invariants that a test cites."""
    return {int(number) for number in re.findall(r"\bI(\d+)\b", text)}


def check(root):
    header = root / "server/store/store.h"
    if not header.is_file():
        return ["server/store/store.h: is not there"]
    numbers = stated(header.read_text(encoding="utf-8"))
    if numbers != list(range(1, len(numbers) + 1)) or not numbers:
        return [f"server/store/store.h: invariants are numbered {numbers}"]
    tested = set()
    for path in tree.files(root, "tests/unit/server/**/*.c", "tests/e2e/*.mjs"):
        tested |= cited(path.read_text(encoding="utf-8"))
    return [f"server/store/store.h: no test cites I{number}" for number in numbers
            if number not in tested]


if __name__ == "__main__":
    tree.main(check)
