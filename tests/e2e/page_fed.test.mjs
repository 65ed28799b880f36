// Runs that are fed: from the form, with their plates and photo eyes, curves and key figures, and both models together.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { closeBrowser, editText, numberIn, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { fed } from "./scenarios.mjs";
import { until } from "./setup.mjs";

after(closeBrowser);

// The value of a curve in the legend, at the time of the animation.
const valueOf = (page, name) => numberIn(page.locator(".plot-legend li", { hasText: name }).locator("b"));

const showsValue = (page, name, value) => page.waitForFunction(([text, number]) =>
  [...document.querySelectorAll(".plot-legend li")].some((item) => item.querySelector("span")?.textContent === text
    && Number(item.querySelector("b").textContent.replaceAll(",", "")) === number), [name, value]);

async function pauseAt(page, t) {
  const slider = page.getByRole("slider", { name: "Time" });
  await page.locator("main").focus();
  if ((await page.locator(".transport .primary").getAttribute("aria-label")) === "Pause") await page.keyboard.press("k");
  await slider.fill(String(t));
}

// Whether a plate or a photo eye is drawn at a place of the belt; of a plate that is away there is only an outline.
function isDrawn(page, [x, y]) {
  return page.evaluate(([across, up, margin]) => {
    const canvas = document.querySelector("canvas.devices");
    const ratio = canvas.width / canvas.clientWidth;
    const place = (share, from, to, size) => Math.round((from + share * (size - from - to)) * ratio);
    const px = place(across, margin.left, margin.right, canvas.clientWidth);
    const py = place(1 - up, margin.top, margin.bottom, canvas.clientHeight);
    return canvas.getContext("2d").getImageData(px, py, 1, 1).data[3] > 0;
  }, [x / 0.6, y / 0.3, { left: 46, right: 22, top: 12, bottom: 28 }]);
}

async function submitBoth(d) {
  const runs = [];
  for (const model of ["micro", "macro"]) runs.push(await d.submit(fed(), { model }));
  for (const { id } of runs) await d.reached(id, "succeeded");
  return runs.map(({ id }) => id);
}

test("a fed scenario is started from the form in both models, and its flow is shown to its end", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  for (const model of ["Macroscopic", "Microscopic"]) {
    await visit(page, "#/new?tab=json");
    await page.getByText("Ready:").waitFor();
    await editText(page, JSON.stringify(fed()));
    await page.getByRole("button", { name: model }).click();
    await page.getByRole("button", { name: "Belt and numbers" }).click();
    await page.getByRole("textbox", { name: "Feed" }).fill("10");
    await page.getByText(model === "Macroscopic" ? "Ready: 1,800 cells, 3 s." : "Ready: every part by itself, 3 s.").waitFor();
    await page.getByRole("button", { name: "Start the run" }).click();
    await page.locator(".pill", { hasText: "succeeded" }).waitFor();
    await page.getByText("Parts that entered").waitFor();
    await page.keyboard.press("End");
    // Ten a second, for three seconds, one after the other: none had to wait.
    for (const [name, value] of [["offered", 30], ["admitted", 30], ["waiting", 0]]) await showsValue(page, name, value);
    await page.getByRole("button", { name: "Content" }).click();
    await page.locator(".plot-legend", { hasText: "infeed: waiting" }).waitFor();
    assert.equal(await page.locator(".plot-legend", { hasText: "offered" }).count(), 0);
  }
});

test("plates stand as at the time shown, by the scenario and by what a photo eye commanded", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  for (const id of await submitBoth(d)) {
    await visit(page, `#/runs/${id}?t=0`);
    await page.waitForFunction(() => performance.getEntriesByName("first-frame").length > 0);
    await pauseAt(page, 0);
    const [raised, stop] = [[0.47, 0.07], [0.5025, 0.25]]; // 0.1 m up the flap at 45 degrees; within the stop
    await until(async () => !(await isDrawn(page, raised)) && !(await isDrawn(page, stop)), "no plate to be drawn");
    // The first parts are at the photo eye after 0.25 m at 0.3 m/s.
    await pauseAt(page, 2);
    await until(async () => (await isDrawn(page, raised)) && (await isDrawn(page, stop)), "both plates to be drawn");
  }
});

