// The edits beside the map: each in words with what became of it, and all of them as the file that the program replays.

import { element } from "../../placegraph/assets/viewer/dom.js";
import { LINE_TOOLS, inWords, lineEdit } from "./acts.js";

export class EditPanel {
  /** `on`: `{ remove(index), clear(), save(), edit(edit), place() }`. */
  constructor(panel, on) {
    this.on = on;
    this.empty = element(panel, "p", { class: "fine" },
      "Nothing is changed yet. Choose a place to rename it, give it another class or merge it, or draw with the tools above the map. What you do is listed here, and replayed on every later map.");
    this.list = element(panel, "ol", { class: "edits", id: "edits", "aria-label": "Edits" });
    this.actions = element(panel, "div", { class: "actions" });
    element(this.actions, "button", { type: "button", id: "save-edits", class: "primary", onclick: () => on.save() }, "Save edits.toml");
    element(this.actions, "button", { type: "button", onclick: () => on.clear() }, "Remove all");
    this.text = element(panel, "pre", { id: "edits-text", tabindex: "0", "aria-label": "The edit file" });
    this.#lineForm(panel);
  }

  /** `outcomes`: for every edit its error, or null. */
  show(edits, outcomes, text) {
    this.empty.hidden = edits.length > 0;
    for (const part of [this.list, this.actions, this.text]) part.hidden = !edits.length;
    this.list.replaceChildren();
    edits.forEach((edit, index) => {
      const why = outcomes[index]?.error;
      const item = element(this.list, "li", { class: why ? "failed" : null });
      element(item, "span", {}, inWords(edit));
      element(item, "button", { type: "button", "aria-label": `Remove edit ${index + 1}`, onclick: () => this.on.remove(index) }, "✕");
      if (why) element(item, "span", { class: "why" }, `Does not apply: ${why}`);
    });
    this.text.textContent = text;
  }

  /** Lines by their coordinates, for those who do not draw. */
  #lineForm(panel) {
    const details = element(panel, "details", { class: "card" });
    element(details, "summary", {}, "Draw by coordinates");
    const form = element(details, "form", { id: "line-form", class: "row" });
    const kind = element(form, "select", { id: "line-kind", "aria-label": "What the line is" });
    for (const { id, name } of LINE_TOOLS) element(kind, "option", { value: id }, name);
    const fields = ["from x", "from y", "to x", "to y"].map((name) =>
      element(element(form, "label", {}, `${name}, m`), "input", { type: "number", step: "any", required: true, "aria-label": `${name} in meters` }));
    element(form, "button", { id: "line-add" }, "Draw");
    const why = element(details, "p", { class: "why", id: "line-why", role: "status" });
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const [ax, ay, bx, by] = fields.map((field) => Number(field.value));
      const place = this.on.place();
      const isLost = kind.value === "move_doorway" && !place;
      why.textContent = isLost ? "Choose the doorway to move first, in the list of places." : "";
      if (isLost) return;
      this.on.edit(lineEdit(kind.value, [[ax, ay], [bx, by]], place));
    });
  }
}
