// Takes out of a style sheet what no page of the site uses: node purge.mjs NODE_MODULES SITE SHEET
import { createRequire } from "node:module";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [modules, site, sheet] = process.argv.slice(2);
const { PurgeCSS } = createRequire(join(modules, "package.json"))("purgecss");

// Of a page, the names of its elements, classes and attributes: a word of the text is none.
function namesIn(page) {
  const names = new Set();
  for (const [, tag, attributes] of page.matchAll(/<([a-z][a-z0-9-]*)((?:\s+[^\s=>]+(?:\s*=\s*(?:"[^"]*"|'[^']*'|[^\s>]+))?)*)\s*\/?>/gi)) {
    names.add(tag.toLowerCase());
    for (const [, name, , double, single] of attributes.matchAll(/([^\s=>]+)(\s*=\s*(?:"([^"]*)"|'([^']*)'|[^\s>]+))?/g)) {
      names.add(name);
      for (const word of (double ?? single ?? "").split(/\s+/)) if (word.length < 60) names.add(word);
    }
  }
  return [...names];
}
// Of a script, every word: it may become a class.
const wordsIn = (script) => script.match(/[A-Za-z][\w-]*/g) ?? [];

const [{ css }] = await new PurgeCSS().purge({
  content: [join(site, "**/*.html"), join(site, "_static/**/*.js")],
  css: [sheet],
  extractors: [{ extractor: namesIn, extensions: ["html"] }, { extractor: wordsIn, extensions: ["js"] }],
  skippedContentGlobs: [join(site, "lite/**")], // notebooks bring their own
  keyframes: true,
});
// Values that nothing asks for: neither this sheet, nor those of the book.
const others = process.argv.slice(5).map((name) => readFileSync(name, "utf8")).join("");
let kept = css, before;
do {
  before = kept.length;
  const asked = new Set((kept + others).match(/(?<=var\(\s*)--[\w-]+/g));
  kept = kept.replace(/(?<=[{;\s])(--[\w-]+)\s*:(?:[^;{}"']|"[^"]*"|'[^']*')*(;|(?=\}))/g, (rule, name) => (asked.has(name) ? rule : ""));
} while (kept.length < before);
writeFileSync(sheet, kept);
