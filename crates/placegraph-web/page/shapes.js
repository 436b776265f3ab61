// The cells of shapes that are painted. Each calls `set(x, y)` for the cells that it covers; cells count from the upper left.

import { boxOf } from "../../placegraph/assets/viewer/mapdata.js";

/** All cells whose middle is at most `radius` from the line, and the cell under its end. */
export function brush(from, to, radius, set) {
  const [x0, x1] = [Math.min(from[0], to[0]) - radius, Math.max(from[0], to[0]) + radius];
  const [y0, y1] = [Math.min(from[1], to[1]) - radius, Math.max(from[1], to[1]) + radius];
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length2 = dx * dx + dy * dy;
  for (let y = Math.floor(y0); y <= y1; y += 1) {
    for (let x = Math.floor(x0); x <= x1; x += 1) {
      const [px, py] = [x + 0.5 - from[0], y + 0.5 - from[1]];
      const along = length2 ? Math.min(Math.max((px * dx + py * dy) / length2, 0), 1) : 0;
      if ((px - along * dx) ** 2 + (py - along * dy) ** 2 <= radius * radius) set(x, y);
    }
  }
  set(Math.floor(to[0]), Math.floor(to[1]));
}

/** All cells whose middle lies inside of the rings of corners, holes left out. */
export function polygon(rings, set) {
  const [, top, , bottom] = boxOf(rings);
  for (let y = Math.floor(top); y <= bottom; y += 1) {
    const crossings = [];
    for (const ring of rings) {
      ring.forEach(([ax, ay], k) => {
        const [bx, by] = ring[(k + 1) % ring.length];
        if (ay > y + 0.5 !== by > y + 0.5) crossings.push(ax + ((y + 0.5 - ay) / (by - ay)) * (bx - ax));
      });
    }
    crossings.sort((a, b) => a - b);
    for (let k = 0; k + 1 < crossings.length; k += 2) {
      for (let x = Math.ceil(crossings[k] - 0.5); x + 0.5 < crossings[k + 1]; x += 1) set(x, y);
    }
  }
}

/** The cells that are joined to `start` by sides and for which `isSame(x, y)` holds. */
export function flood(start, [width, height], isSame, set) {
  const seen = new Uint8Array(width * height);
  const waiting = [];
  const visit = (x, y) => {
    if (x < 0 || y < 0 || x >= width || y >= height || seen[y * width + x] || !isSame(x, y)) return;
    seen[y * width + x] = 1;
    waiting.push(y * width + x);
  };
  visit(Math.floor(start[0]), Math.floor(start[1]));
  while (waiting.length) {
    const cell = waiting.pop();
    const [x, y] = [cell % width, Math.floor(cell / width)];
    set(x, y);
    visit(x - 1, y);
    visit(x + 1, y);
    visit(x, y - 1);
    visit(x, y + 1);
  }
}
