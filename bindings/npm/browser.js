// Workers and the module in a browser.

import { MOST_THREADS } from "./caller.js";

async function loaded(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`the WebAssembly module cannot be loaded: ${answer.status} ${answer.statusText}`);
  // While it arrives, and kept compiled by the browser, where the host says what it is.
  const isNamed = answer.headers.get("content-type")?.startsWith("application/wasm");
  return isNamed ? WebAssembly.compileStreaming(answer) : WebAssembly.compile(await answer.arrayBuffer());
}

/** As many threads as are of use: memory is shared only among workers of an isolated page, where there is room for all that it may become. */
export function cores() {
  try {
    if (globalThis.crossOriginIsolated && new WebAssembly.Memory({ initial: 1, maximum: 65536, shared: true })) return Math.min(navigator.hardwareConcurrency, MOST_THREADS);
  } catch {
    // One thread needs no more than it uses.
  }
  return 1;
}

/** The module, compiled; with memory that is shared for several threads. */
export async function compiled(isShared) {
  const module = await loaded(isShared ? new URL("./pathwright-threads_bg.wasm", import.meta.url) : new URL("./pathwright_bg.wasm", import.meta.url));
  return { module, isShared };
}

/** A worker. */
export const started = () => new Worker(new URL("./worker.js", import.meta.url), { type: "module" });

/** Whether the process waits for a worker: pages do not end by themselves. */
export const awaited = () => {};
