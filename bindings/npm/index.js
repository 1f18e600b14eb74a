// Pathwright for Node and bundlers. Each call runs in a worker of its own; see index.d.ts.

import { awaited, compiled, cores, started } from "#platform";
import { Caller, PathwrightError } from "./caller.js";

export { PathwrightError };

/** The module for one thread, and that for several. */
const modules = { false: null, true: null };
/** A caller that has nothing to do. */
let idle = null;

async function free(threads) {
  let caller = idle;
  idle = null;
  if (caller?.ended || caller?.compiled.threads !== threads) {
    caller?.end(new PathwrightError({ message: "this worker has ended" }));
    const isShared = threads > 1;
    modules[isShared] ??= compiled(isShared).catch((error) => {
      modules[isShared] = null;
      throw error;
    });
    caller = new Caller(started, { ...(await modules[isShared]), threads });
  }
  awaited(caller.worker, true);
  return caller;
}

function rest(caller) {
  caller.on = () => {};
  awaited(caller.worker, false);
  if (caller.ended || idle) caller.end(new PathwrightError({ message: "this worker has ended" }));
  else idle = caller;
}

/** Calls a function of the module; `signal` ends it, `on` is told what happens meanwhile. */
async function call({ signal, threads = cores(), on = {} }, name, ...args) {
  signal?.throwIfAborted();
  if (!(Number.isInteger(threads) && threads > 0)) throw new PathwrightError({ kind: "usage", message: `\`threads\` is a whole number from 1 up, not ${threads}` });
  const caller = await free(Math.min(threads, cores()));
  caller.on = (event, data, bytes) => on[event]?.(data, bytes);
  const abort = () => caller.end(signal.reason);
  signal?.addEventListener("abort", abort);
  if (signal?.aborted) abort();
  try {
    return await caller.call(name, ...args);
  } finally {
    signal?.removeEventListener("abort", abort);
    rest(caller);
  }
}

/** What an option is called in a project, where it is called otherwise. */
const NAMES = { colorChanges: "color_changes", allowFloating: "allow_floating" };
const PROJECT = ["profiles", "profile", "settings", "models", "pauses", "colorChanges", "allowFloating", "certify"];
const COMMON = ["signal", "threads", "onProgress"];

/** The project that options describe, as JSON. */
function project(options, own) {
  const known = [...PROJECT, ...COMMON, ...own];
  const strange = Object.keys(options).find((key) => !known.includes(key));
  if (strange) throw new PathwrightError({ kind: "usage", message: `there is no option \`${strange}\`; there are: ${known.join(", ")}` });
  const given = PROJECT.filter((key) => options[key] !== undefined).map((key) => [NAMES[key] ?? key, options[key]]);
  const wanted = Object.fromEntries(given);
  if (wanted.settings) wanted.settings = typed(wanted.settings);
  if (wanted.models) wanted.models = wanted.models.map((model) => (model.settings ? { ...model, settings: typed(model.settings) } : model));
  return JSON.stringify(wanted);
}

/** Values as they are typed after `--set`. */
const typed = (settings) => Object.fromEntries(Object.entries(settings).map(([key, value]) => [key, typeof value === "string" ? value : JSON.stringify(value)]));

/** Files with name and bytes, from whatever holds bytes. */
async function files(models) {
  const list = Array.isArray(models) ? models : [models];
  return Promise.all(list.map(async (model, index) => {
    const { name = list.length > 1 ? `model-${index + 1}` : "model", bytes = model } = model;
    return { name, bytes: await bytesOf(bytes) };
  }));
}

async function bytesOf(data) {
  if (data instanceof Uint8Array) return data;
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  if (data instanceof Blob) return new Uint8Array(await data.arrayBuffer());
  if (typeof data === "string") return new TextEncoder().encode(data);
  throw new PathwrightError({ kind: "usage", message: "bytes are expected: a Uint8Array, an ArrayBuffer, a Blob, or a text" });
}

const progress = ({ signal, threads, onProgress }) => ({ signal, threads, on: { progress: onProgress && (({ done, of }) => onProgress(done, of)) } });

export async function slice(models, options = {}) {
  const { onLayer, binary } = options, wanted = project(options, ["onLayer", "binary"]), watched = progress(options);
  watched.on.layer = onLayer && ((about, bytes) => onLayer(layerOf(about, bytes)));
  return call(watched, "slice", await files(models), wanted, Boolean(onLayer), binary);
}

export async function* layers(models, options = {}) {
  const ready = [], ending = new AbortController(), { signal, ...others } = options;
  let wake = () => {}, end = null;
  const onLayer = (layer) => { ready.push(layer); wake(); };
  const whole = slice(models, { ...others, onLayer, signal: signal ? AbortSignal.any([signal, ending.signal]) : ending.signal });
  whole.then(() => {}, () => {}).finally(() => { end = true; wake(); });
  try {
    for (;;) {
      while (ready.length) yield ready.shift();
      if (end) return await whole;
      await new Promise((done) => { wake = done; });
    }
  } finally {
    ending.abort();
  }
}

export async function compare(models, options = {}) {
  const { strategies = ["nearest", "greedy", "christofides-open", "optimized"] } = options;
  return call(progress(options), "compare", await files(models), project(options, ["strategies"]), strategies);
}

export async function reorder(gcode, options = {}) {
  const { keepDirection = false, moreRetractions = false } = options, wanted = project(options, ["keepDirection", "moreRetractions"]);
  return call(progress(options), "reorder", await bytesOf(gcode), wanted, keepDirection, moreRetractions);
}

export async function check(gcode, options = {}) {
  const { against = [], ...others } = options;
  return call(progress(options), "check", await bytesOf(gcode), project(others, []), await files(against));
}

export const time = async (gcode, options = {}) => call(progress(options), "time", await bytesOf(gcode), project(options, []));

export async function order(polylines, { closed = false, groups = [], signal, threads, ...wanted } = {}) {
  const starts = [0];
  for (const line of polylines) starts.push(starts.at(-1) + line.length);
  const isClosed = (index) => Number(Array.isArray(closed) ? closed[index] : closed);
  return call({ signal, threads }, "order", Float64Array.from(polylines.flat(2)), Uint32Array.from(starts),
    Uint8Array.from(polylines, (_, index) => isClosed(index)), Uint32Array.from(polylines, (_, index) => groups[index] ?? 0), JSON.stringify(wanted));
}

export const schema = () => call({}, "schema");
export const profiles = () => call({}, "profiles");
export const convert = (name, text) => call({}, "convert", name, text);
export const version = () => call({}, "version");

/** A layer as it is handed on: its paths, each a view of the same numbers. */
function layerOf({ index, z_mm, height_mm, roles, vertices }, bytes) {
  const all = new Float64Array(bytes.buffer);
  const part = (first, perVertex) => (from, to) => all.subarray(first * vertices + perVertex * from, first * vertices + perVertex * to);
  const [points, widths, speeds, times] = [part(0, 3), part(3, 1), part(4, 1), part(5, 1)], starts = all.subarray(6 * vertices);
  const paths = roles.map((role, i) => {
    const [from, to] = [starts[i], starts[i + 1]];
    return { role, points: points(from, to), widths: widths(from, to), speeds: speeds(from, to), times: times(from, to) };
  });
  return { index, z: z_mm, height: height_mm, paths };
}
