// Every exchange of a story against api/openapi.json: the status, the media type, the headers and the
// body of each answer must be what the document says, and what was accepted must be what the
// document lets one send. Without the packages of tests/package.json nothing is checked.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { appendFileSync, existsSync, mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import zlib from "node:zlib";

import { noteSample } from "./samples.mjs";
import { packages, root } from "./setup.mjs";

export const document = JSON.parse(readFileSync(path.join(root, "api/openapi.json"), "utf8"));
const base = "openapi.json";
const isInstalled = existsSync(path.join(packages, "node_modules/ajv"));
const validator = isInstalled ? makeValidator() : null;

// Paths of the document as patterns; one without parameters counts before one with them, one with the ending of a format before
// one without.
const templates = Object.entries(document.paths)
  .map(([template, item]) => ({
    template,
    item,
    pattern: new RegExp(`^${template.replace(/[.]/g, "\\$&").replace(/\{\w+\}/g, "[^/]+")}$`),
  }))
  .sort((a, b) => a.template.split("{").length - b.template.split("{").length || b.template.length - a.template.length);

// What was validated, for the sum of all stories (tests/openapi/exchanges.mjs): a line for each pair of
// request and answer, without what differs from run to run, with how often it came.
const seen = new Map();
process.on("exit", () => {
  const folder = process.env.BELTFLOW_EXCHANGES;
  if (folder === undefined || seen.size === 0) return;
  mkdirSync(folder, { recursive: true });
  const lines = [...seen].map(([pair, n]) => `${n} ${pair}\n`).join("");
  appendFileSync(path.join(folder, `${process.pid}.txt`), lines);
});

const withoutIds = (text) => text.replace(/[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}/g, "{id}");
const digest = (text) => createHash("sha256").update(text).digest("hex").slice(0, 16);

// Headers whose values follow from the moment, the connection or the length of a time.
const varying = new Set(["connection", "content-length", "date", "etag", "keep-alive", "last-modified", "ratelimit",
  "traceparent", "x-request-id"]);

// An answer without ids and times: what stays the same when the same story runs again.
function digestOfAnswer(answer) {
  const headers = Object.entries(answer.headers)
    .map(([name, value]) => `${name}: ${varying.has(name) ? "*" : value}\n`)
    .sort()
    .join("");
  const text = plainText(answer);
  const body = (text ?? "packed")
    .replace(/\d{4}-\d\d-\d\dT[\d:.]+Z/g, "{time}")
    .replace(/"(wall_time_s|eta_s|\w+_steps_per_s)": *[-+.\de]+/g, '"$1":0')
    .replace(/"predicted_s": *(null|[-+.\de]+)/g, '"predicted_s":0')
    .replace(/127\.0\.0\.1:\d+/g, "{address}");
  return digest(withoutIds(headers + body));
}

function count({ method, target, body = "" }, template, status, type = "-", answer = "-") {
  const request = digest(`${withoutIds(target)} ${withoutIds(body.toString())}`);
  const pair = `${method} ${template} ${status} ${type} ${request} ${answer}`;
  seen.set(pair, (seen.get(pair) ?? 0) + 1);
}

function makeValidator() {
  const require = createRequire(path.join(packages, "package.json"));
  const { Ajv2020 } = require("ajv/dist/2020.js");
  // To optimise the code of a schema takes longer than what a story saves by it.
  const ajv = new Ajv2020({ strict: false, allErrors: true, code: { optimize: false } });
  require("ajv-formats")(ajv);
  ajv.addFormat("binary", true);
  ajv.addSchema(document, base);
  return ajv;
}

const escape = (key) => key.replaceAll("~", "~0").replaceAll("/", "~1");

// The value at a pointer of the document, references resolved, and its actual pointer.
function at(place) {
  let value = document;
  for (const key of place.slice(2).split("/").filter((part) => part !== "")) {
    value = value[key.replaceAll("~1", "/").replaceAll("~0", "~")];
  }
  return value?.$ref === undefined ? { value, place } : at(value.$ref);
}

function assertFits(value, place, what) {
  const validate = validator.getSchema(`${base}${encodeURI(place)}`);
  assert.ok(validate, `no schema at ${place}`);
  if (validate(value)) return;
  const faults = validate.errors.map((e) => `${e.instancePath} ${e.message} ${JSON.stringify(e.params)}`);
  assert.fail(`${what} is not ${place}: ${faults.slice(0, 8).join("; ")}\n${JSON.stringify(value).slice(0, 2000)}`);
}

// The operation of a request, or null where the document has none.
export function operationOf(method, target) {
  const pathname = target.split("?")[0];
  const found = templates.find(({ pattern }) => pattern.test(pathname));
  if (found === undefined) return null;
  const name = method.toLowerCase();
  const operation = found.item[name === "head" ? "get" : name];
  if (operation === undefined) return null;
  const place = `#/paths/${escape(found.template)}/${name === "head" ? "get" : name}`;
  return { operation, place, template: found.template };
}

