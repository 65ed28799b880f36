// A long mixed load:
//
//     node tests/soak/soak.mjs [SECONDS [NAME=VALUE ...]]
//
// NAME is a number of clients of tests/soak/load.mjs (submitters, streams, silent), kill_every_s, or retention_runs.
// 60 s, 1,000 streams, 150 clients that do not read, and 500 runs that are kept by default. Prints memory, open files and
// the store's size over time, and the times of health and of a run's document. Status 1 when something that
// was accepted is missing, or when the store is not sound.

import assert from "node:assert/strict";

import { daemon } from "../e2e/daemon.mjs";
import { runProgram } from "../e2e/processes.mjs";
import { Load } from "./load.mjs";

const [seconds = "60", ...rest] = process.argv.slice(2);
const given = Object.fromEntries(rest.map((word) => word.split("=")).map(([name, value]) => [name, Number(value)]));
const { retention_runs, ...sizes } = { retention_runs: 500, submitters: 4, streams: 1000, silent: 150, kill_every_s: 0, ...given };

const ends = [];
try {
  const d = await daemon({ after: (end) => ends.push(end) },
    { workers: 2, retention_runs, streams: 1300, connections: 4000, idempotency_hours: 1 });
  const load = new Load(d, { seconds: Number(seconds), ...sizes });
  await load.run((figures) => console.log(JSON.stringify(figures)));
  const left = await load.settle({ retention_runs });
  console.log(`${load.report()}\n${left} runs are left\nat rest: ${JSON.stringify(load.figures())}`);
  await d.stop();
  const verified = await runProgram("beltflowd", ["--data", d.data, "verify"]);
  assert.equal(verified.status, 0, verified.stdout + verified.stderr);
} finally {
  for (const end of ends) await end();
}
