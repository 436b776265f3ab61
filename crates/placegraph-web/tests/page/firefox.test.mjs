// The page in Firefox, by WebDriver BiDi: node --experimental-websocket --test firefox.test.mjs
import test from "node:test";
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { folder, officeFolder, PAGE, program } from "./browser.mjs";

const FIREFOX = process.env.FIREFOX ?? "firefox-esr";

/** A running Firefox: `send(method, params)` asks, `close()` ends it. */
async function launchFirefox() {
  const profile = folder();
  const browser = spawn(FIREFOX, ["--headless", "--no-remote", "--profile", profile, "--remote-debugging-port", "0"], { stdio: ["ignore", "ignore", "pipe"] });
  let address = null;
  for await (const line of createInterface({ input: browser.stderr })) {
    address = /BiDi listening on (ws:\S+)/.exec(line)?.[1];
    if (address) break;
  }
  browser.stderr.resume();
  const socket = new WebSocket(`${address}/session`);
  await once(socket, "open");
  const waiting = new Map();
  socket.onmessage = ({ data }) => {
    const { id, result, message } = JSON.parse(data);
    const asked = waiting.get(id);
    waiting.delete(id);
    if (message) asked?.reject(new Error(message));
    else asked?.resolve(result);
  };
  const send = (method, params = {}) => new Promise((resolve, reject) => {
    const id = (send.n = (send.n ?? 0) + 1);
    waiting.set(id, { resolve, reject });
    socket.send(JSON.stringify({ id, method, params }));
  });
  const close = async () => {
    socket.close();
    browser.kill();
    await once(browser, "exit");
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  };
  return { send, close };
}

test("Firefox labels the example and exports what the program writes", { timeout: 300_000 }, async () => {
  const firefox = await launchFirefox();
  try {
    await firefox.send("session.new", { capabilities: {} });
    const { contexts: [{ context }] } = await firefox.send("browsingContext.getTree");
    await firefox.send("browsingContext.navigate", { context, url: PAGE, wait: "complete" });
    /** The value of an expression on the page. */
    const evaluate = async (expression) => {
      const { type, result, exceptionDetails } = await firefox.send("script.evaluate", { expression, target: { context }, awaitPromise: true });
      assert.equal(type, "success", exceptionDetails?.text);
      return result.value;
    };
    await evaluate("document.getElementById('example').click()");
    const failed = await evaluate(`new Promise((done) => {
      const look = () => {
        const { state } = globalThis.placegraph;
        if (!document.getElementById("failed").hidden) done(document.getElementById("failed").innerText);
        else if (state.data && document.getElementById("busy").hidden) done("");
        else setTimeout(look, 100);
      };
      look();
    })`);
    assert.equal(failed, "");
    const exported = await evaluate(`globalThis.placegraph.engine.call({ op: "export", edits: [], formats: ["nav2"] }).then(({ files, bytes }) => {
      const text = (name) => new TextDecoder().decode(bytes[files.indexOf(name)]);
      return JSON.stringify({ topology: text("topology.json"), files });
    })`);
    const path = officeFolder();
    program(["map", "map.yaml", "--out", "out", "--export", "nav2"], path);
    const { topology, files } = JSON.parse(exported);
    assert.ok(files.length > 5, files.join());
    assert.equal(topology, readFileSync(join(path, "out/topology.json"), "utf8"));
    // The picture is painted, the panel of the tab is there.
    await evaluate("document.getElementById('tab-teach').click(); document.getElementById('start-model').click()");
    const isPainted = await evaluate("new Promise((done) => setTimeout(() => done(Boolean(globalThis.placegraph.viewer.labels)), 2000))");
    assert.equal(isPainted, true);
  } finally {
    await firefox.close();
  }
});
