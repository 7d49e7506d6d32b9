// The reader's code in the cells of a page, as the store keeps it: a text that is replaced is set aside, not lost.

import { fingerprint, plainName, Store } from "./store.js";

export const SITE = new URL("../../", import.meta.url).pathname;
export const store = new Store(SITE);

// Names that cells keep when other cells are added or removed: the name that a grader uses, or else a hash of the code.
export function nameCells(cells) {
  const seen = {};
  return cells.map(({ name, original }) => {
    if (name) return name;
    const print = fingerprint(original);
    seen[print] = (seen[print] ?? -1) + 1;
    return `${print}-${seen[print]}`;
  });
}

// What coursework stores beside a notebook, for all pages: who works here, and the progress. {text, at} by file name.
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

  // {code, number, original, at}: the text, the cell's number, the fingerprint of the book's code, and milliseconds.
  read(name) {
    return store.read(this.answer + name);
  }

  // Keep a text; ``known`` is the one that it replaces. Any other existing text comes from elsewhere, and stays where
  // there is no room to set it aside. Returns whether the browser has stored the new one.
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

  // Tabs hear of each other with a delay. Set aside what another tab wrote while this one wrote ``own`` without knowing
  // of it.
  overtake(name, value, own) {
    const theirs = value && JSON.parse(value);
    if (theirs && theirs.code !== own && this.read(name)?.code === own) this.setAside(name, theirs.code, theirs.at);
  }

  // Remove the text before it is set aside, because this makes the room for it.
  remove(name) {
    const there = this.read(name);
    store.drop(this.answer + name);
    return !there || this.setAside(name, there.code, there.at);
  }

  setAside(name, code, at = Date.now()) {
    return store.put(`${this.aside}${name} ${fingerprint(code)}`, { code, at });
  }

  // Earlier texts of this cell, the newest first, without those in ``shown``.
  earlier(name, ...shown) {
    return store.entries(`${this.aside}${name} `).map(([, entry]) => entry)
      .filter(({ code }) => !shown.includes(code)).sort((earlier, later) => later.at - earlier.at);
  }

  // Keep what a question gives a reader with numbers of their own, by the cell's name: {student, text, original,
  // variants}. It is not shown again in an edition with other variants.
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
