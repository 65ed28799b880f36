// Slurm on this machine for a story: munged, slurmctld and slurmd with a folder and ports of their own. Needs root.

import { spawn } from "node:child_process";
import { chmodSync, chownSync, mkdirSync, mkdtempSync, openSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:net";
import { hostname, tmpdir } from "node:os";
import path from "node:path";
import { randomBytes } from "node:crypto";

import { runTool } from "./processes.mjs";
import { until, within } from "./setup.mjs";

const programs = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol"];

const environment = { env: { PATH: `${process.env.PATH}:/usr/sbin:/sbin` } };

// A port that was free a moment ago.
export function freePort() {
  return new Promise((resolve, reject) => {
    const server = createServer();
    server.on("error", reject);
    server.listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

// Why Slurm cannot be started here; null: it can.
async function findObstacle() {
  if (process.getuid() !== 0) return "not root";
  for (const name of programs) {
    if ((await runTool("sh", ["-c", `command -v ${name}`], environment)).status !== 0) return `${name} is not installed`;
  }
  return null;
}

function userOf(name) {
  const line = readFileSync("/etc/passwd", "utf8").split("\n").find((entry) => entry.startsWith(`${name}:`));
  return Number(line.split(":")[2]);
}

function configurationOf(folder, ports, host, cores) {
  return `ClusterName=belt
SlurmctldHost=${host}(127.0.0.1)
SlurmUser=slurm
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
AuthType=auth/munge
AuthInfo=socket=${folder}/munge/socket
CredType=cred/munge
StateSaveLocation=${folder}/state
SlurmdSpoolDir=${folder}/spool
SlurmctldPidFile=${folder}/slurmctld.pid
SlurmdPidFile=${folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_min_interval=0,batch_sched_delay=0,bf_interval=1,sched_interval=1
SlurmdParameters=config_overrides
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
KillWait=5
NodeName=${host} NodeAddr=127.0.0.1 CPUs=${cores} RealMemory=2000 State=UNKNOWN
PartitionName=sim Nodes=${host} Default=YES MaxTime=INFINITE State=UP
`;
}

export class Slurm {
  // A Slurm whose node has so many cores, however many there are; or a text that says why there is none.
  static async start(cores) {
    const obstacle = await findObstacle();
    if (obstacle !== null) return obstacle;
    const s = new Slurm();
    try {
      await s.prepare(cores);
      await s.startMunge();
      s.startController("-c");
      s.startNode();
      await until(async () => (await s.ask("sinfo", "-h", "-o", "%T")).trim() === "idle", "the node");
      return s;
    } catch (error) {
      await s.stop();
      return `${error.message}; ${s.log()}`;
    }
  }

  async prepare(cores) {
    this.children = [];
    this.folder = mkdtempSync(path.join(tmpdir(), "beltflow-slurm-"));
    chmodSync(this.folder, 0o755);
    for (const name of ["munge", "state", "spool"]) mkdirSync(path.join(this.folder, name), { mode: 0o755 });
    chownSync(path.join(this.folder, "munge"), userOf("munge"), 0);
    chownSync(path.join(this.folder, "state"), userOf("slurm"), 0);
    const key = path.join(this.folder, "munge/key");
    writeFileSync(key, randomBytes(128), { mode: 0o400 });
    chownSync(key, userOf("munge"), 0);
    const ports = [await freePort(), await freePort()];
    this.file = path.join(this.folder, "slurm.conf");
    writeFileSync(this.file, configurationOf(this.folder, ports, hostname().split(".")[0], cores));
    // Of programs of Slurm that this process or its children run.
    process.env.SLURM_CONF = this.file;
    process.env.PATH = environment.env.PATH;
  }

  log() {
    return ["munged", "slurmctld", "slurmd"].map((name) => this.logOf(name)).join("\n");
  }

  logOf(name) {
    try {
      return readFileSync(path.join(this.folder, `${name}.log`), "utf8").slice(-2000);
    } catch {
      return "";
    }
  }

  spawn(name, program, args) {
    const log = openSync(path.join(this.folder, `${name}.log`), "a");
    const child = spawn(program, args, { stdio: ["ignore", log, log], detached: true });
    child.exited = new Promise((resolve) => child.on("close", resolve));
    this.children.push(child);
    return child;
  }

  async startMunge() {
    const of = (name) => path.join(this.folder, "munge", name);
    const args = ["-u", "munge", "--", "munged", "-F", `--socket=${of("socket")}`, `--key-file=${of("key")}`];
    const files = [`--pid-file=${of("pid")}`, `--log-file=${of("log")}`, `--seed-file=${of("seed")}`];
    this.spawn("munged", "runuser", [...args, ...files]);
    const works = async () => (await runTool("munge", ["-n", "-S", of("socket")])).status === 0;
    await until(works, "munged");
  }

  startController(...args) {
    this.controller = this.spawn("slurmctld", "slurmctld", ["-D", "-f", this.file, ...args]);
  }

  startNode() {
    this.node = this.spawn("slurmd", "slurmd", ["-D", "-f", this.file, "-N", hostname().split(".")[0]]);
  }

  async kill(child) {
    process.kill(child.pid, "SIGKILL");
    await within(child.exited, "a daemon of Slurm to die");
  }

  // What a program of Slurm prints; "" if it fails.
  async ask(program, ...args) {
    const done = await runTool(program, args);
    return done.status === 0 ? done.stdout : "";
  }

  // { id, state } of each task.
  async tasks() {
    const lines = (await this.ask("squeue", "-h", "-r", "-o", "%i %T")).split("\n").filter(Boolean);
    return lines.map((line) => line.split(" ")).map(([id, state]) => ({ id, state }));
  }

  async running() {
    return (await this.tasks()).filter(({ state }) => state === "RUNNING");
  }

  // End all tasks; their workers, which are asked to stop, have gone then.
  async cancelAll() {
    await this.ask("scancel", "--signal=KILL", "--full", "--me");
    await this.ask("scancel", "--me");
    await until(async () => (await this.tasks()).length === 0, "the end of all tasks");
  }

  async stop() {
    if (this.controller) await this.cancelAll().catch(() => {});
    for (const child of this.children ?? []) {
      if (child.exitCode === null && child.signalCode === null) process.kill(-child.pid, "SIGKILL");
      await within(child.exited, "a daemon of Slurm to end");
    }
    rmSync(this.folder, { recursive: true, force: true });
  }
}
