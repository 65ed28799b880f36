"""core and api are silent: they neither print, log nor exit, and read no clock, file or environment."""

import re

import tree

# The last words of a broken invariant are the one exception.
LOUD = "core/base/check.c"
CALLS = re.compile(
    r"\b(v?f?printf|puts|fputs|putchar|fputc|fwrite|perror|exit|_Exit|quick_exit|abort|log_\w+|"
    r"fopen|freopen|open|popen|system|getenv|time|clock|clock_gettime|gettimeofday|rand|random|"
    r"setlocale|sleep|usleep|nanosleep|signal|assert)\s*\(|\b(stdout|stderr|stdin)\b")


def check(root):
    found = []
    for path in tree.sources(root, "core", "api"):
        name = tree.name(root, path)
        if name == LOUD:
            continue
        text = tree.code(path.read_text(encoding="utf-8"))
        for number, line in enumerate(text.splitlines(), 1):
            match = CALLS.search(line)
            if match:
                found.append(f"{name}:{number}: {match.group(0)}")
    return found


if __name__ == "__main__":
    tree.main(check)
