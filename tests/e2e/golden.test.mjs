// The results of every ready scenario in both models, without its document, are the bytes that tests/golden/results.txt has, on
// processors with fused multiply-add and without (libm rounds a few values differently there, so there
// are two digests where they differ). With BELTFLOW_GOLDEN=write the file is written instead.

import assert from "node:assert/strict";
import { readdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { digestOfFolder, goldenFile, hasFma, isX86, known } from "./golden.mjs";
import { beltflow } from "./processes.mjs";
import { isSanitized, patience, root, temporaryFolder } from "./setup.mjs";

const scenarios = path.join(root, "api/scenario/examples");
const withoutFma = "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX2_Usable,-FMA_Usable";

async function digestOfResults(t, file, model, tunables) {
  const out = path.join(temporaryFolder(t), "out");
  const env = tunables === undefined ? {} : { GLIBC_TUNABLES: tunables };
  const done = await beltflow(["solve", file, "--model", model, "--out", out], { env, limit: 10 * patience });
  assert.equal(done.status, 0, done.stderr);
  return digestOfFolder(out);
}

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
