#!/usr/bin/python3
"""A study of macroscopic trials solved by this machine's daemon, by two workers that pull, and by workers that Slurm starts: wall
time, how busy the solvers keep the cores, and what a trial costs the daemon. The bytes are those of `beltflow study` each
time. Then what workers cost a daemon: a request for work when there is none, and frames.

Slurm wants root, slurm-wlm and munge, and is left out with a line that says so where it cannot start."""

import argparse
import contextlib
import http.client
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import time

from daemon import BINARIES, JSON_TYPE, ROOT, Daemon
from study import compare, cpu_of_solvers, document, follow, read, solve_locally

FOLDER = pathlib.Path(__file__).resolve().parent
ASKS = 2000
LONG_S = 20


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def count(metrics, pattern):
    """The sum of all series whose line matches."""
    return sum(float(line.rsplit(" ", 1)[1]) for line in metrics.splitlines() if re.match(pattern, line))


@contextlib.contextmanager
def workers(port, n, cores=1):
    """n workers that use so many cores each, whether they are there or not."""
    started = [subprocess.Popen([BINARIES / "beltflow", "worker", "--pull", f"http://127.0.0.1:{port}", "--name", f"w{k}",
                                 "--cores", str(cores)], stderr=subprocess.DEVNULL) for k in range(n)]
    try:
        yield
    finally:
        for worker in started:
            worker.terminate()
        for worker in started:
            worker.wait()


