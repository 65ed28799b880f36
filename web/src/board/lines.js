// Lines that are being edited are kept in the browser as they are, so that a reload or a closed tab loses nothing.

import { cut } from "../base/format.js";

const KEY = "beltflow-lines";
const MOST = 20; // the oldest are forgotten

// [{ id, saved_at, scenario, model, label, ofLine }], the last one first; ofLine: what the server knows the line as.
export function savedLines() {
  try {
    const lines = JSON.parse(localStorage.getItem(KEY));
    return Array.isArray(lines) ? lines.filter((line) => line?.id && line.scenario) : [];
  } catch {
    return []; // the browser stores nothing
  }
}

function write(lines) {
  try {
    localStorage.setItem(KEY, JSON.stringify(lines));
  } catch {
    if (lines.length > 1) write(lines.slice(0, -1)); // there is no room for all
  }
}

export function saveLine(line) {
  const others = savedLines().filter(({ id }) => id !== line.id);
  write([{ ...line, saved_at: new Date().toISOString() }, ...others].slice(0, MOST));
}

const LINE_BYTES = 100; // the server's limit of a line's name

// What a line is called by the name of its scenario.
export const lineOf = (name = "") => cut(name.trim(), LINE_BYTES);

export const newLineId = () => `${Date.now().toString(36)}${Math.floor(Math.random() * 1e6).toString(36)}`;

// Where one's own line begins: a belt, cans and a feed of them.
export const blankLine = {
  name: "My line", duration_s: 60, warmup_s: 15, domain: { x_m: [0, 2], y_m: [0, 0.6] },
  belts: [{ id: "belt-1", velocity_m_s: [0.4, 0] }],
  cargo: { goods: "can-330" },
  feeds: [{ id: "feed-1", edge: "west", rate_per_s: 5, arrivals: "poisson" }],
};
