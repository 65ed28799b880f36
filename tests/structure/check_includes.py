"""Every #include follows the arrows: server -> api -> core, inside core base <- convex, scene <- feed <- observe <- study, base <- compare <- observe,
scene <- world <- macro, micro <- run <- advice, inside api json <- scenario <- results <- study <- http <- openapi, inside server base <- http, store <- run,
study <- daemon, run <- pull <- slurm <- daemon, run <- worker <- cli; and every outside header is included only where it belongs."""

import re

import tree

API_CORE = {"core/base", "core/scene", "core/world", "core/observe", "core/run", "core/advice",
            "core/compare", "core/study"}
API = {"api", "api/json", "api/scenario", "api/results", "api/study", "api/http", "api/openapi"}

# Folder: the folders of ours that it may include from.
ARROWS = {
    "core/base": {"core/base"},
    "core/convex": {"core/base", "core/convex"},
    "core/scene": {"core/base", "core/scene"},
    "core/feed": {"core/base", "core/scene", "core/feed"},
    "core/observe": {"core/base", "core/scene", "core/world", "core/feed", "core/compare", "core/observe"},
    "core/world": {"core/base", "core/scene", "core/world"},
    "core/macro": {"core/base", "core/scene", "core/world", "core/macro"},
    "core/micro": {"core/base", "core/convex", "core/scene", "core/world", "core/micro"},
    "core/micro/disk": {"core/base", "core/scene", "core/world", "core/micro", "core/micro/disk"},
    "core/micro/body": {"core/base", "core/convex", "core/scene", "core/world", "core/micro", "core/micro/body"},
    "core/run": {"core/base", "core/scene", "core/world", "core/feed", "core/observe", "core/macro", "core/micro",
                 "core/run"},
    "core/advice": {"core/base", "core/scene", "core/feed", "core/observe", "core/macro", "core/micro", "core/run",
                    "core/advice"},
    "core/compare": {"core/base", "core/compare"},
    "core/study": {"core/base", "core/feed", "core/observe", "core/study"},
    "api": {"core/base", "core/scene", "core/observe", "core/run", "core/advice", "core/study", "api"},
    "api/json": {"core/base", "core/scene", "api/json"},
    "api/scenario": {"core/base", "core/scene", "core/observe", "core/run", "core/advice", "api", "api/json", "api/scenario"},
    "api/study": API_CORE | {"core/feed", "api", "api/json", "api/scenario", "api/results", "api/study"},
    "api/results": API_CORE | {"core/feed", "api", "api/json", "api/scenario", "api/results"},
    "api/http": API_CORE | API - {"api/openapi"},
    "api/openapi": API_CORE | API,
}
# What each folder of the server may include from beside what all of them may: core and api.
for folder, known in {
    "server/base": set(),
    "server/http": {"server/base", "server/http/mhd"},
    "server/http/mhd": {"server/base"},
    "server/store": {"server/base"},
    "server/run": {"server/base", "server/store"},
    "server/pull": {"server/base", "server/run"},
    "server/slurm": {"server/base", "server/store", "server/run", "server/pull"},
    "server/study": {"server/base", "server/store"},
    "server/worker": {"server/base", "server/run"},
    "server/cli": {"server/base", "server/run", "server/worker"},
    "server/daemon": {"server/base", "server/http", "server/store", "server/run", "server/pull",
                      "server/slurm", "server/study"},
}.items():
    ARROWS[folder] = API_CORE | API | known | {folder}

# What a standard C library offers; clocks, locales, signals and threads are left out on purpose.
STANDARD = {
    "ctype.h", "endian.h", "errno.h", "float.h", "inttypes.h", "limits.h", "math.h",
    "stdalign.h", "stdarg.h",
    "stdatomic.h", "stdbool.h", "stddef.h", "stdint.h", "stdio.h", "stdlib.h", "string.h",
    "strings.h",
}

# Beyond that: instruction sets, threads, and the calendar (not the clock).
ALSO = {
    "core/base/simd.h": {"emmintrin.h", "immintrin.h"},
    "core/base/team.c": {"linux/futex.h", "pthread.h", "sched.h", "signal.h", "sys/syscall.h", "unistd.h"},
    "api/json/moment.c": {"time.h"},
    "api/results/png.c": {"setjmp.h"},
}

