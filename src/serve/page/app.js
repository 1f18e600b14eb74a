// Starts the page and connects its parts.

import { find } from "./view.js";
import { Connection } from "./connection.js";
import { Desk } from "./desk.js";
import { Memory } from "./memory.js";
import { unplaced, withMove, withTurn } from "./project.js";
import { PlateView } from "./plate/view.js";
import { Compare } from "./preview/compare.js";
import { Preview } from "./preview/preview.js";
import { Stops } from "./preview/stops.js";
import { Follow } from "./preview/follow.js";
import { Presets } from "./settings/presets.js";
import { SettingsPanel } from "./settings/panel.js";
import { listenToFiles } from "./ui/files.js";
import { PrintHosts } from "./ui/hosts.js";
import { fillKeys, listenToKeys } from "./ui/keyboard.js";
import { askToken } from "./ui/login.js";
import { attempt, notify } from "./ui/notices.js";
import { addBodies } from "./ui/bodies.js";
import { ObjectList } from "./ui/objects.js";
import { Status } from "./ui/status.js";
import { Transform } from "./ui/transform.js";
import { Warnings } from "./ui/warnings.js";

// Where the page is from says what slices: the service, or a worker of the page.
const { Engine } = await import(document.documentElement.dataset.engine === "worker" ? "./local.js" : "./engine.js");
const desk = new Desk(), engine = new Engine();
setTheme(localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
const connection = new Connection(engine, desk, new Memory(desk), () => askToken(engine));
const plate = new PlateView(desk, engine, find("plate"));
const preview = new Preview();
const transform = new Transform(desk, engine, plate);
const panel = new SettingsPanel(desk);
const stops = new Stops(desk, preview);
const files = listenToFiles(desk, engine, connection);
new Presets(desk, engine);
new ObjectList(desk, { open: files.choose });
new Status(desk);
new PrintHosts(desk, engine);
new Warnings(desk, (key) => panel.find(key));
addBodies(desk, connection);
const compare = new Compare(desk, engine, preview, () => preview.setMode("2d"));
new Follow(desk, engine, preview, compare);

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
}

/** `plate`, `2d` or `3d`. */
function setView(view) {
  desk.view = view;
  find("centre").dataset.view = document.body.dataset.view = view === "plate" ? "plate" : "preview";
  for (const name of ["plate", "2d", "3d"]) find(`view-${name}`).setAttribute("aria-pressed", name === view);
  find("layers").hidden = view === "plate";
  // The small window beside the plate shows the whole print.
  if (view === "plate" && preview.solid) preview.state.mode = "3d";
  preview.resized();
  plate.schedule();
}

preview.onMode = (mode) => setView(mode);
find("view-plate").addEventListener("click", () => setView("plate"));
for (const mode of ["2d", "3d"]) find(`view-${mode}`).addEventListener("click", () => preview.setMode(mode));
find("enlarge").addEventListener("click", () => preview.setMode(preview.solid ? "3d" : "2d"));
find("color").addEventListener("change", ({ target }) => preview.setColor(target.value));
find("layer").addEventListener("input", ({ target }) => preview.goTo(target.value - 1));
find("progress").addEventListener("input", ({ target }) => preview.setProgress(+target.value));
find("play").addEventListener("click", () => preview.play());
find("back").addEventListener("click", () => preview.step(-1));
find("forward").addEventListener("click", () => preview.step(1));
const shown = () => (desk.view === "plate" ? plate : preview);
find("fit").addEventListener("click", () => shown().fit());
find("theme").addEventListener("click", () => {
  const theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
  localStorage.setItem("theme", theme);
  setTheme(theme);
  preview.setTheme(theme);
  desk.tell("theme");
});
find("help").addEventListener("click", () => find("keys").showModal());
find("undo").addEventListener("click", () => desk.undo());
find("redo").addEventListener("click", () => desk.redo());
desk.on("problem", (error) => notify(error.message, "error"));
desk.on("project", () => {
  find("undo").disabled = !desk.history.past.length;
  find("redo").disabled = !desk.history.future.length;
});

