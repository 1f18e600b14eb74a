// Workers and the module in Node.

import { readFile } from "node:fs/promises";
import { Worker } from "node:worker_threads";

/** The module, compiled. */
export const compiled = async () => WebAssembly.compile(await readFile(new URL("./pathwright_bg.wasm", import.meta.url)));

/** A worker, with the interface of a browser's. */
export function started() {
  const worker = new Worker(new URL("./node-worker.js", import.meta.url));
  worker.on("message", (data) => worker.onmessage({ data }));
  worker.on("error", (error) => worker.onerror(error));
  return worker;
}

/** Whether the process waits for a worker. */
export const awaited = (worker, yes) => (yes ? worker.ref() : worker.unref());
