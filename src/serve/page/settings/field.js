// One setting: its name, its control, what differs, where it is from.

import { element } from "../view.js";

/** `layer.first_height` → `First height`. */
export const title = (key) => {
  const name = key.slice(key.indexOf(".") + 1).replaceAll("_", " ");
  return name[0].toUpperCase() + name.slice(1);
};

/** A value as it is shown: lists without brackets. */
export const plain = (value) => (Array.isArray(value) ? value.join(", ") : String(value ?? "")).replace(/^\[(.*)\]$/, "$1").replaceAll("\n", "\\n");

/** The least step that makes sense of a number. */
function hintOf({ kind, min, max, unit }) {
  const span = min !== undefined && max !== undefined ? `${min} to ${max}${unit ? ` ${unit}` : ""}` : unit ?? "";
  return { number: "number", integer: "whole number", percent: "share, such as 15%", list: "numbers with commas", text: "text" }[kind] + (span && kind !== "text" ? `, ${span}` : "");
}

export class Field {
  /** `change(text or null)`: sets the value or takes it back. */
  constructor(setting, change) {
    Object.assign(this, { setting, change });
    const { key, kind, unit, choices, help } = setting, id = `set-${key.replaceAll(".", "-")}`;
    const set = ({ target }) => this.typed(target);
    if (kind === "boolean") this.input = element("input", { id, type: "checkbox", onchange: ({ target }) => change(String(target.checked)) });
    else if (kind === "choice") this.input = element("select", { id, onchange: set }, ...choices.map((choice) => element("option", {}, choice)));
    else this.input = element("input", { id, type: "text", inputmode: ["number", "integer"].includes(kind) ? "decimal" : false, spellcheck: "false", autocomplete: "off", onchange: set });
    this.input.setAttribute("aria-describedby", `${id}-more`);
    this.label = element("label", { for: id, title: help }, title(key));
    this.value = element("div", { class: unit ? "value unit" : "value" }, this.input, ...(unit ? [element("span", { class: "unit-name", "aria-hidden": "true" }, unit)] : []));
    this.back = element("button", { class: "back", onclick: () => change(null) }, "↺");
    this.more = element("div", { class: "more", id: `${id}-more`, hidden: true });
    this.problem = element("div", { class: "problem", role: "alert", hidden: true });
    this.root = element("div", { class: "setting", "data-key": key }, this.label, this.value, this.back, this.problem, this.more);
    this.label.addEventListener("click", (event) => {
      event.preventDefault();
      this.explain(this.more.hidden);
    });
    // What is being typed is nobody else's to change.
    this.input.addEventListener("input", () => { this.typing = true; });
    this.input.addEventListener("blur", () => {
      this.typing = false;
      this.refresh?.();
    });
    this.input.addEventListener("focus", () => this.explain(true));
    this.root.addEventListener("focusout", ({ relatedTarget }) => { if (!this.root.contains(relatedTarget)) this.explain(false); });
  }

  typed(input) {
    this.typing = false;
    const { kind } = this.setting, text = input.value.trim();
    if (text === "" && kind !== "text") return this.change(null);
    if (kind === "list") return this.change(`[${text.replace(/^\[|\]$/g, "")}]`);
    this.change(["number", "integer", "percent"].includes(kind) ? text.replace(",", ".") : text);
  }

  /** `state`: `own`: the value set here, if any; `shown`: the value in force; `origin`: where it is from; `base`: the value without ours. */
  show(state) {
    this.refresh = () => this.fill(state);
    this.fill(state);
  }

  fill({ own, shown, origin, base, problem }) {
    const { setting, input } = this, value = plain(own ?? shown ?? setting.default), changed = own !== undefined && own !== null;
    if (setting.kind === "boolean") input.checked = value === "true";
    else if (input.value !== value && !this.typing) input.value = value;
    input.setAttribute("aria-invalid", Boolean(problem));
    this.root.classList.toggle("changed", changed);
    this.back.hidden = !changed;
    if (changed) {
      const to = base === undefined ? "" : ` to ${plain(base)}`;
      this.back.title = `Back${to}`;
      this.back.setAttribute("aria-label", `${title(setting.key)}: back${to}`);
    }
    this.problem.hidden = !problem;
    this.problem.textContent = problem ?? "";
    this.source = changed ? `set here${base === undefined ? "" : `; otherwise ${plain(base) || "empty"}`}` : `from ${origin ?? "the defaults"}`;
    if (!this.more.hidden) this.explain(true);
  }

  /** Shows or hides meaning, range, key and source. */
  explain(shown) {
    const { setting } = this, takes = setting.kind === "boolean" || setting.kind === "choice" ? "" : `${hintOf(setting)}; `;
    this.more.hidden = !shown;
    if (shown) this.more.replaceChildren(setting.help, " ", element("code", {}, setting.key), `, ${takes}${this.source}.`);
  }

  /** Marks the words that were looked for. */
  mark(words) {
    const text = title(this.setting.key), at = words.map((word) => [text.toLowerCase().indexOf(word), word.length]).find(([i]) => i >= 0);
    if (!at) return this.label.replaceChildren(text);
    this.label.replaceChildren(text.slice(0, at[0]), element("mark", {}, text.slice(at[0], at[0] + at[1])), text.slice(at[0] + at[1]));
  }
}
