// HTTP as its standards have it: encodings, ranges, conditions, waiting, limits, other origins. The
// clients are Node's fetch and curl, which decode and resume by themselves.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { endless, jam, tiny } from "./scenarios.mjs";
import { hasPage, until, within } from "./setup.mjs";

const page = hasPage ? ["/"] : [];
const someone = { "x-forwarded-for": "198.51.100.1" };

async function solved(d, scenario = tiny()) {
  const run = await d.submit(scenario);
  await d.reached(run.id, "succeeded");
  return run;
}

function post(d, scenario, headers = {}) {
  return d.request("POST", "/v1/runs", {
    headers: { "content-type": "application/json", ...headers },
    body: JSON.stringify({ scenario }),
  });
}

test("fetch and curl read encoded text as it is", async (t) => {
  const d = await daemon(t);
  const run = await solved(d, jam(1, { curve_every_s: 0.01, snapshot_every_s: 0.5 }));
  for (const target of [`/v1/runs/${run.id}/curve`, `/v1/runs/${run.id}/curve?format=csv`, `/v1/runs/${run.id}/scenario`, ...page]) {
    const plain = await d.get(target);
    assert.equal(plain.headers["content-encoding"], undefined);
    const fetched = await fetch(new URL(target, d.url), { headers: { "accept-encoding": "gzip" } });
    assert.equal(fetched.headers.get("content-encoding"), "gzip", target);
    assert.match(fetched.headers.get("vary"), /Accept-Encoding/);
    assert.notEqual(fetched.headers.get("etag"), plain.headers.etag);
    assert.equal(await fetched.text(), plain.text);
    const curl = spawnSync("curl", ["-sS", "--compressed", new URL(target, d.url).href]);
    assert.equal(curl.stdout.toString(), plain.text, `${curl.stderr}`);
    const packed = await d.get(target, { "accept-encoding": "gzip" });
    assert.ok(packed.body.length < 0.7 * plain.body.length, `${packed.body.length}`);
  }
});

test("fetch reads an encoded density as it is, and a part of one is not encoded", async (t) => {
  const d = await daemon(t);
  const run = await solved(d, jam(0.1, { curve_every_s: 0.05, snapshot_every_s: 0.1 }));
  const target = `/v1/runs/${run.id}/snapshots/1`;
  const plain = await d.get(target);
  for (const encoding of ["gzip", "zstd"]) {
    const headers = { "accept-encoding": encoding };
    const packed = await d.get(target, headers);
    assert.equal(packed.headers["content-encoding"], encoding);
    assert.notEqual(packed.headers.etag, plain.headers.etag);
    assert.ok(packed.body.length < 0.7 * plain.body.length, `${packed.body.length}`);
    const part = await d.get(target, { ...headers, range: "bytes=0-9" });
    assert.deepEqual([part.status, part.headers["content-encoding"], part.body], [206, undefined, plain.body.subarray(0, 10)]);
  }
  const fetched = await fetch(new URL(target, d.url), { headers: { "accept-encoding": "gzip" } });
  assert.deepEqual(Buffer.from(await fetched.arrayBuffer()), plain.body);
});

test("a download of a snapshot is resumed where it was cut", async (t) => {
  const d = await daemon(t);
  const run = await solved(d);
  const target = `/v1/runs/${run.id}/snapshots/0`;
  const whole = await d.get(target);
  assert.equal(whole.headers["accept-ranges"], "bytes");
  const file = path.join(d.folder, "density.npy");
  writeFileSync(file, whole.body.subarray(0, 100));
  const curl = spawnSync("curl", ["-sS", "-C", "-", "-o", file, new URL(target, d.url).href]);
  assert.equal(curl.status, 0, `${curl.stderr}`);
  assert.deepEqual(readFileSync(file), whole.body);
  const end = await d.get(target, { range: "bytes=-4", "if-range": whole.headers.etag });
  assert.deepEqual([end.status, end.body], [206, whole.body.subarray(-4)]);
  const beyond = await d.get(target, { range: `bytes=${whole.body.length}-` });
  assert.deepEqual([beyond.status, beyond.json.status], [416, 416]);
});

