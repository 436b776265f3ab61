// The page: files in, the library's answers shown, every act an entry of the edit file.

import { $, count, element } from "../../placegraph/assets/viewer/dom.js";
import { Viewer } from "../../placegraph/assets/viewer/viewer.js";
import { MapData } from "../../placegraph/assets/viewer/mapdata.js";
import { FREE } from "../../placegraph/assets/viewer/layers.js";
import { layerControls, legend, positionText, tipFor, toggleTheme, zoomControls } from "../../placegraph/assets/viewer/controls.js";
import { isOnMap, LINE_TOOLS, lineEdit } from "./acts.js";
import { cover, coverBusy, coverFailed, listenForDrops, say, showProgress } from "./covers.js";
import { Cancelled, Engine, startWorker } from "./engine.js";
import { EditPanel } from "./editlist.js";
import { decoded, sorted } from "./files.js";
import { History } from "./history.js";
import { LineTool } from "./linetool.js";
import { PAINT_TOOLS } from "./painttool.js";
import { PlacesPanel } from "./places.js";
import { askResolution } from "./scaledialog.js";
import { keepEdits, keepMap, keptEdits, keptMap } from "./store.js";
import { Tabs } from "./tabs.js";
import { download, TakePanel } from "./takealong.js";
import { Teach } from "./teach.js";
import { Toolbar } from "./toolbar.js";

const embedded = JSON.parse($("data").textContent);
const viewer = new Viewer($("viewer"), { choose, hover });
const state = { map: null, data: null, history: new History(), outcomes: [], text: "", formats: [], tool: null };
const tabs = new Tabs($("tabs"), $("panels"), [
  { id: "places", name: "Places" }, { id: "edits", name: "Edits" }, { id: "teach", name: "Teach" }, { id: "check", name: "Check" },
  { id: "take", name: "Take along" },
], showTab);
const places = new PlacesPanel(tabs.panel("places"), { choose: (place) => choose(place, true), edit: act, draw: pickTool });
const teach = new Teach(tabs.panel("teach"), {
  viewer, call, say, map: () => state.map, data: () => state.data, edits: () => state.history.edits, useModel, work, toolsChanged: showTools,
});
const toolbar = new Toolbar($("tools"), pickTool);
let edits = null;
let take = null;
const engine = new Engine(startWorker, showProgress);

function buildPanels() {
  for (const id of ["edits", "take"]) tabs.panel(id).replaceChildren();
  places.on.edit = act;
  edits = new EditPanel(tabs.panel("edits"), {
    remove: (index) => change(() => state.history.remove(index)), clear: () => change(() => state.history.set([])),
    save: () => download("edits.toml", [state.text], "application/toml"), edit: act, place: () => state.data.byId.get(places.selected),
  });
  take = new TakePanel(tabs.panel("take"), { files: exported, name: () => state.map.name });
}

const fail = (title, why) => coverFailed(title, why, Boolean(state.data));

// Opening.

