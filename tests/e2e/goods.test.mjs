// Usual goods: their table, and scenarios that name them.

import assert from "node:assert/strict";
import test from "node:test";

import { goodScenario } from "./bad_scenarios.mjs";
import { daemon } from "./daemon.mjs";

const scenarioOf = (cargo, more = {}) => {
  const scenario = { ...goodScenario(), domain: { x_m: [0, 4], y_m: [0, 2.4] }, cargo, ...more };
  delete scenario.obstacles;
  scenario.initial = { positions_m: [[0.5, 0.5], [1.5, 0.5], [2.5, 0.5]] };
  return scenario;
};

test("each goods of the table make a scenario with their shape, mass and frictions", async (t) => {
  const d = await daemon(t);
  const { goods, surfaces, frictions } = (await d.get("/v1/goods")).json;
  assert.ok(goods.length >= 20);
  const names = new Set(surfaces.map(({ name }) => name));
  for (const { a, b, friction, range: [low, high], source } of frictions) {
    assert.ok(names.has(a) && names.has(b));
    assert.ok(low <= friction + 5e-5 && friction - 5e-5 <= high);
    assert.ok(source.length > 0);
  }
  const between = (a, b) => frictions.find((pair) => (pair.a === a && pair.b === b) || (pair.a === b && pair.b === a)).friction;
  for (const { name, surface, shape, mass_kg: mass } of goods) {
    const answer = await d.post("/v1/validate", { scenario: scenarioOf({ goods: name }), model: "micro" });
    assert.equal(answer.status, 200, answer.text);
    const { cargo, contacts } = answer.json.resolved;
    assert.deepEqual([cargo.goods, cargo.shape, cargo.mass_kg], [name, shape, mass]);
    assert.equal(contacts.conveyor_cargo.friction, surface ? between(surface, "acetal") : 1);
    assert.equal(contacts.cargo_cargo.friction, surface ? between(surface, surface) : 0.15);
  }
});

test("members beside goods outrank them, and the resolved scenario resolves to itself", async (t) => {
  const d = await daemon(t);
  const given = scenarioOf({ goods: "keg-50", mass_kg: 12.5, shape: { height_m: 0.5 } }, { surfaces: { conveyor: "steel", handling: "pe" } });
  const { resolved } = (await d.post("/v1/validate", { scenario: given, model: "micro" })).json;
  assert.deepEqual(resolved.cargo.shape, { type: "cylinder", radius_m: 0.204, height_m: 0.5 });
  assert.equal(resolved.cargo.mass_kg, 12.5);
  assert.deepEqual(Object.values(resolved.contacts).map((contact) => contact.friction ?? contact), [0.27, 0.27, 0.16, 0.16]);
  const again = (await d.post("/v1/validate", { scenario: resolved, model: "micro" })).json;
  assert.deepEqual(again.resolved, resolved);
  // Without the names, the numbers are the same scenario.
  const { goods, surface, ...cargo } = resolved.cargo;
  const { surfaces, ...bare } = resolved;
  assert.ok(goods && surface && surfaces);
  const plain = (await d.post("/v1/validate", { scenario: { ...bare, cargo }, model: "micro" })).json.resolved;
  assert.deepEqual(plain, { ...bare, cargo });
});

test("a name that is not known is told with all that are", async (t) => {
  const d = await daemon(t);
  const { goods } = (await d.get("/v1/goods")).json;
  const { errors } = (await d.post("/v1/validate", { scenario: scenarioOf({ goods: "barrel" }) })).json;
  assert.deepEqual(errors.map(({ pointer }) => pointer), ["/scenario/cargo/goods"]);
  for (const { name } of goods) assert.ok(errors[0].detail.split(" ").includes(name), name);
});
