// A worker of a story, step by step: leases jobs of a daemon, has `beltflow-worker` solve them, delivers what that says.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import path from "node:path";

import { binaries, root } from "./setup.mjs";

const header = readFileSync(path.join(root, "core/run/run.h"), "utf8");
const runVersion = /RUN_VERSION = (\d+)/.exec(header)[1];
const section_bytes = 512 * 1024;

export class PullWorker {
  constructor(d, name, cores = 1) {
    this.d = d;
    this.name = name;
    this.cores = cores;
  }

  // The name of the solver that this tree has, as server/base/solver.h has it.
  async solver() {
    const { version } = (await this.d.get("/version")).json;
    return `${version}/${runVersion}`;
  }

  // POST /v1/leases; the answer.
  async ask(changes = {}) {
    const who = { worker: this.name, solver: await this.solver(), cores: this.cores, memory_bytes: 1e9 };
    return this.d.post("/v1/leases", { ...who, ...changes });
  }

  // A lease with jobs, and the input of each.
  async lease() {
    for (;;) {
      const { status, json, text } = await this.ask();
      assert.equal(status, 200, text);
      if (json.id !== null) return { ...json, inputs: await this.inputs(json) };
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  }

  async inputs(lease) {
    const answer = await this.d.request("GET", `/v1/leases/${lease.id}/jobs`);
    assert.equal(answer.status, 200, answer.text);
    let at = 0;
    return lease.jobs.map(({ bytes }) => answer.body.subarray(at, (at += bytes)));
  }

  // All frames of a job.
  async solve(input) {
    const child = spawn(path.join(binaries, "beltflow-worker"), ["worker", "--checkpoint-ms", "50"], {
      stdio: ["pipe", "pipe", "inherit"],
    });
    const chunks = [];
    child.stdout.on("data", (chunk) => chunks.push(chunk));
    child.stdin.end(input);
    await once(child, "close");
    return Buffer.concat(chunks);
  }

  // Bytes `from` to `to` of a job's frames; what is answered of the job.
  async deliver(lease, job, frames, from = 0, to = frames.length) {
    const header = Buffer.alloc(16);
    header.writeUInt32LE(job, 0);
    header.writeUInt32LE(to - from, 4);
    header.writeBigUInt64LE(BigInt(from), 8);
    const answer = await this.d.request("PUT", `/v1/leases/${lease.id}/frames`, {
      headers: { "content-type": "application/octet-stream" },
      body: Buffer.concat([header, frames.subarray(from, to)]),
    });
    assert.equal(answer.status, 200, answer.text);
    return answer.json.jobs.find((state) => state.job === job);
  }

  // Everything, as fast as the daemon takes it.
  async deliverAll(lease, job, frames) {
    for (let at = 0; at < frames.length; ) {
      const to = Math.min(at + section_bytes, frames.length);
      const { next, stop } = await this.deliver(lease, job, frames, at, to);
      if (stop === "gone") return;
      if (next === at) await new Promise((resolve) => setTimeout(resolve, 20));
      at = next;
    }
  }

  // Jobs of a lease that go on, and ends of others; the states that are answered.
  async renew(lease, jobs, ended = []) {
    const report = (job) => {
      const { run, attempt } = lease.jobs[job];
      return { job, run, attempt, cpu_s: 0.01 };
    };
    const answer = await this.d.post(`/v1/leases/${lease.id}/renew`, {
      worker: this.name,
      solver: await this.solver(),
      jobs: jobs.map(report),
      ended: ended.map(({ job, ...end }) => ({ ...report(job), cause: "exited", error: null, digest: null, ...end })),
    });
    assert.equal(answer.status, 200, answer.text);
    return answer.json.jobs;
  }

  // One lease from its begin to its end; how many jobs it had.
  async work() {
    const lease = await this.lease();
    const open = lease.jobs.map(({ job }) => job);
    while (open.length > 0) {
      const job = open[0];
      const frames = await this.solve(lease.inputs[job]);
      await this.deliverAll(lease, job, frames);
      open.shift();
      const states = await this.renew(lease, open, [{ job, bytes: frames.length }]);
      assert.ok(states.some((state) => state.job === job && (state.next === frames.length || state.stop === "gone")));
    }
    return lease.jobs.length;
  }
}
