// A browser with the page, and what the tests do in it.
import { execFileSync } from "node:child_process";
import test, { after, before } from "node:test";
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

export const ROOT = new URL("../../../../", import.meta.url);
export const PAGE = pathToFileURL(process.env.PLACEGRAPH_PAGE ?? "target/web/page.html").href;
export const PROGRAM = process.env.PLACEGRAPH_PROGRAM ?? new URL("target/debug/placegraph", ROOT).pathname;
const FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });

/** A page in a context of its own; whatever goes wrong in it is in `errors`. */
export async function openPage(browser, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, acceptDownloads: true, ...options });
  // A busy machine takes its time.
  context.setDefaultTimeout(120_000);
  const page = await context.newPage();
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("request", (request) => !/^(file|blob|data):/.test(request.url()) && errors.push(`asked for ${request.url()}`));
  page.on("dialog", (dialog) => { errors.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
  await page.goto(PAGE);
  return Object.assign(page, { errors });
}

/** Tests in a browser of their own: the function that is returned makes one, on a page in which nothing may go wrong. */
export function onPages() {
  let browser;
  before(async () => { browser = await launch(); });
  after(() => browser?.close());
  return (name, options, act) => test(name, async () => {
    const page = await openPage(browser, options);
    try {
      await act(page);
      assert.deepEqual(page.errors, []);
    } finally {
      await page.context().close();
    }
  });
}

export const file = (name, buffer) => ({ name, mimeType: "application/octet-stream", buffer: Buffer.from(buffer) });
export const read = (path) => readFileSync(new URL(path, ROOT));
export const officeFiles = () => [file("map.yaml", read("maps/office/map.yaml")), file("map.png", read("maps/office/map.png"))];

/** Waits until a result is shown, or the reason why there is none. */
export async function settled(page, timeout = 120_000) {
  const outcome = await page.waitForFunction(() => {
    if (!document.getElementById("failed").hidden) return document.getElementById("failed").innerText;
    const covered = ["empty", "busy"].some((id) => !document.getElementById(id).hidden);
    return !covered && globalThis.placegraph.state.data ? "shown" : null;
  }, null, { timeout });
  return outcome.jsonValue();
}

export async function openOffice(page) {
  await page.setInputFiles("#files", officeFiles());
  return settled(page);
}

/** Drops files on the page as a file manager does. */
export async function drop(page, files) {
  const transfer = await page.evaluateHandle((list) => {
    const data = new DataTransfer();
    for (const { name, bytes } of list) data.items.add(new File([Uint8Array.from(bytes)], name));
    return data;
  }, files.map(({ name, buffer }) => ({ name, bytes: [...buffer] })));
  await page.dispatchEvent("#drop", "drop", { dataTransfer: transfer });
}

/** Everything the page knows of its places, and where they are on the screen. */
export const places = (page) => page.evaluate(() => {
  const { viewer } = globalThis.placegraph;
  const box = viewer.canvas.getBoundingClientRect();
  const onScreen = (at) => { const [x, y] = viewer.camera.toScreen(at); return [box.x + x, box.y + y]; };
  return viewer.data.places.map(({ id, name, class: kind, at, jambs, area_m2, box: cells, x, y }) =>
    ({ id, name, class: kind, at: onScreen(at), area_m2, x, y, cells, jambs: jambs?.map(onScreen) ?? null }));
});

export const editsOf = (page) => page.evaluate(() => globalThis.placegraph.state.history.edits);

/** Waits until the page has `n` edits and shows what comes of them. */
export async function waitForEdits(page, n) {
  await page.waitForFunction((wanted) => globalThis.placegraph.state.history.edits.length === wanted, n, { timeout: 60_000 });
  await page.evaluate(() => globalThis.placegraph.state.changing);
  return settled(page);
}

/** The largest place of a class. */
export const chosen = (page, kind) => places(page).then((all) => all.filter((place) => place.class === kind).sort((a, b) => b.area_m2 - a.area_m2)[0]);

/** Chooses a place with the mouse. */
export async function clickPlace(page, place) {
  await page.click("#tools button[data-tool='']");
  await page.mouse.click(...place.at);
  await page.waitForFunction((id) => globalThis.placegraph.viewer.selected === id, place.id);
}

/** Moves the keyboard's cross to a point of the screen, from where it is; returns where it is then. */
export async function cross(page, from, to) {
  const at = [...from];
  for (const axis of [0, 1]) {
    const [back, ahead] = axis ? ["ArrowUp", "ArrowDown"] : ["ArrowLeft", "ArrowRight"];
    for (const [prefix, length] of [["", 12], ["Shift+", 1]]) {
      const n = Math.trunc((to[axis] - at[axis]) / length);
      for (let k = 0; k < Math.abs(n); k += 1) await page.keyboard.press(prefix + (n < 0 ? back : ahead));
      at[axis] += n * length;
    }
  }
  return at;
}

/** The middle of the map on the screen, where the cross appears. */
export const middleOfMap = (page) => page.evaluate(() => {
  const { x, y, width, height } = globalThis.placegraph.viewer.canvas.getBoundingClientRect();
  return [x + width / 2, y + height / 2];
});

/** The bytes of the download that `act` starts. */
export async function downloaded(page, act) {
  const [download] = await Promise.all([page.waitForEvent("download", { timeout: 60_000 }), act()]);
  return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
}

export const folder = () => mkdtempSync(join(tmpdir(), "placegraph-page-"));

/** Runs the program in `cwd`. */
export const program = (args, cwd) => execFileSync(PROGRAM, args, { cwd, env: { ...process.env, SOURCE_DATE_EPOCH: "0" }, stdio: ["ignore", "pipe", "pipe"] });

/** Files of an archive by name. */
export function unzipped(bytes, cwd) {
  const script = "import base64, io, json, sys, zipfile; z = zipfile.ZipFile(io.BytesIO(sys.stdin.buffer.read())); print(json.dumps({n: base64.b64encode(z.read(n)).decode() for n in z.namelist()}))";
  const text = execFileSync("python3", ["-c", script], { input: bytes, cwd, encoding: "utf8", maxBuffer: 1 << 29 });
  return new Map(Object.entries(JSON.parse(text)).map(([name, base64]) => [name, Buffer.from(base64, "base64")]));
}

/** Office files in a folder, as the program takes them; it names a map.yaml by its folder, and the page by itself. */
export function officeFolder() {
  const path = join(folder(), "map");
  mkdirSync(path);
  for (const { name, buffer } of officeFiles()) writeFileSync(join(path, name), buffer);
  return path;
}

/** All files of the program's result for the page's edits, and those that the page hands out. */
export async function bothResults(page, formats = [], path = officeFolder(), options = []) {
  const args = ["map", "map.yaml", "--out", "out", ...options];
  if (formats.length) args.push("--export", formats.join());
  if ((await editsOf(page)).length) {
    await page.click("#tab-edits");
    const { name, bytes } = await downloaded(page, () => page.click("#save-edits"));
    assert.equal(name, "edits.toml");
    writeFileSync(join(path, name), bytes);
    args.push("--edits", "edits.toml");
  }
  program(args, path);
  await page.click("#tab-take");
  for (const format of formats) await page.check(`#panel-take input[value="${format}"]`);
  const { bytes } = await downloaded(page, () => page.click("#save-zip"));
  const out = join(path, "out");
  const files = unzipped(bytes, path);
  // The archive also has the edit file.
  files.delete("edits.toml");
  return { page: files, program: new Map(readdirSync(out).map((name) => [name, readFileSync(join(out, name))])) };
}

export function assertSame(results) {
  assert.deepEqual([...results.page.keys()].sort(), [...results.program.keys()].sort());
  for (const [name, bytes] of results.program) {
    assert.ok(bytes.equals(results.page.get(name)), `${name} differs: ${bytes.length} and ${results.page.get(name).length} bytes`);
  }
}
