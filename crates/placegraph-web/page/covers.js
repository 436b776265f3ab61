// What lies over the map while there is none, while something runs, and when something is wrong.

import { $ } from "../../placegraph/assets/viewer/dom.js";

const STAGES = {
  read: "Reading the map", classify: "Looking around from every free cell", doorways: "Finding doorways", spaces: "Telling rooms from corridors",
  smooth: "Hearing the neighbors", correct: "Joining what belongs together", topology: "Building the graph",
  features: "Looking around from the painted cells", validate: "Holding parts out, to see how right it is", boost: "Learning from all of it",
};

/** Speaks to screen readers. */
export function say(text) {
  $("status").textContent = text;
}

/** Shows one of the covers, or none. */
export function cover(id) {
  for (const other of ["empty", "busy", "failed"]) $(other).hidden = other !== id;
}

/** Covers the map while something runs that can be cancelled. */
export function coverBusy(title) {
  $("busy-what").textContent = title;
  $("stage").textContent = "";
  $("bar").removeAttribute("value");
  cover("busy");
  $("cancel").focus();
}

export function showProgress(stage, done, total) {
  $("stage").textContent = STAGES[stage] ?? stage;
  if (total) $("bar").value = done / total;
  else $("bar").removeAttribute("value");
}

/** Says what is wrong; `canReturn` where there is a map to go back to. */
export function coverFailed(title, why, canReturn) {
  $("failed-what").textContent = title;
  $("failed-why").textContent = why;
  $("back").hidden = !canReturn;
  cover("failed");
  (canReturn ? $("back") : $("again")).focus();
}

/** Takes files that are dropped anywhere on the page. */
export function listenForDrops(hasMap, open) {
  addEventListener("dragover", (event) => {
    event.preventDefault();
    document.body.classList.add("is-over");
    if (hasMap() && $("busy").hidden) cover("empty");
  });
  addEventListener("dragleave", (event) => {
    if (event.relatedTarget) return;
    document.body.classList.remove("is-over");
    if (hasMap() && !$("empty").hidden) cover(null);
  });
  addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("is-over");
    if (hasMap()) cover(null);
    if (event.dataTransfer.files.length && $("busy").hidden) open(event.dataTransfer.files);
  });
}
