// Event streams: every event arrives exactly once, and a slow reader does not affect others.

import assert from "node:assert/strict";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import net from "node:net";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { solveMicro } from "./micro.mjs";
import { residentBytes } from "./processes.mjs";
import { solve } from "./results.mjs";
import { endless, fed, interruptible, jam, tiny } from "./scenarios.mjs";
import { isSanitized, until, within } from "./setup.mjs";

async function ended(d, scenario) {
  const run = await d.submit(scenario);
  await d.reached(run.id, "succeeded");
  return run;
}

test("a stream opens with the run and ends with its end", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(jam(1, { curve_every_s: 0.05, snapshot_every_s: 0.25 }));
  const stream = await d.events(run.id);
  assert.equal(stream.status, 200);
  assert.match(stream.headers["content-type"], /^text\/event-stream/);
  assert.equal(stream.headers["cache-control"], "no-store");
  assert.equal(stream.headers["x-accel-buffering"], "no");
  const events = await stream.rest();
  assert.equal(stream.retry, 3000);
  assert.deepEqual(
    [events[0].event, events[0].data.status, events[0].data.id],
    ["status", "queued", run.id],
  );
  const kinds = new Set(events.map((event) => event.event));
  assert.deepEqual([...kinds].sort(), ["curve", "end", "figures", "progress", "snapshot", "status"]);
  // The key figures that came last are those of the summary, and of the resource.
  const { data: last } = events.filter((event) => event.event === "figures").at(-1);
  assert.deepEqual(last.key_figures, (await d.get(`/v1/runs/${run.id}/summary`)).json.key_figures);
  assert.deepEqual(last.key_figures, (await d.get(`/v1/runs/${run.id}/key_figures`)).json);
  const { feeds, counters, photo_eyes: eyes, ...ofRun } = last.key_figures;
  assert.deepEqual([feeds.length, counters.length, eyes.length], [0, 1, 0]);
  const { json: list } = await d.get("/v1/runs");
  assert.deepEqual(list.runs[0].key_figures, ofRun);
  const snapshots = events.filter((event) => event.event === "snapshot");
  assert.deepEqual(snapshots.map((event) => event.data.n), [0, 1, 2, 3, 4]);
  assert.equal((await d.get(snapshots[4].data.url)).status, 200);
});

test("what photo eyes saw and did stands in events, in its resource and in the archive alike", async (t) => {
  const d = await daemon(t);
  for (const [model, solved] of [["macro", solve], ["micro", solveMicro]]) {
    const run = await d.submit(fed(), { model });
    const events = await (await d.events(run.id)).rest();
    const of = (kind) => events.filter(({ event }) => event === kind).map(({ data: { run: id, ...rest } }) => rest);
    const { json } = await d.get(`/v1/runs/${run.id}/photo_eyes`);
    assert.deepEqual(json, { changes: of("photo_eye"), actions: of("action"), drives: [], belts: [], is_cut: false });
    assert.equal(json.changes[0].state, "blocked");
    assert.deepEqual(json.actions.map(({ action, target }) => [action, target])[0], [0, "stop"]);
    const lines = json.changes.map((row) => `${row.t_s},${row.photo_eye},${row.state}\n`);
    const csv = (await d.get(`/v1/runs/${run.id}/photo_eyes?format=csv`)).text;
    assert.equal(csv, `t_s,photo_eye,state\n${lines.join("")}`);
    const folder = await solved(t, fed());
    assert.equal(csv, readFileSync(path.join(folder, "photo_eyes.csv"), "utf8"));
  }
});

// A closed box whose eastern half is full of parts, and a plate in its middle that turns towards them.
const press = () => ({
  duration_s: 0.6, domain: { x_m: [0, 0.6], y_m: [0, 0.2] }, edges: { west: "wall", east: "wall" }, belts: [{ velocity_m_s: [0.1, 0] }], cargo: {},
  obstacles: [{ id: "arm", from_m: [0.3, 0], to_m: [0.3, 0.19], motion: { t_s: [0.05, 0.55], turn_deg: [0, -60] }, force_limit_n: 2 }],
  initial: { positions_m: Array.from({ length: 88 }, (_, k) => [0.6 - 0.0245 * (0.5 + (k % 11)), 0.0245 * (0.5 + Math.floor(k / 11))]) },
});

test("a plate that cargo stops is told in events, in its resource and in a sentence alike", async (t) => {
  const d = await daemon(t);
  for (const model of ["macro", "micro"]) {
    const run = await d.submit(press(), { model });
    const events = await (await d.events(run.id)).rest();
    const drives = events.filter(({ event }) => event === "drive").map(({ data: { run: id, ...rest } }) => rest);
    assert.ok(drives.some(({ obstacle, state, turn_deg: turn }) => obstacle === "arm" && state === "stalled" && turn > -60 && turn < 0));
    assert.deepEqual((await d.get(`/v1/runs/${run.id}/photo_eyes`)).json.drives, drives);
    const { key_figures: figures, verdicts } = (await d.get(`/v1/runs/${run.id}/summary`)).json;
    assert.equal(figures.stall.count, drives.filter(({ state }) => state === "stalled").length);
    assert.match(verdicts.find(({ kind }) => kind === "stalled").text, /'arm'/);
  }
});

