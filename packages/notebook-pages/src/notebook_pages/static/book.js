// Lay out what is below the first view (see first_view.py) once that is shown: a few blocks at a time, from the top
// down, so that the page responds meanwhile. To lay out the whole page at once, remove the class "in-parts".
{
  const root = document.documentElement;
  const later = root.classList.contains("in-parts") ? [...document.querySelectorAll(".later")] : [];
  const SLICE = 6; // milliseconds
  const whole = () => root.classList.remove("in-parts");
  const whenIdle = window.requestIdleCallback?.bind(window) ?? ((work) => setTimeout(work)); // not in every browser
  const goOn = () => {
    const start = performance.now();
    while (later.length && performance.now() - start < SLICE) {
      const block = later.shift();
      block.classList.remove("later");
      block.getBoundingClientRect(); // lays it out
    }
    if (later.length && root.classList.contains("in-parts")) whenIdle(goOn, { timeout: 200 });
    else whole();
  };
  // Load the typefaces of the whole page first: a face that came later would cause its text to be laid out again.
  const faces = () => Promise.all(allFaces.map((face) => document.fonts.load(face))).catch(() => {});
  const aWhile = () => new Promise((resolve) => setTimeout(resolve, 3000));
  const frame = () => new Promise(requestAnimationFrame);
  let ran;
  window.figuresRan = new Promise((end) => { ran = end; }); // for scripts that need the figures
  const begin = async () => {
    while (root.classList.contains("settling")) await frame();
    // Wait until the frame with the first view is drawn before requesting anything that it does not need.
    await frame();
    await frame();
    ran(Promise.all([...document.querySelectorAll("link[rel='figure-script']")].map(({ href: src }) => new Promise((end) => {
      document.head.append(Object.assign(document.createElement("script"), { src, async: false, onload: end, onerror: end })); // in their order
    }))));
    if (!later.length) return;
    await Promise.race([faces(), aWhile()]);
    whenIdle(goOn, { timeout: 200 });
  };
  if (!later.length) whole();
  begin();
  for (const name of ["hashchange", "beforeprint"]) addEventListener(name, whole);
  document.addEventListener("click", ({ target }) => target.closest("a[href*='#']") && whole(), true);
}

// On a busy machine, Chromium sometimes stays at the top of a page although the address names a place in it. An old link
// may name a place that is gone: say so. A name that carries the state of a figure has "=" in it.
const arrives = performance.getEntriesByType("navigation")[0]?.type === "navigate";
addEventListener("load", () => requestAnimationFrame(() => {
  const name = location.hash.slice(1), place = document.getElementById(name);
  if (arrives && !scrollY) place?.scrollIntoView();
  const gone = "This page no longer has the place that your link names. It may have been moved or renamed: try the search.";
  if (!place && /^[\w-]+$/.test(name)) document.querySelector(".bd-article")?.prepend(Object.assign(document.createElement("p"), { className: "said", textContent: gone }));
}));

// Restore what the reader has moved, after Back and after a reload.
{
  const figures = () => [...document.querySelectorAll("figure.moving")];
  const moved = `moved ${location.pathname}`;
  addEventListener("pagehide", () => sessionStorage.setItem(moved, JSON.stringify(figures().map(({ model }) => model?.moved))));
  if (!arrives) figuresRan.then(() => {
    const before = JSON.parse(sessionStorage.getItem(moved)) ?? [];
    figures().forEach(({ model }, place) => model?.move(before[place]));
  });
}

// When a phone is turned or a window made narrower, keep what the reader is using, or else the first visible line, in
// its place. Lines are looked for at a few heights only, because measuring all of them would lay out the whole page.
{
  const LINE = ".bd-article :is(h1, h2, h3, p, li, tr, pre, .cm-line, .math):not(figure *)";
  let kept, place, timer, width; // measured at the first scroll, because that lays out the page
  const topOf = (line) => line.getBoundingClientRect().top;
  const begins = (line) => line && topOf(line) > 0 && topOf(line) < innerHeight;
  const remember = () => {
    if (innerWidth !== (width ??= innerWidth)) return;
    const { left } = document.querySelector(".bd-article, .bd-search-container").getBoundingClientRect();
    const lines = Array.from({ length: 40 }, (_, k) => document.elementFromPoint(left + 60, innerHeight * k / 40)?.closest(LINE));
    kept = scrollY && [document.querySelector(".bd-article :focus:not(figure *)"), ...lines].find(begins);
    place = kept && topOf(kept);
  };
  const soon = () => {
    clearTimeout(timer);
    timer = setTimeout(remember, 100);
  };
  for (const name of ["scroll", "focusin"]) addEventListener(name, soon, { passive: true });
  addEventListener("resize", () => {
    if (innerWidth === width) return; // only the keyboard or the address bar has appeared
    width = innerWidth;
    if (kept?.isConnected && !document.documentElement.classList.contains("lecture"))
      scrollBy({ top: topOf(kept) - Math.min(place, innerHeight / 2), behavior: "instant" });
    soon();
  });
}

// Make boxes that scroll reachable by keyboard, but only while they overflow. They are checked after they have been
// laid out, never before: measuring a box that nobody sees yet would lay out the page.
const watch = new ResizeObserver((entries) => {
  // A folded box has no size, and is checked when it is unfolded.
  const boxes = entries.filter(({ contentRect }) => contentRect.width).map(({ target }) => {
    const wide = target.scrollWidth > target.clientWidth + 1;
    return [target, wide || (!target.matches(".math-box, figure") && target.scrollHeight > target.clientHeight)];
  });
  for (const [target, scrolls] of boxes) {
    const words = target.matches(".math-box") ? "Wide equation" : target.matches("figure") && "Wide figure";
    for (const [name, value] of Object.entries({ tabindex: "0", ...(words && { role: "group", "aria-label": words }) })) {
      if (scrolls) target.setAttribute(name, value);
      else if (name === "role" && target.matches("figure")) target.setAttribute(name, "none"); // its drawing has a name
      else target.removeAttribute(name);
    }
  }
});
window.watchWidth = (box) => watch.observe(box); // also for the boxes of the theme and later outputs
document.querySelectorAll(".math-box, figure.orientation-figure").forEach(watchWidth);

