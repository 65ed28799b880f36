// tests/golden/results.txt has the digests of the results of all ready scenarios; here is what they are taken of.

import { createHash } from "node:crypto";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import path from "node:path";

import { isEmulated, root } from "./setup.mjs";

export const goldenFile = path.join(root, "tests/golden/results.txt");

// Only on x86-64 is there a choice; AArch64 always has fused multiply-add.
export const isX86 = process.arch === "x64" && !isEmulated;
export const hasFma = !isX86 || /^flags.*\bfma\b/m.test(readFileSync("/proc/cpuinfo", "utf8"));

// Results of one release are those of the next, so the digests have the first one's number.
const release = { solver_version: "0.1.0" };

// The members of a summary that are results: not timings, not what is said about the run and what follows from its document, and
// not that itself, which api/openapi.json has.
function resultsOf(text) {
  const { verdicts, warnings, warning_details, validity, closure, cell_m, scenario, ...results } = JSON.parse(text);
  return JSON.stringify({ ...results, ...release }, (name, value) => (/^(wall_time_s|threads|\w+_steps_per_s)$/.test(name) ? 0 : value));
}

// One digest for all files of a folder, names and bytes, in order.
export function digestOfFolder(folder) {
  const hash = createHash("sha256");
  const names = readdirSync(folder, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => path.relative(folder, path.join(entry.parentPath ?? entry.path, entry.name)))
    .filter((name) => name !== "scenario.json")
    .sort();
  for (const name of names) {
    const bytes = readFileSync(path.join(folder, name));
    const kept = name === "summary.json" ? Buffer.from(resultsOf(bytes.toString())) : bytes;
    hash.update(`${name} ${kept.length}\n`).update(kept);
  }
  return hash.digest("hex");
}

// The digests of a ready scenario in a model, by "<scenario>/<model>".
export const known = existsSync(goldenFile)
  ? new Map(readFileSync(goldenFile, "utf8").trim().split("\n").map((line) => {
    const [name, fma, none = fma] = line.split(" ");
    return [name, { fma, none }];
  }))
  : new Map();

// The one that the processor at hand must give.
export function goldenDigest(scenario, model) {
  return known.get(`${scenario}/${model}`)?.[hasFma ? "fma" : "none"];
}
