// The caller's side of a worker, or of several that share memory: calls by name, answered one after the other.

/** Why something was not done. `kind`: usage, input, settings, does_not_fit, check, not_found, limit or internal. */
export class PathwrightError extends Error {
  constructor({ kind = "internal", message, ...rest }) {
    super(message);
    Object.assign(this, { name: "PathwrightError", kind, ...rest });
  }
}

/** More than these wait for each other too often: they share one allocator. */
export const MOST_THREADS = 8;

export class Caller {
  /** `started()`: a worker of either platform; `compiled`: the module and `threads`; `on(event, data, bytes, file)`: told of whatever happens meanwhile. */
  constructor(started, compiled, on = () => {}) {
    Object.assign(this, { started, compiled, on, workers: [], waiting: new Map(), last: 0, ended: null });
    this.begin(compiled);
  }

  begin(first) {
    const worker = this.started();
    worker.onmessage = ({ data }) => this.take(data);
    worker.onerror = (event) => this.end(new PathwrightError({ message: event.message ?? "the worker could not be started" }));
    worker.postMessage(first);
    this.workers.push(worker);
  }

  /** The one that is called. */
  get worker() {
    return this.workers[0];
  }

  call(name, ...args) {
    if (this.ended) return Promise.reject(this.ended);
    const id = ++this.last;
    return new Promise((done, fail) => {
      this.waiting.set(id, { done, fail });
      this.worker.postMessage({ id, name, args });
    });
  }

  take({ id, value, error, event, data, bytes, file, memory, others }) {
    if (event) return this.on(event, data, bytes, file);
    if (error?.fatal) return this.end(new PathwrightError(error));
    if (memory) {
      while (this.workers.length <= others) this.begin({ ...this.compiled, memory });
      return;
    }
    const { done, fail } = this.waiting.get(id);
    this.waiting.delete(id);
    return error ? fail(new PathwrightError(error)) : done(value);
  }

  /** Ends the workers, and with this error whatever they were to do. */
  end(error) {
    if (this.ended) return;
    this.ended = error;
    for (const worker of this.workers) worker.terminate();
    for (const { fail } of this.waiting.values()) fail(error);
    this.waiting.clear();
    this.on("ended", error);
  }
}
