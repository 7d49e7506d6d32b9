"""The built site in a real browser, page by page."""

import gzip
import io
import json
import os
import random
import re
import zipfile
from contextlib import suppress
from functools import cache
from html import unescape
from urllib.parse import unquote, urldefrag, urljoin, urlsplit

import numpy as np
import pytest
from nbconvert import ScriptExporter
from PIL import Image
from places import HTML, REPOSITORY, every_day, html_pages
from playwright.sync_api import TimeoutError

import orientation_recordings as recordings
from notebook_pages import fonts, mathematics
from notebook_pages.lighten import lighten

PAGES = html_pages()
# Representative pages: one with text, formulas and a figure, and one with questions and their
# drawings.
EVERY_DAY = ("chapters/reference-frames.html", "exercises/other-descriptions.html")
WIDE, NARROW = {"width": 1300, "height": 900}, {"width": 380, "height": 760}
NARROWEST = {"width": 320, "height": 640}  # a wide page at four times its size: WCAG 2.2, 1.4.10
HEAVIEST = 450_000  # bytes over the wire, compressed
HEAVIEST_PAGE, ESSAY = 372_000, 100_000  # bytes of the page itself, on the disk
LARGEST_SHIFT = 0.001
# Bytes of a page's head and of its style sheets.
MOST_AWAITED, MOST_AWAITED_PACKED = (100_500, 23_500)

WATCH_SHIFTS = """
window.shift = 0;
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) window.shift += entry.value;
}).observe({type: "layout-shift", buffered: true});
"""
# The faults of a page's mathematics: not typeset, not spoken, or left as TeX.
MATHEMATICS = r"""() => {
  const faults = [];
  for (const formula of document.querySelectorAll(".katex")) {
    if (!formula.querySelector("math")) faults.push("no MathML: " + formula.textContent);
    if (!formula.querySelector(':scope > i[aria-hidden="true"]')) faults.push("spoken twice: " + formula.textContent);
  }
  for (const bad of document.querySelectorAll(".bad-tex, .katex-error, mjx-container")) faults.push(bad.outerHTML);
  const words = document.querySelector("article, .bd-search-container").cloneNode(true);
  words.querySelectorAll(".katex, pre, code, script, style, svg, textarea").forEach((element) => element.remove());
  const raw = words.textContent.match(/\$\S[^$]*\$|\\(?:begin|frac|hat|mathbf|left|theta|psi)\b/);
  if (raw) faults.push("raw TeX: " + raw[0]);
  return faults;
}"""
# Content beyond the edge of a box that scrolls or clips, which readers overlook.
HIDDEN = """() => [...document.querySelectorAll(".bd-article *")].filter((box) => box.clientWidth
  && getComputedStyle(box).overflowX !== "visible" && box.scrollWidth > box.clientWidth + 1
  && !box.closest("svg, input, select, textarea, .katex > :first-child, .unseen")).map((box) =>
  `${box.className} hides ${box.scrollWidth - box.clientWidth} px: ${box.textContent.trim().slice(0, 80)}`)"""
# A box that scrolls sideways shows it by a shadow at the edge.
WITHOUT_SHADOW = """() => [...document.querySelectorAll(".bd-article *")].filter((box) => box.clientWidth
  && ["auto", "scroll"].includes(getComputedStyle(box).overflowX) && box.scrollWidth > box.clientWidth + 1
  && !getComputedStyle(box).backgroundImage.includes("gradient") && !box.closest("textarea")).map((box) =>
  `${box.tagName}.${box.className}: ${box.textContent.trim().slice(0, 80)}`)"""
