// Finds places of the book by what a reader types: words, with slips and synonyms, or signs of a formula.
import MiniSearch from "minisearch";

const LEFT_OUT = new Set(("a an and are as at be between by can do does for from get have how i in into is it its my of on or"
  + " should that the their them this to use using vs versus was what when which why with you your").split(" "));
const IRREGULAR = { matrices: "matrix", axes: "axis", vertices: "vertex", gimble: "gimbal", euler: "euler" };
const ENDINGS = /(?:ations?|ating|at(?:es?|ed)|i[sz](?:ing|ed|es?)|ings?|ies|ed|es|s|ly|e)$/;
const GREEK = { α: "alpha", β: "beta", γ: "gamma", δ: "delta", θ: "theta", λ: "lambda", π: "pi", σ: "sigma", φ: "phi", ϕ: "phi", ψ: "psi", ω: "omega", Ω: "omega" };

export const plain = (text) => text.replace(/[α-ωϕΩ]/g, (sign) => ` ${GREEK[sign] ?? ""} `).normalize("NFD").replace(/[\u0300-\u036f]/g, "").toLowerCase();

// The stem of a word, about: endings of English, as long as four letters stay.
export function stem(word) {
  if (IRREGULAR[word]) return IRREGULAR[word];
  const end = ENDINGS.exec(word);
  return end?.index >= 4 ? word.slice(0, end.index) : word.replace(/(?<=[a-z]{3}[^s])s$/, "");
}

// The words of a text; a name of the software is one word, and each of its parts is one, too.
export function words(text) {
  const found = plain(text).replace(/[’']s\b/g, "").match(/[a-z0-9]+(?:[_.][a-z0-9]+)*/g) ?? [];
  return found.flatMap((word) => word.split(".")).flatMap((word) => (word.includes("_") ? [word, ...word.split("_")] : [word]))
    .filter((word) => !LEFT_OUT.has(word)).map((word) => (word.includes("_") ? word : stem(word)));
}

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

// What a reader looks for is rather one than another of these, where both answer as well.
const KINDS = { page: 1.6, section: 1.25, term: 1.15, function: 0.75, exercise: 0.7, example: 0.8, figure: 0.55, equation: 0.45 };

const READ = { page: true, section: true }; // those of the chapters have numbers

// ``texts`` are the words of each entry's text, once they are there.
export function finder({ pages, fields, entries: rows, synonyms = [] }, texts = []) {
  const entries = rows.map((row) => Object.fromEntries(fields.map((field, k) => [field, row[k] || undefined])));
  for (const entry of entries) entry.page ??= 0;
  const cut = texts.map(words);
  const concepts = synonyms.map((group) => group.map((phrase) => words(phrase)));
  // Where in a list of words a phrase stands; the last word may still be on its way, from the third letter on.
  const begun = (word, whole) => word === whole || (word?.length > 2 && whole.startsWith(word));
  const within = (list, phrase, typed) => list.findIndex((_, k) => phrase.every((word, j) =>
    (typed && k + j === list.length - 1 ? begun(list[k + j], word) : list[k + j] === word)));
  // Each word, or run of words, that names a concept, replaced by the concept.
  const named = (list, typed) => concepts.flatMap((group, number) => group.filter((phrase) => phrase.length && within(list, phrase, typed) >= 0)
    .sort((one, other) => other.length - one.length)
    .slice(0, 1).map((phrase) => [number, phrase]));
  const index = new MiniSearch({
    idField: "id", fields: ["title", "concepts", "chapter", "about", "words"], tokenize: (text) => text.split(" ").filter(Boolean), processTerm: (term) => term,
  });
  index.addAll(entries.map((entry, id) => {
    const title = words(entry.title);
    return {
      id, title: title.join(" "), chapter: entry.anchor ? words(pages[entry.page][1]).join(" ") : "", about: words(entry.about ?? "").join(" "), words: (cut[id] ?? []).join(" "),
      concepts: named(title).map(([number]) => `§${number}`).join(" "),
    };
  }));
  const spread = new Map(); // in how many entries each word stands
  for (const [id, entry] of entries.entries()) {
    for (const word of new Set([...words(`${entry.title} ${entry.about ?? ""}`), ...cut[id] ?? []])) spread.set(word, (spread.get(word) ?? 0) + 1);
  }
  const worth = (term) => Math.log(1 + entries.length / (1 + (spread.get(term) ?? 0)));
  const formulas = entries.map(({ tex }, id) => tex && { id, signs: pairs(signs(tex)) }).filter(Boolean);
  const OPTIONS = {
    boost: { title: 6, concepts: 6, chapter: 1.2, about: 1.4, words: 0.4 }, weights: { fuzzy: 0.3, prefix: 0.5 },
    prefix: (term) => term.length > 2 && term[0] !== "§", fuzzy: (term) => (term[0] !== "§" && term.length > 3 ? (term.length > 7 ? 0.25 : 0.2) : false),
  };

  function byWords(list, whole, worthOf = worth) {
    if (!list.length) return [];
    return index.search(list.join(" "), OPTIONS).map(({ id, score, queryTerms }) => {
      const entry = entries[id], title = words(entry.title);
      const there = title.join(" ");
      const same = there === whole ? 2.5 : entry.kind === "page" && there.startsWith(`${whole} `) ? 2.2 : 1;
      const sum = (of) => [...new Set(of)].reduce((all, term) => all + worthOf(term), 0);
      const part = sum(queryTerms) / sum(list); // rare words tell more than common ones
      return [id, score / list.length * part ** 2 * same * (KINDS[entry.kind] ?? 1) * (entry.weight ?? 1) * (entry.number || !READ[entry.kind] ? 1 : 0.8)];
    });
  }

  // The entries that answer, the best first.
  return (query, most = 12) => {
    const scores = new Map(), take = (found, share = 1) => {
      for (const [id, score] of found) scores.set(id, Math.max(scores.get(id) ?? 0, score * share));
    };
    const formula = isFormula(query);
    const list = words(query).filter((word) => !formula || word.length > 1);
    take(byWords(list, list.join(" ")), formula ? 0.4 : 1);
    for (const [number, phrase] of named(list, true)) {
      const place = within(list, phrase, true);
      const all = phrase.reduce((sum, word) => sum + worth(word), 0);
      const asked = [...list.slice(0, place), `§${number}`, ...list.slice(place + phrase.length)];
      take(byWords(asked, "", (term) => (term[0] === "§" ? all : worth(term))), 0.8 + 0.15 * phrase.length);
    }
    if (formula) {
      const asked = pairs(signs(query));
      take(formulas.map(({ id, signs: there }) => [id, 24 * (overlap(asked, there) / asked.length) ** 2 * (asked.length / there.length) ** 0.2]));
    }
    return [...scores].filter(([, score]) => score > 0.05).sort((one, other) => other[1] - one[1]).slice(0, most)
      .map(([id, score]) => ({ ...entries[id], score }));
  };
}
