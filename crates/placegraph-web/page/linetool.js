// Draws a line on the map, by dragging, by two clicks, or with the keyboard.

import { Cursor } from "./cursor.js";

const SNAP_PX = 12;

/** The point that `at` means: a jamb close by, else the closest cell that is not free, else itself. */
export function snapped(at, jambs, isFree, reach) {
  const distance = (p) => Math.hypot(p[0] - at[0], p[1] - at[1]);
  const near = jambs.filter((jamb) => distance(jamb) <= reach).sort((a, b) => distance(a) - distance(b));
  if (near.length) return near[0];
  let best = null;
  const [cx, cy, r] = [Math.floor(at[0]), Math.floor(at[1]), Math.ceil(reach)];
  for (let y = cy - r; y <= cy + r; y += 1) {
    for (let x = cx - r; x <= cx + r; x += 1) {
      const d = distance([x + 0.5, y + 0.5]);
      if (d <= reach && !isFree(x, y) && (!best || d < best.d)) best = { d, at: [x + 0.5, y + 0.5] };
    }
  }
  return best?.at ?? at;
}

export class LineTool {
  /** `done(ends)` takes both ends in cells; `say(text)` speaks to a screen reader; `snaps`: `{ jambs(), isFree(x, y), nameAt(at) }`. */
  constructor(done, say, snaps) {
    Object.assign(this, { done, say, snaps, start: null, end: null, isDragging: false });
    this.cursor = new Cursor(say, snaps.nameAt);
  }

  #snap(at, viewer) {
    return snapped(at, this.snaps.jambs(), this.snaps.isFree, Math.min(SNAP_PX / viewer.camera.scale, 8));
  }

  down(at, viewer) {
    const point = this.#snap(at, viewer);
    this.isDragging = true;
    this.cursor.at = null;
    if (this.start) this.isSecond = true;
    else this.start = point;
    this.end = point;
    viewer.repaint();
  }

  move(at, viewer) {
    if (!this.start || this.cursor.at) return;
    this.end = this.#snap(at, viewer);
    viewer.repaint();
  }

  up(at, viewer, wasClick) {
    this.isDragging = false;
    this.end = this.#snap(at, viewer);
    if (!this.start || (wasClick && !this.isSecond)) return;
    this.#finish(viewer);
  }

  key(event, viewer) {
    if (event.key === "Escape" && this.start) {
      this.reset();
      viewer.repaint();
      return true;
    }
    if (this.cursor.key(event, viewer)) {
      if (this.start) this.end = this.cursor.at;
      return true;
    }
    if (event.key === "Enter" || event.key === " ") {
      const point = this.#snap(this.cursor.place(viewer), viewer);
      if (!this.start) {
        Object.assign(this, { start: point, end: point });
        this.say("first end set");
        viewer.repaint();
      } else {
        this.end = point;
        this.#finish(viewer);
      }
      return true;
    }
    return false;
  }

  reset() {
    Object.assign(this, { start: null, end: null, isSecond: false, isDragging: false });
  }

  #finish(viewer) {
    const ends = [this.start, this.end];
    this.reset();
    viewer.repaint();
    if (Math.hypot(ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]) >= 0.5) this.done(ends);
  }

  paint(context, viewer) {
    const { camera, colors } = viewer;
    const dot = (at, radius) => {
      context.beginPath();
      context.arc(...camera.toScreen(at), radius, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
    };
    context.strokeStyle = colors.halo;
    context.fillStyle = colors.accent;
    context.lineWidth = 2;
    if (this.start) {
      for (const [width, style] of [[6, colors.halo], [3, colors.accent]]) {
        context.beginPath();
        context.moveTo(...camera.toScreen(this.start));
        context.lineTo(...camera.toScreen(this.end));
        context.lineWidth = width;
        context.strokeStyle = style;
        context.stroke();
      }
      context.lineWidth = 2;
      context.strokeStyle = colors.halo;
      dot(this.start, 5);
      dot(this.end, 5);
    }
    this.cursor.paint(context, viewer);
  }
}
