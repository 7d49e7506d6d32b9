// KaTeX for the build: a formula as a line of JSON comes in, its HTML goes out the same way.
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

console.warn = () => {}; // what it warns of, it also throws
for await (const line of createInterface({ input: process.stdin })) {
  process.stdout.write(`${JSON.stringify(answer(JSON.parse(line)))}\n`);
}
