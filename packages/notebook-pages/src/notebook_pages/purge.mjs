// What of a style sheet a site needs, and when: node purge.mjs NODE_MODULES NAMES --of SITE finds the names that its pages
// hold, and keeps them in NAMES page by page, for pages change seldom: the others use what it has found.
// node purge.mjs NODE_MODULES NAMES SHEET FILE... takes out of the sheet what no page uses. The files are scripts, whose words
// may become classes, and other sheets, which may ask for values of this one.
// node purge.mjs NODE_MODULES NAMES SHEET --later LATER moves into another sheet what no page uses as it comes, before its
// scripts have run.
import { createRequire } from "node:module";
import { createHash } from "node:crypto";
import { existsSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const [modules, notes, sheet, ...files] = process.argv.slice(2);
const require = createRequire(join(modules, "package.json"));

// Every word of a script that stands in quotes.
function quoted(script) {
  const strings = script.replace(/^\s*\/\/.*$/gm, "").match(/"[^"\n]*"|'[^'\n]*'|`[^`]*`/g) ?? [];
  return strings.join(" ").match(/[A-Za-z][\w-]*/g) ?? [];
}
// Of a page, its elements, ids, classes and attributes: a word of the text is none. To them come the words of the scripts
// that stand in it, for these run before it is seen, and those of a comment that keeps a place for what comes last.
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
        if (word.length < 60) found.values.add(word), ({ class: found.classes, id: found.ids })[name]?.add(word);
      }
    }
  }
  return sorted(found);
}
function sorted(found) {
  return Object.fromEntries(KINDS.map((kind) => [kind, [...found[kind]].sort()]));
}
// The names of all pages, by kind. Notebooks bring their own styles; and what finish.py writes into pages is no name.
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
// Of the theme's scripts, the classes that they give to what is there: most of what else they make belongs to parts of a
// page that no page here has.
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
if (sheet === "--of") {
  writeFileSync(notes, JSON.stringify(namesOf(files[0])));
} else if (files[0] === "--later") {
  // Each rule gets a number, and those whose numbers are left over from the pages alone are needed at once. What a reader
  // does without a script, such as to point at something, counts as [open], which is always there. So do rules with an
  // address, which would mean another one elsewhere.
  const root = require("postcss").parse(css);
  let count = 0;
  root.walkRules((rule) => rule.append({ prop: "--rule", value: String(count++) }));
  const stateless = root.clone();
  stateless.walkRules((rule) => (rule.selector = rule.selector.replace(/::?[a-z-]+(?![a-z(-])/g, "[open]")));
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
  // Then values that nothing asks for: neither this sheet, nor those of the book.
  const others = files.map((name) => readFileSync(name, "utf8")).join("");
  let kept = await purged(css, files.filter((name) => name.endsWith(".js")), { keyframes: true, fontFace: true }), before;
  do {
    before = kept.length;
    const asked = new Set((kept + others).match(/(?<=var\(\s*)--[\w-]+/g));
    kept = kept.replace(/(?<=[{;\s])(--[\w-]+)\s*:(?:[^;{}"']|"[^"]*"|'[^']*')*(;|(?=\}))/g, (rule, name) => (asked.has(name) ? rule : ""));
  } while (kept.length < before);
  writeFileSync(sheet, kept);
}
