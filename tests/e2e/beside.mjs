// Auxiliary programs of the stories: a service manager's socket, a lock on the store.

import { spawn } from "node:child_process";
import { once } from "node:events";
import path from "node:path";
import readline from "node:readline";

import { root, until, within } from "./setup.mjs";

// A script of this folder: { lines: what it has printed so far, end() }.
async function script(t, name, ...args) {
  const child = spawn("python3", ["-B", path.join(root, "tests/e2e", name), ...args], {
    stdio: ["pipe", "pipe", "inherit"],
  });
  const exited = once(child, "close");
  const lines = [];
  readline.createInterface({ input: child.stdout }).on("line", (line) => lines.push(line));
  const end = async () => {
    child.stdin.end();
    await within(exited, `the end of ${name}`);
  };
  t.after(end);
  await until(() => lines.length > 0, `${name} to be there`);
  return { lines, end };
}

// A service manager: { path of its socket, messages so far, said(field): their values in order }.
export async function serviceManager(t) {
  const { lines } = await script(t, "service_manager.py");
  const messages = () => lines.slice(1).map((line) => JSON.parse(line));
  return {
    path: JSON.parse(lines[0]),
    messages,
    said: (field) => messages().map((message) => message[field]).filter((value) => value !== undefined),
  };
}

// Blocks all writes to the store of a daemon until the function that this resolves with is called.
export async function holdStore(t, d) {
  return (await script(t, "hold_store.py", d.data)).end;
}
