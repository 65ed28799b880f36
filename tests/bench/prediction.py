#!/usr/bin/env python3
"""How far off predictions of the time of a run are (core/advice/prediction.h), on the ready scenarios and on random ones.

    tests/bench/prediction.py                  judge: scenarios of a seed that the costs were not fitted to
    tests/bench/prediction.py --learn          judge how much better they are when runs were learned from
    tests/bench/prediction.py --fit            fit the costs to scenarios of other seeds, some of them with equipment, and to
                                               the ready ones; prints the table

The machine's speed is measured as the daemon does it, so that costs of one machine are judged on another. Prints each
ratio of predicted to measured CPU time; status 1 if not all ready scenarios and nine tenths of the random ones are within 25 %.
--fit needs SciPy (apt-get install -y --no-install-recommends python3-scipy). It takes times by the speed of the machine that is
measured right before each of them: what other processes slow down in between does not spoil the costs.
"""

import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build/release/bench/bench_prediction"
KINDS = ["roe", "muscl", "congested", "planar_verlet", "planar_implicit", "spatial_verlet", "spatial_implicit"]
TERMS = ["RUN", "CELLS", "SNAPSHOT_CELLS", "STEPS", "ROW_STEPS", "CELL_STEPS", "COVERED_STEPS", "SWEPT", "VARIED",
         "DISPERSED", "RECORDED", "RELAXED", "COUPLED", "FIELD_CELLS", "SAMPLE_CELLS", "TRACER_STEPS", "KIND_STEPS", "SPREAD_CELLS",
         "SAMPLE_PARTS", "PART_STEPS", "ROUND_STEPS", "PAIR_STEPS", "LISTED_PAIRS"]
SEEDS_OF_FIT, SEED_OF_JUDGEMENT = range(11, 17), 2
BOUND = 1.25
SHARE_OF_RANDOM = 0.9
NEGLIGIBLE = 0.02  # share of a term in the time of any run, below which its cost is left out


def plate(draw, length, width):
    """A plate from the south wall, or none."""
    angle = draw.choice([30, 45, 60, 75, None])
    opening = draw.choice([0.1, 0.14, 0.2, 0.25])
    if angle is None:
        return []
    height = width - opening
    foot = 0.75 * length - height / math.tan(math.radians(angle))
    if foot < 0.35:
        return []
    return [{"id": "plate", "from_m": [round(foot, 4), 0.0], "to_m": [round(0.75 * length, 4), round(height, 4)]}]


def planar_cargo(draw, scene, length, width, speed):
    """Cylinders at the start, or fed for a longer time."""
    radius = draw.choice([0.012, 0.012, 0.015, 0.02])
    scene["cargo"] = {"shape": {"type": "cylinder", "radius_m": radius, "height_m": 0.008},
                      "mass_kg": round(0.03 * (radius / 0.012) ** 2, 4)}
    if draw.random() < 0.5:
        most = speed * width / (2 * math.sqrt(3) * radius ** 2)
        scene["feeds"] = [{"id": "feed", "edge": "west", "y_m": [round(0.05 * width, 3), round(0.95 * width, 3)],
                           "arrivals": draw.choice(["poisson", "regular"]),
                           "rate_per_s": round(draw.uniform(0.05, 0.6) * most, 1)}]
        scene["duration_s"] = round(1.5 * scene["duration_s"], 1)
    else:
        pitch = 2.05 * radius
        scene["initial"] = {"hexagonal": {"rows": max(3, int(0.7 * width / (0.87 * pitch))),
                                          "columns": max(3, int(0.3 * min(length, 1.2) / pitch)),
                                          "first_m": [0.06, round(0.12 * width, 3)], "spacing_m": pitch}}


def spatial_cargo(draw, scene, width):
    """Boxes, or cylinders that may tip, at random places."""
    scene["cargo"] = {"shape": draw.choice([
        {"type": "box", "length_m": 0.04, "width_m": 0.03, "height_m": 0.02},
        {"type": "box", "length_m": 0.05, "width_m": 0.03, "height_m": 0.015},
        {"type": "cylinder", "radius_m": 0.018, "height_m": 0.015}]), "mass_kg": 0.05}
    scene["micro"]["path"] = "spatial"
    scene["initial"] = {"random": {"count": draw.randint(15, int(100 * width)), "seed": draw.randint(1, 99),
                                   "region": {"x_m": [0.05, 0.5], "y_m": [round(0.1 * width, 3),
                                                                          round(0.9 * width, 3)]}}}


