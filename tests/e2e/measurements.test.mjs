// Measured curves: stored, listed, removed, and compared with runs of both models.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { smallJam } from "./micro.mjs";
import { beltflow } from "./processes.mjs";
import { fed } from "./scenarios.mjs";
import { temporaryFolder } from "./setup.mjs";

const csv = { "content-type": "text/csv" };

// Twenty parts that ride past the counter within 0.4 s: 41 samples, 5 snapshots.
function passing() {
  return smallJam({ name: "a passage", duration_s: 0.4, obstacles: [] });
}

async function post(d, body, query = "") {
  const answer = await d.request("POST", `/v1/measurements.csv${query}`, { headers: csv, body });
  assert.equal(answer.status, 201, answer.text);
  assert.equal(answer.headers.location, `/v1/measurements/${answer.json.id}`);
  return answer.json;
}

async function refused(d, status, body, headers = csv) {
  const answer = await d.request("POST", "/v1/measurements", { headers, body });
  assert.equal(answer.status, status, answer.text);
  assert.equal(answer.headers["content-type"], "application/problem+json");
  return (answer.json.errors ?? []).map(({ pointer }) => pointer);
}

// What a camera would have seen of a computed curve: every third sample, later by a while.
function seen(curve, later_s) {
  const rows = curve.t_s.map((t, k) => [t + later_s, curve.columns.upstream[k]]).filter((_, k) => k % 3 === 0);
  return `t_s,count\r\n${rows.map((row) => row.join(",")).join("\r\n")}\r\n`;
}

async function solveBoth(d) {
  const runs = [];
  for (const model of ["macro", "micro"]) runs.push(await d.submit(passing(), { model, label: model }));
  for (const { id } of runs) await d.reached(id, "succeeded");
  return runs.map(({ id }) => id);
}

test("a measured curve is laid over the runs of both models", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const [macro, micro] = await solveBoth(d);
  const curve = (await d.get(`/v1/runs/${micro}/curve`)).json;
  const { id } = await post(d, seen(curve, 0.02), "?label=camera%202");

  const ids = [macro, micro, id];
  const answer = await d.get(`/v1/compare?runs=${ids}&reference=${micro}`);
  assert.equal(answer.status, 200, answer.text);
  const { reference, entries, pairs } = answer.json;
  assert.equal(reference, micro);
  assert.deepEqual(entries.map((entry) => entry.id), ids);
  assert.deepEqual(entries.map(({ kind, model }) => [kind, model]),
    [["run", "macro"], ["run", "micro"], ["measurement", null]]);
  assert.equal(entries[2].label, "camera 2");
  for (const { column, parts_start, t10_s, t90_s, throughput_per_s } of entries) {
    assert.equal(column, "upstream");
    assert.ok(t90_s > t10_s && throughput_per_s > 0 && parts_start > 19, JSON.stringify(entries));
  }
  assert.deepEqual(pairs.map(({ a, b }) => [a, b]), [[micro, macro], [micro, id]]);

  // The models differ, but not by much; their densities are on the same grid at the same times.
  const [models, measured] = pairs;
  assert.ok(models.curve.l1 > 0 && models.curve.l1 < 2, JSON.stringify(models.curve));
  assert.equal(models.density.n_common, 5);
  for (const { l1, emd_x_m, emd_y_m } of models.density.snapshots) {
    assert.ok(l1 >= 0 && l1 <= 1 && (emd_x_m === null || (emd_x_m >= 0 && emd_y_m >= 0)));
  }
  assert.ok(models.density.snapshots[0].emd_x_m < 1e-6); // both begin with the same density
  assert.equal(measured.density, null);
  // Seen 0.02 s later, and no closer than its samples, 0.03 s apart.
  const { drain_time_gap_s, l1, largest } = measured.curve;
  assert.ok(drain_time_gap_s > 0.02 - 1e-9 && drain_time_gap_s < 0.05 + 1e-9, `${drain_time_gap_s}`);
  assert.ok(l1 > 0 && l1 <= largest);
});

test("the path of CSV takes nothing else, and the one without an ending both", async (t) => {
  const d = await daemon(t);
  const body = "t_s,count\n0,2\n1,0\n";
  const send = (target, type) => d.request("POST", target, { headers: { "content-type": type }, body });
  const wrong = await send("/v1/measurements.csv", "application/json");
  assert.deepEqual([wrong.status, wrong.headers.accept], [415, "text/csv"]);
  const [own, other] = [await post(d, body, "?label=a"), (await send("/v1/measurements?label=a", "text/csv")).json];
  assert.deepEqual([other.label, other.t_s, other.count], [own.label, own.t_s, own.count]);
  assert.equal((await d.get("/v1/measurements.csv")).status, 405);
});

