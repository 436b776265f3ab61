// Names on the map that never overlap: the important ones first, each where it fits, else not at all.

const GAP_PX = 3;

/** `items`: `{ at: [x, y] on the screen, width, height }`, most important first. Returns those that fit, with `left` and `top`. */
export function placeNames(items, screen) {
  const placed = [];
  const rows = new Map();
  const ROW_PX = 64;
  const rowsOf = (box) => {
    const found = [];
    for (let row = Math.floor(box[1] / ROW_PX); row <= Math.floor(box[3] / ROW_PX); row += 1) found.push(row);
    return found;
  };
  const isFree = (box) =>
    rowsOf(box).every((row) =>
      (rows.get(row) ?? []).every((o) => box[2] <= o[0] || o[2] <= box[0] || box[3] <= o[1] || o[3] <= box[1]),
    );
  for (const item of items) {
    const { at, width, height } = item;
    if (at[0] < 0 || at[1] < 0 || at[0] > screen[0] || at[1] > screen[1]) continue;
    const below = height / 2 + 9;
    for (const [dx, dy] of [[0, -below], [0, below], [width / 2 + 10, 0], [-width / 2 - 10, 0]]) {
      const left = at[0] + dx - width / 2;
      const top = at[1] + dy - height / 2;
      const box = [left - GAP_PX, top - GAP_PX, left + width + GAP_PX, top + height + GAP_PX];
      if (!isFree(box)) continue;
      for (const row of rowsOf(box)) rows.set(row, [...(rows.get(row) ?? []), box]);
      placed.push({ ...item, left, top });
      break;
    }
  }
  return placed;
}