test("a belt that fails is told in events, in its resource, in the curve and in key figures alike", async (t) => {
  const d = await daemon(t);
  for (const model of ["macro", "micro"]) {
    const run = await d.submit(tiny({ belts: [{ id: "main", failures: [{ id: "jam", t_s: [0.025], duration_s: [0.04] }] }] }), { model });
    const events = await (await d.events(run.id)).rest();
    const told = events.filter(({ event }) => event === "belt").map(({ data: { run: id, ...rest } }) => rest);
    assert.deepEqual(told.map(({ belt, state }) => [belt, state]), [["main", "failed"], ["main", "running"]]);
    assert.deepEqual((await d.get(`/v1/runs/${run.id}/photo_eyes`)).json.belts, told);
    const { t_s: times, columns } = (await d.get(`/v1/runs/${run.id}/curve`)).json;
    assert.deepEqual(columns["jam.failed"], times.map((at) => (at >= 0.025 && at < 0.065 ? 1 : 0)));
    const { belts: [main], failures: [jam] } = (await d.get(`/v1/runs/${run.id}/summary`)).json.key_figures;
    assert.deepEqual(jam, { id: "jam", failed: { count: 1, total_s: 0.04 } });
    assert.ok(Math.abs(main.availability - (1 - 0.04 / times.at(-1))) < 1e-9);
  }
});

test("ids rise strictly, over the runs of a store and its restarts (I6)", async (t) => {
  const d = await daemon(t);
  const ids = [];
  const follow = async () => {
    const run = await d.submit(tiny());
    ids.push(...(await (await d.events(run.id)).rest()).map((event) => Number(event.id)));
    return run;
  };
  const first = await follow();
  await follow();
  await d.request("DELETE", `/v1/runs/${first.id}`);
  await d.stop();
  await d.start();
  await follow();
  ids.forEach((id, k) => assert.ok(k === 0 || id > ids[k - 1], `${ids}`));
});

test("a client that returns after any event gets exactly the rest", async (t) => {
  const d = await daemon(t);
  const run = await ended(d, tiny());
  const all = await (await d.events(run.id)).rest();
  for (const [k, { id }] of all.slice(0, -1).entries()) {
    const rest = await (await d.events(run.id, { "last-event-id": id })).rest();
    assert.deepEqual(rest, all.slice(k + 1));
    const byQuery = await d.events(`/v1/runs/${run.id}/events?last_event_id=${id}`);
    assert.deepEqual(await byQuery.rest(), all.slice(k + 1));
  }
});

test("a client that leaves after every event of a live run has it all in the end", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(jam(1, { curve_every_s: 0.02, snapshot_every_s: 0.1 }));
  const seen = [];
  while (seen.at(-1)?.event !== "end") {
    const last = seen.at(-1)?.id;
    const stream = await d.events(run.id, last === undefined ? {} : { "last-event-id": last });
    seen.push(await stream.next());
    stream.close();
  }
  assert.deepEqual(seen, await (await d.events(run.id)).rest());
});

test("a client misses nothing when the daemon is killed under it (I1, I4, I7)", async (t) => {
  const d = await daemon(t, { checkpoint_ms: 50 });
  const run = await d.submit(interruptible());
  const seen = [];
  let stream = await d.events(run.id);
  while (!seen.some((event) => event.event === "snapshot" && event.data.n >= 3)) {
    seen.push(await stream.next());
  }
  await d.kill();
  seen.push(...(await stream.rest())); // what was on its way when the daemon died
  await d.start();
  stream = await d.events(run.id, { "last-event-id": seen.at(-1).id });
  seen.push(...(await stream.rest()));

  assert.deepEqual(seen, await (await d.events(run.id)).rest());
  const snapshots = seen.filter((event) => event.event === "snapshot");
  assert.deepEqual(snapshots.map((event) => event.data.n), snapshots.map((_, n) => n));
  let samples = 0;
  for (const { data } of seen.filter((event) => event.event === "curve")) {
    assert.equal(data.first, samples);
    samples += data.t_s.length;
  }
  assert.equal(samples, 201);
});

test("an ended run replays and closes; after its end there is no content", async (t) => {
  const d = await daemon(t);
  const run = await ended(d, tiny());
  const all = await (await d.events(run.id)).rest();
  const { id } = all.at(-1);
  for (const headers of [{ "last-event-id": id }, { "last-event-id": "9999999" }]) {
    const answer = await d.get(`/v1/runs/${run.id}/events`, headers);
    assert.deepEqual([answer.status, answer.body.length], [204, 0]);
  }
});

test("an id that is none is refused", async (t) => {
  const d = await daemon(t);
  const run = await ended(d, tiny());
  for (const id of ["x", "-1", "1.5", "18446744073709551616"]) {
    const answer = await d.get(`/v1/runs/${run.id}/events`, { "last-event-id": id });
    assert.equal(answer.status, 400, id);
  }
});

