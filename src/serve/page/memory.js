// Keeps the plate of this tab over a reload, in the browser's own database. Without one, a reload begins anew.

const PLATES = "plates", FILES = "files";
/** Plates of tabs that were closed are forgotten after so many days. */
const DAYS = 7;

export class Memory {
  constructor(desk) {
    this.desk = desk;
    this.id = sessionStorage.getItem("plate");
    this.written = new Set();
    this.pending = null;
    desk.on("project", () => this.keep());
    // A page that goes away does not wait.
    addEventListener("pagehide", () => this.write().catch(() => {}));
  }

  /** What was on the plate before the reload: a project and its files by name; null: nothing. */
  async last() {
    try {
      this.base = await opened();
      await this.forgetOld();
      if (!this.id) return null;
      const plate = await answer(this.store(PLATES).get(this.id));
      if (!plate?.project.models.length) return null;
      const range = IDBKeyRange.bound([this.id], [this.id, []]);
      const [keys, values] = await Promise.all([answer(this.store(FILES).getAllKeys(range)), answer(this.store(FILES).getAll(range))]);
      const files = new Map(keys.map(([, name], i) => [name, values[i]]));
      // Of several names of one file, one is enough to send it again.
      const blobs = new Map();
      for (const file of files.values()) {
        const alike = `${file.blob.name}/${file.blob.size}/${file.blob.lastModified}`;
        if (!blobs.has(alike)) blobs.set(alike, file.blob);
        file.blob = blobs.get(alike);
      }
      if (plate.project.models.some(({ file }) => !files.has(file))) return null;
      this.written = new Set(files.keys());
      return { project: plate.project, files };
    } catch {
      return null;
    }
  }

  /** Writes what is on the plate; of several changes in a row the first and the last. `pending` until it is written. */
  keep() {
    this.changed = true;
    this.pending ??= this.soon().finally(() => { this.pending = null; });
  }

  async soon() {
    while (this.changed) {
      await this.write().catch(() => {});
      await new Promise((done) => setTimeout(done, 200));
    }
  }

  /** Writes what is on the plate now, all of it or nothing. */
  async write() {
    const { changed } = this;
    this.changed = false;
    if (!this.base || !changed) return;
    if (!this.id) sessionStorage.setItem("plate", this.id = crypto.randomUUID());
    const { project, files } = this.desk, fresh = new Set(project.models.map(({ file }) => file).filter((file) => files.has(file) && !this.written.has(file)));
    const writing = this.base.transaction([FILES, PLATES], "readwrite");
    for (const file of fresh) writing.objectStore(FILES).put(files.get(file), [this.id, file]);
    writing.objectStore(PLATES).put({ project, at: Date.now() }, this.id);
    writing.commit();
    await new Promise((done, fail) => Object.assign(writing, { oncomplete: done, onabort: () => fail(writing.error) }));
    for (const file of fresh) this.written.add(file);
  }

  async forgetOld() {
    const keys = await answer(this.store(PLATES).getAllKeys());
    for (const key of keys) {
      const plate = await answer(this.store(PLATES).get(key));
      if (key === this.id || plate.at > Date.now() - DAYS * 864e5) continue;
      await answer(this.store(FILES, "readwrite").delete(IDBKeyRange.bound([key], [key, []])));
      await answer(this.store(PLATES, "readwrite").delete(key));
    }
  }

  store(name, mode = "readonly") {
    return this.base.transaction(name, mode).objectStore(name);
  }
}

/** What comes of a request to the database. */
export const answer = (request) => new Promise((done, fail) => {
  request.onsuccess = () => done(request.result);
  request.onerror = () => fail(request.error);
});

function opened() {
  const request = indexedDB.open("pathwright", 1);
  request.onupgradeneeded = () => [PLATES, FILES].forEach((name) => request.result.createObjectStore(name));
  return answer(request);
}
