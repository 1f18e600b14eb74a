// Pauses and filament changes on the slider of layers.

import { element, find } from "../view.js";
import { layerOfStop, withStop } from "../project.js";

const KINDS = { pauses: { sign: "‖", name: "Pause", button: "pause-here" }, color_changes: { sign: "◆", name: "Filament change", button: "color-here" } };

export class Stops {
  constructor(desk, preview) {
    Object.assign(this, { desk, preview });
    for (const [kind, { button }] of Object.entries(KINDS)) find(button).addEventListener("click", () => this.toggle(kind));
    desk.on("project", () => this.draw());
    preview.onLayer = () => this.draw();
    this.draw();
  }

  /** The stops of a kind with the index of the layer that each comes before. */
  of(kind) {
    const [print] = this.preview.prints;
    return this.desk.project[kind].map((where) => ({ where, layer: layerOfStop(where, print.z) - 1 }));
  }

  toggle(kind) {
    const { desk, preview } = this, { layer } = preview.state, here = this.of(kind).find((stop) => stop.layer === layer);
    desk.change(withStop(desk.project, kind, here?.where ?? String(layer + 1), !here));
  }

  draw() {
    const { preview } = this, { layer } = preview.state, key = JSON.stringify([this.desk.project.pauses, this.desk.project.color_changes, layer, preview.layers]);
    if (key === this.drawn) return;
    this.drawn = key;
    const marks = [];
    for (const [kind, { sign, name, button }] of Object.entries(KINDS)) {
      for (const { where, layer: at } of this.of(kind)) {
        const text = `${name} before layer ${at + 1}`;
        const mark = element("button", { class: "stop", title: `${text}; a click removes it`, "aria-label": `${text}: remove`, onclick: () => this.desk.change(withStop(this.desk.project, kind, where, false)) }, sign);
        mark.style.left = `${(100 * at) / Math.max(preview.layers - 1, 1)}%`;
        marks.push(mark);
      }
      find(button).setAttribute("aria-pressed", this.of(kind).some((stop) => stop.layer === layer));
    }
    find("stops").replaceChildren(...marks);
  }
}
