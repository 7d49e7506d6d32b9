// Set formulas with KaTeX for the build: reads each formula as a line of JSON, and writes its HTML the same way.
import { createInterface } from "node:readline";
import { createRequire } from "node:module";

const katex = createRequire(import.meta.url)(process.argv[2]);

function answer({ tex, display, stretch }) {
  try {
    const options = { displayMode: display, output: "htmlAndMathml", throwOnError: true, strict: "error" };
    return { html: katex.renderToString(tex, { ...options, macros: { "\\arraystretch": stretch } }) };
  } catch (error) {
    return { fault: error.message };
  }
}

console.warn = () => {}; // KaTeX also throws an error for everything that it warns about
for await (const line of createInterface({ input: process.stdin })) {
  process.stdout.write(`${JSON.stringify(answer(JSON.parse(line)))}\n`);
}
