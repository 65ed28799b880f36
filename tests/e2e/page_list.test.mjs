// The list of runs: it updates itself, filters, pages, cancels, deletes with a way back, and says when the
// daemon is away.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { closeBrowser, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { endless, jam, tiny } from "./scenarios.mjs";
import { until } from "./setup.mjs";

after(closeBrowser);

const rowOf = (page, name) => page.locator("tbody tr", { hasText: name });

test("a run that is submitted elsewhere appears, makes progress and can be cancelled", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/");
  await page.getByText("No runs yet.").waitFor();

  const run = await d.submit({ ...endless(), name: "for ever" });
  const row = rowOf(page, "for ever");
  await row.locator(".pill", { hasText: "running" }).waitFor();
  await row.getByRole("button", { name: "Cancel for ever" }).click();
  await row.locator(".pill", { hasText: "cancelled" }).waitFor();
  assert.match(await row.innerText(), /stopped at \d+ %/);
  // A closed gate lets nothing pass: no billionths of a part.
  assert.match(await row.locator('td[data-label="Sustained throughput"]').innerText(), /^0\s\/h$/);
  assert.equal((await d.run(run.id)).status, "cancelled");
});

test("what is deleted is gone at once, comes back by undo, and else leaves the daemon", async (t) => {
  const d = await daemon(t);
  const runs = [];
  for (const name of ["kept", "lost"]) runs.push(await d.submit(tiny({ name })));
  for (const { id } of runs) await d.reached(id, "succeeded");
  const page = await openPage(t, d);
  await visit(page, "#/");

  await rowOf(page, "kept").getByRole("button", { name: "Delete kept" }).click();
  await rowOf(page, "kept").waitFor({ state: "detached" });
  await page.getByRole("button", { name: "Undo" }).click();
  await rowOf(page, "kept").waitFor();
  await page.waitForFunction(() => document.activeElement.getAttribute("aria-label") === "Delete kept");

  // By key: the focus goes on to the next run, and back when that is undone by a key.
  await page.keyboard.press("Enter");
  await rowOf(page, "kept").waitFor({ state: "detached" });
  assert.equal(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), "Delete lost");
  await page.keyboard.press("Control+z");
  await page.waitForFunction(() => document.activeElement.getAttribute("aria-label") === "Delete kept");

  await rowOf(page, "lost").getByRole("button", { name: "Delete lost" }).click();
  await rowOf(page, "lost").waitFor({ state: "detached" });
  assert.equal((await d.get(`/v1/runs/${runs[1].id}`)).status, 200); // not yet
  await page.getByRole("button", { name: "Dismiss" }).click();
  await until(async () => (await d.get(`/v1/runs/${runs[1].id}`)).status === 404, "it to be gone");
  assert.equal((await d.get(`/v1/runs/${runs[0].id}`)).status, 200);
});

test("a first visit says what this is, and shows it at a press of a button", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/");
  await page.getByText("predicts how parts on a conveyor belt jam").waitFor();
  await page.getByRole("img", { name: "A belt from above" }).waitFor();
  await page.getByRole("button", { name: "Run Example 1 in both models" }).click();
  await page.waitForURL(/#\/compare\?runs=/);
  await page.locator(".panel").nth(1).waitFor();
  const { runs } = (await d.get("/v1/runs")).json;
  assert.deepEqual(runs.map(({ model }) => model).sort(), ["macro", "micro"]);
  for (const { id } of runs) assert.ok(page.url().includes(id));
});

test("runs are found by the day on which they were accepted, and by their star", async (t) => {
  const d = await daemon(t);
  await d.submit(tiny({ name: "run of today" }));
  const page = await openPage(t, d);
  const dayOf = (later) => page.evaluate((days) => {
    const day = new Date(Date.now() + days * 86400e3);
    return [day.getFullYear(), day.getMonth() + 1, day.getDate()].map((n) => String(n).padStart(2, "0")).join("-");
  }, later);
  await visit(page, "#/");
  await rowOf(page, "run of today").waitFor();
  await page.getByLabel("From").fill(await dayOf(2));
  await page.getByText("No run matches.").waitFor();
  // The day before: the test may run at midnight.
  await page.getByLabel("From").fill(await dayOf(-1));
  await rowOf(page, "run of today").waitFor();
  await page.getByLabel("to", { exact: true }).fill(await dayOf(-2));
  await page.getByText("No run matches.").waitFor();
  await page.getByLabel("to", { exact: true }).fill(await dayOf(1));
  await rowOf(page, "run of today").waitFor();
  assert.match(page.url(), /from=\d{4}-\d\d-\d\d&to=\d{4}-\d\d-\d\d/);

  // Or by its star.
  await visit(page, "#/?starred=1");
  await page.getByText("No run matches.").waitFor();
  await page.getByRole("combobox", { name: "Show", exact: true }).selectOption("all");
  await page.getByRole("button", { name: "Star run of today" }).click();
  await page.getByRole("button", { name: "Star run of today", pressed: true }).waitFor();
  await page.getByRole("combobox", { name: "Show", exact: true }).selectOption("starred");
  await page.getByRole("link", { name: "run of today" }).click();
  await page.getByRole("button", { name: "Star", pressed: true }).click();
  await page.getByRole("button", { name: "Star", pressed: false }).waitFor();
});

