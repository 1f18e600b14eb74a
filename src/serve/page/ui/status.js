// The line below: what is going on, what the print comes to, what the last change did to that, and the same as a command.

import { duration, element, find, fixed, length } from "../view.js";

const STAGES = { sections: "Cutting into layers", paths: "Laying paths", order: "Ordering" };
const signed = (value, text) => `${value < 0 ? "−" : "+"}${text(Math.abs(value))}`;
const near = (seconds) => (seconds < 90 ? `${Math.round(seconds)} s` : `${Math.round(seconds / 60)} min`);

/** Figures, how they are written, and from where on a change is worth telling. */
const FIGURES = [
  { name: "Time", value: (s) => s.total_s, before: "time_s", text: duration, change: near, least: 0.5 },
  { name: "Filament", value: (s) => s.filament_g, before: "filament_g", text: (g, s) => `${length(s.filament_mm)}, ${fixed(g, 1)} g`, change: (g) => `${fixed(g, 1)} g`, least: 0.05 },
  { name: "Cost", value: (s) => s.filament_cost, before: "cost", text: (cost) => fixed(cost, 2), change: (cost) => fixed(cost, 2), least: 0.005 },
  { name: "Travel", value: (s) => s.travel_mm, before: "travel_mm", text: length, change: length, least: 0.5 },
];

export class Status {
  constructor(desk) {
    Object.assign(this, { desk });
    desk.on("state done", () => this.draw());
    desk.on("done", () => this.results());
    find("copy").addEventListener("click", () => this.copy());
  }

  draw() {
    const { desk } = this, { state, error, progress } = desk, bar = find("bar");
    find("state").dataset.state = state;
    const texts = {
      starting: "Starting", idle: "Nothing to slice", done: "Sliced: ready to save", busy: "Slicing",
      failed: error?.message ?? "", offline: "No answer from the service; trying again",
    };
    const share = progress && state === "busy" && progress.of ? progress.done / progress.of : null;
    find("state-text").textContent = share === null ? texts[state] : STAGES[progress.stage] ?? texts.busy;
    find("state-text").title = find("state-text").textContent;
    bar.hidden = share === null;
    if (share !== null) bar.value = share;
    const save = find("save");
    save.disabled = !desk.project.models.length || state === "failed" || state === "offline";
    find("results").style.opacity = desk.current ? "1" : "0.55";
    if (!desk.project.models.length) {
      find("results").replaceChildren();
      find("command-text").value = "";
    }
  }

  results() {
    const { summary, before, command, project_needed: needed } = this.desk.done;
    find("results").replaceChildren(...FIGURES.filter(({ value }) => value(summary) !== undefined && value(summary) !== null).map((figure) => {
      const value = figure.value(summary), change = before ? value - before[figure.before] : 0, node = element("dd", {}, figure.text(value, summary));
      if (Math.abs(change) >= figure.least) {
        node.append(element("span", { class: `change ${change < 0 ? "less" : "more"}`, title: "What the last change did" }, signed(change, figure.change)));
      }
      return element("div", {}, element("dt", {}, figure.name), node);
    }));
    find("command-text").value = command ?? (needed ? "pathwright slice project.3mf" : "");
    find("command-text").title = needed ? "For the project: save it first" : "Writes the same bytes";
    document.querySelector("#command label").textContent = needed ? "Save project, then" : "Command";
  }

  async copy() {
    const field = find("command-text");
    field.select();
    try {
      await navigator.clipboard.writeText(field.value);
    } catch {
      document.execCommand("copy");
    }
    find("copy").textContent = "Copied";
    setTimeout(() => { find("copy").textContent = "Copy"; }, 1500);
  }
}
