// The list of places with its search, and what can be done with the one that is chosen.

import { count, element } from "../../placegraph/assets/viewer/dom.js";
import { swatch } from "../../placegraph/assets/viewer/controls.js";
import { exclude, merge, relabel, removeDoorway, rename } from "./acts.js";

const MAX_NAME = 200;

export class PlacesPanel {
  /** `on`: `{ choose(place), edit(edit), draw(tool) }`. */
  constructor(panel, on) {
    Object.assign(this, { on, data: null, selected: null });
    this.card = element(panel, "section", { class: "card", "aria-label": "The chosen place", hidden: true });
    this.search = element(panel, "input", {
      type: "search", class: "find", id: "find", placeholder: "Find a place by name or class", "aria-label": "Find a place by name or class",
      oninput: () => this.#fill(),
    });
    this.summary = element(panel, "p", { class: "fine", id: "summary", role: "status" });
    this.list = element(panel, "ul", { class: "places", id: "places", "aria-label": "Places" });
  }

  show(data) {
    this.data = data;
    this.#fill();
    this.select(this.selected);
  }

  select(id) {
    this.selected = this.data?.byId.has(id) ? id : null;
    for (const button of this.list.querySelectorAll("button")) {
      const isThis = Number(button.dataset.id) === this.selected;
      if (isThis) {
        button.setAttribute("aria-current", "true");
        button.scrollIntoView({ block: "nearest" });
      } else button.removeAttribute("aria-current");
    }
    this.#fillCard(this.data?.byId.get(this.selected));
  }

  #fill() {
    const { data } = this;
    if (!data) return;
    const wanted = this.search.value.trim().toLowerCase();
    const order = [...data.places].sort((a, b) => Number(data.isDoorway(a)) - Number(data.isDoorway(b)) || a.id - b.id);
    const found = order.filter((p) => (!p.speck || wanted) && `${p.name} ${p.class}`.toLowerCase().includes(wanted));
    this.list.replaceChildren();
    for (const place of found) {
      const item = element(this.list, "li");
      const button = element(item, "button", {
        type: "button", "data-id": place.id, "aria-current": place.id === this.selected ? "true" : null, onclick: () => this.on.choose(place),
      });
      swatch(button, data.classOf.get(place.class));
      element(button, "span", { class: "name" }, place.name);
      const size = data.isDoorway(place) ? `${place.width_m.toFixed(2)} m` : `${place.area_m2.toFixed(1)} m²`;
      element(button, "span", { class: "size" }, element(null, "span", { class: "visually-hidden" }, `${place.class}, `), size);
    }
    const specks = data.places.filter((p) => p.speck).length;
    this.summary.textContent = wanted ? `${count(found.length, "place")} found`
      : `${count(data.places.length - specks, "place")}, ${count(data.connections.length, "connection")}${specks ? `, ${count(specks, "speck")} left out` : ""}`;
  }

  #fillCard(place) {
    this.card.hidden = !place;
    this.card.replaceChildren();
    if (!place) return;
    const { data, on } = this;
    const head = element(this.card, "h2");
    swatch(head, data.classOf.get(place.class));
    head.append(` ${place.name}`);
    const figures = element(this.card, "div", { class: "figures" });
    for (const line of data.figures(place)) element(figures, "div", {}, line);
    if (!on.edit) return;

    const name = this.#row("name", "Name");
    const input = element(name, "input", { id: "name", value: place.name, maxlength: MAX_NAME, autocomplete: "off" });
    const save = () => input.value.trim() && input.value.trim() !== place.name && on.edit(rename(place, input.value.trim()));
    input.addEventListener("keydown", (event) => event.key === "Enter" && save());
    element(name, "button", { type: "button", id: "rename", onclick: save }, "Rename");

    const kind = this.#row("class", "Class");
    const classes = element(kind, "select", { id: "class", onchange: () => on.edit(relabel(place, classes.value)) });
    for (const { name: option } of data.classes) element(classes, "option", { value: option, selected: option === place.class }, option);

    const neighbors = data.neighbors(place.id);
    const reach = new Map();
    for (const near of neighbors) {
      if (!data.isDoorway(near)) reach.set(near.id, near);
      else for (const far of data.neighbors(near.id)) if (far.id !== place.id) reach.set(far.id, far);
    }
    const others = [...(data.isDoorway(place) ? neighbors : reach.values())];
    if (others.length) {
      const row = this.#row("merge-with", "Merge with");
      const select = element(row, "select", { id: "merge-with" });
      for (const other of others) element(select, "option", { value: other.id }, other.name);
      element(row, "button", { type: "button", id: "merge", onclick: () => on.edit(merge([place, data.byId.get(Number(select.value))])) }, "Merge");
    }
    const acts = element(this.card, "div", { class: "actions" });
    if (data.isDoorway(place)) {
      element(acts, "button", { type: "button", id: "remove-doorway", onclick: () => on.edit(removeDoorway(place)) }, "Remove doorway");
      element(acts, "button", { type: "button", onclick: () => on.draw("move_doorway") }, "Move…");
    } else {
      element(acts, "button", { type: "button", onclick: () => on.draw("split") }, "Split…");
    }
    element(acts, "button", { type: "button", id: "exclude", onclick: () => on.edit(exclude(place)) }, "Not a place");
  }

  #row(id, label) {
    const row = element(this.card, "div", { class: "row" });
    element(row, "label", { for: id }, label);
    return element(row, "div", { class: "with" });
  }
}