DURATIONS = {"roe": (4, 12), "muscl": (2, 6), "congested": (4, 20), "planar_verlet": (1, 4),
             "planar_implicit": (5, 30), "spatial_verlet": (0.5, 1.5), "spatial_implicit": (1, 4)}


def make(draw, kind):
    """A random scenario for a kind of solver."""
    length, width = draw.choice([1.0, 1.5, 2.0, 3.0]), draw.choice([0.4, 0.6, 0.8, 1.0])
    speed = round(draw.uniform(0.2, 0.8), 2)
    scene = {"duration_s": round(draw.uniform(*DURATIONS[kind]), 1),
             "domain": {"x_m": [0, length], "y_m": [0, width]},
             "belts": [{"id": "main", "velocity_m_s": [speed, 0]}],
             "obstacles": plate(draw, length, width),
             "output": {"curve_every_s": draw.choice([0.01, 0.05, 0.1]),
                        "snapshot_every_s": draw.choice([0.1, 0.5, 1.0])},
             "macro": {"cell_m": draw.choice([0.005, 0.01, 0.01] if kind in ("roe", "muscl") else [0.01, 0.01, 0.02]),
                       "step_s": "auto"},
             "micro": {"modulus_reduction": draw.choice([1e3, 1e4]), "overlap_limit": 1, "step_s": "auto"}}
    scene["macro"]["closure"] = "congested" if kind == "congested" else "dispersive"
    if kind == "muscl":
        scene["macro"]["scheme"] = "muscl"
    if not kind.startswith(("roe", "muscl", "congested")):
        scene["micro"]["integrator"] = kind.split("_")[1]
    if kind.startswith("spatial"):
        spatial_cargo(draw, scene, width)
    else:
        planar_cargo(draw, scene, length, width, speed)
    return scene


def measure(paths, model):
    """{name, kind, measured, reference, predicted, amounts} of each scenario that the model can solve."""
    output = subprocess.run([PROGRAM, model, *paths], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                            check=True).stdout
    rows = [line.split(",") for line in output.splitlines()]
    return [{"name": pathlib.Path(row[0]).stem, "kind": row[1], "measured": float(row[2]),
             "reference": float(row[3]), "predicted": float(row[4]), "amounts": [float(value) for value in row[6:]]} for row in rows]


def equip(draw, scene):
    """A flap that turns, and an eye before it that stops the belt."""
    length, width = scene["domain"]["x_m"][1], scene["domain"]["y_m"][1]
    scene["obstacles"].append({"id": "flap", "path_m": [[round(0.8 * length, 3), 0], [round(0.8 * length + 0.15, 3), 0]],
                               "motion": {"t_s": [0, 0.5, 2, 2.5], "turn_deg": [0, 40, 40, 0], "repeat_s": 4}})
    scene["photo_eyes"] = [{"id": "eye", "line_m": [[round(0.5 * length, 3), 0], [round(0.5 * length, 3), width]],
                            "block_time_s": draw.choice([0.2, 0.5, 1])}]
    scene["actions"] = [{"when": {"photo_eye": "eye", "state": state}, "do": {"belt": "main", "factor": factor}}
                        for state, factor in [("blocked", 0.5), ("clear", 1)]]


def measure_random(seed, n_each, folder, is_equipped=False):
    draw, rows = random.Random(seed), []
    for kind in ["congested", "planar_implicit"] if is_equipped else KINDS:
        paths = [pathlib.Path(folder) / f"{kind}-{k}.json" for k in range(n_each)]
        for path in paths:
            scene = make(draw, kind)
            if is_equipped:
                equip(draw, scene)
            path.write_text(json.dumps(scene))
        rows += measure(paths, "micro" if kind.startswith(("planar", "spatial")) else "macro")
    return rows


