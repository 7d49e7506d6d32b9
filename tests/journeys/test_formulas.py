"""A reader meets formulas in a translating browser, copies them, and reads them on a phone."""

import pytest

CHAPTER = "chapters/unit-quaternions.html"
SETTLED = "() => !document.documentElement.matches('.settling, .in-parts')"


@pytest.fixture(scope="module")
def context(browser):
    context = browser.new_context(viewport={"width": 380, "height": 760})
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    yield context
    context.close()


@pytest.fixture(scope="module")
def chapter(context, site):
    page = context.new_page()
    page.goto(site + CHAPTER)
    page.wait_for_function(SETTLED)
    return page


def test_a_browser_that_translates_leaves_formulas_alone(chapter):
    translated = chapter.evaluate(
        "[...document.querySelectorAll('.katex')].map((formula) => formula.translate)"
    )
    assert len(translated) > 50 and not any(translated)


def copied(page, selector):
    """Return the text that a reader gets by selecting an element and copying it."""
    page.bring_to_front()
    page.locator(selector).first.evaluate("(box) => getSelection().selectAllChildren(box)")
    page.keyboard.press("Control+c")
    return page.evaluate("navigator.clipboard.readText()")


def test_a_sentence_is_copied_with_the_tex_of_its_formulas(chapter):
    text = copied(chapter, "article section p:has(.katex)")
    assert "$" in text and "\n" not in text.strip()
    assert text.count("$") % 2 == 0 and "\u2061" not in text


def test_numbers_of_a_figure_are_copied_as_programs_read_them(chapter):
    assert set(copied(chapter, ".moving[data-ready] .readouts")) & set(".\u2212\u2007") == {"."}


def test_text_is_copied_with_the_code_below_it_and_no_buttons(context, site):
    """Press in a paragraph, and release in the second cell below it."""
    page = context.new_page()
    page.goto(site + "exercises/simple-orientations.html")
    page.wait_for_function(SETTLED)
    check = page.locator(".cell_input").filter(has_text="skier', weight")
    check.evaluate("(box) => box.scrollIntoView({ block: 'center', behavior: 'instant' })")
    page.wait_for_timeout(500)
    text = page.locator("p").filter(has_text="Set weight")
    for place, left, press in ((text, 1, page.mouse.down), (check, 340, page.mouse.up)):
        box = place.bounding_box()
        page.mouse.move(box["x"] + left, box["y"] + box["height"] / 2)
        press()
    page.keyboard.press("Control+c")
    lines = page.evaluate("navigator.clipboard.readText()").split("\n")
    assert "three components" in lines[0] and lines[1:3] == ["", "weight = ...  # your answer"]
    assert "Run" not in lines


@pytest.mark.parametrize(
    ("part", "fence"),
    [
        ("article p .katex > :last-child", "$"),
        ("article .math-box .katex-display .katex > :last-child", "$$"),
        ("article div.math.display .math-box", "$$"),
    ],
)
def test_part_of_a_formula_is_copied_as_the_whole_formula(chapter, part, fence):
    text = copied(chapter, part).strip()
    assert text.startswith(fence) and text.endswith(fence) and text.count("$") == 2 * len(fence)


def test_matrices_are_whole_on_a_phone_or_scroll_with_the_keyboard(chapter):
    matrices = chapter.locator(".cell_output .math-box")
    wide = []
    for matrix in matrices.all():
        matrix.scroll_into_view_if_needed()
        chapter.wait_for_timeout(100)
        hidden = matrix.evaluate("(box) => box.scrollWidth - box.clientWidth")
        if hidden > 1:
            wide.append(matrix)
            matrix.focus()
            for _ in range(20):
                chapter.keyboard.press("ArrowRight")
            chapter.wait_for_timeout(400)
            left = matrix.evaluate("(box) => box.scrollWidth - box.clientWidth - box.scrollLeft")
            assert left <= 1, "its last column cannot be reached"
    assert len(wide) <= 2, "the matrix of a quaternion does not fit"