test("what a client has is not sent again, and not changed in another state", async (t) => {
  const d = await daemon(t);
  const run = await solved(d);
  const base = `/v1/runs/${run.id}`;
  const targets = ["", "/scenario", "/summary", "/curve", "/snapshots", "/snapshots/0"].map((part) => base + part);
  for (const target of [...targets, "/v1/runs", "/v1/examples", "/v1/examples/example-1", "/version", ...page]) {
    for (const encoding of ["identity", "gzip"]) {
      const headers = { "accept-encoding": encoding };
      const first = await d.get(target, headers);
      const again = await d.get(target, { ...headers, "if-none-match": first.headers.etag });
      assert.deepEqual([again.status, again.body.length], [304, 0], target);
      assert.equal(again.headers.etag, first.headers.etag, target);
      assert.equal(again.headers.vary, first.headers.vary, target);
      const length = again.headers["content-length"];
      assert.ok(length === undefined || length === first.headers["content-length"], target);
    }
  }
  const stale = { headers: { "if-match": '"r1"' } };
  assert.equal((await d.request("DELETE", base, stale)).status, 412);
  assert.equal((await d.request("POST", `${base}/cancel`, stale)).status, 412);
  const current = { headers: { "if-match": (await d.get(base)).headers.etag } };
  assert.equal((await d.request("DELETE", base, current)).status, 204);
});

test("a script gets its result in one call", async (t) => {
  const d = await daemon(t);
  const answer = await post(d, tiny(), { prefer: "wait=60" });
  assert.deepEqual([answer.status, answer.json.status], [201, "succeeded"]);
  assert.equal(answer.headers["preference-applied"], "wait=60");
  assert.equal(answer.headers.location, `/v1/runs/${answer.json.id}`);
  const late = await post(d, endless(), { prefer: "respond-async, wait=1" });
  assert.deepEqual([late.status, late.json.status], [201, "running"]);
  assert.ok((await d.run(late.json.id)).progress < 1);
});

test("a long poll follows a run from state to state", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(jam(1, { curve_every_s: 0.05, snapshot_every_s: 0.25 }));
  const seen = [];
  let etag = '"r0"';
  while (seen.at(-1)?.status !== "succeeded") {
    const answer = await d.get(`/v1/runs/${run.id}?wait=30`, { "if-none-match": etag });
    assert.equal(answer.status, 200);
    assert.notEqual(answer.headers.etag, etag);
    etag = answer.headers.etag;
    seen.push(answer.json);
  }
  assert.equal((await d.get(`/v1/runs/${run.id}?wait=30`, { "if-none-match": etag })).status, 304);
  const ended = await d.get(`/v1/runs/${run.id}?wait=30`);
  assert.deepEqual(ended.json, seen.at(-1));
});

test("those who wait are answered when the daemon stops, and when their run is removed", async (t) => {
  const d = await daemon(t, { waits: 50 });
  const run = await d.submit(endless());
  await d.progressed(run.id, 1e-6);
  const removed = await d.submit(tiny());
  const wait = (id) =>
    until(async () => {
      const answer = await d.get(`/v1/runs/${id}?wait=60`);
      return answer.status !== 503 && answer; // the look below may have taken its place
    }, "room to wait");
  const waiting = Array.from({ length: 49 }, () => wait(run.id));
  const gone = wait(removed.id);
  const look = () => d.get(`/v1/runs/${run.id}?wait=1`);
  await until(async () => (await look()).status === 503, "all of them to wait");
  assert.equal((await d.request("DELETE", `/v1/runs/${removed.id}`)).status, 204);
  assert.equal((await gone).status, 404);
  const stopped = d.stop();
  for (const answer of await within(Promise.all(waiting), "all answers")) {
    assert.deepEqual([answer.status, answer.json.id], [200, run.id]);
  }
  await stopped;
});