# Punctuation or brackets after a formula, or in the call of a function, at the beginning of a line.
STRAY = """() => [...document.querySelectorAll(".bd-article :is(.katex, .sig-param)")].filter((formula) => {
  const after = formula.nextSibling?.firstChild ?? formula.nextSibling, last = [...formula.getClientRects()].at(-1);
  if (after?.nodeType !== Node.TEXT_NODE || !/^(?:[.,;:!?)]|['’]s)/.test(after.data) || !last?.width) return false;
  const range = document.createRange();
  range.setStart(after, 0);
  range.setEnd(after, 1);
  return range.getBoundingClientRect().left < last.left;
}).map((formula) => (formula.querySelector("math") ?? formula).textContent)"""
# Rules that the page's scripts add, and that the page needs before them, or that name a file, which
# would be looked up beside the page.
TOO_LATE = r"""async () => {
  const page = new DOMParser().parseFromString(await (await fetch(location.href)).text(), "text/html");
  const flat = (rules) => [...rules].flatMap((rule) => rule.selectorText ? [rule] : flat(rule.cssRules ?? []));
  const brought = [...document.querySelectorAll("head > style:not(:first-of-type)")].flatMap(({ sheet }) => flat(sheet.cssRules));
  const whenever = (selector) => selector.replace(/:not\([^()]*\)/g, "").replace(/::?[a-z-]+(?![a-z(-])/g, ":where(*)");
  const late = ({ selectorText, cssText }) => page.querySelector(whenever(selectorText)) || /url\("(?!data:)/.test(cssText);
  return brought.length ? brought.filter(late).map(({ cssText }) => cssText) : ["nothing is brought"];
}"""
SIDEWAYS = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"


@cache
def axe_source():
    return (REPOSITORY / "node_modules" / "axe-core" / "axe.min.js").read_text("utf8")


@cache
def text(page):
    return (HTML / page).read_text("utf8")


def violations(page, where="document"):
    """Return the faults that axe finds, one line for each kind, with the first element."""
    page.evaluate(axe_source())
    faults = page.evaluate(
        f"async () => (await axe.run({where}, {{resultTypes: ['violations']}})).violations"
    )
    return [
        f"{v['id']}: {v['help']} ({len(v['nodes'])}): {v['nodes'][0]['html'][:200]}" for v in faults
    ]


class Visit:
    """A page opened in the browser, with its messages and requests."""

    def __init__(self, browser, site, name, theme, viewport):
        # The page's own policy is in force: violations are errors on the console.
        self.context = browser.new_context(color_scheme=theme, viewport=viewport, bypass_csp=False)
        self.context.add_init_script(WATCH_SHIFTS)
        self.page = self.context.new_page()
        self.faults, self.fetched = [], set()
        self.site = site
        self.page.on("console", lambda m: m.type == "error" and self.faults.append(m.text))
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("requestfailed", self.note_failure)
        self.page.on("request", self.note_request)
        self.page.on("requestfinished", self.note_response)
        self.page.goto(site + name)
        # The page is loaded. Idleness is not always reported after many simultaneous requests.
        with suppress(TimeoutError):
            self.page.wait_for_load_state("networkidle", timeout=20_000)
        self.page.wait_for_selector("html:not(.settling, .in-parts)")
        if self.page.evaluate("document.documentElement.dataset.typefaces === 'late'"):
            # On a busy machine, they are in the browser's cache now, as on a reader's second page.
            self.page.reload()
            self.page.wait_for_selector("html:not(.settling, .in-parts)")
            self.page.evaluate("document.fonts.ready.then(() => true)")

    def note_failure(self, request):
        # Leaving a page cuts off what it still fetches, which is no fault of the page or its server.
        if request.failure != "net::ERR_ABORTED":
            self.faults.append(f"failed: {request.url}: {request.failure}")

    def shift(self):
        """Return how far lines moved, without the change of typefaces that came late again."""
        return self.page.evaluate(
            "document.documentElement.dataset.typefaces === 'late' ? 0 : window.shift"
        )

    def note_request(self, request):
        if not request.url.startswith((self.site, "data:", "blob:")):
            self.faults.append(f"leaves the site: {request.url}")

    def note_response(self, request):
        if request.url.startswith("data:"):
            return
        self.fetched.add(request.url)
        if (status := request.response().status) >= 400:
            self.faults.append(f"{status}: {request.url}")

    def weights(self):
        """Return the bytes over the wire, by path; of the files, as a reload takes what came."""
        return {
            path: len(gzip.compress((HTML / unquote(path)).read_bytes(), 6))
            for path in {
                urlsplit(url).path[1:] for url in self.fetched if url.startswith(self.site)
            }
        }

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.context.close()


