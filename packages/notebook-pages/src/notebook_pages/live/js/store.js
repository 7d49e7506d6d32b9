// The store: all that a browser stores of a book, with its rules and its version. Nothing else is stored in the
// browser, except what belongs to one tab and ends with it. There are three kinds of storage, all named after the site,
// so that two books at one address stay separate:
//
// - entries, short texts as JSON, in localStorage: they are stored at once, even if the tab is closed in the next
//   moment, and other tabs hear of them. One fact has one entry, so that no tab overwrites what another one knows:
//     version                    of the store, at the time of the last change
//     answer PAGE CELL           what the reader has written in a cell; earlier PAGE CELL PRINT: what this replaced
//     given PAGE CELL            the question that a run showed to this reader, with their own numbers
//     agreed PAGE                what the page and its notebook last agreed on
//     record PAGE LIST NAME      one thing that was read, done or checked, or one question that was answered
//     question NAME              what coursework knows of one question; coursework NAME: its other texts
//     setting NAME               what the reader has chosen, or what the browser has fetched
// - editions of the book, stored completely or not at all: files by their content in one cache, and the list that names
//   the newest (editions.js); the service worker cannot read the entries, and finds the version in that list;
// - notebooks, in the database that JupyterLite creates (notebooks.js).
//
// Data of a newer version is left alone, and the reader is told. Data without room lasts as long as the page.
export const VERSION = 3;
export const NEWER = "A newer edition of this book has stored data in this browser in a form that this page cannot read. It stays"
  + " as it is. What you do here lasts until you leave the page; a reload may bring the newer edition.";

export const cacheOf = (site) => `book ${site}`;
const LISTS = ["read", "done", "checked"];
const blank = () => ({ read: [], done: [], checked: [], answers: {} });

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

// Values for which the browser had no room, by key: they last as long as the page, for all scripts that import this.
const unkept = (globalThis.unkept ??= new Map());

