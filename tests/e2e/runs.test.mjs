// The main use case: a scenario is submitted, and its results are the command line's bytes.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { digestOfFolder, goldenDigest } from "./golden.mjs";
import { beltflow } from "./processes.mjs";
import { assertSameResults, solve } from "./results.mjs";
import { fed, jam, tiny } from "./scenarios.mjs";
import { isSanitized, temporaryFolder } from "./setup.mjs";

const curveMeasures = ["l1", "l2", "largest"];

async function readyExamples(d) {
  const { examples } = (await d.get("/v1/examples")).json;
  const documents = [];
  for (const { name } of examples) {
    const answer = await d.get(`/v1/examples/${name}`);
    assert.equal(answer.status, 200);
    documents.push({ name, scenario: answer.json });
  }
  return documents;
}

test("a run that is followed to its end gives the bytes of the command line", async (t) => {
  const d = await daemon(t);
  const scenario = jam(2, { curve_every_s: 0.01, snapshot_every_s: 0.1 });
  const run = await d.submit(scenario, { label: "first" });
  assert.deepEqual([run.model, run.label, run.priority], ["macro", "first", 0]);

  const events = await (await d.events(run.id)).rest();
  assert.equal(events[0].event, "status");
  assert.equal(events.at(-1).event, "end");
  assert.equal(events.at(-1).data.status, "succeeded");
  const ended = await d.run(run.id);
  assert.deepEqual([ended.status, ended.progress, ended.error], ["succeeded", 1, null]);
  await assertSameResults(d, run.id, await solve(t, scenario));
});

test("the curve of the events is the stored curve, sample by sample", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(jam(2, { curve_every_s: 0.01, snapshot_every_s: 0.1 }));
  const events = await (await d.events(run.id)).rest();
  const told = { t_s: [], columns: { upstream: [], left_domain: [] } };
  for (const { data: { first, t_s, columns } } of events.filter(({ event }) => event === "curve")) {
    assert.equal(first, told.t_s.length);
    told.t_s.push(...t_s);
    for (const [name, values] of Object.entries(columns)) told.columns[name].push(...values);
  }
  assert.deepEqual(told, (await d.get(`/v1/runs/${run.id}/curve`)).json);
  assert.equal(told.t_s.length, 201);
});

test("the location of a new run is its document", async (t) => {
  const d = await daemon(t);
  const answer = await d.post("/v1/runs", { scenario: tiny() });
  assert.equal(answer.status, 201);
  assert.equal(answer.headers.location, `/v1/runs/${answer.json.id}`);
  const run = (await d.get(answer.headers.location)).json;
  assert.equal(run.links.self, answer.headers.location);
  for (const link of ["scenario", "curve", "snapshots", "events"]) {
    const found = await d.get(run.links[link]);
    assert.ok(found.status === 200, `${link}: ${found.status}`);
  }
});

test("every ready example is accepted as it is", async (t) => {
  const d = await daemon(t);
  const examples = await readyExamples(d);
  const names = examples.map((example) => example.name);
  for (const name of ["example-1", "example-2", "example-3"]) assert.ok(names.includes(name));
  for (const { name, scenario } of examples) {
    const answer = await d.post("/v1/validate", { scenario });
    assert.equal(answer.status, 200, `${name}: ${answer.text}`);
  }
});

// Of these golden.test.mjs has the digests; the archive has all files that the command line writes.
test("every ready example is solved to the command line's bytes", { skip: isSanitized }, async (t) => {
  const d = await daemon(t, { workers: 2 });
  const runs = [];
  for (const { name, scenario } of await readyExamples(d)) runs.push({ name, id: (await d.submit(scenario, { label: name })).id });
  for (const { name, id } of runs) {
    assert.equal((await d.reached(id, "succeeded")).label, name);
    const folder = temporaryFolder(t);
    const archive = path.join(folder, "results.zip");
    writeFileSync(archive, (await d.get(`/v1/runs/${id}/results.zip`)).body);
    const done = spawnSync("python3", ["-m", "zipfile", "-e", archive, path.join(folder, "out")]);
    assert.equal(done.status, 0, done.stderr.toString());
    assert.equal(digestOfFolder(path.join(folder, "out")), goldenDigest(name, "macro"), name);
    const read = (file) => readFileSync(path.join(folder, "out", file), "utf8");
    assert.equal((await d.get(`/v1/runs/${id}/curve?format=csv`)).text, read("curve.csv"), name);
    assert.deepEqual((await d.get(`/v1/runs/${id}/summary`)).json, JSON.parse(read("summary.json")), name);
  }
});

