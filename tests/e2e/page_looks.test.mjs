// Every view, on a wide screen in light and dark, and on a phone: axe finds nothing, and nothing sticks out. With
// BELTFLOW_PICTURES=1 a picture of each is left in the build folder, so that one can look.

import test, { after } from "node:test";

import {
  assertAccessible, assertReadable, closeBrowser, editText, editedText, openPage, redrawn, sizes as screens, takePicture, visit,
} from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { endless, fed, tiny } from "./scenarios.mjs";

after(closeBrowser);

// A daemon with runs in every state; { name: id }.
async function furnish(d) {
  const example = (await d.get("/v1/examples/example-1")).json;
  const mixed = (await d.get("/v1/examples/mixed-cargo")).json;
  const submit = async (name, scenario, extra) => [name, (await d.submit(scenario, extra)).id];
  const done = await Promise.all([
    submit("macro", example, { label: "paper" }),
    submit("micro", example, { model: "micro", label: "paper" }),
    submit("mixed", { ...mixed, duration_s: 2 }, { model: "micro" }),
    submit("fed", fed(), { model: "micro" }),
    submit("fedMacro", fed()),
    submit("other", { ...example, name: "Example 1 on a faster belt", belts: [{ velocity_m_s: [0.5, 0] }] }, { line: "hall 2" }),
  ]);
  for (const [, id] of done) await d.reached(id, "succeeded");
  const study = await d.post("/v1/studies", { name: "Which angle", line: "hall 2", base: { scenario: { ...example, duration_s: 0.5 } }, method: { type: "grid" },
    parameters: [{ pointer: "/obstacles/0/from_m/0", range: [0.4, 0.7], steps: 4 }], objectives: [{ figure: "peak_density" }] });
  const cancelled = await submit("cancelled", tiny({ ...endless(), name: "A run that was stopped" }));
  await d.progressed(cancelled[1], 0);
  await d.post(`/v1/runs/${cancelled[1]}/cancel`, "");
  const running = await submit("running", { ...endless(), name: "A long run" });
  await d.reached(running[1], "running");
  const queued = await submit("queued", tiny({ name: "A run that waits" }));
  return Object.fromEntries([...done, cancelled, running, queued, ["study", study.json.id]]);
}

const csv = { name: "belt.csv", mimeType: "text/csv",
  buffer: Buffer.from(["t_s,count", ...Array.from({ length: 13 }, (_, k) => `${k / 2},${Math.max(0, 192 - 12 * k)}`)].join("\n")) };

// [name, address, what must be seen before one looks], of runs that are going and of what rests.
const busyViews = (ids) => [
  ["runs", "#/", async (page) => page.getByText("of 192").first().waitFor()],
  ["run-running", `#/runs/${ids.running}`, async (page) => page.getByText("Follow live").waitFor()],
  ["run-queued", `#/runs/${ids.queued}`, async (page) => page.getByText("Waiting for its turn").waitFor()],
];

