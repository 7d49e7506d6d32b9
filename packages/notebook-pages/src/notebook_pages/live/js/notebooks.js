// The notebooks that JupyterLite stores in this browser, and how one of them and its page are made to agree.
import { Answers, coursework, nameCells, store } from "./answers.js";
import { fingerprint, joinProgress } from "./store.js";

const text = (source) => (Array.isArray(source) ? source.join("") : source).trimEnd();
const settled = (request) => new Promise((resolve, reject) => {
  request.onsuccess = () => resolve(request.result);
  request.onerror = () => reject(request.error);
});

// Call ``use`` with the store of files; if it is missing, create it in the same way as JupyterLite's own library.
async function files(mode, use) {
  const known = (await indexedDB.databases?.() ?? [{ name: store.database }]).some(({ name }) => name === store.database);
  if (!known && mode === "readonly") return undefined;
  let database = await settled(indexedDB.open(store.database));
  if (!database.objectStoreNames.contains("files")) {
    const version = database.version + 1;
    database.close();
    if (mode === "readonly") return undefined;
    const opening = indexedDB.open(store.database, version);
    opening.onupgradeneeded = () => opening.result.createObjectStore("files");
    database = await settled(opening);
  }
  try {
    return await use(database.transaction("files", mode).objectStore("files"));
  } finally {
    database.close();
  }
}

export const readCopy = (path) => files("readonly", (store) => settled(store.get(path)));
export const writeCopy = (path, copy) => files("readwrite", (store) => settled(store.put(copy, path)));
export const allCopies = async () => (await files("readonly", async (store) => {
  const [keys, values] = await Promise.all([settled(store.getAllKeys()), settled(store.getAll())]);
  return keys.map((key, k) => [key, values[k]]);
})) ?? [];

// A free path for ``content`` beside the file at ``path``, with ``words`` in its name, so that nothing is overwritten.
export async function placeBeside(path, words, content) {
  for (let number = 1; ; number += 1) {
    const place = path.replace(/(\.\w+)?$/, ` (${words}${number > 1 ? `, ${number}` : ""})$1`);
    const there = await readCopy(place);
    if (!there || JSON.stringify(there.content) === JSON.stringify(content)) return place;
  }
}

export function newFile(path, content) {
  const now = new Date().toISOString();
  return {
    name: path.split("/").at(-1), path, last_modified: now, created: now, format: "json",
    mimetype: "application/json", content, size: JSON.stringify(content).length, writable: true, type: "notebook",
  };
}

// Files of coursework beside the notebooks of a folder belong to all pages and notebooks. Of the student IDs the newer
// one counts, and the progress is joined question by question.
export async function agreeOnRecords(page, mayWrite = false) {
  const folder = `${page.split("/").slice(0, -1).join("/")}/.coursework`;
  for (const [name, join] of [["me.txt", (older, newer) => newer], ["progress.json", joinProgress]]) {
    const path = `${folder}/${name}`, here = coursework.read(name), copy = await readCopy(path);
    const there = copy && { text: typeof copy.content === "string" ? copy.content : JSON.stringify(copy.content), at: Date.parse(copy.last_modified) };
    if (!here && !there) continue;
    const [older, newer] = (there?.at ?? 0) > (here?.at ?? 0) ? [here, there] : [there, here];
    const both = older ? join(older.text, newer.text) : newer.text;
    if (both !== here?.text) coursework.write(name, both, newer.at);
    if (mayWrite && both !== there?.text) {
      const about = { ...newFile(path, both), format: "text", mimetype: "text/plain", type: "file", size: both.length };
      await writeCopy(folder, { ...newFile(folder, null), format: "json", mimetype: "", type: "directory", size: 0 });
      await writeCopy(path, about);
    }
  }
}

// The code cells of a notebook that are the book's: their names, texts, and the code that the book had there.
export function bookCells(notebook) {
  const codes = notebook.cells.filter((cell) => cell.cell_type === "code");
  const stamp = notebook.metadata?.book?.cells;
  if (stamp) {
    return codes.filter(({ id }) => id in stamp).map((cell) => ({
      cell, name: stamp[cell.id][0], text: text(cell.source), original: stamp[cell.id][1],
    }));
  }
  // Notebooks from elsewhere have no stamp: the names that graders use identify their cells.
  const graded = (cell) => cell.metadata?.nbgrader?.grade_id;
  const names = nameCells(codes.map((cell) => ({ name: graded(cell), original: text(cell.source) })));
  return codes.map((cell, k) => ({ cell, name: names[k], text: text(cell.source), original: null }));
}

export const edition = (notebook) => JSON.stringify(Object.values(notebook.metadata?.book?.cells ?? {}));

// Make the copy and the page agree. The text of each cell is taken from the side that has changed since they last
// agreed; if both have changed, the newer text is used and the other is set aside. Returns the names of the cells that
// changed on the page, and in the copy. If the copy may be changed too, ``originals`` is the book's code by
// names.
export function bringTogether(page, copy, originals) {
  const answers = new Answers(page);
  const agreement = answers.agreement(), agreed = {};
  const came = [], went = [];
  for (const { cell, name, text: there, original } of bookCells(copy.content)) {
    const entry = answers.read(name);
    if (entry && original && entry.original !== original) continue; // of another edition: the page asks
    const changedThere = original === null || fingerprint(there) !== original;
    if (entry ? entry.code.trimEnd() === there : !changedThere) {
      agreed[name] = fingerprint(there);
      continue;
    }
    const last = agreement[name] ?? original;
    const copyMoved = fingerprint(there) !== last;
    const here = entry ? fingerprint(entry.code.trimEnd()) : original;
    const pageMoved = here !== last;
    const pageWins = pageMoved && (!copyMoved || (entry?.at ?? 0) > Date.parse(copy.last_modified));
    if (pageWins) {
      const source = entry?.code ?? originals?.[name];
      if (!originals || source === undefined) continue;
      if (changedThere) answers.setAside(name, there, Date.parse(copy.last_modified));
      Object.assign(cell, { source, outputs: [], execution_count: null });
      agreed[name] = here;
      went.push(name);
    } else if (copyMoved) {
      if (!changedThere) answers.remove(name);
      else {
        const number = entry?.number ?? Object.keys(copy.content.metadata.book?.cells ?? {}).indexOf(cell.id) + 1;
        answers.write(name, { code: there, number, original: original ?? entry?.original, at: Date.now() });
      }
      agreed[name] = fingerprint(there);
      came.push(name);
    }
  }
  answers.agree(agreed);
  return { came, went };
}
