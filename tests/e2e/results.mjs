// The results of a run over HTTP against the files that the command line writes.

import assert from "node:assert/strict";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";

import { beltflow } from "./processes.mjs";
import { temporaryFolder } from "./setup.mjs";

// Solve with the command line; the folder with its results.
export async function solve(t, scenario, ...more) {
  const folder = temporaryFolder(t);
  const file = path.join(folder, "scenario.json");
  const out = path.join(folder, "out");
  writeFileSync(file, JSON.stringify(scenario));
  const done = await beltflow(["solve", file, "--model", "macro", "--out", out, ...more]);
  assert.equal(done.status, 0, done.stderr);
  return out;
}

// Members of a summary on timing and reuse, which are not results.
function withoutTiming(summary) {
  const { wall_time_s, threads, cell_steps_per_s, cached, ...rest } = summary;
  assert.ok(cached === undefined || cached === true, JSON.stringify(summary));
  assert.ok(wall_time_s >= 0 && threads >= 1 && cell_steps_per_s >= 0, JSON.stringify(summary));
  return rest;
}

// Curve, every snapshot and the summary are the same; the first two byte by byte.
export async function assertSameResults(d, id, folder) {
  const read = (name) => readFileSync(path.join(folder, name));
  const curve = await d.get(`/v1/runs/${id}/curve?format=csv`);
  assert.deepEqual(curve.text, read("curve.csv").toString());

  const files = readdirSync(path.join(folder, "snapshots")).sort();
  const { snapshots } = (await d.get(`/v1/runs/${id}/snapshots`)).json;
  assert.equal(snapshots.length, files.length);
  for (const [n, file] of files.entries()) {
    const snapshot = await d.get(`/v1/runs/${id}/snapshots/${n}?format=npy`);
    assert.ok(snapshot.body.equals(read(`snapshots/${file}`)), `snapshot ${n}`);
  }
  const summary = await d.get(`/v1/runs/${id}/summary`);
  assert.deepEqual(withoutTiming(summary.json), withoutTiming(JSON.parse(read("summary.json"))));
}
