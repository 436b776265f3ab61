// The page's logic without a browser: node --test
import test from "node:test";
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Camera, scaleBar } from "../../../placegraph/assets/viewer/camera.js";
import { MapData, isInside, lettersOf } from "../../../placegraph/assets/viewer/mapdata.js";
import { placeNames } from "../../../placegraph/assets/viewer/placement.js";
import { inWords, isOnMap, lineEdit, merge, rename } from "../../page/acts.js";
import { Cancelled, Engine } from "../../page/engine.js";
import { bytesOfText, sizeOf, sorted } from "../../page/files.js";
import { History } from "../../page/history.js";
import { unpacked } from "../../page/lzma.js";
import { snapped } from "../../page/linetool.js";
import { crc32, zipParts } from "../../page/zip.js";
import { numbers } from "./numbers.mjs";

const near = (a, b) => assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) < 1e-9, `${a} is not ${b}`);

test("the cell under the pointer stays there while zooming", () => {
  const camera = new Camera(3, 4, 2);
  const before = camera.toCells([70, 20]);
  camera.zoom(1.7, [70, 20]);
  near(camera.toCells([70, 20]), before);
  near(camera.toCells(camera.toScreen([5, 6])), [5, 6]);
  camera.pan(10, -4);
  near(camera.toCells([80, 16]), before);
});

test("a box that is fitted lies in the middle and inside", () => {
  const camera = new Camera();
  camera.fit([10, 20, 110, 70], 500, 400, 20);
  near(camera.toScreen([60, 45]), [250, 200]);
  const [left, top] = camera.toScreen([10, 20]);
  assert.ok(left >= 20 - 1e-9 && top >= 20);
});

test("scale bars are round and fit", () => {
  for (const pxPerMeter of [0.03, 1, 7, 20, 333]) {
    const { meters, px } = scaleBar(pxPerMeter);
    assert.ok(px <= 140.001 && px > 50, `${meters} m, ${px} px`);
    assert.match(String(meters), /^(0\.)?0*[125]0*$/);
  }
});

const place = (id, x0, y0, x1, y1, extra = {}) => ({
  id, name: `room ${id}`, class: "room", probability: 1, area_m2: (x1 - x0) * (y1 - y0), clearance_m: 1, x: 0, y: 0,
  at: [(x0 + x1) / 2, (y0 + y1) / 2], rings: [[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]], width_m: null, jambs: null, sides: null, ...extra,
});

function building() {
  const ring = place(1, 0, 0, 30, 30);
  ring.rings.push([[10, 10], [20, 10], [20, 20], [10, 20]]);
  return new MapData({
    width: 40, height: 30, resolution_m: 0.1, origin: { x: 2, y: -1, yaw_rad: 0.7 }, frame: "map", findings: [],
    classes: [{ name: "corridor", color: [1, 2, 3] }, { name: "room", color: [4, 5, 6] }, { name: "café", color: [7, 8, 9] }],
    places: [ring, place(2, 12, 12, 18, 18), place(3, 30, 0, 32, 30, { width_m: 0.9, sides: [1, 4], jambs: [[30, 0], [30, 9]] }), place(4, 32, 0, 40, 30)],
    connections: [{ a: 1, b: 3, line: [] }, { a: 3, b: 4, line: [] }],
  });
}

test("meters and cells are each other's inverse in a turned frame", () => {
  const data = building();
  near(data.toMeters([0, 30]), [2, -1]);
  near(data.toMeters([10, 30]), [2 + Math.cos(0.7), -1 + Math.sin(0.7)]);
  for (const at of [[0, 0], [13.25, 7], [40, 30]]) near(data.toCells(data.toMeters(at)), at);
});

test("places are found in holes of others, and nothing where there is none", () => {
  const data = building();
  assert.equal(data.placeAt([5, 5]).id, 1);
  assert.equal(data.placeAt([15, 15]).id, 2);
  assert.equal(data.placeAt([11, 11]), undefined);
  assert.equal(data.placeAt([-1, 5]), undefined);
  assert.deepEqual(data.neighbors(3).map(({ id }) => id), [1, 4]);
  assert.match(data.figures(data.byId.get(3)).join(), /0\.90 m wide, joins room 1 and room 4/);
});

test("being inside agrees with counting, over random stars", () => {
  const next = numbers(7);
  const draw = () => next.next().value;
  for (let round = 0; round < 40; round += 1) {
    const ring = Array.from({ length: 12 }, (_, k) => {
      const [angle, r] = [(k / 12) * 2 * Math.PI, 2 + 8 * draw()];
      return [r * Math.cos(angle), r * Math.sin(angle)];
    });
    for (let n = 0; n < 50; n += 1) {
      const at = [20 * draw() - 10, 20 * draw() - 10];
      let angle = 0;
      ring.forEach(([ax, ay], k) => {
        const [bx, by] = ring[(k + 1) % 12];
        const [p, q] = [[ax - at[0], ay - at[1]], [bx - at[0], by - at[1]]];
        angle += Math.atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
      });
      assert.equal(isInside([ring], at), Math.abs(angle) > 3);
    }
  }
});

