// The map on a canvas: pan, zoom, pinch, keyboard, hover and choice. It knows nothing of what surrounds it.

import { Camera, scaleBar } from "./camera.js";
import { LAYERS, occupancyPalette, paintLayers, paintMark, probabilityPalette, themeColors } from "./layers.js";
import { element } from "./dom.js";
import { Raster } from "./raster.js";

/** A full painting that takes longer than this is reused while the map moves. */
const SLOW_MS = 7;
/** How long the map rests before it is painted in full again. */
const REST_MS = 90;
const CLICK_PX = 5;
const KEY_STEP = 0.12;

export class Viewer {
  /** Builds the viewer inside of `host`. `on`: `{ choose(place), hover(place, meters, event) }`, all optional. */
  constructor(host, on = {}) {
    Object.assign(this, { host, on, camera: new Camera(), data: null, selected: null, hovered: null, patterns: [] });
    this.shown = Object.fromEntries(LAYERS.map(({ id, on: isOn }) => [id, isOn]));
    /** What handles pointers and keys before the viewer does, and paints on top: a drawing tool. */
    this.tool = null;
    /** A `Raster` of classes that is shown instead of the result's. */
    this.labels = null;
    this.canvas = element(host, "canvas", {
      id: "map", tabindex: "0", role: "application", "aria-roledescription": "map",
      "aria-label": "Map. Arrow keys move it, plus and minus zoom, 0 shows all of it, Enter chooses the place in the middle.",
    });
    this.scaleBar = element(host, "div", { class: "scale-bar", "aria-hidden": "true" });
    this.sheet = document.createElement("canvas");
    this.context = this.canvas.getContext("2d", { alpha: false });
    this.pointers = new Map();
    this.costMs = 0;
    this.frames = [];
    this.#listen();
    this.colors = themeColors(this.#isDark());
    new ResizeObserver(() => this.#resize()).observe(host);
    this.#resize();
  }

  /** Shows a result. `rasters`: `{ occupancy, probability }`, a byte per cell each; what is not given stays. */
  show(data, rasters = {}) {
    this.data = data;
    for (const [name, values] of Object.entries(rasters)) {
      this[name] = values && new Raster(values, data.width, data.height);
    }
    this.retheme();
    if (this.hovered && !data.byId.has(this.hovered)) this.hovered = null;
    if (this.selected && !data.byId.has(this.selected)) this.selected = null;
    this.invalidate();
  }

  retheme() {
    this.colors = themeColors(this.#isDark());
    this.occupancy?.color(occupancyPalette(this.colors));
    this.probability?.color(probabilityPalette());
    this.invalidate();
  }

  setLayer(id, isOn) {
    this.shown[id] = isOn;
    this.invalidate();
  }

  fit(box = this.data?.box()) {
    if (!box) return;
    this.camera.fit(box, this.width, this.height);
    this.isFitted = box;
    this.invalidate();
  }

  /** Marks a place; `isSought` also brings it into sight. */
  select(id, isSought = false) {
    this.selected = id;
    const place = this.data?.byId.get(id);
    if (place && isSought) this.#seek(place.box);
    this.invalidate();
  }

  zoomBy(factor, at = [this.width / 2, this.height / 2]) {
    this.isFitted = null;
    this.camera.zoom(factor, at);
    this.#moved();
  }

  panBy(dx, dy) {
    this.isFitted = null;
    this.camera.pan(dx, dy);
    this.#moved();
  }

  /** Paints again from nothing at the next frame. */
  invalidate() {
    this.sheetCamera = null;
    this.#request();
  }

  /** Paints again what lies over the layers. */
  repaint() {
    this.#request();
  }

  #isDark() {
    return getComputedStyle(this.host).getPropertyValue("--is-dark").trim() === "1";
  }

  #seek([x0, y0, x1, y1]) {
    const [left, top] = this.camera.toScreen([x0, y0]);
    const [right, bottom] = this.camera.toScreen([x1, y1]);
    const isInSight = left >= 0 && top >= 0 && right <= this.width && bottom <= this.height;
    const isLarge = Math.max(right - left, bottom - top) > 48;
    if (isInSight && isLarge) return;
    const margin = Math.max(x1 - x0, y1 - y0, 20) * 0.7;
    this.fit([x0 - margin, y0 - margin, x1 + margin, y1 + margin]);
  }

  #resize() {
    const { width, height } = this.host.getBoundingClientRect();
    this.dpr = Math.min(globalThis.devicePixelRatio || 1, 2);
    [this.width, this.height] = [Math.max(width, 1), Math.max(height, 1)];
    this.canvas.width = Math.round(this.width * this.dpr);
    this.canvas.height = Math.round(this.height * this.dpr);
    if (this.isFitted) this.fit(this.isFitted);
    this.invalidate();
  }

