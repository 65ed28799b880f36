// The same request again, and the same work again: neither is done twice.

import assert from "node:assert/strict";
import { test } from "node:test";

import { daemon } from "./daemon.mjs";
import { assertSameResults, solve } from "./results.mjs";
import { endless, tiny } from "./scenarios.mjs";

const key = (text) => ({ "idempotency-key": text });

async function count(d) {
  return (await d.get("/v1/runs?limit=200")).json.runs.length;
}

function assertReplay(again, first) {
  assert.equal(again.status, first.status);
  assert.equal(again.text, first.text);
  assert.equal(again.headers.location, first.headers.location);
  assert.equal(again.headers.etag, first.headers.etag);
  assert.equal(again.headers["idempotent-replayed"], "true");
}

test("a key's first answer comes again after kill -9 right behind it (I1, I11)", async (t) => {
  const d = await daemon(t);
  for (let life = 0; life < 5; life++) {
    const body = { scenario: tiny(), label: `life ${life}`, fresh: true };
    const first = await d.post("/v1/runs", body, key(`"key of life ${life}"`));
    await d.kill();
    assert.equal(first.status, 201, first.text);
    assert.equal(first.headers["idempotent-replayed"], undefined);
    await d.start();
    assertReplay(await d.post("/v1/runs", body, key(`"key of life ${life}"`)), first);
    assert.equal(await count(d), life + 1);
    await d.reached(first.json.id, "succeeded");
    assertReplay(await d.post("/v1/runs", body, key(`"key of life ${life}"`)), first);
  }
});

test("an answer that was lost on its way is found by asking again (I11)", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const accepted = [];
  for (let life = 0; life < 4; life++) {
    const bodies = Array.from({ length: 6 }, (_, k) => ({ scenario: tiny(), label: `${life}-${k}` }));
    const posts = bodies.map((body) => d.post("/v1/runs", body, key(body.label)).catch(() => null));
    await new Promise((resolve) => setTimeout(resolve, 5 * life));
    await d.kill();
    await Promise.all(posts);
    await d.start();
    for (const body of bodies) {
      const answer = await d.post("/v1/runs", body, key(body.label));
      assert.equal(answer.status, 201, answer.text);
      accepted.push(answer.json.id);
    }
  }
  const { runs } = (await d.get("/v1/runs?limit=200")).json;
  assert.deepEqual(new Set(runs.map((run) => run.id)), new Set(accepted));
  assert.equal(runs.length, 24);
});

test("many requests at once with one key make one run", async (t) => {
  const d = await daemon(t);
  const body = { scenario: endless() };
  const answers = await Promise.all(
    Array.from({ length: 30 }, () => d.post("/v1/runs", body, key("the-key"))),
  );
  for (const answer of answers) assert.ok([201, 409].includes(answer.status), answer.text);
  const ids = answers.filter(({ status }) => status === 201).map(({ json }) => json.id);
  assert.equal(new Set(ids).size, 1);
  assert.equal(await count(d), 1);
  const last = await d.post("/v1/runs", body, key("the-key"));
  assert.equal(last.json.id, ids[0]);
});

test("a key with another body is refused, and one of a removed run answers as before", async (t) => {
  const d = await daemon(t);
  const body = { scenario: tiny() };
  const first = await d.post("/v1/runs", body, key("k"));
  const other = await d.post("/v1/runs", { scenario: tiny({ duration_s: 0.2 }) }, key("k"));
  assert.equal(other.status, 422);
  assert.equal(other.headers["content-type"], "application/problem+json");
  assert.match(other.json.detail, /another body/);
  for (const bad of ["a,b", '""', "k".repeat(256)]) {
    assert.equal((await d.post("/v1/runs", body, key(bad))).status, 400);
  }
  assert.equal((await d.request("DELETE", first.headers.location)).status, 204);
  assertReplay(await d.post("/v1/runs", body, key("k")), first);
  assert.equal((await d.get(first.headers.location)).status, 404);
  assert.equal(await count(d), 0);
});

