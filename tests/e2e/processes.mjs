// Processes as /proc shows them, and the command-line program as a story uses it.

import { spawn } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import path from "node:path";

import { binaries, patience } from "./setup.mjs";

// { state, parent } of a process, or null when there is none.
function statOf(pid) {
  try {
    const text = readFileSync(`/proc/${pid}/stat`, "latin1");
    const [state, parent] = text.slice(text.lastIndexOf(")") + 2).split(" ");
    return { state, parent: Number(parent) };
  } catch {
    return null;
  }
}

// Process ids of the living children of a process.
export function childrenOf(pid) {
  return readdirSync("/proc")
    .filter((name) => /^\d+$/.test(name))
    .map(Number)
    .filter((child) => {
      const stat = statOf(child);
      return stat !== null && stat.parent === pid && stat.state !== "Z";
    });
}

// A zombie that is not reaped is not alive: it runs nothing and has no resources.
export function isAlive(pid) {
  const stat = statOf(pid);
  return stat !== null && stat.state !== "Z" && stat.state !== "X";
}

// Resident memory of a process, bytes.
export function residentBytes(pid) {
  const found = /^VmRSS:\s+(\d+) kB$/m.exec(readFileSync(`/proc/${pid}/status`, "utf8"));
  return Number(found[1]) * 1024;
}

// Run a program of ours to its end, or kill it when it has none: { status, signal, stdout, stderr }.
export function runProgram(name, args, options) {
  return runTool(path.join(binaries, name), args, options);
}

// The same for any program; limit: when it is killed, ms.
export function runTool(program, args, { input = "", env = {}, limit = patience } = {}) {
  return new Promise((resolve, reject) => {
    const child = spawn(program, args, {
      env: { ...process.env, ...env },
      timeout: limit,
      killSignal: "SIGKILL",
    });
    const out = [];
    const err = [];
    child.stdout.on("data", (chunk) => out.push(chunk));
    child.stderr.on("data", (chunk) => err.push(chunk));
    child.stdin.on("error", () => {}); // a program that refuses its arguments reads no input
    child.on("error", reject);
    child.on("close", (status, signal) =>
      resolve({
        status,
        signal,
        stdout: Buffer.concat(out).toString("utf8"),
        stderr: Buffer.concat(err).toString("utf8"),
      }),
    );
    child.stdin.end(input);
  });
}

// The beltflow program.
export function beltflow(args, options) {
  return runProgram("beltflow", args, options);
}