test("the resolved scenario, submitted again, gives the same results", async (t) => {
  const d = await daemon(t);
  const first = await d.submit(tiny());
  await d.reached(first.id, "succeeded");
  const resolved = await d.get(`/v1/runs/${first.id}/scenario`);
  const second = await d.submit(resolved.json);
  await d.reached(second.id, "succeeded");
  for (const part of ["scenario", "curve?format=csv", "snapshots/2"]) {
    const [a, b] = await Promise.all(
      [first, second].map((run) => d.get(`/v1/runs/${run.id}/${part}`)),
    );
    assert.deepEqual(a.body, b.body, part);
  }
});

test("runs are found by a part of their name or label, sorted by a key figure, counted", async (t) => {
  const d = await daemon(t);
  const durations = [0.02, 0.03, 0.01, 0.04];
  for (const [k, duration_s] of durations.entries()) {
    const run = await d.submit(tiny({ duration_s, name: `Belt of ${k} m` }), { label: k % 2 === 0 ? "Hall East" : "" });
    await d.reached(run.id, "succeeded");
  }
  const list = async (query) => (await d.get(`/v1/runs?${query}`)).json;
  assert.deepEqual((await list("search=hall")).runs.map(({ name }) => name), ["Belt of 2 m", "Belt of 0 m"]);
  assert.deepEqual((await list("search=OF%203")).runs.map(({ name }) => name), ["Belt of 3 m"]);
  assert.equal((await list("search=hall&count=1&limit=1")).total, 2);
  assert.equal((await list("")).total, undefined);
  const names = [];
  for (let target = "/v1/runs?sort=name&limit=3"; target;) {
    const page = await d.get(target);
    names.push(...page.json.runs.map(({ name }) => name));
    target = /<(.*)>; rel="next"/.exec(page.headers.link ?? "")?.[1];
  }
  assert.deepEqual(names, ["Belt of 0 m", "Belt of 1 m", "Belt of 2 m", "Belt of 3 m"]);
  const entered = (await list("sort=-parts.entered")).runs.map((run) => run.key_figures.parts.entered);
  assert.deepEqual(entered, [...entered].sort((a, b) => b - a));
});

test("validating says yes to what is good, and stores nothing", async (t) => {
  const d = await daemon(t);
  const answer = await d.post("/v1/validate", { scenario: tiny() });
  assert.equal(answer.status, 200, answer.text);
  assert.deepEqual((await d.get("/v1/runs")).json.runs, []);
});

test("validating says before a run what its summary will say", async (t) => {
  const d = await daemon(t);
  const scenario = jam(0.1, { curve_every_s: 0.05, snapshot_every_s: 0.1 });
  const before = (await d.post("/v1/validate", { scenario })).json;
  assert.equal(before.validity.compared, false);
  const doubts = [...before.validity.outside, ...before.validity.never_compared];
  assert.deepEqual(doubts.map(({ pointer }) => pointer), before.warning_details.map(({ pointer }) => pointer));
  assert.deepEqual(before.warning_details.map(({ title, meaning }) => `${title}. ${meaning}`), before.warnings);
  const opening = before.validity.outside.find(({ what }) => what === "opening");
  assert.deepEqual([opening.value, opening.pointer], [0, "/obstacles/0"]);
  const run = await d.submit(scenario);
  await d.reached(run.id, "succeeded");
  const { validity, warnings, warning_details: details } = (await d.get(`/v1/runs/${run.id}/summary`)).json;
  assert.deepEqual(validity, before.validity);
  for (const text of before.warnings) assert.ok(warnings.includes(text), text);
  assert.deepEqual(details.map(({ title, meaning }) => `${title}. ${meaning}`), warnings);
});

