// Files that the reader exports and imports: the page's notebook with the answers in it, and all answers in one file.
import { Answers, nameCells, store } from "./answers.js";
import { allCopies, bookCells, placeBeside, readCopy, writeCopy } from "./notebooks.js";
import { fingerprint, NEWER, VERSION } from "./store.js";

const text = (source) => (Array.isArray(source) ? source.join("") : source).trimEnd();
const count = (number, one, many = `${one}s`) => `${number} ${number === 1 ? one : many}`;

function save(name, content) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type: "application/json" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

function choose(kinds) {
  return new Promise((resolve) => {
    const field = Object.assign(document.createElement("input"), { type: "file", accept: kinds });
    field.addEventListener("change", () => resolve(field.files[0]));
    field.click();
  });
}

// ``data`` describes the page; ``originals`` is the book's code in its cells.
function named(data, originals) {
  return nameCells(originals.map((original, k) => ({ name: data.cells[k]?.name, original })));
}

async function bookNotebook(data, originals) {
  const answer = await fetch(new URL(data.notebook, location.href), { cache: "no-cache" });
  if (!answer.ok) throw new Error(`the page’s notebook could not be downloaded (${answer.status})`);
  const notebook = await answer.json();
  // The notebook may contain cells that the page does not show.
  const all = notebook.cells.filter((cell) => cell.cell_type === "code");
  let next = 0;
  const codes = originals.map((original) => {
    while (next < all.length && text(all[next].source) !== original) next += 1;
    return all[next++];
  });
  if (codes.includes(undefined)) throw new Error("the book has changed since this page was opened: reload the page first");
  return { notebook, codes };
}

