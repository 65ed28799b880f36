// Counts that were measured on a real belt: read from CSV, stored by the server, bound to a counter.

import Papa from "papaparse";

import { getJson, post } from "./api.js";
import { h } from "./dom.js";

// With another separator the comma may be the decimal mark.
function valueOf(cell = "") {
  return cell.trim() === "" ? NaN : Number(cell.trim().replace(",", "."));
}

// { name, t, v } of CSV with times in seconds and counts of parts, with or without a header, separated by commas, semicolons or
// tabs. Throws with the line at fault.
export function readMeasured(text) {
  const delimiter = [";", "\t", ","].find((mark) => text.includes(mark));
  const { data: lines } = Papa.parse(text.replace(/^\uFEFF/, ""), { delimiter });
  const curve = { name: "", t: [], v: [] };
  lines.forEach((cells, k) => {
    const [t, v] = cells.map(valueOf);
    if (cells.join("").trim() === "") return;
    if (k === 0 && Number.isNaN(t)) {
      curve.name = (cells[1] ?? "").trim();
      return;
    }
    if (!Number.isFinite(t) || !Number.isFinite(v)) {
      throw new Error(`Line ${k + 1}: “${cells.join(" ").trim()}” is not a time in seconds and a number of parts.`);
    }
    if (t <= curve.t.at(-1)) throw new Error(`Line ${k + 1}: times must rise.`);
    curve.t.push(t);
    curve.v.push(v);
  });
  if (curve.t.length < 2) throw new Error("There are not two samples.");
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

// Stores a file under its name: for the counter that its second column is called like, if isCounter(name) knows it, else for
// this one. The error begins with the file's name.
export async function storeFile(file, counter, isCounter) {
  try {
    const curve = readMeasured(await file.text());
    return await storeMeasured(curve, file.name, isCounter(curve.name) ? curve.name : counter);
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
