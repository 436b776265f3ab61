// What is painted, without a browser: node --test
import test from "node:test";
import assert from "node:assert/strict";
import { isInside } from "../../../placegraph/assets/viewer/mapdata.js";
import { letterSpots } from "../../page/letters.js";
import { joinedClasses, MAX_CLASSES, Painting, runsBetween, withValues } from "../../page/painting.js";
import { brush, flood, polygon } from "../../page/shapes.js";
import { numbers } from "./numbers.mjs";

const CLASSES = withValues([
  { name: "hall", role: "passage", color: [1, 2, 3] }, { name: "office", role: "place", color: [4, 5, 6] }, { name: "door", role: "doorway", color: [7, 8, 9] },
]);
const [WIDTH, HEIGHT] = [40, 30];
const blank = () => new Painting({ width: WIDTH, height: HEIGHT, values: new Uint8Array(WIDTH * HEIGHT), classes: CLASSES });
/** The cells that a shape sets, each once. */
function cellsOf(shape) {
  const cells = new Set();
  shape((x, y) => cells.add(`${x} ${y}`));
  return cells;
}
const allCells = () => Array.from({ length: WIDTH * HEIGHT }, (_, i) => [i % WIDTH, Math.floor(i / WIDTH)]);

test("a brush covers what is near its way, and the cell under it", () => {
  const [from, to] = [[5.2, 6.1], [20.7, 14.4]];
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const cells = cellsOf((set) => brush(from, to, 3, set));
  for (const [x, y] of allCells()) {
    // The least distance over many points of the way.
    const distance = Math.min(...Array.from({ length: 2001 }, (_, k) => Math.hypot(x + 0.5 - from[0] - (k / 2000) * dx, y + 0.5 - from[1] - (k / 2000) * dy)));
    if (Math.abs(distance - 3) > 0.01) assert.equal(cells.has(`${x} ${y}`), distance < 3, `${x}, ${y}`);
  }
  assert.deepEqual([...cellsOf((set) => brush([7.9, 8.9], [7.9, 8.9], 0.05, set))], ["7 8"]);
});

test("an outline covers the cells whose middle it encloses, holes left out", () => {
  const next = numbers(11);
  const draw = () => next.next().value;
  for (let round = 0; round < 20; round += 1) {
    const star = (cx, cy, r) => Array.from({ length: 9 }, (_, k) => {
      const [angle, at] = [(k / 9) * 2 * Math.PI, r * (0.4 + draw())];
      return [cx + at * Math.cos(angle), cy + at * Math.sin(angle)];
    });
    const rings = [star(20, 15, 12), star(20, 15, 3)];
    const cells = cellsOf((set) => polygon(rings, set));
    for (const [x, y] of allCells()) assert.equal(cells.has(`${x} ${y}`), isInside(rings, [x + 0.5, y + 0.5]), `${x}, ${y}`);
  }
});

test("a fill covers what is joined by sides, and nothing outside of the map", () => {
  const rows = ["....#...", ".##.#.#.", ".#...#..", "########", "........"];
  const cells = cellsOf((set) => flood([0.5, 0.5], [8, 5], (x, y) => rows[y][x] === ".", set));
  assert.deepEqual([...cells].sort(), ["0 0", "0 1", "0 2", "1 0", "2 0", "2 2", "3 0", "3 1", "3 2", "4 2"]);
  assert.equal(cellsOf((set) => flood([-1, 0], [8, 5], () => true, set)).size, 0);
});

