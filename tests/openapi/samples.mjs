// Makes api/openapi/samples.txt, the examples of the document, of what the stories exchanged.
//
//     samples.mjs FOLDER     the folder that BELTFLOW_SAMPLES named
//
// A line is: operation, "request" or status, media type, path and query, value as JSON. Of an operation's exchanges the
// longest that is short is taken; where all are long, the shortest, whose lists and lines are cut. Of operations that nobody
// asked for the example stays, if it still is what the schema says.

import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";

import { fitsSchema, mediaOf, readSamples, samplesFile } from "./sample_schemas.mjs";

const MOST = 2500; // characters of a value
const LINES = 8; // of a text that is cut

// Lists of pairs stay lists of pairs.
function cutLists(value, most) {
  if (Array.isArray(value)) return value.slice(0, most).map((item) => cutLists(item, most));
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, cutLists(item, most)]));
}

const isJson = (type) => type.endsWith("json") && !type.endsWith("ndjson");
const isText = (type) => /^text\/|ndjson$|xml$/.test(type);

// The value of an example, or undefined where there is none.
function valueOf(kind, body) {
  const [, , type] = kind.split(" ");
  if (isText(type)) {
    if (body.length <= MOST) return body;
    const lines = body.split("\n");
    return type.endsWith("xml") || lines[0].length > MOST ? undefined : `${lines.slice(0, LINES).join("\n")}\n`;
  }
  if (!isJson(type)) return undefined;
  const whole = JSON.parse(body);
  const tried = [whole, ...[16, 8, 4, 3, 2].map((most) => cutLists(whole, most))]
    .filter((value) => fitsSchema(kind, value));
  return tried.find((value) => JSON.stringify(value).length <= MOST) ?? tried.at(-1);
}

// The document has no example of itself, and those of bodies that the ready scenarios are.
const isWanted = ({ kind }) =>
  !kind.startsWith("getDocument ") && !Object.values(mediaOf(kind)?.examples ?? {}).some(({ $ref }) => $ref !== undefined);

const candidates = readdirSync(process.argv[2])
  .flatMap((file) => JSON.parse(readFileSync(path.join(process.argv[2], file), "utf8"))).filter(isWanted);
const rank = ({ body }) => (body.length <= MOST ? body.length : -body.length);
const chosen = new Map();
for (const candidate of candidates.sort((a, b) => rank(b) - rank(a))) {
  if (chosen.has(candidate.kind)) continue;
  const value = valueOf(candidate.kind, candidate.body);
  if (value !== undefined) chosen.set(candidate.kind, `${candidate.kind} ${candidate.target} ${JSON.stringify(value)}\n`);
}
for (const { kind, target, value } of readSamples()) {
  if (!chosen.has(kind) && fitsSchema(kind, value)) chosen.set(kind, `${kind} ${target} ${JSON.stringify(value)}\n`);
}
writeFileSync(samplesFile, [...chosen.values()].sort().join(""));
console.log(`${chosen.size} examples of ${new Set(candidates.map(({ kind }) => kind)).size} kinds`);
