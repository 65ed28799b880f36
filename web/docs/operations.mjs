// A page for each operation: what it does, what is sent, what is answered, with the examples that were recorded.

import { code, escape, frame, inline, link, list, markdown, table } from "./html.mjs";
import { example, outline, typeOf } from "./schemas.mjs";

const METHODS = ["get", "post", "put", "patch", "delete"];
const SHOWN = 2; // ready examples of a body: the others are alike

export const operationsOf = ({ paths }) =>
  Object.entries(paths).flatMap(([path, item]) => METHODS.filter((method) => item[method] !== undefined)
    .map((method) => ({ path, method: method.toUpperCase(), shared: item.parameters ?? [], ...item[method] })));

export const pathOf = ({ operationId }) => `/docs/operations/${operationId}.html`;
export const callOf = ({ method, path }) => `<code class="call">${method} ${escape(path)}</code>`;

const nameOf = (reference) => reference.split("/").at(-1);
const resolve = (document, value) => (value.$ref === undefined ? value : document.components[value.$ref.split("/")[2]][nameOf(value.$ref)]);

// The last part of a problem's type, which names its page.
export const problemOf = ({ content }) => content?.["application/problem+json"]?.example?.type.split("/").at(-1);

function access({ security = [] }) {
  const scopes = security.flatMap((way) => Object.keys(way)).filter((name) => name !== "ticket");
  if (scopes.length === 0) return "<p>Open to everybody.</p>";
  const ticket = security.some((way) => "ticket" in way) ? ", or a ticket" : "";
  const scope = scopes[0] === "any" ? "of any scope" : `with the scope <code>${escape(scopes[0])}</code>`;
  return `<p>Where the service has tokens: a token ${scope}${ticket} (${link("/docs/access.html", "Access")}).</p>`;
}

function parameters({ shared, parameters: own = [] }) {
  const rows = [...shared, ...own].map((p) => [`<code>${escape(p.name)}</code>`, p.in, typeOf(p.schema), p.required ? "yes" : "", inline(p.description)]);
  return rows.length === 0 ? "" : `<h2>Parameters</h2>\n${table(["name", "in", "type", "required", "meaning"], rows)}`;
}

function media(document, content = {}) {
  return Object.entries(content).map(([type, { schema, examples = {} }]) => {
    const shown = Object.entries(examples).slice(0, SHOWN).map(([name, given], k) => {
      const { summary, value } = resolve(document, given);
      return example(summary ?? name, value, k === 0);
    });
    return `<p><code>${escape(type)}</code></p>\n${outline(schema, document.components.schemas)}\n${shown.join("")}`;
  }).join("\n");
}

function answers(document, { responses }) {
  const all = Object.entries(responses).map(([status, answer]) => [status, resolve(document, answer)]);
  const good = all.filter(([status]) => status < "400").map(([status, answer]) => {
    const headers = Object.keys(answer.headers ?? {}).map((name) => `<code>${escape(name)}</code>`).join(", ");
    return `<h3>${status}</h3>\n<p>${inline(answer.description)}. Headers: ${headers}.</p>\n${media(document, answer.content)}`;
  });
  const refusals = all.filter(([status]) => status >= "400").map(([status, answer]) =>
    `${link(`/docs/problems/${problemOf(answer)}.html`, `${status} ${problemOf(answer)}`)}: ${inline(answer.description)}`);
  return `<h2>Answers</h2>\n${good.join("\n")}<h3>Refusals</h3>\n${list(refusals)}`;
}

// The request of a recorded example, as one sends it.
function curl({ method, requestBody, responses }) {
  const recorded = Object.values(responses).flatMap(({ content = {} }) => Object.values(content))
    .map(({ examples }) => examples?.recorded?.summary).find(Boolean);
  if (recorded === undefined) return "";
  const verb = method === "GET" ? "" : ` -X ${method}`;
  const type = Object.keys(requestBody?.content ?? {})[0];
  const body = type === undefined ? "" : ` -H 'Content-Type: ${type}' --data-binary @body`;
  return code(`curl -sS${verb}${body} 'http://127.0.0.1:8080${recorded.split(" ")[1]}'`);
}

export function operationPages(document) {
  return operationsOf(document).map((operation) => {
    const { operationId, summary, description, requestBody, tags: [tag] } = operation;
    const body = [
      `<p>${callOf(operation)}</p>`, `<p>${inline(summary)}.</p>`, markdown(description), access(operation), curl(operation), parameters(operation),
      requestBody === undefined ? "" : `<h2>Body</h2>\n${media(document, requestBody.content)}`, answers(document, operation)];
    return { path: pathOf(operation), title: operationId, kind: "operation", text: `${operation.method} ${operation.path} ${summary}. ${description}`,
      html: frame(operationId, [link(`/docs#${tag.toLowerCase()}`, escape(tag))], body.join("\n")), parts: [] };
  });
}