async function openFiles(list) {
  const files = await Promise.all([...list].map(async (file) => ({ name: file.name, file })));
  const found = sorted(files);
  if (found.error) return fail("Which map is it?", found.error);
  if (found.model) return openModel(found.model.file);
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

async function openModel(file) {
  const bytes = await file.arrayBuffer();
  if (!state.data) return fail("A model needs a map", `Open a map first, then ${file.name}.`);
  await work("Labeling with another model", () => useModel({ name: file.name, bytes }), (error) => fail(`${file.name} cannot be used`, error.message));
  return undefined;
}

/** Opens a map; edits that the page kept for it come back, else those of the text `given` hold. */
async function openMap(map, isRestored = false, given = null) {
  coverBusy(map.files[0].name);
  const start = performance.now();
  if (isRestored) teach.model = map.model ?? null;
  try {
    await load(map);
    const first = given ? (await engine.call({ op: "parse_edits", text: given })).edits : [];
    state.history = History.from(keptEdits(state.map.hash)) ?? new History([first]);
    state.isNew = true;
    buildPanels();
    await replay();
    await teach.opened();
    showTab(tabs.shown);
    if (!isRestored) keepMap({ ...map, model: teach.model });
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
  await engine.call({ op: "use_model", name: teach.model?.name ?? null }, teach.model ? [teach.model.bytes] : []);
  const names = map.files.map(({ name }) => name);
  const answer = await engine.call({ op: "open", names, resolution_m: map.resolution_m }, map.files.map(({ bytes }) => bytes));
  state.map = { ...map, ...answer.map };
  state.loaded = engine.worker;
}

/** Asks the library about the open map. */
async function call(request, bytes) {
  if (engine.worker !== state.loaded || !engine.worker) await load(state.map);
  return engine.call(request, bytes);
}

/** Long work under a cover, which can be cancelled. */
async function work(title, act, onError = (error) => fail("This cannot be done", error.message)) {
  coverBusy(title);
  try {
    await act();
    cover(null);
  } catch (error) {
    cover(null);
    if (error instanceof Cancelled) say("Stopped.");
    else onError(error);
  }
}

/** Labels with another model; null is the library's own. */
async function useModel(model) {
  const before = teach.model;
  try {
    teach.model = model;
    await call({ op: "use_model", name: model?.name ?? null }, model ? [model.bytes] : []);
    await replay();
  } catch (error) {
    teach.model = before;
    throw error;
  }
  keepMap({ files: state.map.files, resolution_m: state.map.resolution_m, model });
}

// Showing.

/** Has the library replay all edits, and shows what comes of it. */
async function replay() {
  const { bytes: [occupancy, probability], ...answer } = await call({ op: "replay", edits: state.history.edits });
  Object.assign(state, { data: new MapData(answer.view), outcomes: answer.outcomes, text: answer.edits_toml, formats: answer.formats });
  viewer.show(state.data, occupancy ? { occupancy, probability } : {});
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

function showAll() {
  const { data, history, outcomes } = state;
  for (const id of ["actions", "tools", "below", "side"]) $(id).hidden = false;
  const what = $("what");
  what.replaceChildren();
  element(what, "b", {}, state.map.name);
  what.append(` · ${data.width} × ${data.height} cells of ${data.resolution_m} m · ${data.places.reduce((sum, p) => sum + p.area_m2, 0).toFixed(0)} m² free`);
  if (teach.model) what.append(` · labeled by ${teach.model.name}`);
  document.title = `${state.map.name} – placegraph`;
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
  teach.resultChanged();
  showTools();
}

/** Whether the map is painted rather than mended. */
const isTeaching = () => tabs.shown === "teach" && Boolean(teach.painting);

function showTab(id) {
  if (!state.data) return;
  const isPainting = isTeaching();
  if (state.isPainting !== isPainting) {
    state.isPainting = isPainting;
    toolbar.show(isPainting ? PAINT_TOOLS : LINE_TOOLS);
    useTool(isPainting ? "brush" : "");
  }
  teach.show(id === "teach");
  showTools();
}

/** What depends on whether the map is mended or painted. */
function showTools() {
  if (state.isPainting !== isTeaching()) return showTab(tabs.shown);
  const steps = state.isPainting ? teach : state.history;
  $("undo").disabled = !steps.canUndo;
  $("redo").disabled = !steps.canRedo;
  $("layers").hidden = Boolean(viewer.labels);
  if (viewer.labels) teach.legend($("legend"));
  else legend($("legend"), state.data, viewer.shown.probability);
  return undefined;
}

/** Undoes or redoes a step of what the tab is about. */
function step(isRedo) {
  const steps = isTeaching() ? teach : state.history;
  if (!(isRedo ? steps.canRedo : steps.canUndo)) return;
  if (steps === teach) teach.undo(isRedo);
  else change(() => (isRedo ? state.history.redo() : state.history.undo()));
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
  tabs.panel("teach").replaceChildren(element(null, "p", { class: "fine" }, "This page shows a result. Open its map to paint on it."));
  tabs.panel("edits").replaceChildren(element(null, "p", { class: "fine" }, "This page shows a result. Open its map to mend it."));
  tabs.panel("take").replaceChildren(element(null, "p", { class: "fine" }, "Open the map to take its files along."));
  cover(null);
}

function choose(place, isSought = false) {
  if (isSought) viewer.select(place?.id ?? null, true);
  else viewer.select(place?.id ?? null);
  if (place && !isSought && !isTeaching()) tabs.show("places");
  places.select(place?.id ?? null);
}

function hover(place, meters, event) {
  if (!state.data) return;
  const painted = meters && teach.nameAt(state.data.toCells(meters));
  $("at").textContent = [positionText(meters, state.data.frame), painted].filter(Boolean).join(" · ") || "\u00a0";
  tipFor(state.data, state.tool || viewer.labels ? null : place, event);
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
    if (isSlow) coverBusy("Labeling the changed map");
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
  const tools = state.isPainting ? PAINT_TOOLS : LINE_TOOLS;
  const tool = tools.find((other) => other.id === id && state.tool !== id) ?? null;
  viewer.tool?.end?.();
  state.tool = tool?.id ?? null;
  viewer.tool = tool && (state.isPainting ? teach.tool(tool.id) : lineTool(tool.id));
  viewer.canvas.classList.toggle("drawing", Boolean(tool));
  const how = state.isPainting ? "" : " Drag, or click twice; with the keyboard: arrows, Enter, arrows, Enter. Esc ends.";
  toolbar.select(state.tool, tool ? tool.hint + how : "");
  viewer.repaint();
}

/** As `useTool`, by somebody who draws next. */
function pickTool(id) {
  useTool(id);
  if (state.tool) viewer.canvas.focus();
}

const lineTool = (id) => new LineTool((ends) => drawn(id, ends), say, {
  jambs: () => state.data.places.flatMap((place) => place.jambs ?? []),
  isFree: (x, y) => x >= 0 && y >= 0 && x < state.data.width && y < state.data.height
    && viewer.occupancy?.values[y * state.data.width + x] === FREE,
  nameAt: (at) => state.data.placeAt(at)?.name,
});

function drawn(action, ends) {
  const place = state.data.byId.get(places.selected);
  if (action === "move_doorway" && !(place && state.data.isDoorway(place))) {
    toolbar.hint("Choose the doorway to move first, on the map or in the list.");
    return;
  }
  act(lineEdit(action, ends.map((end) => state.data.toMeters(end)), place));
}

/** What the program would write: the result and the chosen formats. */
async function exported(formats) {
  const answer = await call({ op: "export", edits: state.history.edits, formats });
  return { files: answer.files.map((name, i) => ({ name, bytes: answer.bytes[i] })), skipped: answer.skipped };
}

// Controls.

function keys(event) {
  if (event.defaultPrevented || !state.data || !$("busy").hidden || $("scale-dialog").open) return;
  const key = event.key.toLowerCase();
  if ((event.ctrlKey || event.metaKey) && (key === "z" || key === "y")) {
    if (event.target.matches("input, textarea")) return;
    event.preventDefault();
    step(key === "y" || event.shiftKey);
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
  if (state.isPainting && teach.key(key)) return;
  const tool = (state.isPainting ? PAINT_TOOLS : LINE_TOOLS).find((other) => other.key === key);
  if (tool) pickTool(tool.id);
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
  $("undo").onclick = () => step(false);
  $("redo").onclick = () => step(true);
  $("example").hidden = !embedded.example;
  $("example").onclick = () => openMap({ files: decoded(embedded.example), resolution_m: null });
  addEventListener("keydown", keys);
  listenForDrops(() => Boolean(state.data), openFiles);
}

/** After a reload the map that was open comes back; on a new visit it is offered. */
async function restore() {
  if (embedded.map) {
    return openMap({ files: decoded(embedded.map.files), resolution_m: embedded.map.resolution_m }, true, embedded.map.edits);
  }
  if (embedded.result) return showResult(new MapData(embedded.result));
  engine.wake();
  const kept = await keptMap();
  if (!kept) return undefined;
  if (sessionStorage.getItem("placegraph:open")) return openMap(kept, true);
  $("continue").hidden = false;
  $("continue").textContent = `Continue with ${kept.files[0].name}`;
  $("continue").onclick = () => openMap(kept, true);
  return undefined;
}

// For the console, and for tests.
globalThis.placegraph = { viewer, state, teach, engine };
zoomControls($("viewer"), viewer);
listen();
restore();