test("a client has its share of the queue, and its rate", async (t) => {
  const d = await daemon(t, {
    trusted_proxies: "127.0.0.1",
    plaintext: "open",
    queue_share: 2,
    queue_limit: 4,
    work_per_minute: 6,
  });
  await d.reached((await d.submit(endless(), { priority: 1 })).id, "running");
  const mine = [await post(d, tiny(), someone), await post(d, tiny(), someone)];
  const refused = await post(d, tiny(), someone);
  assert.equal(refused.status, 429, refused.text);
  assert.match(refused.json.detail, /2 runs of 198\.51\.100\.1 wait/);
  assert.match(refused.headers["retry-after"], /^\d+$/);
  await d.submit(tiny()); // others, and this machine, are not concerned
  await d.submit(tiny());
  const full = await post(d, tiny(), { "x-forwarded-for": "198.51.100.2" });
  assert.deepEqual([full.status, /^\d+$/.test(full.headers["retry-after"])], [503, true]);
  await d.post(`/v1/runs/${mine[0].json.id}/cancel`, "");
  assert.equal((await post(d, tiny(), someone)).status, 201);
  for (let k = 0; k < 2; k++) await post(d, tiny(), someone);
  const tooOften = await post(d, tiny(), someone);
  assert.equal(tooOften.status, 429);
  assert.match(tooOften.headers.ratelimit, /"requests";r=\d+;t=\d+, "work";r=0;t=\d+/);
  assert.equal((await d.get("/version", someone)).status, 200);
});

test("a replay gets its first answer, also when the share and the queue are full", async (t) => {
  const d = await daemon(t, { trusted_proxies: "127.0.0.1", plaintext: "open", queue_share: 1, queue_limit: 2 });
  const keyed = { ...someone, "idempotency-key": '"once"' };
  await d.reached((await d.submit(endless(), { priority: 1 })).id, "running");
  const first = await post(d, tiny(), keyed);
  assert.equal(first.status, 201, first.text);
  assert.equal((await post(d, tiny(), someone)).status, 429);
  const replay = async () => {
    const again = await post(d, tiny(), keyed);
    assert.deepEqual([again.status, again.text], [201, first.text]);
  };
  await replay();
  await d.submit(tiny());
  assert.equal((await post(d, tiny(), { "x-forwarded-for": "198.51.100.2" })).status, 503);
  await replay();
  // The replays took no places: with its run gone, the client may queue one, and one only.
  await d.post(`/v1/runs/${first.json.id}/cancel`, "");
  assert.equal((await post(d, tiny(), someone)).status, 201);
  assert.equal((await post(d, tiny(), someone)).status, 429);
});

test("a page elsewhere may read what the settings let it", async (t) => {
  const d = await daemon(t, { cors_origins: "https://plan.example" });
  const headers = { origin: "https://plan.example", "access-control-request-method": "DELETE" };
  const preflight = await d.request("OPTIONS", "/v1/runs/x", { headers });
  assert.equal(preflight.status, 204);
  assert.match(preflight.headers["access-control-allow-methods"], /DELETE/);
  assert.equal(preflight.headers["access-control-allow-credentials"], undefined);
  const other = await d.get("/version", { origin: "https://other.example" });
  assert.equal(other.headers["access-control-allow-origin"], undefined);
  assert.match(other.headers.vary, /Origin/);
});

test("a request is found again in the log by its id", async (t) => {
  const d = await daemon(t);
  const answer = await post(d, { duration_s: -1 }, { "x-request-id": "night-17" });
  assert.equal(answer.headers["x-request-id"], "night-17");
  assert.equal(answer.json.request_id, "night-17");
  await until(() => /event=request .*status=422 .*request_id=night-17/.test(d.log), "the line of the log");
});
