// Access tokens for a story, made as an operator makes them.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import path from "node:path";

import { binaries } from "./setup.mjs";

// Run beltflowd for a data directory; { status, stdout, stderr }.
export function beltflowd(data, ...words) {
  const { status, stdout, stderr, error } = spawnSync(path.join(binaries, "beltflowd"), ["--data", data, ...words], {
    encoding: "utf8",
    timeout: 60000, // of a daemon that starts where it should not
  });
  assert.equal(error, undefined);
  return { status, stdout, stderr };
}

// Make a token beside the daemon; its text.
export function makeToken(data, ...words) {
  const { status, stdout, stderr } = beltflowd(data, "token", "add", ...words);
  assert.equal(status, 0, stderr);
  const token = stdout.trim();
  assert.match(token, /^bft_[\w-]{43}$/);
  return token;
}

// The same; the header that presents it.
export function addToken(data, ...words) {
  return { authorization: `Bearer ${makeToken(data, ...words)}` };
}
