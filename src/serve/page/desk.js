// All that the page knows: the project and its history, the files, the selection, and what the engine has said last.

import { unionOf } from "./plate/instances.js";
import { EMPTY, History, complete, same, without } from "./project.js";

export class Desk {
  constructor() {
    Object.assign(this, {
      history: new History(), selection: new Set(), files: new Map(), listeners: new Map(), stops: null,
      // What the engine says.
      revision: 0, state: "starting", error: null, progress: null, resolved: null, placed: { objects: [], notes: [] }, done: null, before: null,
      // What the plate shows of it, see `placed` in project.js.
      stands: [],
      schema: null, profiles: [], sent: null,
    });
  }

  get project() {
    return this.history.now;
  }

  /** Calls back whenever something of this name has changed. */
  on(names, callback) {
    for (const name of names.split(" ")) this.listeners.set(name, [...(this.listeners.get(name) ?? []), callback]);
  }

  tell(name, value) {
    for (const callback of this.listeners.get(name) ?? []) callback(value);
  }

  /** Goes on with another project; `group`: see History. */
  change(project, group = null) {
    if (!this.history.push(project, group)) return;
    this.changed();
  }

  /** After any change of the project. */
  changed() {
    const { length } = this.project.models;
    this.selection = new Set([...this.selection].filter((i) => i < length));
    this.tell("project");
    this.tell("selection");
  }

  undo() {
    if (this.history.undo()) this.changed();
  }

  redo() {
    if (this.history.redo()) this.changed();
  }

  select(indices) {
    if (same([...indices], [...this.selection])) return;
    this.selection = new Set(indices);
    this.tell("selection");
  }

  /** The selected model's index, if it is one. */
  get selected() {
    return this.selection.size === 1 ? [...this.selection][0] : null;
  }

  remove(indices = [...this.selection]) {
    if (!indices.length) return;
    const moved = (i) => i - indices.filter((gone) => gone < i).length;
    const objects = this.placed.objects.filter((o) => !indices.includes(o.model)).map((o) => ({ ...o, model: moved(o.model) }));
    this.placed = { ...this.placed, objects };
    this.selection = new Set();
    this.change(without(this.project, indices));
  }

  /** Another project from a file takes the place of this one; undo brings this one back. */
  replace(project) {
    this.selection = new Set();
    this.placed = { objects: [], notes: [] };
    this.change(complete(project));
  }

  clear() {
    this.replace(EMPTY);
  }

  /** What was on the plate before the page was loaded again; there is nothing to undo. */
  restore(project) {
    this.history = new History(complete(project));
    this.changed();
  }

  // What is in a file.

  objects(model) {
    const objects = this.files.get(model.file)?.objects ?? [];
    return model.object === undefined ? objects : objects.slice(model.object, model.object + 1);
  }

  name(model) {
    const objects = this.objects(model);
    const name = objects[0]?.name;
    if (model.object === undefined) return model.file;
    return name && name !== model.file ? name : `${model.file}, object ${model.object + 1}`;
  }

  /** Why a model cannot be printed where it is. */
  trouble(index) {
    return this.placed.objects.find((o) => o.model === index && !o.fits)?.reason ?? null;
  }

  /** Where the first copy of a model is, and how large; null before that is known. */
  where(index) {
    const own = this.placed.objects.filter((o) => o.model === index), first = own.filter((o) => o.copy === own[0].copy);
    return own.length ? unionOf(first) : null;
  }

  /** Where the models of a project that has positions are, and how large. */
  boxes(project) {
    const size = (i) => this.where(i)?.size_mm ?? this.objects(project.models[i])[0]?.size_mm ?? [0, 0, 0];
    return project.models.flatMap(({ at_mm }, i) => (at_mm ? [{ at_mm, size_mm: size(i) }] : []));
  }

  // What the engine says.

  /** An event of a slicing; false if it is of an older one. */
  newer(event) {
    if (event.revision < this.revision) return false;
    if (event.revision > this.revision) {
      Object.assign(this, { revision: event.revision, error: null, progress: null });
    }
    return true;
  }

  setState(state, error = null) {
    Object.assign(this, { state, error });
    this.tell("state");
  }

  /** Whether what is shown is what will be saved. */
  get current() {
    return this.state === "done" && this.done?.revision === this.revision && this.sent === this.project;
  }
}
