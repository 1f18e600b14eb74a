// What is on the plate and how it is printed, and every step back: pure functions on snapshots. Nothing here knows the page.

import { angles, rotation, tidy, turned } from "./geometry.js";

/** A project without models, as the service writes it. */
export const EMPTY = Object.freeze({
  presets: {}, profiles: [], profile: "", settings: {}, models: [], pauses: [], color_changes: [], allow_floating: false, certify: false,
});

export const MODEL = Object.freeze({ role: "part", scale: [1, 1, 1], rotate_deg: [0, 0, 0], copies: 1, settings: {} });

/** A project that someone else wrote, with all its parts. */
export const complete = (project) => ({ ...EMPTY, ...project, models: (project.models ?? []).map((model) => ({ ...MODEL, ...model })) });

const replaced = (list, index, value) => list.map((old, i) => (i === index ? value : old));

/** With some fields of a model changed. */
export const withModel = (project, index, fields) => ({
  ...project, models: replaced(project.models, index, { ...project.models[index], ...fields }),
});

/** With a value of a setting, of the project or of a model; null takes it away. */
export function withSetting(project, key, value, model = null) {
  const owner = model === null ? project : project.models[model], settings = { ...owner.settings };
  if (value === null) delete settings[key];
  else settings[key] = String(value);
  return model === null ? { ...project, settings } : withModel(project, model, { settings });
}

/** With another model at the end. Either all have a position or none: without one it has everything arranged anew. */
export function withFile(project, file, fields = {}) {
  const added = { ...project, models: [...project.models, { ...MODEL, settings: {}, file, ...fields }] };
  return fields.at_mm ? added : unplaced(added);
}

/**
 * A place on the bed for a box of this size, away from other boxes (`at_mm`, `size_mm`): the one nearest to the middle, or
 * the middle itself where none is free.
 */
export function freePlace(bed, boxes, size, distance = 5) {
  const [x0, y0] = bed.origin_mm, [w, h] = bed.size_mm, middle = [x0 + w / 2, y0 + h / 2];
  const clear = (x, y) => boxes.every(({ at_mm, size_mm }) =>
    Math.abs(at_mm[0] - x) >= (size_mm[0] + size[0]) / 2 + distance || Math.abs(at_mm[1] - y) >= (size_mm[1] + size[1]) / 2 + distance);
  let best = null, least = Infinity;
  for (let x = x0 + size[0] / 2; x <= x0 + w - size[0] / 2; x += 5) {
    for (let y = y0 + size[1] / 2; y <= y0 + h - size[1] / 2; y += 5) {
      const far = Math.hypot(x - middle[0], y - middle[1]);
      if (far < least && clear(x, y)) [best, least] = [[x, y], far];
    }
  }
  return [...(best ?? middle), 0];
}

/** Without positions: everything is arranged. */
export const unplaced = (project) => ({
  ...project,
  models: project.models.map(({ at_mm: _, ...model }) => model),
});

export const isPlaced = (project) => project.models.some((model) => model.at_mm);

/**
 * With the positions that everything was last given: copies become models, quarter turns of the arrangement angles, and
 * the objects of a file models of their own where they were placed apart.
 */
export function placed(project, objects) {
  const models = project.models.flatMap((model, index) => {
    const own = model.at_mm ? [] : objects.filter((object) => object.model === index);
    if (!own.length) return [model];
    return own.map(({ at_mm, rotate_z_deg, object }) => ({
      ...model, copies: 1, at_mm: at_mm.map(round), ...(object === undefined ? {} : { object }),
      rotate_deg: rotate_z_deg ? turned(model.rotate_deg, 2, rotate_z_deg) : model.rotate_deg,
    }));
  });
  return { ...project, models };
}

const round = (mm) => Math.round(mm * 1e3) / 1e3;

/** The index after `placed` of what was placed as the entry of this number. */
export function indexAfter(project, objects, entry) {
  const wanted = objects[entry];
  let sum = 0;
  for (let i = 0; i < project.models.length; i++) {
    const own = objects.filter((object) => object.model === i);
    if (i === wanted.model) return sum + (project.models[i].at_mm ? 0 : own.indexOf(wanted));
    sum += project.models[i].at_mm ? 1 : Math.max(own.length, 1);
  }
  return sum;
}

