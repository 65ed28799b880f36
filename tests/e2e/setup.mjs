// Where things are, how long a story waits, and how it waits.

import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { setTimeout as sleep } from "node:timers/promises";
import { fileURLToPath } from "node:url";

export const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
export const binaries = process.env.BELTFLOW_BIN_DIR ?? path.join(root, "build/release/bin");
export const packages = process.env.BELTFLOW_NPM_DIR ?? path.join(root, "build/release/tests-npm");
// The page's folder. It is not built without npm nor under the sanitizers.
export const web = path.join(binaries, "../web");
export const hasPage = existsSync(web);
export const isSanitized = (process.env.BELTFLOW_SANITIZED ?? "") !== "";
export const isThreadSanitized = process.env.BELTFLOW_SANITIZED === "thread";
// The programs are those of another processor.
export const isEmulated = process.env.BELTFLOW_EMULATED === "1";

// How long anything may take before a story fails, ms. Generous: it only ends what hangs.
export const patience = isEmulated ? 1_800_000 : isSanitized ? 120_000 : 60_000;

// A folder that is removed after the story.
export function temporaryFolder(t) {
  const folder = mkdtempSync(path.join(tmpdir(), "beltflow-e2e-"));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

// The result of a promise, or a failure that says what was waited for.
export function within(promise, what, ms = patience) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`waited ${ms} ms for ${what}`)), ms);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

// Ask until the answer is truthy; returns it. The longer it takes the more seldom: asking takes time from what is waited
// for.
export async function until(ask, what, ms = patience) {
  const deadline = Date.now() + ms;
  for (let pause_ms = 10; ; pause_ms = Math.min(1.2 * pause_ms, 100)) {
    const answer = await ask();
    if (answer) return answer;
    if (Date.now() > deadline) throw new Error(`waited ${ms} ms for ${what}`);
    await sleep(pause_ms);
  }
}
