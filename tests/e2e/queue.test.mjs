// The queue: what waits, what runs, in which order, and what happens to a run that goes wrong.

import assert from "node:assert/strict";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { childrenOf } from "./processes.mjs";
import { endless, interruptible, jam, tiny } from "./scenarios.mjs";
import { isSanitized, until } from "./setup.mjs";

const cancel = (d, run) => d.post(`/v1/runs/${run.id}/cancel`, "");

test("one worker solves one run at a time, two workers two", async (t) => {
  for (const workers of [1, 2]) {
    const d = await daemon(t, { workers });
    for (let k = 0; k < 3; k++) await d.submit(endless());
    const count = async (status) => (await d.get(`/v1/runs?status=${status}`)).json.runs.length;
    await until(async () => (await count("running")) === workers, `${workers} to run`);
    assert.equal(await count("queued"), 3 - workers);
    assert.equal(childrenOf(d.pid).length, workers);
    await d.stop();
  }
});

test("higher priorities come first, equal ones in their order", async (t) => {
  const d = await daemon(t, { workers: 1 });
  const first = await d.submit(endless(), { priority: 100 });
  await d.reached(first.id, "running");
  const wanted = [];
  for (const priority of [0, 5, -5, 5, 0]) {
    wanted.push({ priority, id: (await d.submit(tiny(), { priority })).id });
  }
  await cancel(d, first);
  for (const { id } of wanted) await d.reached(id, "succeeded");
  const ended = [];
  for (const { id } of wanted) ended.push({ id, at: (await (await d.events(id)).rest()).at(-1).id });
  ended.sort((a, b) => Number(a.at) - Number(b.at));
  const expected = [...wanted].sort((a, b) => b.priority - a.priority);
  assert.deepEqual(ended.map(({ id }) => id), expected.map(({ id }) => id));
});

test("a queued run that is cancelled never runs, and says so on its stream", async (t) => {
  const d = await daemon(t);
  await d.reached((await d.submit(endless())).id, "running");
  const run = await d.submit(tiny());
  const stream = await d.events(run.id);
  const answer = await cancel(d, run);
  assert.deepEqual([answer.status, answer.json.status], [200, "cancelled"]);
  const events = await stream.rest();
  assert.deepEqual(
    events.map((event) => [event.event, event.data.status]),
    [["status", "queued"], ["status", "cancelled"], ["end", "cancelled"]],
  );
  const ended = await d.run(run.id);
  assert.deepEqual([ended.status, ended.started_at], ["cancelled", null]);
});

test("a running run that is cancelled keeps what it has and frees its worker", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(endless());
  const stream = await d.events(run.id);
  assert.ok(await stream.until("snapshot"));
  assert.equal((await cancel(d, run)).status, 202);
  assert.equal((await stream.rest()).at(-1).data.status, "cancelled");
  await d.reached(run.id, "cancelled");
  const { t_s, columns: { upstream } } = (await d.get(`/v1/runs/${run.id}/curve`)).json;
  assert.ok(t_s.length > 0 && t_s.length === upstream.length);
  assert.equal((await d.get(`/v1/runs/${run.id}/snapshots/0`)).status, 200);
  assert.equal((await d.get(`/v1/runs/${run.id}/summary`)).status, 200);
  await d.reached((await d.submit(tiny())).id, "succeeded");
});

test("what has ended cannot be cancelled", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  const answer = await cancel(d, run);
  assert.equal(answer.status, 409);
  assert.equal((await d.run(run.id)).status, "succeeded");
});

test("a running run can be removed; its child goes with it", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(endless());
  await d.progressed(run.id, 1e-6);
  const children = childrenOf(d.pid);
  assert.equal(children.length, 1);
  assert.equal((await d.request("DELETE", `/v1/runs/${run.id}`)).status, 204);
  assert.equal((await d.get(`/v1/runs/${run.id}`)).status, 404);
  await d.assertGone(children);
  await d.reached((await d.submit(tiny())).id, "succeeded");
});