@pytest.mark.parametrize("name", every_day(PAGES, *EVERY_DAY))
def test_page_in_light_and_wide(browser, site, name):
    with Visit(browser, site, name, "light", WIDE) as visit:
        page = visit.page
        assert page.evaluate("document.documentElement.dataset.theme") == "light"
        assert visit.shift() < LARGEST_SHIFT
        assert page.evaluate(TOO_LATE) == []
        assert page.evaluate(MATHEMATICS) == []
        assert bool(page.query_selector(".katex")) or not name.startswith("chapters/")
        assert violations(page) == []
        assert page.evaluate(SIDEWAYS) <= 0, "the page scrolls sideways"
        page.evaluate(
            "document.querySelectorAll('article details').forEach((details) => { details.open = "
            "true; })"
        )
        assert page.evaluate(HIDDEN) == []
        page.set_viewport_size(NARROW)
        assert page.evaluate(SIDEWAYS) <= 0, "the narrow page scrolls sideways"
        page.set_viewport_size(NARROWEST)
        assert page.evaluate(SIDEWAYS) <= 0, "the page of 320 pixels scrolls sideways"
        assert page.evaluate(STRAY) == [], "lines that begin with a full stop"
        weights = visit.weights()
        assert sum(weights.values()) <= HEAVIEST, weights
        assert visit.faults == []


@pytest.mark.parametrize("name", every_day(PAGES, *EVERY_DAY))
def test_page_in_dark_and_narrow(browser, site, name):
    with Visit(browser, site, name, "dark", NARROW) as visit:
        page = visit.page
        assert page.evaluate("document.documentElement.dataset.theme") == "dark"
        assert visit.shift() < LARGEST_SHIFT
        assert page.evaluate(SIDEWAYS) <= 0, "the page scrolls sideways"
        assert page.eval_on_selector_all(
            ".math-box",
            "all => all.every(b => b.scrollWidth > b.clientWidth + 1 === (b.tabIndex === 0))",
        ), "only wide boxes are stops of the Tab key"
        assert page.evaluate(WITHOUT_SHADOW) == []
        # The thousands of elements of formulas have the colour of the text around them, and were
        # checked on the wide pages.
        page.evaluate(
            "document.querySelectorAll('.katex > [aria-hidden] > *').forEach((element) => "
            "element.remove())"
        )
        assert violations(page) == []
        # The wide page has more around the text.
        page.set_viewport_size(WIDE)
        assert violations(page, "{exclude: ['article']}") == []
        assert visit.faults == []


def test_widths_of_windows_are_counted_in_letters():
    """Whoever reads with larger letters has room for fewer columns; scripts have to agree."""
    for path in [*HTML.glob("_static/*.css"), *HTML.glob("_static/page*.js")]:
        assert not re.search(r"-width: ?[\d.]+px\)", path.read_text("utf8")), path


def test_little_is_awaited_before_the_first_line_is_seen():
    """On a slow telephone the head and its styles determine the first view."""
    styles, weights = {}, {}
    for name in PAGES:
        head = text(name).partition("<body")[0]
        sheets = re.findall(r'<link rel="stylesheet" href="([^"?]*)', head)
        assert sheets, name
        for address in sheets:
            path = (HTML / name).parent / address
            styles.setdefault(path, (path.stat().st_size, len(gzip.compress(path.read_bytes(), 6))))
        sizes = [
            (len(head), len(gzip.compress(head.encode(), 6))),
            *(styles[(HTML / name).parent / a] for a in sheets),
        ]
        weights[name] = [sum(column) for column in zip(*sizes)]
    assert max(plain for plain, _ in weights.values()) < MOST_AWAITED, weights
    assert max(packed for _, packed in weights.values()) < MOST_AWAITED_PACKED, weights
    assert not any("base64" in path.read_text("utf8") for path in styles), (
        "what is inside a style sheet is awaited"
    )