test("the line as it was before is found among its versions, changed and run as the next one", async (t) => {
  const d = await daemon(t);
  const before = await d.submit(tiny({ name: "as built" }), { line: "Hall 2" });
  await d.submit(tiny({ name: "longer", duration_s: 0.2 }), { line: "Hall 2" });
  await d.submit(tiny({ name: "elsewhere" }), { line: "Hall 3" });
  const study = await d.post("/v1/studies", { name: "Which time", line: "Hall 2", base: { scenario: tiny() }, method: { type: "list" },
    parameters: [], objectives: [{ figure: "peak_density" }] });
  await d.reached(before.id, "succeeded");
  const page = await openPage(t, d);
  await visit(page, "#/lines");
  await page.getByRole("link", { name: "Hall 2", exact: true }).waitFor();
  const cells = await page.getByRole("row", { name: /Hall 2/ }).getByRole("cell").allInnerTexts();
  assert.deepEqual(cells.slice(0, 3), ["2", "2", "1"]); // versions, runs, studies
  await page.getByRole("link", { name: "Hall 2", exact: true }).click();
  await page.getByRole("link", { name: "Which time" }).waitFor();
  await page.getByRole("link", { name: "as built" }).waitFor();
  assert.deepEqual(await page.locator(".version strong, tr:not(.study) > .name > a").allInnerTexts(), ["Version 2", "longer", "Version 1", "as built"]);
  assert.equal(await page.getByText("elsewhere").count(), 0);

  await page.getByRole("link", { name: "Change and run version 1" }).click();
  await page.getByText("Ready:").waitFor();
  assert.equal(await page.getByRole("textbox", { name: "Line keeps its runs together" }).inputValue(), "Hall 2");
  await page.getByLabel("Duration").fill("0,05");
  await page.locator(".verdict", { hasText: "0.05 s" }).waitFor();
  await page.getByRole("button", { name: "Start the run" }).click();
  await page.getByRole("link", { name: "Hall 2, version 3" }).waitFor();
  await page.getByRole("button", { name: "Rename …" }).click();
  await page.getByRole("dialog").getByLabel("Line").fill("Hall 3");
  await page.getByRole("button", { name: "Keep" }).click();
  await page.getByRole("link", { name: "Hall 3, version 2" }).click();
  await page.getByRole("link", { name: "elsewhere" }).waitFor();
  // A study belongs to it, too, by the form of a new one.
  await visit(page, `#/studies/new?from=${before.id}`);
  await page.locator(".verdict", { hasText: "At most" }).waitFor();
  assert.equal(await page.locator("[name=line]").inputValue(), "Hall 2");
  await visit(page, `#/studies/${study.json.id}`);
  await page.getByRole("link", { name: "Hall 2", exact: true }).waitFor();
});