test("what a run counted, posted as measured, is at no distance from it", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(passing());
  await d.reached(run.id, "succeeded");
  const text = (await d.get(`/v1/runs/${run.id}/curve?format=csv`)).text;
  const json = (await d.get(`/v1/runs/${run.id}/curve`)).json;
  const asCsv = await post(d, text);
  const asJson = (await d.post("/v1/measurements", { counter: "left_domain", t_s: json.t_s, count: json.columns.left_domain })).json;
  const parts = ["curve", "key_figures", "photo_eyes"].map((part) => `/v1/runs/${run.id}/${part}`);
  const texts = [...parts.map((path) => [path, `${path}.csv`]),
    [`/v1/measurements/${asCsv.id}`, `/v1/measurements/${asCsv.id}.csv`]];
  for (const [path, alone] of texts) {
    assert.equal((await d.get(alone)).text, (await d.get(`${path}?format=csv`)).text, alone);
  }
  assert.deepEqual([asCsv.counter, asJson.counter], ["upstream", "left_domain"]);
  assert.deepEqual((await d.get(`/v1/measurements/${asJson.id}`)).json.t_s, json.t_s);
  for (const { id, counter } of [asCsv, asJson]) {
    const { a, b, curve } = (await d.get(`/v1/compare?a=${run.id}&b=${id}`)).json;
    assert.deepEqual([a.column, b.column], [counter, counter]);
    for (const name of ["l1", "l2", "largest"]) assert.equal(curve[name], 0, name);
    assert.equal(a.throughput_per_s, b.throughput_per_s);
  }
});

test("measurements survive a restart, page by page, until they are removed", async (t) => {
  const d = await daemon(t);
  const ids = [];
  for (const label of ["a", "b", "a"]) ids.push((await post(d, "t_s,count\n0,2\n1,0.1\n", `?label=${label}`)).id);
  await d.kill();
  await d.start();
  const seenIds = [];
  for (let target = "/v1/measurements?limit=2"; target !== undefined; ) {
    const page = await d.get(target);
    seenIds.push(...page.json.measurements.map(({ id }) => id));
    target = /<([^>]+)>; rel="next"/.exec(page.headers.link ?? "")?.[1];
  }
  assert.deepEqual(seenIds, [...ids].reverse());
  const some = (await d.get("/v1/measurements?label=b")).json.measurements;
  assert.deepEqual(some.map(({ id, n_samples }) => [id, n_samples]), [[ids[1], 2]]);
  const target = `/v1/measurements/${ids[0]}`;
  assert.equal((await d.get(target, { accept: "text/csv" })).text, "t_s,upstream\n0,2\n1,0.1\n");
  assert.equal((await d.request("DELETE", target)).status, 204);
  for (const method of ["GET", "DELETE"]) assert.equal((await d.request(method, target)).status, 404);
});

test("what is no measurement is refused with its place", async (t) => {
  const d = await daemon(t);
  assert.deepEqual(await refused(d, 422, "t_s,count\n0,2\n0.5,1\n0.5,x\n"), ["/line/4"]);
  assert.deepEqual(await refused(d, 422, "t_s,count\n0,2\n1,-1\n1,0\n"), ["/line/3", "/line/4"]);
  assert.deepEqual(await refused(d, 422, "zeit;zahl\n0;2\n"), ["/line/1"]);
  await refused(d, 415, "t_s,count\n0,2\n1,1\n", { "content-type": "text/plain" });
  await refused(d, 413, `t_s,count\n${"0,1\n".repeat(300_000)}`);
  const bad = await d.post("/v1/measurements", { t_s: [0, 1], count: [1, "0"] });
  assert.deepEqual([bad.status, bad.json.errors[0].pointer], [422, "/count/1"]);
  assert.deepEqual((await d.get("/v1/measurements")).json.measurements, []);
});

test("what cannot be compared is told with its place", async (t) => {
  const d = await daemon(t);
  const measure = (body, query) => post(d, body, query).then(({ id }) => id);
  const early = await measure("t_s,count\n0,2\n1,1\n");
  const late = await measure("t_s,count\n5,2\n6,1\n");
  const gate = await measure("t_s,gate\n0,2\n1,1\n");
  const nobody = "01234567-89ab-7cde-8f01-23456789abcd";
  for (const [status, ids, pointer] of [
    [422, [early, late], "/runs/1"],
    [422, [early, gate], "/runs/1"],
    [404, [early, early.replace(/^./, "z")], "/runs/1"],
    [404, [nobody, early], "/runs/0"],
  ]) {
    const answer = await d.get(`/v1/compare?runs=${ids}`);
    assert.equal(answer.status, status, answer.text);
    assert.deepEqual(answer.json.errors.map((error) => error.pointer), [pointer], answer.text);
  }
});

