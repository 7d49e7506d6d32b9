// On every page with code: the buttons, and a bar for messages. Everything else is loaded when needed.
{
  const data = JSON.parse(document.getElementById("live-data").textContent);
  const place = new URL("../", document.currentScript.src).pathname;
  const boxes = [...document.querySelectorAll("div.cell")].filter((box) => box.querySelector(".cell_input"));
  const make = (tag, attributes, text = "") => Object.assign(document.createElement(tag), attributes, { textContent: text });

  const store = globalThis.bookStore; // shared with the whole page (see progress.js)
  // Store a value that lasts as long as the tab. If the browser has no room, or forbids it, the page is not reloaded.
  const note = (key, value) => {
    try {
      sessionStorage.setItem(key, value);
      return true;
    } catch {
      return false;
    }
  };

  // A page that was saved holds what scripts added to it. They have put new buttons before the old ones.
  document.querySelectorAll(".live-bar, .run-cell, .copybtn + .copybtn").forEach((old) => old.remove());
  // The bar at the bottom of the window, which covers part of the page, so that no line moves.
  const bar = make("section", { className: "live-bar", hidden: true });
  bar.setAttribute("aria-label", "Python on this page");
  const words = make("p", { id: "live-words" }), bytes = make("span", { className: "live-bytes" });
  words.setAttribute("role", "status");
  const choices = make("span", { className: "live-choices" }), progress = make("progress", { hidden: true });
  progress.setAttribute("aria-label", "Loading Python");
  bytes.setAttribute("aria-hidden", "true"); // as the words are spoken once, but the numbers change all the time
  const keys = make("p", { id: "live-keys" }, "Shift+Enter runs a cell, Escape leaves it.");
  const close = make("button", { type: "button", className: "live-close", title: "Close this bar" }, "×");
  close.setAttribute("aria-label", "Close this bar");
  close.addEventListener("click", () => (bar.hidden = true));
  bar.append(words, choices, bytes, progress, keys, close);
  document.body.append(bar);
  const button = (text, action) => {
    const made = make("button", { type: "button" }, text);
    made.addEventListener("click", action);
    return made;
  };
  const tools = {
    say(text) {
      bar.hidden = false;
      words.textContent = text;
      choices.replaceChildren();
    },
    ask(text, actions) {
      tools.say(text);
      choices.append(...Object.entries(actions).map(([name, action]) => button(name, action)));
      choices.firstChild.focus();
    },
    progress(loaded, all) {
      progress.hidden = loaded === null;
      bytes.textContent = loaded === null ? "" : `${Math.round(loaded / 1e6)} of ${Math.round(all / 1e6)} MB`;
      if (loaded !== null) Object.assign(progress, { max: all, value: loaded });
    },
    fetched() {
      store.put("setting fetched", data.pyodide);
      tellSize();
    },
    buttons: (actions) => Object.entries(actions).map(([text, action]) => {
      const made = button(text, action);
      close.before(made);
      return made;
    }),
  };

  // Why this page cannot run code or store anything, if so: its origin is not shared by its own files.
  const apart = self.origin !== "null" ? "" : location.protocol === "file:"
    ? "A page opened from disk cannot run code. Open it online at its address or, in the folder of the whole book, run python serve.py and open the address that it prints."
    : "The page around this one blocks its files (its frame has a sandbox without allow-same-origin), so no code runs here. Open this page in its own tab.";
  document.querySelector("a.open-notebook")?.addEventListener("click", (event) => {
    if (!apart) return;
    event.preventDefault();
    tools.say(apart);
  });

  // Only an isolated page shares memory with its Python, which can then be stopped and keeps its names. If the server
  // does not isolate the pages, a service worker does, after the page is reloaded once.
  const RUN = `book ${place} run`; // in this tab: "tried", or what to run after the reload
  const isolate = async (number) => {
    const able = isSecureContext && "serviceWorker" in navigator && self === top && !window.keepsNothing;
    // Texts that the browser had no room for would be lost.
    if (crossOriginIsolated || !able || sessionStorage.getItem(RUN) || store.holdsTexts()) return false;
    if (!note(RUN, "tried")) return false;
    try {
      await navigator.serviceWorker.register(`${place}service-worker.js`);
      const late = new Promise((_, reject) => setTimeout(reject, 5000, new Error("it does not start")));
      await Promise.race([navigator.serviceWorker.ready, late]);
    } catch (error) {
      console.info(`The page is not isolated: ${error.message}`);
      return false;
    }
    if (!note(RUN, JSON.stringify({ page: data.page, number, line: scrollY }))) return false;
    location.reload();
    return true;
  };

  let page;
  // A browser remembers a failed script as long as the page is open, so it is then requested by another name.
  let tries = 0;
  const script = async (name) => {
    try {
      return await import(new URL(`${data.scripts}${name}${tries ? `?again=${tries}` : ""}`, location.href));
    } catch (error) {
      tries += 1;
      throw Object.assign(error, { isLost: true });
    }
  };
  // Explain an error. A script is missing if a newer edition has replaced the files of a page that was open.
  tools.explain = async (error, what = "That did not work") => {
    if (!error.isLost) return tools.say(`${what}: ${error.message}.`);
    const asked = (method) => fetch(location.pathname, { method, cache: "no-cache", signal: AbortSignal.timeout(5000) });
    const now = await asked("GET").then((answer) => answer.ok && answer.text(), () => "");
    if (now && !now.includes(data.scripts.split("/").at(-2))) {
      return tools.ask("This page has been updated since you opened it. Reload it to run its code. What you wrote here is kept.", {
        "Reload": () => location.reload(),
      });
    }
    // A page that is stored in the browser comes without a network, but no answer to HEAD is stored.
    if (!now || !(await asked("HEAD").then(() => true, () => false))) return tools.say(`${what}: the server of these pages does not answer${now ? ", and this browser keeps them without Python" : ""}. Try again when you have a network.`);
    tools.say(`${what}: ${error.message}.`);
  };
  const open = () => (page ??= script("live.js").then(({ open }) => open({ data, boxes, bar: tools })));
  const awaited = new Map(); // the cells in which the reader types before their editors are there
  const ask = async (number) => {
    if (apart) return tools.say(apart);
    await Promise.all(awaited.values());
    if (number !== undefined && (await isolate(number))) return;
    try {
      const opened = await open();
      if (number !== undefined) opened.run(opened.cells[number]);
    } catch (error) {
      page = undefined;
      await tools.explain(error);
    }
  };

  boxes.forEach((box, number) => {
    const run = button("Run", () => ask(number));
    run.className = "run-cell";
    run.dataset.label = `Run cell ${number + 1}`;
    box.querySelector(".cell_input").append(run);
  });
  // Code is edited in its place. Its editor is loaded when the reader goes there, or at once if answers are asked for.
  // Python waits for the first run. Until the editor is there, a text field takes the input, also from an input method.
  const makeField = (number) => {
    const code = boxes[number].querySelector(".cell_input > div");
    const ariaLabel = `Code of cell ${number + 1}`;
    const field = make("textarea", { className: "live-field", rows: 1, spellcheck: false, autocapitalize: "off", placeholder: " ", ariaLabel });
    field.addEventListener("compositionstart", () => {
      field.composed = new Promise((resolve) => field.addEventListener("compositionend", () => setTimeout(resolve), { once: true }));
    });
    field.addEventListener("keydown", (event) => {
      const command = (event.ctrlKey || event.metaKey) && !event.altKey;
      if (command && event.key === "a") field.all ||= !field.value;
      if (event.key !== "Enter" || event.isComposing || !(event.shiftKey || command)) return;
      event.preventDefault();
      field.readOnly = true; // what is typed after this would run as well
    });
    // Try again to load the editor if it could not be fetched.
    field.onfocus = field.onclick = () => write(number);
    code.tabIndex = -1; // or Shift+Tab would return from the field to it
    code.after(field);
    return field;
  };
  const bringEditor = async (number, point, field) => {
    try {
      const opened = await open();
      await field.composed;
      opened.write(opened.cells[number], point, field);
      field.remove();
    } catch (error) {
      page = undefined;
      field.readOnly = false;
      await tools.explain(error);
    }
    awaited.delete(number);
  };
  const write = (number, point) => {
    if (apart) return;
    const field = boxes[number].querySelector(".live-field") ?? makeField(number);
    if (!awaited.has(number)) awaited.set(number, bringEditor(number, point, field));
    field.focus();
  };
  boxes.forEach((box, number) => {
    const code = box.querySelector(".cell_input > div");
    code.tabIndex = 0;
    code.setAttribute("role", "textbox");
    code.setAttribute("aria-label", `Code of cell ${number + 1}`);
    code.addEventListener("focus", () => code.matches(":focus-visible") && write(number));
    code.addEventListener("click", ({ target, x, y }) => {
      // A reader who has selected part of the code is about to copy it.
      if (!target.closest("button") && getSelection().isCollapsed) write(number, { x, y });
    });
    code.addEventListener("dragenter", ({ dataTransfer, x, y }) => dataTransfer.types.includes("text/plain") && write(number, { x, y }));
  });
  const answers = [...boxes.keys()].filter((number) => data.cells[number]?.name);
  if (answers.length && !apart) addEventListener("load", () => setTimeout(() =>
    open().then(({ cells }) => answers.forEach((number) => cells[number].edit()), () => (page = undefined))));
  // A cell that takes files is prepared for them as soon as it is nearly in view.
  const near = new IntersectionObserver((entries) => {
    if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
    near.disconnect();
    open().catch(() => (page = undefined));
  }, { rootMargin: "50%" });
  if (!apart) document.querySelectorAll(".tag_takes-file").forEach((box) => near.observe(box));
  const runPage = document.querySelector("button.run-page");
  runPage.addEventListener("click", () => ask(-1));

  // Show the size of Python before it is fetched; afterwards the browser has it.
  function tellSize() {
    const told = store.read("setting fetched") === data.pyodide ? "" : `${Math.round(data.bytes / 1e6)} MB`;
    for (const run of [runPage, ...document.querySelectorAll("button.run-cell")]) {
      if (told && run === runPage) run.dataset.size = told;   // only once per page
      else delete run.dataset.size;
      run.setAttribute("aria-label", `${run.dataset.label}${told && `, which first fetches ${told}`}`);
    }
  }
  runPage.dataset.label = "Run this page";
  tellSize();

  // Store the book for reading without a network.
  document.querySelector("button.keep-book").addEventListener("click", async () => {
    document.querySelector("details.take-away").open = false;
    if (apart) return tools.say(location.protocol === "file:" ? "This copy of the book is on your disk: it needs no network." : apart);
    try {
      await (await script("keep.js")).keep(tools);
    } catch (error) {
      await tools.explain(error);
    }
  });

  // Take away and bring back: the page's answers as a notebook, and all answers of the book as one file.
  const originals = boxes.map((box) => box.querySelector(".cell_input pre").textContent.trimEnd());
  for (const choice of document.querySelectorAll("button[data-answers]")) {
    choice.addEventListener("click", async () => {
      if (apart) return tools.say(apart);
      try {
        const { [choice.dataset.answers]: act } = await script("take-away.js");
        tools.say(await act(data, originals));
        if (/load|restore/.test(choice.dataset.answers)) (await open()).reread();
      } catch (error) {
        await tools.explain(error);
      }
    });
  }

  // The output below a cell may be the default one, as the page was built, or of another ID: fold it, and show above it
  // what coursework knows of this reader. A cell that has run for this reader (see live.js) needs no such line.
  const named = (call) => originals.map((code) => new RegExp(`\\b${call}\\(\\s*["']([^"']+)["']`).exec(code)?.[1]);
  const shown = named("variant"), checked = named("check");
  tools.tellWhatIsKnown = () => {
    const name = store.read("coursework me.txt")?.text;
    boxes.forEach((box, number) => {
      const output = box.querySelector(".cell_output"), question = checked[number], { whose } = box.dataset;
      output?.querySelector(":scope > .live-known")?.remove();
      const folded = output?.querySelector(":scope > details.live-others");
      folded?.replaceWith(...[...folded.childNodes].slice(1));
      if (!output || !(shown[number] || question) || whose === store.student) return;
      const varies = shown.includes(question), known = question && store.standing(question, varies);
      if (whose !== undefined && question && !varies) return; // the same for everybody
      const run = "Run this cell to see the reply again.";
      const numbers = known?.whose ? `the numbers of ${known.whose}` : "the default numbers";
      const now = `${name ? `The numbers are those of ${name}` : "You have the default numbers"} now`;
      let said = "";
      if (shown[number]) said = name && `Run this cell to get the numbers of ${name}.`;
      else if (!known) said = whose !== undefined && `${now}: run this cell once your answer uses these numbers.`;
      else if (known.whose !== undefined) said = `${known.outcome === "correct" ? "✓ Right with" : "Tried with"} ${numbers}, and this is remembered. ${now}: run the question and this cell to see how you stand.`;
      else if (known.outcome === "correct") said = "✓ Correct, in an earlier check. Run this cell to see the reply to the answer above it.";
      else said = `You have tried this one before. ${run}`;
      if (!said) return;
      output.querySelector('.coursework-reply[data-outcome="not attempted"]')?.remove();
      if (shown[number] || whose !== undefined) { // so that results of another ID do not seem to be those of the reader
        const others = make("details", { className: "live-built live-others" });
        others.append(make("summary", {}, shown[number] ? "The default numbers" : "The reply to other numbers"), ...output.childNodes);
        output.append(others);
      }
      output.prepend(make("p", { className: "live-known" }, said));
    });
  };
  tools.tellWhatIsKnown();

  // Restore what the reader has written here before, also in another tab; see store.js for the keys.
  const own = [`answer ${data.page} `, `earlier ${data.page} `, `agreed ${data.page}`, `given ${data.page} `];
  const isOwn = (key) => own.some((start) => key?.startsWith(start));
  const again = sessionStorage.getItem(RUN)?.startsWith("{") ? JSON.parse(sessionStorage.getItem(RUN)) : {};
  if (again.page) note(RUN, "tried");
  // The service worker has stored a newer edition. In a frame that forbids storage, asking for the worker is an error.
  if (self === top) navigator.serviceWorker?.addEventListener("message", ({ data: { edition } }) =>
    edition && script("keep.js").then(({ tellOfRenewal }) => tellOfRenewal(tools)).catch(() => {}));
  if (again.page === data.page) {
    addEventListener("load", () => scrollTo(0, again.line));
    window.figuresRan.then(() => ask(again.number)); // after the figures are restored (see book.js)
  }
  else if (store.isNewer) tools.say(globalThis.progress.whyNotKept());
  else if (store.keys().some(isOwn)) ask();
  else store.listen((key) => page || (isOwn(key) && ask()));
}
