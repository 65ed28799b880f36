// Curves: samples in rising times.

import { indexBefore } from "../base/search.js";

// The value of a curve at t, on straight lines between its samples; null before its first sample.
export function valueAt(times, values, t) {
  const k = indexBefore(times, t);
  if (k < 0) return null;
  if (k === times.length - 1) return values[k];
  const share = (t - times[k]) / (times[k + 1] - times[k]);
  return values[k] + share * (values[k + 1] - values[k]);
}

const FALLEN_TOLD = 0.1; // parts: a density spreads without end

const balance = ["offered", "admitted", "waiting", "discarded"]; // columns of each feed

export function isFed({ feeds = [] }) {
  return feeds.length > 0;
}

// What the parts in a counter are called.
function wordsOf({ id }) {
  return id === "upstream" ? "parts upstream" : id;
}

// [name, words] of the columns of a run's curve that count parts.
export function columnsOf(scenario) {
  const { counters, feeds = [], sinks = [] } = scenario;
  return [...counters.map((counter) => [counter.id, wordsOf(counter)]), ["left_domain", "left the belt"],
    ...feeds.flatMap(({ id }) => balance.map((what) => [`${id}.${what}`, `${id}: ${what}`])), ...sinks.map(({ id }) => [`${id}.taken`, `${id}: taken`])];
}

// [words, values] of what flows through: the sums of the feeds, and what left the belt.
export function flowOf(scenario, { columns }) {
  const { feeds = [] } = scenario;
  const sums = balance.map((what) => [what, sumOf(feeds.map(({ id }) => columns.get(`${id}.${what}`) ?? []))]);
  const seen = sums.filter(([what, values]) => what !== "discarded" || values.some((value) => value > 0));
  return [...seen, ["left the belt", columns.get("left_domain") ?? []], ...fallsOf({ columns })];
}

// [words, values] of what fell off the belts, where anything did.
export function fallsOf({ columns }) {
  const values = columns.get("fallen") ?? [];
  return values.at(-1) >= FALLEN_TOLD ? [["fell off the belts", values]] : [];
}

function sumOf([first = [], ...others]) {
  return others.reduce((sum, values) => sum.map((value, k) => value + values[k]), first);
}

// [words, values] of what is in the counters, and what waits at the feeds.
export function contentOf({ counters, feeds = [] }, { columns }) {
  return [...counters.map((counter) => [wordsOf(counter), columns.get(counter.id) ?? []]),
    ...feeds.map(({ id }) => [`${id}: waiting`, columns.get(`${id}.waiting`) ?? []])];
}

// Whether a column only ever rises or, without feeds, only falls: what has passed so far, or what is still to pass.
export function isOneWay(scenario, column) {
  return !isFed(scenario) || /^(?:left_domain|fallen)$|\.(?:offered|admitted|discarded|left)$/.test(column);
}

// A curve minus another one, at its times that both have.
export function differenceOf({ t, v }, reference) {
  const last = reference.t.at(-1) ?? -Infinity;
  const known = t.map((time, k) => [time, v[k], time <= last + 1e-9 ? valueAt(reference.t, reference.v, time) : null])
    .filter(([, , other]) => other !== null);
  return { t: known.map(([time]) => time), v: known.map(([, value, other]) => value - other) };
}

export const shifted = (curve, by) => ({ ...curve, t: curve.t.map((time) => Number((time + by).toFixed(9))) });

// The root mean square distance of a curve from a reference, at its times that both have; null: fewer than two.
export function distanceOf(curve, reference) {
  const { v } = differenceOf(curve, reference);
  return v.length < 2 ? null : Math.sqrt(v.reduce((sum, one) => sum + one * one, 0) / v.length);
}

const SHIFTS = 400; // that are tried at first

// By how much later a curve is nearest to a reference, to a four-thousandth of what both times span; null: it cannot be said. At least
// half of its samples stay within the reference.
export function fittedShift(curve, reference) {
  const { t } = curve;
  if (t.length < 2 || reference.t.length < 2) return null;
  const [low, high] = [reference.t[0] - t.at(-1), reference.t.at(-1) - t[0]];
  const at = (by) => {
    const moved = shifted(curve, by);
    const isWithin = 2 * differenceOf(moved, reference).v.length >= t.length;
    return { by, distance: isWithin ? distanceOf(moved, reference) ?? Infinity : Infinity };
  };
  const bestOf = (from, step, n) => Array.from({ length: n + 1 }, (_, k) => at(from + k * step)).reduce((a, b) => (b.distance < a.distance ? b : a));
  const step = (high - low) / SHIFTS;
  const coarse = bestOf(low, step, SHIFTS);
  if (coarse.distance === Infinity) return null;
  const fine = bestOf(coarse.by - step, step / 10, 20);
  return Number(fine.by.toPrecision(4));
}

const RATE_WINDOWS = 20; // that the time of a curve has, of each of which a rate is the mean

// How many parts per second pass, of a curve that only rises or only falls, as means over windows about each sample.
export function rateOf({ t, v }) {
  if (t.length < 3) return { t: [], v: [] };
  const sign = Math.sign(v.at(-1) - v[0]);
  const half = Math.max((t.at(-1) - t[0]) / RATE_WINDOWS, t[1] - t[0]) / 2;
  const times = t.filter((time) => time >= t[0] + half - 1e-9 && time <= t.at(-1) - half + 1e-9);
  const passed = (time) => sign * (valueAt(t, v, time + half) - valueAt(t, v, Math.max(time - half, t[0])));
  return { t: times, v: times.map((time) => Math.max(0, passed(time)) / (2 * half)) };
}
