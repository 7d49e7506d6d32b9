// What the reader writes, kept in this browser. Each cell of each page has an entry of its own, so that two
// tabs never write over each other's cells; and a text that gives way to another one is set aside, not lost.
// The keys carry the site's path: two books, or two editions, at one address keep apart what belongs to them.

export const SITE = new URL("../../", import.meta.url).pathname;
export const PREFIX = `book ${SITE} `;

export function fingerprint(text) {
  let a = 0xdeadbeef, b = 0x41c6ce57; // cyrb53, a short hash that is good enough to tell texts apart
  for (let k = 0; k < text.length; k++) {
    const unit = text.charCodeAt(k);
    a = Math.imul(a ^ unit, 2654435761);
    b = Math.imul(b ^ unit, 1597334677);
  }
  a = Math.imul(a ^ (a >>> 16), 2246822507) ^ Math.imul(b ^ (b >>> 13), 3266489909);
  b = Math.imul(b ^ (b >>> 16), 2246822507) ^ Math.imul(a ^ (a >>> 13), 3266489909);
  return (4294967296 * (2097151 & b) + (a >>> 0)).toString(36);
}

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
const COURSEWORK = `${PREFIX}coursework `;
export const coursework = {
  read: (name) => parsed(COURSEWORK + name),
  write: (name, text, at = Date.now()) => put(COURSEWORK + name, { text, at }),
  all: () => Object.fromEntries(Answers.entries(COURSEWORK).map(([name, { text }]) => [name, text])),
};

// What the browser had no room for, by its key: it lasts as long as the page, for all scripts of which this is a part.
export const unkept = (globalThis.unkeptAnswers ??= new Map());

function stored(key) {
  try {
    return JSON.parse(localStorage.getItem(key));
  } catch {
    return null;
  }
}

const parsed = (key) => unkept.get(key) ?? stored(key);

function drop(key) {
  unkept.delete(key);
  localStorage.removeItem(key);
}

// Returns whether the browser has kept it.
function put(key, value) {
  try {
    localStorage.setItem(key, JSON.stringify(value));
    unkept.delete(key);
    return true;
  } catch {
    unkept.set(key, value);
    return false;
  }
}

export class Answers {
  constructor(page) {
    this.page = page;
    this.answer = `${PREFIX}answer ${page} `;
    this.aside = `${PREFIX}earlier ${page} `;
    this.agreed = `${PREFIX}agreed ${page}`;
    this.given = `${PREFIX}given ${page} `;
  }

  // The entries whose keys begin with ``start``: what follows it, and the value.
  static entries(start) {
    const keys = new Set([...Object.keys(localStorage), ...unkept.keys()].filter((key) => key.startsWith(start)));
    return [...keys].map((key) => [key.slice(start.length), parsed(key)]).filter(([, value]) => value);
  }

  all() {
    return new Map(Answers.entries(this.answer));
  }

  // {code, number, original, at}: the text, the cell's place, the fingerprint of the book's code, milliseconds.
  read(name) {
    return parsed(this.answer + name);
  }

  // Keep a text; ``known`` is the one that it takes the place of. Another one that stands there comes from elsewhere,
  // and where there is no room to set it aside, it stays. Returns whether the browser has kept the new one.
  write(name, entry, known) {
    const key = this.answer + name, there = stored(key);
    if (there && there.code !== known && there.code !== entry.code && !this.setAside(name, there.code, there.at)) {
      unkept.set(key, entry);
      return false;
    }
    return put(key, entry);
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
    drop(this.answer + name);
    return !there || this.setAside(name, there.code, there.at);
  }

  setAside(name, code, at = Date.now()) {
    return put(`${this.aside}${name} ${fingerprint(code)}`, { code, at });
  }

  // The texts that this cell has held, the newest first, without those in ``shown``.
  earlier(name, ...shown) {
    return Answers.entries(`${this.aside}${name} `).map(([, entry]) => entry)
      .filter(({ code }) => !shown.includes(code)).sort((one, other) => other.at - one.at);
  }

  // What a question gives its reader, whose numbers are nobody else's: {student, text, original}, by the cell's name.
  keepGiven(name, entry) {
    put(this.given + name, entry);
  }

  givenTo(student, name, original) {
    const entry = parsed(this.given + name);
    return entry?.student === student && entry.original === fingerprint(original) ? entry.text : undefined;
  }

  // What this page and its notebook last agreed on: fingerprints by the names of the cells.
  agreement() {
    return parsed(this.agreed) ?? {};
  }

  agree(prints) {
    put(this.agreed, { ...this.agreement(), ...prints });
  }

  forgetAgreement() {
    localStorage.removeItem(this.agreed);
  }

  // The first edition kept all edits of a page in one list, under a name that other books may share: it stays
  // where it is, and is read once.
  bringOld(names, originals) {
    const old = parsed(`code of ${this.page}`);
    if (!Array.isArray(old) || parsed(`${PREFIX}old ${this.page}`)) return;
    for (const { number, original, code } of old) {
      const places = [number - 1, ...originals.keys()];
      const place = places.find((k) => originals[k] !== undefined && fingerprint(originals[k]) === original
        && !this.read(names[k]));
      const name = place === undefined ? `old-${fingerprint(code)}` : names[place];
      this.write(name, { code, number, original, at: 0 });
    }
    put(`${PREFIX}old ${this.page}`, true);
  }
}
