// The daemon describes itself, and does what it says: every operation, format and method of the
// document is requested. Each answer is also checked against the document (contract.mjs).

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { document } from "./contract.mjs";
import { daemon } from "./daemon.mjs";
import { smallJam } from "./micro.mjs";
import { beltflow } from "./processes.mjs";
import { isSanitized, root, until, within } from "./setup.mjs";

const kept = readFileSync(path.join(root, "api/openapi.json"), "utf8");

test("the document is the one in the tree, over HTTP and on the command line", async (t) => {
  const d = await daemon(t);
  const answer = await d.get("/openapi.json");
  assert.deepEqual([answer.status, answer.text], [200, kept]);
  const again = await d.get("/openapi.json", { "if-none-match": answer.headers.etag });
  assert.deepEqual([again.status, again.body.length], [304, 0]);
  assert.equal((await beltflow(["openapi"])).stdout, kept);
});

test("every example of the document is accepted as it is", async (t) => {
  const d = await daemon(t);
  for (const [name, { value }] of Object.entries(document.components.examples)) {
    const body = value.scenario === undefined ? { scenario: value } : value;
    const answer = await d.post("/v1/validate", body);
    assert.equal(answer.status, 200, `${name}: ${answer.text}`);
  }
});

// Two runs that have ended, and what stands for parameters in paths and queries; a path counts more
// than a name.
async function makeValues(d) {
  const runs = [await d.submit(smallJam()), await d.submit(smallJam(), { model: "micro" })];
  for (const { id } of runs) await d.reached(id, "succeeded");
  const [a, b] = runs.map(({ id }) => id);
  const measured = await d.post("/v1/measurements", { t_s: [0, 1], count: [20, 0] });
  const { json: study } = await d.post("/v1/studies", {
    base: { scenario: smallJam() },
    parameters: [{ pointer: "/duration_s", values: [0.1] }],
    objectives: [{ figure: "peak_density" }],
    method: { type: "list" },
  });
  await until(async () => (await d.get(study.links.self)).json.status === "succeeded", "the end of the study");
  return {
    study: study.id,
    id: b, n: "0", name: "example-1", kind: "not-found", runs: `${a},${b}`,
    "/v1/measurements/{id}": measured.headers.location,
    "/v1/measurements/{id}.csv": `${measured.headers.location}.csv`,
    "/v1/compare": `/v1/compare?a=${a}&b=${b}`,
  };
}

// [template, operation, target] of every GET, required parameters filled in; leases are there where a service leaves
// solving to workers (pull.test.mjs).
function gets(values) {
  return Object.entries(document.paths).flatMap(([template, { get }]) => {
    if (get === undefined || get.tags.includes("Workers")) return [];
    if (template in values) return [[template, get, values[template]]];
    const required = (get.parameters ?? []).filter((p) => p.in === "query" && p.required);
    const query = required.map(({ name }) => `${name}=${values[name]}`).join("&");
    const isOfStudy = template.startsWith("/v1/studies/");
    const pathname = template.replace(/\{(\w+)\}/g, (_, name) => values[isOfStudy && name === "id" ? "study" : name]);
    return [[template, get, query === "" ? pathname : `${pathname}?${query}`]];
  });
}

test("every operation answers in its media type, by HEAD, and not again while nothing has changed", async (t) => {
  const d = await daemon(t);
  const values = await makeValues(d);
  for (const [template, operation, target] of gets(values)) {
    const [type, ...others] = Object.keys(operation.responses["200"].content);
    assert.deepEqual(others, [], `${template} answers in one media type`);
    const answer = await d.get(target);
    assert.equal(answer.status, 200, `${target}: ${answer.text.slice(0, 300)}`);
    assert.ok(answer.headers["content-type"].startsWith(type), `${target}: ${type}`);
    const head = await d.request("HEAD", target);
    assert.deepEqual([head.status, head.body.length], [200, 0], target);
    assert.equal(head.headers["content-type"], answer.headers["content-type"], target);
    if (operation.responses["304"] === undefined) continue;
    const again = await d.get(target, { "if-none-match": answer.headers.etag });
    assert.equal(again.status, 304, template);
  }
});

test("OPTIONS tells the methods of the document, and every other one is refused", async (t) => {
  const d = await daemon(t);
  const values = { id: "0190a0b0-0000-7000-8000-000000000001", n: "0", number: "0", name: "example-1" };
  for (const [template, item] of Object.entries(document.paths)) {
    const target = template.replace(/\{(\w+)\}/g, (_, name) => values[name]);
    const known = ["get", "post", "put", "patch", "delete"].filter((method) => method in item);
    const methods = known.map((method) => method.toUpperCase());
    if (known.includes("get")) methods.push("HEAD");
    const options = await d.request("OPTIONS", target);
    assert.deepEqual(options.headers.allow.split(", ").sort(), [...methods, "OPTIONS"].sort(), target);
    for (const method of ["GET", "POST", "PUT", "DELETE", "PATCH"]) {
      if (methods.includes(method)) continue;
      assert.equal((await d.request(method, target)).status, 405, `${method} ${target}`);
    }
  }
});

test("a parameter that the document does not have is refused by every operation", async (t) => {
  const d = await daemon(t);
  const values = await makeValues(d);
  for (const [, , target] of gets(values)) {
    const answer = await d.get(`${target}${target.includes("?") ? "&" : "?"}colour=red`);
    assert.equal(answer.status, 400, target);
    assert.match(answer.json.detail, /colour/);
  }
});

test("the reference page leads to the document and may load nothing from elsewhere", async (t) => {
  const d = await daemon(t);
  const page = await d.get("/docs");
  assert.equal(page.status, 200);
  assert.match(page.headers["content-type"], /^text\/html/);
  assert.match(page.text, /href="\/openapi\.json"/);
  assert.doesNotMatch(page.headers["content-security-policy"], /unsafe|https?:|\*/);
  assert.doesNotMatch(page.text, /<script(?![^>]*\bsrc=)|<style|\sstyle=|\son\w+=/);
  for (const [, target] of page.text.matchAll(/(?:src|href)="([^"]+)"/g)) {
    const part = await d.get(target);
    assert.equal(part.status, 200, target);
  }
});

// A table of drain times over the deflector's angle, made with the document alone.
test("the example in Python draws its table", { skip: isSanitized }, async (t) => {
  const d = await daemon(t, { workers: 2 });
  const script = path.join(root, "deploy/examples/drain_times.py");
  const done = new Promise((resolve) => {
    const child = spawn("python3", [script, d.url.replace(/\/$/, ""), "60"]);
    let output = "";
    for (const stream of [child.stdout, child.stderr]) stream.on("data", (chunk) => (output += chunk));
    child.on("close", (status) => resolve({ status, output }));
  });
  const { status, output } = await within(done, "the table");
  assert.equal(status, 0, output);
  const [head, row] = output.trim().split("\n").map((line) => line.split(/\s{2,}/).map((word) => word.trim()));
  assert.deepEqual(head, ["angle [deg]", "macro [s]", "micro [s]"]);
  const [angle, macro, micro] = row.filter((word) => word !== "").map(Number);
  assert.equal(angle, 60);
  // The paper's belt is free after some seven seconds, in both models.
  for (const time of [macro, micro]) assert.ok(time > 6.5 && time < 7.5, output);
});
