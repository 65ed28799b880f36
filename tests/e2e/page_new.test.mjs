// A new run by the form and by JSON: limits and faults at their places.

import assert from "node:assert/strict";
import test, { after } from "node:test";

import { assertAccessible, closeBrowser, editText, editedText, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { until } from "./setup.mjs";

after(closeBrowser);

test("a number out of its limits is refused at its field, and the daemon's judgement stands there too", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new");
  await page.getByText("Ready: 24,000 cells, 6 s.").waitFor();

  await page.getByLabel("Duration").fill("-1");
  await page.locator("#duration-fault", { hasText: "must be greater than 0" }).waitFor();
  assert.equal(await page.getByLabel("Duration").getAttribute("aria-invalid"), "true");
  await page.getByRole("button", { name: "Start the run" }).click();
  await page.waitForFunction(() => document.activeElement.id === "duration");
  assert.deepEqual((await d.get("/v1/runs")).json.runs, []);
  await page.getByLabel("Duration").fill("6");

  // Only the daemon knows which step is stable: 0.5 s is not. The focus goes there also where it is folded away.
  await page.getByText("Advanced").click();
  await page.getByRole("textbox", { name: "Time step" }).fill("0.5");
  const fault = page.locator("#macro-step-fault:not([hidden])");
  await fault.waitFor();
  assert.match(await fault.innerText(), /\d/);
  await page.getByText("1 fault to mend").waitFor();

  await page.getByText("Advanced").click();
  await page.getByRole("button", { name: "Start the run" }).click();
  await page.waitForFunction(() => document.activeElement.id === "macro-step");
  assert.match(page.url(), /#\/new/);

  await page.getByRole("textbox", { name: "Time step" }).fill("");
  await page.getByText("Ready: 24,000 cells, 6 s.").waitFor();
  assert.equal(await page.getByRole("textbox", { name: "Time step" }).getAttribute("aria-invalid"), "false");
});

test("what the results would be doubted for stands at its field with the reason, and the run can be started", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?example=example-1");
  await page.getByText("Ready:").waitFor();
  const warning = page.locator("#angle-warning");
  assert.equal(await warning.isVisible(), false);
  // At 20 degrees the foot is 0.5 m / tan 20 degrees = 1.37 m upstream of the tip, off the belt of 0.75 m before it.
  await page.getByLabel("Deflector angle").fill("20");
  await warning.waitFor();
  assert.match(await warning.innerText(), /A deflector stands at 20 degrees to the belt/);
  assert.match(await warning.innerText(), /its foot lies off the belt, at \(-0\.624, 0\) m/);
  await page.locator(".verdict.doubt", { hasText: /Read the .*warnings? first/ }).waitFor();
  assert.ok(await page.getByRole("button", { name: "Start the run" }).isEnabled());
  // Beside the JSON all of them stand above the button.
  await page.getByRole("button", { name: "JSON" }).click();
  await page.getByRole("list", { name: "Warnings" }).getByText("its foot lies off the belt").waitFor();
  await page.locator(".cm-lintRange-warning").first().waitFor();
  await page.getByRole("button", { name: "Belt and numbers" }).click();
  await page.getByLabel("Deflector angle").fill("60");
  await warning.waitFor({ state: "hidden" });
});

