// Printer, print and filament: presets of other slicers, built-in profiles, and a profile of one's own.

import { element, find } from "../view.js";
import { withProfile } from "../project.js";
import { attempt, notify } from "../ui/notices.js";
import { Combo } from "./combo.js";
import { PresetFolders } from "./folders.js";

const KINDS = { printer: "Printer", print: "Print", filament: "Filament" };
/** The built-in profiles that go with each. */
const BUILT_IN = { printer: "printer", print: "quality", filament: "material" };
const has = (text, words) => words.toLowerCase().split(/\s+/).every((word) => text.toLowerCase().includes(word));

export class Presets {
  constructor(desk, engine) {
    Object.assign(this, { desk, engine, fitting: null });
    this.combos = Object.fromEntries(Object.entries(KINDS).map(([kind, label]) => [kind, new Combo(label, (words) => this.find(kind, words), (value) => this.choose(kind, value))]));
    this.folders = new PresetFolders(desk, engine, () => this.renew());
    this.left = element("details", { class: "note", hidden: true });
    this.own = element("span", { class: "soft" });
    this.drop = element("button", { title: "Print without this profile", hidden: true, onclick: () => desk.change({ ...desk.project, profile: "" }) }, "Remove");
    find("presets").append(...Object.values(this.combos).map(({ root }) => root), element("div", { class: "line" },
      element("button", { title: "Take settings from a profile (TOML)", onclick: () => find("profile-file").click() }, "Import profile…"),
      element("a", { id: "export-profile", hidden: true, download: "" }),
      element("button", { title: "Save the settings in force as a profile (TOML)", onclick: () => this.export() }, "Export profile"), this.own, this.drop), this.folders.root, this.left);
    find("profile-file").addEventListener("change", ({ target }) => this.import(target));
    desk.on("project schema resolved", () => this.draw());
  }

  async find(kind, words) {
    const { desk, engine } = this, profiles = desk.profiles.filter((p) => p.kind === BUILT_IN[kind] && has(`${p.name} ${p.help}`, words));
    const built = { title: "Built in", items: profiles.map(({ name, help }) => ({ value: { profile: name }, label: name, help })) };
    if (kind === "printer") {
      const found = await engine.printers(words).catch(() => []);
      const items = found.slice(0, 150).map(({ name, bed_mm, height_mm, nozzle_mm, from }) => ({ value: { preset: name }, label: name, help: `${[...bed_mm, height_mm].join(" × ")} mm, nozzle ${nozzle_mm} mm, ${from}` }));
      return [{ items: [{ value: {}, label: "Default", help: "RepRap 250 × 250 × 250 mm" }].filter(({ label, help }) => has(`${label} ${help}`, words)) }, built, { title: "Presets of other slicers", items }];
    }
    const { printer } = desk.project.presets;
    if (!printer) return [{ items: [{ value: {}, label: "Default", help: "" }].filter(({ label }) => has(label, words)) }, built];
    const answer = await this.presetsOf(printer), names = (kind === "print" ? answer?.prints : answer?.filaments) ?? [];
    const items = names.map((entry) => entry.name ?? entry).filter((name) => has(name, words)).map((name) => ({ value: { preset: name }, label: name }));
    const own = kind === "print" ? answer?.default_print : answer?.default_filament;
    return [{ items: [{ value: {}, label: "The printer's own", help: own ?? "" }].filter(({ label, help }) => has(`${label} ${help}`, words)) }, { title: `For ${printer}`, items }, { ...built, title: "Built in, on top" }];
  }

  async presetsOf(printer) {
    if (this.fitting?.printer === printer) return this.fitting.asked;
    const fitting = (this.fitting = { printer, answer: null, asked: attempt(() => this.engine.printer(printer)) });
    return (fitting.answer = await fitting.asked);
  }

  /** The presets are others: what is chosen of them is sliced anew. */
  renew() {
    this.fitting = null;
    this.draw();
    if (this.desk.project.presets.printer) this.desk.tell("again");
  }

  choose(kind, { profile = null, preset = null }) {
    const { desk } = this, names = desk.profiles.filter((p) => p.kind === BUILT_IN[kind]).map((p) => p.name), presets = { ...desk.project.presets };
    delete presets[kind];
    if (preset !== null) presets[kind] = preset;
    // Prints and filaments belong to a printer.
    if (kind === "printer") for (const other of ["print", "filament"]) delete presets[other];
    desk.change({ ...withProfile(desk.project, names, profile), presets });
  }

  draw() {
    const { desk } = this, { presets, profiles, profile } = desk.project;
    if (presets.printer && this.fitting?.printer !== presets.printer) this.presetsOf(presets.printer).then(() => this.draw());
    for (const [kind, combo] of Object.entries(this.combos)) {
      const built = desk.profiles.find((p) => p.kind === BUILT_IN[kind] && profiles.includes(p.name));
      const own = this.fitting?.printer === presets.printer ? this.fitting?.answer?.[`default_${kind}`] : null;
      const fallback = kind === "printer" || !presets.printer ? "Default" : own ? `${own} (the printer's own)` : "The printer's own";
      combo.show(built?.name ?? presets[kind] ?? fallback, built?.help ?? "");
    }
    this.own.textContent = profile ? "with your profile" : "";
    this.drop.hidden = !profile;
    const left = desk.resolved?.not_taken_over;
    this.left.hidden = !left;
    this.left.replaceChildren(element("summary", {}, "Not everything of the preset is taken over"), left ?? "");
  }

  async import(input) {
    const [file] = input.files;
    input.value = "";
    if (!file) return;
    const text = await file.text();
    const profile = file.name.toLowerCase().endsWith(".ini") ? await attempt(() => this.engine.convert(file.name, text)) : text;
    if (!profile) return;
    this.desk.change({ ...this.desk.project, profile });
    notify(`${file.name} is in force; what it sets wins over the presets.`);
  }

  async export() {
    const link = find("export-profile"), address = await attempt(() => this.engine.profileFile());
    if (!address) return;
    link.href = address;
    link.click();
  }
}
