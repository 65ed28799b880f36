// The document itself: its schemas compile, take what is good, refuse what is not, and an answer
// that differs from it is found, by our own check and by Prism.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import test from "node:test";

import { badScenarios, goodScenario } from "../e2e/bad_scenarios.mjs";
import { checkEvent, checkExchange, document } from "../e2e/contract.mjs";
import { startJudge } from "../e2e/prism.mjs";
import { packages, root } from "../e2e/setup.mjs";
import { fitsSchema, operations, readSamples } from "./sample_schemas.mjs";

const require = createRequire(path.join(packages, "package.json"));
const { Ajv2020 } = require("ajv/dist/2020.js");
const ajv = new Ajv2020({ strict: true, strictRequired: false, allowUnionTypes: true, allErrors: true });
require("ajv-formats")(ajv);
ajv.addFormat("binary", true);
ajv.addKeyword("components");
const { components } = document;
ajv.addSchema({ $id: "openapi.json", components: { schemas: components.schemas } }, "openapi.json", false, false);
const validate = (name) => ajv.getSchema(`openapi.json#/components/schemas/${name}`);

function assertTaken(name, value, what) {
  const check = validate(name);
  assert.ok(check(value), `${what}: ${JSON.stringify(check.errors)}`);
}

test("every schema compiles in ajv's strict mode", () => {
  const names = Object.keys(components.schemas);
  assert.ok(names.length > 80);
  for (const name of names) assert.equal(typeof validate(name), "function", name);
});

test("the ready examples fit the scenario's schema, and so do the document's own", () => {
  const folder = path.join(root, "api/scenario/examples");
  const files = readdirSync(folder);
  assert.ok(files.length >= 6);
  for (const file of files) {
    const scenario = JSON.parse(readFileSync(path.join(folder, file), "utf8"));
    assertTaken("Scenario", scenario, file);
    const name = path.basename(file, ".json");
    assert.deepEqual(components.examples[`${name}-scenario`].value, scenario);
    assertTaken("Submission", components.examples[`${name}-run`].value, name);
  }
});

// Bytes have none, and the document none of itself.
test("every operation has an example of its request and its answer, and each fits its schema", () => {
  const isShown = (type) => /json$|^text\//.test(type);
  const check = (what, bodies) => {
    const media = bodies.flatMap(({ content = {} }) => Object.entries(content)).filter(([type]) => isShown(type));
    const has = media.some(([, { examples = {} }]) => Object.keys(examples).length > 0);
    assert.ok(media.length === 0 || has, `${what} has no example`);
  };
  for (const [id, { operation }] of operations) {
    const answers = Object.entries(operation.responses).filter(([status]) => status.startsWith("2"));
    if (id !== "getDocument") check(`the answer of ${id}`, answers.map(([, answer]) => answer));
    if (operation.requestBody !== undefined) check(`the request of ${id}`, [operation.requestBody]);
  }
  for (const { kind, value } of readSamples()) assert.ok(fitsSchema(kind, value), `the example of ${kind}`);
});

test("an obstacle has one form, and where cargo is at the start is said once", () => {
  const scenario = goodScenario();
  const obstacles = {
    taken: [
      { end_m: [0.7, 0.4], angle_deg: 60, length_m: 0.4 },
      { from_m: [0.5, 0], to_m: [0.7, 0.4], thickness_m: 0.01 },
      { path_m: [[0.5, 0], [0.6, 0.2], [0.7, 0.4]] },
    ],
    refused: [
      {},
      { end_m: [0.7, 0.4], angle_deg: 60 },
      { from_m: [0.5, 0], to_m: [0.7, 0.4], angle_deg: 60 },
      { path_m: [[0.5, 0]] },
    ],
  };
  for (const obstacle of obstacles.taken) assertTaken("Obstacle", obstacle, JSON.stringify(obstacle));
  for (const obstacle of obstacles.refused) assert.ok(!validate("Obstacle")(obstacle), JSON.stringify(obstacle));
  const random = { count: 3, region: { x_m: [0, 1], y_m: [0, 1] } };
  assertTaken("Initial", { random }, "random");
  assert.ok(!validate("Initial")({ random, positions_m: [[0, 0]] }));
  assertTaken("Shape", {}, "a shape is a cylinder unless it says otherwise");
  assert.ok(!validate("Shape")({ type: "box", radius_m: 0.1 }));
  assertTaken("Scenario", scenario, "the good scenario of the stories");
});

