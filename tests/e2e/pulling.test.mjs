// `beltflow worker --pull`: what it solves for a daemon has the bytes of `beltflow solve`, also when the worker is stopped, or
// the daemon killed, in the middle; what is refused ends it.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { copyFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import test, { after } from "node:test";

import { daemon } from "./daemon.mjs";
import { beltflow, childrenOf, isAlive } from "./processes.mjs";
import { assertSameResults, assertSameStudy, solve } from "./results.mjs";
import { endless, fed, jam, lengths, tiny } from "./scenarios.mjs";
import { binaries, temporaryFolder, until, within } from "./setup.mjs";
import { makeToken } from "./tokens.mjs";

const solved = solve({ after }, tiny());
const pulling = { executor: "pull" };

// A worker of this story, which is stopped with it; { stop(signal), log(), pid }.
function worker(t, d, name, ...more) {
  const { folder = binaries } = typeof more[0] === "object" ? more.shift() : {};
  const args = ["worker", "--pull", d.url, "--name", name, "--cores", "1", "--spool", temporaryFolder(t), ...more];
  const child = spawn(path.join(folder, "beltflow"), args, { stdio: ["ignore", "ignore", "pipe"] });
  let log = "";
  child.stderr.on("data", (chunk) => (log += chunk));
  const exited = new Promise((resolve) => child.on("close", resolve));
  const w = { pid: child.pid, log: () => log, exited };
  w.stop = async (signal = "SIGTERM") => {
    const children = childrenOf(child.pid);
    child.kill(signal);
    const status = await within(exited, `the end of worker ${name}; its log:\n${log}`);
    await until(() => !children.some(isAlive), "the end of the children");
    return status;
  };
  t.after(() => child.kill("SIGKILL"));
  return w;
}

test("a worker with a token solves a run, and ends when it is idle", async (t) => {
  const d = await daemon(t, pulling);
  const run = await d.submit(tiny());
  const file = path.join(temporaryFolder(t), "token");
  writeFileSync(file, `${makeToken(d.data, "one", "--scopes", "work")}\n`);
  const admin = { authorization: `Bearer ${makeToken(d.data, "all", "--scopes", "read,admin")}` };
  await until(async () => (await d.get("/v1/leases")).status === 401, "the tokens to count");
  const w = worker(t, d, "one", "--token-file", file, "--idle-s", "3");
  assert.equal(await within(w.exited, "the idle worker's end"), 0, w.log());
  const hasSucceeded = async () => (await d.get(`/v1/runs/${run.id}`, admin)).json.status === "succeeded";
  await until(hasSucceeded, "the end of the run");
  assert.match(w.log(), /event=lease_begun lease=\S+ jobs=1[^]*event=lease_ended/);
});

test("a worker that is stopped saves its run, and another goes on from there", async (t) => {
  const d = await daemon(t, pulling);
  const scenario = jam(60, { curve_every_s: 0.5, snapshot_every_s: 20 });
  const run = await d.submit(scenario);
  const first = worker(t, d, "first");
  await until(async () => (await d.run(run.id)).progress > 0, "progress");
  assert.equal(await first.stop(), 0, first.log());
  await until(() => d.log.includes("state=queued"), "the end of the first attempt");
  assert.deepEqual((await d.get("/v1/leases")).json.workers.flatMap(({ leases }) => leases), []);
  const second = worker(t, d, "second");
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solve(t, scenario));
  assert.equal(await second.stop("SIGINT"), 0, second.log());
});

test("a run whose frames are longer than the spool is solved piece by piece", async (t) => {
  const d = await daemon(t, pulling);
  // 61 snapshots of 300 x 180 floats, 13 MB, through a spool of 6 MB.
  const scenario = jam(0.6, { curve_every_s: 0.01, snapshot_every_s: 0.01 });
  scenario.macro = { ...scenario.macro, cell_m: scenario.macro.cell_m / 3 };
  delete scenario.macro.step_s;
  const run = await d.submit(scenario);
  const w = worker(t, d, "one", "--spool-bytes", "6000000");
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solve(t, scenario));
  assert.match(w.log(), /event=spool_f(ills|ull) run=/);
  assert.equal(await w.stop(), 0, w.log());
});

// A snapshot alone, 600 x 360 floats, is more than three of the smallest bodies that a daemon with workers may have as its limit.
test("a worker sends no larger bodies than the daemon takes", async (t) => {
  const d = await daemon(t, { ...pulling, body_bytes: 262144 });
  const scenario = jam(0.02, { curve_every_s: 0.01, snapshot_every_s: 0.01 });
  scenario.macro = { ...scenario.macro, cell_m: scenario.macro.cell_m / 6 };
  delete scenario.macro.step_s;
  const run = await d.submit(scenario);
  const w = worker(t, d, "one");
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solve(t, scenario));
  await until(() => /event=lease_ended .*bytes=/.test(d.log), "the end of the lease");
  const sent = Number(/event=lease_ended .*bytes=(\d+)/.exec(d.log)[1]);
  assert.ok(sent > 3 * 600 * 360 * 4, `${sent}`);
  const answered = /requests_total\{route="\/v1\/leases\/\{id\}\/frames",method="PUT",code="(\d+)"\} (\d+)/g;
  const codes = [...(await d.get("/metrics")).text.matchAll(answered)];
  assert.deepEqual(codes.map(([, code]) => code), ["200"]);
  assert.ok(Number(codes[0][2]) > sent / 262144, codes[0][0]);
  assert.equal(await w.stop(), 0, w.log());
});

