// Studies on the page: begun by the form, watched while they are made, paused, resumed and cancelled; points open their run.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test, { after } from "node:test";

import { assertAccessible, closeBrowser, editText, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { fed, jam } from "./scenarios.mjs";
import { until } from "./setup.mjs";

after(closeBrowser);

// A plate at the wall that ends at (0.75, 0.5) and leaves 0.1 m free.
function plate(duration_s, changes = {}) {
  const scenario = jam(duration_s, { curve_every_s: 0.05, snapshot_every_s: duration_s });
  const length_m = 0.5 / Math.sin(Math.PI / 3);
  return { ...scenario, name: "a plate", obstacles: [{ end_m: [0.75, 0.5], angle_deg: 60, length_m }], ...changes };
}

async function begin(d, document) {
  const answer = await d.post("/v1/studies", document);
  assert.equal(answer.status, 201, answer.text);
  return answer.json.id;
}

test("several runs of each are begun in the form, and stand together", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?tab=json&model=micro");
  await page.getByText("Ready:").waitFor();
  const { photo_eyes: eyes, actions, obstacles, ...free } = fed();
  await editText(page, JSON.stringify({ ...free, duration_s: 4, feeds: [{ ...free.feeds[0], arrivals: "poisson" }] }));
  await page.getByLabel("Runs of each").fill("3");
  await page.getByText("Ready:").waitFor();
  await page.getByRole("button", { name: "Start the run" }).click();
  await page.waitForURL(/#\/studies\/[0-9a-f-]+$/);
  await page.getByRole("heading", { name: "All runs together" }).waitFor();
  await page.getByText(/± .* parts\/h is the mean of 3 runs/).waitFor();
  await page.getByText(/^Nothing left for a while in 0 of 3 runs/).waitFor();
});

test("a study is begun by the form, shows what it finds, and its points open their runs", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(plate(0.5));
  const page = await openPage(t, d);
  await visit(page, "#/studies");
  await page.getByText("No studies yet.").waitFor();
  await visit(page, `#/studies/new?from=${run.id}`);
  await page.locator("[name=parameter]").selectOption("angle");
  await page.locator("[name=from]").fill("60");
  await page.locator("[name=to]").fill("90");
  await page.locator("[name=steps]").fill("4");
  await page.locator("[name=figure]").selectOption("Parts inside, mean, of upstream");
  assert.equal(await page.locator("[name=name]").inputValue(), "Parts inside, mean, of upstream, angle 60 to 90°");
  await page.getByText("At most 4 runs").waitFor();
  await page.getByRole("button", { name: "Start the study" }).click();

  await page.locator(".pill", { hasText: "succeeded" }).waitFor();
  const points = page.locator(".study-point");
  await page.waitForFunction(() => document.querySelectorAll(".study-point").length === 4);
  const id = /studies\/([^?]*)/.exec(page.url())[1];
  const stored = (await d.get(`/v1/studies/${id}/document`)).json;
  // The plate reaches the wall at each angle: at 60 degrees it is longest.
  assert.ok(Math.abs(stored.base.scenario.obstacles[0].length_m - 0.5 / Math.sin(Math.PI / 3)) < 1e-6);
  const { best } = (await d.get(`/v1/studies/${id}/best`)).json;
  await page.locator(".best-words", { hasText: `angle ${best.parameters["/obstacles/0/angle_deg"]}°` }).waitFor();
  await page.getByText("the microscopic model has not confirmed it").waitFor();
  assert.equal(await page.locator(".study-point.best").count(), 1);
  const [file] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Trials as CSV" }).click()]);
  assert.equal(readFileSync(await file.path(), "utf8"), (await d.get(`/v1/studies/${id}/trials?format=csv`)).text);
  const [drawing] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save the curves as SVG" }).click()]);
  assert.match(drawing.suggestedFilename(), /against-angle\.svg$/);
  assert.equal(readFileSync(await drawing.path(), "utf8").match(/<circle /g).length, 4);
  const [picture] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save the plot as PNG" }).click()]);
  assert.match(picture.suggestedFilename(), /against-angle\.png$/);

  // Trials are not in the list of runs; the one that is opened is.
  assert.deepEqual((await d.get("/v1/runs")).json.runs.map((one) => one.id), [run.id]);
  await points.nth(1).focus();
  await page.keyboard.press("Enter");
  await page.waitForURL(/#\/runs\//);
  const opened = /runs\/([^?]*)/.exec(page.url())[1];
  const { obstacles } = (await d.get(`/v1/runs/${opened}/scenario`)).json;
  const [[x0, y0], [x1, y1]] = obstacles[0].path_m;
  assert.ok(Math.abs(Math.atan2(y1 - y0, x1 - x0) - (70 * Math.PI) / 180) < 1e-6);
  await visit(page, `#/studies/${id}`);
  await page.getByRole("button", { name: "Solve these 4 again and show" }).click();
  await page.getByRole("link", { name: "angle 90°, open the run" }).waitFor();
  await page.waitForFunction(() => [...document.querySelectorAll(".pictures img")].filter((image) => image.naturalWidth > 0).length === 4);
  // A trial has no pictures, and so none to be played.
  await page.getByRole("link", { name: "Its runs" }).click();
  await page.locator("td.name a").first().click();
  await page.getByText("Trials keep no snapshots: press its point in the study.").waitFor();
  assert.ok(await page.getByRole("button", { name: "Play", exact: true }).isDisabled());
  await visit(page, "#/studies");
  await page.getByRole("link", { name: "Parts inside, mean" }).waitFor();
  await page.getByRole("cell", { name: "4 trials" }).waitFor();
});

test("several parameters are varied in the form, and two figures are weighed against each other", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(plate(0.5));
  const page = await openPage(t, d);
  await visit(page, `#/studies/new?from=${run.id}`);
  const [first, second] = [1, 2].map((k) => page.getByRole("group", { name: `Parameter ${k}` }));
  await first.getByLabel("Parameter").selectOption("angle");
  await page.getByRole("button", { name: "Vary another one, too" }).click();
  await second.getByLabel("Parameter").selectOption("tip y");
  await page.getByText("At most 18 runs").waitFor(); // 6 angles by 3 tips
  // However many there are, the name that says them is as long as a name may be.
  const more = page.getByRole("button", { name: "Vary another one, too" });
  while (await more.isVisible()) await more.click();
  const named = Buffer.byteLength(await page.locator("[name=name]").inputValue());
  assert.ok(named > 95 && named <= 100, `${named} bytes`);
  while (await page.getByRole("group", { name: "Parameter 3" }).count() > 0) await page.getByRole("group", { name: "Parameter 3" }).getByRole("button").click();

  // A grid of listed angles by heights in equal ratios.
  await first.getByLabel("Spread").selectOption("as listed");
  await first.locator("[name=values]").fill("60 62.5 75 90");
  await second.getByLabel("Spread").selectOption("in equal ratios");
  await page.getByText("At most 12 runs").waitFor();
  const sent = page.waitForRequest((request) => request.url().endsWith("/v1/studies") && request.method() === "POST");
  await page.route("**/v1/studies", (route) => route.abort(), { times: 1 });
  await page.getByRole("button", { name: "Start the study" }).click();
  assert.deepEqual((await sent).postDataJSON().parameters, [{ pointer: "/obstacles/0/angle_deg", values: [60, 62.5, 75, 90] },
    { pointer: "/obstacles/0/end_m/1", range: [0.45, 0.55], scale: "log", steps: 3 }]);
  await second.getByLabel("Spread").selectOption("evenly");

  await page.locator("[name=method]").selectOption("Listed values");
  await first.locator("[name=values]").fill("60 75 90");
  await second.locator("[name=values]").fill("0.45 0.5");
  await page.getByText("Values: each parameter needs as many as the others, not 3 and 2").waitFor();
  await second.locator("[name=values]").fill("0.45 0,5 five");
  await page.getByText("Values: must be a number").waitFor();
  await second.locator("[name=values]").fill("0.45 0.5 0.55");
  await page.getByText("At most 3 runs").waitFor();
  await assertAccessible(page, "several parameters");

  await page.locator("[name=method]").selectOption("Spread evenly");
  await page.locator("[name=points]").fill("5");
  await page.locator("[name=figure]").selectOption("Parts inside, mean, of upstream");
  await page.locator("[name=second]").selectOption("Peak density");
  await first.getByLabel("From").fill("60");
  await second.getByLabel("From").fill("0.45");
  await second.getByLabel("To").fill("0.55");
  assert.equal(await page.locator("[name=name]").inputValue(), "Parts inside, mean, of upstream, angle 60 to 90°, tip y 0.45 to 0.55 m");
  await page.getByText("At most 5 runs").waitFor();
  await page.getByRole("button", { name: "Start the study" }).click();
  await page.locator(".pill", { hasText: "succeeded" }).waitFor();
  const id = /studies\/([^?]*)/.exec(page.url())[1];
  const { base, parameters, method, objectives } = (await d.get(`/v1/studies/${id}/document`)).json;
  assert.deepEqual([method.type, method.points], ["sobol", 5]);
  assert.deepEqual(parameters.map(({ pointer, range }) => [pointer, range]), [["/obstacles/0/angle_deg", [60, 90]], ["/obstacles/0/end_m/1", [0.45, 0.55]]]);
  assert.deepEqual(objectives.slice(0, 2).map(({ figure }) => figure), ["content.mean", "peak_density"]);
  // Its foot stays behind the wall for the highest tip at the least angle.
  assert.ok(Math.abs(base.scenario.obstacles[0].length_m - 0.55 / Math.sin(Math.PI / 3)) < 1e-6);

  await page.getByRole("combobox", { name: "Against" }).selectOption("Peak density");
  await page.getByRole("heading", { name: "Parts inside, mean, of upstream against Peak density" }).waitFor();
  const { front } = (await d.get(`/v1/studies/${id}/best`)).json;
  assert.equal(await page.locator(".study-point").count(), 5);
  assert.equal(await page.locator(".study-point.front").count(), front.length);
  await page.getByText("no other is better in both").waitFor();
  await page.reload();
  await page.getByRole("heading", { name: "against Peak density" }).waitFor();
});

