// One's own line, drawn on the board, and one's own numbers.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import test, { after } from "node:test";

import { assertAccessible, closeBrowser, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { tiny } from "./scenarios.mjs";

after(closeBrowser);

const scenarioIn = (page) => page.evaluate(() => JSON.parse(localStorage.getItem("beltflow-lines"))[0].scenario);

test("a line is made from nothing, without JSON, and solved in both models", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  await page.getByLabel("Goods").selectOption("pet-500");
  await page.getByLabel("Line, along x").fill("1.5");
  await page.getByLabel("Line, along y").fill("0.5");
  await page.getByLabel("Warm-up").fill("0");
  await page.getByLabel("Duration").fill("1");
  await page.getByRole("button", { name: "+ Deflector" }).click();
  const thing = page.getByRole("region", { name: "What is chosen" });
  await thing.getByRole("heading", { name: "Plate plate-1" }).waitFor();
  await thing.getByLabel("Angle").fill("50");
  await thing.getByLabel("End, x").fill("1,2");
  await page.getByRole("button", { name: "Feed feed-1" }).click();
  await thing.getByLabel("Rate").fill("20");
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  const { obstacles, feeds, domain, cargo, name } = await scenarioIn(page);
  assert.deepEqual(domain, { x_m: [0, 1.5], y_m: [0, 0.5] });
  assert.equal(cargo.goods, "pet-500");
  assert.equal(name, "My line");
  // 70 % of the width by default; it is turned about its end, and its foot stays at the side: 0.35 m / sin 50 degrees.
  assert.deepEqual(obstacles, [{ id: "plate-1", end_m: [1.2, 0.35], angle_deg: 50, length_m: 0.456892551 }]);
  assert.deepEqual(feeds, [{ id: "feed-1", edge: "west", rate_per_s: 20, arrivals: "poisson" }]);
  await page.getByRole("button", { name: "Run both models" }).click();
  await page.waitForURL(/#\/compare\?runs=/);
  // Above all numbers stands what the server says of the two.
  await page.locator('.pill[data-state="succeeded"]').nth(1).waitFor();
  const [, a, b] = /runs=([^,&]+),([^,&]+)/.exec(decodeURIComponent(page.url()));
  const [{ text }] = (await d.get(`/v1/compare?a=${a}&b=${b}`)).json.verdicts;
  await page.locator(".verdict", { hasText: text.slice(0, 20) }).first().waitFor();
});

test("what was drawn is undone by keys, outlasts a reload, and goes into a file and back", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  await page.getByRole("button", { name: "+ Guide" }).click();
  const whole = page.getByRole("button", { name: /^plate-1, as a whole/ });
  await whole.focus();
  await page.keyboard.press("ArrowUp"); // by 0.01 m
  const plate = async () => (await scenarioIn(page)).obstacles?.[0];
  // 10 to 90 % of 2 m, at 30 % of 0.6 m.
  assert.deepEqual(await plate(), { id: "plate-1", from_m: [0.2, 0.19], to_m: [1.8, 0.19] });
  await page.getByRole("button", { name: "Undo" }).focus();
  await page.keyboard.press("ControlOrMeta+z");
  assert.deepEqual((await plate()).from_m, [0.2, 0.18]);
  await page.keyboard.press("ControlOrMeta+z");
  assert.equal(await plate(), undefined);
  assert.equal(await page.getByRole("button", { name: "Undo" }).isDisabled(), true);
  await page.getByRole("button", { name: "Redo" }).click();
  await page.getByRole("button", { name: "Redo" }).click();
  assert.deepEqual((await plate()).from_m, [0.2, 0.19]);

  await page.reload();
  await page.getByText("Ready:").waitFor();
  await page.getByRole("button", { name: "Plate plate-1" }).waitFor();
  const [file] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save as a file" }).click()]);
  assert.equal(file.suggestedFilename(), "my-line.json");
  const saved = JSON.parse(readFileSync(await file.path(), "utf8"));
  assert.deepEqual(saved, await scenarioIn(page));
  await page.getByLabel("Open a file").setInputFiles({ name: "other.json", mimeType: "application/json",
    buffer: Buffer.from(JSON.stringify({ ...saved, name: "Other", obstacles: [] })) });
  await page.getByRole("button", { name: "Plate plate-1" }).waitFor({ state: "detached" });
  assert.equal(await page.getByLabel("Name").inputValue(), "Other");
});

