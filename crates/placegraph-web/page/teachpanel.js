// The panel beside a map that is painted: classes, commands for those who do not draw, training, and its report.

import { $, count, element } from "../../placegraph/assets/viewer/dom.js";
import { lettersOf } from "../../placegraph/assets/viewer/mapdata.js";
import { MAX_CLASSES, NOTHING, ROLES } from "./painting.js";

const MAX_CLASS_NAME = 100;
export const EFFORTS = [
  { cells: 750, name: "Quick: 750 cells of a class" },
  { cells: 3000, name: "As the program: 3000 cells of a class" },
];
const VIEWS = [["painted", "What is painted"], ["result", "What the model says"], ["differences", "Where they differ"]];

const hex = (color) => `#${color.map((v) => v.toString(16).padStart(2, "0")).join("")}`;
const fromHex = (text) => [1, 3, 5].map((at) => Number.parseInt(text.slice(at, at + 2), 16));
const percent = (share, digits = 1) => `${(100 * share).toFixed(digits)} %`;

export class TeachPanel {
  /** `on`: what each control does, see `Teach`. */
  constructor(panel, on) {
    Object.assign(this, { panel, on });
  }

  /** `now`: `{ painting, value, brushM, cellM, view, others, effort, model, places, note }`. */
  show(now) {
    const focused = this.panel.contains(document.activeElement) ? document.activeElement.id : null;
    const isOpen = $("paint-commands")?.open ?? false;
    const scrolled = this.panel.parentElement.scrollTop;
    this.panel.replaceChildren();
    if (now.painting) {
      this.#classes(now);
      this.#brush(now);
      this.#views(now);
      this.#commands(now, isOpen);
      this.#train(now);
      this.#save();
    } else this.#start(now);
    if (focused) $(focused)?.focus({ preventScroll: true });
    this.panel.parentElement.scrollTop = scrolled;
  }

