"""What readers type first into the search leads to the chapter, and complaints to the workbench."""

import pytest
from playwright.sync_api import expect

# The address of each chapter and its title, from the contents at the side.
CHAPTERS = """() => [...document.querySelectorAll('.bd-sidebar-primary a[href*="chapters/"]')]
  .map((link) => [link.pathname, link.textContent.trim().replace(/^\\d+\\.\\s*/, '')])"""


@pytest.fixture(scope="module")
def page(browser, site):
    context = browser.new_context(viewport={"width": 1300, "height": 900})
    page = context.new_page()
    page.goto(f"{site}search.html")
    page.wait_for_function("'searchWords' in self")
    yield page
    context.close()


def search(page, words):
    page.locator("form.bd-search:not(dialog form) input").click()
    page.keyboard.press("Control+a")
    page.keyboard.type(words)


@pytest.mark.parametrize(
    ("symbol", "reply"),
    [("∑", "Nothing found in this book. Try a different word"), ("θ", "Enter opens the first")],
)
def test_a_symbol_brings_places_or_what_to_try(page, symbol, reply):
    search(page, symbol)
    expect(page.locator("#search-results .found-count")).to_contain_text(reply)


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("chapters/euler-angles.html#no-such-place", "This page no longer has the place"),
        ("workbench.html#workbench=1.eyjmaxjzdci6", "letters were changed from capitals"),
    ],
)
def test_a_link_that_leads_nowhere_says_so(page, site, address, words):
    tab = page.context.new_page()
    tab.goto(site + address)
    expect(tab.locator(".bd-article")).to_contain_text(words)


def first_place(page, words):
    """Return the address and the title of the first place that the search shows for ``words``."""
    search(page, words)
    place = page.locator("#search-results ul.found a").first
    expect(place).to_be_visible()
    return place.evaluate("(link) => [link.pathname, link.querySelector('b').textContent]")


def test_four_letters_of_a_title_bring_its_chapter_first(page):
    chapters = page.evaluate(CHAPTERS)
    assert len(chapters) == 21
    # Four chapters begin with the same letters, and only one of them can be first.
    brought = {
        tuple(first_place(page, word))[0]
        for word in {title.removeprefix("The ")[:4] for _, title in chapters}
    }
    assert len(brought & {address for address, _ in chapters}) >= 18
    with page.context.expect_page():
        page.keyboard.press("Control+Enter")


@pytest.mark.parametrize(
    ("words", "chapter"),
    [
        ("quaternion", "quaternions-in-full"),
        ("Euler", "euler-angles"),
        ("axis and angle", "axis-and-angle"),
        ("the map", "map-of-descriptions"),
        ("gimbal", "gimbal-lock"),
        ("oiler angles", "euler-angles"),
    ],
)
def test_a_subject_brings_its_chapter_first(page, words, chapter):
    assert first_place(page, words)[0] == f"/chapters/{chapter}.html"


@pytest.mark.parametrize(
    "complaint",
    [
        "gives the wrong attitude",
        "orientation does not seem correct",
        "the rotation seems to be wrong",
        "my pose is incorrect",
        "orientation not as expected",
    ],
)
def test_a_complaint_leads_to_the_workbench(page, complaint):
    assert first_place(page, complaint)[0] == "/workbench.html"
