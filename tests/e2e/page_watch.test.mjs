// Watching and comparing: Example 1 in both models, from the form to the measures.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test, { after } from "node:test";

import { closeBrowser, numberIn, openPage, visit } from "./browser.mjs";
import { daemon } from "./daemon.mjs";
import { longJam } from "./micro.mjs";
import { endless, jam } from "./scenarios.mjs";
import { until } from "./setup.mjs";

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

// The colour of a cell of Example 1, [red, green, blue].
function colorOf(page, [i, j]) {
  return page.evaluate(([across, up, margin]) => {
    const canvas = document.querySelector("canvas.field");
    const ratio = canvas.width / canvas.clientWidth;
    const place = (share, from, to, size) => Math.floor((from + share * (size - from - to)) * ratio);
    const px = place(across, margin.left, margin.right, canvas.clientWidth);
    const py = place(1 - up, margin.top, margin.bottom, canvas.clientHeight);
    return [...canvas.getContext("2d").getImageData(px, py, 1, 1).data.slice(0, 3)];
  }, [(i + 0.5) / 200, (j + 0.5) / 120, { left: 46, right: 22, top: 12, bottom: 28 }]);
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

    // So it is where the belt is seen larger, and about its middle.
    await page.keyboard.press("+");
    await page.keyboard.press("+");
    await page.waitForURL(/zoom=2.25,0.5,0.5/);
    await probe(page, [0.61, 0.31]);
    const [x, y] = (await page.locator(".tip span").nth(1).innerText()).match(/[\d.]+/g).map(Number);
    assert.ok(Math.abs(x - (0.5 + 0.11 / 2.25)) < 0.003 && Math.abs(y - (0.3 + 0.01 / 2.25)) < 0.003, `${x}, ${y}`);
    await page.keyboard.press("0");
    await page.waitForURL((url) => !url.href.includes("zoom="));
  }

  // What is above the range has a colour of its own, and so has the belt where nothing lies.
  await visit(page, `#/runs/${macro}?t=2&range=1`);
  await page.locator(".stamp:not(.late)", { hasText: "2.0 s" }).waitFor();
  const { density } = (await d.get(`/v1/runs/${macro}/snapshots/20?format=json`)).json;
  const places = density.flatMap((row, j) => row.map((value, i) => ({ value, at: [i, j] })));
  const most = places.reduce((best, cell) => (cell.value > best.value ? cell : best));
  assert.ok(most.value > 1);
  assert.deepEqual(await colorOf(page, most.at), [255, 61, 200]);
  assert.deepEqual(await colorOf(page, places.find(({ value }) => value === 0).at), [125, 138, 152]);

  // A part under the pointer says what it does.
  await visit(page, `#/runs/${micro}?t=2`);
  await page.locator(".stamp:not(.late)", { hasText: "2.0 s" }).waitFor();
  const [header, ...rows] = (await d.get(`/v1/runs/${micro}/parts/20?format=csv`)).text.trim().split("\n").map((line) => line.split(","));
  const of = (row, name) => Number(row[header.indexOf(name)]);
  const part = rows.findIndex((row) => Math.abs(of(row, "x_m") - 0.6) < 0.05);
  await probe(page, [of(rows[part], "x_m"), of(rows[part], "y_m")]);
  await page.locator(".tip", { hasText: `Part ${part + 1}` }).waitFor();
  const speed = await numberIn(page.locator(".tip span", { hasText: "m/s" }));
  const expected = Math.hypot(of(rows[part], "vx_m_s"), of(rows[part], "vy_m_s"));
  assert.ok(Math.abs(speed - expected) <= 0.06 * expected, `${speed} m/s is not ${expected}`);
  await page.locator(".tip", { hasText: "on the belt for 2.0 s" }).waitFor();

  // Both from the list into one view.
  await visit(page, "#/");
  for (const model of ["macro", "micro"]) await page.getByRole("checkbox", { name: `(${model})` }).check();
  await page.getByRole("button", { name: "Compare 2 runs" }).click();
  await page.waitForURL(/#\/compare/);
  await page.locator(".panel").nth(1).waitFor();
  const [first, second] = page.url().match(/runs=([^&]+)/)[1].split(",");
  const { a, b, curve: gap } = (await d.get(`/v1/compare?a=${first}&b=${second}`)).json;

  // Runs are named by what differs, here the model, and their figures are the server's.
  await page.locator(".plot-legend li").nth(1).waitFor();
  const runs = await Promise.all([first, second].map((id) => d.get(`/v1/runs/${id}`)));
  const named = runs.map(({ json: { model, closure } }) => [model, closure].filter(Boolean).join(", "));
  assert.deepEqual(await page.locator(".plot-legend span").allInnerTexts(), named);
  assert.deepEqual(await page.locator(".panel .chip").allInnerTexts(), named);
  const throughput = page.locator(".key-table tbody tr", { hasText: "Throughput" }).locator("td");
  for (const [k, entry] of [a, b].entries()) {
    const shown = await numberIn(throughput.nth(k));
    assert.ok(Math.abs(shown - 3600 * entry.throughput_per_s) <= 500, `${shown} is not ${3600 * entry.throughput_per_s}`);
  }
  await page.getByText("Agreement").click();
  const measuresOf = (what) => page.locator(".measures:not(.key-table) tbody tr", { hasText: what }).locator("td");
  const cells = measuresOf("Mean gap");
  await cells.last().getByText(/\d/).waitFor();
  assert.ok(Math.abs((await numberIn(cells.last())) - gap.l1) < 0.005);

  // Of what has left no rate is negative, and nothing is drained.
  await page.getByRole("combobox", { name: "Counter" }).selectOption("left_domain");
  const { a: left } = (await d.get(`/v1/compare?a=${first}&b=${second}&column=left_domain`)).json;
  const isShown = ([what, value]) => [...document.querySelectorAll(".measures:not(.key-table) tbody tr")].some((row) =>
    row.textContent.startsWith(what) && Math.abs(Number(row.querySelector("td").textContent.replace(",", "")) - value) < 0.1);
  await page.waitForFunction(isShown, ["Throughput", left.throughput_per_s]);
  assert.equal(await measuresOf("Drained").count(), 0);
  await page.getByRole("combobox", { name: "Counter" }).selectOption("upstream");
  await measuresOf("Drained").first().waitFor();

  // The pointer over the plot tells the curve's value there.
  const curve = (await d.get(`/v1/runs/${first}/curve`)).json;
  const { width, height } = await page.locator(".u-over").boundingBox();
  await page.locator(".u-over").hover({ position: { x: width / 4, y: height / 2 } });
  const tip = page.locator(".plot .tip");
  await tip.waitFor();
  const at = await numberIn(tip.locator("strong"));
  assert.ok(Math.abs(at - 1.5) < 0.02, `${at} s is not a quarter of 6 s`);
  const after = curve.t_s.findIndex((time) => time > at);
  const share = (at - curve.t_s[after - 1]) / (curve.t_s[after] - curve.t_s[after - 1]);
  const { upstream } = curve.columns;
  const value = upstream[after - 1] + share * (upstream[after] - upstream[after - 1]);
  assert.ok(Math.abs((await numberIn(tip.locator("b").first())) - value) < 0.5);

  // The other run becomes the reference; the difference of both is the larger one's turned round.
  await page.getByRole("combobox", { name: "Reference" }).selectOption("1");
  await measuresOf("Mean gap").first().getByText(/\d/).waitFor();
  assert.match(page.url(), new RegExp(`reference=${second}`));
  await page.getByRole("button", { name: "Difference" }).click();
  await page.locator(".plot-legend li").nth(1).waitFor({ state: "detached" });
  await page.getByRole("button", { name: "Counts", exact: true }).click();
  await page.getByRole("combobox", { name: "Reference" }).selectOption("0");

  // Counts that were measured: 5 parts more than the first run has, at each time; as a spreadsheet writes them.
  const comma = (number) => String(number).replace(".", ",");
  const csv = ["Zeit;Teile", ...curve.t_s.map((time, k) => `${comma(time)};${comma(curve.columns.upstream[k] + 5)}`)].join("\n");
  await page.locator(".card.curve").evaluate((card, text) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([text], "belt.csv", { type: "text/csv" }));
    for (const type of ["dragover", "drop"]) card.dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
  }, csv);
  const laid = page.locator(".plot-legend", { hasText: "measured: belt.csv" });
  await laid.waitFor();
  await cells.nth(2).getByText(/^5(?:\.0*)?$/).waitFor();
  await page.setInputFiles('input[type="file"]', { name: "bad.csv", mimeType: "text/csv", buffer: Buffer.from("t_s,count\n1,x") });
  await page.getByText("bad.csv: Line 2").waitFor();

  // They are stored, of this counter alone, and in the address; a run of the address that is gone takes nothing else away.
  const gone = "01a1f916-75bc-759c-9d74-cbbf3fe9393f";
  await visit(page, page.url().replace(/^[^#]*/, "").replace(first, `${first},${gone}`));
  await laid.waitFor();
  await page.getByText(`Run ${gone.slice(-8)} of this address was deleted`).waitFor();
  assert.equal(await page.locator(".panel").count(), 2);
  await page.getByRole("combobox", { name: "Counter" }).selectOption("left_domain");
  await laid.waitFor({ state: "detached" });

  // One clock for both.
  await page.keyboard.press("Escape");
  await pause(page);
  await slider.fill("3");
  await page.getByText("3.0 / 6.0 s").waitFor();
  assert.equal(await page.getByRole("status").filter({ hasText: "6.0 s" }).count(), 0, "the clock announces itself");
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
  assert.match(await page.getByRole("link", { name: "Density shown, NPY" }).getAttribute("href"), /snapshots\/2\.npy$/);
  await csv.focus();
  assert.equal(await page.locator(".curl").innerText(), `curl -sS -o curve.csv '${d.url}v1/runs/${run.id}/curve.csv'`);
  const waiting = page.waitForEvent("download");
  await page.locator("li", { hasText: "Picture as seen" }).getByRole("button").click();
  assert.equal((await waiting).suggestedFilename(), "example-1-singularizer-at-60-degrees-macro-0.2s.png");
  const recording = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save film" }).click();
  // H.264 in MP4, which not every browser writes: "ftyp" in its first box; a WebM begins with the mark of EBML.
  const film = await recording;
  const ending = film.suggestedFilename().slice("example-1-singularizer-at-60-degrees-macro-0.2s.".length);
  const head = readFileSync(await film.path()).subarray(0, 8).toString("latin1");
  assert.match(head, { mp4: /^....ftyp/s, webm: /^\x1aE\xdf\xa3/ }[ending]);
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  assert.equal(await page.getByRole("navigation", { name: "Views" }).isVisible(), false);
  for (const controls of [".transport", ".scene-row"]) assert.equal(await page.locator(controls).first().isVisible(), false, `${controls} on paper`);
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).color), "rgb(24, 34, 45)", "text is dark on paper");
});

