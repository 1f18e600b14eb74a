// Unpacks previews and makes all that drawing them needs, aside, so that the page stays quick meanwhile.

import { glance, markCounts, outlineOf, roleLengths, strokeWords, unpack } from "../view.js";

addEventListener("message", ({ data: { id, buffer } }) => {
  try {
    const print = read(buffer);
    postMessage({ id, print }, [...new Set(buffers(print))]);
  } catch (error) {
    postMessage({ id, error: error.message });
  }
});

/** `PWP1`, the length of the head, the head as JSON, the strokes. */
function read(buffer) {
  const magic = String.fromCharCode(...new Uint8Array(buffer, 0, 4)), length = new DataView(buffer).getUint32(4, true);
  if (magic !== "PWP1") throw new Error("the service sends a preview that this page does not know; load the page anew");
  const info = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  const print = unpack(new Uint8Array(buffer, 8 + length), info), [x0, y0, x1, y1] = print.bounds;
  const few = glance(print, Math.hypot(x1 - x0, y1 - y0) / 300);
  few.source = Int32Array.from(few.source);
  few.words = strokeWords(few);
  print.words = strokeWords(print);
  return { ...print, few, lengths: roleLengths(print), markCounts: markCounts(print), outline: outlineOf(print) };
}

/** Everything that goes over without a copy. */
function buffers(value) {
  return Object.values(value).flatMap((part) => (ArrayBuffer.isView(part) ? [part.buffer] : part?.words ? buffers(part) : []));
}
