// Files that the page makes, and the browser saves.

import Papa from "papaparse";

import { ask } from "./api.js";
import { link } from "./dom.js";

export function saveBlob(blob, name) {
  const url = URL.createObjectURL(blob);
  link(url, "", { download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

// A table as spreadsheets open it where numbers have a decimal comma: with semicolons between the columns.
export function withDecimalCommas(csv) {
  const { data } = Papa.parse(csv.trimEnd(), { delimiter: "," }); // or it would be guessed
  const isNumber = (cell) => cell.trim() !== "" && Number.isFinite(Number(cell));
  return `${Papa.unparse(data.map((row) => row.map((cell) => (isNumber(cell) ? cell.replace(".", ",") : cell))), { delimiter: ";" })}\r\n`;
}

// Saves a table of the API so. The byte order mark tells spreadsheets that it is UTF-8.
export async function saveWithCommas(target, name) {
  const csv = await (await ask(target)).text();
  saveBlob(new Blob(["\uFEFF", withDecimalCommas(csv)], { type: "text/csv" }), name);
}