// Faults of the scenario as a whole (overlaps, stability) cannot be found by a schema.
test("most bad scenarios of the stories are refused by the schema already", (t) => {
  const refused = badScenarios.filter(([, change]) => {
    const scenario = goodScenario();
    change(scenario);
    return !validate("Scenario")(scenario);
  });
  t.diagnostic(`${refused.length} of ${badScenarios.length} bad scenarios are refused by the schema`);
  assert.ok(refused.length > badScenarios.length / 2);
});

const json = { "content-type": "application/json", "cache-control": "no-store", "x-content-type-options": "nosniff", etag: "\"v\"", "x-request-id": "1" };
const version = { name: "beltflow", version: "1.2.3", api: "v1", compiler: "c" };

function answer(status, value, headers = json) {
  const text = value === undefined ? "" : JSON.stringify(value);
  return { status, headers, body: Buffer.from(text), text, json: value };
}

const without = (headers, name) => Object.fromEntries(Object.entries(headers).filter(([key]) => key !== name));

const differences = [
  ["a member too many", answer(200, { ...version, more: 1 })],
  ["a member that is missing", answer(200, { name: "beltflow", version: "1.2.3", api: "v1" })],
  ["a member of another type", answer(200, { ...version, version: 1 })],
  ["another word", answer(200, { ...version, api: "v2" })],
  ["another media type", answer(200, version, { ...json, "content-type": "text/plain" })],
  ["a header that is missing", answer(200, version, without(json, "etag"))],
  ["a status that is not listed", answer(203, version)],
];

test("our check finds each answer that differs from the document", () => {
  const exchange = { method: "GET", target: "/version" };
  checkExchange(exchange, answer(200, version));
  for (const [what, different] of differences) {
    assert.throws(() => checkExchange(exchange, different), assert.AssertionError, what);
  }
  assert.throws(() => checkExchange({ method: "GET", target: "/v1/nothing" }, answer(200, {})));
  assert.throws(() => checkExchange({ method: "GET", target: "/v1/runs?colour=red" }, answer(200, { runs: [], has_more: false })), /no parameter/);
  const body = JSON.stringify({ scenario: { duration_s: 1 } });
  assert.throws(() => checkExchange({ method: "POST", target: "/v1/validate", headers: json, body }, answer(200, {})));
});

// openapi-typescript and others take a property with `default` for one that is always there.
test("what a client may leave out has no default that makes generated clients demand it", () => {
  const withDefault = (value, at) =>
    value === null || typeof value !== "object"
      ? []
      : Object.entries(value).flatMap(([name, item]) => [
          ...(at.endsWith("/properties") && item.default !== undefined ? [`${at}/${name}`] : []),
          ...withDefault(item, `${at}/${name}`),
        ]);
  assert.deepEqual(withDefault(document.components.schemas, ""), []);
});

test("our check finds an event that differs", () => {
  const run = "0190a0b0-0000-7000-8000-000000000001";
  const progress = { run, t_s: 1, progress: 0.5, steps_per_s: null, eta_s: null };
  const check = (event) => checkEvent(event, `/v1/runs/${run}/events`);
  check({ id: "1", event: "progress", data: progress });
  for (const data of [{ ...progress, progress: 2 }, { ...progress, more: 1 }, { t_s: 1 }]) {
    assert.throws(() => check({ id: "1", event: "progress", data }), assert.AssertionError);
  }
  assert.throws(() => check({ id: "1", event: "surprise", data: progress }), /surprise|Surprise/);
});

test("Prism finds each of them, too", async (t) => {
  const { judge, close } = await startJudge();
  t.after(close);
  const exchange = { method: "GET", target: "/version", headers: {} };
  assert.deepEqual(await judge(exchange, answer(200, version)), []);
  for (const [what, different] of differences) assert.notDeepEqual(await judge(exchange, different), [], what);
});
