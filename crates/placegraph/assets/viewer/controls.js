// What stands around every map: layers to switch, zoom, legend, the tip under the pointer, light and dark.

import { $, element, number } from "./dom.js";
import { LAYERS } from "./layers.js";

/** Check boxes for the layers. */
export function layerControls(host, viewer, onChange = () => {}) {
  host.replaceChildren();
  for (const { id, name } of LAYERS) {
    const isMissing = id === "occupancy" && !viewer.occupancy;
    const label = element(host, "label");
    element(label, "input", {
      type: "checkbox", id: `show-${id}`, checked: viewer.shown[id] && !isMissing, disabled: isMissing,
      onchange: (event) => {
        viewer.setLayer(id, event.target.checked);
        onChange();
      },
    });
    label.append(name);
  }
}

export function zoomControls(host, viewer) {
  const zoom = element(host, "div", { class: "zoom", role: "group", "aria-label": "Zoom" });
  element(zoom, "button", { type: "button", id: "zoom-in", "aria-label": "Zoom in", onclick: () => viewer.zoomBy(1.4) }, "+");
  element(zoom, "button", { type: "button", id: "zoom-out", "aria-label": "Zoom out", onclick: () => viewer.zoomBy(1 / 1.4) }, "\u2212");
  element(zoom, "button", { type: "button", id: "zoom-fit", "aria-label": "Show the whole map", onclick: () => viewer.fit() }, "\u2922");
}

/** A square with the color and the letter of a class. */
export function swatch(parent, info) {
  return element(parent, "span", { class: "swatch", "aria-hidden": "true", style: `background:${info?.css ?? "#999"}` }, info?.letter ?? "?");
}

export function legend(host, data, isProbability) {
  host.replaceChildren();
  if (isProbability) {
    const item = element(host, "span");
    element(item, "b", {}, "probability");
    item.append("0.3");
    element(item, "span", { class: "ramp" });
    item.append("1");
    return;
  }
  const total = data.places.reduce((sum, place) => sum + place.area_m2, 0) || 1;
  for (const info of data.classOf.values()) {
    const area = data.places.filter((p) => p.class === info.name).reduce((sum, p) => sum + p.area_m2, 0);
    const item = element(host, "span");
    swatch(item, info);
    element(item, "b", {}, info.name);
    item.append(`${number((100 * area) / total, 1)} %`);
  }
}

/** Shows figures of the place under the pointer. */
export function tipFor(data, place, event) {
  const tip = $("tip");
  tip.hidden = !place || !event || event.pointerType === "touch";
  if (tip.hidden) return;
  tip.replaceChildren();
  element(tip, "b", {}, place.name);
  for (const line of data.figures(place)) element(tip, "div", {}, line);
  const left = Math.min(event.clientX + 16, innerWidth - tip.offsetWidth - 8);
  const top = Math.min(event.clientY + 16, innerHeight - tip.offsetHeight - 8);
  tip.style.cssText = `left:${left}px;top:${top}px`;
}

/** Where the pointer is, in meters of the map frame. */
export const positionText = (meters, frame) => (meters ? `${meters[0].toFixed(2)}, ${meters[1].toFixed(2)} m in ${frame}` : "");

/** Switches between light and dark; the choice lasts as long as the page is open. */
export function toggleTheme(viewer) {
  const root = document.documentElement;
  const isDark = getComputedStyle(root).getPropertyValue("--is-dark").trim() === "1";
  root.dataset.theme = isDark ? "light" : "dark";
  viewer.retheme();
}
