#!/usr/bin/env python3
"""The service next to others on the same machine in the same run: GET next to nginx, durable POST next to
bare SQLite; from POST to the first event; an idle daemon with 10,000 finished runs; 1,000 streams of one run; what
the daemon adds to a short run; 1,000 trials of Example 1 on cells of 1 cm."""

import argparse
import datetime
import hashlib
import json
import os
import pathlib
import re
import selectors
import socket
import sqlite3
import statistics
import subprocess
import time

import daemon

N_RUNS = 10_000
NGINX = """
worker_processes {threads}; pid {folder}/nginx.pid; error_log stderr warn; daemon off;
events {{ worker_connections 1024; }}
http {{
  access_log off; sendfile on; keepalive_requests 100000000; default_type application/json;
  client_body_temp_path {folder}/a; proxy_temp_path {folder}/b; fastcgi_temp_path {folder}/c;
  uwsgi_temp_path {folder}/d; scgi_temp_path {folder}/e;
  server {{ listen 127.0.0.1:{port}; root {folder}; }}
}}
"""
POST_LUA = 'wrk.method = "POST"\nwrk.headers["Content-Type"] = "application/json"\nwrk.body = [==[{}]==]\n'


def wrk(url, connections, seconds, script=None):
    """Requests a second; fails when an answer is not a 2xx."""
    command = ["wrk", "-t1", f"-c{connections}", f"-d{seconds}s", url]
    command += ["-s", script] if script else []
    text = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
    if "Non-2xx" in text or "Socket errors" in text:
        raise RuntimeError(text)
    return float(re.search(r"Requests/sec:\s+([\d.]+)", text).group(1))


def take_turns(measures, rounds):
    """The best of each, measured one after the other in every round."""
    best = [0.0] * len(measures)
    for _ in range(rounds):
        for i, measure in enumerate(measures):
            best[i] = max(best[i], measure())
    return best


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def start_nginx(folder, body, port, threads):
    (folder / "run.json").write_bytes(body)
    config = folder / "nginx.conf"
    config.write_text(NGINX.format(folder=folder, port=port, threads=threads), encoding="ascii")
    process = subprocess.Popen(["nginx", "-p", folder, "-c", config])
    time.sleep(0.5)
    return process


def bench_get(arguments):
    with daemon.folder() as name, daemon.Daemon(f"{name}/data") as d:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        target = f"/v1/runs/{d.solve()}"
        _, body = d.ask("GET", target)
        port = free_port()
        nginx = start_nginx(folder, body, port, 2)
        urls = [f"http://127.0.0.1:{d.port}{target}", f"http://127.0.0.1:{port}/run.json"]
        try:
            for connections in (1, 16, 64):
                rates = take_turns([lambda u=u: wrk(u, connections, arguments.seconds) for u in urls],
                                   arguments.rounds)
                print(f"GET of a run, {len(body)} bytes, {connections} connections: "
                      f"{rates[0]:,.0f}/s, nginx {rates[1]:,.0f}/s, ratio {rates[0] / rates[1]:.2f}")
        finally:
            nginx.terminate()
            nginx.wait()


class BareSqlite:
    """A database with synced commits of one insert each, of as many bytes as a submission has. It stays
    open, as the daemon's does: a log that starts again overwrites itself, which syncs faster."""

    def __init__(self, path):
        self.db = sqlite3.connect(path, isolation_level=None)
        self.db.execute("PRAGMA journal_mode = WAL")
        self.db.execute("PRAGMA synchronous = FULL")
        self.db.execute("CREATE TABLE runs (id INTEGER PRIMARY KEY, scenario TEXT)")

    def measure(self, seconds):
        """Commits a second."""
        text, n, end = daemon.BODY.decode(), 0, time.perf_counter() + seconds
        while time.perf_counter() < end:
            self.db.execute("INSERT INTO runs (scenario) VALUES (?)", (text,))
            n += 1
        return n / seconds


