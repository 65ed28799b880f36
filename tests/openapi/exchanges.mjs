// The sum of what the stories validated against the document: reads the folders that BELTFLOW_EXCHANGES
// named, prints how much there was in each, and fails when an operation of the document was never
// answered with success, or when a request of the first folder was not answered as
// tests/golden/exchanges.txt has it.
//
//     exchanges.mjs DOCUMENT FOLDER ...              check
//     exchanges.mjs --golden DOCUMENT FOLDER ...     write the golden file: what every folder answers alike

import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";

import { operationsOf } from "./operations.mjs";

const isWriting = process.argv[2] === "--golden";
const [documentFile, ...folders] = process.argv.slice(isWriting ? 3 : 2);
const document = JSON.parse(readFileSync(documentFile, "utf8"));
const goldenFile = path.join(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname),
  "../golden/exchanges.txt");

// The lines of a folder: { n, kind, request, answer }. kind is method, template, status and media type.
function read(folder) {
  const files = existsSync(folder) ? readdirSync(folder).filter((file) => file.endsWith(".txt")) : [];
  return files.flatMap((file) =>
    readFileSync(path.join(folder, file), "utf8").trim().split("\n").map((line) => {
      const [n, method, template, status, type, request, answer] = line.split(" ");
      return { n: Number(n), kind: `${method} ${template} ${status} ${type}`, request, answer };
    }));
}

// "kind request" to the set of the answers that it got.
function answersOf(lines) {
  const answers = new Map();
  for (const { kind, request, answer } of lines) {
    const pair = `${kind} ${request}`;
    answers.set(pair, (answers.get(pair) ?? new Set()).add(answer));
  }
  return answers;
}

function writeGolden() {
  const [first, ...others] = folders.map((folder) => answersOf(read(folder)));
  const stable = [...first].filter(([pair, answers]) => {
    const [answer] = answers;
    return answers.size === 1 && answer !== "-" && others.every((other) => {
      const found = other.get(pair);
      return found?.size === 1 && found.has(answer);
    });
  });
  writeFileSync(goldenFile, stable.map(([pair, [answer]]) => `${pair} ${answer}\n`).sort().join(""));
  console.log(`${stable.length} of ${first.size} pairs are the same in ${folders.length} folders`);
}

function differencesFromGolden() {
  const answers = answersOf(read(folders[0]));
  return readFileSync(goldenFile, "utf8").trim().split("\n").flatMap((line) => {
    const [, pair, answer] = /^(.*) (\S+)$/.exec(line);
    const found = answers.get(pair);
    if (found === undefined) return [`golden: nobody asked ${pair}`];
    return found.has(answer) ? [] : [`golden: another answer to ${pair}`];
  });
}

function check() {
  const kinds = new Map();
  const sums = folders.map((folder) => {
    const lines = read(folder);
    for (const { n, kind } of lines) kinds.set(kind, (kinds.get(kind) ?? 0) + n);
    const total = lines.reduce((sum, { n }) => sum + n, 0);
    const pairs = new Set(lines.map(({ kind, request }) => `${kind} ${request}`));
    const ofFolder = new Set(lines.map(({ kind }) => kind));
    return `${path.basename(folder)}: ${total} exchanges, ${pairs.size} distinct pairs of request and response, `
      + `${ofFolder.size} kinds of them`;
  });
  const withoutSuccess = operationsOf(document).filter((operation) =>
    ![...kinds.keys()].some((kind) => kind.startsWith(`${operation} 2`)));
  const faults = [...withoutSuccess.map((operation) => `no story had success with ${operation}`),
    ...differencesFromGolden()];
  for (const [kind, n] of [...kinds].sort()) console.log(`${String(n).padStart(6)} ${kind}`);
  for (const line of [...sums, ...faults]) console.log(line);
  process.exit(faults.length === 0 ? 0 : 1);
}

if (isWriting) writeGolden();
else check();
