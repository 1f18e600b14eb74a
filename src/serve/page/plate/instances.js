// What stands on the bed: each copy of each model with the points of its parts and where they go.

import { add, apply, boxOf, linear, multiply, rotation, sub } from "../geometry.js";

/** Meshes by file and object, asked of the engine once. */
export class Meshes {
  constructor(engine, arrived) {
    Object.assign(this, { engine, arrived, known: new Map() });
  }

  /** The mesh, or null until it is there. */
  get(file, object) {
    const key = `${object} ${file}`;
    if (!this.known.has(key)) {
      this.known.set(key, null);
      this.engine.mesh(file, object).then((mesh) => {
        this.known.set(key, { ...mesh, key });
        this.arrived();
      }, () => this.known.delete(key));
    }
    return this.known.get(key);
  }
}

/** Boxes of meshes under three rows: they are asked for at every frame of a drag. */
const boxes = new WeakMap();

function boxUnder(mesh, rows) {
  const key = rows.flat().join();
  if (boxes.get(mesh)?.key !== key) boxes.set(mesh, { key, box: boxOf(mesh.vertices, rows) });
  return boxes.get(mesh).box;
}

/**
 * Everything on the plate: `index` (of the model), `copy`, `object` (of a file whose objects stand apart), `parts` with mesh
 * and shift, `rows` (what is done to points before the shift), `turn` (of the arrangement, degrees), `at` (middle and
 * bottom), `size`, `before` (how many are printed before it, where they are printed in turn), `fits`, `reason`, `role`.
 */
export function instances(desk, meshes) {
  const { project, placed, resolved } = desk, bed = resolved?.bed;
  const middle = bed ? [bed.origin_mm[0] + bed.size_mm[0] / 2, bed.origin_mm[1] + bed.size_mm[1] / 2, 0] : [0, 0, 0];
  return project.models.flatMap((model, index) => {
    const own = placed.objects.filter((object) => object.model === index), copies = new Map(own.map((object) => [object.copy, []]));
    for (const object of own) copies.get(object.copy).push(object);
    if (!copies.size) copies.set(0, [{ at_mm: middle, rotate_z_deg: 0, fits: true, unknown: true }]);
    return [...copies].flatMap(([copy, objects]) => stand(desk, meshes, model, objects).map((instance) => ({ ...instance, index, copy, role: model.role })));
  });
}

/** One copy of a model: as a whole, or each of its objects where they were placed apart. */
function stand(desk, meshes, model, objects) {
  const infos = desk.files.get(model.file)?.objects ?? [], numbers = model.object === undefined ? infos.map((_, i) => i) : [model.object];
  const found = numbers.map((number) => ({ mesh: meshes.get(model.file, number), from: infos[number]?.at_mm ?? [0, 0, 0] }));
  if (!found.length || found.some(({ mesh }) => !mesh)) return [];
  const bad = objects.find((object) => !object.fits), state = { fits: !bad, reason: bad?.reason, unknown: Boolean(objects[0].unknown), before: objects[0].before };
  const turn = model.at_mm ? 0 : objects[0].rotate_z_deg, rows = rowsOf(model, turn), whole = { ...bodyOf(found, rows), ...state, turn };
  if (model.at_mm) return [shifted(whole, model.at_mm)];
  if (found.length === 1) return [shifted(whole, objects[0].at_mm)];
  const at = unionOf(objects).at_mm, group = shifted(whole, at);
  const kept = objects.length === found.length && objects.every((object, i) => group.boxes[i].every((mm, k) => Math.abs(mm + group.by[k] - object.at_mm[k]) < 0.05));
  if (kept || state.unknown) return [group];
  return objects.filter(({ object }) => found[object]).map(({ object, at_mm, rotate_z_deg, before, fits, reason }) => {
    const rows = rowsOf(model, rotate_z_deg);
    return { ...shifted(bodyOf([found[object]], rows), at_mm), object, turn: rotate_z_deg, before, fits, reason };
  });
}

const rowsOf = (model, turn) => (turn ? multiply(rotation([0, 0, turn]), linear(model)) : linear(model));

/** Parts under three rows where their file has them: `boxes` (middle and bottom of each), and the box of all. */
function bodyOf(found, rows) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const parts = found.map(({ mesh, from }) => ({ mesh, shift: apply(rows, from), box: boxUnder(mesh, rows) }));
  const boxes = parts.map(({ shift, box }) => {
    for (let i = 0; i < 3; i++) {
      low[i] = Math.min(low[i], box.low[i] + shift[i]);
      high[i] = Math.max(high[i], box.high[i] + shift[i]);
    }
    return middleOf(add(box.low, shift), add(box.high, shift));
  });
  return { rows, parts, boxes, middle: middleOf(low, high), size: sub(high, low) };
}

const middleOf = (low, high) => [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]];

function shifted(body, at) {
  const by = sub(at, body.middle);
  return { ...body, at, by, parts: body.parts.map(({ mesh, shift }) => ({ mesh, shift: add(shift, by) })) };
}

/** The box around placed objects: middle and bottom, and size. */
export function unionOf(objects) {
  const low = [0, 1, 2].map((i) => Math.min(...objects.map((o) => o.at_mm[i] - (i < 2 ? (o.size_mm?.[i] ?? 0) / 2 : 0))));
  const high = [0, 1, 2].map((i) => Math.max(...objects.map((o) => o.at_mm[i] + (o.size_mm?.[i] ?? 0) * (i < 2 ? 0.5 : 1))));
  return { at_mm: middleOf(low, high), size_mm: sub(high, low) };
}
