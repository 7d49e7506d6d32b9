// The lecture: the page in the steps that its author marked, at the size of a lecture hall, with working figures. It
// starts by a button and not by a key, because a single letter must not change the page for somebody who dictates or
// types. The key "?" shows all keys. Nothing is moved within the page: what is not shown is hidden, and what is shown
// covers everything else. book.js loads this script and its styles when they are needed.
{
  const root = document.documentElement;
  const article = document.querySelector(".bd-article");
  const button = document.querySelector("button.lecture-mode");
  const make = (tag, attributes = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), attributes);
    element.append(...children);
    return element;
  };
  const headingOf = (section) => {
    const words = section?.querySelector(":scope > :is(h1, h2, h3)")?.cloneNode(true);
    words?.querySelectorAll(".headerlink, .section-number").forEach((part) => part.remove());
    return words?.textContent.trim() ?? "";
  };

  // The steps are marked in the notebook (lecture.py), or they are the stops of an essay, the sections with a
  // data-stop: such a page moves its own figure as it is scrolled, so its text is for the speaker.
  const stops = [...new Set([...document.querySelectorAll("[data-stop]")].map((stop) => stop.closest("section")))];
  const items = [...(document.querySelector("template#lecture")?.content.querySelectorAll("li[data-shows]") ?? [])];
  const steps = stops.length
    ? stops.map((stop) => ({
        stop,
        blocks: [],
        line: make("p", { textContent: headingOf(stop) }),
        notes: [...stop.querySelectorAll(":scope > p")].map((text) => text.outerHTML).join(""),
        section: "",
      }))
    : items.map((item) => ({
        blocks: item.dataset.shows.split(" ").filter(Boolean).map((id) => document.getElementById(id)).filter(Boolean),
        line: item.querySelector("p"),
        notes: item.querySelector("aside").innerHTML,
        section: headingOf(document.getElementById(item.dataset.section)?.closest("section")),
      }));

  let now = -1, began = 0, place = 0, speaker = null, typed = "", words = "", unseen = [], ticking;
  const line = make("div", { className: "lecture-line", tabIndex: -1 });
  const counter = make("button", { type: "button", title: "Outline and more (key O)" });
  const clock = make("span", { className: "lecture-clock", hidden: true });
  const under = make("span", { className: "lecture-section" });
  const bar = make("div", { className: "lecture-bar" }, under, clock, counter);
  const said = make("p", { className: "lecture-said" });
  said.setAttribute("role", "status");
  const notes = make("aside", { className: "lecture-notes", hidden: true });
  notes.setAttribute("aria-label", "Notes for the speaker");
  const black = make("div", { className: "lecture-black", hidden: true });
  const menu = make("dialog", { className: "lecture-menu" });
  menu.setAttribute("aria-label", "Outline of the lecture");

  // ---- vote on a prediction by show of hands: enter the counts, see the shares, then the answer ----
  const votes = new Map();
  const ballot = (box) => {
    if (box.dataset.kind !== "answer" || votes.has(box)) return;
    const choices = [...box.querySelectorAll(".choices > li")];
    const hands = choices.map((choice) => {
      const input = make("input", { type: "number", min: 0, step: 1, placeholder: "0", inputMode: "numeric" });
      input.setAttribute("aria-label", `Hands for ${choice.dataset.name}`);
      const more = make("button", { type: "button", textContent: "+" });
      more.setAttribute("aria-label", `One more hand for ${choice.dataset.name}`);
      const before = make("span", { className: "share before" });
      const share = make("span", { className: "share" });
      const counted = make("div", { className: "hands" }, make("span", { className: "shares" }, before, share), input, more);
      more.addEventListener("click", () => {
        input.value = Number(input.value) + 1;
        input.dispatchEvent(new Event("input"));
      });
      input.addEventListener("keydown", (event) => {
        if (event.key === "Enter") (hands[hands.indexOf(hand) + 1]?.input ?? show).focus();
      });
      choice.append(counted);
      const hand = { input, share, before, counted, choice };
      return hand;
    });
    const tell = () => {
      const all = hands.reduce((sum, { input }) => sum + Math.max(0, Number(input.value)), 0);
      for (const { input, share } of hands) share.style.width = `${all ? (100 * Math.max(0, Number(input.value))) / all : 0}%`;
    };
    for (const { input } of hands) input.addEventListener("input", tell);
    const show = make("button", { type: "button", textContent: "Show the answer" });
    const again = make("button", { type: "button", className: "quiet", textContent: "Vote again" });
    const reply = make("div", { className: "result" });
    reply.setAttribute("role", "status");
    const reveal = () => {
      const right = box.querySelector(".replies li.right");
      box.classList.add("shown");
      for (const { choice } of hands) choice.classList.toggle("right", choice.dataset.name === right.dataset.name);
      reply.className = "result right";
      reply.replaceChildren(make("p", { className: "verdict" }, make("strong", { textContent: right.dataset.name })), right.querySelector("div").cloneNode(true));
      fit();
    };
    show.addEventListener("click", reveal);
    again.addEventListener("click", () => {
      for (const { input, share, before } of hands) {
        before.style.width = share.style.width;
        input.value = "";
      }
      tell();
      hands[0].input.focus();
    });
    const actions = make("p", { className: "actions hands" }, show, again);
    box.append(actions, reply);
    votes.set(box, { reveal, clear: () => [...hands.map(({ counted }) => counted), actions, reply].forEach((part) => part.remove()) });
  };

  // ---- what is shown ----
  // Each figure fills the space that the words leave: beside or below, whichever makes the drawing larger.
  const GAP = 16;
  const PANEL = 19; // the width of a figure's controls and numbers, in the type of the lecture
  const SIZES = [1, 0.9, 0.8, 0.7, 0.6, 0.5];
  const LARGE = [1.8, 1.6, 1.4, 1.2, ...SIZES];
  // The aspect ratio of a drawing, and the width of the controls beside it within its figure.
  const shapeOf = (figure) => {
    const drawing = figure.querySelector("svg.sheet") ?? figure.querySelector("svg[viewBox], img");
    const panel = figure.querySelector(".moving") ? PANEL * parseFloat(getComputedStyle(root).fontSize) : 0;
    if (!drawing) return { shape: 1, panel: 2 * panel };
    if (drawing.localName === "img") return { shape: drawing.naturalWidth / drawing.naturalHeight || 1.6, panel };
    return { shape: drawing.viewBox.baseVal.width / drawing.viewBox.baseVal.height, panel };
  };
  const set = (name, value) => article.style.setProperty(`--lecture-${name}`, value);
  const overflows = () =>
    article.scrollHeight > article.clientHeight + 1 ||
    [line, ...article.querySelectorAll(".in-step .math-box")].some((box) => box.scrollWidth > box.clientWidth + 1);
  const fit = () => {
    if (stops.length || now < 0) return;
    const figures = steps[now].blocks.filter((block) => block.matches("figure"));
    set("left", "0px");
    set("top", "0px");
    if (!figures.length) {
      article.dataset.words = steps[now].blocks.length ? "alone" : "only";
      LARGE.some((size) => (set("type", size), !overflows()));
      return;
    }
    const shapes = figures.map(shapeOf);
    const shape = shapes.reduce((sum, shape) => sum + shape.shape, 0);
    const panel = shapes.reduce((sum, part) => sum + part.panel, 0);
    const foot = parseFloat(getComputedStyle(article).paddingBottom);
    const [wide, high] = [article.clientWidth - 2 * GAP, article.clientHeight - GAP - foot];
    const area = (width, height) => Math.min(height, Math.max(0, width - panel) / shape) ** 2 * shape;
    // Words may be smaller or in a narrower column for the sake of the drawing, but not by much.
    const worth = ({ width, height, size, tall }) => area(width, height) * size ** 0.8 * (tall ? 0.75 : 1);
    const layouts = [];
    article.dataset.words = "below";
    for (const size of SIZES.slice(0, 3)) {
      set("type", size);
      const words = [line, ...steps[now].blocks.filter((block) => !block.matches("figure"))];
      const height = high - words.reduce((sum, line) => sum + line.offsetHeight + GAP, 0);
      layouts.push({ words: "below", width: wide + GAP, height, size });
    }
    article.dataset.words = "beside";
    for (const share of [0.18, 0.22, 0.26, 0.3, 0.36, 0.44, 0.52]) {
      set("left", `${(1 - share) * 100}%`);
      const size = SIZES.find((size) => (set("type", size), !overflows()));
      if (size) layouts.push({ words: "beside", width: wide * (1 - share), height: high, size, tall: line.offsetHeight > high / 3 });
    }
    const best = layouts.reduce((best, candidate) => (worth(candidate) >= worth(best) ? candidate : best));
    article.dataset.words = best.words;
    set("type", best.size);
    set("left", best.words === "beside" ? `${best.width + GAP}px` : "0px");
    set("top", `${best.height}px`);
    let from = 0;
    for (const [place, figure] of figures.entries()) {
      const width = ((best.width - panel) * shapes[place].shape) / shape + shapes[place].panel;
      figure.style.setProperty("--lecture-from", `${from}px`);
      figure.style.setProperty("--lecture-width", `${width}px`);
      from += width;
      const live = figure.querySelector(".moving > .live");
      if (live) SIZES.some((size) => (live.style.setProperty("--lecture-panel", size), live.scrollHeight <= live.clientHeight + 1));
    }
    dispatchEvent(new Event("resize"));
  };
  // Scroll the page past a stop as a reader would, so that its figure goes through what the stop shows.
  const GLIDE = 7; // milliseconds a pixel
  let gliding = 0;
  const glide = (stop) => {
    cancelAnimationFrame(gliding);
    const { top, height } = stop.getBoundingClientRect();
    const from = scrollY + top - 0.55 * innerHeight + 1;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const start = performance.now();
    const move = (moment) => {
      const share = still ? 1 : Math.min(1, Math.max(0, (moment - start) / (GLIDE * height)));
      scrollTo({ top: from + 0.9 * height * share, behavior: "instant" });
      if (share < 1) gliding = requestAnimationFrame(move);
    };
    move(start);
  };
  const clear = () => {
    cancelAnimationFrame(gliding);
    for (const block of document.querySelectorAll(".in-step, .around-step")) block.classList.remove("in-step", "around-step");
    for (const block of unseen) block.inert = true;
    unseen = [];
  };
  const show = (wanted, told = true) => {
    now = Math.max(0, Math.min(steps.length - 1, wanted));
    const step = steps[now];
    clear();
    for (const block of step.blocks) {
      block.classList.add("in-step");
      // The speaker decides when to show it, so what a prediction covers on the page is not covered here.
      for (let box = block.parentElement; box && box !== article; box = box.parentElement) {
        box.classList.add("around-step");
        if (box.inert) {
          box.inert = false;
          unseen.push(box);
        }
      }
      if (block.matches(".question")) ballot(block);
    }
    history.replaceState({ lecture: now }, ""); // for a reload
    words = `${now + 1} of ${steps.length}`;
    line.replaceChildren(step.line.cloneNode(true));
    counter.textContent = words;
    under.textContent = step.section;
    notes.innerHTML = step.notes || "<p>No notes for this step.</p>";
    said.textContent = `Step ${words}`;
    if (step.stop) {
      glide(step.stop);
    } else {
      article.scrollTop = 0;
      fit();
    }
    line.focus({ preventScroll: true });
    if (told) tellSpeaker();
  };

  // ---- the speaker's own window ----
  const time = () => {
    const seconds = Math.floor((Date.now() - began) / 1000);
    return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
  };
  const tellSpeaker = () => {
    if (!speaker || speaker.closed) return;
    const page = speaker.document;
    const next = steps[now + 1];
    page.querySelector("h1").replaceChildren(...page.importNode(steps[now].line, true).childNodes);
    page.querySelector("main").innerHTML = steps[now].notes || "<p>No notes for this step.</p>";
    page.querySelector("footer").replaceChildren(next ? "Next: " : "The last step.", ...(next ? page.importNode(next.line, true).childNodes : []));
    page.querySelector("p.place").textContent = words;
  };
  const openSpeaker = () => {
    if (speaker && !speaker.closed) return speaker.focus();
    speaker = open("", "lecture-speaker", "popup,width=760,height=560");
    if (!speaker) return (notes.hidden = false); // no second window is allowed: the notes are shown below the step
    const page = speaker.document;
    page.title = `Notes: ${document.title}`;
    page.documentElement.dataset.theme = root.dataset.theme ?? "light";
    page.documentElement.className = "lecture-speaker";
    page.documentElement.lang = root.lang;
    for (const { href } of document.querySelectorAll("link[rel=stylesheet]")) page.head.append(Object.assign(page.createElement("link"), { rel: "stylesheet", href }));
    for (const styles of document.querySelectorAll("head > style")) page.head.append(page.importNode(styles, true));
    page.body.innerHTML = '<p class="place"></p><p class="time" role="timer"></p><h1></h1><main></main><footer></footer>';
    page.addEventListener("keydown", keys);
    tellSpeaker();
    tick();
  };
  const tick = () => {
    clock.textContent = time();
    if (speaker && !speaker.closed) speaker.document.querySelector("p.time").textContent = time();
  };

  // ---- outline, with every action of the keys for those who have no keyboard ----
  const KEYS = [
    ["\u2192 \u2193 Space PageDown", "the next step", () => show(now + 1)],
    ["\u2190 \u2191 PageUp", "the step before", () => show(now - 1)],
    ["Home, End", "the first, the last step"],
    ["a number, Enter", "to that step"],
    ["O", "outline", () => outline()],
    ["A", "the answer to a prediction"],
    ["B", "black screen", () => (black.hidden = !black.hidden)],
    ["T", "time since the beginning; Shift and T sets it to 0:00", () => (clock.hidden = !clock.hidden)],
    ["N", "notes on this screen", () => ((notes.hidden = !notes.hidden), fit())],
    ["S", "notes in a window of their own", openSpeaker],
    ["F", "full screen", () => (document.fullscreenElement ? document.exitFullscreen() : root.requestFullscreen?.())],
    ["?", "these keys", () => outline()],
    ["Escape", "back to the page", () => end()],
  ];
  const outline = () => {
    if (menu.open) return menu.close();
    let section;
    const list = make("ol");
    steps.forEach((step, number) => {
      if (step.section !== section && step.section) list.append(make("li", { className: "lecture-part", textContent: step.section }));
      section = step.section;
      const go = make("button", { type: "button" }, make("b", { textContent: number + 1 }), step.line.cloneNode(true));
      if (number === now) go.setAttribute("aria-current", "step");
      go.addEventListener("click", () => {
        menu.close();
        show(number);
      });
      list.append(make("li", {}, go));
    });
    const table = make("ul", { className: "lecture-keys" });
    for (const [key, means, act] of KEYS) {
      const means_ = act ? make("button", { type: "button", textContent: means }) : make("span", { textContent: means });
      if (act) means_.addEventListener("click", () => {
        menu.close();
        act();
      });
      table.append(make("li", {}, make("kbd", { textContent: key }), means_));
    }
    menu.replaceChildren(list, table);
    menu.showModal();
    menu.querySelector("[aria-current]")?.focus();
  };
  menu.addEventListener("click", ({ target }) => target === menu && menu.close());
  menu.addEventListener("keydown", (event) => {
    const all = [...menu.querySelectorAll("ol button")];
    const at = all.indexOf(document.activeElement);
    const to = { ArrowDown: at + 1, ArrowUp: at - 1 }[event.key];
    if (to !== undefined) {
      event.preventDefault();
      all[Math.max(0, Math.min(all.length - 1, to))].focus();
    }
    if (/^[o?]$/i.test(event.key)) {
      event.stopPropagation();
      menu.close();
    }
  });
  counter.addEventListener("click", outline);
  black.addEventListener("click", () => (black.hidden = true));

  const begin = () => {
    root.classList.remove("in-parts"); // because the steps are measured
    place = scrollY;
    began = Date.now();
    ticking = setInterval(tick, 1000);
    // Start at what the reader was looking at.
    const at = steps.findIndex(({ blocks, stop }) => [stop ?? blocks].flat().some((block) => block.getBoundingClientRect().bottom > 80));
    root.classList.add("lecture");
    root.classList.toggle("in-steps", !stops.length);
    button.setAttribute("aria-pressed", "true");
    article.append(line);
    document.body.append(bar, said, notes, black, menu);
    if (history.state?.lecture === undefined) history.pushState(null, ""); // the browser's Back ends the lecture
    show(history.state?.lecture ?? (place > 200 ? Math.max(at, 0) : 0));
    tick();
  };
  const end = () => {
    if (menu.open) menu.close();
    if (document.fullscreenElement) document.exitFullscreen();
    clear();
    clearInterval(ticking);
    for (const { clear: remove } of votes.values()) remove();
    for (const box of votes.keys()) box.classList.remove("shown");
    votes.clear();
    root.classList.remove("lecture", "in-steps");
    delete article.dataset.words;
    button.setAttribute("aria-pressed", "false");
    for (const part of [line, bar, said, notes, black, menu]) part.remove();
    speaker?.close();
    dispatchEvent(new Event("resize"));
    scrollTo({ top: place, behavior: "instant" });
    button.focus({ preventScroll: true });
    if (history.state?.lecture !== undefined) history.back();
  };
  addEventListener("popstate", () => root.classList.contains("lecture") && history.state?.lecture === undefined && end());
  const toggle = () => (root.classList.contains("lecture") ? end() : begin());
  button.addEventListener("click", toggle);

  // ---- keys, clicks and touches ----
  const TYPING = "input:not([type=range], [type=radio], [type=checkbox]), textarea, select, [contenteditable], .cm-editor";
  const MOVED = "[role=slider], [role=radiogroup], input, .sheet, canvas, button.number";
  function keys(event) {
    if (event.altKey || event.ctrlKey || event.metaKey || event.target.closest?.(`${TYPING}, dialog`)) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!root.classList.contains("lecture")) return;
    const remote = /^(PageDown|PageUp|F5)$/.test(key) && !event.shiftKey; // a remote control works wherever the focus is
    if (!remote && event.target.closest?.(MOVED) && !/^[a-z?.]$/.test(key)) return;
    if (!remote && (key === " " || key === "Enter") && !typed && event.target.closest?.("button, summary, a")) return;
    const go = { ArrowRight: 1, ArrowDown: 1, PageDown: 1, " ": 1, ArrowLeft: -1, ArrowUp: -1, PageUp: -1, Home: -steps.length, End: steps.length }[key];
    const digit = /^\d$/.test(key);
    if (go) {
      event.preventDefault();
      if (black.hidden) show(now + go);
      black.hidden = true;
    } else if (digit) counter.textContent = `to ${(typed += key)}`;
    else if (key === "Enter" && typed) {
      event.preventDefault();
      show(Number(typed) - 1);
    } else if (key === "Escape") typed ? (counter.textContent = words) : black.hidden ? end() : (black.hidden = true);
    else if (key === "b" || key === ".") black.hidden = !black.hidden;
    else if (key === "o" || key === "?") outline();
    else if (key === "t" && event.shiftKey) (began = Date.now()), tick();
    else if (key === "t") clock.hidden = !clock.hidden;
    else if (key === "n") (notes.hidden = !notes.hidden), fit();
    else if (key === "s") openSpeaker();
    else if (key === "f" || key === "F5" && remote) event.preventDefault(), KEYS.find(([name]) => name === "F")[2](); // F5 starts a remote control's show
    else if (key === "a") votes.get(steps[now].blocks.find((block) => votes.has(block)))?.reveal();
    if (!digit) typed = "";
  }
  document.addEventListener("keydown", keys);
  // A control that was clicked does not keep the focus: the next space bar goes to the next step.
  document.addEventListener("pointerup", () => {
    if (!root.classList.contains("lecture")) return;
    setTimeout(() => {
      const holder = document.activeElement;
      if (!menu.open && holder && !holder.matches(TYPING)) line.focus({ preventScroll: true });
    });
  });
  let touched = null;
  document.addEventListener("touchstart", ({ touches, target }) => {
    touched = touches.length === 1 && !target.closest(`${MOVED}, button, dialog, .scrolls`) ? [touches[0].clientX, touches[0].clientY] : null;
  }, { passive: true });
  document.addEventListener("touchend", ({ changedTouches: [finger] }) => {
    if (!touched || !root.classList.contains("lecture")) return;
    const [across, down] = [finger.clientX - touched[0], finger.clientY - touched[1]];
    if (Math.abs(across) > 60 && Math.abs(across) > 2 * Math.abs(down)) show(now + (across < 0 ? 1 : -1));
  });
  addEventListener("resize", ({ isTrusted }) => isTrusted && root.classList.contains("lecture") && fit());
}
