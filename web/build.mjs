// Bundles the page into a folder: minified, with a .gz next to each text for servers that send it.
//
//     node web/build.mjs OUT MODULES
//
// OUT is emptied first; MODULES is the node_modules folder that `npm ci` made of package-lock.json.
// The editor of JSON and the reader of drawings, which the page imports when they are needed, become bundles of their own. scenario_schemas.json and the pages
// below OUT/docs, which web/docs makes, follow from api/openapi.json.

import { mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";

const here = path.dirname(fileURLToPath(import.meta.url));
const packed = /\.(?:html|css|js|svg|json|txt)$/;

const [out, modules] = process.argv.slice(2).map((name) => path.resolve(name));
if (!modules) {
  process.stderr.write("usage: node web/build.mjs OUT MODULES\n");
  process.exit(2);
}
const { build } = createRequire(path.join(modules, "package.json"))("esbuild");

const bundled = new Set(); // names of packages

async function bundle(entry, folder, more = {}) {
  const { metafile } = await build({
    entryPoints: [entry],
    outdir: folder,
    bundle: true,
    minify: true,
    format: "esm",
    target: ["es2022"],
    nodePaths: [modules],
    legalComments: "none",
    logLevel: "warning",
    metafile: true,
    ...more,
  });
  for (const input of Object.keys(metafile.inputs)) {
    const found = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (found) bundled.add(found[1]);
  }
}

// What each package asks to go along with copies of it.
function licenceOf(name) {
  const folder = path.join(modules, name);
  const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
  if (!file) throw new Error(`${name} has no text of its licence`);
  return `${name}\n\n${readFileSync(path.join(folder, file), "utf8").trim()}\n`;
}

function copyFolder(from, to) {
  mkdirSync(to, { recursive: true });
  for (const name of readdirSync(from)) writeFileSync(path.join(to, name), readFileSync(path.join(from, name)));
}

// Writes NAME.gz where it is worth it; the same input gives the same bytes.
function packFolder(folder) {
  for (const entry of readdirSync(folder, { withFileTypes: true })) {
    const file = path.join(folder, entry.name);
    if (entry.isDirectory()) packFolder(file);
    else if (packed.test(entry.name)) writeFileSync(`${file}.gz`, gzipSync(readFileSync(file), { level: 9 }));
  }
}

const description = JSON.parse(readFileSync(path.join(here, "../api/openapi.json"), "utf8"));

// What a scenario may have, for the form that is made of it: its schema, and all that it refers to.
function scenarioSchemas() {
  const { schemas } = description.components;
  const found = {};
  const take = (name) => {
    if (found[name]) return;
    found[name] = schemas[name];
    for (const [, other] of JSON.stringify(schemas[name]).matchAll(/"#\/components\/schemas\/(\w+)"/g)) take(other);
  };
  take("Scenario");
  return JSON.stringify(found);
}

// The pages of /docs. Their generator is bundled, too, so that it finds its packages.
async function writeDocs() {
  const tool = path.join(out, "docs.tool.mjs");
  await build({ entryPoints: [path.join(here, "docs/pages.mjs")], outfile: tool, bundle: true, format: "esm", platform: "node", nodePaths: [modules] });
  const { makePages } = await import(pathToFileURL(tool));
  rmSync(tool);
  const { pages, found } = makePages(description);
  for (const { path: name, html } of pages) {
    mkdirSync(path.dirname(path.join(out, name)), { recursive: true });
    writeFileSync(path.join(out, name), html);
  }
  writeFileSync(path.join(docs, "search.json"), JSON.stringify(found));
}

// The folder itself stays: a daemon that serves it has it open.
mkdirSync(out, { recursive: true });
for (const name of readdirSync(out)) rmSync(path.join(out, name), { recursive: true });
copyFolder(path.join(here, "static"), out);
await bundle(path.join(here, "src/main.js"), out, { external: ["./code_editor.js", "./drawing_files.js"] });
for (const part of ["edit/code_editor.js", "board/drawing_files.js"]) await bundle(path.join(here, "src", part), out);
writeFileSync(path.join(out, "scenario_schemas.json"), scenarioSchemas());
const docs = path.join(out, "docs");
copyFolder(path.join(here, "docs/static"), docs);
await bundle(path.join(here, "docs/main.js"), docs);
await writeDocs();
writeFileSync(path.join(out, "licences.txt"), [...bundled].sort().map(licenceOf).join("\n\n"));
packFolder(out);