test("things are doubled, mirrored, turned and deleted; rules are told in words and follow other ids", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  assert.equal(await page.getByRole("button", { name: "+ Rule" }).isDisabled(), true);
  const press = (name) => page.getByRole("button", { name, exact: true }).click();
  for (const name of ["+ Deflector", "Double", "Mirror", "+ Photo eye", "+ Rule"]) await press(name);
  await page.getByRole("button", { name: "Rule When eye-1 is blocked: stop belt-1" }).waitFor();
  // 75 % of 2 m and 70 % of 0.6 m; the double stands 0.1 m farther, and its image in the line y = 0.3 m ends at 0.18 m.
  const { obstacles } = await scenarioIn(page);
  assert.deepEqual(obstacles.map(({ id, end_m: end, angle_deg: angle }) => [id, end, angle]), [["plate-1", [1.5, 0.42], 60], ["plate-2", [1.6, 0.18], -60]]);
  const thing = page.getByRole("region", { name: "What is chosen" });
  await page.getByRole("button", { name: "Belt belt-1" }).click();
  await thing.getByLabel("Id").fill("infeed");
  await page.getByRole("button", { name: "Rule When eye-1 is blocked: stop infeed" }).waitFor();
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();

  // What is typed into a folded box arrives letter by letter, and stays where it is.
  await page.getByRole("button", { name: /^Rule/ }).click();
  await thing.getByText("More", { exact: true }).click();
  await thing.getByLabel("Delay").pressSequentially("12.5");
  assert.equal(await thing.getByLabel("Delay").inputValue(), "12.5");
  await page.getByRole("button", { name: "Rule When eye-1 is blocked for 12.5 s: stop infeed" }).waitFor();
  await thing.getByLabel("Kind").selectOption("cargo");
  await page.getByRole("button", { name: "Rule When eye-1 sees cargo, 12.5 s later: stop infeed" }).waitFor();
  await thing.getByLabel("Kind").selectOption("");
  await page.getByRole("button", { name: "Plate plate-2" }).click();
  await thing.getByText("More", { exact: true }).click();
  await thing.getByRole("button", { name: "Give motion" }).click();
  await thing.getByLabel("T", { exact: true }).pressSequentially("0; 4; 5");
  await thing.getByLabel("Turn", { exact: true }).pressSequentially("0; 0; -30");
  assert.deepEqual((await scenarioIn(page)).obstacles[1].motion, { t_s: [0, 4, 5], turn_deg: [0, 0, -30] });
  await thing.getByRole("button", { name: "Without motion" }).click();

  // A pusher goes to and fro across the belt.
  await press("+ Pusher");
  const { motion } = (await scenarioIn(page)).obstacles.at(-1);
  assert.deepEqual(motion.shift_m.map(([x]) => x), [0, 0, 0, 0, 0]);
  assert.ok(motion.shift_m[2][1] > 0);
  assert.equal(Number(await thing.getByLabel("Shift 3, y").inputValue()), motion.shift_m[2][1]);
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  await press("Delete");

  // A sink over 70 to 80 % of the line is drawn, moved by 0.01 m and gets a rate.
  await press("+ Sink");
  await page.getByRole("button", { name: /^sink-1, as a whole/ }).focus();
  await page.keyboard.press("ArrowRight");
  await thing.getByText("More", { exact: true }).click();
  await thing.getByLabel("Rate").fill("2.5");
  assert.deepEqual((await scenarioIn(page)).sinks,
    [{ id: "sink-1", polygon_m: [[1.41, 0], [1.61, 0], [1.61, 0.6], [1.41, 0.6]], rate_per_s: 2.5 }]);
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  await press("Delete");
  assert.equal((await scenarioIn(page)).sinks, undefined);

  // A beam across the belt at 1.2 m, turned about its middle, lies along it; without its eye the rule has a fault.
  await page.getByRole("button", { name: "Photo eye eye-1" }).click();
  await press("Turn by 90°");
  assert.deepEqual((await scenarioIn(page)).photo_eyes[0].line_m, [[1.5, 0.3], [0.9, 0.3]]);
  await press("Delete");
  const rule = page.locator(".things li", { hasText: "When eye-1 is blocked" });
  await rule.locator(".fault").waitFor();
  await page.getByText("1 fault to mend").waitFor();
  await rule.getByRole("button").click();
  await press("Delete");
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();

  // A merge of the two belts, at the end of which are the eyes, is told in words and follows other ids.
  assert.equal(await page.getByRole("button", { name: "+ Merge" }).isDisabled(), true);
  for (const name of ["+ Belt", "+ Photo eye", "+ Photo eye", "+ Merge"]) await press(name);
  await page.getByRole("button", { name: "Merge merge-1: infeed, belt-1 in turn, 1 part each" }).waitFor();
  await thing.getByText("More", { exact: true }).click();
  await thing.getByLabel("Order").selectOption("priority");
  await thing.getByLabel("Parts").fill("5");
  await page.getByRole("button", { name: "Merge merge-1: infeed, belt-1 by priority, 5 parts each" }).waitFor();
  await page.getByRole("button", { name: "Photo eye eye-2" }).click();
  await thing.getByLabel("Id").fill("waits");
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  assert.deepEqual((await scenarioIn(page)).merges,
    [{ id: "merge-1", lanes: [{ belt: "infeed", photo_eye: "eye-1" }, { belt: "belt-1", photo_eye: "waits" }], order: "priority", parts: 5 }]);
  await assertAccessible(page, "the board");
});