const calmViews = (ids) => [
  ["runs-selected", "#/", async (page) => {
    for (const box of (await page.getByRole("checkbox", { name: "Example 1:" }).all()).slice(0, 2)) await box.check();
  }],
  ["runs-none", "#/?label=nothing", async (page) => page.getByText("No run matches.").waitFor()],
  ["run-macro", `#/runs/${ids.macro}?t=2`, shown],
  ["run-macro-grey", `#/runs/${ids.macro}?t=2&map=grey`, shown],
  ["run-micro", `#/runs/${ids.micro}?t=3`, shown],
  ["run-micro-parts", `#/runs/${ids.micro}?t=3&layer=parts`, shown],
  ["run-mixed", `#/runs/${ids.mixed}?t=1.5`, shown],
  ["run-fed", `#/runs/${ids.fed}?t=2.5`, shown],
  ["run-none", "#/runs/01a1f916-75bc-759c-9d74-cbbf3fe9393f", async (page) => page.getByText("There is no such run").waitFor()],
  ["compare-two", `#/compare?runs=${ids.macro},${ids.micro}&t=2.5`, async (page) => {
    await page.setInputFiles('input[type="file"]', csv);
    await page.getByText("measured: belt.csv").waitFor();
  }],
  ["compare-fed", `#/compare?runs=${ids.fed},${ids.fedMacro}&t=2.5`, async (page) => page.locator(".plot-legend .group").nth(1).waitFor()],
  ["compare-four", `#/compare?runs=${ids.macro},${ids.micro},${ids.other},${ids.mixed}&t=1.5`, shown],
  ["compare-none", "#/compare", async (page) => page.getByText("Add two to eight runs").waitFor()],
  ["runs-grouped", `#/?open=${ids.study}`, async (page) => page.locator(".of-study").first().waitFor()],
  ["lines", "#/lines", async (page) => page.getByRole("link", { name: "Change and run hall 2" }).waitFor()],
  ["line", "#/?line=hall%202", async (page) => page.getByRole("link", { name: "Change and run version 1" }).waitFor()],
  ["studies", "#/studies", async (page) => page.getByRole("link", { name: "Which angle" }).waitFor()],
  ["study", `#/studies/${ids.study}`, async (page) => page.locator(".study-point.best").waitFor()],
  ["study-new", "#/studies/new", async (page) => page.locator(".verdict", { hasText: "At most" }).waitFor()],
  ["study-fit", "#/studies/new", async (page) => {
    await page.locator("[name=method]").selectOption("Fit to counts");
    await page.setInputFiles('input[type="file"]', csv);
    await page.getByText("belt.csv is stored and chosen.").waitFor();
  }],
  ["new-form", "#/new", async (page) => page.getByText("Ready:").waitFor()],
  ["new-faults", "#/new", async (page) => {
    await page.getByText("Ready:").waitFor();
    await page.getByLabel("Duration").fill("0");
    await page.getByText("Advanced").click();
    await page.getByRole("textbox", { name: "Time step" }).fill("0.5");
    await page.locator("#macro-step-fault:not([hidden])").waitFor();
  }],
  ["new-warning", "#/new", async (page) => {
    await page.getByText("Ready:").waitFor();
    await page.getByLabel("Deflector angle").fill("30");
    await page.locator("#angle-warning:not([hidden])").waitFor();
  }],
  ["new-json", "#/new?tab=json", async (page) => {
    await page.getByText("Ready:").waitFor();
    await editText(page, (await editedText(page)).replace('"duration_s"', '"duraton_s"'));
    await page.locator(".faults button").first().waitFor();
  }],
  ["help", `#/runs/${ids.macro}?t=2`, async (page) => {
    await page.getByRole("button", { name: "Help" }).click();
    for (const name of ["Words", "Key figures"]) await page.getByText(name, { exact: true }).last().click();
    await page.getByText("Doubles of a photo eye").waitFor();
  }],
];

async function shown(page) {
  await page.waitForFunction(() => performance.getEntriesByName("first-frame").length > 0);
  await page.locator(".u-over").waitFor();
}

async function look(page, [name, address, wait]) {
  await visit(page, address);
  await wait(page);
  for (const size of sizes) await judge(page, name, size);
}

// Colours do not depend on the size, nor anything else on colours, so dark is checked on the wide screen alone, and there
// by the rules of colours. A phone has the markup of the wide screen, but for what its styles hide and fold: the
// rules of names and of what scrolls. The open page turns dark and light again, as a desktop does it, and is made as small
// as a phone's. What a page does otherwise when it begins on a phone, to fold the filters of runs, is looked at apart.
const ofHiding = ["scrollable-region-focusable", "page-has-heading-one", "skip-link", "label", "button-name", "link-name", "summary-name"];
const sizes = ["wide", "phone"];

async function judge(page, name, size) {
  await page.setViewportSize(screens[size]);
  await redrawn(page);
  await takePicture(page, `${name}-${size}-light`, size);
  await assertAccessible(page, `${name} ${size} light`, size === "phone" ? { only: ofHiding } : {});
  if (size === "phone") return;
  await page.emulateMedia({ colorScheme: "dark" });
  await takePicture(page, `${name}-${size}-dark`, size);
  await assertReadable(page, `${name} ${size} dark`);
  await page.emulateMedia({ colorScheme: "light" });
}

test("every view passes axe and fits, in light and dark, wide and narrow", async (t) => {
  const d = await daemon(t);
  const ids = await furnish(d);
  const page = await openPage(t, d);
  const phone = await openPage(t, d, { size: "phone" });
  for (const view of busyViews(ids)) await look(page, view);
  const [[, list, wait]] = busyViews(ids);
  await visit(phone, list);
  await wait(phone);
  await judge(phone, "runs-begun", "phone");
  await d.post(`/v1/runs/${ids.running}/cancel`, "");
  for (const view of calmViews(ids)) await look(page, view);
});

test("so do an empty list, and the page without its daemon", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await look(page, ["studies-empty", "#/studies", async (at) => at.getByText("No studies yet.").waitFor()]);
  await look(page, ["lines-empty", "#/lines", async (at) => at.getByText("No line yet.").waitFor()]);
  await look(page, ["runs-empty", "#/", async (at) => at.getByText("No runs yet.").waitFor()]);
  await page.route("**/*", (route) => route.abort());
  await page.getByText("The server does not answer. Trying again").waitFor();
  for (const size of sizes) await judge(page, "away", size);
});
