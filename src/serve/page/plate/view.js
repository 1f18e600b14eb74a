// The plate in the window: what is seen of it, and what is meant by a place there.

import { FIELD, TurnCamera, element, fixed } from "../view.js";
import { add, apply, dot, inverse, layDown, nearest, sub, times } from "../geometry.js";
import { indexAfter, isPlaced, placed, withAngles } from "../project.js";
import { PlatePainter } from "./draw.js";
import { handles } from "./gizmo.js";
import { Meshes, instances } from "./instances.js";
import { Pointer } from "./pointer.js";

export class PlateView {
  constructor(desk, engine, root) {
    Object.assign(this, { desk, engine, root, tool: "move", hot: null, hotFace: -1, faces: null, frame: 0, touched: false });
    this.meshes = new Meshes(engine, () => this.schedule());
    this.camera = new TurnCamera([0, 0, 0, 200, 200, 0]);
    this.canvas = element("canvas", { role: "application", tabindex: "0", "aria-label": "The plate. Arrow keys move the selected object; question mark lists all keys." });
    this.tags = element("div", { "aria-hidden": "true" });
    this.sizeTag = element("div", { class: "size-tag", hidden: true });
    root.prepend(this.canvas, this.tags, this.sizeTag);
    try {
      this.painter = new PlatePainter(this.canvas);
    } catch {
      root.append(element("p", { class: "hint" }, "This browser has no WebGL 2: the plate is not shown. Objects and settings work all the same."));
    }
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.painter = new PlatePainter(this.canvas);
      this.schedule();
    });
    new ResizeObserver(() => this.schedule()).observe(root);
    desk.on("project placed selection theme", () => this.schedule());
    desk.on("selection project", () => this.loadFaces());
    desk.on("resolved", ({ bed } = desk.resolved) => this.setBed(bed));
    this.pointer = new Pointer(this);
  }

  /** Another bed is seen as a whole, unless someone has chosen a view of the same one. */
  setBed(bed) {
    const key = JSON.stringify(bed);
    if (key === this.bedKey) return;
    this.bedKey = key;
    this.bed = bed;
    this.camera.outline = bed.outline.flatMap(([x, y]) => [x, y, 0, x, y, 0.25 * Math.min(bed.height_mm, Math.max(...bed.size_mm))]);
    this.touched = false;
    this.schedule();
  }

  setTool(tool) {
    this.tool = tool;
    this.hot = null;
    this.loadFaces();
    this.desk.tell("tool");
    this.schedule();
  }

  size() {
    return { width: Math.max(this.root.clientWidth, 1), height: Math.max(this.root.clientHeight, 1), ratio: Math.min(devicePixelRatio || 1, 2) };
  }

  fit() {
    this.touched = false;
    this.schedule();
  }

  zoom(factor) {
    this.touched = true;
    this.camera.zoom(factor);
    this.schedule();
  }

  schedule() {
    this.frame ||= requestAnimationFrame(() => this.render());
  }

  render() {
    this.frame = 0;
    const size = this.size(), { desk, camera } = this;
    this.instances = instances(desk, this.meshes);
    desk.stands = this.instances.map(({ index, copy, object, at, size: size_mm, turn, fits, reason }) => ({ model: index, copy, object, at_mm: at, size_mm, rotate_z_deg: turn, fits, reason }));
    if (!this.touched) camera.fit(size.width, size.height);
    this.chosen = this.instances.find((instance) => instance.index === desk.selected && (this.copy === undefined || instance.copy === this.copy))
      ?? this.instances.find((instance) => instance.index === desk.selected);
    this.handles = this.chosen && !this.faces ? handles(this.tool, this.chosen, camera.pixel(size.height)) : [];
    const scene = {
      instances: this.instances, bed: this.bed, selected: desk.selection, handles: this.handles, hot: this.pointer.drag?.handle?.axis ?? this.hot,
      faces: this.chosen && this.faces ? this.shownFaces() : null, hotFace: this.hotFace,
    };
    this.painter?.draw(scene, camera, size, document.documentElement.dataset.theme);
    this.label(size);
  }

  /** What does not fit says why, where it is; what is dragged says its size or place. */
  label(size) {
    const bad = this.instances.filter((instance) => !instance.fits && instance.reason), texts = bad.map((instance) => [instance, instance.reason, "tag"]);
    const inTurn = this.instances.filter((instance) => instance.before !== undefined);
    texts.push(...inTurn.map((instance) => [instance, String(instance.before + 1), "tag turn"]));
    this.tags.replaceChildren(...texts.slice(0, 30).map(([instance, text, kind]) => {
      const [x, y] = this.camera.project(add(instance.at, [0, 0, instance.size[2]]), size.width, size.height);
      const tag = element("div", { class: kind }, text);
      tag.style.transform = `translate(${Math.min(Math.max(x, 72), size.width - 240).toFixed(0)}px, ${Math.min(Math.max(y - 30, 48), size.height - 60).toFixed(0)}px)`;
      return tag;
    }));
    this.sizeTag.hidden = !this.chosen;
    if (this.chosen) this.sizeTag.textContent = `${this.chosen.size.map((mm) => fixed(mm, 1)).join(" × ")} mm`;
  }

  /** The ray under a place in the window, in mm. */
  ray([x, y]) {
    const { width, height } = this.size(), { eye, right, up, back } = this.camera.matrix(width, height), half = Math.tan(FIELD / 2);
    const u = ((2 * x) / width - 1) * half * (width / height), v = (1 - (2 * y) / height) * half;
    const direction = add(add(times(right, u), times(up, v)), times(back, -1));
    return { from: eye, along: times(direction, 1 / Math.hypot(...direction)) };
  }

  /** The nearest instance under a ray, and where. */
  pick(ray) {
    let best = null, least = Infinity;
    for (const instance of this.instances ?? []) {
      const back = inverse(instance.rows);
      for (const { mesh, shift } of instance.parts) {
        const own = { from: apply(back, sub(ray.from, shift)), along: apply(back, ray.along) };
        if (!throughBall(instance, ray)) continue;
        const far = nearest(own, mesh.vertices, mesh.triangles);
        if (far < least) [best, least] = [{ instance, point: add(ray.from, times(ray.along, far)) }, far];
      }
    }
    return best;
  }

  project(point) {
    const { width, height } = this.size();
    return this.camera.project(point, width, height);
  }

  /** Gives everything the position that it has on the plate; gives the instance's index then. */
  pin(instance) {
    const { desk } = this, entry = this.instances.findIndex((other) => other.index === instance.index && other.copy === instance.copy && other.object === instance.object);
    if (isPlaced(desk.project)) return instance.index;
    if (instance.unknown || entry < 0) return null;
    const index = indexAfter(desk.project, desk.stands, entry), project = placed(desk.project, desk.stands);
    // The engine says the same a moment later.
    desk.placed = { ...desk.placed, objects: entriesOf(project, desk.stands) };
    desk.change(project, "move");
    desk.select([index]);
    return index;
  }

  // Faces to lie on.

  async loadFaces() {
    const { desk } = this, index = desk.selected, model = index === null ? null : desk.project.models[index];
    if (this.tool !== "face" || !model) {
      this.faces = null;
      return this.schedule();
    }
    const key = `${model.object ?? 0} ${model.file}`;
    if (this.facesOf === key && this.faces) return;
    this.facesOf = key;
    const faces = await this.engine.faces(model.file, model.object ?? 0).catch(() => []);
    if (this.facesOf === key && this.tool === "face") this.faces = faces;
    this.hotFace = -1;
    this.schedule();
  }

  shownFaces() {
    const { rows, parts: [{ shift }] } = this.chosen;
    return this.faces.map(({ outline, normal }) => ({ normal, points: outline.map((point) => add(apply(rows, point), shift)) }));
  }

  faceAt(ray) {
    let best = -1, least = Infinity;
    this.shownFaces().forEach(({ points }, i) => {
      const flat = new Float32Array(points.flat()), triangles = points.slice(2).flatMap((_, k) => [0, k + 1, k + 2]);
      const far = nearest(ray, flat, triangles);
      if (far < least) [best, least] = [i, far];
    });
    return best;
  }

  layOn(face) {
    const { desk } = this, index = desk.selected;
    desk.change(withAngles(desk.project, index, layDown(desk.project.models[index], this.faces[face].normal)));
    this.setTool("move");
  }
}

/** What was placed, for a project in which everything has a position. */
function entriesOf(project, objects) {
  const near = (a, b) => a.every((mm, i) => Math.abs(mm - b[i]) < 0.01);
  return project.models.flatMap(({ at_mm }, model) => {
    const entry = objects.find((object) => near(object.at_mm, at_mm));
    return entry ? [{ ...entry, model, copy: 0, at_mm, rotate_z_deg: 0, object: 0 }] : [];
  });
}

/** Whether a ray comes near to an instance at all. */
function throughBall({ at, size }, ray) {
  const middle = sub(add(at, [0, 0, size[2] / 2]), ray.from), along = dot(middle, ray.along);
  return dot(middle, middle) - along * along <= dot(size, size) / 4 + 1;
}
