// The preview: the parts of the page that `pathwright view` writes, shown anew whenever something was sliced.

import { App, GlPainter, PALETTE, Pane, find } from "../view.js";

const NOTHING = {
  name: "", notes: [], strokes: 0, marks: 0, layers: 1, bounds: [0, 0, 100, 100], total: { total_s: 0, filament_mm: 0, print_mm: 0, travel_mm: 0, total_mm: 0, travels: 0, retractions: 0, link_mm: 0 }, filament_g: 0,
  points: new Float32Array(3), role: new Uint8Array(0), bead: new Uint16Array(0), section: new Float32Array(0), speed: new Float32Array(0),
  markPoints: new Float32Array(0), markKind: new Uint8Array(0), markStroke: new Uint32Array(0), first: new Uint32Array(2), firstMark: new Uint32Array(2),
  ...Object.fromEntries(["z", "time", "print", "travel", "link", "volume", "bound"].map((key) => [key, new Float64Array(1)])), travels: new Uint32Array(1), retractions: new Uint32Array(1),
  outline: [0, 0, 0, 100, 100, 50],
};

/** Unpacks in a worker. */
class Unpacker {
  constructor() {
    this.waiting = new Map();
    this.worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    this.worker.addEventListener("message", ({ data: { id, print, error } }) => {
      const [done, failed] = this.waiting.get(id);
      this.waiting.delete(id);
      error ? failed(new Error(error)) : done(print);
    });
  }

  unpack(buffer) {
    const id = (this.last = (this.last ?? 0) + 1);
    return new Promise((done, failed) => {
      this.waiting.set(id, [done, failed]);
      this.worker.postMessage({ id, buffer }, [buffer]);
    });
  }
}

const breath = () => new Promise((done) => setTimeout(done, 0));

export class Preview extends App {
  constructor() {
    super(PALETTE, [NOTHING]);
    this.unpacker = new Unpacker();
    this.pool = [...this.panes];
    this.empty = true;
    find("table").replaceChildren();
  }

  /** As `App`, without the address line. */
  begin() {
    this.state.theme = document.documentElement.dataset.theme;
    this.state.mode = "3d";
    this.setMode("3d");
    this.colored();
  }

  setTheme(theme) {
    this.state.theme = theme;
    this.legend.draw();
    this.resized();
  }

  /** As a small window it shows a glance. */
  look() {
    return { ...super.look(), glance: document.body.dataset.view === "plate" };
  }

  get atTop() {
    return this.state.layer >= this.layers - 1;
  }

  /** Shows packed prints once all is at hand; those asked for later win. `bed`: box of the bed. Gives whether it did. */
  async present(packed, names, bed) {
    const asked = (this.asked = {}), prints = await Promise.all(packed.map((buffer) => this.unpacker.unpack(buffer)));
    prints.forEach((print, i) => Object.assign(print, { bed, name: names[i] ?? print.name }));
    if (this.asked !== asked) return false;
    while (this.pool.length < prints.length) this.pool.push(new Pane(this, NOTHING));
    const prepared = [];
    for (const [i, print] of prints.entries()) {
      const { painter } = this.pool[i];
      prepared.push(painter instanceof GlPainter ? await this.prepare(painter, print, asked) : null);
      if (this.asked !== asked) return false;
    }
    this.take(prints, prepared);
    return true;
  }

  async prepare(painter, print, asked) {
    const steps = painter.prepare(print);
    for (;;) {
      const { done, value } = steps.next();
      if (done) return value;
      await breath();
      // Somebody else's strokes are the next ones; what is on the card is freed with the arrays.
      if (this.asked !== asked) return null;
    }
  }

  take(prints, prepared) {
    const top = this.atTop || this.empty, { layer } = this.state;
    if (prints.length !== this.panes.length) this.touched = false;
    Object.assign(this, { prints, lengthCache: null, empty: false, panes: this.pool.slice(0, prints.length), layers: Math.max(...prints.map((print) => print.layers)) });
    this.panes.forEach((pane, i) => pane.show(prints[i], prepared[i]));
    this.layOut();
    this.judge();
    const flat = [0, 1, 2, 3].map((i) => (i < 2 ? Math.min : Math.max)(...prints.map((print) => print.bounds[i])));
    const { "2d": above, "3d": around } = this.cameras;
    above.box = flat;
    around.outline = prints.flatMap((print) => print.outline);
    if (prints.length === 1) find("table").replaceChildren();
    this.goTo(top ? this.layers - 1 : layer);
    this.colored();
    this.resized();
  }

  /** Nothing is there any more. */
  clear() {
    this.asked = {};
    if (this.empty) return;
    this.take([NOTHING], [null]);
    this.empty = true;
  }

  setMode(mode) {
    super.setMode(mode);
    this.onMode?.(this.state.mode);
  }

  showText() {
    super.showText();
    this.onLayer?.();
  }

  /** What is on show and why it may be another. */
  say(text) {
    const note = find("stale");
    note.hidden = !text;
    note.textContent = text;
  }
}

