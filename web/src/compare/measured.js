// Counts that were measured on a real belt: read from CSV, stored by the server, bound to a counter.

import Papa from "papaparse";

import { getJson, post } from "../base/api.js";
import { h } from "../base/dom.js";
import { marksOf, numberWith } from "../base/numbers.js";
import { tidy } from "../scenario/plate.js";

// Seconds of a time: a number, or a time of day as 7:05 or 07:05:30.5; NaN is neither.
function secondsOf(text, mark) {
  const clock = /^(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d+)?))?$/.exec(text);
  return clock ? 3600 * Number(clock[1]) + 60 * Number(clock[2]) + Number((clock[3] ?? "0").replace(",", ".")) : numberWith(text, mark);
}

const isClock = (text) => text.includes(":");

// { name, t, v } of CSV with times and counts of parts, with or without a header, separated by commas, semicolons or tabs. Times
// are seconds, or times of day, which then count from the first. Throws with the line at fault.
export function readMeasured(text) {
  const delimiter = [";", "\t", ","].find((mark) => text.includes(mark));
  const { data } = Papa.parse(text.replace(/^\uFEFF/, ""), { delimiter });
  const lines = data.map((cells, k) => ({ line: k + 1, t: cells[0]?.trim() ?? "", v: cells[1]?.trim() ?? "" })).filter(({ t, v }) => t + v !== "");
  const curve = { name: "", t: [], v: [] };
  if (lines.length > 0 && !/\d/.test(lines[0].t)) curve.name = lines.shift().v;
  const [mark = ".", other] = delimiter === "," ? ["."] : marksOf(lines.flatMap(({ t, v }) => (isClock(t) ? [v] : [t, v])));
  if (other !== undefined) throw new Error("It is not clear whether “.” and “,” are decimal marks or between thousands: write thousands without a mark.");
  for (const { line, t: time, v: count } of lines) {
    const [t, v] = [secondsOf(time, mark), numberWith(count, mark)];
    if (!Number.isFinite(t) || !Number.isFinite(v)) throw new Error(`Line ${line}: “${`${time} ${count}`.trim()}” is not a time and a number of parts.`);
    if (t <= curve.t.at(-1)) throw new Error(`Line ${line}: times must rise.`);
    curve.t.push(t);
    curve.v.push(v);
  }
  if (curve.t.length < 2) throw new Error("There are not two samples.");
  if (isClock(lines[0].t)) curve.t = curve.t.map((t) => tidy(t - curve.t[0], 9));
  return curve;
}

const shown = ({ id, label, counter, t_s: t, count: v }) => ({ id, label: label || "measured", counter, t, v });

// A stored curve by its id: { id, label, counter, t, v }.
export async function loadMeasured(id) {
  return shown(await getJson(`v1/measurements/${id}`));
}

export async function storeMeasured({ t, v }, label, counter) {
  return shown(await post("v1/measurements", { label, counter, t_s: t, count: v }));
}

// Counts of the time before each sample as counts up to it.
export function summedUp({ name, t, v }) {
  let sum = 0;
  const fall = v.findIndex((count) => count < 0);
  if (fall >= 0) throw new Error(`At ${t[fall]} s ${v[fall]} parts came: they cannot be fewer than none.`);
  return { name, t, v: v.map((count) => (sum = tidy(sum + count, 12))) };
}

// Stores a curve for the counter that its column is called like, if isCounter(name) knows it, else for this one.
export function storeCurve(curve, label, counter, isCounter) {
  return storeMeasured(curve, label, isCounter(curve.name) ? curve.name : counter);
}

// Stores a file under its name. The error begins with it.
export async function storeFile(file, counter, isCounter) {
  try {
    return await storeCurve(readMeasured(await file.text()), file.name, counter, isCounter);
  } catch (error) {
    throw new Error(`${file.name}: ${error.message}`);
  }
}

// A button that takes a file of counts. It forgets the file, so that the same one can be given again once it is mended.
export function fileButton(text, onFile, properties = {}) {
  const box = h("input", { type: "file", accept: ".csv,.txt,text/csv", class: "hidden", ...properties, on: { change: () => {
    const [file] = box.files;
    box.value = "";
    if (file) onFile(file);
  } } });
  return h("label", { class: "button" }, box, text);
}

// Stored curves, the newest first, without their samples.
export async function listMeasured() {
  const { measurements } = await getJson("v1/measurements?limit=50");
  return measurements.filter(({ kind }) => kind === undefined);
}
