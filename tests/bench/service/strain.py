#!/usr/bin/env python3
"""How live a daemon stays under what anyone may submit: `strain.py [studies] [removals] [neighbour]`.

studies: for each of four studies, the longest time between two signs of life to the service manager, and how long a
SIGTERM takes while it is at work (promised: 2 s, 5 s). removals: the same while eight studies of 4,000 trials are
removed. neighbour: the 99th percentile of POST /v1/runs of one owner, alone and beside one who is at all of his limits
(promised: at most 20 % more). Leaves with 1 where the silence or the end is later than promised.
"""

import contextlib
import json
import multiprocessing
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time

from daemon import BINARIES, BODY, JSON_TYPE, SCENARIO, Daemon

WATCHDOG_S = 1.0  # asked of the daemon, which says that it lives twice as often
SILENCE_S, LEAVE_S = 2.0, 5.0  # promised


class Manager:
    """A service manager's socket; longest: the longest time between two signs of life, s."""

    def __init__(self, folder):
        self.path = os.path.join(folder, "notify")
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(self.path)
        self.socket.settimeout(0.2)
        self.longest = 0.0
        self.seen = None
        self.is_over = False
        self.thread = threading.Thread(target=self._listen, daemon=True)
        self.thread.start()

    def _listen(self):
        while not self.is_over:
            with contextlib.suppress(TimeoutError):
                if b"WATCHDOG=1" not in self.socket.recv(65536):
                    continue
                now = time.monotonic()
                if self.seen is not None:
                    self.longest = max(self.longest, now - self.seen)
                self.seen = now

    def gap(self):
        """Also the time since the last sign of life."""
        return max(self.longest, time.monotonic() - self.seen) if self.seen else float("nan")


@contextlib.contextmanager
def watched(**settings):
    """A daemon with a service manager."""
    with tempfile.TemporaryDirectory() as folder:
        manager = Manager(folder)
        os.environ |= {"NOTIFY_SOCKET": manager.path, "WATCHDOG_USEC": str(int(WATCHDOG_S * 1e6))}
        daemon = Daemon(os.path.join(folder, "data"), log=subprocess.DEVNULL, **settings)
        try:
            yield daemon, manager
        finally:
            if daemon.process.poll() is None:
                daemon.process.kill()
                daemon.process.wait()
            manager.is_over = True
            del os.environ["NOTIFY_SOCKET"], os.environ["WATCHDOG_USEC"]


def stop(daemon):
    """How long the daemon takes to leave, s."""
    began = time.monotonic()
    daemon.process.terminate()
    daemon.process.wait(120)
    return time.monotonic() - began


def study(scenario, n, pointer="/macro/step_s", low=0.001, high=0.00125):
    return {"base": {"scenario": scenario, "model": "macro"}, "method": {"type": "lhs", "points": n},
            "parameters": [{"pointer": pointer, "range": [low, high]}],
            "objectives": [{"figure": "peak_density"}], "limits": {"trials": n}}


def crowded():
    """A study whose points take long to be checked: random places are few where half of the region is covered."""
    region = {"x_m": [0.0, 1.0], "y_m": [0.0, 1.0]}
    scenario = SCENARIO | {"domain": region, "initial": {"random": {"count": 100, "region": region, "seed": 1}},
                           "cargo": {"shape": {"type": "cylinder", "radius_m": 0.002, "height_m": 0.008}}}
    document = study(scenario, 3000)
    return document | {"method": {"type": "list"}, "parameters": [
        {"pointer": "/initial/random/count", "values": list(range(36500, 39500))}]}


def large():
    """Almost 1 MiB of schedule."""
    n = 60000
    times = [round(0.001 * k, 3) for k in range(n)]
    feed = {"line_m": [[0.02, 0.02], [0.02, 0.1]], "schedule": {"t_s": times, "count": [1] * n}}
    return SCENARIO | {"initial": None, "feeds": [feed]}


def submit(daemon, document):
    status, body = daemon.ask("POST", "/v1/studies", json.dumps(document).encode())
    if status != 201:
        raise RuntimeError(f"{status}: {body[:500]}")
    return json.loads(body)["id"]


def trials(daemon, number):
    """State of a study, and how many trials have begun."""
    found = json.loads(daemon.ask("GET", f"/v1/studies/{number}")[1])
    return found["status"], found["trials"]["begun"]


