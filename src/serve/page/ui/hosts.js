// Print hosts: what each of them does, and the print on the plate for one of them.

import { element, find } from "../view.js";
import { addingHost, forgetting } from "./adding-host.js";
import { attempt, notify } from "./notices.js";

const ASKED_MS = 2000;
const pause = (ms) => new Promise((done) => setTimeout(done, ms));
const minutes = (seconds) => (seconds < 3600 ? `${Math.ceil(seconds / 60)} min` : `${Math.floor(seconds / 3600)} h ${Math.ceil((seconds / 60) % 60)} min`);

/** What a printer does, in a line. */
export function told({ activity, message, printing, ended }) {
  const runs = activity === "printing" || activity === "paused", words = [activity];
  if (!runs) return ended && ended !== "done" ? `${activity}, the last print ${ended}` : activity === "ready" ? activity : `${activity}: ${message}`;
  if (printing.file) words.push(printing.file);
  if (printing.progress !== null) words.push(`${Math.round(printing.progress * 100)} %`);
  if (printing.layer) words.push(printing.layers ? `layer ${printing.layer} of ${printing.layers}` : `layer ${printing.layer}`);
  if (printing.left_s !== null) words.push(`${minutes(printing.left_s)} left`);
  return words.join(", ");
}

export class PrintHosts {
  constructor(desk, engine) {
    Object.assign(this, { desk, engine, rows: new Map(), busy: false });
    this.dialog = find("printing");
    find("print").addEventListener("click", () => this.open());
    desk.on("state done", () => { find("print").disabled = !desk.current || desk.state !== "done"; });
    desk.on("schema", () => this.look());
  }

  /** The button is there where hosts are. */
  async look() {
    this.hosts = (await attempt(() => this.engine.hosts())) ?? [];
    find("print").hidden = !this.hosts.length && !this.engine.addHost;
  }

  async open() {
    await this.look();
    if (!this.hosts.length && !this.engine.addHost) return;
    const chosen = localStorage.getItem("print-host");
    this.rows = new Map(this.hosts.map((host, index) => {
      const pick = element("input", { type: "radio", name: "host", value: host.name, required: true, checked: host.name === chosen || (index === 0 && !this.hosts.some(({ name }) => name === chosen)) });
      return [host.name, { pick, state: element("span", { class: "soft" }, "asking…") }];
    }));
    const list = this.hosts.map(({ name, kind, url }) => {
      const { pick, state } = this.rows.get(name);
      const forget = this.engine.addHost ? [forgetting(this.engine, name, () => this.open())] : [];
      return element("p", {}, element("label", { title: `${kind}, ${url}` }, pick, ` ${name}: `, state), ...forget);
    });
    this.start = element("input", { type: "checkbox", id: "print-start" });
    this.replace = element("input", { type: "checkbox", id: "print-replace" });
    this.said = element("p", { role: "status", id: "print-said" });
    this.bar = element("progress", { id: "print-bar", max: 100, value: 0, hidden: true, "aria-label": "Sent" });
    this.send = element("button", { class: "main", id: "print-send", disabled: !this.hosts.length }, "Send");
    const form = element("form", {}, element("h2", {}, "Print"), ...list,
      element("p", {}, element("label", {}, this.start, " Start it when it is there")),
      element("p", {}, element("label", {}, this.replace, " Replace a file of the same name")),
      this.said, this.bar,
      element("div", { class: "row" }, this.send, element("button", { type: "button", id: "print-close", onclick: () => this.dialog.close() }, "Close")));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.print();
    });
    this.dialog.replaceChildren(form, ...(this.engine.addHost ? [addingHost(this.engine, !this.hosts.length)] : []));
    if (!this.dialog.open) this.dialog.showModal();
    for (const { name } of this.hosts) this.follow(name);
  }

  /** Shows what a host does as long as the dialog is open. */
  async follow(name) {
    const row = this.rows.get(name);
    while (this.dialog.open && this.rows.get(name) === row) {
      try {
        row.state.textContent = told((await this.engine.host(name)).state);
      } catch (error) {
        row.state.textContent = error.message;
      }
      await pause(ASKED_MS);
    }
  }

  async print() {
    const { desk, engine } = this, [name] = [...this.rows].find(([, { pick }]) => pick.checked);
    localStorage.setItem("print-host", name);
    const start = this.start.checked;
    this.send.disabled = true;
    this.said.textContent = "Sending…";
    try {
      const file = desk.done.name, gcode = await engine.gcodeFile(desk.done);
      const size = `${(gcode.size / 1e6).toFixed(1)} MB`;
      const sent = await engine.print(name, { file, start, replace: this.replace.checked }, gcode, ({ percent }) => {
        Object.assign(this.bar, { hidden: false, value: percent });
        this.said.textContent = percent < 100 ? `Sending: ${percent} % of ${size}` : `All of ${size} is sent; ${name} stores it…`;
      });
      for (const warning of sent.warnings) notify(warning);
      this.said.textContent = start ? `${sent.name} prints on ${name}.` : `${sent.name} is stored on ${name}.`;
    } catch (error) {
      this.said.textContent = error.message;
    }
    this.bar.hidden = true;
    this.send.disabled = false;
  }
}
