// What a run loses, and how long it stands still, when a part dies that solves it or lets it be solved: `node faults.mjs`. Each
// run ends with the bytes of `beltflow solve`, or this fails. Slurm wants root, slurm-wlm and munge. Some minutes, most of them
// waiting.

import { execFileSync, spawn } from "node:child_process";
import { rmSync, mkdtempSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

import { daemon } from "../../e2e/daemon.mjs";
import { assertSameResults } from "../../e2e/results.mjs";
import { jam } from "../../e2e/scenarios.mjs";
import { binaries, temporaryFolder } from "../../e2e/setup.mjs";
import { Slurm, freePort } from "../../e2e/slurm.mjs";

const patience_ms = 1_200_000;
const folder = mkdtempSync(path.join(tmpdir(), "beltflow-faults-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

// A scenario that is solved for some seconds, one for longer than a minute, and the folder of the results of each.
const [usual, long] = [250, 1800].map((duration_s) => {
  const scenario = jam(duration_s, { curve_every_s: 10, snapshot_every_s: 50 });
  const results = path.join(folder, String(duration_s));
  const file = `${results}.json`;
  writeFileSync(file, JSON.stringify(scenario));
  execFileSync(path.join(binaries, "beltflow"), ["solve", file, "--model", "macro", "--out", results], { stdio: "ignore" });
  return { scenario, results };
});

// Stands for a story: what is to be undone at its end.
class Story {
  undo = [];

  after(step) {
    this.undo.push(step);
  }

  async end() {
    for (const step of this.undo.reverse()) await step();
  }
}

async function awaited(ask, what) {
  const deadline = Date.now() + patience_ms;
  while (!(await ask())) {
    if (Date.now() > deadline) throw new Error(`waited ${patience_ms / 1000} s for ${what}`);
    await sleep(50);
  }
}

function worker(t, url, name) {
  const args = ["worker", "--pull", url, "--name", name, "--cores", "1", "--spool", temporaryFolder(t)];
  const child = spawn(path.join(binaries, "beltflow"), args, { stdio: "ignore" });
  t.after(() => child.kill("SIGKILL"));
  return child;
}

// A TCP proxy before a port, whose connections can be cut.
async function proxy(t, port) {
  const open = new Set();
  let isCut = false;
  const server = net.createServer((client) => {
    if (isCut) return client.destroy();
    const service = net.connect(port, "127.0.0.1");
    for (const [from, to] of [[client, service], [service, client]]) {
      open.add(from);
      from.on("error", () => {});
      from.on("close", () => (open.delete(from), to.destroy()));
      from.pipe(to);
    }
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const cut = (wanted) => {
    isCut = wanted;
    if (isCut) for (const socket of open) socket.destroy();
  };
  t.after(() => (cut(true), server.close()));
  return { url: `http://127.0.0.1:${server.address().port}/`, cut };
}

// A run that is being solved; prepare() gives what happens to it, which may say when it stood still.
async function measure(name, settings, prepare, { scenario, results } = usual) {
  const t = new Story();
  try {
    const port = await freePort();
    const more = typeof settings === "function" ? settings(t, port) : settings;
    const d = await daemon(t, { listen: `127.0.0.1:${port}`, checkpoint_ms: 1000, ...more });
    const strike = await prepare(t, d);
    const run = await d.submit(scenario);
    const progress = async () => (await d.run(run.id)).progress;
    await awaited(async () => (await progress()) > 0.02, "progress");
    const now = Date.now();
    const begin = (await strike()) ?? now;
    const at = await progress();
    await awaited(async () => (await progress()) > at, "more progress");
    const stood_s = (Date.now() - begin) / 1000;
    await awaited(async () => (await d.run(run.id)).status === "succeeded", "the end of the run");
    await assertSameResults(d, run.id, results);
    console.log(`${name}: nothing lost, on its way again after ${stood_s.toFixed(1)} s`);
  } finally {
    await t.end();
  }
}

const pull = { executor: "pull" };

await measure("worker killed (SIGKILL), another one there", pull, async (t, d) => {
  const first = worker(t, d.url, "first");
  return async () => {
    first.kill("SIGKILL");
    worker(t, d.url, "second");
  };
});

await measure("connection of the worker cut for 90 s, another one there", pull, async (t, d) => {
  const line = await proxy(t, d.port);
  worker(t, line.url, "first");
  return async () => {
    line.cut(true);
    setTimeout(() => line.cut(false), 90_000);
    worker(t, d.url, "second");
  };
});

await measure("connection of the only worker cut for 30 s", pull, async (t, d) => {
  const line = await proxy(t, d.port);
  worker(t, line.url, "only");
  return async () => {
    line.cut(true);
    await sleep(30_000);
    line.cut(false);
  };
});

await measure("daemon killed (SIGKILL) with a lease out", pull, async (t, d) => {
  worker(t, d.url, "one");
  return async () => {
    await d.kill();
    await d.start();
  };
});

const slurm = await Slurm.start(4);
if (typeof slurm === "string") {
  console.log(`SLURM CANNOT BE STARTED HERE, its faults are left out: ${slurm}`);
  process.exit(1);
}

// The usual script but for the time limit, which Slurm has in minutes.
const started = (t, port) => {
  const template = path.join(temporaryFolder(t), "template");
  writeFileSync(template, `#!/bin/sh
#SBATCH --ntasks=1 --cpus-per-task={cores} --time=1 --signal=B:TERM@30 --no-requeue --output=/dev/null
exec {program} worker --pull {url} {token} --cores {cores} --name slurm-\${SLURM_ARRAY_JOB_ID}_\${SLURM_ARRAY_TASK_ID}
`);
  const where = { executor: "slurm", slurm_url: `http://127.0.0.1:${port}`, slurm_template: template };
  return { ...where, slurm_workers: 1, slurm_cores: 1, slurm_interval_s: 1 };
};

try {
  const taskOf = async () => (await slurm.running())[0]?.id;
  await measure("time limit of a task reached (Slurm's SIGTERM 30 s before it)", started, async (t) => {
    t.after(() => slurm.cancelAll());
    return async () => {
      const id = await taskOf();
      await awaited(async () => (await taskOf()) !== id, "the end of the task");
      return Date.now();
    };
  }, long);
  await measure("slurmd killed (SIGKILL) under load", started, async (t) => {
    t.after(() => slurm.cancelAll());
    return async () => {
      await slurm.kill(slurm.node);
      slurm.startNode();
    };
  });
  await measure("slurmctld killed (SIGKILL), its state gone, and the task cancelled", started, async (t) => {
    t.after(() => slurm.cancelAll());
    return async () => {
      await slurm.kill(slurm.controller);
      slurm.startController("-c");
      await slurm.cancelAll();
    };
  });
} finally {
  await slurm.stop();
}
