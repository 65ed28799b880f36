// Where in JSON text the value is that a JSON pointer names: a member from its name on.

import { jsonLanguage } from "@codemirror/lang-json";

const VALUE = /^(?:True|False|Null|Number|String|Object|Array)$/;

const childrenOf = (node) => {
  const list = [];
  for (let child = node.firstChild; child; child = child.nextSibling) list.push(child);
  return list;
};

export class JsonPlaces {
  // doc: the text of the editor.
  constructor(doc) {
    this.doc = doc;
    this.text = doc.toString();
    this.root = jsonLanguage.parser.parse(this.text).topNode.firstChild;
  }

  // { from, to, line, message } of a fault. Text that is no JSON has its place in the words of the fault.
  of(pointer, detail) {
    const match = /^line (\d+), column (\d+): (.*)$/s.exec(detail);
    const { from, to } = match ? this.at(Number(match[1]), Number(match[2])) : this.locate(pointer);
    return { from, to, line: this.doc.lineAt(from).number, message: match ? match[3] : detail };
  }

  // The character at a line and column, both from 1.
  at(line, column) {
    const { length, lines } = this.doc;
    const from = Math.min(this.doc.line(Math.min(line, lines)).from + Math.max(0, column - 1), length);
    return { from, to: Math.min(from + 1, length) };
  }

  // Of the value that the pointer names, or of the nearest one around it.
  locate(pointer) {
    let place = this.root;
    for (const token of pointer.split("/").slice(1)) {
      const next = place && this.child(place, token.replaceAll("~1", "/").replaceAll("~0", "~"));
      if (!next) break;
      place = next;
    }
    return { from: place?.from ?? 0, to: place?.to ?? 0 };
  }

  child(place, token) {
    const value = place.name === "Property" ? place.lastChild : place;
    if (value.name === "Object") return value.getChildren("Property").find((member) => this.nameOf(member) === token);
    if (value.name === "Array") return childrenOf(value).filter(({ name }) => VALUE.test(name))[Number(token)];
    return undefined;
  }

  nameOf({ firstChild: { from, to } }) {
    try {
      return JSON.parse(this.text.slice(from, to));
    } catch {
      return null;
    }
  }
}
