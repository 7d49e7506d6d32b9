// The words of a text as the search compares them: without accents, capitals, endings and what says nothing.

// Without these a question is the same; "to" and "from" are read before they go, for they tell which way to convert.
const LEFT_OUT = new Set(("a an and are as at be been being both but by can could did do does doing for from gives give get gets getting had has have"
  + " how i if in into is it its let like lets make makes me my need of off on one or our please s shall should so some such t than that"
  + " the their them then there these they this those to too try trying up us use used uses using via vs versus want was we what whats when where which"
  + " while who why will with would you your am any about again between just does don not no isn only").split(" "));
// These say what is wanted, and little about where it stands.
const WEAK = new Set();
const WEAK_WORDS = "actual actually algorithm approach best better book calculate calculation chapter code compare compute computing convert conversion converting correct correctly define"
  + " definition derive describe description difference different example explain explained explanation express find finding formula formulas function good got"
  + " help implement implementation intuition intuitive know library meaning method obtain perform possible problem program programming proof prove python question"
  + " represent representation result right section show simple simply solve theorem tutorial understand value way well without work wrong write equation given not doesn many several new operator"
  + " many two three several new first second"
  // What titles of questions in forums have besides.
  + " add allow always behave bug case cause change clarify consider create detect determine doc documentation enhancement ensure error exist expect extract fail feature generate give handle happen improve inconsistent incorrect incorrectly interpret invalid issue make may might multiple note obtain offer only output please produce proper properly provide question reach read report request return say seem suggest suggestion support suspicion take tell thing understand unexpected version weird";
const IRREGULAR = { matrices: "matrix", axes: "axis", vertices: "vertex", indices: "index", gimble: "gimbal", gimbals: "gimbal", euler: "euler", eulers: "euler", inertia: "inertia", bias: "bias", unity: "unity", derivative: "derivative", derivatives: "derivative", biases: "bias", radians: "radian", rad: "radian", deg: "degre", ninety: "90" };
const ENDINGS = /(?:ati(?:ons?|ves?|ng|onal)|at(?:es?|ed|ors?)|i(?:ng|ngs|es|ed)|ed|es|ly|s|e|y)$/;
const GREEK = { α: "alpha", β: "beta", γ: "gamma", δ: "delta", θ: "theta", λ: "lambda", π: "pi", σ: "sigma", φ: "phi", ϕ: "phi", ψ: "psi", ω: "omega", Ω: "omega" };
// What words are told apart by: names of the software whole, numbers of sections whole, arrows.
const TOKEN = /[a-z]+\d*(?:_[a-z0-9]+)+|\d+\.\d+|[a-z0-9]+|->|=>|→/g;

export const plain = (text) => text.replace(/°/g, " degrees ").replace(/[α-ωϕΩ]/g, (sign) => ` ${GREEK[sign] ?? ""} `).normalize("NFD").replace(/[\u0300-\u036f]/g, "").toLowerCase();

// The stem of a word, about: endings of English, as long as three letters stay.
export function stem(word) {
  if (IRREGULAR[word]) return IRREGULAR[word];
  if (/\d/.test(word)) return word;
  const end = ENDINGS.exec(word);
  const cut = end?.index >= 3 && !word.endsWith("ss") ? word.slice(0, end.index) : word;
  return cut.replace(/([^aeiou])\1$/, "$1").replace(/iz$/, "is").replace(/i$/, "");
}
for (const word of WEAK_WORDS.split(" ")) WEAK.add(stem(word));
export const isWeak = (word) => word.length < 2 || WEAK.has(word);

// All words in their order; of a name such as dcm_from_quaternion or dcmFromQuaternion those that it is made of.
function told(text) {
  const apart = text.replace(/\b(what|does|do)\b(.*)\bmean\b/i, "$1$2").replace(/\bmeans?\s*\??$/i, "").replace(/([a-z]{2})([A-Z][a-z]{2,})/g, "$1 $2").replace(/\b([a-z]{3,})2([a-z]{3,})\b/gi, "$1 to $2")
    .replace(/\b([xyz])-([xyz])-([xyz])\b/gi, "$1$2$3").replace(/\b([123])-([123])-([123])\b/g, "$1$2$3");
  return (plain(apart).replace(/[’'](?:s|t|re|m)\b/g, "").match(TOKEN) ?? []).flatMap((word) => (word.includes("_") ? word.split("_") : [word]));
}

// The words that count, stemmed.
export const words = (text) => told(text).filter((word) => !LEFT_OUT.has(word) && !/^[-=→]/.test(word)).map(stem);

// The words that count, and the conversion that is asked for: pairs of numbers of ``kinds``, the lists of what can be converted.
export function read(text, kinds = []) {
  const all = told(text);
  const found = all.map((word) => (LEFT_OUT.has(word) || /^[-=→]/.test(word) ? null : stem(word)));
  const places = found.flatMap((word, k) => (word === null ? [] : [k]));
  const list = places.map((k) => found[k]);
  const spans = [];
  for (let k = 0; k < list.length; k += 1) {
    let best = null;
    for (const [kind, phrases] of kinds.entries()) for (const phrase of phrases) {
      if (phrase.length > (best?.length ?? 0) && phrase.every((word, j) => list[k + j] === word)) best = { kind, start: k, length: phrase.length };
    }
    if (best) spans.push(best), k += best.length - 1;
  }
  const conversions = [];
  for (let k = 0; k + 1 < spans.length; k += 1) {
    const [one, other] = [spans[k], spans[k + 1]];
    const amid = all.slice(places[one.start + one.length - 1] + 1, places[other.start]).filter((word) => !["a", "an", "the", "into", "given", "my", "and"].includes(word) || word === "into");
    if (one.kind === other.kind || amid.length !== 1) continue;
    const way = /^(?:to|into|2|as|->|=>|→)$/.test(amid[0]) ? [one.kind, other.kind] : amid[0] === "from" ? [other.kind, one.kind] : null;
    if (way) conversions.push({ way, start: one.start, end: other.start + other.length });
  }
  return { list, conversions };
}