test("filters stand in the address, and pages follow the cursor there and back", async (t) => {
  const d = await daemon(t);
  for (let k = 0; k < 60; k++) await d.submit(tiny({ name: `run ${k}`, duration_s: k % 30 === 0 ? 0.2 : 0.1 }), { label: k % 20 === 0 ? "marked" : "" });
  const page = await openPage(t, d);
  await visit(page, "#/");
  await rowOf(page, "run 59").waitFor();
  assert.equal(await page.locator("tbody tr").count(), 50);
  await page.getByRole("button", { name: "Older" }).click();
  await page.getByRole("link", { name: "run 9", exact: true }).waitFor();
  assert.equal(await page.locator("tbody tr").count(), 10);
  assert.match(page.url(), /cursor=/);
  await page.getByRole("button", { name: "Newer" }).click();
  await rowOf(page, "run 59").waitFor();

  await page.locator(".total", { hasText: "60" }).waitFor();
  await page.getByLabel("Search").fill("duration > 0,15 s; cell = 0.01"); // numbers of the scenario
  await page.locator(".total", { hasText: /^2$/ }).waitFor();
  await page.waitForFunction(() => document.querySelectorAll("tbody tr").length === 2);
  await page.getByLabel("Search").fill("duration > long");
  await page.getByText('What "duration" is compared with must be a number').waitFor();
  await page.getByLabel("Search").fill("MARK"); // a part of labels
  await page.waitForFunction(() => document.querySelectorAll("tbody tr").length === 3);
  await page.locator(".total", { hasText: "3" }).waitFor();
  assert.match(page.url(), /search=MARK/);
  await page.getByRole("combobox", { name: "Model" }).selectOption("micro");
  await page.getByText("No run matches.").waitFor();
  const address = page.url();
  await visit(page, new URL(address).hash);
  await page.getByText("No run matches.").waitFor();
  assert.equal(await page.getByLabel("Search").inputValue(), "MARK");

  // By name, and the other way round; by a key figure, largest first.
  await visit(page, "#/?limit=20");
  await rowOf(page, "run 59").waitFor();
  const header = (name) => page.getByRole("columnheader", { name, exact: true });
  const firstNames = (...names) => page.waitForFunction((expected) =>
    JSON.stringify([...document.querySelectorAll(".name a")].slice(0, 3).map((a) => a.textContent)) === expected, JSON.stringify(names));
  await header("Run").getByRole("button").click();
  await firstNames("run 0", "run 1", "run 10");
  assert.equal(await header("Run").getAttribute("aria-sort"), "ascending");
  await header("Run").getByRole("button").click();
  await firstNames("run 9", "run 8", "run 7");
  await header("Age").getByRole("button").click();
  await firstNames("run 59", "run 58", "run 57");

  // Pages of twenty. Loaded again, the third one knows which the second one was.
  await visit(page, "#/?limit=20");
  const first = (k) => page.locator("tbody tr", { hasText: `run ${k}` }).first().waitFor();
  await first(59);
  await page.getByRole("checkbox", { name: "Select run 59 " }).check();
  await page.getByRole("button", { name: "Older" }).click();
  await first(39);
  await page.getByRole("button", { name: "Older" }).click();
  await first(19);
  // The bar of what is selected, which is on this page, too, covers no row beside it.
  await page.evaluate(() => scrollTo(0, 0));
  const [hit, text] = await page.evaluate(() => {
    const { left, width, top, height } = document.querySelector(".list-foot").getBoundingClientRect();
    const element = document.elementFromPoint(left + width / 2, top + height / 2);
    return [element?.closest(".list-foot") !== null, document.querySelector(".tray").innerText];
  });
  assert.equal(hit, false);
  assert.match(text, /1 selected/);
  await page.getByRole("checkbox", { name: "Select run 3 " }).check();
  await page.getByRole("button", { name: "Compare 2 runs" }).waitFor();
  await page.reload();
  await first(19);
  await page.getByRole("button", { name: "Newer" }).click();
  await first(39);
  // The browser's way back leads from page to page, too.
  await page.goBack();
  await first(19);
  await page.goBack();
  await first(39);
  await page.goBack();
  await first(59);
});

