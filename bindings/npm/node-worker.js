// The worker in Node.

import { readFileSync } from "node:fs";
import { parentPort } from "node:worker_threads";
import { slicer } from "./slicer.js";

const rest = (isShared) => readFileSync(new URL(isShared ? "pathwright-threads_rest.wasm" : "pathwright_rest.wasm", import.meta.url));
const take = slicer((message, transfer) => parentPort.postMessage(message, transfer), rest);
parentPort.on("message", take);
