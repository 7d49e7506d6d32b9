"""Controls have unique names, figures keep their state, and nothing covers them."""

import re

import pytest
from playwright.sync_api import expect

CHAPTER = "chapters/successive-orientations.html"
PAGES = ["chapters/simple-orientations.html", "appendix/solutions.html"]
SETTLED = "() => !document.documentElement.matches('.settling, .in-parts')"
READY = ".moving[data-figure=successive][data-ready]"


def test_no_two_buttons_of_questions_have_the_same_name(page, site):
    page.goto(site + PAGES[0])
    page.wait_for_function(SETTLED)
    names = page.locator(".question .actions button").evaluate_all(
        "(buttons) => buttons.map((button) => button.ariaLabel)"
    )
    assert len(names) >= 4 and len(set(names)) == len(names)
    expect(page.get_by_role("button", name=re.compile("^Check: Question"))).not_to_have_count(0)


@pytest.mark.parametrize("address", PAGES)
def test_no_two_places_of_a_page_have_the_same_address(page, site, address):
    page.goto(site + address)
    ids = page.evaluate("[...document.querySelectorAll('[id]')].map(({ id }) => id)")
    assert {name for name in ids if ids.count(name) > 1} == set()


def test_a_slider_stands_where_it_was_left_after_back(page, site):
    page.goto(site + CHAPTER)
    page.wait_for_function(SETTLED)
    slider = page.locator(f"{READY} .turn-of-chain input[type=range]").first
    slider.focus()
    first = slider.input_value()
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    moved = slider.input_value()
    assert moved != first
    page.goto(site + PAGES[0])
    page.go_back()
    page.wait_for_function(SETTLED)
    expect(page.locator(f"{READY} .turn-of-chain input[type=range]").first).to_have_value(moved)


def test_a_drawing_that_sticks_lies_over_the_controls(page, site):
    page.set_viewport_size({"width": 380, "height": 760})
    page.goto(site + CHAPTER)
    page.wait_for_function(SETTLED)
    over = page.locator(READY).first.evaluate("""(figure) => {
      const button = [...figure.querySelectorAll('.exchange')].find((one) => one.checkVisibility());
      const stage = figure.querySelector('.live .stage');
      button.scrollIntoView({ block: 'start', behavior: 'instant' });
      scrollBy({ top: -40, behavior: 'instant' });
      const { left, top, width, height } = button.getBoundingClientRect();
      const seen = document.elementFromPoint(left + width / 2, top + height / 2);
      const under = stage.getBoundingClientRect();
      return [top > under.top && top + height < under.bottom, stage.contains(seen)];
    }""")
    assert over == [True, True]


@pytest.mark.parametrize("width", [1300, 380])
def test_nothing_is_empty_above_the_caption_of_the_workbench(page, site, width):
    page.set_viewport_size({"width": width, "height": 900})
    page.goto(f"{site}workbench.html")
    page.wait_for_function(SETTLED)
    page.locator(".moving[data-figure=workbench] .answer[aria-busy=false]").wait_for()
    empty = page.locator("figure > figcaption").first.evaluate("""(caption) => {
      const parts = [...caption.parentElement.querySelectorAll('.live *')];
      const lowest = parts.filter((part) => !part.children.length && part.checkVisibility())
        .map((part) => part.getBoundingClientRect().bottom);
      return caption.getBoundingClientRect().top - Math.max(...lowest);
    }""")
    assert 0 <= empty < 60


@pytest.mark.parametrize("answered", ["with the keyboard", "by a touch"])
def test_a_turned_telephone_shows_what_was_in_hand(page, site, answered):
    page.set_viewport_size({"width": 380, "height": 760})
    page.goto(site + CHAPTER)
    page.wait_for_function(SETTLED)
    choice = page.locator(".question label", has=page.get_by_role("radio")).last
    choice.get_by_role("radio").press("Space") if "keyboard" in answered else choice.click()
    page.wait_for_timeout(500)
    page.set_viewport_size({"width": 760, "height": 380})
    expect(choice).to_be_in_viewport()
