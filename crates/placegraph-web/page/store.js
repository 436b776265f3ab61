// What survives a reload: the files of the open map, and the edits of every map by its hash. All of it stays in the browser.

const DATABASE = "placegraph";
const TABLE = "files";
const LAST = "last";
const MAX_KEPT_BYTES = 64 << 20;

function database() {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(DATABASE, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(TABLE);
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

async function withTable(mode, act) {
  const db = await database();
  try {
    return await new Promise((resolve, reject) => {
      const transaction = db.transaction(TABLE, mode);
      const request = act(transaction.objectStore(TABLE));
      transaction.oncomplete = () => resolve(request.result);
      transaction.onerror = () => reject(transaction.error);
    });
  } finally {
    db.close();
  }
}

/** Keeps the files of the open map: `{ files: [{ name, bytes }], resolution_m, name }`. Where a browser keeps nothing, nothing is kept. */
export async function keepMap(map) {
  const size = map.files.reduce((sum, { bytes }) => sum + bytes.byteLength, 0);
  try {
    await withTable("readwrite", (table) => (size > MAX_KEPT_BYTES ? table.delete(LAST) : table.put(map, LAST)));
  } catch {
    // Without a store, a reload starts from nothing.
  }
}

export async function keptMap() {
  try {
    return (await withTable("readonly", (table) => table.get(LAST))) ?? null;
  } catch {
    return null;
  }
}

const paintingKey = (hash) => `painting:${hash}`;
const PAINTED = "painted-map:";

/** Keeps what was painted on the map with this hash, see `Painting.toKeep`. */
export async function keepPainting(hash, painting) {
  try {
    await withTable("readwrite", (table) => table.put(painting, paintingKey(hash)));
  } catch {
    // It is still on the page.
  }
}

export async function keptPainting(hash) {
  try {
    return (await withTable("readonly", (table) => table.get(paintingKey(hash)))) ?? null;
  } catch {
    return null;
  }
}

/** Keeps a map that is painted on, so that others can be trained together with it: `{ hash, name, files, resolution_m }`. */
export async function keepPaintedMap({ hash, name, files, resolution_m }) {
  const size = files.reduce((sum, { bytes }) => sum + bytes.byteLength, 0);
  if (size > MAX_KEPT_BYTES) return;
  try {
    await withTable("readwrite", (table) => table.put({ hash, name, files, resolution_m }, `${PAINTED}${hash}:${name}`));
  } catch {
    // The map can be trained on while it is open.
  }
}

/** Hashes and names of all maps that were painted on. */
export async function paintedMaps() {
  try {
    const keys = await withTable("readonly", (table) => table.getAllKeys(IDBKeyRange.bound(PAINTED, `${PAINTED}\uffff`)));
    return keys.map((key) => {
      const [, hash, name] = /^painted-map:([^:]*):(.*)$/su.exec(key);
      return { hash, name };
    });
  } catch {
    return [];
  }
}

/** A map that was painted on, and what was painted; null where either is gone. */
export async function keptPaintedMap({ hash, name }) {
  try {
    const map = await withTable("readonly", (table) => table.get(`${PAINTED}${hash}:${name}`));
    const painting = await keptPainting(hash);
    return map && painting ? { map, painting } : null;
  } catch {
    return null;
  }
}

const keyOf = (hash) => `placegraph:edits:${hash}`;

export function keepEdits(hash, history) {
  try {
    if (history.states.length > 1 || history.edits.length) localStorage.setItem(keyOf(hash), JSON.stringify(history));
    else localStorage.removeItem(keyOf(hash));
  } catch {
    // The store is full or forbidden: the edits are still on the page.
  }
}

export function keptEdits(hash) {
  try {
    return JSON.parse(localStorage.getItem(keyOf(hash)));
  } catch {
    return null;
  }
}
