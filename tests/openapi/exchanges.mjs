// The sum of what the stories validated against the document: reads the folders that BELTFLOW_EXCHANGES
// named, prints how much there was in each, and fails when an operation of the document was never
// answered with success.

import { existsSync, readFileSync, readdirSync } from "node:fs";
import path from "node:path";

const [documentFile, ...folders] = process.argv.slice(2);
const document = JSON.parse(readFileSync(documentFile, "utf8"));
const kinds = new Map();

function sum(folder) {
  const pairs = new Set();
  const ofFolder = new Set();
  let total = 0;
  for (const file of existsSync(folder) ? readdirSync(folder) : []) {
    for (const line of readFileSync(path.join(folder, file), "utf8").trim().split("\n")) {
      const [n, method, template, status, type, request] = line.split(" ");
      const kind = `${method} ${template} ${status} ${type}`;
      pairs.add(`${kind} ${request}`);
      ofFolder.add(kind);
      kinds.set(kind, (kinds.get(kind) ?? 0) + Number(n));
      total += Number(n);
    }
  }
  const name = path.basename(folder);
  return `${name}: ${total} exchanges, ${pairs.size} distinct pairs of request and response, ${ofFolder.size} kinds of them`;
}

const sums = folders.map(sum);
const missing = [];
for (const [template, item] of Object.entries(document.paths)) {
  for (const method of ["get", "post", "put", "delete"]) {
    if (item[method] === undefined) continue;
    const start = `${method.toUpperCase()} ${template} 2`;
    if (![...kinds.keys()].some((kind) => kind.startsWith(start))) missing.push(`${method.toUpperCase()} ${template}`);
  }
}

for (const [kind, n] of [...kinds].sort()) console.log(`${String(n).padStart(6)} ${kind}`);
for (const line of sums) console.log(line);
for (const operation of missing) console.log(`no story had success with ${operation}`);
process.exit(missing.length === 0 ? 0 : 1);
