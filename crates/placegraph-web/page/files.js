// What was dropped: which of the files is the map, which belong to it, which are edits or a model.

const extension = (name) => (/\.([^.]+)$/.exec(name)?.[1] ?? "").toLowerCase();
const IMAGES = ["png", "pgm", "pnm", "pbm", "ppm", "bmp"];

/** Sorts files by what they are: `{ main, files }` for a map, `edits` for an edit file, or `error`. */
export function sorted(files) {
  const of = (...extensions) => files.filter(({ name }) => extensions.includes(extension(name)));
  const edits = of("toml")[0] ?? null;
  const [yamls, images] = [of("yaml", "yml"), of(...IMAGES)];
  const others = files.filter((file) => ![...yamls, ...images, ...of("toml")].includes(file));
  if (yamls.length > 1) return { error: `${yamls.map(({ name }) => name).join(" and ")} are two maps: open one at a time.` };
  if (!yamls.length && images.length > 1) {
    return { error: `${images.map(({ name }) => name).join(" and ")} are ${images.length} images: open one, or add the map.yaml that names one.` };
  }
  const main = yamls[0] ?? images[0] ?? others[0] ?? null;
  if (!main) return edits ? { edits } : { error: "There is no file." };
  return { main, files: yamls.length ? [main, ...images, ...others] : [main], edits, isImageAlone: main === images[0] };
}

/** Width and height that a PNG or PNM header declares, or null. */
export function sizeOf(bytes) {
  const view = new DataView(bytes);
  if (bytes.byteLength >= 24 && view.getUint32(0) === 0x89504e47) return [view.getUint32(16), view.getUint32(20)];
  const head = new TextDecoder("latin1").decode(bytes.slice(0, 1024)).replace(/#[^\n]*\n/g, " ");
  const pnm = /^P[1-6]\s+(\d+)\s+(\d+)/.exec(head);
  return pnm ? [Number(pnm[1]), Number(pnm[2])] : null;
}
