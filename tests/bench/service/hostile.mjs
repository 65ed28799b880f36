// Workers that lie and workers that are drained: `node hostile.mjs liar [TRIES]` (2,000) and `node hostile.mjs drains [N]` (1,000).
// Each prints what it found, and ends with 1 where a run failed, was lost, or has another curve than an honest worker's.
//
// A liar leases a run, damages the frames of an honest solver or what it says of them, and delivers that; an honest worker
// solves what is left. A drained worker gets SIGTERM at a random moment, and the next one begins.

import { spawn } from "node:child_process";
import path from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

import { daemon } from "../../e2e/daemon.mjs";
import { PullWorker } from "../../e2e/pull_worker.mjs";
import { jam, tiny } from "../../e2e/scenarios.mjs";
import { binaries, temporaryFolder } from "../../e2e/setup.mjs";

const [part, given] = process.argv.slice(2);
const undo = [];
const t = { after: (step) => undo.push(step) };

// Numbers that come again in each execution (Lehmer's generator).
let seed = 1;
const random = (n) => ((seed = (seed * 48271) % 2147483647), seed % n);

// What is delivered in the place of good frames.
const damages = [
  (bytes) => void (bytes[random(bytes.length)] ^= 1 << random(8)),
  (bytes) => void bytes.writeUInt32LE(random(2147483647), 4 * random(bytes.length >> 2)),
  (bytes) => void bytes.fill(0, random(bytes.length)),
  (bytes) => bytes.subarray(0, random(bytes.length)),
  (bytes) => Buffer.concat([bytes, bytes.subarray(random(bytes.length))]),
  (bytes) => Buffer.concat([bytes.subarray(0, random(bytes.length)), bytes.subarray(random(bytes.length))]),
];

// What is said at the end, beside the number of bytes; these go with good frames.
const lies = [
  { cpu_s: 1e300 }, { cpu_s: -1 }, { attempt: 1 }, { bytes: 1 }, { bytes: 2 ** 52 }, { digest: "0".repeat(16) },
  { cause: "signalled" }, { cause: "memory" }, { cause: "exited", error: { code: "EINPUT", pointer: "", detail: "no" } },
];

async function tell(d, liar, lease, frames, lie) {
  const { run, attempt } = lease.jobs[0];
  const end = { job: 0, run, attempt, cpu_s: 0.01, cause: "exited", error: null, digest: null, bytes: frames.length, ...lie };
  await d.post(`/v1/leases/${lease.id}/renew`, { worker: liar.name, solver: await liar.solver(), jobs: [], ended: [end] });
  await d.request("DELETE", `/v1/leases/${lease.id}`);
}


async function lieAbout(tries) {
  const d = await daemon(t, { executor: "pull", run_attempts: 9 });
  const honest = new PullWorker(d, "honest");
  const submit = () => d.submit(tiny(), { fresh: true });
  const curveOf = async ({ id }) => (await d.get(`/v1/runs/${id}/curve.csv`)).text;
  const first = await submit();
  const lease = await honest.lease();
  const good = await honest.solve(lease.inputs[0]);
  await honest.deliverAll(lease, 0, good);
  await honest.renew(lease, [], [{ job: 0, bytes: good.length }]);
  await d.reached(first.id, "succeeded");
  const wanted = await curveOf(first);
  const isSuspended = (name) => new RegExp(`event=worker_suspended .*worker=${name}[ \n]`).test(d.log.slice(-20000));
  const found = { tries: 0, failed: 0, wrong: 0, liars: 0, suspended: 0 };
  for (let k = 0, name = 0; k < tries; k++) {
    const run = await submit();
    let liar = new PullWorker(d, `liar-${name}`);
    let { json } = await liar.ask();
    for (; json.id === null; ({ json } = await liar.ask())) {
      if (!isSuspended(liar.name)) await sleep(2);
      else liar = new PullWorker(d, `liar-${++name}`);
    }
    const kind = random(damages.length + lies.length);
    const bytes = Buffer.from(good);
    const frames = kind < damages.length ? (damages[kind](bytes) ?? bytes) : bytes;
    await liar.deliverAll(json, 0, frames).catch(() => {});
    await tell(d, liar, json, frames, lies[kind - damages.length]);
    const worker = new PullWorker(d, "honest");
    for (let status; (status = (await d.run(run.id)).status) !== "succeeded" && status !== "failed"; await sleep(5)) {
      const { json: mine } = await worker.ask();
      if (mine.id === null) continue;
      await worker.deliverAll(mine, 0, good);
      await worker.renew(mine, [], [{ job: 0, bytes: good.length }]);
    }
    found.tries += 1;
    if ((await d.run(run.id)).status === "failed") found.failed += 1;
    else if ((await curveOf(run)) !== wanted) found.wrong += 1;
    await d.request("DELETE", `/v1/runs/${run.id}`);
    found.liars = name + 1;
  }
  found.suspended = (d.log.match(/event=worker_suspended/g) ?? []).length;
  return found;
}

async function drain(n) {
  const d = await daemon(t, { executor: "pull" });
  const runs = [];
  let n_ended = 0;
  const found = { drains: 0, runs: 0, failed: 0 };
  const isOver = ({ status }) => ["succeeded", "failed", "cancelled"].includes(status);
  const look = async () => {
    for (; n_ended < runs.length; n_ended++) {
      const run = await d.run(runs[n_ended]);
      if (!isOver(run)) return;
      found.runs += 1;
      found.failed += run.status !== "succeeded";
    }
  };
  const worker = () => spawn(path.join(binaries, "beltflow"),
    ["worker", "--pull", d.url, "--name", "drained", "--cores", "2", "--spool", temporaryFolder(t)], { stdio: "ignore" });
  for (; found.drains < n; found.drains++) {
    await look();
    while (runs.length - n_ended < 4) runs.push((await d.submit(jam(20), { fresh: true })).id);
    const child = worker();
    const exited = new Promise((resolve) => child.on("close", resolve));
    await sleep(50 + random(700));
    child.kill("SIGTERM");
    await exited;
  }
  const last = worker();
  t.after(() => last.kill("SIGKILL"));
  while ((await look(), n_ended < runs.length)) await sleep(100);
  return found;
}

const began = Date.now();
const found = part === "liar" ? await lieAbout(Number(given ?? 2000)) : await drain(Number(given ?? 1000));
for (const step of undo.reverse()) await step();
console.log(`${part}: ${Object.entries(found).map(([name, n]) => `${n} ${name}`).join(", ")}, ${(Date.now() - began) / 1000} s`);
process.exit(found.failed > 0 || found.wrong > 0 ? 1 : 0);
