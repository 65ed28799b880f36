// Schemas of the document as tables of members, and their pages.

import { code, escape, frame, inline, link, table } from "./html.mjs";

const nameOf = (reference) => reference.split("/").at(-1);
const pathOf = (name) => `/docs/schemas/${name}.html`;

const BOUNDS = [["minimum", "≥"], ["exclusiveMinimum", ">"], ["maximum", "≤"], ["exclusiveMaximum", "<"],
  ["minLength", "length ≥"], ["maxLength", "length ≤"], ["minItems", "items ≥"], ["maxItems", "items ≤"]];

// What a schema takes besides its type, in words.
function limitsOf(schema) {
  const bounds = BOUNDS.filter(([key]) => schema[key] !== undefined).map(([key, sign]) => `${sign} ${schema[key]}`);
  const pattern = schema.pattern === undefined ? [] : [`<code>${escape(schema.pattern)}</code>`];
  const fixed = schema.default === undefined ? [] : [`default <code>${escape(JSON.stringify(schema.default))}</code>`];
  return [...bounds.map(escape), ...pattern, ...fixed].join(", ");
}

const words = (values) => values.map((value) => `<code>${escape(JSON.stringify(value))}</code>`).join(", ");

// A type in one phrase, with links to the schemas that it names.
export function typeOf(schema) {
  const limits = limitsOf(schema);
  return `${kindOf(schema)}${limits === "" ? "" : `, ${limits}`}`;
}

function kindOf(schema) {
  if (schema.$ref !== undefined) return link(pathOf(nameOf(schema.$ref)), nameOf(schema.$ref));
  if (schema.const !== undefined) return words([schema.const]);
  if (schema.enum !== undefined) return `one of ${words(schema.enum)}`;
  const choices = schema.oneOf ?? schema.anyOf;
  if (choices !== undefined) return choices.map((choice) => choice.title ?? typeOf(choice)).join(" or ");
  if (schema.prefixItems !== undefined) return `[${schema.prefixItems.map(typeOf).join(", ")}]`;
  const types = [schema.type ?? "any"].flat();
  return types.map((type) => (type === "array" && schema.items ? `list of ${typeOf(schema.items)}` : type)).join(" or ");
}

// The members of an object; those of the objects in it have lines of their own.
function membersOf(schema, before = "") {
  return Object.entries(schema.properties ?? {}).flatMap(([name, member]) => {
    const isNeeded = schema.required?.includes(name);
    const inner = member.properties !== undefined ? member : member.items?.properties !== undefined ? member.items : {};
    const path = `${before}${name}`;
    return [[path, member, isNeeded], ...membersOf(inner, `${path}.`)];
  });
}

function bodyOf(schema) {
  const choices = (schema.oneOf ?? schema.anyOf ?? []).filter((choice) => choice.properties !== undefined);
  const rows = membersOf(schema).map(([path, member, isNeeded]) => [
    `<code id="${escape(path)}">${escape(path)}</code>`, typeOf(member), isNeeded ? "yes" : "", inline(member.description ?? "")]);
  const others = schema.additionalProperties;
  const isFree = others !== undefined && others !== false;
  return [
    rows.length === 0 && choices.length === 0 ? `<p>${typeOf(schema)}</p>` : "",
    rows.length > 0 ? table(["member", "type", "required", "meaning"], rows) : "",
    isFree ? `<p>Other members: ${others === true ? "anything" : typeOf(others)}.</p>` : "",
    ...choices.map((choice) => `<h2>${escape(choice.title ?? "One form")}</h2>${bodyOf(choice)}`),
  ].join("\n");
}

// The members of what is sent or answered: those of a named schema, on the operation's own page.
export function outline(schema, schemas) {
  if (schema.$ref === undefined) return `<p>${typeOf(schema)}</p>`;
  const name = nameOf(schema.$ref);
  const { description } = schemas[name];
  return `<p>${typeOf(schema)}${description === undefined ? "" : `: ${inline(description)}`}</p>\n${bodyOf(schemas[name]).replaceAll(/ id="[^"]*"/g, "")}`;
}

export function schemaPages({ components: { schemas } }) {
  return Object.entries(schemas).map(([name, schema]) => {
    const text = schema.description ?? "";
    const members = [schema, ...(schema.oneOf ?? [])].flatMap((of) => membersOf(of));
    return { path: pathOf(name), title: name, kind: "schema", text,
      html: frame(name, [link("/docs#schemas", "Schemas")], `<p>${inline(text)}</p>\n${bodyOf(schema)}`),
      parts: members.map(([path, member]) => ({ anchor: path, title: `${name}.${path}`, kind: "member", text: member.description ?? "" })) };
  });
}

export const example = (title, value, isOpen) =>
  `<details${isOpen ? " open" : ""}><summary>${escape(title)}</summary>${code(typeof value === "string" ? value : JSON.stringify(value, null, 2))}</details>\n`;
