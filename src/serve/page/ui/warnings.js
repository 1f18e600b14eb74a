// What is doubtful about the print, with what mends it.

import { element, find } from "../view.js";
import { withSetting } from "../project.js";

const MOST = 8;

export class Warnings {
  /** `show(key)`: leads to a setting. */
  constructor(desk, show) {
    Object.assign(this, { desk, show, root: find("warnings") });
    desk.on("resolved placed done project", () => this.draw());
  }

  draw() {
    const { desk, root } = this, some = desk.project.models.length > 0, fresh = desk.done?.revision === desk.revision;
    const problems = desk.resolved?.problems ?? [];
    const texts = [...(desk.resolved?.warnings ?? []), ...(some ? desk.placed.notes ?? [] : []), ...(some && fresh ? desk.done.warnings ?? [] : some ? this.last ?? [] : [])];
    if (fresh) this.last = desk.done.warnings;
    const key = JSON.stringify([problems, texts]);
    if (key === this.drawn) return;
    this.drawn = key;
    root.hidden = !problems.length && !texts.length;
    root.replaceChildren(element("div", { class: "head" }, element("h2", {}, problems.length ? "Problems" : "Warnings")),
      ...problems.slice(0, MOST).map((problem) => this.problem(problem)),
      ...[...new Set(texts)].slice(0, MOST).map((text) => element("div", { class: "note" }, text)),
      ...this.proposals(texts));
  }

  problem({ key, message }) {
    return element("div", { class: "note error" }, message, ...(key ? [element("br"), element("button", { onclick: () => this.show(key) }, "Show the setting")] : []));
  }

  /** A button for each setting that a line proposes as `--set key=value`. */
  proposals(texts) {
    const { desk } = this, found = new Set(texts.flatMap((text) => /--set ([a-z_.]+=[^\s,;]+)/.exec(text)?.[1] ?? []));
    return [...found].map((setting) => {
      const [key, value] = setting.split(/=(.*)/s);
      return element("button", { onclick: () => desk.change(withSetting(desk.project, key, value)) }, `Set ${setting}`);
    });
  }
}
