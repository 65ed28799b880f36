// `/v1/studies`: a study is followed to its end, gives the bytes of the command line, is paused, resumed, cancelled and
// removed; a trial is solved again with all its output; measured counts are named by their id.

import assert from "node:assert/strict";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { assertSameStudy } from "./results.mjs";
import { fed, plate } from "./scenarios.mjs";
import { until } from "./setup.mjs";

const studyOf = (changes) => ({
  name: "which angle",
  base: { scenario: plate(0.5) },
  parameters: [{ pointer: "/obstacles/0/length_m", values: [0.4, 0.5, 0.6, -1] }],
  objectives: [{ figure: "content.mean" }, { figure: "throughput_per_h", goal: "maximize" }],
  method: { type: "list" },
  ...changes,
});

async function begin(d, document) {
  const answer = await d.post("/v1/studies", document);
  assert.equal(answer.status, 201, answer.text);
  assert.equal(answer.headers.location, `/v1/studies/${answer.json.id}`);
  return answer.json;
}

async function show(d, id) {
  return (await d.get(`/v1/studies/${id}`)).json;
}

const reached = (d, id, ...states) =>
  until(async () => {
    const study = await show(d, id);
    return states.includes(study.status) ? study : null;
  }, `the study to be ${states}`);

test("a study that is followed to its end gives the bytes of the command line", async (t) => {
  const d = await daemon(t);
  const { id } = await begin(d, studyOf({}));
  const events = await (await d.events(`/v1/studies/${id}/events`)).rest();
  const trials = events.filter(({ event }) => event === "trial");
  assert.deepEqual(trials.map((event) => Number(event.id)), [1, 2, 3, 4]);
  assert.deepEqual(trials.map(({ data }) => data.trial).sort(), [0, 1, 2, 3]);
  const end = events.at(-1);
  assert.deepEqual([end.event, end.id, end.data.status], ["end", "5", "succeeded"]);
  assert.deepEqual([end.data.trials.succeeded, end.data.trials.infeasible], [3, 1]);
  // Behind any event the rest follows, and behind the last one nothing.
  const rest = await (await d.events(`/v1/studies/${id}/events`, { "last-event-id": "3" })).rest();
  assert.deepEqual(rest.filter((event) => event.id !== undefined).map((event) => event.id), ["4", "5"]);
  assert.equal((await d.events(`/v1/studies/${id}/events`, { "last-event-id": "5" })).status, 204);

  await assertSameStudy(t, d, id, (await d.get(`/v1/studies/${id}/document`)).json);

  const page = await d.get(`/v1/studies/${id}/trials?limit=3`);
  assert.equal(page.json.trials.length, 3);
  assert.deepEqual([page.json.has_more, page.json.next_from], [true, 3]);
  const next = /<(.*)>; rel="next"/.exec(page.headers.link)[1];
  const [last] = (await d.get(next)).json.trials;
  assert.deepEqual([last.trial, last.status, last.run], [3, "infeasible", undefined]);
  assert.match(last.error.pointer, /^\/obstacles\/0/);
  assert.deepEqual((await d.get("/v1/studies?status=succeeded")).json.studies.map((study) => study.id), [id]);
});

test("a trial is a run of its study, and is solved again with all its output", async (t) => {
  const d = await daemon(t);
  const { id } = await begin(d, studyOf({}));
  await reached(d, id, "succeeded");
  assert.deepEqual((await d.get("/v1/runs")).json.runs, []);
  const { runs } = (await d.get(`/v1/runs?study=${id}`)).json;
  assert.deepEqual(runs.map((run) => run.study), [id, id, id]);
  const { trials } = (await d.get(`/v1/studies/${id}/trials`)).json;
  const again = await d.post(`/v1/studies/${id}/trials/1/run`, "", { prefer: "wait=30" });
  assert.equal(again.status, 201, again.text);
  assert.deepEqual([again.json.status, again.json.cached, again.json.study], ["succeeded", false, undefined]);
  assert.ok((await d.get(`/v1/runs/${again.json.id}/snapshots`)).json.snapshots.length > 0);
  const figures = (await d.get(`/v1/runs/${again.json.id}/key_figures`)).json;
  assert.equal(figures.counters[0].content.mean, trials[1].values["content.mean"]);
  // What is known in full then is not solved a second time.
  const known = await d.post(`/v1/studies/${id}/trials/1/run`, "", { prefer: "wait=30" });
  assert.deepEqual([known.json.status, known.json.cached], ["succeeded", true]);
  assert.equal((await d.request("DELETE", `/v1/runs/${known.json.id}`)).status, 204);
  assert.equal((await d.post(`/v1/studies/${id}/trials/3/run`, "")).status, 409);
  assert.equal((await d.request("DELETE", `/v1/studies/${id}`)).status, 204);
  assert.equal((await d.get(`/v1/studies/${id}`)).status, 404);
  // The run that was made of a trial stays.
  assert.deepEqual((await d.get("/v1/runs")).json.runs.map((run) => run.id), [again.json.id]);
});

test("kill -9 while a study is made: it goes on, and ends with the bytes of the command line", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const document = studyOf({
    parameters: [{ pointer: "/obstacles/0/angle_deg", range: [60, 90] }],
    method: { type: "cmaes" },
    limits: { trials: 40 },
  });
  const { id } = await begin(d, document);
  for (const n of [3, 11, 12, 25]) {
    await until(async () => (await show(d, id)).trials.succeeded >= n, `${n} trials`);
    await d.kill();
    await d.start();
  }
  await reached(d, id, "succeeded");
  await assertSameStudy(t, d, id, document);
});

