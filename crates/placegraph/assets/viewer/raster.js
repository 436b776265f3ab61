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
    this.levels = [{ size: 1, tiles: this.#largest(table) }];
    while (this.width / this.levels.at(-1).size > TILE || this.height / this.levels.at(-1).size > TILE) {
      this.levels.push(this.#halved(this.levels.at(-1)));
    }
  }

  #largest(table) {
    const tiles = [];
    for (let y = 0; y < this.height; y += TILE) {
      for (let x = 0; x < this.width; x += TILE) {
        const [w, h] = [Math.min(TILE, this.width - x), Math.min(TILE, this.height - y)];
        const image = new ImageData(w, h);
        const pixels = new Uint32Array(image.data.buffer);
        for (let row = 0; row < h; row += 1) {
          const start = (y + row) * this.width + x;
          for (let column = 0; column < w; column += 1) pixels[row * w + column] = table[this.values[start + column]];
        }
        const canvas = newCanvas(w, h);
        canvas.getContext("2d").putImageData(image, 0, 0);
        tiles.push({ canvas, x, y, width: w, height: h });
      }
    }
    return tiles;
  }

  #halved({ size, tiles }) {
    const step = TILE * size * 2;
    const groups = new Map();
    for (const tile of tiles) {
      const key = `${Math.floor(tile.x / step)} ${Math.floor(tile.y / step)}`;
      groups.set(key, [...(groups.get(key) ?? []), tile]);
    }
    const made = [...groups.values()].map((group) => {
      const x = Math.floor(group[0].x / step) * step;
      const y = Math.floor(group[0].y / step) * step;
      const [width, height] = [Math.min(step, this.width - x), Math.min(step, this.height - y)];
      const canvas = newCanvas(Math.ceil(width / size / 2), Math.ceil(height / size / 2));
      const context = canvas.getContext("2d");
      context.imageSmoothingQuality = "medium";
      const scale = 1 / (size * 2);
      for (const t of group) {
        context.drawImage(t.canvas, (t.x - x) * scale, (t.y - y) * scale, t.width * scale, t.height * scale);
      }
      return { canvas, x, y, width, height };
    });
    return { size: size * 2, tiles: made };
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
