// Asks the search of the built book what readers type: node ranks.mjs FOLDER, for each line of queries on stdin a line
// of places on stdout (JSON).
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";
import { finder } from "../../../packages/notebook-pages/src/notebook_pages/search/js/find.js";

const data = (name) => JSON.parse(/^self\.\w+=(.*);$/m.exec(readFileSync(`${process.argv[2]}/${name}`, "utf8"))[1]);
const index = data("search.js");
const find = finder(index, data("search-words.js"));
const place = ({ page, anchor = "" }) => index.pages[page][0] + (anchor && `#${anchor}`);
for await (const line of createInterface({ input: process.stdin }))
  console.log(JSON.stringify(JSON.parse(line).map((query) => find(query).map(place))));
