// The page's files, as the daemon gives them.

import assert from "node:assert/strict";
import { readFileSync, readdirSync, statSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { runProgram } from "./processes.mjs";
import { hasPage, temporaryFolder, web } from "./setup.mjs";

const needsPage = { skip: !hasPage && "the page was not built" };

test("the page and what it needs come from the daemon, with their types", needsPage, async (t) => {
  const d = await daemon(t);
  for (const [target, file, type] of [
    ["/", "index.html", /^text\/html/],
    ["/main.js", "main.js", /^text\/javascript/],
    ["/main.css", "main.css", /^text\/css/],
  ]) {
    const answer = await d.get(target);
    assert.equal(answer.status, 200, target);
    assert.match(answer.headers["content-type"], type);
    assert.equal(answer.text, readFileSync(path.join(web, file), "utf8"));
  }
});

test("the licences of all that is bundled go along with it", needsPage, () => {
  const text = readFileSync(path.join(web, "licences.txt"), "utf8");
  for (const name of ["uplot", "papaparse", "@codemirror/view"]) {
    assert.match(text, new RegExp(`^${name}\\n\\n[^]*?Copyright`, "m"));
  }
});

test("the page is smaller than 200 kB, compressed, and so is the editor of JSON, which it loads on demand", needsPage, () => {
  const packed = readdirSync(web).filter((name) => name.endsWith(".gz"));
  const sizes = new Map(packed.map((name) => [name, statSync(path.join(web, name)).size]));
  assert.ok(sizes.has("main.js.gz"));
  const editor = sizes.get("code_editor.js.gz");
  const rest = [...sizes.values()].reduce((sum, size) => sum + size, 0) - editor;
  assert.ok(rest < 200_000 && editor < 200_000, JSON.stringify([...sizes]));
});

test("the page runs nothing inline and loads nothing from elsewhere", needsPage, async (t) => {
  const d = await daemon(t);
  const page = (await d.get("/")).text;
  assert.doesNotMatch(page, /<script(?![^>]*\bsrc=)/);
  assert.doesNotMatch(page, /\son\w+=|<style|\sstyle=|javascript:/);
  for (const [, target] of page.matchAll(/(?:src|href)="([^"#]+)"/g)) {
    assert.doesNotMatch(target, /^(?:https?:)?\/\//);
    assert.equal((await d.get(target.startsWith("/") ? target : `/${target}`)).status, 200, target);
  }
});

test("no file outside the page's folder is given", async (t) => {
  const d = await daemon(t);
  for (const target of ["/../README.md", "/%2e%2e/README.md", "/..%2fREADME.md", "//etc/passwd", "/CMakeLists.txt"]) {
    assert.notEqual((await d.get(target)).status, 200, target);
  }
});

test("a daemon whose folder holds no page says so at its address, and serves the rest", async (t) => {
  const d = await daemon(t, { web: temporaryFolder(t) });
  const answer = await d.get("/");
  assert.deepEqual([answer.status, answer.headers["content-type"]], [404, "application/problem+json"]);
  assert.equal((await d.get("/livez")).status, 200);
});

test("a daemon that is told of a folder that is not there does not start", async (t) => {
  const data = temporaryFolder(t);
  const web = path.join(data, "none");
  const done = await runProgram("beltflowd", ["--data", data, "--web", web, "--listen", "127.0.0.1:0"]);
  assert.equal(done.status, 1);
  assert.match(done.stderr, /none/);
});