test("a box that is emptied is typed on in, also where it is folded away then", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  await page.getByRole("button", { name: "Feed feed-1" }).click();
  const id = page.getByLabel("Id", { exact: true });
  await id.focus();
  for (let k = 0; k < "feed-1".length; k++) await page.keyboard.press("Backspace");
  await page.keyboard.type("infeed");
  await page.getByRole("button", { name: "Feed infeed" }).waitFor();
  assert.equal(await id.inputValue(), "infeed");
});

test("curves and figures are saved as the reader's spreadsheet opens them", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny());
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d, { locale: "de-DE" });
  await visit(page, `#/runs/${run.id}`);
  const link = page.getByRole("link", { name: "Curve, CSV 1,5" });
  const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
  const [head, first, second] = readFileSync(await download.path(), "utf8").split("\r\n");
  assert.match(head, /^\uFEFFt_s;/);
  assert.match(first, /^0;0,9\d+;/);
  assert.match(second, /^0,01/);
});

test("a decimal comma is read, and what may mean two numbers is refused", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d, { locale: "de-DE" });
  await visit(page, "#/new?example=example-1");
  await page.getByText("Ready:").waitFor();
  await page.getByLabel("Deflector angle").fill("62,5");
  await page.getByText("Ready:").waitFor();
  assert.equal((await scenarioIn(page)).obstacles[0].angle_deg, 62.5);
  await page.getByLabel("Duration").fill("1.010");
  await page.locator("#duration-fault", { hasText: "may mean 1.01 or 1010: write 1.01 or 1010" }).waitFor();
  assert.equal((await scenarioIn(page)).duration_s, 6);
  await page.getByLabel("Duration").fill("6,0");

  await page.getByRole("button", { name: "Study …" }).click();
  await page.locator("[name=from]").fill("45,5");
  await page.getByText("At most 6 runs").waitFor();
  assert.match(await page.locator("[name=name]").inputValue(), /angle 45\.5 to 90°/);
  await page.locator("[name=to]").fill("neunzig");
  await page.getByText("To: must be a number").waitFor();
});

