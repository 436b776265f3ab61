// Pictures with a value per cell, as tiles at several sizes: large maps stay fluid and within what a canvas may hold.

const TILE = 1024;

/** 0.3 and below dark violet, over teal, to yellow for 1. */
export function shade(probability) {
  const stops = [[68, 1, 84], [33, 145, 140], [253, 231, 37]];
  const t = Math.min(Math.max((probability - 0.3) / 0.7, 0), 1) * 2;
  const i = Math.min(Math.floor(t), 1);
  return stops[i].map((value, k) => Math.round(value + (t - i) * (stops[i + 1][k] - value)));
}

/** Colors of the values 0 to 255 as RGBA in one table. */
export function palette(colorOf) {
  const table = new Uint32Array(256);
  const bytes = new Uint8Array(table.buffer);
  for (let value = 0; value < 256; value += 1) bytes.set(colorOf(value), value * 4);
  return table;
}

export class Raster {
  /** `values`: a byte per cell, rows from the top. */
  constructor(values, width, height) {
    Object.assign(this, { values, width, height, levels: [] });
  }

  /** Paints all tiles with the colors of `table`; smaller levels follow from larger ones. */
  color(table) {
    this.table = table;
    this.levels = [{ size: 1, tiles: this.#largest() }];
    while (this.width / this.levels.at(-1).size > TILE || this.height / this.levels.at(-1).size > TILE) {
      this.levels.push(this.#halved(this.levels.at(-1)));
    }
  }

  /** Paints again what changed within the box `[x0, y0, x1, y1]`. */
  update([x0, y0, x1, y1]) {
    for (const [k, { size, tiles }] of this.levels.entries()) {
      // Whole pixels of this level, and some more for those that are smoothed over the edge.
      const grown = [Math.floor(x0 / size - 2), Math.floor(y0 / size - 2), Math.ceil(x1 / size + 2), Math.ceil(y1 / size + 2)].map((v) => v * size);
      for (const tile of tiles) {
        const [left, top] = [Math.max(grown[0], tile.x), Math.max(grown[1], tile.y)];
        const [right, bottom] = [Math.min(grown[2], tile.x + tile.width), Math.min(grown[3], tile.y + tile.height)];
        if (left >= right || top >= bottom) continue;
        if (k === 0) this.#paint(tile, [left, top, right, bottom]);
        else this.#shrink(tile, size, this.levels[k - 1].tiles, [left, top, right, bottom]);
      }
    }
  }

  #largest() {
    const tiles = [];
    for (let y = 0; y < this.height; y += TILE) {
      for (let x = 0; x < this.width; x += TILE) {
        const [width, height] = [Math.min(TILE, this.width - x), Math.min(TILE, this.height - y)];
        const tile = { canvas: newCanvas(width, height), x, y, width, height };
        this.#paint(tile, [x, y, x + width, y + height]);
        tiles.push(tile);
      }
    }
    return tiles;
  }

  /** The cells of a box in a tile of the largest level. */
  #paint(tile, [left, top, right, bottom]) {
    const [w, h] = [right - left, bottom - top];
    const image = new ImageData(w, h);
    const pixels = new Uint32Array(image.data.buffer);
    for (let row = 0; row < h; row += 1) {
      const start = (top + row) * this.width + left;
      for (let column = 0; column < w; column += 1) pixels[row * w + column] = this.table[this.values[start + column]];
    }
    tile.canvas.getContext("2d").putImageData(image, left - tile.x, top - tile.y);
  }

  /** A box of a tile from the tiles of the level before, which are twice as large. */
  #shrink(tile, size, larger, [left, top, right, bottom]) {
    const context = tile.canvas.getContext("2d");
    context.imageSmoothingQuality = "medium";
    context.save();
    context.beginPath();
    context.rect((left - tile.x) / size, (top - tile.y) / size, (right - left) / size, (bottom - top) / size);
    context.clip();
    context.clearRect(0, 0, tile.canvas.width, tile.canvas.height);
    for (const t of larger) {
      if (t.x >= right || t.y >= bottom || t.x + t.width <= left || t.y + t.height <= top) continue;
      context.drawImage(t.canvas, (t.x - tile.x) / size, (t.y - tile.y) / size, t.width / size, t.height / size);
    }
    context.restore();
  }

  #halved({ size: before, tiles: larger }) {
    const size = before * 2;
    const step = TILE * size;
    const tiles = [];
    for (let y = 0; y < this.height; y += step) {
      for (let x = 0; x < this.width; x += step) {
        const [width, height] = [Math.min(step, this.width - x), Math.min(step, this.height - y)];
        const tile = { canvas: newCanvas(Math.ceil(width / size), Math.ceil(height / size)), x, y, width, height };
        this.#shrink(tile, size, larger, [x, y, x + width, y + height]);
        tiles.push(tile);
      }
    }
    return { size, tiles };
  }

  /** Draws what is in sight; `context` counts in cells. */
  draw(context, scale, [x0, y0, x1, y1]) {
    const wanted = Math.max(0, Math.floor(Math.log2(1 / scale)));
    const level = this.levels[Math.min(wanted, this.levels.length - 1)];
    context.imageSmoothingEnabled = scale < 1;
    for (const tile of level?.tiles ?? []) {
      if (tile.x > x1 || tile.y > y1 || tile.x + tile.width < x0 || tile.y + tile.height < y0) continue;
      context.drawImage(tile.canvas, tile.x, tile.y, tile.width, tile.height);
    }
  }
}

function newCanvas(width, height) {
  return Object.assign(document.createElement("canvas"), { width, height });
}

/** The values of a gray picture, rows from the top. */
export async function valuesOf(source, width, height) {
  const image = new Image();
  image.src = source;
  await image.decode();
  const values = new Uint8Array(width * height);
  const rows = Math.max(1, Math.floor((1 << 22) / width));
  const canvas = newCanvas(width, Math.min(rows, height));
  const context = canvas.getContext("2d", { willReadFrequently: true });
  for (let y = 0; y < height; y += rows) {
    const h = Math.min(rows, height - y);
    context.drawImage(image, 0, -y);
    const { data } = context.getImageData(0, 0, width, h);
    for (let i = 0; i < width * h; i += 1) values[y * width + i] = data[i * 4];
  }
  return values;
}