@contextlib.contextmanager
def slurm(cores):
    """Slurm in the environment of what is started meanwhile; None, or why it cannot be."""
    helper = subprocess.Popen(["node", FOLDER / "slurm.mjs", str(cores)], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    path = helper.stdout.readline().strip()
    if not path:
        yield helper.stderr.read().strip()
        return
    os.environ["SLURM_CONF"] = path
    try:
        yield None
    finally:
        helper.stdin.close()
        helper.wait()


def measure(name, folder, study, n, cores):
    """One way to solve the study; prints its line."""
    port = free_port()
    data = folder / name
    settings = {"local": {}, "pull": {"executor": "pull"},
                "slurm": {"executor": "slurm", "slurm_url": f"http://127.0.0.1:{port}", "slurm_workers": cores,
                          "slurm_cores": 1, "slurm_idle_s": 5}}[name]
    with contextlib.ExitStack() as stack:
        if name == "pull":
            stack.enter_context(workers(port, cores))
        daemon, identity, wall = follow(lambda: Daemon(data, listen=f"127.0.0.1:{port}", **settings), study, n, 0)
        with daemon:
            compare(daemon, identity, folder)
            metrics = read(daemon, "/metrics").decode()
    solving = cpu_of_solvers(data)
    own = count(metrics, "process_cpu_seconds_total ")
    requests = count(metrics, r'beltflow_http_requests_total\{route="/v1/leases')
    leases = count(metrics, r'beltflow_http_requests_total\{route="/v1/leases/\{id\}/jobs"')
    print(f"{name:8} wall {wall:7.2f} s   busy {solving / wall / cores:6.1%}   solvers {1e3 * solving / n:6.2f} ms a trial   "
          f"overhead {1e3 * (wall * cores - solving) / n:6.2f} ms of a core a trial   daemon {1e3 * own / n:5.2f} ms a trial"
          + (f"   {requests / n:.2f} requests a trial, {n / leases:.1f} trials a lease" if leases else ""), flush=True)


def settle():
    """A daemon measures at its start how fast the machine is."""
    time.sleep(1.5)


def cpu_seconds(daemon):
    return count(read(daemon, "/metrics").decode(), "process_cpu_seconds_total ")


def solver(daemon):
    """The name of this tree's solver, as server/base/solver.h has it."""
    version = json.loads(read(daemon, "/version"))["version"]
    return f"{version}/{re.search(r'RUN_VERSION = ([0-9]+)', (ROOT / 'core/run/run.h').read_text())[1]}"


def measure_asks(folder):
    """CPU time of a request for work when there is none."""
    with Daemon(folder / "asks", executor="pull", requests_per_minute=0, work_per_minute=0) as daemon:
        who = {"worker": "one", "solver": solver(daemon), "cores": 1, "memory_bytes": 1e9}
        connection = http.client.HTTPConnection("127.0.0.1", daemon.port)
        settle()
        before = cpu_seconds(daemon)
        for _ in range(ASKS):
            connection.request("POST", "/v1/leases", json.dumps(who), JSON_TYPE)
            answer = connection.getresponse()
            if answer.status != 200 or json.loads(answer.read())["id"] is not None:
                raise RuntimeError("there is work")
        print(f"a request for work, none there   {1e6 * (cpu_seconds(daemon) - before) / ASKS:8.0f} us of the daemon's CPU")


def example(**output):
    """Example 1 with other cells, for longer than it is measured."""
    scenario = json.loads((ROOT / "api/scenario/examples/example-1.json").read_text())
    scenario["macro"] |= {"cell_m": 0.0025, "step_s": "auto"}
    scenario["output"] |= output
    return scenario


def submit(daemon, scenario):
    status, body = daemon.ask("POST", "/v1/runs", json.dumps({"scenario": scenario, "model": "macro", "fresh": True}))
    if status != 201:
        raise RuntimeError(f"a run was refused: {body[:500]!r}")
    return json.loads(body)["id"]


def measure_long_runs(folder, n):
    """What runs that one worker solves at once cost the daemon, beside their snapshots."""
    port = free_port()
    with Daemon(folder / f"long{n}", listen=f"127.0.0.1:{port}", executor="pull") as daemon, workers(port, 1, n):
        runs = [submit(daemon, example(snapshot_every_s=10) | {"duration_s": 1000}) for _ in range(n)]
        while any(json.loads(read(daemon, f"/v1/runs/{run}"))["progress"] == 0 for run in runs):
            time.sleep(0.1)
        settle()
        before, began = read(daemon, "/metrics").decode(), time.perf_counter()
        time.sleep(LONG_S)
        after, seconds = read(daemon, "/metrics").decode(), time.perf_counter() - began
        used, requests = (count(after, line) - count(before, line) for line in (
            "process_cpu_seconds_total ", r'beltflow_http_requests_total\{route="/v1/leases'))
        for run in runs:
            daemon.ask("POST", f"/v1/runs/{run}/cancel", "")
    print(f"{n} of a worker's runs under way   {1e3 * used / seconds / n:8.2f} ms of the daemon's CPU a second for each, "
          f"{requests / seconds:.1f} requests a second together")


def measure_frames(folder):
    """CPU time of the daemon for the frames of one large run, from the worker to the store."""
    port = free_port()
    with tempfile.NamedTemporaryFile("w") as log, workers(port, 1), \
            Daemon(folder / "frames", log, listen=f"127.0.0.1:{port}", executor="pull", log_level="info") as daemon:
        settle()
        before = cpu_seconds(daemon)
        run = submit(daemon, example(snapshot_every_s=0.05))
        while json.loads(read(daemon, f"/v1/runs/{run}"))["status"] in ("queued", "running"):
            time.sleep(0.5)
        used = cpu_seconds(daemon) - before
        while "event=lease_ended" not in (text := pathlib.Path(log.name).read_text()):
            time.sleep(0.1)
    n = int(re.search(r"event=lease_ended .*bytes=(\d+)", text)[1])
    print(f"frames of one run                {1e9 * used / n:8.1f} ms of the daemon's CPU a MB ({n / 1e6:.0f} MB)")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=1000)
    arguments = parser.parse_args()
    n, cores = arguments.trials, len(os.sched_getaffinity(0))
    study = document(n)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="beltflow-cluster-"))
    try:
        alone = solve_locally(study, folder)
        print(f"{n} trials on {cores} cores; beltflow study: {1e3 * alone / n:.2f} ms of CPU a trial", flush=True)
        measure("local", folder, study, n, cores)
        measure("pull", folder, study, n, cores)
        with slurm(cores) as obstacle:
            if obstacle is None:
                measure("slurm", folder, study, n, cores)
            else:
                print(f"slurm    LEFT OUT: {obstacle}")
        measure_asks(folder)
        for runs in (1, 8):
            measure_long_runs(folder, runs)
        measure_frames(folder)
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
