// The commands of the README and of the manual (api/docs/) work as pasted, against a real daemon.

import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";

import { daemon } from "./daemon.mjs";
import { binaries, isSanitized, patience, root, temporaryFolder, within } from "./setup.mjs";
import { makeToken } from "./tokens.mjs";

const manual = readdirSync(path.join(root, "api/docs")).map((name) => `api/docs/${name}`);
const documents = Object.fromEntries(["README.md", ...manual].map((name) => [name, readFileSync(path.join(root, name), "utf8")]));

// The blocks of code in a language.
function blocksOf(name, language) {
  return [...documents[name].matchAll(new RegExp(`^\`\`\`${language}\\n(.*?)^\`\`\`$`, "gms"))].map(([, text]) => text);
}

// What a reader types: the lines of `console` blocks behind the prompt.
function typedLines(name) {
  return blocksOf(name, "console").flatMap((block) => [...block.matchAll(/^\$ (.*?)(?:\s+#.*)?$/gm)].map(([, line]) => line));
}

function run(command, args, folder) {
  const done = new Promise((resolve) => {
    const child = spawn(command, args, { cwd: folder });
    let output = "";
    child.stdout.on("data", (chunk) => (output += chunk));
    child.stderr.on("data", (chunk) => (output += chunk));
    child.on("close", (status) => resolve({ status, output }));
  });
  // Studies compute at a low priority beside other stories.
  return within(done, "a document's commands", 2 * patience);
}

// The commands of a text, in one shell, so that what one sets the next one finds.
function paste(lines, d, folder) {
  const script = lines
    .join("\n")
    .replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`)
    .replaceAll("build/release/bin/", `${binaries}/`)
    .replaceAll(/^(beltflowd?) /gm, `${binaries}/$1 `);
  return run("bash", ["-euo", "pipefail", "-c", script], folder);
}

test("every language of a block is one that is tried here or read by another test", () => {
  const known = ["sh", "python", "js", "json", "console", "ini", "yaml", ""];
  for (const [name, text] of Object.entries(documents)) {
    const marks = [...text.matchAll(/^```(.*)$/gm)].map(([, language]) => language);
    assert.equal(marks.length % 2, 0, name);
    assert.deepEqual(marks.filter((language) => !known.includes(language)), [], name);
  }
});

for (const [name, expected] of [
  ["README.md", [/event: end/, /throughput_per_h/]],
  ["api/docs/first_steps.md", [/event: end/, /trial,point,/]],
  ["api/docs/more_over_http.md", [/event: end/, /t_s,upstream,left_domain/, /"kind":"measurement"/]],
]) {
  test(`the commands of ${name} work as pasted`, { skip: isSanitized }, async (t) => {
    const d = await daemon(t);
    const blocks = blocksOf(name, "sh");
    assert.ok(blocks.length >= 1);
    const { status, output } = await paste(blocks, d, temporaryFolder(t));
    assert.equal(status, 0, output);
    for (const pattern of expected) assert.match(output, pattern);
    const { runs } = (await d.get("/v1/runs")).json;
    assert.ok(runs.length >= 1 && runs.every(({ status: state }) => state === "succeeded"));
  });
}

test("the commands of Access make, list, rotate and revoke tokens that count", { skip: isSanitized }, async (t) => {
  const d = await daemon(t);
  // The lines show one store and its token; here they are the daemon's.
  const token = makeToken(d.data, "shell", "--owner", "alice");
  const lines = typedLines("api/docs/access.md").map((line) => line.replaceAll("DATA", d.data));
  assert.equal(lines.length, 5);
  const { status, output } = await paste([`TOKEN=${token}`, "sleep 1.1", ...lines], d, temporaryFolder(t));
  assert.equal(status, 0, output);
  assert.match(output, /"runs": ?\[\]/);
  assert.match(output, /laptop/);
});

// What needs a machine of its own (packages, units, other hosts) is carried out by tests/deploy/package.sh.
test("the commands of Operating have only options that the programs have", { skip: isSanitized }, () => {
  const lines = typedLines("api/docs/operating.md").filter((line) => line.startsWith("beltflow"));
  assert.ok(lines.length >= 4);
  for (const line of lines) {
    const [program, ...words] = line.split(/\s+/);
    const verb = words.find((word, k) => /^[a-z]+$/.test(word) && !(words[k - 1] ?? "").startsWith("--"));
    const asked = program === "beltflow" ? [...words, "--help"] : ["--help"];
    const help = spawnSync(path.join(binaries, program), asked, { encoding: "utf8" });
    const text = help.stdout + help.stderr;
    assert.ok(text.includes(verb), line);
    for (const option of words.filter((word) => word.startsWith("--"))) assert.ok(text.includes(option), `${line}: ${option}`);
  }
});

test("what is shown as JSON is JSON, but for what is left out", () => {
  for (const name of Object.keys(documents)) {
    for (const block of blocksOf(name, "json")) {
      // Several values may follow each other, and … stands for what is left out.
      const values = block.trim().split(/\n(?=\{)/);
      for (const value of values) assert.doesNotThrow(() => JSON.parse(value), `${name}: ${value}`);
    }
  }
});

test("the first steps do in Python and JavaScript what they say", { skip: isSanitized }, async (t) => {
  const d = await daemon(t);
  const folder = temporaryFolder(t);
  // Debian's Python has Debian's NumPy.
  for (const [language, program, file] of [["python", "/usr/bin/python3", "steps.py"], ["js", process.execPath, "steps.mjs"]]) {
    const [block] = blocksOf("api/docs/first_steps.md", language);
    writeFileSync(path.join(folder, file), block.replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`));
    const { status, output } = await run(program, [file], folder);
    assert.equal(status, 0, output);
    assert.match(output, /^at 6 s [\d.e-]+ parts are left$/m);
    assert.match(output, /24000 cells, largest 1\.\d+|\(120, 200\) largest 1\.\d+/);
    assert.match(output, /^\d+\.\d+$/m);
  }
  const { runs } = (await d.get("/v1/runs")).json;
  assert.deepEqual(runs.map(({ status }) => status), Array(4).fill("succeeded"));
});

test("the first steps with studies answer their three questions", { skip: isSanitized }, async (t) => {
  const d = await daemon(t);
  const folder = temporaryFolder(t);
  const [, block] = blocksOf("api/docs/first_steps.md", "python");
  writeFileSync(path.join(folder, "studies.py"), block.replaceAll("127.0.0.1:8080", `127.0.0.1:${d.port}`));
  const { status, output } = await run("/usr/bin/python3", ["studies.py"], folder);
  assert.equal(status, 0, output);
  assert.match(output, /^the best angle is (60|70|80|90)$/m);
  const [, low, high] = /^95 % interval of the throughput: \[([\d.]+), ([\d.]+)\]$/m.exec(output);
  assert.ok(Number(low) < Number(high), output);
  const [, friction] = /^the friction is ([\d.]+)$/m.exec(output);
  assert.ok(Math.abs(Number(friction) - 0.25) < 0.05, output);
});
