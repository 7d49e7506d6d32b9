// Takes out of a style sheet what no page of the site uses: node purge.mjs NODE_MODULES SITE SHEET FILE...
// The files are scripts, whose words may become classes, and other sheets, which may ask for values of this one.
import { createRequire } from "node:module";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [modules, site, sheet, ...files] = process.argv.slice(2);
const { PurgeCSS } = createRequire(join(modules, "package.json"))("purgecss");

// Of a page, the names of its elements, classes and attributes: a word of the text is none.
function namesIn(page) {
  const names = new Set();
  for (const [, tag, attributes] of page.matchAll(/<([a-z][a-z0-9-]*)((?:\s+[^\s=>]+(?:\s*=\s*(?:"[^"]*"|'[^']*'|[^\s>]+))?)*)\s*\/?>/gi)) {
    names.add(tag.toLowerCase());
    for (const [, name, , double, single, bare] of attributes.matchAll(/([^\s=>]+)(\s*=\s*(?:"([^"]*)"|'([^']*)'|([^\s>]+)))?/g)) {
      names.add(name);
      for (const word of (double ?? single ?? bare ?? "").split(/\s+/)) if (word.length < 60) names.add(word);
    }
  }
  return [...names];
}
// Of a script of ours, every word that stands in quotes. Of the theme's, the classes that it gives to what is there: most
// of what else it makes belongs to parts of a page that no page here has.
function wordsIn(name) {
  const script = readFileSync(name, "utf8");
  if (name.includes("/scripts/")) return [...script.matchAll(/classList\.(?:add|toggle)\("([\w-]+)/g)].map(([, name]) => name);
  const quoted = script.replace(/^\s*\/\/.*$/gm, "").match(/"[^"\n]*"|'[^'\n]*'|`[^`]*`/g) ?? [];
  return quoted.join(" ").match(/[A-Za-z][\w-]*/g) ?? [];
}

const [{ css }] = await new PurgeCSS().purge({
  content: [join(site, "**/*.html"), { raw: files.filter((name) => name.endsWith(".js")).flatMap(wordsIn).join(" "), extension: "words" }],
  css: [sheet],
  extractors: [{ extractor: namesIn, extensions: ["html"] }, { extractor: (words) => words.split(" "), extensions: ["words"] }],
  skippedContentGlobs: [join(site, "lite/**")], // notebooks bring their own
  keyframes: true,
  fontFace: true,
});
// Values that nothing asks for: neither this sheet, nor those of the book.
const others = files.map((name) => readFileSync(name, "utf8")).join("");
let kept = css, before;
do {
  before = kept.length;
  const asked = new Set((kept + others).match(/(?<=var\(\s*)--[\w-]+/g));
  kept = kept.replace(/(?<=[{;\s])(--[\w-]+)\s*:(?:[^;{}"']|"[^"]*"|'[^']*')*(;|(?=\}))/g, (rule, name) => (asked.has(name) ? rule : ""));
} while (kept.length < before);
writeFileSync(sheet, kept);
