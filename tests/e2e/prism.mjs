// Prism's validation proxy as a second judge of exchanges:
//
//     judge -> Prism -> relay
//
// The relay gives the answer that the daemon gave to the story. With BELTFLOW_EXCHANGES=FOLDER each process of a story keeps
// some exchanges of every kind there, and tests/openapi/prism.test.mjs has them judged. Those that Prism does not support,
// see reasonToOmit(), are checked by contract.mjs alone, as all others are there, too.

import { mkdirSync, writeFileSync } from "node:fs";
import http from "node:http";
import { createRequire } from "node:module";
import path from "node:path";

import { document, operationOf, typeOf } from "./contract.mjs";
import { packages } from "./setup.mjs";

const PER_KIND = 2; // of an operation, a status and a media type, by a process
const LONGEST_REQUEST = 100_000; // bytes of a body; Prism does not pass on a million
const LONGEST_ANSWER = 2_000_000; // same; the document has half of them
const ANSWER_MS = 60_000; // an answer takes some 10 ms

const folder = process.env.BELTFLOW_EXCHANGES;
const kept = new Map();

process.on("exit", () => {
  if (folder === undefined || kept.size === 0) return;
  mkdirSync(folder, { recursive: true });
  writeFileSync(path.join(folder, `${process.pid}.json`), JSON.stringify([...kept.values()].flat()));
});

function isJson(body) {
  try {
    JSON.parse(body);
    return true;
  } catch {
    return false;
  }
}

// Whether Accept asks for nothing but what the operation answers.
const isTaken = (accept, { responses }) => ["", "*/*", ...Object.keys(responses["200"]?.content ?? {})].includes(accept);

// Why Prism cannot judge an exchange, or null.
function reasonToOmit({ method, target, headers, body }) {
  const header = (name) => Object.entries(headers).find(([key]) => key.toLowerCase() === name)?.[1] ?? "";
  if (method === "HEAD") return "Prism knows HEAD only where the document lists it beside GET";
  const found = operationOf(method, target);
  if (found === null) return "Prism answers itself where the document has no path or method";
  if (/zstd/.test(header("accept-encoding"))) return "Prism cannot unpack zstd";
  const type = typeOf(headers);
  if (/[?&]format=/.test(target) || !isTaken(header("accept"), found.operation))
    return "Prism knows what an operation answers, which is one media type";
  const { requestBody } = found.operation;
  if (body !== undefined && requestBody !== undefined && !(type in requestBody.content))
    return "Prism sends no body on whose type is not in the document";
  if (type === "application/json" && body !== undefined && body.length > 0 && !isJson(body))
    return "Prism refuses a body that is not JSON before it asks anybody";
  if (body !== undefined && /\[{1000}/.test(body)) return "Prism runs out of stack where arrays are nested too deep";
  if (/%(?![0-9a-f]{2})/i.test(target)) return "Prism cannot decode a broken %XX";
  return null;
}

const packed = (body) => Buffer.from(body).toString("base64");

// Keeps an exchange with its answer, if there are not enough of its kind yet.
export function noteExchange(exchange, { status, headers, body }) {
  if (folder === undefined || reasonToOmit(exchange) !== null) return;
  const { template } = operationOf(exchange.method, exchange.target);
  const kind = `${exchange.method} ${template} ${status} ${typeOf(headers)}`;
  const list = kept.get(kind) ?? [];
  if (list.length === PER_KIND || body.length > LONGEST_ANSWER || exchange.body?.length > LONGEST_REQUEST) return;
  const sent = exchange.body === undefined ? {} : { body: packed(exchange.body) };
  kept.set(kind, [...list, { kind, exchange: { ...exchange, ...sent }, answer: { status, headers, body: packed(body) } }]);
}

// What was kept, with bodies as bytes.
export function unpackExchange({ kind, exchange, answer }) {
  const body = exchange.body === undefined ? {} : { body: Buffer.from(exchange.body, "base64") };
  return { kind, exchange: { ...exchange, ...body }, answer: { ...answer, body: Buffer.from(answer.body, "base64") } };
}

const listening = (server) => new Promise((resolve) => server.listen(0, "127.0.0.1", () => resolve(server.address().port)));

async function startPrism(upstream) {
  const require = createRequire(path.join(packages, "package.json"));
  const { createServer } = require("@stoplight/prism-http-server");
  const { getHttpOperationsFromSpec } = require("@stoplight/prism-http");
  const quiet = { info() {}, warn() {}, error() {}, debug() {}, trace() {}, success() {}, fatal() {} };
  const logger = { ...quiet, child: () => logger };
  const server = createServer(await getHttpOperationsFromSpec(structuredClone(document)), { // it works on what it is given
    cors: false,
    components: { logger },
    config: {
      isProxy: true,
      upstream,
      upstreamProxy: undefined,
      checkSecurity: true,
      validateRequest: false, // bad requests must be passed on: their refusals are what is validated
      validateResponse: true,
      errors: true,
      mock: { dynamic: false, ignoreExamples: false },
    },
  });
  return { server, url: new URL(await server.listen(0, "127.0.0.1")) };
}

// { judge, close }: judge(exchange, answer) gives the violations that Prism finds in an answer. One exchange at a time.
export async function startJudge() {
  let answer = null; // of the exchange that is being judged, until the relay is asked for it
  const relay = http.createServer((request, response) => {
    request.resume();
    const { "transfer-encoding": _, connection: __, ...headers } = answer.headers;
    response.writeHead(answer.status, headers).end(answer.body);
    answer = null;
  });
  const upstream = new URL(`http://127.0.0.1:${await listening(relay)}`);
  const prism = await startPrism(upstream);
  const { hostname, port } = prism.url;
  const ask = ({ method, target, headers, body }) => new Promise((resolve, reject) => {
    const signal = AbortSignal.timeout(ANSWER_MS);
    const request = http.request({ hostname, port, method, path: target, headers, agent: false, signal }, (response) => {
      response.resume();
      response.on("error", reject);
      response.on("end", () => resolve(response.headers));
    });
    request.on("error", reject);
    request.end(body);
  });
  return {
    async judge(exchange, given) {
      answer = given;
      const headers = await ask(exchange);
      if (answer !== null) throw new Error(`Prism did not pass on ${exchange.method} ${exchange.target}`);
      return JSON.parse(headers["sl-violations"] ?? "[]").filter(({ location }) => location[0] === "response");
    },
    async close() {
      await prism.server.close();
      relay.closeAllConnections();
      await new Promise((resolve) => relay.close(resolve));
    },
  };
}