test("a gate across the belt is opened in the form, and a run of it is started", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?example=photo-eye");
  await page.getByText("Ready:").waitFor();
  await page.getByLabel("Duration").fill("1");
  await page.locator("#warmup-fault", { hasText: "must be shorter than duration_s" }).waitFor();
  await page.getByLabel("Warm-up").fill("0");
  await page.getByText("1 s. Closure").waitFor();
  await page.getByRole("button", { name: "Start the run" }).click();
  await page.waitForURL(/#\/runs\//);
});

test("counts are pasted as a spreadsheet copies them, and how they are read is said first", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/example-1")).json;
  const run = await d.submit({ ...example, duration_s: 0.05 });
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d, { locale: "de-DE" });
  await visit(page, `#/compare?runs=${run.id}&column=upstream`);
  await page.getByRole("button", { name: "Paste counts" }).click();
  const dialog = page.getByRole("dialog");
  const use = dialog.getByRole("button", { name: "Use these counts" });
  const text = dialog.getByRole("textbox");
  await text.fill("50\t1.010\n60\t1.100");
  await dialog.getByText("It is not clear whether").waitFor();
  assert.ok(await use.isDisabled());
  await text.fill("50,5\t1.010\n60,0\t1.100");
  await dialog.getByText("2 samples: 50.5 s, 1,010 parts; 60 s, 1,100 parts").waitFor();
  await text.fill("06:00\t12\n06:01\t8\n06:02:30\t10");
  await dialog.getByText("3 samples: 0 s, 12 parts; 60 s, 8 parts; … 150 s, 10 parts").waitFor();
  await dialog.getByRole("combobox").selectOption("in");
  await dialog.getByText("3 samples: 0 s, 12 parts; 60 s, 20 parts; … 150 s, 30 parts").waitFor();
  await assertAccessible(page, "pasted counts");
  await use.click();
  await page.getByText("pasted counts · upstream").waitFor();
  const { measurements: [{ id }] } = (await d.get("/v1/measurements")).json;
  const { t_s: times, count } = (await d.get(`/v1/measurements/${id}`)).json;
  assert.deepEqual([times, count], [[0, 60, 150], [12, 20, 30]]);

  // The clock of the counts began elsewhere: what is shifted is stored beside.
  await page.getByRole("button", { name: "Shift …" }).click();
  const shift = page.getByRole("dialog", { name: "Shift pasted counts in time" });
  await shift.getByText(/^Fewer than two samples are within/).waitFor();
  await shift.getByRole("button", { name: "Fit" }).click();
  await shift.getByLabel("Later by").fill("-1,5");
  await assertAccessible(page, "a shift in time");
  await shift.getByRole("button", { name: "Shift the counts" }).click();
  await page.getByText("pasted counts, 1.5 s earlier · upstream").waitFor();
  const { measurements: [moved] } = (await d.get("/v1/measurements")).json;
  assert.deepEqual((await d.get(`/v1/measurements/${moved.id}`)).json.t_s, [-1.5, 58.5, 148.5]);
  assert.match(page.url(), new RegExp(`measured=${moved.id}`));

  // The run as a line, the counts as a dot each.
  const [drawing] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save the curves as SVG" }).click()]);
  assert.equal(drawing.suggestedFilename(), "curves-of-the-runs.svg");
  const shapes = await page.evaluate((text) => {
    const svg = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
    return [svg.localName, ...["polyline", "circle"].map((name) => svg.querySelectorAll(name).length), svg.textContent.includes("pasted counts, 1.5 s earlier")];
  }, readFileSync(await drawing.path(), "utf8"));
  assert.deepEqual(shapes, ["svg", 1, 3, true]);
  const [picture] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save the plot as PNG" }).click()]);
  assert.equal(picture.suggestedFilename(), "curves-of-the-runs.png");
  const png = readFileSync(await picture.path());
  assert.equal(png.subarray(1, 4).toString(), "PNG");
  const seen = await page.locator(".plot canvas").first().evaluate(({ width, height }) => [width, height]);
  assert.ok(png.readUInt32BE(16) > seen[0] && png.readUInt32BE(20) > seen[1], "the drawing, and what its curves are");
});

