// The page: files in, the library's answers shown, every act an entry of the edit file.

import { $, count, element } from "../../placegraph/assets/viewer/dom.js";
import { Viewer } from "../../placegraph/assets/viewer/viewer.js";
import { MapData } from "../../placegraph/assets/viewer/mapdata.js";
import { FREE } from "../../placegraph/assets/viewer/layers.js";
import { layerControls, legend, positionText, tipFor, toggleTheme, zoomControls } from "../../placegraph/assets/viewer/controls.js";
import { isOnMap, LINE_TOOLS, lineEdit } from "./acts.js";
import { Cancelled, Engine } from "./engine.js";
import { EditPanel } from "./editlist.js";
import { sizeOf, sorted } from "./files.js";
import { History } from "./history.js";
import { LineTool } from "./linetool.js";
import { PlacesPanel } from "./places.js";
import { keepEdits, keepMap, keptEdits, keptMap } from "./store.js";
import { Tabs } from "./tabs.js";
import { download, TakePanel } from "./takealong.js";

const STAGES = {
  read: "Reading the map", classify: "Looking around from every free cell", doorways: "Finding doorways", spaces: "Telling rooms from corridors",
  smooth: "Hearing the neighbors", correct: "Joining what belongs together", topology: "Building the graph",
};

const embedded = JSON.parse($("data").textContent);
const viewer = new Viewer($("viewer"), { choose, hover });
const state = { map: null, data: null, history: new History(), outcomes: [], text: "", formats: [], tool: null };
const tabs = new Tabs($("tabs"), $("panels"), [
  { id: "places", name: "Places" }, { id: "edits", name: "Edits" }, { id: "check", name: "Check" }, { id: "take", name: "Take along" },
]);
const places = new PlacesPanel(tabs.panel("places"), { choose: (place) => choose(place, true), edit: act, draw: useTool });
let edits = null;
let take = null;
const engine = new Engine(startWorker, (stage, done, total) => {
  $("stage").textContent = STAGES[stage] ?? stage;
  if (total) $("bar").value = done / total;
  else $("bar").removeAttribute("value");
});

function buildPanels() {
  for (const id of ["edits", "take"]) tabs.panel(id).replaceChildren();
  places.on.edit = act;
  edits = new EditPanel(tabs.panel("edits"), {
    remove: (index) => change(() => state.history.remove(index)), clear: () => change(() => state.history.set([])),
    save: () => download("edits.toml", [state.text], "application/toml"), edit: act, place: () => state.data.byId.get(places.selected),
  });
  take = new TakePanel(tabs.panel("take"), { files: exported, name: () => state.map.name });
}

function startWorker() {
  const address = URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" }));
  const worker = new Worker(address);
  const packed = Uint8Array.from(atob($("library").textContent.trim()), (c) => c.charCodeAt(0));
  worker.postMessage({ packed });
  return worker;
}

const say = (text) => { $("status").textContent = text; };

/** Shows one of the covers over the map, or none. */
function cover(id) {
  for (const other of ["empty", "busy", "failed"]) $(other).hidden = other !== id;
}

function fail(title, why) {
  $("failed-what").textContent = title;
  $("failed-why").textContent = why;
  $("back").hidden = !state.data;
  cover("failed");
  ($("back").hidden ? $("again") : $("back")).focus();
}

// Opening.

async function openFiles(list) {
  const files = await Promise.all([...list].map(async (file) => ({ name: file.name, file })));
  const found = sorted(files);
  if (found.error) return fail("Which map is it?", found.error);
  if (!found.main) return openEdits(found.edits.file);
  const read = await Promise.all(found.files.map(async ({ name, file }) => ({ name, bytes: await file.arrayBuffer() })))
    .catch((error) => fail("The file cannot be read", error.message));
  if (!read) return undefined;
  const empty = read.find(({ bytes }) => !bytes.byteLength);
  if (empty) return fail("There is nothing to read", `${empty.name} is empty.`);
  let resolution = null;
  if (found.isImageAlone) {
    resolution = await askResolution(read[0]);
    if (resolution === null) return undefined;
  }
  await openMap({ files: read, resolution_m: resolution });
  if (found.edits && state.data) await openEdits(found.edits.file);
  return undefined;
}

