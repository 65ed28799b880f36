// The parts of the microscopic model from above, with their headings: as crisp shapes while they are few,
// as stamped pixels when they are many.

import { convexHull } from "../scenario/geometry.js";
import { Stamper } from "./stamps.js";

const CRISP_MAX = 4000; // round parts beyond this are stamped
const CORNERED_MAX = 20000; // and others beyond this, as discs of their area

// Where the columns of a row stand.
function layoutOf(columns) {
  const at = (name) => columns.indexOf(name);
  return { stride: columns.length, id: at("id"), kind: at("kind"), x: at("x_m"), y: at("y_m"), heading: at("heading_rad"),
    q: at("q_w"), vx: at("vx_m_s"), vy: at("vy_m_s") };
}

// Between two places at a share of the way, with the velocities at both ends times the seconds between them: a cubic, with
// velocities held so that it never goes beyond the places (Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238).
function between(a, b, va, vb, share) {
  const way = b - a;
  const held = (v) => (v * way <= 0 ? 0 : Math.sign(v) * Math.min(Math.abs(v), 3 * Math.abs(way)));
  const [s, rest] = [share, 1 - share];
  return a + way * s * s * (3 - 2 * s) + s * rest * (rest * held(va) - s * held(vb));
}

// Whether the way from a to b meets a segment.
function crosses(a, b, [p, q]) {
  const side = ([ux, uy], [vx, vy], [wx, wy]) => (vx - ux) * (wy - uy) - (vy - uy) * (wx - ux);
  return side(p, q, a) * side(p, q, b) <= 0 && side(a, b, p) * side(a, b, q) <= 0;
}

export class PartsLayer {
  // feedLines: what parts enter over during the run.
  constructor(columns, cargo, feedLines) {
    Object.assign(this, { layout: layoutOf(columns), cargo, feedLines });
    this.stamper = null;
    this.pose = { id: 0, kind: 0, x: 0, y: 0, heading: 0, q: null, vx: 0, vy: 0 };
  }

  // Sets the pose to that of each part between two frames, one after the other, and visits it; gap: seconds between
  // the frames. Rows are parts, or their ids rise; then parts come and go from one frame to the next.
  each({ frame, next, share, gap }, visit) {
    const after = share > 0 && next ? next : null;
    const n = frame.shape[0];
    if (this.layout.id < 0 || !after) {
      for (let k = 0; k < n; k++) if (this.read(k, frame.data, after?.data, k, share, gap)) visit(this.pose);
      return;
    }
    const { stride, id } = this.layout;
    const n_after = after.shape[0];
    for (let k = 0, j = 0; k < n || j < n_after;) {
      const [a, b] = [k < n ? frame.data[k * stride + id] : Infinity, j < n_after ? after.data[j * stride + id] : Infinity];
      const isSeen = b < a ? this.readEntering(j, after.data, (1 - share) * gap)
        : this.read(k, frame.data, a === b ? after.data : null, j, share, gap);
      if (isSeen) visit(this.pose);
      k += a <= b;
      j += b <= a;
    }
  }

  // The pose of row k on its way to row j of the frame after, or on with its velocity; false: it has left.
  read(k, data, after, j, share, gap) {
    const { stride, id, x, y, heading, q, vx, vy } = this.layout;
    const [from, to] = [k * stride, j * stride];
    if (Number.isNaN(data[from + x])) return false;
    const there = after && !Number.isNaN(after[to + x]) ? after : null;
    const mix = (c) => (there ? data[from + c] + share * (there[to + c] - data[from + c]) : data[from + c]);
    const drift = there ? 0 : share * gap;
    this.pose.id = id < 0 ? k : data[from + id];
    this.pose.kind = this.kindOf(k, data);
    this.pose.vx = data[from + vx];
    this.pose.vy = data[from + vy];
    const along = (c, v) => (there ? between(data[from + c], there[to + c], gap * data[from + v], gap * there[to + v], share)
      : data[from + c] + drift * data[from + v]);
    this.pose.x = along(x, vx);
    this.pose.y = along(y, vy);
    if (heading >= 0) this.pose.heading = mix(heading);
    else this.turn(data, from + q, there, to + q, share);
    return true;
  }

  // The pose some seconds before a frame of a part that entered since the frame before; false: it is not there yet.
  readEntering(k, data, before) {
    const { stride, x, y } = this.layout;
    this.read(k, data, null, 0, 1, -before);
    const [here, later] = [[this.pose.x, this.pose.y], [data[k * stride + x], data[k * stride + y]]];
    return !this.feedLines.some((line) => crosses(here, later, line));
  }

