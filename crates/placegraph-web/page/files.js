// What was dropped: which of the files is the map, which belong to it, which are edits or a model.

const extension = (name) => (/\.([^.]+)$/.exec(name)?.[1] ?? "").toLowerCase();
const IMAGES = ["png", "pgm", "pnm", "pbm", "ppm", "bmp"];

/** Sorts files by what they are: `{ main, files }` for a map, `edits` for an edit file, `model`, or `error`. */
export function sorted(files) {
  const of = (...extensions) => files.filter(({ name }) => extensions.includes(extension(name)));
  const edits = of("toml")[0] ?? null;
  const model = files.find(({ name }) => name.toLowerCase().endsWith(".model.json"));
  if (model) return { model };
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

export const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)).buffer;

/** Files that came inside of the page. */
export const decoded = (files) => files.map(({ name, base64 }) => ({ name, bytes: bytesOf(base64) }));

/** What HTML would not leave as it is. */
const LEFT_OUT = [0, 0x0d, 0x3c];

/** The bytes of text with seven bits a character, or twice seven where the first are those of what is left out. */
export function bytesOfText(text) {
  const bytes = new Uint8Array(Math.floor((text.length * 14) / 8));
  let [end, bits, nBits] = [0, 0, 0];
  const push = (seven) => {
    bits = (bits << 7) | seven;
    nBits += 7;
    if (nBits < 8) return;
    nBits -= 8;
    bytes[end] = bits >>> nBits;
    end += 1;
    bits &= (1 << nBits) - 1;
  };
  for (let at = 0; at < text.length; at += 1) {
    const code = text.charCodeAt(at);
    if (code >= 0x100) push(LEFT_OUT[(code >>> 7) - 2]);
    push(code & 127);
  }
  return bytes.slice(0, end);
}
