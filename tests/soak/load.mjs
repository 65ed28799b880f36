// A mixed load on a daemon (tests/e2e/daemon.mjs): clients that submit, cancel, remove, read, stream, and clients that
// do not read; on demand the daemon is killed meanwhile. At the end everything that was accepted is accounted for.

import assert from "node:assert/strict";
import { once } from "node:events";
import { readdirSync, readlinkSync, statSync } from "node:fs";
import http from "node:http";
import net from "node:net";
import path from "node:path";
import { setTimeout as sleep } from "node:timers/promises";
import { Worker } from "node:worker_threads";

import { residentBytes } from "../e2e/processes.mjs";
import { jam, tiny } from "../e2e/scenarios.mjs";
import { until } from "../e2e/setup.mjs";

const AGAIN_MS = 20; // after a request that found no daemon

export const isEnded = (status) => ["succeeded", "failed", "cancelled"].includes(status);

export function quantile(sorted, share) {
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

// Descriptors of a process whose target begins so.
export function openFiles(pid, kind = "") {
  const targetOf = (fd) => {
    try {
      return readlinkSync(`/proc/${pid}/fd/${fd}`);
    } catch {
      return null; // closed meanwhile
    }
  };
  return readdirSync(`/proc/${pid}/fd`).filter((fd) => targetOf(fd)?.startsWith(kind)).length;
}

// Bytes of the store with its log.
export function storeBytes(d) {
  return readdirSync(d.data).reduce((sum, name) => sum + statSync(path.join(d.data, name)).size, 0);
}

export class Load {
  // submitters, streams, silent: numbers of clients; kill_every_s: 0 for never.
  constructor(d, { seconds, submitters = 2, streams = 20, silent = 20, kill_every_s = 0 }) {
    Object.assign(this, { d, seconds, submitters, streams, silent, kill_every_s });
    this.isOver = false;
    this.over = new Promise((resolve) => (this.end = resolve));
    this.accepted = new Map(); // id of a run to whether it was removed
    this.isDown = false; // the daemon, killed
    this.counts = { submissions: 0, refusals: 0, cancels: 0, removals: 0, events: 0, streams: 0, kills: 0 };
    this.newest = null;
  }

  // An exchange, again and again while there is no daemon.
  async ask(method, target, options = {}) {
    for (;;) {
      try {
        return await this.d.send({ method, target, ...options });
      } catch (error) {
        if (this.kill_every_s === 0 || error.code === undefined) throw error;
        await sleep(AGAIN_MS);
      }
    }
  }

  // Until the end of the load.
  async repeat(step) {
    while (!this.isOver) await step();
  }

  // One run, whose key makes it one also where the answer was lost.
  async submit(who, n) {
    const body = JSON.stringify({ scenario: tiny({ duration_s: 0.1 + 0.00125 * (n % 400) }), fresh: true });
    const headers = { "content-type": "application/json", "idempotency-key": `"${who}-${n}"` };
    const answer = await this.ask("POST", "/v1/runs", { headers, body });
    if (answer.status === 503 || answer.status === 429) {
      this.counts.refusals += 1;
      await sleep(200);
      return this.isOver ? null : this.submit(who, n);
    }
    assert.equal(answer.status, 201, answer.text);
    this.counts.submissions += 1;
    return answer.json.id;
  }

  async useRun(who, n) {
    const id = await this.submit(who, n);
    if (id === null) return;
    this.accepted.set(id, false);
    this.newest = id;
    if (n % 10 === 3) {
      this.counts.cancels += 1;
      const { status } = await this.ask("POST", `/v1/runs/${id}/cancel`);
      assert.ok([200, 202, 409].includes(status), `cancel: ${status}`);
    }
    if (n % 10 === 7) {
      this.counts.removals += 1;
      this.accepted.set(id, true);
      const { status } = await this.ask("DELETE", `/v1/runs/${id}`);
      assert.ok([204, 404].includes(status), `removal: ${status}`); // 404: done, and the answer was lost
    }
  }

  // One connection of an event stream, read until it closes. Without the checks of event_stream.mjs, which a thousand
  // streams have no time for. seen: { last, isAtEnd }, of all connections to this stream.
  followOnce(id, seen) {
    return new Promise((resolve, reject) => {
      const headers = seen.last > 0 ? { "last-event-id": String(seen.last) } : {};
      const options = { host: "127.0.0.1", port: this.d.port, path: `/v1/runs/${id}/events`, headers, agent: false };
      const request = http.get(options, (response) => {
        let rest = "";
        response.setEncoding("latin1");
        response.on("data", (text) => {
          const lines = (rest + text).split("\n");
          rest = lines.pop();
          for (const line of lines) this.takeLine(line, seen);
        });
        response.on("error", resolve);
        response.on("close", () => resolve(response.statusCode));
      });
      this.over.then(() => request.destroy());
      request.on("error", (error) => (this.isOver || this.kill_every_s > 0 ? resolve(error) : reject(error)));
    });
  }

  takeLine(line, seen) {
    if (line.startsWith("id: ")) {
      const id = Number(line.slice(4));
      assert.ok(id > seen.last, `event ${id} after ${seen.last}`);
      seen.last = id;
      this.counts.events += 1;
    }
    if (line === "event: end") seen.isAtEnd = true;
  }

  // Follow a run to its end, over as many connections as it takes.
  async followRun(id) {
    const seen = { last: 0, isAtEnd: false };
    while (!seen.isAtEnd && !this.isOver && !this.accepted.get(id)) {
      this.counts.streams += 1;
      const how = await this.followOnce(id, seen);
      await sleep(AGAIN_MS);
      if (how === 404) return; // removed, or expired
    }
  }

  async beSilent() {
    const socket = net.connect(this.d.port, "127.0.0.1");
    socket.on("error", () => {}); // the daemon was killed, or cut it off
    socket.pause();
    socket.write(`GET /v1/runs/${this.newest}/events?inline=1 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n`);
    const closed = once(socket, "close");
    await Promise.race([closed, this.over]);
    socket.destroy();
    await sleep(AGAIN_MS);
  }

  async killNow() {
    await sleep(this.kill_every_s * 1000 * (0.5 + Math.random()));
    if (this.isOver) return;
    this.d.settings.listen = `127.0.0.1:${this.d.port}`;
    this.isDown = true;
    await this.d.kill();
    await this.d.start();
    this.isDown = false;
    this.counts.kills += 1;
  }

  figures() {
    const { d } = this;
    return { resident_MB: Math.round(residentBytes(d.pid) / 2 ** 20), files: openFiles(d.pid),
      store_MB: Number((storeBytes(d) / 2 ** 20).toFixed(1)) };
  }

  // onProgress(figures) every tenth of the time.
  async run(onProgress = () => {}) {
    const clients = [];
    const start = (n, step) => {
      for (let k = 0; k < n; k++) clients.push(step(k));
    };
    const long = (await this.d.submit(jam(200_000, { curve_every_s: 50, snapshot_every_s: 100 }))).id;
    this.accepted.set(long, false);
    this.newest = long;
    start(this.submitters, async (who) => {
      for (let n = 0; !this.isOver; n++) await this.useRun(who, n);
    });
    start(this.streams, (k) => this.repeat(() => this.followRun(k % 10 === 0 ? this.newest : long)));
    start(this.silent, () => this.repeat(() => this.beSilent()));
    const clock = new Worker(new URL("clock.mjs", import.meta.url), { workerData: { port: this.d.port, id: long } });
    if (this.kill_every_s > 0) start(1, () => this.repeat(() => this.killNow()));
    const all = Promise.all(clients);
    try {
      for (let k = 0; k < 10; k++) {
        await Promise.race([sleep((this.seconds * 1000) / 10), all]);
        if (!this.isDown) onProgress(this.figures());
      }
    } finally {
      this.isOver = true;
      this.end();
    }
    clock.postMessage("stop");
    [this.times] = await once(clock, "message");
    await all;
    await this.ask("POST", `/v1/runs/${long}/cancel`);
  }

  // Every run that was accepted and neither removed nor expired has ended, and there is no other.
  async settle({ retention_runs: kept = Infinity } = {}) {
    for (const status of ["queued", "running"]) {
      await until(async () => {
        const { json } = await this.ask("GET", `/v1/runs?status=${status}&limit=1`);
        return json.runs.length === 0;
      }, `no run to be ${status}`, 600_000);
    }
    const there = new Map();
    for (let target = "/v1/runs?limit=100"; target !== null;) {
      const answer = await this.ask("GET", target);
      for (const run of answer.json.runs) there.set(run.id, run.status);
      target = /<([^>]*)>;\s*rel="next"/.exec(answer.headers.link ?? "")?.[1] ?? null;
    }
    for (const [id, status] of there) {
      assert.ok(isEnded(status), `${id} is ${status}`);
      assert.notEqual(status, "failed", id);
      assert.equal(this.accepted.get(id), false, `${id} was removed, or never accepted`);
    }
    const wanted = [...this.accepted].filter(([, isRemoved]) => !isRemoved).length;
    if (wanted <= kept) assert.equal(there.size, wanted);
    return there.size;
  }

  report() {
    const spread = Object.entries(this.times).map(([kind, list]) => {
      const sorted = list.toSorted((a, b) => a - b);
      const [p50, p99, max] = [0.5, 0.99, 1].map((share) => quantile(sorted, share).toFixed(1));
      return `GET ${kind}: ${list.length} times, p50 ${p50} ms, p99 ${p99} ms, slowest ${max} ms`;
    });
    return [...spread, JSON.stringify(this.counts)].join("\n");
  }
}
