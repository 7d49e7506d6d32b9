// The life of the page's Python: it is started, given one cell at a time, interrupted, and ended.

// Milliseconds. Before Python's thread reports anything, it and the files that it starts with have to be fetched.
const SILENCE = 18_000;
// A run that cannot be interrupted in this time is ended, and everything that it has defined is lost.
const PATIENCE = 2500;
// Python that has read the interrupt but goes on is interrupted again after this time: an interrupt between the two
// steps of its check is lost, and so is one during the deletion of an object.
const LONGER = 5000;

export class Python {
  constructor(place, listener) {
    this.listener = listener;
    this.jobs = 0;
    // Shared memory, through which Python is asked to stop, is available to isolated pages only.
    this.interrupts = globalThis.crossOriginIsolated && typeof SharedArrayBuffer === "function" ? new Uint8Array(new SharedArrayBuffer(1)) : null;
    this.worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    this.ready = new Promise((resolve, reject) => {
      this.giveUp = reject;
      this.worker.addEventListener("message", ({ data }) => this.hear(data, resolve, reject));
      this.worker.addEventListener("error", (event) => {
        event.preventDefault();
        this.end(event.message || "its script could not be loaded", { isLost: !event.message });
      });
    });
    this.ready.catch(() => {});
    this.watchSilence();
    this.worker.postMessage({ type: "start", ...place, interrupts: this.interrupts?.buffer });
  }

  watchSilence() {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => this.end("the server of these pages has sent nothing for 18 seconds"), SILENCE);
  }

  hear(data, resolve, reject) {
    if (data.type === "progress" && !this.compiling) this.watchSilence();
    else clearTimeout(this.silence);
    this.compiling ||= data.type === "compiling";
    if (data.type === "ready") resolve(data);
    else if (data.type === "done") this.finish(data.outcome);
    else if (data.type === "dead") {
      this.end(data.reason, { isLost: true });
    } else if (data.job === undefined || data.job === this.current?.job) this.listener(data, this.current?.show);
  }

  // Run code and resolve to the outcome. ``kept`` are the files of coursework; ``show`` is given each output as it comes.
  run(code, name, needs, show, retry, kept) {
    return new Promise((settle) => {
      this.current = { job: ++this.jobs, settle, show };
      if (this.interrupts) this.interrupts[0] = 0;
      this.worker.postMessage({ type: "run", job: this.current.job, code, name, needs, retry, kept });
    });
  }

  // Put files into the folder ``dropped``, in place of the files before.
  put(files) {
    this.worker.postMessage({ type: "files", files });
  }

  // Tell a widget's Python side what has changed on the page. It is processed before the next run.
  tell(name, data) {
    this.worker.postMessage({ type: "widget", name, data });
  }

  finish(outcome) {
    clearTimeout(this.timer);
    this.current?.settle(outcome);
    this.current = null;
  }

  interrupt(again = true) {
    if (!this.interrupts || !this.current) return this.end("interrupted");
    this.interrupts[0] = 2; // SIGINT
    clearTimeout(this.timer);
    const giveUp = () => this.end("interrupted");
    // Python resets the number when it reads it.
    this.timer = setTimeout(() => {
      if (this.interrupts[0]) giveUp();
      else this.timer = setTimeout(() => (again ? this.interrupt(false) : giveUp()), LONGER);
    }, PATIENCE);
  }

  // End the thread; what runs in it gets this outcome. ``about`` says whether a file may be lost.
  end(reason, about) {
    clearTimeout(this.silence);
    this.worker.terminate();
    this.ended = true;
    this.giveUp(Object.assign(new Error(reason), about));
    this.finish({ status: "ended", reason });
  }
}