def bench_post(arguments):
    with daemon.folder() as name:
        folder = pathlib.Path(name)
        idle = folder / "idle"  # in the solver's place, so that the queue only grows
        idle.write_text("#!/bin/sh\nexec sleep 1000\n", encoding="ascii")
        idle.chmod(0o755)
        script = folder / "post.lua"
        script.write_text(POST_LUA.format(daemon.BODY.decode()), encoding="ascii")
        with daemon.Daemon(f"{name}/data", program=idle, queue_limit=1000000, stop_grace_ms=0) as d:
            url = f"http://127.0.0.1:{d.port}/v1/runs"
            clients = (1, 8, 32)
            bare = BareSqlite(folder / "bare.db")
            measures = [lambda: bare.measure(arguments.seconds)]
            measures += [lambda c=c: wrk(url, c, arguments.seconds, script) for c in clients]
            take_turns(measures, 1)  # until both logs have started again
            best = take_turns(measures, arguments.rounds)
            bare.db.close()
        for n, rate in zip(clients, best[1:]):
            print(f"durable POST, {n} clients: {rate:,.0f}/s, bare SQLite {best[0]:,.0f}/s, "
                  f"ratio {rate / best[0]:.2f}")


def first_events(d):
    """Seconds from POST to the first event of the stream, and to the first one of the solver."""
    began = time.perf_counter()
    _, text = d.ask("POST", "/v1/runs", daemon.BODY)
    connection = d.connect()
    connection.request("GET", f"/v1/runs/{json.loads(text)['id']}/events")
    answer = connection.getresponse()
    first = None
    for line in answer:
        if line.startswith(b"event:"):
            first = first or time.perf_counter() - began
            if line.split()[1] in (b"curve", b"snapshot", b"progress"):
                break
    solved = time.perf_counter() - began
    answer.read()
    connection.close()
    return first, solved


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def bench_event(arguments):
    with daemon.folder() as name, daemon.Daemon(f"{name}/data") as d:
        times = [first_events(d) for _ in range(arguments.events)]
    for what, values in zip(("first event", "first event of the solver"), zip(*times)):
        print(f"POST to the {what}: median {1e3 * statistics.median(values):.1f} ms, "
              f"p99 {1e3 * percentile(values, 0.99):.1f} ms")


def ready_s(d):
    while d.ask("GET", "/readyz")[0] != 200:
        time.sleep(0.001)
    return time.perf_counter() - d.began


def bench_idle(arguments):
    with daemon.folder() as name:
        data = f"{name}/data"
        with daemon.Daemon(data) as d:
            d.solve()
            daemon.multiply(d, N_RUNS - 1)
        size = (pathlib.Path(data) / "beltflow.db").stat().st_size
        times = []
        for _ in range(5):
            with daemon.Daemon(data) as d:
                times.append(ready_s(d))
        with daemon.Daemon(data) as d:
            ready_s(d)
            n_runs = len(json.loads(d.ask("GET", "/v1/runs?limit=200")[1])["runs"])
            time.sleep(2)
            before = d.switches()
            time.sleep(arguments.idle)
            switches = d.switches() - before
            resident = d.resident_bytes()
    print(f"idle daemon, {N_RUNS:,} finished runs in {size / 2**20:.0f} MiB (a page of {n_runs}): ready "
          f"in {1e3 * statistics.median(times):.0f} ms, {resident / 2**20:.1f} MiB resident, "
          f"{switches} wake-ups in {arguments.idle} s")


def read_streams(port, run, n):
    """Read n streams of a run to their ends; the different contents, without comments."""
    selector = selectors.DefaultSelector()
    # HTTP/1.0 has no chunks, which may begin within a line.
    request = f"GET /v1/runs/{run}/events HTTP/1.0\r\nHost: 127.0.0.1:{port}\r\n\r\n"
    for _ in range(n):
        connection = socket.create_connection(("127.0.0.1", port))
        connection.sendall(request.encode())
        connection.recv(1, socket.MSG_PEEK)  # not all at once, which would be refused
        selector.register(connection, selectors.EVENT_READ, [hashlib.sha256(), b""])
    contents = set()
    while selector.get_map():
        for key, _ in selector.select():
            bytes_read, state = key.fileobj.recv(65536), key.data
            *lines, state[1] = (state[1] + bytes_read).split(b"\n")
            for line in lines:
                if re.match(rb"(id|event|data):", line):
                    state[0].update(line + b"\n")
                    state[2:] = [line] if line.startswith(b"event:") else state[2:]
            if not bytes_read:
                contents.add((state[0].digest(), state[2].split()[1] if state[2:] else b""))
                selector.unregister(key.fileobj)
                key.fileobj.close()
    return contents


def seconds_between(run, start, end):
    times = [datetime.datetime.fromisoformat(run[name].replace("Z", "+00:00")) for name in (start, end)]
    return (times[1] - times[0]).total_seconds()


