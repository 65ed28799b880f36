"""C and C++ files are as clang-format leaves them; all text files follow .editorconfig."""

import subprocess

import tree

TEXT = ("**/*.c", "**/*.cpp", "**/*.h", "**/*.md", "**/*.py", "**/*.mjs", "**/*.js", "**/*.html", "**/*.css",
        "**/*.json", "**/*.cmake", "**/CMakeLists.txt", "deploy/*", ".ci/*")


def c_faults(root):
    """What clang-format would change, a line each."""
    paths = tree.sources(root, *tree.FLOORS, "tests") + tree.files(root, "tests/**/*.cpp")
    sources = [tree.name(root, path) for path in paths]
    if not sources:
        return []
    done = subprocess.run(["clang-format", "--dry-run", "-Werror", *sources], cwd=root,
                          stderr=subprocess.PIPE, text=True, check=False)
    found = [line for line in done.stderr.splitlines() if ": error: " in line]
    if done.returncode != 0 and not found:
        found = [done.stderr.strip() or "clang-format failed"]
    return found


def text_faults(name, text):
    """Tabs, blanks at the end of lines, a missing last newline."""
    if text and not text.endswith("\n"):
        yield f"{name}: the last line has no end"
    if text.endswith("\n\n"):
        yield f"{name}: blank lines at the end"
    for number, line in enumerate(text.split("\n"), 1):
        if line != line.rstrip():
            yield f"{name}:{number}: blanks at the end"
        if "\t" in line:
            yield f"{name}:{number}: a tab"


def check(root):
    found = c_faults(root)
    for path in tree.files(root, *TEXT):
        found.extend(text_faults(tree.name(root, path), path.read_text(encoding="utf-8")))
    return found


if __name__ == "__main__":
    tree.main(check)
