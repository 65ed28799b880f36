"""Headers are contracts: each opens with its purpose, and every prototype and every member of a
struct has a /// comment, its own or that of the block of lines it stands in."""

import re

import tree

PROTOTYPE = re.compile(r"[A-Za-z_][\w\s*]*\([^;{]*\)[^;{]*;", re.DOTALL)


def opening_faults(name, lines):
    if not lines or not lines[0].startswith("/// "):
        yield f"{name}:1: does not open with its purpose"


def is_struct_start(text):
    return re.match(r"(typedef\s+)?(struct|union)\b[^;()]*\{$", text) is not None


def statement_at(lines, start):
    """The statement that starts in this line, up to its ';', and its last line."""
    text = ""
    for number in range(start, min(start + 12, len(lines))):
        bare = re.sub(r"//.*", "", lines[number]).rstrip()
        text += bare + "\n"
        if bare.endswith((";", "{", "}")):
            return text.strip(), number
    return text.strip(), start


def has_note(lines, first, last):
    """A comment behind the statement, or continued in the line after it."""
    return any("///<" in line for line in lines[first:last + 1]) or (
        last + 1 < len(lines) and lines[last + 1].lstrip().startswith("///<"))


def undocumented(lines):
    """Numbers of the lines where a prototype or a member without a comment starts."""
    kinds = []  # of the braces that are open: "struct" or "other"
    is_covered = False  # a /// stands earlier in this block of lines
    number = 0
    while number < len(lines):
        text = lines[number].strip()
        if not text:
            is_covered = False
        elif text.startswith("///"):
            is_covered = is_covered or not text.startswith("///<")
        elif not re.match(r"#|//|[A-Z_]+\(.*\)$|.*\\$", text):
            statement, last = statement_at(lines, number)
            in_struct = bool(kinds) and kinds[-1] == "struct"
            if statement.endswith("{"):
                kinds.append("struct" if is_struct_start(statement) else "other")
                is_covered = is_covered and not in_struct
                is_covered = is_covered and kinds[-1] != "struct"
            elif statement.startswith("}"):
                kinds = kinds[:-1]
                is_covered = False
            elif statement.endswith(";"):
                is_wanted = in_struct or (
                    not kinds and PROTOTYPE.fullmatch(statement) is not None)
                if is_wanted and not is_covered and not has_note(lines, number, last):
                    yield number + 1
            number = last
        number += 1


def check(root):
    found = []
    for path in tree.files(root, *[f"{floor}/**/*.h" for floor in tree.FLOORS]):
        name, lines = tree.name(root, path), tree.lines(path)
        found.extend(opening_faults(name, lines))
        found.extend(f"{name}:{number}: no /// comment: {lines[number - 1].strip()}"
                     for number in undocumented(lines))
    return found


if __name__ == "__main__":
    tree.main(check)
