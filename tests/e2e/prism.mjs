// Prism's validation proxy between a story and its daemon, by BELTFLOW_PROXY=prism:
//
//     story -> Prism -> relay -> daemon
//
// Prism parses bodies and reserialises them, which changes bytes and damages binary data. So the
// relay sends the daemon what the story really sent, and the story gets what the daemon really
// answered; Prism sees both and validates the answer. What Prism does not support goes directly to the daemon,
// see reasonToBypass(); it is still checked by contract.mjs.

import assert from "node:assert/strict";
import http from "node:http";
import { createRequire } from "node:module";
import path from "node:path";

import { document, operationOf, typeOf } from "./contract.mjs";
import { packages } from "./setup.mjs";

export const isWanted = process.env.BELTFLOW_PROXY === "prism";
const marker = "x-relay";

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

// Why an exchange cannot go through Prism, or null.
export function reasonToBypass({ method, target, headers, body }) {
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
  if (type === "application/json" && body !== undefined && !isJson(body))
    return "Prism refuses a body that is not JSON before it asks anybody";
  if (body !== undefined && /\[{1000}/.test(body)) return "Prism runs out of stack where arrays are nested too deep";
  if (/%(?![0-9a-f]{2})/i.test(target)) return "Prism cannot decode a broken %XX";
  return null;
}

// Listens on a free port and answers as the daemon of the exchange that a request is marked with.
function startRelay(exchanges) {
  const server = http.createServer(async (request, response) => {
    const exchange = exchanges.get(request.headers[marker]);
    request.resume();
    try {
      exchange.answer = await exchange.send();
      const { status, headers, body } = exchange.answer;
      const { "transfer-encoding": _, connection: __, ...others } = headers;
      response.writeHead(status, others).end(body);
    } catch (error) {
      exchange.error = error;
      response.destroy();
    }
  });
  return new Promise((resolve) => server.listen(0, "127.0.0.1", () => resolve(server)));
}

const require = createRequire(path.join(packages, "package.json"));
let operations = null; // of the document, read once for all daemons of a story

async function startPrism(upstream) {
  const { createServer } = require("@stoplight/prism-http-server");
  const { getHttpOperationsFromSpec } = require("@stoplight/prism-http");
  const quiet = { info() {}, warn() {}, error() {}, debug() {}, trace() {}, success() {}, fatal() {} };
  const logger = { ...quiet, child: () => logger };
  operations ??= getHttpOperationsFromSpec(structuredClone(document)); // it works on what it is given
  const server = createServer(await operations, {
    cors: false,
    components: { logger },
    config: {
      isProxy: true,
      upstream: new URL(upstream),
      upstreamProxy: undefined,
      checkSecurity: true,
      validateRequest: false, // bad requests must reach the daemon: its refusals are what is validated
      validateResponse: true,
      errors: true,
      mock: { dynamic: false, ignoreExamples: false },
    },
  });
  return { server, url: await server.listen(0, "127.0.0.1") };
}

class Proxy {
  constructor(relay, prism, exchanges) {
    this.relay = relay;
    this.prism = prism;
    this.exchanges = exchanges;
  }

  ask({ method, target, headers, body }, mark) {
    return new Promise((resolve, reject) => {
      const { hostname, port } = new URL(this.prism.url);
      const marked = { ...headers, [marker]: mark };
      const request = http.request({ hostname, port, method, path: target, headers: marked, agent: false }, (response) => {
        const chunks = [];
        response.on("data", (chunk) => chunks.push(chunk));
        response.on("error", reject);
        response.on("end", () => resolve({ headers: response.headers, text: Buffer.concat(chunks).toString() }));
      });
      request.on("error", reject);
      request.end(body);
    });
  }

  // The daemon's answer to an exchange, send() being how it is asked; a violation is a failure.
  async pass(exchange, send) {
    const mark = String(this.exchanges.size + 1);
    const kept = { send, answer: null, error: null };
    this.exchanges.set(mark, kept);
    const judged = await this.ask(exchange, mark);
    if (kept.error !== null) throw kept.error;
    const what = `${exchange.method} ${exchange.target}`;
    assert.ok(kept.answer !== null, `Prism did not pass on ${what}: ${judged.text.slice(0, 1000)}`);
    const violations = JSON.parse(judged.headers["sl-violations"] ?? "[]").filter(
      ({ location }) => location[0] === "response",
    );
    assert.deepEqual(violations, [], `Prism on the answer to ${what}: ${kept.answer.text.slice(0, 1000)}`);
    return kept.answer;
  }

  async close() {
    await this.prism.server.close();
    await new Promise((resolve) => {
      this.relay.close(resolve);
      this.relay.closeAllConnections();
    });
  }
}

export async function startProxy() {
  const exchanges = new Map();
  const relay = await startRelay(exchanges);
  const prism = await startPrism(`http://127.0.0.1:${relay.address().port}`);
  return new Proxy(relay, prism, exchanges);
}
