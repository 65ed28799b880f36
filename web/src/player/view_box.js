// Where metres lie on a canvas: the domain, or a part of it, in true proportions, y upwards, with room for the axes.

const MARGIN = { left: 46, right: 22, top: 12, bottom: 28 }; // CSS pixels

export class ViewBox {
  // width, most: CSS pixels that there are; ratio: device pixels of each; zoom: how many times larger than the whole domain, and
  // what is in the middle, as shares of the domain.
  constructor(domain, width, most, ratio, { factor, x, y }) {
    const [x0, x1] = domain.x_m;
    const [y0, y1] = domain.y_m;
    const wide = (width - MARGIN.left - MARGIN.right) / (x1 - x0);
    const high = (most - MARGIN.top - MARGIN.bottom) / (y1 - y0);
    const scale = Math.max(1e-3, Math.min(wide, high));
    this.ratio = ratio;
    this.scale = scale * ratio * factor;
    this.isWhole = factor === 1;
    this.visible = { x_m: partOf(x0, x1, factor, x), y_m: partOf(y0, y1, factor, y) };
    this.origin = [this.visible.x_m[0], this.visible.y_m[0]];
    this.inner = {
      x: Math.round(MARGIN.left * ratio),
      y: Math.round(MARGIN.top * ratio),
      width: Math.max(1, Math.round((x1 - x0) * scale * ratio)),
      height: Math.max(1, Math.round((y1 - y0) * scale * ratio)),
    };
    this.cssWidth = (x1 - x0) * scale + MARGIN.left + MARGIN.right;
    this.cssHeight = (y1 - y0) * scale + MARGIN.top + MARGIN.bottom;
    this.width = Math.round(this.cssWidth * ratio);
    this.height = Math.round(this.cssHeight * ratio);
    // The domain, which may reach over the canvas.
    this.whole = this.isWhole ? this.inner
      : { x: this.x(x0), y: this.y(y1), width: (x1 - x0) * this.scale, height: (y1 - y0) * this.scale };
  }

  x(m) {
    return this.inner.x + (m - this.origin[0]) * this.scale;
  }

  y(m) {
    return this.inner.y + this.inner.height - (m - this.origin[1]) * this.scale;
  }

  // Limits drawing to what is visible of the domain, with some CSS pixels around it, until the context is restored.
  clip(context, around = 0) {
    const { x, y, width, height } = this.inner;
    const more = around * this.ratio;
    context.beginPath();
    context.rect(x - more, y - more, width + 2 * more, height + 2 * more);
    context.clip();
  }

  // Metres of a place in CSS pixels.
  place(x, y) {
    return [
      this.origin[0] + (x * this.ratio - this.inner.x) / this.scale,
      this.origin[1] + (this.inner.y + this.inner.height - y * this.ratio) / this.scale,
    ];
  }
}

function partOf(from, to, factor, centre) {
  const length = (to - from) / factor;
  const begin = from + centre * (to - from) - length / 2;
  return [begin, begin + length];
}
