"""The lecture of a chapter: its steps, its keys, its votes, in a real browser."""

import pytest
from places import HTML
from playwright.sync_api import expect
from test_site import violations

CHAPTERS = sorted(path.stem for path in (HTML / "chapters").glob("*.html"))
BAR = ".lecture-bar button"

# Go through the lecture, and return the faults of each step.
STEPS = """() => {
  const press = (key) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  press("Home");
  const article = document.querySelector(".bd-article");
  const faults = [];
  const count = Number(document.querySelector(".lecture-bar button").textContent.split(" ").at(-1));
  for (let step = 1; step <= count; step += 1) {
    const wrong = (what) => faults.push(`${step}: ${what}`);
    const line = document.querySelector(".lecture-line").getBoundingClientRect();
    if (!line.width || line.top < 0 || line.bottom > innerHeight) wrong("its line is not seen");
    if (line.bottom > document.querySelector(".lecture-bar").getBoundingClientRect().top) wrong("its line lies on the bar");
    for (const block of document.querySelectorAll(".in-step")) {
      const box = block.getBoundingClientRect();
      if (!box.height || !box.width) wrong(`${block.id} is not seen`);
      if (!block.matches("figure")) continue;
      if (box.top < 0 || box.bottom > innerHeight || box.left < 0 || box.right > innerWidth) wrong(`${block.id} is cut off`);
      const clear = box.right <= line.left || box.bottom <= line.top || box.top >= line.bottom;
      if (!clear) wrong(`${block.id} lies over its line`);
      const drawings = [...block.querySelectorAll(":scope svg[viewBox]:not(.formula), :scope img")].filter((one) => one.checkVisibility());
      if (drawings.length && Math.max(...drawings.map((one) => one.getBoundingClientRect().height)) < 0.4 * innerHeight)
        wrong(`the drawing of ${block.id} is small`);
    }
    if (article.scrollHeight > innerHeight + 1 && document.querySelector("figure.in-step")) wrong("its words are cut off");
    press("PageDown");
  }
  return [count, faults];
}"""  # noqa: E501


@pytest.fixture
def opened(browser, site):
    contexts = []

    def open_chapter(name="simple-orientations", folder="chapters/", **settings):
        context = browser.new_context(viewport={"width": 1280, "height": 720}, **settings)
        contexts.append(context)
        context.set_default_timeout(60_000)
        page = context.new_page()
        page.goto(f"{site}{folder}{name}.html")
        page.wait_for_function("!document.documentElement.matches('.settling, .in-parts')")
        return page

    yield open_chapter
    for context in contexts:
        context.close()


def begin(page):
    """Start the lecture and wait for it."""
    box = page.locator("button.lecture-mode").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.wait_for_selector("html.lecture")


def step(page):
    return int(page.locator(BAR).inner_text().split()[0])


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", CHAPTERS)
def test_each_step_is_seen_whole_with_its_line(opened, name):
    page = opened(name)
    begin(page)
    count, faults = page.evaluate(STEPS)
    assert faults == [] and 3 <= count <= 25
    # The bar keeps a type that can be read where all other type is small.
    page.set_viewport_size({"width": 380, "height": 760})
    assert [fault for fault in page.evaluate(STEPS)[1] if "bar" in fault] == []


def test_keys_work_after_clicks_and_the_page_is_left_whole_where_it_was(opened):
    page = opened()
    page.locator("button.lecture-mode").click()
    assert step(page) == 1
    page.keyboard.press(" ")
    assert step(page) == 2
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    slider = page.locator("figure.in-step [type=range]").first
    slider.click()
    expect(page.locator(".lecture-line")).to_be_focused()
    page.keyboard.press("ArrowRight")
    assert step(page) == 6  # a pointer returns the keys to the lecture
    slider.focus()
    value = slider.input_value()
    page.keyboard.press("ArrowRight")
    # A reader who came by keyboard moves the figure.
    assert step(page) == 6 and slider.input_value() != value
    page.keyboard.press("PageDown")  # and a speaker's remote control continues
    assert step(page) == 7
    page.keyboard.type("3\n")
    page.reload()
    page.wait_for_selector("html.lecture")
    assert step(page) == 3
    page.keyboard.press("F5")  # the button with which a remote control starts its show
    page.wait_for_function("document.fullscreenElement !== null")
    assert step(page) == 3
    page.evaluate("document.exitFullscreen()")
    page.wait_for_function("document.fullscreenElement === null")
    if page.locator(".lecture-bar").count():
        page.go_back()
    expect(page.locator(".lecture-bar")).to_have_count(0)
    page.evaluate("document.querySelectorAll('h2')[3].scrollIntoView({ behavior: 'instant' })")
    before = page.evaluate("[scrollY, document.querySelectorAll('article *').length]")
    begin(page)
    page.emulate_media(media="print")
    hidden = (
        "all => all.filter((one) => one.textContent.trim() && "
        "!one.getBoundingClientRect().height).length"
    )
    of_page = page.locator(".bd-article > section > section > :is(p, h2, div.math)")
    assert of_page.evaluate_all(hidden) == 0
    assert not page.locator(".lecture-line").is_visible()
    page.emulate_media(media="screen")
    page.keyboard.press("End")
    page.keyboard.press("Escape")
    assert page.evaluate("[scrollY, document.querySelectorAll('article *').length]") == before
    assert page.locator(".in-step, .around-step, .lecture-line, .lecture-bar").count() == 0
    assert page.locator(".covered").count() == page.locator(".covered[inert]").count()


