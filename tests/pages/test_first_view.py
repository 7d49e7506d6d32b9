"""The first view of a page is shown before the rest is laid out, and nothing is lost by this."""

import re

import pytest
from places import HTML, html_pages

from notebook_pages.first_view import MARKED

LONG = "chapters/unit-quaternions.html"
SIZES = {"wide": {"width": 1300, "height": 900}, "narrow": {"width": 380, "height": 760}}
SCRIPT = re.compile(r'<script[^>]* src="([^"?]*)')
FIGURES = re.compile(r'<link rel="figure-script" href="([^"?]*)')
# The largest number of scripts: of the page itself, of its figures (the shared one, and each kind),
# of its code.
SCRIPTS = 1 + 2 + 2 + 1
# The blocks below are not laid out until the test allows it.
HOLD = "window.held = []; window.requestIdleCallback = (action) => held.push(action);"
# The frames after the first view are drawn when the test allows it.
HOLD_FRAMES = """
window.held = [];
const draw = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = (action) => document.documentElement.matches(".settling") ? draw(action) : held.push(action);
window.release = () => { window.requestAnimationFrame = draw; held.splice(0).forEach((action) => draw(action)); };
"""
# The top of each block of the text.
PLACES = """() => [...document.querySelectorAll('.bd-article section > *')].map(
  (block) => Math.round(block.getBoundingClientRect().top + scrollY))"""
# The elements that a script measured although they are not laid out: measuring lays them out.
MEASURED = """
window.measured = [];
const isLeftAlone = (element) => document.documentElement.matches(".settling, .in-parts") && element.closest(".later")
  && !element.checkVisibility({ contentVisibilityAuto: true });
const note = (element) => !window.mayMeasure && isLeftAlone(element) && measured.push(element.outerHTML.slice(0, 100));
for (const name of ["getBoundingClientRect", "getClientRects"]) {
  const own = Element.prototype[name];
  Element.prototype[name] = function () { note(this); return own.call(this); };
}
for (const [kind, names] of [[Element, ["scrollWidth", "scrollHeight", "clientWidth", "clientHeight"]],
                             [HTMLElement, ["offsetWidth", "offsetHeight", "offsetTop"]]])
  for (const name of names) {
    const { get } = Object.getOwnPropertyDescriptor(kind.prototype, name);
    Object.defineProperty(kind.prototype, name, { get() { note(this); return get.call(this); } });
  }
"""
IS_SHOWN = "(block) => block.firstElementChild.checkVisibility({ contentVisibilityAuto: true })"


@pytest.fixture
def open_page(browser, site):
    contexts = []

    def opened(name, size="wide", script="", **options):
        contexts.append(browser.new_context(viewport=SIZES[size], **options))
        page = contexts[-1].new_page()
        page.add_init_script(script)
        page.goto(site + name)
        page.wait_for_selector("html:not(.settling)")
        return page

    yield opened
    for context in contexts:
        context.close()


def whole(page):
    page.wait_for_selector("html:not(.in-parts)")
    page.wait_for_function("document.fonts.status === 'loaded'")
    return page


def test_long_pages_are_marked_and_short_ones_are_not():
    marked = {name: len(MARKED.findall((HTML / name).read_text("utf8"))) for name in html_pages()}
    assert all(marked[name] > 15 for name in marked if name.startswith("chapters/")), marked
    assert marked["appendix/solutions.html"] > 50 and not marked["search.html"]
    for name in marked:
        article = (HTML / name).read_text("utf8").partition("<article")[2]
        before = article[: match.start()] if (match := MARKED.search(article)) else ""
        words = re.sub(r"<(script|style|svg|math)\b.*?</\1>|<[^>]*>", "", before, flags=re.DOTALL)
        assert not match or len(words) > 1500, f"{name}: what is seen at first is put off"


def test_few_scripts_are_fetched_and_not_before_the_text_has_come():
    """On a slow line without compression they took a quarter of the time to the first view."""
    for name in html_pages():
        text = (HTML / name).read_text("utf8")
        assert 0 < len(SCRIPT.findall(text) + FIGURES.findall(text)) <= SCRIPTS, name
        assert SCRIPT.search(text.partition("</head>")[0]) is None, name