test("a study is paused, resumed and cancelled", async (t) => {
  const d = await daemon(t);
  const parameters = [{ pointer: "/obstacles/0/angle_deg", range: [60, 90], steps: 2000 }];
  const { id } = await begin(d, studyOf({ parameters, method: { type: "grid" } }));
  await until(async () => (await show(d, id)).trials.succeeded >= 2, "two trials");
  assert.ok([200, 202].includes((await d.post(`/v1/studies/${id}/pause`, "")).status));
  const { trials } = await reached(d, id, "paused");
  assert.ok(trials.succeeded < 2000);
  assert.equal((await d.post(`/v1/studies/${id}/pause`, "")).status, 409);
  assert.equal((await d.post(`/v1/studies/${id}/resume`, "")).status, 200);
  await until(async () => (await show(d, id)).trials.succeeded > trials.succeeded + 2, "further trials");
  assert.ok([200, 202].includes((await d.post(`/v1/studies/${id}/cancel`, "")).status));
  const ended = await reached(d, id, "cancelled");
  const { succeeded, cancelled, begun } = ended.trials;
  assert.equal(succeeded + cancelled, begun);
  assert.equal((await d.post(`/v1/studies/${id}/resume`, "")).status, 409);
});

test("a calibration names counts that were measured by their id", async (t) => {
  const d = await daemon(t);
  const scenario = plate(1);
  const run = await d.submit(scenario);
  await d.reached(run.id, "succeeded");
  const curve = (await d.get(`/v1/runs/${run.id}/curve`)).json;
  const measured = await d.post("/v1/measurements", { counter: "upstream", t_s: curve.t_s, count: curve.columns.upstream });
  const calibration = (measurement) => ({
    base: { scenario },
    parameters: [{ pointer: "/obstacles/0/length_m", range: [0.4, 0.6] }],
    curves: [{ counter: "upstream", measurement }],
    method: { type: "calibrate", points: 2 },
    limits: { trials: 4 },
  });
  const { id } = await begin(d, calibration(measured.json.id));
  const [stored] = (await d.get(`/v1/studies/${id}/document`)).json.curves;
  assert.deepEqual(stored, { counter: "upstream", t_s: curve.t_s, count: curve.columns.upstream });
  assert.equal((await reached(d, id, "succeeded", "failed")).status, "succeeded");
  const { best, profiles } = (await d.get(`/v1/studies/${id}/best`)).json;
  assert.ok(best.values["mse:upstream"].mean >= 0);
  assert.deepEqual(profiles.map(({ pointer }) => pointer), ["/obstacles/0/length_m"]);
  const refused = await d.post("/v1/studies", calibration(run.id));
  assert.deepEqual([refused.status, refused.json.errors[0].pointer], [422, "/curves/0/measurement"]);
});

// A feed by chance, so that runs differ; a plate that lets everything through.
function arrivals() {
  const { actions, photo_eyes: eyes, obstacles, ...scenario } = fed({ duration_s: 4 });
  return { ...scenario, feeds: [{ id: "infeed", edge: "west", y_m: [0.05, 0.25], rate_per_s: 20, arrivals: "poisson" }] };
}

test("several runs of a scenario are a study of one point, with the interval of its mean", async (t) => {
  const d = await daemon(t);
  const body = { scenario: arrivals(), model: "micro", label: "how sure", replications: 5 };
  const answer = await d.post("/v1/runs", body, { "idempotency-key": "\"five\"" });
  assert.equal(answer.status, 201, answer.text);
  assert.equal(answer.headers.location, `/v1/studies/${answer.json.id}`);
  assert.equal(answer.json.name, "how sure");
  assert.equal((await d.post("/v1/runs", body, { "idempotency-key": "\"five\"" })).json.id, answer.json.id);
  const study = await reached(d, answer.json.id, "succeeded", "failed");
  assert.deepEqual([study.status, study.trials.succeeded], ["succeeded", 5]);
  const { best, verdicts, has_chance: hasChance } = (await d.get(`/v1/studies/${study.id}/best`)).json;
  const { n, mean, interval_95: interval } = best.values.sustained_throughput_per_h;
  assert.ok(hasChance && n === 5 && interval[0] < mean && mean < interval[1], JSON.stringify(best));
  // Wilson's interval of 0 of 5: 0 to z^2/(5 + z^2) with z = 1.96, 43 %.
  const { mean: jams, interval_95: range } = best.values["jam.count"].jam_probability;
  assert.ok(jams === 0 && range[0] === 0 && Math.abs(range[1] - 0.4345) < 1e-3, JSON.stringify(range));
  assert.deepEqual(verdicts.map(({ kind }) => kind), ["replications", "jams"]);
  assert.match(verdicts[0].text, /^[0-9.,]+ ± [0-9.,]+ parts\/h is the mean of 5 runs .* 15 more runs would halve it\.$/);
  const csv = (await d.get(`/v1/studies/${study.id}/trials?format=csv`)).text.trim().split("\n");
  assert.equal(csv.length, 6);
});

test("without chance several runs are one, and the answer says so", async (t) => {
  const d = await daemon(t);
  const { json } = await d.post("/v1/runs", { scenario: plate(0.5), replications: 7 });
  const study = await reached(d, json.id, "succeeded", "failed");
  assert.equal(study.trials.succeeded, 1);
  const { best, verdicts } = (await d.get(`/v1/studies/${json.id}/best`)).json;
  assert.deepEqual(verdicts.map(({ kind }) => kind), ["no_chance"]);
  assert.equal(best.values.sustained_throughput_per_h.interval_95, undefined);
  // Without parameters only the method that takes a list is a study.
  const refused = await d.post("/v1/studies", studyOf({ parameters: [], method: { type: "grid" } }));
  assert.deepEqual([refused.status, refused.json.errors[0].pointer], [422, "/parameters"]);
});
