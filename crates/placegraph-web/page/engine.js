// The library on its worker thread: requests go out one after another, answers come back as promises.

import { $ } from "../../placegraph/assets/viewer/dom.js";
import { bytesOfText } from "./files.js";

/** A worker with the library that the page brings. */
export function startWorker() {
  const worker = new Worker(URL.createObjectURL(new Blob([$("worker").textContent], { type: "text/javascript" })));
  worker.postMessage({ packed: bytesOfText($("library").textContent) });
  return worker;
}

/** The work was stopped by the user. */
export class Cancelled extends Error {}

export class Engine {
  /** `start`: makes a worker; `onProgress(stage, done, total)` hears where the work is. */
  constructor(start, onProgress = () => {}) {
    Object.assign(this, { start, onProgress, worker: null, waiting: new Map(), next: 0, memoryBytes: 0 });
  }

  /** Asks for `op`; `bytes` are moved to the worker. The answer has `bytes` where there are any. */
  call(request, bytes = []) {
    this.worker ??= this.#launch();
    const id = (this.next += 1);
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, request, bytes });
    });
  }

  /** Has the thread ready before it is asked. */
  wake() {
    this.worker ??= this.#launch();
  }

  /** Stops whatever runs. The next call starts on a new thread that knows nothing of the old one. */
  cancel() {
    this.#end(new Cancelled("stopped"));
  }

  #end(error) {
    this.worker?.terminate();
    this.worker = null;
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    for (const { reject } of waiting) reject(error);
  }

  #launch() {
    const worker = this.start();
    worker.onmessage = ({ data }) => {
      if (data.progress) {
        this.onProgress(...data.progress);
        return;
      }
      this.memoryBytes = data.memory ?? this.memoryBytes;
      const asked = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      if (data.fatal) {
        this.waiting.set(data.id, asked);
        this.#end(new Error(data.fatal));
      } else if (data.error) {
        asked?.reject(Object.assign(new Error(data.error.message), data.error));
      } else {
        asked?.resolve({ ...data.answer, bytes: data.bytes });
      }
    };
    worker.onerror = (event) => this.#end(new Error(event.message || "the worker failed"));
    return worker;
  }
}