test("validating warns of a deflector that cargo passes behind", async (t) => {
  const d = await daemon(t);
  const { scenario } = (await readyExamples(d)).find(({ name }) => name === "example-1");
  const tip = scenario.obstacles[0].to_m;
  // Of 40 degrees: it begins at x = 0.154 m, and the cargo ends at x = 0.38 m.
  scenario.obstacles[0].from_m = [tip[0] - tip[1] / Math.tan((40 * Math.PI) / 180), 0];
  const { warning_details: details } = (await d.post("/v1/validate", { scenario })).json;
  assert.deepEqual(details.map(({ title, pointer }) => [title, pointer]), [["Cargo starts behind a deflector", "/obstacles/0"]]);
  assert.match(details[0].meaning, /^\d+ of 192 parts start behind 'singularizer', which does not hold them back: /);
});

test("the paper's Examples lie where the models were compared", async (t) => {
  const d = await daemon(t);
  for (const { name, scenario } of await readyExamples(d)) {
    const { validity } = (await d.post("/v1/validate", { scenario })).json;
    if (name.startsWith("example-")) assert.ok(validity.compared, name);
  }
});

test("a run compared with itself is apart by nothing", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  const measures = (await d.get(`/v1/compare?a=${run.id}&b=${run.id}`)).json;
  for (const name of curveMeasures) assert.equal(measures.curve[name], 0, name);
  assert.equal(measures.density.snapshots.length, 3);
  for (const { mean_abs } of measures.density.snapshots) assert.equal(mean_abs, 0);
});

test("a comparison has the flows of the counters that both runs have", async (t) => {
  const d = await daemon(t);
  const runs = [];
  for (const rate_per_s of [10, 20]) {
    const { id } = await d.submit(fed({ obstacles: [], actions: [], feeds: [{ id: "infeed", edge: "west", y_m: [0.05, 0.25], rate_per_s }] }));
    await d.reached(id, "succeeded");
    const { key_figures } = (await d.get(`/v1/runs/${id}/summary`)).json;
    runs.push({ id, flow: key_figures.counters[0].flow_per_h });
  }
  const [a, b] = runs;
  assert.ok(b.flow > a.flow);
  const compared = async (column) => (await d.get(`/v1/compare?a=${a.id}&b=${b.id}&column=${column}&densities=0`)).json;
  const { flows, curve: inside, b: entry } = await compared("upstream");
  // What is inside enters while it leaves; what left only rises.
  for (const figure of ["drain_time_a_s", "drain_time_gap_s", "rate_a_per_s", "throughput_a_per_s", "throughput_b_per_s", "throughput_gap_per_s"])
    assert.equal(inside[figure], null, figure);
  assert.deepEqual([entry.drain_time_s, entry.t10_s, entry.throughput_per_s], [null, null, null]);
  assert.ok(inside.l1 > 0);
  const { curve: left } = await compared("left_domain");
  assert.ok(left.throughput_b_per_s > left.throughput_a_per_s && left.drain_time_a_s === null);
  const { flow_gap_per_h: gap, ...others } = flows[0];
  assert.equal(flows.length, 1);
  assert.deepEqual(others, { of: "counter", id: "upstream", flow_a_per_h: a.flow, flow_error_a_per_h: null, flow_b_per_h: b.flow, flow_error_b_per_h: null });
  assert.ok(Math.abs(gap - (b.flow - a.flow)) < 1e-6 * b.flow);
});

test("two runs compared give the measures of the command line", async (t) => {
  const d = await daemon(t);
  const scenarios = [tiny(), tiny({ belts: [{ velocity_m_s: [0.2, 0] }] })];
  const runs = [];
  const folders = [];
  for (const scenario of scenarios) {
    runs.push(await d.submit(scenario));
    folders.push(await solve(t, scenario));
  }
  for (const run of runs) await d.reached(run.id, "succeeded");
  const { curve } = (await d.get(`/v1/compare?a=${runs[0].id}&b=${runs[1].id}`)).json;
  const done = await beltflow(["compare", ...folders]);
  assert.equal(done.status, 0, done.stderr);
  const [titles, , , row] = done.stdout.split("\n").map((line) => line.trim().split(/\s+/));
  for (const name of curveMeasures) {
    const printed = Number(row[titles.indexOf(name)]);
    assert.ok(curve[name] > 0 && Math.abs(printed / curve[name] - 1) < 1e-5, name); // 6 digits
  }
});

