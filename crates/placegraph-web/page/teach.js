// Painting labels on the open map, training on them, and what comes of it.

import { legend } from "../../placegraph/assets/viewer/controls.js";
import { lettersOf } from "../../placegraph/assets/viewer/mapdata.js";
import { FREE } from "../../placegraph/assets/viewer/layers.js";
import { palette } from "../../placegraph/assets/viewer/raster.js";
import { LetteredRaster } from "./letters.js";
import { joinedClasses, NOTHING, Painting, withValues } from "./painting.js";
import { PaintTool } from "./painttool.js";
import { polygon } from "./shapes.js";
import { keepPaintedMap, keepPainting, keptPaintedMap, keptPainting, paintedMaps } from "./store.js";
import { download } from "./takealong.js";
import { EFFORTS, TeachPanel } from "./teachpanel.js";
import { zipParts } from "./zip.js";

const PAINT_ALPHA = 185;
const BRUSH_M = 0.8;
const BRUSH_STEP = 1.25;
/** Colors of label images that are no class. */
const [NO_LABEL, IGNORED] = ["0,0,0", "255,255,255"];

export class Teach {
  /** `page`: `{ viewer, call(request, bytes), say(text), map(), data(), edits(), useModel(model), work(title, act, onError), toolsChanged() }`. */
  constructor(panel, page) {
    Object.assign(this, { page, painting: null, value: 1, brushM: BRUSH_M, view: "painted", others: [], effort: EFFORTS[0].cells, model: null, note: "", isOn: false });
    this.panel = new TeachPanel(panel, {
      start: (isFromModel) => this.#start(isFromModel), choose: (value) => this.choose(value), brush: (meters) => { this.brushM = meters; },
      changeClass: (value, change) => this.#changeClass(value, change), removeClass: (value) => this.#classes(() => this.painting.removeClass(value)),
      addClass: () => this.#classes(() => { this.value = this.painting.addClass()?.value ?? this.value; }),
      view: (view) => this.#view(view), paintPlace: (id) => this.#paintPlace(id), paintBox: (box) => this.#paintBox(box),
      chooseOther: (hash, isChosen) => { this.others.find((other) => other.hash === hash).isChosen = isChosen; },
      effort: (cells) => { this.effort = cells; }, train: () => this.#train(), save: (isZip) => this.#save(isZip),
      saveModel: () => download(this.model.name, [this.model.bytes], "application/json"), forgetModel: () => this.#forget(),
    });
  }

  /** Another map is open; what was painted on it comes back. */
  async opened() {
    const { hash } = this.page.map();
    Object.assign(this, { painting: null, hash, view: "painted", note: "", result: null });
    const kept = await keptPainting(hash);
    const { width, height } = this.page.data();
    if (kept?.width === width && kept.height === height) this.painting = new Painting(kept);
    this.value = this.painting?.classes[0]?.value ?? 1;
    this.others = (await paintedMaps()).filter((other) => other.hash !== hash).map((other) => ({ ...other, isChosen: false }));
    this.refresh();
  }

  /** The result has changed, or the model. */
  resultChanged() {
    this.result = null;
    if (this.isOn) this.#view(this.view);
  }

  /** The tab is shown, or another is. */
  show(isOn) {
    this.isOn = isOn;
    this.refresh();
  }

  get canUndo() {
    return Boolean(this.painting?.canUndo);
  }

  get canRedo() {
    return Boolean(this.painting?.canRedo);
  }

  undo(isRedo) {
    if (isRedo) this.painting.redo();
    else this.painting.undo();
    this.#changed();
  }

  choose(value) {
    if (value !== NOTHING && !this.painting?.classOf(value)) return;
    this.value = value;
    this.page.say(`Painting ${this.painting.classOf(value)?.name ?? "nothing"}.`);
    this.refresh();
  }

  /** The keys of this mode that belong to no tool; returns whether it was one. */
  key(key) {
    if (!this.painting) return false;
    if (key === "[" || key === "]") {
      this.brushM = Math.min(Math.max(this.brushM * (key === "]" ? BRUSH_STEP : 1 / BRUSH_STEP), 0.05), 4);
      this.page.say(`The brush is ${this.brushM.toFixed(2)} m wide.`);
      this.refresh();
    } else if (key === "e") this.choose(NOTHING);
    else if (/^[1-8]$/.test(key)) this.choose(this.painting.classes[Number(key) - 1]?.value ?? this.value);
    else return false;
    return true;
  }

