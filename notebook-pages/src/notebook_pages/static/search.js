{
  // Excerpts on the search page show the text only, and each formula once.
  const toText = Search.htmlToText;
  Search.htmlToText = (html, anchor) => {
    const page = new DOMParser().parseFromString(html, "text/html");
    const skipped = ".katex-mathml, .bd-header-article, .bd-sidebar-secondary, footer";
    page.querySelectorAll(skipped).forEach((element) => element.remove());
    return toText(page.documentElement.outerHTML, anchor);
  };
}