test("runs are listed newest first, page by page, and by state and label", async (t) => {
  const d = await daemon(t);
  const ids = [];
  for (const label of ["a", "b", "a", "b", "a"]) ids.push((await d.submit(tiny(), { label })).id);
  for (const id of ids) await d.reached(id, "succeeded");

  const newest = [...ids].reverse();
  const listed = async (target) => {
    const answer = await d.get(target);
    assert.equal(answer.status, 200, answer.text);
    return { ids: answer.json.runs.map((run) => run.id), link: answer.headers.link };
  };
  assert.deepEqual((await listed("/v1/runs")).ids, newest);
  assert.deepEqual((await listed("/v1/runs?label=b")).ids, [ids[3], ids[1]]);
  assert.deepEqual((await listed("/v1/runs?status=failed")).ids, []);
  assert.deepEqual((await listed("/v1/runs?status=succeeded&model=macro")).ids, newest);

  const seen = [];
  for (let target = "/v1/runs?limit=2"; target !== undefined; ) {
    const page = await listed(target);
    seen.push(...page.ids);
    target = /<([^>]+)>; rel="next"/.exec(page.link ?? "")?.[1];
  }
  assert.deepEqual(seen, newest);
});

test("a run and a study are renamed, found by their new names, and keep their results", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny({ name: "before" }), { label: "a" });
  await d.reached(run.id, "succeeded");
  const curve = (await d.get(`/v1/runs/${run.id}/curve`)).text;
  const patch = (target, value) => d.request("PATCH", target, { body: JSON.stringify(value), headers: { "content-type": "application/json" } });
  const renamed = await patch(`/v1/runs/${run.id}`, { name: "hall 2, monday", notes: "plate as built" });
  assert.equal(renamed.status, 200, renamed.text);
  const { name, label, notes } = (await d.get(`/v1/runs/${run.id}`)).json;
  assert.deepEqual([name, label, notes], ["hall 2, monday", "a", "plate as built"]);
  assert.deepEqual((await d.get("/v1/runs?search=monday")).json.runs.map(({ id }) => id), [run.id]);
  assert.equal((await d.get(`/v1/runs/${run.id}/scenario`)).json.name, "before");
  assert.equal((await d.get(`/v1/runs/${run.id}/curve`)).text, curve);
  assert.equal((await patch(`/v1/runs/${run.id}`, { starred: true })).json.starred, true);
  await d.submit(tiny());
  const starred = (await d.get("/v1/runs?starred=1&count=1")).json;
  assert.deepEqual([starred.runs.map(({ id }) => id), starred.total], [[run.id], 1]);
  assert.equal((await patch(`/v1/runs/${run.id}`, { starred: null })).json.starred, undefined);
  assert.deepEqual((await d.get("/v1/runs?starred=1")).json.runs, []);
  const refused = await patch(`/v1/runs/${run.id}`, { name: "x".repeat(201) });
  assert.deepEqual([refused.status, refused.json.errors[0].pointer], [422, "/name"]);

  const study = await d.post("/v1/studies", { name: "before", base: { scenario: tiny() }, method: { type: "grid" },
    parameters: [{ pointer: "/duration_s", range: [0.1, 0.2], steps: 2 }], objectives: [{ figure: "peak_density" }] });
  assert.equal(study.status, 201, study.text);
  assert.equal((await patch(`/v1/studies/${study.json.id}`, { name: "after" })).json.name, "after");
  assert.equal((await d.get(`/v1/studies/${study.json.id}`)).json.name, "after");
});

