// The report: the viewer, the check of the map, and tables.

import { $, count, element } from "../viewer/dom.js";
import { layerControls, legend, positionText, swatch, tipFor, toggleTheme, zoomControls } from "../viewer/controls.js";
import { MapData } from "../viewer/mapdata.js";
import { valuesOf } from "../viewer/raster.js";
import { Viewer } from "../viewer/viewer.js";
import { figureColumn, table, textColumn } from "./tables.js";

const data = new MapData(JSON.parse($("data").textContent));
const viewer = new Viewer($("viewer"), { choose: (place) => place && choose(place.id), hover });
const area = (list) => list.reduce((sum, place) => sum + place.area_m2, 0);
const specks = data.places.filter((place) => place.speck);
const ofClass = (name) => data.places.filter((place) => !place.speck && place.class === name);

document.title = `${data.title} – placegraph report`;
$("title").textContent = data.title;
$("provenance").textContent = data.provenance;
$("summary").textContent = [
  ...data.classes.map(({ name }) => `${ofClass(name).length} × ${name}`),
  `${area(data.places).toFixed(1)} m² free`,
  `${data.width} × ${data.height} cells of ${data.resolution_m} m`,
].join(" · ");
$("theme").onclick = () => toggleTheme(viewer);
zoomControls($("viewer"), viewer);
legend($("legend"), data, false);

function hover(place, meters, event) {
  $("at").textContent = positionText(meters, data.frame);
  tipFor(data, place, event);
}

/** Marks a place on the map and in the table. */
function choose(id, isSought = false) {
  viewer.select(id, isSought);
  for (const row of document.querySelectorAll("tr.chosen")) row.classList.remove("chosen");
  $(`row-${id}`)?.classList.add("chosen");
}

const link = (cell, id) => element(cell, "button", {
  type: "button",
  onclick: () => {
    choose(id, true);
    viewer.host.scrollIntoView({ block: "nearest" });
  },
}, data.called(id));

const isWanted = (place) => (!place.speck || $("show-specks").checked)
  && `${place.name} ${place.class}`.toLowerCase().includes($("filter").value.trim().toLowerCase());
const fillPlaces = table($("places"), [
  figureColumn("Id", (p) => p.id, 0),
  { name: "Name", key: (p) => p.name, cell: (cell, p) => link(cell, p.id) },
  { name: "Class", key: (p) => p.class, cell: (cell, p) => { swatch(cell, data.classOf.get(p.class)); cell.append(` ${p.class}`); } },
  figureColumn("Probability", (p) => p.probability, 2),
  figureColumn("Area, m²", (p) => p.area_m2, 1),
  figureColumn("Clearance, m", (p) => p.clearance_m, 2),
  figureColumn("Width, m", (p) => p.width_m, 2),
  textColumn("Anchor, m", (p) => `${p.x.toFixed(2)}, ${p.y.toFixed(2)}`),
], data.places, isWanted);
$("filter").oninput = $("show-specks").onchange = fillPlaces;
$("specks").append(`${count(specks.length, "speck")} that nothing leads to, ${area(specks).toFixed(2)} m²`);
$("specks").hidden = !specks.length;
table($("connections"), [
  { name: "From", key: (c) => data.called(c.a), cell: (cell, c) => link(cell, c.a) },
  { name: "To", key: (c) => data.called(c.b), cell: (cell, c) => link(cell, c.b) },
  figureColumn("Contact, m", (c) => c.contact_m, 2),
  figureColumn("Route, m", (c) => c.length_m, 2),
], data.connections);

const list = $("findings").querySelector("ul");
if (data.findings.length) for (const text of data.findings) element(list, "li", {}, text);
else list.replaceWith(element(null, "p", {}, "Nothing to report."));

async function start() {
  const rasters = {};
  for (const name of ["occupancy", "probability"]) {
    const source = $(name).textContent;
    if (source) rasters[name] = await valuesOf(source, data.width, data.height);
  }
  viewer.show(data, rasters);
  viewer.fit();
  layerControls($("layers"), viewer, () => legend($("legend"), data, viewer.shown.probability));
}
// For the console, and for tests, which wait until the pictures are read.
globalThis.placegraph = { viewer, shown: start() };
