// Times, sizes and memory of the page: PLACEGRAPH_PAGE=page.html PLACEGRAPH_PROGRAM=placegraph node speed.mjs [MAP...]
//
// For the example and every map named: from the drop to the picture on the page, and the program on one thread, in turn, the
// best of three each. Then what the page takes to paint while a map is moved.
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

for (const map of [fileURLToPath(new URL("maps/office/map.yaml", ROOT)), ...process.argv.slice(2)]) {
  const times = { page: [], program: [] };
  let memory = 0;
  for (let run = 0; run < RUNS; run += 1) {
    const page = await openPage(browser);
    // The library starts with the first map: its start is part of the time.
    const start = performance.now();
    await page.setInputFiles("#files", filesOf(map));
    await settled(page);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    times.page.push(performance.now() - start);
    memory = await page.evaluate(() => globalThis.placegraph.engine.memoryBytes);
    await page.context().close();
    const begin = performance.now();
    execFileSync(PROGRAM, ["map", map, "--threads", "1", "--out", join(folder(), "out")], { stdio: "ignore" });
    times.program.push(performance.now() - begin);
  }
  const [page, program] = [Math.min(...times.page) / 1e3, Math.min(...times.program) / 1e3];
  const name = basename(dirname(map));
  console.log(`${name}: page ${page.toFixed(2)} s, program on one thread ${program.toFixed(2)} s, ratio ${(page / program).toFixed(1)}, the library's memory ${inMb(memory)}`);
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
