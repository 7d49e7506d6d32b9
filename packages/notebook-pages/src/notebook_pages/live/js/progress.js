// The reader's progress, stored only in this browser: nothing is sent anywhere. The scripts of the page find the store
// here, and the record as ``progress``; if the store has no room, the record lasts as long as the page.
import { NEWER, Store } from "./store.js";

const root = new URL(document.documentElement.dataset.content_root || "./", location.href).pathname;
const store = (globalThis.bookStore = new Store(root));
const blank = () => ({ read: [], done: [], checked: [], answers: {} });

export const page = decodeURI(location.pathname).slice(decodeURI(root).length).replace(/\.html$/, "") || "index";
export const all = () => store.record();
export const here = () => store.record()[page] ?? blank();

// Why the record may be lost with the page; nothing if the browser stores it.
let kept = true;
export function whyNotKept() {
  if (store.isNewer) return NEWER;
  // If storage is forbidden, the page's head replaces it by a store that lasts as long as the page.
  return kept && !window.keepsNothing ? "" : "This browser does not let the page store anything, so your record lasts only as long as the page is open.";
}

export function change(action) {
  const now = here();
  action(now);
  kept = store.keepRecord(page, now);
  document.dispatchEvent(new CustomEvent("progress"));
}

// Replace this record by an exported one.
export function replace(value) {
  for (const name of Object.keys(all())) store.keepRecord(name, blank());
  kept = store.takeRecord(value?.pages);
}

const note = (list, name) => {
  if (name && !here()[list].includes(name)) change((now) => now[list].push(name));
};
// A section counts as read when its last lines have been on the screen for some time.
const A_WHILE = 1500;
const waiting = new Map();
const reading = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    const { id } = target.closest("section");
    clearTimeout(waiting.get(id));
    if (isIntersecting) waiting.set(id, setTimeout(() => note("read", id), A_WHILE));
  }
});
for (const section of document.querySelectorAll(".bd-article > section > section")) reading.observe(section.lastElementChild);

// Exercises with pencil and paper are ticked by the reader.
for (const exercise of document.querySelectorAll(".admonition.exercise[id]")) {
  const label = document.createElement("label");
  const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: here().done.includes(exercise.id) });
  label.className = "done";
  label.append(box, " I have done this one");
  box.addEventListener("change", () =>
    change((now) => {
      now.done = now.done.filter((name) => name !== exercise.id);
      if (box.checked) now.done.push(exercise.id);
    }));
  exercise.append(label);
}

// The answers that the page's own Python has checked and found right.
const RIGHT = '.coursework-reply[data-outcome="correct"]';
new MutationObserver((changes) => {
  for (const { addedNodes } of changes)
    for (const node of addedNodes)
      if (node.nodeType === Node.ELEMENT_NODE)
        for (const reply of [...(node.matches(RIGHT) ? [node] : []), ...node.querySelectorAll(RIGHT)])
          note("checked", reply.dataset.question);
}).observe(document.querySelector("article") ?? document.body, { childList: true, subtree: true });
