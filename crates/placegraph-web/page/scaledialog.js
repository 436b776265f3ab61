// Asks how large the cells of an image are.

import { $ } from "../../placegraph/assets/viewer/dom.js";
import { sizeOf } from "./files.js";

/** Meters per pixel of the image; null if the user gives up. */
export function askResolution({ name, bytes }) {
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