test("a deflector is drawn by pointer and by keys, and the numbers beside it follow", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?example=example-1");
  await page.getByText("Ready:").waitFor();
  const number = async (name) => Number(await page.getByRole("textbox", { name, exact: true }).inputValue());
  const tip = page.getByRole("button", { name: "singularizer, tip" });
  await tip.focus();
  await page.keyboard.press("ArrowRight"); // by 0.01 m
  assert.equal(await number("Tip, x"), 0.76);
  await page.locator(".verdict", { hasText: "It takes about" }).waitFor();
  assert.equal(await number("Foot, x"), 0.461325);
  await page.keyboard.press("Shift+ArrowLeft"); // by 0.001 m
  assert.equal(await number("Tip, x"), 0.759);
  const opening = page.getByRole("button", { name: "singularizer, opening" });
  const angle = await number("Deflector angle");
  await opening.focus();
  await page.keyboard.press("ArrowDown");
  assert.equal(await number("Opening"), 0.11);
  assert.ok(Math.abs((await number("Deflector angle")) - angle) < 1e-3);

  // A counter's side and a feed's end move alike.
  await page.getByRole("button", { name: "upstream, downstream side of the counter" }).focus();
  await page.keyboard.press("ArrowRight");
  await page.getByRole("button", { name: "upstream, downstream side of the counter, x: 0.76 m" }).waitFor();

  // The pointer draws the foot along the wall, onto the lattice.
  const { x, y, width, height } = await page.getByRole("button", { name: "singularizer, foot" }).boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2 - 60, y + height / 2 - 6, { steps: 3 });
  await page.mouse.up();
  const foot = await number("Foot, x");
  assert.ok(foot < 0.45 && Math.abs(foot * 100 - Math.round(foot * 100)) < 1e-9, String(foot));
  const text = await page.getByLabel("Name").inputValue();
  assert.match(text, /^Example 1, angle [\d.]+°, tip [\d.]+, 0\.49 m, upstream x 0, 0\.76 m$/);
  await page.getByRole("button", { name: "JSON" }).click();
  const scenario = JSON.parse(await editedText(page));
  assert.deepEqual(scenario.counters[0].x_m, [0, 0.76]);
  const { end_m: [ex, ey], angle_deg: degrees, length_m: length } = scenario.obstacles[0];
  assert.ok(Math.abs(ex - length * Math.cos((degrees * Math.PI) / 180) - foot) < 1e-5);
  assert.ok(Math.abs(ey - length * Math.sin((degrees * Math.PI) / 180)) < 1e-5);
});

test("what the Tab key reaches is not hidden by the row of buttons, nor by what lies at the same place", async (t) => {
  const d = await daemon(t);
  for (const [width, height] of [[1280, 720], [500, 900], [640, 360], [320, 640]]) {
    const page = await openPage(t, d);
    await page.setViewportSize({ width, height });
    await visit(page, "#/new?example=packing-line");
    await page.getByText("Ready: ").waitFor();
    await page.getByLabel("Runs of each").waitFor();
    for (let isLast = false, n = 0; !isLast; n++) {
      assert.ok(n < 300, `"Start the run" is reached at ${width} x ${height}`);
      await page.keyboard.press("Tab");
      const [name, isSeen, isButton] = await page.evaluate(() => {
        const at = document.activeElement;
        const box = at.getBoundingClientRect();
        const shares = [0.1, 0.5, 0.9];
        const seen = shares.flatMap((x) => shares.map((y) => document.elementFromPoint(box.left + x * box.width, box.top + y * box.height)));
        return [
          at.outerHTML.slice(0, 80),
          seen.some((element) => element !== null && (at.contains(element) || element.contains(at))),
          at.textContent === "Start the run",
        ];
      });
      assert.ok(isSeen, `${name} is hidden at ${width} x ${height}`);
      isLast = isButton;
    }
  }
});

test("what would leave no deflector across the belt is refused at its field, which stays", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?example=example-1");
  await page.getByText("Ready:").waitFor();
  const field = (id) => page.locator(`#${id}`);
  // The foot is at (0.46, 0) m and the tip at (0.75, 0.5) m, on a belt of 0.6 m: a tip at 7.5 m makes 4 degrees with it, and an
  // opening of 0.7 m is wider than the belt.
  for (const [id, bad, good] of [["tip-x", "7.5", "0.75"], ["foot-x", "-9", "0.461325"], ["opening", "0.7", "0.1"]]) {
    await field(id).fill(bad);
    await page.locator(`#${id}-fault`, { hasText: "must leave a deflector across the belt, at 10 to 170 degrees" }).waitFor();
    assert.equal(await field("angle").inputValue(), "60");
    await page.getByRole("button", { name: "Start the run" }).click();
    await page.waitForFunction((wanted) => document.activeElement.id === wanted, id);
    await field(id).fill(good);
    await page.locator(`#${id}-fault`).waitFor({ state: "hidden" });
  }
  await page.getByText("Ready: 24,000 cells, 6 s.").waitFor();
  assert.deepEqual((await d.get("/v1/runs")).json.runs, []);
});

