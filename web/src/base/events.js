// The page's one event stream. A view says which runs it follows; the stream is opened again when that
// changes, and by itself when the connection is lost, after the last event that was seen.

import { ended, states, ticketed } from "./api.js";
import { onConnection, report, isDaemonAway } from "./connection.js";

const KINDS = ["status", "progress", "curve", "snapshot", "figures", "action", "drive", "end"];
const RETRY_MS = 2000;
const RUNS_MAX = 32; // that one stream follows

let source = null;
let following = null; // { ids, onEvent, open, last }
let timer = 0;
let attempts = 0; // to connect; each one and each end makes those before it void

function close() {
  clearTimeout(timer);
  attempts++;
  source?.close();
  source = null;
}

function take(kind, message) {
  const { onEvent, open } = following;
  const event = JSON.parse(message.data);
  following.last = message.lastEventId || following.last;
  report(true);
  if (kind === "end") open.delete(event.run);
  onEvent(kind, event);
  if (open.size === 0) close();
}

// The address of the stream; null: it cannot be had, or another attempt has begun.
async function addressOf(query) {
  const mine = attempts;
  try {
    const target = await ticketed(`v1/events?${query}`);
    return mine === attempts ? target : null;
  } catch {
    if (mine === attempts) timer = setTimeout(connect, RETRY_MS);
    return null;
  }
}

async function connect() {
  close();
  if (following === null || following.open.size === 0) return;
  const query = new URLSearchParams({ runs: following.ids.join(",") });
  if (following.last) query.set("last_event_id", following.last);
  const target = await addressOf(query);
  if (target === null) return;
  source = new EventSource(target);
  for (const kind of KINDS) source.addEventListener(kind, (message) => take(kind, message));
  source.addEventListener("open", () => report(true));
  source.addEventListener("error", lose);
}

// The browser tries again only after some failures; here it is tried after each.
function lose() {
  const isDead = source?.readyState === EventSource.CLOSED;
  close();
  if (!isDead) report(false);
  timer = setTimeout(connect, RETRY_MS);
}

onConnection((isAway) => {
  if (!isAway && following !== null && source === null) connect();
});

// Follow these runs from their first event on; onEvent(kind, event), event.run names the run. Takes the
// place of whatever was followed before. Returns how to stop.
export function follow(ids, onEvent) {
  const mine = { ids: ids.slice(0, RUNS_MAX), onEvent, open: new Set(ids.slice(0, RUNS_MAX)), last: "" };
  following = mine;
  if (isDaemonAway()) close();
  else connect();
  return () => {
    if (following !== mine) return;
    following = null;
    close();
  };
}

// Takes what an event says into the run's document. A stream begins with the past: what the document
// already went beyond changes nothing.
export function applyToRun(run, kind, event) {
  const isPast = (status) => states.indexOf(status) < states.indexOf(run.status);
  if (kind === "status" && !isPast(event.status) && !(event.progress < run.progress)) Object.assign(run, event);
  if (kind === "progress" && !ended.has(run.status) && event.progress >= run.progress) {
    Object.assign(run, { status: "running", progress: event.progress, eta_s: event.eta_s });
  }
  if (kind === "figures" && !ended.has(run.status)) run.key_figures = event.key_figures;
  if (kind === "end") {
    Object.assign(run, { status: event.status, progress: event.progress, eta_s: null,
      finished_at: event.finished_at, error: event.error });
  }
}