def test_a_prediction_is_voted_twice_and_answered(opened):
    page = opened()
    begin(page)
    while not page.locator(".question.in-step").count():
        page.keyboard.press("PageDown")
    at = step(page)
    box = page.locator(".question.in-step")
    hands = box.locator(".hands input")
    right = box.get_attribute("data-answer")
    hands.nth(0).fill("12")
    hands.nth(1).fill("4")
    shares = "all => all.map((one) => one.getBoundingClientRect().width)"
    first, second, *_ = box.locator(".share:not(.before)").evaluate_all(shares)
    assert first == pytest.approx(3 * second, rel=0.02)
    box.get_by_role("button", name="Vote again").click()
    assert box.locator(".share.before").evaluate_all(shares)[0] == pytest.approx(first, rel=0.02)
    assert box.locator("li.right .hands").count() == 0
    box.get_by_role("button", name="Show the answer").click()
    assert box.locator(".choices > li.right").get_attribute("data-name") == right
    page.keyboard.press("ArrowRight")
    assert step(page) == at + 1
    # A vote of the audience is nobody's own answer.
    assert not any(here["answers"] for here in page.evaluate("bookStore.record()").values())
    page.keyboard.press("Escape")
    assert page.locator(".hands").count() == 0


def test_outline_black_screen_time_and_notes(opened):
    page = opened()
    begin(page)
    page.keyboard.press("o")
    menu = page.get_by_role("dialog", name="Outline of the lecture")
    assert menu.locator("ol button").count() == int(page.locator(BAR).inner_text().split()[-1])
    menu.locator("ol button").nth(4).click()
    assert step(page) == 5 and menu.count() == 0
    page.keyboard.press("b")
    assert page.evaluate("document.elementFromPoint(640, 360).className") == "lecture-black"
    page.keyboard.press("PageDown")
    assert step(page) == 5 and not page.locator(".lecture-black").is_visible()
    page.keyboard.press("t")
    assert page.locator(".lecture-clock").inner_text().startswith("0:")
    page.keyboard.press("n")
    assert page.locator(".lecture-notes").is_visible()
    with page.expect_popup() as popup:
        page.keyboard.press("s")
    speaker = popup.value
    assert speaker.locator("main").inner_text().split()
    speaker.keyboard.press("PageDown")
    assert step(page) == 6
    page.keyboard.press("?")
    assert violations(page) == []


@pytest.mark.long
def test_a_hall_without_a_mouse_may_swipe(opened):
    page = opened(has_touch=True)
    page.locator("button.lecture-mode").tap()
    page.wait_for_selector("html.lecture")
    swipe = """(by) => {
      const target = document.querySelector(".lecture-line");
      const at = (x) => [new Touch({ identifier: 1, target, clientX: x, clientY: 300 })];
      target.dispatchEvent(new TouchEvent(
        "touchstart", { touches: at(600), changedTouches: at(600), bubbles: true }));
      target.dispatchEvent(new TouchEvent(
        "touchend", { changedTouches: at(600 + by), bubbles: true }));
    }"""
    page.evaluate(swipe, -200)
    assert step(page) == 2
    page.evaluate(swipe, 200)
    assert step(page) == 1
    page.locator(BAR).tap()
    page.get_by_role("button", name="back to the page").tap()
    assert page.locator(".lecture-bar").count() == 0


@pytest.mark.long
def test_the_essay_is_lectured_by_its_stops(opened):
    page = opened("rotations", "", reduced_motion="reduce")
    begin(page)
    stops = page.locator("[data-stop]").evaluate_all("all => all.map((one) => one.dataset.stop)")
    assert page.locator(BAR).inner_text() == f"1 of {len(stops)}"
    for stop in stops[:5]:
        page.wait_for_function(
            "(stop) => document.querySelector('.world').dataset.state === stop", arg=stop
        )
        drawing, line = (
            page.locator(".world canvas").bounding_box(),
            page.locator(".lecture-line").bounding_box(),
        )
        assert (
            drawing["width"] * drawing["height"] > 0.5 * 1280 * 720
            and drawing["y"] + drawing["height"] <= line["y"]
        )
        page.keyboard.press("PageDown")


def test_marks_are_in_no_page_notebook_or_script():
    made = [
        path
        for where in ("chapters/*.html", "take-away/*.ipynb", "take-away/*.py")
        for path in HTML.glob(where)
    ]
    assert made
    assert [path.name for path in made if "<!-- step" in path.read_text("utf8")] == []
