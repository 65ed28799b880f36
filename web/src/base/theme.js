// Colours of the style sheet for what is drawn on canvases, and when they change.

const listeners = new Set();
const darkness = matchMedia("(prefers-color-scheme: dark)");
const stillness = matchMedia("(prefers-reduced-motion: reduce)");

// On paper all is light.
for (const change of [darkness, matchMedia("print")]) change.addEventListener("change", () => {
  for (const listener of [...listeners]) listener();
});

export function onTheme(listener) {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// [r, g, b] of a colour of the style sheet that is written as #rrggbb.
export function rgb(name) {
  const text = color(name);
  return [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
}

export function prefersStillness() {
  return stillness.matches;
}

// Colours that distinguish runs, safe for the colour-blind; each also has a dash of its own.
export const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [14, 4], [5, 2], [10, 3, 2, 3, 2, 3], [1, 2]];
