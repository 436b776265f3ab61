// The page in a browser: PLACEGRAPH_PAGE=page.html PLACEGRAPH_PROGRAM=placegraph node --test
import test from "node:test";
import assert from "node:assert/strict";
import { statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { gzipSync, deflateSync, crc32 as crcOf } from "node:zlib";
import { assertSame, bothResults, chosen, clickPlace, drop, file, folder, officeFiles, officeFolder, onPages, openOffice, PAGE, places, program, read, settled, waitForEdits } from "./browser.mjs";

const MAX_PAGE_BYTES = 2_000_000;

const onPage = onPages();

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

onPage("the program writes pages that open with a result, and with a map", {}, async (page) => {
  const path = officeFolder();
  program(["map", "map.yaml", "--out", "out"], path);
  program(["page", "-o", "result.html", "--result", "out"], path);
  await page.goto(pathToFileURL(join(path, "result.html")).href);
  await settled(page);
  const named = async () => (await places(page)).map(({ name }) => name);
  const names = await named();
  assert.ok(names.length > 10);
  assert.match(await page.textContent("#panel-edits"), /Open its map to mend it/);
  program(["page", "-o", "map.html", "--map", "map.yaml"], path);
  await page.goto(pathToFileURL(join(path, "map.html")).href);
  assert.equal(await settled(page), "shown");
  assert.deepEqual(await named(), names);
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