test("runs and studies belong to lines, whose scenarios are their versions", async (t) => {
  const d = await daemon(t);
  const submit = (changes, more) => d.submit(tiny(changes), { line: "hall 2", ...more });
  const patch = (target, value) => d.request("PATCH", target, { body: JSON.stringify(value), headers: { "content-type": "application/json" } });
  const yesterday = await submit({ name: "as built" });
  const longer = await submit({ name: "longer", duration_s: 0.2 });
  // The other model and another name make no other scenario.
  const again = await submit({ name: "as built, again" }, { model: "micro" });
  const alone = await d.submit(tiny({ duration_s: 0.2 }));
  assert.deepEqual([yesterday, longer, again, alone].map(({ line, line_version: version }) => [line, version]),
    [["hall 2", 1], ["hall 2", 2], ["hall 2", 1], [undefined, undefined]]);
  const listed = async (target) => (await d.get(target)).json;
  const { runs, total } = await listed("/v1/runs?line=hall%202&count=1");
  assert.deepEqual([runs.map(({ id }) => id), total], [[again.id, longer.id, yesterday.id], 3]);
  assert.deepEqual((await listed("/v1/runs?search=hall&sort=name")).runs.map(({ id }) => id), [yesterday.id, again.id, longer.id]);

  const moved = await patch(`/v1/runs/${alone.id}`, { line: "hall 2" });
  assert.equal(moved.json.line_version, 2, moved.text);
  assert.equal((await patch(`/v1/runs/${alone.id}`, { line: null })).json.line_version, undefined);

  const study = await d.post("/v1/studies", { line: "hall 2", base: { scenario: tiny() }, method: { type: "grid" },
    parameters: [{ pointer: "/duration_s", range: [0.1, 0.2], steps: 2 }], objectives: [{ figure: "peak_density" }] });
  assert.equal(study.json.line, "hall 2", study.text);
  const other = await d.post("/v1/studies", { base: { scenario: tiny() }, method: { type: "list" }, parameters: [],
    objectives: [{ figure: "peak_density" }] });
  const studies = async () => (await listed("/v1/studies?line=hall%202")).studies.map(({ id }) => id);
  assert.deepEqual(await studies(), [study.json.id]);
  assert.equal((await patch(`/v1/studies/${other.json.id}`, { line: "hall 2" })).json.line, "hall 2");
  assert.deepEqual(await studies(), [other.json.id, study.json.id]);
  const pages = await d.get("/v1/studies?line=hall%202&limit=1");
  assert.match(pages.headers.link, /&line=hall%202&/);

  const newer = await d.submit(tiny(), { line: "hall 3" });
  const { lines } = await listed("/v1/lines");
  assert.deepEqual(lines.map(({ used_at: at, ...line }) => line), [
    { line: "hall 3", versions: 1, runs: 1, studies: 0, newest_run: newer.id },
    { line: "hall 2", versions: 2, runs: 3, studies: 2, newest_run: again.id }]);
  assert.deepEqual(lines.map(({ used_at: at }) => at), [newer.created_at, other.json.created_at]);
  const first = await d.get("/v1/lines?limit=1");
  assert.deepEqual(first.json.lines.map(({ line }) => line), ["hall 3"]);
  const next = await listed(/<([^>]+)>; rel="next"/.exec(first.headers.link)[1]);
  assert.deepEqual([next.lines.map(({ line }) => line), next.has_more], [["hall 2"], false]);
});

test("a removed run is gone with all it had", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  assert.equal((await d.request("DELETE", `/v1/runs/${run.id}`)).status, 204);
  for (const part of ["", "/curve", "/scenario", "/snapshots", "/snapshots/0", "/events"]) {
    assert.equal((await d.get(`/v1/runs/${run.id}${part}`)).status, 404, part);
  }
  assert.equal((await d.request("DELETE", `/v1/runs/${run.id}`)).status, 404);
});

test("a snapshot is a NumPy file of the grid and may be cached for ever", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  const answer = await d.get(`/v1/runs/${run.id}/snapshots/0`);
  assert.equal(answer.body.subarray(1, 6).toString(), "NUMPY");
  const header = answer.body.subarray(10, 10 + answer.body.readUInt16LE(8)).toString();
  assert.match(header, /'descr': '<f4', 'fortran_order': False, 'shape': \(12, 24\)/);
  assert.equal(answer.body.length, 10 + answer.body.readUInt16LE(8) + 4 * 24 * 12);
  assert.match(answer.headers["cache-control"], /immutable/);
  const again = await d.get(`/v1/runs/${run.id}/snapshots/0`, {
    "if-none-match": answer.headers.etag,
  });
  assert.deepEqual([again.status, again.body.length], [304, 0]);
});

test("threads change no bit of a run", { skip: isSanitized }, async (t) => {
  const scenario = jam(2, { curve_every_s: 0.05, snapshot_every_s: 0.5 });
  const one = await solve(t, scenario, "--threads", "1");
  const two = await solve(t, scenario, "--threads", "2");
  for (const file of ["curve.csv", ...readdirSync(path.join(one, "snapshots")).map((f) => `snapshots/${f}`)]) {
    assert.deepEqual(readFileSync(path.join(one, file)), readFileSync(path.join(two, file)), file);
  }
});
