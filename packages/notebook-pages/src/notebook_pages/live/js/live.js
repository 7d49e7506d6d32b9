// Loaded when the reader first asks to run code: the page's cells, the bar below, and the order of runs.
import { Cell } from "./cell.js";
import { Answers, coursework, nameCells, store } from "./answers.js";
import { named } from "./names.js";
import { agreeOnRecords, bringTogether, readCopy } from "./notebooks.js";
import { Figures } from "./figures.js";
import { element, preformatted } from "./output.js";
import { Python } from "./python.js";
import { fingerprint, NEWER } from "./store.js";

// A cell that shows a question in a variant.
const SHOWS = /\bvariant\(\s*["']/;
const plural = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;

class Page {
  constructor({ data, boxes, bar }) {
    this.place = { runtime: new URL(data.runtime, location.href).href, pyodide: data.pyodide, lock: data.lock };
    this.answers = new Answers(data.page);
    this.variants = data.variants;
    this.bar = bar;
    this.figures = new Figures((name, data) => this.python?.tell(name, data));
    this.cells = boxes.map((box, index) => new Cell(box, index + 1, data.cells[index] ?? {}, this));
    const ids = nameCells(this.cells.map(({ kind, original }) => ({ name: kind.name, original })));
    this.cells.forEach((cell, index) => (cell.id = ids[index]));
    for (const cell of this.cells) if (cell.box.matches(".tag_takes-file")) this.askForFiles(cell);
    this.queue = [];
    this.buttons = bar.buttons({
      "Run the page": () => this.run(),
      Stop: () => this.stop(),
      "Start afresh": () => this.reset(),
      "Book’s code": () => this.askToUndo(),
    });
    this.show();
  }

  // Create the editors while Python is being loaded, which takes longer.
  edit() {
    for (const cell of this.cells) cell.edit();
    this.askWho();
  }

  // Open the editor of a cell, with the cursor at the point that was clicked, or at the end. ``field`` contains what
  // was typed before the editor existed (see page.js).
  write(cell, point, field) {
    const stays = document.activeElement === field;
    cell.edit();
    const { editor } = cell, end = editor.state.doc.length;
    const anchor = point ? editor.posAtCoords(point, false) : end;
    editor.dispatch({ selection: field.all ? { anchor: 0, head: end } : { anchor } });
    if (field.value) editor.dispatch(editor.state.replaceSelection(field.value));
    if (stays) editor.focus();
    if (point) editor.setTabFocusMode(false);
    if (field.readOnly) this.run(cell);
  }

  // If the questions of the page have variants, ask once for the reader's ID; then all pages, and Python, know it.
  askWho() {
    const cell = this.cells.find(({ original }) => /^student\(/m.test(original));
    if (!cell || this.who?.contains(document.activeElement)) return;
    const name = coursework.read("me.txt")?.text ?? "";
    const field = Object.assign(element("input"), { value: name, name: "student", autocomplete: "email", spellcheck: false });
    const label = element("label", "", "Your ID in your course: ", field);
    const button = element("button", "", name ? "Change" : "Give me my own numbers");
    const words = name ? `These pages use the numbers of ${name}.` : "Your ID stays in this browser.";
    const form = element("form", "live-note live-choice live-who", element("p", "", words), label, " ", button);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (field.value.trim() === name) return;
      coursework.write("me.txt", field.value.trim());
      field.blur();
      button.blur();
      this.tellWhose();
      this.bar.say(field.value.trim() ? "From the next run on, you get your own numbers." : "From the next run on, you get the default numbers.");
    });
    if (this.who) this.who.replaceWith(form);
    else cell.input.after(form);
    this.who = form;
  }

  // Keep the text of a question with the reader's own numbers, to show it when the page is opened the next time.
  keepGiven(cell) {
    const { student } = store;
    if (student && cell.given !== undefined && SHOWS.test(cell.original)) {
      this.answers.keepGiven(cell.id, { student, text: cell.given, original: fingerprint(cell.original), variants: this.variants });
    }
  }

  // After a change of the ID, show neither the numbers of another ID nor replies to them as the reader's own.
  tellWhose() {
    for (const cell of this.cells) {
      cell.ran = false;
      if (SHOWS.test(cell.original) && cell.box.dataset.whose !== store.student) cell.restore();
    }
    this.bar.tellWhatIsKnown();
    this.showGiven();
    this.askWho();
  }

  showGiven() {
    for (const cell of this.cells) {
      const text = this.answers.givenTo(store.student, cell.id, cell.original, this.variants);
      if (text) cell.showGiven(store.student, text);
    }
  }

  // Mark a reply to an answer that has changed, until its check runs again.
  doubt(cell, changed) {
    const check = this.cells.slice(cell.number).find(({ code }) => /\bcheck\(/.test(code));
    check?.output.querySelector(":scope > .live-outdated")?.remove();
    if (!changed || !check?.output.querySelector(":scope > :not(.live-others) .coursework-reply:not([data-outcome='not attempted'])")) return;
    check.output.prepend(element("p", "live-known live-outdated", "This is the reply to an earlier answer. When the answer above runs without an error, run this cell to check it."));
  }

  // --- the reader's edits ----------------------------------------------------------------------

  // Store the text of one cell that has changed here, and no other.
  keep(cell) {
    const { id, number, original, code } = cell;
    let kept = true;
    if (cell.edited) {
      kept = this.answers.write(id, { code, number, original: fingerprint(original), at: Date.now() }, cell.known);
    } else {
      kept = this.answers.remove(id);
    }
    cell.known = code;
    cell.own = cell.edited ? code : undefined; // until it is replaced by the text of another tab
    if (store.isNewer) this.bar.say(`${NEWER} “Take away: with my answers” saves it.`);
    else if (!kept || window.keepsNothing) {
      this.bar.say(`${window.keepsNothing ? "Your browser does not let this page store anything" : "This browser has no room left for your answers"}: what you write lasts until you leave the page. “Take away: with my answers” saves it.`);
    }
    this.show();
  }

  // Restore the stored texts where the book's code has not changed; elsewhere ask.
  async bring() {
    this.showGiven();
    await this.lookAtNotebook();
    if (this.reread()) this.bar.say("Your edits are restored. The results are the book’s until you run the page.");
    store.listen((key, text) => {
      if (key !== null && !key.includes(` ${this.answers.page} `)) return;
      const cell = this.cells.find(({ id }) => this.answers.isOf(id, key));
      if (cell?.own !== undefined) this.answers.overtake(cell.id, text, cell.own);
      this.reread();
    });
    // A tab in the background may have missed changes by others.
    const wake = async () => document.hidden || (await this.lookAtNotebook(), this.reread());
    document.addEventListener("visibilitychange", wake);
    // Ask before closing a page with texts that are not stored elsewhere.
    addEventListener("beforeunload", (event) => {
      if (store.holdsTexts() || (window.keepsNothing && this.cells.some((cell) => cell.edited))) event.preventDefault();
    });
    addEventListener("pageshow", ({ persisted }) => persisted && wake());
  }

  // The page's notebook in JupyterLite, if this browser has one, may contain newer answers, and another ID.
  async lookAtNotebook() {
    if (!store.read(this.answers.agreed)) return;
    try {
      const { student } = store, known = store.tries()?.text;
      await agreeOnRecords(this.answers.page);
      if (store.student !== student) this.tellWhose();
      else if (store.tries()?.text !== known) this.bar.tellWhatIsKnown();
      const copy = await readCopy(`${this.answers.page}.ipynb`);
      if (copy) bringTogether(this.answers.page, copy);
    } catch (error) {
      console.warn(`The notebook of this page could not be read: ${error.message}`);
    }
  }

  // Make the cells show the stored texts. Returns how many texts there are.
  reread() {
    const kept = this.answers.all();
    const all = kept.size;
    this.offers ??= new Map();
    for (const cell of this.cells) {
      const entry = kept.get(cell.id);
      if (entry && entry.original !== fingerprint(cell.original)) continue;
      kept.delete(cell.id);
      if (entry || cell.edited) cell.follow(entry ? entry.code : cell.original);
      if (cell.editor) cell.showEarlier();
    }
    for (const [name, box] of this.offers) if (!kept.has(name)) box.remove(), this.offers.delete(name);
    for (const [name, entry] of kept) if (!this.offers.has(name)) this.offer(name, entry);
    const aside = this.cells.some((cell) => this.answers.earlier(cell.id, cell.original).length);
    if (all || aside) this.edit();
    this.show();
    return all;
  }

  // Offer a text at the code that has changed, and a text for a removed question at the end, where it belongs to no
  // cell. A name made from the code shows that the code has changed (see nameCells).
  offer(name, entry) {
    const own = this.cells.find(({ id }) => id === name);
    const gone = !own && !name.startsWith(`${entry.original}-`);
    const cell = own ?? this.cells[gone ? this.cells.length - 1 : Math.min(Math.max(entry.number, 1), this.cells.length) - 1];
    const choose = (text, action) => {
      const button = element("button", "", text);
      button.type = "button";
      button.addEventListener("click", () => {
        this.answers.setAside(gone ? name : cell.id, entry.code, entry.at);
        this.answers.remove(name);
        action();
        this.reread();
      });
      return button;
    };
    this.edit();
    const putAway = () => this.bar.say("It has been put away. “Back up everything” still saves it.");
    const box = element("div", "live-note live-choice",
      element("p", "", gone ? `You wrote this for “${name}”, which this page no longer asks:`
        : "The book’s code here has changed since you edited it. This was yours:"),
      preformatted("stream", entry.code),
      ...(gone ? [choose("Put it away", putAway)]
        : [choose("Use mine", () => cell.write(entry.code)), " ", choose("Keep the book’s", () => {})]));
    box.setAttribute("role", "group");
    box.setAttribute("aria-label", gone ? `Your answer to ${name}` : `An older edit of ${cell.name}`);
    (gone ? cell.box : cell.input).after(box);
    this.offers.set(name, box);
  }

  // Ask first, so that one click cannot remove the work of an hour.
  askToUndo() {
    const edited = this.cells.filter((cell) => cell.edited);
    this.bar.ask(`Bring back the book’s code in ${plural(edited.length, "cell")}? What you wrote there is kept below each cell.`, {
      "Bring it back": () => {
        const mine = edited.map((cell) => [cell, cell.code]);
        for (const cell of edited) cell.write(cell.original);
        this.bar.ask("All cells hold the book’s code again.", {
          Undo: () => {
            for (const [cell, code] of mine) cell.write(code);
            this.bar.say("Your code is back.");
          },
        });
      },
      "Keep mine": () => this.bar.say("Nothing was changed."),
    });
  }

  // --- what is to run --------------------------------------------------------------------------

  // Whether running the cell would give nothing but a picture that is already there.
  leftOut(cell) {
    return cell.kind.skip && !cell.edited;
  }

  // Whether a cell is running with its present code, and is not being stopped.
  atWork(cell) {
    return this.running === cell && cell.sent === cell.code && !this.stopping;
  }

  // Run one cell, after the cells above it that have not run yet; without a cell, run the whole page.
  run(cell) {
    if (!cell && this.cells.every((another) => this.leftOut(another))) {
      return this.bar.say("Every cell of this page draws a picture that is already shown. Run, below a cell, draws it again.");
    }
    // Ignore a second click while the cell is running.
    if (cell ? this.atWork(cell) : this.whole) return;
    if (cell) cell.asked = true; // by its own button: its figure starts anew
    else {
      this.whole = true;
      this.empty(); // every cell is added in its order
    }
    const upTo = cell ? cell.number : this.cells.length;
    const before = this.cells.slice(0, upTo).filter((other) =>
      other !== cell && !(cell && (other.ran || other.stopped || this.atWork(other))) && !(this.leftOut(other) && !(cell?.kind.skip)));
    for (const next of cell ? [...before, cell] : before) {
      if (!this.queue.includes(next)) {
        this.queue.push(next);
        next.box.classList.add("waiting");
      }
    }
    this.tally ??= { ran: 0, plain: 0, failed: [], missing: new Set(), alone: true };
    this.tally.alone &&= Boolean(cell);
    if (!this.busy) this.work();
  }

  // Ask for files in a cell with this tag. They stay here: Python finds them in the folder ``dropped``, and the cell runs.
  askForFiles(cell) {
    const { box } = cell;
    const field = Object.assign(element("input"), { type: "file", multiple: true });
    box.prepend(element("label", "takes-file", "Choose a file, or drop it here. It stays in this page: ", field));
    field.addEventListener("change", () => this.give(cell, [...field.files]));
    // Catch a file that misses the cell, as the browser would open it in place of this page.
    const taking = (event) => {
      if (event.defaultPrevented || !event.dataTransfer.types.includes("Files")) return;
      event.preventDefault();
      box.classList.toggle("taking", event.type === "dragover");
      if (event.type === "drop") this.give(cell, [...event.dataTransfer.files]);
    };
    for (const name of ["dragover", "dragleave", "drop"]) addEventListener(name, taking);
  }

  async give(cell, files) {
    if (!files.length) return;
    cell.box.scrollIntoView({ block: "nearest" });
    this.files = await Promise.all(files.map(async (file) => [file.name, new Uint8Array(await file.arrayBuffer())]));
    if (this.has) this.python?.put(this.files);
    cell.ran = false;
    this.run(cell);
  }

  async work() {
    this.busy = true;
    this.retry = true; // downloads that failed are tried again
    this.show();
    try {
      while (this.queue.length) {
        if (!this.python) await this.load();
        await this.next(this.queue.shift());
      }
      this.report();
    } catch (error) {
      this.empty();
      this.bar.progress(null);
      if (error.message === "interrupted") this.bar.say("Stopped: Python was not loaded.");
      else await this.bar.explain(error, "Python could not be started");
    }
    this.busy = this.whole = this.stopping = false;
    this.tally = null;
    this.show();
  }

  async load() {
    this.bar.say("Loading Python ...");
    this.has = null;
    this.python = new Python(this.place, (message, cell) => this.hear(message, cell));
    const { python } = this;
    setTimeout(() => this.edit());
    try {
      this.has = await python.ready;
      if (this.files) python.put(this.files);
      this.bar.fetched();
    } catch (error) {
      if (this.python === python) this.python = null;
      throw error;
    }
    this.bar.progress(null);
  }

  hear(message, cell) {
    if (message.type === "progress" && !this.has) this.bar.progress(message.bytes, message.all);
    else if (message.type === "fetching") this.bar.say(`Fetching ${named(message.name)} from ${message.place} ...`);
    else if (message.type === "output") cell.take(message.message);
    else if (message.type === "kept") this.keepOf(message);
    else if (message.type === "widget") this.figures.hear(message.message);
    else if (message.type === "observed") this.figures.observed(message.widget, message.message);
  }

  // Coursework has changed the reader's ID or progress.
  keepOf({ name, text, base }) {
    const before = store.student;
    coursework.write(name, text, Date.now(), base);
    if (store.student !== before) this.tellWhose();
  }

  async next(cell) {
    const needs = cell.edited ? [] : cell.kind.needs ?? [];
    const lacking = needs.filter((module) => !this.has.modules.includes(module));
    this.running = cell;
    cell.begin();
    if (this.queue.length || !this.tally.alone) this.bar.say(`Running ${cell.name} of ${this.cells.length} ...`);
    // Run the hidden code above this cell; its output belongs to no cell.
    const { before } = cell.kind;
    const show = lacking.length ? { take() {} } : cell; // it cannot run to its end, but others use names from before
    const hidden = before ? await this.python.run(before, `the code above ${cell.name}`, needs, { take() {} }, this.retry, coursework.all()) : { status: "ok" };
    const outcome = hidden.status === "ok" ? await this.python.run(cell.sent, cell.name, needs, show, this.retry, coursework.all()) : hidden;
    this.retry = false;
    this.running = null;
    if (lacking.length && ["ok", "error", "missing"].includes(outcome.status)) {
      this.leave(cell, `it needs ${named(...lacking)}, which is not part of the page’s Python`);
    } else this.settle(cell, outcome);
    if (cell.asked) cell.showReply();
    cell.asked = this.stopping = false;
  }

  leave(cell, reason) {
    this.tally.missing.add(cell.number);
    const note = element("div", "live-note", element("p", "", `Not run here: ${reason}.`));
    cell.leave(note);
    this.last = `${cell.name} was not run: ${reason}.`;
  }

  settle(cell, outcome) {
    const { status } = outcome;
    if (status === "ok") {
      cell.end();
      cell.box.dataset.whose = store.student;
      this.keepGiven(cell);
      this.tally.ran += 1;
      this.tally.plain += Boolean(outcome.plain);
      const words = cell.words.join(" ").trim();
      const by = outcome.plain ? ", computed by plain Python instead of NumPy" : "";
      this.last = `${cell.name} ran${by}${words ? `. Result: ${words.length > 200 ? `${words.slice(0, 200)} ...` : words}` : ", without a result to show"}`;
    } else if (status === "missing") {
      this.leave(cell, outcome.reason);
    } else if (status === "error") {
      const text = preformatted("stream", outcome.traceback);
      text.classList.add("stderr", "live-error");
      cell.end(text);
      this.doubt(cell, true);
      this.tally.failed.push(cell.number);
      this.last = `${cell.name} raised an error: ${outcome.traceback.split("\n").at(-1)}`;
      if (this.queue.length) this.last += " The cells after it were not run.";
      this.empty();
    } else {
      const lost = status === "ended";
      const why = outcome.reason === "interrupted" || !lost ? "Stopped." : `Python stopped: ${outcome.reason}.`;
      const then = lost ? " At the next run Python restarts, and the page’s earlier cells run first." : " Everything that earlier cells defined is still there.";
      cell.end(element("div", "live-note", element("p", "", why + then)));
      cell.ran = false;
      cell.stopped = cell.sent === cell.code; // it runs again when it is asked for or changed, but not for a later cell
      // What is in the queue was requested after Stop: run it, and if Python restarts, also the cells above it.
      const [next, whole] = this.stopping ? [this.queue.at(-1), this.whole] : [];
      this.stopping = false;
      if (lost || !next) this.empty();
      if (lost) {
        this.forget();
        this.whole = false;
        if (next) this.run(whole ? undefined : next);
      }
      this.last = `${cell.name}: ${why}${then}`;
      this.tally.stopped = true;
    }
  }

  report() {
    const { ran, plain, failed, missing, alone, stopped } = this.tally;
    const parts = [`${plural(ran, "cell")} ran.`];
    if (plain) parts.push(`In ${plain} of them plain Python stood in for NumPy.`);
    const last = `${this.last[0].toUpperCase()}${this.last.slice(1)}`;
    if (missing.size) parts.push(`${plural(missing.size, "cell was", "cells were")} not run; the reason is below each.`);
    this.bar.say(alone || stopped || failed.length ? last : parts.join(" "));
  }

  empty() {
    for (const cell of this.queue) cell.box.classList.remove("waiting");
    this.queue = [];
  }

  // --- stopping --------------------------------------------------------------------------------

  stop() {
    this.empty();
    this.whole = false;
    this.stopping = Boolean(this.running);
    this.python?.interrupt();
    if (this.python?.ended) this.forget();
  }

  // Python has ended, and with it every name: the next run starts with the first cell.
  forget() {
    this.python = null;
    for (const cell of this.cells) cell.ran = false;
  }

  reset() {
    this.empty();
    this.python?.end("interrupted");
    this.forget();
    for (const cell of this.cells) cell.restore();
    this.bar.progress(null);
    this.bar.say("Everything is as in the book, except for your edits. Python restarts at the next run.");
  }

  show() {
    const [all, stop, afresh, book] = this.buttons;
    all.hidden = this.busy;
    stop.hidden = !this.busy;
    afresh.hidden = this.busy || !this.python;
    book.hidden = this.busy || !this.cells.some((cell) => cell.edited);
    document.documentElement.classList.toggle("live-busy", Boolean(this.busy));
  }
}

export async function open(parts) {
  const style = Object.assign(element("link"), { rel: "stylesheet", href: new URL("./live.css", import.meta.url) });
  document.head.append(style);
  // What the cells show contains formulas, and without these rules each formula is there twice.
  await new Promise((arrived) => (style.onload = style.onerror = arrived));
  const page = new Page(parts);
  await page.bring();
  return page;
}
