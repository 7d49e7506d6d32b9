// What the reader writes in the cells of a page, as the store keeps it: a text that gives way to another one is set
// aside, not lost.

import { fingerprint, plainName, Store } from "./store.js";

export const SITE = new URL("../../", import.meta.url).pathname;
export const store = new Store(SITE);

// Names that cells keep when others come or go: the name that a grader knows, or else one made of the code.
export function nameCells(cells) {
  const seen = {};
  return cells.map(({ name, original }) => {
    if (name) return name;
    const print = fingerprint(original);
    seen[print] = (seen[print] ?? -1) + 1;
    return `${print}-${seen[print]}`;
  });
}

// What coursework keeps beside a notebook, for all pages: who works here, and how far. {text, at} by the file's name.
const TRIES = "progress.json";
export const coursework = {
  read: (name) => (name === TRIES ? store.tries() : store.read(`coursework ${name}`)),
  write: (name, text, at = Date.now(), base) => (name === TRIES ? store.keepTries(text, at, base) : store.put(`coursework ${name}`, { text, at })),
  all: () => Object.fromEntries(["me.txt", TRIES].map((name) => [name, coursework.read(name)?.text]).filter(([, text]) => text !== undefined)),
};

export class Answers {
  constructor(page) {
    this.page = page;
    this.answer = `answer ${page} `;
    this.aside = `earlier ${page} `;
    this.agreed = `agreed ${page}`;
    this.given = `given ${page} `;
  }

  all() {
    return new Map(store.entries(this.answer));
  }

  // {code, number, original, at}: the text, the cell's place, the fingerprint of the book's code, milliseconds.
  read(name) {
    return store.read(this.answer + name);
  }

  // Keep a text; ``known`` is the one that it takes the place of. Another one that stands there comes from elsewhere,
  // and where there is no room to set it aside, it stays. Returns whether the browser has kept the new one.
  write(name, entry, known) {
    const key = this.answer + name, there = store.kept(key);
    if (there && there.code !== known && there.code !== entry.code && !this.setAside(name, there.code, there.at)) {
      store.hold(key, entry);
      return false;
    }
    return store.put(key, entry);
  }

  isOf(name, key) {
    return key === this.answer + name;
  }

  // Tabs hear of each other a moment late. What another one wrote at the moment in which this one wrote ``own``, over
  // which it did not know to write, is set aside.
  overtake(name, value, own) {
    const theirs = value && JSON.parse(value);
    if (theirs && theirs.code !== own && this.read(name)?.code === own) this.setAside(name, theirs.code, theirs.at);
  }

  // The text makes room before it is set aside, which takes a little less.
  remove(name) {
    const there = this.read(name);
    store.drop(this.answer + name);
    return !there || this.setAside(name, there.code, there.at);
  }

  setAside(name, code, at = Date.now()) {
    return store.put(`${this.aside}${name} ${fingerprint(code)}`, { code, at });
  }

  // The texts that this cell has held, the newest first, without those in ``shown``.
  earlier(name, ...shown) {
    return store.entries(`${this.aside}${name} `).map(([, entry]) => entry)
      .filter(({ code }) => !shown.includes(code)).sort((earlier, later) => later.at - earlier.at);
  }

  // What a question gives its reader, whose numbers are nobody else's, by the cell's name: {student, text, original,
  // variants}. What an edition with other variants has given is not shown again.
  keepGiven(name, entry) {
    store.put(this.given + name, entry);
  }

  givenTo(student, name, original, variants) {
    const entry = store.read(this.given + name), { original: print, text } = entry ?? {};
    return student && plainName(entry?.student ?? "") === student && print === fingerprint(original) && entry.variants === variants ? text : undefined;
  }

  // What this page and its notebook last agreed on: fingerprints by the names of the cells.
  agreement() {
    return store.read(this.agreed) ?? {};
  }

  agree(prints) {
    store.put(this.agreed, { ...this.agreement(), ...prints });
  }

  forgetAgreement() {
    store.drop(this.agreed);
  }
}
