// CodeMirror with what JSON needs. It stands in a shadow root: there it adopts its style sheets, while in the document
// it would insert a style element, which the page's policy forbids. Tab is not bound and leaves the editor.

import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { json } from "@codemirror/lang-json";
import { bracketMatching, syntaxHighlighting } from "@codemirror/language";
import { lintGutter, nextDiagnostic, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { Annotation } from "@codemirror/state";
import { EditorView, highlightActiveLineGutter, keymap, lineNumbers } from "@codemirror/view";

import { highlighting, theme } from "./code_theme.js";
import { JsonPlaces } from "./json_places.js";

const isGiven = Annotation.define(); // the text comes from the form, not from the keyboard

// What is typed over a selection: Chromium would carry the style of the selected text over by a style attribute, which
// the policy forbids, before CodeMirror draws the line again.
const typingOver = EditorView.domEventHandlers({ beforeinput: (event, view) => {
  const selection = view.root.getSelection?.(); // of a shadow root only Chromium has one
  if (event.inputType !== "insertText" || event.data === null || view.composing || !selection || selection.isCollapsed) return false;
  const insert = view.state.toText(event.data);
  const ends = [["anchorNode", "anchorOffset"], ["focusNode", "focusOffset"]].map(([node, offset]) =>
    view.posAtDOM(selection[node], selection[offset]));
  const [from, to] = [Math.min(...ends), Math.max(...ends)];
  view.dispatch({ changes: { from, to, insert }, selection: { anchor: from + insert.length }, userEvent: "input.type",
    scrollIntoView: true });
  return true;
} });

export class CodeEditor {
  // description: the element that says in words what is wrong.
  constructor(box, { text, label, description, onInput }) {
    this.hasFaults = false;
    this.view = new EditorView({ doc: text, parent: box.attachShadow({ mode: "open" }), extensions: [
      lineNumbers(), lintGutter(), highlightActiveLineGutter(), history(), bracketMatching(), highlightSelectionMatches(),
      search({ top: true }), json(), syntaxHighlighting(highlighting), theme, typingOver,
      keymap.of([{ key: "F8", run: nextDiagnostic }, ...searchKeymap, ...historyKeymap, ...defaultKeymap]),
      EditorView.contentAttributes.of(() => ({ tabindex: "0", "aria-label": label, "aria-invalid": String(this.hasFaults) })),
      EditorView.updateListener.of(({ docChanged, transactions }) => {
        if (docChanged && !transactions.some((one) => one.annotation(isGiven))) onInput();
      }),
    ] });
    this.view.contentDOM.ariaDescribedByElements = [description];
  }

  dispose() {
    this.view.destroy();
  }

  get text() {
    return this.view.state.doc.toString();
  }

  set text(value) {
    if (value === this.text) return;
    this.view.dispatch({ changes: { from: 0, to: this.view.state.doc.length, insert: value }, annotations: isGiven.of(true) });
  }

  // Marks [{ pointer, detail }] in the text; returns the errors as [{ pointer, message, line, from, to }].
  mark(errors, warnings) {
    const { doc } = this.view.state;
    const places = new JsonPlaces(doc);
    const at = ({ pointer, detail }) => ({ pointer, ...places.of(pointer, detail) });
    // Of a place of many lines, such as the whole text, the first is underlined.
    const diagnostic = (severity) => ({ from, to, message }) =>
      ({ severity, from, to: Math.min(to, doc.lineAt(from).to), message });
    const faults = errors.map(at);
    this.hasFaults = faults.length > 0;
    this.view.dispatch(setDiagnostics(this.view.state,
      [...faults.map(diagnostic("error")), ...warnings.map(at).map(diagnostic("warning"))]));
    return faults;
  }

  // The text may have become shorter since it was marked.
  select({ from, to }) {
    const { length } = this.view.state.doc;
    const [anchor, head] = [Math.min(from, length), Math.min(to, length)];
    this.view.dispatch({ selection: { anchor, head }, effects: EditorView.scrollIntoView(anchor, { y: "center" }) });
    this.view.focus();
  }
}