test("a run is renamed and noted on, and its address and the list say so", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(tiny({ name: "before" }));
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d);
  await visit(page, `#/runs/${run.id}`);
  await page.getByRole("button", { name: "Rename" }).click();
  const dialog = page.getByRole("dialog", { name: "What it is called" });
  await dialog.getByLabel("Name").fill("hall 2, monday");
  await dialog.getByLabel("Notes").fill("plate as built");
  await assertAccessible(page, "another name");
  await dialog.getByRole("button", { name: "Keep" }).click();
  await page.getByRole("heading", { name: "hall 2, monday" }).waitFor();
  await page.getByText("plate as built").waitFor();
  await visit(page, "#/?search=monday");
  await page.getByRole("link", { name: "hall 2, monday" }).waitFor();
  const { name, label, notes } = (await d.get(`/v1/runs/${run.id}`)).json;
  assert.deepEqual([name, label, notes], ["hall 2, monday", "", "plate as built"]);
});

test("the line as a whole has a form: a mix of kinds, which feeds name, and its edges", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  await page.getByRole("button", { name: "Line My line" }).click();
  const chosen = page.getByRole("region", { name: "What is chosen" });
  await chosen.getByRole("heading", { name: "The line" }).waitFor();
  await chosen.getByRole("button", { name: "A mix of several" }).click();
  await chosen.getByRole("button", { name: "Add one" }).click();
  await chosen.getByLabel("Goods").nth(1).selectOption("can-500");
  await chosen.getByLabel("Id").first().fill("cans");
  await chosen.locator("summary").click();
  await chosen.getByRole("button", { name: "Give edges" }).click();
  await chosen.getByLabel("South").selectOption("outflow");
  await assertAccessible(page);

  await page.getByRole("button", { name: "Feed feed-1" }).click();
  await chosen.locator("summary").click();
  await chosen.getByRole("button", { name: "Give cargo" }).click();
  await chosen.getByLabel("Kind").selectOption("cargo-2");
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  const { cargo, edges, feeds } = await scenarioIn(page);
  assert.deepEqual(cargo, [{ goods: "can-330", id: "cans" }, { goods: "can-500" }]);
  assert.deepEqual(edges, { south: "outflow" });
  assert.deepEqual(feeds[0].cargo, [{ kind: "cargo-2" }]);

  // A feed goes on naming a kind that gets another id.
  await chosen.getByLabel("Kind").selectOption("cans");
  await page.getByRole("button", { name: "Line My line" }).click();
  await chosen.getByLabel("Id").first().fill("cola");
  assert.deepEqual((await scenarioIn(page)).feeds[0].cargo, [{ kind: "cola" }]);
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
});

test("a path goes on from the belt as an S, and its corners are handles", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  await page.getByRole("button", { name: "+ Path", exact: true }).click();
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  const { belts, domain } = await scenarioIn(page);
  assert.deepEqual(belts[1], { id: "belt-2", velocity_m_s: [0.4, 0],
    path: { points_m: [[2, 0.3], [2.6, 0.3], [3.5, 1.2], [4.1, 1.2]], radius_m: [0.6, 0.6], width_m: 0.6 } });
  assert.deepEqual(domain, { x_m: [0, 4.1], y_m: [0, 1.5] });
  await page.getByRole("button", { name: /^belt-2, corner 2/ }).press("ArrowRight");
  const moved = (await scenarioIn(page)).belts[1].path.points_m;
  assert.ok(moved[1][0] > 2.6 && moved[1][1] === 0.3);
  await assertAccessible(page, "a path");
});