// Each of its three tries is its own fault, and no attempt of the run.
test("a worker that cannot start a solver gives its jobs back", async (t) => {
  const d = await daemon(t, pulling);
  const run = await d.submit(tiny());
  const folder = temporaryFolder(t);
  copyFileSync(path.join(binaries, "beltflow"), path.join(folder, "beltflow"));
  writeFileSync(path.join(folder, "beltflow-worker"), "of another machine\n", { mode: 0o755 });
  const broken = worker(t, d, "broken", { folder });
  await until(() => d.log.includes("event=worker_suspended worker=broken"), "the suspension");
  assert.notEqual((await d.run(run.id)).status, "failed");
  assert.equal(await broken.stop(), 0, broken.log());
  const w = worker(t, d, "one");
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solved);
  assert.equal(await w.stop(), 0, w.log());
});

test("a daemon that was killed has the whole of a run from its worker", async (t) => {
  const d = await daemon(t, { ...pulling, listen: "127.0.0.1:0" });
  const run = await d.submit(endless());
  const w = worker(t, d, "one");
  await until(async () => (await d.run(run.id)).progress > 0, "progress");
  const [child] = childrenOf(w.pid);
  await d.kill();
  d.settings.listen = `127.0.0.1:${d.port}`;
  await until(() => w.log().includes("event=service_lost"), "the loss");
  await d.start();
  await until(() => w.log().includes("event=service_back"), "the daemon");
  await until(async () => (await d.run(run.id)).progress > 0, "more progress");
  assert.deepEqual(childrenOf(w.pid), [child]);
  await d.post(`/v1/runs/${run.id}/cancel`, "");
  await d.reached(run.id, "cancelled");
  const again = await d.submit(tiny());
  await d.reached(again.id, "succeeded");
  await assertSameResults(d, again.id, await solved);
  assert.equal(await w.stop(), 0, w.log());
});

test("a study has the bytes of the command line, and few requests a trial", async (t) => {
  const study = lengths(12);
  const d = await daemon(t, pulling);
  const { id } = (await d.post("/v1/studies", study)).json;
  const w = worker(t, d, "one");
  await until(async () => (await d.get(`/v1/studies/${id}`)).json.status === "succeeded", "the end of the study");
  await assertSameStudy(t, d, id, study);
  const counts = (await d.get("/metrics")).text;
  const found = /requests_total\{route="\/v1\/leases\/\{id\}\/frames",method="PUT",code="200"\} (\d+)/.exec(counts);
  // One or two each, more only while a trial takes longer than 250 ms.
  assert.ok(Number(found[1]) < 10 * 12, counts);
  assert.equal(await w.stop(), 0, w.log());
});

test("workers of two tokens have the same results of runs that both solve", async (t) => {
  const d = await daemon(t, { ...pulling, check_every: 1 });
  const token = (name, scopes) => {
    const file = path.join(temporaryFolder(t), "token");
    writeFileSync(file, `${makeToken(d.data, name, "--scopes", scopes)}\n`);
    return file;
  };
  const files = [token("one", "work"), token("two", "work")];
  const admin = { authorization: `Bearer ${makeToken(d.data, "all", "--scopes", "admin")}` };
  await until(async () => (await d.get("/v1/leases")).status === 401, "the tokens to count");
  const workers = files.map((file, k) => worker(t, d, `worker-${k}`, "--token-file", file));
  const hasBoth = async () => (await d.get("/v1/leases", admin)).json.workers.length === 2;
  await until(hasBoth, "both workers");
  // Feeds, photo eyes, plates that move, and of the microscopic model rows of parts.
  const bodies = ["macro", "micro"].flatMap((model) => [tiny(), fed()].map((scenario) => ({ model, scenario })));
  for (const body of bodies) assert.equal((await d.post("/v1/runs", body, admin)).status, 201);
  const compared = async (match) =>
    Number(new RegExp(`duplicates_total\\{match="${match}"\\} (\\d+)`).exec((await d.get("/metrics", admin)).text)[1]);
  await until(async () => (await compared("equal")) === bodies.length, "each to be solved twice");
  assert.equal(await compared("unequal"), 0);
  for (const w of workers) assert.equal(await w.stop(), 0, w.log());
});

test("a daemon that refuses ends the worker, and its words are told", async (t) => {
  const local = await daemon(t);
  const refused = await beltflow(["worker", "--pull", local.url]);
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /this service solves runs itself/);
  const file = path.join(temporaryFolder(t), "token");
  writeFileSync(file, "two words");
  const bad = await beltflow(["worker", "--pull", local.url, "--token-file", file]);
  assert.equal(bad.status, 2);
  assert.match(bad.stderr, /holds more than a token/);
});
