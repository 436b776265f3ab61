// The list of edits, with every earlier state of it: undo and redo without limit.

export class History {
  /** `states`: lists of edits; `index`: the one that holds. */
  constructor(states = [[]], index = states.length - 1) {
    Object.assign(this, { states, index });
  }

  get edits() {
    return this.states[this.index];
  }

  get canUndo() {
    return this.index > 0;
  }

  get canRedo() {
    return this.index < this.states.length - 1;
  }

  /** A new list of edits; what was undone before is forgotten. */
  set(edits) {
    this.states = [...this.states.slice(0, this.index + 1), edits];
    this.index += 1;
  }

  add(edit) {
    this.set([...this.edits, edit]);
  }

  remove(at) {
    this.set(this.edits.filter((_, index) => index !== at));
  }

  undo() {
    if (this.canUndo) this.index -= 1;
  }

  redo() {
    if (this.canRedo) this.index += 1;
  }

  toJSON() {
    return { states: this.states, index: this.index };
  }

  /** What was saved, or nothing where it is not what this wrote. */
  static from(saved) {
    const isList = (value) => Array.isArray(value) && value.every((edit) => typeof edit?.action === "string");
    const { states, index } = saved ?? {};
    if (!Array.isArray(states) || !states.length || !states.every(isList) || !(index in states)) return null;
    return new History(states, Number(index));
  }
}