// Code that gives no student ID, with the ID that this browser knows: elsewhere the questions would have the default
// numbers.
function signed(code) {
  const name = store.read("coursework me.txt")?.text.trim();
  return name ? code.replace(/^(# )?student\((''|""|'your ID')\)/m, () => `student(${JSON.stringify(name)})`) : code;
}

// The page's notebook with the reader's answers, as a file.
export async function handIn(data, originals) {
  const { notebook, codes } = await bookNotebook(data, originals);
  const kept = new Answers(data.page).all();
  const stamp = {};
  let answered = 0;
  named(data, originals).forEach((name, k) => {
    stamp[codes[k].id] = [name, fingerprint(originals[k])];
    const entry = kept.get(name), mine = entry?.original === fingerprint(originals[k]);
    const source = signed(mine ? entry.code : originals[k]);
    if (source !== originals[k]) Object.assign(codes[k], { source, outputs: [], execution_count: null });
    if (!mine) return;
    kept.delete(name);
    answered += 1;
  });
  notebook.metadata.book = { cells: stamp }; // for importing it
  save(data.notebook.split("/").at(-1), `${JSON.stringify(notebook, null, 1)}\n`);
  const left = kept.size ? ` ${count(kept.size, "text", "texts")} written for an older edition ${kept.size === 1 ? "is" : "are"} not in it: decide about each on the page first.` : "";
  return `Saved with what you have written in ${count(answered, "cell")} of this page.${left}`;
}

// Import the answers of such a notebook, or of one that was written elsewhere.
export async function load(data, originals) {
  const file = await choose(".ipynb");
  let notebook;
  try {
    notebook = JSON.parse(await file.text());
    if (!Array.isArray(notebook.cells)) throw new Error();
  } catch {
    return `${file.name} is not a notebook: nothing was changed.`;
  }
  const answers = new Answers(data.page);
  const names = named(data, originals);
  const codes = notebook.cells.filter((cell) => cell.cell_type === "code");
  const found = new Map(bookCells(notebook).map((cell) => [cell.name, cell.text]));
  // In a notebook without a stamp, cells without a grader's name are identified by their order if none was added.
  const inPlace = !notebook.metadata?.book && codes.length === originals.length;
  if (!names.some((name, k) => found.has(name) && (data.cells[k]?.name || found.get(name) === originals[k]))) {
    return `${file.name} is not the notebook of this page: nothing was changed.`;
  }
  let changed = 0, kept = true;
  names.forEach((name, k) => {
    const there = found.get(name) ?? (inPlace && !data.cells[k]?.name ? text(codes[k].source) : undefined);
    const entry = answers.read(name);
    if (there === undefined || there === signed(entry?.code.trimEnd() ?? originals[k]) || there === originals[k]) return;
    kept = answers.write(name, { code: there, number: k + 1, original: fingerprint(originals[k]), at: Date.now() }) && kept;
    changed += 1;
  });
  if (!kept) return "This browser has no room for everything in the notebook, or stores nothing, so not all of it was loaded.";
  const more = codes.length - originals.length;
  // Without its name, a changed cell may be anywhere in the file.
  const texts = new Set(found.values());
  const lost = names.filter((name, k) => data.cells[k]?.name && !found.has(name) && !texts.has(originals[k])).length;
  const byHand = lost ? ` We cannot tell what the file has for ${count(lost, "cell")} of this page: copy ${lost === 1 ? "it" : "them"} by hand.` : "";
  const own = more > 0 ? ` ${count(more, "cell")} of yours that the page does not have ${more === 1 ? "stays" : "stay"} in the file.` : "";
  const done = changed ? `${count(changed, "cell")} changed: the earlier content is kept below each cell.` : lost ? "Nothing was loaded." : "Nothing differs.";
  return `${done}${byHand}${own}`;
}

// --- all answers of the book ----------------------------------------------------------------------

const KIND = "answers to the exercises of a book";

export async function backUp() {
  if (store.isNewer) return NEWER;
  const kept = Object.fromEntries(store.entries());
  const notebooks = Object.fromEntries(await allCopies());
  const day = new Date().toISOString().slice(0, 10);
  save(`answers-${day}.json`, JSON.stringify({ kind: KIND, version: VERSION, day, kept, notebooks }));
  const answers = Object.keys(kept).filter((key) => key.startsWith("answer ")).length;
  return `Saved: ${count(answers, "answer")} and ${count(Object.keys(notebooks).length, "notebook")}.`;
}

// Restore a backup. Newer texts in the browser stay; the other text is set aside, or stored beside it.
export async function restore() {
  if (store.isNewer) return NEWER;
  const file = await choose(".json");
  let saved;
  try {
    saved = JSON.parse(await file.text());
    if (saved.kind !== KIND) throw new Error();
  } catch {
    return `${file.name} is not a backup of this book: nothing was changed.`;
  }
  if (saved.version > VERSION) return `${file.name} was saved by a newer edition of this book, in a format that this page cannot read: nothing was changed.`;
  let brought = 0, kept = true;
  for (const [key, value] of Object.entries(saved.kept)) {
    const [, page, name] = key.match(/^answer (\S+) (.*)$/s) ?? [];
    const question = key.match(/^question (.*)$/s)?.[1];
    if (page && store.read(key)) {
      const answers = new Answers(page), mine = answers.read(name);
      if (mine.code === value.code) continue;
      kept = (mine.at >= value.at ? answers.setAside(name, value.code, value.at) : answers.write(name, value)) && kept;
      brought += 1;
    } else if (question) {
      kept = store.keepTries(JSON.stringify({ [question]: value.tried }), value.at) && kept;
    } else if (key !== "version" && store.read(key) === null) {
      kept = store.put(key, value) && kept;
      brought += Boolean(page);
    }
  }
  for (const [path, copy] of Object.entries(saved.notebooks)) {
    const mine = await readCopy(path);
    if (JSON.stringify(mine?.content) === JSON.stringify(copy.content)) continue;
    const place = mine ? await placeBeside(path, `from the backup of ${saved.day}`, copy.content) : path;
    await writeCopy(place, { ...copy, path: place, name: place.split("/").at(-1) });
    brought += 1;
  }
  const lacking = kept ? "" : " This browser has no room for all of it: the rest is on this page until you leave it, and in the file.";
  return `${count(brought, "answer or notebook", "answers and notebooks")} restored; newer work here is kept.${lacking}`;
}
