// The words of a text as the search compares them: without accents, capitals, endings and words that say nothing.

// Words that do not change a question; "to" and "from" are read first, as they tell the direction of a conversion.
const LEFT_OUT = new Set(("a about again am an and any are as at be been being between both but by can correctly could did do does"
  + " doing don for from get gets getting give gives had has have how i if in into is isn it its just let lets"
  + " like make makes me my need no not of off on one only or our please properly s shall should so some such t"
  + " than that the their them then there these they this those to too try trying up us use used uses using versus"
  + " via vs want was we what whats when where which while who why will with would you your").split(" "));
export const isLeftOut = (word) => LEFT_OUT.has(word);
// Words of questions and complaints that say what is wanted, but little about where to find it.
const WEAK_WORDS = "3d able access accurate action actual actually add additional against algorithm allow always appear"
  + " application apply approach around ask assume available away back bad basic basics behave behavior behaviour"
  + " best better book broken bug build calculate calculation call case cause certain change chapter clarify clear"
  + " clearly code com come common compare completely compute computing concept confused confusing confusion"
  + " consider consistent construct constructing conversion convert converting correct create custom data deal"
  + " default define definition derive describe description desired detect determine difference different directly"
  + " discussion display doc documentation doesn easiest easily easy effect efficient element enhancement enough"
  + " ensure equation error especially etc exactly example exist expect explain explained explanation express"
  + " extract face fail far fast feature find finding fine first follow format formula formulas forum function"
  + " general generate given good got hand handle happen hello help hi hope idea implement implementation"
  + " implementing important improve include including inconsistent incorrect incorrectly input instead"
  + " instruction interested interpret intuition intuitive invalid involve issue job keep kind know known language"
  + " large latest library line link list logic lot main major many math matter may meaning method might minimal"
  + " missing model modify module move multiple necessary new next nice note nothing object obtain obviously offer"
  + " ok old operator option original other others output overview own part particular people perfect perfectly"
  + " perform plain poorly possible precise previous private problem process produce program programming proof"
  + " proper prove provide purpose python question quick reach read really reason recommend recommended refer"
  + " reference regarding relate related relationship rely report represent representation request require result"
  + " return right same save say script second section seem sense set setup several show similar simple simplest"
  + " simply simulate simulation simultaneous situation small software solution solve somehow someone something"
  + " sometimes somewhere specific specify standard still stop strange structure stuff stupid suggest suggestion"
  + " support sure suspicion take task tell terms test thank thanks theorem thing though thought three time tip"
  + " tool topic tried trouble tutorial two type unable unclear understand unexpected unexplainable unknown"
  + " unusual update useful user usual usually value various version visual way weird well whether whole without"
  + " wonder word work working worse write wrong yet"
  // Programs and languages: the convention card names them, but most questions with them ask for something else.
  + " arduino babylon blender cpp directx eigen glm glsl godot java javascript js matlab numpy opencv opengl pyopengl pytorch qt"
  + " ros space unity unreal webgl";
const IRREGULAR = new Map(Object.entries({ matrices: "matrix", axes: "axis", vertices: "vertex", indices: "index", gimble: "gimbal", gimbals: "gimbal", euler: "euler", eulers: "euler", oiler: "euler", inertia: "inertia", bias: "bias", unity: "unity", derivative: "derivative", derivatives: "derivative", biases: "bias", radians: "radian", rad: "radian", deg: "degre", ninety: "90", meaning: "meaning", handed: "handed" }));
const ENDINGS = /(?:ati(?:ons?|ves?|ng|onal)|at(?:es?|ed|ors?)|i(?:ng|ngs|es|ed)|ed|es|ly|s|e|y)$/;
const GREEK = { α: "alpha", β: "beta", γ: "gamma", δ: "delta", θ: "theta", λ: "lambda", π: "pi", σ: "sigma", φ: "phi", ϕ: "phi", ψ: "psi", ω: "omega", Ω: "omega" };
// The tokens that are compared: whole names of software, whole numbers of sections, and arrows.
const TOKEN = /[a-z]+\d*(?:_[a-z0-9]+)+|\d+\.\d+|[a-z0-9]+|->|=>|→/g;

export const plain = (text) => text.replace(/°/g, " degrees ").replace(/[α-ωϕΩ]/g, (sign) => ` ${GREEK[sign] ?? ""} `).normalize("NFD").replace(/[\u0300-\u036f]/g, "").toLowerCase();

// The approximate stem of a word: removes English endings as long as three letters remain.
export function stem(word) {
  if (IRREGULAR.has(word)) return IRREGULAR.get(word);
  if (/\d/.test(word)) return word;
  const end = ENDINGS.exec(word);
  const cut = end?.index >= 3 && !word.endsWith("ss") ? word.slice(0, end.index) : word;
  return cut.replace(/([^aeiou])\1$/, "$1").replace(/iz$/, "is").replace(/i$/, "");
}
const WEAK = new Set(WEAK_WORDS.split(" ").map(stem));
export const isWeak = (word) => word.length < 2 || WEAK.has(word);

// All words in their order; names such as dcm_from_quaternion or dcmFromQuaternion are split into their words.
function told(text) {
  const apart = text.replace(/\b(what|does|do)\b(.*)\bmean\b/i, "$1$2").replace(/\bmeans?\s*\??$/i, "").replace(/([a-z]{2})([A-Z][a-z]{2,})/g, "$1 $2").replace(/\b([a-z]{3,})2([a-z]{3,})\b/gi, "$1 to $2")
    .replace(/\b([xyz])-([xyz])-([xyz])\b/gi, "$1$2$3").replace(/\b([123])-([123])-([123])\b/g, "$1$2$3");
  return (plain(apart).replace(/(?:n[’']t|[’'](?:s|re|m|ve|d|ll))\b/g, "").match(TOKEN) ?? []).flatMap((word) => (word.includes("_") ? word.split("_") : [word]));
}

// All words, and the stems of those that count with their places among all words.
export function read(text) {
  const all = told(text), list = [], at = [];
  for (const [k, word] of all.entries()) if (!isLeftOut(word) && !/^[-=→]/.test(word)) list.push(stem(word)), at.push(k);
  return { all, list, at };
}
export const words = (text) => read(text).list;
