"""What a machine is, for figures that were measured on it."""

import os
import pathlib
import platform
import re
import subprocess
import time

WORK = "n = 0\nfor k in range(10_000_000): n = (n * 5 + k) & 0xffffffff\n"


def cpu_model():
    text = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    found = re.search(r"^(?:model name|CPU part)\s*:\s*(.+)$", text, re.MULTILINE)
    return found.group(1).strip() if found else platform.machine()


def caches():
    """Level, type and size of each cache that the first core uses."""
    found = []
    for index in sorted(pathlib.Path("/sys/devices/system/cpu/cpu0/cache").glob("index*")):
        level, kind, size = ((index / name).read_text(encoding="ascii").strip() for name in ("level", "type", "size"))
        found.append(f"L{level} {kind.lower()} {size}")
    return ", ".join(found)


def seconds_of(n):
    """Wall time of n independent processes at once, each with the same work."""
    began = time.perf_counter()
    for process in [subprocess.Popen(["python3", "-c", WORK]) for _ in range(n)]:
        process.wait()
    return time.perf_counter() - began


def pair():
    """How much longer two independent processes take at once than one alone, and what it means."""
    one, two = zip(*[(seconds_of(1), seconds_of(2)) for _ in range(3)])
    slower = min(two) / min(one)
    return f"{slower:.2f} times as long as one: " + (
        "cores of their own" if slower < 1.15 else "threads of one core, or a machine with other work")


def load():
    """Of the last minute."""
    return os.getloadavg()[0]


def describe():
    """(what, text) pairs."""
    return [("processor", cpu_model()), ("cores", str(os.cpu_count())), ("caches", caches()),
            ("kernel", f"{platform.system()} {platform.release()} {platform.machine()}"),
            ("two processes at once", pair())]


def name():
    """For a file."""
    return re.sub(r"[^a-z0-9]+", "-", f"{cpu_model()} {os.cpu_count()} cores".lower()).strip("-")
