// The layers of the map, each a function that paints with a context that counts in cells.

import { palette, shade } from "./raster.js";
import { placeNames } from "./placement.js";

export const FREE = 255;
export const UNKNOWN = 128;

/** The layers from bottom to top: id, name, whether it is shown at first. */
export const LAYERS = [
  { id: "occupancy", name: "Occupancy", on: true },
  { id: "classes", name: "Classes", on: true },
  { id: "patterns", name: "Patterns", on: false },
  { id: "probability", name: "Probability", on: false },
  { id: "regions", name: "Outlines", on: true },
  { id: "doorways", name: "Doorways", on: true },
  { id: "graph", name: "Graph", on: true },
  { id: "names", name: "Names", on: true },
];

/** Colors that follow the page's theme. */
export function themeColors(isDark) {
  return isDark
    ? { free: [52, 58, 70, 255], wall: [226, 230, 238, 255], unknown: [22, 26, 33, 255], ink: "#f2f4f8", halo: "#14171d", route: "#f2f4f8", outline: "rgba(10,12,16,.85)", accent: "#86aaff", jamb: "#ff8090" }
    : { free: [255, 255, 255, 255], wall: [40, 44, 56, 255], unknown: [226, 229, 235, 255], ink: "#12161f", halo: "#ffffff", route: "#12161f", outline: "rgba(28,34,48,.9)", accent: "#2458c5", jamb: "#c8102e" };
}

export function occupancyPalette(colors) {
  return palette((value) => (value === FREE ? colors.free : value === UNKNOWN ? colors.unknown : colors.wall));
}

export function probabilityPalette() {
  return palette((value) => (value ? [...shade(value / 255), 230] : [0, 0, 0, 0]));
}

/** Pixels of 12 × 12: lines, dots and crosses, by the number of the class. */
export function patternOf(context, index) {
  const tile = Object.assign(document.createElement("canvas"), { width: 12, height: 12 });
  const ink = tile.getContext("2d");
  ink.strokeStyle = ink.fillStyle = "rgba(10,14,24,.75)";
  ink.lineWidth = 1.5;
  const line = (...points) => {
    ink.beginPath();
    for (let i = 0; i < points.length; i += 4) {
      ink.moveTo(points[i], points[i + 1]);
      ink.lineTo(points[i + 2], points[i + 3]);
    }
    ink.stroke();
  };
  const draw = [
    () => line(-3, 9, 3, 15, -3, -3, 15, 15, 9, -3, 15, 3),
    () => ink.fillRect(5, 5, 2.4, 2.4),
    () => line(0, 0, 12, 12, 12, 0, 0, 12),
    () => line(0, 6, 12, 6),
    () => line(6, 0, 6, 12),
    () => line(-3, 3, 3, -3, -3, 15, 15, -3, 9, 15, 15, 9),
    () => line(0, 6, 12, 6, 6, 0, 6, 12),
    () => ink.strokeRect(3, 3, 6, 6),
  ];
  draw[index % draw.length]();
  return context.createPattern(tile, "repeat");
}

/** The outline of a place, made once. */
function pathOf(place) {
  if (!place.path) {
    place.path = new Path2D();
    for (const ring of place.rings) {
      ring.forEach(([x, y], i) => (i ? place.path.lineTo(x, y) : place.path.moveTo(x, y)));
      place.path.closePath();
    }
  }
  return place.path;
}

const isSeen = ({ box }, sight) => box[0] <= sight[2] && box[2] >= sight[0] && box[1] <= sight[3] && box[3] >= sight[1];

/** Paints every layer that is on. `at`: `{ camera, sight, dpr, size }`; the context is in device pixels before and after. */
export function paintLayers(context, view, at) {
  const { data, shown, colors } = view;
  const { camera, sight, dpr } = at;
  const inCells = () => context.setTransform(camera.scale * dpr, 0, 0, camera.scale * dpr, -camera.x * camera.scale * dpr, -camera.y * camera.scale * dpr);
  const px = 1 / camera.scale;
  inCells();
  if (shown.occupancy && view.occupancy) view.occupancy.draw(context, camera.scale * dpr, sight);
  if (view.labels) {
    // Somebody paints: nothing else shall lie over it.
    view.labels.draw(context, camera.scale * dpr, sight);
    return;
  }
  if (shown.probability && view.probability) view.probability.draw(context, camera.scale * dpr, sight);
  const seen = data.places.filter((place) => isSeen(place, sight));
  if (shown.probability && !view.probability) fill(context, seen, (p) => `rgb(${shade(p.probability).join()})`, 0.9);
  if (shown.classes && !shown.probability) fill(context, seen, (p) => data.classOf.get(p.class)?.css ?? "#999", 0.72);
  if (shown.patterns) paintPatterns(context, view, seen, at);
  if (shown.regions) {
    context.strokeStyle = colors.outline;
    context.lineWidth = 1.2 * px;
    for (const place of seen) context.stroke(pathOf(place));
  }
  if (shown.graph) paintGraph(context, view, px);
  if (shown.doorways) paintJambs(context, seen, colors, px);
  context.setTransform(dpr, 0, 0, dpr, 0, 0);
  if (shown.names) paintNames(context, view, at);
}

