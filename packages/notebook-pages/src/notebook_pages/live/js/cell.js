// One cell of the page: its editor, its buttons, and the output below it.
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { python } from "@codemirror/lang-python";
import { bracketMatching, indentOnInput, indentUnit, syntaxHighlighting } from "@codemirror/language";
import { EditorState, Prec } from "@codemirror/state";
import { EditorView, keymap } from "@codemirror/view";
import { classHighlighter } from "@lezer/highlight";
import { element, goOn, preformatted, shown, wake } from "./output.js";

export class Cell {
  // ``box`` is the cell's element, ``number`` starts at 1, and ``kind`` is what the build found out about the cell. The
  // page sets ``id``, the name under which its text is kept.
  constructor(box, number, kind, page) {
    Object.assign(this, { box, number, kind, page, name: `cell ${number}`, ran: false });
    this.input = box.querySelector(".cell_input");
    this.original = this.input.querySelector("pre").textContent.trimEnd();
    this.button = this.input.querySelector("button.run-cell");
    this.findOutput();
    this.box.addEventListener("sibling", ({ detail }) => this.takeSibling(detail));
  }

  // Find the output; a figure keeps its caption, so only what precedes the caption is a result.
  findOutput() {
    let output = this.box.querySelector(":scope > .cell_output");
    if (!output) {
      output = element("div", "cell_output docutils container");
      this.box.append(output);
    }
    this.output = output.querySelector(":scope > figure:has(> figcaption)") ?? output;
    // The line above it about the reader's record is not a result (see page.js).
    this.built = [...this.output.children].filter((child) => !child.matches("figcaption, .live-known"))
      .flatMap((child) => (child.matches(".live-others") ? [...child.children].slice(1) : [child]));
    this.current = this.built;
    this.made = this.original; // the code whose result is shown
  }

  get code() {
    return this.editor ? this.editor.state.doc.toString() : this.original;
  }

  get edited() {
    return this.code.trimEnd() !== this.original;
  }

  edit() {
    if (this.editor) return;
    const old = this.input.querySelector(":scope > div");
    old.querySelector("button.copybtn")?.remove();
    const run = () => (this.page.run(this), true);
    const leave = () => (this.button.focus(), true);
    const changed = EditorView.updateListener.of(({ docChanged }) => docChanged && this.changed());
    this.known ??= this.original;
    this.editor = new EditorView({
      state: EditorState.create({
        doc: this.original,
        extensions: [
          history(), indentOnInput(), indentUnit.of("    "), bracketMatching(), python(),
          syntaxHighlighting(classHighlighter), changed,
          Prec.high(keymap.of([
            { key: "Shift-Enter", run }, { key: "Mod-Enter", run }, { key: "Escape", run: leave },
          ])),
          keymap.of([...defaultKeymap, ...historyKeymap, indentWithTab]),
          // After arriving with Tab, Tab moves on; it indents as soon as another key, or the pointer, is used here.
          EditorView.domEventHandlers({
            focus: (event, editor) => editor.setTabFocusMode(true),
            keydown: ({ key }, editor) => { if (!/Tab|Shift/.test(key)) editor.setTabFocusMode(false); },
            pointerup: (event, editor) => editor.setTabFocusMode(false),
          }),
          EditorView.contentAttributes.of({
            "aria-label": `Code of ${this.name}`, "aria-describedby": "live-keys", spellcheck: "false", tabindex: "0",
          }),
        ],
      }),
    });
    this.editor.dom.classList.add("highlight");
    old.hidden = true;
    old.after(this.editor.dom);
    this.back = element("button", "to-original", "Book’s code");
    this.back.type = "button";
    this.back.hidden = true;
    this.back.setAttribute("aria-label", `Bring back the book’s code of ${this.name}`);
    this.back.addEventListener("click", () => (this.write(this.original), this.editor.focus()));
    this.button.before(this.back);
    this.showEarlier();
  }

  // An edited cell has to run again before the cells below it.
  changed() {
    this.ran = this.stopped = false;
    this.back.hidden = !this.edited;
    this.box.classList.toggle("edited", this.edited);
    this.page.doubt(this, this.code !== this.sent);
    if (!this.following) this.page.keep(this);
  }

  write(code) {
    this.edit();
    this.editor.dispatch({ changes: { from: 0, to: this.editor.state.doc.length, insert: code } });
    this.showEarlier();
  }

  // Add the same question with other numbers, as offered by a reply: the code that shows and checks it goes to the end
  // of the cell, so that the cell does all of it, here and in the notebook. The answer above it stays.
  takeSibling(name) {
    const answer = `other_${name.split("/")[1].replace(/\W/g, "_")}${name.match(/\d*$/)[0]}`;
    if (!this.code.includes(`check('${name}'`)) {
      const above = this.code.trimEnd().replace(/^((?:check|worked_solution)\(.*\))$(?![\s\S])/m, "display($1)");
      this.write(`${above}\n\n# The same with other numbers: replace the dots with your answer, and keep the name.\nfrom coursework import check, variant\n\nsibling = variant('${name}')\ndisplay(sibling)\n${answer} = ...\ncheck('${name}', ${answer})`);
    }
    this.editor.focus();
    this.page.run(this);
  }