test("an idle stream is kept awake by comments", async (t) => {
  const d = await daemon(t, { heartbeat_ms: 100 });
  const busy = await d.submit(endless(), { priority: 1 });
  await d.reached(busy.id, "running");
  const waiting = await d.submit(tiny());
  const stream = await d.events(waiting.id);
  assert.equal((await stream.next()).data.status, "queued");
  const next = stream.next(); // reads on while nothing comes but comments
  await until(() => stream.comments >= 3, "three comments");
  await d.post(`/v1/runs/${waiting.id}/cancel`, "");
  assert.equal((await next).data.status, "cancelled");
  stream.close();
});

test("the same events come as lines of JSON", async (t) => {
  const d = await daemon(t);
  const run = await ended(d, tiny());
  const events = await (await d.events(run.id)).rest();
  for (const [target, headers] of [
    [`/v1/runs/${run.id}/events`, { accept: "application/x-ndjson" }],
    [`/v1/runs/${run.id}/events?format=ndjson`, {}],
  ]) {
    const answer = await d.get(target, headers);
    assert.equal(answer.headers["content-type"], "application/x-ndjson");
    const lines = answer.text.trimEnd().split("\n").map((line) => JSON.parse(line));
    assert.equal(lines.length, events.length);
    for (const [k, line] of lines.entries()) {
      assert.deepEqual([String(line.id), line.event], [events[k].id, events[k].event]);
    }
  }
});

test("a snapshot that comes inline holds the bytes of the stored one", async (t) => {
  const d = await daemon(t);
  const run = await ended(d, tiny());
  const events = await (await d.events(`/v1/runs/${run.id}/events?inline=1`)).rest();
  const snapshots = events.filter((event) => event.event === "snapshot");
  assert.equal(snapshots.length, 3);
  for (const { data } of snapshots) {
    const npy = (await d.get(data.url)).body;
    const grid = npy.subarray(10 + npy.readUInt16LE(8));
    assert.ok(Buffer.from(data.data, "base64").equals(grid));
  }
});

test("one stream follows several runs and closes when all have ended", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const runs = [await d.submit(tiny()), await d.submit(tiny()), await d.submit(tiny())];
  const stream = await d.events(`/v1/events?runs=${runs.map((run) => run.id).join(",")}`);
  const events = await stream.rest();
  const ends = events.filter((event) => event.event === "end");
  assert.equal(ends.length, 3);
  for (const run of runs) {
    const own = await (await d.events(run.id)).rest();
    assert.ok(own.every(({ id }) => events.some((event) => event.id === id)), run.id);
  }
});

test("the stream of a run that is not there is a 404", async (t) => {
  const d = await daemon(t);
  const nobody = "01890a5d-ac96-774b-bcce-b302099a8057";
  assert.equal((await d.get(`/v1/runs/${nobody}/events`)).status, 404);
  assert.equal((await d.get(`/v1/events?runs=${nobody}`)).status, 404);
});

// A client that asks for a stream and then does not read.
async function openWithoutReading(d, target) {
  const socket = net.connect(d.port, "127.0.0.1");
  await once(socket, "connect");
  socket.on("error", () => {}); // a client that is starved itself may be cut off
  socket.pause();
  socket.write(`GET ${target} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n`);
  return socket;
}

test("a reader that does not read slows no run and costs little memory", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(interruptible());
  const slow = [];
  for (let k = 0; k < 20; k++) {
    slow.push(await openWithoutReading(d, `/v1/runs/${run.id}/events?inline=1`));
  }
  await d.reached(run.id, "succeeded");
  if (!isSanitized) assert.ok(residentBytes(d.pid) < 128 * 1024 * 1024, `${residentBytes(d.pid)}`);

  let text = "";
  slow[0].on("data", (chunk) => (text += chunk));
  slow[0].resume();
  await until(() => /event: end\n/.test(text), "the end of the slow stream");
  for (const socket of slow) socket.destroy();
});

test("a hundred readers of one run all get the same", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(jam(2, { curve_every_s: 0.02, snapshot_every_s: 0.2 }));
  const streams = await Promise.all(Array.from({ length: 100 }, () => d.events(run.id)));
  const all = await within(Promise.all(streams.map((stream) => stream.rest())), "all streams");
  for (const events of all) assert.deepEqual(events, all[0]);
  assert.equal(all[0].at(-1).event, "end");
});

test("streams beyond the limit are refused for a while", async (t) => {
  const d = await daemon(t, { streams: 2 });
  const run = await d.submit(endless());
  const streams = [await d.events(run.id), await d.events(run.id)];
  const answer = await d.get(`/v1/runs/${run.id}/events`);
  assert.equal(answer.status, 503, answer.text);
  assert.match(answer.headers["retry-after"], /^\d+$/);
  streams[0].close();
  await until(async () => {
    const stream = await d.events(run.id);
    stream.close();
    return stream.status === 200;
  }, "room for a stream");
  streams[1].close();
});
