// Retention, copies of a store, and verification of a store.

import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, readdirSync, statSync, writeFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";

import { daemon } from "./daemon.mjs";
import { runProgram } from "./processes.mjs";
import { assertSameResults, solve } from "./results.mjs";
import { endless, interruptible, tiny } from "./scenarios.mjs";
import { until } from "./setup.mjs";

// beltflowd with a command about the store of d.
function maintain(d, ...words) {
  return runProgram("beltflowd", ["--data", d.data, ...words]);
}

async function assertSound(d, ...words) {
  const done = await maintain(d, "verify", ...words);
  assert.equal(done.status, 0, done.stdout + done.stderr);
  assert.match(done.stdout, /^ok +I4 /m);
  assert.match(done.stdout, / is sound\n$/);
}

test("beyond retention_runs the runs that ended first go, and work stays (I12)", async (t) => {
  const d = await daemon(t);
  const ended = [];
  for (let k = 0; k < 5; k++) {
    const run = await d.submit(tiny({ duration_s: 0.1 + 0.01 * k }));
    ended.push(await d.reached(run.id, "succeeded"));
  }
  const busy = await d.submit(endless());
  const waiting = await d.submit(tiny());
  await d.stop();
  d.settings.retention_runs = 2;
  await d.start();
  await until(async () => (await d.get("/v1/runs?status=succeeded")).json.runs.length === 2, "two");
  const { runs } = (await d.get("/v1/runs")).json;
  const kept = [...ended.slice(-2).map(({ id }) => id), busy.id, waiting.id];
  assert.deepEqual(new Set(runs.map(({ id }) => id)), new Set(kept));
  assert.match(d.log, /event=run_expired run=\S+ rule=retention_runs/);
  await d.stop();
  await assertSound(d);
});

test("a copy that was made under load serves the same results (I1)", async (t) => {
  const d = await daemon(t, { workers: 2, checkpoint_ms: 20 });
  const scenario = tiny();
  const solved = await d.submit(scenario);
  await d.reached(solved.id, "succeeded");
  const cached = (await d.post("/v1/runs", { scenario })).json;
  const long = await d.submit(interruptible());
  await d.progressed(long.id, 0.2);
  for (let k = 0; k < 20; k++) await d.submit(tiny({ duration_s: 0.2 + 0.01 * k }));

  const file = path.join(d.folder, "copy");
  const copied = await maintain(d, "backup", file);
  assert.equal(copied.status, 0, copied.stderr);
  assert.equal(statSync(file).mode & 0o777, 0o600);
  await assertSound(d, file);
  await assertSound(d); // and the one in use
  const again = await maintain(d, "backup", file);
  assert.equal(again.status, 2);
  assert.match(again.stderr, /there already/);
  await d.stop();

  // The copy takes the place of the store; finished runs are there, others continue.
  d.data = path.join(d.folder, "restored");
  mkdirSync(d.data);
  copyFileSync(file, path.join(d.data, "beltflow.db"));
  await d.start();
  const folder = await solve(t, scenario);
  await assertSameResults(d, solved.id, folder);
  await assertSameResults(d, cached.id, folder);
  await d.reached(long.id, "succeeded");
  await assertSameResults(d, long.id, await solve(t, interruptible()));
  await d.stop();
  await assertSound(d);
});

test("a damaged store is told from a sound one", async (t) => {
  const d = await daemon(t);
  await d.reached((await d.submit(tiny())).id, "succeeded");
  await d.stop();
  const file = path.join(d.folder, "copy");
  assert.equal((await maintain(d, "backup", file)).status, 0);
  assert.deepEqual(
    readdirSync(d.folder).filter((name) => name.startsWith("copy")),
    ["copy"],
  );
  assert.equal((await maintain(d, "--verify", file)).status, 0);
  const size = statSync(file).size;
  writeFileSync(file, Buffer.alloc(size - 8192, 0x55), { flag: "r+" });
  const done = await maintain(d, "verify", file);
  assert.equal(done.status, 1, done.stdout);
  assert.match(done.stdout + done.stderr, /damaged/);
});

test("commands about stores say what is wrong with their arguments", async (t) => {
  const d = await daemon(t);
  for (const [words, reason] of [
    [["backup"], /the name of a new file/],
    [["revive", "x"], /no command/],
    [["restore", path.join(d.folder, "missing")], /there is no file/],
    [["verify", "a", "b"], /nothing else fits/],
    [["verify", path.join(d.folder, "missing")], /there is no store/],
  ]) {
    const done = await maintain(d, ...words);
    assert.equal(done.status, 2, done.stderr);
    assert.match(done.stderr, reason);
  }
  const lost = await maintain(d, "backup", path.join(d.folder, "missing", "copy"));
  assert.equal(lost.status, 1);
  assert.match(lost.stderr, /cannot write beside/);
});
