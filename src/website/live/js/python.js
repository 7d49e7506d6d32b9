// The life of the page's Python: started, given one cell at a time, interrupted, ended.

// A run that cannot be interrupted in this time is ended, and everything that it knew with it.
const PATIENCE = 700;

export class Python {
  constructor(runtime, listener) {
    this.listener = listener;
    this.jobs = 0;
    // Shared memory, through which Python is asked to stop, is given to isolated pages only.
    this.interrupts = globalThis.crossOriginIsolated ? new Uint8Array(new SharedArrayBuffer(1)) : null;
    this.worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    this.ready = new Promise((resolve, reject) => {
      this.giveUp = reject;
      this.worker.addEventListener("message", ({ data }) => this.hear(data, resolve, reject));
      this.worker.addEventListener("error", (event) => {
        event.preventDefault();
        this.end(event.message || "its script could not be loaded");
        reject(new Error(event.message || "its script could not be loaded"));
      });
    });
    this.ready.catch(() => {});
    this.worker.postMessage({ type: "start", runtime, interrupts: this.interrupts?.buffer });
  }

  hear(data, resolve, reject) {
    if (data.type === "ready") resolve(data);
    else if (data.type === "done") this.finish(data.outcome);
    else if (data.type === "dead") {
      this.end(data.reason);
      reject(new Error(data.reason));
    } else if (data.job === undefined || data.job === this.current?.job) this.listener(data, this.current?.show);
  }

  // Run code; ``show`` is given each output as it comes. Resolves to the outcome.
  run(code, name, needs, show) {
    return new Promise((settle) => {
      this.current = { job: ++this.jobs, settle, show };
      if (this.interrupts) this.interrupts[0] = 0;
      this.worker.postMessage({ type: "run", job: this.current.job, code, name, needs });
    });
  }

  finish(outcome) {
    clearTimeout(this.timer);
    this.current?.settle(outcome);
    this.current = null;
  }

  interrupt() {
    if (!this.interrupts || !this.current) return this.end("interrupted");
    this.interrupts[0] = 2; // SIGINT
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.end("interrupted"), PATIENCE);
  }

  // End the thread; what runs in it has no outcome but this one.
  end(reason) {
    this.worker.terminate();
    this.ended = true;
    this.giveUp(new Error(reason));
    this.finish({ status: "ended", reason });
  }
}
