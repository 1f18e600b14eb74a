// Workers and the module in Node.

import { readFile } from "node:fs/promises";
import { availableParallelism } from "node:os";
import { Worker } from "node:worker_threads";
import { MOST_THREADS } from "./caller.js";

/** As many threads as are of use. */
export const cores = () => Math.min(availableParallelism(), MOST_THREADS);

/** The module, compiled; with memory that is shared for several threads. */
export async function compiled(isShared) {
  const name = isShared ? "pathwright-threads_bg.wasm" : "pathwright_bg.wasm";
  return { module: await WebAssembly.compile(await readFile(new URL(name, import.meta.url))), isShared };
}

/** A worker, with the interface of a browser's. */
export function started() {
  const worker = new Worker(new URL("./node-worker.js", import.meta.url));
  worker.on("message", (data) => worker.onmessage({ data }));
  worker.on("error", (error) => worker.onerror(error));
  worker.unref();
  return worker;
}

/** Whether the process waits for a worker. */
export const awaited = (worker, yes) => (yes ? worker.ref() : worker.unref());
