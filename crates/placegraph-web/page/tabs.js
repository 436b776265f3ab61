// Tabs with panels, as the ARIA practices ask: arrow keys move between tabs, each names its panel.

import { element } from "../../placegraph/assets/viewer/dom.js";

export class Tabs {
  /** `tabs`: `{ id, name }`; `onShow(id)` is called when another is shown. */
  constructor(list, panels, tabs, onShow) {
    this.tabs = new Map();
    for (const { id, name } of tabs) {
      const button = element(list, "button", {
        type: "button", role: "tab", id: `tab-${id}`, "aria-controls": `panel-${id}`, onclick: () => this.show(id),
      }, name);
      const panel = element(panels, "div", { class: "panel", role: "tabpanel", id: `panel-${id}`, "aria-labelledby": `tab-${id}`, tabindex: "0" });
      this.tabs.set(id, { button, panel, n: element(button, "span", { class: "n" }) });
    }
    list.addEventListener("keydown", (event) => {
      const ids = [...this.tabs.keys()];
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      const next = ids[(ids.indexOf(this.shown) + step + ids.length) % ids.length];
      this.show(next);
      this.tabs.get(next).button.focus();
    });
    this.show(tabs[0].id);
    this.onShow = onShow;
  }

  panel(id) {
    return this.tabs.get(id).panel;
  }

  count(id, n) {
    this.tabs.get(id).n.textContent = n ? String(n) : "";
  }

  show(id) {
    this.shown = id;
    for (const [other, { button, panel }] of this.tabs) {
      button.setAttribute("aria-selected", String(other === id));
      button.tabIndex = other === id ? 0 : -1;
      panel.hidden = other !== id;
    }
    this.onShow?.(id);
  }
}
