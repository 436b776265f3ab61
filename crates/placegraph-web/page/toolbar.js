// The tools above the map, and what the chosen one is for.

import { element } from "../../placegraph/assets/viewer/dom.js";

const CHOOSE = { id: "", name: "Choose", key: "v" };

export class Toolbar {
  /** `choose(id)` is called with the tool that was clicked, or "" for none. */
  constructor(host, choose) {
    Object.assign(this, { host, choose });
    host.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      const buttons = [...host.querySelectorAll("button")];
      if (step) buttons[(buttons.indexOf(document.activeElement) + step + buttons.length) % buttons.length]?.focus();
    });
  }

  /** Offers `tools`: `{ id, name, key, hint }`. */
  show(tools) {
    this.host.replaceChildren();
    for (const { id, name, key } of [CHOOSE, ...tools]) {
      element(this.host, "button", {
        type: "button", "data-tool": id, "aria-pressed": String(!id), "aria-keyshortcuts": key.toUpperCase(), onclick: () => this.choose(id),
      }, name, element(null, "kbd", { "aria-hidden": "true" }, key.toUpperCase()));
    }
    element(this.host, "p", { class: "hint", id: "hint", role: "status" });
  }

  select(id, hint) {
    for (const button of this.host.querySelectorAll("button")) button.setAttribute("aria-pressed", String(button.dataset.tool === (id ?? "")));
    this.hint(hint);
  }

  hint(text) {
    this.host.querySelector(".hint").textContent = text;
  }
}
