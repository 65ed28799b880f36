// Where metres lie on a canvas: the domain in true proportions, y upwards, with room for the axes.

const MARGIN = { left: 46, right: 22, top: 12, bottom: 28 }; // CSS pixels

export class ViewBox {
  // width, most: CSS pixels that there are; ratio: device pixels of each.
  constructor(domain, width, most, ratio) {
    const [x0, x1] = domain.x_m;
    const [y0, y1] = domain.y_m;
    const wide = (width - MARGIN.left - MARGIN.right) / (x1 - x0);
    const high = (most - MARGIN.top - MARGIN.bottom) / (y1 - y0);
    const scale = Math.max(1e-3, Math.min(wide, high));
    this.ratio = ratio;
    this.scale = scale * ratio;
    this.origin = [x0, y0];
    this.inner = {
      x: Math.round(MARGIN.left * ratio),
      y: Math.round(MARGIN.top * ratio),
      width: Math.max(1, Math.round((x1 - x0) * this.scale)),
      height: Math.max(1, Math.round((y1 - y0) * this.scale)),
    };
    this.cssWidth = (x1 - x0) * scale + MARGIN.left + MARGIN.right;
    this.cssHeight = (y1 - y0) * scale + MARGIN.top + MARGIN.bottom;
    this.width = Math.round(this.cssWidth * ratio);
    this.height = Math.round(this.cssHeight * ratio);
  }

  x(m) {
    return this.inner.x + (m - this.origin[0]) * this.scale;
  }

  y(m) {
    return this.inner.y + this.inner.height - (m - this.origin[1]) * this.scale;
  }

  // Limits drawing to the domain, until the context is restored.
  clip(context) {
    const { x, y, width, height } = this.inner;
    context.beginPath();
    context.rect(x, y, width, height);
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
