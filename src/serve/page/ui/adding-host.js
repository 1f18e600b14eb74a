// A print host of the user's own, where the engine keeps them in the browser.

import { element } from "../view.js";
import { attempt } from "./notices.js";

/** A form for another host; `open`: it is what is to be done first. */
export function addingHost(engine, open) {
  const kind = element("select", { id: "host-kind" }, ...Object.entries(engine.hostKinds()).map(([value, label]) => element("option", { value }, label)));
  const url = element("input", { id: "host-url", required: true, placeholder: "http://192.168.1.20" });
  const key = element("input", { id: "host-key", type: "password", autocomplete: "off" });
  const name = element("input", { id: "host-name" });
  const line = (label, input) => element("p", {}, element("label", {}, `${label} `, input));
  const form = element("form", {}, line("Kind", kind), line("Address", url), line("Key or password", key), line("Name", name),
    element("p", { class: "soft" }, "Address and key stay in this browser, and requests go to that address alone. The host must allow this page: what to set there is said where it does not."),
    element("button", { id: "host-add" }, "Add"));
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    const host = { kind: kind.value, url: url.value.trim(), key: key.value.trim(), name: name.value.trim() };
    // The page says at its start whom it may ask; its plate is kept.
    if (await attempt(async () => { await engine.addHost(host); return true; })) location.reload();
  });
  return element("details", { id: "adding-host", open }, element("summary", {}, "Add a printer"), form);
}

/** A button that forgets a host. */
export function forgetting(engine, name, then) {
  const forget = async () => {
    await engine.removeHost(name);
    then();
  };
  return element("button", { type: "button", class: "plain icon", title: `Forget ${name}`, "aria-label": `Forget ${name}`, onclick: forget }, "✕");
}