test("who prefers to wait is shown the run as it is, also when a key comes again", async (t) => {
  const d = await daemon(t);
  const body = { scenario: tiny(), fresh: true };
  const waits = { ...key("k"), prefer: "wait=30" };
  const waited = await d.post("/v1/runs", body, waits);
  assert.deepEqual([waited.status, waited.json.status], [201, "succeeded"]);
  const first = await d.post("/v1/runs", body, key("k"));
  assert.equal(first.json.status, "queued");
  assertReplay(await d.post("/v1/runs", body, key("k")), first);
  const again = await d.post("/v1/runs", body, waits);
  assert.deepEqual(again.json, waited.json);
  assert.equal(again.headers["idempotent-replayed"], "true");
  assert.equal(await count(d), 1);
});

test("the same work is done once, and both runs have all its results (I10)", async (t) => {
  const d = await daemon(t);
  const scenario = tiny({ name: "the second one" });
  const first = await d.submit(tiny());
  await d.reached(first.id, "succeeded");
  const answer = await d.post("/v1/runs", { scenario, label: "again" });
  assert.equal(answer.status, 201);
  const second = answer.json;
  assert.equal(second.status, "succeeded");
  assert.equal(second.cached, true);
  assert.equal(second.progress, 1);
  assert.equal(second.name, "the second one");
  assert.equal(second.label, "again");
  assert.equal((await d.run(first.id)).cached, false);

  const summary = (await d.get(`/v1/runs/${second.id}/summary`)).json;
  assert.equal(summary.cached, true);
  assert.equal(summary.scenario.name, "the second one");
  // Without the first one it has them still.
  assert.equal((await d.request("DELETE", `/v1/runs/${first.id}`)).status, 204);
  await assertSameResults(d, second.id, await solve(t, scenario));
  const third = (await d.post("/v1/runs", { scenario })).json;
  assert.equal(third.cached, true);
});

test("a run that was not solved tells what it would have told", async (t) => {
  const d = await daemon(t);
  const first = await d.submit(tiny());
  const told = await (await d.events(first.id)).rest();
  const second = (await d.post("/v1/runs", { scenario: tiny() })).json;
  assert.equal(second.cached, true);
  const again = await (await d.events(second.id)).rest();
  // Of key figures the last ones; a run that takes longer has told earlier ones, too.
  const results = (events, id) => {
    const figures = events.filter(({ event }) => event === "figures").slice(0, -1);
    return events
      .filter((one) => ["curve", "snapshot", "figures"].includes(one.event) && !figures.includes(one))
      .map(({ event, data }) => [event, JSON.stringify(data).replaceAll(id, "ID")]);
  };
  assert.deepEqual(results(again, second.id), results(told, first.id));
  const { key_figures } = (await d.get(`/v1/runs/${second.id}/summary`)).json;
  assert.deepEqual(again.filter(({ event }) => event === "figures").at(-1).data.key_figures, key_figures);
  assert.deepEqual(
    again.slice(-2).map(({ event }) => event),
    ["status", "end"],
  );
  assert.equal(again.at(-2).data.cached, true);
  const [{ data }] = again.filter(({ event }) => event === "snapshot");
  assert.equal((await d.get(data.url)).status, 200);
  // From the middle on, too; and after the end there is nothing more.
  const middle = again[Math.floor(again.length / 2)];
  const rest = await (await d.events(second.id, { "last-event-id": middle.id })).rest();
  assert.deepEqual(rest, again.slice(again.indexOf(middle) + 1));
  const over = await d.get(`/v1/runs/${second.id}/events`, { "last-event-id": again.at(-1).id });
  assert.equal(over.status, 204);
});

test("what is not the same work, or wanted fresh, is solved", async (t) => {
  const d = await daemon(t);
  const first = await d.submit(tiny());
  await d.reached(first.id, "succeeded");
  const bodies = [
    { scenario: tiny(), fresh: true },
    { scenario: tiny({ duration_s: 0.11 }) },
    { scenario: tiny(), model: "micro" },
  ];
  for (const body of bodies) {
    const answer = await d.post("/v1/runs", body);
    assert.equal(answer.json.cached, false);
    assert.equal(answer.json.status, "queued");
    await d.reached(answer.json.id, "succeeded");
  }
  assert.equal((await d.post("/v1/runs", { scenario: tiny(), model: "micro" })).json.cached, true);
});
