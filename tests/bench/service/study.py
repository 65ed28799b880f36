#!/usr/bin/python3
"""A study of many macroscopic trials through the daemon: how busy its solvers keep the cores, and, with --kills, that the
daemon may be killed meanwhile. Its trials.csv and best.json are compared, byte by byte, with those of `beltflow study`."""

import argparse
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import sqlite3
import subprocess
import tempfile
import time

from daemon import BINARIES, ROOT, Daemon

EXAMPLE = ROOT / "api/scenario/examples/example-1.json"


def document(n):
    """Example 1 on the 1 cm grid, at n angles of its deflector."""
    scenario = json.loads(EXAMPLE.read_text())
    scenario["macro"] |= {"cell_m": 0.01, "step_s": 0.0025}
    deflector = scenario["obstacles"][0]
    del deflector["from_m"], deflector["to_m"]
    deflector |= {"end_m": [0.75, 0.5], "angle_deg": 60.0, "length_m": 0.577}
    return {"base": {"scenario": scenario},
            "parameters": [{"pointer": "/obstacles/0/angle_deg", "range": [45.0, 90.0], "steps": n}],
            "objectives": [{"figure": "content.mean"}],
            "method": {"type": "grid"}, "limits": {"trials": n}}


def cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def solve_locally(study, folder):
    """What the command line makes of it, and its CPU time."""
    file = folder / "in.json"
    file.write_text(json.dumps(study))
    before = cpu_of_children()
    subprocess.run([BINARIES / "beltflow", "study", file, "--out", folder / "out"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return cpu_of_children() - before


def read(daemon, target):
    status, body = daemon.ask("GET", target)
    if status != 200:
        raise RuntimeError(f"{target}: {status} {body[:200]!r}")
    return body


def kill(daemon):
    os.kill(daemon.pid, signal.SIGKILL)
    daemon.process.wait()


def follow(start, study, n, kills):
    """Make the study in a daemon that start() gives; the daemon, the id of the study, and the wall time, s."""
    began = time.perf_counter()
    daemon = start()
    status, body = daemon.ask("POST", "/v1/studies", json.dumps(study))
    if status != 201:
        raise RuntimeError(f"the study was refused: {body[:500]!r}")
    identity = json.loads(body)["id"]
    at = sorted(random.Random(1).sample(range(n // 20, n - n // 20), kills))
    while True:
        now = json.loads(read(daemon, f"/v1/studies/{identity}"))
        if now["status"] not in ("queued", "running"):
            break
        if at and now["trials"]["succeeded"] >= at[0]:
            kill(daemon)
            at.pop(0)
            daemon = start()
        time.sleep(0.05)
    wall = time.perf_counter() - began
    if now["status"] != "succeeded":
        raise RuntimeError(f"the study is {now['status']}: {now['error']}")
    return daemon, identity, wall


def compare(daemon, identity, folder):
    """Fails unless the study has the bytes of the command line."""
    for target, name in ((f"/v1/studies/{identity}/trials.csv", "trials.csv"),
                         (f"/v1/studies/{identity}/best", "best.json")):
        if read(daemon, target).strip() != (folder / "out" / name).read_bytes().strip():
            raise RuntimeError(f"{name} is not that of the command line")


def cpu_of_solvers(data):
    """CPU time of all processes that solved trials, as the daemon has charged it."""
    with sqlite3.connect(f"file:{data}/beltflow.db?mode=ro", uri=True) as db:
        return db.execute("SELECT sum(cpu_s) FROM runs WHERE parent <> ''").fetchone()[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=1000)
    parser.add_argument("--kills", type=int, default=0, help="times that the daemon is killed (SIGKILL)")
    arguments = parser.parse_args()
    study = document(arguments.trials)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="beltflow-study-"))
    try:
        alone = solve_locally(study, folder)
        daemon, identity, wall = follow(lambda: Daemon(folder / "data"), study, arguments.trials, arguments.kills)
        with daemon:
            compare(daemon, identity, folder)
            metrics = read(daemon, "/metrics").decode()
        cores = len(os.sched_getaffinity(0))
        solving = cpu_of_solvers(folder / "data")
        own = next(float(line.split()[1]) for line in metrics.splitlines()
                   if line.startswith("process_cpu_seconds_total "))
        print(f"{arguments.trials} trials, {arguments.kills} kills: the same bytes as beltflow study")
        print(f"CPU of beltflow study              {alone:8.2f} s, {1e3 * alone / arguments.trials:.2f} ms a trial")
        print(f"CPU of the daemon's solvers        {solving:8.2f} s, {1e3 * solving / arguments.trials:.2f} ms a trial")
        print(f"wall time through the daemon       {wall:8.2f} s on {cores} cores")
        print(f"cores busy in solvers              {solving / (wall * cores):8.1%}")
        if arguments.kills == 0:
            print(f"CPU of the daemon itself           {own:8.2f} s, {1e3 * own / arguments.trials:.2f} ms a trial")
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
