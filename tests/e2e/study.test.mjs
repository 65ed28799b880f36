// `beltflow study`: a study is made, interrupted, killed and gone on with, and its document is refused where it is wrong.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { beltflow } from "./processes.mjs";
import { jam, tiny } from "./scenarios.mjs";
import { binaries, isThreadSanitized, temporaryFolder, until, within } from "./setup.mjs";

const angle = { pointer: "/obstacles/0/angle_deg", range: [60, 90] };

// A plate that ends at (0.75, 0.5) and leaves 0.1 m free; the counter is upstream of it.
function plate(duration_s) {
  const scenario = jam(duration_s, { curve_every_s: 0.05, snapshot_every_s: duration_s });
  scenario.obstacles = [{ end_m: [0.75, 0.5], angle_deg: 60.0, length_m: 0.6 }];
  return scenario;
}

function studyOf(changes) {
  return {
    name: "which angle",
    base: { scenario: plate(1) },
    parameters: [{ ...angle, steps: 12 }],
    objectives: [{ figure: "content.mean" }, { figure: "throughput_per_h", goal: "maximize" }],
    method: { type: "grid" },
    ...changes,
  };
}

function write(t, document) {
  const folder = temporaryFolder(t);
  const file = path.join(folder, "in.json");
  writeFileSync(file, JSON.stringify(document));
  return { file, out: path.join(folder, "out"), other: path.join(folder, "other") };
}

function rows(folder) {
  const [header, ...lines] = readFileSync(path.join(folder, "trials.csv"), "utf8").trimEnd().split("\n");
  const names = header.split(",");
  return lines.map((line) => Object.fromEntries(line.split(",").map((value, k) => [names[k], value])));
}

const best = (folder) => JSON.parse(readFileSync(path.join(folder, "best.json"), "utf8"));

test("a sweep has a line for each trial, with the figures that solve has, and the best one", async (t) => {
  const { file, out, other } = write(t, studyOf({}));
  const done = await beltflow(["study", file, "--out", out]);
  assert.deepEqual([done.status, done.stderr], [0, ""]);
  const trials = rows(out);
  assert.equal(trials.length, 12);
  assert.deepEqual(trials.map((trial) => Number(trial.trial)), [...trials.keys()]);
  assert.ok(trials.every((trial) => trial.state === "succeeded" && trial.fault === ""));
  const contents = trials.map((trial) => Number(trial["content.mean"]));
  const found = best(out);
  assert.deepEqual(JSON.parse(done.stdout), found);
  // Without feeds nothing is left to chance: the set has all points within the indifference, and the best is one of them.
  const near = [...contents.keys()].filter((k) => contents[k] - Math.min(...contents) <= found.indifference);
  assert.deepEqual(found.set.map(({ point }) => point), near);
  assert.ok(near.includes(found.best.point));
  // Its cells are not those that the models were compared with.
  assert.ok(found.warnings.some((text) => text.includes("cell")), `${found.warnings}`);
  const scenario = plate(1);
  scenario.obstacles[0].angle_deg = Number(trials[5]["/obstacles/0/angle_deg"]);
  const solved = await beltflow(["solve", "-", "--out", other], { input: JSON.stringify(scenario) });
  assert.equal(solved.status, 0);
  const { key_figures: figures } = JSON.parse(readFileSync(path.join(other, "summary.json"), "utf8"));
  assert.equal(figures.counters[0].content.mean, contents[5]);
  assert.equal(figures.throughput_per_h, Number(trials[5].throughput_per_h));
});

// A child that makes a study; it is stopped by a signal when its file has some lines.
async function cut(file, out, signal, lines) {
  const child = spawn(path.join(binaries, "beltflow"), ["study", file, "--out", out], { stdio: "ignore" });
  const exited = once(child, "close");
  const trials = path.join(out, "trials.csv");
  await until(
    () => existsSync(trials) && readFileSync(trials, "utf8").split("\n").length > lines + 1,
    "lines of trials",
  );
  child.kill(signal);
  return within(exited, "the end of the study");
}

