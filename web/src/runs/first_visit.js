// What a first visit sees: what this is, in a sentence and a picture, and a button that shows it.

import { getJson, post } from "../base/api.js";
import { h, svg } from "../base/dom.js";
import { address, go } from "../base/router.js";
import { tellFault } from "../base/toast.js";

const [WIDTH, HEIGHT, RADIUS] = [600, 230, 8];
const [FOOT, TIP] = [[300, HEIGHT], [430, 60]];
const PITCH = 2.15 * RADIUS;

// How far left of the plate a point is.
function distanceTo([x, y]) {
  const share = (HEIGHT - y) / (HEIGHT - TIP[1]);
  return FOOT[0] + share * (TIP[0] - FOOT[0]) - x;
}

// Parts that are packed before the plate, that arrive, and that have passed it.
function places() {
  const found = [[36, 70], [84, 150], [58, 196], [120, 96], [150, 190], [176, 140], [212, 84], [262, 60],
    [344, 34], [392, 28], [430, 40], [468, 22], [508, 36], [566, 24]];
  for (let row = 0; row * PITCH * 0.87 < HEIGHT - 84; row++) {
    for (let column = 0; column < 26; column++) {
      const place = [(column + (row % 2) / 2) * PITCH + 60, HEIGHT - RADIUS - 2 - row * PITCH * 0.87];
      const distance = distanceTo(place);
      if (distance > RADIUS + 5 && distance < 128 - 5 * row) found.push(place);
    }
  }
  return found;
}

function picture() {
  const text = (x, y, words) => svg("text", { x, y, class: "word" }, words);
  return svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "first-picture", role: "img",
    "aria-label": "A belt from above: parts arrive from the left, jam before a deflector, and pass through the opening at its tip." },
  svg("rect", { class: "belt", width: String(WIDTH), height: String(HEIGHT) }),
  svg("path", { class: "wall", d: `M0 1h${WIDTH}M0 ${HEIGHT - 1}h${WIDTH}` }),
  svg("path", { class: "way", d: "M24 24h70m-10-6 10 6-10 6" }),
  places().map(([cx, cy]) => svg("circle", { class: "part", cx: cx.toFixed(1), cy: cy.toFixed(1), r: String(RADIUS) })),
  svg("path", { class: "plate", d: `M${FOOT}L${TIP}` }),
  text("104", "29", "parts arrive"), text(String(TIP[0] + 16), "70", "opening"), text("396", "170", "deflector"));
}

async function runBoth(button) {
  button.disabled = true;
  try {
    const scenario = await getJson("v1/examples/example-1");
    const runs = await Promise.all(["macro", "micro"].map((model) => post("v1/runs", { model, scenario })));
    go(address("compare", "", { runs: runs.map(({ id }) => id).join(",") }));
  } catch (error) {
    tellFault(error);
    button.disabled = false;
  }
}

export function firstVisit() {
  const button = h("button", { type: "button", class: "primary", on: { click: () => runBoth(button) } },
    "Run Example 1 in both models");
  return [picture(),
    h("p", { class: "what" }, "Beltflow predicts how parts on a conveyor belt jam in front of a deflector, and how fast they get past it."),
    button, h("p", { class: "hint" }, "No runs yet. You will see the same jam twice, as single parts and as a density.")];
}
