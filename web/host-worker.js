// The worker that talks to print hosts. It may wait for each answer, and may ask only whom the page may ask: see policy.js.

import * as alone from "./pathwright.js";
import * as shared from "./pathwright-threads.js";
import { rest } from "./rest.js";
import { slicer } from "./slicer.js";

/** Makes a request, with the host's key and nothing of this browser's. */
function exchange(method, url, headers, body, milliseconds) {
  const request = new XMLHttpRequest();
  try {
    request.open(method, url, false);
    request.timeout = milliseconds;
    request.responseType = "arraybuffer";
    for (const [name, value] of Object.entries(headers)) request.setRequestHeader(name, value);
    request.send(body);
  } catch (error) {
    return { broken: error.name === "TimeoutError" ? `no answer within ${milliseconds / 1000} s` : "nothing comes back" };
  }
  return { status: request.status, body: new Uint8Array(request.response ?? 0) };
}

/** Memory that nobody changes is what a worker can wait for. */
const still = new Int32Array(new WebAssembly.Memory({ initial: 1, maximum: 1, shared: true }).buffer);
const pause = (milliseconds) => { Atomics.wait(still, 0, 0, milliseconds); };

const take = slicer((message, transfer) => postMessage(message, transfer), rest);
addEventListener("message", ({ data }) => {
  take(data);
  if (data.module) (data.isShared ? shared : alone).network(exchange, pause);
});
