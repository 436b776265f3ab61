// How long the page takes to paint while the map is moved: node speed.mjs. Prints a line per size of map.
import { launch, openOffice, openPage } from "./browser.mjs";

const browser = await launch();
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
