// Finds places of the book by what a reader types: words, with slips and synonyms, or signs of a formula.
//
// A place answers to its title and to the phrases that readers use for it. Each word of a question counts by how rare it
// is; a phrase is as good as the share of the question that it answers, and of itself that was asked for.
import MiniSearch from "minisearch";
import { isWeak, plain, read, stem, words } from "./words.js";

// The signs of a formula, as TeX has them or as they are typed: what only shapes them is left out.
export function signs(text) {
  return plain(text.replace(/\{\}\^\{?[A-Z]\}?(\\left\(|\()?(\\mathbf\{C\}|C)\^\{?[A-Z]\}?/g, "$1 C ").replace(/\\(?:math\w+|boldsymbol|hat|bar|left|right|[dt]?frac|quad|qquad|lvert|rvert|begin|end|text\w*)(?![a-z])|\\[,;:! ]/gi, " ")
    .replace(/\b(?:aligned|bmatrix|cases)\b/g, " ")).match(/[a-z]{3,}|[a-z0-9]|[=+-]/g) ?? [];
}
const isFormula = (query) => /[=^\\√·×]|[a-z0-9]\(|\d\/|\/\d|[a-z]_[a-z0-9]\b/i.test(query) && !/[a-z]{2}_[a-z]{2}/i.test(query);
const pairs = (list) => [...list, ...list.slice(1).map((sign, k) => `${list[k]} ${sign}`)];

function overlap(one, other) {
  const left = new Map();
  for (const sign of other) left.set(sign, (left.get(sign) ?? 0) + 1);
  let common = 0;
  for (const sign of one) if (left.get(sign) > 0) common += 1, left.set(sign, left.get(sign) - 1);
  return common;
}

// How many letters must be changed, added or left out, or two neighbours exchanged, to make one word of the other.
function slips(one, other) {
  let [before, row] = [[], [...Array(other.length + 1).keys()]];
  for (let i = 1; i <= one.length; i += 1) {
    const next = [i];
    for (let j = 1; j <= other.length; j += 1) {
      next[j] = Math.min(row[j] + 1, next[j - 1] + 1, row[j - 1] + (one[i - 1] === other[j - 1] ? 0 : 1));
      if (one[i - 1] === other[j - 2] && one[i - 2] === other[j - 1]) next[j] = Math.min(next[j], before[j - 2] + 1);
    }
    [before, row] = [row, next];
  }
  return row[other.length];
}

// What a reader looks for is rather one than another of these, where both answer as well.
const KINDS = { page: 1.1, section: 1.05, term: 1.06, function: 0.92, exercise: 0.88, example: 0.85, equation: 0.6, figure: 0.8 };
const READ = { page: true, section: true }; // those of the chapters have numbers
const CHAPTER = 0.45, ABOUT = 0.45, TEXT = 0.3; // what a word counts that stands not in a phrase, but there
const SAME = 1.12; // for the very words
const SYNONYM = 0.9, OF_WEAK = 0.3;
const OTHER_WAY = 0.7, NO_WAY = 0.88; // where a conversion is asked for: the one back, or none
const isName = (query) => /^\w*[a-z]_[a-z]\w*$|^[a-z]{2,}(?:[A-Z][a-z]+)+$/.test(query);
const named = (query) => plain(query.replace(/([a-z])([A-Z])/g, "$1_$2"));

// ``more`` holds the words of each entry's text, its TeX, and the figures, once they are there.
export function finder({ pages, fields, kinds: kindsOfPlaces, entries: rows, synonyms = {} }, more = {}) {
  const entries = [...rows, ...more.figures ?? []].map((row) => Object.fromEntries(fields.map((field, k) => [field, row[k] || undefined])));
  for (const entry of entries) entry.kind = kindsOfPlaces[entry.kind ?? 0];
  const kinds = (synonyms.conversions ?? []).map((group) => group.map(words));
  const groups = (synonyms.words ?? []).map((group) => group.map(words).filter((phrase) => phrase.join("").length > 1));

  // A text as words, and the concepts and conversions that stand in it, each with the words that it covers.
  const heads = new Map(); // the concepts that begin with a word
  for (const [number, group] of groups.entries()) for (const phrase of group) heads.set(phrase[0], [...heads.get(phrase[0]) ?? [], [number, phrase]]);
  function understood(text) {
    const { list, conversions } = read(text, kinds);
    const signs = conversions.map(({ way, start, end }) => ({ term: `§${way[0]}>${way[1]}`, back: `§${way[1]}>${way[0]}`, start, end }));
    for (const [k, word] of list.entries()) for (const [number, phrase] of heads.get(word) ?? []) {
      if (phrase.every((one, j) => list[k + j] === one)) signs.push({ term: `§${number}`, start: k, end: k + phrase.length });
    }
    return { list, signs };
  }

  // Each title and each phrase is a document, and so is each text.
  const documents = [];
  for (const [id, entry] of entries.entries()) {
    entry.page ??= 0;
    const add = (text, share = 1) => documents.push({ entry: id, share, ...understood(text) });
    entry.title ??= `Equation ${entry.number}: ${entries[id - 1].kind === "equation" ? entries[id - 1].of : entries[id - 1].title}`;
    if (entry.kind === "equation") entry.of = entry.title.slice(entry.title.indexOf(": ") + 2);
    add(entry.title);
    if (entry.number) documents.push({ entry: id, share: 1, alone: true, ...understood(/^[A-Z]/.test(entry.number) ? entry.number : `${entry.kind === "page" ? "chapter" : entry.kind} ${entry.number}`) });
    for (const phrase of entry.asked ?? []) add(phrase, 0.98);
    if (entry.about) documents.push({ entry: id, within: ABOUT, ...understood(entry.about) });
    if (entry.anchor && pages[entry.page][2]) documents.push({ entry: id, within: CHAPTER, ...understood(pages[entry.page][1]) });
    if (more.words?.[id]) documents.push({ entry: id, within: TEXT, list: words(more.words[id]), signs: [] });
  }
  const spread = new Map(), known = new Set(); // in how many entries each word or concept stands
  for (const [id, { entry, list, signs, within }] of documents.entries()) {
    documents[id].id = id;
    for (const word of list) known.add(word);
    if (within === CHAPTER) continue;
    for (const word of [...list, ...signs.map(({ term }) => term)]) {
      if (!spread.has(word)) spread.set(word, new Set());
      spread.get(word).add(entry);
    }
  }
  const rarity = (term) => Math.log(1 + entries.length / (1 + (spread.get(term)?.size ?? 0)));
  const worth = (word, signs = [], k = -1) => {
    const concepts = signs.filter(({ term, start, end }) => !term.includes(">") && start === k && end === k + 1).map(({ term }) => rarity(term));
    return Math.min(rarity(word), ...concepts) * (isWeak(word) ? OF_WEAK : 1);
  };
  const index = new MiniSearch({ fields: ["words"], tokenize: (text) => text.split(" ").filter(Boolean), processTerm: (term) => term });
  index.addAll(documents.map(({ id, list, signs }) => ({ id, words: [...list, ...signs.map(({ term }) => term)].join(" ") })));
  for (const one of documents) {
    one.worths = one.list.map((word, k) => worth(word, one.signs, k));
    one.worth = one.worths.reduce((sum, one) => sum + one, 0);
  }
  const formulas = (more.tex ?? []).map(([id, tex]) => ({ id, signs: pairs(signs(tex)) }));

  // Words that were written together, or apart, as the book has them.
  function joined(list) {
    const found = [];
    for (let k = 0; k < list.length; k += 1) {
      const [one, other] = [list[k], list[k + 1]];
      if (other && !(known.has(one) && known.has(other)) && known.has(stem(one + other))) {
        found.push(one + other), k += 1;
        continue;
      }
      let cut = null;
      if (!known.has(one)) for (let j = 3; j <= one.length - 3 && !cut; j += 1) {
        const parts = [stem(one.slice(0, j)), stem(one.slice(j))];
        if (parts.every((part) => known.has(part) && (spread.get(part)?.size ?? 0) > 1)) cut = parts;
      }
      found.push(...cut ?? [one]);
    }
    return found;
  }

  // The documents that have a word, or one like it: [document, which of its words, how like].
  function having(word, isLast) {
    const exact = known.has(word);
    const found = index.search(word, {
      prefix: word.length > 2 && (isLast || !exact) && word[0] !== "§",
      fuzzy: exact || word.length < 4 || /\d/.test(word) ? false : word.length > 6 ? 2 : 1,
    });
    return found.map(({ id, terms }) => {
      let like = 0, its = null;
      for (const term of terms) {
        const now = term === word ? 1 : term[0] === "§" ? 0 : term.startsWith(word) ? (exact ? 0.6 : 0.92 - 0.02 * (term.length - word.length)) : 0.95 - 0.15 * slips(word, term) - (term[0] === word[0] ? 0 : 0.1);
        if (now > like) [like, its] = [now, term];
      }
      return [documents[id], its, like];
    });
  }

  function byWords(text, ending) {
    let { list, signs } = understood(text);
    const put = joined(list);
    if (put.length !== list.length || put.some((word, k) => word !== list[k])) ({ list, signs } = understood(put.join(" ")));
    if (!list.length) return [];
    const worths = list.map((word, k) => worth(word, signs, k));
    const whole = worths.reduce((sum, one) => sum + one, 0);
    const states = new Map();
    const state = (one) => {
      if (!states.has(one)) states.set(one, { asked: new Float64Array(list.length), own: new Float64Array(one.list.length), back: false });
      return states.get(one);
    };
    for (const [k, word] of list.entries()) for (const [one, its, like] of having(word, ending && k === list.length - 1)) {
      const { asked, own } = state(one);
      asked[k] = Math.max(asked[k], like);
      for (const [j, term] of one.list.entries()) if (term === its) own[j] = Math.max(own[j], like);
    }
    for (const { term, back, start, end } of signs) {
      const like = term.includes(">") ? 1 : SYNONYM;
      for (const [one] of having(term)) {
        const { asked, own } = state(one);
        for (let k = start; k < end; k += 1) asked[k] = Math.max(asked[k], like);
        for (const sign of one.signs) if (sign.term === term) for (let j = sign.start; j < sign.end; j += 1) own[j] = Math.max(own[j], like);
      }
      if (back) for (const [one] of having(back)) state(one).back = !one.signs.some((sign) => sign.term === term);
    }
    const within = new Map(); // what the text of an entry adds
    for (const [one, { asked }] of states) if (one.within) {
      if (!within.has(one.entry)) within.set(one.entry, new Float64Array(list.length));
      const sum = within.get(one.entry);
      for (const [k, like] of asked.entries()) sum[k] = Math.max(sum[k], like * one.within);
    }
    const best = new Map(), all = new Map(), there = list.join(" ");
    const ways = new Set(signs.map(({ term }) => term).filter((term) => term.includes(">"))), asksWay = ways.size > 0;
    for (const [one, { asked, own, back }] of states) {
      if (one.within) continue;
      const beside = one.alone ? null : within.get(one.entry);
      let answered = 0, used = 0;
      for (const [k, like] of asked.entries()) answered += worths[k] * Math.max(like, beside?.[k] ?? 0);
      for (const [j, like] of own.entries()) used += one.worths[j] * like;
      if (!one.alone) {
        if (!all.has(one.entry)) all.set(one.entry, { asked: new Float64Array(list.length), used: 0 });
        const its = all.get(one.entry);
        for (const [k, like] of asked.entries()) its.asked[k] = Math.max(its.asked[k], like * one.share, beside?.[k] ?? 0);
        its.used = Math.max(its.used, used / one.worth * answered / whole);
      }
      const score = (answered / whole) ** 1.5 * (0.5 + 0.5 * used / one.worth) * one.share * (one.list.join(" ") === there ? SAME : 1)
        * (!asksWay ? 1 : back ? OTHER_WAY : one.signs.some(({ term }) => ways.has(term)) ? 1 : NO_WAY);
      best.set(one.entry, Math.max(best.get(one.entry) ?? 0, score));
    }
    for (const [id, { asked, used }] of all) { // what no one phrase of a place answers, all of them may
      const answered = asked.reduce((sum, like, k) => sum + worths[k] * like, 0);
      best.set(id, Math.max(best.get(id) ?? 0, (answered / whole) ** 1.5 * (0.5 + 0.5 * used)));
    }
    for (const [id, sum] of within) {
      const answered = sum.reduce((all, like, k) => all + worths[k] * like, 0);
      best.set(id, Math.max(best.get(id) ?? 0, (answered / whole) ** 1.5 * 0.5));
    }
    return [...best].map(([id, score]) => {
      const { kind, number, weight = 1 } = entries[id];
      return [id, score * (KINDS[kind] ?? 1) * weight * (number || !READ[kind] ? 1 : 0.93)];
    });
  }

  // The entries that answer, the best first.
  return (query, most = 12) => {
    const scores = new Map(), take = (found, share = 1) => {
      for (const [id, score] of found) scores.set(id, Math.max(scores.get(id) ?? 0, score * share));
    };
    const formula = isFormula(query);
    if (isName(query.trim())) {
      const name = named(query.trim());
      take(entries.flatMap(({ kind, title }, id) => {
        const its = title.toLowerCase().split(".").at(-1);
        return kind !== "function" || !its.startsWith(name) ? [] : [[id, its === name ? 3 : 1.5]];
      }));
    }
    take(byWords(query, !/\s$/.test(query)), formula ? 0.6 : 1);
    if (formula) {
      const asked = pairs(signs(query));
      take(formulas.map(({ id, signs: there }) => [id, (overlap(asked, there) / asked.length) ** 2 * (asked.length / there.length) ** 0.2]));
    }
    return [...scores].filter(([, score]) => score > 0.06).sort((one, other) => other[1] - one[1]).slice(0, most)
      .map(([id, score]) => ({ ...entries[id], score }));
  };
}
