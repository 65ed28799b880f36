// `executor = pull`: workers lease jobs and send the bytes of frames; what they leave, lose or damage is solved again, also
// by a daemon that was killed meanwhile, and results are those of `beltflow solve` and `beltflow study`.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { daemon } from "./daemon.mjs";
import { PullWorker } from "./pull_worker.mjs";
import { assertSameResults, assertSameStudy, solve } from "./results.mjs";
import { lengths, tiny } from "./scenarios.mjs";
import { until } from "./setup.mjs";
import { addToken } from "./tokens.mjs";

const solved = solve({ after }, tiny());
const pulling = { executor: "pull" };

test("a run is solved by the worker that asks for it", async (t) => {
  const d = await daemon(t, pulling);
  const run = await d.submit(tiny());
  assert.equal(run.status, "queued");
  assert.equal(await new PullWorker(d, "one").work(), 1);
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solved);
  const { workers } = (await d.get("/v1/leases")).json;
  assert.deepEqual(workers.map(({ worker, cores, leases }) => [worker, cores, leases]), [["one", 1, []]]);
  assert.match(d.log, /event=lease_ended lease=\S+ worker=one jobs=1 done=1/);
});

test("a worker that damages frames costs an attempt, not the run", async (t) => {
  const d = await daemon(t, pulling);
  const run = await d.submit(tiny());
  const liar = new PullWorker(d, "liar");
  const lease = await liar.lease();
  const frames = await liar.solve(lease.inputs[0]);
  frames[frames.length >> 1] ^= 4;
  await liar.deliverAll(lease, 0, frames);
  await until(() => d.log.includes(`event=worker_at_fault run=${run.id} worker=liar`), "the fault");
  assert.equal(await new PullWorker(d, "honest").work(), 1);
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solved);
  assert.match((await d.get("/metrics")).text, /beltflow_pull_faults_total 1\n/);
});

test("a worker that leaves gives its job back, and a cancelled run is gone for its worker", async (t) => {
  const d = await daemon(t, pulling);
  const run = await d.submit(tiny());
  const first = new PullWorker(d, "first");
  const lease = await first.lease();
  assert.equal((await d.request("DELETE", `/v1/leases/${lease.id}`)).status, 204);
  const second = new PullWorker(d, "second");
  const again = await second.lease();
  assert.ok(again.jobs[0].attempt > lease.jobs[0].attempt);
  assert.deepEqual(await first.renew(lease, [0]), [{ job: 0, next: 0, stop: "gone" }]);
  await d.post(`/v1/runs/${run.id}/cancel`, "");
  await until(async () => (await second.renew(again, [0]))[0].stop !== "none", "the stop");
  await second.renew(again, [], [{ job: 0, cause: "stopped", bytes: 0 }]);
  await d.reached(run.id, "cancelled");
});

test("a daemon that was killed takes the whole of a job from its worker", async (t) => {
  const d = await daemon(t, pulling);
  const run = await d.submit(tiny());
  const worker = new PullWorker(d, "one");
  const lease = await worker.lease();
  const frames = await worker.solve(lease.inputs[0]);
  await worker.deliver(lease, 0, frames, 0, frames.length >> 1);
  await d.reached(run.id, "running");
  await d.kill();
  await d.start();
  assert.deepEqual(await worker.renew(lease, [0]), [{ job: 0, next: 0, stop: "none" }]);
  await worker.deliverAll(lease, 0, frames);
  await worker.renew(lease, [], [{ job: 0, bytes: frames.length }]);
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solved);
});