@pytest.mark.parametrize(
    ("name", "uses_few"),
    [("chapters/unit-quaternions.html", False), ("chapters/angular-velocity.html", True)],
)
def test_typefaces_of_the_first_view_are_asked_for_at_once_and_the_others_after_it(
    browser, site, name, uses_few
):
    """The typefaces in the head are those of the first view, so that none comes after the others.

    This is checked twice, without a clock: while the script that lays out the rest is held back,
    the typefaces in use are those named; when it arrives, the others are requested after these.
    """
    named = set(re.findall(r'<link rel="preload" as="font"[^>]* href="\.\./([^"]*)"', text(name)))
    assert len(named) > 3

    def asked(page):
        page.wait_for_selector("html:not(.settling) main", state="attached")
        page.evaluate("new Promise((drawn) => requestAnimationFrame(() => setTimeout(drawn)))")
        page.evaluate("document.fonts.ready.then(() => true)")
        return [
            address.removeprefix(site)
            for address in page.evaluate(
                "performance.getEntriesByType('resource').map(({ name }) => name)"
            )
            if address.endswith(".woff2")
        ]

    page = browser.new_page(viewport=WIDE)
    # Held, not refused: a document that has ended before its first frame is laid out as a whole.
    held = []
    page.route("**/_static/page-*.js*", lambda route: held.append(route))
    page.goto(site + name, wait_until="commit")
    first = asked(page)
    for route in held:
        route.abort()
    page.close()
    with Visit(browser, site, name, "light", WIDE) as visit:
        fetched = asked(visit.page)
    # On a busy machine, Chromium rarely requests one more file, of which the first view needs nothing.
    assert len(first) <= len(named) + 1, (first, named)
    assert named <= set(first) & set(fetched[: len(named) + 1]), (first, fetched)
    # The browser decides when to lay out the rest, which may need rarer characters.
    assert len(fetched) > len(named) or uses_few, fetched
    assert not any(
        "KaTeX" in address
        for address in re.findall(r'<link rel="preload"[^>]*', text("search.html"))
    )


def test_reduced_typefaces_have_every_character_of_the_formulas():
    """A character that only the whole typeface has makes the page lay out all formulas twice."""
    reduced = set(fonts.codes(f"{fonts.FORMULAS},{fonts.GREEK}"))
    for name in PAGES:
        drawn = "".join(re.findall(r"<i aria-hidden=true>(.*?)</span>", text(name), re.DOTALL))
        assert set(map(ord, unescape(re.sub("<[^>]*>", "", drawn)))) <= reduced, name


def test_no_page_is_heavy():
    weights = {name: (HTML / name).stat().st_size for name in PAGES}
    assert weights.pop("rotations.html") < ESSAY
    assert {name: weight for name, weight in weights.items() if weight > HEAVIEST_PAGE} == {}


def test_what_programs_and_plots_repeat_is_said_in_few_words():
    body = '<span class="doc">a link</span><pre><span class="k">def</span> <span class="n">f</span></pre>'
    assert lighten(body) == '<span class="doc">a link</span><pre><i class=k>def</i> f</pre>'
    line = '<path d="M0 0l9 9" style="stroke:red"/>'
    plot = lighten(f'<svg aria-label="a > b">{line * 3}</svg>')
    assert plot.startswith('<svg aria-label="a > b"><style>.s') and plot.count("stroke:red") == 1
    assert len(set(re.findall(r'class="(s\w+)"', plot))) == 1 and plot.count("class=") == 3
    assert lighten(f"<svg>{line * 2}</svg>") == f"<svg>{line * 2}</svg>"
    assert lighten(
        '<svg><path d="M10 0L-2.26 0.04C0 1 2 3 4 5Z"/><g transform="translate(-0.54 3.06)"/></svg>'
    ) == (
        '<svg><path d="m10 0-12.3 0c2.3 1 4.3 3 6.3 5z"/><g transform="translate(-.5 3.1)"/></svg>'
    )
    words = "".join(f'<span class="{name}">1</span>' for name in ("sa", "s1", "mi"))
    assert lighten(f"<pre>{words}</pre>") == "<pre><i class=s>11</i><i class=m>1</i></pre>"


