"""Whatever a reader types, wherever the book accepts text, appears as typed."""

import pytest
from engines import ENGINES, Chromium
from places import PATIENCE
from playwright.sync_api import expect

CELL = "chapters/simple-orientations.html"
ANSWER = "exercises/simple-orientations.html"
ASCII = "".join(map(chr, range(33, 127)))
WRITTEN = "x = sm.pi/6  # " + ASCII + "äöüßéñçø€"
# The middle of a cell's code, scrolled into view. Some cells are folded.
MIDDLE = """(number) => {
  const code = [...document.querySelectorAll('div.cell_input')].filter((one) => one.checkVisibility())[number];
  code.scrollIntoView({ block: 'center', behavior: 'instant' });
  const box = code.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2];
}"""  # noqa: E501
SETTLED = "() => !document.documentElement.matches('.settling, .in-parts')"
CODE = "() => document.activeElement.innerText"


@pytest.fixture(scope="module", params=["Chromium", *ENGINES])
def engine(request, browser):
    engine = Chromium(browser) if request.param == "Chromium" else ENGINES[request.param]()
    yield engine
    engine.close()


@pytest.mark.parametrize("address", [CELL, ANSWER])
def test_every_character_stands_in_a_cell_as_it_was_typed(engine, site, address):
    engine.go(site + address)
    engine.wait(SETTLED)
    engine.click(*engine.run(MIDDLE, 1))
    # Type at once, without waiting for the editor.
    engine.type(WRITTEN)
    engine.wait("() => document.activeElement.matches('.cm-content')")
    assert WRITTEN in engine.run(CODE)
    engine.run("() => localStorage.clear()")


# The middle of the first field for a number in a figure, once it is in view and alive.
FIELD = """() => {
  const field = document.querySelector('.moving input[type=number]');
  const shown = field || document.querySelector('.moving');
  shown.scrollIntoView({ block: 'center', behavior: 'instant' });
  if (!field) return null;
  const box = field.getBoundingClientRect(), middle = box.top + box.height / 2;
  return middle > 0 && middle < innerHeight ? [box.left + box.width / 3, middle] : null;
}"""


def test_a_field_takes_numbers_as_people_write_them(engine, site):
    engine.go(site + CELL)
    engine.wait(SETTLED)
    engine.wait(FIELD)
    engine.click(*engine.wait(FIELD))
    for typed, kind, shown in (
        ("12,5", "number", "12.5"),
        ("\u22127,5", "number", "-7.5"),
        ("270\n", "range", "-90"),
        ("-181\n", "range", "179"),
    ):
        engine.run("() => document.activeElement.select()")
        engine.type(typed)
        value = f"() => document.querySelector('.moving input[type={kind}]').value"
        engine.wait(f"() => ({value})() === '{shown}'")


@pytest.fixture
def late(page, site):
    """A chapter whose editor arrives three seconds after it was requested."""

    def later(route):
        page.wait_for_timeout(3000)
        route.continue_()

    page.route("**/live.js", later)
    page.goto(site + CELL)
    page.wait_for_function(SETTLED)
    page.mouse.click(*page.evaluate(MIDDLE, 1))
    assert not page.locator(".cm-editor").count()
    return page


def test_what_is_typed_before_the_editor_has_come_goes_into_it(late):
    late.context.grant_permissions(["clipboard-read", "clipboard-write"])
    late.evaluate("navigator.clipboard.writeText('x = \\'a/b\\'\\n')")
    late.keyboard.press("Control+a")
    late.keyboard.press("Control+v")
    late.keyboard.type("x * 2")
    late.keyboard.press("Shift+Enter")
    cell = late.locator("div.cell", has_text="x * 2")
    expect(cell.locator(".cm-content")).to_have_text("x = 'a/b'x * 2")
    expect(cell.locator(".cell_output")).to_contain_text("a/ba/b", timeout=PATIENCE)


