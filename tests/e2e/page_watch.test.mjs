// Watching and comparing: Example 1 in both models, from the form to the measures.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { closeBrowser, numberIn, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";

after(closeBrowser);

// Starts Example 1 by the form; the run's id.
async function start(page, model) {
  await visit(page, "#/new?example=example-1");
  await page.getByText("Ready:").waitFor();
  if (model === "Microscopic") await page.getByRole("button", { name: model }).click();
  await page.getByText(model === "Microscopic" ? "Ready: every part" : "Ready: 24,000 cells").waitFor();
  await page.getByRole("button", { name: "Start the run" }).click();
  await page.waitForURL(/#\/runs\//);
  return /runs\/([^?]+)/.exec(page.url())[1];
}

const timeOf = async (page) => Number(await page.getByRole("slider", { name: "Time" }).inputValue());

// The density that the probe shows at a place of the belt, share of close packing.
async function probe(page, [x, y]) {
  const frame = page.locator(".stage-frame").first();
  const box = await frame.boundingBox();
  const [left, right, top, bottom] = [46, 22, 12, 28]; // room for the axes
  await page.mouse.move(box.x + left + x * (box.width - left - right), box.y + box.height - bottom - (y / 0.6) * (box.height - top - bottom));
  await page.locator(".tip:not([hidden])").first().waitFor();
  return (await numberIn(page.locator(".tip span").first())) / 100;
}

async function pause(page) {
  await page.locator("main").focus();
  if ((await page.locator(".transport .primary").getAttribute("aria-label")) === "Pause") await page.keyboard.press("k");
}

test("Example 1 in both models from the form, live to its end, scrubbed, and compared with measured counts", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);

  const macro = await start(page, "Macroscopic");
  await page.locator(".pill", { hasText: "succeeded" }).waitFor();
  const micro = await start(page, "Microscopic");
  await page.getByRole("button", { name: "Follow live", pressed: true }).waitFor();
  await page.waitForFunction(() => Number(document.querySelector(".transport input").value) > 1);
  await page.locator(".pill", { hasText: "succeeded" }).waitFor();
  await page.getByText("Parts at start").waitFor();

  // Scrubbed by the slider, by keys, and by the curve.
  const slider = page.getByRole("slider", { name: "Time" });
  await slider.fill("2");
  await pause(page);
  await slider.fill("2");
  assert.equal(await timeOf(page), 2);
  await page.locator("main").focus();
  await page.keyboard.press("ArrowRight");
  assert.ok(Math.abs((await timeOf(page)) - 2.1) < 1e-6);
  const over = await page.locator(".u-over").boundingBox();
  await page.mouse.click(over.x + over.width / 2, over.y + over.height / 2);
  assert.ok(Math.abs((await timeOf(page)) - 3) < 0.11, "the middle of the plot is 3 s");
  await slider.fill("2");

  // The value under the pointer is the snapshot's, at both models' places.
  for (const id of [micro, macro]) {
    await visit(page, `#/runs/${id}?t=2`);
    const shown = await probe(page, [0.6025, 0.3025]);
    const snapshot = (await d.get(`/v1/runs/${id}/snapshots/20?format=json`)).json;
    const grid = snapshot.density;
    assert.ok(Math.abs(shown - grid[60][120]) < 6e-4, `${shown} is not ${grid[60][120]}`);
  }

  // Both from the list into one view.
  await visit(page, "#/");
  for (const model of ["macro", "micro"]) await page.getByRole("checkbox", { name: `(${model})` }).check();
  await page.getByRole("button", { name: "Compare 2 runs" }).click();
  const measures = (await d.get(`/v1/compare?a=${micro}&b=${macro}`)).json;
  await page.waitForURL(/#\/compare/);
  const cells = page.locator(".measures tbody tr", { hasText: "Mean gap" }).locator("td");
  await page.waitForFunction(() => /\d/.test(document.querySelector(".measures tbody td:last-child")?.textContent));
  assert.ok(Math.abs((await numberIn(cells.last())) - measures.curve.l1) < 0.005);
  assert.equal(await page.locator(".panel").count(), 2);

  // Counts that were measured: 5 parts more than the first run has, at each time.
  const first = (await page.url()).match(/runs=([^,]+)/)[1];
  const curve = (await d.get(`/v1/runs/${first}/curve`)).json;
  const csv = ["t_s,count", ...curve.t_s.map((time, k) => `${time},${curve.upstream[k] + 5}`)].join("\n");
  await page.locator(".card.curve").evaluate((card, text) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([text], "belt.csv", { type: "text/csv" }));
    for (const type of ["dragover", "drop"]) card.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
  }, csv);
  await page.locator(".plot-legend", { hasText: "measured: belt.csv" }).waitFor();
  assert.equal(await numberIn(cells.last()), 5);
  await page.setInputFiles('input[type="file"]', { name: "bad.csv", mimeType: "text/csv", buffer: Buffer.from("t_s,count\n1,x") });
  await page.getByText("bad.csv: Line 2").waitFor();

  // One clock for both.
  await page.keyboard.press("Escape");
  await pause(page);
  await slider.fill("3");
  await page.getByText("3.0 / 6.0 s").waitFor();
});

test("a run's page offers its results, and they are the daemon's bytes", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/example-1")).json;
  const run = await d.submit({ ...example, duration_s: 0.3 });
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d);
  await visit(page, `#/runs/${run.id}?t=0.2`);
  const csv = page.getByRole("link", { name: "Curve, CSV" });
  const href = await csv.getAttribute("href");
  assert.equal((await d.get(`/${href}`)).text, (await d.get(`/v1/runs/${run.id}/curve?format=csv`)).text);
  assert.match(await page.getByRole("link", { name: "Density shown, NPY" }).getAttribute("href"), /snapshots\/2\?format=npy$/);
  await csv.focus();
  assert.equal(await page.locator(".curl").innerText(), `curl -sS -o curve.csv '${d.url}v1/runs/${run.id}/curve?format=csv'`);
  const waiting = page.waitForEvent("download");
  await page.locator("li", { hasText: "Picture as seen" }).getByRole("button").click();
  assert.equal((await waiting).suggestedFilename(), "belt-000002.png");
});

test("with reduced motion nothing moves by itself", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/example-1")).json;
  const run = await d.submit({ ...example, duration_s: 0.3 });
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d, { motion: "reduce" });
  await visit(page, `#/runs/${run.id}`);
  await page.getByText("Parts at start").waitFor();
  await page.waitForTimeout(300);
  assert.equal(await timeOf(page), 0);
  assert.equal(await page.locator(".transport .primary").getAttribute("aria-label"), "Play");
});

test("an address without a run or a view says so", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/runs/01a1f916-75bc-759c-9d74-cbbf3fe9393f");
  await page.getByRole("heading", { name: "There is no such run" }).waitFor();
  await visit(page, "#/nothing");
  await page.getByRole("heading", { name: "There is no such view" }).waitFor();
});