test("a curve goes on from the belt, with a gate, an eye and a belt that merges", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  const press = (name) => page.getByRole("button", { name, exact: true }).click();
  await press("+ Curve");
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  // The belt of 2 x 0.6 m stays as it is; the curve is as wide, around a centre 0.3 m beside its end.
  const { belts, domain, feeds, edges } = await scenarioIn(page);
  assert.deepEqual(edges, { north: "outflow" });
  assert.deepEqual(belts, [{ id: "belt-1", velocity_m_s: [0.4, 0], polygon_m: [[0, 0], [2, 0], [2, 0.6], [0, 0.6]] },
    { id: "belt-2", velocity_m_s: [0.4, 0], arc: { centre_m: [2, 0.9], inner_radius_m: 0.3, outer_radius_m: 0.9, from_deg: -90, to_deg: 0 } }]);
  assert.deepEqual([domain, feeds[0].y_m], [{ x_m: [0, 2.9], y_m: [0, 0.9] }, [0, 0.6]]);
  await assertAccessible(page, "a curve");

  // Another belt brings cargo from the side; the gate, the eye and the rule are ready as they are added.
  await press("+ Belt");
  assert.deepEqual((await scenarioIn(page)).belts[2], { id: "belt-3", velocity_m_s: [0, -0.4], polygon_m: [[0.6, 0.6], [1, 0.6], [1, 0.9], [0.6, 0.9]] });
  await press("+ Feed on a line");
  assert.deepEqual((await scenarioIn(page)).feeds[1].line_m, [[0.66, 0.81], [0.94, 0.81]]);
  for (const name of ["+ Gate", "+ Photo eye", "+ Rule"]) await press(name);
  await page.getByRole("button", { name: "Rule When eye-1 is blocked: stop belt-1" }).waitFor();
  await page.getByLabel("Duration").fill("2");
  await page.getByLabel("Warm-up").fill("0");
  await page.locator(".verdict", { hasText: "Ready:" }).waitFor();
  await page.getByRole("button", { name: "Run both models" }).click();
  await page.waitForURL(/#\/compare\?runs=/);
  await page.locator('.pill[data-state="succeeded"]').nth(1).waitFor();
});

// A DXF file: pairs of a code and a value. Millimetres; a block of an outline of 1,000 x 400, which holds itself, inserted at (500, 100).
const dxf = [
  [0, "SECTION"], [2, "HEADER"], [9, "$INSUNITS"], [70, 4], [0, "ENDSEC"],
  [0, "SECTION"], [2, "BLOCKS"], [0, "BLOCK"], [2, "BELT"], [10, 0], [20, 0],
  [0, "LWPOLYLINE"], [90, 4], [70, 1], [10, 0], [20, 0], [10, 1000], [20, 0], [10, 1000], [20, 400], [10, 0], [20, 400],
  [0, "INSERT"], [2, "BELT"], [10, 9], [20, 9], [0, "ENDBLK"], [0, "ENDSEC"],
  [0, "SECTION"], [2, "ENTITIES"], [0, "INSERT"], [2, "BELT"], [10, 500], [20, 100],
  [0, "LINE"], [10, 0], [20, 0], [11, 2000], [21, 0], [0, "ARC"], [10, 1800], [20, 300], [40, 200], [50, 0], [51, 90], [0, "ENDSEC"], [0, "EOF"],
].map(([code, value]) => `${code}\n${value}\n`).join("");

