// What the page costs in a real browser: bytes, time to the first frame, frames a second, memory over ten minutes. Prints
// one line for each; no test. Needs what the stories of the page need.
//
//     node tests/bench/page.mjs [WORD]    only the lines whose name holds the word

import { readFileSync, readdirSync } from "node:fs";
import path from "node:path";
import { setTimeout as sleep } from "node:timers/promises";

import { closeBrowser, openPage, visit } from "../e2e/browser.mjs";
import { daemon } from "../e2e/daemon.mjs";
import { endless, tiny } from "../e2e/scenarios.mjs";
import { binaries } from "../e2e/setup.mjs";

const PLAYED_MS = 4000;
const word = process.argv[2] ?? "";

const last = [];
const t = { after: (action) => last.unshift(action) };

function tell(name, text) {
  process.stdout.write(`${name.padEnd(34)} ${text}\n`);
}

const ms = (value) => `${value.toFixed(value < 10 ? 1 : 0)} ms`;

// Frames while the animation plays for some seconds: how often, and how long the page's thread worked.
async function play(page, name, speed) {
  await page.getByLabel("Speed").selectOption(String(speed));
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  const cpu = async () => (await session.send("Performance.getMetrics")).metrics.find(({ name: n }) => n === "TaskDuration").value;
  await page.locator("main").focus();
  await page.keyboard.press("Home");
  if (!(await page.getByRole("button", { name: "Pause" }).isVisible())) await page.keyboard.press("k");
  await page.getByRole("button", { name: "Pause" }).waitFor();
  await sleep(500);
  const before = await cpu();
  const gaps = await page.evaluate((duration) => new Promise((resolve) => {
    const times = [];
    const begin = performance.now();
    const tick = (now) => {
      times.push(now);
      if (now - begin < duration) requestAnimationFrame(tick);
      else resolve(times.slice(1).map((time, k) => time - times[k]));
    };
    requestAnimationFrame(tick);
  }), PLAYED_MS);
  if (!(await page.getByRole("button", { name: "Pause" }).isVisible())) throw new Error(`${name}: it came to its end`);
  const spent = ((await cpu()) - before) * 1000;
  const sorted = [...gaps].sort((a, b) => a - b);
  const at = (share) => sorted[Math.floor(share * (sorted.length - 1))];
  const rate = (1000 * gaps.length) / gaps.reduce((sum, gap) => sum + gap, 0);
  tell(name, `${rate.toFixed(1)} frames/s; between frames median ${ms(at(0.5))}, 95 % ${ms(at(0.95))}; ${ms(spent / gaps.length)} of CPU a frame`);
}

// From the click on the run's link to its first picture, and from the last byte of a snapshot to it.
async function open(page, name, run) {
  await visit(page, "#/");
  const link = page.getByRole("link", { name: run.name, exact: true }).first();
  await link.waitFor();
  await link.evaluate((element) => element.addEventListener("click", () => performance.mark("pressed"), { once: true }));
  await link.click();
  await page.waitForFunction(() => performance.getEntriesByName("first-frame").length > 0);
  const [pressed, bytes, frame] = await page.evaluate(() => [
    performance.getEntriesByName("pressed").at(-1).startTime,
    Math.min(...performance.getEntriesByType("resource").filter(({ name: n }) => /(?:snapshots|parts)\/0$/.test(n)).map((entry) => entry.responseEnd)),
    performance.getEntriesByName("first-frame")[0].startTime,
  ]);
  tell(name, `${ms(frame - pressed)} from the press to the first frame, ${ms(frame - bytes)} from its bytes`);
}

async function solve(d, scenario, extra) {
  const run = await d.submit(scenario, extra);
  return d.reached(run.id, "succeeded");
}

function tellSizes() {
  const folder = path.join(binaries, "../web");
  const files = readdirSync(folder).filter((name) => name.endsWith(".gz"));
  const sizes = files.map((name) => [name.slice(0, -3), readFileSync(path.join(folder, name)).length]);
  const all = sizes.reduce((sum, [, n]) => sum + n, 0);
  tell("size, gzip", `${(all / 1000).toFixed(1)} kB (${sizes.map(([name, n]) => `${name} ${(n / 1000).toFixed(1)}`).join(", ")})`);
}