test("runs that are selected are deleted together, and come back together", async (t) => {
  const d = await daemon(t);
  for (const name of ["one", "two", "three"]) await d.submit(tiny({ name }));
  const page = await openPage(t, d);
  await visit(page, "#/");
  for (const name of ["one", "two"]) await page.getByRole("checkbox", { name: `Select ${name} ` }).check();
  await page.getByRole("group", { name: "Selected runs" }).getByRole("button", { name: "Delete" }).click();
  await page.getByText("Deleted 2 runs.").waitFor();
  await page.waitForFunction(() => document.querySelectorAll("tbody tr").length === 1);
  await page.keyboard.press("Control+z");
  await page.waitForFunction(() => document.querySelectorAll("tbody tr").length === 3);
  await page.getByRole("checkbox", { name: "Select three " }).check();
  await page.getByRole("button", { name: "New run like it" }).click();
  await page.waitForURL(/#\/new\?from=/);
});

const plate = (degrees) => ({ obstacles: [{ end_m: [0.2, 0.1], angle_deg: degrees, length_m: 0.05 }] });
const column = async (page, name) =>
  (await page.locator(`tbody td[data-label="${name}"]`).allInnerTexts()).map((text) => text.replaceAll(/\s/g, " "));

test("what runs of one scenario differ in most has columns, by which they are sorted, and the rest has chips", async (t) => {
  const d = await daemon(t);
  await d.submit(tiny({ name: "gate: at 60 degrees", ...plate(60) }));
  await d.submit(tiny({ name: "gate: at 60 degrees", ...plate(75) }));
  await d.submit(tiny({ name: "gate, angle 80°", ...plate(80), duration_s: 0.2, macro: { closure: "dispersive", cell_m: 0.02, step_s: 0.00125 } }));
  await d.submit(tiny({ name: "alone" }));
  const page = await openPage(t, d);
  await visit(page, "#/");
  const header = page.getByRole("columnheader", { name: "Angle", exact: true });
  await header.waitFor();
  assert.deepEqual(await column(page, "Angle"), ["–", "80°", "75°", "60°"]);
  assert.deepEqual(await column(page, "Duration"), ["0.1 s", "0.2 s", "0.1 s", "0.1 s"]);
  const chips = await page.locator("tbody tr").evaluateAll((rows) =>
    rows.map((row) => [...row.querySelectorAll(".chip")].map((chip) => chip.textContent.split(" ")[0])));
  assert.deepEqual(chips.map((all) => all.includes("cell")), [false, true, true, true]);
  assert.ok(chips.flat().every((word) => word !== "angle" && word !== "duration"), String(chips));

  await header.getByRole("button").click();
  await page.waitForFunction(() => document.querySelector('tbody td[data-label="Angle"]').textContent === "60°");
  assert.deepEqual(await column(page, "Angle"), ["60°", "75°", "80°", "–"]);
  assert.equal(await header.getAttribute("aria-sort"), "ascending");
  await page.reload();
  await page.waitForFunction(() => document.querySelector('tbody td[data-label="Angle"]')?.textContent === "60°");
  await header.getByRole("button").click();
  await page.waitForFunction(() => document.querySelector('tbody td[data-label="Angle"]').textContent === "80°");
  assert.deepEqual(await column(page, "Angle"), ["80°", "75°", "60°", "–"]);
});

test("a study stands between the runs of its time and opens to the runs of its trials", async (t) => {
  const d = await daemon(t);
  await d.submit(tiny({ name: "before" }));
  const study = await d.post("/v1/studies", { name: "which angle", base: { scenario: tiny({ name: "gate", ...plate(60), counters: [{ id: "start", x_m: [0, 0.08] }] }) },
    parameters: [{ pointer: "/obstacles/0/angle_deg", values: [60, 70, 80] }], method: { type: "list" },
    objectives: [{ figure: "sustained_throughput_per_h", goal: "maximize" }] });
  assert.equal(study.status, 201, study.text);
  await until(async () => (await d.get(`/v1/studies/${study.json.id}`)).json.status === "succeeded", "the end of the study");
  await d.submit(tiny({ name: "after" }));
  const page = await openPage(t, d);
  await visit(page, "#/");
  const names = () => page.locator("tbody td.name a").allInnerTexts();
  await page.getByRole("link", { name: "which angle" }).waitFor();
  assert.deepEqual(await names(), ["after", "which angle", "before"]);
  await page.getByText("3 trials").waitFor();
  const { best } = (await d.get(`/v1/studies/${study.json.id}/best`)).json;
  await page.getByText(`best: angle ${best.parameters["/obstacles/0/angle_deg"]}°, `).waitFor();

  const toggle = page.getByRole("button", { name: "Runs of the study which angle" });
  await toggle.focus();
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelectorAll("tbody .of-study").length === 3);
  assert.deepEqual(await names(), ["after", "which angle", "gate", "gate", "gate", "before"]);
  assert.equal(await toggle.getAttribute("aria-expanded"), "true");
  await page.getByRole("columnheader", { name: "Angle", exact: true }).waitFor();
  assert.deepEqual((await column(page, "Angle")).filter((text) => text !== "–").sort(), ["60°", "70°", "80°"]);
  const trials = (await d.get(`/v1/runs?study=${study.json.id}`)).json.runs;
  const rates = trials.map((run) => Math.round(run.key_figures.sustained_throughput_per_h));
  assert.ok(rates.every((rate) => rate > 0), String(rates));
  const shown = await page.locator('.of-study td[data-label="Sustained throughput"]').allInnerTexts();
  assert.deepEqual(shown.map((text) => Number(text.replaceAll(/[^\d.]/g, ""))), rates);
  // Which studies are open stands in the address.
  await page.reload();
  await page.locator(".of-study").nth(2).waitFor();
  await toggle.click();
  await page.locator(".of-study").first().waitFor({ state: "detached" });

  // Other orders and filters are of runs alone; a search finds studies by their names.
  await page.getByRole("columnheader", { name: "Run", exact: true }).getByRole("button").click();
  await page.getByRole("link", { name: "which angle" }).waitFor({ state: "detached" });
  await visit(page, "#/?search=WHICH");
  await page.getByRole("link", { name: "which angle" }).waitFor();
  assert.deepEqual(await names(), ["which angle"]);
});

