// A field to search in and choose from: what screen readers know as a combobox with a list.

import { element } from "../view.js";

let count = 0;

export class Combo {
  /** `find(words)`: gives or promises groups `{ title, items: [{ value, label, help }] }`; `choose(value)`. */
  constructor(label, find, choose) {
    Object.assign(this, { find, choose, items: [], active: -1, shown: "" });
    const id = `combo-${count++}`;
    this.input = element("input", {
      id, type: "text", role: "combobox", "aria-expanded": "false", "aria-controls": `${id}-list`, "aria-autocomplete": "list", autocomplete: "off", spellcheck: "false",
      oninput: () => this.open(this.input.value), onfocus: () => this.input.select(), onclick: () => this.open(""),
      onblur: () => this.close(), onkeydown: (event) => this.key(event),
    });
    this.list = element("ul", { id: `${id}-list`, class: "choices", role: "listbox", "aria-label": label, hidden: true });
    // A press in the list must not take the focus, or the list would close before the click.
    this.list.addEventListener("pointerdown", (event) => event.preventDefault());
    this.root = element("div", { class: "picker" }, element("label", { for: id }, label), this.input, this.list);
  }

  show(text, help = "") {
    this.shown = text;
    this.input.title = help;
    if (this.list.hidden) this.input.value = text;
  }

  async open(words) {
    const asked = (this.asked = {});
    Object.assign(this, { items: [], active: -1, wanted: false, found: false });
    this.list.hidden = false;
    this.input.setAttribute("aria-expanded", "true");
    const groups = await this.find(words);
    if (this.asked !== asked) return;
    this.items = [];
    this.list.replaceChildren(...groups.filter(({ items }) => items.length).flatMap(({ title, items }) => [
      ...(title ? [element("li", { class: "group", role: "presentation" }, title)] : []),
      ...items.map((item) => this.option(item)),
    ]));
    if (!this.items.length) this.list.append(element("li", { class: "group", role: "presentation" }, "Nothing has these words"));
    this.activate(this.items.length && words ? 0 : -1);
    // Whoever was quicker than the answer takes the first.
    if (this.wanted && this.items.length && words) this.take(this.items[0].value);
    this.found = true;
  }

  option({ value, label, help }) {
    const node = element("li", { role: "option", id: `${this.list.id}-${this.items.length}`, "aria-selected": "false", onclick: () => this.take(value) }, label);
    if (help) node.append(element("small", {}, help));
    this.items.push({ value, node });
    return node;
  }

  activate(index) {
    this.active = index;
    this.items.forEach(({ node }, i) => node.setAttribute("aria-selected", i === index));
    const { node } = this.items[index] ?? {};
    if (node) node.scrollIntoView({ block: "nearest" });
    this.input.setAttribute("aria-activedescendant", node?.id ?? "");
  }

  key(event) {
    const steps = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 }, step = steps[event.key];
    if (step) {
      event.preventDefault();
      if (this.list.hidden) return this.open("");
      this.activate(Math.min(Math.max(this.active + step, 0), this.items.length - 1));
    } else if (event.key === "Enter" && !this.list.hidden && this.items[this.active]) {
      event.preventDefault();
      this.take(this.items[this.active].value);
    } else if (event.key === "Enter" && !this.list.hidden && !this.found) {
      this.wanted = true;
    } else if (event.key === "Escape") {
      event.stopPropagation();
      this.close();
    }
  }

  take(value) {
    this.close();
    this.choose(value);
  }

  close() {
    this.asked = null;
    this.list.hidden = true;
    this.input.setAttribute("aria-expanded", "false");
    this.input.value = this.shown;
  }
}
