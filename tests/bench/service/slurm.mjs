// Slurm on this machine (tests/e2e/slurm.mjs) for a program in another language: `node slurm.mjs CORES` prints the path of its
// configuration, and ends it when standard input ends.

import { Slurm } from "../../e2e/slurm.mjs";

const slurm = await Slurm.start(Number(process.argv[2]));
if (typeof slurm === "string") {
  console.error(slurm);
  process.exit(1);
}
console.log(slurm.file);
for await (const _ of process.stdin);
await slurm.stop();