test("a study is paused, resumed, cancelled and deleted", async (t) => {
  const d = await daemon(t);
  const id = await begin(d, { name: "long", base: { scenario: plate(0.5) }, method: { type: "grid" }, objectives: [{ figure: "content.mean" }],
    parameters: [{ pointer: "/obstacles/0/angle_deg", range: [60, 90], steps: 2000 }] });
  const page = await openPage(t, d);
  await visit(page, `#/studies/${id}`);
  await page.locator(".study-point").nth(1).waitFor();
  await page.getByRole("button", { name: "Pause" }).click();
  await page.locator(".pill", { hasText: "paused" }).waitFor();
  const count = (await d.get(`/v1/studies/${id}`)).json.trials.succeeded;
  await page.getByRole("button", { name: "Resume" }).click();
  await until(async () => (await d.get(`/v1/studies/${id}`)).json.trials.succeeded > count, "further trials");
  await page.getByRole("button", { name: "Cancel" }).click();
  await page.locator(".pill", { hasText: "cancelled" }).waitFor();
  assert.equal(await page.getByRole("button", { name: "Resume" }).isVisible(), false);
  await page.getByRole("button", { name: "Delete" }).click();
  await page.getByText("No studies yet.").waitFor();
  assert.equal((await d.get(`/v1/studies/${id}`)).status, 404);
});