  #moved() {
    clearTimeout(this.resting);
    this.isMoving = true;
    this.resting = setTimeout(() => {
      this.isMoving = false;
      if (this.isStale) this.invalidate();
    }, REST_MS);
    this.#request();
  }

  #request() {
    this.frame ??= requestAnimationFrame(() => {
      this.frame = null;
      this.#paint();
    });
  }

  #paint() {
    const start = performance.now();
    if (!this.data) {
      this.context.fillStyle = getComputedStyle(this.host).backgroundColor;
      this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
      return;
    }
    if (this.costMs > SLOW_MS && this.isMoving && this.#sheetCovers()) {
      this.#blit();
      this.isStale = true;
    } else {
      this.#paintSheet();
      this.#blit();
      this.isStale = false;
      this.costMs = performance.now() - start;
    }
    this.#paintOver();
    this.#paintScaleBar();
    this.frames.push(performance.now() - start);
    if (this.frames.length > 240) this.frames.shift();
  }

  /** The layers on a sheet with a margin around the screen, so that it can be moved for a while. */
  #paintSheet() {
    const margin = this.costMs > SLOW_MS ? 0.25 : 0;
    const [mx, my] = [Math.round(this.width * margin), Math.round(this.height * margin)];
    const [width, height] = [this.width + 2 * mx, this.height + 2 * my];
    this.sheet.width = Math.round(width * this.dpr);
    this.sheet.height = Math.round(height * this.dpr);
    const camera = this.camera.copy();
    camera.x -= mx / camera.scale;
    camera.y -= my / camera.scale;
    const context = this.sheet.getContext("2d", { alpha: false });
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = `rgb(${this.colors.unknown.slice(0, 3).join()})`;
    context.fillRect(0, 0, this.sheet.width, this.sheet.height);
    const [x1, y1] = camera.toCells([width, height]);
    const at = { camera, sight: [camera.x, camera.y, x1, y1], dpr: this.dpr, size: [width, height] };
    paintLayers(context, this, at);
    Object.assign(this, { sheetCamera: camera, sheetSize: [width, height] });
  }

  #sheetCovers() {
    if (!this.sheetCamera) return false;
    const ratio = this.camera.scale / this.sheetCamera.scale;
    if (ratio < 0.66 || ratio > 1.8) return false;
    const [left, top] = this.sheetCamera.toScreen([this.camera.x, this.camera.y]);
    const [right, bottom] = this.sheetCamera.toScreen(this.camera.toCells([this.width, this.height]));
    return left >= 0 && top >= 0 && right <= this.sheetSize[0] && bottom <= this.sheetSize[1];
  }

  #blit() {
    const ratio = this.camera.scale / this.sheetCamera.scale;
    const [left, top] = this.camera.toScreen([this.sheetCamera.x, this.sheetCamera.y]);
    const { context, dpr } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.sheet, Math.round(left * dpr), Math.round(top * dpr), this.sheet.width * ratio, this.sheet.height * ratio);
  }

  #paintOver() {
    const { context, camera, dpr } = this;
    context.setTransform(camera.scale * dpr, 0, 0, camera.scale * dpr, -camera.x * camera.scale * dpr, -camera.y * camera.scale * dpr);
    for (const [id, kind] of this.labels ? [] : [[this.hovered, "hovered"], [this.selected, "selected"]]) {
      const place = this.data.byId.get(id);
      if (place) paintMark(context, place, kind, this.colors, 1 / camera.scale);
    }
    context.setTransform(dpr, 0, 0, dpr, 0, 0);
    this.tool?.paint(context, this);
  }

  #paintScaleBar() {
    const { meters, px } = scaleBar(this.camera.scale / this.data.resolution_m);
    const text = `${meters} m`;
    if (this.scaleBar.textContent !== text) this.scaleBar.textContent = text;
    this.scaleBar.style.width = `${px}px`;
  }

  #at(event) {
    const { left, top } = this.canvas.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  #listen() {
    const { canvas } = this;
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoomBy(Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0015)), this.#at(event));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.#up(event));
    canvas.addEventListener("pointerleave", () => this.#hover(null));
    canvas.addEventListener("keydown", (event) => this.#key(event));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.retheme());
  }

  #down(event) {
    const at = this.#at(event);
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, at);
    if (this.pointers.size === 1) this.pressed = { at, moved: false, button: event.button };
    else {
      if (this.pressed) this.pressed.moved = true;
      this.tool?.cancel?.();
    }
    if (this.pointers.size === 1 && event.button === 0 && this.data) this.tool?.down?.(this.camera.toCells(at), this);
  }

  #move(event) {
    const at = this.#at(event);
    const before = this.pointers.get(event.pointerId);
    if (before) this.#drag(event, before, at);
    if (!this.data) return;
    const cells = this.camera.toCells(at);
    this.tool?.move?.(cells, this);
    if (!before || !this.pressed?.moved) this.#hover(this.data.placeAt(cells), this.data.toMeters(cells), event);
  }

  #drag(event, before, at) {
    if (Math.hypot(at[0] - this.pressed.at[0], at[1] - this.pressed.at[1]) > CLICK_PX) this.pressed.moved = true;
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, point]) => point);
    this.pointers.set(event.pointerId, at);
    if (others.length === 1) {
      // Two fingers: the point between them stays under them.
      const [other] = others;
      const distance = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
      const middle = (p) => [(p[0] + other[0]) / 2, (p[1] + other[1]) / 2];
      const [from, to] = [middle(before), middle(at)];
      this.panBy(to[0] - from[0], to[1] - from[1]);
      this.zoomBy(distance(at) / Math.max(distance(before), 1), to);
    } else if (others.length === 0 && this.pressed.moved && !this.tool?.isDragging) {
      this.panBy(at[0] - before[0], at[1] - before[1]);
      this.canvas.classList.add("dragging");
      this.#hover(null);
    }
  }

  #up(event) {
    const wasClick = this.pointers.size === 1 && this.pressed && !this.pressed.moved && event.type === "pointerup" && this.pressed.button === 0;
    this.pointers.delete(event.pointerId);
    this.canvas.classList.remove("dragging");
    if (!this.data) return;
    const cells = this.camera.toCells(this.#at(event));
    if (this.tool) this.tool.up?.(cells, this, wasClick);
    else if (wasClick) this.on.choose?.(this.data.placeAt(cells) ?? null);
  }

  #hover(place, meters, event) {
    const id = place?.id ?? null;
    if (id !== this.hovered) {
      this.hovered = id;
      this.repaint();
    }
    this.on.hover?.(place ?? null, meters ?? null, event);
  }

  #key(event) {
    if (!this.data || event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.tool?.key?.(event, this)) {
      event.preventDefault();
      return;
    }
    const [dx, dy] = [this.width * KEY_STEP, this.height * KEY_STEP];
    const keys = {
      ArrowLeft: () => this.panBy(dx, 0), ArrowRight: () => this.panBy(-dx, 0),
      ArrowUp: () => this.panBy(0, dy), ArrowDown: () => this.panBy(0, -dy),
      "+": () => this.zoomBy(1.25), "=": () => this.zoomBy(1.25), "-": () => this.zoomBy(0.8), 0: () => this.fit(),
      Enter: () => this.on.choose?.(this.data.placeAt(this.camera.toCells([this.width / 2, this.height / 2])) ?? null),
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  }
}
