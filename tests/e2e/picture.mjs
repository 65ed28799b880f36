// Makes the README's picture, web/picture.png: Example 1 in both models at the same instant, as the page shows them.
//
//   node tests/e2e/picture.mjs

import assert from "node:assert/strict";
import { statSync } from "node:fs";
import path from "node:path";
import test, { after } from "node:test";

import { closeBrowser, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { root } from "./setup.mjs";

const mostBytes = 200_000;

after(closeBrowser);

test("a picture of both models", async (t) => {
  const d = await daemon(t, { workers: 2 });
  const scenario = (await d.get("/v1/examples/example-1")).json;
  const runs = await Promise.all(["micro", "macro"].map((model) => d.submit(scenario, { model })));
  for (const { id } of runs) await d.reached(id, "succeeded");
  const page = await openPage(t, d, { motion: "reduce" });
  await page.setViewportSize({ width: 1280, height: 860 });
  await visit(page, `#/compare?runs=${runs.map(({ id }) => id)}&t=2`);
  await page.locator(".stamp:not(.late)", { hasText: "2.0 s" }).nth(1).waitFor();
  await page.locator(".u-over").waitFor();
  const file = path.join(root, "web/picture.png");
  await page.screenshot({ path: file });
  assert.ok(statSync(file).size <= mostBytes, `${statSync(file).size} bytes`);
});
