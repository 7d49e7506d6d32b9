"""The built site in a real browser, page by page."""

import gzip
import json
import re
from functools import cache
from urllib.parse import unquote, urldefrag, urljoin

import pytest
from bs4 import BeautifulSoup
from conftest import HTML, REPOSITORY, html_pages

PAGES = html_pages()
THEMES = ("light", "dark")
WIDE, NARROW = {"width": 1300, "height": 900}, {"width": 380, "height": 760}
HEAVIEST = 450_000  # bytes over the wire, compressed
LARGEST_SHIFT = 0.001

WATCH_SHIFTS = """
window.shift = 0;
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) window.shift += entry.value;
}).observe({type: "layout-shift", buffered: true});
"""
# The words of a page without its mathematics and code.
WORDS = """() => {
  const article = document.querySelector("article, .bd-search-container").cloneNode(true);
  article.querySelectorAll(".katex, pre, code, script, style, svg").forEach((e) => e.remove());
  return article.textContent;
}"""
SIDEWAYS = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"


@cache
def axe_source():
    return (REPOSITORY / "node_modules" / "axe-core" / "axe.min.js").read_text("utf8")


@cache
def parsed(page):
    return BeautifulSoup((HTML / page).read_text("utf8"), "html.parser")


def violations(page):
    """What axe finds wrong, one line for each kind, with the first element."""
    page.evaluate(axe_source())
    found = page.evaluate("async () => (await axe.run(document, {resultTypes: ['violations']})).violations")
    return [f"{v['id']}: {v['help']} ({len(v['nodes'])}): {v['nodes'][0]['html'][:200]}" for v in found]


class Visit:
    """A page opened in the browser, with everything it said and asked for."""

    def __init__(self, browser, site, name, theme, viewport):
        self.context = browser.new_context(color_scheme=theme, viewport=viewport)
        self.context.add_init_script(WATCH_SHIFTS)
        self.page = self.context.new_page()
        self.faults, self.bytes = [], {}
        self.site = site
        self.page.on("console", lambda m: m.type == "error" and self.faults.append(m.text))
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("requestfailed", lambda r: self.faults.append(f"failed: {r.url}"))
        self.page.on("request", self.note_request)
        self.page.on("requestfinished", self.note_size)
        self.page.goto(site + name)
        self.page.wait_for_load_state("networkidle")
        self.page.wait_for_function("!document.documentElement.classList.contains('settling')")

    def note_request(self, request):
        if not request.url.startswith((self.site, "data:", "blob:")):
            self.faults.append(f"leaves the site: {request.url}")

    def note_size(self, request):
        response = request.response()
        if request.url.startswith("data:"):
            return
        if response.status >= 400:
            self.faults.append(f"{response.status}: {request.url}")
        self.bytes[request.url] = len(gzip.compress(response.body(), 6))

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.context.close()


def test_there_are_pages():
    assert "index.html" in PAGES and any(name.startswith("chapters/") for name in PAGES)


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("name", PAGES)
def test_page(browser, site, name, theme):
    with Visit(browser, site, name, theme, WIDE) as visit:
        page = visit.page
        assert page.evaluate("document.documentElement.dataset.theme") == theme
        assert page.evaluate("window.shift") < LARGEST_SHIFT
        assert page.evaluate(SIDEWAYS) <= 0
        assert violations(page) == []
        assert sum(visit.bytes.values()) <= HEAVIEST, visit.bytes
        assert visit.faults == []


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("name", PAGES)
def test_page_on_a_narrow_screen(browser, site, name, theme):
    with Visit(browser, site, name, theme, NARROW) as visit:
        page = visit.page
        assert page.evaluate("window.shift") < LARGEST_SHIFT
        assert page.evaluate(SIDEWAYS) <= 0, "the page scrolls sideways"
        assert violations(page) == []
        assert visit.faults == []


