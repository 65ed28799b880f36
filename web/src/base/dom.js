// Elements by function call, and the few drawings that buttons need.

const SVG = "http://www.w3.org/2000/svg";

function give(element, name, value) {
  if (value === null || value === undefined || value === false) return;
  if (name === "on") {
    for (const [type, listener] of Object.entries(value)) element.addEventListener(type, listener);
  } else if (name === "data") {
    Object.assign(element.dataset, value);
  } else if (name === "value" || name === "checked") {
    element[name] = value;
  } else {
    element.setAttribute(name, value === true ? "" : value);
  }
}

// h("p", { class: "x", on: { click } }, "text", child): null children are left out.
export function h(name, properties = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) give(element, key, value);
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

// Replaces the text only when it differs, so that selections remain and screen readers do not announce it again.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

const paths = {
  play: "M4 2.5v11l9-5.5z",
  pause: "M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z",
  replay: "M8 3V.5L4 4l4 3.5V5a4 4 0 1 1-4 4H2a6 6 0 1 0 6-6z",
  previous: "M11 2.5v11L4.5 8zM3 2.5h1.5v11H3z",
  next: "M5 2.5v11L11.5 8zM11.5 2.5H13v11h-1.5z",
  stop: "M3 3h10v10H3z",
  trash: "M6 1h4l1 1.5h3V4H2V2.5h3zM3 5h10l-.8 10H3.8z",
  copy: "M2 1h8v2H4v8H2zM5.5 4.5H14V15H5.5z",
  chevron: "M5 2.5 11 8l-6 5.5z",
  close: "M3 4.4 4.4 3 8 6.6 11.6 3 13 4.4 9.4 8l3.6 3.6-1.4 1.4L8 9.4 4.4 13 3 11.6 6.6 8z",
  minus: "M2 7h12v2H2z",
  film: "M1 3h10v10H1zM12 7l3-2.5v7L12 9z",
  star: "M8 1l2.1 4.6 5 .5-3.8 3.3 1.1 4.9L8 11.8l-4.4 2.5 1.1-4.9L.9 6.1l5-.5z",
  add: "M7 2h2v5h5v2H9v5H7V9H2V7h5z",
  picture: "M1 3h14v10H1zM2.5 11.5h11L10 7l-2.5 3L6 8.5z",
  download: "M7 1h2v7h3l-4 4.5L4 8h3zM2 13h12v2H2z",
};

// An element of a drawing.
export function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children.flat());
  return element;
}

// A decorative drawing, hidden from assistive technology.
function drawing(viewBox, kind, d) {
  return svg("svg", { viewBox, class: kind, "aria-hidden": "true" }, svg("path", { d }));
}

// An icon of 16 x 16.
export function icon(name) {
  return drawing("0 0 16 16", "icon", paths[name]);
}

// A piece of a line, 24 wide, with the dash of a curve.
export function strokeMark(dash = []) {
  const mark = drawing("0 0 24 4", "stroke", "M0 2h24");
  mark.firstChild.setAttribute("stroke-dasharray", dash.join(" "));
  return mark;
}

export function swapIcon(button, name) {
  if (button.dataset.icon === name) return;
  button.dataset.icon = name;
  button.querySelector("svg")?.replaceWith(icon(name));
}

// A button with a drawing and a name; shown: the name stands beside the drawing.
export function iconButton(picture, name, onClick, { shown = false, ...more } = {}) {
  const properties = { type: "button", on: { click: onClick }, data: { icon: picture }, ...more };
  if (!shown) Object.assign(properties, { "aria-label": name, title: name });
  return h("button", properties, icon(picture), shown ? h("span", {}, name) : null);
}

export function link(href, text, properties = {}) {
  return h("a", { href, ...properties }, text);
}
