// Keeps desk and engine together: whatever happens to the one reaches the other, also after the engine was gone.

import { EngineError } from "./engine.js";
import { complete, freePlace, isPlaced, withFile } from "./project.js";

const pause = (ms) => new Promise((done) => setTimeout(done, ms));
/** An engine that is silent for so long is gone; it says at least every 15 s that it is there. */
const RETRY_MS = [300, 700, 1500, 3000];

export class Connection {
  constructor(engine, desk, memory, askToken) {
    Object.assign(this, { engine, desk, memory, askToken, sending: null, wanted: null, failures: 0 });
    /** Fulfilled as soon as there is a plate. */
    this.ready = new Promise((done) => { this.isReady = done; });
    desk.on("project again", () => this.send());
  }

  /** Runs as long as the page. */
  async run() {
    for (;;) {
      try {
        if (!this.engine.session) await this.begin();
        await this.engine.events(this.handlers());
      } catch (error) {
        await this.recover(error);
      }
    }
  }

  /** A new plate, with all that this page has. */
  async begin() {
    const { engine, desk } = this;
    desk.version = await engine.open();
    if (!desk.schema) {
      [desk.schema, desk.profiles] = await Promise.all([engine.schema(), engine.profiles()]);
      desk.tell("schema");
    }
    const kept = this.begun ? null : await this.memory.last();
    if (kept) desk.files = kept.files;
    // A project is one file of several names.
    for (const blob of new Set([...desk.files.values()].map((file) => file.blob))) await engine.addModel(blob.name, blob);
    Object.assign(desk, { revision: 0, done: null, sent: null });
    if (kept) desk.restore(kept.project);
    else if (!this.begun) await this.openGiven();
    this.begun = true;
    this.isReady();
  }

  /** What the program was started with. */
  async openGiven() {
    for (const { name, read } of await this.engine.opened()) {
      const [problem] = await this.add([new File([await read()], name)]);
      if (problem) this.desk.tell("problem", problem);
    }
  }

  async recover(error) {
    const { engine, desk } = this;
    if (!(error instanceof EngineError)) throw error;
    if (error.status === 401) return this.askToken();
    if (error.status === 404 || error.status === 410) engine.session = null;
    // It may have been started anew and know nothing of this plate.
    desk.setState("offline", error);
    await pause(RETRY_MS[Math.min(this.failures++, RETRY_MS.length - 1)]);
  }

  handlers() {
    const { desk } = this;
    // Those of a comparison are no news of the plate.
    const of = (name, handle) => (event) => (event.side ? desk.tell("side", { name, event }) : desk.newer(event) && handle(event));
    return {
      connected: () => {
        this.failures = 0;
        desk.setState("idle");
        this.send();
      },
      resolved: of("resolved", (event) => {
        desk.resolved = event;
        desk.tell("resolved");
        if (event.problems.length) desk.setState("failed", { kind: "settings", message: event.problems[0].message });
      }),
      placed: of("placed", (event) => {
        desk.placed = event;
        desk.tell("placed");
      }),
      progress: of("progress", (event) => {
        desk.progress = event;
        desk.setState("busy");
      }),
      walls: of("walls", (event) => desk.tell("walls", event)),
      done: of("done", (event) => {
        desk.done = event;
        desk.setState(this.wanted || desk.sent !== desk.project ? "busy" : "done");
        desk.tell("done", event);
      }),
      failed: of("failed", (event) => {
        if (event.error.kind !== "cancelled") desk.setState("failed", event.error);
      }),
    };
  }

  /** Gives the present project to the engine: one at a time, and of several the last. */
  send() {
    this.wanted = this.desk.project;
    if (!this.engine.session || this.desk.state === "offline") return null;
    this.sending ??= this.sendAll().finally(() => { this.sending = null; });
    return this.sending;
  }

  async sendAll() {
    try {
      while (this.wanted) {
        const project = this.wanted;
        this.wanted = null;
        this.desk.setState(project.models.length ? "busy" : "idle");
        const revision = await this.engine.setProject(project);
        this.desk.sent = project;
        // Its events may have been quicker than this answer, and so may those of the one before.
        if (revision > this.desk.revision) {
          this.desk.newer({ revision });
          this.desk.setState(project.models.length ? "busy" : "idle");
        } else if (this.desk.done?.revision === revision) this.desk.setState("done");
      }
    } catch (error) {
      if (!(error instanceof EngineError)) throw error;
      if (error.status >= 400 && error.status !== 404 && error.status !== 401) this.desk.setState("failed", error);
    }
  }

  /** Adds files, models and projects, and gives what went wrong. */
  async add(files) {
    const { desk } = this, problems = [];
    for (const file of files) {
      try {
        const answer = await this.upload(file);
        if (answer.project) desk.replace(complete(answer.project));
        else desk.change(withFile(desk.project, answer.file, this.place(answer.objects)));
        desk.select([desk.project.models.length - 1].filter((i) => i >= 0));
      } catch (error) {
        if (!(error instanceof EngineError)) throw error;
        problems.push(error.offline ? new EngineError({ message: `${file.name} was not added: ${error.message}` }) : error);
      }
    }
    return problems;
  }

  async upload(file) {
    const { files } = this.desk, alike = ({ blob }) => blob.name === file.name && blob.size === file.size && blob.lastModified === file.lastModified;
    const known = [...files].find(([, other]) => alike(other) && !other.project);
    if (known) return { file: known[0], objects: known[1].objects, project: null };
    const answer = await this.engine.addModel(file.name, file);
    for (const part of answer.files ?? [answer]) files.set(part.file, { blob: file, objects: part.objects, bytes: part.bytes, project: Boolean(answer.project) });
    return answer;
  }

  /** A free place where everything else has its own. */
  place(objects) {
    const { desk } = this, bed = desk.resolved?.bed;
    if (!bed || !isPlaced(desk.project) || objects.length !== 1) return {};
    return { at_mm: freePlace(bed, desk.boxes(desk.project), objects[0].size_mm) };
  }
}
