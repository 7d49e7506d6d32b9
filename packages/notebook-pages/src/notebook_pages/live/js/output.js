// The output of cells, formatted in the same way as by the build.
import katex from "katex";

const ORDER = ["text/html", "image/svg+xml", "image/png", "text/markdown", "text/latex", "text/plain"];

function element(tag, className, ...children) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.append(...children);
  return made;
}

// Make a box that scrolls reachable by keyboard, but only while it overflows.
const watchLong = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    const { scrollWidth, clientWidth, scrollHeight, clientHeight } = target;
    if (scrollWidth > clientWidth + 1 || scrollHeight > clientHeight + 1) target.tabIndex = 0;
    else target.removeAttribute("tabindex");
  }
});

// Numbers in columns: their lines scroll on a narrow screen, while the lines of sentences wrap.
const COLUMNS = /^ *\[|^ {4}|\S {2,}\S/m;

function preformatted(kind, text) {
  const box = element("div", `output ${kind} highlight-myst-ansi notranslate`);
  const words = element("pre");
  box.append(element("div", "highlight", words));
  goOn(box, text);
  watchLong.observe(words);
  return box;
}

// Printed text comes in pieces, and may turn out to be in columns only with the last of them.
function goOn(box, text) {
  const words = box.querySelector("pre");
  words.append(text);
  if (box.classList.contains("text_plain") || COLUMNS.test(words.textContent)) words.className = "columns";
}

// Remove the delimiters; everything is set in display style, as by the build.
function bare(tex) {
  for (const [start, end] of [["\\(", "\\)"], ["\\[", "\\]"], ["$$", "$$"], ["$", "$"]]) {
    if (tex.startsWith(start) && tex.endsWith(end)) return tex.slice(start.length, -end.length);
  }
  return tex;
}

function formula(text) {
  const tex = bare(text.trim()).trim();
  const box = element("div", "math-box");
  try {
    box.innerHTML = katex.renderToString(tex, {
      displayMode: true, output: "htmlAndMathml", throwOnError: true, strict: "ignore",
      macros: { "\\arraystretch": tex.includes("\\frac") ? "1.6" : "1.15" },
    });
  } catch {
    return preformatted("text_plain", text);
  }
  window.watchWidth?.(box);
  return element("div", "output text_latex math display notranslate", box);
}

function picture(form, data, name) {
  const image = element("img");
  image.src = form === "image/png" ? `data:image/png;base64,${data}`
    : `data:image/svg+xml;charset=utf-8,${encodeURIComponent(data)}`;
  image.alt = `The picture that ${name} has drawn`;
  return element("div", "output image_svg", image);
}

// Set the formulas in the text of such an output as a notebook does.
function setFormulas(box) {
  const walker = document.createTreeWalker(box, NodeFilter.SHOW_TEXT);
  const texts = [];
  while (walker.nextNode()) texts.push(walker.currentNode);
  for (const text of texts) {
    if (!/\$[^$]+\$/.test(text.data) || text.parentElement.closest("code, pre, script, style, svg")) continue;
    const parts = text.data.split(/\$([^$]+)\$/).map((part, place) => {
      if (place % 2 === 0) return part;
      const math = element("span", "notranslate");
      math.innerHTML = katex.renderToString(part, { output: "htmlAndMathml", throwOnError: false, strict: "ignore" });
      return math;
    });
    text.replaceWith(...parts);
  }
}

function html(text) {
  const box = element("div", "output text_html");
  box.innerHTML = text;
  setFormulas(box);
  // Scripts that are inserted as text do not run. A copy as a file does: the page's policy allows no others.
  for (const script of box.querySelectorAll("script")) {
    const copy = element("script");
    for (const { name, value } of script.attributes) copy.setAttribute(name, value);
    if (script.textContent.trim()) {
      copy.src = URL.createObjectURL(new Blob([script.textContent], { type: "text/javascript" }));
      copy.addEventListener("load", () => URL.revokeObjectURL(copy.src));
    }
    script.replaceWith(copy);
  }
  box.querySelectorAll("figure.orientation-figure").forEach((figure) => window.watchWidth?.(figure));
  for (const reply of box.querySelectorAll(".coursework-reply[data-sibling]")) {
    const button = element("button", "sibling", "A sibling question");
    button.type = "button";
    button.addEventListener("click", () =>
      button.dispatchEvent(new CustomEvent("sibling", { bubbles: true, detail: reply.dataset.sibling })));
    reply.after(button);
  }
  return box;
}

// The Markdown output of a cell: paragraphs, lists and tables, with code, emphasis, links and formulas.
function markdown(text) {
  const box = element("div", "output text_markdown");
  for (const part of text.split(/\n{2,}/)) {
    const display = part.trim().match(/^\$\$([\s\S]*)\$\$$/);
    const items = part.split(/\n(?=\d+\. |- )/);
    const drawn = part.trim().match(/^<p><img alt="([^"]*)" width="([\d.]+)" src="(data:image\/svg\+xml;base64,[\w+/=]+)"><\/p>$/);
    if (drawn) {
      const alt = new DOMParser().parseFromString(drawn[1], "text/html").documentElement.textContent;
      box.append(Object.assign(element("img"), { alt, width: drawn[2], src: drawn[3] }));
    } else if (display) box.append(formula(display[1]));
    else if (/^\|.*\n\|[-:| ]+\|(\n|$)/.test(part)) box.append(table(part));
    else if (/^(\d+\. |- )/.test(part)) {
      const list = element(part.startsWith("-") ? "ul" : "ol");
      list.append(...items.map((item) => withStress(element("li"), item.replace(/^(\d+\.|-) /, ""))));
      box.append(list);
    } else box.append(withStress(element("p"), part));
  }
  setFormulas(box);
  return box;
}

