// A mixed load for some seconds, without and with the daemon being killed; tests/soak/soak.mjs is the long form.

import assert from "node:assert/strict";
import test from "node:test";

import { Load, openFiles } from "../soak/load.mjs";
import { daemon } from "./daemon.mjs";
import { runProgram } from "./processes.mjs";
import { isSanitized, until } from "./setup.mjs";

const seconds = isSanitized ? 2 : 4;

async function assertSound(d) {
  const { status, stdout, stderr } = await runProgram("beltflowd", ["--data", d.data, "verify"]);
  assert.equal(status, 0, stdout + stderr);
}

test("a mixed load leaves every accepted run ended, and no connection open", async (t) => {
  const d = await daemon(t, { workers: 2, retention_runs: 1000 });
  await d.get("/v1/runs");
  const before = openFiles(d.pid, "socket:");
  const load = new Load(d, { seconds, streams: 60, silent: 30 });
  await load.run();
  await load.settle({ retention_runs: 1000 });
  await until(() => openFiles(d.pid, "socket:") <= before, "connections to be closed");
  await d.stop();
  await assertSound(d);
});

test("a daemon that is killed under a mixed load loses and doubles no run", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const load = new Load(d, { seconds, streams: 10, silent: 10, kill_every_s: 1 });
  await load.run();
  assert.ok(load.counts.kills > 0);
  await load.settle();
  await d.stop();
  await assertSound(d);
});
