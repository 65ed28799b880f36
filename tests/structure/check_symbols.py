"""Every public symbol of the libraries starts with the prefix of the file that defines it."""

import pathlib
import re
import subprocess

import tree

# Prefixes beside the file's own name, by folder or file.
ALSO = {"core/base": {"bf"}, "core/micro": {"micro"}, "api": {"api"}}
# Written by tools, not by us.
FOREIGN = re.compile(r"__|_init$|_fini$")


def prefixes(source):
    """What symbols of this file may start with: its name, or its name's first words."""
    path = pathlib.PurePosixPath(source)
    words = path.stem.split("_")
    own = {"_".join(words[:n]) for n in range(1, len(words) + 1)}
    return own | ALSO.get(path.parent.as_posix(), set()) | ALSO.get(source, set())


def is_named_well(symbol, source):
    return any(symbol == prefix or symbol.startswith(f"{prefix}_") for prefix in prefixes(source))


def symbols(listing):
    """(object, symbol) of nm's listing of an archive."""
    member = None
    for line in listing.splitlines():
        if line.endswith(":"):
            member = line[:-1]
        match = re.fullmatch(r"[0-9a-f]* ([A-Z]) (\S+)", line.strip())
        if match and member:
            yield member, match.group(2)


def source_of(root, archive, member):
    """The source of an archive's member: names are unique within a floor."""
    floor = archive.stem.removeprefix("libbeltflow_")
    stem = member.removesuffix(".o")
    for path in tree.files(root, f"{floor}/**/{stem}"):
        return tree.name(root, path)
    return f"{floor}/{stem}"


def check(root, build):
    archives = sorted(build.glob("*/libbeltflow_*.a"))
    if not archives:
        return [f"{build}: no libraries of ours found"]
    found = []
    for archive in archives:
        listing = subprocess.run(["nm", "--extern-only", "--defined-only", archive],
                                 stdout=subprocess.PIPE, text=True, check=True).stdout
        for member, symbol in symbols(listing):
            source = source_of(root, archive, member)
            bare = symbol.split(".")[0]
            if not FOREIGN.match(bare) and not is_named_well(bare, source):
                found.append(f"{source}: {symbol} does not start with "
                             f"{' or '.join(sorted(prefixes(source)))}")
    return found


if __name__ == "__main__":
    tree.main(check)
