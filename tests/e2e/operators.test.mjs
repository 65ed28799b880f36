// What those who run the daemon rely on: metrics, settings read again, messages to the service manager.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { once } from "node:events";
import { readFileSync, writeFileSync } from "node:fs";
import net from "node:net";
import path from "node:path";
import test from "node:test";

import { holdStore, serviceManager } from "./beside.mjs";
import { daemon } from "./daemon.mjs";
import { childrenOf, runProgram } from "./processes.mjs";
import { endless, tiny } from "./scenarios.mjs";
import { addToken } from "./tokens.mjs";
import { isSanitized, root, temporaryFolder, until } from "./setup.mjs";

// The samples of /metrics: "name{labels}" to number.
async function metrics(d) {
  const answer = await d.get("/metrics");
  assert.equal(answer.status, 200);
  assert.equal(answer.headers["content-type"], "text/plain; version=0.0.4; charset=utf-8");
  const lines = answer.text.split("\n").filter((line) => line !== "" && !line.startsWith("#"));
  return Object.fromEntries(
    lines.map((line) => [line.slice(0, line.lastIndexOf(" ")), Number(line.slice(line.lastIndexOf(" ")))]),
  );
}

// Wait for values of metrics, { name: value }; all of them.
const metricsWith = (d, values) =>
  until(async () => {
    const now = await metrics(d);
    return Object.entries(values).every(([name, value]) => now[name] === value) && now;
  }, `metrics to be ${JSON.stringify(values)}`);

test("promtool finds no fault with the metrics of a daemon that has worked", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await (await d.events(run.id)).rest();
  await d.reached(run.id, "succeeded");
  await d.get("/v1/nothing");
  const { text } = await d.get("/metrics");
  const { error, status, stdout, stderr } = spawnSync("promtool", ["check", "metrics"], {
    input: text,
    encoding: "utf8",
  });
  assert.equal(error, undefined, `${error}: deploy/install-deps installs promtool`);
  assert.deepEqual({ status, stdout, stderr }, { status: 0, stdout: "", stderr: "" });
});

