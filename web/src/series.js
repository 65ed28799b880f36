// Curves: samples in rising times.

// Index of the last item whose key is not after t, or -1.
export function indexBefore(items, t, key = (item) => item) {
  let low = -1;
  let high = items.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (key(items[middle]) <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

// The value of a curve at t, on straight lines between its samples; null before its first sample.
export function valueAt(times, values, t) {
  const k = indexBefore(times, t);
  if (k < 0) return null;
  if (k === times.length - 1) return values[k];
  const share = (t - times[k]) / (times[k + 1] - times[k]);
  return values[k] + share * (values[k + 1] - values[k]);
}

const balance = ["offered", "admitted", "waiting", "discarded"]; // columns of each feed

export function isFed({ feeds = [] }) {
  return feeds.length > 0;
}

// [name, words] of the columns of a run's curve that count parts.
export function columnsOf(scenario) {
  const { counters, feeds = [] } = scenario;
  return [...counters.map(({ id }) => [id, id]), ["left_domain", isFed(scenario) ? "exits" : "left the belt"],
    ...feeds.flatMap(({ id }) => balance.map((what) => [`${id}.${what}`, `${id}: ${what}`]))];
}

// [words, values] of what flows through: the sums of the feeds, and the exits.
export function flowOf(scenario, { columns }) {
  const { feeds = [] } = scenario;
  const sums = balance.map((what) => [what, sumOf(feeds.map(({ id }) => columns.get(`${id}.${what}`) ?? []))]);
  const seen = sums.filter(([what, values]) => what !== "discarded" || values.some((value) => value > 0));
  return [...seen, ["exits", columns.get("left_domain") ?? []]];
}

function sumOf([first = [], ...others]) {
  return others.reduce((sum, values) => sum.map((value, k) => value + values[k]), first);
}

// [words, values] of what is in the counters, and what waits at the feeds.
export function contentOf({ counters, feeds = [] }, { columns }) {
  return [...counters.map(({ id }) => [id, columns.get(id) ?? []]),
    ...feeds.map(({ id }) => [`${id}: waiting`, columns.get(`${id}.waiting`) ?? []])];
}

// Samples of a measured curve from CSV with the header t_s,<name>. Throws with the line at fault.
export function readMeasured(text) {
  const lines = text.replace(/^﻿/, "").split(/\r?\n/);
  const names = lines[0].split(",").map((name) => name.trim());
  if (names[0] !== "t_s" || names.length < 2) {
    throw new Error("Line 1: the header must be t_s,count (times in seconds, then counts of parts).");
  }
  const curve = { name: names[1], t: [], v: [] };
  lines.forEach((line, k) => {
    if (k === 0 || line.trim() === "") return;
    const [t, v] = line.split(",").map((cell) => (cell.trim() === "" ? NaN : Number(cell)));
    if (!Number.isFinite(t) || !Number.isFinite(v)) throw new Error(`Line ${k + 1}: “${line.trim()}” is not two numbers.`);
    if (curve.t.length > 0 && t <= curve.t.at(-1)) throw new Error(`Line ${k + 1}: times must rise.`);
    curve.t.push(t);
    curve.v.push(v);
  });
  if (curve.t.length === 0) throw new Error("There is no sample below the header.");
  return curve;
}

// Mean and root mean square gap, largest gap and its time, over the time that both have, as the API's
// comparison defines them. null: they have no time in common.
export function measureGap(a, b) {
  const from = Math.max(a.t[0], b.t[0]);
  const to = Math.min(a.t.at(-1), b.t.at(-1));
  if (from > to) return null;
  const times = [...new Set([from, ...a.t, ...b.t, to])].filter((t) => t >= from && t <= to).sort((x, y) => x - y);
  const gaps = times.map((t) => valueAt(a.t, a.v, t) - valueAt(b.t, b.v, t));
  let area = 0;
  let square = 0;
  for (let k = 1; k < times.length; k++) {
    const [low, high, width] = [Math.abs(gaps[k - 1]), Math.abs(gaps[k]), times[k] - times[k - 1]];
    const crosses = gaps[k - 1] * gaps[k] < 0;
    area += 0.5 * width * (crosses ? (low * low + high * high) / (low + high) : low + high);
    square += (width * (low * low + gaps[k - 1] * gaps[k] + high * high)) / 3;
  }
  const sizes = gaps.map(Math.abs);
  const largest = sizes.reduce((most, size) => Math.max(most, size), 0);
  const width = to - from;
  return {
    l1: width > 0 ? area / width : sizes[0],
    l2: width > 0 ? Math.sqrt(square / width) : sizes[0],
    largest,
    largest_at_s: times[sizes.indexOf(largest)],
    rate_per_s: width > 0 ? (valueAt(b.t, b.v, from) - valueAt(b.t, b.v, to)) / width : 0,
    drain_time_s: b.t[b.v.findIndex((v) => v <= 0.01 * b.v[0])] ?? null,
  };
}
