// Paints classes on the map: with a brush, an outline or a fill, by pointer or with the keyboard.

import { Cursor } from "./cursor.js";
import { brush, flood, polygon } from "./shapes.js";

export const PAINT_TOOLS = [
  { id: "brush", name: "Brush", key: "b", hint: "Drag to paint; [ and ] change the width. With the keyboard: Enter puts the brush down and lifts it, arrows move it." },
  { id: "polygon", name: "Outline", key: "p", hint: "Click the corners, the first one again to close; Backspace takes one back. With the keyboard: arrows, Enter, and Enter twice to close." },
  { id: "fill", name: "Fill", key: "f", hint: "Click to paint all that is joined and has one class. With the keyboard: arrows, Enter." },
];
const CLOSE_PX = 10;

export class PaintTool {
  /** `on`: `{ painting(), value(), radius(), isFree(x, y), nameAt(at), changed(box), done(), say(text) }`; `kind` as in `PAINT_TOOLS`. */
  constructor(kind, on) {
    Object.assign(this, { kind, on, isDragging: false, isDown: false, last: null, pointer: null, corners: [] });
    this.cursor = new Cursor(on.say, on.nameAt);
  }

  down(at, viewer) {
    this.cursor.at = null;
    if (this.kind !== "brush") return;
    this.isDragging = true;
    this.#stroke(at, viewer);
  }

  move(at, viewer) {
    this.pointer = at;
    if (this.isDragging) this.#stroke(at, viewer);
    else viewer.repaint();
  }

  up(at, viewer, wasClick) {
    if (this.isDragging) this.#lift();
    else if (wasClick) this.#point(at, viewer);
  }

  /** A second finger moves the map: the stroke of the first was not meant. */
  cancel() {
    if (!this.isDragging) return;
    Object.assign(this, { isDragging: false, last: null });
    this.on.painting().drop();
    this.on.done();
  }

  key(event, viewer) {
    if (this.cursor.key(event, viewer)) {
      if (this.isDown) this.#stroke(this.cursor.at, viewer);
      return true;
    }
    if (event.key === "Enter" || event.key === " ") {
      const at = this.cursor.place(viewer);
      if (this.kind !== "brush") this.#point(at, viewer);
      else if (this.isDown) this.#lift();
      else {
        this.isDown = true;
        this.#stroke(at, viewer);
        this.on.say("The brush is down.");
      }
      viewer.repaint();
      return true;
    }
    if (event.key === "Backspace" && this.corners.length) {
      this.corners.pop();
      viewer.repaint();
      return true;
    }
    if (event.key === "Escape" && (this.isDown || this.corners.length)) {
      if (this.isDown) this.#lift();
      this.corners = [];
      viewer.repaint();
      return true;
    }
    return false;
  }

  /** What is begun when the tool is put away. */
  end() {
    if (this.isDown || this.isDragging) this.#lift();
  }

  #stroke(at, viewer) {
    this.on.painting().begin();
    const [from, radius] = [this.last ?? at, this.on.radius()];
    brush(from, at, radius, this.#setter());
    this.last = at;
    const low = [0, 1].map((axis) => Math.floor(Math.min(from[axis], at[axis]) - radius) - 1);
    const high = [0, 1].map((axis) => Math.ceil(Math.max(from[axis], at[axis]) + radius) + 1);
    this.on.changed([...low, ...high], viewer);
  }

  #lift() {
    Object.assign(this, { isDragging: false, isDown: false, last: null });
    this.on.painting().end();
    this.on.done();
  }

  /** A click or an Enter, for what is made of points. */
  #point(at, viewer) {
    const painting = this.on.painting();
    if (this.kind === "brush") return;
    if (this.kind === "polygon" && !this.#closes(at, viewer)) {
      this.corners.push(at);
      this.on.say(`Corner ${this.corners.length}.`);
      viewer.repaint();
      return;
    }
    painting.begin();
    if (this.kind === "fill") {
      const cellAt = (x, y) => painting.values[y * painting.width + x];
      const value = cellAt(Math.floor(at[0]), Math.floor(at[1]));
      flood(at, [painting.width, painting.height], (x, y) => this.on.isFree(x, y) && cellAt(x, y) === value, this.#setter());
    } else {
      polygon([this.corners], this.#setter());
      this.corners = [];
    }
    painting.end();
    this.on.done();
  }

  /** Whether the point closes the outline: it is the first corner again, or the last. */
  #closes(at, viewer) {
    const reach = CLOSE_PX / viewer.camera.scale;
    const isNear = (corner) => Math.hypot(corner[0] - at[0], corner[1] - at[1]) <= reach;
    return this.corners.length > 2 && (isNear(this.corners[0]) || isNear(this.corners.at(-1)));
  }

  /** Paints free cells of the map. */
  #setter() {
    const { values, width, height } = this.on.painting();
    const value = this.on.value();
    return (x, y) => {
      if (x >= 0 && y >= 0 && x < width && y < height && this.on.isFree(x, y)) values[y * width + x] = value;
    };
  }

  paint(context, viewer) {
    const { camera, colors } = viewer;
    const at = this.cursor.at ?? this.pointer;
    const trace = (path) => {
      for (const [width, style] of [[4, colors.halo], [1.5, colors.accent]]) {
        context.lineWidth = width;
        context.strokeStyle = style;
        context.beginPath();
        path();
        context.stroke();
      }
    };
    if (this.kind === "brush" && at) trace(() => context.arc(...camera.toScreen(at), Math.max(this.on.radius() * camera.scale, 2), 0, 2 * Math.PI));
    if (this.corners.length) {
      trace(() => {
        for (const corner of [...this.corners, ...(at ? [at] : [])]) context.lineTo(...camera.toScreen(corner));
      });
      trace(() => context.arc(...camera.toScreen(this.corners[0]), CLOSE_PX / 2, 0, 2 * Math.PI));
    }
    this.cursor.paint(context, viewer);
  }
}
