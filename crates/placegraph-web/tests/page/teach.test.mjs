// Painting and training on the page: PLACEGRAPH_PAGE=page.html PLACEGRAPH_PROGRAM=placegraph node --test
import assert from "node:assert/strict";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { assertSame, bothResults, cross, downloaded, folder, middleOfMap, officeFolder, onPages, openOffice, places, program, settled, unzipped } from "./browser.mjs";

const TRAINING_MS = 600_000;

const onAnyPage = onPages();
const onPage = (name, act) => onAnyPage(name, {}, async (page) => {
  await openOffice(page);
  await page.click("#tab-teach");
  await act(page);
});

/** What is painted: cells of every class by its name, and how many steps can be undone. */
async function painted(page) {
  await page.waitForFunction(() => globalThis.placegraph.teach.painting);
  return page.evaluate(() => {
    const { painting } = globalThis.placegraph.teach;
    const counts = painting.counts();
    return { cells: Object.fromEntries(painting.classes.map(({ name, value }) => [name, counts[value]])), steps: painting.index };
  });
}

async function rename(page, value, name) {
  await page.fill(`#name-${value}`, name);
  await page.press(`#name-${value}`, "Tab");
}

/** Moves the pointer along points of the screen with the button down. */
async function drag(page, points) {
  await page.mouse.move(...points[0]);
  await page.mouse.down();
  for (const at of points.slice(1)) await page.mouse.move(...at, { steps: 4 });
  await page.mouse.up();
}

/** Corners of a place's box on the screen, grown by some cells, once the map has the room that a new hint left it. */
const boxOnScreen = (page, id, grown = 0) => page.evaluate(async ([wanted, margin]) => {
  for (let n = 0; n < 3; n += 1) await new Promise(requestAnimationFrame);
  const { viewer } = globalThis.placegraph;
  const [x0, y0, x1, y1] = viewer.data.byId.get(wanted).box;
  const canvas = viewer.canvas.getBoundingClientRect();
  const onScreen = (at) => { const [x, y] = viewer.camera.toScreen(at); return [canvas.x + x, canvas.y + y]; };
  return [[x0 - margin, y0 - margin], [x1 + margin, y0 - margin], [x1 + margin, y1 + margin], [x0 - margin, y1 + margin]].map(onScreen);
}, [id, grown]);

async function train(page) {
  await page.click("#train");
  await page.waitForFunction(() => document.getElementById("model-card") || document.getElementById("teach-note")?.textContent, null, { timeout: TRAINING_MS });
  assert.equal(await page.textContent("#teach-note"), "");
  await page.waitForSelector("#busy", { state: "hidden" });
}

/** Writes files of an archive below `path`. */
function unpack(files, path) {
  for (const [name, bytes] of files) {
    mkdirSync(dirname(join(path, name)), { recursive: true });
    writeFileSync(join(path, name), bytes);
  }
}

onPage("classes painted by mouse and by keyboard are learned, as the program learns them, to the same bytes", async (page) => {
  await page.click("#start-empty");
  await rename(page, 1, "hall");
  await rename(page, 2, "office");
  const all = await places(page);
  const bySize = (kind) => all.filter((place) => place.class === kind).sort((a, b) => b.area_m2 - a.area_m2);
  // The hall by its outline, corner by corner, then the offices with the brush, wall to wall.
  await page.check("#paint-1");
  await page.click("#tools button[data-tool=polygon]");
  const corners = await boxOnScreen(page, bySize("corridor")[0].id, 3);
  for (const corner of [...corners, corners[0]]) await page.mouse.click(...corner);
  assert.ok((await painted(page)).cells.hall > 1000, JSON.stringify(await painted(page)));
  await page.check("#paint-2");
  await page.click("#tools button[data-tool=brush]");
  for (const room of bySize("room").slice(0, 8)) {
    const [a, , c] = await boxOnScreen(page, room.id, -8);
    const y = (a[1] + c[1]) / 2;
    await drag(page, [[a[0], y], [c[0], y]]);
  }
  // A doorway each with the keyboard alone.
  await page.focus("#map");
  await page.keyboard.press("3");
  for (let k = 0; k < 3; k += 1) await page.keyboard.press("[");
  await page.focus("#map");
  let at = await middleOfMap(page);
  for (const { jambs } of bySize("doorway").slice(0, 8)) {
    at = await cross(page, at, jambs[0]);
    await page.keyboard.press("Enter");
    at = await cross(page, at, jambs[1]);
    await page.keyboard.press("Enter");
  }
  const { cells, steps } = await painted(page);
  assert.ok(cells.office > 1000 && cells.doorway > 50, JSON.stringify(cells));

  await page.keyboard.press("Control+z");
  const undone = await painted(page);
  assert.equal(undone.steps, steps - 1);
  assert.ok(undone.cells.doorway < cells.doorway);
  await page.keyboard.press("Control+Shift+z");
  assert.deepEqual(await painted(page), { cells, steps });

  await page.waitForFunction(() => !globalThis.placegraph.teach.isKeeping);
  await page.reload();
  assert.equal(await settled(page), "shown");
  await page.click("#tab-teach");
  assert.deepEqual(await painted(page), { cells, steps }, "after a reload");
  assert.equal(await page.isEnabled("#undo"), true);

  const start = Date.now();
  await train(page);
  console.log(`trained in ${((Date.now() - start) / 1000).toFixed(0)} s`);
  assert.match(await page.textContent("#held-out"), /held out in turn it was right for \d+\.\d % of the cells/);
  assert.deepEqual([...new Set((await places(page)).map((place) => place.class))].sort(), ["doorway", "hall", "office"]);

  // As one archive, with the commands that the page names.
  const path = folder();
  const { name, bytes } = await downloaded(page, () => page.click("#save-training-zip"));
  assert.equal(name, "map.training.zip");
  const files = unzipped(bytes, path);
  assert.deepEqual([...files.keys()], ["training.toml", "map/labels.png", "map/map.yaml", "map/map.png", "map.model.json"]);
  unpack(files, path);
  const [command] = (await page.textContent("#model-card pre")).split("\n");
  const model = files.get("map.model.json");
  const options = command.split(" ").slice(3, -1);
  program(["train", "training.toml", ...options, "again.json"], path);
  assert.ok(model.equals(readFileSync(join(path, "again.json"))), "the program trains another model");

  // As two files beside the map.
  const beside = officeFolder();
  const labels = page.waitForEvent("download", { predicate: (found) => found.suggestedFilename() === "labels.png" });
  const training = await downloaded(page, () => page.click("#save-training"));
  writeFileSync(join(beside, "labels.png"), readFileSync(await (await labels).path()));
  writeFileSync(join(beside, training.name), training.bytes);
  program(["train", "training.toml", ...options, "map.model.json"], beside);
  assert.ok(model.equals(readFileSync(join(beside, "map.model.json"))), "the files beside the map train another model");

  // The saved model labels the map to what the page shows.
  const saved = await downloaded(page, () => page.click("#save-model"));
  assert.ok(saved.name === "map.model.json" && saved.bytes.equals(model));
  assertSame(await bothResults(page, ["nav2", "geojson"], beside, ["--model", "map.model.json"]));

  // The model survives a reload, and the library's own comes back.
  await page.reload();
  assert.equal(await settled(page), "shown");
  assert.match(await page.textContent("#what"), /labeled by map\.model\.json/);
  await page.click("#tab-teach");
  await page.click("#default-model");
  await page.waitForSelector("#busy", { state: "hidden" });
  assert.ok((await places(page)).some((place) => place.class === "room"));
});

