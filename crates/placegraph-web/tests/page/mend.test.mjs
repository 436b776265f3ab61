// Every act of mending, by mouse and by keyboard, replayed by the program.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { assertSame, bothResults, chosen, clickPlace, cross, editsOf, folder, middleOfMap, onPages, openOffice, places, waitForEdits } from "./browser.mjs";

const onPage = onPages();

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
async function drawOne(page, tool, lines, draw = dragLine) {
  const n = (await editsOf(page)).length;
  for (const line of lines) {
    await draw(page, tool, ...line);
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

const jambsOf = async (page, id) => (await places(page)).find((place) => place.id === id).jambs;

const ACTS = ["rename", "relabel", "merge", "split", "add_doorway", "remove_doorway", "move_doorway", "close", "open", "exclude"];

/** Lines across the doorway between `a` and `b`, as far on both sides as it is wide, or less, or more. */
function through(a, b) {
  const [middle, normal] = [[(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], [(a[1] - b[1]) / 2, (b[0] - a[0]) / 2]];
  return [0.5, 1, 2].map((share) => [1, -1].map((side) => [0, 1].map((axis) => middle[axis] + side * share * normal[axis])));
}

/** Lines parallel to that from `a` to `b`, on one side or the other. */
function beside([a, b]) {
  const normal = [(a[1] - b[1]) / 2, (b[0] - a[0]) / 2];
  return [0.5, -0.5, 1, -1, 0.2, -0.2, 0].map((share) => [a, b].map((at) => [0, 1].map((axis) => at[axis] + share * normal[axis])));
}

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
  await drawOne(page, "move_doorway", beside(await jambsOf(page, doorway.id)));
  const [a, b] = await jambsOf(page, doorway.id);
  await dragLine(page, "close", a, b);
  await waitForEdits(page, 8);
  await drawOne(page, "open", through(a, b));
  const small = (await places(page)).filter((place) => place.class === "room").at(-1);
  await page.click(`#places button[data-id="${small.id}"]`);
  await page.click("#exclude");
  await waitForEdits(page, 10);
  assert.deepEqual((await editsOf(page)).map(({ action }) => action), ACTS);
  const results = await bothResults(page);
  assertSame(results);
  assert.ok(results.page.get("topology.json").includes("kitchen <b>&"));
});

/** Presses Tab until the control has the focus, as somebody without a mouse does. */
async function tabTo(page, selector) {
  for (let n = 0; n < 150; n += 1) {
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted), selector)) return;
    await page.keyboard.press("Tab");
  }
  assert.fail(`Tab does not lead to ${selector}`);
}

/** Chooses a place by its name in the list. */
async function findPlace(page, place) {
  await page.keyboard.press("/");
  await page.keyboard.press("Control+a");
  await page.keyboard.type(place.name);
  await tabTo(page, `#places button[data-id="${place.id}"]`);
  await page.keyboard.press("Enter");
  await page.waitForFunction((id) => globalThis.placegraph.viewer.selected === id, place.id);
}

const KEYS = { split: "s", add_doorway: "d", move_doorway: "m", close: "w", open: "o" };

async function lineByKeys(page, tool, from, to) {
  await page.keyboard.press(KEYS[tool]);
  await page.waitForFunction(() => document.activeElement.id === "map");
  const at = await cross(page, await middleOfMap(page), from);
  await page.keyboard.press("Enter");
  await cross(page, at, to);
  await page.keyboard.press("Enter");
  await page.keyboard.press("v");
}

onPage("every act by keyboard alone is replayed by the program to the same bytes, and undone", {}, async (page) => {
  await openOffice(page);
  await findPlace(page, await chosen(page, "room"));
  await tabTo(page, "#name");
  await page.keyboard.press("Control+a");
  await page.keyboard.type("office of Ada");
  await page.keyboard.press("Enter");
  await waitForEdits(page, 1);
  await findPlace(page, (await places(page)).find(({ name }) => name === "office of Ada"));
  await tabTo(page, "#class");
  await page.keyboard.press("c");
  await waitForEdits(page, 2);
  await findPlace(page, (await places(page)).find(({ name }) => name === "office of Ada"));
  await tabTo(page, "#merge");
  await page.keyboard.press("Enter");
  await waitForEdits(page, 3);
  await drawOne(page, "split", await acrossRooms(page), lineByKeys);
  await drawOne(page, "add_doorway", await acrossRooms(page), lineByKeys);
  await findPlace(page, (await places(page)).find((place) => place.class === "doorway"));
  await tabTo(page, "#remove-doorway");
  await page.keyboard.press("Enter");
  await waitForEdits(page, 6);
  const doorway = (await places(page)).find((place) => place.class === "doorway");
  await findPlace(page, doorway);
  await drawOne(page, "move_doorway", beside(await jambsOf(page, doorway.id)), lineByKeys);
  const [a, b] = await jambsOf(page, doorway.id);
  await drawOne(page, "close", [[a, b]], lineByKeys);
  await drawOne(page, "open", through(a, b), lineByKeys);
  await findPlace(page, (await places(page)).filter((place) => place.class === "room").at(-1));
  await tabTo(page, "#exclude");
  await page.keyboard.press("Enter");
  await waitForEdits(page, ACTS.length);
  assert.deepEqual((await editsOf(page)).map(({ action }) => action), ACTS);
  assertSame(await bothResults(page));
  await page.keyboard.press("Escape");
  for (let n = ACTS.length - 1; n >= 0; n -= 1) {
    await page.keyboard.press("Control+z");
    await waitForEdits(page, n);
  }
  assert.ok(!(await places(page)).some(({ name }) => name === "office of Ada"));
  for (let n = 1; n <= ACTS.length; n += 1) {
    await page.keyboard.press("Control+Shift+z");
    await waitForEdits(page, n);
  }
  assert.deepEqual((await editsOf(page)).map(({ action }) => action), ACTS);
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

onPage("a line that moves no doorway is refused in words", {}, async (page) => {
  await openOffice(page);
  await page.click("#tab-edits");
  await page.click("summary");
  await page.selectOption("#line-kind", "move_doorway");
  for (const field of await page.$$("#line-form input")) await field.fill("1");
  await page.click("#line-add");
  assert.match(await page.textContent("#line-why"), /Choose the doorway/);
  assert.deepEqual(await editsOf(page), []);
});

// Without the slash that no name may have; a comment that opens a script is what ends one early.
const SCRIPT = "<!--<script>alert(1)<img src=x onerror=alert(2)>";

onPage("a name that is script runs nowhere: in the page, after a reload, in the report", {}, async (page) => {
  await openOffice(page);
  await clickPlace(page, await chosen(page, "room"));
  await page.fill("#name", SCRIPT);
  await page.click("#rename");
  await waitForEdits(page, 1);
  const isShown = (selector) => page.waitForFunction(([where, name]) => document.querySelector(where)?.textContent.includes(name), [selector, SCRIPT]);
  await isShown("#places");
  await page.click("#tab-edits");
  await isShown("#edits");
  await page.hover("#map");
  await page.reload();
  await isShown("#places");
  const { program } = await bothResults(page, ["report"]);
  const report = [...program.keys()].find((name) => name.endsWith(".html"));
  const path = join(folder(), report);
  writeFileSync(path, program.get(report));
  // Whatever runs shows a dialog, and a picture without a file is an error on the console: both are in the page's errors.
  await page.goto(pathToFileURL(path).href);
  await isShown("#places");
});
