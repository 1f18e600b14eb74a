// Every key, and the list of them.

import { element, find } from "../view.js";

/** Rows of the list of keys; `null` begins the second half. */
const LIST = [
  ["Ctrl+O", "open models or a project"], ["Ctrl+S", "save the project"], ["Ctrl+G", "save the G-code"], ["Ctrl+Z, Ctrl+Y", "undo, redo"],
  ["1 2 3", "plate, layer, whole print"], ["0", "fit into the window"], ["+ −", "zoom in, out"], ["Ctrl+F, /", "search the settings"],
  ["M R S F", "move, turn, scale, lay a face on the bed"], ["← ↑ → ↓", "move the object 1 mm (with Shift 10)"], ["[ ]", "turn it by 15°"],
  ["Tab, Enter", "go through objects and controls"], ["Ctrl+A, Esc", "select all, nothing"], ["Ctrl+D", "copy"], ["Del", "delete"], ["A, O", "arrange everything, orient the object"],
  ["↑ ↓", "in the preview: layer up, down (Shift ten)"], ["← →", "one move back, forward (Shift fifty)"], ["Home, End", "first, last layer"], ["Space", "play, pause"],
  ["P, C", "pause, filament change at this layer"], ["T", "hide or show travel"],
];

export function fillKeys() {
  find("keys").replaceChildren(
    element("h2", {}, "Keyboard shortcuts"),
    element("dl", { class: "keys" }, ...LIST.flatMap(([key, text]) => [element("dt", {}, key), element("dd", {}, text)])),
    element("p", { class: "soft" }, "Drag the plate to look from elsewhere, with Shift or the right button to move it; wheel or two fingers zoom. Shift while turning is free of whole degrees."),
    element("form", { method: "dialog" }, element("div", { class: "row" }, element("button", { class: "main" }, "Close"))),
  );
}

/** `keys`: what each does, by name (`Ctrl+z`); `plate` and `preview`: those of one view. */
export function listenToKeys(common, plate, preview, inPlate) {
  document.addEventListener("keydown", (event) => {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key, command = event.ctrlKey || event.metaKey;
    const name = command ? `Ctrl+${event.shiftKey && key === "z" ? "y" : key}` : key;
    if (event.altKey || document.querySelector("dialog[open]")) return;
    const target = event.target.closest?.("input, select, textarea, [role=combobox]");
    const typing = target && !(target.type === "checkbox" || target.type === "range");
    // Fields have keys of their own, and so have lists, buttons and sliders.
    if (typing && !["Ctrl+o", "Ctrl+s", "Ctrl+g", "Ctrl+f"].includes(name)) return;
    if (event.key === " " && event.target.closest?.("button, input, summary")) return;
    const arrows = event.key.startsWith("Arrow") && event.target.closest?.("#objects, #right");
    const action = (inPlate() ? plate : preview)[name] ?? common[name];
    if (!action || arrows) return;
    event.preventDefault();
    action(event);
  });
}