test("a study that is interrupted and killed goes on with the same trials, and ends with the same bytes", async (t) => {
  const scenario = plate(isThreadSanitized ? 0.5 : 2); // which takes longer there than 2 s elsewhere
  const { file, out, other } = write(t, studyOf({ base: { scenario }, method: { type: "cmaes" }, limits: { trials: 32 } }));
  assert.deepEqual(await cut(file, out, "SIGINT", 3), [130, null]);
  assert.equal(best(out).is_ended, false);
  assert.deepEqual(await cut(file, out, "SIGKILL", rows(out).length + 3), [null, "SIGKILL"]);
  // A line that was torn by the end of the program.
  const torn = readFileSync(path.join(out, "trials.csv"));
  writeFileSync(path.join(out, "trials.csv"), torn.subarray(0, torn.length - 9));
  assert.equal((await beltflow(["study", file, "--out", out])).status, 0);
  assert.equal((await beltflow(["study", file, "--out", other, "--workers", "1"])).status, 0);
  for (const name of ["trials.csv", "best.json", "study.json"])
    assert.deepEqual(readFileSync(path.join(out, name)), readFileSync(path.join(other, name)), name);
  assert.equal(rows(out).length, 32);
  assert.equal(best(out).is_ended, true);
});

// At 90 degrees a closed gate; where the plate leaves room the belt is empty long before the end.
test("runs that cannot be the best any more are pruned, and the best one is the same", async (t) => {
  const scenario = { ...plate(60), until: "drained" };
  scenario.macro.mollifier_per_m2 = 10000;
  const study = studyOf({
    base: { scenario },
    parameters: [{ pointer: "/obstacles/0/length_m", values: [0.2, 0.6, 0.6001, 0.6002] }],
    objectives: [{ figure: "drained_at_s" }],
    method: { type: "list", prune: true },
  });
  const { file, out } = write(t, study);
  assert.equal((await beltflow(["study", file, "--out", out, "--workers", "1"])).status, 0);
  assert.equal(best(out).best.point, 0);
  const states = rows(out).map((trial) => trial.state);
  assert.equal(states[0], "succeeded");
  assert.ok(states.includes("pruned"), `${states}`);
});

test("both models screen a plate's angle: each confirmed point has what both say", async (t) => {
  const scenario = plate(2);
  scenario.initial.hexagonal = { ...scenario.initial.hexagonal, rows: 4, columns: 4, first_m: [0.5, 0.4] };
  scenario.micro = { integrator: "implicit", modulus_reduction: 1e4 };
  const { file, out } = write(
    t,
    studyOf({
      base: { scenario },
      parameters: [{ ...angle, steps: 4 }],
      objectives: [{ figure: "content.mean" }],
      method: { type: "screen", sweep: "grid", confirm: 2, indifference: 0.1 },
      replications: 2,
      limits: { trials: 20 },
    }),
  );
  const done = await beltflow(["study", file, "--out", out]);
  assert.equal(done.status, 0);
  const found = best(out);
  // Without feeds all replications are equal, so each point is solved once, and the better one is known.
  assert.equal(found.is_decided, true);
  assert.equal(found.has_chance, false);
  assert.equal(found.trials, 4 + 2);
  assert.deepEqual(found.confirmed.map((point) => point.is_in_set).sort(), [false, true]);
  assert.deepEqual(found.set.map(({ point }) => point), [found.best.point]);
  assert.match(found.verdicts.find(({ kind }) => kind === "confirmed").text, /^The microscopic model compared angle_deg .* by 1 run each\./);
  for (const { micro, macro, difference } of found.confirmed) {
    assert.deepEqual(micro.parameters, macro.parameters);
    const [a, b] = [macro, micro].map((point) => point.values["content.mean"].mean);
    assert.ok(Math.abs(difference - (a - b)) < 1e-9);
  }
  assert.equal(found.best.model, "micro");
});

