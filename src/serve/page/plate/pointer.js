// What mouse, fingers and pen do on the plate.

import { add, turned } from "../geometry.js";
import { withModel, withMove, withScale } from "../project.js";
import { alongAxis, angleAt, dragFlat, handleAt, snap } from "./gizmo.js";

/** Pixels that a finger or mouse may slip during a click. */
const SLIP = 4;
/** Pixels around a handle that count as the handle. */
const REACH = { mouse: 9, pen: 12, touch: 20 };

export class Pointer {
  constructor(view) {
    Object.assign(this, { view, down: new Map(), drag: null });
    this.listen();
  }

  listen() {
    const { canvas } = this.view, place = (event) => {
      const box = canvas.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    };
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.view.zoom(Math.exp(Math.min(Math.max(event.deltaY * (event.deltaMode === 1 ? 16 : 1), -200), 200) * 0.002));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture?.(event.pointerId);
      this.down.set(event.pointerId, place(event));
      if (this.down.size === 1) this.press(place(event), event);
      else this.drag = { kind: "view" };
    });
    canvas.addEventListener("pointermove", (event) => this.move(place(event), event));
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => {
        this.down.delete(event.pointerId);
        if (!this.down.size) this.release(event, place(event));
      });
    }
    canvas.addEventListener("pointerleave", () => this.hover(null, -1));
    canvas.addEventListener("dblclick", (event) => !this.view.pick(this.view.ray(place(event))) && this.view.fit());
  }

  press(at, event) {
    const ray = this.view.ray(at), under = event.button === 0 ? this.view.pick(ray) : null;
    this.start = at;
    // A finger on the object means the object, beside it the handle that is near.
    const reach = under ? REACH.mouse : REACH[event.pointerType] ?? REACH.mouse;
    const handle = event.button === 0 && handleAt(this.view.handles ?? [], at, (point) => this.view.project(point), reach);
    const hit = handle ? null : under;
    if (handle) this.drag = this.begin(this.view.tool, handle, ray);
    else if (hit && this.view.tool !== "face" && this.view.desk.selection.has(hit.instance.index) && !event.shiftKey) {
      this.view.copy = hit.instance.copy;
      this.view.chosen = hit.instance;
      this.drag = { kind: "flat", from: hit.point, instance: hit.instance, at: hit.instance.at };
    } else this.drag = { kind: "view" };
    this.drag.hit = hit;
  }

  /** What a drag of a handle starts from. */
  begin(kind, handle, ray) {
    const { chosen, desk } = this.view, middle = add(chosen.at, [0, 0, chosen.size[2] / 2]), model = desk.project.models[chosen.index];
    const drag = { kind, handle, instance: chosen, middle, at: chosen.at, model, ray };
    if (kind === "turn") drag.angle = angleAt(ray, middle, handle.axis);
    else if (handle.axis < 3) drag.far = alongAxis(ray, middle, handle.axis);
    return drag;
  }

  move(at, event) {
    const before = this.down.get(event.pointerId);
    if (!before) return this.hoverAt(at, event);
    this.down.set(event.pointerId, at);
    const { drag } = this, moved = Math.hypot(at[0] - this.start[0], at[1] - this.start[1]);
    if (!drag || (!drag.active && moved < SLIP && this.down.size === 1)) return;
    drag.active = true;
    if (drag.kind === "view") return this.turnView(before, at, event);
    const ray = this.view.ray(at);
    if (drag.kind === "flat") this.moveBy(drag, dragFlat(ray, drag.from));
    else if (drag.kind === "move") {
      const far = alongAxis(ray, drag.middle, drag.handle.axis), by = [0, 0, 0];
      if (far === null || drag.far === null) return;
      by[drag.handle.axis] = far - drag.far;
      this.moveBy(drag, by);
    } else if (drag.kind === "turn") this.turnBy(drag, ray, at, event);
    else if (drag.kind === "scale") this.scaleBy(drag, ray, at);
  }

  turnView(before, at, event) {
    const [dx, dy] = [at[0] - before[0], at[1] - before[1]], { height } = this.view.size();
    const other = [...this.down].find(([id]) => id !== event.pointerId)?.[1];
    this.view.touched = true;
    if (other) {
      const far = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]);
      this.view.camera.drag(dx / 2, dy / 2, height);
      this.view.camera.zoom(far(before) / Math.max(far(at), 1));
    } else if (event.shiftKey || event.buttons & 6) this.view.camera.drag(dx, dy, height);
    else this.view.camera.turn(dx, dy);
    this.view.schedule();
  }

  /** Moves what is dragged; with the first step everything gets a position of its own. */
  moveBy(drag, by) {
    if (!by) return;
    const { desk } = this.view;
    if (!drag.index && drag.index !== 0) drag.index = this.view.pin(drag.instance);
    if (drag.index === null) return;
    desk.change(withMove(desk.project, drag.index, add(drag.at, by)), "move");
  }

  turnBy(drag, ray, at, event) {
    const { desk } = this.view, { axis } = drag.handle, now = angleAt(ray, drag.middle, axis);
    const by = now === null || drag.angle === null ? (at[0] - this.start[0]) * 0.5 : now - drag.angle;
    const rotate_deg = turned(drag.model.rotate_deg, axis, snap(((by % 360) + 540) % 360 - 180, event.shiftKey));
    desk.change(withModel(desk.project, drag.instance.index, { rotate_deg }), "turn");
  }

  scaleBy(drag, ray, at) {
    const { desk } = this.view, { axis } = drag.handle;
    const middle = this.view.project(drag.middle), far = (point) => Math.hypot(point[0] - middle[0], point[1] - middle[1]);
    const factor = axis === 3 ? far(at) / Math.max(far(this.start), 1) : (alongAxis(ray, drag.middle, axis) ?? 0) / (drag.far || 1);
    if (!(factor > 0.01)) return;
    // An axis of the bed is one of the model's, as far as it is turned by quarters; else the nearest one.
    const own = axis < 3 ? strongest(drag.instance.rows[axis]) : -1;
    const scale = drag.model.scale.map((f, i) => (axis === 3 || i === own ? f * rounded(factor) : f));
    desk.change(withScale(desk.project, drag.instance.index, scale), "scale");
  }

  release(event, at) {
    const { drag } = this, { desk } = this.view;
    this.drag = null;
    desk.history.settle();
    if (event.type === "pointercancel" || !drag || drag.active || event.button !== 0) return this.view.schedule();
    if (this.view.faces && this.view.chosen) {
      const face = this.view.faceAt(this.view.ray(at));
      if (face >= 0) return this.view.layOn(face);
    }
    const index = drag.hit?.instance.index;
    if (drag.handle) return;
    this.view.copy = drag.hit?.instance.copy;
    if (index === undefined) desk.select([]);
    else if (event.shiftKey || event.ctrlKey || event.metaKey) desk.select(desk.selection.has(index) ? [...desk.selection].filter((i) => i !== index) : [...desk.selection, index]);
    else desk.select([index]);
    this.view.schedule();
  }

  hoverAt(at, event) {
    if (event.pointerType === "touch") return;
    if (this.view.faces && this.view.chosen) return this.hover(null, this.view.faceAt(this.view.ray(at)));
    const handle = handleAt(this.view.handles ?? [], at, (point) => this.view.project(point), REACH.mouse);
    this.view.canvas.style.cursor = handle ? "grab" : "";
    this.hover(handle?.axis ?? null, -1);
  }

  hover(axis, face) {
    if (axis === this.view.hot && face === this.view.hotFace) return;
    [this.view.hot, this.view.hotFace] = [axis, face];
    this.view.schedule();
  }
}

const rounded = (factor) => Math.round(factor * 200) / 200;

function strongest(row) {
  const sizes = row.map(Math.abs);
  return sizes.indexOf(Math.max(...sizes));
}
