// The lines of api/openapi/samples.txt, and whether a value is what the document says there.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

import { packages, root } from "../e2e/setup.mjs";

export const samplesFile = path.join(root, "api/openapi/samples.txt");
const document = JSON.parse(readFileSync(path.join(root, "api/openapi.json"), "utf8"));
const require = createRequire(path.join(packages, "package.json"));
const { Ajv2020 } = require("ajv/dist/2020.js");
const ajv = new Ajv2020({ strict: false, allErrors: true });
require("ajv-formats")(ajv);
ajv.addFormat("binary", true);
ajv.addSchema(document, "openapi.json");

const escape = (key) => key.replaceAll("~", "~0").replaceAll("/", "~1");

export const operations = new Map(Object.entries(document.paths).flatMap(([template, item]) =>
  ["get", "post", "put", "patch", "delete"].filter((method) => item[method] !== undefined).map((method) =>
    [item[method].operationId, { operation: item[method], place: `#/paths/${escape(template)}/${method}` }])));

// What the document says of a kind: operation, "request" or status, media type.
export function mediaOf(kind) {
  const [id, where, type] = kind.split(" ");
  const { operation } = operations.get(id) ?? {};
  const of = where === "request" ? operation?.requestBody : operation?.responses[where];
  return of?.content?.[type];
}

export function fitsSchema(kind, value) {
  const [id, where, type] = kind.split(" ");
  if (mediaOf(kind) === undefined) return false;
  const { place } = operations.get(id);
  const inner = where === "request" ? "requestBody" : `responses/${where}`;
  return ajv.getSchema(`openapi.json${encodeURI(`${place}/${inner}/content/${escape(type)}/schema`)}`)(value);
}

export function readSamples() {
  return readFileSync(samplesFile, "utf8").split("\n").filter(Boolean).map((line) => {
    const [, kind, target, value] = /^(\S+ \S+ \S+) (\S+) (.*)$/.exec(line);
    return { kind, target, value: JSON.parse(value) };
  });
}
