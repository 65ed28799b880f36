// The results of a run over HTTP against the files that the command line writes.

import assert from "node:assert/strict";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";

import { beltflow } from "./processes.mjs";
import { temporaryFolder } from "./setup.mjs";

// The folder with the results of a command for a document.
async function execute(t, command, document, more) {
  const folder = temporaryFolder(t);
  const file = path.join(folder, "in.json");
  const out = path.join(folder, "out");
  writeFileSync(file, JSON.stringify(document));
  const done = await beltflow([command, file, "--out", out, ...more]);
  assert.equal(done.status, 0, done.stderr);
  return out;
}

// Solve with the command line; the folder with its results.
export function solve(t, scenario, ...more) {
  return execute(t, "solve", scenario, ["--model", "macro", ...more]);
}

// The trials of a study that has ended, and the best, are those of the command line, byte by byte.
export async function assertSameStudy(t, d, id, study) {
  const out = await execute(t, "study", study, []);
  const read = (name) => readFileSync(path.join(out, name), "utf8");
  for (const name of ["trials?format=csv", "trials.csv"]) {
    assert.equal((await d.get(`/v1/studies/${id}/${name}`)).text, read("trials.csv"), name);
  }
  assert.equal((await d.get(`/v1/studies/${id}/best`)).text.trim(), read("best.json").trim());
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