def submit(d, scenario, model="macro"):
    status, text = d.ask("POST", "/v1/runs",
                         json.dumps({"scenario": scenario, "model": model, "fresh": True}).encode())
    if status != 201:
        raise RuntimeError(text.decode())
    return json.loads(text)["id"]


def finished(d, run):
    """The run when it has ended, which must have succeeded."""
    while True:
        run_now = json.loads(d.ask("GET", f"/v1/runs/{run}?wait=60")[1])
        if run_now["status"] not in ("queued", "running"):
            break
    if run_now["status"] != "succeeded":
        raise RuntimeError(f"run {run}: {run_now['status']}")
    return run_now


def example(d, **members):
    return {**json.loads(d.ask("GET", "/v1/examples/example-1")[1]), **members}


def bench_streams(arguments):
    n, times, most = 1000, {0: [], 1000: []}, 0
    with daemon.folder() as name:
        with daemon.Daemon(f"{name}/data", connections_per_address=n + 100) as d:
            scenario = example(d)
            for _ in range(arguments.rounds):
                for readers in times:
                    run = submit(d, scenario, "micro")
                    contents = read_streams(d.port, run, max(readers, 1))
                    if len(contents) != 1 or {end for _, end in contents} != {b"end"}:
                        ends = sorted({end.decode() for _, end in contents})
                        raise RuntimeError(f"{len(contents)} different streams, with the last events {ends}")
                    times[readers].append(seconds_between(finished(d, run), "started_at", "finished_at"))
            most = d.peak_bytes()
    alone, watched = (min(values) for values in times.values())
    print(f"{n:,} streams of one run, all complete: the run {watched:.3f} s, with one stream {alone:.3f} s, "
          f"ratio {watched / alone:.3f}; at most {most / 2**20:.1f} MiB resident")


def bench_short(arguments):
    with daemon.folder() as name, daemon.Daemon(f"{name}/data", queue_limit=100000) as d:
        runs = [finished(d, run) for run in [submit(d, daemon.SCENARIO) for _ in range(arguments.events)]]
        summaries = [json.loads(d.ask("GET", f"/v1/runs/{run['id']}/summary")[1]) for run in runs]
    means = [statistics.mean(seconds_between(run, "started_at", "finished_at") for run in runs),
             statistics.mean(summary["wall_time_s"] for summary in summaries)]
    print(f"a short run: {1e3 * means[0]:.2f} ms from claim to end, {1e3 * means[1]:.2f} ms of them the solver's, "
          f"overhead {1e3 * (means[0] - means[1]):.2f} ms")


def bench_trials(arguments):
    cores = os.cpu_count()
    with daemon.folder() as name:
        with daemon.Daemon(f"{name}/data", workers=cores, queue_limit=100000) as d:
            scenario = example(d, macro={"cell_m": 0.01, "step_s": 0.0025})
            begun, children = time.perf_counter(), d.children_seconds()
            runs = [submit(d, scenario) for _ in range(arguments.trials)]
            for run in runs:
                finished(d, run)
            wall, children = time.perf_counter() - begun, d.children_seconds() - children
    print(f"{arguments.trials:,} macro trials on {cores} cores: {1e3 * wall / len(runs):.2f} ms each, cores "
          f"{100 * children / wall / cores:.1f} % in solvers")


PARTS = {"get": bench_get, "post": bench_post, "event": bench_event, "idle": bench_idle,
         "streams": bench_streams, "short": bench_short, "trials": bench_trials}
PEERS = {"get": ("wrk", "nginx"), "post": ("wrk",)}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"{', '.join(PARTS)}; all if none")
    parser.add_argument("--seconds", type=int, default=3, help="of one measurement (3)")
    parser.add_argument("--rounds", type=int, default=3, help="of which the best counts (3)")
    parser.add_argument("--events", type=int, default=300, help="runs that are timed (300)")
    parser.add_argument("--idle", type=int, default=20, help="seconds of watching it sleep (20)")
    parser.add_argument("--trials", type=int, default=1000, help="runs of Example 1 (1000)")
    arguments = parser.parse_args()
    unknown = set(arguments.parts) - set(PARTS)
    if unknown:
        parser.error(f"there is no part {', '.join(unknown)}")
    for part in arguments.parts or PARTS:
        daemon.need(*PEERS.get(part, ()))
        PARTS[part](arguments)


if __name__ == "__main__":
    main()
