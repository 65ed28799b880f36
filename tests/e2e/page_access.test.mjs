// The page of a daemon with tokens: signing in, watching, downloading, signing out.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import http from "node:http";
import path from "node:path";
import test, { after } from "node:test";

import { assertAccessible, closeBrowser, openPage, takePicture, visit } from "./browser.mjs";
import { document } from "./contract.mjs";
import { daemon } from "./daemon.mjs";
import { endless, tiny } from "./scenarios.mjs";
import { temporaryFolder, until } from "./setup.mjs";
import { beltflowd, makeToken } from "./tokens.mjs";

after(closeBrowser);

// A daemon with a token of alice; what a request of hers has.
async function guarded(t) {
  const data = path.join(temporaryFolder(t), "data");
  const token = makeToken(data, "alice");
  const d = await daemon(t, { data });
  return { d, data, token, headers: { authorization: `Bearer ${token}` } };
}

const dialogOf = (page) => page.getByRole("dialog", { name: "Sign in" });

async function signIn(page, token) {
  const dialog = dialogOf(page);
  await dialog.getByLabel("Access token").fill(token);
  await dialog.getByRole("button", { name: "Sign in" }).click();
}

async function submit(d, headers, body) {
  const { status, json, text } = await d.post("/v1/runs", { fresh: true, ...body }, headers);
  assert.equal(status, 201, text);
  return json.id;
}

// What a click on a link saves.
async function saved(page, name) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("link", { name }).click()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

test("the dialog passes axe and fits, in light and dark, wide and narrow", async (t) => {
  const { d } = await guarded(t);
  for (const [scheme, size] of [["light", "wide"], ["light", "phone"], ["dark", "wide"]]) {
    const page = await openPage(t, d, { scheme, size });
    await visit(page, "#/");
    await dialogOf(page).waitFor();
    await signIn(page, "nonsense");
    await page.getByText("this is no access token").waitFor();
    await takePicture(page, `sign-in-${size}-${scheme}`, size);
    await assertAccessible(page, `sign-in ${size} ${scheme}`);
  }
});

test("a wrong token is told so, a right one opens the view that was asked for, and Escape nothing", async (t) => {
  const { d, data, token, headers } = await guarded(t);
  const id = await submit(d, headers, { scenario: tiny({ name: "Hers" }) });
  const page = await openPage(t, d);
  await visit(page, `#/runs/${id}`);
  await dialogOf(page).waitFor();
  await page.keyboard.press("Escape");
  for (const wrong of [`${token.slice(0, -2)}xx`, "umlaut ä", makeToken(data, "writer", "--scopes", "submit")]) {
    await signIn(page, wrong);
    await dialogOf(page).getByText(/no access token|lacks the scope read/).waitFor();
  }
  await signIn(page, token);
  await page.getByRole("heading", { name: "Hers" }).waitFor();
  assert.equal(await dialogOf(page).count(), 0);
  await page.reload();
  await page.getByRole("heading", { name: "Hers" }).waitFor();
});

test("a run is watched live and downloaded, and the token is in no address", async (t) => {
  const { d, token, headers } = await guarded(t);
  const example = (await d.get("/v1/examples/example-1", headers)).json;
  const addresses = [];
  const page = await openPage(t, d);
  page.on("request", (request) => addresses.push(request.url()));
  await visit(page, "#/");
  await signIn(page, token);
  await page.getByText("No runs yet.").waitFor();
  const live = await submit(d, headers, { scenario: endless() });
  await visit(page, `#/runs/${live}`);
  await until(() => addresses.some((address) => /\/v1\/events\?.*ticket=/.test(address)), "the run to be followed");
  assert.equal((await d.post(`/v1/runs/${live}/cancel`, "", headers)).status, 202);
  await page.locator(".pill", { hasText: "cancelled" }).waitFor();
  const id = await submit(d, headers, { scenario: example, model: "micro" });
  await visit(page, `#/runs/${id}`);
  await page.locator(".pill", { hasText: "succeeded" }).waitFor();
  await page.getByText("Parts at start").waitFor();

  const curve = await saved(page, "Curve, CSV");
  assert.equal(curve.name, "curve.csv");
  assert.equal(curve.bytes.toString(), (await d.get(`/v1/runs/${id}/curve?format=csv`, headers)).text);
  const archive = await saved(page, "Everything, ZIP");
  assert.equal(archive.bytes.subarray(0, 2).toString(), "PK");
  assert.match(await page.locator("code.curl").innerText(), /-H "Authorization: Bearer \$TOKEN"/);
  assert.ok(!addresses.some((address) => address.includes(token.slice(4, 20))), addresses.join("\n"));
  assert.ok(!(await page.content()).includes(token.slice(4, 20)));
});

test("who signs out leaves nothing behind, and deletes what was to be deleted", async (t) => {
  const { d, token, headers } = await guarded(t);
  const id = await submit(d, headers, { scenario: tiny({ name: "Hers" }) });
  const page = await openPage(t, d);
  await visit(page, "#/");
  await signIn(page, token);
  await page.getByRole("button", { name: /^Delete/ }).click();
  await page.getByText("Deleted").waitFor();
  await page.getByRole("button", { name: "Sign out" }).click();
  await dialogOf(page).waitFor();
  assert.equal(await page.evaluate(() => sessionStorage.length), 0);
  assert.equal(await page.getByText("Hers").count(), 0);
  assert.equal(await page.getByRole("button", { name: "Sign out", includeHidden: true }).isVisible(), false);
  await until(async () => (await d.get(`/v1/runs/${id}`, headers)).status === 404, "the run to be removed");
});

