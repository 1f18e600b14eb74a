// Where the selected object is, how it is turned and how large it is, as numbers; and what can be done with it.

import { element, find } from "../view.js";
import { turned } from "../geometry.js";
import { freePlace, isPlaced, placed, unplaced, withAngles, withCopy, withMirror, withModel, withMove, withScale } from "../project.js";
import { attempt } from "./notices.js";

const AXES = ["X", "Y", "Z"];
const UNITS = { mm: 1, "%": null, in: 25.4 };
const number = (value, digits) => String(Number(value.toFixed(digits)));

export class Transform {
  constructor(desk, engine, plate) {
    Object.assign(this, { desk, engine, plate, root: find("transform"), unit: "mm", locked: true });
    this.title = element("h2");
    this.place = this.triple("Position", (i, v) => this.move(i, v), "mm");
    this.angle = this.triple("Angle", (i, v) => this.turn(i, v), "degrees");
    this.size = this.triple("Size", (i, v) => this.scale(i, v), "");
    const heads = element("div", { class: "triple heads", "aria-hidden": "true" }, element("span"), ...AXES.map((axis) => element("span", { class: `axis-${axis.toLowerCase()}` }, axis)));
    this.units = element("select", { "aria-label": "Unit of the size", onchange: (event) => { this.unit = event.target.value; this.draw(); } },
      ...Object.keys(UNITS).map((unit) => element("option", {}, unit)));
    this.lock = element("input", { type: "checkbox", onchange: (event) => { this.locked = event.target.checked; } });
    this.lock.checked = true;
    const act = (name, title, action) => element("button", { title, onclick: action }, name);
    const turn = (axis, by) => act(`${AXES[axis]} ${by > 0 ? "+" : "−"}90°`, `Turn about ${AXES[axis]}`, () => this.each((project, i) => withAngles(project, i, turned(project.models[i].rotate_deg, axis, by))));
    this.copies = element("input", { type: "number", min: 1, max: 500, step: 1, "aria-label": "Copies", onchange: (event) => this.setCopies(event.target) });
    this.role = element("select", { "aria-label": "What the object is for", onchange: ({ target }) => this.setRole(target.value) },
      ...[["part", "Printed part"], ["support_enforcer", "Support enforcer"], ["support_blocker", "Support blocker"]].map(([value, text]) => element("option", { value }, text)));
    this.one = [heads, this.place.root, this.angle.root, this.size.root,
      element("div", { class: "line" }, element("label", {}, "in", this.units), element("label", {}, this.lock, "all axes alike"))];
    this.root.append(element("div", { class: "head" }, this.title), ...this.one,
      element("div", { class: "buttons" }, turn(0, 90), turn(1, 90), turn(2, 90)),
      element("div", { class: "buttons" }, ...[0, 1, 2].map((axis) => act(`Mirror ${AXES[axis]}`, `Mirror along ${AXES[axis]}`, () => this.each((project, i) => withMirror(project, i, axis))))),
      element("div", { class: "buttons" }, act("Lay flat", "Choose a face to lie on the bed (F)", () => plate.setTool("face")), act("Orient", "Turn it to stand stably with the least support (O)", () => this.orient()),
        act("Reset", "Undo turning and scaling of this object", () => this.each((project, i) => withModel(project, i, { scale: [1, 1, 1], rotate_deg: [0, 0, 0] })))),
      element("div", { class: "buttons" }, act("Copy", "One more of it (Ctrl+D)", () => this.copy()), act("Centre", "To the middle of the bed", () => this.centre()), act("Delete", "Take it from the plate (Del)", () => desk.remove())),
      element("div", { class: "line last" }, element("label", {}, "Copies", this.copies)), element("div", { class: "line last" }, "Use as", this.role));
    desk.on("project selection placed", () => this.draw());
  }

  triple(name, change, unit) {
    const inputs = AXES.map((axis, i) => element("input", {
      type: "text", inputmode: "decimal", "aria-label": `${name} ${axis}${unit ? `, ${unit}` : ""}`,
      oninput: ({ target }) => { target.dataset.typing = "yes"; },
      onblur: ({ target }) => { delete target.dataset.typing; },
      onchange: ({ target }) => {
        delete target.dataset.typing;
        const value = Number(target.value.trim().replace(",", ".").replace("−", "-"));
        if (target.value.trim() !== "" && Number.isFinite(value)) change(i, value);
        this.draw();
      },
    }));
    return { inputs, root: element("div", { class: "triple", role: "group", "aria-label": name }, element("span", {}, name), ...inputs) };
  }