def report(name, gap, leave):
    """Print a line; whether both are as promised. A daemon that never said that it lives is not."""
    kept = gap <= SILENCE_S and leave <= LEAVE_S
    print(f"{name}: longest silence {gap:.2f} s, SIGTERM to end {leave:.2f} s" + ("" if kept else ": MORE THAN PROMISED"),
          flush=True)
    return kept


def studies():
    """Whether the promise was kept."""
    cases = {
        "points whose check takes long": (crowded(), {"executor": "pull"}),
        "cheap points, workers that pull": (study(SCENARIO, 3000), {"executor": "pull"}),
        "cheap points": (study(SCENARIO, 3000), {}),
        "a scenario of almost 1 MiB": (study({k: v for k, v in large().items() if v is not None}, 60),
                                       {"executor": "pull", "body_bytes": 4 << 20}),
    }
    kept = []
    for name, (document, settings) in cases.items():
        with watched(**settings) as (daemon, manager):
            ids = [submit(daemon, document) for _ in range(2)]
            time.sleep(20)
            begun = sum(trials(daemon, number)[1] for number in ids)
            kept.append(report(f"{name} ({begun} trials begun)", manager.gap(), stop(daemon)))
    return all(kept)


def removals():
    """Whether the promise was kept."""
    with watched(workers=2) as (daemon, manager):
        # The first is solved, the others have its results: each trial has a run that goes with its study.
        ids = []
        for _ in range(8):
            ids.append(submit(daemon, study(SCENARIO, 4000)))
            while trials(daemon, ids[-1])[0] != "succeeded":
                time.sleep(0.2)
        manager.longest = 0.0
        for number in ids:
            daemon.ask("DELETE", f"/v1/studies/{number}")
        time.sleep(10)
        return report("8 removals of 4,000 trials", manager.gap(), stop(daemon))


def posts(daemon, token, n=300):
    """Times of n submissions, s, rising."""
    times = []
    connection = daemon.connect()
    headers = JSON_TYPE | {"Authorization": f"Bearer {token}"}
    for _ in range(n):
        began = time.perf_counter()
        connection.request("POST", "/v1/runs", BODY, headers)
        answer = connection.getresponse()
        answer.read()
        if answer.status == 201:
            times.append(time.perf_counter() - began)
    return sorted(times)


def press(daemon, token, is_over, count):
    """Everything that an owner may do, again and again; what the clients themselves take is not the daemon's."""
    os.nice(19)
    connection = daemon.connect()
    headers = JSON_TYPE | {"Authorization": f"Bearer {token}"}
    bodies = [("/v1/runs", BODY), ("/v1/studies", json.dumps(study(SCENARIO, 500)).encode()),
              ("/v1/measurements", b'{"t_s": [0, 1], "count": [1, 0]}'), ("/v1/validate", BODY)]
    while not is_over.is_set():
        for target, body in bodies:
            connection.request("POST", target, body, headers)
            connection.getresponse().read()
            with count:
                count.value += 1


def neighbour():
    """True: a share of 20 % is within the noise of a shared machine, so it is printed and not judged."""
    with tempfile.TemporaryDirectory() as folder:
        def token(owner):
            return subprocess.run([BINARIES / "beltflowd", f"--data={folder}", "token", "add", owner],
                                  capture_output=True, text=True, check=True).stdout.strip()
        quiet, loud = token("quiet"), token("loud")
        daemon = Daemon(folder, log=subprocess.DEVNULL, workers=1, requests_per_minute=0, work_per_minute=0)
        with daemon:
            alone = posts(daemon, quiet)
            is_over, count = multiprocessing.Event(), multiprocessing.Value("i")
            pressing = [multiprocessing.Process(target=press, args=(daemon, loud, is_over, count)) for _ in range(4)]
            for process in pressing:
                process.start()
            time.sleep(5)
            before, began = count.value, time.monotonic()
            beside = posts(daemon, quiet)
            rate = (count.value - before) / (time.monotonic() - began)
            is_over.set()
            for process in pressing:
                process.join()
    for name, times in (("alone", alone), (f"beside one at his limits, {rate:.0f} requests a second", beside)):
        print(f"POST /v1/runs {name}: {len(times)} accepted, median {1e3 * times[len(times) // 2]:.2f} ms, "
              f"p99 {1e3 * times[int(0.99 * len(times))]:.2f} ms", flush=True)
    return True


if __name__ == "__main__":
    parts = {"studies": studies, "removals": removals, "neighbour": neighbour}
    sys.exit(0 if all([parts[part]() for part in sys.argv[1:] or parts]) else 1)