test("a token that is revoked while one watches is asked for again, and the view goes on", async (t) => {
  const { d, data, token, headers } = await guarded(t);
  const id = await submit(d, headers, { scenario: endless() });
  const page = await openPage(t, d);
  await visit(page, "#/");
  await signIn(page, token);
  await page.locator(".pill", { hasText: "running" }).waitFor();
  assert.equal(beltflowd(data, "token", "revoke", "1").status, 0);
  await dialogOf(page).getByText("the access token was revoked").waitFor();
  const another = makeToken(data, "again", "--owner", "alice");
  const anew = { authorization: `Bearer ${another}` };
  await until(async () => (await d.get("/v1/runs", anew)).status === 200, "the daemon to see the token");
  await signIn(page, another);
  assert.equal((await d.post(`/v1/runs/${id}/cancel`, "", anew)).status, 202);
  await page.locator(".pill", { hasText: "cancelled" }).waitFor();
});

test("a link shows one run to who has no token, until it is revoked", async (t) => {
  const { d, token, headers } = await guarded(t);
  const id = await submit(d, headers, { scenario: tiny({ name: "Hers" }) });
  const page = await openPage(t, d);
  await visit(page, `#/runs/${id}`);
  await signIn(page, token);
  await page.getByRole("button", { name: "Share …" }).click();
  const dialog = page.getByRole("dialog", { name: "Share this run" });
  await dialog.getByLabel("Counts for").selectOption("7 days");
  await dialog.getByRole("button", { name: "Make a link" }).click();
  const link = await dialog.locator("code.address").innerText();
  await assertAccessible(page, "the dialog of links");
  await takePicture(page, "share", "wide");

  const guest = await openPage(t, d);
  await guest.goto(link);
  await guest.getByRole("heading", { name: "Hers" }).waitFor();
  await guest.getByText("Parts at start").waitFor();
  assert.ok(!guest.url().includes("bft_"), guest.url());
  for (const name of ["Share …", "Rename …", "Delete", "Star"]) assert.equal(await guest.getByRole("button", { name }).count(), 0, name);
  assert.equal(await guest.getByRole("navigation", { name: "Views" }).isVisible(), false);
  await guest.reload();
  await guest.getByRole("heading", { name: "Hers" }).waitFor();
  assert.equal((await saved(guest, "Curve, CSV")).name, "curve.csv");
  await assertAccessible(guest, "a guest's run");

  await dialog.getByRole("button", { name: "Revoke link 2" }).click();
  await dialog.locator("li").waitFor({ state: "detached" });
  await guest.reload();
  await dialogOf(guest).getByText("the access token was revoked").waitFor();
});

test("without tokens a run is shared by its address", async (t) => {
  const d = await daemon(t);
  const id = await submit(d, {}, { scenario: tiny({ name: "Anybody's" }) });
  const page = await openPage(t, d);
  await visit(page, `#/runs/${id}`);
  await page.getByRole("button", { name: "Share …" }).click();
  const dialog = page.getByRole("dialog", { name: "Share this run" });
  assert.equal(await dialog.locator("code.address").innerText(), `${d.url}#/runs/${id}`);
  assert.equal(await dialog.getByRole("button", { name: "Make a link" }).count(), 0);
});

test("without tokens nobody is asked", async (t) => {
  const d = await daemon(t);
  const page = await openPage(t, d);
  await visit(page, "#/");
  await page.getByText("No runs yet.").waitFor();
  assert.equal(await dialogOf(page).count(), 0);
  assert.equal(await page.getByRole("button", { name: "Sign out" }).count(), 0);
});

// A server whose pages are empty; its origin.
async function otherOrigin(t) {
  const server = http.createServer((request, response) => response.setHeader("Content-Type", "text/html").end("<p>"));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  t.after(() => server.close());
  return `http://127.0.0.1:${server.address().port}`;
}

test("the document's code follows a run and shows a picture on a page of another origin", async (t) => {
  const origin = await otherOrigin(t);
  const data = path.join(temporaryFolder(t), "data");
  const token = makeToken(data, "alice");
  const d = await daemon(t, { data, cors_origins: origin });
  const id = await submit(d, { authorization: `Bearer ${token}` }, { scenario: tiny() });
  const section = document.info.description.split("## From another origin")[1];
  const [, code] = /```js\n(.*?)```/s.exec(section);
  const page = await openPage(t, { url: "http://127.0.0.1" }); // both
  await page.goto(origin);
  // The first stream is torn before it begins.
  await page.route("**/events?*", (route) => route.abort(), { times: 1 });
  const told = await page.evaluate(async ({ text, run }) => {
    const { follow, show } = new Function(`${text}; return { follow, show };`)();
    const kinds = [];
    await follow(run, (kind) => kinds.push(kind));
    const image = new Image();
    const shown = new Promise((resolve) => (image.onload = image.onerror = resolve));
    await show(image, run, 0);
    await shown;
    return { kinds, width: image.naturalWidth };
  }, { text: code.replace(/^const base = .*$/m, `const base = "${new URL(d.url).origin}", token = "${token}";`), run: id });
  assert.equal(told.kinds.filter((kind) => kind === "end").length, 1);
  assert.ok(told.kinds.includes("curve"));
  assert.ok(told.width > 0);
});
