// Boxes that say where support is wanted and where not.

import { element, find } from "../view.js";
import { isPlaced, placed, withFile } from "../project.js";
import { attempt } from "./notices.js";

const SIDE = 15;

/** Buttons below the list of objects. */
export function addBodies(desk, connection) {
  const buttons = [["support_enforcer", "+ Support here", "support enforcer"], ["support_blocker", "+ No support", "support blocker"]].map(([role, text, name]) =>
    element("button", { title: `A box within which overhangs are ${role === "support_blocker" ? "not supported" : "supported"}: move and scale it`, onclick: () => attempt(() => add(role, name)) }, text));
  const line = element("div", { class: "line", hidden: true }, ...buttons);
  find("objects").append(line);
  desk.on("project", () => { line.hidden = !desk.project.models.length; });

  async function add(role, name) {
    const file = new File([box()], `${name}.stl`), answer = await connection.upload(file);
    const project = isPlaced(desk.project) ? desk.project : placed(desk.project, desk.stands);
    const owner = project.models[desk.selected ?? 0], at = owner?.at_mm ?? [0, 0, 0];
    desk.change(withFile(project, answer.file, { role, at_mm: [at[0], at[1], 0] }));
    desk.select([desk.project.models.length - 1]);
  }
}

/** A cube as a binary STL. */
function box() {
  const corner = (i) => [0, 1, 2].map((k) => (i >> k & 1 ? SIDE : 0));
  const faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
  const view = new DataView(new ArrayBuffer(84 + 50 * faces.length));
  view.setUint32(80, faces.length, true);
  faces.forEach((face, i) => face.flatMap(corner).forEach((value, k) => view.setFloat32(84 + 50 * i + 12 + 4 * k, value, true)));
  return view.buffer;
}