def test_whoever_clicks_again_before_the_editor_has_come_types_once(late):
    """Try it in the same cell and in another one, where text is dictated, then composed."""
    late.keyboard.type("one/")
    late.wait_for_timeout(600)
    late.mouse.click(*late.evaluate(MIDDLE, 1))
    late.keyboard.type("two/")
    late.mouse.click(*late.evaluate(MIDDLE, 2))
    keyboard = late.context.new_cdp_session(late)
    keyboard.send("Input.insertText", {"text": "three/"})
    composed = {"text": "かい", "selectionStart": 2, "selectionEnd": 2}
    keyboard.send("Input.imeSetComposition", composed)
    late.wait_for_timeout(4000)  # the editor does not interrupt an input method
    keyboard.send("Input.insertText", {"text": "回転"})
    expect(late.locator(".cm-content")).to_have_count(2)
    first, second = late.locator(".cm-content").all_inner_texts()
    assert (first.count("one/two/"), first.count("three/")) == (1, 0)
    assert (second.count("three/回転"), second.count("two/")) == (1, 0)


def test_a_cell_is_edited_as_any_editor_is_with_any_keyboard(page, site):
    page.goto(site + CELL)
    page.wait_for_function(SETTLED)
    page.mouse.click(*page.evaluate(MIDDLE, 1))
    expect(page.locator(".cm-editor.cm-focused")).to_be_visible()
    page.keyboard.press("Control+a")
    # A German keyboard has the slash on Shift and 7, and braces on AltGr; then a dead key.
    keyboard = page.context.new_cdp_session(page)
    for key, code, modifiers in [("/", "Digit7", 8), ("{", "Digit7", 0), ("@", "KeyQ", 0)]:
        stroke = {"key": key, "code": code, "modifiers": modifiers}
        keyboard.send("Input.dispatchKeyEvent", {"type": "keyDown", "text": key, **stroke})
        keyboard.send("Input.dispatchKeyEvent", {"type": "keyUp", **stroke})
    dead = {"type": "rawKeyDown", "key": "Dead", "code": "BracketLeft"}
    keyboard.send("Input.dispatchKeyEvent", dead)
    keyboard.send("Input.insertText", {"text": "ê"})
    content = page.locator(".cm-editor.cm-focused .cm-content")
    expect(content).to_have_text("/{@ê")
    page.keyboard.press("Control+a")
    page.keyboard.type("a/b")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("Backspace")
    page.keyboard.type("*")
    expect(content).to_have_text("a*b")
    page.keyboard.press("Control+z")
    expect(content).to_have_text("a/b")
    page.keyboard.press("Home")
    page.keyboard.press("Tab")
    assert content.inner_text() == "    a/b"
    page.keyboard.press("Escape")
    expect(page.locator("button.run-cell:focus")).to_be_visible()
    # Whoever passes through with Tab changes nothing.
    for key in ["Shift+Tab", "Shift+Tab", "Tab"]:
        page.keyboard.press(key)
    expect(page.locator("button.to-original:focus")).to_be_visible()
    assert page.locator(".edited .cm-content").inner_text() == "    a/b"
    page.keyboard.press("Tab")
    expect(page.locator(".cm-editor.cm-focused")).to_have_count(0)


def test_the_search_takes_every_character(page, site):
    page.goto(site + CELL)
    page.locator("button.search-button__button").first.click()
    field = page.locator("dialog input[type=search]")
    expect(field).to_be_focused()
    page.keyboard.type(ASCII)
    expect(field).to_have_value(ASCII)


@pytest.mark.parametrize(
    ("address", "name"),
    [
        ("workbench.html", "What the first program gives"),
        ("chapters/convention-card.html", "Numbers to convert"),
    ],
)
def test_the_fields_of_figures_take_every_character_and_new_lines(page, site, address, name):
    page.goto(site + address)
    field = page.get_by_label(name)
    field.click()
    page.keyboard.press("Control+a")
    page.keyboard.type(ASCII)
    page.keyboard.press("Enter")
    page.keyboard.type("a/b")
    expect(field).to_have_value(f"{ASCII}\na/b")


@pytest.mark.parametrize("address", [CELL, "workbench.html", "rotations.html"])
def test_who_dictates_hello_to_a_page_turns_nothing(page, site, address):
    """Dictation types where nothing accepts text."""
    page.goto(site + address)
    page.wait_for_load_state("load")
    page.locator("h1").first.click()
    # Long pages are laid out in parts, the last of them after the reader begins.
    page.wait_for_function("!document.documentElement.classList.contains('in-parts')")
    before = page.evaluate("[location.href, document.documentElement.className]")
    page.keyboard.type("hello/all?")
    page.wait_for_timeout(300)
    assert page.evaluate("[location.href, document.documentElement.className]") == before
    assert page.locator("dialog[open]").count() == 0