function table(text) {
  const [head, , ...body] = text.trim().split("\n").map((line) =>
    line.slice(1, -1).split(/(?<!\\)\|/).map((entry) => entry.trim().replaceAll("\\|", "|")));
  const row = (entries, position, cell) =>
    element("tr", position % 2 ? "row-even" : "row-odd", ...entries.map((entry) => cell(withStress(element("p"), entry))));
  return element("div", "pst-scrollable-table-container", element("table", "table",
    element("thead", "", row(head, 0, (words) => element("th", "head", words))),
    element("tbody", "", ...body.map((entries, position) => row(entries, position + 1, (words) => element("td", "", words))))));
}

function withStress(block, text) {
  for (const piece of text.split(/(`[^`]+`|\$[^$]+\$|\*\*[^*]+\*\*|\*[^*\s][^*]*\*|\[[^\]]+\]\(https:[^)\s]+\))/)) {
    const link = piece.match(/^\[(.+)\]\((https:.+)\)$/);
    if (/^`.+`$/.test(piece)) block.append(element("code", "", piece.slice(1, -1)));
    else if (/^\*\*.+\*\*$/s.test(piece)) block.append(withStress(element("strong"), piece.slice(2, -2)));
    else if (/^\*.+\*$/s.test(piece)) block.append(element("em", "", piece.slice(1, -1)));
    else if (link) block.append(Object.assign(element("a", "reference external", link[1]), { href: link[2] }));
    else block.append(piece);
  }
  return block;
}

// One value in the best of its formats, with a few words for screen readers. ``figure`` returns the element of a value
// that is a moving figure.
export function shown(data, name, figure) {
  const moving = figure(data);
  if (moving) return [moving, "a figure"];
  const form = ORDER.find((known) => known in data);
  if (form === "text/html") {
    const box = html(data[form]);
    const drawing = box.querySelector("figure, svg, img");
    const alone = drawing && !box.textContent.replace(drawing.textContent, "").trim();
    return [box, alone ? "a figure" : data["text/plain"] ?? box.textContent.trim()];
  }
  if (form === "text/latex") return [formula(data[form]), data["text/plain"]?.includes("\n") ? "a formula" : data["text/plain"] ?? "a formula"];
  if (form === "text/markdown") return [markdown(data[form]), data["text/plain"] ?? data[form]];
  if (form?.startsWith("image/")) return [picture(form, data[form], name), "a picture"];
  const text = data[form] ?? "a value without a form that can be shown";
  return [preformatted("text_plain", text), text];
}

// Start a moving figure with the page's own script for its kind.
export function wake(root) {
  const kinds = new Set([...root.querySelectorAll(".moving[data-figure]:not([data-ready])")].map((f) => f.dataset.figure));
  for (const kind of kinds) {
    const loader = document.querySelector(`script[src*="moving/${kind}.js"]`);
    if (loader) {
      const again = element("script");
      again.src = loader.src;
      document.head.append(again);
      again.addEventListener("load", () => again.remove());
    }
  }
}

export { element, goOn, preformatted };