async function openEdits(file) {
  if (!state.data) return fail("An edit file needs its map", `Open the map first, then ${file.name}.`);
  try {
    const answer = await engine.call({ op: "parse_edits", text: await file.text() });
    await change(() => state.history.set(answer.edits));
    tabs.show("edits");
  } catch (error) {
    fail(`${file.name} cannot be read`, error.message);
  }
  return undefined;
}

/** Asks for meters per pixel; null if the user gives up. */
function askResolution({ name, bytes }) {
  const size = sizeOf(bytes);
  const dialog = $("scale-dialog");
  const show = () => {
    const side = Number($("resolution").value);
    $("extent").textContent = size && side > 0 ? `${name} would be ${(size[0] * side).toFixed(1)} × ${(size[1] * side).toFixed(1)} m.` : "";
  };
  show();
  $("resolution").oninput = show;
  dialog.returnValue = "";
  dialog.showModal();
  return new Promise((resolve) => {
    dialog.onclose = () => resolve(dialog.returnValue === "ok" ? Number($("resolution").value) : null);
  });
}

/** Opens a map; edits that the page kept for it come back, else those of the text `given` hold. */
async function openMap(map, isRestored = false, given = null) {
  cover("busy");
  $("busy-what").textContent = map.files[0].name;
  $("bar").removeAttribute("value");
  $("cancel").focus();
  const start = performance.now();
  try {
    await load(map);
    const first = given ? (await engine.call({ op: "parse_edits", text: given })).edits : [];
    state.history = History.from(keptEdits(state.map.hash)) ?? new History([first]);
    state.isNew = true;
    buildPanels();
    await replay();
    if (!isRestored) keepMap(map);
    sessionStorage.setItem("placegraph:open", "1");
    cover(null);
    say(`${state.map.name} is labeled: ${count(state.data.places.length, "place")}.`);
    console.info(`placegraph: picture after ${(performance.now() - start).toFixed(0)} ms`);
  } catch (error) {
    if (error instanceof Cancelled) cover(state.data ? null : "empty");
    else fail("This map cannot be labeled", error.message);
  }
}

/** Gives the files to the library; the engine may be a new one. */
async function load(map) {
  const names = map.files.map(({ name }) => name);
  // Copies: what is sent is gone, and a cancelled engine needs it again.
  const answer = await engine.call({ op: "open", names, resolution_m: map.resolution_m }, map.files.map(({ bytes }) => bytes.slice(0)));
  state.map = { ...map, ...answer.map };
  state.loaded = engine.worker;
}

// Showing.

/** Has the library replay all edits, and shows what comes of it. */
async function replay() {
  if (engine.worker !== state.loaded || !engine.worker) await load(state.map);
  const { answer, rasters } = await ask();
  Object.assign(state, { data: new MapData(answer.view), outcomes: answer.outcomes, text: answer.edits_toml, formats: answer.formats });
  viewer.show(state.data, rasters);
  if (state.isNew) {
    state.isNew = false;
    viewer.selected = places.selected = null;
    layerControls($("layers"), viewer, () => legend($("legend"), state.data, viewer.shown.probability));
    take.show(state.formats);
    viewer.fit();
  }
  keepEdits(state.map.hash, state.history);
  showAll();
}

async function ask() {
  const answer = await engine.call({ op: "replay", edits: state.history.edits });
  const [occupancy, probability] = answer.bytes;
  return { answer, rasters: occupancy ? { occupancy, probability } : {} };
}

function showAll() {
  const { data, history, outcomes } = state;
  for (const id of ["actions", "tools", "below", "side"]) $(id).hidden = false;
  const what = $("what");
  what.replaceChildren();
  element(what, "b", {}, state.map.name);
  what.append(` · ${data.width} × ${data.height} cells of ${data.resolution_m} m · ${data.places.reduce((sum, p) => sum + p.area_m2, 0).toFixed(0)} m² free`);
  document.title = `${state.map.name} – placegraph`;
  legend($("legend"), data, viewer.shown.probability);
  places.show(data);
  edits?.show(history.edits, outcomes, state.text);
  tabs.count("edits", history.edits.length);
  tabs.count("check", data.findings.length);
  const check = tabs.panel("check");
  check.replaceChildren();
  if (data.findings.length) {
    const list = element(check, "ul", { class: "findings" });
    for (const finding of data.findings) element(list, "li", {}, finding);
  } else element(check, "p", { class: "fine" }, "The check of the map found nothing to report.");
  $("undo").disabled = !history.canUndo;
  $("redo").disabled = !history.canRedo;
}

