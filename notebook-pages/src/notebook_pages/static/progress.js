// What the reader has done, kept in this browser alone: nothing is sent anywhere.
// One record for the whole site, under the site's path, so that two books on one server keep apart.
const progress = (() => {
  const root = new URL(document.documentElement.dataset.content_root || "./", location.href).pathname;
  const key = `progress of ${root}`;
  const page = decodeURI(location.pathname).slice(decodeURI(root).length).replace(/\.html$/, "") || "index";
  let record = {};
  let kept = true;

  // A record that somebody else wrote, or that an export brought back, is taken only as far as it is one.
  const sound = (value) => {
    const pages = {};
    for (const [name, found] of Object.entries(value?.pages ?? {})) {
      const texts = (list) => [...new Set(Array.isArray(list) ? list.filter((item) => typeof item === "string") : [])];
      const answers = {};
      for (const [label, { first, last, right, rightAtFirst } = {}] of Object.entries(found?.answers ?? {}))
        answers[label] = { first: String(first), last: String(last), right: right === true, rightAtFirst: rightAtFirst === true };
      pages[name] = { read: texts(found?.read), done: texts(found?.done), checked: texts(found?.checked), answers };
    }
    return { pages };
  };
  const load = () => {
    try {
      record = sound(JSON.parse(localStorage.getItem(key)));
    } catch {
      kept = false; // storage is forbidden, or holds something else: this page's record then lasts as long as the page
      record.pages ??= {};
    }
  };
  const store = () => {
    try {
      localStorage.setItem(key, JSON.stringify(record));
      kept = true;
    } catch {
      kept = false;
    }
  };
  load();

  return {
    page,
    all: () => record.pages,
    isKept: () => kept && !window.keepsNothing, // the page's head puts a store that lasts as long as the page where storage is forbidden
    here: () => record.pages[page] ?? { read: [], done: [], checked: [], answers: {} },
    change(action) {
      if (kept) load(); // another tab may have written meanwhile
      action((record.pages[page] ??= { read: [], done: [], checked: [], answers: {} }));
      store();
      document.dispatchEvent(new CustomEvent("progress"));
    },
    replace(value) {
      record = sound(value);
      if (Object.keys(record.pages).length) return store();
      try {
        localStorage.removeItem(key);
      } catch {
        kept = false;
      }
    },
  };
})();

{
  const note = (list, name) => {
    if (name && !progress.here()[list].includes(name)) progress.change((here) => here[list].push(name));
  };
  // A section counts as read when its last lines have been on the screen for a while.
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

  // What is done with pencil and paper, the reader ticks.
  for (const exercise of document.querySelectorAll(".admonition.exercise[id]")) {
    const label = document.createElement("label");
    const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: progress.here().done.includes(exercise.id) });
    label.className = "done";
    label.append(box, " I have done this one");
    box.addEventListener("change", () =>
      progress.change((here) => {
        here.done = here.done.filter((name) => name !== exercise.id);
        if (box.checked) here.done.push(exercise.id);
      }));
    exercise.append(label);
  }

  // What the page's own Python has checked, and found right.
  const RIGHT = '.coursework-reply[data-outcome="correct"]';
  new MutationObserver((changes) => {
    for (const { addedNodes } of changes)
      for (const node of addedNodes)
        if (node.nodeType === Node.ELEMENT_NODE)
          for (const reply of [...(node.matches(RIGHT) ? [node] : []), ...node.querySelectorAll(RIGHT)])
            note("checked", reply.dataset.question);
  }).observe(document.querySelector("article") ?? document.body, { childList: true, subtree: true });
}