test("each part of random cargo is drawn where it will stand, in the colour of its kind", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  const { domain, ...rest } = (await d.get("/v1/examples/mixed-cargo")).json;
  const { parts } = (await d.post("/v1/validate?parts=20000", { scenario: { domain, ...rest }, model: "micro" })).json;
  await visit(page, "#/new?example=mixed-cargo");
  await page.getByText("Ready:").waitFor();
  // 3 mm behind the centre, from which a line shows the heading.
  const places = parts.map(({ x_m: x, y_m: y, heading_rad: turn }) => [x - 0.003 * Math.cos(turn), y - 0.003 * Math.sin(turn)]);
  const colors = await page.evaluate(([wanted, { x_m: [x0, x1], y_m: [y0] }]) => {
    const canvas = document.querySelector(".scene-frame canvas");
    const [left, right, bottom] = [46, 22, 28].map((margin) => margin * (canvas.width / canvas.clientWidth));
    const scale = (canvas.width - left - right) / (x1 - x0);
    const context = canvas.getContext("2d");
    return wanted.map(([x, y]) => String(context.getImageData(left + (x - x0) * scale, canvas.height - bottom - (y - y0) * scale, 1, 1).data));
  }, [places, domain]);
  const ofKinds = rest.cargo.map((_, kind) => [...new Set(colors.filter((_color, k) => parts[k].kind === kind))]);
  assert.ok(ofKinds.every((some) => some.length === 1), JSON.stringify(ofKinds));
  assert.equal(new Set(ofKinds.flat()).size, ofKinds.length);
});

test("both models are run from one form and compared, and a study begins with what was edited", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?example=example-1");
  await page.getByText("Ready:").waitFor();
  await page.getByLabel("Duration").fill("0.05");
  await page.getByText("Ready: 24,000 cells, 0.05 s.").waitFor();
  await page.getByRole("button", { name: "Run both models" }).click();
  await page.waitForURL(/#\/compare\?runs=/);
  const { runs } = (await d.get("/v1/runs")).json;
  assert.deepEqual(runs.map(({ model, name }) => [model, name]).sort(),
    ["macro", "micro"].map((model) => [model, "Example 1, duration 0.05 s"]));
  await visit(page, `#/new?from=${runs[0].id}`);
  await page.getByText("Ready:").waitFor();
  await page.getByLabel("Belt speed").fill("0.5");
  await page.getByRole("button", { name: "Study …" }).click();
  await page.locator("[name=parameter]").selectOption("belt speed");
  assert.equal(await page.locator("[name=from]").inputValue(), "0.35"); // 30 % less
  assert.equal(await page.locator("[name=to]").inputValue(), "0.65");
});

test("a belt speed that is typed keeps the directions of all belts and the proportions of their speeds", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?example=merge");
  await page.getByText("Ready:").waitFor();
  const speed = page.getByLabel("Belt speed");
  assert.equal(await speed.inputValue(), "0.5");
  await speed.fill("");
  await speed.pressSequentially("0.");
  await page.locator("#speed-fault", { hasText: "must be greater than 0" }).waitFor();
  await speed.pressSequentially("25");
  await page.locator("#speed-fault").waitFor({ state: "hidden" });
  await page.getByRole("button", { name: "JSON" }).click();
  const velocities = JSON.parse(await editedText(page)).belts.map(({ id, velocity_m_s: velocity }) => [id, velocity]);
  // Half of what they were: 0.5 m/s along x, and 0.4 m/s against y.
  assert.deepEqual(velocities, [["line", [0.25, 0]], ["side", [0, -0.2]]]);
});

