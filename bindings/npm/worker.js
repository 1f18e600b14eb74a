// The worker in a browser.

import { rest } from "./rest.js";
import { slicer } from "./slicer.js";

const take = slicer((message, transfer) => postMessage(message, transfer), rest);
addEventListener("message", ({ data }) => take(data));
