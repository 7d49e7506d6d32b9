// Runs before JupyterLite opens a notebook: copies the answers of its page into it, and asks if the book has changed.
import { Answers, SITE, store } from "./answers.js";
import { agreeOnRecords, bookCells, bringTogether, edition, newFile, placeBeside, readCopy, writeCopy } from "./notebooks.js";

const element = (tag, properties, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

// Ask before the interface is loaded. Resolves to the index of the button that was clicked.
function ask(title, words, ...choices) {
  return new Promise((resolve) => {
    const buttons = choices.map((choice, place) => element("button", {
      textContent: choice, onclick: () => (dialog.remove(), resolve(place)),
      style: "display: block; margin: 0.6rem 0; padding: 0.5rem 1rem; font: inherit; text-align: left",
    }));
    const dialog = element("dialog", {
      className: "book-choice", style: "max-width: 34rem; padding: 1.5rem; font: 1rem/1.5 system-ui, sans-serif",
      oncancel: (event) => event.preventDefault(),
    }, element("h1", { textContent: title, style: "font-size: 1.2rem; margin: 0 0 0.6rem" }),
    element("p", { textContent: words }), ...buttons);
    document.body.append(dialog);
    dialog.showModal();
  });
}

async function open(path) {
  const answer = await fetch(`${SITE}lite/files/${path}`, { cache: "no-cache" });
  if (!answer.ok) return; // a notebook of the reader's own
  const book = await answer.json();
  const originals = Object.fromEntries(bookCells(book).map(({ name, text }) => [name, text]));
  const page = path.replace(/\.ipynb$/, "");
  await agreeOnRecords(page, true);
  const copy = await readCopy(path);
  let used = copy;
  if (copy) {
    if (!copy.content.metadata.book) return; // the reader put it there
    if (edition(copy.content) !== edition(book)) used = await choose(path, copy, book);
  } else {
    used = newFile(path, book);
    new Answers(page).forgetAgreement();
  }
  const { went } = bringTogether(page, used, originals);
  if (went.length || (copy && used !== copy)) {
    await writeCopy(path, { ...used, last_modified: new Date().toISOString() });
  }
  new Answers(page).agree({}); // tells the page that there is a notebook to check
}

// The notebook of the book has changed since the copy was made. Whatever the reader chooses, the copy is kept.
async function choose(path, copy, book) {
  const written = bookCells(copy.content).filter(({ text, original }) => text && original !== null);
  const name = await placeBeside(path, `my copy of ${copy.last_modified.slice(0, 16).replace(/[T:]/g, "-")}`, copy.content);
  const choice = await ask("The book has a new version of this notebook",
    "You have a copy of an older version, with what you wrote in it. The new version is opened with your answers in "
    + `the cells that are still the same, and your copy stays beside it as “${name.split("/").at(-1)}”.`,
    "Open the new version", "Open my copy as it is");
  if (choice === 1) return copy;
  await writeCopy(name, { ...copy, path: name, name: name.split("/").at(-1) });
  const fresh = newFile(path, book);
  const mine = new Map(written.map(({ name: cell, text, original }) => [cell, { text, original }]));
  const stamps = new Map(Object.values(book.metadata.book.cells));
  for (const { cell, name: of } of bookCells(fresh.content)) {
    const text = mine.get(of);
    if (text && stamps.get(of) === text.original) cell.source = text.text;
  }
  return fresh;
}

export async function prepare() {
  const path = new URLSearchParams(location.search).get("path");
  if (!path?.endsWith(".ipynb") || store.isNewer) return;
  try {
    await open(path);
  } catch (error) {
    console.warn(`The answers of the page could not be copied into the notebook: ${error.message}`);
  }
}
