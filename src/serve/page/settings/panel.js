// All settings, made from the schema: groups, search, what differs; of the print or of the selected object.

import { element, find } from "../view.js";
import { withSetting } from "../project.js";
import { Field, title } from "./field.js";

/** Groups that most people need are open at first. */
const OPEN = new Set(["layer", "walls", "infill", "support"]);
/** Those that are about the print come first, those about the machine last. */
const FIRST = ["layer", "walls", "shell", "infill", "support", "brim", "skirt", "raft", "speed", "temperature", "cooling", "retract", "seam", "order"];

export class SettingsPanel {
  constructor(desk) {
    Object.assign(this, { desk, root: find("settings"), fields: new Map(), groups: [], scope: "print", words: [], onlyChanged: false });
    this.search = element("input", { type: "search", placeholder: "Search settings and help", "aria-label": "Search settings", id: "search", oninput: () => this.filter() });
    this.changed = element("button", { "aria-pressed": "false", title: "Show only what differs from the preset", onclick: () => this.toggleChanged() }, "Changed");
    this.scopes = ["print", "object"].map((scope) => element("button", { "aria-pressed": String(scope === "print"), onclick: () => this.setScope(scope) }, scope === "print" ? "Whole print" : "Selected object"));
    this.list = element("div", { id: "groups" });
    this.none = element("p", { class: "soft", hidden: true, style: "padding: 12px" });
    this.root.append(element("div", { class: "top" }, element("div", { class: "pair" }, ...this.scopes), element("div", { class: "search" }, this.search, this.changed)), this.list);
    desk.on("schema", () => this.build());
    desk.on("project resolved selection", () => this.draw());
  }

  build() {
    const rank = ({ name }) => (FIRST.indexOf(name) + 1 || 99);
    this.groups = [...this.desk.schema.groups].sort((a, b) => rank(a) - rank(b)).map((group) => this.group(group));
    this.list.replaceChildren(...this.groups.map(({ root }) => root), this.none);
    this.draw();
    this.filter();
  }

  group({ name, title: text, help, settings }) {
    const fields = settings.map((setting) => new Field(setting, (value) => this.set(setting.key, value)));
    for (const field of fields) this.fields.set(field.setting.key, field);
    const count = element("span", { class: "count", hidden: true }), id = `group-${name}`;
    const head = element("button", { "aria-expanded": String(OPEN.has(name)), "aria-controls": id, title: help ?? "" }, text || title(`.${name}`), count);
    const body = element("div", { id }, ...fields.map((field) => field.root)), group = { name, text: `${name} ${text} ${help}`.toLowerCase(), fields, head, body, count, open: OPEN.has(name) };
    head.addEventListener("click", () => {
      group.open = head.getAttribute("aria-expanded") !== "true";
      this.expand(group, group.open);
    });
    group.root = element("div", { class: "group" }, element("h3", {}, head), body);
    return group;
  }

  expand({ head, body }, open) {
    head.setAttribute("aria-expanded", open);
    body.hidden = !open;
  }

  /** Of which settings are those of: null is the whole print. */
  get model() {
    return this.scope === "object" ? this.desk.selected : null;
  }

  set(key, value) {
    this.desk.change(withSetting(this.desk.project, key, value, this.model));
  }

  setScope(scope) {
    this.scope = scope;
    this.scopes.forEach((button, i) => button.setAttribute("aria-pressed", (i === 0) === (scope === "print")));
    this.draw();
    this.filter();
  }

  /** Leads to a setting. */
  find(key) {
    this.search.value = key;
    this.setScope("print");
    this.fields.get(key)?.input.focus();
  }

  toggleChanged() {
    this.onlyChanged = !this.onlyChanged;
    this.changed.setAttribute("aria-pressed", this.onlyChanged);
    this.filter();
  }

  draw() {
    const { desk } = this, { project, resolved } = desk;
    this.scopes[1].disabled = desk.selected === null;
    if (this.scope === "object" && desk.selected === null) return this.setScope("print");
    const model = this.model, own = model === null ? project.settings : project.models[model].settings;
    const problems = new Map((resolved?.problems ?? []).filter((p) => (p.model ?? null) === model).map((p) => [p.key, p.message]));
    for (const [key, field] of this.fields) {
      const shown = model === null ? resolved?.settings[key] : project.settings[key] ?? resolved?.settings[key];
      const base = model === null ? resolved?.base?.[key] : shown;
      field.show({ own: own[key], shown, base, origin: resolved?.origins[key], problem: problems.get(key) });
    }
    for (const { fields, count } of this.groups) {
      const changed = fields.filter(({ setting }) => setting.key in own).length;
      count.hidden = !changed;
      count.textContent = changed;
      count.title = `${changed} changed`;
    }
    if (this.onlyChanged) this.filter();
  }

  /** Shows what the words, the scope and the button ask for. */
  filter() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean), { model, desk } = this;
    const own = model === null ? desk.project.settings : desk.project.models[model].settings, looking = words.length > 0 || this.onlyChanged;
    let shown = 0;
    for (const group of this.groups) {
      let some = 0;
      for (const field of group.fields) {
        const { key, help, per_object: single } = field.setting, text = `${key} ${title(key)} ${help} ${group.text}`.toLowerCase();
        const seen = words.every((word) => text.includes(word)) && (this.scope === "print" || single) && (!this.onlyChanged || key in own);
        field.root.hidden = !seen;
        field.mark(words);
        some += seen;
      }
      group.root.hidden = !some;
      this.expand(group, looking ? some > 0 : group.open);
      shown += some;
    }
    this.none.hidden = shown > 0 || !this.groups.length;
    this.none.textContent = this.onlyChanged ? "Nothing differs from the preset." : "No setting has these words.";
  }
}
