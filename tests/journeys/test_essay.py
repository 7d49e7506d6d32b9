"""A reader opens the essay at a stop, reads on, and uses windows of all sizes."""

import pytest

ESSAY = "rotations.html"
# The address of each stop, and its name.
STOPS = """() => [...document.querySelectorAll('[data-stop]')]
  .map((stop) => [stop.closest('section').id, stop.dataset.stop])"""
LINKED = ["your-turn", "two-motors"]
SIZES = [(1300, 900), (1024, 700), (740, 360), (380, 760)]
ZOOMED = (320, 200)  # a window of 1280 by 800 at 400 %
# Whether the place is visible: within the window, and not covered.
SEEN = """(box) => {
  const { left, top, width, height } = box.getBoundingClientRect();
  const there = document.elementFromPoint(left + Math.min(width, 40) / 2, top + height / 2);
  return box.contains(there);
}"""


@pytest.fixture(params=SIZES, ids=lambda size: "x".join(map(str, size)))
def page(request, browser):
    width, height = request.param
    context = browser.new_context(viewport={"width": width, "height": height})
    yield context.new_page()
    context.close()


def open_essay(page, address):
    page.goto("about:blank")
    page.goto(address)
    page.locator(".world").hover()
    page.locator(".world:is([data-ready], [data-stills])").wait_for()
    if page.locator(".world[data-stills]").count():
        pytest.skip("this browser has no WebGL")


def test_a_finger_on_the_still_takes_hold_of_the_gimbal(browser, site):
    context = browser.new_context(viewport={"width": 380, "height": 760}, has_touch=True)
    page = context.new_page()
    page.goto(site + ESSAY)
    page.wait_for_timeout(1500)
    assert not page.locator(".world[data-ready]").count(), "nobody has touched it"
    box = page.locator(".world > .still svg").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    finger = context.new_cdp_session(page)

    def touch(kind, *places):
        points = [{"x": x + place, "y": y} for place in places]
        finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    touch("touchStart", 0)
    touch("touchMove", 12)
    page.locator(".world:is([data-ready], [data-stills])").wait_for()
    if page.locator(".world[data-stills]").count():
        pytest.skip("this browser has no WebGL")
    page.wait_for_function("document.querySelector('.world').world.held")
    for place in range(20, 90, 10):
        touch("touchMove", place)
    touch("touchEnd")
    assert page.evaluate("document.querySelector('.world').world.state.free")
    context.close()


def wait_for_stop(page, stop):
    page.wait_for_function(
        "stop => document.querySelector('.world').dataset.state === stop", arg=stop
    )


def test_a_link_to_a_stop_shows_that_stop_and_leaves_room_for_its_text(page, site):
    width, height = page.viewport_size["width"], page.viewport_size["height"]
    for stop in LINKED:
        open_essay(page, f"{site}{ESSAY}#{stop}")
        wait_for_stop(page, stop)
        assert page.locator(f"#{stop} > h2").evaluate(SEEN)
        text = page.locator(f"#{stop} > p").first
        assert text.evaluate(SEEN), "the figure lies over what it is to show"
        # The figure is whole.
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        figure = page.locator(".world .world-live").bounding_box()
        picture = page.locator(".world canvas").bounding_box()
        output = page.locator(".cell:has(.world)").bounding_box()
        assert picture["width"] <= output["width"] + 1 and figure["x"] + figure["width"] <= width
        assert picture["height"] > 120
        beside = figure["x"] > width / 3
        covered = 0 if beside else max(0, figure["y"] + figure["height"])
        assert height - covered > min(140, 0.7 * height)
    # A reload in mid-page stays there.
    page.mouse.wheel(0, 110)
    page.wait_for_timeout(300)
    before = page.locator(".world").get_attribute("data-state")
    page.reload()
    page.locator(".world[data-ready]").wait_for()
    wait_for_stop(page, before)


@pytest.mark.parametrize("page", [(1024, 700)], indirect=True)
def test_the_answer_to_a_task_comes_only_when_the_reader_goes_on(page, site):
    open_essay(page, f"{site}{ESSAY}#three-are-enough")
    wait_for_stop(page, "three-are-enough")
    task, answer = page.locator("#three-are-enough > p").all()[:2]
    assert task.evaluate(SEEN) and not answer.evaluate(SEEN)
    look = page.locator(".world .look")
    assert "The star is 41 degrees away" in look.inner_text()
    for _ in range(60):
        if "Three motors were enough" not in look.inner_text():
            page.mouse.wheel(0, 110)
            page.wait_for_timeout(150)
            page.wait_for_function("!document.querySelector('.world').world.frame")  # it rests
    assert "Three motors were enough" in look.inner_text()
    # Its paragraph is being read when the gimbal shows it.
    box = answer.bounding_box()
    assert box["y"] < page.viewport_size["height"] < 2 * (box["y"] + box["height"])


@pytest.mark.parametrize("page", [ZOOMED], indirect=True)
def test_at_400_percent_a_link_to_a_stop_shows_its_text_and_its_still(page, site):
    """The moving figure would fill the window, so each stop has its still instead."""
    for stop in LINKED:
        page.goto("about:blank")
        page.goto(f"{site}{ESSAY}#{stop}")
        page.wait_for_load_state("networkidle")
        assert page.locator(f"#{stop} > h2").evaluate(SEEN)
        assert page.evaluate("document.documentElement.scrollWidth") <= ZOOMED[0]
        still = page.locator(f"#{stop} svg, #{stop} img").first
        still.scroll_into_view_if_needed()
        assert still.is_visible()


@pytest.mark.parametrize("page", [(740, 360)], indirect=True)
def test_every_stop_has_an_address_and_its_scene_begins_there(page, site):
    open_essay(page, site + ESSAY)
    stops = page.evaluate(STOPS)
    assert len(stops) == 16
    # Every third stop, including the first and the last.
    for address, stop in stops[::3]:
        page.evaluate("(address) => { location.hash = address; }", address)
        wait_for_stop(page, stop)
        page.mouse.wheel(0, 1)
        page.wait_for_timeout(700)
        assert page.evaluate("document.querySelector('.world').world.state.t") < 0.05, stop
