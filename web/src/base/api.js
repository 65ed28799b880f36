// Requests to the daemon. Addresses are relative to the page's, so a proxy may put both below a path.

import { authorized, currentToken, signIn } from "./access.js";
import { report } from "./connection.js";
import { readable } from "./format.js";

// What a problem document (RFC 9457) says; status 0: no answer came.
export class Problem extends Error {
  constructor(status, detail, errors = []) {
    super(detail);
    this.status = status;
    this.errors = errors;
  }
}

export const LATER_MS = 2000; // after which a busy server is asked again

export function isBusy({ status }) {
  return [429, 503].includes(status);
}

// "/v1/runs/..." of the API's links, as an address of this page.
export function local(target) {
  return target.replace(/^\//, "");
}

// A sentence about a number ends with the number that was sent.
function faultOf({ detail, unit, ...fault }) {
  return { ...fault, detail: unit === undefined ? detail : `${detail} ${unit}` };
}

async function problemOf(response) {
  try {
    const value = await response.json();
    return new Problem(response.status, readable(value.detail ?? response.statusText), (value.errors ?? []).map(faultOf));
  } catch (error) {
    if (error.name === "AbortError") throw error;
    return new Problem(response.status, `${response.status} ${response.statusText}`);
  }
}

// The response, or a Problem. An aborted request stays an AbortError. Where a token is wanted, it is asked for, and the
// request sent again.
export async function ask(target, options = {}) {
  const token = currentToken();
  let response;
  try {
    response = await fetch(local(target), authorized(options));
  } catch (error) {
    if (error.name === "AbortError") throw error;
    report(false);
    throw new Problem(0, "The server does not answer.");
  }
  report(response.status !== 502 && response.status !== 504);
  if (response.ok) return response;
  const problem = await problemOf(response);
  const isForToken = response.status === 401 && /^Bearer\b/i.test(response.headers.get("www-authenticate") ?? "");
  if (!isForToken) throw problem;
  await signIn(token, problem.message);
  return ask(target, options);
}

// An address for what the browser fetches by itself, without our headers: with a ticket that counts for a minute, where
// somebody is signed in.
export async function ticketed(target) {
  if (currentToken() === null) return target;
  const { ticket } = await (await ask("v1/tickets", { method: "POST" })).json();
  return `${target}${target.includes("?") ? "&" : "?"}ticket=${ticket}`;
}

export async function getJson(target, options) {
  return (await ask(target, options)).json();
}

export async function getBytes(target, options) {
  return (await ask(target, options)).arrayBuffer();
}

// body: a value, or JSON text that goes out as it is.
export async function post(target, body, options = {}) {
  const text = typeof body === "string" ? body : JSON.stringify(body);
  const headers = { "content-type": "application/json" };
  return (await ask(target, { method: "POST", headers, body: text, ...options })).json();
}

// Changes some members of a resource, and returns it.
export async function patch(target, changes) {
  return (await ask(target, { method: "PATCH", headers: { "content-type": "application/json" }, body: JSON.stringify(changes) })).json();
}

export const paths = {
  run: (id) => `v1/runs/${id}`,
  of: (id, what) => `v1/runs/${id}/${what}`,
};

// One page of a list: { runs, total, cursor }, { studies, cursor } or { lines, cursor }, with the cursor of the next one, or null. What is "" is not
// asked for.
async function listOf(path, query, options) {
  const said = Object.entries(query).filter(([, value]) => value !== "");
  const response = await ask(`${path}?${new URLSearchParams(said)}`, options);
  const next = /<([^>]*)>;\s*rel="next"/.exec(response.headers.get("link") ?? "");
  const cursor = next ? new URL(next[1], location.href).searchParams.get("cursor") : null;
  return { ...(await response.json()), cursor };
}

export const listRuns = (query, options) => listOf("v1/runs", query, options);
export const listStudies = (query, options) => listOf("v1/studies", query, options);
export const listLines = (query, options) => listOf("v1/lines", query, options);

export function cancelRun(id) {
  return ask(paths.of(id, "cancel"), { method: "POST" });
}

// keepalive: the request outlives the page.
export function removeRun(id) {
  return ask(paths.run(id), { method: "DELETE", keepalive: true });
}

// The states of a run, in the order of its life; the last three are ends.
export const states = ["queued", "running", "succeeded", "failed", "cancelled"];
export const ended = new Set(states.slice(-3));

export function isOver(run) {
  return ended.has(run.status);
}
