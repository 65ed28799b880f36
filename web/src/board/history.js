// What was edited, to undo and redo: texts of the whole scenario. Changes of one thing that follow each other closely, a drag or a number
// that is being typed, are one.

const MOST = 200;
const ONE_CHANGE_MS = 600;

export class History {
  begin(text) {
    Object.assign(this, { texts: [text], at: 0, what: null, changedAt: -Infinity });
  }

  // what: names the box or handle that was used, or is null.
  take(text, what = null, now = performance.now()) {
    if (text === this.texts[this.at]) return;
    const isOne = what !== null && what === this.what && this.at > 0 && this.at === this.texts.length - 1 && now - this.changedAt < ONE_CHANGE_MS;
    this.texts.splice(isOne ? this.at : this.at + 1, Infinity, text);
    if (this.texts.length > MOST) this.texts.shift();
    this.at = this.texts.length - 1;
    Object.assign(this, { what, changedAt: now });
  }

  canGo(by) {
    return this.texts?.[this.at + by] !== undefined;
  }

  // The text one step back (-1) or on (1).
  go(by) {
    this.at += by;
    this.what = null;
    return this.texts[this.at];
  }
}