test("promtool finds no fault with the alerts, and each looks at what the daemon tells", async (t) => {
  const rules = path.join(root, "deploy/prometheus/beltflow.rules.yml");
  const { error, status, stdout, stderr } = spawnSync("promtool", ["check", "rules", rules], { encoding: "utf8" });
  assert.equal(error, undefined, `${error}: deploy/install-deps installs promtool`);
  assert.equal(status, 0, stdout + stderr);
  const data = path.join(temporaryFolder(t), "data");
  const prometheus = addToken(data, "prometheus", "--scopes", "metrics", "--expires", "10d");
  const reader = addToken(data, "reader", "--owner", "ada", "--scopes", "read");
  const d = await daemon(t, { data, access_log: 1 });
  const { text } = await d.get("/metrics", prometheus);
  const told = new Set([...text.matchAll(/^# TYPE (\S+) /gm)].map(([, name]) => name));
  const asked = [...readFileSync(rules, "utf8").matchAll(/\bbeltflow_\w+/g)].map(([name]) => name);
  assert.deepEqual(asked.filter((name) => !told.has(name)), []);
  assert.match(text, /^beltflow_token_expires_in_seconds\{token="1",name="prometheus",owner="prometheus"\} 86\d{4}$/m);
  assert.match(text, /^beltflow_owner_cpu_seconds\{owner="ada"\} 0$/m);
  assert.match(text, /^beltflow_store_disk_free_bytes [1-9]/m);
  assert.equal((await d.get("/v1/runs", prometheus)).status, 403);
  // What others use is not every reader's.
  assert.doesNotMatch((await d.get("/metrics", reader)).text, /owner="|token="/);
  await until(() => /event=request method="GET" path="\/v1\/runs" status=403 .* owner=prometheus client=127\.0\.0\.1$/m.test(d.log), "an access log");
});

test("the shipped unit lets trials have a lower priority", () => {
  const unit = readFileSync(path.join(root, "deploy/systemd/beltflow.service"), "utf8");
  const filters = [...unit.matchAll(/^SystemCallFilter=(.*)$/gm)].map(([, words]) => words);
  // setpriority is of the group @resources; a later line adds to what an earlier one took away.
  const denied = filters.findIndex((words) => words.startsWith("~") && words.includes("@resources"));
  const allowed = filters.findLastIndex((words) => words.split(" ").includes("setpriority"));
  assert.ok(allowed > denied && denied >= 0, filters.join("\n"));
});

test("a daemon that others can reach says so in its log", async (t) => {
  const reachable = await daemon(t, { listen: "0.0.0.0:0", plaintext: "open" });
  await until(() => /level=warn event=listens_to_the_network address=0\.0\.0\.0 /.test(reachable.log), "a warning");
  const local = await daemon(t);
  assert.equal((await local.get("/livez")).status, 200);
  assert.doesNotMatch(local.log, /listens_to_the_network/);
});

test("metrics tell what a run did, by templates and never by ids", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  const events = await (await d.events(run.id)).rest();
  await d.reached(run.id, "succeeded");
  const now = await metricsWith(d, { 'beltflow_runs{state="succeeded"}': 1 });
  assert.equal(now['beltflow_http_requests_total{route="/v1/runs",method="POST",code="201"}'], 1);
  assert.equal(now['beltflow_http_requests_total{route="/v1/runs/{id}/events",method="GET",code="200"}'], 1);
  assert.equal(now['beltflow_http_request_duration_seconds_count{route="/v1/runs",method="POST"}'], 1);
  assert.equal(now['beltflow_solver_steps_total{model="macro"}'], 80);
  assert.equal(now['beltflow_child_exits_total{reason="ok"}'], 1);
  const snapshots = events.filter(({ event }) => event === "snapshot").length;
  assert.equal(now['beltflow_frames_stored_total{kind="snapshot"}'], snapshots);
  assert.ok(now.beltflow_http_stream_bytes_total > 500);
  assert.ok(now.beltflow_store_commit_duration_seconds_count >= 3);
  assert.ok(now.beltflow_store_size_bytes > 0 && now.beltflow_store_wal_size_bytes > 0);
  assert.ok(now.process_resident_memory_bytes > 1e6 && now.process_open_fds > 5);
  assert.ok(Math.abs(now.process_start_time_seconds - Date.now() / 1000) < 600);
  assert.ok(!Object.keys(now).some((name) => name.includes(run.id)));
});

test("metrics tell of the queue, of what is being solved, and of open streams", async (t) => {
  const d = await daemon(t);
  const first = await d.submit(endless());
  const stream = await d.events(first.id);
  assert.ok(await stream.until("progress"));
  await d.submit(tiny());
  const now = await metricsWith(d, { beltflow_queue_length: 1, 'beltflow_runs{state="running"}': 1 });
  assert.equal(now['beltflow_solver_items{model="macro"}'], 100 * 60);
  assert.equal(now.beltflow_http_streams, 1);
  assert.ok(now.beltflow_queue_oldest_age_seconds > 0);
  await until(async () => (await metrics(d)).beltflow_queue_predicted_seconds > 0, "the queue to be predicted");
  assert.ok(now.beltflow_http_requests_in_flight >= 2); // the stream and this one
  await d.post(`/v1/runs/${first.id}/cancel`, "");
  await stream.rest();
  await metricsWith(d, { 'beltflow_runs{state="succeeded"}': 1 });
  const after = await metricsWith(d, { beltflow_http_streams: 0 });
  assert.equal(after.beltflow_queue_length, 0);
  assert.equal(after.beltflow_queue_oldest_age_seconds, 0);
  assert.equal(after.beltflow_queue_predicted_seconds, 0);
});

test("health and metrics are answered when all connections but the reserve are taken", async (t) => {
  // A reserve of five: requests before that the daemon has not closed yet take of it, too.
  const d = await daemon(t, { connections: 40, http_threads: 1 });
  const run = await d.submit(endless());
  const crowd = await Promise.all(Array.from({ length: 35 }, () => d.events(run.id)));
  t.after(() => crowd.forEach((stream) => stream.request.destroy()));
  await metricsWith(d, { beltflow_http_connections: 36 });
  assert.equal((await d.get("/livez")).status, 200);
  assert.equal((await d.get("/version")).status, 503);
});

test("settings are checked, printed with their origins, and the print is a file", async (t) => {
  const folder = temporaryFolder(t);
  const file = path.join(folder, "beltflowd.conf");
  const again = path.join(folder, "again.conf");
  writeFileSync(file, "workers = 3\n");
  const check = (...args) => runProgram("beltflowd", args, { env: { BELTFLOW_THREADS: "2" } });
  const good = await check("--config", file, "--check-config");
  assert.deepEqual(good, { status: 0, signal: null, stdout: "", stderr: "" });
  const printed = await check("--config", file, "--streams", "7", "--print-config");
  assert.equal(printed.status, 0, printed.stderr);
  for (const [origin, line] of [
    [`${file}:1`, "workers = 3"],
    ["BELTFLOW_THREADS", "threads = 2"],
    ["--streams", "streams = 7"],
    ["default", "queue_limit = 1000"],
  ])
    assert.ok(printed.stdout.includes(`# from: ${origin}\n${line}\n`), printed.stdout);
  writeFileSync(again, printed.stdout);
  const second = await runProgram("beltflowd", ["--config", again, "--print-config"]);
  const settings = (text) => text.split("\n").filter((line) => /^\w/.test(line));
  assert.deepEqual(settings(second.stdout), settings(printed.stdout));
  writeFileSync(file, "workers = 3\nlisten = nowhere\n");
  const bad = await check("--config", file, "--check-config");
  assert.deepEqual([bad.status, bad.stdout], [2, ""]);
  assert.ok(bad.stderr.startsWith(`${file}:2: 'nowhere'`), bad.stderr);
});

test("SIGHUP takes over what it can, says what needs a restart, and keeps all when the file is bad", async (t) => {
  const config = path.join(temporaryFolder(t), "beltflowd.conf");
  writeFileSync(config, "workers = 1\n");
  const d = await daemon(t, { config });
  for (let k = 0; k < 2; k++) await d.submit(endless());
  await until(() => childrenOf(d.pid).length === 1, "one child");
  writeFileSync(config, "workers = 2\nhttp_threads = 3\nbody_bytes = 1024\nlog_level = debug\n");
  d.process.kill("SIGHUP");
  await until(() => childrenOf(d.pid).length === 2, "two children");
  await until(() => d.log.includes("event=settings_read"), "the word of it");
  assert.match(d.log, /level=info event=setting_changed name=workers from="1" to="2"/);
  assert.match(d.log, /level=warn event=setting_needs_restart name=http_threads from="2" to="3"/);
  const large = { scenario: tiny({ name: "x".repeat(1100) }) };
  assert.equal((await d.post("/v1/validate", large)).status, 413);
  await d.get("/livez");
  await until(() => /level=debug event=request .*path="\/livez"/.test(d.log), "a line for developers");
  writeFileSync(config, "workers = 1\nworkers = none\n");
  d.process.kill("SIGHUP");
  await until(() => d.log.includes("event=settings_refused"), "the word of it");
  assert.match(d.log, /level=error event=settings_refused error="[^"]*beltflowd\.conf:2: workers must be /);
  assert.equal((await d.post("/v1/validate", large)).status, 413);
  assert.equal((await metrics(d)).beltflow_config_last_reload_successful, 0);
  assert.equal(childrenOf(d.pid).length, 2);
});

test("the service manager hears when it is ready, reloads and stops, in order", async (t) => {
  const manager = await serviceManager(t);
  const d = await daemon(t, {}, { NOTIFY_SOCKET: manager.path });
  await until(() => manager.said("READY").length === 1, "READY=1");
  assert.match(manager.said("STATUS")[0], new RegExp(`port ${d.port}\\b`));
  assert.equal((await d.get("/readyz")).status, 200);
  d.process.kill("SIGHUP");
  await until(() => manager.said("READY").length === 2, "READY=1 again");
  await d.stop();
  await until(() => manager.said("STOPPING").length === 1, "STOPPING=1");
  const heard = manager.messages().map((message) => Object.keys(message)[0]);
  assert.deepEqual(heard, ["READY", "RELOADING", "READY", "STOPPING"]);
  assert.match(manager.said("MONOTONIC_USEC")[0], /^\d+$/);
});

test("a store that hangs starves the watchdog, and feeds it again when it goes on", async (t) => {
  const interval_ms = isSanitized ? 1000 : 600;
  const manager = await serviceManager(t);
  const d = await daemon(t, {}, { NOTIFY_SOCKET: manager.path, WATCHDOG_USEC: String(interval_ms * 1000) });
  const beats = () => manager.said("WATCHDOG").length;
  await until(() => beats() >= 3, "three signs of life");
  const release = await holdStore(t, d);
  const answer = d.post("/v1/runs", { scenario: tiny() });
  await until(() => /event=subsystem_stalled store=hangs .*http=alive/.test(d.log), "the word of it");
  // Each turn of the watchdog has either a sign of life or this word.
  const before = beats();
  const hangs = () => d.log.match(/event=subsystem_stalled/g).length;
  const first = hangs();
  await until(() => hangs() >= first + 2, "the word of it again");
  assert.equal(beats(), before);
  assert.equal((await d.get("/livez")).status, 200);
  await release();
  const { status, json } = await answer;
  assert.equal(status, 201);
  await until(() => beats() >= before + 2, "signs of life again");
  await d.reached(json.id, "succeeded");
});