test("a range goes up, also of a speed against an axis, and one that does not is refused at its end", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/studies/new?example=merge");
  await page.locator("[name=parameter]").selectOption("side belt speed");
  // 30 % around -0.4 m/s.
  const [from, to] = ["from", "to"].map((name) => page.locator(`[name=${name}]`));
  assert.deepEqual([await from.inputValue(), await to.inputValue()], ["-0.52", "-0.28"]);
  await to.fill("-0.52");
  await page.getByRole("button", { name: "Start the study" }).click();
  await page.getByRole("status").getByText("To: must be greater than From").waitFor();
  assert.deepEqual((await d.get("/v1/studies")).json.studies, []);
  // Nor does a prediction that was asked for before take the refusal's place.
  let release;
  const held = new Promise((resolve) => (release = resolve));
  await page.route("**/v1/validate", async (route) => {
    await held;
    await route.continue();
  }, { times: 1 });
  const asked = page.waitForRequest("**/v1/validate");
  await to.fill("-0.45");
  await asked;
  await to.fill("-0.52");
  const answered = page.waitForResponse("**/v1/validate");
  release();
  await (await answered).finished();
  await page.evaluate(() => new Promise((seen) => setTimeout(seen, 100)));
  assert.equal(await page.locator(".verdict").textContent(), "To: must be greater than From");
  await to.fill("-0.5");
  await page.getByText("At most 18 runs").waitFor(); // 6 speeds, 3 runs of each
});

