// What can be mended, each as one entry of the edit file. Points are meters of the map frame, to the millimeter.

const rounded = (value) => Math.round(value * 1000) / 1000 + 0;
const point = ([x, y]) => [rounded(x), rounded(y)];

/** The tools that draw a line. `key` chooses them; `cells` are the two ends in cells, `toMeters` gives meters. */
export const LINE_TOOLS = [
  { id: "split", name: "Split", key: "s", hint: "Draw a line across a place: it becomes two." },
  { id: "add_doorway", name: "Add doorway", key: "d", hint: "Draw a line from jamb to jamb: it becomes a doorway." },
  { id: "move_doorway", name: "Move doorway", key: "m", hint: "Draw the line where the chosen doorway belongs, from jamb to jamb." },
  { id: "close", name: "Wall", key: "w", hint: "Draw a wall that closes a gap. The map is labeled again." },
  { id: "open", name: "Opening", key: "o", hint: "Draw a line through a wall, from free space to free space: a door that was shut. The map is labeled again." },
];

/** The edit that a line makes; a doorway that moves is `place`. */
export function lineEdit(action, ends, place) {
  const line = ends.map(point);
  return action === "move_doorway" ? { action, at: insideOf(place), line } : { action, line };
}

/** A point of the place, for edits: numbers and names change from run to run, the ground does not. */
export const insideOf = (place) => point([place.x, place.y]);

export const rename = (place, name) => ({ action: "rename", at: insideOf(place), name });
export const relabel = (place, name) => ({ action: "relabel", at: insideOf(place), class: name });
export const merge = (places) => ({ action: "merge", at: places.map(insideOf) });
export const removeDoorway = (place) => ({ action: "remove_doorway", at: insideOf(place) });
export const exclude = (place) => ({ action: "exclude", at: insideOf(place) });

const at = (target) => (Array.isArray(target) ? `(${target.map((v) => v.toFixed(2)).join(", ")})` : `“${target}”`);
const along = ([a, b]) => `from ${at(a)} to ${at(b)}`;

/** An edit in words. */
export function inWords(edit) {
  const words = {
    rename: () => `Name the place at ${at(edit.at)} “${edit.name}”`,
    relabel: () => `The place at ${at(edit.at)} is a ${edit.class}`,
    split: () => `Split ${along(edit.line)}`,
    merge: () => `Merge the places at ${edit.at.map(at).join(" and ")}`,
    add_doorway: () => `Doorway ${along(edit.line)}`,
    move_doorway: () => `Move the doorway at ${at(edit.at)} to the line ${along(edit.line)}`,
    remove_doorway: () => `Remove the doorway at ${at(edit.at)}`,
    close: () => `Wall ${along(edit.line)}`,
    open: () => `Opening ${along(edit.line)}`,
    exclude: () => `Not a place: ${at(edit.at)}`,
  };
  return words[edit.action]?.() ?? edit.action;
}

/** Whether the map itself changes, so that it must be labeled again. */
export const isOnMap = (edit) => edit.action === "close" || edit.action === "open";