test("the command line compares several curves in one table", async (t) => {
  const folder = temporaryFolder(t);
  const files = ["a", "b", "c"].map((name) => path.join(folder, `${name}.csv`));
  // 100 parts leave evenly within 1 s, within 2 s, and not at all.
  writeFileSync(files[0], "t_s,count\n0,100\n1,0\n4,0\n");
  writeFileSync(files[1], "t_s,count\n0,100\n2,0\n4,0\n");
  writeFileSync(files[2], "t_s,count\n0,100\n4,100\n");
  const done = await beltflow(["compare", ...files]);
  assert.equal(done.status, 0, done.stderr);
  const [table, sentences] = done.stdout.trimEnd().split("\n\n");
  const [titles, , ...rows] = table.split("\n").map((line) => line.trim().split(/\s+/));
  assert.deepEqual(sentences.split("\n").map((line) => line.split(":")[0]), files.slice(1));
  assert.deepEqual(titles.slice(0, 3), ["drain", "throughput", "l1"]);
  assert.deepEqual(rows.map((row) => row.at(-1)), files);
  assert.deepEqual(rows[0].slice(0, -1), ["1", "100", "-", "-", "-", "-", "-", "-"]);
  // Between both lines lies a triangle of 50 parts at 1 s, over 2 of 4 s.
  assert.deepEqual(rows[1].slice(0, 3), ["2", "50", "12.5"]);
  assert.deepEqual(rows[1].slice(4, -1), ["50", "1", "1", "-50"]);
  assert.deepEqual(rows[2].slice(0, 3), ["-", "-", "87.5"]);
  const json = JSON.parse((await beltflow(["compare", "--json", ...files])).stdout);
  assert.deepEqual(json.pairs.map(({ a, b }) => [a, b]), [[files[0], files[1]], [files[0], files[2]]]);
  assert.equal(json.pairs[0].curve.drain_time_gap_s, 1);
  assert.equal(json.entries[2].throughput_per_s, null);
  assert.equal((await beltflow(["compare", ...Array(9).fill(files[0])])).status, 2);
  assert.equal((await beltflow(["compare", files[0]])).status, 2);
});

test("feeds take their profiles and lists of arrivals from stored measurements", async (t) => {
  const d = await daemon(t);
  const profile = (await post(d, "t_s,count\n0,4\n1,8\n2,0\n", "?kind=profile&label=monday"));
  const schedule = (await post(d, "t_s,kind,y_m\n0.5,tin,0.1\n1,box,0.2\n", "?kind=schedule"));
  assert.deepEqual([profile.kind, profile.n_samples, schedule.kind, schedule.t_end_s], ["profile", 3, "schedule", 1]);
  const feeds = (first, second) => [
    { edge: "west", y_m: [0.05, 0.25], profile: first, seed: 3 },
    { line_m: [[0.2, 0.05], [0.2, 0.25]], schedule: second }];
  const scenario = (...demands) => fed({ feeds: feeds(...demands), photo_eyes: [], actions: [],
    cargo: ["box", "tin"].map((id) => ({ ...fed().cargo, id })) });
  const named = scenario({ measurement: profile.id }, { measurement: schedule.id });
  const run = await d.submit(named, { model: "micro" });
  await d.reached(run.id, "succeeded");
  const resolved = (await d.get(`/v1/runs/${run.id}/scenario`)).json;
  assert.deepEqual(resolved.feeds[1].schedule.kind, ["tin", "box"]);
  assert.ok(!JSON.stringify(resolved).includes("measurement"));
  // The texts themselves are the same work, also when the measurements are gone.
  for (const { id } of [profile, schedule]) assert.equal((await d.request("DELETE", `/v1/measurements/${id}`)).status, 204);
  const inline = scenario({ csv: profile.csv }, { csv: schedule.csv });
  assert.equal((await d.post("/v1/runs", { scenario: inline, model: "micro" })).json.cached, true);
  const gone = await d.post("/v1/runs", { scenario: named, model: "micro" });
  assert.equal(gone.status, 422);
  assert.deepEqual(gone.json.errors.map(({ pointer }) => pointer),
    ["/scenario/feeds/0/profile/measurement"]);
  assert.ok(gone.json.detail.includes(`there is no measurement '${profile.id}'`), gone.text);
  // Without a daemon there is nothing that an id could name.
  const file = path.join(temporaryFolder(t), "scenario.json");
  writeFileSync(file, JSON.stringify(named));
  for (const command of ["check", "solve"]) {
    const done = await beltflow([command, file, ...(command === "solve" ? ["--out", temporaryFolder(t)] : [])]);
    assert.notEqual(done.status, 0);
    assert.match(done.stderr, /\/feeds\/0\/profile\/measurement.*needs a daemon/);
  }
});