test("workers need the scope, the same solver, and a service that has jobs for them", async (t) => {
  const local = await daemon(t);
  assert.equal((await new PullWorker(local, "one").ask()).status, 409);
  const d = await daemon(t, pulling);
  const other = await new PullWorker(d, "one").ask({ solver: "0.0.0-other" });
  assert.equal(other.status, 409);
  assert.match(other.json.detail, /0\.0\.0-other/);
  const bad = await new PullWorker(d, "no blanks").ask();
  assert.deepEqual(bad.json.errors.map(({ pointer }) => pointer), ["/worker"]);
  const reader = addToken(d.data, "reader", "--scopes", "read");
  const worker = addToken(d.data, "worker", "--scopes", "work");
  await until(async () => (await d.get("/v1/leases")).status === 401, "the tokens to count");
  assert.equal((await d.get("/v1/leases", reader)).status, 403);
  assert.equal((await d.get("/v1/leases", worker)).status, 200);
});

test("a study by two workers has the bytes of the command line", async (t) => {
  const study = lengths(20);
  const d = await daemon(t, pulling);
  const begun = await d.post("/v1/studies", study);
  assert.equal(begun.status, 201, begun.text);
  const hasEnded = async () => (await d.get(`/v1/studies/${begun.json.id}`)).json.status === "succeeded";
  const workers = [new PullWorker(d, "one"), new PullWorker(d, "two")];
  await Promise.race([
    Promise.all(workers.map(async (worker) => {
      while (!(await hasEnded())) await worker.work();
    })),
    until(hasEnded, "the end of the study"),
  ]);
  await assertSameStudy(t, d, begun.json.id, study);
});

// The frames of a run with the begin of another: whole, of the right run, and wrong.
function disguised(frames, begin) {
  const length = (bytes) => 16 + Math.ceil(Number(bytes.readBigUInt64LE(8)) / 8) * 8 + 8;
  return Buffer.concat([begin.subarray(0, length(begin)), frames.subarray(length(frames))]);
}

test("what a worker sent that lies is suspect, and solved again when it is submitted again", async (t) => {
  const d = await daemon(t, { ...pulling, check_every: 1 });
  const as = (headers) =>
    Object.assign(Object.create(d), { request: (method, target, more) => d.request(method, target, { ...more, headers: { ...more?.headers, ...headers } }) });
  const admin = as(addToken(d.data, "all", "--scopes", "admin"));
  const [liar, second, third] = ["liar", "second", "third"].map((name) =>
    new PullWorker(as(addToken(d.data, name, "--scopes", "work")), name));
  await until(async () => (await d.get("/v1/leases")).status === 401, "the tokens to count");
  const accept = async (scenario) => (await admin.post("/v1/runs", { model: "macro", scenario })).json;
  const deliver = async (worker, lease, frames) => {
    await worker.deliverAll(lease, 0, frames);
    await worker.renew(lease, [], [{ job: 0, bytes: frames.length }]);
  };
  const isSuspect = async ({ id }) => (await admin.get(`/v1/runs/${id}`)).json.suspect === true;
  for (const worker of [second, third]) assert.equal((await worker.ask()).json.id, null);

  const right = await accept(tiny({ initial: { positions_m: [[0.09, 0.06]] } }));
  const before = await liar.lease();
  const others = await liar.solve(before.inputs[0]);
  await deliver(liar, before, others);
  assert.equal(await second.work(), 1);
  const wrong = await accept(tiny());
  const lease = await liar.lease();
  await deliver(liar, lease, disguised(others, await liar.solve(lease.inputs[0])));
  await until(async () => (await admin.get(`/v1/runs/${wrong.id}`)).json.status === "succeeded", "the lie to be served");
  assert.equal(await second.work(), 1);
  await until(() => isSuspect(wrong), "the run that two have solved differently");
  assert.equal(await isSuspect(right), false);
  assert.equal(await third.work(), 1);
  await until(() => isSuspect(right), "what the liar sent before");

  const again = await accept(tiny());
  assert.equal(again.status, "queued");
  assert.equal(await third.work(), 1);
  const ended = async () => (await admin.get(`/v1/runs/${again.id}`)).json;
  await until(async () => (await ended()).status === "succeeded", "the end of the run");
  assert.equal((await ended()).suspect, undefined);
  await assertSameResults(admin, again.id, await solved);
});
