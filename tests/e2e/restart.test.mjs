// The daemon is stopped, by signal or by crash, and restarted: no accepted run is lost, no child is
// left, and results are those of an undisturbed run.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { daemon } from "./daemon.mjs";
import { childrenOf, isAlive, runProgram } from "./processes.mjs";
import { assertSameResults, solve } from "./results.mjs";
import { endless, interruptible, tiny } from "./scenarios.mjs";
import { isSanitized, until } from "./setup.mjs";

// The folder with the results of interruptible(), solved once.
const undisturbed = solve({ after }, interruptible());

test("kill -9 in the middle: the run ends with the bytes of an undisturbed one (I1, I5)", async (t) => {
  const d = await daemon(t, { checkpoint_ms: 50 });
  const run = await d.submit(interruptible());
  await d.progressed(run.id, 0.05); // early, so that its end does not come before the kill
  await d.kill();
  await d.start();
  await d.reached(run.id, "succeeded");
  assert.match(d.log, /runs_requeued\b.*\bruns=1\b/, "it had ended before the kill");
  await assertSameResults(d, run.id, await undisturbed);
});

test("kill -9 again and again: the run gets on, and ends with the same bytes", async (t) => {
  const d = await daemon(t, { checkpoint_ms: 20 });
  const run = await d.submit(interruptible());
  const times = isSanitized ? 3 : 8;
  for (let k = 1; k <= times; k++) {
    await d.progressed(run.id, k / (2 * times)); // the second half is for its end not to come before the kill
    await d.kill();
    await d.start();
  }
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await undisturbed);
});

test("kill -9 at random moments of a busy life loses no run (I1, I3, I8)", async (t) => {
  const d = await daemon(t, { workers: 2, checkpoint_ms: 20 });
  const accepted = [];
  for (let life = 0; life < 5; life++) {
    for (let k = 0; k < 10; k++) accepted.push((await d.submit(tiny({ duration_s: 0.5 }))).id);
    await d.kill();
    await d.start();
    const { runs } = (await d.get("/v1/runs?limit=200")).json;
    assert.deepEqual(new Set(runs.map((run) => run.id)), new Set(accepted));
  }
  for (const id of accepted) await d.reached(id, "succeeded");
});

test("a run goes on from its checkpoint, not from the start", async (t) => {
  const d = await daemon(t, { checkpoint_ms: 20 });
  const run = await d.submit(interruptible());
  await d.progressed(run.id, 0.3);
  await d.kill();
  await d.start();
  assert.ok((await d.run(run.id)).progress >= 0.1);
  const stream = await d.events(run.id);
  const events = await stream.rest();
  let reached = 0;
  for (const { data } of events.filter((event) => event.event === "progress")) {
    assert.ok(data.progress >= reached - 0.2, "progress fell back to the start");
    reached = data.progress;
  }
});

test("SIGTERM hands back what runs, and the next start goes on with it", async (t) => {
  const d = await daemon(t, { checkpoint_ms: 60_000 });
  const run = await d.submit(interruptible());
  const waiting = await d.submit(tiny());
  await d.progressed(run.id, 0.1);
  await d.stop();
  await d.start();
  const back = await d.run(run.id);
  assert.ok(["queued", "running"].includes(back.status), JSON.stringify(back));
  assert.ok(back.progress >= 0.1, "no checkpoint was taken on the way out");
  await d.reached(run.id, "succeeded");
  await d.reached(waiting.id, "succeeded");
  await assertSameResults(d, run.id, await undisturbed);
});

test("no child outlives a daemon that was killed", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const runs = [await d.submit(endless()), await d.submit(endless())];
  for (const run of runs) await d.progressed(run.id, 1e-6);
  const children = childrenOf(d.pid);
  assert.equal(children.length, 2);
  await d.kill(); // fails if they are still there
  assert.ok(!children.some(isAlive));
});

test("what a killed daemon left queued is there, in its order", async (t) => {
  const d = await daemon(t);
  const first = await d.submit(endless(), { priority: 10 });
  await d.reached(first.id, "running");
  const waiting = [await d.submit(tiny()), await d.submit(tiny())];
  await d.kill();
  await d.start();
  await d.reached(first.id, "running");
  for (const run of waiting) assert.equal((await d.run(run.id)).status, "queued");
  await d.post(`/v1/runs/${first.id}/cancel`, "");
  for (const run of waiting) await d.reached(run.id, "succeeded");
});

test("a second daemon on the same data is refused and harms nothing (I2)", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(endless());
  await d.reached(run.id, "running");
  const second = await runProgram("beltflowd", d.flags());
  assert.equal(second.status, 1);
  assert.match(second.stderr, /another|in use|held|locked/);
  assert.equal((await d.run(run.id)).status, "running");
  assert.equal((await d.get("/readyz")).status, 200);
});

test("a daemon stops within seconds with open streams, busy runs and a full queue", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const runs = [];
  for (let k = 0; k < 10; k++) runs.push(await d.submit(endless()));
  const streams = [];
  for (let k = 0; k < 50; k++) streams.push(await d.events(runs[k % runs.length].id));
  await d.progressed(runs[0].id, 1e-6);
  const started = Date.now();
  await d.stop(); // status 0, no child left
  assert.ok(Date.now() - started < 30_000, `${Date.now() - started} ms`); // runs and streams have no end
  for (const stream of streams) await stream.rest();
  await d.start();
  await until(async () => (await d.get("/v1/runs?status=running")).json.runs.length === 2, "two runs");
});
