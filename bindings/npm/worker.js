// The worker in a browser.

import { slicer } from "./slicer.js";

const take = slicer((message, transfer) => postMessage(message, transfer));
addEventListener("message", ({ data }) => take(data));
