// Exchanges that succeeded, as candidates for the examples of the document: with BELTFLOW_SAMPLES=FOLDER each process of a
// story writes those that it saw there, and tests/openapi/samples.mjs makes api/openapi/samples.txt of them.

import { mkdirSync, writeFileSync } from "node:fs";
import path from "node:path";

const folder = process.env.BELTFLOW_SAMPLES;
const PER_KIND = 40; // of an operation, a place and a media type
const seen = new Map();

process.on("exit", () => {
  if (folder === undefined || seen.size === 0) return;
  mkdirSync(folder, { recursive: true });
  writeFileSync(path.join(folder, `${process.pid}.json`), JSON.stringify([...seen.values()].flat()));
});

// where: "request", or the status of the answer; body: a text.
export function noteSample({ operationId }, target, where, type, body) {
  if (folder === undefined || type === undefined || type === "") return;
  const kind = `${operationId} ${where} ${type}`;
  const list = seen.get(kind) ?? [];
  if (list.length < PER_KIND) seen.set(kind, [...list, { kind, target, body }]);
}