test("both models of a fed run stand in one plot, and in the list with what went through", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  const ids = await submitBoth(d);
  await visit(page, `#/compare?runs=${ids.join()}&t=3`);
  await page.locator(".plot-legend .group").nth(1).waitFor();
  assert.deepEqual(await page.locator(".plot-legend .group").allInnerTexts(),
    ["micro", "macro, dispersive"]);
  assert.deepEqual(await page.locator(".plot-legend span").allInnerTexts(),
    Array.from({ length: 2 }, () => ["offered", "admitted", "waiting", "left the belt"]).flat());
  await showsValue(page, "offered", 60);
  const measures = (await d.get(`/v1/compare?a=${ids[0]}&b=${ids[1]}&column=left_domain`)).json;
  await page.getByRole("group", { name: "What this says" }).getByText(measures.verdicts[0].text.replaceAll(" -", " −")).waitFor();
  await page.getByText("Agreement").click();
  const gap = page.locator(".measures tbody tr", { hasText: "Mean gap" }).locator("td").last();
  await gap.getByText(/\d/).waitFor();
  assert.ok(Math.abs((await numberIn(gap)) - measures.curve.l1) < 0.005);
  await page.getByRole("combobox", { name: "Curves" }).selectOption("infeed.waiting");
  await page.locator(".plot-legend", { hasText: "offered" }).waitFor({ state: "detached" });
  assert.equal(await valueOf(page, "macro"), 0);

  await visit(page, "#/");
  for (const through of await page.locator('td[data-label="Parts through"]').all()) await through.getByText(/of 60/).waitFor();
});

test("key figures are the daemon's, with their units and definitions, and the list shows the throughput", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  const [id] = await submitBoth(d);
  const { key_figures: figures, verdicts } = (await d.get(`/v1/runs/${id}/summary`)).json;
  const { RunFigures: described } = (await d.get("/openapi.json")).json.components.schemas;
  await visit(page, `#/runs/${id}`);
  await page.getByRole("group", { name: "What this says" }).getByText(verdicts[0].text).waitFor();
  const panel = page.getByRole("region", { name: "Key figures" });
  const throughput = panel.locator("dl > div", { hasText: "Throughput" }).first().locator("dd span");
  await throughput.getByText("parts/h").waitFor();
  const shown = await numberIn(throughput);
  assert.ok(Math.abs(shown - figures.throughput_per_h) <= 0.5, `${shown} is not ${figures.throughput_per_h}`);
  assert.equal(await throughput.getAttribute("title"), described.properties.throughput_per_h.description);
  const glance = page.getByRole("region", { name: "At a glance" });
  for (const [name, value] of [["Throughput", figures.throughput_per_h], ["Longest queue", figures.queue_end_m],
    ["Residence", figures.residence_s.p95], ["Peak density", 100 * figures.peak_density]].filter(([, known]) => known !== undefined)) {
    const shown = await numberIn(glance.locator("dl > div", { hasText: name }).locator("dd").first());
    assert.ok(Math.abs(shown - value) <= 0.005 * value, `${name}: ${shown} is not ${value}`);
  }
  for (const name of ["Feed “infeed”", "Counter “upstream”"]) await panel.getByRole("heading", { name }).waitFor();

  await visit(page, "#/");
  const cells = page.locator('td[data-label="Sustained throughput"]');
  await cells.nth(1).getByText("/h").waitFor();
  const listed = await Promise.all([cells.first(), cells.nth(1)].map(numberIn));
  assert.ok(listed.some((value) => Math.abs(value - figures.throughput_per_h) <= 0.5), String(listed));
});
