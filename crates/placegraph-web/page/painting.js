// What somebody painted: a class per cell, the classes, and every earlier state of both.

export const NOTHING = 0;
export const MAX_CLASSES = 8;
export const ROLES = [["place", "a place, as a room"], ["passage", "a passage"], ["doorway", "a doorway"]];

/** Colors of new classes, as the program gives them. */
const COLORS = [
  [86, 156, 214], [244, 200, 120], [206, 68, 84], [120, 178, 120], [160, 130, 200], [230, 150, 80], [110, 190, 190], [200, 140, 170],
];
/** Numbers of a run: its first cell, how many cells, their values before and after. */
const RUN = 4;

/** The runs of cells in which two pictures differ. */
export function runsBetween(before, after) {
  const runs = [];
  for (let i = 0; i < after.length; i += 1) {
    if (before[i] === after[i]) continue;
    const start = i;
    while (i + 1 < after.length && before[i + 1] === before[start] && after[i + 1] === after[start]) i += 1;
    runs.push(start, i - start + 1, before[start], after[start]);
  }
  return Int32Array.from(runs);
}

export class Painting {
  /** `values`: the number of the class of every cell, 0 for none, rows from the top; `classes`: `{ value, name, role, color }`. */
  constructor({ width, height, values, classes, steps = [], index = steps.length }) {
    Object.assign(this, { width, height, values, classes, steps, index, before: null });
  }

  get canUndo() {
    return this.index > 0;
  }

  get canRedo() {
    return this.index < this.steps.length;
  }

  classOf(value) {
    return this.classes.find((info) => info.value === value);
  }

  /** A stroke begins: what `values` are given until its end is one step. */
  begin() {
    this.before ??= this.values.slice();
  }

  /** The stroke ends; returns whether it changed anything. */
  end() {
    if (!this.before) return false;
    const runs = runsBetween(this.before, this.values);
    this.before = null;
    return runs.length > 0 && this.#add({ runs, classes: null });
  }

  /** The stroke never was. */
  drop() {
    if (this.before) this.values.set(this.before);
    this.before = null;
  }

  /** Other classes, and with them other values, as one step. */
  become(classes, values = this.values) {
    const step = { runs: runsBetween(this.values, values), classes: [this.classes, classes] };
    // In place: a picture of the cells shares them.
    this.values.set(values);
    this.classes = classes;
    this.#add(step);
  }

  /** A new class with a name, a color and a value that no other has; nothing if there are too many. */
  addClass() {
    if (this.classes.length >= MAX_CLASSES) return null;
    const free = (list, taken) => list.find((item) => !this.classes.some((info) => taken(info, item)));
    const value = free(Array.from({ length: MAX_CLASSES }, (_, k) => k + 1), (info, item) => info.value === item);
    const color = free(COLORS, (info, item) => info.color.join() === item.join()) ?? [value * 20, 90, 250 - value * 20];
    const name = free(Array.from({ length: MAX_CLASSES + 1 }, (_, k) => `class ${k + 1}`), (info, item) => info.name === item);
    const added = { value, name, role: "place", color };
    this.become([...this.classes, added]);
    return added;
  }

  changeClass(value, change) {
    this.become(this.classes.map((info) => (info.value === value ? { ...info, ...change } : info)));
  }

  /** Without the class; its cells have none. */
  removeClass(value) {
    this.become(this.classes.filter((info) => info.value !== value), this.values.map((other) => (other === value ? NOTHING : other)));
  }

  undo() {
    if (!this.canUndo) return;
    this.index -= 1;
    this.#apply(this.steps[this.index], 2, 0);
  }

  redo() {
    if (!this.canRedo) return;
    this.#apply(this.steps[this.index], 3, 1);
    this.index += 1;
  }

  /** Number of cells of every class by its value. */
  counts() {
    const counts = new Array(256).fill(0);
    for (const value of this.values) counts[value] += 1;
    return counts;
  }

  /** The cells numbered from 1 in the order of `classes`, each found by its name. */
  numbered(classes) {
    const number = new Uint8Array(256);
    for (const { value, name } of this.classes) number[value] = classes.findIndex((info) => info.name === name) + 1;
    return this.values.map((value) => number[value]);
  }

  /** What is kept over a reload. */
  toKeep() {
    const { width, height, values, classes, steps, index } = this;
    return { width, height, values, classes, steps, index };
  }

  #add(step) {
    this.steps = [...this.steps.slice(0, this.index), step];
    this.index += 1;
    return true;
  }

  #apply({ runs, classes }, which, side) {
    for (let i = 0; i < runs.length; i += RUN) this.values.fill(runs[i + which], runs[i], runs[i] + runs[i + 1]);
    if (classes) this.classes = classes[side];
  }
}

/** The classes of a model with a value each. */
export const withValues = (classes) => classes.map(({ name, role, color }, k) => ({ value: k + 1, name, role, color }));

/** The classes of several paintings: those of the first, then those of the others with new names. */
export function joinedClasses(paintings) {
  const joined = [];
  for (const { classes } of paintings) {
    for (const { name, role, color } of classes) if (!joined.some((info) => info.name === name)) joined.push({ name, role, color });
  }
  return joined;
}
