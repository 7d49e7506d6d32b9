"""Previews: the target of a link appears beside it for a pointer or the keyboard."""

import re

import pytest
from places import HTML
from test_site import NARROW, PAGES, WIDE, Visit, text, violations

from notebook_pages import previews

# How links of each kind begin, on the page itself and on another one, and what of their target is
# shown.
LINKS = {
    "equation here": ("#equation-", ".katex math"),
    "equation elsewhere": (r"[\w./-]+\.html#equation-", ".katex math"),
    "figure here": ("#figure-", "figcaption"),
    "figure elsewhere": (r"[\w./-]+\.html#figure-", "figcaption"),
    "term here": ("#term-", "dd"),
    "term elsewhere": (r"[\w./-]+\.html#term-", "dd"),
    "source": (r"[\w./-]+bibliography\.html#id", "p"),
}


def first_link(name):
    """Return the smallest page that has such a link in its text, and the first one there."""
    written = re.compile(rf'<a class="reference internal" href="({LINKS[name][0]}[^"]*)"')
    texts = {page: text(page).partition("<article")[2] for page in PAGES}
    page = min(
        (page for page, words in texts.items() if written.search(words)),
        key=lambda page: len(texts[page]),
    )
    return page, f'.bd-article a.internal[href="{written.search(texts[page])[1]}"]'


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", LINKS)
def test_a_preview_shows_what_the_link_leads_to_and_goes_with_escape(browser, site, name):
    address, link = first_link(name)
    part = LINKS[name][1]
    with Visit(browser, site, address, "light", WIDE) as visit:
        page = visit.page
        asked = page.locator(link).first
        asked.scroll_into_view_if_needed()
        asked.hover()
        box = page.get_by_role("tooltip")
        box.wait_for()
        assert box.locator(part).count() and box.inner_text().strip()
        assert box.locator("a, button, input").count() == 0
        assert asked.get_attribute("aria-describedby") == box.get_attribute("id")
        assert box.locator("[id]:not(svg [id])").count() == 0
        if "figure" in name:
            assert box.locator("svg[viewBox]").bounding_box()["height"] > 50
        # The page around them is checked in test_site.py.
        assert (
            violations(page, "{include: ['[role=tooltip]', 'a[aria-describedby]']}") == []
            and visit.faults == []
        )
        page.keyboard.press("Escape")
        assert box.count() == 0 and asked.get_attribute("aria-describedby") is None


def test_a_preview_comes_by_keyboard_stays_under_the_pointer_and_is_not_in_the_way_of_a_touch(
    browser, site
):
    address, link = first_link("equation elsewhere")
    with Visit(browser, site, address, "dark", WIDE) as visit:
        page, box = visit.page, visit.page.get_by_role("tooltip")
        asked = page.locator(link).first
        asked.focus()
        page.keyboard.press("Shift+Tab")
        page.keyboard.press("Tab")
        box.wait_for()
        page.keyboard.press("Tab")
        box.wait_for(state="detached")
        asked.hover()
        box.wait_for()
        place = box.bounding_box()
        page.mouse.move(place["x"] + 20, place["y"] + place["height"] / 2, steps=5)
        page.wait_for_timeout(600)
        assert box.count() == 1
        page.mouse.move(5, 5, steps=5)
        box.wait_for(state="detached")
    context = browser.new_context(viewport=NARROW, has_touch=True)
    page = context.new_page()
    page.goto(site + address)
    page.wait_for_selector("html:not(.settling, .in-parts)")
    asked = page.locator(link).first
    target = asked.get_attribute("href").partition("#")[2]
    asked.tap()
    page.wait_for_url(f"**#{target}")
    context.close()


def test_previews_come_from_a_disk_too(browser):
    address, link = first_link("term elsewhere")
    page = browser.new_page(viewport=WIDE)
    page.goto((HTML / address).as_uri())
    page.locator(link).first.hover()
    page.get_by_role("tooltip").locator("dd").wait_for()
    page.close()


def test_what_is_previewed_is_whole():
    text = (
        '<p id="other">no</p><div class="a" id="it"><div>in</div><div id="b"><a '
        'href="#x">out</a></div></div>'
    )
    text += "<div>after</div>"
    assert (
        previews.element_at(text, "it")
        == text[text.index('<div class="a"') : text.index("<div>after")]
    )
    assert previews.preview(text, "it") == '<div class="a"><div>in</div><div>out</div></div>'
    assert (
        previews.element_at(text, "not-there") is None
        and previews.preview(text, "term-not-there") is None
    )
    with pytest.raises(ValueError, match="has no end tag"):
        previews.element_at('<div id="it"><div></div>', "it")


def test_previews_weigh_little():
    """Each is fetched on request; a script of one page is far smaller than the page."""
    weights = {path.name: path.stat().st_size for path in (HTML / previews.FOLDER).iterdir()}
    assert len(weights) > 5 and max(weights.values()) < 100_000, weights
