// Find places of the book by what a reader types: words, with typing errors and synonyms, or symbols of a formula.
//
// A place is found by its title and by the phrases that readers use for it. Each word of a question counts by how rare
// it is, and most if it is a term of the subject. A phrase counts by the share of the question that it covers, and by
// the share of itself that the question covers. Several good phrases of a place count more than one. The shares below
// were fitted to titles of forums (``questions.txt``).
import SearchableMap from "minisearch/SearchableMap";
import { isLeftOut, isWeak, plain, read, stem, words } from "./words.js";

// The symbols of a formula, as in TeX or as they are typed, without those that only set its form.
export function signs(text) {
  return plain(text.replace(/\{\}\^\{?[A-Z]\}?(\\left\(|\()?(\\mathbf\{C\}|C)\^\{?[A-Z]\}?/g, "$1 C ")
    .replace(/\\(?:math\w+|text\w*|boldsymbol|hat|bar|left|right)(?![a-z])/gi, " ")
    .replace(/\\(?:[dt]?frac|q?quad|lvert|rvert|begin|end)(?![a-z])/gi, " ")
    .replace(/\\[,;:! ]|\b(?:aligned|bmatrix|cases)\b/g, " ")).match(/[a-z]{3,}|[a-z0-9]|[=+-]/g) ?? [];
}
const FORMULA = /[=^\\√·×]|\b(?:[a-z]|sin|cos|tan|exp|log|det)\(|\d\/|\/\d|[a-z]_[a-z0-9]\b/i;
const isFormula = (query) => FORMULA.test(query) && !/[a-z]{2}_[a-z]{2}/i.test(query);
const pairs = (list) => [...list, ...list.slice(1).map((sign, k) => `${list[k]} ${sign}`)];

function overlap(one, other) {
  const left = new Map();
  for (const sign of other) left.set(sign, (left.get(sign) ?? 0) + 1);
  let common = 0;
  for (const sign of one) if (left.get(sign) > 0) common += 1, left.set(sign, left.get(sign) - 1);
  return common;
}

// If places of several kinds answer equally well, these are the kinds that readers prefer.
const KINDS = {
  page: 1.1, section: 1.05, term: 1.06, function: 0.92, exercise: 0.88, example: 0.85, equation: 0.6, figure: 0.8,
};
const IN_LONG = { term: 0.85 }; // a question of more than two words asks for more than a term
const ASKED = 0.95; // the least score of a place with phrases in the words of readers
const WITHIN = { about: 0.45, text: 0.25 }; // the weight of a word that is not in a phrase, but there
const SYNONYM = 0.8, SAME = 1.5; // for a synonym, and for exactly the same words
const OF_WEAK = 0.4, OF_OTHERS = 0.6; // for words that say little, and for words not of the subject
const APART = 0.7; // for one word of a name of several words, without the others
const POWER = 1.5, OWN = 0.5; // how the answered share counts, and the share of a phrase's own words
const TOGETHER = 4; // the power in which the scores of the phrases of a place are added: the best counts most
const ENDS = 6, ENDED = 0.7; // how many completions of a last word are tried, and their weight if it is a word
const OTHER_WAY = 0.6, NO_WAY = 0.7; // where a conversion is asked for: for the opposite one, or for none
// Added to a page whose title starts with the question, and twice for a chapter: no other place gets as much. A word
// within the title counts half.
const BEGUN = 2;
const headed = (text) => plain(text).replace(/^(?:the|an?) +(?=.)/, "").replace(/-/g, " ");
const isName = (query) => /^\w*[a-z]_[a-z]\w*$|^[a-z]{2,}(?:[A-Z][a-z]+)+$/.test(query);
const named = (query) => plain(query.replace(/([a-z])([A-Z])/g, "$1_$2"));

// The words of names of several words: "rotate vectors" is not a rotation vector, but "rotation vectors" are.
const single = (word) => (word.length < 4 || word.endsWith("ss") ? word
  : word.replace(/(?<=[sxz]|ch|sh)es$|s$/, "").replace(/([iy])z(?=e|ed|ing|ation)/, "$1s"));
const BETWEEN = new Set(["and", "the"]);
const AMID = new Set(["a", "an", "the", "given", "my", "and", "angle", "angles", "values", "of", "in", "rotation",
  "rotations", "orientation"]);
const isWay = (sign) => sign.term.includes(">");

// ``more`` contains the words of each entry's text, further phrases and first sentences, the TeX of the equations, the
// equations and the figures, once they are loaded.
export function finder({ pages, fields, kinds, entries: rows, synonyms = {} }, more = {}) {
  const entries = [...rows, ...more.entries ?? []].map((row) => (
    Object.fromEntries(fields.map((field, k) => [field, row[k] || undefined]))));
  for (const [id, about] of more.about ?? []) entries[id].about = about;
  for (const [id, asked] of more.asked ?? []) entries[id].asked = [...entries[id].asked ?? [], ...asked];
  for (const entry of entries) entry.kind = kinds[entry.kind ?? 0], entry.page ??= 0;

  // Concepts have several names of one or more words, and so have things that can be converted into one another.
  const heads = new Map(); // the names that start with a word
  for (const [of, groups] of Object.entries(synonyms)) for (const [number, group] of groups.entries()) {
    for (const name of group) {
      const list = read(name).all.filter((word) => !BETWEEN.has(word)).map(single);
      if (list.join("").length < 2) continue;
      const exact = list.length > 1 || of === "conversions"; // "rotation" is not "rot"
      if (!exact) list[0] = stem(list[0]);
      const head = `${exact} ${list[0]}`;
      heads.set(head, [...heads.get(head) ?? [], { of, number, list }]);
    }
  }

  // Split a text into words, and find its concepts and conversions, each with the words that it covers.
  function understood(text) {
    const { all, list, at } = read(text);
    const kept = all.flatMap((word, k) => (BETWEEN.has(word) ? [] : [k]));
    const signs = [], spans = [];
    for (const [k, first] of kept.entries()) {
      const some = [...heads.get(`true ${single(all[first])}`) ?? [], ...heads.get(`false ${stem(all[first])}`) ?? []];
      for (const { of, number, list: name } of some) {
        if (name.length > 1 && !name.every((one, j) => one === single(all[kept[k + j]] ?? ""))) continue;
        const last = kept[k + name.length - 1];
        const start = at.findIndex((place) => place >= first), end = at.filter((place) => place <= last).length;
        if (start < 0 || end <= start) continue;
        if (of === "words") signs.push({ term: `§${number}`, start, end });
        else spans.push({ number, start, end, first, last });
      }
    }
    // The longest name of several words to which each word belongs.
    const names = list.map((_, k) => signs.filter(({ start, end }) => end - start > 1 && start <= k && k < end)
      .reduce((best, sign) => (best && best.end - best.start >= sign.end - sign.start ? best : sign), null)?.term);
    spans.sort((left, right) => left.first - right.first || right.last - left.last);
    for (let k = 0; k < spans.length; k += 1) while (spans[k + 1]?.first <= spans[k].last) spans.splice(k + 1, 1);
    for (const [k, other] of spans.entries()) if (k) {
      const one = spans[k - 1];
      const amid = all.slice(one.last + 1, other.first).filter((word) => !AMID.has(word) && !isWeak(stem(word)));
      if (one.number === other.number || amid.length !== 1) continue;
      const there = `§${one.number}>${other.number}`, back = `§${other.number}>${one.number}`;
      const [term, its] = /^(?:to|into|2|as|->|=>|→)$/.test(amid[0]) ? [there, back]
        : amid[0] === "from" ? [back, there] : [];
      if (term) signs.push({ term, back: its, start: one.start, end: other.end });
    }
    return { all, list, signs, names };
  }

  // Each title, each phrase and each text is a document.
  const documents = [], having = new SearchableMap(), spread = new Map(), forms = new SearchableMap();
  const add = (entry, text, { within, ...more }) => {
    const read = within === "text" ? { list: words(text), signs: [] } : understood(text);
    const one = { entry, within, ...more, ...read };
    for (const word of one.all ?? []) forms.set(word, (forms.get(word) ?? 0) + 1);
    for (const term of new Set([...one.list, ...one.signs.map((sign) => sign.term)])) {
      if (!having.has(term)) having.set(term, []), spread.set(term, new Set());
      having.get(term).push(one);
      spread.get(term).add(entry);
    }
    documents.push(one);
  };
  for (const [id, { kind, number, title, about, asked = [] }] of entries.entries()) {
    add(id, title, {});
    if (number) add(id, /^[A-Z]/.test(number) ? number : `${kind === "page" ? "chapter" : kind} ${number}`, { alone: true });
    for (const phrase of asked) add(id, phrase, {});
    if (about) add(id, about, { within: "about" });
    if (more.words?.[id]) add(id, more.words[id], { within: "text" });
  }
  const ofNames = entries.filter(({ kind }) => kind === "term" || kind === "function").map(({ title }) => title);
  const ofSubject = new Set([...Object.values(synonyms).flat(2), ...ofNames].flatMap(words));
  const size = (term) => spread.get(term)?.size ?? 0; // the number of entries that contain it
  const rarity = (term) => Math.log(1 + entries.length / (1 + size(term)));
  const worths = ({ list, signs }) => list.map((word, k) => {
    const same = signs.filter((sign) => !isWay(sign) && sign.start === k && sign.end === k + 1);
    return Math.min(rarity(word), ...same.map((sign) => rarity(sign.term)))
      * (isWeak(word) ? OF_WEAK : ofSubject.has(word) || /\d/.test(word) ? 1 : OF_OTHERS);
  });
  const sorted = (word) => [...word].sort().join("");
  const sum = (list) => list.reduce((all, worth) => all + worth, 0);
  for (const document of documents) if (!document.within) document.worths = worths(document), document.worth = sum(document.worths);
  const formulas = (more.tex ?? []).map(([id, tex]) => ({ id, signs: pairs(signs(tex)) }));

  // Rewrite a question in the words of the book: joined or split as in the book, and without typing errors.
  const isKnown = (word) => forms.has(word) || size(stem(word)) > 2;
  // Readers' phrases contain typing errors, too.
  const isSlip = (word) => word.length > 6 && size(stem(word)) < 3 && [...forms.fuzzyGet(word, 1).keys()].some((form) => size(stem(form)) > 20);
  const widest = (list) => list.reduce((best, word) => (size(stem(word)) > size(stem(best)) ? word : best));
  function mended(text) {
    const given = read(text.replace(/([a-z])(?=[A-Z][a-z])/g, "$1 ")).all, found = [];
    for (let k = 0; k < given.length; k += 1) {
      const [one, next] = [given[k], given[k + 1]];
      const put = () => {
        const two = [one, next];
        if (next && !two.some(isLeftOut) && !two.every(isKnown) && isKnown(one + next)) return k += 1, [one + next];
        if (!isSlip(one) && (isKnown(one) || one.length < 4 || isLeftOut(one) || forms.atPrefix(one).size)) return [one];
        const letters = /^([a-z]{3,})\d\w*$/.exec(one)?.[1]; // such as Vector3
        if (letters) return [letters];
        const cut = [...one].map((_, j) => [one.slice(0, j), one.slice(j)])
          .find((parts) => parts.every((part) => part.length > 2 && forms.has(part)));
        if (cut) return cut;
        const near = [...forms.fuzzyGet(one, 2)];
        const close = near.filter(([form, [, slips]]) => slips === 1 || sorted(form) === sorted(one));
        const like = (close.length ? close : one.length > 6 ? near : []).map(([form]) => form);
        return [like.length ? widest(like) : one];
      };
      found.push(...put());
    }
    return found.join(" ");
  }

  // The terms of the book that a word of a question matches, with their similarity: itself, or words that begin with
  // it.
  const meant = (word) => (having.has(word) ? [[word, 1]] : word.length < 3 ? []
    : [...having.atPrefix(word).keys()].map((term) => [term, 0.92 - 0.02 * (term.length - word.length)]));

  // The completions of a question whose last word is unfinished, with the most frequent words that start this way.
  function finished(text) {
    const begun = /[a-z]+$/i.exec(text)?.[0].toLowerCase();
    return (begun ? [...forms.atPrefix(begun)] : []).filter(([form]) => form !== begun)
      .sort(([, one], [, other]) => other - one).slice(0, ENDS)
      .map(([form]) => [text + form.slice(begun.length), forms.has(begun) ? ENDED : 1]);
  }

  function byWords(text) {
    const asked = understood(mended(text)), { list, signs } = asked;
    const weights = worths(asked), whole = sum(weights);
    const answered = (likes) => (sum(likes.map((like, k) => weights[k] * like)) / whole) ** POWER;
    const states = new Map();
    const state = (one) => {
      if (!states.has(one)) states.set(one, { likes: list.map(() => 0), own: one.list.map(() => 0), back: false });
      return states.get(one);
    };
    const raise = (likes, k, like) => { likes[k] = Math.max(likes[k], like); };
    for (const [k, word] of list.entries()) {
      for (const [term, like] of meant(word)) for (const one of having.get(term)) {
        const { likes, own } = state(one);
        if (one.within) raise(likes, k, like);
        else for (const [j, mine] of one.list.entries()) if (mine === term) {
          const now = like * (one.names[j] === asked.names[k] ? 1 : APART);
          raise(likes, k, now), raise(own, j, now);
        }
      }
    }
    for (const sign of signs) {
      const like = isWay(sign) ? 1 : SYNONYM;
      for (const document of having.get(sign.term) ?? []) {
        const { likes, own } = state(document);
        for (let k = sign.start; k < sign.end; k += 1) raise(likes, k, like);
        for (const its of document.signs) if (its.term === sign.term) {
          for (let j = its.start; j < its.end; j += 1) raise(own, j, like);
        }
      }
      if (sign.back) for (const one of having.get(sign.back) ?? []) {
        state(one).back = !one.signs.some(({ term }) => term === sign.term);
      }
    }
    const beside = new Map(); // what the text of an entry adds
    for (const [one, { likes }] of states) if (one.within) {
      if (!beside.has(one.entry)) beside.set(one.entry, list.map(() => 0));
      for (const [k, like] of likes.entries()) raise(beside.get(one.entry), k, like * WITHIN[one.within]);
    }
    const best = new Map(), all = new Map(), ways = new Set(signs.filter(isWay).map(({ term }) => term));
    const take = (id, score) => best.set(id, (best.get(id) ?? 0) + score ** TOGETHER);
    for (const [one, { likes, own, back }] of states) if (!one.within) {
      const used = sum(own.map((like, j) => one.worths[j] * like)) / one.worth;
      const text = one.alone ? undefined : beside.get(one.entry);
      const both = likes.map((like, k) => Math.max(like, text?.[k] ?? 0));
      const way = !ways.size || one.signs.some(({ term }) => ways.has(term)) ? 1 : NO_WAY;
      const same = one.list.join(" ") === list.join(" ") ? SAME : 1;
      take(one.entry, answered(both) * (1 - OWN + OWN * used) * same * (back ? OTHER_WAY : way));
      if (one.alone) continue;
      if (!all.has(one.entry)) all.set(one.entry, { likes: list.map(() => 0), used: 0, way: NO_WAY });
      const its = all.get(one.entry);
      for (const [k, like] of likes.entries()) raise(its.likes, k, Math.max(like, text?.[k] ?? 0));
      its.used = Math.max(its.used, used * sum(both.map((like, k) => weights[k] * like)) / whole);
      its.way = Math.max(its.way, way);
    }
    // If no single phrase of a place answers the question, all of them together may, or else its text.
    for (const [id, { likes, used, way }] of all) take(id, answered(likes) * (1 - OWN + OWN * used) * way);
    for (const [id, likes] of beside) take(id, answered(likes) * (1 - OWN));
    return [...best].map(([id, powers]) => {
      const { kind, page, asked: phrases } = entries[id], weight = pages[page][3];
      return [id, powers ** (1 / TOGETHER) * KINDS[kind] * (list.length > 2 ? IN_LONG[kind] ?? 1 : 1)
        * (phrases ? Math.max(weight, ASKED) : weight)];
    });
  }

  // The entries that answer the question, the best first.
  let before = new Map(); // the results for the letters so far: the next letter needs most of them again
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
    const tried = new Map();
    const byItsWords = (text) => {
      tried.set(text, before.get(text) ?? byWords(text));
      return tried.get(text);
    };
    take(byItsWords(query), formula ? 0.6 : 1);
    if (!formula) for (const [longer, share] of finished(query)) take(byItsWords(longer), share);
    before = tried;
    if (formula) {
      const asked = pairs(signs(query));
      take(formulas.map(({ id, signs: there }) => (
        [id, (overlap(asked, there) / asked.length) ** 2 * (asked.length / there.length) ** 0.2])));
    }
    const begun = headed(query.trim());
    if (begun) take(entries.flatMap(({ kind, page, title, number }, id) => {
      const place = kind === "page" ? ` ${headed(title)}`.indexOf(` ${begun}`) : -1;
      return place < 0 ? [] : [[id, (scores.get(id) ?? 0) + BEGUN * (place ? 0.5 : 1) * (number ? 2 : pages[page][3])]];
    }));
    return [...scores].filter(([, score]) => score > 0.06).sort((left, right) => right[1] - left[1]).slice(0, most)
      .map(([id, score]) => ({ ...entries[id], score }));
  };
}
