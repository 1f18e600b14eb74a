// The caller's side of a worker: calls by name, answered one after the other.

/** Why something was not done. `kind`: usage, input, settings, does_not_fit, check, not_found, limit or internal. */
export class PathwrightError extends Error {
  constructor({ kind = "internal", message, ...rest }) {
    super(message);
    Object.assign(this, { name: "PathwrightError", kind, ...rest });
  }
}

export class Caller {
  /** `worker`: of either platform; `module`: compiled; `on(event, data, bytes, file)`: told of whatever happens meanwhile. */
  constructor(worker, module, on = () => {}) {
    Object.assign(this, { worker, on, waiting: new Map(), last: 0, ended: null });
    worker.onmessage = ({ data }) => this.take(data);
    worker.onerror = (event) => this.end(new PathwrightError({ message: event.message ?? "the worker could not be started" }));
    worker.postMessage({ module });
  }

  call(name, ...args) {
    if (this.ended) return Promise.reject(this.ended);
    const id = ++this.last;
    return new Promise((done, fail) => {
      this.waiting.set(id, { done, fail });
      this.worker.postMessage({ id, name, args });
    });
  }

  take({ id, value, error, event, data, bytes, file }) {
    if (event) return this.on(event, data, bytes, file);
    const { done, fail } = this.waiting.get(id);
    if (error?.fatal) return this.end(new PathwrightError(error));
    this.waiting.delete(id);
    return error ? fail(new PathwrightError(error)) : done(value);
  }

  /** Ends the worker, and with this error whatever it was to do. */
  end(error) {
    if (this.ended) return;
    this.ended = error;
    this.worker.terminate();
    for (const { fail } of this.waiting.values()) fail(error);
    this.waiting.clear();
    this.on("ended", error);
  }
}
