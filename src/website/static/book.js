// Boxes that scroll sideways can be reached by keyboard, but only while they overflow.
const boxes = document.querySelectorAll(".math-box, figure.orientation-figure");
const watch = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    if (target.scrollWidth > target.clientWidth + 1) {
      target.tabIndex = 0;
      target.setAttribute("role", "group");
      target.setAttribute("aria-label", target.className === "math-box" ? "Wide equation" : "Wide figure");
    } else {
      for (const name of ["tabindex", "role", "aria-label"]) target.removeAttribute(name);
    }
  }
});
for (const box of boxes) watch.observe(box);
window.watchWidth = (box) => watch.observe(box); // for what a page puts out later

// Who reports a mistake tells where: the section that is being read.
const report = document.querySelector("a.report-mistake");
report?.addEventListener("click", () => {
  const above = [...document.querySelectorAll(".bd-article :is(h1, h2, h3)")].filter((h) => h.getBoundingClientRect().top < innerHeight / 2);
  const address = new URL(report.href);
  const section = above.at(-1)?.cloneNode(true);
  section?.querySelectorAll(".headerlink").forEach((link) => link.remove());
  const body = address.searchParams.get("body").replace(/^Section: .*$/m, `Section: ${section?.textContent.trim() ?? ""}`);
  address.searchParams.set("body", body);
  report.href = address;
});

// The take-away menu closes like any menu: by Escape, or by a press elsewhere.
const menu = document.querySelector("details.take-away");
if (menu) {
  document.addEventListener("click", (event) => {
    if (!menu.contains(event.target)) menu.open = false;
  });
  menu.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && menu.open) {
      menu.open = false;
      menu.querySelector("summary").focus();
    }
  });
}

document.querySelector("button.print-page")?.addEventListener("click", () => print());

// A page opened from disk may not read other pages: the search then shows titles alone.
if (location.protocol === "file:" && typeof DOCUMENTATION_OPTIONS !== "undefined") {
  DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;
}
