// Times, sizes and memory of the page: PLACEGRAPH_PAGE=page.html PLACEGRAPH_PROGRAM=placegraph node speed.mjs [MAP...]
//
// For the example and every map named: from the drop to the picture on the page, and the program on one thread, in turn, the
// best of three each. The page starts its library when it opens: a map is dropped at once, and when the library has started, as it
// has after a moment. Then what the page takes to paint while a map is moved.
import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { basename, dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { PROGRAM, ROOT, file, folder, launch, openOffice, openPage, PAGE, settled } from "./browser.mjs";

const RUNS = 3;
const browser = await launch();
const inMb = (bytes) => `${(bytes / 1e6).toFixed(2)} MB`;
console.log(`page: ${inMb(statSync(fileURLToPath(PAGE)).size)}`);

/** The map's YAML and its image. */
function filesOf(path) {
  const image = /^image: *["']?([^"'\n]+)/m.exec(readFileSync(path, "utf8"))[1].trim();
  return [path, join(dirname(path), image)].map((name) => file(basename(name), readFileSync(name)));
}

/** Seconds from the drop to the picture, and the memory of the library. */
async function onPage(map, hasStarted) {
  const page = await openPage(browser);
  if (hasStarted) await page.evaluate(() => globalThis.placegraph.engine.call({ op: "parse_edits", text: "" }));
  const start = performance.now();
  await page.setInputFiles("#files", filesOf(map));
  await settled(page);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const seconds = (performance.now() - start) / 1e3;
  const memory = await page.evaluate(() => globalThis.placegraph.engine.memoryBytes);
  await page.context().close();
  return [seconds, memory];
}

for (const map of [fileURLToPath(new URL("maps/office/map.yaml", ROOT)), ...process.argv.slice(2)]) {
  const best = { atOnce: Infinity, started: Infinity, program: Infinity };
  let memory = 0;
  for (let run = 0; run < RUNS; run += 1) {
    for (const [name, hasStarted] of [["atOnce", false], ["started", true]]) {
      const [seconds, bytes] = await onPage(map, hasStarted);
      best[name] = Math.min(best[name], seconds);
      memory = Math.max(memory, bytes);
    }
    const begin = performance.now();
    execFileSync(PROGRAM, ["map", map, "--threads", "1", "--out", join(folder(), "out")], { stdio: "ignore" });
    best.program = Math.min(best.program, (performance.now() - begin) / 1e3);
  }
  const times = (name) => `${best[name].toFixed(2)} s, ${(best[name] / best.program).toFixed(1)} times`;
  console.log(`${basename(dirname(map))}: program on one thread ${best.program.toFixed(2)} s; page, dropped at once ${times("atOnce")}; library started ${times("started")}; memory of the library ${inMb(memory)}`);
}

/** Milliseconds between frames of an empty page: what the browser and this machine take by themselves. */
async function emptyGap() {
  const page = await (await browser.newContext({ viewport: { width: 1600, height: 1000 } })).newPage();
  const gap = await page.evaluate(async () => {
    const gaps = [];
    for (let i = 0, last = performance.now(); i < 120; i += 1) {
      await new Promise((done) => requestAnimationFrame(done));
      gaps.push(performance.now() - last);
      last = performance.now();
    }
    return gaps.sort((a, b) => a - b)[60];
  });
  await page.context().close();
  return gap;
}
console.log(`an empty page: between frames ${(await emptyGap()).toFixed(1)} ms`);

for (const [columns, rows] of [[1, 1], [2, 3], [5, 5]]) {
  const page = await openPage(browser, { viewport: { width: 1600, height: 1000 } });
  await openOffice(page);
  const line = await page.evaluate(async ([nx, ny]) => {
    const { viewer } = globalThis.placegraph;
    const one = viewer.data;
    const [w, h] = [one.width, one.height];
    // The office again and again, side by side.
    const values = new Uint8Array(w * h * nx * ny);
    for (let y = 0; y < h * ny; y += 1) {
      for (let x = 0; x < w * nx; x += 1) values[y * w * nx + x] = viewer.occupancy.values[(y % h) * w + (x % w)];
    }
    const places = [];
    const connections = [];
    for (let copy = 0; copy < nx * ny; copy += 1) {
      const move = ([x, y]) => [x + (copy % nx) * w, y + Math.floor(copy / nx) * h];
      const id = (n) => n + copy * 1000;
      for (const p of one.places) {
        places.push({ ...p, path: undefined, id: id(p.id), at: move(p.at), rings: p.rings.map((ring) => ring.map(move)), jambs: p.jambs?.map(move), sides: p.sides?.map(id) });
      }
      for (const c of one.connections) connections.push({ ...c, a: id(c.a), b: id(c.b), line: c.line.map(move) });
    }
    const data = new one.constructor({ ...one, width: w * nx, height: h * ny, places, connections });
    viewer.show(data, { occupancy: values });
    viewer.fit();
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    await frame();
    await frame();
    const gaps = [];
    viewer.frames.length = 0;
    let last = performance.now();
    for (let i = 0; i < 120; i += 1) {
      viewer.panBy(6 * Math.cos(i / 9), 6 * Math.sin(i / 9));
      if (i % 30 === 29) viewer.zoomBy(1.15);
      await frame();
      gaps.push(performance.now() - last);
      last = performance.now();
    }
    const sorted = (list) => [...list].sort((a, b) => a - b);
    const [paint, gap] = [sorted(viewer.frames), sorted(gaps)];
    const at = (list, share) => list[Math.floor(list.length * share)].toFixed(1);
    return `${((w * h * nx * ny) / 1e6).toFixed(2)} M cells, ${places.length} places: painting ${at(paint, 0.5)} ms (95 %: ${at(paint, 0.95)}), between frames ${at(gap, 0.5)} ms (95 %: ${at(gap, 0.95)})`;
  }, [columns, rows]);
  console.log(line);
  await page.context().close();
}
await browser.close();
