// Workers and the module in a browser.

/** The module, compiled. */
export async function compiled() {
  const answer = await fetch(new URL("./pathwright_bg.wasm", import.meta.url));
  if (!answer.ok) throw new Error(`the WebAssembly module cannot be loaded: ${answer.status} ${answer.statusText}`);
  // While it arrives, and kept compiled by the browser, where the host says what it is.
  const isNamed = answer.headers.get("content-type")?.startsWith("application/wasm");
  return isNamed ? WebAssembly.compileStreaming(answer) : WebAssembly.compile(await answer.arrayBuffer());
}

/** A worker. */
export const started = () => new Worker(new URL("./worker.js", import.meta.url), { type: "module" });

/** Whether the process waits for a worker: pages do not end by themselves. */
export const awaited = () => {};
