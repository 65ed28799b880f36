// What a scenario may have, as the description of the API has it: members, their kinds, limits, units and defaults. Forms follow
// from it, so that a member that the server learns needs nothing here.

import { limitFault } from "../base/numbers.js";

let schemas = null;

export async function loadSchemas() {
  if (schemas === null) {
    const response = await fetch("scenario_schemas.json");
    if (!response.ok) throw new Error("What a scenario may have could not be loaded.");
    schemas = await response.json();
  }
  return schemas;
}

const nameIn = ({ $ref }) => $ref?.replace("#/components/schemas/", "");

// A schema that may refer to another one, with its own description; name: that of the other one.
export function resolve(schema) {
  const name = nameIn(schema);
  return name === undefined ? schema : { ...schemas[name], ...schema, $ref: undefined, name };
}

// The kinds of things that a scenario has lists of: [{ list, schema, least }], in the order of the description.
export function listsOf() {
  return Object.entries(schemas.Scenario.properties).filter(([, { type }]) => type === "array")
    .map(([list, { items, minItems: least = 0 }]) => ({ list, schema: resolve(items), least }))
    .filter(({ schema }) => schema.properties || schema.oneOf);
}

// What a scenario has beside lists of things and some other members: the line as a whole.
export function schemaOfLine(others) {
  const without = [...others, ...listsOf().map(({ list }) => list)];
  const { properties, required } = schemas.Scenario;
  return { properties: Object.fromEntries(Object.entries(properties).filter(([member]) => !without.includes(member))), required };
}

// Which of several forms an object is written in: the first that has all of its members, else the first.
export function formOf(schema, value = {}) {
  if (!schema.oneOf) return schema;
  const names = Object.keys(value);
  return schema.oneOf.find(({ properties }) => names.every((name) => properties[name])) ?? schema.oneOf[0];
}

const plain = (schema) => {
  const { oneOf, type } = schema;
  const word = oneOf?.find((one) => one.const !== undefined)?.const;
  return word === undefined ? { ...schema, type } : { ...schema, ...oneOf.find((one) => one.const === undefined), word };
};

const isObject = ({ type, oneOf }) => type === "object" || Boolean(oneOf?.every((one) => one.type === "object"));
const isListOfObjects = ({ type, items }) => type === "array" && isObject(resolve(items));
const isPoint = (schema) => schema.type === "array" && resolve(schema.items).type === "number" && schema.maxItems === 2;

// What kind of box a member needs: choice, truth, text, id (of another thing), number, list (of numbers or truths), point, points, object, objects,
// one-or-many (an object or a list of them), or json for all else; with the number's unit, limits and word ("auto"), the member's description, and its default in words.
export function boxOf(member, schema) {
  const known = plain(resolve(schema));
  const [, said = "", unit = "", usual = ""] = /^(.*?)(?: \[([^\]]+)\])?(?:\. Default: (.*))?$/.exec(known.description ?? "");
  const common = { member, label: labelOf(member), said: said.replace(/^\w+ form: (.)/, (_, first) => first.toUpperCase()), unit, usual, schema: known };
  const { type } = known;
  if (known.name === "ScenarioId") return { ...common, kind: "id" };
  if (known.enum) return { ...common, kind: "choice", choices: known.enum };
  if (type === "boolean") return { ...common, kind: "truth" };
  if (type === "string") return { ...common, kind: "text" };
  if (type === "number" || type === "integer") return { ...common, kind: "number", word: known.word };
  if (isObject(known)) return { ...common, kind: "object" };
  if (known.oneOf?.some(isListOfObjects)) return { ...common, kind: "one-or-many" };
  if (type !== "array") return { ...common, kind: "json" };
  if (isPoint(known)) return { ...common, kind: "point" };
  const items = resolve(known.items);
  if (isPoint(items)) return { ...common, kind: "points" };
  if (items.type === "number" || items.type === "boolean") return { ...common, kind: "list" };
  return { ...common, kind: isObject(items) ? "objects" : "json" };
}

// "velocity_m_s" is "Velocity".
export function labelOf(member) {
  const words = member.replace(/_(?:m_s2|m_s|m2|m|s|deg|per_s|per_h|n|kg)$/, "").replaceAll("_", " ");
  return (words[0].toUpperCase() + words.slice(1)).replace(/^Mt(bf|tr)\b/, (name) => name.toUpperCase());
}

// What is wrong with a number by itself, or "".
export function faultOfNumber({ schema: { minimum: least, maximum: most, exclusiveMinimum: above, type } }, value) {
  return limitFault({ above, least, most }, value) || (type === "integer" && !Number.isInteger(value) ? "must be a whole number" : "");
}