  draw() {
    const { desk } = this, count = desk.selection.size, index = desk.selected, model = desk.project.models[index];
    this.root.hidden = count === 0;
    for (const node of this.one) node.hidden = count !== 1;
    if (!count) return;
    this.title.textContent = count > 1 ? `${count} objects selected` : desk.name(model);
    const first = desk.project.models[[...desk.selection][0]];
    this.role.value = first.role;
    this.copies.value = first.copies;
    this.copies.disabled = isPlaced(desk.project);
    if (count > 1) return;
    const at = model.at_mm ?? desk.where(index)?.at_mm ?? [0, 0, 0];
    show(this.place.inputs, at.map((v) => number(v, 2)));
    show(this.angle.inputs, model.rotate_deg.map((v) => number(v, 2)));
    const size = this.natural(model);
    show(this.size.inputs, model.scale.map((f, i) => (this.unit === "%" ? number(100 * f, 2) : number((Math.abs(f) * size[i]) / UNITS[this.unit], this.unit === "in" ? 3 : 2))));
  }

  /** Size along the model's own axes, unscaled, mm. */
  natural(model) {
    const objects = this.desk.objects(model), low = [0, 1].map((k) => Math.min(...objects.map((o) => (o.at_mm?.[k] ?? 0) - o.size_mm[k] / 2)));
    if (objects.length === 1) return objects[0].size_mm;
    const high = [0, 1].map((k) => Math.max(...objects.map((o) => (o.at_mm?.[k] ?? 0) + o.size_mm[k] / 2)));
    const top = Math.max(...objects.map((o) => (o.at_mm?.[2] ?? 0) + o.size_mm[2])) - Math.min(...objects.map((o) => o.at_mm?.[2] ?? 0));
    return [high[0] - low[0], high[1] - low[1], top];
  }

  /** Changes every selected object as one step. */
  each(change) {
    const { desk } = this;
    desk.change([...desk.selection].reduce((project, i) => change(project, i), desk.project));
  }

  move(axis, value) {
    const { plate, desk } = this, index = plate.chosen ? plate.pin(plate.chosen) : null;
    desk.history.settle();
    if (index === null) return;
    const at = [...desk.project.models[index].at_mm];
    at[axis] = value;
    desk.change(withMove(desk.project, index, at));
  }

  turn(axis, value) {
    const { desk } = this, angles = [...desk.project.models[desk.selected].rotate_deg];
    angles[axis] = value;
    desk.change(withAngles(desk.project, desk.selected, angles));
  }

  scale(axis, value) {
    const { desk } = this, model = desk.project.models[desk.selected], own = this.natural(model)[axis] || 1;
    const wanted = this.unit === "%" ? value / 100 : (value * UNITS[this.unit] * Math.sign(model.scale[axis])) / own;
    if (!wanted) return;
    const factor = wanted / model.scale[axis];
    const scale = model.scale.map((f, i) => (this.locked ? f * Math.abs(factor) * (i === axis ? Math.sign(factor) : 1) : i === axis ? wanted : f));
    desk.change(withScale(desk.project, desk.selected, scale));
  }

  /** What is no part of the print stays where it is, and so does the rest. */
  setRole(role) {
    const { desk } = this, before = isPlaced(desk.project) || role === "part" ? desk.project : placed(desk.project, desk.stands);
    if (before.models.length !== desk.project.models.length) return this.draw();
    desk.change([...desk.selection].reduce((project, i) => withModel(project, i, { role }), before));
  }

  setCopies(input) {
    const copies = Math.min(Math.max(Math.round(Number(input.value)) || 1, 1), 500);
    this.each((project, i) => withModel(project, i, { copies }));
    this.draw();
  }

  copy() {
    const { desk } = this, bed = desk.resolved?.bed;
    const size = (i) => desk.where(i)?.size_mm ?? [20, 20, 20];
    if (bed) this.each((project, i) => withCopy(project, i, freePlace(bed, desk.boxes(project), size(i))));
  }

  centre() {
    const { desk, plate } = this, bed = desk.resolved?.bed;
    if (!bed || !plate.chosen) return;
    if (desk.project.models.length === 1 && desk.project.models[0].copies === 1) return desk.change(unplaced(desk.project));
    const index = plate.pin(plate.chosen);
    desk.history.settle();
    if (index === null) return;
    const at = [0, 1].map((i) => bed.origin_mm[i] + bed.size_mm[i] / 2);
    desk.change(withMove(desk.project, index, [...at, desk.project.models[index].at_mm[2]]));
  }

  async orient() {
    const { desk, engine } = this;
    for (const index of [...desk.selection]) {
      const answer = await attempt(() => engine.orient(desk.project, index));
      const model = answer?.models?.[index];
      if (model) desk.change(withModel(desk.project, index, { rotate_deg: model.rotate_deg }));
    }
  }
}

function show(inputs, values) {
  inputs.forEach((input, i) => {
    if (!input.dataset.typing) input.value = values[i];
  });
}
