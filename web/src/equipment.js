// What the equipment of a scenario does at a time: how plates are turned, which of them are there, and the
// states of photo eyes.

import { indexBefore } from "./series.js";

// The angle of a motion at t, degrees: linear between its times; between the last one of a round and the first one
// of the next, too.
export function turnAt(motion, t) {
  if (!motion?.t_s) return 0;
  const { t_s: times, turn_deg: angles, repeat_s: round = Infinity } = motion;
  const now = t % round;
  const k = indexBefore(times, now);
  if (k < 0 && t < round) return angles[0];
  if (k === times.length - 1 && round === Infinity) return angles[k];
  const from = k < 0 ? times.at(-1) - round : times[k];
  const to = times[k + 1] ?? times[0] + round;
  const [before, after] = [angles.at(k), angles[k + 1] ?? angles[0]];
  return before + (after - before) * ((now - from) / (to - from));
}

// Whether an obstacle is there at t: from each time to the next, true before the first one.
export function isPresentAt(present, t) {
  if (!present) return true;
  const { t_s: times, value, repeat_s: round = Infinity } = present;
  const k = indexBefore(times, t % round);
  return k < 0 && t < round ? true : value.at(k);
}

export class Equipment {
  // curve: { t, columns } of the run; done: its actions that were carried out, [{ t_s, action }] in this order; drives: how
  // obstacles followed what they were told, [{ t_s, obstacle, state, turn_deg }] in this order. All may grow.
  constructor(scenario, curve, done, drives) {
    const { obstacles, photo_eyes: eyes = [], actions = [] } = scenario;
    Object.assign(this, { obstacles, eyes, actions, curve, done, drives });
    this.seen = 0;
  }

  // { plates: [{ turn, isPresent }], eyes: [true: blocked, null: not known] }.
  at(t) {
    this.followCommands();
    return {
      plates: this.obstacles.map((obstacle, k) => ({ turn: this.turnOf(k, t), isPresent: this.isThere(k, t) })),
      eyes: this.eyes.map((eye) => this.stateOf(eye, t)),
    };
  }

  stateOf({ id }, t) {
    const { t: times, columns } = this.curve;
    if (times.length === 0 || t > times.at(-1) + 1e-9) return null;
    return columns.get(`${id}.blocked`)?.[indexBefore(times, t + 1e-9)] === 1;
  }

  // The commands so far, of each obstacle in the order of their times, and how it followed them.
  followCommands() {
    if (this.seen === this.done.length + this.drives.length) return;
    this.seen = this.done.length + this.drives.length;
    this.held = this.obstacles.map(({ id }) => this.drives.filter(({ obstacle }) => obstacle === id));
    const commands = this.done.map(({ t_s: t, action }) => ({ ...this.actions[action].do, t }));
    this.commands = this.obstacles.map(({ id }) => commands.filter(({ obstacle }) => obstacle === id));
    this.turns = this.obstacles.map(() => []);
    this.commands.forEach((list, k) => {
      for (const { t, turn_deg: to, over_s: over } of list) {
        if (to !== undefined) this.turns[k].push({ t, from: this.turnOf(k, t), to, over });
      }
    });
  }

  // Where cargo held a plate back, between the angles that were told.
  turnOf(k, t) {
    const held = this.held?.[k] ?? [];
    const at = indexBefore(held, t, (drive) => drive.t_s);
    if (at < 0 || held[at].state === "as_told") return this.toldTurnOf(k, t);
    const [now, next = { ...held[at], t_s: Infinity }] = held.slice(at, at + 2);
    return now.turn_deg + (next.turn_deg - now.turn_deg) * ((t - now.t_s) / (next.t_s - now.t_s));
  }

  toldTurnOf(k, t) {
    const turns = this.turns?.[k] ?? [];
    const last = turns[indexBefore(turns, t, (turn) => turn.t)];
    if (!last) return turnAt(this.obstacles[k].motion, t);
    return last.from + (last.to - last.from) * Math.min(1, (t - last.t) / last.over);
  }

  isThere(k, t) {
    const command = this.commands?.[k].findLast((one) => one.t <= t && one.present !== undefined);
    return command ? command.present : isPresentAt(this.obstacles[k].present, t);
  }
}
