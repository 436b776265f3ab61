// Everything that the program writes, as files or as one archive.

import { element } from "../../placegraph/assets/viewer/dom.js";
import { zipParts } from "./zip.js";

/** Hands a file to the user. */
export function download(name, parts, type = "application/octet-stream") {
  const address = URL.createObjectURL(new Blob(parts, { type }));
  element(null, "a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}

export class TakePanel {
  /** `on`: `{ files(formats) -> Promise<[{ name, bytes }]>, say(text), name() }`. */
  constructor(panel, on) {
    Object.assign(this, { on, panel, chosen: new Set() });
  }

  /** `formats`: `{ id, doc, files }`. */
  show(formats) {
    this.panel.replaceChildren();
    element(this.panel, "p", { class: "fine" }, "The result as the program writes it: topology.json, label and region images, an overview. Add what your stack reads.");
    const list = element(this.panel, "ul", { class: "formats" });
    for (const { id, doc } of formats) {
      const label = element(element(list, "li"), "label");
      element(label, "input", {
        type: "checkbox", value: id, checked: this.chosen.has(id),
        onchange: ({ target }) => (target.checked ? this.chosen.add(id) : this.chosen.delete(id)),
      });
      element(label, "b", {}, id);
      element(label, "small", {}, doc);
    }
    const actions = element(this.panel, "div", { class: "actions" });
    element(actions, "button", { type: "button", id: "save-zip", class: "primary", onclick: () => this.#save(true) }, "Save as one zip");
    element(actions, "button", { type: "button", id: "save-files", onclick: () => this.#save(false) }, "Save the files");
    this.why = element(this.panel, "p", { class: "fine", role: "status" });
  }

  async #save(isZip) {
    try {
      const { files, skipped } = await this.on.files([...this.chosen]);
      if (isZip) download(`${this.on.name()}.placegraph.zip`, await zipParts(files), "application/zip");
      else for (const { name, bytes } of files) download(name, [bytes]);
      this.why.textContent = [`${files.length} files saved.`, ...skipped.map(({ format, reason }) => `${format} is left out: ${reason}.`)].join(" ");
    } catch (error) {
      this.why.textContent = `Nothing was saved: ${error.message}`;
    }
  }
}
