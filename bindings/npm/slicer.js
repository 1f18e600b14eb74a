// The worker's side: calls in, answers and events out. One instance of the module, one call after the other.

import * as alone from "./pathwright.js";
import * as shared from "./pathwright-threads.js";

/**
 * Gives what takes messages: first `{ module, isShared, threads }`, compiled, then calls, `{ id, name, args }`. `post(message, transfer)`
 * sends `{ id, value }` or `{ id, error }` for each, and `{ event, data, bytes }` meanwhile. It sends `{ memory, others }` if there are to
 * be several threads: so many workers more, which get the first message with `memory`, and no calls. `rest(isShared)` is what the module
 * does not hold, because prints do not call it as a rule: bytes, had while something waits for them.
 */
export function slicer(post, rest) {
  let wasm = null, session = null, presets = null, done = [];

  const told = (event, json, bytes) => {
    const data = JSON.parse(json);
    // What belongs to it can only be had when the slicing has ended.
    if (event === "done") done.push(data);
    else post({ event, data, bytes }, bytes ? [bytes.buffer] : []);
  };

  /** Slices what the plate wants; its results go with the events. */
  const run = () => {
    while (session?.step()) {
      wasm.tell_waiting();
      for (const data of done.splice(0)) {
        const bytes = session.preview(data.revision), file = session.gcode(data.revision);
        post({ event: "done", data, bytes, file }, [bytes.buffer, file.buffer]);
      }
    }
    post({ event: "idle" }, []);
  };

  const calls = {
    version: () => wasm.version(),
    schema: () => JSON.parse(wasm.schema()),
    profiles: () => JSON.parse(wasm.profiles()),
    convert: (name, text) => wasm.convert(name, text),

    slice: (files, project, layers, binary) => using(models(files), (all) => using(all.slice(project, layers), (print) => ({
      gcode: print.gcode(binary), summary: JSON.parse(print.summary()), warnings: print.warnings(),
    }))),
    compare: (files, project, strategies) => using(models(files), (all) => JSON.parse(all.compare(project, strategies))),
    reorder: (gcode, project, keepDirection, moreRetractions) => using(wasm.reorder(gcode, project, keepDirection, moreRetractions), (done) => ({
      gcode: done.gcode(), report: JSON.parse(done.report()),
    })),
    check: (gcode, project, files) => using(models(files), (all) => JSON.parse(wasm.check(gcode, project, all))),
    time: (gcode, project) => JSON.parse(wasm.time(gcode, project)),
    order: (points, starts, closed, groups, wanted) => JSON.parse(wasm.order(points, starts, closed, groups, wanted)),

    // A plate that is sliced as it changes.
    open: () => { session = new wasm.Session(); },
    presetFiles: (paths) => wasm.preset_files(paths),
    presets: ({ paths, lengths, bytes }) => {
      presets?.free();
      presets = new wasm.Presets(paths, Uint32Array.from(lengths), bytes);
      session.set_presets(presets);
      return presets.problems();
    },
    printersOf: (folder) => presets.count(folder),
    printers: (words) => JSON.parse(presets?.find(words) ?? "[]"),
    printer: (name) => JSON.parse(presets.printer(name)),
    add: (name, bytes) => JSON.parse(session.add(name, bytes)),
    mesh: (file, object) => session.mesh(file, object),
    faces: (file, object) => JSON.parse(session.faces(file, object)),
    setProject: (project) => session.set_project(project),
    setProjects: (a, b) => [...session.compare(a, b)],
    arrange: (project) => JSON.parse(session.arrange(project)),
    hostAddress: (host) => wasm.host_address(host),
    hostState: (host) => JSON.parse(wasm.host_state(host)),
    hostPrint: (host, wanted, gcode) => JSON.parse(wasm.host_print(host, wanted, gcode)),

    orient: (project, model) => JSON.parse(session.orient(project, model)),
    projectFile: (project) => session.project_file(project),
    profile: (project) => session.profile(project),
  };

  const models = (files) => {
    const all = new wasm.Models();
    for (const { name, bytes } of files) all.add(name, bytes);
    return all;
  };

  const begin = ({ module, isShared, threads, memory }) => {
    wasm = isShared ? shared : alone;
    const main = wasm.initSync(memory ? { module, memory } : { module });
    globalThis.loadPathwrightRest = () => new WebAssembly.Instance(new WebAssembly.Module(rest(isShared)), { main });
    if (memory) return wasm.help();
    wasm.listen(told);
    if (threads > 1) post({ memory: wasm.share(threads), others: threads - 1 }, []);
  };

  const call = ({ id, name, args }) => {
    const value = calls[name](...args);
    wasm.tell_waiting();
    post({ id, value }, buffers(value));
    if (name.startsWith("setProject")) run();
  };

  return (message) => {
    try {
      if (message.module) begin(message);
      else call(message);
    } catch (error) {
      post({ id: message.id, error: described(error) }, []);
    }
  };
}

/** Does something with an object of the module, and frees it. */
function using(object, work) {
  try {
    return work(object);
  } finally {
    object.free();
  }
}

/** What goes over without a copy. */
function buffers(value) {
  const parts = value instanceof Uint8Array ? [value] : Object.values(value ?? {});
  return parts.filter((part) => part instanceof Uint8Array).map((part) => part.buffer);
}

/** An error as it is posted. After one that is not the caller's the instance is of no more use. */
function described(error) {
  if (error?.kind) return error;
  const isMemory = error instanceof WebAssembly.RuntimeError || error instanceof RangeError;
  if (!isMemory) return { kind: "internal", message: `a mistake of this program: ${error.message}`, fatal: true };
  return { kind: "limit", message: "it takes more memory than there is for WebAssembly; slice fewer or simpler models, or use the program", fatal: true };
}