function fill(context, places, colorOf, alpha) {
  context.globalAlpha = alpha;
  for (const place of places) {
    context.fillStyle = colorOf(place);
    context.fill(pathOf(place), "evenodd");
  }
  context.globalAlpha = 1;
}

function paintPatterns(context, view, places, { camera }) {
  const scale = 1 / camera.scale;
  for (const place of places) {
    const index = view.data.classOf.get(place.class)?.index ?? 0;
    view.patterns[index] ??= patternOf(context, index);
    // The pattern keeps its size on the screen and moves with the map.
    view.patterns[index].setTransform(new DOMMatrix([scale, 0, 0, scale, 0, 0]));
    context.fillStyle = view.patterns[index];
    context.fill(pathOf(place), "evenodd");
  }
}

function paintGraph(context, { data, colors }, px) {
  context.strokeStyle = colors.route;
  context.lineJoin = "round";
  for (const connection of data.connections) {
    const ends = [data.byId.get(connection.a)?.at, data.byId.get(connection.b)?.at];
    const line = connection.line.length ? connection.line : ends.filter(Boolean);
    if (line.length < 2) continue;
    context.setLineDash(connection.line.length ? [] : [4 * px, 4 * px]);
    context.lineWidth = 1.6 * px;
    context.beginPath();
    line.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
    context.stroke();
  }
  context.setLineDash([]);
  context.lineWidth = 1.6 * px;
  for (const place of data.places.filter((p) => !p.speck)) {
    context.beginPath();
    context.arc(place.at[0], place.at[1], (data.isDoorway(place) ? 3 : 4.5) * px, 0, 2 * Math.PI);
    context.fillStyle = colors.halo;
    context.fill();
    context.stroke();
  }
}

function paintJambs(context, places, colors, px) {
  context.strokeStyle = colors.jamb;
  context.lineCap = "round";
  context.lineWidth = 3.2 * px;
  for (const { jambs } of places) {
    if (!jambs) continue;
    context.beginPath();
    context.moveTo(...jambs[0]);
    context.lineTo(...jambs[1]);
    context.stroke();
  }
  context.lineCap = "butt";
}

const FONT_PX = 12.5;
const FONT = `600 ${FONT_PX}px system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif`;
const MAX_CHARACTERS = 28;

const short = (name) => ([...name].length > MAX_CHARACTERS ? `${[...name].slice(0, MAX_CHARACTERS - 1).join("")}…` : name);

function paintNames(context, { data, colors, shown, selected }, { camera, size }) {
  context.font = FONT;
  const rank = (place) => (place.id === selected ? Infinity : place.area_m2);
  // A doorway is named where it is wide enough on the screen to be told from its neighbors.
  const isNamed = (place) => !place.speck && (!data.isDoorway(place) || place.id === selected
    || (place.width_m / data.resolution_m) * camera.scale > 60);
  const items = data.places.filter(isNamed).sort((a, b) => rank(b) - rank(a)).map((place) => {
    const letter = shown.patterns ? `${data.classOf.get(place.class)?.letter ?? ""} · ` : "";
    // Of a doorway the number, and the name only if it has one of its own.
    const isNumbered = data.isDoorway(place) && place.name === `${place.class} ${place.id}`;
    const text = letter + (isNumbered ? String(place.id) : short(place.name));
    place.textWidths ??= new Map();
    if (!place.textWidths.has(text)) place.textWidths.set(text, context.measureText(text).width);
    return { at: camera.toScreen(place.at), width: place.textWidths.get(text), height: FONT_PX, text };
  });
  context.lineJoin = "round";
  context.lineWidth = 3.5;
  context.strokeStyle = colors.halo;
  context.fillStyle = colors.ink;
  context.textBaseline = "top";
  for (const { text, left, top } of placeNames(items, size)) {
    context.strokeText(text, left, top);
    context.fillText(text, left, top);
  }
}

/** Marks a place: `kind` is "selected" or "hovered". */
export function paintMark(context, place, kind, colors, px) {
  context.globalAlpha = 0.13;
  context.fillStyle = colors.accent;
  context.fill(pathOf(place), "evenodd");
  context.globalAlpha = 1;
  if (kind !== "selected") return;
  context.strokeStyle = colors.accent;
  context.lineWidth = 2.5 * px;
  context.stroke(pathOf(place));
}
