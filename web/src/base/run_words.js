// What every view says of a run or a study in the same way: its state, its line, and that its results may be wrong.

import { h, link, setText } from "./dom.js";
import { address } from "./router.js";

export const suspicion = "These results may be wrong. Submit the line again to have it solved anew.";

export function statePill(run) {
  const pill = h("span", { class: "pill" }, h("i", { class: "dot" }), h("span"));
  return { pill, show: (current) => {
    pill.dataset.state = current.status;
    setText(pill.lastChild, current.status);
    pill.title = current.error?.detail ?? "";
  } };
}

// Where a run's or a study's line is shown: a link, with the run's version of it. A list without one where it has no line.
export function lineLink({ line, line_version: version }) {
  return line ? [link(address("runs", "", { line }), version ? `${line}, version ${version}` : line)] : [];
}
