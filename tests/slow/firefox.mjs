// The page in Firefox, by hand: needs firefox-esr of Debian (or FIREFOX, a program) and a built page. The stories drive Chromium,
// since the client library that they use needs a Firefox of its own; this one speaks Firefox's protocol Marionette itself.
//
//     node --test tests/slow/firefox.mjs

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import net from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import test from "node:test";

import { daemon } from "../e2e/daemon.mjs";
import { until } from "../e2e/setup.mjs";

const ELEMENT = "element-6066-11e4-a52e-4f735466cecf"; // the key of an element, by the standard WebDriver

// Commands of WebDriver over a socket: a message is its length, a colon, and [0, id, command, parameters] or [1, id, error, result].
class Marionette {
  constructor(socket) {
    Object.assign(this, { socket, bytes: Buffer.alloc(0), waiting: new Map(), n: 0 });
    socket.on("data", (data) => this.take(data));
  }

  take(data) {
    this.bytes = Buffer.concat([this.bytes, data]);
    for (let colon; (colon = this.bytes.indexOf(":")) > 0;) {
      const end = colon + 1 + Number(this.bytes.subarray(0, colon));
      if (this.bytes.length < end) return;
      const message = JSON.parse(this.bytes.subarray(colon + 1, end));
      this.bytes = this.bytes.subarray(end);
      if (!Array.isArray(message)) continue; // the greeting
      const [, id, error, result] = message;
      const { resolve, reject } = this.waiting.get(id);
      if (error) reject(new Error(`${error.error}: ${error.message}`));
      else resolve(result !== null && typeof result === "object" && "value" in result ? result.value : result);
    }
  }

  send(command, parameters = {}, group = "WebDriver") {
    const id = ++this.n, text = JSON.stringify([0, id, `${group}:${command}`, parameters]);
    this.socket.write(`${Buffer.byteLength(text)}:${text}`);
    return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
  }

  run(script, ...args) {
    return this.send("ExecuteScript", { script, args });
  }
}

async function firefox(t) {
  const profile = mkdtempSync(path.join(tmpdir(), "beltflow-firefox-"));
  // Port 0: any that is free.
  writeFileSync(path.join(profile, "user.js"), Object.entries({ "marionette.port": 0, "intl.accept_languages": "de-DE", "app.update.disabledForTesting": true,
    "datareporting.policy.dataSubmissionEnabled": false, "browser.shell.checkDefaultBrowser": false })
    .map(([name, value]) => `user_pref(${JSON.stringify(name)}, ${JSON.stringify(value)});\n`).join(""));
  const child = spawn(process.env.FIREFOX ?? "firefox-esr", ["--headless", "--marionette", "--no-remote", "--profile", profile, "--width", "1366", "--height", "768"],
    { stdio: "ignore" });
  const ended = new Promise((resolve) => child.on("exit", resolve));
  const port = path.join(profile, "MarionetteActivePort");
  await until(() => existsSync(port) && readFileSync(port, "utf8") !== "", "Firefox listens");
  const browser = new Marionette(net.connect(Number(readFileSync(port, "utf8")), "127.0.0.1"));
  await browser.send("NewSession");
  t.after(async () => {
    await browser.send("Quit", { flags: ["eForceQuit"] }, "Marionette");
    await ended;
    browser.socket.destroy();
    rmSync(profile, { recursive: true, force: true });
  });
  return browser;
}

test("the page does in Firefox what a planner asks of it", async (t) => {
  const d = await daemon(t);
  const browser = await firefox(t);
  const find = (xpath) => until(async () => (await browser.send("FindElements", { using: "xpath", value: xpath }))[0], xpath);
  const press = async (xpath) => browser.send("ElementClick", { id: (await find(xpath))[ELEMENT] });
  const button = (text) => press(`//button[normalize-space()="${text}"] | //a[normalize-space()="${text}"]`);
  const type = async (label, text) => {
    const { [ELEMENT]: id } = await find(`//label[contains(., "${label}")]//input | //input[@id = //label[contains(., "${label}")]/@for]`);
    await browser.send("ElementClear", { id });
    await browser.send("ElementSendKeys", { id, text });
  };
  const seen = (script) => until(() => browser.run(`return ${script}`), script);
  // Whatever is thrown in the page is kept, also across the views, which one document shows.
  await browser.send("Navigate", { url: d.url });
  await browser.run("window.faults = []; for (const kind of ['error', 'unhandledrejection', 'securitypolicyviolation']) addEventListener(kind, (event) => faults.push(String(event.message ?? event.reason ?? event.violatedDirective)))");

  // Example 1 in both models, from the first visit: drawn, played, with its curves.
  await button("Run Example 1 in both models");
  await seen("document.querySelectorAll('.pill[data-state=succeeded]').length === 2");
  await seen("performance.getEntriesByName('first-frame').length > 0");
  await seen("[...document.querySelectorAll('.stage canvas, canvas')].some((one) => one.getContext('2d')?.getImageData(0, 0, one.width, one.height).data.some((byte) => byte > 0))");
  await seen("document.querySelectorAll('.plot-legend').length > 0");

  // A line from nothing on the board, numbers as Germans type them, in both models.
  await button("Lines");
  await button("New line");
  await seen("document.querySelector('.submit-row .verdict')?.textContent.startsWith('Ready:')");
  await type("Line, along x", "1,5");
  await type("Duration", "20");
  await type("Warm-up", "5");
  await button("+ Deflector");
  await type("Angle", "50");
  await seen("JSON.parse(localStorage.getItem('beltflow-lines'))[0].scenario.obstacles?.[0].angle_deg === 50");
  await seen("document.querySelector('.submit-row .verdict')?.textContent.startsWith('Ready:')");
  await button("Run both models");
  await seen("/compare\\?runs=/.test(location.hash)");
  await seen("document.querySelectorAll('.pill[data-state=succeeded]').length === 2");
  const { runs } = (await d.get("/v1/runs?line=My%20line")).json;
  assert.deepEqual(runs.map((run) => run.line_version), [1, 1]);
  assert.deepEqual((await d.get(`/v1/runs/${runs[0].id}/scenario`)).json.domain.x_m, [0, 1.5]);

  // It is found among the lines.
  await button("Lines");
  await button("My line");
  await find('//strong[.="Version 1"]');
  // A drawing that changes the height of its own box is told of it in the next frame, which Firefox notes as an error.
  assert.deepEqual(await browser.run("return faults.filter((fault) => !fault.startsWith('ResizeObserver loop'))"), []);
});