/** A result without its map: to look at. */
function showResult(data) {
  state.data = data;
  state.map = { name: data.title };
  viewer.show(data);
  viewer.fit();
  layerControls($("layers"), viewer, () => legend($("legend"), data, viewer.shown.probability));
  places.on.edit = null;
  showAll();
  for (const id of ["actions", "tools"]) $(id).hidden = true;
  tabs.panel("edits").replaceChildren(element(null, "p", { class: "fine" }, "This page shows a result. Open its map to mend it."));
  tabs.panel("take").replaceChildren(element(null, "p", { class: "fine" }, "Open the map to take its files along."));
  cover(null);
}

function choose(place, isSought = false) {
  if (isSought) viewer.select(place?.id ?? null, true);
  else viewer.select(place?.id ?? null);
  if (place && !isSought) tabs.show("places");
  places.select(place?.id ?? null);
}

function hover(place, meters, event) {
  if (!state.data) return;
  $("at").textContent = positionText(meters, state.data.frame) || "\u00a0";
  tipFor(state.data, state.tool ? null : place, event);
}

// Mending.

function act(edit) {
  return change(() => state.history.add(edit));
}

/** Changes the list of edits and replays it; one change at a time. */
function change(how) {
  state.changing = (state.changing ?? Promise.resolve()).then(async () => {
    const before = [state.history.states, state.history.index];
    const onMap = JSON.stringify(state.history.edits.filter(isOnMap));
    const chosen = state.data.byId.get(places.selected);
    how();
    const isSlow = JSON.stringify(state.history.edits.filter(isOnMap)) !== onMap;
    if (isSlow) {
      $("busy-what").textContent = "Labeling the changed map";
      cover("busy");
    }
    try {
      await replay();
      // Numbers may change: what was chosen is what lies at the same point.
      const again = chosen && state.data.placeAt(state.data.toCells([chosen.x, chosen.y]));
      choose(again ?? null, false);
      const failed = state.outcomes.find((outcome) => outcome?.error);
      say(failed ? `An edit does not apply: ${failed.error}` : `${count(state.history.edits.length, "edit")}, ${count(state.data.places.length, "place")}.`);
      cover(null);
    } catch (error) {
      [state.history.states, state.history.index] = before;
      if (error instanceof Cancelled) cover(null);
      else fail("This edit cannot be made", error.message);
    }
  });
  return state.changing;
}

function useTool(id) {
  const tool = LINE_TOOLS.find((other) => other.id === id && state.tool !== id) ?? null;
  state.tool = tool?.id ?? null;
  viewer.tool = tool && new LineTool((ends) => drawn(tool.id, ends), say, {
    jambs: () => state.data.places.flatMap((place) => place.jambs ?? []),
    isFree: (x, y) => x >= 0 && y >= 0 && x < state.data.width && y < state.data.height
      && viewer.occupancy?.values[y * state.data.width + x] === FREE,
  });
  viewer.canvas.classList.toggle("drawing", Boolean(tool));
  for (const button of $("tools").querySelectorAll("button")) {
    button.setAttribute("aria-pressed", String((button.dataset.tool || null) === state.tool));
  }
  $("hint").textContent = tool ? `${tool.hint} Drag, or click twice; with the keyboard: arrows, Enter, arrows, Enter. Esc ends.` : "";
  if (tool) viewer.canvas.focus();
  viewer.repaint();
}

function drawn(action, ends) {
  const place = state.data.byId.get(places.selected);
  if (action === "move_doorway" && !(place && state.data.isDoorway(place))) {
    $("hint").textContent = "Choose the doorway to move first, on the map or in the list.";
    return;
  }
  act(lineEdit(action, ends.map((end) => state.data.toMeters(end)), place));
}

