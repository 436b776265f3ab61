// The page in a browser: PLACEGRAPH_PAGE=page.html PLACEGRAPH_PROGRAM=placegraph node --test
import test, { after, before } from "node:test";
import assert from "node:assert/strict";
import { statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync, deflateSync, crc32 as crcOf } from "node:zlib";
import { assertSame, bothResults, drop, editsOf, file, folder, launch, officeFiles, openOffice, openPage, PAGE, places, read, settled, waitForEdits } from "./browser.mjs";

let browser;
before(async () => { browser = await launch(); });
after(() => browser?.close());

const onPage = (name, options, act) => test(name, async () => {
  const page = await openPage(browser, options);
  try {
    await act(page);
    assert.deepEqual(page.errors, []);
  } finally {
    await page.context().close();
  }
});

const MAX_PAGE_BYTES = 2_000_000;

test("the page is smaller than 2 MB", () => {
  const { size } = statSync(fileURLToPath(PAGE));
  assert.ok(size < MAX_PAGE_BYTES, `${size} bytes`);
});

onPage("a dropped map is shown, and the result is the program's, byte for byte", {}, async (page) => {
  await drop(page, officeFiles());
  assert.equal(await settled(page), "shown");
  assert.ok((await places(page)).length > 10);
  assertSame(await bothResults(page));
});

onPage("every export is the program's, byte for byte", {}, async (page) => {
  await openOffice(page);
  await page.click("#tab-take");
  const formats = await page.$$eval("#panel-take input[type=checkbox]", (boxes) => boxes.map((box) => box.value));
  assert.ok(formats.length >= 13, formats.join());
  assertSame(await bothResults(page, formats));
});

const chosen = (page, kind) => places(page).then((all) => all.filter((place) => place.class === kind).sort((a, b) => b.area_m2 - a.area_m2)[0]);

/** Chooses a place with the mouse. */
async function clickPlace(page, place) {
  await page.click("#tools button[data-tool='']");
  await page.mouse.click(...place.at);
  await page.waitForFunction((id) => globalThis.placegraph.viewer.selected === id, place.id);
}

async function dragLine(page, tool, from, to) {
  await page.click(`#tools button[data-tool="${tool}"]`);
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move((from[0] + to[0]) / 2, (from[1] + to[1]) / 2);
  await page.mouse.move(...to);
  await page.mouse.up();
  await page.click("#tools button[data-tool='']");
}

/** Draws the first of the lines that does something, as the page says: rooms have many forms. */
async function drawOne(page, tool, lines) {
  const n = (await editsOf(page)).length;
  for (const line of lines) {
    await dragLine(page, tool, ...line);
    await waitForEdits(page, n + 1);
    if (await page.evaluate(() => !globalThis.placegraph.state.outcomes.at(-1)?.error)) return;
    await page.focus("#map");
    await page.keyboard.press("Control+z");
    await waitForEdits(page, n);
  }
  assert.fail(`no line was right for ${tool}`);
}

/** Lines across the middles of all rooms, the largest first. */
async function acrossRooms(page) {
  const rooms = (await places(page)).filter((place) => place.class === "room").sort((a, b) => b.area_m2 - a.area_m2);
  return Promise.all(rooms.map((room) => across(page, room.id)));
}

/** A line across the middle of a place, wall to wall, on the screen. */
const across = (page, id) => page.evaluate((wanted) => {
  const { viewer } = globalThis.placegraph;
  const place = viewer.data.byId.get(wanted);
  const box = viewer.canvas.getBoundingClientRect();
  const y = (place.box[1] + place.box[3]) / 2;
  const ends = [[place.box[0] - 1, y], [place.box[2] + 1, y]];
  return ends.map((at) => { const [sx, sy] = viewer.camera.toScreen(at); return [box.x + sx, box.y + sy]; });
}, id);