test("a drawing lies under the line, and its lines become belts and guides", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?blank=1");
  await page.getByText("Ready:").waitFor();
  const open = (name, text) => page.getByLabel(/drawing …|Drawing under/i).setInputFiles({ name, mimeType: "", buffer: Buffer.from(text) });
  await open("hall.dxf", dxf);
  await page.getByText("1 of 3 lines: an outline, 1 × 0.4 m").waitFor();
  // Its lower left corner lies at that of the line, unless it is moved.
  await page.getByLabel("Its lower edge is at y =").fill("0,05");
  await page.getByRole("button", { name: "As a belt" }).click();
  await page.getByRole("button", { name: "The next line of it" }).click();
  await page.getByText("2 of 3 lines: 2 points, 2 × 0 m").waitFor();
  assert.equal(await page.getByRole("button", { name: "As a belt" }).isDisabled(), true);
  await page.getByRole("button", { name: "As a guide" }).click();
  const { belts, obstacles } = await scenarioIn(page);
  assert.deepEqual(belts[1].polygon_m, [[0.5, 0.15], [1.5, 0.15], [1.5, 0.55], [0.5, 0.55]]);
  assert.deepEqual(obstacles, [{ id: "plate-1", from_m: [0, 0.05], to_m: [2, 0.05] }]);
  await page.getByRole("button", { name: "The line of it before" }).click();
  await assertAccessible(page, "a drawing under the line");

  // It outlasts a reload. The arc is a quarter of a circle of 0.2 m, which has 48 chords.
  await page.reload();
  await page.getByText("1 of 3 lines").waitFor();
  await page.getByRole("button", { name: "The line of it before" }).click();
  await page.getByText("3 of 3 lines: 13 points, 0.2 × 0.2 m").waitFor();

  // An SVG file is 3 m wide, its y goes down. The rectangle is moved by (200, 50), and scaled by two before.
  await open("hall.svg", `<svg xmlns="http://www.w3.org/2000/svg" width="3000mm" viewBox="0 0 3000 1000" style="x:y">
    <style>rect { fill: red }</style><g transform="translate(200 50)"><rect transform="scale(2)" x="0" y="0" width="500" height="200"/></g><path d="M0 1000h3000M0 0v1000"/></svg>`);
  await page.getByText("1 of 3 lines: an outline, 1 × 0.4 m").waitFor();
  await page.getByRole("button", { name: "Line as large as the drawing" }).click();
  await page.getByRole("button", { name: "As a belt" }).click();
  const grown = await scenarioIn(page);
  assert.deepEqual(grown.domain, { x_m: [0, 3], y_m: [0, 1] });
  assert.deepEqual(new Set(grown.belts[2].polygon_m.map(String)), new Set(["0.2,0.95", "1.2,0.95", "1.2,0.55", "0.2,0.55"]));

  // A file of more than 20 MB is not read, and the drawing that is there stays. One of 20 MB is: a comment (999) fills it up.
  // They are read from the disk: to hand 20 MB to the browser takes half a minute on a busy machine.
  const openLarge = async (name, bytes) => {
    const file = path.join(d.folder, name);
    writeFileSync(file, `999\n${"x".repeat(bytes - dxf.length - "999\n\n".length)}\n${dxf}`);
    await page.getByLabel(/drawing …|Drawing under/i).setInputFiles(file);
  };
  await openLarge("city.dxf", 20e6 + 1);
  await page.getByText("city.dxf: It has more than 20 MB.").waitFor();
  await page.getByText("Drawing hall.svg").waitFor();
  await openLarge("town.dxf", 20e6);
  await page.getByText("Drawing town.dxf").waitFor();
  await page.getByText("1 of 3 lines: an outline, 1 × 0.4 m").waitFor();
  assert.equal(await page.getByText("It has more than 20 MB.").count(), 0);

  await open("letter.dxf", "Dear colleague,\n");
  await page.getByText("letter.dxf: It is no DXF file, or a damaged one.").waitFor();
  await open("hall.dxf", "AutoCAD Binary DXF\r\n\x1a\0");
  await page.getByText("hall.dxf: It is a binary DXF file: save it as an ASCII one.").waitFor();
  // The block is a line now, which a quarter of a turn puts upright: 6e-17 of its length are left across, of rounding.
  const upright = dxf.replace(/LWPOLYLINE[^]*?0\nINSERT/, "LINE\n10\n0\n20\n0\n11\n1000\n21\n0\n0\nINSERT").replace("10\n500\n20\n100\n", "10\n0\n20\n100\n50\n90\n");
  await open("upright.dxf", upright);
  await page.getByText("1 of 3 lines: 2 points, 0 × 1 m").waitFor();
  await page.getByRole("button", { name: "Without the drawing" }).click();
  await page.getByText("Drawing under the line …").waitFor();
});