// A connection with a latency of 100 ms and 500 kB/s.
async function slowDown(page) {
  const session = await page.context().newCDPSession(page);
  await session.send("Network.enable");
  await session.send("Network.emulateNetworkConditions",
    { offline: false, latency: 100, downloadThroughput: 500e3, uploadThroughput: 500e3 });
}

test("one request gets several pictures that follow each other", async (t) => {
  const d = await daemon(t);
  const run = await d.submit(jam(6, { curve_every_s: 0.5, snapshot_every_s: 0.1 }));
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d);
  const asked = []; // pictures of each request
  page.on("request", (request) => {
    const { pathname, searchParams } = new URL(request.url());
    if (/snapshots\/\d+$/.test(pathname)) asked.push(Number(searchParams.get("count") ?? 1));
  });
  await visit(page, `#/runs/${run.id}?t=0`);
  // The first ones come one by one, so that something is shown soon; 48 are fetched ahead.
  await until(() => asked.reduce((sum, n) => sum + n, 0) >= 48, "48 pictures to be asked for");
  assert.ok(asked.length <= 20, `${asked.length} requests: ${asked}`);
});

test("the columns of parts are asked for once while the answer is on its way, whatever snapshots come", async (t) => {
  const d = await daemon(t);
  const first = await d.submit(endless());
  const run = await d.submit(longJam(), { model: "micro" });
  const page = await openPage(t, d);
  const held = [];
  await page.route("**/snapshots", (route) => void held.push(route));
  await visit(page, `#/runs/${run.id}`);
  await page.locator(".pill", { hasText: "queued" }).first().waitFor();
  await d.post(`/v1/runs/${first.id}/cancel`, "");
  await d.reached(run.id, "succeeded");
  await page.locator(".verdict", { hasText: "192 of 192 parts are still on the belt" }).waitFor(); // what comes with the end
  assert.equal(held.length, 1);

  await held[0].continue();
  await page.waitForFunction(() => performance.getEntriesByName("first-frame").length > 0);
});