def learn(rows):
    """The rows in the order given, each with what was predicted before it was learned from."""
    lines = "".join(",".join(map(str, [row["kind"], row["measured"], *row["amounts"]])) + "\n" for row in rows)
    output = subprocess.run([PROGRAM, "learn"], input=lines, stdout=subprocess.PIPE, text=True, check=True).stdout
    return [{**row, "predicted": float(line)} for row, line in zip(rows, output.splitlines())]


def judge_learning(rows):
    """How near predictions are before anything was learned, and after the first 30 runs in a random order."""
    random.Random(3).shuffle(rows)
    learned = learn(rows)
    for title, part, bound in [("before any run", rows, 2.0), ("before any run", rows, BOUND),
                               ("after 30 runs", learned[30:], BOUND), ("after 30 runs", learned[30:], 2.0)]:
        good = sum(1 / bound <= row["predicted"] / row["measured"] <= bound for row in part)
        print(f"{title}: {good} of {len(part)} within a factor of {bound}")


def measure_ready():
    paths = sorted((ROOT / "api/scenario/examples").glob("*.json"))
    return measure(paths, "macro") + measure(paths, "micro")


def judge(title, rows, share):
    """Print the ratios of each kind; True if enough of them are within the bound."""
    good = 0
    for kind in KINDS:
        ratios = [(row["name"], row["predicted"] / row["measured"]) for row in rows if row["kind"] == kind]
        if ratios:
            print(f"{title}, {kind}: " + ", ".join(f"{name} {ratio:.2f}" for name, ratio in ratios))
        good += sum(1 / BOUND <= ratio <= BOUND for _, ratio in ratios)
    print(f"{title}: {good} of {len(rows)} within {100 * (BOUND - 1):.0f} %")
    return good >= share * len(rows)


def fit(rows):
    """Costs >= 0 whose predictions have the least sum of relative errors, robust against single runs."""
    import numpy
    from scipy.optimize import least_squares, nnls
    amounts = numpy.array([row["amounts"] for row in rows])
    measured = numpy.array([row["reference"] for row in rows])
    scale = numpy.where(amounts.max(0) > 0, amounts.max(0), 1)
    costs, _ = nnls(amounts / scale / measured[:, None], numpy.ones(len(rows)))
    found = least_squares(lambda x: numpy.log(amounts / scale @ numpy.exp(x)) - numpy.log(measured),
                          numpy.log(numpy.maximum(costs, 1e-6 * measured.mean())), loss="soft_l1", f_scale=0.1)
    costs = numpy.where(amounts.max(0) > 0, numpy.exp(found.x) / scale, 0)
    share = (amounts * costs / (amounts @ costs)[:, None]).max(0)
    return numpy.where(share > NEGLIGIBLE, costs, 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fit", action="store_true", help="print the table of costs")
    parser.add_argument("--learn", action="store_true", help="judge what is predicted after runs were learned from")
    parser.add_argument("--each", type=int, default=12, help="random scenarios of each kind")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [row for seed in (SEEDS_OF_FIT if options.fit else [SEED_OF_JUDGEMENT])
                for is_equipped in ([False, True] if options.fit else [False])
                for row in measure_random(seed, options.each, folder, is_equipped)]
        if options.learn:
            judge_learning(rows + measure_random(SEED_OF_JUDGEMENT, options.each, folder, True))
            return 0
    ready = measure_ready()
    if options.fit:
        for kind in KINDS:
            costs = fit([row for row in rows + ready if row["kind"] == kind])
            cells = ", ".join(f"[PREDICTION_{term}] = {cost:.2e}" for term, cost in zip(TERMS, costs) if cost > 0)
            print(f"    [PREDICTION_{kind.upper()}] = {{ {cells} }},")
        print("reference_s of core/advice/prediction_measure.c, times what they are:",
              subprocess.check_output([PROGRAM, "speed"], text=True).replace("\n", " "))
        return 0
    are_ready_good = judge("ready", ready, 1.0)
    are_random_good = judge("random", rows, SHARE_OF_RANDOM)
    return 0 if are_ready_good and are_random_good else 1


if __name__ == "__main__":
    sys.exit(main())
