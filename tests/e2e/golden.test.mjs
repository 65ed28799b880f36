// The results of every ready scenario in both models, without its document, are the bytes that tests/golden/results.txt has, on
// processors with fused multiply-add and without (libm rounds a few values differently there, so there
// are two digests where they differ). With BELTFLOW_GOLDEN=write the file is written instead.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { beltflow } from "./processes.mjs";
import { isEmulated, isSanitized, patience, root, temporaryFolder } from "./setup.mjs";

const goldenFile = path.join(root, "tests/golden/results.txt");
const scenarios = path.join(root, "api/scenario/examples");
const withoutFma = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX2_Usable,-FMA_Usable";
// Only on x86-64 is there a choice; AArch64 always has fused multiply-add.
const isX86 = process.arch === "x64" && !isEmulated;
const hasFma = !isX86 || /^flags.*\bfma\b/m.test(readFileSync("/proc/cpuinfo", "utf8"));

// Results of one release are those of the next, so the digests have the first one's number.
const release = { solver_version: "0.1.0" };

// The members of a summary that are results: not timings, not what is said about the run and what follows from its document, and
// not that itself, which api/openapi.json has.
function resultsOf(text) {
  const { verdicts, warnings, warning_details, validity, closure, cell_m, scenario, ...results } = JSON.parse(text);
  return JSON.stringify({ ...results, ...release }, (name, value) => (/^(wall_time_s|threads|\w+_steps_per_s)$/.test(name) ? 0 : value));
}

// One digest for all files of a folder, names and bytes, in order.
function digestOfFolder(folder) {
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

async function digestOfResults(t, file, model, tunables) {
  const out = path.join(temporaryFolder(t), "out");
  const env = tunables === undefined ? {} : { GLIBC_TUNABLES: tunables };
  const done = await beltflow(["solve", file, "--model", model, "--out", out], { env, limit: 10 * patience });
  assert.equal(done.status, 0, done.stderr);
  return digestOfFolder(out);
}

const known = existsSync(goldenFile)
  ? new Map(readFileSync(goldenFile, "utf8").trim().split("\n").map((line) => {
    const [name, fma, none = fma] = line.split(" ");
    return [name, { fma, none }];
  }))
  : new Map();

for (const file of readdirSync(scenarios).sort()) {
  for (const model of ["macro", "micro"]) {
    const name = `${path.basename(file, ".json")}/${model}`;
    test(`the results of ${name} are the known bytes`, { skip: isSanitized }, async (t) => {
      const solve = (tunables) => digestOfResults(t, path.join(scenarios, file), model, tunables);
      const isWriting = process.env.BELTFLOW_GOLDEN === "write";
      const wanted = known.get(name);
      const fma = hasFma ? await solve() : wanted?.fma;
      // Where both are the same digest, the processor at hand is asked alone: half the time.
      const isOne = hasFma && !isWriting && wanted?.fma === wanted?.none;
      const none = isOne ? fma : isX86 ? await solve(withoutFma) : wanted?.none ?? fma;
      if (isWriting) known.set(name, { fma, none });
      else assert.deepEqual({ fma, none }, wanted);
    });
  }
}

if (process.env.BELTFLOW_GOLDEN === "write") {
  test.after(() => {
    const lines = [...known].map(([name, { fma, none }]) => `${name} ${fma}${none === fma ? "" : ` ${none}`}\n`);
    writeFileSync(goldenFile, lines.join(""));
  });
}
