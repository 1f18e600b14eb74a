// The preview follows the plate: walls as soon as they are there, then the whole print.

import { find } from "../view.js";

export class Follow {
  constructor(desk, engine, preview, compare) {
    Object.assign(this, { desk, engine, preview, compare, shown: null });
    desk.on("walls", (event) => this.fetch(event, false));
    desk.on("done", (event) => this.fetch(event, true));
    desk.on("state project", () => this.say());
  }

  async fetch(event, whole) {
    const { desk, engine, preview, compare } = this;
    if (compare.running) return;
    this.latest = event;
    try {
      const packed = await engine.preview(event);
      // A revision may be gone by now, and so may the wish for it.
      if (this.latest !== event || compare.running) return;
      const [x, y] = desk.resolved.bed.origin_mm, [w, h] = desk.resolved.bed.size_mm;
      desk.bedBox = [x, y, x + w, y + h];
      if (!(await preview.present([packed], [event.name ?? ""], desk.bedBox)) || this.latest !== event) return;
      this.shown = { revision: event.revision, whole };
      this.say();
    } catch (error) {
      if (!error.kind) throw error;
    }
  }

  say() {
    const { desk, preview, shown, compare } = this, { models } = desk.project;
    if (!models.length) {
      this.shown = null;
      preview.clear();
    }
    find("preview").hidden = !this.shown && !compare.running;
    if (compare.running) return;
    if (!shown) return preview.say("");
    if (desk.state === "failed") preview.say("Out of date: what is on the plate cannot be printed");
    else if (!shown.whole) preview.say("Walls; the rest follows");
    else preview.say(desk.state === "busy" || desk.revision !== shown.revision ? "Slicing the change" : "");
  }
}
