// The list of what is on the plate, with what is wrong with it and what mends it.

import { element, find, fixed } from "../view.js";
import { split, withScale } from "../project.js";

const ROLES = { support_enforcer: "support enforcer", support_blocker: "support blocker" };
const size = (mm) => `${mm.map((v) => fixed(v, 1)).join(" × ")} mm`;

export class ObjectList {
  constructor(desk, actions) {
    Object.assign(this, { desk, actions, root: find("objects") });
    this.list = element("ul");
    this.head = element("h2");
    this.root.append(element("div", { class: "head" }, this.head,
      element("button", { class: "icon", title: "Add models (Ctrl+O)", "aria-label": "Add models", onclick: actions.open }, "+"),
      this.clear = element("button", { title: "Take everything from the plate", onclick: () => desk.clear() }, "Clear")), this.list);
    desk.on("project placed selection", () => this.draw());
    this.draw();
  }

  draw() {
    const { desk, list } = this, { models } = desk.project, focus = list.contains(document.activeElement) ? document.activeElement.dataset.index : null;
    const count = models.reduce((sum, model) => sum + model.copies, 0);
    this.head.textContent = count === 1 ? "1 object" : `${count} objects`;
    this.clear.hidden = !count;
    find("drop").hidden = count > 0;
    list.replaceChildren(...models.flatMap((model, index) => this.item(model, index)));
    if (focus !== null) list.querySelector(`[data-index="${focus}"]`)?.focus();
  }

  item(model, index) {
    const { desk } = this, objects = desk.objects(model), trouble = desk.trouble(index), selected = desk.selection.has(index);
    const where = desk.where(index);
    const what = [ROLES[model.role], model.copies > 1 && `${model.copies} ×`, size(where?.size_mm ?? objects[0]?.size_mm ?? [0, 0, 0])].filter(Boolean).join(" ");
    const pick = element("button", {
      class: "pick", "data-index": index, "aria-pressed": String(selected), title: desk.name(model),
      onclick: (event) => desk.select(event.shiftKey || event.ctrlKey || event.metaKey
        ? selected ? [...desk.selection].filter((i) => i !== index) : [...desk.selection, index] : [index]),
    }, element("span", { class: "name" }, desk.name(model)), element("span", { class: "what" }, what));
    if (trouble) pick.append(element("span", { class: "why" }, trouble));
    const remove = element("button", { class: "remove icon", title: "Delete (Del)", "aria-label": `Delete ${desk.name(model)}`, onclick: () => desk.remove([index]) }, "✕");
    const row = element("div", { class: `object${selected ? " selected" : ""}${trouble ? " bad" : ""}` }, pick, remove);
    return [element("li", {}, row, ...this.notes(model, index, objects))];
  }

  /** Units that are probably others, several objects in one, what was repaired. */
  notes(model, index, objects) {
    const { desk } = this, notes = [], unscaled = model.scale.every((f) => Math.abs(f) === 1);
    const { hint } = objects.find((object) => object.hint) ?? {};
    if (hint && unscaled) {
      const mend = () => desk.change(withScale(desk.project, index, model.scale.map((f) => f * hint.factor)));
      notes.push(note(`Was it made in ${hint.words}?`, "", [`Scale by ${hint.factor} (from ${hint.unit})`, mend]));
    }
    if (model.object === undefined && objects.length > 1) {
      notes.push(note(`${objects.length} objects that keep their layout.`, "info", ["Split into objects", () => {
        desk.selection = new Set();
        desk.change(split(desk.project, index, objects.length));
      }]));
    }
    const repairs = objects.flatMap((object) => object.repairs ?? []), warnings = objects.flatMap((object) => object.warnings ?? []);
    if (repairs.length) notes.push(note(`Repaired: ${repairs.slice(0, 5).join("; ")}${repairs.length > 5 ? " …" : ""}.`, "info"));
    for (const warning of warnings.slice(0, 3)) notes.push(note(warning, ""));
    return notes;
  }
}

function note(text, kind, action = null) {
  return element("div", { class: `note ${kind}` }, text, ...(action ? [element("br"), element("button", { onclick: action[1] }, action[0])] : []));
}