  // Take over a text from another tab, or the notebook, which may not have known what was just written here.
  follow(code) {
    this.known = code;
    if (this.own !== undefined && this.own !== code) {
      this.page.answers.setAside(this.id, this.own);
      this.own = undefined;
    }
    if (code === this.code) return;
    this.following = true;
    this.write(code);
    this.following = false;
  }

  // Show the earlier texts of this cell, to restore one of them.
  showEarlier() {
    const texts = this.page.answers.earlier(this.id, this.code, this.original);
    this.earlier?.remove();
    this.earlier = null;
    if (!texts.length) return;
    const use = (code) => {
      const button = element("button", "", "Bring it back");
      button.type = "button";
      button.addEventListener("click", () => {
        this.page.answers.setAside(this.id, this.code);
        this.write(code);
        this.editor.focus();
      });
      return button;
    };
    this.earlier = element("details", "live-note live-choice live-earlier",
      element("summary", "", `What you wrote here before (${texts.length})`),
      ...texts.flatMap(({ code }) => [preformatted("stream", code), use(code)]));
    this.input.after(this.earlier);
  }

  // --- results ---------------------------------------------------------------------------------

  replace(nodes) {
    for (const node of [...this.current, ...this.output.querySelectorAll(":scope > .live-known, :scope > .live-others")]) node.remove();
    this.output.prepend(...nodes);
    this.current = nodes;
    wake(this.output);
  }

  restore() {
    this.replace(this.built);
    delete this.box.dataset.whose;
    this.made = this.original;
    this.box.classList.remove("waiting", "running", "failed");
    this.ran = this.stopped = false;
  }

  // Show the text of a question as this reader got it in an earlier visit, in place of the default one.
  showGiven(student, text) {
    this.box.dataset.whose = student;
    this.replace([shown({ "text/markdown": text }, this.name, () => null)[0]]);
  }

  begin() {
    this.sent = this.code; // the reader may edit it meanwhile
    this.stopped = false;
    this.fresh = [];
    this.words = [];
    this.given = undefined;
    this.box.classList.remove("failed", "waiting");
    this.box.classList.add("running");
  }

  // Process one message of the running cell.
  take(message) {
    const last = this.fresh.at(-1);
    if (message.type === "clear") {
      this.fresh = [];
    } else if (message.type === "stream") {
      if (last?.classList.contains("stream") && last.dataset.name === message.name) {
        goOn(last, message.text);
      } else {
        const box = preformatted("stream", message.text);
        box.dataset.name = message.name;
        if (message.name === "stderr") box.classList.add("stderr");
        this.fresh.push(box);
      }
      this.words.push(message.text);
    } else {
      const [box, words] = shown(message.data, this.name, (data) => this.page.figures.show(data, this));
      this.given = message.data["text/markdown"] ?? this.given;
      this.fresh.push(box);
      this.words.push(words);
    }
    if (message.type === "stream") this.replace([...this.fresh]); // printed text is shown at once
  }

  // Show what the observers of this cell's figure output, at any time after the run: it replaces their earlier output,
  // which belongs to another position of the figure.
  observed(message) {
    if (message.type === "clear") {
      this.outdated = true;
      return;
    }
    if (this.outdated || !this.heard) {
      this.outdated = false;
      this.heard?.remove();
      this.heard = element("div", "output");
      const there = this.current.filter((node) => node.isConnected);
      there.at(-1).after(this.heard);
      this.current = [...there, this.heard];
    }
    if (message.type !== "stream") return this.heard.append(shown(message.data, this.name, () => null)[0]);
    const last = this.heard.lastElementChild;
    if (last?.dataset.name === message.name) return goOn(last, message.text);
    const box = preformatted("stream", message.text);
    box.dataset.name = message.name;
    if (message.name === "stderr") box.classList.add("stderr");
    this.heard.append(box);
  }

  // The result of the book's code, beside a note: folded if the code above it was edited.
  get bookResult() {
    if (this.built.every((output) => output.hidden)) return [];
    if (!this.edited) return [element("p", "live-built", "The book’s result:"), ...this.built];
    return [element("details", "live-built", element("summary", "", "The result of the book’s code"), ...this.built)];
  }

  // The cell was not run: the book's result stays, and ``note`` says why.
  leave(note) {
    this.box.classList.remove("running", "waiting");
    this.replace(this.edited ? [note, ...this.bookResult] : [...this.built, note]);
    this.ran = false;
  }

  // Scroll to the output if the cell that was just run is in view, so that the bar does not cover it.
  showReply() {
    const { top, bottom } = this.input.getBoundingClientRect();
    if (bottom > 0 && top < innerHeight) this.output.scrollIntoView({ block: "nearest" });
  }

  // The cell has run; ``note`` is a box with what went wrong, if anything, beside which the book's own result stays.
  end(note) {
    this.box.classList.remove("running", "waiting");
    this.box.classList.toggle("failed", Boolean(note));
    const nodes = [...this.fresh];
    if (note) nodes.push(note, ...this.bookResult);
    if (!this.asked && this.made === this.sent) this.page.figures.keep(this.current, nodes);
    this.made = this.sent;
    this.replace(nodes);
    this.ran = this.sent === this.code;
  }
}
