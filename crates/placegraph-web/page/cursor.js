// A cross on the map that the arrow keys move: the pointer of those who draw with the keyboard.

const STEP_PX = 12;
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Cursor {
  /** `describe(at)` says what lies at a point, for screen readers. */
  constructor(say, describe) {
    Object.assign(this, { say, describe, at: null });
  }

  /** Where the cross is; it appears in the middle of the map. */
  place(viewer) {
    this.at ??= viewer.camera.toCells([viewer.width / 2, viewer.height / 2]);
    return this.at;
  }

  /** Moves by a key; returns whether it was one that moves. */
  key(event, viewer) {
    const step = STEPS[event.key];
    if (!step) return false;
    const [x, y] = this.place(viewer);
    const length = (event.shiftKey ? 1 : STEP_PX) / viewer.camera.scale;
    this.at = [x + step[0] * length, y + step[1] * length];
    const meters = viewer.data.toMeters(this.at).map((v) => v.toFixed(2)).join(", ");
    this.say([`${meters} meters`, this.describe(this.at)].filter(Boolean).join(", "));
    viewer.repaint();
    return true;
  }

  paint(context, { camera, colors }) {
    if (!this.at) return;
    const [x, y] = camera.toScreen(this.at);
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
