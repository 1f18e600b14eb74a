// Asks for the token of a service that wants one.

import { element, find } from "../view.js";

/** Asks until one is taken. */
export function askToken(engine) {
  const dialog = find("login"), field = element("input", { type: "password", id: "token", autocomplete: "current-password", required: true });
  const said = element("p", { role: "alert" }, "Whoever runs it gives you one: a line of its token file.");
  const form = element("form", {}, element("h2", {}, "This service asks for a token"), said, element("label", { for: "token" }, "Token"), field,
    element("div", { class: "row" }, element("button", { class: "main" }, "Continue")));
  dialog.replaceChildren(form);
  dialog.addEventListener("cancel", (event) => event.preventDefault());
  if (!dialog.open) dialog.showModal();
  return new Promise((done) => {
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      try {
        await engine.login(field.value);
        dialog.close();
        done();
      } catch (error) {
        said.textContent = error.message;
        field.select();
      }
    });
  });
}
