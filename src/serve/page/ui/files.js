// Files in and out: dropped, chosen, saved.

import { element, find } from "../view.js";
import { attempt, notify } from "./notices.js";

/** Gives `choose`, `saveProject` and `saveGcode`. */
export function listenToFiles(desk, engine, connection) {
  let wanted = false;
  const add = async (list) => {
    const files = [...list];
    if (!files.length) return;
    if (desk.state === "offline") return notify("The service does not answer; nothing was added.", "error");
    document.body.classList.add("adding");
    // What slices may have to be loaded first.
    await connection.ready;
    for (const error of await connection.add(files)) notify(error.message, "error");
    document.body.classList.remove("adding");
  };
  const choose = () => find("files").click();
  const download = (url, name) => {
    const link = element("a", { href: url, download: name, hidden: true });
    document.body.append(link);
    link.click();
    link.remove();
  };
  const save = () => {
    wanted = false;
    find("save").textContent = "Save G-code";
    download(engine.gcode(desk.done), desk.done.name);
  };
  /** Saves what is on the plate; what is still being sliced when it is done. */
  const saveGcode = () => {
    if (find("save").disabled) return;
    if (desk.current) return save();
    wanted = !wanted;
    find("save").textContent = wanted ? "Saving when sliced…" : "Save G-code";
  };
  const saveProject = () => attempt(async () => {
    if (!desk.project.models.length) return notify("There is nothing on the plate to save.");
    // What is saved is what the engine has: it must have the last change.
    await connection.send();
    download(await engine.projectFile(), "project.3mf");
  });

  find("files").addEventListener("change", ({ target }) => {
    add(target.files);
    target.value = "";
  });
  for (const id of ["open", "open-here"]) find(id).addEventListener("click", choose);
  find("save").addEventListener("click", saveGcode);
  find("save-project").addEventListener("click", saveProject);
  desk.on("done", () => wanted && save());

  const holdsFiles = (event) => event.dataTransfer?.types.includes("Files");
  document.addEventListener("dragover", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    document.body.classList.add("dropping");
  });
  document.addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) document.body.classList.remove("dropping");
  });
  document.addEventListener("drop", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    document.body.classList.remove("dropping");
    // A folder is among the files, too, as one of no use.
    const entries = [...event.dataTransfer.items].filter(({ kind }) => kind === "file").map((item) => item.webkitGetAsEntry?.());
    const folders = entries.filter((entry) => entry?.isDirectory);
    if (folders.length && !engine.addPresets) notify("A folder cannot be opened; drop the models in it.", "error");
    else if (folders.length) desk.tell("folders", folders);
    add([...event.dataTransfer.files].filter((_, i) => !entries[i]?.isDirectory));
  });
  return { choose, saveProject, saveGcode, add };
}
