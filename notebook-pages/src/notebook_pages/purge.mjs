// What of a style sheet a site needs, and when: node purge.mjs NODE_MODULES SITE SHEET FILE... takes out of the sheet what no
// page uses. The files are scripts, whose words may become classes, and other sheets, which may ask for values of this one.
// node purge.mjs NODE_MODULES SITE SHEET --later LATER moves into another sheet what no page uses as it comes, before its
// scripts have run.
import { createRequire } from "node:module";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [modules, site, sheet, ...files] = process.argv.slice(2);
const require = createRequire(join(modules, "package.json"));
const { PurgeCSS } = require("purgecss");
const css = readFileSync(sheet, "utf8");

// Every word of a script that stands in quotes.
function quoted(script) {
  const found = script.replace(/^\s*\/\/.*$/gm, "").match(/"[^"\n]*"|'[^'\n]*'|`[^`]*`/g) ?? [];
  return found.join(" ").match(/[A-Za-z][\w-]*/g) ?? [];
}
// Of a page, its elements, ids, classes and attributes: a word of the text is none. To them come the words of the scripts
// that stand in it, for these run before it is seen, and those of a comment that keeps a place for what comes last.
function namesIn(page) {
  const found = { tags: [], classes: [], ids: [], attributes: { names: [], values: [] }, undetermined: [] };
  for (const [, script] of page.matchAll(/<script>(.*?)<\/script>/gs)) found.undetermined.push(...quoted(script));
  for (const [, name] of page.matchAll(/<!-- ([\w-]+) -->/g)) found.classes.push(name);
  for (const [, tag, attributes] of page.matchAll(/<([a-z][a-z0-9-]*)((?:\s+[^\s=>]+(?:\s*=\s*(?:"[^"]*"|'[^']*'|[^\s>]+))?)*)\s*\/?>/gi)) {
    found.tags.push(tag.toLowerCase());
    for (const [, name, , double, single, bare] of attributes.matchAll(/([^\s=>]+)(\s*=\s*(?:"([^"]*)"|'([^']*)'|([^\s>]+)))?/g)) {
      const words = (double ?? single ?? bare ?? "").split(/\s+/).filter((word) => word.length < 60);
      found.attributes.names.push(name);
      found.attributes.values.push(...words);
      ({ class: found.classes, id: found.ids })[name]?.push(...words);
    }
  }
  return found;
}
// Of the theme's scripts, the classes that they give to what is there: most of what else they make belongs to parts of a
// page that no page here has.
function wordsIn(name) {
  const script = readFileSync(name, "utf8");
  return name.includes("/scripts/") ? [...script.matchAll(/classList\.(?:add|toggle)\("([\w-]+)/g)].map(([, name]) => name) : quoted(script);
}
async function purged(css, scripts, options) {
  const [found] = await new PurgeCSS().purge({
    content: [join(site, "**/*.html"), { raw: scripts.flatMap(wordsIn).join(" "), extension: "words" }],
    css: [{ raw: css }],
    extractors: [{ extractor: namesIn, extensions: ["html"] }, { extractor: (words) => words.split(" "), extensions: ["words"] }],
    skippedContentGlobs: [join(site, "lite/**")], // notebooks bring their own
    ...options,
  });
  return found.css;
}

if (files[0] === "--later") {
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
