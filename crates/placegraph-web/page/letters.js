// The letters of classes over what is painted, so that color is not all that tells classes apart.

import { Raster } from "../../placegraph/assets/viewer/raster.js";

/** A class has at most one letter in a block of so many pixels. */
const BLOCK_PX = 52;
const SAMPLE_PX = 2;
/** Samples that a class needs within a block: what is smaller than its letter has none. */
const MIN_SAMPLES = 24;
const APART_PX = 17;

/** Where letters stand: `{ value, at }` in cells, in the middle of what is painted in every block of the screen. */
export function letterSpots({ values, width, height }, scale, [x0, y0, x1, y1]) {
  // Whole numbers of cells from the map's corner: letters move with the map.
  const sample = Math.max(1, Math.round(SAMPLE_PX / scale));
  const block = sample * Math.max(1, Math.round(BLOCK_PX / scale / sample));
  const [left, top] = [x0, y0].map((v) => Math.max(0, Math.floor(v / block) * block));
  const [right, bottom] = [Math.min(x1, width), Math.min(y1, height)];
  const least = MIN_SAMPLES * (SAMPLE_PX / (sample * scale)) ** 2;
  const spots = [];
  for (let by = top; by < bottom; by += block) {
    for (let bx = left; bx < right; bx += block) {
      const sums = new Map();
      for (let y = by + (sample >> 1); y < Math.min(by + block, height); y += sample) {
        for (let x = bx + (sample >> 1); x < Math.min(bx + block, width); x += sample) {
          const value = values[y * width + x];
          if (!value) continue;
          let sum = sums.get(value);
          if (!sum) sums.set(value, (sum = [0, 0, 0]));
          sum[0] += 1;
          sum[1] += x;
          sum[2] += y;
        }
      }
      for (const [value, [n, sumX, sumY]] of sums) {
        const at = [sumX / n + 0.5, sumY / n + 0.5];
        if (n >= least && values[Math.floor(at[1]) * width + Math.floor(at[0])] === value) spots.push({ value, at, n });
      }
    }
  }
  const chosen = [];
  for (const spot of spots.sort((a, b) => b.n - a.n)) {
    const isNear = (other) => Math.hypot(other.at[0] - spot.at[0], other.at[1] - spot.at[1]) * scale < APART_PX;
    if (!chosen.some(isNear)) chosen.push(spot);
  }
  return chosen;
}

/** A picture of classes with their letters; `letters` has one for every value. */
export class LetteredRaster extends Raster {
  constructor(values, width, height, letters) {
    super(values, width, height);
    this.letters = letters;
  }

  draw(context, scale, sight) {
    super.draw(context, scale, sight);
    const dpr = devicePixelRatio;
    const { a, e, f } = context.getTransform();
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.font = `700 ${12.5 * dpr}px system-ui, "DejaVu Sans", sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.lineJoin = "round";
    context.lineWidth = 3 * dpr;
    context.strokeStyle = "#ffffffb0";
    context.fillStyle = "#12161f";
    for (const { value, at } of letterSpots(this, scale / dpr, sight)) {
      const [x, y] = [at[0] * a + e, at[1] * a + f];
      context.strokeText(this.letters.get(value), x, y);
      context.fillText(this.letters.get(value), x, y);
    }
    context.restore();
  }
}
