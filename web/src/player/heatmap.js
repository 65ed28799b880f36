// A density as pixels: one for each cell, coloured by a table of the colour map, brought to size by the canvas. The last colour
// of the table is that of densities above the end of the scale.

export class Heatmap {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.pixels = null;
  }

  // frame: { shape: [rows, columns], data }; next: the frame after it, share: how far on the way there.
  paint(frame, next, share, table, end) {
    const [rows, columns] = frame.shape;
    if (this.pixels?.width !== columns || this.pixels?.height !== rows) {
      Object.assign(this.canvas, { width: columns, height: rows });
      this.context = this.canvas.getContext("2d", { alpha: false });
      this.pixels = this.context.createImageData(columns, rows);
    }
    const to = new Uint32Array(this.pixels.data.buffer);
    if (next && share > 0) mixInto(to, frame, next, share, table, end);
    else copyInto(to, frame, table, end);
    this.context.putImageData(this.pixels, 0, 0);
  }

  // Onto a rectangle of another canvas: cells stay squares with edges where they are large.
  drawOn(context, { x, y, width, height }) {
    context.imageSmoothingEnabled = this.canvas.width > width || this.canvas.height > height;
    context.imageSmoothingQuality = "medium";
    context.drawImage(this.canvas, x, y, width, height);
  }
}

// Row 0 of a frame lies at the bottom. What is not a number is drawn as an empty belt.
function copyInto(to, { shape: [rows, columns], data }, table, end) {
  const top = table.length - 1;
  const scale = (top - 1) / end;
  for (let j = 0, k = 0; j < rows; j++) {
    for (let o = (rows - 1 - j) * columns, stop = o + columns; o < stop; o++, k++) {
      const v = (data[k] * scale) | 0;
      to[o] = table[v < 0 ? 0 : v > top ? top : v];
    }
  }
}

function mixInto(to, { shape: [rows, columns], data }, { data: later }, share, table, end) {
  const top = table.length - 1;
  const scale = (top - 1) / end;
  for (let j = 0, k = 0; j < rows; j++) {
    for (let o = (rows - 1 - j) * columns, stop = o + columns; o < stop; o++, k++) {
      const v = ((data[k] + share * (later[k] - data[k])) * scale) | 0;
      to[o] = table[v < 0 ? 0 : v > top ? top : v];
    }
  }
}

// The density at a place of the grid, by the same mixing; null outside.
export function densityAt(frame, next, share, grid, [x, y]) {
  const [rows, columns] = frame.shape;
  const i = Math.floor((x - grid.origin_m[0]) / grid.cell_m[0]);
  const j = Math.floor((y - grid.origin_m[1]) / grid.cell_m[1]);
  if (i < 0 || j < 0 || i >= columns || j >= rows) return null;
  const k = j * columns + i;
  return next && share > 0 ? frame.data[k] + share * (next.data[k] - frame.data[k]) : frame.data[k];
}