onPage("every act by mouse is replayed by the program to the same bytes", {}, async (page) => {
  await openOffice(page);
  await clickPlace(page, await chosen(page, "room"));
  await page.fill("#name", "kitchen <b>&\"'");
  await page.click("#rename");
  await waitForEdits(page, 1);
  assert.equal(await page.textContent("#panel-places h2"), "R kitchen <b>&\"'".replace("R ", "R "));
  await page.selectOption("#class", "corridor");
  await waitForEdits(page, 2);
  await page.click("#merge");
  await waitForEdits(page, 3);
  await drawOne(page, "split", await acrossRooms(page));
  await drawOne(page, "add_doorway", await acrossRooms(page));
  let doorway = (await places(page)).find((place) => place.class === "doorway");
  await page.click(`#places button[data-id="${doorway.id}"]`);
  await page.click("#remove-doorway");
  await waitForEdits(page, 6);
  doorway = (await places(page)).find((place) => place.class === "doorway");
  await page.click(`#places button[data-id="${doorway.id}"]`);
  const [a, b] = (await places(page)).find(({ id }) => id === doorway.id).jambs;
  await dragLine(page, "close", a, b);
  await waitForEdits(page, 7);
  // Through the wall that was drawn, as far on both sides as the door is wide.
  const [middle, normal] = [[(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], [(a[1] - b[1]) / 2, (b[0] - a[0]) / 2]];
  const through = (share) => [1, -1].map((side) => [0, 1].map((axis) => middle[axis] + side * share * normal[axis]));
  await drawOne(page, "open", [0.5, 1, 2].map(through));
  const small = (await places(page)).filter((place) => place.class === "room").at(-1);
  await page.click(`#places button[data-id="${small.id}"]`);
  await page.click("#exclude");
  await waitForEdits(page, 9);
  assert.deepEqual((await editsOf(page)).map(({ action }) => action),
    ["rename", "relabel", "merge", "split", "add_doorway", "remove_doorway", "close", "open", "exclude"]);
  const results = await bothResults(page);
  assertSame(results);
  assert.ok(results.page.get("topology.json").includes("kitchen <b>&"));
});

onPage("acts by keyboard alone: find, rename, draw a split, undo, redo", {}, async (page) => {
  await openOffice(page);
  await page.keyboard.press("/");
  await page.keyboard.type("room");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  await page.focus("#name");
  await page.keyboard.press("Control+a");
  await page.keyboard.type("office of Ada");
  await page.keyboard.press("Enter");
  await waitForEdits(page, 1);
  assert.ok((await places(page)).some(({ name }) => name === "office of Ada"));
  await page.focus("#map");
  await page.keyboard.press("s");
  await page.waitForFunction(() => document.activeElement.id === "map");
  for (const key of ["ArrowLeft", "Enter", ...Array(8).fill("ArrowRight"), "Enter"]) await page.keyboard.press(key);
  await waitForEdits(page, 2);
  assert.equal((await editsOf(page))[1].action, "split");
  await page.keyboard.press("Control+z");
  await waitForEdits(page, 1);
  await page.keyboard.press("Control+z");
  await waitForEdits(page, 0);
  assert.ok(!(await places(page)).some(({ name }) => name === "office of Ada"));
  await page.keyboard.press("Control+Shift+z");
  await waitForEdits(page, 1);
  assertSame(await bothResults(page));
});

onPage("lines can be drawn by their coordinates", {}, async (page) => {
  await openOffice(page);
  await page.click("#tab-edits");
  await page.click("summary");
  const fields = await page.$$("#line-form input");
  for (const [i, value] of [-14, 1, -10, 1].entries()) await fields[i].fill(String(value));
  await page.click("#line-add");
  await waitForEdits(page, 1);
  assert.deepEqual(await editsOf(page), [{ action: "split", line: [[-14, 1], [-10, 1]] }]);
  assert.match(await page.textContent("#edits-text"), /action = "split"/);
});

onPage("edits survive a reload, with their past", {}, async (page) => {
  await openOffice(page);
  await clickPlace(page, await chosen(page, "room"));
  await page.fill("#name", "kept");
  await page.click("#rename");
  await waitForEdits(page, 1);
  await page.reload();
  assert.equal(await settled(page), "shown");
  assert.ok((await places(page)).some(({ name }) => name === "kept"));
  await page.click("#undo");
  await waitForEdits(page, 0);
});

onPage("an edit file that is dropped is replayed, and a wrong one is refused in words", {}, async (page) => {
  await openOffice(page);
  const before = (await places(page)).length;
  await page.setInputFiles("#files", [file("edits.toml", "[[edit]]\naction = \"fly\"\n")]);
  await page.waitForSelector("#failed:not([hidden])");
  assert.match(await settled(page), /edits\.toml cannot be read[\s\S]*fly/);
  await page.click("#back");
  await page.setInputFiles("#files", [file("edits.toml", "[[edit]]\naction = \"rename\"\nat = [-999.0, 0.0]\nname = \"x\"\n")]);
  await waitForEdits(page, 1);
  assert.equal((await places(page)).length, before);
  assert.match(await page.textContent("#edits .why"), /Does not apply: .*-999/);
});

onPage("a picture alone asks for its resolution", {}, async (page) => {
  await page.setInputFiles("#files", [file("floor.png", read("maps/office/map.png"))]);
  await page.waitForSelector("#scale-dialog[open]");
  assert.match(await page.textContent("#extent"), /floor\.png would be 16\.4 × 23\.2 m/);
  await page.fill("#resolution", "0.1");
  await page.click("#scale-dialog button[value=ok]");
  assert.equal(await settled(page), "shown");
  assert.match(await page.textContent("#what"), /cells of 0\.1 m/);
});

onPage("a CARMEN map is read, gzipped too", {}, async (page) => {
  await page.setInputFiles("#files", [file("hall.map.gz", gzipSync(carmen(60, 40)))]);
  assert.equal(await settled(page), "shown");
  assert.match(await page.textContent("#what"), /60 × 40 cells of 0\.1 m/);
});

/** A hall of free cells within walls, as CARMEN writes it: columns of probabilities. */
function carmen(width, height) {
  const header = Buffer.alloc(4 + 10 + 8 + 4);
  header.writeInt32LE(10 + 12 + 4 * width * height, 0);
  header.write("GRIDMAP   ", 4, "latin1");
  header.writeInt32LE(width, 14);
  header.writeInt32LE(height, 18);
  header.writeFloatLE(0.1, 22);
  const cells = Buffer.alloc(4 * width * height);
  for (let x = 0; x < width; x += 1) {
    for (let y = 0; y < height; y += 1) {
      cells.writeFloatLE(x < 2 || y < 2 || x > width - 3 || y > height - 3 ? 0.9 : 0.1, 4 * (x * height + y));
    }
  }
  return Buffer.concat([Buffer.from("CARMENMAPFILEv020\x01", "latin1"), header, cells]);
}

const chunk = (type, data) => {
  const body = Buffer.concat([Buffer.from(type), data]);
  const head = Buffer.alloc(4);
  head.writeUInt32BE(data.length);
  const crc = Buffer.alloc(4);
  crc.writeUInt32BE(crcOf ? crcOf(body) : 0);
  return Buffer.concat([head, body, crc]);
};

/** The header of a gray PNG that says how large it is, and bytes that are no picture. */
function pngHeader(width, height, n_bytes) {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(width, 0);
  header.writeUInt32BE(height, 4);
  header.set([8, 0, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", header), chunk("IDAT", deflateSync(Buffer.alloc(64))), Buffer.alloc(n_bytes)]);
}

const HOSTILE = [
  ["what is no map", [file("notes.txt", "hello, this is no map")], /cannot be labeled/],
  ["an empty file", [file("map.pgm", "")], /map\.pgm is empty/],
  ["a map without its image", [file("map.yaml", read("maps/office/map.yaml"))], /map\.png.*give both/s],
  ["a name that is script", [file("<img src=x onerror=alert(1)>.yaml", "image: [")], /cannot be labeled/],
  ["30 000 × 30 000 pixels", [file("big.yaml", read("maps/office/map.yaml")), file("map.png", pngHeader(30_000, 30_000, 0))], /30000/],
  ["40 MB that are no picture", [file("big.yaml", read("maps/office/map.yaml")), file("map.png", pngHeader(1000, 1000, 40 << 20))], /cannot be labeled/],
];
for (const [name, files, expected] of HOSTILE) {
  onPage(`refused in words: ${name}`, {}, async (page) => {
    // A busy machine takes its time to hand 40 MB to the browser.
    await page.setInputFiles("#files", files, { timeout: 120_000 });
    assert.match(await settled(page, 60_000), expected);
    await page.click("#failed button:visible");
  });
}

/** 100 MB of noise, as a picture of 25 million cells. */
function noisePng(path) {
  const [side, channels] = [5000, 4];
  const rows = Buffer.alloc(side * (1 + side * channels));
  let state = 1;
  for (let i = 0; i < rows.length; i += 4) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    rows.writeUInt32LE(state, i);
  }
  for (let row = 0; row < side; row += 1) rows[row * (1 + side * channels)] = 0;
  const header = Buffer.alloc(13);
  header.writeUInt32BE(side, 0);
  header.writeUInt32BE(side, 4);
  header.set([8, 6, 0, 0, 0], 8);
  const packed = deflateSync(rows, { level: 0 });
  writeFileSync(path, Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", header), chunk("IDAT", packed), chunk("IEND", Buffer.alloc(0))]));
  return path;
}

onPage("a picture of 100 MB is refused or labeled, and can be cancelled while it is", {}, async (page) => {
  const path = folder();
  writeFileSync(join(path, "noise.yaml"), read("maps/office/map.yaml").toString().replace(/^image:.*/m, "image: noise.png"));
  const image = noisePng(join(path, "noise.png"));
  assert.ok(statSync(image).size > 100e6);
  await page.setInputFiles("#files", [join(path, "noise.yaml"), image]);
  await page.waitForSelector("#busy:not([hidden])", { timeout: 60_000 });
  // The page stays awake while the library reads.
  const start = Date.now();
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
  assert.ok(Date.now() - start < 5000);
  const isBusy = await page.waitForFunction(() => document.getElementById("stage").textContent !== "" || document.getElementById("busy").hidden, null, { timeout: 120_000 })
    .then(() => page.isVisible("#busy"));
  if (isBusy) await page.click("#cancel");
  else await page.click("#failed button:visible");
  assert.equal(await openOffice(page), "shown");
});

onPage("labeling can be cancelled, and the next map is labeled", {}, async (page) => {
  const side = 1500;
  const pixels = Buffer.alloc(side * side, 254);
  for (let i = 0; i < side; i += 1) for (let wall = 0; wall < side; wall += 100) pixels[i * side + wall] = pixels[wall * side + i] = 0;
  const yaml = read("maps/office/map.yaml").toString().replace(/^image:.*/m, "image: huge.pgm");
  await page.setInputFiles("#files", [file("huge.yaml", yaml), file("huge.pgm", Buffer.concat([Buffer.from(`P5\n${side} ${side}\n255\n`), pixels]))]);
  await page.waitForFunction(() => document.getElementById("stage").textContent !== "");
  const start = Date.now();
  await page.click("#cancel");
  await page.waitForSelector("#empty:not([hidden])", { timeout: 2000 });
  assert.ok(Date.now() - start < 2000);
  assert.equal(await openOffice(page), "shown");
});
