"""Headers within 250 lines, files within 800, functions within 80."""

import re

import tree

HEADER_MAX, FILE_MAX, FUNCTION_MAX = 250, 800, 80
COUNTED = ("**/*.c", "**/*.h", "**/*.py", "**/*.mjs", "**/*.js", "**/*.css", "**/*.html")


def functions(lines):
    """(name, first line, length) of each function of a C file: its brace opens at column 0."""
    start = None
    for number, line in enumerate(lines):
        if line == "{":
            start = number
            while start > 0 and lines[start - 1] and lines[start - 1][0] not in "}#/":
                start -= 1
        elif line == "}" and start is not None:
            words = re.findall(r"(\w+)\s*\(", " ".join(lines[start:start + 2]))
            yield (words[0] if words else "?"), start + 1, number - start + 1
            start = None


def check(root):
    found = []
    for path in tree.files(root, *COUNTED):
        name, lines = tree.name(root, path), tree.lines(path)
        limit = HEADER_MAX if name.endswith(".h") else FILE_MAX
        if len(lines) > limit:
            found.append(f"{name}: {len(lines)} lines, at most {limit}")
        if name.endswith(".c"):
            found.extend(f"{name}:{first}: {function}() has {length} lines, at most {FUNCTION_MAX}"
                         for function, first, length in functions(lines)
                         if length > FUNCTION_MAX)
    return found


if __name__ == "__main__":
    tree.main(check)
