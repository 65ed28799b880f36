"""Paths that a README or the manual names exist, the first README is short and names every folder, the diagram of a
run's states is the table of api/run_state.h, and each limit and promise names the tests that go beyond it."""

import re

import tree

ENDINGS = ("c", "h", "md", "json", "py", "mjs", "js", "css", "html", "txt", "cmake")
TEST = re.compile(r"tests/(?:[\w-]+/)+(?:test_\w+\.c|\w+\.test\.mjs|fuzz\.c)")
CHAPTERS = ("api/docs/limits.md", "api/docs/guarantees.md")
LONGEST = 150  # lines of the first README
PATH = re.compile(r"[\w.*-]+(?:/[\w.*-]+)*/?")


def path_spans(root, text):
    """What stands in `code` or (links) and looks like a path of the tree."""
    folders = {path.name for path in root.iterdir() if path.is_dir()}
    prose = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    spans = re.findall(r"`([^`\n]+)`", prose)
    spans += [link.split("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", prose)
              if "://" not in link and not link.startswith("#")]
    for span in spans:
        if not PATH.fullmatch(span) or span.startswith("build/"):
            continue
        is_below = "/" in span and span.split("/")[0] in folders
        is_file = span.rsplit(".", 1)[-1] in ENDINGS and "." in span.strip(".")
        if is_below or (is_file and re.search(r"[\w*]\.\w+$", span)):
            yield span


def path_faults(root, path):
    name = tree.name(root, path)
    for span in path_spans(root, path.read_text(encoding="utf-8")):
        places = (root, path.parent)
        if not any(list(place.glob(span.rstrip("/"))) for place in places):
            yield f"{name}: `{span}` does not exist"


def folder_faults(root):
    """Top folders need a README, and a word in the first one, which is short."""
    text = (root / "README.md").read_text(encoding="utf-8")
    if text.count("\n") > LONGEST:
        yield f"README.md: has more than {LONGEST} lines"
    for folder in sorted(path for path in root.iterdir() if path.is_dir()):
        if folder.name.startswith(".") or folder.name in tree.SKIPPED:
            continue
        if not (folder / "README.md").is_file():
            yield f"{folder.name}: has no README.md"
        if f"`{folder.name}/" not in text:
            yield f"README.md: does not name `{folder.name}/`"


def arrows_of_table(text):
    """(from, to) of run_state.h's table."""
    rows = re.findall(r'X\((RUN_\w+),\s*\\?\s*"(\w+)",([^"]*?)\)\s*(?:\\\n|\n\n)', text)
    words = {state: word for state, word, _ in rows}
    return {(word, words[to]) for _, word, to_list in rows
            for to in re.findall(r"RUN_TO\((\w+)\)", to_list)}


def arrows_of_diagram(text):
    """(from, to) of the state diagram in a README."""
    found = re.search(r"stateDiagram-v2\n(.*?)```", text, re.DOTALL)
    pairs = re.findall(r"(\w+) --> (\w+)", found.group(1)) if found else []
    return set(pairs)


def state_faults(root):
    header = root / "api" / "run_state.h"
    if not header.is_file():
        return ["api/run_state.h: is not there"]
    table = arrows_of_table(header.read_text(encoding="utf-8"))
    diagram = arrows_of_diagram((root / "server" / "README.md").read_text(encoding="utf-8"))
    found = [f"server/README.md: the diagram lacks {a} --> {b}" for a, b in sorted(table - diagram)]
    found += [f"server/README.md: the diagram invents {a} --> {b}" for a, b in sorted(diagram - table)]
    return found if table else ["api/run_state.h: no table of states found"]


def test_faults(root, chapter):
    """Each row of the tables of a chapter of the manual names tests that exist, in its last cell."""
    text = (root / chapter).read_text(encoding="utf-8")
    for table in re.findall(r"(?:^\|.*\n?)+", text, re.MULTILINE):
        for row in table.splitlines()[2:]:
            what, *_, tests = [cell.strip() for cell in row.strip("|").split("|")]
            named = re.findall(r"`([^`]+)`", tests)
            if not any(TEST.fullmatch(name) for name in named):
                yield f"{chapter}: '{what}' names no test"
            for name in named:
                if not (root / name).is_file():
                    yield f"{chapter}: '{what}' names `{name}`, which is not there"


def check(root):
    found = [fault for path in tree.files(root, "README.md", "*/README.md", "deploy/*.md", "api/docs/*.md")
             for fault in path_faults(root, path)]
    found += list(folder_faults(root)) + state_faults(root)
    return found + [fault for chapter in CHAPTERS for fault in test_faults(root, chapter)]


if __name__ == "__main__":
    tree.main(check)