def test_letters_of_drawings_stand_once_on_a_page():
    for name in PAGES:
        for part in (r' d="(m[^"]*q[^"]{60,}z)"', r'<path id="(o\d+)"'):
            outlines = re.findall(part, text(name))
            assert len(outlines) == len(set(outlines)), name
        shown = re.findall(r'<use [^>]*href="#([^"]*)"', text(name))
        assert set(shown).issubset(re.findall(r'\bid="([^"]*)"', text(name))), name


# Show formulas, and return where each letter is, from the corner of its box.
LETTERS = """async (html) => {
  document.body.innerHTML = html;
  // The boxes are laid out once, so that their typefaces are asked for.
  const aMoment = () => new Promise((done) => setTimeout(done, 100));
  do await aMoment(); while (document.body.offsetHeight && document.fonts.status === "loading");
  return [...document.querySelectorAll("p")].map((box) => {
    const from = box.getBoundingClientRect(), found = [["box", from.height, 0]];
    const walker = document.createTreeWalker(box.querySelector("[aria-hidden]"), NodeFilter.SHOW_TEXT);
    for (let node; (node = walker.nextNode());)
      for (let place = 0; place < node.length; place++) {
        if (node.data[place] === "\u200b") continue;
        const range = document.createRange();
        range.setStart(node, place);
        range.setEnd(node, place + 1);
        const at = range.getBoundingClientRect();
        found.push([node.data[place], at.left - from.left, at.top - from.top]);
      }
    return found;
  });
}"""


def written_cells():
    """Iterate over the text of the chapters' cells."""
    for path in sorted((REPOSITORY / "chapters").glob("*.ipynb")):
        for cell in json.loads(path.read_text("utf8"))["cells"]:
            if cell["cell_type"] == "markdown":
                yield "".join(cell["source"])


def stand_as_katex_sets_them(run, within=1):
    """Compare our shorter HTML of formulas, letter by letter, with KaTeX's own.

    ``run`` runs a function in a page.
    """
    # The pages do not contain the TeX of formulas within a line; the chapters' cells do.
    formulas = sorted(
        {unescape(tex) for name in PAGES for tex in re.findall(r' data-tex="([^"]*)"', text(name))}
        | {
            tex
            for cell in written_cells()
            for tex in re.findall(r"(?<![$\\`])\$([^$\n]+)\$(?!\$)", cell)
        }
    )
    chosen = random.Random(0).sample(formulas, 60)
    own = [mathematics.katex(os.getpid())(tex, False, "1.15")["html"] for tex in chosen]
    light = [mathematics.lighten(html, tex) for html, tex in zip(own, chosen, strict=True)]
    styles = re.sub(
        r"@font-face\s*\{[^}]*\}", "", mathematics.KATEX.with_name("katex.css").read_text("utf8")
    )
    places = []
    for style, formulas in ((styles, own), ("", light)):
        # Each stands in one line, however wide.
        lines = "".join(f'<p style="width: 4000px">{html}</p>' for html in formulas)
        places.append(
            run(LETTERS, f"<style>{style} .katex {{ font-size: 1.08em; }}</style>{lines}")
        )
    for tex, before, after in zip(chosen, *places, strict=True):
        assert [letter for letter, *_ in before] == [letter for letter, *_ in after], tex
        apart = max(
            abs(a - b)
            for before_letter, after_letter in zip(before, after, strict=True)
            for a, b in zip(before_letter[1:], after_letter[1:], strict=True)
        )
        assert apart < within, (tex, apart)


def test_light_formulas_stand_as_katex_sets_them(browser, site):
    with browser.new_page(viewport=WIDE) as page:
        page.goto(f"{site}/index.html")
        stand_as_katex_sets_them(page.evaluate)


def test_a_formula_is_as_wide_in_the_list_of_sections_as_in_its_heading(browser, site):
    page = browser.new_page(viewport=WIDE)
    page.goto(f"{site}chapters/unit-quaternions.html")
    width = (
        "(formula) => formula.getBoundingClientRect().width / "
        "parseFloat(getComputedStyle(formula).fontSize)"
    )
    listed, heading = (
        page.locator(f"{place} .katex > i:last-child > i").first.evaluate(width)
        for place in (".page-toc", "h3")
    )
    page.close()
    assert abs(listed - heading) < 0.1


