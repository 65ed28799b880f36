// The pages of /docs, of the document of the API: an index, a page for each chapter of its description, each operation, each
// kind of problem and each schema, and the list that the search looks through.

import { anchorOf, code, escape, frame, inline, link, list, markdown } from "./html.mjs";
import { callOf, operationPages, operationsOf, pathOf, problemOf } from "./operations.mjs";
import { schemaPages } from "./schemas.mjs";

const TEXT_MOST = 400; // characters of a text that the search knows

// The parts of a Markdown text that begin with a heading of this rank; the first one has none.
function split(text, rank) {
  const mark = `${"#".repeat(rank)} `;
  const parts = [{ title: "", lines: [] }];
  let isCode = false;
  for (const line of text.split("\n")) {
    if (line.startsWith("```")) isCode = !isCode;
    if (!isCode && line.startsWith(mark)) parts.push({ title: line.slice(mark.length), lines: [] });
    else parts.at(-1).lines.push(line);
  }
  return parts.map(({ title, lines }) => ({ title, text: lines.join("\n").trim() }));
}

// Headings of a chapter stand one rank below its title, which is the page's.
function chapterPage({ title, text }) {
  const [intro, ...sections] = split(text, 3);
  const raised = [intro.text, ...sections.map((section) => `## ${section.title}\n\n${section.text}`)].join("\n\n");
  return { path: `/docs/${anchorOf(title)}.html`, title, kind: "chapter", text: intro.text, html: frame(title, [], markdown(raised)),
    parts: sections.map((section) => ({ anchor: anchorOf(section.title), title: `${title}: ${section.title}`, kind: "section", text: section.text })) };
}

function problemPages(document, chapter) {
  const operations = operationsOf(document);
  return split(chapter.text, 3).slice(1).map(({ title, text }) => {
    const word = title.split(" ")[1];
    const [name, refusal] = Object.entries(document.components.responses).find(([, answer]) => problemOf(answer) === word);
    const from = operations.filter(({ responses }) => Object.values(responses).some(({ $ref }) => $ref?.endsWith(`/${name}`)));
    const sample = refusal.content["application/problem+json"].example;
    const body = [markdown(text), "<h2>Example</h2>", code(JSON.stringify(sample, null, 2)), "<h2>Operations that refuse so</h2>",
      from.length === operations.length ? "<p>All.</p>" : list(from.map((o) => `${link(pathOf(o), o.operationId)}: ${inline(o.summary)}`))];
    return { path: `/docs/problems/${word}.html`, title, kind: "problem", text,
      html: frame(title, [link("/docs#problems", "Problems")], body.join("\n")), parts: [] };
  });
}

function indexPage(document, intro, chapters, problems, schemas) {
  const operations = operationsOf(document);
  const lines = (pages) => list(pages.map(({ path, title }) => link(path, escape(title))));
  const ofTag = (tag) => operations.filter(({ tags }) => tags.includes(tag));
  const tags = document.tags.map(({ name, description }) => `<h3 id="${name.toLowerCase()}">${escape(name)}</h3>
<p>${inline(description)}</p>
${list(ofTag(name).map((o) => `${link(pathOf(o), callOf(o))} ${inline(o.summary)}`))}`);
  const body = [
    markdown(intro), `<p>All of this is made of ${link("/openapi.json", "/openapi.json")}, an OpenAPI document.</p>`,
    "<h2>Manual</h2>", lines(chapters), "<h2>Operations</h2>", ...tags,
    '<h2 id="problems">Problems</h2>', lines(problems),
    '<h2 id="schemas">Schemas</h2>', `<p class="dense">${schemas.map(({ path, title }) => link(path, escape(title))).join(" ")}</p>`];
  return { path: "/docs/index.html", html: frame("Manual and API", [], body.join("\n")) };
}

const short = (text) => text.replace(/\s+/g, " ").slice(0, TEXT_MOST);

// [{ path, html }] of all pages, and [[kind, title, path, text]] of all that can be found.
export function makePages(document) {
  const [intro, ...chapters] = split(document.info.description, 2);
  const manual = chapters.map(chapterPage);
  const problems = problemPages(document, chapters.find(({ title }) => title === "Problems"));
  const schemas = schemaPages(document);
  const pages = [...operationPages(document), ...manual, ...problems, ...schemas];
  const found = pages.flatMap(({ path, title, kind, text, parts }) => [[kind, title, path, short(text)],
    ...parts.map((part) => [part.kind, part.title, `${path}#${part.anchor}`, short(part.text)])]);
  return { pages: [indexPage(document, intro.text, manual, problems, schemas), ...pages], found };
}