test("undo and redo go through every step of cells and classes, to the cell", () => {
  const next = numbers(5);
  const draw = () => next.next().value;
  const painting = blank();
  const states = [];
  const remember = () => states.push([painting.values.slice(), painting.classes]);
  remember();
  for (let n = 0; n < 60; n += 1) {
    const act = n % 10;
    if (act === 3) painting.addClass();
    else if (act === 6) painting.changeClass(painting.classes[0].value, { name: `name ${n}` });
    else if (act === 9) painting.removeClass(painting.classes.at(-1).value);
    else {
      painting.begin();
      const value = painting.classes[Math.floor(draw() * painting.classes.length)].value;
      brush([draw() * WIDTH, draw() * HEIGHT], [draw() * WIDTH, draw() * HEIGHT], 2, (x, y) => {
        if (x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT) painting.values[y * WIDTH + x] = value;
      });
      if (!painting.end()) continue;
    }
    remember();
  }
  assert.ok(states.length > 50);
  const isState = (k) => assert.deepEqual([painting.values, painting.classes], states[k]);
  for (let k = states.length - 1; k > 0; k -= 1) {
    isState(k);
    painting.undo();
  }
  isState(0);
  assert.equal(painting.canUndo, false);
  for (let k = 1; k < states.length; k += 1) {
    painting.redo();
    isState(k);
  }
  const again = new Painting(structuredClone(painting.toKeep()));
  again.undo();
  assert.deepEqual([again.values, again.classes], states.at(-2));
});

test("a stroke that changes nothing, or is dropped, is no step", () => {
  const painting = blank();
  painting.begin();
  assert.equal(painting.end(), false);
  painting.begin();
  painting.values[3] = 2;
  painting.drop();
  assert.deepEqual([painting.values[3], painting.canUndo], [0, false]);
  assert.deepEqual([...runsBetween(Uint8Array.of(0, 0, 1, 1), Uint8Array.of(2, 2, 2, 1))], [0, 2, 0, 2, 2, 1, 1, 2]);
});

test("every class has a name, a color and a value of its own, and there are at most eight", () => {
  const painting = blank();
  painting.removeClass(2);
  assert.equal(painting.addClass().value, 2);
  while (painting.addClass());
  for (const key of ["value", "name", "color"]) assert.equal(new Set(painting.classes.map((info) => String(info[key]))).size, MAX_CLASSES);
});

test("paintings are learned from together by the names of their classes", () => {
  const [one, two] = [blank(), blank()];
  two.removeClass(1);
  two.changeClass(2, { name: "lab" });
  two.values.set([2, 3, 0], 0);
  one.values.set([1, 2, 3], 0);
  const classes = joinedClasses([one, two]);
  assert.deepEqual(classes.map(({ name }) => name), ["hall", "office", "door", "lab"]);
  assert.deepEqual([...one.numbered(classes).slice(0, 3)], [1, 2, 3]);
  assert.deepEqual([...two.numbered(classes).slice(0, 3)], [4, 3, 0]);
});

test("what is painted has the letters of its classes at every zoom, none on another, and they move with the map", () => {
  const [width, height] = [600, 400];
  const values = new Uint8Array(width * height);
  const paint = (value, x0, y0, x1, y1) => { for (let y = y0; y < y1; y += 1) values.fill(value, y * width + x0, y * width + x1); };
  paint(1, 10, 10, 300, 200);
  paint(2, 310, 10, 590, 390);
  paint(3, 300, 80, 310, 110);
  paint(4, 100, 300, 101, 302);
  const whole = [0, 0, width, height];
  for (const scale of [0.3, 1, 1.7, 6]) {
    const spots = letterSpots({ values, width, height }, scale, whole);
    for (const [k, { value, at }] of spots.entries()) {
      assert.equal(values[Math.floor(at[1]) * width + Math.floor(at[0])], value);
      for (const other of spots.slice(k + 1)) assert.ok(Math.hypot(at[0] - other.at[0], at[1] - other.at[1]) * scale >= 17);
    }
    const seen = new Set(spots.map(({ value }) => value));
    // The doorway has a letter where there is room for one, the speck at no zoom of these.
    assert.deepEqual([1, 2, 3, 4].map((value) => seen.has(value)), [true, true, scale >= 1, false], `${scale}`);
    const inside = ({ at }) => at[0] > 200 && at[1] > 120 && at[0] < 400 && at[1] < 280;
    const moved = letterSpots({ values, width, height }, scale, [100, 20, 500, 380]).filter(inside);
    const key = ({ value, at }) => `${value} ${at}`;
    assert.deepEqual(new Set(moved.map(key)), new Set(spots.filter(inside).map(key)), `${scale}`);
  }
});