test("what the form changes is what is submitted: angle, speed, duration, cell and model", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/new?example=example-1");
  await page.getByText("Ready:").waitFor();
  await page.getByLabel("Deflector angle").fill("45");
  await page.getByLabel("Belt speed").fill("0.3");
  await page.getByLabel("Duration").fill("0.05");
  await page.getByText("Advanced").click();
  await page.getByRole("textbox", { name: "Cell" }).fill("0.01");
  await page.getByLabel("Label").fill("by form");
  await page.getByText("Ready: 6,000 cells, 0.05 s.").waitFor();
  const made = "Example 1, angle 45°, belt speed 0.3 m/s, duration 0.05 s, cell 0.01 m";
  const name = page.getByLabel("Name");
  assert.equal(await name.inputValue(), made);
  // A name of one's own stays; without it the parameters make one again.
  await name.fill("mine");
  await page.getByLabel("Duration").fill("0.06");
  assert.equal(await name.inputValue(), "mine");
  await name.fill("");
  await page.getByLabel("Duration").fill("0.05");
  assert.equal(await name.inputValue(), made);
  await page.getByText("Ready: 6,000 cells, 0.05 s.").waitFor();
  await page.getByRole("button", { name: "Start the run" }).click();
  await page.locator(".pill", { hasText: "succeeded" }).waitFor();

  const [run] = (await d.get("/v1/runs?label=by+form")).json.runs;
  assert.equal(run.name, made);
  const scenario = (await d.get(`/v1/runs/${run.id}/scenario`)).json;
  // The plate still ends at (0.75, 0.5) and begins at the wall: at 45 degrees 0.5 m before its end.
  const [[from], [to]] = [scenario.obstacles[0].path_m, scenario.obstacles[0].path_m.slice(1)];
  assert.ok(Math.hypot(from[0] - 0.25, from[1] - 0) < 1e-6, JSON.stringify(scenario.obstacles));
  assert.deepEqual(to, [0.75, 0.5]);
  assert.deepEqual(scenario.belts[0].velocity_m_s, [0.3, 0]);
  assert.equal(scenario.duration_s, 0.05);
  assert.equal(scenario.macro.cell_m, 0.01);
});

test("faults of the JSON are marked at their places, and lead there", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  const loaded = () => page.evaluate(() =>
    performance.getEntriesByType("resource").filter(({ name }) => name.endsWith("/code_editor.js")).length);
  await visit(page, "#/new");
  await page.getByText("Ready:").waitFor();
  assert.equal(await loaded(), 0);
  await page.getByRole("button", { name: "JSON" }).click();
  const area = page.getByRole("textbox", { name: "Scenario as JSON" });
  const good = await editedText(page);
  assert.equal(await loaded(), 1);
  const selected = () => page.locator(".json-box").evaluate((box) => box.shadowRoot.getSelection().toString());
  // The fault at a pointer: what it says, what is underlined, and what is selected when one goes there.
  const showsFault = async (pointer, text, place) => {
    const fault = page.locator(".faults button", { hasText: pointer });
    await fault.waitFor();
    assert.match(await fault.innerText(), text);
    assert.ok((await page.locator(".cm-lintRange-error").allTextContents()).join("").endsWith(place));
    await fault.click();
    assert.equal(await selected(), place);
  };

  await editText(page, good.replace('"duration_s"', '"duraton_s"'));
  await showsFault("/duraton_s", /line 3[^]*duration_s/, '"duraton_s": 6'); // with what was meant
  assert.equal(await area.getAttribute("aria-invalid"), "true");
  // The whole document lacks a member: of it the first line is marked, as is that of the unknown one.
  assert.equal(await page.locator(".cm-lint-marker-error").count(), 2);
  await editText(page, good.replace(/("velocity_m_s": \[[^,]*, )[^\]]*/, '$1"a~b"'));
  await showsFault("/belts/0/velocity_m_s/1", /line \d+/, '"a~b"');
  await editText(page, good.replace('"duration_s": 6', '"duration_s": six'));
  await page.locator(".faults button", { hasText: "line 3" }).waitFor();
  await page.getByText("1 fault to mend").waitFor();

  // Tab leaves the editor; undo is of the text.
  await area.press("Tab");
  await page.waitForFunction(() => document.activeElement.matches(".fault-link"));
  await area.press("ControlOrMeta+z");
  await page.getByText("Ready:").waitFor({ state: "hidden" });
  await page.locator(".faults button", { hasText: "/belts/0/velocity_m_s/1" }).waitFor();
  await area.press("ControlOrMeta+f");
  await page.getByRole("textbox", { name: "Find", exact: true }).waitFor();
  await assertAccessible(page, "the search of the editor");
  await page.keyboard.press("Escape");

  await editText(page, good);
  await page.getByText("Ready:").waitFor();
  assert.equal(await page.locator(".cm-lintRange-error").count(), 0);
  assert.equal(await area.getAttribute("aria-invalid"), "false");
});

