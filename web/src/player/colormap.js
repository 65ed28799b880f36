// Colours of densities: viridis (Smith and van der Walt 2015, CC0), perceptually uniform and safe for the
// colour-blind, and the grey of the paper, white where the belt is empty.

const N = 1024;

// Viridis at 0, 1/16, ..., 1.
const viridis = [
  [68, 1, 84], [72, 24, 106], [71, 45, 123], [66, 64, 134], [59, 82, 139], [51, 99, 141], [44, 114, 142],
  [38, 130, 142], [33, 145, 140], [31, 160, 136], [40, 174, 128], [63, 188, 115], [94, 201, 98], [132, 212, 75],
  [173, 220, 48], [216, 226, 25], [253, 231, 37],
];

function viridisAt(share) {
  const at = Math.min(share * 16, 15.999);
  const k = Math.floor(at);
  return viridis[k].map((low, c) => low + (at - k) * (viridis[k + 1][c] - low));
}

// 255 down to 20: black itself is left to the lines.
const greyAt = (share) => Array(3).fill(255 - 235 * share);

export const maps = {
  viridis: { label: "Viridis", at: viridisAt },
  grey: { label: "Grey (paper)", at: greyAt, isPale: true },
};

// Whether an empty belt is drawn light, so that lines over it must be dark.
export function isPale(name) {
  return maps[name].isPale === true;
}

const EMPTY = 0.005; // of close packing: below it nothing lies there

const pixelOf = ([r, g, b]) => (255 << 24) | (b << 16) | (g << 8) | r;

// N colours as 32-bit pixels, from density 0 to the end of the scale, and one for what is above. belt: the colour of a belt that
// nothing lies on; the grey map has white for it.
export function tableOf(name, end, { belt, above }) {
  const { at, isPale } = maps[name];
  const table = new Uint32Array(N + 1);
  for (let k = 0; k < N; k++) {
    const isEmpty = !isPale && (k / (N - 1)) * end < EMPTY;
    table[k] = pixelOf(isEmpty ? belt : at(k / (N - 1)).map(Math.round));
  }
  table[N] = pixelOf(above);
  return table;
}

export function cssColor(name, share) {
  return `rgb(${maps[name].at(share).map(Math.round).join(" ")})`;
}

// Ends of the scale that can be chosen; "peak": whatever the largest density needs.
export const ranges = [["1", "0 to 1"], ["1.25", "0 to 1.25"], ["1.5", "0 to 1.5"], ["2", "0 to 2"], ["peak", "0 to the peak"]];

// The end of the scale for densities up to this peak: 1, 1.25, 1.5, ...
export function scaleEnd(peak) {
  return Math.max(1, Math.ceil(peak * 4 - 1e-6) / 4);
}