const mediaTypes = (found) => Object.keys(found?.operation.responses["200"]?.content ?? {});
const bodyTypes = (found) => Object.keys(found?.operation.requestBody?.content ?? {});

// The same request at the path of the format of its body: by Content-Type the path without an ending takes others, too.
function ofBody(exchange) {
  const { method, target, headers } = exchange;
  const [pathname, ...query] = target.split(/(?=\?)/);
  const type = typeOf(headers);
  if (type === "" || bodyTypes(operationOf(method, target)).includes(type)) return exchange;
  const isTaken = bodyTypes(operationOf(method, `${pathname}.csv`)).includes(type);
  return isTaken ? { ...exchange, target: `${pathname}.csv${query.join("")}` } : exchange;
}

// The same request at the path of the format in which it was answered: by `format` and by Accept the path without an ending
// answers in others, too.
function inFormat(exchange, type) {
  const { method, target } = exchange;
  const found = operationOf(method, target);
  const [pathname, query = ""] = target.split("?");
  const rest = query.split("&").filter((pair) => !/^(format=|$)/.test(pair)).join("&");
  const isAsked = rest !== query;
  if (found === null || type === "" || (mediaTypes(found).includes(type) && !isAsked)) return exchange;
  const siblings = templates.filter(({ template }) => template === found.template || template.replace(/\.\w+$/, "") === found.template);
  const other = siblings.map(({ template }) => template.slice(found.template.length))
    .find((ending) => mediaTypes(operationOf(method, pathname + ending)).includes(type));
  return other === undefined ? exchange : { ...exchange, target: `${pathname}${other}${rest === "" ? "" : `?${rest}`}` };
}

// A value of a header or a query is text; the document may require a number.
function fromText(text, place) {
  const { value: schema } = at(place);
  const isNumber = ["integer", "number"].includes(schema.type);
  return isNumber && text !== "" && Number.isFinite(Number(text)) ? Number(text) : text;
}

function checkHeaders(headers, responsePlace, what) {
  const { value: response } = at(responsePlace);
  for (const name of Object.keys(response.headers ?? {})) {
    const { value: header, place } = at(`${responsePlace}/headers/${escape(name)}`);
    const text = headers[name.toLowerCase()];
    if (text === undefined) assert.ok(!header.required, `${what} lacks ${name}`);
    else assertFits(fromText(text, `${place}/schema`), `${place}/schema`, `${name} of ${what}`);
  }
  assert.equal(headers["x-content-type-options"], "nosniff", what);
}

// The text of a body as it was before it was packed; null where this Node.js cannot unpack it.
function plainText({ headers, body }) {
  const coding = headers["content-encoding"];
  if (coding === undefined) return body.toString("utf8");
  const unpack = { gzip: zlib.gunzipSync, zstd: zlib.zstdDecompressSync }[coding];
  return unpack === undefined ? null : unpack(body).toString("utf8");
}

// The body of an answer whose media type the document names. What is no JSON is text or bytes.
function checkBody(answer, responsePlace, what) {
  const { value: response } = at(responsePlace);
  const type = answer.headers["content-type"]?.split(";")[0];
  if (response.content === undefined) {
    assert.equal(answer.body.length, 0, `${what} has a body`);
    return type;
  }
  assert.ok(type in response.content, `${what} is ${type}, not ${Object.keys(response.content)}`);
  if (type.endsWith("json") && !type.endsWith("ndjson")) {
    const text = plainText(answer);
    if (text !== null) assertFits(JSON.parse(text), `${responsePlace}/content/${escape(type)}/schema`, what);
  }
  return type;
}

function checkProblem(answer, what) {
  assert.equal(answer.headers["content-type"], "application/problem+json", what);
  const text = plainText(answer);
  if (text === null) return;
  const problem = JSON.parse(text);
  assertFits(problem, "#/components/schemas/Problem", what);
  assert.equal(problem.status, answer.status, what);
}