onPage("what the model says is painted, put right with the fill, and compared", async (page) => {
  await page.click("#start-model");
  const { cells } = await painted(page);
  assert.ok(cells.room > 10_000 && cells.corridor > 1000 && cells.doorway > 100, JSON.stringify(cells));
  const room = (await places(page)).filter((place) => place.class === "room").sort((a, b) => b.area_m2 - a.area_m2)[0];
  await page.click("#add-class");
  await rename(page, 4, "lab");
  await page.check("#paint-4");
  await page.click("#tools button[data-tool=fill]");
  await page.mouse.click(...room.at);
  const { cells: filled } = await painted(page);
  assert.ok(filled.lab > 500 && filled.lab + filled.room === cells.room, JSON.stringify(filled));
  await page.check("#view-differences");
  await page.check("#view-result");
  assert.equal(await page.evaluate(() => globalThis.placegraph.viewer.labels), null);
  await page.click("#remove-4");
  assert.equal((await painted(page)).cells.lab, undefined);
  await page.click("#undo");
  assert.equal((await painted(page)).cells.lab, filled.lab);
});

onPage("commands paint places and rectangles, and words say what is wrong", async (page) => {
  await page.click("#start-empty");
  await page.click("#paint-commands summary");
  await page.selectOption("#paint-place", { index: 0 });
  await page.click("#paint-place-go");
  const { cells } = await painted(page);
  assert.ok(cells.corridor > 200, JSON.stringify(cells));
  await page.check("#paint-2");
  const fields = await page.$$("#paint-box input");
  for (const [k, value] of [-14, 1, -12, 3].entries()) await fields[k].fill(String(value));
  await page.click("#paint-box-go");
  assert.ok((await painted(page)).cells.room > 200);
  await rename(page, 2, "corridor");
  assert.match(await page.textContent("#teach-note"), /a class called corridor already/);
  await rename(page, 2, "<img src=x onerror=alert(1)>");
  await page.click("#train");
  await page.waitForFunction(() => document.getElementById("teach-note")?.textContent);
  assert.match(await page.textContent("#teach-note"), /Nothing was learned: .*none of "doorway"/);
  await page.fill("#color-3", "#000000");
  assert.match(await page.textContent("#teach-note"), /choose another color/);
  assert.equal(await page.inputValue("#color-3"), "#ce4454");
});

onPage("training can be cancelled, and what is painted stays", async (page) => {
  await page.click("#start-model");
  await page.selectOption("#effort", "3000");
  const before = await painted(page);
  await page.click("#train");
  await page.waitForFunction(() => document.getElementById("stage").textContent !== "");
  assert.match(await page.textContent("#stage"), /^[A-Z][a-z]+ .*[a-z]$/, "the stage in words");
  await page.click("#cancel");
  await page.waitForSelector("#busy", { state: "hidden", timeout: 2000 });
  assert.deepEqual(await painted(page), before);
  await page.check("#view-differences");
  await page.click("#tab-take");
  await downloaded(page, () => page.click("#save-zip"));
});