test("a method can be chosen before the scenario is read", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  let read;
  await page.route("**/v1/examples/*", async (route) => {
    await new Promise((resolve) => (read = resolve));
    await route.continue();
  });
  await visit(page, "#/studies/new");
  await page.locator("[name=method]").selectOption("Fit to counts");
  await page.getByRole("button", { name: "Start the study" }).click();
  await page.getByRole("status").getByText("From: ").waitFor();
  assert.equal(await page.locator("[name=parameter] option").count(), 0);
  read();
  await page.locator("[name=parameter]").selectOption("belt speed");
  assert.equal(await page.locator("[name=method] option:checked").innerText(), "Fit to counts");
});

test("what both models say of the best points, and how a fit agrees with the counts", async (t) => {
  const d = await daemon(t);
  const scenario = plate(2, { micro: { integrator: "implicit", modulus_reduction: 1e4 } });
  scenario.initial.hexagonal = { ...scenario.initial.hexagonal, rows: 4, columns: 4, first_m: [0.5, 0.4] };
  const parameters = [{ pointer: "/obstacles/0/angle_deg", range: [60, 90], steps: 4 }];
  const screened = await begin(d, { base: { scenario }, parameters, objectives: [{ figure: "content.mean" }], replications: 2,
    method: { type: "screen", sweep: "grid", confirm: 2, indifference: 0.1 }, limits: { trials: 20 } });
  const page = await openPage(t, d);
  await visit(page, `#/studies/${screened}`);
  await page.getByText(/^The microscopic model compared angle \d+, \d+ with each other, by 1 run each\./).waitFor();
  await page.getByRole("rowheader", { name: "may be best" }).waitFor();
  await page.getByRole("rowheader", { name: "worse" }).waitFor();

  const run = await d.submit(scenario);
  await d.reached(run.id, "succeeded");
  const curve = (await d.get(`/v1/runs/${run.id}/curve`)).json;
  await visit(page, `#/studies/new?from=${run.id}`);
  await page.locator("[name=method]").selectOption("Fit to counts");
  await page.locator("[name=parameter]").selectOption("belt speed");
  await page.locator("[name=trials]").fill("6");

  // Nothing is stored yet; a file that lacks a count is refused with its line, and taken once it is mended.
  const start = page.getByRole("button", { name: "Start the study" });
  const counts = page.locator("[name=counts]");
  const file = page.getByLabel("Add counts from a file");
  const said = page.getByRole("alert");
  const comma = (number) => String(number).replace(".", ",");
  const lines = ["Zeit;Teile", ...curve.t_s.map((time, k) => `${comma(time)};${comma(curve.columns.upstream[k])}`)];
  const hall = (text) => ({ name: "hall.csv", mimeType: "text/csv", buffer: Buffer.from(text.join("\r\n")) });
  await page.getByText("No counts are stored yet.").waitFor();
  assert.equal(await counts.isVisible(), false);
  await start.click();
  await said.getByText("A fit needs counts").waitFor();
  assert.ok(await file.evaluate((box) => box === document.activeElement), "the way on has the focus");
  await file.setInputFiles(hall([...lines.slice(0, 2), "0,05;", ...lines.slice(3)]));
  await said.getByText("hall.csv: Line 3: “0,05” is not a time and a number of parts.").waitFor();
  await assertAccessible(page, "counts at fault");
  await file.setInputFiles(hall(lines));
  await said.getByText("hall.csv is stored and chosen.").waitFor();
  assert.equal(await counts.locator("option:checked").innerText(), "hall.csv");
  await start.click();
  await page.locator(".pill", { hasText: "succeeded" }).waitFor();
  const id = /studies\/([^?]*)/.exec(page.url())[1];
  assert.deepEqual((await d.get(`/v1/studies/${id}/document`)).json.curves, [{ counter: "upstream", t_s: curve.t_s, count: curve.columns.upstream }]);
  await page.locator(".fit .plot-legend", { hasText: "computed" }).waitFor();
  await page.getByRole("row", { name: /^belt speed .* m\/s/ }).waitFor();

  // Parts that left are counts, too: what was counted follows from the counts that are chosen.
  const left = await d.post("/v1/measurements", { label: "at the end", counter: "left_domain", t_s: curve.t_s, count: curve.columns.left_domain.map((n) => Math.max(0, n)) });
  assert.equal(left.status, 201, left.text);
  await visit(page, `#/studies/new?from=${run.id}`);
  await page.locator("[name=method]").selectOption("Fit to counts");
  await counts.selectOption("hall.csv");
  assert.equal(await page.locator("[name=counter]").inputValue(), "upstream");
  await counts.selectOption("at the end");
  assert.equal(await page.locator("[name=counter]").inputValue(), "left_domain");
  await page.locator("[name=trials]").fill("4");
  await start.click();
  await page.locator(".pill", { hasText: "succeeded" }).waitFor();
  const other = /studies\/([^?]*)/.exec(page.url())[1];
  assert.deepEqual((await d.get(`/v1/studies/${other}/document`)).json.curves, [{ counter: "left_domain", t_s: left.json.t_s, count: left.json.count }]);
});

