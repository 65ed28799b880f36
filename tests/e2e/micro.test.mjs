// The microscopic model through all layers, like the macroscopic one, with its parts.

import assert from "node:assert/strict";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import {
  assertSameMicroResults, badMicroScenarios, longJam, readDoubles, shortMix, smallJam, solveMicro,
} from "./micro.mjs";
import { beltflow } from "./processes.mjs";
import { solve } from "./results.mjs";
import { isSanitized, temporaryFolder } from "./setup.mjs";

const micro = { model: "micro" };


test("a microscopic run gives the bytes of the command line", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(smallJam(), { ...micro, label: "parts" });
  assert.deepEqual([run.model, run.label], ["micro", "parts"]);
  await d.reached(run.id, "succeeded");
  await assertSameMicroResults(d, run.id, await solveMicro(t, smallJam()));
  const { runs } = (await d.get("/v1/runs?model=micro")).json;
  assert.deepEqual(runs.map(({ id }) => id), [run.id]);
});

test("a validation lists the parts as they stand when the run begins", async (t) => {
  const d = await daemon(t);
  const random = { ...shortMix(), initial: { random: { count: 40, region: { x_m: [0.05, 0.4], y_m: [0.05, 0.55] } } } };
  for (const scenario of [shortMix(), random]) {
    const { parts } = (await d.post("/v1/validate?parts=20000", { scenario, ...micro })).json;
    const run = await d.submit(scenario, micro);
    await d.reached(run.id, "succeeded");
    const { kinds } = (await d.get(`/v1/runs/${run.id}/snapshots`)).json;
    const { columns, parts: rows } = (await d.get(`/v1/runs/${run.id}/parts/0?format=json`)).json;
    const [x, y, w, z] = ["x_m", "y_m", "q_w", "q_z"].map((name) => columns.indexOf(name));
    assert.deepEqual(parts.map((part) => [part.x_m, part.y_m, part.kind]), rows.map((row, k) => [row[x], row[y], kinds[k]]));
    parts.forEach((part, k) => assert.ok(Math.abs(part.heading_rad - 2 * Math.atan2(rows[k][z], rows[k][w])) < 1e-12));
  }
});

test("a snapshot that is told of leads to its parts, at once and for ever", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(smallJam(), micro);
  const stream = await d.events(run.id);
  const told = [];
  for (const event of await stream.rest()) {
    if (event.event !== "snapshot") continue;
    const { n, parts_url: url, mass } = event.data;
    assert.equal(url, `/v1/runs/${run.id}/parts/${n}`);
    const answer = await d.get(url);
    assert.equal(answer.status, 200, answer.text);
    assert.match(answer.headers["cache-control"], /immutable/);
    const rows = readDoubles(answer.body);
    assert.deepEqual([rows.length, rows[0].length], [20, 6]);
    assert.equal(rows.filter(([x]) => !Number.isNaN(x)).length, mass);
    const again = await d.get(url, { "if-none-match": answer.headers.etag });
    assert.deepEqual([again.status, again.body.length], [304, 0]);
    told.push(n);
  }
  assert.deepEqual(told, [0, 1, 2, 3]);
});

test("parts come as NumPy file, CSV and JSON, the same numbers in each", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(smallJam(), micro);
  await d.reached(run.id, "succeeded");
  const target = `/v1/runs/${run.id}/parts/3`;
  const rows = readDoubles((await d.get(target)).body);
  const { columns, parts, t_s } = (await d.get(`${target}?format=json`)).json;
  assert.deepEqual(columns, ["x_m", "y_m", "heading_rad", "vx_m_s", "vy_m_s", "spin_rad_s"]);
  assert.ok(Math.abs(t_s - 0.3) < 1e-9);
  assert.deepEqual(parts, rows);
  const lines = (await d.get(target, { accept: "text/csv" })).text.trimEnd().split("\n");
  assert.equal(lines[0], `part,${columns.join(",")}`);
  assert.deepEqual(lines.slice(1).map((line) => line.split(",").map(Number)), rows.map((row, k) => [k, ...row]));
  assert.equal((await d.get(target, { accept: "image/png" })).status, 406);
});