// The browser's value of a key of any kind; null also if access is forbidden.
function found(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

const same = (first, second) => JSON.stringify(first) === JSON.stringify(second);
const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

export class Store {
  constructor(site) {
    this.prefix = `book ${site} `;
    this.database = `JupyterLite Storage - ${site}lite/`;
  }

  // Whether a newer version has stored data.
  get isNewer() {
    return parsed(found(`${this.prefix}version`)) > VERSION;
  }

  // The value in the browser, without those for which there was no room.
  kept(key) {
    return this.isNewer ? null : parsed(found(this.prefix + key));
  }

  read(key) {
    return unkept.get(this.prefix + key) ?? this.kept(key);
  }

  // Returns whether the browser has stored it.
  put(key, value) {
    try {
      if (this.isNewer) throw new Error(NEWER);
      if (this.kept("version") !== VERSION) localStorage.setItem(`${this.prefix}version`, VERSION);
      localStorage.setItem(this.prefix + key, JSON.stringify(value));
      unkept.delete(this.prefix + key);
      return true;
    } catch {
      this.hold(key, value);
      return false;
    }
  }

  // Keep a value as long as the page lasts.
  hold(key, value) {
    unkept.set(this.prefix + key, value);
  }

  drop(key) {
    unkept.delete(this.prefix + key);
    try {
      if (!this.isNewer) localStorage.removeItem(this.prefix + key);
    } catch {} // access is forbidden
  }

  keys() {
    let there = [];
    try {
      if (!this.isNewer) there = Object.keys(localStorage);
    } catch {} // access is forbidden
    const own = [...there, ...unkept.keys()].filter((key) => key.startsWith(this.prefix));
    return [...new Set(own)].map((key) => key.slice(this.prefix.length));
  }

  // The entries whose keys begin with ``start``: the rest of the key, and the value.
  entries(start = "") {
    return this.keys().filter((key) => key.startsWith(start)).map((key) => [key.slice(start.length), this.read(key)])
      .filter(([, value]) => value !== null);
  }

  // Whether the reader's text would be lost with the page.
  holdsTexts() {
    return [...unkept.keys()].some((key) => key.startsWith(`${this.prefix}answer `) || key.startsWith(`${this.prefix}earlier `));
  }

  // Call ``use`` with each key that another tab writes, and its text; with null as the key if the tab cleared
  // everything.
  listen(use) {
    addEventListener("storage", ({ key, newValue }) => {
      if (key === null || key.startsWith(this.prefix)) use(key && key.slice(this.prefix.length), newValue);
    });
  }

  // --- the reader's record, by pages ---------------------------------------------------------------

  record() {
    const pages = {};
    for (const [key, value] of this.entries("record ")) {
      const [, page, list, name] = key.match(/^(\S+) (\S+) (.*)$/s) ?? [];
      if (!page) continue;
      const here = (pages[decodeURI(page)] ??= blank());
      if (list === "answers") here.answers[name] = value;
      else here[list]?.push(name);
    }
    return pages;
  }

  // Make one page's record equal to ``wanted``.
  keepRecord(page, wanted) {
    const before = this.record()[page] ?? blank(), start = `record ${encodeURI(page)}`;
    let kept = true;
    for (const list of LISTS) {
      for (const name of before[list]) if (!wanted[list].includes(name)) this.drop(`${start} ${list} ${name}`);
      for (const name of wanted[list]) if (!before[list].includes(name)) kept = this.put(`${start} ${list} ${name}`, true) && kept;
    }
    for (const name of Object.keys(before.answers)) if (!(name in wanted.answers)) this.drop(`${start} answers ${name}`);
    for (const [name, answer] of Object.entries(wanted.answers)) {
      if (!same(answer, before.answers[name])) kept = this.put(`${start} answers ${name}`, answer) && kept;
    }
    return kept;
  }

  // Add the entries of a foreign record, as far as it is valid. Of an answer that exists here, too, the first try and
  // the right answers stay.
  takeRecord(pages) {
    let kept = true;
    for (const [page, found] of Object.entries(isObject(pages) ? pages : {})) {
      const here = this.record()[page] ?? blank();
      for (const list of LISTS) {
        const names = Array.isArray(found?.[list]) ? found[list].filter((name) => typeof name === "string") : [];
        here[list] = [...new Set([...here[list], ...names])];
      }
      for (const [name, { first, last, right, rightAtFirst } = {}] of Object.entries(found?.answers ?? {})) {
        const its = { first: String(first), last: String(last), right: right === true, rightAtFirst: rightAtFirst === true };
        const mine = here.answers[name] ?? its;
        here.answers[name] = { ...mine, last: its.last, right: mine.right || its.right };
      }
      kept = this.keepRecord(page, here) && kept;
    }
    return kept;
  }

  // --- coursework's record of each question --------------------------------------------------------

  // The text of its file, and when it was last changed; null if there is none.
  tries() {
    const all = this.entries("question ").sort(([one], [other]) => (one < other ? -1 : 1));
    if (!all.length) return null;
    const text = JSON.stringify(Object.fromEntries(all.map(([name, { tried }]) => [name, tried])), null, 1);
    return { text, at: Math.max(...all.map(([, { at }]) => at)) };
  }

  // The student ID that was given here, in the form in which IDs are compared; "" if there is none.
  get student() {
    return plainName(this.read("coursework me.txt")?.text ?? "");
  }

  // The state of a question: its outcome with the reader's own numbers or, if there is none, the record with other
  // numbers and whose they were ("" for the default ones). An entry without a name belongs to a question with a single
  // set of numbers, and counts for every reader until the question ``varies``.
  standing(name, varies) {
    const tried = this.read(`question ${name}`)?.tried;
    if (!isObject(tried)) return null;
    const { student } = this;
    const all = [tried, ...Object.values(tried[OTHERS] ?? {})].filter((one) => isObject(one) && one.outcome);
    const whose = (entry) => entry.whose ?? (varies ? "" : student);
    const own = all.find((entry) => plainName(whose(entry)) === student);
    if (own) return { outcome: own.outcome };
    const other = all.find(({ outcome }) => outcome === "correct") ?? all[0];
    return other ? { outcome: other.outcome, whose: whose(other) } : null;
  }

  // Store the entries of a file for the questions that it changes; ``base`` is the file that it was made from. Changes
  // by other tabs in the meantime are joined with it.
  keepTries(text, at = Date.now(), base = "") {
    const was = sound(base);
    let kept = true;
    for (const [name, tried] of Object.entries(sound(text))) {
      if (same(tried, was[name])) continue;
      const here = this.read(`question ${name}`);
      const [older, newer] = here?.at > at ? [tried, here.tried] : [here?.tried, tried];
      const both = same(here?.tried, was[name]) ? tried : joinTries(older, newer);
      if (!same(both, here?.tried)) kept = this.put(`question ${name}`, { tried: both, at: Math.max(at, here?.at ?? 0) }) && kept;
    }
    return kept;
  }
}

const HELP = ["mistake", "hint", "solution"]; // in order of increasing help, as in coursework.checking.reply
// The field of a question's entry for its other variants, by number (see coursework.checking.progress).
const OTHERS = "other variants";

// A damaged record counts as none, as for coursework.
function sound(text) {
  const found = parsed(text);
  return isObject(found) ? found : {};
}

// Names in the form in which coursework compares them: Unicode forms, invisible characters, surrounding spaces and
// capitals make no difference.
export const plainName = (name) => name.normalize("NFKC").replace(/\p{Cf}/gu, "").trim().split(/\s+/).join(" ").toUpperCase();

// Whether two entries have the same numbers; one of a question without variants knows only its place among them.
const ofSameNumbers = (first, second) =>
  first.numbers && second.numbers ? first.numbers === second.numbers : (first.variant ?? 0) === (second.variant ?? 0);

// The joined record of a question: that with the numbers of the newer entry, and the others beside it.
function joinTries(older, newer) {
  if (!isObject(older) || !isObject(newer)) return newer ?? older;
  const apart = ({ [OTHERS]: others, ...own }) => [own, ...Object.values(others ?? {}).filter(isObject)];
  const all = apart(newer);
  for (const entry of apart(older)) {
    const place = all.findIndex((candidate) => ofSameNumbers(candidate, entry));
    if (place < 0) all.push(entry);
    else all[place] = joinEntries(entry, all[place]);
  }
  const [own, ...rest] = all, others = {};
  for (const one of rest) {
    const name = String(one.variant ?? 0);
    others[name in others ? `${name} ${one.numbers}` : name] = one;
  }
  return rest.length ? { ...own, [OTHERS]: others } : own;
}

// Join two entries with the same numbers: a right answer stays right, and no answer, hint or help is lost.
function joinEntries(older, newer) {
  const joined = { ...older, ...newer };
  const right = [older, newer].find(({ outcome }) => outcome === "correct");
  const help = right ? right.help : HELP.findLast((kind) => [older.help, newer.help].includes(kind));
  if (right) joined.outcome = "correct";
  if (help) joined.help = help;
  else delete joined.help;
  for (const list of ["answers", "after"]) {
    if (!joined[list]) continue;
    const known = [...(older[list] ?? []), ...(newer[list] ?? [])].map((item) => JSON.stringify(item));
    joined[list] = [...new Set(known)].map((text) => JSON.parse(text));
  }
  return joined;
}

// Join two files of coursework's record.
export function joinProgress(older, newer) {
  const [a, b] = [sound(older), sound(newer)];
  const both = { ...a, ...b };
  for (const name of Object.keys(a)) if (name in b) both[name] = joinTries(a[name], b[name]);
  return JSON.stringify(both, null, 1);
}
