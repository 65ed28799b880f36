"""A daemon to be measured: started on a free port with a store of its own, asked over HTTP, stopped."""

import concurrent.futures
import http.client
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
BINARIES = pathlib.Path(os.environ.get("BELTFLOW_BIN_DIR", ROOT / "build/release/bin"))

# One part on a free belt: 24 x 12 cells, 80 steps, solved in a millisecond.
SCENARIO = {
    "name": "one part on a free belt",
    "duration_s": 0.1,
    "domain": {"x_m": [0.0, 0.24], "y_m": [0.0, 0.12]},
    "cargo": {"shape": {"type": "cylinder", "radius_m": 0.012, "height_m": 0.008}},
    "initial": {"positions_m": [[0.06, 0.06]]},
    "output": {"curve_every_s": 0.01, "snapshot_every_s": 0.05},
    "macro": {"closure": "dispersive", "cell_m": 0.01, "step_s": 0.00125},
}
# Solved each time, even if the same scenario was solved before.
BODY = json.dumps({"scenario": SCENARIO, "fresh": True}).encode()
JSON_TYPE = {"Content-Type": "application/json"}


class Daemon:
    """beltflowd on a data directory; settings are flags, with '_' for '-'. log: a file for it, else it is shown."""

    def __init__(self, data, log=None, **settings):
        flags = [f"--{name.replace('_', '-')}={value}" for name, value in settings.items()]
        self.began = time.perf_counter()
        self.process = subprocess.Popen(
            [BINARIES / "beltflowd", "--listen=127.0.0.1:0", f"--data={data}", "--log-level=warn",
             *flags], stdout=subprocess.PIPE, stderr=log, text=True)
        line = self.process.stdout.readline()
        self.port = int(re.search(r":(\d+)/", line).group(1))
        self.pid = self.process.pid

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        if self.process.wait() != 0:
            raise RuntimeError("the daemon did not leave with 0")

    def connect(self):
        return http.client.HTTPConnection("127.0.0.1", self.port)

    def ask(self, method, target, body=None):
        """Status and body of one exchange."""
        connection = self.connect()
        connection.request(method, target, body, JSON_TYPE if body else {})
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        return answer.status, text

    def solve(self):
        """Submit the scenario and wait for its end; its id."""
        status, text = self.ask("POST", "/v1/runs", BODY)
        if status != 201:
            raise RuntimeError(text.decode())
        run = json.loads(text)["id"]
        self.ask("GET", f"/v1/runs/{run}/events")
        return run

    def status_bytes(self, name):
        text = pathlib.Path(f"/proc/{self.pid}/status").read_text(encoding="ascii")
        return int(re.search(rf"{name}:\s+(\d+) kB", text).group(1)) * 1024

    def resident_bytes(self):
        return self.status_bytes("VmRSS")

    def peak_bytes(self):
        """The most that was resident."""
        return self.status_bytes("VmHWM")

    def children_seconds(self):
        """CPU time of the solvers that have ended."""
        text = pathlib.Path(f"/proc/{self.pid}/stat").read_text(encoding="ascii")
        return sum(map(int, text.rsplit(")", 1)[1].split()[13:15])) / os.sysconf("SC_CLK_TCK")

    def switches(self):
        """How often its threads have gone to sleep or been interrupted, all together."""
        total = 0
        for task in pathlib.Path(f"/proc/{self.pid}/task").iterdir():
            text = (task / "status").read_text(encoding="ascii")
            total += sum(int(n) for n in re.findall(r"ctxt_switches:\s+(\d+)", text))
        return total


def folder():
    """A temporary folder, on the disk that the build lies on."""
    return tempfile.TemporaryDirectory(dir=ROOT / "build", prefix="bench-")


def multiply(d, n):
    """Submit what was solved before until the daemon has n finished runs: such runs are finished at once."""
    body = json.dumps({"scenario": SCENARIO}).encode()

    def submit(count):
        connection = d.connect()
        for _ in range(count):
            connection.request("POST", "/v1/runs", body, JSON_TYPE)
            answer = connection.getresponse()
            run = json.loads(answer.read())
            if answer.status != 201 or run["status"] != "succeeded":
                raise RuntimeError(str(run))
        connection.close()

    clients = 8
    with concurrent.futures.ThreadPoolExecutor(clients) as pool:
        list(pool.map(submit, [n // clients + (k < n % clients) for k in range(clients)]))


def need(*programs):
    missing = [name for name in programs if shutil.which(name) is None]
    if missing:
        raise SystemExit(f"missing: {', '.join(missing)}; see tests/bench/README.md")
