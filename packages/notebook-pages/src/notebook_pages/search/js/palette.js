// Shows, while a reader types into a field of the search, the places that answer: below the field, the best first.
// The index stands before this script, in the same file (see notebook_pages/search): a page from a disk may fetch nothing.
import { finder } from "./find.js";
import { pasted } from "./pasted.js";

const index = self.searchIndex;
let find = finder(index);
const fields = [];
const root = new URL(document.documentElement.dataset.content_root || "./", location.href);
const make = (tag, properties, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

const address = ({ page, anchor }) => new URL(`${index.pages[page][0]}.html${anchor ? `#${anchor}` : ""}`, root).href;
const KIND = { page: "", section: "", example: "", term: "Glossary", function: "Function", exercise: "Exercise", equation: "Equation", figure: "Figure" };

function shown(entry) {
  const [, title, part] = index.pages[entry.page];
  const number = entry.number && !/^[A-Z]/.test(entry.number) ? `${entry.number} ` : "";
  const place = [KIND[entry.kind], !entry.anchor ? part : entry.kind === "term" ? "" : title].filter(Boolean).join(" · ");
  return make("li", {}, make("a", { href: address(entry) },
    make("b", { textContent: `${number}${entry.title}` }), make("small", { textContent: place }),
    make("span", { textContent: entry.about ?? "" })));
}

function numbersFirst(query) {
  const given = index.workbench && pasted(query);
  if (!given) return [];
  const data = btoa(String.fromCharCode(...new TextEncoder().encode(JSON.stringify({ first: query.trim() }))));
  const fragment = `#workbench=1.${data.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
  return [make("li", {}, make("a", { href: new URL(index.workbench + fragment, root).href },
    make("b", { textContent: `Compare this ${given} with what another program gives` }), make("small", { textContent: "Workbench" })))];
}

function attach(form) {
  const field = form.querySelector("input");
  const list = make("ul", { className: "found" });
  const count = make("p", { className: "found-count" });
  count.setAttribute("role", "status");
  form.closest("dialog")?.setAttribute("aria-label", "Search");
  const place = document.getElementById("search-results");
  if (place && !form.closest("dialog")) place.append(count, list);
  else form.after(count, list);
  const links = () => [...list.querySelectorAll("a")];
  const answer = () => {
    if (list.contains(document.activeElement)) return; // whoever is among the answers keeps them
    const query = field.value.trim();
    const numbers = numbersFirst(query); // in which there is nothing to be looked for
    const begun = query.length < 3 && /^[\p{Script=Latin}\d\s]*$/u.test(query); // a word, or nothing yet
    const found = begun ? [] : numbers.length ? numbers : find(query).map(shown);
    list.replaceChildren(...found);
    count.textContent = begun ? "" : found.length
      ? `${found.length} ${found.length === 1 ? "place" : "places"}; Enter opens the first` : "Nothing found in this book. Try a different word. For a symbol, type its name.";
  };
  fields.push(answer);
  field.addEventListener("input", answer);
  field.addEventListener("paste", () => setTimeout(answer));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    links()[0]?.click();
  });
  const move = (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const all = [field, ...links()], next = all[all.indexOf(document.activeElement) + step];
    if (next) event.preventDefault(), next.focus();
  };
  for (const part of [field, list]) part.addEventListener("keydown", move);
  // A place on this page is come to beneath the palette.
  list.addEventListener("click", () => form.closest("dialog")?.close());
  const asked = new URLSearchParams(location.search).get("q");
  if (place && asked && !field.value && !form.closest("dialog")) field.value = asked;
  answer();
}

for (const form of document.querySelectorAll("form.bd-search")) attach(form);
const more = make("script", { src: new URL(index.words, root).href });
more.addEventListener("load", () => {
  find = finder(index, self.searchWords);
  for (const answer of fields) answer();
});
document.head.append(more);
