// A real daemon for a story: started on a free port with a data directory of its own, stopped and
// checked when the story is over. Only Node's own modules.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import http from "node:http";
import { tmpdir } from "node:os";
import path from "node:path";

import { checkExchange } from "./contract.mjs";
import { EventStream } from "./event_stream.mjs";
import { noteExchange } from "./prism.mjs";
import { childrenOf, isAlive } from "./processes.mjs";
import { binaries, isSanitized, until, within } from "./setup.mjs";

// A daemon of this story. settings: flags without their dashes, e.g. { workers: 2 }; environment:
// what is added to ours.
export async function daemon(t, settings = {}, environment = {}) {
  const d = new Daemon(settings, environment);
  t.after(() => d.dispose());
  await d.start();
  return d;
}

class Daemon {
  constructor(settings, environment) {
    this.folder = mkdtempSync(path.join(tmpdir(), "beltflow-e2e-"));
    this.data = path.join(this.folder, "data");
    this.settings = settings;
    this.environment = environment;
    this.log = "";
    this.process = null;
    this.agent = new http.Agent({ keepAlive: false });
  }

  flags() {
    const all = { listen: "127.0.0.1:0", data: this.data };
    // What waits and what is solved at once does not depend on the machine's cores.
    if (this.settings.config === undefined) all.workers = 1;
    if (isSanitized) all.run_memory_bytes = 0; // shadow memory needs the whole address space
    return Object.entries({ ...all, ...this.settings }).flatMap(([name, value]) => [
      `--${name.replaceAll("_", "-")}`,
      String(value),
    ]);
  }

  async start() {
    const child = spawn(path.join(binaries, "beltflowd"), this.flags(), {
      stdio: ["ignore", "pipe", "pipe"],
      env: { ...process.env, ...this.environment },
    });
    this.process = child;
    this.pid = child.pid;
    this.exited = new Promise((resolve) => {
      child.on("close", (code, signal) => resolve({ code, signal }));
    });
    child.stderr.on("data", (chunk) => (this.log += chunk));
    const line = await within(this.firstLine(child), "the daemon's first line");
    const found = /^beltflowd \S+ listening on (http:\/\/[\d.]+:(\d+)\/)$/.exec(line);
    assert.ok(found, `first line is ${JSON.stringify(line)}; log:\n${this.log}`);
    this.url = found[1];
    this.port = Number(found[2]);
  }

  async firstLine(child) {
    let text = "";
    child.stdout.on("data", (chunk) => (text += chunk));
    let isOver = false;
    this.exited.then(() => (isOver = true));
    await until(() => isOver || text.includes("\n"), "a line");
    return text.split("\n")[0];
  }

  // SIGTERM; the daemon must exit with status 0 and leave no child process.
  async stop() {
    const children = childrenOf(this.pid);
    this.process.kill("SIGTERM");
    const { code, signal } = await within(this.exited, "the daemon's end");
    this.process = null;
    this.assertClean();
    assert.deepEqual({ code, signal }, { code: 0, signal: null }, this.log);
    await this.assertGone(children);
  }

  // kill -9, as a crash would; its children must not outlive it.
  async kill() {
    const children = childrenOf(this.pid);
    this.process.kill("SIGKILL");
    await within(this.exited, "the daemon's end");
    this.process = null;
    await this.assertGone(children);
  }

  async assertGone(pids) {
    await until(() => !pids.some(isAlive), `the end of the children ${pids}`);
  }

  assertClean() {
    assert.doesNotMatch(this.log, /Sanitizer|runtime error:|broken invariant/, this.log);
  }

  async dispose() {
    try {
      if (this.process !== null && this.process.exitCode === null) await this.stop();
      this.assertClean();
    } finally {
      this.process?.kill("SIGKILL");
      this.agent.destroy();
      rmSync(this.folder, { recursive: true, force: true });
    }
  }

  // One exchange: { status, headers, body, text, json }; it must be what the document says.
  async request(method, target, { headers = {}, body } = {}) {
    const exchange = { method, target, headers, body };
    const answer = await this.send(exchange);
    checkExchange(exchange, answer);
    noteExchange(exchange, answer);
    return answer;
  }

  // The same, straight to the daemon and unchecked.
  send({ method, target, headers, body }) {
    const exchange = new Promise((resolve, reject) => {
      const request = http.request(
        { host: "127.0.0.1", port: this.port, agent: this.agent, method, path: target, headers },
        (response) => {
          const chunks = [];
          response.on("data", (chunk) => chunks.push(chunk));
          response.on("error", reject);
          response.on("end", () => resolve(new Answer(response, Buffer.concat(chunks))));
        },
      );
      request.on("error", reject);
      request.end(body);
    });
    return within(exchange, `${method} ${target}`);
  }

  get(target, headers) {
    return this.request("GET", target, { headers });
  }

  // POST a value as JSON, or text as it is.
  post(target, value, more = {}) {
    const body = typeof value === "string" || Buffer.isBuffer(value) ? value : JSON.stringify(value);
    const headers = {
      "content-type": "application/json",
      "content-length": Buffer.byteLength(body),
      ...more,
    };
    return this.request("POST", target, { headers, body });
  }

  // Submit a scenario; the run's document. It is solved also where its results are known, unless the
  // story disables that.
  async submit(scenario, extra = {}) {
    const answer = await this.post("/v1/runs", { scenario, fresh: true, ...extra });
    assert.equal(answer.status, 201, answer.text);
    return answer.json;
  }

  async run(id) {
    const answer = await this.get(`/v1/runs/${id}`);
    assert.equal(answer.status, 200, answer.text);
    return answer.json;
  }

  // Wait for a state of a run; its document. Another final state fails at once.
  async reached(id, ...states) {
    return until(async () => {
      const run = await this.run(id);
      if (states.includes(run.status)) return run;
      assert.ok(["queued", "running"].includes(run.status), JSON.stringify(run));
      return null;
    }, `run ${id} to be ${states.join(" or ")}`);
  }

  // Wait until a running run has made this fraction of its steps.
  async progressed(id, share) {
    return until(async () => {
      const run = await this.run(id);
      assert.ok(["queued", "running"].includes(run.status), JSON.stringify(run));
      return run.progress >= share;
    }, `run ${id} to make progress`);
  }

  // The open event stream of a run (or of any target).
  events(idOrTarget, headers = {}) {
    const target = idOrTarget.startsWith("/") ? idOrTarget : `/v1/runs/${idOrTarget}/events`;
    return within(EventStream.open(this.port, target, headers), `GET ${target}`);
  }
}

class Answer {
  constructor(response, body) {
    this.status = response.statusCode;
    this.headers = response.headers;
    this.body = body;
  }

  get text() {
    return this.body.toString("utf8");
  }

  get json() {
    return JSON.parse(this.text);
  }
}
