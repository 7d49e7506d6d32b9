// Find out which parts of a style sheet a site needs, and when. Call it in three ways:
// node purge.mjs NODE_MODULES NAMES --of SITE stores the names in the pages of the site in the file NAMES, page by page, as
// pages seldom change. The other two use this file.
// node purge.mjs NODE_MODULES NAMES SHEET FILE... removes from the sheet what no page uses. The files are scripts, whose
// words may become classes, and other sheets, which may use variables of this one.
// node purge.mjs NODE_MODULES NAMES SHEET --later LATER moves to another sheet what no page uses before its scripts run.
import { createRequire } from "node:module";
import { createHash } from "node:crypto";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const [modules, notes, sheet, ...files] = process.argv.slice(2);
const require = createRequire(join(modules, "package.json"));

// All words inside quotation marks. esbuild gives each statement a line, as two strings on one would enclose code.
function quoted(script) {
  const { code } = require("esbuild").transformSync(script, { legalComments: "none" });
  const strings = code.match(/"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'|`[^`]*`/g) ?? [];
  return strings.join(" ").match(/[A-Za-z][\w-]*/g) ?? [];
}
// The elements, ids, classes and attributes of a page, but not the words of its text. The words of its inline scripts
// are included, as these run before the page is seen, and so are the words of comments that are placeholders.
const KINDS = ["tags", "classes", "ids", "attributes", "values", "undetermined"];
function namesIn(page) {
  const found = Object.fromEntries(KINDS.map((kind) => [kind, new Set()]));
  for (const [, script] of page.matchAll(/<script>(.*?)<\/script>/gs)) for (const word of quoted(script)) found.undetermined.add(word);
  for (const [, name] of page.matchAll(/<!-- ([\w-]+) -->/g)) found.classes.add(name);
  for (const [, tag, attributes] of page.matchAll(/<([a-z][a-z0-9-]*)((?:\s+[^\s=>]+(?:\s*=\s*(?:"[^"]*"|'[^']*'|[^\s>]+))?)*)\s*\/?>/gi)) {
    found.tags.add(tag.toLowerCase());
    for (const [, name, , double, single, bare] of attributes.matchAll(/([^\s=>]+)(\s*=\s*(?:"([^"]*)"|'([^']*)'|([^\s>]+)))?/g)) {
      found.attributes.add(name);
      for (const word of (double ?? single ?? bare ?? "").split(/\s+/)) {
        found.values.add(word.slice(0, 60)), ({ class: found.classes, id: found.ids })[name]?.add(word); // data can be long
      }
    }
  }
  return sorted(found);
}
function sorted(found) {
  return Object.fromEntries(KINDS.map((kind) => [kind, [...found[kind]].sort()]));
}
// The names of all pages, by kind. The styles of notebooks and the changes that finish.py makes do not count.
function namesOf(site) {
  const memory = `${notes}.pages`, known = existsSync(memory) ? JSON.parse(readFileSync(memory, "utf8")) : {}, used = {};
  const program = readFileSync(fileURLToPath(import.meta.url), "utf8");
  const all = Object.fromEntries(KINDS.map((kind) => [kind, new Set()]));
  for (const name of readdirSync(site, { recursive: true })) {
    if (!name.endsWith(".html") || name.startsWith("lite/")) continue;
    const page = readFileSync(join(site, name), "utf8").replace(/\?v=\w+|<meta http-equiv="Content-Security-Policy"[^>]*>/g, "");
    const key = createHash("sha256").update(program).update(page).digest("hex");
    used[key] = known[key] ?? namesIn(page);
    for (const kind of KINDS) for (const name of used[key][kind]) all[kind].add(name);
  }
  writeFileSync(memory, JSON.stringify(used));
  return sorted(all);
}
// From the theme's scripts, take only the classes that they give to existing elements: most of what they create belongs
// to parts of a page that the pages of the book do not have.
function wordsIn(name) {
  const script = readFileSync(name, "utf8");
  return name.includes("/scripts/") ? [...script.matchAll(/classList\.(?:add|toggle)\("([\w-]+)/g)].map(([, name]) => name) : quoted(script);
}
async function purged(css, scripts, options) {
  const { PurgeCSS } = require("purgecss");
  const { attributes: names, values, ...found } = JSON.parse(readFileSync(notes, "utf8"));
  const words = { ...found, attributes: { names, values }, undetermined: [...found.undetermined, ...scripts.flatMap(wordsIn)] };
  const [kept] = await new PurgeCSS().purge({
    content: [{ raw: "", extension: "words" }],
    css: [{ raw: css }],
    extractors: [{ extractor: () => words, extensions: ["words"] }],
    ...options,
  });
  return kept.css;
}

const css = sheet === "--of" ? "" : readFileSync(sheet, "utf8");
if (sheet === "--of") writeFileSync(notes, JSON.stringify(namesOf(files[0])));
else if (files[0] === "--later") {
  // Number the rules. The rules that remain for the pages alone are needed at once. The reader's actions that need no
  // script, such as pointing at something, are replaced by [open], which always exists, but no words in brackets, such
  // as "data:". Rules with an address are kept too, because the address would mean something else in another file.
  const root = require("postcss").parse(css);
  let count = 0;
  root.walkRules((rule) => rule.append({ prop: "--rule", value: String(count++) }));
  const stateless = root.clone();
  stateless.walkRules((rule) => (rule.selector = rule.selector.replace(/(\[[^\]]*\])|::?[a-z-]+(?![a-z(-])/g, (_, brackets) => brackets ?? "[open]")));
  const atOnce = new Set((await purged(stateless.toString(), [])).match(/(?<=--rule: ?)\d+/g));
  root.walkRules((rule) => {
    if (/url\((?!["']?data:)/.test(rule)) atOnce.add(rule.last.value);
  });
  const part = (wanted) => {
    const found = root.clone();
    found.walkRules((rule) => (wanted(rule) ? rule.last : rule).remove());
    return found;
  };
  const later = part((rule) => !atOnce.has(rule.last.value));
  later.walkAtRules("font-face", (face) => face.remove());
  writeFileSync(sheet, part((rule) => atOnce.has(rule.last.value)).toString());
  writeFileSync(files[1], later.toString());
} else {
  // Then remove the variables that neither this sheet nor the sheets of the book use.
  const others = files.map((name) => readFileSync(name, "utf8")).join("");
  let kept = await purged(css, files.filter((name) => name.endsWith(".js")), { keyframes: true, fontFace: true }), before;
  do {
    before = kept.length;
    const asked = new Set((kept + others).match(/(?<=var\(\s*)--[\w-]+/g));
    kept = kept.replace(/(?<=[{;\s])(--[\w-]+)\s*:(?:[^;{}"']|"[^"]*"|'[^']*')*(;|(?=\}))/g, (rule, name) => (asked.has(name) ? rule : ""));
  } while (kept.length < before);
  writeFileSync(sheet, kept);
}
