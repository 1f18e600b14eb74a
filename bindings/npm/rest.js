// What the module does not hold, in a browser's worker.

/** Its bytes; the worker waits for them. */
export function rest(isShared) {
  const url = isShared ? new URL("./pathwright-threads_rest.wasm", import.meta.url) : new URL("./pathwright_rest.wasm", import.meta.url);
  const request = new XMLHttpRequest();
  request.open("GET", url, false);
  request.responseType = "arraybuffer";
  try {
    request.send();
  } catch {
    throw missing("nothing comes back");
  }
  if (!(request.status >= 200 && request.status < 300)) throw missing(`${request.status} ${request.statusText}`);
  return request.response;
}

/** The module is of no more use. */
const missing = (why) => ({ kind: "internal", message: `the rest of the WebAssembly module cannot be loaded: ${why}`, fatal: true });