test("every class has a letter of its own", () => {
  assert.deepEqual(lettersOf(["corridor", "room", "café", "crypt", "🚪"]), ["C", "R", "A", "Y", "B"]);
  assert.equal(new Set(lettersOf(["a", "a!", "A", "aa"])).size, 4);
});

test("names never overlap and the first ones win", () => {
  const next = numbers(3);
  const draw = () => next.next().value;
  const items = Array.from({ length: 400 }, (_, id) => ({ id, at: [draw() * 900, draw() * 600], width: 20 + draw() * 90, height: 13 }));
  const placed = placeNames(items, [900, 600]);
  assert.equal(placed[0].id, 0);
  assert.ok(placed.length > 50);
  for (const [i, a] of placed.entries()) {
    for (const b of placed.slice(i + 1)) {
      const apart = a.left + a.width <= b.left || b.left + b.width <= a.left || a.top + a.height <= b.top || b.top + b.height <= a.top;
      assert.ok(apart, `${a.id} and ${b.id}`);
    }
  }
});

test("undo and redo have no limit, and a new edit forgets what was undone", () => {
  const history = new History();
  for (let n = 0; n < 500; n += 1) history.add({ action: "rename", at: [n, 0], name: String(n) });
  for (let n = 0; n < 500; n += 1) history.undo();
  assert.deepEqual(history.edits, []);
  history.undo();
  history.redo();
  assert.equal(history.edits.length, 1);
  history.add({ action: "exclude", at: [0, 0] });
  assert.equal(history.canRedo, false);
  const again = History.from(JSON.parse(JSON.stringify(history)));
  assert.deepEqual(again.edits, history.edits);
  again.undo();
  again.undo();
  assert.equal(again.canUndo, false);
});

test("what was not saved by the page is not restored", () => {
  for (const bad of [null, 3, {}, { states: [] }, { states: [[1]], index: 0 }, { states: [[]], index: 4 }, { states: [[{ action: 2 }]], index: 0 }]) {
    assert.equal(History.from(bad), null);
  }
});

test("edits are entries of the edit file, to the millimeter", () => {
  const at = { x: 1.23456, y: -0.00001 };
  assert.deepEqual(rename(at, "kitchen"), { action: "rename", at: [1.235, 0], name: "kitchen" });
  assert.deepEqual(merge([at, at]).at.length, 2);
  assert.deepEqual(lineEdit("split", [[0, 0.1234], [1, 2]]), { action: "split", line: [[0, 0.123], [1, 2]] });
  assert.deepEqual(lineEdit("move_doorway", [[0, 0], [1, 2]], at).at, [1.235, 0]);
  assert.ok(isOnMap({ action: "close" }) && !isOnMap({ action: "split" }));
  for (const edit of [rename(at, "x"), merge([at, at]), lineEdit("open", [[0, 0], [1, 2]])]) assert.ok(inWords(edit).length > 10);
});

test("a drawn end snaps to a jamb, else to what is not free, else stays", () => {
  const isFree = (x, y) => !(x === 9 && y === 4);
  assert.deepEqual(snapped([5.2, 5.1], [[5, 5]], isFree, 3), [5, 5]);
  assert.deepEqual(snapped([8.2, 4.6], [[0, 0]], isFree, 3), [9.5, 4.5]);
  assert.deepEqual(snapped([2, 2], [], isFree, 1), [2, 2]);
});

test("what was dropped is told apart", () => {
  const names = (...list) => sorted(list.map((name) => ({ name })));
  const main = (...list) => names(...list).main?.name;
  assert.equal(main("map.png", "map.yaml"), "map.yaml");
  assert.equal(main("map.PGM"), "map.PGM");
  assert.equal(names("map.pgm").isImageAlone, true);
  assert.equal(names("map.pgm", "map.yml").isImageAlone, false);
  assert.equal(main("fr79.map.gz"), "fr79.map.gz");
  assert.equal(names("edits.toml").main, undefined);
  assert.equal(names("edits.toml", "map.yaml", "map.pgm").edits.name, "edits.toml");
  assert.match(names("a.yaml", "b.yaml").error, /two maps/);
  assert.match(names("a.png", "b.png").error, /2 images/);
  assert.match(names().error, /no file/);
});

test("sizes come from headers", () => {
  const bytes = (text) => new TextEncoder().encode(text).buffer;
  assert.deepEqual(sizeOf(bytes("P5\n# made\n30 20\n255\n")), [30, 20]);
  const png = new DataView(new ArrayBuffer(24));
  png.setUint32(0, 0x89504e47);
  png.setUint32(16, 7);
  png.setUint32(20, 9);
  assert.deepEqual(sizeOf(png.buffer), [7, 9]);
  assert.equal(sizeOf(bytes("hello")), null);
});