export const withMove = (project, index, at) => withModel(project, index, { at_mm: at.map(round) });

export const withTurn = (project, index, axis, degrees) =>
  withModel(project, index, { rotate_deg: turned(project.models[index].rotate_deg, axis, degrees) });

export const withAngles = (project, index, rotate_deg) => withModel(project, index, { rotate_deg: rotate_deg.map(tidy) });

export const withScale = (project, index, scale) => withModel(project, index, { scale: scale.map((f) => Number(f.toPrecision(9))) });

/** Mirrored along an axis of the bed. */
export function withMirror(project, index, axis) {
  const model = project.models[index], scale = [...model.scale], flip = (i, k) => (i === axis) !== (k === axis);
  scale[axis] = -scale[axis];
  // Mirroring along an axis of the model instead leaves a turn to be made up for.
  const rows = rotation(model.rotate_deg).map((row, i) => row.map((v, k) => (flip(i, k) ? -v : v)));
  return withModel(project, index, { scale, rotate_deg: angles(rows) });
}

/** Without some models. */
export const without = (project, indices) => ({ ...project, models: project.models.filter((_, i) => !indices.includes(i)) });

/** One model for each of the objects of a file that came as one. */
export function split(project, index, count) {
  const { at_mm: _, ...model } = project.models[index];
  const parts = Array.from({ length: count }, (_, object) => ({ ...model, settings: { ...model.settings }, object }));
  return unplaced({ ...project, models: [...project.models.slice(0, index), ...parts, ...project.models.slice(index + 1)] });
}

/** With one more of a model, at this place where models have positions. */
export function withCopy(project, index, at) {
  const model = project.models[index];
  if (!model.at_mm) return withModel(project, index, { copies: model.copies + 1 });
  return { ...project, models: [...project.models, { ...model, settings: { ...model.settings }, at_mm: at }] };
}

/** With a stop before a layer, or without it; `kind`: `pauses` or `color_changes`. */
export function withStop(project, kind, where, on) {
  const others = project[kind].filter((old) => old !== where);
  const value = (text) => parseFloat(text) * (text.endsWith("mm") ? 1 : 1e-6);
  return { ...project, [kind]: on ? [...others, where].sort((a, b) => value(a) - value(b)) : others };
}

/** The layer (from 1) before which a stop is, of layers at these heights. */
export function layerOfStop(where, heights) {
  if (!where.endsWith("mm")) return parseInt(where, 10);
  const mm = parseFloat(where);
  for (let i = 0; i < heights.length; i++) if (heights[i] >= mm - 1e-6) return i + 1;
  return heights.length + 1;
}

/** Printer, filament or quality, from the profiles of one kind (`names`); null: none. */
export function withProfile(project, names, name) {
  const profiles = project.profiles.filter((other) => !names.includes(other));
  return { ...project, profiles: name === null ? profiles : [...profiles, name] };
}

/** A project and how it came to be: snapshots, back and forth. */
export class History {
  constructor(project = EMPTY) {
    Object.assign(this, { now: project, past: [], future: [], group: null });
  }

  /** Goes on with another project. Changes of one group, such as the steps of a drag, are taken back at once. */
  push(project, group = null) {
    if (same(project, this.now)) return false;
    if (group === null || group !== this.group) this.past.push(this.now);
    if (this.past.length > 200) this.past.shift();
    Object.assign(this, { now: project, future: [], group });
    return true;
  }

  /** The next change is a step of its own. */
  settle() {
    this.group = null;
  }

  undo() {
    return this.go(this.past, this.future);
  }

  redo() {
    return this.go(this.future, this.past);
  }

  go(from, to) {
    if (!from.length) return false;
    to.push(this.now);
    Object.assign(this, { now: from.pop(), group: null });
    return true;
  }
}

export const same = (a, b) => a === b || JSON.stringify(a) === JSON.stringify(b);