test("a calibration finds the mollifier that a curve was made with, and says what the curve does not tell", async (t) => {
  const scenario = plate(6);
  Object.assign(scenario.obstacles[0], { band_m: 0.08, slide_width_m: 0.03 });
  const { file, out, other } = write(t, {});
  const made = { ...scenario, macro: { ...scenario.macro, cell_m: 0.02, mollifier_per_m2: 8000 } };
  assert.equal((await beltflow(["solve", "-", "--out", other], { input: JSON.stringify(made) })).status, 0);
  const curve = readFileSync(path.join(other, "curve.csv"), "utf8").trimEnd().split("\n").slice(1);
  const [t_s, count] = [0, 1].map((k) => curve.map((line) => Number(line.split(",")[k])));
  const base = structuredClone(made);
  base.macro.mollifier_per_m2 = 10000.0;
  base.micro = { modulus_reduction: 1e5 };
  writeFileSync(
    file,
    JSON.stringify({
      base: { scenario: base },
      parameters: [
        { pointer: "/macro/mollifier_per_m2", range: [5000, 16000], scale: "log" },
        { pointer: "/micro/modulus_reduction", range: [1e4, 1e6], scale: "log" },
      ],
      curves: [{ counter: "upstream", t_s, count }],
      method: { type: "calibrate", points: 8 },
      limits: { trials: 140 },
    }),
  );
  assert.equal((await beltflow(["study", file, "--out", out])).status, 0);
  const found = best(out);
  const value = found.best.parameters["/macro/mollifier_per_m2"];
  assert.ok(Math.abs(value - 8000) <= 400, `${value}`);
  assert.deepEqual(found.profiles.map((profile) => profile.is_identifiable), [true, false]);
});

test("numbers that a scenario cannot have make trials infeasible, with their place", async (t) => {
  const { file, out } = write(
    t,
    studyOf({
      base: { scenario: tiny() },
      parameters: [{ pointer: "/macro/cell_m", values: [0.01, -1, 0.02] }],
      objectives: [{ figure: "peak_density" }],
      method: { type: "list" },
    }),
  );
  assert.equal((await beltflow(["study", file, "--out", out])).status, 0);
  const trials = rows(out);
  assert.deepEqual(trials.map((trial) => trial.state), ["succeeded", "infeasible", "succeeded"]);
  assert.match(trials[1].fault, /^"?\/macro\/cell_m: /);
});

test("a directory that another process has open is refused, and left as it is", async (t) => {
  const { file, out } = write(t, studyOf({}));
  mkdirSync(out);
  const holder = spawn("flock", [out, "sh", "-c", "echo held; exec cat"], { stdio: ["pipe", "pipe", "inherit"] });
  const ended = once(holder, "close");
  await within(once(holder.stdout, "data"), "the lock");
  const refused = await beltflow(["study", file, "--out", out]);
  holder.stdin.end();
  await within(ended, "the end of the holder");
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /is used by another study/);
  assert.deepEqual(readdirSync(out), []);
});

test("what is wrong with a study, its directory or its flags is said, and leaves with 2", async (t) => {
  const { file, out, other } = write(t, studyOf({}));
  for (const [changes, pointer] of [
    [{ parameters: [{ ...angle, pointer: "/obstacles/7/angle_deg" }] }, "/parameters/0/pointer"],
    [{ parameters: [{ ...angle, pointer: "/counters/0/id" }] }, "/parameters/0/pointer"],
    [{ parameters: [{ ...angle, range: [90, 60] }] }, "/parameters/0"],
    [{ objectives: [{ figure: "queue_end_m" }] }, "/objectives/0/figure"],
    [{ limits: { trials: 1e9 } }, "/limits/trials"],
    [{ base: studyOf({}) }, "/base/parameters"],
    [{ base: { scenario: { ...plate(1), duration_s: -1 } } }, "/base/scenario/duration_s"],
  ]) {
    const refused = await beltflow(["study", "-", "--out", out], { input: JSON.stringify(studyOf(changes)) });
    assert.equal(refused.status, 2, pointer);
    assert.match(refused.stderr, new RegExp(`^${pointer}: `, "m"));
    assert.ok(!existsSync(out));
  }
  assert.equal((await beltflow(["study", file, "--out", other])).status, 0);
  const another = await beltflow(["study", "-", "--out", other], { input: JSON.stringify(studyOf({ seed: 2 })) });
  assert.equal(another.status, 2);
  assert.match(another.stderr, /another study/);
  assert.equal((await beltflow(["study", file])).status, 2);
  assert.equal((await beltflow(["study", file, "--out", other, "--workers", "0"])).status, 2);
});