/** What the program would write: the result and the chosen formats. */
async function exported(formats) {
  const answer = await engine.call({ op: "export", edits: state.history.edits, formats });
  return { files: answer.files.map((name, i) => ({ name, bytes: answer.bytes[i] })), skipped: answer.skipped };
}

// Controls.

function buildTools() {
  const tools = [{ id: "", name: "Choose", key: "v" }, ...LINE_TOOLS];
  for (const { id, name, key } of tools) {
    element($("tools"), "button", {
      type: "button", "data-tool": id, "aria-pressed": String(!id), "aria-keyshortcuts": key.toUpperCase(), onclick: () => useTool(id),
    }, name, element(null, "kbd", { "aria-hidden": "true" }, key.toUpperCase()));
  }
  element($("tools"), "p", { class: "hint", id: "hint", role: "status" });
  $("tools").addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const buttons = [...$("tools").querySelectorAll("button")];
    if (step) buttons[(buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length]?.focus();
  });
}

function keys(event) {
  if (!state.data || !$("busy").hidden || $("scale-dialog").open) return;
  const key = event.key.toLowerCase();
  if ((event.ctrlKey || event.metaKey) && (key === "z" || key === "y")) {
    if (event.target.matches("input, textarea")) return;
    event.preventDefault();
    const isRedo = key === "y" || event.shiftKey;
    if (isRedo ? state.history.canRedo : state.history.canUndo) change(() => (isRedo ? state.history.redo() : state.history.undo()));
    return;
  }
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input, select, textarea")) return;
  if (key === "escape" && state.tool) useTool("");
  if (key === "v") useTool("");
  if (key === "/") {
    event.preventDefault();
    tabs.show("places");
    $("find").focus();
  }
  const tool = LINE_TOOLS.find((other) => other.key === key);
  if (tool) useTool(tool.id);
}

function listen() {
  const chooseFiles = () => $("files").click();
  for (const id of ["open", "choose", "again"]) $(id).onclick = chooseFiles;
  $("files").onchange = () => {
    if ($("files").files.length) openFiles($("files").files).finally(() => { $("files").value = ""; });
  };
  $("back").onclick = () => cover(null);
  $("cancel").onclick = () => engine.cancel();
  $("theme").onclick = () => toggleTheme(viewer);
  $("undo").onclick = () => change(() => state.history.undo());
  $("redo").onclick = () => change(() => state.history.redo());
  $("example").hidden = !embedded.example;
  $("example").onclick = () => openMap({ files: embedded.example.map(({ name, base64 }) => ({ name, bytes: bytesOf(base64) })), resolution_m: null });
  addEventListener("keydown", keys);
  addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("is-over");
    if (state.data && $("busy").hidden) cover("empty");
  });
  addEventListener("dragleave", (event) => {
    if (event.relatedTarget) return;
    document.body.classList.remove("is-over");
    if (state.data && !$("empty").hidden) cover(null);
  });
  addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("is-over");
    if (state.data) cover(null);
    if (event.dataTransfer.files.length && $("busy").hidden) openFiles(event.dataTransfer.files);
  });
}

const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer;

/** After a reload the map that was open comes back; on a new visit it is offered. */
async function restore() {
  if (embedded.map) {
    const files = embedded.map.files.map(({ name, base64 }) => ({ name, bytes: bytesOf(base64) }));
    return openMap({ files, resolution_m: embedded.map.resolution_m }, true, embedded.map.edits);
  }
  if (embedded.result) return showResult(new MapData(embedded.result));
  const kept = await keptMap();
  if (!kept) return undefined;
  if (sessionStorage.getItem("placegraph:open")) return openMap(kept, true);
  $("continue").hidden = false;
  $("continue").textContent = `Continue with ${kept.files[0].name}`;
  $("continue").onclick = () => openMap(kept, true);
  return undefined;
}

// For the console, and for tests.
globalThis.placegraph = { viewer, state };
zoomControls($("viewer"), viewer);
buildTools();
listen();
restore();
