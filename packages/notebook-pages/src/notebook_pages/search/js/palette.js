// Show the places that answer, while the reader types into a search field: below the field, the best first. The index
// precedes this script in the same file (see notebook_pages/search), as a page opened from disk may not fetch.
import { finder } from "./find.js";
import { pasted } from "./pasted.js";

const index = self.searchIndex;
let find; // built when the words have come, or for a query before that, since it takes a while on a telephone
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
    if (list.contains(document.activeElement)) return; // the answers stay while one of them has the focus
    const query = field.value.trim();
    const numbers = numbersFirst(query); // with numbers there is nothing to look up
    const begun = query.length < 3 && /^[\p{Script=Latin}\d\s]*$/u.test(query); // a single word so far, or nothing
    const found = begun ? [] : numbers.length ? numbers : (find ??= finder(index))(query).map(shown);
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
    // In the field, these keys submit nothing; on a link, the browser opens a tab.
    if (event.target === field && event.key === "Enter" && (event.ctrlKey || event.metaKey) && all[1]) open(all[1].href);
  };
  for (const part of [field, list]) part.addEventListener("keydown", move);
  // The dialog closes, as the answer may be a place on this page, below it.
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