async function postStudy(d, name) {
  const answer = await d.post("/v1/studies", { name, base: { scenario: tiny({ name: "gate" }) }, method: { type: "list" },
    parameters: [{ pointer: "/duration_s", values: [0.1] }], objectives: [{ figure: "content.mean" }] });
  assert.equal(answer.status, 201, answer.text);
}

test("of many studies the list shows fifty, and leads to the others", async (t) => {
  const d = await daemon(t);
  for (let k = 0; k < 51; k++) await postStudy(d, `study ${k}`);
  const page = await openPage(t, d);
  await visit(page, "#/");
  await page.getByRole("link", { name: "study 50", exact: true }).waitFor();
  assert.equal(await page.locator("tbody tr.study").count(), 50);
  await page.getByRole("link", { name: "Show older studies" }).click();
  await page.getByRole("link", { name: "study 0", exact: true }).waitFor();
  assert.equal(await page.locator("tbody tr").count(), 1);
});

test("studies of any page of the list are found, and none twice", async (t) => {
  const d = await daemon(t);
  for (let k = 0; k < 6; k++) {
    await postStudy(d, `study ${k}`);
    await d.submit(tiny({ name: `run ${k}` }));
  }
  const page = await openPage(t, d);
  await visit(page, "#/?limit=2");
  const found = [];
  for (let shown = 5; shown > 0; shown -= 2) {
    await page.getByRole("link", { name: `run ${shown}`, exact: true }).waitFor();
    found.push(...await page.locator("tbody td.name a").allInnerTexts());
    if (shown > 1) await page.getByRole("button", { name: "Older" }).click();
  }
  assert.deepEqual(found, [5, 4, 3, 2, 1, 0].flatMap((k) => [`run ${k}`, `study ${k}`]));
});

test("the page says when the daemon is away, finds it again, and the run goes on before its eyes", async (t) => {
  const d = await daemon(t, { checkpoint_ms: 50 });
  const page = await openPage(t, d);
  const run = await d.submit({ ...jam(60_000, { curve_every_s: 1, snapshot_every_s: 4 }), name: "interrupted" });
  const pictures = () => page.locator(".transport input").evaluate((slider) => Number(slider.max));
  await visit(page, `#/runs/${run.id}`);
  await page.locator(".pill", { hasText: "running" }).waitFor();
  await page.waitForFunction(() => Number(document.querySelector(".transport input").value) > 0);

  await d.kill();
  await page.getByText("The server does not answer. Trying again").waitFor();
  const before = await pictures();
  d.settings.listen = `127.0.0.1:${d.port}`;
  const back = page.getByText("The server is back.").waitFor(); // shown for some seconds only
  await d.start();
  await back;
  await until(async () => (await pictures()) > before, "more pictures");
  assert.equal(await page.locator("#connection").innerText(), "");
  await d.post(`/v1/runs/${run.id}/cancel`, "");
  await page.locator(".pill", { hasText: "cancelled" }).waitFor();
  await page.getByText("Parts at start").waitFor();
  const { length } = (await d.get(`/v1/runs/${run.id}/snapshots`)).json.snapshots;
  await page.keyboard.press("End");
  const text = await page.locator(".clock").innerText();
  assert.match(text, /^(\S+) \/ \1 s$/, `${text} of ${length} snapshots`);
});

test("a run that ended while the daemon was away is shown with its results", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  const run = await d.submit(endless());
  await visit(page, `#/runs/${run.id}`);
  await page.locator(".pill", { hasText: "running" }).waitFor();

  await page.context().setOffline(true);
  await d.post(`/v1/runs/${run.id}/cancel`, "");
  await d.reached(run.id, "cancelled");
  await page.getByText("The server does not answer. Trying again").waitFor();
  await page.context().setOffline(false);
  await page.locator(".pill", { hasText: "cancelled" }).waitFor();
  await page.getByText("Parts at start").waitFor();
});
