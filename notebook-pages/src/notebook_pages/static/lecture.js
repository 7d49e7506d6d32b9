// Lecture mode: the page in steps at the size of a lecture hall, with its figures alive. The key L or the button
// begins and ends it; the arrow keys, PageUp, PageDown and the space bar go from step to step, as speaker's remotes do.
{
  const button = document.querySelector("button.lecture-mode");
  const root = document.documentElement;
  const bar = document.createElement("p");
  bar.className = "lecture-bar";
  bar.setAttribute("role", "status");

  // A step is a heading with what follows it, up to and with a figure, an equation, a cell or a box.
  const SHOWS = "figure, .cell, div.math, .admonition, .question, table, .pst-scrollable-table-container";
  const steps = [];
  const isHeading = (block) => /^H\d$/.test(block.tagName);
  const collect = (parent, around = []) => {
    let step = [];
    const close = () => {
      if (step.length) steps.push([...around, ...step]);
      step = [];
    };
    for (const block of parent.children) {
      if (block.tagName === "SECTION") {
        close();
        collect(block);
      } else if (block.matches(".covered, .uncovered")) {
        // What a prediction covers comes in steps as well, and each is covered until somebody has answered.
        close();
        collect(block, [block]);
      } else if (block.matches(".recap")) {
        // Its questions come one by one; what stands beside them comes with each.
        close();
        for (const question of block.querySelectorAll(":scope > .question")) steps.push([block, question]);
      } else {
        // A figure that is turned needs the height of the screen for itself, and a drawing leaves room for two paragraphs.
        const before = step.filter((one) => !isHeading(one)).length;
        if (block.querySelector(".moving") ? before : block.querySelector("figure") && before > 2) close();
        step.push(block);
        // A heading waits for what follows it.
        if (block.matches(SHOWS) || block.querySelector(":scope > figure")) close();
      }
    }
    close();
  };

  // The height of a drawing, as a share of the window's, and the size of the type: the largest with which the step
  // is seen whole. What does not fit with the last of them is longer than a slide, and is scrolled.
  const SIZES = [[58, 1], [48, 1], [42, 0.9], [38, 0.8], [34, 0.72], [30, 0.72], [30, 0.64]];
  const fit = () => {
    for (const [drawing, type] of SIZES) {
      root.style.setProperty("--lecture-drawing", `${drawing}vh`);
      root.style.setProperty("--lecture-type", type);
      if (root.scrollHeight <= innerHeight) return;
    }
  };

  let now = -1;
  const show = (place) => {
    now = Math.max(0, Math.min(steps.length - 1, place));
    for (const step of steps) for (const block of step) block.classList.remove("in-step");
    // The heading that the step stands under is shown with it.
    const heading = steps[now][0].closest("section")?.querySelector(":scope > :is(h1, h2, h3)");
    for (const block of [...steps[now], ...(heading ? [heading] : [])]) block.classList.add("in-step");
    bar.textContent = `${now + 1} of ${steps.length}`;
    scrollTo(0, 0);
    fit();
    dispatchEvent(new Event("resize"));
  };
  const begin = () => {
    root.classList.remove("in-parts"); // steps are measured
    if (!steps.length) collect(document.querySelector(".bd-article > section"));
    // Begin with what the reader was looking at.
    const at = steps.findIndex((step) => step.at(-1).getBoundingClientRect().bottom > 80);
    root.classList.add("lecture");
    button.setAttribute("aria-pressed", "true");
    document.body.append(bar);
    show(Math.max(at, 0));
  };
  const end = () => {
    root.classList.remove("lecture");
    button.setAttribute("aria-pressed", "false");
    bar.remove();
    // The box round what was covered has no place of its own.
    steps[now]?.find((block) => block.getBoundingClientRect().height)?.scrollIntoView();
  };
  const toggle = () => (root.classList.contains("lecture") ? end() : begin());
  button.addEventListener("click", toggle);
  document.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    // Whoever is typing, moving a figure or choosing an answer needs these keys.
    if (event.target.closest("input, textarea, select, [contenteditable], .sheet, .cm-editor, [role=slider], .number, dialog")) return;
    if (event.key === "l" || event.key === "L") return toggle();
    if (!root.classList.contains("lecture")) return;
    const onButton = event.key === " " && event.target.closest("button, summary, a");
    const go = { ArrowRight: 1, ArrowDown: 1, PageDown: 1, " ": 1, ArrowLeft: -1, ArrowUp: -1, PageUp: -1, Home: -steps.length, End: steps.length }[event.key];
    if (event.key === "Escape") return end();
    if (!go || onButton) return;
    event.preventDefault();
    show(now + go);
  });
}