test("a past run is where the next one begins", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/example-2")).json;
  const run = await d.submit({ ...example, duration_s: 0.05 }, { model: "micro", label: "before" });
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d);
  await visit(page, `#/runs/${run.id}`);
  await page.getByRole("link", { name: "Run again with changes" }).press("Enter"); // figures that come above it may move it
  await page.getByText("Ready: every part by itself, 0.05 s.").waitFor();
  assert.equal(await page.getByLabel("Deflector angle").inputValue(), "90");
  assert.equal(await page.getByLabel("Label").inputValue(), "before");
  assert.equal(await page.getByRole("button", { name: "Microscopic" }).getAttribute("aria-pressed"), "true");
});

test("goods that are chosen bring their numbers, which can be changed and stay without the name", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  const { goods, frictions } = (await d.get("/v1/goods")).json;
  const can = goods.find(({ name }) => name === "can-330");
  const onSteel = (other) => frictions.find(({ a, b }) => a === "steel" && b === other).friction;
  let asked = "";
  page.on("request", (request) => /v1\/validate/.test(request.url()) && (asked = request.postData()));
  await visit(page, "#/new?example=photo-eye&model=micro");
  const number = async (name) => Number(await page.getByRole("textbox", { name, exact: true }).inputValue());
  // Fields get their numbers when the server has filled in the scenario's defaults.
  const shows = (numbers) => until(async () => {
    const shown = await Promise.all(Object.keys(numbers).map(number));
    return Object.values(numbers).every((value, k) => value === shown[k]);
  }, JSON.stringify(numbers));
  // The scenario that the server is asked to validate after a change; it may be asked about the one before once more.
  await page.getByText("Ready:").waitFor();
  const after = async (change) => {
    const before = asked;
    const [request] = await Promise.all([
      page.waitForRequest((one) => /v1\/validate/.test(one.url()) && one.postData() !== before), change()]);
    return JSON.parse(request.postData()).scenario;
  };
  await shows({ Diameter: 0.03, Mass: 0.01, "Friction on the belt": 1 });
  assert.equal(await page.getByLabel("Belts are of").isVisible(), false);

  const chosen = await after(() => page.getByLabel("Goods").selectOption("can-330"));
  assert.deepEqual([chosen.cargo, chosen.contacts], [{ goods: "can-330" }, undefined]);
  await shows({ Diameter: 2 * can.shape.radius_m, Mass: can.mass_kg, "Friction on the belt": onSteel("acetal") });
  assert.deepEqual((await after(() => page.getByLabel("Belts are of").selectOption("rubber"))).surfaces, { conveyor: "rubber" });
  await shows({ "Friction on the belt": onSteel("rubber") });

  assert.deepEqual((await after(() => page.getByLabel("Mass", { exact: true }).fill("0.03"))).cargo, { goods: "can-330", mass_kg: 0.03 });
  const changed = await after(() => page.getByLabel("Friction at plates").fill("0.2"));
  assert.deepEqual(changed.contacts, { handling_cargo: { friction: 0.2 } });
  const { resolved } = (await d.post("/v1/validate", { scenario: changed, model: "micro" })).json;
  assert.deepEqual([resolved.cargo.shape, resolved.cargo.mass_kg], [can.shape, 0.03]);

  const plain = await after(() => page.getByLabel("Goods").selectOption(""));
  assert.deepEqual([plain.cargo, plain.surfaces], [{ shape: can.shape, mass_kg: 0.03 }, undefined]);
  await shows({ "Friction on the belt": 1 });
});
