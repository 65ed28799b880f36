// The parts of the microscopic model from above, with their headings: as crisp shapes while they are few,
// as stamped pixels when they are many.

import { convexHull } from "./geometry.js";
import { Stamper } from "./stamps.js";

const CRISP_MAX = 4000; // round parts beyond this are stamped
const CORNERED_MAX = 20000; // and others beyond this, as discs of their area

// Where the columns of a row stand.
function layoutOf(columns) {
  const at = (name) => columns.indexOf(name);
  return { stride: columns.length, x: at("x_m"), y: at("y_m"), heading: at("heading_rad"), q: at("q_w"),
    vx: at("vx_m_s"), vy: at("vy_m_s") };
}

export class PartsLayer {
  constructor(columns, cargo) {
    this.layout = layoutOf(columns);
    this.cargo = cargo;
    this.stamper = new Stamper();
    this.pose = { x: 0, y: 0, heading: 0, q: null };
  }

  // The pose of part k between two frames; false: it has left. gap: seconds between the frames.
  read(k, frame, next, share, gap) {
    const { stride, x, y, heading, q, vx, vy } = this.layout;
    const from = k * stride;
    const { data } = frame;
    if (Number.isNaN(data[from + x])) return false;
    const there = next && share > 0 && !Number.isNaN(next.data[from + x]) ? next.data : null;
    const mix = (c) => (there ? data[from + c] + share * (there[from + c] - data[from + c]) : data[from + c]);
    const drift = next && share > 0 && !there ? share * gap : 0;
    this.pose.x = mix(x) + drift * data[from + vx];
    this.pose.y = mix(y) + drift * data[from + vy];
    if (heading >= 0) this.pose.heading = mix(heading);
    else this.turn(from, there, share, data, q);
    return true;
  }

  turn(from, there, share, data, q) {
    const a = [data[from + q], data[from + q + 1], data[from + q + 2], data[from + q + 3]];
    if (there) {
      const b = [there[from + q], there[from + q + 1], there[from + q + 2], there[from + q + 3]];
      const sign = a.reduce((dot, value, c) => dot + value * b[c], 0) < 0 ? -1 : 1;
      a.forEach((value, c) => (a[c] = value + share * (sign * b[c] - value)));
      const length = Math.hypot(...a);
      a.forEach((value, c) => (a[c] = value / length));
    }
    const [w, i, j, k] = a;
    this.pose.heading = Math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k));
    this.pose.q = a;
  }

  // view: a ViewBox; style: { fill, line, fillRgb, lineRgb }.
  draw(context, view, { frame, next, share, gap }, style) {
    const n = frame.shape[0];
    const isRound = this.cargo.kinds.every((kind) => kind.isRound) && this.layout.heading >= 0;
    if (n > (isRound ? CRISP_MAX : CORNERED_MAX)) this.stamp(context, view, { frame, next, share, gap, n }, style);
    else this.trace(context, view, { frame, next, share, gap, n }, style);
  }

  trace(context, view, { frame, next, share, gap, n }, style) {
    const bodies = new Path2D();
    const headings = new Path2D();
    for (let k = 0; k < n; k++) {
      if (!this.read(k, frame, next, share, gap)) continue;
      const kind = this.cargo.kinds[this.cargo.kindOfPart(k)];
      const x = view.x(this.pose.x);
      const y = view.y(this.pose.y);
      const reach = kind.radius * view.scale;
      if (this.isUpright() && kind.isRound) {
        bodies.moveTo(x + reach, y);
        bodies.arc(x, y, reach, 0, 2 * Math.PI);
      } else {
        addPolygon(bodies, this.outlineOf(kind), x, y, view.scale);
      }
      const { heading } = this.pose;
      headings.moveTo(x, y);
      headings.lineTo(x + 0.9 * reach * Math.cos(heading), y - 0.9 * reach * Math.sin(heading));
    }
    context.lineWidth = Math.max(0.75, Math.min(1.5, view.scale * 0.0015)) * view.ratio;
    context.fillStyle = style.fill;
    context.fill(bodies);
    context.strokeStyle = style.line;
    context.stroke(bodies);
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

  stamp(context, view, { frame, next, share, gap, n }, style) {
    const { kinds, kindOfPart } = this.cargo;
    this.stamper.begin(view.width, view.height, kinds.map((kind) => kind.radius * view.scale), style);
    const { pose } = this;
    for (let k = 0; k < n; k++) {
      if (!this.read(k, frame, next, share, gap)) continue;
      this.stamper.put(kindOfPart(k), view.x(pose.x), view.y(pose.y), pose.heading);
    }
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
