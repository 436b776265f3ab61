// Where the map is on the screen. The camera counts in cells, y down from the map's upper edge, and in pixels.

const MAX_SCALE = 64;

export class Camera {
  /** `x`, `y`: the cell in the upper left corner of the screen; `scale`: pixels per cell. */
  constructor(x = 0, y = 0, scale = 1) {
    Object.assign(this, { x, y, scale, minScale: 1e-3 });
  }

  copy() {
    return Object.assign(new Camera(), this);
  }

  toScreen([x, y]) {
    return [(x - this.x) * this.scale, (y - this.y) * this.scale];
  }

  toCells([left, top]) {
    return [this.x + left / this.scale, this.y + top / this.scale];
  }

  /** Moves the map by pixels. */
  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y -= dy / this.scale;
  }

  /** Zooms; the cell under the pixel `at` stays there. */
  zoom(factor, at) {
    const fixed = this.toCells(at);
    this.scale = Math.min(Math.max(this.scale * factor, this.minScale), MAX_SCALE);
    this.x = fixed[0] - at[0] / this.scale;
    this.y = fixed[1] - at[1] / this.scale;
  }

  /** Shows the box `[x0, y0, x1, y1]` of cells in the middle of `width` × `height` pixels. */
  fit([x0, y0, x1, y1], width, height, margin = 24) {
    const fits = Math.min((width - 2 * margin) / Math.max(x1 - x0, 1), (height - 2 * margin) / Math.max(y1 - y0, 1));
    this.scale = Math.min(Math.max(fits, this.minScale), MAX_SCALE);
    this.x = (x0 + x1) / 2 - width / 2 / this.scale;
    this.y = (y0 + y1) / 2 - height / 2 / this.scale;
  }
}

/** The longest round length of at most `maxPx` pixels: meters and pixels. */
export function scaleBar(pxPerMeter, maxPx = 140) {
  const longest = maxPx / pxPerMeter;
  const power = 10 ** Math.floor(Math.log10(longest));
  const meters = [5, 2, 1].find((n) => n * power <= longest * (1 + 1e-9)) * power;
  return { meters: Number(meters.toPrecision(1)), px: meters * pxPerMeter };
}
