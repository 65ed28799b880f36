// Workers that Slurm starts: what is solved has the bytes of the command line, whichever part of Slurm dies meanwhile. One
// Slurm for all stories, with four cores whatever the machine has.

import assert from "node:assert/strict";
import path from "node:path";
import test, { after, before } from "node:test";

import { daemon } from "./daemon.mjs";
import { runProgram } from "./processes.mjs";
import { assertSameResults, assertSameStudy, solve } from "./results.mjs";
import { jam, lengths, tiny } from "./scenarios.mjs";
import { binaries, until } from "./setup.mjs";
import { Slurm, freePort } from "./slurm.mjs";

let slurm;

before(async () => {
  slurm = await Slurm.start(4);
  if (typeof slurm === "string") console.log(`# SLURM CANNOT BE STARTED HERE, its stories are skipped: ${slurm}`);
});

after(async () => {
  if (typeof slurm !== "string") await slurm.stop();
});

// A story with a daemon whose workers Slurm starts.
function story(name, body) {
  test(name, async (t) => {
    if (typeof slurm === "string") return t.skip(slurm);
    const port = await freePort();
    const settings = { executor: "slurm", listen: `127.0.0.1:${port}`, slurm_url: `http://127.0.0.1:${port}` };
    const pace = { slurm_workers: 4, slurm_cores: 1, slurm_interval_s: 1, slurm_idle_s: 5 };
    const d = await daemon(t, { ...settings, ...pace });
    t.after(() => slurm.cancelAll());
    return body(t, d);
  });
}

// A study of n trials that take some hundredths of a second each.
async function begin(d, n) {
  const study = lengths(n, 1);
  const answer = await d.post("/v1/studies", study);
  assert.equal(answer.status, 201, answer.text);
  return { study, id: answer.json.id };
}

// Solved in some seconds: while Slurm's programs are asked and obey, there is work left.
const longJam = () => jam(300, { curve_every_s: 1.5, snapshot_every_s: 6 });

async function assertSolved(t, d, { study, id }) {
  await until(async () => (await d.get(`/v1/studies/${id}`)).json.status === "succeeded", "the end of the study");
  await assertSameStudy(t, d, id, study);
}

async function countOf(d, name) {
  const found = new RegExp(`^${name} (\\d+)$`, "m").exec((await d.get("/metrics")).text);
  return Number(found[1]);
}

story("a study over four workers has the bytes of the command line, and its workers end when they are idle", async (t, d) => {
  const study = await begin(d, 60);
  await until(async () => (await slurm.running()).length === 4, "four workers");
  await assertSolved(t, d, study);
  assert.equal(await countOf(d, "beltflow_slurm_tasks_submitted_total"), 4);
  await until(async () => (await slurm.tasks()).length === 0, "the end of the idle workers");
});

story("a controller that was killed after it took an array forgets it, and it is submitted again", async (t, d) => {
  await slurm.kill(slurm.node); // nothing begins
  const run = await d.submit(tiny());
  await until(() => d.log.includes("event=slurm_submitted"), "a submission");
  await slurm.kill(slurm.controller);
  await until(() => d.log.includes("event=slurm_failed"), "a failure");
  slurm.startController("-c"); // as if its state had not been written
  slurm.startNode();
  await d.reached(run.id, "succeeded");
  assert.equal(await countOf(d, "beltflow_slurm_tasks_submitted_total"), 2);
});

story("a node's daemon that is killed under load costs nothing", async (t, d) => {
  const study = await begin(d, 40);
  await until(async () => (await d.get(`/v1/studies/${study.id}`)).json.trials.succeeded > 0, "a trial");
  await slurm.kill(slurm.node);
  slurm.startNode();
  await assertSolved(t, d, study);
});

story("a daemon that is killed with leases out finds its workers again", async (t, d) => {
  const scenario = longJam();
  const run = await d.submit(scenario);
  await d.progressed(run.id, 0.1);
  await d.kill();
  await d.start();
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solve(t, scenario));
  assert.equal(await countOf(d, "beltflow_slurm_tasks_submitted_total"), 0);
});

story("a worker at its time limit hands its run to another one", async (t, d) => {
  const scenario = longJam();
  const run = await d.submit(scenario);
  await d.progressed(run.id, 0.1);
  const [{ id }] = await slurm.running();
  await slurm.ask("scancel", "--batch", "--signal=TERM", id); // as --signal=B:TERM@120 does
  await until(async () => !(await slurm.running()).some((task) => task.id === id), "the worker's end");
  await d.reached(run.id, "succeeded");
  await assertSameResults(d, run.id, await solve(t, scenario));
  assert.equal(await countOf(d, "beltflow_slurm_tasks_submitted_total"), 2);
});

test("a dry run prints the script, and says what is missing", async () => {
  const script = await runProgram("beltflowd", ["slurm", "--dry-run", "--slurm-url", "http://head:1", "--slurm-cores", "3"]);
  assert.equal(script.status, 0, script.stderr);
  assert.match(script.stdout, /^#!\/bin\/sh\n#SBATCH [^]*--cpus-per-task=3\n/);
  assert.ok(script.stdout.includes(`exec '${path.join(binaries, "beltflow")}' worker --pull 'http://head:1'`));
  const without = await runProgram("beltflowd", ["slurm", "--dry-run"]);
  assert.equal(without.status, 2);
  assert.match(without.stderr, /slurm_url must say/);
  const unknown = await runProgram("beltflowd", ["slurm"]);
  assert.equal(unknown.status, 2);
  assert.match(unknown.stderr, /slurm wants --dry-run/);
});
