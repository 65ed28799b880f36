// What the equipment of a scenario does at a time: how plates are turned and shifted, which of them are there, the states of
// photo eyes, and which belts are down.

import { indexBefore } from "../base/search.js";

const mix = (a, b, share) => (Array.isArray(a) ? a.map((value, k) => mix(value, b[k], share)) : a + (b - a) * share);

// The two times of a motion around t, by their indices, and the share of the way from the first to the second; between the last one
// of a round and the first one of the next, too.
function spanAt({ t_s: times, repeat_s: round = Infinity }, t) {
  const now = t % round;
  const k = indexBefore(times, now);
  if (k < 0 && t < round) return [0, 0, 0];
  if (k === times.length - 1 && round === Infinity) return [k, k, 0];
  const from = k < 0 ? times.at(-1) - round : times[k];
  const to = times[k + 1] ?? times[0] + round;
  return [k, (k + 1) % times.length, (now - from) / (to - from)];
}

// The angle of a motion at t, degrees, and its shift, m: linear between its times.
export function placeAt(motion, t) {
  const [before, after, share] = motion?.t_s ? spanAt(motion, t) : [0, 0, 0];
  const of = (values, none) => (motion?.t_s && values ? mix(values.at(before), values.at(after), share) : none);
  return { turn: of(motion?.turn_deg, 0), shift: of(motion?.shift_m, [0, 0]) };
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
  // obstacles followed what they were told, [{ t_s, obstacle, state, turn_deg, shift_m }] in this order. All may grow.
  constructor(scenario, curve, done, drives) {
    const { belts = [], obstacles, photo_eyes: eyes = [], actions = [] } = scenario;
    Object.assign(this, { belts, obstacles, eyes, actions, curve, done, drives });
    this.seen = 0;
  }

  // { plates: [{ turn, shift, isPresent }], eyes: [true: blocked, null: not known], failures: [ids of those by which each belt is down] }.
  at(t) {
    this.followCommands();
    return {
      plates: this.obstacles.map((obstacle, k) => ({ ...this.placeOf(k, t), isPresent: this.isThere(k, t) })),
      eyes: this.eyes.map(({ id }) => this.stateOf(`${id}.blocked`, t)),
      failures: this.belts.map(({ failures = [] }) => failures.map(({ id }) => id).filter((id) => this.stateOf(`${id}.failed`, t))),
    };
  }

  // Whether a column of the curve is 1 at t; null: it is not known yet.
  stateOf(column, t) {
    const { t: times, columns } = this.curve;
    if (times.length === 0 || t > times.at(-1) + 1e-9) return null;
    return columns.get(column)?.[indexBefore(times, t + 1e-9)] === 1;
  }

  // The commands so far, of each obstacle in the order of their times, and how it followed them.
  followCommands() {
    if (this.seen === this.done.length + this.drives.length) return;
    this.seen = this.done.length + this.drives.length;
    this.held = this.obstacles.map(({ id }) => this.drives.filter(({ obstacle }) => obstacle === id));
    const commands = this.done.map(({ t_s: t, action }) => ({ ...this.actions[action].do, t }));
    this.commands = this.obstacles.map(({ id }) => commands.filter(({ obstacle }) => obstacle === id));
    this.moves = this.obstacles.map(() => ({ turn: [], shift: [] }));
    this.commands.forEach((list, k) => {
      for (const { t, turn_deg: turn, shift_m: shift, over_s: over } of list) {
        for (const [what, to] of Object.entries({ turn, shift })) {
          if (to !== undefined) this.moves[k][what].push({ t, from: this.placeOf(k, t)[what], to, over });
        }
      }
    });
  }

  // Where cargo held a plate back, between the places that were told.
  placeOf(k, t) {
    const held = this.held?.[k] ?? [];
    const at = indexBefore(held, t, (drive) => drive.t_s);
    if (at < 0 || held[at].state === "as_told") return this.toldPlaceOf(k, t);
    const placeIn = ({ turn_deg: turn, shift_m: shift = [0, 0] }) => ({ turn, shift });
    const [now, next = { ...held[at], t_s: Infinity }] = held.slice(at, at + 2);
    const [from, to, share] = [placeIn(now), placeIn(next), (t - now.t_s) / (next.t_s - now.t_s)];
    return { turn: mix(from.turn, to.turn, share), shift: mix(from.shift, to.shift, share) };
  }

  // Commands replace what they command of the schedule.
  toldPlaceOf(k, t) {
    const place = placeAt(this.obstacles[k].motion, t);
    for (const [what, list] of Object.entries(this.moves?.[k] ?? {})) {
      const last = list[indexBefore(list, t, (move) => move.t)];
      if (last) place[what] = mix(last.from, last.to, Math.min(1, (t - last.t) / last.over));
    }
    return place;
  }

  isThere(k, t) {
    const command = this.commands?.[k].findLast((one) => one.t <= t && one.present !== undefined);
    return command ? command.present : isPresentAt(this.obstacles[k].present, t);
  }
}
