// What people should know, until they have read it.

import { element, find } from "../view.js";

const SECONDS = { info: 6, warning: 15, error: 0 };

/** Shows a line; `action`: [label, what it does]. The same line is not shown twice. */
export function notify(text, kind = "info", action = null) {
  const root = find("notices");
  for (const old of root.children) if (old.dataset.text === text) old.remove();
  const close = () => node.remove();
  const node = element("div", { class: `notice ${kind}`, "data-text": text, ...(kind === "error" ? { role: "alert" } : {}) },
    element("p", {}, text),
    ...(action ? [element("button", { onclick: () => { close(); action[1](); } }, action[0])] : []),
    element("button", { class: "plain icon", "aria-label": "Close", onclick: close }, "✕"));
  root.append(node);
  while (root.children.length > 4) root.firstChild.remove();
  if (SECONDS[kind]) setTimeout(close, 1000 * SECONDS[kind]);
  return node;
}

/** Runs something that may fail, and says so. */
export async function attempt(task) {
  try {
    return await task();
  } catch (error) {
    if (!error.kind) throw error;
    notify(error.message, "error");
    return null;
  }
}
