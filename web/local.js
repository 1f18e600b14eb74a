// What slices where there is no service: workers of the page with the WebAssembly module, by the methods of engine.js.
//
// One worker answers what is asked about the plate, another one slices. WebAssembly hears nothing while it works: what is no
// longer wanted ends with its worker, and the next one begins with the same files.

import { EngineError, readMesh } from "./engine.js";
import { compiled, cores, started } from "./browser.js";
import { Caller } from "./caller.js";
import { Hosts } from "./hosts.js";
import { Kept } from "./kept.js";

/** Most bytes of presets: two workers hold them. */
const PRESETS_BYTES = 256 << 20;

/** An address at which the browser finds bytes for a while. */
function address(blob) {
  const url = URL.createObjectURL(blob);
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
  return url;
}

export class Engine {
  constructor() {
    // `last`: revision; `base`: revisions before those that the slicing worker counts.
    Object.assign(this, { kept: new Kept(), printHosts: new Hosts(() => this.compiled()), session: null, files: [], project: null, sides: null, plate: null, slicing: null, last: 0, base: 0, on: {} });
    navigator.serviceWorker?.register("service-worker.js").catch(() => {});
  }

  // What all plates share.

  schema = () => this.ask("schema");
  profiles = () => this.ask("profiles");
  convert = (name, text) => this.ask("convert", name, text);
  printers = (words) => this.ask("printers", words);
  printer = (name) => this.ask("printer", name);

  // Print hosts: those that were entered here.

  hostKinds = () => this.printHosts.kinds;
  hosts = async () => this.printHosts.list();
  host = (name) => this.printHosts.state(name).catch(refused);
  print = (name, wanted, gcode) => this.printHosts.print(name, wanted, gcode).catch(refused);
  addHost = (host) => this.printHosts.add(host).catch(refused);
  removeHost = async (name) => this.printHosts.remove(name);

  opened = async () => [];

  // Folders of presets: a page finds none by itself.

  presetFolders = async () => [...(await this.kept.presets()).keys()];

  /** Takes what is of presets among the files of a folder, in place of an earlier folder of that name. */
  async addPresets(files) {
    const [folder] = files[0].path.split("/"), wanted = await this.ask("presetFiles", files.map(({ path }) => path));
    const chosen = files.filter((_, i) => wanted[i]), lengths = chosen.map(({ file }) => file.size);
    const size = lengths.reduce((sum, length) => sum + length, 0);
    if (size > PRESETS_BYTES) throw new EngineError({ kind: "limit", message: `${folder} has ${size >> 20} MB of presets, and ${PRESETS_BYTES >> 20} MB are possible; open a folder in it` });
    // As one, in memory: later the files may be others, or gone.
    const bytes = new Blob([await new Blob(chosen.map(({ file }) => file)).arrayBuffer()]);
    await this.kept.setPresets(folder, { paths: chosen.map(({ path }) => path), lengths, bytes });
    const problems = await this.usePresets();
    return { folder, printers: await this.ask("printersOf", folder), problems };
  }

  async forgetPresets(folder) {
    await this.kept.setPresets(folder, null);
    await this.usePresets();
  }

  /** Gives all presets to the worker that answers; the one that slices begins anew, and has them, too. */
  async usePresets() {
    const folders = [...(await this.kept.presets()).values()];
    this.presets = async () => ({
      paths: folders.flatMap(({ paths }) => paths), lengths: folders.flatMap(({ lengths }) => lengths),
      bytes: new Uint8Array(await new Blob(folders.map(({ bytes }) => bytes)).arrayBuffer()),
    });
    this.slicing?.end(gone());
    return this.ask("presets", await this.presets());
  }

  // One plate.

  async open() {
    const module = await this.compiled();
    this.end();
    this.plate = new Caller(started, { ...module, threads: 1 }, (event, error) => event === "ended" && this.lost(error));
    const version = await this.ask("version");
    await this.ask("open");
    await this.usePresets();
    this.session = "page";
    return version;
  }

  async compiled() {
    return (this.module ??= await compiled(cores() > 1));
  }

  close() {
    this.end();
    this.session = null;
  }

