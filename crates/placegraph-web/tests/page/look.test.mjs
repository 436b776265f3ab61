// How the page looks and what it says to screen readers; the pictures of docs/page.md.
import test, { after, before } from "node:test";
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { launch, officeFolder, openOffice, openPage, places, program, ROOT } from "./browser.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const PICTURES = process.env.PLACEGRAPH_PICTURES;
let browser;
before(async () => { browser = await launch(); });
after(() => browser?.close());

const VIEWS = [
  ["desktop", {}],
  ["dark", { colorScheme: "dark" }],
  ["narrow", { viewport: { width: 390, height: 844 }, hasTouch: true }],
];

/** What axe-core finds wrong, in a line each. */
async function violations(page) {
  // The page runs no script but its own: axe comes in by the browser's back door.
  const session = await page.context().newCDPSession(page);
  await session.send("Runtime.evaluate", { expression: AXE });
  const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  return found.violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target.join(" ")).join("; ")}`);
}

for (const [name, options] of VIEWS) {
  test(`axe-core finds nothing wrong: ${name}`, async () => {
    const page = await openPage(browser, options);
    try {
      assert.deepEqual(await violations(page), [], "empty");
      await openOffice(page);
      const corridor = (await places(page)).find((place) => place.class === "corridor");
      await page.click(`#places button[data-id="${corridor.id}"]`);
      await page.waitForTimeout(200);
      assert.deepEqual(await violations(page), [], "a map with a chosen place");
      await page.evaluate(() => scrollTo(0, 0));
      if (PICTURES) await page.screenshot({ path: `${PICTURES}/page-${name}.png` });
      for (const tab of ["edits", "check", "take", "teach"]) {
        await page.click(`#tab-${tab}`);
        assert.deepEqual(await violations(page), [], tab);
      }
      await page.click("#start-model");
      await page.click("#paint-commands summary");
      assert.deepEqual(await violations(page), [], "a map that is painted");
      await page.click("#paint-commands summary");
      if (PICTURES) await page.screenshot({ path: `${PICTURES}/page-teach-${name}.png` });
      await page.setInputFiles("#files", [{ name: "x.txt", mimeType: "text/plain", buffer: Buffer.from("x") }]);
      await page.waitForSelector("#failed:not([hidden])");
      assert.deepEqual(await violations(page), [], "an error");
    } finally {
      await page.context().close();
    }
  });
}

const isNarrow = (page) => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);

test("axe-core finds nothing wrong: the reports of a map and of training", async () => {
  const path = officeFolder();
  program(["map", "map.yaml", "--out", "out", "--export", "report"], path);
  const home = (name) => fileURLToPath(new URL(`maps/home/${name}`, ROOT));
  program(["train", "--map", home("map.yaml"), "--labels", home("labels-five.png"), "--classes", home("five-classes.toml"), "--max-cells-per-class", "60",
    "-o", "five.model.json", "--report", "training.html"], path);
  for (const report of ["out/report.html", "training.html"]) {
    for (const [name, options] of VIEWS) {
      const page = await openPage(browser, options);
      try {
        await page.goto(pathToFileURL(join(path, report)).href);
        await page.waitForFunction(() => document.querySelector("h1").textContent);
        assert.deepEqual(await violations(page), [], `${report}, ${name}`);
        assert.ok(await isNarrow(page), `${report}, ${name}`);
        if (PICTURES) await page.screenshot({ path: `${PICTURES}/${report.replace(/\W/g, "-")}-${name}.png` });
      } finally {
        await page.context().close();
      }
    }
  }
});

test("nothing is wider than a narrow screen", async () => {
  const page = await openPage(browser, { viewport: { width: 320, height: 700 } });
  try {
    await openOffice(page);
    assert.ok(await isNarrow(page));
    await page.click("#tab-teach");
    await page.click("#start-model");
    assert.ok(await isNarrow(page));
  } finally {
    await page.context().close();
  }
});
