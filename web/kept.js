// What the browser keeps of this machine for the next visit: folders of presets. Where it keeps nothing, they last as long as the page.

import { answer } from "./memory.js";

const PRESETS = "presets";

export class Kept {
  constructor() {
    this.folders = new Map();
    this.base = opened().catch(() => null);
  }

  /** Folders by name, each with the paths, lengths and bytes of its files. */
  async presets() {
    const base = await this.base;
    if (base && !this.isRead) {
      const store = base.transaction(PRESETS).objectStore(PRESETS), [names, folders] = await Promise.all([answer(store.getAllKeys()), answer(store.getAll())]);
      names.forEach((name, i) => this.folders.set(name, folders[i]));
    }
    this.isRead = true;
    return this.folders;
  }

  /** Keeps a folder; null: forgets it. */
  async setPresets(name, folder) {
    if (folder) this.folders.set(name, folder);
    else this.folders.delete(name);
    // What is kept should outlast a full disk.
    navigator.storage?.persist?.().catch(() => {});
    const base = await this.base, store = base?.transaction(PRESETS, "readwrite").objectStore(PRESETS);
    if (store) await answer(folder ? store.put(folder, name) : store.delete(name)).catch(() => {});
  }
}

function opened() {
  const request = indexedDB.open("pathwright-machine", 1);
  request.onupgradeneeded = () => request.result.createObjectStore(PRESETS);
  return answer(request);
}
