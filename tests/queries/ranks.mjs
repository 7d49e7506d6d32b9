// Asks the search of the built book what readers type: node ranks.mjs SCRIPT, queries on stdin, places on stdout (JSON).
import { readFileSync } from "node:fs";
import { finder } from "../../src/website/search/js/find.js";

const [, data] = /^self\.searchIndex=(.*);$/m.exec(readFileSync(process.argv[2], "utf8"));
const index = JSON.parse(data);
const find = finder(index);
const place = ({ page, anchor = "" }) => index.pages[page][0] + (anchor && `#${anchor}`);
console.log(JSON.stringify(JSON.parse(readFileSync(0)).map((query) => find(query).map(place))));
