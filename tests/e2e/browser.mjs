// A real Chromium for the stories of the page, and functions to examine what it shows.

import assert from "node:assert/strict";
import { accessSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

import { binaries, patience } from "./setup.mjs";

const npm = process.env.BELTFLOW_NPM_DIR ?? path.join(binaries, "../tests-npm");
const load = createRequire(path.join(npm, "package.json"));
const { chromium } = load("playwright-core");
const { source: axe } = load("axe-core");

// A phone is as narrow as WCAG 2.2 has it (1.4.10): 1280 pixels at 400 %.
export const sizes = { wide: { width: 1440, height: 900 }, phone: { width: 320, height: 640 } };

// Pictures are for people; no story reads them.
const pictures = process.env.BELTFLOW_PICTURES === "1" ? path.join(binaries, "../screenshots") : null;
if (pictures !== null) mkdirSync(pictures, { recursive: true });

function findChromium() {
  // The headless shell draws the same without a window's machinery, in two thirds of the processor time.
  const names = [process.env.CHROMIUM, ...["chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"]
    .map((name) => `/usr/bin/${name}`)];
  const found = names.filter(Boolean).find((name) => {
    try {
      accessSync(name);
      return true;
    } catch {
      return false;
    }
  });
  assert.ok(found, "Chromium is not installed (deploy/install-deps does that), and CHROMIUM names none");
  return found;
}

let browser = null;

async function launch() {
  const args = process.getuid() === 0 ? ["--no-sandbox"] : [];
  browser ??= await chromium.launch({ executablePath: findChromium(), args });
  return browser;
}

// To be called by a file of stories when all of them are over.
export async function closeBrowser() {
  await browser?.close();
}

// A page of its own for this story. Whatever goes wrong in it fails the story at its end; refused
// requests are provoked by the stories, so those are only counted.
export async function openPage(t, d, { scheme = "light", size = "wide", motion = "no-preference", locale = "en-US" } = {}) {
  const context = await (await launch()).newContext({
    baseURL: d.url, viewport: sizes[size], colorScheme: scheme, reducedMotion: motion, locale, acceptDownloads: true,
  });
  const page = await context.newPage();
  const faults = [];
  page.setDefaultTimeout(patience / 2);
  page.on("pageerror", (error) => faults.push(error.stack));
  page.on("console", (message) => {
    if (message.type() === "error" && !/Failed to load resource/.test(message.text())) faults.push(message.text());
  });
  page.on("request", (request) => {
    if (!request.url().startsWith(d.url) && !request.url().startsWith("blob:")) faults.push(`asks ${request.url()}`);
  });
  t.after(async () => {
    await context.close();
    assert.deepEqual(faults, []);
  });
  return page;
}

// Opens a view by its address, from an empty page.
export async function visit(page, address) {
  await page.goto("about:blank");
  await page.goto(`/${address}`);
}

// axe's rules of colours take most of its time. What they find depends on the styles of an element and of what it is in, so
// a combination of these is judged until it passes once in the file of stories.
const ofColours = ["color-contrast", "link-in-text-block"];
const passed = new Set();

// No violation that axe finds, of any of its rules or only of some.
export async function assertAccessible(page, name, { only } = {}) {
  const rules = Object.fromEntries(ofColours.map((rule) => [rule, { enabled: false }]));
  const options = { resultTypes: ["violations"], ...(only ? { runOnly: only } : { rules }) };
  await injectAxe(page);
  assertNone(await page.evaluate(async (wanted) => (await window.axe.run(wanted)).violations, options), name);
  if (!only) await assertReadable(page, name);
}

// No violation that axe finds of its rules of colours.
export async function assertReadable(page, name) {
  await injectAxe(page);
  const { violations, combinations } = await page.evaluate(async ([rules, known]) => {
    const seen = new Set(known);
    // Of what lies on another layer of the page, the place matters, too: it has none.
    const combinationOf = (element) => {
      const parts = [];
      for (let at = element; at !== null; at = at.parentElement) {
        const style = getComputedStyle(at);
        if (!["static", "relative"].includes(style.position)) return null;
        parts.push([style.backgroundColor, style.backgroundImage, style.opacity, style.filter, style.mixBlendMode].join());
        if (at === element) parts.push(style.color, style.fontSize, style.fontWeight, style.textShadow);
        if (at === element.parentElement) parts.push(style.color, style.fontWeight, style.textDecorationLine);
      }
      return parts.join("|");
    };
    const hasText = (element) => element.matches("input, select, textarea")
      || [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.data.trim() !== "");
    const include = [...document.body.querySelectorAll("*")].filter((element) => hasText(element) && !seen.has(combinationOf(element)));
    if (include.length === 0) return { violations: [], combinations: [] };
    const found = await window.axe.run({ include }, { runOnly: rules, resultTypes: ["violations", "passes"], elementRef: true });
    const good = found.passes.filter(({ id }) => id === "color-contrast").flatMap(({ nodes }) => nodes);
    return { combinations: good.map(({ element }) => combinationOf(element)).filter((combination) => combination !== null),
      violations: found.violations.map(({ id, help, nodes }) => ({ id, help, nodes: nodes.map(({ html, any }) => ({ html, any })) })) };
  }, [ofColours, [...passed]]);
  assertNone(violations, name);
  for (const combination of combinations) passed.add(combination);
}

// Its own package for Playwright injects it again and opens a tab of its own each time.
async function injectAxe(page) {
  if (await page.evaluate(() => window.axe === undefined)) await page.evaluate(axe);
}

function assertNone(violations, name) {
  const found = violations.map(({ id, help, nodes }) => `${id}: ${help}: ${nodes.map(({ html, any }) =>
    `${html.slice(0, 160)} ${any.map(({ message }) => message).join("; ")}`).join("\n    ")}`);
  assert.deepEqual(found, [], name);
}

// Until what follows the size of the view or its colours has been drawn again: that is in the frame after a change.
export async function redrawn(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

// No element overflows the view. With BELTFLOW_PICTURES=1 a picture of the whole view is left in the build folder.
export async function takePicture(page, name, size) {
  if (pictures !== null) {
    const height = await page.evaluate(() => document.documentElement.scrollHeight);
    await page.setViewportSize({ ...sizes[size], height: Math.max(height, sizes[size].height) });
    await redrawn(page);
    await page.screenshot({ path: path.join(pictures, `${name}.png`) });
    await page.setViewportSize(sizes[size]);
  }
  const excess = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(excess <= 0, `${name} is ${excess} pixels too wide`);
}

// The text of the editor of JSON.
export async function editedText(page) {
  await page.locator(".cm-line").first().waitFor();
  // The document itself: of a long one the page has only the lines that can be seen. This is what CodeMirror's
  // EditorView.findFromDOM() does.
  return page.locator(".cm-content").evaluate((content) => {
    const node = content.cmTile ?? content.cmView;
    return (node.view ?? node.rootView.view).state.doc.toString();
  });
}

// Type a text over all that the editor of JSON holds. fill() replaces only the lines that are drawn.
export async function editText(page, text) {
  await page.locator(".cm-line").first().waitFor();
  await page.getByRole("textbox", { name: "Scenario as JSON" }).press("ControlOrMeta+a");
  await page.keyboard.insertText(text);
}

// The text of an element, as a number: "173 of 192" is 173.
export async function numberIn(locator) {
  return Number((await locator.innerText()).replaceAll(",", "").match(/-?[\d.]+/)?.[0]);
}
