// Figures made by the page's Python: the page's side of widgets, as far as anywidget's front ends need it.
import { element, preformatted } from "./output.js";
import { Model } from "./model.js";

const WIDGET = "application/vnd.jupyter.widget-view+json";
const scripts = new Map(); // front ends by their text: all figures of one kind share one
const styles = new Set();

function frontEnd(text) {
  if (!scripts.has(text)) {
    const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    scripts.set(text, import(address).finally(() => URL.revokeObjectURL(address)));
  }
  return scripts.get(text);
}

function dress(text) {
  if (!text || styles.has(text)) return;
  styles.add(text);
  document.head.append(element("style", "", text));
}

// The figures in some nodes, each with its model: those of the build, and those of Python.
const figuresIn = (nodes) => nodes.flatMap((node) => [node, ...node.querySelectorAll?.("figure.moving") ?? []]).filter(({ model }) => model);

export class Figures {
  // ``tell(name, data)`` sends a message to Python.
  constructor(tell) {
    this.tell = tell;
    this.models = new Map();
    this.cells = new Map();
  }

  hear({ type, id, data }) {
    if (type === "comm_open") {
      const told = (state) => this.tell(id, { method: "update", state, buffer_paths: [] });
      this.models.set(id, new Model(data.state, told));
    } else if (type === "comm_close") {
      this.models.delete(id);
    } else if (data.method === "update") {
      this.models.get(id)?.take(data.state);
    }
  }

  // The element for a value that is a figure, or nothing.
  show(data, cell) {
    const model = this.models.get(data[WIDGET]);
    if (!model) return null;
    const box = element("div", "output text_html");
    if (model.get("_model_module") !== "anywidget") {
      box.append(preformatted("text_plain", data["text/plain"] ?? ""),
        element("p", "live-note", "This page cannot show this control of ipywidgets. The notebook can."));
      return box;
    }
    box.model = model;
    this.cells.set(data[WIDGET], cell);
    dress(model.get("_css"));
    frontEnd(model.get("_esm")).then(({ default: made }) => made.render({ model, el: box }),
      (error) => box.append(preformatted("stream", `The figure could not be shown: ${error.message}`)));
    return box;
  }

  // Show what the observers of a figure print below it, in place of what they printed before.
  observed(name, message) {
    this.cells.get(name)?.observed(message);
  }

  // Keep the position of a figure that the reader has moved if its cell runs because another cell needs it.
  keep(before, after) {
    const [old, fresh] = [before, after].map(figuresIn);
    fresh.forEach(({ model }, place) => model.move(old[place]?.model.moved));
  }
}