// Copy a formula as its TeX, without its drawing and spoken text, a number as programs read it, and no buttons.
document.addEventListener("copy", (event) => {
  const chosen = getSelection();
  if (event.defaultPrevented || chosen.isCollapsed) return;
  const range = chosen.getRangeAt(0).cloneRange();
  const around = (node) => (node.closest ? node : node.parentElement).closest(".katex-display, .katex:not(.katex-display *)");
  const [first, last] = [around(range.startContainer), around(range.endContainer)];
  if (first) range.setStartBefore(first);
  if (last) range.setEndAfter(last);
  const copy = document.createElement("div");
  copy.append(range.cloneContents());
  const formulas = copy.querySelectorAll(".katex"), buttons = copy.querySelectorAll(".run-cell, .to-original, details.hide > summary");
  if (!formulas.length && !buttons.length && !/[\u2007\u2212]/.test(chosen)) return;
  for (const button of buttons) button.remove();
  for (const formula of formulas) {
    const fence = formula.parentElement.matches(".katex-display") ? "$$" : "$";
    formula.replaceWith(fence + (formula.dataset.tex ?? formula.querySelector("annotation").textContent) + fence);
  }
  document.body.append(copy); // so that the browser knows where the lines end
  const shown = (formulas.length || buttons.length ? copy.innerText : String(chosen)).replaceAll("\u2007", " ");
  event.clipboardData.setData("text/plain", shown.replace(/\u2212(?=[\d.])/g, "-"));
  event.clipboardData.setData("text/html", copy.innerHTML);
  copy.remove();
  event.preventDefault();
});

// A report of a mistake names the section that is being read.
const report = document.querySelector("a.report-mistake");
report?.addEventListener("click", () => {
  const above = [...document.querySelectorAll(".bd-article :is(h1, h2, h3)")].filter((h) => h.getBoundingClientRect().top < innerHeight / 2);
  const address = new URL(report.href), { searchParams } = address, section = above.at(-1)?.cloneNode(true);
  section?.querySelectorAll(".headerlink").forEach((link) => link.remove());
  searchParams.set("body", searchParams.get("body").replace(/^Section: .*$/m, `Section: ${section?.textContent.trim() ?? ""}`));
  report.href = address;
});

// Close the take-away menu like any menu: by Escape, or by a click elsewhere.
const menu = document.querySelector("details.take-away");
document.addEventListener("click", ({ target }) => menu?.contains(target) || menu?.removeAttribute("open"));
menu?.addEventListener("keydown", (event) => {
  if (event.key !== "Escape" || !menu.open) return;
  menu.open = false;
  menu.querySelector("summary").focus();
});

// Numbers in columns and lines of code keep their lines: on a narrow screen they scroll. Same as in live/js/output.js.
for (const text of document.querySelectorAll("div.cell_output .output pre"))
  text.classList.toggle("columns", Boolean(text.closest(".text_plain")) || /^ *\[|^ {4}|\S {2,}\S/m.test(text.textContent));

// Hide the result of a check that nobody has answered yet, which the dots in its cell show.
for (const output of document.querySelectorAll("div.cell_output > .output"))
  output.hidden = /^\s*…\s*Not attempted/.test(output.textContent);

// On a narrow screen the contents of the page lie over it: close them when the reader follows one of their links.
document.addEventListener("click", ({ target }) => target.closest("dialog a[href^='#']")?.closest("dialog").close());

document.querySelector("button.print-page")?.addEventListener("click", () => print());
// Paper is white: print in the colours for a light page.
addEventListener("beforeprint", () => {
  const { dataset } = document.documentElement, { theme } = dataset;
  addEventListener("afterprint", () => { dataset.theme = theme; }, { once: true });
  dataset.theme = "light";
});

// The theme restores the scroll position of the contents from the page before; show the entry of this page.
{
  const entry = document.querySelector(".bd-sidebar-primary li.current > a.current");
  const side = entry?.closest(".bd-sidebar-primary");
  if (entry) addEventListener("load", () => {
    const [box, line] = [side.getBoundingClientRect(), entry.getBoundingClientRect()];
    if (line.top < box.top || line.bottom > Math.min(box.bottom, innerHeight)) side.scrollTop += line.top - box.top - side.clientHeight / 3;
  });
}

// Load the search when its field gets the focus or, in a window without focus, a text, and the lecture when it starts. No
// single key does either, as dictation, or typing outside a text field, would do so. Ctrl+K is the theme's.
{
  const load = (name, onload) => {
    const link = document.querySelector(`link[rel='${name}-script']`);
    const onerror = () => document.head.append(link); // requests it again if it failed
    if (link) document.head.append(Object.assign(document.createElement("script"), { src: link.href, onload, onerror }));
    link?.remove(); // once
  };
  const lecture = document.querySelector("button.lecture-mode");
  for (const act of ["focusin", "input"]) document.addEventListener(act, ({ target }) => target.closest("form.bd-search") && load("search"));
  lecture?.addEventListener("click", () => load("lecture", () => lecture.click()));
  if (lecture && history.state?.lecture !== undefined) figuresRan.then(() => lecture.click()); // it was reloaded
  if (document.querySelector("form.bd-search:not(dialog form)")) load("search");
}
