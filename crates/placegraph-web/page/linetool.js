// Draws a line on the map, by dragging, by two clicks, or with the keyboard.

const SNAP_PX = 12;
const KEY_PX = 12;

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
  /** `done(ends)` takes both ends in cells; `say(text)` speaks to a screen reader; `snaps`: `{ jambs(), isFree(x, y) }`. */
  constructor(done, say, snaps) {
    Object.assign(this, { done, say, snaps, start: null, end: null, cursor: null, isDragging: false });
  }

  #snap(at, viewer) {
    return snapped(at, this.snaps.jambs(), this.snaps.isFree, Math.min(SNAP_PX / viewer.camera.scale, 8));
  }

  down(at, viewer) {
    const point = this.#snap(at, viewer);
    this.isDragging = true;
    this.cursor = null;
    if (this.start) this.isSecond = true;
    else this.start = point;
    this.end = point;
    viewer.repaint();
  }

  move(at, viewer) {
    if (!this.start || this.cursor) return;
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
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const step = steps[event.key];
    const length = (event.shiftKey ? 1 : KEY_PX) / viewer.camera.scale;
    if (step) {
      this.cursor ??= viewer.camera.toCells([viewer.width / 2, viewer.height / 2]);
      this.cursor = [this.cursor[0] + step[0] * length, this.cursor[1] + step[1] * length];
      if (this.start) this.end = this.cursor;
      const [x, y] = viewer.data.toMeters(this.cursor);
      this.say(`${x.toFixed(2)}, ${y.toFixed(2)} meters${viewer.data.placeAt(this.cursor) ? `, ${viewer.data.placeAt(this.cursor).name}` : ""}`);
      viewer.repaint();
      return true;
    }
    if (event.key === "Enter" || event.key === " ") {
      this.cursor ??= viewer.camera.toCells([viewer.width / 2, viewer.height / 2]);
      const point = this.#snap(this.cursor, viewer);
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
    if (this.cursor) {
      const [x, y] = camera.toScreen(this.cursor);
      for (const [width, style] of [[5, colors.halo], [2, colors.accent]]) {
        context.lineWidth = width;
        context.strokeStyle = style;
        context.beginPath();
        context.moveTo(x - 12, y);
        context.lineTo(x + 12, y);
        context.moveTo(x, y - 12);
        context.lineTo(x, y + 12);
        context.stroke();
      }
    }
  }
}
