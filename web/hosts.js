// Print hosts that the user has entered: addresses and keys stay in this browser, requests go from a worker straight to the host.

import { EngineError } from "./engine.js";
import { Caller } from "./caller.js";

const KEPT = "print-hosts";
/** Whom a page may ask where the user lets it: PrusaLink answers no page but its own. */
const KINDS = { octoprint: "OctoPrint", moonraker: "Moonraker (Klipper)", duet: "Duet (RepRapFirmware)" };

/** A worker from an address of the page's own making has the page's policy: it may ask no one else. */
function started() {
  const script = new Blob([`import ${JSON.stringify(new URL("./host-worker.js", import.meta.url))};`], { type: "text/javascript" });
  const url = URL.createObjectURL(script), worker = new Worker(url, { type: "module" });
  worker.addEventListener("message", () => URL.revokeObjectURL(url), { once: true });
  return worker;
}

export class Hosts {
  /** `compiled`: promises the module. */
  constructor(compiled) {
    this.compiled = compiled;
    this.kinds = KINDS;
  }

  /** All of them, with their keys. */
  get kept() {
    return JSON.parse(localStorage.getItem(KEPT) ?? "[]");
  }

  set kept(hosts) {
    localStorage.setItem(KEPT, JSON.stringify(hosts));
  }

  list = () => this.kept.map(({ name, kind, url }) => ({ name, kind, url }));

  /** Keeps a host. The page must be loaded again until it may ask it. */
  async add(host) {
    const named = { ...host, name: host.name.trim() || new URL(/^https?:/.test(host.url) ? host.url : `http://${host.url}`).host };
    const url = await this.call("hostAddress", this.described(named));
    this.kept = [...this.kept.filter(({ name }) => name !== named.name), { ...named, url }];
  }

  remove(name) {
    this.kept = this.kept.filter((host) => host.name !== name);
  }

  state = async (name) => this.call("hostState", this.described(this.find(name)));
  print = async (name, wanted, gcode) => this.call("hostPrint", this.described(this.find(name)), JSON.stringify(wanted), new Uint8Array(await gcode.arrayBuffer()));

  find(name) {
    const host = this.kept.find((one) => one.name === name);
    if (!host) throw new EngineError({ kind: "not_found", message: `there is no host \`${name}\`` }, 404);
    return host;
  }

  described = (host) => JSON.stringify({ ...host, origin: location.origin });

  async call(name, ...args) {
    if (!this.worker || this.worker.ended) this.worker = new Caller(started, { ...(await this.compiled()), threads: 1 });
    return this.worker.call(name, ...args);
  }
}
