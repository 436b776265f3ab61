// The thread that the library runs on. A message is a request, JSON and byte strings; so is the answer.

const TELL_EVERY_MS = 40;

let instance = null;
let told = 0;

async function start(packed) {
  const bytes = unpacked(packed);
  const progress = (at, length, done, total) => {
    const now = performance.now();
    if (done && done < total && now - told < TELL_EVERY_MS) return;
    told = now;
    const stage = new TextDecoder().decode(new Uint8Array(instance.memory.buffer, at, length));
    postMessage({ progress: [stage, done, total] });
  };
  instance = (await WebAssembly.instantiate(bytes, { page: { progress } })).instance.exports;
}

/** Length of the JSON, the JSON with the sizes of all byte strings, the byte strings. */
function send(request, blobs) {
  const json = new TextEncoder().encode(JSON.stringify({ ...request, sizes: blobs.map((blob) => blob.byteLength) }));
  const total = 4 + json.length + blobs.reduce((sum, blob) => sum + blob.byteLength, 0);
  const at = instance.input(total);
  if (!at) throw new Error("the browser gives no more memory");
  const memory = new Uint8Array(instance.memory.buffer, at, total);
  new DataView(memory.buffer, at).setUint32(0, json.length, true);
  memory.set(json, 4);
  let end = 4 + json.length;
  for (const blob of blobs) {
    memory.set(new Uint8Array(blob), end);
    end += blob.byteLength;
  }
}

function receive() {
  const at = instance.output();
  const memory = new Uint8Array(instance.memory.buffer, at, instance.output_len());
  const length = new DataView(memory.buffer, at).getUint32(0, true);
  const answer = JSON.parse(new TextDecoder().decode(memory.subarray(4, 4 + length)));
  let end = 4 + length;
  const bytes = (answer.sizes ?? []).map((size) => memory.slice(end, (end += size)));
  return { answer, bytes };
}

const ready = new Promise((resolve, reject) => {
  onmessage = ({ data }) => {
    onmessage = (event) => ready.then(
      () => run(event.data),
      (error) => postMessage({ id: event.data.id, fatal: `the library cannot be started in this browser: ${error.message}` }),
    );
    start(data.packed).then(resolve, reject);
  };
});

function run({ id, request, bytes }) {
  try {
    send(request, bytes);
    instance.call();
    const { answer, bytes: blobs } = receive();
    if (answer.error) postMessage({ id, error: answer.error });
    else postMessage({ id, answer, bytes: blobs, memory: instance.memory.buffer.byteLength }, blobs.map((blob) => blob.buffer));
  } catch (error) {
    const words = error instanceof RangeError ? "the browser gives no more memory" : panicText() || String(error.message ?? error);
    postMessage({ id, fatal: words });
  }
}

/** What the library wrote before it stopped, if it did. */
function panicText() {
  try {
    return receive().answer.panic ?? "";
  } catch {
    return "";
  }
}
