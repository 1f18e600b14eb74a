// Two ways to print the same, side by side.

import { element, find } from "../view.js";
import { withSetting } from "../project.js";
import { attempt, notify } from "../ui/notices.js";

const STRATEGY = "order.strategy";

export class Compare {
  constructor(desk, engine, preview, show) {
    Object.assign(this, { desk, engine, preview, show, running: null });
    find("compare").addEventListener("click", () => this.ask());
    find("end-compare").addEventListener("click", () => this.end());
    desk.on("side", ({ name, event }) => this.handle(name, event));
    desk.on("project", () => this.end());
    desk.on("state", () => { find("compare").disabled = !desk.project.models.length; });
  }

  ask() {
    const { desk } = this, strategies = desk.schema?.groups.flatMap((g) => g.settings).find((s) => s.key === STRATEGY)?.choices ?? [];
    const now = desk.resolved?.settings[STRATEGY] ?? "optimized", before = desk.history.past.at(-1), same = before?.models.length > 0;
    const select = (id, value) => element("select", { id }, ...strategies.map((choice) => element("option", choice === value ? { selected: true } : {}, choice)));
    const kind = (value, text, disabled = false) => element("label", { class: "line" }, element("input", { type: "radio", name: "kind", value, disabled, ...(value === "order" ? { checked: true } : {}) }), text);
    const other = element("textarea", { rows: 3, "aria-label": "Settings of the other side", placeholder: "infill.density=15%\nlayer.height=0.3" });
    const left = select("side-a", now), right = select("side-b", now === "nearest" ? "optimized" : "nearest"), dialog = find("comparing");
    const form = element("form", { method: "dialog" },
      element("h2", {}, "Compare on the same layers"),
      kind("order", "Two ordering strategies"), element("div", { class: "line" }, left, "with", right),
      kind("before", "Now with before the last change", !same),
      kind("settings", "Now with other settings, one on each line"), other,
      element("div", { class: "row" }, element("button", { value: "" }, "Cancel"), element("button", { class: "main", value: "go" }, "Compare")));
    other.addEventListener("focus", () => { form.elements.kind.value = "settings"; });
    for (const list of [left, right]) list.addEventListener("change", () => { form.elements.kind.value = "order"; });
    form.addEventListener("submit", (event) => event.submitter?.value === "go" && this.start(this.sides(form.elements.kind.value, left.value, right.value, other.value)));
    dialog.replaceChildren(form);
    dialog.showModal();
  }

  /** Both projects and what they are called. */
  sides(kind, left, right, text) {
    const { project, history } = this.desk;
    if (kind === "before") return { names: ["now", "before"], projects: [project, history.past.at(-1)] };
    if (kind === "order") return { names: [left, right], projects: [withSetting(project, STRATEGY, left), withSetting(project, STRATEGY, right)] };
    const lines = text.split("\n").map((line) => line.trim()).filter(Boolean).map((line) => line.split(/=(.*)/s));
    return { names: ["now", lines.map(([key, value]) => `${key}=${value}`).join(", ") || "now"], projects: [project, lines.reduce((p, [key, value = ""]) => withSetting(p, key.trim(), value.trim()), project)] };
  }

  /** Slices both; then once more with a bound for each order, which takes longer and gives the gaps. */
  async start({ names, projects, certify = false }) {
    const running = (this.running = { names, projects, certify, revisions: [], events: [null, null] });
    const [a, b] = projects.map((project) => ({ ...project, certify })), answer = await attempt(() => this.engine.compare(a, b));
    if (!answer) return this.end();
    if (this.running !== running) return;
    running.revisions = [answer.a, answer.b];
    this.desk.sent = null;
    find("end-compare").hidden = false;
    this.preview.say(certify ? "Proving the gaps" : "Slicing both sides");
    if (!certify) this.show();
    for (const [name, event] of this.early ?? []) this.handle(name, event);
    this.early = [];
  }

  async handle(name, event) {
    const { running } = this;
    // Events may be quicker than the answer that says which they are.
    if (!running?.revisions.length) return void (this.early = [...(this.early ?? []), [name, event]].slice(-20));
    const side = running.revisions.indexOf(event.revision);
    if (side < 0) return;
    if (name === "failed") {
      notify(`${running.names[side]}: ${event.error.message}`, "error");
      return this.end();
    }
    if (name !== "done") return;
    running.events[side] = event;
    if (running.events.some((other) => !other)) return;
    const packed = await attempt(() => Promise.all(running.events.map((done) => this.engine.preview(done))));
    if (packed && this.running === running) {
      await this.preview.present(packed, running.names, this.desk.bedBox);
      this.preview.say("");
      if (!running.certify && this.running === running) this.start({ ...running, certify: true });
    }
  }

  /** Back to the one print. */
  end() {
    this.early = [];
    if (!this.running) return;
    this.running = null;
    find("end-compare").hidden = true;
    this.preview.say("");
    // Few results are kept: the print itself may have made room for both sides.
    this.desk.tell("again");
  }
}
