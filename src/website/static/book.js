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

// A page opened from disk may not read other pages: the search then shows titles alone.
if (location.protocol === "file:" && typeof DOCUMENTATION_OPTIONS !== "undefined") {
  DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;
}

// Excerpts on the search page show the text only, and each formula once.
if (typeof Search !== "undefined") {
  const toText = Search.htmlToText;
  Search.htmlToText = (html, anchor) => {
    const page = new DOMParser().parseFromString(html, "text/html");
    const skipped = ".katex-mathml, .bd-header-article, .bd-sidebar-secondary, footer";
    page.querySelectorAll(skipped).forEach((element) => element.remove());
    return toText(page.documentElement.outerHTML, anchor);
  };
}