for (const tool of ["move", "turn", "scale", "face"]) find(`gizmo-${tool}`).addEventListener("click", () => plate.setTool(tool));
desk.on("tool", () => {
  for (const tool of ["move", "turn", "scale", "face"]) find(`gizmo-${tool}`).setAttribute("aria-pressed", tool === plate.tool);
});

async function arrange() {
  if (!desk.project.models.length) return;
  const arranged = await attempt(() => engine.arrange(unplaced(desk.project)));
  // Without positions of their own models are arranged whenever something changes.
  if (arranged) desk.change(unplaced(desk.project));
}
find("arrange").addEventListener("click", arrange);

for (const [button, side] of [["show-objects", "left"], ["show-settings", "right"]]) {
  find(button).addEventListener("click", () => {
    const on = find(side).classList.toggle("shown");
    find(button).setAttribute("aria-expanded", on);
    find(side === "left" ? "right" : "left").classList.remove("shown");
  });
}
find("centre").addEventListener("pointerdown", () => {
  for (const side of ["left", "right"]) find(side).classList.remove("shown");
});

/** Moves what is selected by so many mm, keeping everything else where it is. */
function nudge(x, y) {
  return (event) => {
    if (!plate.chosen) return;
    const by = event.shiftKey ? 10 : 1, index = plate.pin(plate.chosen);
    if (index === null) return;
    const at = desk.project.models[index].at_mm;
    desk.change(withMove(desk.project, index, [at[0] + x * by, at[1] + y * by, at[2]]), "nudge");
  };
}
const turn = (by) => () => desk.change([...desk.selection].reduce((project, i) => withTurn(project, i, 2, by), desk.project));

fillKeys();
listenToKeys({
  "Ctrl+o": files.choose, "Ctrl+s": files.saveProject, "Ctrl+g": files.saveGcode, "Ctrl+z": () => desk.undo(), "Ctrl+y": () => desk.redo(),
  "Ctrl+f": () => panel.search.focus(), "/": () => panel.search.focus(), "?": () => find("keys").showModal(),
  1: () => setView("plate"), 2: () => preview.setMode("2d"), 3: () => preview.setMode("3d"), 0: () => shown().fit(), "+": () => shown().zoom(0.8), "-": () => shown().zoom(1.25),
}, {
  m: () => plate.setTool("move"), r: () => plate.setTool("turn"), s: () => plate.setTool("scale"), f: () => plate.setTool("face"), a: arrange, o: () => transform.orient(),
  ArrowLeft: nudge(-1, 0), ArrowRight: nudge(1, 0), ArrowUp: nudge(0, 1), ArrowDown: nudge(0, -1), "[": turn(15), "]": turn(-15),
  "Ctrl+a": () => desk.select(desk.project.models.keys()), "Ctrl+d": () => transform.copy(), Delete: () => desk.remove(), Backspace: () => desk.remove(),
  Escape: () => (plate.tool === "face" ? plate.setTool("move") : desk.select([])),
}, {
  ArrowUp: (e) => preview.goTo(preview.state.layer + (e.shiftKey ? 10 : 1)), ArrowDown: (e) => preview.goTo(preview.state.layer - (e.shiftKey ? 10 : 1)),
  ArrowRight: (e) => preview.step(e.shiftKey ? 50 : 1), ArrowLeft: (e) => preview.step(e.shiftKey ? -50 : -1),
  PageUp: () => preview.goTo(preview.state.layer + 10), PageDown: () => preview.goTo(preview.state.layer - 10),
  Home: () => preview.goTo(0), End: () => preview.goTo(preview.layers - 1), " ": () => preview.play(),
  p: () => stops.toggle("pauses"), c: () => stops.toggle("color_changes"), t: () => preview.toggle("role-13"), Escape: () => setView("plate"),
}, () => desk.view === "plate");

setView("plate");
addEventListener("unhandledrejection", ({ reason }) => notify(`Something went wrong in this page: ${reason?.message ?? reason}`, "error"));
// For whoever looks from the console, and for tests.
window.pathwright = { desk, engine, plate, preview, connection };
addEventListener("pagehide", () => engine.close());
connection.run();
