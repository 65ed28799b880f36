// Many discs, drawn as pixels: each is copied from a small picture of itself, made once for each size
// and for a few places between the pixels. A hundred thousand take some milliseconds.

const PHASES = 4; // places between two pixels, along each axis

function pixelOf([r, g, b], alpha) {
  return ((Math.round(255 * alpha) << 24) | (b << 16) | (g << 8) | r) >>> 0;
}

// The pixels of a disc as spans: [dx, dy, colour] for whole ones and for those of its edge.
function makeSprite(radius, dx, dy, fill, line) {
  const whole = [];
  const edge = [];
  const reach = Math.ceil(radius + 1);
  const rim = radius > 2 ? 1 : 0;
  for (let y = -reach; y <= reach; y++) {
    for (let x = -reach; x <= reach; x++) {
      const distance = Math.hypot(x + 0.5 - dx, y + 0.5 - dy);
      const cover = Math.min(1, radius + 0.5 - distance);
      if (cover <= 0) continue;
      const color = distance > radius - rim ? line : fill;
      (cover === 1 ? whole : edge).push([x, y, pixelOf(color, cover)]);
    }
  }
  return { whole, edge, reach };
}

export class Stamper {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.key = "";
  }

  // style: { fillsRgb, lineRgb }. radii: of each kind, in pixels.
  begin(width, height, radii, style) {
    const key = JSON.stringify([width, height, radii, style.fillsRgb, style.lineRgb]);
    if (key !== this.key) {
      this.key = key;
      Object.assign(this.canvas, { width, height });
      this.context = this.canvas.getContext("2d");
      this.image = this.context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
      this.radii = radii;
      this.line = pixelOf(style.lineRgb, 1);
      this.sprites = radii.map((radius, k) => this.spritesOf(Math.max(radius, 0.6), style.fillsRgb[k % style.fillsRgb.length], style.lineRgb));
    }
    this.pixels.fill(0);
  }

  spritesOf(radius, fillRgb, lineRgb) {
    return Array.from({ length: PHASES * PHASES }, (_, k) => {
      const sprite = makeSprite(radius, (k % PHASES + 0.5) / PHASES, (Math.floor(k / PHASES) + 0.5) / PHASES,
        fillRgb, lineRgb);
      const flat = (list) => ({
        steps: Int32Array.from(list, ([x, y]) => y * this.canvas.width + x),
        colors: Uint32Array.from(list, ([, , color]) => color),
      });
      return { whole: flat(sprite.whole), edge: flat(sprite.edge), reach: sprite.reach };
    });
  }

  put(kind, x, y, heading) {
    const { width, height } = this.canvas;
    const column = Math.floor(x);
    const row = Math.floor(y);
    const phase = Math.floor((y - row) * PHASES) * PHASES + Math.floor((x - column) * PHASES);
    const { whole, edge, reach } = this.sprites[kind][phase];
    if (column < reach || row < reach || column >= width - reach || row >= height - reach) return;
    const from = row * width + column;
    const { pixels } = this;
    for (let k = 0; k < whole.steps.length; k++) pixels[from + whole.steps[k]] = whole.colors[k];
    for (let k = 0; k < edge.steps.length; k++) {
      const at = from + edge.steps[k];
      if (pixels[at] === 0) pixels[at] = edge.colors[k];
    }
    if (this.radii[kind] > 2.5) this.putHeading(x, y, heading, this.radii[kind]);
  }

  putHeading(x, y, heading, radius) {
    const c = Math.cos(heading);
    const s = Math.sin(heading);
    for (let r = 0; r < radius - 0.5; r += 0.9) {
      this.pixels[Math.floor(y - r * s) * this.canvas.width + Math.floor(x + r * c)] = this.line;
    }
  }

  drawOn(context) {
    this.context.putImageData(this.image, 0, 0);
    context.drawImage(this.canvas, 0, 0);
  }
}