def test_a_box_that_does_not_scroll_has_no_stroke_at_its_edges(browser, site):
    """This includes a box whose left edge is between two pixels."""
    page = browser.new_page(viewport=WIDE, device_scale_factor=2)
    page.goto(f"{site}chapters/orientation-with-sympy.html")
    page.wait_for_selector("html:not(.settling, .in-parts)")
    fits = (
        "(boxes) => boxes.findIndex((box) => box.offsetHeight && box.scrollWidth <= "
        "box.clientWidth)"
    )
    box = page.locator("div.cell_output .math-box").nth(
        page.locator("div.cell_output .math-box").evaluate_all(fits)
    )
    box.scroll_into_view_if_needed()
    strokes = set()
    for shift in (0, 0.25, 0.5):
        box.evaluate("(box, shift) => { box.style.marginInline = `${shift}px`; }", shift)
        at = box.bounding_box()
        line = {"x": int(at["x"]) - 1, "y": at["y"] + at["height"] / 2, "width": 12, "height": 2}
        for x in (line["x"], int(at["x"] + at["width"]) - 10):
            picture = page.screenshot(clip=line | {"x": x})
            colours = np.asarray(Image.open(io.BytesIO(picture)).convert("RGB")).reshape(-1, 3)
            strokes.add(len(np.unique(colours, axis=0)))
    page.close()
    assert strokes == {1}


@pytest.mark.parametrize(
    "name", ["exercises/orientation-from-sensors.html", "appendix/reference-going-further.html"]
)
def test_no_line_begins_with_a_full_stop_however_wide_the_page_is(browser, site, name):
    """Check this after a formula that is long enough to be broken, and in the call of a function."""
    page = browser.new_page(viewport=NARROW)
    page.goto(site + name)
    page.wait_for_selector("html:not(.settling, .in-parts)")
    for width in range(320, 500, 12):
        page.set_viewport_size(NARROW | {"width": width})
        assert page.evaluate(STRAY) == [], width
    page.close()


def test_a_name_in_the_contents_of_the_page_is_broken_behind_its_low_lines(browser, site):
    page = browser.new_page(viewport=WIDE)
    page.goto(f"{site}appendix/reference-going-further.html")
    page.wait_for_selector("html:not(.settling, .in-parts)")
    lines = """(names) => names.map((name) => {
      const range = document.createRange(), texts = document.createTreeWalker(name, NodeFilter.SHOW_TEXT), tops = new Map();
      while (texts.nextNode()) [...texts.currentNode.data].forEach((sign, k) => {
        range.setStart(texts.currentNode, k), range.setEnd(texts.currentNode, k + 1);
        const { top } = range.getBoundingClientRect();
        tops.set(top, (tops.get(top) ?? "") + sign);
      });
      return [...tops.values()];
    })"""
    names = page.locator(".page-toc code").evaluate_all(lines)
    page.close()
    broken = [parts for parts in names if len(parts) > 1 and "_" in "".join(parts)]
    assert broken and all(part.endswith("_") for parts in broken for part in parts[:-1])


@pytest.mark.parametrize("name", PAGES)
def test_links_lead_somewhere(name):
    for address in set(re.findall(r'\s(?:href|src)="([^"]*)"', text(name))):
        if re.match(r"(https?|mailto|data|javascript):", address):
            continue
        path, fragment = urldefrag(unquote(urljoin(f"/{name}", unescape(address))))
        target = HTML / path.split("?")[0].lstrip("/")
        assert target.is_file(), address
        if fragment and target.suffix == ".html":
            page = str(target.relative_to(HTML))
            assert f'id="{fragment}"' in text(page), f"no place called {fragment} on {page}"


def test_theme_switch_holds_on_the_next_page(browser, site):
    with Visit(browser, site, "index.html", "light", WIDE) as visit:
        page = visit.page
        seen = []
        for _ in range(3):
            page.click(".theme-switch-button")
            seen.append(
                page.evaluate(
                    "[document.documentElement.dataset.mode, "
                    "getComputedStyle(document.body).backgroundColor]"
                )
            )
        colours = dict(seen)
        assert set(colours) == {"auto", "light", "dark"}
        assert colours["dark"] != colours["light"] == colours["auto"]
        page.click(".theme-switch-button")
        page.goto(site + "search.html")
        # Paper is white: what is printed has the colours for a light page.
        assert page.evaluate("""['focus', 'beforeprint', 'afterprint'].map((name) => {
          dispatchEvent(new Event(name));
          return document.documentElement.dataset.theme;
        })""") == ["dark", "light", "dark"]