  end() {
    const error = new EngineError({ kind: "cancelled", message: "something else is wanted by now" });
    const { plate, slicing } = this;
    Object.assign(this, { plate: null, slicing: null, files: [] });
    plate?.end(error);
    slicing?.end(error);
  }

  async addModel(name, blob) {
    const bytes = new Uint8Array(await blob.arrayBuffer());
    const added = await this.ask("add", name, bytes);
    this.files.push({ name, blob });
    return added;
  }

  mesh = async (file, object) => readMesh((await this.ask("mesh", file, object)).buffer);
  faces = (file, object) => this.ask("faces", file, object);
  arrange = (project) => this.ask("arrange", JSON.stringify(project));
  orient = (project, model) => this.ask("orient", JSON.stringify(project), model);

  async setProject(project) {
    this.sides = null;
    this.project = project;
    const slicer = await this.free();
    return this.revision(await slicer.call("setProject", JSON.stringify(project)).catch(refused));
  }

  async compare(a, b) {
    const slicer = await this.free();
    // Events may be quicker than the answer.
    this.sides = [this.last + 1, this.last + 2];
    const revisions = await slicer.call("setProjects", JSON.stringify(a), JSON.stringify(b)).catch(refused);
    [a, b] = revisions.map((revision) => this.revision(revision));
    return { a, b };
  }

  preview = (event) => event.packed.arrayBuffer();
  gcode = (event) => address(event.file);
  gcodeFile = async (event) => event.file;
  projectFile = async () => address(new Blob([await this.ask("projectFile", JSON.stringify(this.project))], { type: "model/3mf" }));
  profileFile = async () => address(new Blob([await this.ask("profile", JSON.stringify(this.project))], { type: "application/toml" }));

  /** As that of a service: it ends only when the plate is lost. */
  events(on) {
    this.on = on;
    on.connected?.();
    return new Promise((_, fail) => { this.fail = fail; });
  }

  // How it is done.

  ask(name, ...args) {
    return (this.plate?.call(name, ...args) ?? Promise.reject(gone())).catch(refused);
  }

  /** The worker that slices, with all files and nothing else to do. */
  async free() {
    if (this.slicing?.busy) this.slicing.end(gone());
    if (!this.slicing || this.slicing.ended) {
      this.base = this.last;
      const slicer = new Caller(started, { ...this.module, threads: cores() });
      slicer.on = (...told) => this.slicing === slicer && this.told(slicer, ...told);
      const opened = slicer.call("open").then(async () => slicer.call("presets", await this.presets()));
      this.slicing = Object.assign(slicer, { busy: false, files: 0, opened });
    }
    const slicer = this.slicing;
    slicer.busy = true;
    try {
      await slicer.opened;
      while (slicer.files < this.files.length) {
        const { name, blob } = this.files[slicer.files++];
        await slicer.call("add", name, new Uint8Array(await blob.arrayBuffer()));
      }
    } catch (error) {
      refused(error);
    }
    return slicer;
  }

  revision(own) {
    this.last = Math.max(this.last, this.base + own);
    return this.base + own;
  }

  told(slicer, event, data, bytes, file) {
    if (event === "idle") slicer.busy = false;
    if (event === "ended") return this.stopped(data);
    if (!this.on[event]) return;
    data.revision = this.revision(data.revision);
    if (bytes) data.packed = new Blob([bytes]);
    if (file) data.file = new Blob([file]);
    const side = this.sides?.indexOf(data.revision) ?? -1;
    if (side >= 0) data.side = "ab"[side];
    this.on[event](data);
  }

  /** The worker that slices came to an end by itself: the page goes on without that print. */
  stopped({ kind, message }) {
    if (kind === "cancelled") return;
    this.on.failed?.({ revision: this.last, error: { kind, message } });
  }

  /** So did the other one: everything begins anew. */
  lost(error) {
    if (error.kind === "cancelled") return;
    this.session = null;
    this.fail?.(new EngineError({ kind: error.kind, message: error.message }, 410));
  }
}

const gone = () => new EngineError({ kind: "cancelled", message: "something else is wanted by now" }, 404);

/** An error of the module as one of an engine. */
function refused(error) {
  if (error instanceof EngineError) throw error;
  const { kind = "internal", message, file, place, object, key } = error;
  throw new EngineError({ kind, message, file, place, object, key }, 422);
}
