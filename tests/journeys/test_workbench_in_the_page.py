"""An engineer pastes the numbers of two programs into the workbench's page, and answers it."""

import pytest
from test_numbers_from_elsewhere import FLU, FRD, OPENCV, OPENGL

# A window on a desktop and one of a telephone.
WINDOWS = {"desk": (1300, 900), "telephone": (380, 760)}


@pytest.fixture(params=WINDOWS)
def page(request, browser, site):
    width, height = WINDOWS[request.param]
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    page.goto(site + "workbench.html")
    page.locator(".answer .heading").wait_for()
    yield page
    context.close()


def answer(page):
    return page.locator(".answer")


def paste(page, first, second):
    """Click into each field, select all its text, and type over it."""
    for side, numbers in (("first", first), ("second", second)):
        page.get_by_label(f"What the {side} program gives").click()
        page.keyboard.press("Control+a")
        page.keyboard.insert_text(numbers)


def click(page, button):
    """Move the mouse to the middle of a button, and press it there."""
    button.scroll_into_view_if_needed()
    box = button.bounding_box()
    assert 0 <= box["x"] and box["x"] + box["width"] <= page.viewport_size["width"]
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)


def test_a_mistake_is_told_and_a_click_answers_the_question_of_a_shared_order(page):
    paste(page, "0.1 0.3", FRD)
    answer(page).get_by_text("Not readable yet").wait_for()
    paste(page, FLU, FRD)
    answer(page).get_by_text("None of these?").wait_for()
    answer(page).get_by_text("One question decides.").wait_for()
    assert "scalar part of the quaternions come first or last?" in answer(page).inner_text()
    last = answer(page).get_by_role("listitem").filter(has_text="comes last in both")
    click(page, last.get_by_role("button", name="That is so"))
    answer(page).get_by_text("They differ, and this is how:").wait_for()
    reply = answer(page).inner_text().lower()
    assert "y and z of the body reversed" in reply and "world" not in reply
    # On paper, they stand instead of the built-in example.
    page.emulate_media(media="print")
    seen = [page.locator(own).is_visible() for own in (".answer", ".side >> nth=1", ".still")]
    assert seen == [True, True, False]
    page.emulate_media(media="screen")
    # For other numbers, the earlier answer does not apply.
    paste(page, FLU, FLU.replace("0.301", "0.302"))
    paste(page, FLU, FRD)
    answer(page).get_by_text("One question decides.").wait_for()


def test_keys_answer_the_question_of_a_shared_layout(page):
    paste(page, OPENCV, OPENGL)
    answer(page).get_by_text("One question decides.").wait_for()
    assert "Are the body's axes the rows or the columns" in answer(page).inner_text()
    # The line under the drawing must not answer the open question either.
    reversed_axes = page.locator(".moving").get_by_text("reversed (").all()
    assert all(each.evaluate("(own) => !!own.closest('.answer')") for each in reversed_axes)
    columns = answer(page).get_by_role("listitem").filter(has_text="are the columns")
    button = columns.get_by_role("button", name="That is so")
    for _ in range(12):  # from the field to the button with the Tab key alone
        page.keyboard.press("Tab")
        if button.evaluate("(own) => own === document.activeElement"):
            break
    page.keyboard.press("Enter")
    answer(page).get_by_text("They differ, and this is how:").wait_for()
    assert "of the body reversed" in answer(page).inner_text().lower()


@pytest.mark.parametrize("page", ["desk"], indirect=True)
def test_a_dropped_file_goes_into_the_field_or_to_the_bench(page, tmp_path):
    """Nowhere on the page, once the bench is near, does it open in place of the page."""
    file = tmp_path / "poses.txt"
    file.write_text("0.5 0.5 0.5 0.5\n", "utf8")
    devices = page.context.new_cdp_session(page)
    field = page.get_by_label("What the first program gives")
    bench = page.get_by_text("How far can you trust a file")
    for place, shown in (
        (field, answer(page).get_by_text("The first side has 1 pose")),
        (bench, page.get_by_text("Not run here: NumPy could not be fetched").last),
    ):
        place.evaluate("(box) => box.scrollIntoView({ block: 'center', behavior: 'instant' })")
        page.wait_for_timeout(1000)
        box = place.bounding_box()
        data = {"items": [], "files": [str(file)], "dragOperationsMask": 1}
        point = {"x": box["x"] + 20, "y": box["y"] + box["height"] / 2}
        for kind in ("dragEnter", "dragOver", "drop"):
            devices.send("Input.dispatchDragEvent", {"type": kind, **point, "data": data})
        shown.wait_for()
    assert len(page.context.pages) == 1


@pytest.mark.parametrize("page", ["desk"], indirect=True)
def test_an_address_that_was_cut_off_says_so_and_shows_no_other_numbers(page):
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    click(page, page.get_by_role("button", name="Copy the address of this case"))
    page.get_by_text("The address is copied.").wait_for()
    address = page.evaluate("navigator.clipboard.readText()")
    page.goto("about:blank")
    page.goto(address[:-40])
    answer(page).get_by_text("This address is incomplete").wait_for()
    first, second = (page.get_by_label(f"What the {side} program") for side in ("first", "second"))
    assert [first.input_value(), second.input_value()] == ["", ""]
    # It is forgotten with the first numbers.
    first.click()
    page.keyboard.insert_text(FLU)
    answer(page).get_by_text("The second side is empty").wait_for()