@pytest.mark.parametrize("name", PAGES)
def test_mathematics_is_typeset(name):
    soup = BeautifulSoup((HTML / name).read_text("utf8"), "html.parser")
    for formula in soup.select(".katex"):
        assert formula.select_one("math"), "no MathML for screen readers"
        assert formula.select_one('.katex-html[aria-hidden="true"]')
    assert not soup.select(".bad-tex, .katex-error, mjx-container")
    article = soup.select_one("article, .bd-search-container")
    for element in article.select(".katex, pre, code, script, style, svg"):
        element.extract()
    raw = re.search(r"\$\S[^$]*\$|\\(?:begin|frac|hat|mathbf|left|theta|psi)\b", article.get_text())
    assert raw is None, f"raw TeX: {raw[0]}"
    if name.startswith("chapters/"):
        assert "katex" in (HTML / name).read_text("utf8")


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_somewhere(name):
    for link in parsed(name).select("[href], [src]"):
        address = link.get("href") or link.get("src")
        if re.match(r"(https?|mailto|data|javascript):", address):
            continue
        path, fragment = urldefrag(unquote(urljoin(f"/{name}", address)))
        target = HTML / path.split("?")[0].lstrip("/")
        assert target.is_file(), address
        if fragment and target.suffix == ".html":
            page = str(target.relative_to(HTML))
            assert parsed(page).find(id=fragment), f"no place called {fragment} on {page}"


def test_theme_switch(browser, site):
    with Visit(browser, site, "index.html", "light", WIDE) as visit:
        page = visit.page
        seen = []
        for _ in range(3):
            page.click(".theme-switch-button")
            seen.append(page.evaluate("[document.documentElement.dataset.mode, getComputedStyle(document.body).backgroundColor]"))
        assert {mode for mode, _ in seen} == {"auto", "light", "dark"}
        colours = dict(seen)
        assert colours["dark"] != colours["light"] == colours["auto"]


def test_theme_stays_on_the_next_page(browser, site):
    with Visit(browser, site, "index.html", "light", WIDE) as visit:
        visit.page.click(".theme-switch-button")
        visit.page.goto(site + "search.html")
        assert visit.page.evaluate("document.documentElement.dataset.theme") == "dark"


def test_search(browser, site):
    chapter = next(name for name in PAGES if name.startswith("chapters/"))
    title = parsed(chapter).select_one("h1").find(string=True, recursive=False).strip()
    word = max(title.split(), key=len)
    with Visit(browser, site, "index.html", "light", WIDE) as visit:
        page = visit.page
        page.keyboard.press("Control+k")
        page.keyboard.type(word)
        page.keyboard.press("Enter")
        page.wait_for_selector("#search-results .search li a")
        found = page.eval_on_selector_all("#search-results li a", "links => links.map(a => a.href)")
        assert any(chapter in address for address in found)
        page.wait_for_selector("#search-results p.context")
        assert "\\" not in page.inner_text("#search-results")
        assert visit.faults == []
        assert violations(page) == []


def test_wide_boxes_are_reached_by_keyboard(browser, site):
    """Boxes that overflow, and only those, are stops of the Tab key."""
    for name in (name for name in PAGES if name.startswith("chapters/")):
        with Visit(browser, site, name, "light", NARROW) as visit:
            boxes = visit.page.eval_on_selector_all(
                ".math-box", "all => all.map(b => [b.scrollWidth > b.clientWidth + 1, b.tabIndex === 0])"
            )
            assert all(overflows == focusable for overflows, focusable in boxes)


def test_take_away_menu(browser, site):
    chapters = [name for name in PAGES if name.startswith("chapters/")]
    with Visit(browser, site, chapters[0], "light", WIDE) as visit:
        page = visit.page
        page.click("details.take-away summary")
        with page.expect_download() as download:
            page.click("details.take-away a >> nth=0")
        notebook = json.loads(download.value.path().read_text("utf8"))
        assert any(cell["cell_type"] == "markdown" for cell in notebook["cells"])
        page.keyboard.press("Escape")
        assert not page.is_visible("details.take-away ul")
    for name in chapters:
        links = [a["href"] for a in parsed(name).select("details.take-away a")]
        assert [link.rpartition(".")[2] for link in links] == ["ipynb", "py", "whl"]


def test_nothing_in_the_site_is_idle():
    """Every file of _static is named by a page, a style sheet or a script."""
    texts = [path.read_text("utf8") for path in HTML.rglob("*") if path.suffix in (".html", ".css", ".js")]
    everything = "\n".join(texts)
    idle = [p.name for p in (HTML / "_static").rglob("*") if p.is_file() and p.name not in everything]
    assert idle == []
