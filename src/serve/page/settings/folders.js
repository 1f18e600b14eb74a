// Folders of other slicers' presets, where the engine has no machine to find them on: chosen or dropped, each with its name and a
// button that forgets it.

import { element, find } from "../view.js";
import { attempt, notify } from "../ui/notices.js";

/** The files of dropped folders: paths that begin with the folder's name. */
async function filesOf(entry, folder = "") {
  const path = folder ? `${folder}/${entry.name}` : entry.name;
  if (entry.isFile) return [{ path, file: await new Promise((done, fail) => entry.file(done, fail)) }];
  const reader = entry.createReader(), all = [];
  for (;;) {
    // It gives some at a time, and none at the end.
    const some = await new Promise((done, fail) => reader.readEntries(done, fail));
    if (!some.length) return all;
    for (const inner of some) all.push(...await filesOf(inner, path));
  }
}

export class PresetFolders {
  /** `changed()`: the presets are others. */
  constructor(desk, engine, changed) {
    Object.assign(this, { desk, engine, changed });
    this.list = element("div", { id: "preset-folders", class: "line" });
    const input = find("preset-folder");
    this.root = element("div", { hidden: !engine.addPresets }, this.list, element("div", { class: "line" },
      element("button", { id: "open-presets", title: "Take printers, prints and filaments from the folder in which PrusaSlicer, OrcaSlicer, Cura or one of their kin keeps its settings. It stays in this browser.", onclick: () => input.click() }, "Presets of my slicer…")));
    if (!engine.addPresets) return;
    input.addEventListener("change", () => {
      const files = [...input.files].map((file) => ({ path: file.webkitRelativePath, file }));
      input.value = "";
      if (files.length) this.add(files);
    });
    desk.on("schema", () => this.draw());
    desk.on("folders", async (entries) => { for (const entry of entries) this.add(await filesOf(entry)); });
  }

  async add(files) {
    const added = await attempt(() => this.engine.addPresets(files));
    if (!added) return;
    const { folder, printers, problems } = added;
    if (printers) notify(`${printers} printers of ${folder} can be chosen now; they stay in this browser.`);
    else notify(`There are no presets of printers in ${folder}. Open the folder in which the slicer keeps its settings: Help › Show Configuration Folder in most of them.`, "error");
    if (problems.length) notify(`${folder}: ${problems[0]}${problems.length > 1 ? `, and ${problems.length - 1} more that cannot be read` : ""}`, "warning");
    await this.draw();
    this.changed();
  }

  async forget(name) {
    await attempt(() => this.engine.forgetPresets(name));
    await this.draw();
    this.changed();
  }

  async draw() {
    const names = (await attempt(() => this.engine.presetFolders())) ?? [];
    this.list.replaceChildren(...names.map((name) => element("span", {}, name,
      element("button", { class: "plain icon", title: `Forget the presets of ${name}`, "aria-label": `Forget the presets of ${name}`, onclick: () => this.forget(name) }, "✕"))));
  }
}
