// The manual and the reference at /docs: a page for each operation, chapter and kind of problem, and the search that leads to
// them.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { assertAccessible, closeBrowser, openPage, takePicture, visit } from "./browser.mjs";
import { document } from "./contract.mjs";
import { daemon } from "./daemon.mjs";

after(closeBrowser);

const operations = Object.entries(document.paths).flatMap(([path, item]) =>
  Object.entries(item).filter(([method]) => method !== "parameters").map(([method, operation]) => ({ path, method, ...operation })));

test("every link of the index and of each page behind it leads to a page and a place on it", async (t) => {
  const d = await daemon(t);
  const seen = new Map();
  const anchors = [];
  const queue = ["/docs"];
  while (queue.length > 0) {
    const target = queue.pop();
    if (seen.has(target)) continue;
    const page = await d.get(target);
    assert.equal(page.status, 200, target);
    seen.set(target, page.text);
    for (const [, path, anchor] of page.text.matchAll(/href="(\/docs[^"#]*)(#[^"]*)?"/g)) {
      if (/\.css$/.test(path)) continue;
      queue.push(path);
      if (anchor !== undefined) anchors.push([path, anchor.slice(1)]);
    }
  }
  for (const [path, anchor] of anchors) assert.ok(seen.get(path).includes(`id="${anchor}"`), `${path}#${anchor}`);
  for (const { operationId, path } of operations) {
    assert.ok(seen.get(`/docs/operations/${operationId}.html`)?.includes(path), operationId);
  }
  const problems = [...seen.keys()].filter((name) => name.startsWith("/docs/problems/"));
  assert.equal(problems.length, document.components.schemas.ProblemType.enum?.length ?? problems.length);
  const found = (await d.get("/docs/search.json")).json;
  for (const [kind, title, target] of found) {
    const [path, anchor] = target.split("#");
    assert.ok(seen.get(path) !== undefined && (anchor === undefined || seen.get(path).includes(`id="${anchor}"`)), `${kind} ${title}`);
  }
});

test("the search finds operations, members, problems and chapters, and Enter opens the first", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "docs");
  const field = page.getByRole("searchbox", { name: "Search" });
  const first = page.locator("#found li").first();
  for (const [words, title] of [["getcurve", "getCurve"], ["force_limit", "Obstacle.force_limit_n"], ["429", "429 too-many-requests"],
    ["other origin", "From another origin"], ["submit scenario disk", "submitRun"]]) {
    await field.fill(words);
    await first.getByRole("link", { name: title, exact: true }).waitFor();
  }
  await field.fill("nothing of this kind");
  await page.getByText("Nothing has all of these words.").waitFor();
  await field.fill("getcurvecsv");
  await first.waitFor();
  await field.press("Enter");
  await page.getByRole("heading", { name: "getCurveCsv" }).waitFor();
  await page.getByText("GET /v1/runs/{id}/curve.csv", { exact: true }).waitFor();
  await page.goto(`${d.url}docs?q=not-found`);
  await page.locator("#found").getByRole("link", { name: "404 not-found", exact: true }).waitFor();
});

test("pages of all kinds are accessible, and nothing sticks out, wide and narrow, light and dark", async (t) => {
  const d = await daemon(t);
  const pages = [["index", "docs"], ["operation", "docs/operations/submitRun.html"], ["picture", "docs/operations/getSnapshotPng.html"],
    ["scenario", "docs/the-scenario.html"], ["problem", "docs/problems/not-found.html"], ["schema", "docs/schemas/Scenario.html"]];
  for (const [size, scheme] of [["wide", "light"], ["phone", "dark"]]) {
    const page = await openPage(t, d, { size, scheme });
    for (const [name, address] of pages) {
      await visit(page, address);
      await page.getByRole("heading", { level: 1 }).waitFor();
      await assertAccessible(page, `${name} ${size}`);
      await takePicture(page, `docs-${name}-${size}`, size);
    }
  }
});