test("there are no parts beyond the last snapshot, nor of a macroscopic run", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(smallJam(), micro);
  const other = await d.submit(smallJam());
  await d.reached(run.id, "succeeded");
  await d.reached(other.id, "succeeded");
  for (const target of [`${run.id}/parts/4`, `${run.id}/parts/x`, `${other.id}/parts/0`]) {
    assert.equal((await d.get(`/v1/runs/${target}`)).status, 404, target);
  }
  const { snapshots, parts } = (await d.get(`/v1/runs/${other.id}/snapshots`)).json;
  assert.equal(parts, undefined);
  assert.equal(snapshots[0].parts_url, undefined);
});

test("kill -9 in the middle: a microscopic run ends with the bytes of an undisturbed one", async (t) => {
  const d = await daemon(t, { checkpoint_ms: 30 });
  const run = await d.submit(longJam(), micro);
  for (const share of [0.2, 0.5]) {
    await d.progressed(run.id, share);
    await d.kill();
    await d.start();
  }
  await d.reached(run.id, "succeeded");
  await assertSameMicroResults(d, run.id, await solveMicro(t, longJam()));
});

test("threads change no bit of the parts", async (t) => {
  const folders = [await solveMicro(t, smallJam()), await solveMicro(t, smallJam(), "--threads", "2")];
  const names = ["snapshots", "parts"].flatMap((kind) =>
    readdirSync(path.join(folders[0], kind)).map((name) => `${kind}/${name}`));
  for (const name of ["curve.csv", ...names]) {
    const [one, two] = folders.map((folder) => readFileSync(path.join(folder, name)));
    assert.ok(one.equals(two), name);
  }
});

test("both models of a scenario compare: their curves, and their densities cell by cell", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const runs = [await d.submit(smallJam()), await d.submit(smallJam(), micro)];
  for (const { id } of runs) await d.reached(id, "succeeded");
  const { curve, density } = (await d.get(`/v1/compare?a=${runs[0].id}&b=${runs[1].id}`)).json;
  assert.equal(curve.t_end_s, 0.3);
  assert.ok(curve.l1 > 0 && curve.l1 <= curve.largest && curve.largest <= 20);
  assert.equal(density.same_grid, true);
  assert.deepEqual(density.snapshots.map(({ a, b }) => [a, b]), [0, 1, 2, 3].map((n) => [n, n]));
  // Both begin with the same density (18) of the same parts; only rounding errors are left.
  assert.ok(density.snapshots[0].mean_abs < 1e-6);

  const folders = [await solve(t, smallJam()), await solveMicro(t, smallJam())];
  const done = await beltflow(["compare", "--json", ...folders]);
  assert.equal(done.status, 0, done.stderr);
  assert.deepEqual(JSON.parse(done.stdout).pairs[0].curve, curve);
});

test("a mix of shapes moves in space, and its parts have unit quaternions", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(shortMix(), micro);
  await d.reached(run.id, "succeeded");
  const { parts, snapshots } = (await d.get(`/v1/runs/${run.id}/snapshots`)).json;
  assert.deepEqual([parts.rows, parts.columns.length], [6, 13]);
  const rows = readDoubles((await d.get(snapshots.at(-1).parts_url)).body);
  for (const [x, y, , ...rest] of rows) {
    assert.ok(x > 0 && x < 1 && y > 0 && y < 0.6);
    assert.ok(Math.abs(Math.hypot(...rest.slice(0, 4)) - 1) < 1e-9);
  }
  const summary = (await d.get(`/v1/runs/${run.id}/summary`)).json;
  assert.deepEqual([summary.path, summary.parts], ["spatial", 6]);
  await assertSameMicroResults(d, run.id, await solveMicro(t, shortMix()));
});

test("the implicit integrator chooses its step, and samples come at their times", async (t) => {
  const out = await solveMicro(t, smallJam({ micro: { integrator: "implicit" } }));
  const { step_s } = JSON.parse(readFileSync(path.join(out, "summary.json")));
  assert.ok(step_s > 1e-5 && step_s <= 2e-3, `${step_s}`);
  const times = readFileSync(path.join(out, "curve.csv"), "utf8").trimEnd().split("\n").slice(1);
  assert.equal(times.length, 31);
  for (const [k, line] of times.entries()) assert.ok(Math.abs(parseFloat(line) - k / 100) < 1e-12, line);
});

