"""Words that had several meanings in this tree are no part of a name, unless they stand in the table with
their one meaning. Names are the identifiers of C files and headers, without comments and literals."""

import re

import tree

# Word, with its other forms: what to say instead.
AMBIGUOUS = {
    "share": "partition, fraction, weight, quota", "shares": "partition, fraction, weights, quota",
    "shared": "common", "floor": "belt, lower bound, layer", "ground": "static body, disk",
    "reach": "bounding radius, range", "reaches": "bounding radius, range", "twist": "torque, angular velocity",
    "push": "force, impulse, dispersion velocity, append", "pushes": "force, impulse",
    "give": "inverse mass, return, hand on", "gives": "inverse mass, return", "keep": "damping factor, store, warm start",
    "keeps": "store", "rub": "friction force", "brake": "spin deceleration", "drag": "belt friction",
    "shut": "closed", "packed": "saturated, compressed", "wish": "stop request", "debt": "pending update",
    "owe": "defer", "owes": "is due", "doomed": "failed", "crowd": "overlap grid", "patch": "contact constraint",
    "mover": "solver body", "burst": "driver", "care": "retention", "bell": "wake descriptor", "pace": "run control",
}

# Whole names: the one meaning with which they stay, and where they may stand.
ALLOWED = {
    "floor": ("libm's function", r".*"),
    "SHUT_RDWR": ("POSIX", r"server/http/.*"),
    "SHUT_WR": ("POSIX", r"server/http/.*"),
    "overlap_share": ("largest overlap by a radius, `largest_overlap_share` of a summary", r".*"),
    "share": ("`share` of a kind in a mix, a member of scenarios", r"((core|api)/scen|core/feed/|core/(advice/validity|run/crossings)).*"),
    "scene_range_share": ("the same", r"(core|api)/scen.*"),
    "share_rule": ("the same", r"core/scene/check\.c"),
    "queue_share": ("a setting", r"server/daemon/.*"),
    "reach": ("S of (15)-(16): how many cells a mollifier has on each side", r"core/(macro|run)/.*"),
    "mollifier_reach": ("the same", r".*"),
    "MOLLIFIER_REACH_MAX": ("the same", r".*"),
}


def names(text):
    """Identifiers of C text with their lines."""
    for number, line in enumerate(tree.code(text).splitlines(), 1):
        if line.lstrip().startswith("#include"):
            continue
        for match in re.finditer(r"[A-Za-z_]\w*", line):
            yield match.group(0), number


def words(name):
    return [word for word in name.lower().split("_") if word]


def is_allowed(name, path):
    return name in ALLOWED and re.fullmatch(ALLOWED[name][1], path) is not None


def check(root):
    found = []
    for path in tree.sources(root, *tree.FLOORS):
        where, seen = tree.name(root, path), set()
        for name, number in names(path.read_text(encoding="utf-8")):
            if name in seen or is_allowed(name, where):
                continue
            seen.add(name)
            found.extend(f"{where}:{number}: {name}: '{word}' had several meanings: {AMBIGUOUS[word]}"
                         for word in words(name) if word in AMBIGUOUS)
    return found


if __name__ == "__main__":
    tree.main(check)