const example = async (d) => (await d.get("/v1/examples/example-1")).json;

async function playCells(name, d, page, domain) {
  const run = await solve(d, { ...(await example(d)), name, domain, duration_s: 1,
    output: { curve_every_s: 0.05, snapshot_every_s: 0.05 }, macro: { closure: "dispersive", cell_m: 0.001, step_s: "auto" } });
  await open(page, name, run);
  await play(page, name, 0.1);
}

// Both models of a scenario beside each other, again and again.
async function watch(page, minutes, onMinute) {
  const play = page.getByRole("button", { name: "Play", exact: true });
  for (let minute = 0; minute < minutes; minute++) {
    for (const end = performance.now() + 60000; performance.now() < end; await sleep(500)) {
      if (!(await play.isVisible())) continue;
      await page.keyboard.press("Home");
      await play.click();
    }
    await onMinute();
  }
}

const benches = {
  "200 x 120 cells": async (name, d, page) => {
    const run = await solve(d, { ...(await example(d)), name });
    await open(page, name, run);
    await play(page, name, 1);
  },
  "192 parts": async (name, d, page) => {
    const run = await solve(d, { ...(await example(d)), name }, { model: "micro" });
    await open(page, name, run);
    await play(page, name, 1);
  },
  "100,000 parts": async (name, d, page) => {
    const run = await solve(d, { ...(await example(d)), name, duration_s: 1, obstacles: [],
      domain: { x_m: [0, 15], y_m: [0, 9] },
      initial: { hexagonal: { rows: 400, columns: 250, first_m: [0.5, 0.1], spacing_m: 0.025 } },
      counters: [{ id: "all" }], output: { curve_every_s: 0.05, snapshot_every_s: 0.05 },
      macro: { closure: "dispersive", cell_m: 0.05, step_s: "auto" }, micro: { integrator: "implicit", step_s: "auto" } }, { model: "micro" });
    await page.setViewportSize({ width: 1920, height: 1080 });
    await open(page, name, run);
    await page.getByRole("button", { name: "Parts", exact: true }).click();
    await play(page, name, 0.1);
  },
  "1,000 x 600 cells": (name, d, page) => playCells(name, d, page, { x_m: [0, 1], y_m: [0, 0.6] }),
  "2,000 x 1,200 cells": (name, d, page) => playCells(name, d, page, { x_m: [0, 2], y_m: [0, 1.2] }),
  "heap over ten minutes": async (name, d, page) => {
    const runs = [];
    for (const model of ["macro", "micro"]) runs.push(await solve(d, { ...(await example(d)), name }, { model }));
    const session = await page.context().newCDPSession(page);
    await visit(page, `#/compare?runs=${runs.map(({ id }) => id)}&t=0`);
    const sizes = [];
    await watch(page, 11, async () => {
      await session.send("HeapProfiler.collectGarbage");
      sizes.push((await session.send("Runtime.getHeapUsage")).usedSize / 1e6);
    });
    tell(name, `${sizes.map((size) => size.toFixed(2)).join(", ")} MB, a minute apart`);
  },
  "list of 10,000 runs": async (name, d, page) => {
    await d.submit({ ...endless(), name: "first" });
    for (let k = 0; k < 10000; k += 8) await Promise.all(Array.from({ length: 8 }, (_, i) => d.submit(tiny({ name: `run ${k + i}` }))));
    const from = performance.now();
    await visit(page, "#/");
    await page.getByText("run 99", { exact: false }).first().waitFor();
    tell(name, `${ms(performance.now() - from)} from nothing to the rows`);
    const older = page.getByRole("button", { name: "Older" });
    const first = () => page.locator("tbody tr a").first().innerText();
    const before = await first();
    const pressed = performance.now();
    await older.click();
    await page.waitForFunction((text) => document.querySelector("tbody tr a").textContent !== text, before);
    tell(name, `${ms(performance.now() - pressed)} to the next page`);
  },
};

try {
  tellSizes();
  for (const [name, run] of Object.entries(benches)) {
    if (!name.includes(word)) continue;
    const d = await daemon(t, { queue_limit: 20000, queue_share: 0, requests_per_minute: 0, work_per_minute: 0 });
    await run(name, d, await openPage(t, d));
  }
} finally {
  for (const action of last) await action();
  await closeBrowser();
}