def test_no_style_that_is_needed_at_once_comes_with_the_scripts(open_page):
    assert (
        whole(open_page(LONG)).evaluate(
            """async (names) => {
          const parsed = async (name) => new DOMParser().parseFromString(
            await (await fetch('/' + name)).text(), 'text/html');
          const served = [...(await parsed(location.pathname.slice(1))).querySelectorAll('style')];
          const texts = served.map(({ textContent }) => textContent), selectors = [], needed = [];
          const read = (rules) => rules.forEach(({ selectorText, cssRules }) =>
            selectorText ? selectors.push(selectorText) : read([...cssRules ?? []]));
          for (const style of document.querySelectorAll('head style'))
            if (!texts.includes(style.textContent)) read([...style.sheet.cssRules]);
          for (const name of names) {
            const page = await parsed(name);
            page.documentElement.dataset.theme = 'dark';
            needed.push(...selectors.filter((selector) => page.querySelector(selector)).map(
              (selector) => `${name}: ${selector}`));
          }
          return selectors.length ? needed : 'no styles came with the scripts';
        }""",
            html_pages(),
        )
        == []
    )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("size", SIZES)
def test_nothing_below_the_first_view_is_laid_out_or_measured_before_it_stands(open_page, size):
    page = open_page(LONG, size, HOLD + MEASURED)
    page.wait_for_function("held.length")
    assert page.evaluate("measured") == []
    last = page.locator(".later:has(> *)").last
    assert not last.evaluate(IS_SHOWN)
    page.evaluate("window.mayMeasure = true")
    page.emulate_media(media="print")
    assert last.evaluate(IS_SHOWN), "paper has the whole page"
    page.emulate_media(media="screen")
    last.scroll_into_view_if_needed()
    page.wait_for_function(
        f"({IS_SHOWN})([...document.querySelectorAll('.later:has(> *)')].at(-1))"
    )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("size", SIZES)
def test_in_the_end_every_block_stands_where_it_stands_on_a_page_laid_out_at_once(open_page, size):
    places = whole(open_page(LONG, size)).evaluate(PLACES)
    at_once = open_page(LONG + "#no=place", size)
    assert not at_once.evaluate("document.documentElement.matches('.in-parts')")
    assert whole(at_once).evaluate(PLACES) == places and len(places) > 50


def test_figures_are_brought_to_life_when_the_first_view_stands(open_page):
    """Their scripts are more than half of a page's, and must not delay the first view."""
    page = open_page(LONG, script=HOLD_FRAMES)
    page.wait_for_function("held.length", polling=50)  # nothing is drawn from here on
    asked = """() => performance.getEntriesByType('resource').filter(
      ({ name }) => /moving\\/.*js/.test(name)).length"""
    assert page.evaluate(asked) == 0
    assert page.locator(".moving .still").first.is_visible()
    page.evaluate("release()")
    page.wait_for_function(
        "[...document.querySelectorAll('.moving[data-figure]')].every((f) => 'ready' in f.dataset)",
        polling=50,
    )
    assert page.evaluate(asked) == len(FIGURES.findall((HTML / LONG).read_text("utf8"))) > 1


def test_link_within_a_page_leads_to_its_place_at_once(open_page):
    page = open_page(LONG, "narrow", HOLD, has_touch=True)
    page.wait_for_function("held.length")
    assert page.evaluate("document.documentElement.matches('.in-parts')")
    heading = page.locator(".bd-article > section > section").last
    page.locator("button.secondary-toggle").tap()
    page.locator("dialog[open] .page-toc > ul > li > a, dialog[open] nav > ul > li > a").last.tap()
    page.wait_for_function(
        "(box) => Math.abs(box.getBoundingClientRect().top) < 120", arg=heading.element_handle()
    )
    assert not page.evaluate("document.querySelector('html.in-parts, dialog[open]')")


def test_lecture_mode_begins_with_the_whole_page(open_page):
    page = open_page(LONG, script=HOLD)
    page.wait_for_function("held.length")
    page.locator("button.lecture-mode").click()
    page.wait_for_selector("html.lecture:not(.in-parts)")
    page.keyboard.press("End")
    assert page.locator(".in-step").last.is_visible()