test("on a slow connection every picture that is asked for arrives, and the clock of a live run is its time", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  const lost = [];
  page.on("requestfailed", (request) => /snapshots\/\d/.test(request.url()) && lost.push(request.url()));
  await visit(page, "#/");
  await slowDown(page);
  // Tens of snapshots a second, of 24 kB each: more than the connection carries.
  const run = await d.submit(jam(2000, { curve_every_s: 10, snapshot_every_s: 0.5 }));
  await visit(page, `#/runs/${run.id}`);
  const contradictions = await page.evaluate(() => new Promise((resolve) => {
    const [times, found] = [new Set(), []];
    const look = () => {
      const [stamp, clock] = [".stamp:not([hidden])", ".clock"].map((name) => document.querySelector(name)?.textContent);
      if (stamp) times.add(stamp);
      if (stamp && stamp.split(" ")[0] !== clock.split(" ")[0]) found.push([stamp, clock]);
      if (times.size > 10) resolve(found);
      else requestAnimationFrame(look);
    };
    look();
  }));
  assert.deepEqual(contradictions, []);
  assert.deepEqual(lost, []);

  // Most of the snapshots of the first ten seconds were left out. One that is asked for is shown late, and until then the
  // picture says so.
  const isSeenLate = await page.getByRole("slider", { name: "Time" }).evaluate((slider) =>
    Array.from({ length: 20 }, (_, k) => k / 2).some((time) => {
      slider.value = String(time);
      slider.dispatchEvent(new Event("input"));
      return document.querySelector(".stamp").textContent.endsWith("loading …");
    }));
  assert.ok(isSeenLate);
  await page.locator(".stamp:not(.late)").waitFor();
  await page.goto("about:blank");
  await d.post(`/v1/runs/${run.id}/cancel`, "");
});

test("parts that are counted one by one are whole between samples, too", async (t) => {
  const d = await daemon(t);
  const example = (await d.get("/v1/examples/example-1-implicit")).json;
  const run = await d.submit({ ...example, duration_s: 3 }, { model: "micro" });
  await d.reached(run.id, "succeeded");
  const page = await openPage(t, d);
  await visit(page, `#/runs/${run.id}?t=1.5`);
  await page.locator(".u-over").waitFor();
  await page.getByRole("button", { name: "Play", exact: true }).click();
  const texts = await page.evaluate(() => new Promise((resolve) => {
    const seen = new Set();
    const look = (now) => {
      seen.add(document.querySelector(".plot-legend b").textContent);
      if (seen.size < 30 && now < begin + 3000) requestAnimationFrame(look);
      else resolve([...seen]);
    };
    const begin = performance.now();
    requestAnimationFrame(look);
  }));
  assert.ok(texts.length > 3, String(texts));
  assert.deepEqual(texts.filter((text) => !/^\d+$/.test(text)), []);
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
  for (const address of ["#/nothing", "#/%E0%A4%A"]) {
    await visit(page, address);
    await page.getByRole("heading", { name: "There is no such view" }).waitFor();
  }
});
