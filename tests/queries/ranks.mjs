// Asks the search of the built book what readers type: node ranks.mjs INDEX, queries on stdin, places on stdout (JSON).
import { readFileSync } from "node:fs";
import { finder } from "../../src/website/search/js/find.js";

const index = JSON.parse(readFileSync(process.argv[2]));
const find = finder(index);
const place = ({ page, anchor = "" }) => index.pages[page][0] + (anchor && `#${anchor}`);
console.log(JSON.stringify(JSON.parse(readFileSync(0)).map((query) => find(query).map(place))));