def test_icons_are_seen_in_colours_that_the_system_sets(browser, site):
    context = browser.new_context(viewport=WIDE, forced_colors="active")
    page = context.new_page()
    page.goto(f"{site}exercises/orientation-filters.html")
    page.wait_for_selector("html:not(.settling, .in-parts)")
    colours = page.evaluate("""() => {
      const icons = [...document.querySelectorAll('[class*="fa-"]')].filter((icon) => icon.checkVisibility());
      return [document.body, ...icons].map((element) => getComputedStyle(element).backgroundColor);
    }""")
    assert len(colours) > 6 and colours[0] not in colours[1:]
    context.close()


WITH_RECORDINGS = (
    "chapters/orientation-from-sensors.html",
    "chapters/orientation-filters.html",
    "chapters/cases-from-practice.html",
)


def test_take_away_menu(browser, site):
    chapters = [name for name in PAGES if name.startswith("chapters/")]
    with Visit(browser, site, chapters[0], "light", WIDE) as visit:
        page = visit.page
        page.click("details.take-away summary")
        with page.expect_download() as download:
            page.click("details.take-away a >> nth=0")
        # As `jupyter nbconvert --to script` does it: Python, with the words as comments.
        script, about = ScriptExporter().from_filename(str(download.value.path()))
        assert about["output_extension"] == ".py" and "\n# ## " in script
        page.keyboard.press("Escape")
        assert not page.is_visible("details.take-away ul")
    for name in chapters:
        menu = text(name).partition('<details class="take-away">')[2].partition("</details>")[0]
        data = ["zip"] if name in WITH_RECORDINGS else []
        assert re.findall(r'href="[^"]*\.(\w+)"', menu) == ["ipynb", "py", "zip", *data]
    with zipfile.ZipFile(HTML / "take-away" / "recordings.zip") as archive:
        names = archive.namelist()
        assert "recordings/LICENSE.txt" in names and len(names) == len(set(names))
        leg = np.loadtxt(archive.open("recordings/lower_leg.csv"), delimiter=",", skiprows=1)
    assert np.array_equal(leg, recordings.table("lower_leg"))
    questions = text("exercises/orientation-from-sensors.html")
    assert "recordings.zip" in questions and "recordings.zip" not in text(
        "exercises/euler-angles.html"
    )


def test_nothing_in_the_site_is_idle():
    """Every file of _static is named by a page, a style sheet or a script."""
    kinds = (".html", ".css", ".js", ".webmanifest")
    everything = "\n".join(
        path.read_text("utf8") for path in HTML.rglob("*") if path.suffix in kinds
    )
    # Scripts assemble these names: previews of links, and the languages of formulas.
    made = ("previews/", "formulas-")
    idle = [
        p.name for p in (HTML / "_static").rglob("*") if p.is_file() and p.name not in everything
    ]
    for name in made:
        assert name in everything
    assert [
        name
        for name in idle
        if not (HTML / "_static" / "previews" / name).exists() and not name.startswith(made)
    ] == []


def test_drawings_of_exercises_stand_on_the_papers_colour(browser, site):
    """They are separate pictures, and were once white boxes on a dark page."""
    with Visit(browser, site, "exercises/simple-orientations.html", "dark", WIDE) as visit:
        picture = visit.page.locator(".bd-article img").first
        picture.scroll_into_view_if_needed()
        seen = Image.open(io.BytesIO(picture.screenshot())).convert("RGB")
        paper = visit.page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert seen.getpixel((4, 4)) == tuple(map(int, re.findall(r"\d+", paper)))
        # The drawing is visible on it, in colours between light and dark.
        dark, light = seen.convert("L").getextrema()
        assert light - dark > 100
