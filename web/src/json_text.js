// JSON text for people: short lists and objects on one line; and where in a text a JSON pointer leads.

const WIDTH = 96;

export function formatJson(value, indent = "") {
  const flat = oneLine(value);
  if (flat.length + indent.length <= WIDTH || value === null || typeof value !== "object") {
    if (indent !== "" || typeof value !== "object") return flat;
  }
  const inner = `${indent}  `;
  if (Array.isArray(value)) {
    return `[\n${value.map((item) => inner + formatJson(item, inner)).join(",\n")}\n${indent}]`;
  }
  const members = Object.entries(value).map(([key, item]) => `${inner}${JSON.stringify(key)}: ${formatJson(item, inner)}`);
  return `{\n${members.join(",\n")}\n${indent}}`;
}

function oneLine(value) {
  if (Array.isArray(value)) return `[${value.map(oneLine).join(", ")}]`;
  if (value === null || typeof value !== "object") return JSON.stringify(value);
  const members = Object.entries(value).map(([key, item]) => `${JSON.stringify(key)}: ${oneLine(item)}`);
  return members.length === 0 ? "{}" : `{ ${members.join(", ")} }`;
}

// Walks over text and calls found(pointer, start, end) for each value, a member's from its name on.
// Stops without an error where the text is not JSON.
class Walker {
  constructor(text, found) {
    Object.assign(this, { text, found, at: 0 });
  }

  blank() {
    while (/\s/.test(this.text[this.at] ?? "")) this.at++;
  }

  take(pattern) {
    pattern.lastIndex = this.at;
    const match = pattern.exec(this.text);
    if (match) this.at += match[0].length;
    return match?.[0] ?? null;
  }

  string() {
    return this.take(/"(?:\\.|[^"\\])*"/y);
  }

  value(pointer, from) {
    this.blank();
    const start = from ?? this.at;
    const first = this.text[this.at];
    const isGood = first === "{" ? this.members(pointer) : first === "[" ? this.items(pointer)
      : this.string() !== null || this.take(/[-+.\w]+/y) !== null;
    if (isGood) this.found(pointer, start, this.at);
    return isGood;
  }

  members(pointer) {
    return this.list("}", () => {
      const start = this.at;
      const name = this.string();
      if (name === null) return false;
      this.blank();
      if (this.text[this.at++] !== ":") return false;
      const key = JSON.parse(name).replaceAll("~", "~0").replaceAll("/", "~1");
      return this.value(`${pointer}/${key}`, start);
    });
  }

  items(pointer) {
    let k = 0;
    return this.list("]", () => this.value(`${pointer}/${k++}`));
  }

  list(close, one) {
    this.at++;
    this.blank();
    while (this.text[this.at] !== close) {
      if (!one()) return false;
      this.blank();
      if (this.text[this.at] === ",") this.at++;
      else if (this.text[this.at] !== close) return false;
      this.blank();
    }
    this.at++;
    return true;
  }
}

// { start, end } of the value that the pointer names, or of the nearest one around it.
export function locate(text, pointer) {
  const places = new Map();
  try {
    new Walker(text, (found, start, end) => places.set(found, { start, end })).value("");
  } catch {
    // What was found so far.
  }
  for (let at = pointer; ; at = at.slice(0, at.lastIndexOf("/"))) {
    if (places.has(at)) return { ...places.get(at), isExact: at === pointer };
    if (at === "") return { start: 0, end: 0, isExact: false };
  }
}

// Offset of a line and column, both from 1.
export function offsetOf(text, line, column) {
  let start = 0;
  for (let k = 1; k < line; k++) {
    const end = text.indexOf("\n", start);
    if (end < 0) break;
    start = end + 1;
  }
  return Math.min(start + Math.max(0, column - 1), text.length);
}