  tool(kind) {
    return new PaintTool(kind, {
      painting: () => this.painting, value: () => this.value, radius: () => this.brushM / this.page.data().resolution_m / 2,
      isFree: (x, y) => this.#isFree(x, y), nameAt: (at) => this.nameAt(at), say: this.page.say,
      changed: (box, viewer) => {
        viewer.labels?.update(box);
        viewer.invalidate();
      },
      done: () => this.#changed(),
    });
  }

  /** What is painted at a point. */
  nameAt([x, y]) {
    const { painting } = this;
    if (!this.isOn || !painting || x < 0 || y < 0 || x >= painting.width || y >= painting.height) return "";
    return painting.classOf(painting.values[Math.floor(y) * painting.width + Math.floor(x)])?.name ?? "";
  }

  #isFree(x, y) {
    const { viewer } = this.page;
    return x >= 0 && y >= 0 && x < this.painting.width && y < this.painting.height && viewer.occupancy?.values[y * this.painting.width + x] === FREE;
  }

  /** The classes of the result, and the number of every cell's class. */
  async #resultLabels() {
    if (!this.result) {
      const answer = await this.page.call({ op: "labels", edits: this.page.edits() });
      this.result = { classes: answer.classes, values: new Uint8Array(answer.bytes[0]) };
    }
    return this.result;
  }

  async #start(isFromModel) {
    const { width, height } = this.page.data();
    const { classes, values } = await this.#resultLabels();
    const start = isFromModel || !this.painting ? withValues(classes) : this.painting.classes;
    const cells = isFromModel ? values : new Uint8Array(width * height);
    if (this.painting) this.painting.become(start, cells);
    else {
      // A copy: the result stays what it is.
      this.painting = new Painting({ width, height, values: cells.slice(), classes: start });
      keepPaintedMap(this.page.map());
    }
    if (!this.painting.classOf(this.value)) this.value = start[0].value;
    this.view = "painted";
    this.#changed();
  }

  #classes(act) {
    act();
    if (!this.painting.classOf(this.value)) this.value = this.painting.classes[0]?.value ?? NOTHING;
    this.#changed();
  }

  #changeClass(value, change) {
    const { classes } = this.painting;
    this.note = "";
    if (change.name === "" || classes.some((info) => info.value !== value && info.name === change.name)) {
      this.note = change.name ? `There is a class called ${change.name} already.` : "A class needs a name.";
      return this.refresh();
    }
    const isTaken = (color) => [NO_LABEL, IGNORED].includes(color) || classes.some((info) => info.value !== value && info.color.join() === color);
    if (change.color && isTaken(change.color.join())) {
      this.note = "Black, white and the colors of other classes mean something else in a label image: choose another color.";
      return this.refresh();
    }
    return this.#classes(() => this.painting.changeClass(value, change));
  }

  #paintPlace(id) {
    const place = this.page.data().byId.get(id);
    this.#paint((set) => polygon(place.rings, set));
  }

  #paintBox([ax, ay, bx, by]) {
    const corners = [[ax, ay], [bx, ay], [bx, by], [ax, by]].map((at) => this.page.data().toCells(at));
    this.#paint((set) => polygon([corners], set));
  }

  #paint(shape) {
    const { painting, value } = this;
    painting.begin();
    shape((x, y) => { if (this.#isFree(x, y)) painting.values[y * painting.width + x] = value; });
    const isNew = painting.end();
    this.page.say(isNew ? `Painted ${painting.classOf(value)?.name ?? "nothing"}.` : "Nothing changed.");
    this.#changed();
  }

  /** After every step: the picture, the panel, and what is kept. */
  #changed() {
    this.refresh();
    this.#keep();
  }

  async #keep() {
    this.isDirty = true;
    if (this.isKeeping) return;
    this.isKeeping = true;
    while (this.isDirty) {
      this.isDirty = false;
      if (this.painting) await keepPainting(this.hash, this.painting.toKeep());
    }
    this.isKeeping = false;
  }

  async #view(view) {
    this.view = view;
    if (view === "differences") await this.#resultLabels();
    this.refresh();
  }

  refresh() {
    const { page, painting } = this;
    if (!page.data()) return;
    page.viewer.labels = this.isOn && painting && this.view !== "result" ? this.#picture() : null;
    page.viewer.invalidate();
    if (!this.isOn) return;
    page.toolsChanged();
    this.panel.show({
      painting, value: this.value, brushM: this.brushM, cellM: page.data().resolution_m, view: this.view, others: this.others, effort: this.effort,
      model: this.model, note: this.note, places: page.data().places.filter((place) => !place.speck),
    });
  }

  /** The painted cells as a picture, or those that the result has as another class. */
  #picture() {
    const { painting, result } = this;
    let { values } = painting;
    if (this.view === "differences" && result) {
      const said = painting.numbered(result.classes);
      values = values.map((value, cell) => (value !== NOTHING && said[cell] !== result.values[cell] ? value : NOTHING));
    }
    const letters = lettersOf(painting.classes.map(({ name }) => name));
    const raster = new LetteredRaster(values, painting.width, painting.height, new Map(painting.classes.map(({ value }, k) => [value, letters[k]])));
    raster.color(palette((value) => {
      const color = painting.classOf(value)?.color;
      return color ? [...color, PAINT_ALPHA] : [0, 0, 0, 0];
    }));
    return raster;
  }

  /** The legend while something is painted: shares of the painted cells. */
  legend(host) {
    const { classes } = this.painting;
    const [counts, letters] = [this.painting.counts(), lettersOf(classes.map(({ name }) => name))];
    const info = classes.map(({ value, name, color }, k) => ({ name, css: `rgb(${color.join()})`, letter: letters[k], share: counts[value] }));
    legend(host, { places: info.map(({ name, share }) => ({ class: name, area_m2: share })), classOf: new Map(info.map((one) => [one.name, one])) }, false);
  }

  /** The request of everything that is to be learned from. */
  async #set(isAll) {
    const own = { map: this.page.map(), painting: this.painting };
    const others = isAll ? await Promise.all(this.others.filter(({ isChosen }) => isChosen).map(keptPaintedMap)) : [];
    const all = [own, ...others.filter(Boolean).map(({ map, painting }) => ({ map, painting: new Painting(painting) }))];
    const classes = joinedClasses(all.map(({ painting }) => painting));
    const maps = all.map(({ map }) => ({ names: map.files.map(({ name }) => name), resolution_m: map.resolution_m }));
    const bytes = all.flatMap(({ map, painting }) => [...map.files.map((file) => file.bytes), painting.numbered(classes).buffer]);
    return { request: { maps, classes }, bytes };
  }

  async #save(isZip) {
    try {
      const { request, bytes } = await this.#set(isZip);
      const answer = await this.page.call({ op: "training_files", ...request, has_folders: isZip }, bytes);
      const files = answer.files.map((name, k) => ({ name, bytes: answer.bytes[k] }));
      if (isZip && this.model?.report) files.push({ name: this.model.name, bytes: new Uint8Array(this.model.bytes) });
      if (isZip) download(`${this.page.map().name}.training.zip`, await zipParts(files), "application/zip");
      else for (const { name, bytes: content } of files) download(name, [content]);
      this.note = "";
    } catch (error) {
      this.note = `Nothing was saved: ${error.message}`;
    }
    this.refresh();
  }

  async #train() {
    this.note = "";
    const { map, call, work, useModel, say } = this.page;
    await work("Training on what is painted", async () => {
      const { request, bytes } = await this.#set(true);
      const { bytes: [model], ...report } = await call({ op: "train", ...request, max_cells_per_class: this.effort }, bytes);
      await useModel({ name: `${map().name.replace(/[^\p{L}\p{N} _-]/gu, "_")}.model.json`, bytes: model.buffer, report, options: this.#options(), map: map().files[0].name });
      await this.#compare();
      this.view = "result";
      say(`${this.model.name} is trained and labels the map.`);
    }, (error) => { this.note = `Nothing was learned: ${error.message}`; });
    this.refresh();
  }

  /** What the program is told besides, to train the same model. */
  #options() {
    const resolution = this.page.map().resolution_m;
    return `--max-cells-per-class ${this.effort}${resolution ? ` --resolution ${resolution}` : ""}`;
  }

  async #forget() {
    await this.page.work("Labeling with the default model", () => this.page.useModel(null));
    this.refresh();
  }

  /** How often the result says what is painted, by class. */
  async #compare() {
    const { painting } = this;
    const { classes, values } = await this.#resultLabels();
    const said = painting.numbered(classes);
    const counts = classes.map(() => new Array(classes.length + 1).fill(0));
    said.forEach((number, cell) => { if (number && values[cell]) counts[number - 1][values[cell]] += 1; });
    const sum = (list) => list.reduce((total, n) => total + n, 0);
    const [right, all] = [sum(counts.map((row, k) => row[k + 1])), sum(counts.map(sum))];
    this.model.agreement = {
      all: all ? right / all : 0,
      classes: classes.map(({ name }, k) => {
        const wrong = counts[k].map((n, other) => (other === k + 1 ? 0 : n));
        const most = wrong.indexOf(Math.max(...wrong));
        return { name, same: sum(counts[k]) ? counts[k][k + 1] / sum(counts[k]) : null, other: wrong[most] ? classes[most - 1].name : null };
      }),
    };
  }
}
