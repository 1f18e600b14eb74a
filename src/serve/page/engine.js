// What slices: the only file that knows the service. Another engine has the same methods and answers.

/** Why something was refused, as the service tells it. */
export class EngineError extends Error {
  constructor({ kind = "internal", message, ...rest }, status = 0) {
    super(message);
    Object.assign(this, { kind, status, ...rest });
  }

  /** Whether nobody answered at all. */
  get offline() {
    return this.kind === "offline";
  }
}

export class Engine {
  constructor() {
    this.session = null;
    this.token = sessionStorage.getItem("token");
  }

  // What all plates share.

  schema = () => this.json("/v1/schema");
  profiles = () => this.json("/v1/profiles");
  /** Another slicer's configuration as a profile of ours. */
  convert = async (name, text) => (await this.request(`/v1/profiles/convert?name=${encodeURIComponent(name)}`, { method: "POST", body: text })).text();
  printers = (words) => this.json(`/v1/printers?q=${encodeURIComponent(words)}`);
  printer = (name) => this.json(`/v1/printers/${encodeURIComponent(name)}`);

  /** Print hosts; what one of them does. */
  hosts = () => this.json("/v1/hosts");
  host = (name) => this.json(`/v1/hosts/${encodeURIComponent(name)}`);

  /** G-code for a print host: calls `sent({ percent })` meanwhile, and gives what has become of it. */
  async print(name, wanted, gcode, sent) {
    const answer = await this.request(`/v1/hosts/${encodeURIComponent(name)}/prints?${new URLSearchParams(wanted)}`, { method: "POST", body: gcode });
    let end = null;
    const done = (told) => { end = told; };
    await listen(answer, { sent, done, failed: ({ error }) => { throw new EngineError(error); } });
    return end ?? lost();
  }

  /** Takes a token for this and the following requests, downloads too. */
  async login(token) {
    await this.request("/v1/login", put("POST", { token }));
    this.token = token;
    sessionStorage.setItem("token", token);
  }

  /** Files that the program was started with: `name` and what gives the bytes. */
  async opened() {
    const list = await this.json("/v1/opened");
    return list.map(({ name }, index) => ({ name, read: async () => (await this.request(`/v1/opened/${index}`)).blob() }));
  }

  // One plate.

  /** Opens a plate and gives the version of what answers. */
  async open() {
    const { session, version } = await this.json("/v1/sessions", { method: "POST" });
    this.session = session;
    return version;
  }

  /** Ends the plate, also while the page goes away. */
  close() {
    if (this.session) this.request(this.at("").slice(0, -1), { method: "DELETE", keepalive: true }).catch(() => {});
  }

  /** Adds a file: its name on the plate, its objects, and the project in it, if any. */
  addModel = (name, bytes) => this.json(this.at(`models?name=${encodeURIComponent(name)}`), { method: "POST", body: bytes });

  /** The triangles of an object: `vertices` (three numbers each, mm) and `triangles` (three indices each). */
  async mesh(file, object) {
    const answer = await this.request(this.at(`models/${encodeURIComponent(file)}/mesh?object=${object}`));
    return readMesh(await answer.arrayBuffer());
  }

  /** Faces that an object can stand on. */
  faces = async (file, object) => (await this.json(this.at(`models/${encodeURIComponent(file)}/faces?object=${object}`))).faces;

  /** Slices a project from now on, and no other. Gives its revision. */
  setProject = async (project) => (await this.json(this.at("project"), put("PUT", project))).revision;

  arrange = (project) => this.json(this.at("arrange"), put("POST", project));
  orient = (project, model) => this.json(this.at(`orient?model=${model}`), put("POST", project));
  compare = (a, b) => this.json(this.at("compare"), put("POST", { a, b }));

  /** The bytes of a packed preview that an event has named. */
  async preview(event) {
    return (await this.request(event.url)).arrayBuffer();
  }

  /** Where to get files: addresses that the browser can save. */
  gcode = (event) => event.gcode;
  /** The same as a blob. */
  gcodeFile = async (event) => (await this.request(event.gcode)).blob();
  projectFile = async () => this.at("project.3mf");
  profileFile = async () => this.at("profile.toml");

  /**
   * Calls `on[event](data)` for everything that happens on the plate, until the signal is given or the connection ends,
   * which is an error.
   */
  async events(on, signal) {
    const answer = await this.request(this.at("events"), { signal, headers: { accept: "text/event-stream" } });
    on.connected?.();
    await listen(answer, on);
    lost();
  }

  at(path) {
    return `/v1/sessions/${this.session}/${path}`;
  }

  async json(path, options) {
    return (await this.request(path, options)).json();
  }

  async request(path, options = {}) {
    const headers = { ...options.headers, ...(this.token ? { authorization: `Bearer ${this.token}` } : {}) };
    const answer = await fetch(path, { ...options, headers, credentials: "same-origin", cache: "no-store" }).catch((error) => {
      if (error.name === "AbortError") throw error;
      return lost();
    });
    if (answer.ok) return answer;
    const text = await answer.text().catch(() => "");
    let error = null;
    try {
      error = JSON.parse(text).error;
    } catch {
      // Something between us and the service has answered.
    }
    throw new EngineError(error ?? { message: `the service answers ${answer.status} ${answer.statusText}` }, answer.status);
  }
}

const put = (method, value) => ({ method, body: JSON.stringify(value), headers: { "content-type": "application/json" } });

function lost() {
  throw new EngineError({ kind: "offline", message: "the service does not answer" });
}

/** Hands on the events of an answer until it ends. */
async function listen(answer, on) {
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read().catch(lost);
    if (done) return;
    const messages = (rest + value).replaceAll("\r", "").split("\n\n");
    rest = messages.pop();
    for (const message of messages) deliver(message, on);
  }
}

/** Hands an event on; lines that begin with a colon say only that someone is there. */
function deliver(message, on) {
  let name = "message";
  const data = [];
  for (const line of message.split("\n")) {
    const [, field, value] = /^([^:]*):? ?(.*)$/.exec(line);
    if (field === "event") name = value;
    else if (field === "data") data.push(value);
  }
  if (data.length) on[name]?.(JSON.parse(data.join("\n")));
}

/** A mesh as it is packed. */
export function readMesh(buffer) {
  const head = new DataView(buffer), magic = String.fromCharCode(...new Uint8Array(buffer, 0, 4));
  if (magic !== "PWM1") throw new EngineError({ message: "the service sends a mesh that this page does not know; load the page anew" });
  const vertices = head.getUint32(4, true), triangles = head.getUint32(8, true);
  return { vertices: new Float32Array(buffer, 12, 3 * vertices), triangles: new Uint32Array(buffer, 12 + 12 * vertices, 3 * triangles) };
}