test("a full queue refuses for a while, and takes again when there is room", async (t) => {
  const d = await daemon(t, { queue_limit: 2 });
  await d.reached((await d.submit(endless())).id, "running");
  const waiting = [await d.submit(tiny()), await d.submit(tiny())];
  const answer = await d.post("/v1/runs", { scenario: tiny() });
  assert.equal(answer.status, 503, answer.text);
  assert.match(answer.headers["retry-after"], /^\d+$/);
  await cancel(d, waiting[0]);
  assert.equal((await d.post("/v1/runs", { scenario: tiny() })).status, 201);
});

test("a run beyond its memory fails and says so; the next one is solved", { skip: isSanitized }, async (t) => {
  const d = await daemon(t, { run_memory_bytes: 200_000_000 });
  const large = jam(1, { curve_every_s: 0.1, snapshot_every_s: 1 });
  large.macro = { closure: "dispersive", cell_m: 0.0002, step_s: "auto" }; // 15 million cells
  large.macro.mollifier_per_m2 = 1e6;
  const failed = await d.reached((await d.submit(large)).id, "failed");
  assert.match(`${failed.error.code} ${failed.error.detail}`, /memory/);
  assert.equal((await d.get("/livez")).status, 200);
  await d.reached((await d.submit(tiny())).id, "succeeded");
});

test("a run beyond its CPU time fails and says so; the next one is solved", async (t) => {
  const d = await daemon(t, { run_cpu_s: 1 });
  const failed = await d.reached((await d.submit(endless())).id, "failed");
  assert.match(failed.error.detail, /CPU/);
  await d.reached((await d.submit(tiny())).id, "succeeded");
});

test("a run whose process is killed fails and says so; the daemon lives on", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(endless());
  await d.progressed(run.id, 1e-6);
  const [child] = childrenOf(d.pid);
  process.kill(child, "SIGKILL");
  const failed = await d.reached(run.id, "failed");
  assert.match(failed.error.detail, /SIGKILL|signal 9|[Kk]illed/);
  const events = await (await d.events(run.id)).rest();
  assert.equal(events.at(-1).data.status, "failed");
  await d.reached((await d.submit(tiny())).id, "succeeded");
});

test("a stopped process holds up neither a cancel nor a removal for ever", async (t) => {
  const d = await daemon(t);
  for (const [method, target, status] of [["POST", "/cancel", 202], ["DELETE", "", 204]]) {
    const run = await d.submit(endless());
    await d.progressed(run.id, 1e-6);
    const children = childrenOf(d.pid);
    process.kill(children[0], "SIGSTOP");
    assert.equal((await d.request(method, `/v1/runs/${run.id}${target}`)).status, status);
    await d.assertGone(children);
    if (method === "POST") await d.reached(run.id, "cancelled");
  }
});

test("many runs submitted at once are all accepted and all solved", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const runs = await Promise.all(Array.from({ length: 40 }, () => d.submit(tiny())));
  assert.equal(new Set(runs.map((run) => run.id)).size, 40);
  for (const run of runs) await d.reached(run.id, "succeeded");
});

test("cancelling, removing and restarting at once leaves only legal states (I3, I9)", async (t) => {
  const d = await daemon(t, { workers: 2, checkpoint_ms: 20 });
  const runs = [];
  for (let k = 0; k < 12; k++) runs.push(await d.submit(k % 2 ? interruptible() : tiny()));
  const answers = await Promise.all(
    runs.map((run, k) =>
      k % 3 === 0 ? cancel(d, run) : k % 3 === 1 ? d.request("DELETE", `/v1/runs/${run.id}`) : d.get(`/v1/runs/${run.id}`),
    ),
  );
  for (const answer of answers) assert.ok([200, 202, 204, 409].includes(answer.status), answer.text);
  await d.stop();
  await d.start();
  for (const [k, run] of runs.entries()) {
    const answer = await d.get(`/v1/runs/${run.id}`);
    assert.equal(answer.status, k % 3 === 1 ? 404 : 200);
    if (k % 3 === 0) assert.ok(["cancelled", "succeeded"].includes(answer.json.status), answer.text);
  }
});
