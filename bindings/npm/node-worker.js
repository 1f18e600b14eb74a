// The worker in Node.

import { parentPort } from "node:worker_threads";
import { slicer } from "./slicer.js";

const take = slicer((message, transfer) => parentPort.postMessage(message, transfer));
parentPort.on("message", take);
