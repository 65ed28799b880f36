// Quotas of owners: a real daemon with tokens, one owner who wants all there is, and another.

import assert from "node:assert/strict";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { endless, tiny } from "./scenarios.mjs";
import { temporaryFolder, until } from "./setup.mjs";
import { addToken } from "./tokens.mjs";

// A daemon with the settings, and what alice and bob do there.
async function owners(t, settings) {
  const data = path.join(temporaryFolder(t), "data");
  const tokens = Object.fromEntries(["alice", "bob"].map((name) => [name, addToken(data, name)]));
  const d = await daemon(t, { data, ...settings });
  const as = (who) => ({
    try: (scenario = tiny()) => d.post("/v1/runs", { scenario, fresh: true }, tokens[who]),
    async submit(scenario) {
      const answer = await this.try(scenario);
      assert.equal(answer.status, 201, answer.text);
      return answer.json.id;
    },
    run: async (id) => (await d.get(`/v1/runs/${id}`, tokens[who])).json,
    reached(id, status) {
      return until(async () => {
        const run = await this.run(id);
        return run.status === status && run;
      }, `${who}'s run to be ${status}`);
    },
    cancel: (id) => d.post(`/v1/runs/${id}/cancel`, "", tokens[who]),
    remove: (id) => d.request("DELETE", `/v1/runs/${id}`, { headers: tokens[who] }),
    quota: async () => (await d.get("/v1/quota", tokens[who])).json,
  });
  return { d, alice: as("alice"), bob: as("bob") };
}

test("one owner's flood delays another's run by one run, and has an end", async (t) => {
  const { alice, bob } = await owners(t, { owner_queue: 4 });
  const first = await alice.submit(endless());
  await alice.reached(first, "running");
  const flood = [await alice.submit(), await alice.submit(), await alice.submit(), await alice.submit()];
  const refused = await alice.try();
  assert.equal(refused.status, 429, refused.text);
  assert.match(refused.json.detail, /^4 runs of alice wait, of 4 allowed \(owner_queue\)/);
  assert.match(refused.headers["retry-after"], /^\d+$/);
  assert.deepEqual((await alice.quota()).waiting_runs, { used: 4, allowed: 4 });
  const single = await bob.submit();
  assert.equal((await alice.cancel(first)).status, 202);
  const { started_at: bobs } = await bob.reached(single, "succeeded");
  for (const id of flood) {
    const { started_at: hers } = await alice.reached(id, "succeeded");
    assert.ok(bobs <= hers, `${bobs} ${hers}`);
  }
  assert.equal((await alice.try()).status, 201);
});

test("with the CPU time used up an owner's runs wait, over a kill, and go on when there is more", async (t) => {
  const { d, alice, bob } = await owners(t, { owner_cpu_s: 1 });
  const first = await alice.submit(endless());
  await alice.reached(first, "running");
  const second = await alice.submit();
  await until(async () => (await alice.quota()).cpu_s.used >= 1, "a second of CPU time");
  const refused = await alice.try();
  assert.equal(refused.status, 429, refused.text);
  assert.match(refused.json.detail, /^runs of alice have used \d+ CPU seconds in 24 hours, of 1 allowed \(owner_cpu_s\)/);
  const { used, allowed, available_at: release } = (await alice.quota()).cpu_s;
  assert.equal(allowed, 1);
  const left = (Date.parse(release) - Date.now()) / 1000;
  assert.ok(left > 22 * 3600 && left <= 24 * 3600, release);
  assert.ok(Math.abs(Number(refused.headers["retry-after"]) - left) < 60, refused.headers["retry-after"]);
  await alice.cancel(first);
  await alice.reached(first, "cancelled");
  await bob.reached(await bob.submit(), "succeeded");
  assert.equal((await alice.run(second)).status, "queued");
  assert.equal((await bob.quota()).cpu_s.used, 0);
  await d.kill();
  d.settings.owner_cpu_s = 1000;
  await d.start();
  assert.ok((await alice.quota()).cpu_s.used >= used);
  await alice.reached(second, "succeeded");
});

test("results that were removed make room at once", async (t) => {
  const { alice, bob } = await owners(t, { owner_bytes: 3000 });
  const run = await alice.submit();
  await alice.reached(run, "succeeded");
  const refused = await alice.try();
  assert.equal(refused.status, 507, refused.text);
  assert.match(refused.json.detail, /^alice has \d+ bytes of results, of 3000 allowed \(owner_bytes\)/);
  await bob.reached(await bob.submit(), "succeeded");
  assert.ok((await alice.quota()).result_bytes.used > 0);
  assert.equal((await alice.remove(run)).status, 204);
  assert.deepEqual((await alice.quota()).result_bytes, { used: 0, allowed: 3000 });
  await alice.submit();
});

test("without tokens there are no quotas of owners", async (t) => {
  const d = await daemon(t, { owner_queue: 1, owner_cpu_s: 1, owner_bytes: 1 });
  await d.reached((await d.submit(endless())).id, "running");
  await d.submit(tiny(), { fresh: true });
  await d.submit(tiny(), { fresh: true });
  const { json } = await d.get("/v1/quota");
  assert.deepEqual(Object.keys(json), ["waiting_runs", "cpu_s", "result_bytes"]);
  assert.deepEqual(json.waiting_runs, { used: 2 });
});