  #start({ model }) {
    element(this.panel, "h2", {}, "Teach it your own classes");
    element(this.panel, "p", { class: "fine" },
      "Paint what the parts of this map are: kitchen, lab, stairs. A model learns to tell them apart, here on the page, and labels this map and others.");
    this.#startButtons(this.panel, "primary");
    this.#model(model);
  }

  #startButtons(parent, first) {
    const row = element(parent, "div", { class: "actions wrap" });
    element(row, "button", { type: "button", id: "start-model", class: first, onclick: () => this.on.start(true) }, "Start from what the model says");
    element(row, "button", { type: "button", id: "start-empty", onclick: () => this.on.start(false) }, "Start from nothing");
  }

  #classes({ painting, value, cellM }) {
    const { on } = this;
    element(this.panel, "h2", { id: "classes-title" }, "Classes");
    const list = element(this.panel, "div", { class: "classes", role: "radiogroup", "aria-labelledby": "classes-title" });
    const counts = painting.counts();
    const letters = lettersOf(painting.classes.map(({ name }) => name));
    const radio = (item, own, name) => element(item, "input", {
      type: "radio", name: "paint-class", id: `paint-${own}`, checked: own === value, "aria-label": `Paint ${name}`, onchange: () => on.choose(own),
    });
    painting.classes.forEach((info, index) => {
      const item = element(list, "div");
      radio(item, info.value, info.name);
      const color = element(item, "span", { class: "color" });
      element(color, "input", {
        type: "color", id: `color-${info.value}`, value: hex(info.color), "aria-label": `Color of ${info.name}`, title: `Color; letter ${letters[index]}`,
        onchange: ({ target }) => on.changeClass(info.value, { color: fromHex(target.value) }),
      });
      element(color, "span", { "aria-hidden": "true" }, letters[index]);
      element(item, "input", {
        id: `name-${info.value}`, value: info.name, maxlength: MAX_CLASS_NAME, autocomplete: "off", "aria-label": `Name of class ${index + 1}`,
        onchange: ({ target }) => on.changeClass(info.value, { name: target.value.trim() }),
      });
      element(item, "button", { type: "button", id: `remove-${info.value}`, "aria-label": `Remove ${info.name}`, onclick: () => on.removeClass(info.value) }, "✕");
      const role = element(item, "select", {
        id: `role-${info.value}`, "aria-label": `Role of ${info.name}`, onchange: () => on.changeClass(info.value, { role: role.value }),
      });
      for (const [id, text] of ROLES) element(role, "option", { value: id, selected: id === info.role }, text);
      element(item, "span", { class: "size" }, `${(counts[info.value] * cellM * cellM).toFixed(1)} m²`);
    });
    const nothing = element(list, "div", { class: "nothing" });
    radio(nothing, NOTHING, "nothing");
    element(nothing, "label", { for: `paint-${NOTHING}` }, "Nothing: takes paint away. Cells without paint are not learned from.");
    element(this.panel, "button", { type: "button", id: "add-class", disabled: painting.classes.length >= MAX_CLASSES, onclick: () => on.addClass() }, "Add a class");
  }

  #brush({ brushM }) {
    const row = element(this.panel, "div", { class: "row" });
    const label = element(row, "label", { for: "brush-width" }, `Width of the brush: ${brushM.toFixed(2)} m`);
    element(row, "input", {
      type: "range", id: "brush-width", min: "0.05", max: "4", step: "0.05", value: String(brushM),
      oninput: ({ target }) => {
        this.on.brush(Number(target.value));
        label.textContent = `Width of the brush: ${Number(target.value).toFixed(2)} m`;
      },
    });
  }

  #views({ view }) {
    const set = element(this.panel, "fieldset", { class: "views" }, element(null, "legend", { class: "label" }, "The map shows"));
    for (const [id, name] of VIEWS) {
      const label = element(set, "label");
      element(label, "input", { type: "radio", name: "view", id: `view-${id}`, checked: id === view, onchange: () => this.on.view(id) });
      label.append(name);
    }
  }

  /** What the tools do, for those who do not draw. */
  #commands({ places }, isOpen) {
    const details = element(this.panel, "details", { class: "card", id: "paint-commands", open: isOpen });
    element(details, "summary", {}, "Paint without drawing");
    const row = element(details, "div", { class: "row" });
    element(row, "label", { for: "paint-place" }, "A place of the result");
    const choice = element(row, "div", { class: "with" });
    const select = element(choice, "select", { id: "paint-place" });
    for (const { id, name } of places) element(select, "option", { value: id }, name);
    element(choice, "button", { type: "button", id: "paint-place-go", onclick: () => this.on.paintPlace(Number(select.value)) }, "Paint it");
    const form = element(details, "form", { class: "row", id: "paint-box" });
    const fields = ["from x", "from y", "to x", "to y"].map((name) =>
      element(element(form, "label", {}, `${name}, m`), "input", { type: "number", step: "any", required: true, "aria-label": `${name} of the rectangle in meters` }));
    element(form, "button", { id: "paint-box-go" }, "Paint the rectangle");
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.on.paintBox(fields.map((field) => Number(field.value)));
    });
    const again = element(details, "div", { class: "row" });
    element(again, "span", { class: "label" }, "Start over (undo brings this back)");
    this.#startButtons(again);
  }

  #train({ others, effort, model, note }) {
    element(this.panel, "h2", {}, "Train");
    if (others.length) {
      const set = element(this.panel, "fieldset", { class: "views" }, element(null, "legend", { class: "label" }, "Learn from this map and from"));
      for (const other of others) {
        const label = element(set, "label");
        element(label, "input", { type: "checkbox", id: `other-${other.hash}`, checked: other.isChosen, onchange: ({ target }) => this.on.chooseOther(other.hash, target.checked) });
        label.append(other.name);
      }
    }
    const row = element(this.panel, "div", { class: "with" });
    const select = element(row, "select", { id: "effort", "aria-label": "Cells to learn from", onchange: () => this.on.effort(Number(select.value)) });
    for (const { cells, name } of EFFORTS) element(select, "option", { value: cells, selected: cells === effort }, name);
    element(row, "button", { type: "button", id: "train", class: "primary", onclick: () => this.on.train() }, "Train");
    element(this.panel, "p", { class: "why", id: "teach-note", role: "status" }, note);
    this.#model(model);
  }

  /** The model in use, if it is not the library's own: how right it is, and how the program makes and takes it. */
  #model(model) {
    if (!model) return;
    const card = element(this.panel, "section", { class: "card", id: "model-card", "aria-label": "The model in use" });
    element(card, "h3", {}, `Labeled by ${model.name}`);
    const { report, agreement } = model;
    if (report) {
      const { held_out: heldOut, n_examples: n } = report;
      element(card, "p", { id: "held-out" }, heldOut
        ? `On ${heldOut.n_folds} parts that were held out in turn it was right for ${percent(heldOut.accuracy)} of the cells (macro-F1 ${heldOut.macro_f1.toFixed(2)}).`
        : "No part could be held out: too little is painted to say how right it is elsewhere.");
      element(card, "p", { class: "fine" },
        `It learned from ${count(n.reduce((sum, k) => sum + k, 0), "scan")}. Held-out parts lie in the same building; another building is usually judged worse.`);
    }
    if (agreement) this.#agreement(card, agreement);
    if (report) {
      element(card, "p", { class: "fine" }, "The program trains the same model from the zip, and labels with it:");
      element(card, "pre", { tabindex: "0", "aria-label": "Commands" },
        `placegraph train training.toml ${model.options} -o ${model.name}\nplacegraph map ${model.map} --model ${model.name} --out out`);
    }
    const actions = element(card, "div", { class: "actions wrap" });
    element(actions, "button", { type: "button", id: "save-model", onclick: () => this.on.saveModel() }, "Save the model");
    element(actions, "button", { type: "button", id: "default-model", onclick: () => this.on.forgetModel() }, "Use the default model");
  }

  #agreement(card, { all, classes }) {
    element(card, "p", {}, `On this map it says the same as the paint for ${percent(all)} of the painted cells:`);
    const table = element(card, "table", { class: "figures" });
    const head = element(element(table, "thead"), "tr");
    for (const name of ["painted", "same", "mostly taken for"]) element(head, "th", { scope: "col" }, name);
    const body = element(table, "tbody");
    for (const { name, same, other } of classes) {
      const row = element(body, "tr");
      element(row, "th", { scope: "row" }, name);
      element(row, "td", {}, same === null ? "–" : percent(same, 0));
      element(row, "td", {}, other ?? "");
    }
  }

  #save() {
    const actions = element(this.panel, "div", { class: "actions wrap" });
    element(actions, "button", { type: "button", id: "save-training-zip", onclick: () => this.on.save(true) }, "Save all as one zip");
    element(actions, "button", { type: "button", id: "save-training", onclick: () => this.on.save(false) }, "Save labels.png and training.toml");
  }
}
