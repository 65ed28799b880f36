"""Every public symbol of the libraries starts with the name of the file that defines it, or with that of
its folder."""

import pathlib
import re
import subprocess

import tree

# Prefixes beside those, by folder.
ALSO = {"core/base": {"bf"}, "core/convex": {"gjk"}, "api": {"api"}, "server/run": {"supervisor"}}
# Written by tools, not by us.
FOREIGN = re.compile(r"__|_init$|_fini$|main$|argp_program_version$")


def prefixes(source):
    """What symbols of this file may start with: its name, its name's first words, or a folder's name below
    the floor."""
    path = pathlib.PurePosixPath(source)
    words = path.stem.split("_")
    own = {"_".join(words[:n]) for n in range(1, len(words) + 1)} | set(path.parts[1:-1])
    folders = [parent.as_posix() for parent in path.parents]
    return own.union(*(ALSO[folder] for folder in folders if folder in ALSO))


def is_named_well(symbol, source):
    return any(symbol == prefix or symbol.startswith(f"{prefix}_") for prefix in prefixes(source))


def source_of(path):
    """The source of an object file: CMake lays core/base/grid.c at core/CMakeFiles/<target>.dir/base/grid.c.o."""
    found = re.search(r"(\w+)/CMakeFiles/[^/]+\.dir/(.+)\.o$", path)
    return f"{found.group(1)}/{found.group(2)}" if found else path


def check(root, build):
    objects = [path for floor in tree.FLOORS for path in sorted(build.glob(f"{floor}/CMakeFiles/*.dir/**/*.c.o"))
               if (root / source_of(path.as_posix())).is_file()]
    if not objects:
        return [f"{build}: no objects of ours found"]
    listing = subprocess.run(["nm", "--print-file-name", "--extern-only", "--defined-only", *objects],
                             stdout=subprocess.PIPE, text=True, check=True).stdout
    found = set()
    for line in listing.splitlines():
        name, _, rest = line.partition(":")
        source, symbol = source_of(name), rest.split()[-1].split(".")[0]
        if not FOREIGN.match(symbol) and not is_named_well(symbol, source):
            found.add(f"{source}: {symbol} does not start with {' or '.join(sorted(prefixes(source)))}")
    return sorted(found)


if __name__ == "__main__":
    tree.main(check)
