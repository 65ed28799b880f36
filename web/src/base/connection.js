// Whether the daemon is reachable. All requests report their outcome here; while it is unreachable one request is
// repeated, and listeners are called when it answers again.

const PERIOD_MS = 1500;

const listeners = new Set();
let isAway = false;
let timer = 0;

function tell() {
  for (const listener of [...listeners]) listener(isAway);
}

async function askAgain() {
  try {
    const response = await fetch("livez", { cache: "no-store" });
    if (response.ok) {
      report(true);
      return;
    }
  } catch {
    // Still unreachable.
  }
  timer = setTimeout(askAgain, PERIOD_MS);
}

// An answer came (true) or none (false).
export function report(isThere) {
  if (isThere === !isAway) return;
  isAway = !isThere;
  clearTimeout(timer);
  if (isAway) timer = setTimeout(askAgain, PERIOD_MS);
  tell();
}

export function isDaemonAway() {
  return isAway;
}

// listener(isAway) at each change; returns how to stop.
export function onConnection(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}
