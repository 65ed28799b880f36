#!/usr/bin/env python3
"""When is the belt free again? A table over the deflector's angle: drain_times.py [URL [ANGLE...]]"""
import json, math, sys, time, urllib.error, urllib.request

URL = sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:8080"
ANGLES = [float(word) for word in sys.argv[2:]] or [50, 55, 60, 65, 70, 75]


def call(path, body=None):
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(URL + path, data, {"Content-Type": "application/json"})
    try:
        return json.load(urllib.request.urlopen(request))
    except urllib.error.HTTPError as refusal:
        sys.exit(f"{path}: {json.load(refusal)['detail']}")


def submit(scenario, angle, model):
    length = 0.5 / math.sin(math.radians(angle))  # from the wall to where Example 1 has its end
    plate = {"end_m": [0.75, 0.5], "angle_deg": angle, "length_m": length}
    changed = {**scenario, "duration_s": 12, "obstacles": [plate]}
    return call("/v1/runs", {"scenario": changed, "model": model, "label": f"{angle:g} degrees"})


def drain_time(run):  # the first time with at most 1 % of the parts before the counter's end
    while run["status"] in ("queued", "running"):
        time.sleep(0.2)
        run = call(run["links"]["self"])
    curve = call(run["links"]["curve"])
    parts = curve["columns"]["upstream"]
    return next((f"{t:.2f}" for t, n in zip(curve["t_s"], parts) if n <= 0.01 * parts[0]), "never")


example = call("/v1/examples/example-1")
runs = {angle: [submit(example, angle, model) for model in ("macro", "micro")] for angle in ANGLES}
print("angle [deg]   macro [s]   micro [s]")
for angle, pair in runs.items():
    print(f"{angle:11g}", *(f"{drain_time(run):>11}" for run in pair))