class FakeWorker {
  sent = [];
  postMessage(message) { this.sent.push(message); }
  terminate() { this.isDead = true; }
}

test("answers find their questions, and errors too", async () => {
  const worker = new FakeWorker();
  const told = [];
  const engine = new Engine(() => worker, (...progress) => told.push(progress));
  const [a, b] = [engine.call({ op: "a" }), engine.call({ op: "b" })];
  worker.onmessage({ data: { progress: ["smooth", 1, 2] } });
  worker.onmessage({ data: { id: 2, answer: { n: 2 }, bytes: [] } });
  worker.onmessage({ data: { id: 1, error: { message: "no" } } });
  assert.equal((await b).n, 2);
  await assert.rejects(a, /no/);
  assert.deepEqual(told, [["smooth", 1, 2]]);
});

test("a cancelled engine starts anew", async () => {
  const workers = [];
  const engine = new Engine(() => { workers.push(new FakeWorker()); return workers.at(-1); });
  const waiting = engine.call({ op: "long" });
  engine.cancel();
  await assert.rejects(waiting, Cancelled);
  assert.ok(workers[0].isDead);
  const next = engine.call({ op: "next" });
  assert.equal(workers.length, 2);
  workers[1].onmessage({ data: { id: 2, fatal: "out of memory" } });
  await assert.rejects(next, /out of memory/);
  assert.ok(workers[1].isDead);
});

test("another program unpacks the archive", async () => {
  assert.equal(crc32(new TextEncoder().encode("123456789")), 0xcbf43926);
  const files = [
    { name: "topology.json", bytes: new TextEncoder().encode("{}".repeat(5000)) },
    { name: "größe.txt", bytes: new Uint8Array() },
    { name: "labels.png", bytes: Uint8Array.from({ length: 3000 }, (_, i) => (i * 31) % 251) },
  ];
  const path = join(mkdtempSync(join(tmpdir(), "zip-")), "a.zip");
  const parts = await zipParts(files);
  writeFileSync(path, Buffer.concat(parts));
  assert.deepEqual(Buffer.concat(await zipParts(files)), Buffer.concat(parts));
  const script = "import json, sys, zipfile; z = zipfile.ZipFile(sys.argv[1]); assert z.testzip() is None; print(json.dumps({n: list(z.read(n)) for n in z.namelist()}))";
  const read = JSON.parse(execFileSync("python3", ["-c", script, path], { encoding: "utf8" }));
  for (const { name, bytes } of files) assert.deepEqual(read[name], [...bytes]);
});

test("text of seven bits a character is the bytes that it was made of", () => {
  /** As the program writes it. */
  const written = (bytes) => {
    const bits = bytes.map((byte) => byte.toString(2).padStart(8, "0")).join("");
    const sevens = (bits.match(/.{1,7}/g) ?? []).map((seven) => Number.parseInt(seven.padEnd(7, "0"), 2));
    let text = "";
    for (let k = 0; k < sevens.length; k += 1) {
      const which = [0, 13, 0x3c].indexOf(sevens[k]);
      if (which < 0) text += String.fromCharCode(sevens[k]);
      else if (k + 1 === sevens.length) text += String.fromCharCode(0x80 + sevens[k]);
      else text += String.fromCharCode(0x100 + 0x80 * which + sevens[(k += 1)]);
    }
    return text;
  };
  assert.equal(written([0x81, 0x80]), "@`\u0080");
  assert.equal(written([0x00, 0x35, 0xe5, 0xc0]), "\u010d\u025c\u0080");
  const next = numbers(2);
  for (let length = 0; length < 90; length += 1) {
    const bytes = Array.from({ length }, () => Math.floor(next.next().value * 256));
    for (const of of [bytes, bytes.fill(0, length - 3), bytes.fill(255)]) assert.deepEqual([...bytesOfText(written(of))], of);
  }
});

test("what another program packed is unpacked, and what is damaged ends", () => {
  const packed = (data, preset) => new Uint8Array(execFileSync("python3", ["-c",
    "import lzma, sys; sys.stdout.buffer.write(lzma.compress(sys.stdin.buffer.read(), lzma.FORMAT_ALONE, preset=int(sys.argv[1])))", preset],
  { input: data, maxBuffer: 1 << 26 }));
  const next = numbers(9);
  const noise = Buffer.from(Array.from({ length: 30_000 }, (_, k) => (next.next().value * 256) >> (k % 7)));
  for (const data of [Buffer.alloc(0), Buffer.from("a"), Buffer.from("hello ".repeat(20_000)), noise, Buffer.concat([noise, Buffer.alloc(9000), noise])]) {
    for (const preset of ["0", "6", "9"]) assert.ok(Buffer.from(unpacked(packed(data, preset))).equals(data), `${data.length} bytes, ${preset}`);
  }
  const whole = packed(noise, "6");
  for (let end = 0; end < whole.length - 8; end += 997) assert.throws(() => unpacked(whole.subarray(0, end)), /cut off|damaged/);
});
