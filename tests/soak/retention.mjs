// How long requests take while retention removes a large store, and, where the disk is short, its pages are given back:
//
//     TMPDIR=DIR node tests/soak/retention.mjs [MEGABYTES]
//
// Fills a store (200 MB by default), starts the daemon again with a limit that all those runs exceed, and times submissions
// and reads until all is removed and the file does not get shorter any more. Pages are given back where less than 128 MiB
// are free, so DIR is then on a file system of some 100 MB more than the store. Prints the times of an idle daemon first.

import { statSync } from "node:fs";
import path from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

import { daemon } from "../e2e/daemon.mjs";
import { tiny } from "../e2e/scenarios.mjs";
import { until } from "../e2e/setup.mjs";
import { quantile } from "./load.mjs";

const [megabytes = "200"] = process.argv.slice(2);
const json = { "content-type": "application/json" };

// Some MB: 10,000 disks on their way, in 41 snapshots.
const large = {
  duration_s: 0.02,
  domain: { x_m: [0, 4], y_m: [0, 3] },
  obstacles: [{ from_m: [2.5, 0], to_m: [3.5, 2.9] }],
  cargo: { shape: { type: "cylinder", radius_m: 0.012, height_m: 0.008 } },
  initial: { hexagonal: { rows: 100, columns: 100, first_m: [0.1, 0.1], spacing_m: 0.0241 } },
  output: { curve_every_s: 0.01, snapshot_every_s: 0.0005 },
  macro: { closure: "dispersive", cell_m: 0.05 },
};

const bytesOf = (d) => statSync(path.join(d.data, "beltflow.db")).size;

async function submit(d, model, scenario, changes = {}) {
  const body = JSON.stringify({ model, scenario, ...changes });
  const answer = await d.send({ method: "POST", target: "/v1/runs", headers: json, body });
  if (answer.status !== 201) throw new Error(answer.text);
  return answer.json.id;
}

async function fill(d) {
  for (let n = 0; bytesOf(d) < Number(megabytes) * 1e6; n++) {
    const id = await submit(d, "micro", large, { fresh: true, label: "large" });
    await until(async () => (await d.send({ method: "GET", target: `/v1/runs/${id}` })).json.status === "succeeded",
      "a large run", 600_000);
  }
}

// Milliseconds of each exchange until isOver(): a run whose results are known, which nothing solves, and its document.
async function time(d, isOver) {
  const times = { POST: [], GET: [] };
  const note = async (kind, exchange) => {
    const begin = performance.now();
    const result = await exchange();
    times[kind].push(performance.now() - begin);
    return result;
  };
  while (!(await isOver())) {
    const id = await note("POST", () => submit(d, "macro", tiny()));
    for (let k = 0; k < 4; k++) {
      await note("GET", () => d.send({ method: "GET", target: `/v1/runs/${id}` }));
      await sleep(5);
    }
  }
  return times;
}

function report(title, times) {
  for (const [kind, list] of Object.entries(times)) {
    const sorted = list.toSorted((a, b) => a - b);
    const [p50, p99, max] = [0.5, 0.99, 1].map((share) => quantile(sorted, share).toFixed(1));
    console.log(`${title}: ${kind} ${list.length} times, p50 ${p50} ms, p99 ${p99} ms, slowest ${max} ms`);
  }
}

const ends = [];
try {
  const d = await daemon({ after: (end) => ends.push(end) }, { workers: 2 });
  await fill(d);
  const first = await submit(d, "macro", tiny());
  await until(async () => (await d.send({ method: "GET", target: `/v1/runs/${first}` })).json.status === "succeeded", "a run");
  const idle_until = performance.now() + 5000;
  report("idle", await time(d, () => performance.now() > idle_until));
  const before = bytesOf(d);
  await d.stop();
  d.settings.retention_runs = 100;
  await d.start();
  const begin = performance.now();
  let size = 0, changed = begin;
  const isOver = async () => {
    if (bytesOf(d) !== size) [size, changed] = [bytesOf(d), performance.now()];
    const { json: list } = await d.send({ method: "GET", target: "/v1/runs?label=large&limit=1" });
    return list.runs.length === 0 && performance.now() > changed + 3000;
  };
  report("retention", await time(d, isOver));
  console.log(`${(before / 1e6).toFixed(0)} MB became ${(size / 1e6).toFixed(0)} MB in ${((changed - begin) / 1000).toFixed(1)} s`);
} finally {
  for (const end of ends) await end();
}