// 999 m/s for 1e-5 s are 10 mm, and half a radius is 6 mm.
test("a run whose numbers fail says in which step, when, which part and where", async (t) => {
  const d = await daemon(t);
  const belts = [{ id: "main", velocity_m_s: [999, 0] }];
  const soft = { integrator: "verlet", modulus_reduction: 1e6, overlap_limit: 1 };
  const run = await d.submit(smallJam({ belts, duration_s: 0.01, micro: soft }), micro);
  await d.reached(run.id, "failed");
  const { status, error } = (await d.get(`/v1/runs/${run.id}`)).json;
  assert.equal(status, "failed");
  assert.equal(error.code, "numeric");
  assert.match(error.detail, /part \d+ moved by more than half a radius in step 1 \(t = 1e-05 s\), at \(/);
  // What it had before stays: the start.
  const { t_s } = (await d.get(`/v1/runs/${run.id}/curve`)).json;
  assert.deepEqual(t_s, [0]);
});

test("the implicit integrator moves a mix of shapes in space", async (t) => {
  const out = await solveMicro(t, { ...shortMix(), micro: { integrator: "implicit", modulus_reduction: 1e6 } });
  const summary = JSON.parse(readFileSync(path.join(out, "summary.json")));
  assert.deepEqual([summary.path, summary.parts], ["spatial", 6]);
  assert.ok(summary.step_s >= 2e-4 && summary.step_s <= 2e-3, `${summary.step_s}`);
});

test("each bad microscopic scenario is a 422 that names its place, and nothing is stored", async (t) => {
  const d = await daemon(t);
  assert.ok(badMicroScenarios.length >= 15);
  for (const { what, scenario, pointer, words } of badMicroScenarios) {
    await t.test(what, async () => {
      for (const target of ["/v1/runs", "/v1/validate"]) {
        const answer = await d.post(target, { scenario, ...micro });
        assert.equal(answer.status, 422, answer.text);
        const found = answer.json.errors.find((error) => error.pointer === `/scenario${pointer}`);
        assert.ok(found, `${pointer} is not in ${answer.text}`);
        assert.match(found.detail, words);
      }
    });
  }
  assert.deepEqual((await d.get("/v1/runs")).json.runs, []);
});

test("the command line names the same places, before it writes anything", async (t) => {
  const folder = temporaryFolder(t);
  const out = path.join(folder, "out");
  for (const { what, scenario, pointer, words } of badMicroScenarios) {
    await t.test(what, async () => {
      const input = JSON.stringify(scenario);
      const checked = await beltflow(["check", "-", "--model", "micro"], { input });
      const solved = await beltflow(["solve", "-", "--model", "micro", "--out", out], { input });
      for (const done of [checked, solved]) {
        assert.equal(done.status, 2, done.stderr);
        const line = done.stderr.split("\n").find((text) => text.startsWith(`${pointer}: `));
        assert.ok(line, `${pointer} is not in ${done.stderr}`);
        assert.match(line, words);
      }
    });
  }
  assert.deepEqual(readdirSync(folder), []);
});

test("a macroscopic run in the same folder leaves nothing of the parts", async (t) => {
  const out = await solveMicro(t, smallJam());
  assert.ok(readdirSync(out).includes("parts"));
  const file = path.join(temporaryFolder(t), "scenario.json");
  writeFileSync(file, JSON.stringify(smallJam()));
  const done = await beltflow(["solve", file, "--model", "macro", "--out", out]);
  assert.equal(done.status, 0, done.stderr);
  assert.deepEqual(readdirSync(out).sort(), ["curve.csv", "scenario.json", "snapshots", "snapshots.json", "summary.json"]);
});

test("Example 1 of both models drains alike", { skip: isSanitized }, async (t) => {
  const d = await daemon(t, { workers: 2 });
  const scenario = (await d.get("/v1/examples/example-1")).json;
  const runs = [await d.submit(scenario), await d.submit(scenario, micro)];
  for (const { id } of runs) await d.reached(id, "succeeded");
  const { curve } = (await d.get(`/v1/compare?a=${runs[0].id}&b=${runs[1].id}`)).json;
  // The mean gap over 6 s was measured as 0.6 % of the 192 parts.
  assert.ok(curve.l1 < 0.03 * 192, `l1 = ${curve.l1}`);
});