// Where the document has no such path or method: a refusal, or a file of the page.
function checkUnknown(method, target, answer, what) {
  if (answer.status < 400) assert.doesNotMatch(target, /^\/v1\//, what);
  else if (method !== "HEAD") checkProblem(answer, what);
}

function checkOptions(answer, what) {
  assert.equal(answer.status, 204, what);
  assert.match(answer.headers.allow, /OPTIONS/, what);
}

// The media type of a body, by headers as a story gives them.
export function typeOf(headers = {}) {
  const [, type = ""] = Object.entries(headers).find(([name]) => name.toLowerCase() === "content-type") ?? [];
  return type.split(";")[0].trim().toLowerCase();
}

// A parameter of the query by which the sender may be identified.
function isCredential(operation, name) {
  const schemes = (operation.security ?? []).flatMap((requirement) => Object.keys(requirement));
  return schemes.map((scheme) => document.components.securitySchemes[scheme])
    .some((scheme) => scheme.in === "query" && scheme.name === name);
}

// What was accepted is what the document lets one send.
function checkRequest({ operation, place }, { target, headers, body }, what) {
  const query = new URLSearchParams(target.split("?")[1] ?? "");
  const known = (operation.parameters ?? []).filter((parameter) => parameter.in === "query");
  for (const [name, text] of query) {
    if (isCredential(operation, name)) continue;
    const index = operation.parameters?.findIndex((p) => p.in === "query" && p.name === name) ?? -1;
    assert.ok(index >= 0, `${what}: the document has no parameter ${name}`);
    const schema = `${place}/parameters/${index}/schema`;
    const isList = operation.parameters[index].explode === false;
    assertFits(isList ? text.split(",") : fromText(text, schema), schema, `${name} of ${what}`);
  }
  for (const { name, required } of known) {
    assert.ok(!required || query.has(name), `${what}: accepted without ${name}`);
  }
  if (body === undefined || operation.requestBody === undefined) return; // not examined
  const type = typeOf(headers);
  assert.ok(type in operation.requestBody.content, `${what}: accepted a body of ${type}`);
  if (type !== "application/json") return;
  assertFits(JSON.parse(body), `${place}/requestBody/content/${escape(type)}/schema`, `the body of ${what}`);
}

function note(operation, { target, headers, body }, answer, type) {
  const text = plainText(answer);
  if (text !== null) noteSample(operation, target, String(answer.status), type, text);
  if (operation.requestBody !== undefined && body !== undefined)
    noteSample(operation, target, "request", typeOf(headers), body.toString());
}

// An exchange; answer as Daemon.request() gives it.
export function checkExchange(exchange, answer) {
  if (validator === null) return;
  const { method } = exchange;
  const what = `${method} ${exchange.target.slice(0, 200)} (${answer.status})`;
  const asked = inFormat(ofBody(exchange), typeOf(answer.headers));
  const found = operationOf(method, asked.target);
  if (method === "OPTIONS" && answer.status < 400) return checkOptions(answer, what);
  if (found === null) return checkUnknown(method, asked.target, answer, what);
  const { operation, place, template } = found;
  assert.ok(String(answer.status) in operation.responses, `${what}: the document has no such status`);
  const { place: responsePlace } = at(`${place}/responses/${answer.status}`);
  checkHeaders(answer.headers, responsePlace, what);
  if (method === "HEAD") return count(exchange, template, answer.status);
  if (answer.status >= 400) checkProblem(answer, what);
  const type = checkBody(answer, responsePlace, what);
  if (answer.status < 300) {
    checkRequest(found, asked, what);
    note(operation, asked, answer, type);
  }
  count(exchange, template, answer.status, type, digestOfAnswer(answer));
}

const schemaOfEvent = (kind) =>
  `#/components/schemas/${kind.split("_").map((word) => word[0].toUpperCase() + word.slice(1)).join("")}Event`;

// One event of a stream of server-sent events. Of a study, data are the study or a trial, and `status` has no id.
export function checkEvent(event, target) {
  if (validator === null || event.event === undefined) return;
  const isOfStudy = target.startsWith("/v1/studies/");
  const ofStudy = `#/components/schemas/${event.event === "trial" ? "Trial" : "Study"}`;
  if (isOfStudy && event.event === "status") assert.equal(event.id, undefined);
  else assert.match(event.id, /^\d+$/);
  assertFits(event.data, isOfStudy ? ofStudy : schemaOfEvent(event.event), `event ${event.event}`);
}

// The first events of a stream, as they came.
export function noteStream(given, headers, text) {
  const { target } = inFormat({ method: "GET", target: given }, typeOf(headers));
  const { operation } = operationOf("GET", target);
  const end = text.lastIndexOf("\n\n");
  noteSample(operation, target, "200", typeOf(headers), end < 0 ? text : text.slice(0, end + 2));
}

// The head of a stream, whose body is checked event by event.
export function checkStream(target, status, headers) {
  if (validator === null) return;
  const asked = inFormat({ method: "GET", target }, typeOf(headers));
  const { operation, place, template } = operationOf("GET", asked.target);
  const what = `GET ${target} (${status})`;
  assert.ok(String(status) in operation.responses, `${what}: the document has no such status`);
  const { value: response, place: responsePlace } = at(`${place}/responses/${status}`);
  checkHeaders(headers, responsePlace, what);
  const type = headers["content-type"]?.split(";")[0];
  assert.ok(type === undefined ? response.content === undefined : type in response.content, what);
  count({ method: "GET", target }, template, status, type);
}