  kindOf(k, data) {
    const { stride, kind } = this.layout;
    return kind < 0 ? this.cargo.kindOfPart(k) : data[k * stride + kind];
  }

  turn(data, from, there, to, share) {
    const a = [data[from], data[from + 1], data[from + 2], data[from + 3]];
    if (there) {
      const b = [there[to], there[to + 1], there[to + 2], there[to + 3]];
      const sign = a.reduce((dot, value, c) => dot + value * b[c], 0) < 0 ? -1 : 1;
      a.forEach((value, c) => (a[c] = value + share * (sign * b[c] - value)));
      const length = Math.hypot(...a);
      a.forEach((value, c) => (a[c] = value / length));
    }
    const [w, i, j, k] = a;
    this.pose.heading = Math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k));
    this.pose.q = a;
  }

  // The pose of the part at a place, in metres; null: none is there.
  partAt(picture, [x, y]) {
    let found = null;
    this.each(picture, (pose) => {
      const distance = Math.hypot(pose.x - x, pose.y - y);
      if (distance < (found?.distance ?? this.cargo.kinds[pose.kind].radius)) found = { ...pose, distance };
    });
    return found;
  }

  // view: a ViewBox; style: { fills, line, fillsRgb, lineRgb }, with fills of the kinds in turn.
  draw(context, view, picture, style) {
    const n = picture.frame.shape[0];
    const isRound = this.cargo.kinds.every((kind) => kind.isRound) && this.layout.heading >= 0;
    if (n > (isRound ? CRISP_MAX : CORNERED_MAX)) this.stamp(context, view, picture, style);
    else this.trace(context, view, picture, style);
  }

  trace(context, view, picture, style) {
    const all = style.fills.map(() => new Path2D());
    const headings = new Path2D();
    this.each(picture, (pose) => {
      const kind = this.cargo.kinds[pose.kind];
      const bodies = all[pose.kind % all.length];
      const x = view.x(pose.x);
      const y = view.y(pose.y);
      const reach = kind.radius * view.scale;
      if (this.isUpright() && kind.isRound) {
        bodies.moveTo(x + reach, y);
        bodies.arc(x, y, reach, 0, 2 * Math.PI);
      } else {
        addPolygon(bodies, this.outlineOf(kind), x, y, view.scale);
      }
      headings.moveTo(x, y);
      headings.lineTo(x + 0.9 * reach * Math.cos(pose.heading), y - 0.9 * reach * Math.sin(pose.heading));
    });
    context.lineWidth = Math.max(0.75, Math.min(1.5, view.scale * 0.0015)) * view.ratio;
    context.strokeStyle = style.line;
    all.forEach((bodies, k) => {
      context.fillStyle = style.fills[k];
      context.fill(bodies);
      context.stroke(bodies);
    });
    context.stroke(headings);
  }

  isUpright() {
    const { q } = this.pose;
    return q === null || Math.hypot(q[1], q[2]) < 1e-3;
  }

  // From above, turned as the part is.
  outlineOf(kind) {
    const { q, heading } = this.pose;
    if (this.isUpright()) {
      const [c, s] = [Math.cos(heading), Math.sin(heading)];
      return kind.outline.map(([x, y]) => [c * x - s * y, s * x + c * y]);
    }
    const [w, i, j, k] = q;
    return convexHull(kind.corners.map(([x, y, z]) => [
      (1 - 2 * (j * j + k * k)) * x + 2 * (i * j - w * k) * y + 2 * (i * k + w * j) * z,
      2 * (i * j + w * k) * x + (1 - 2 * (i * i + k * k)) * y + 2 * (j * k - w * i) * z,
    ]));
  }

  stamp(context, view, picture, style) {
    this.stamper ??= new Stamper();
    this.stamper.begin(view.width, view.height, this.cargo.kinds.map((kind) => kind.radius * view.scale), style);
    this.each(picture, (pose) => this.stamper.put(pose.kind, view.x(pose.x), view.y(pose.y), pose.heading));
    this.stamper.drawOn(context);
  }
}

function addPolygon(path, outline, x, y, scale) {
  outline.forEach((p, k) => {
    if (k === 0) path.moveTo(x + p[0] * scale, y - p[1] * scale);
    else path.lineTo(x + p[0] * scale, y - p[1] * scale);
  });
  path.closePath();
}