# Outside header: the only files that may include it.
ONLY_IN = {
    "nlopt.h": r"core/study/search\.c",
    "jansson.h": r"api/.+\.c|tests/.+",
    "png.h": r"api/results/png\.c|tests/.+",
    "archive.h": r"api/results/zip_out\.c|tests/.+",
    "archive_entry.h": r"api/results/zip_out\.c|tests/.+",
    "curl/curl.h": r"server/worker/http_call\.c",
    "microhttpd.h": r"server/http/.+",
    "sqlite3.h": r"server/store/.+|tests/unit/server/(store/)?\w+_store\w*\.c|tests/fuzz/fuzz_row\.c",
    "sodium.h": r"server/store/\w+\.c|server/pull/checks\.c|tests/unit/server/store/test_store_golden\.c",
    "zstd.h": r"server/(store/\w+|http/representation)\.c|tests/unit/server/.+\.c",
    "zlib.h": r"server/http/representation\.c|tests/unit/server/.+\.c",
    "ini.h": r"server/daemon/config(_\w+)?\.c",
    "systemd/sd-daemon.h": r"server/daemon/notify\.c",
    "systemd/sd-journal.h": r"server/base/log_journal\.c|tests/unit/server/base/test_log\.c",
    "cmocka.h": r"tests/.+",
    # Processes are the local executor's and those of Slurm's commands; the supervisor knows only jobs.
    "seccomp.h": r"server/run/confinement\.c|tests/unit/server/run/test_confinement\.c",
    "linux/landlock.h": r"server/run/confinement\.c",
    "spawn.h": r"server/base/process\.c|tests/unit/server/run/test_executor_faults\.c",
    "sys/pidfd.h": r"server/(run/child|slurm/command)\.c|tests/unit/server/run/test_executor_faults\.c",
    "sys/wait.h": r"server/(run/(child|local_executor)|slurm/command)\.c|tests/.+",
}


def folder_of(name):
    """The folder whose rules apply."""
    parts = name.split("/")[:-1]
    known = ("/".join(parts[:n]) for n in range(len(parts), 0, -1))
    return next((folder for folder in known if folder in ARROWS), parts[0] if parts else name)


def outside_fault(name, header):
    """Why this file may not include <header>, or None."""
    if header in ONLY_IN:
        if re.fullmatch(ONLY_IN[header], name):
            return None
        return f"<{header}> belongs into {ONLY_IN[header]} only"
    is_known = header in STANDARD or header in ALSO.get(name, set())
    if name.startswith(("core/", "api/")) and not is_known:
        return f"<{header}> is not for core and api"
    return None


def own_fault(root, name, header):
    """Why this file may not include "header", or None."""
    if not (root / header).is_file():
        return f'"{header}" is no file of the tree (paths are written from its root)'
    folder = folder_of(name)
    target = folder_of(header)
    if folder in ARROWS and target not in ARROWS[folder]:
        return f'"{header}": {folder} must not know {target}'
    if header.endswith("_priv.h") and folder in ARROWS and target != folder:
        return f'"{header}" is private to {target}'
    return None


def file_faults(root, path):
    name = tree.name(root, path)
    own_header = name[:-2] + ".h"
    includes = []
    for number, line in enumerate(tree.lines(path), 1):
        match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
        if not match:
            continue
        includes.append(match.group(2))
        fault = (outside_fault(name, match.group(2)) if match.group(1) == "<"
                 else own_fault(root, name, match.group(2)))
        if fault:
            yield f"{name}:{number}: {fault}"
    may_be_first = {own_header, own_header[:-2] + "_priv.h"}
    if (name.endswith(".c") and (root / own_header).is_file()
            and not may_be_first.intersection(includes[:1])):
        yield f'{name}:1: does not include its own "{own_header}" first'
    if name.endswith(".h") and "#pragma once" not in tree.lines(path):
        yield f"{name}:1: no #pragma once"


def check(root):
    return [fault for path in tree.sources(root, *tree.FLOORS, "tests")
            for fault in file_faults(root, path)]


if __name__ == "__main__":
    tree.main(check)