test("what a study advises is made by a button, and a report of it stands alone", async (t) => {
  const d = await daemon(t);
  const id = await begin(d, { name: "Where the foot stands", base: { scenario: jam(0.5) }, method: { type: "grid" },
    parameters: [{ pointer: "/obstacles/0/from_m/0", range: [0.4, 0.7], steps: 4 }], objectives: [{ figure: "peak_density" }] });
  const page = await openPage(t, d);
  await visit(page, `#/studies/${id}`);
  const advised = page.getByRole("button", { name: /^Study [\d.]+ to [\d.]+$/ });
  await advised.waitFor();
  const [file] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save report" }).click()]);
  assert.equal(file.suggestedFilename(), "where-the-foot-stands.html");
  const html = readFileSync(await file.path(), "utf8");
  assert.match(html, /<h1>Where the foot stands<\/h1>/);
  assert.match(html, /The best point is at the edge of the range/);
  assert.match(html, /<img alt="" src="data:image\/png;base64,/);
  assert.doesNotMatch(html, /<(?:button|script|canvas)|src="(?!data:)/);
  const { verdicts } = (await d.get(`/v1/studies/${id}/best`)).json;
  const { figures } = verdicts.find(({ kind }) => kind === "edge");
  await advised.click();
  await page.waitForURL((url) => /#\/studies\/[0-9a-f-]+$/.test(url.hash) && !url.hash.endsWith(id));
  const made = (await d.get(`/v1/studies/${/[0-9a-f-]+$/.exec(page.url())[0]}/document`)).json;
  assert.deepEqual(made.parameters[0].range, ["try_from", "try_to"].map((name) => figures.find(({ figure }) => figure === name).value));
});
