// Pieces of HTML: texts, Markdown, tables, and the frame that all pages of /docs have.

import { Marked } from "marked";

export const escape = (text) =>
  String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);

export const anchorOf = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-|-$/g, "");

// Wide tables scroll in themselves; headings have anchors, and their ranks begin below the page's.
const renderer = {
  heading({ tokens, depth, text }) {
    return `<h${depth} id="${anchorOf(text)}">${this.parser.parseInline(tokens)}</h${depth}>\n`;
  },
  code({ text }) {
    return code(text);
  },
  html({ text }) {
    return escape(text);
  },
};
const marked = new Marked({ renderer, gfm: true });

const inScroller = (html) => html.replaceAll("<table>", '<div class="scroll" tabindex="0"><table>').replaceAll("</table>", "</table></div>");

export const markdown = (text) => inScroller(marked.parse(text));
export const inline = (text) => marked.parseInline(text);

export const code = (text) => `<pre tabindex="0"><code>${escape(text)}</code></pre>\n`;
export const link = (target, html) => `<a href="${escape(target)}">${html}</a>`;

export function table(heads, rows) {
  const cells = (tag, list) => list.map((html) => `<${tag}>${html}</${tag}>`).join("");
  return `<div class="scroll" tabindex="0"><table><thead><tr>${cells("th", heads)}</tr></thead>
<tbody>${rows.map((row) => `<tr>${cells("td", row)}</tr>`).join("\n")}</tbody></table></div>\n`;
}

export const list = (items) => `<ul>${items.map((html) => `<li>${html}</li>`).join("\n")}</ul>\n`;

// trail: what leads to the page, as links.
export function frame(title, trail, body) {
  return `<!doctype html>
<html lang="en">
  <head>
    <meta charset="utf-8">
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <title>${escape(title)} - Beltflow</title>
    <link rel="stylesheet" href="/docs/docs.css">
    <script src="/docs/main.js" type="module"></script>
  </head>
  <body>
    <header>
      <nav aria-label="Where this is">${[link("/", "Beltflow"), link("/docs", "Manual and API"), ...trail].join(" / ")}</nav>
      <form role="search" action="/docs" method="get">
        <label for="q">Search</label>
        <input id="q" name="q" type="search" autocomplete="off" placeholder="an operation, a member, a problem">
      </form>
    </header>
    <section id="found" aria-label="What was found" aria-live="polite" hidden></section>
    <main>
<h1>${inline(title)}</h1>
${body}
    </main>
  </body>
</html>
`;
}
