"""Predictions, recaps and the page of progress, in a real browser."""

import json

import pytest
from places import HTML
from test_site import violations

from coursework.checking.reply import Reply

CHAPTER = "chapters/reference-frames"
COVERING = '.question[data-covers]:not([data-covers="0"])'
KEPT = "() => ({ pages: bookStore.record() })"


@pytest.fixture
def context(browser):
    context = browser.new_context(viewport={"width": 1300, "height": 900})
    context.set_default_timeout(60_000)
    yield context
    context.close()


def opened(context, site, name=CHAPTER):
    page = context.new_page()
    page.goto(f"{site}{name}.html")
    page.wait_for_function("!document.documentElement.matches('.settling, .in-parts')")
    return page


def pages_with_questions():
    return [
        path
        for path in sorted((HTML / "chapters").glob("*.html"))
        if 'class="question' in path.read_text("utf8")
    ]


def test_every_reply_says_something():
    from bs4 import BeautifulSoup, SoupStrainer

    of_questions = SoupStrainer(class_="question")
    assert pages_with_questions()
    for path in pages_with_questions():
        text = path.read_text("utf8")
        for box in BeautifulSoup(text, "lxml", parse_only=of_questions).select(".question"):
            replies = box.select(".replies li > div")
            assert len(replies) >= 2, box["id"]
            assert all(len(reply.get_text().split()) >= 2 for reply in replies), (
                path.name,
                box["id"],
            )
            assert len(box.select(".replies li.right")) == 1


def test_prediction_covers_what_follows_until_it_is_made(context, site):
    """Made by keyboard or not, it can be seen without committing, by a link and on paper."""
    page = opened(context, site)
    recap = page.locator(".recap .question").first
    recap.locator("input").first.focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert recap.locator(".result .verdict").is_visible()
    assert page.locator(".recap .score").inner_text().startswith("1 of ")
    name = page.evaluate("document.querySelector('.covered [id]').id")
    page.goto(f"{site}{CHAPTER}.html#{name}")
    page.reload()
    assert page.evaluate(f"document.getElementById('{name}').closest('.covered')") is None
    box = page.locator(COVERING).first
    box.get_by_role("button", name="Show the answer").click()
    assert box.locator(".replies li.right").is_visible()
    page.goto(f"{site}{CHAPTER}.html")
    label, right = box.get_attribute("id"), box.get_attribute("data-answer")
    covered = page.locator(f"#{label} + .covered")
    assert (
        covered.evaluate(
            "element => element.inert && getComputedStyle(element.firstElementChild).display"
        )
        == "none"
    )
    # One line with a word on it, never an empty field.
    assert 10 < covered.bounding_box()["height"] < 40
    box.get_by_role("button", name="That is my prediction").click()
    assert box.get_by_role("status").inner_text() == "Choose one first."
    assert label not in page.evaluate(KEPT)["pages"][CHAPTER]["answers"]
    wrong = box.locator(f'input:not([value="{right}"])').first
    wrong.check()
    box.get_by_role("button", name="That is my prediction").click()
    assert box.get_by_role("status").inner_text().startswith("Not quite.")
    assert (
        covered.count() == 0
        and page.evaluate("document.querySelectorAll('.uncovered[inert]').length") == 0
    )
    box.locator(f'input[value="{right}"]').check()
    box.get_by_role("button", name="That is my prediction").click()
    assert box.get_by_role("status").inner_text().startswith("Right.")
    stored_answer = page.evaluate(KEPT)["pages"][CHAPTER]["answers"][label]
    assert (
        stored_answer["last"] == right
        and stored_answer["right"]
        and not stored_answer["rightAtFirst"]
    )
    page.reload()
    assert page.locator(f"#{label} .result.right").is_visible()
    assert page.locator(f'#{label} input[value="{right}"]').is_checked()
    assert page.locator(f"#{label} + .covered").count() == 0
    assert violations(page, "'.question'") == []
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    assert page.locator("details.replies:not([open])").count() == 0
    assert page.locator(".covered").count() == 0
    assert not page.get_by_label("Predictions").is_visible()


def test_predictions_are_asked_open_or_left_out_as_the_reader_likes(context, site):
    page = opened(context, site)
    label = page.locator(COVERING).first.get_attribute("id")
    for way, asks, folded in (
        ("all open", True, 0),
        ("left out", False, 0),
        ("asked as they come", True, None),
    ):
        page.get_by_label("Predictions").select_option(label=way)
        page.reload()
        assert page.locator(f"#{label}").is_visible() == asks
        assert page.locator(".covered").count() == (
            page.locator(COVERING).count() if folded is None else folded
        )
        assert way != "all open" or page.locator(f"#{label} .replies li.right").is_visible()
    assert page.evaluate(KEPT).get("pages", {}).get(CHAPTER, {}).get("answers", {}) == {}


def test_reads_as_question_and_answer_without_script(browser, site):
    """Nor is anything put off that a script would have to bring."""
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"{site}{CHAPTER}.html")
    box = page.locator(".question").first
    assert box.locator("ol.choices li").count() == box.locator(".replies li").count() >= 2
    assert box.locator("details.replies").is_visible() and page.locator(".covered").count() == 0
    put_off = "(block) => getComputedStyle(block).contentVisibility"
    assert page.locator(".later").last.evaluate(put_off) == "visible"
    context.close()


def test_works_where_storage_is_forbidden(context, site):
    context.add_init_script(
        "Object.defineProperty(window, 'localStorage', {get() { throw new DOMException('no', "
        "'SecurityError'); }})"
    )
    page = context.new_page()
    faults = []
    page.on("pageerror", lambda error: faults.append(error.stack))
    page.goto(f"{site}{CHAPTER}.html")
    page.locator(".recap .question input").first.check()
    page.locator(".recap .question").first.get_by_role("button", name="Check").click()
    assert page.locator(".recap .question .result .verdict").first.is_visible()
    page.goto(f"{site}appendix/my-progress.html")
    assert "does not let the page store" in page.locator(".said").inner_text()
    assert [fault for fault in faults if "progress.js" in fault or "questions.js" in fault] == []


def test_newcomer_has_done_nothing_yet_and_sees_all_columns_on_a_telephone(context, site):
    page = opened(context, site, "appendix/my-progress")
    numbers = page.locator("table.my-progress td").all_inner_texts()
    assert len(numbers) > 50 and {text.split("of")[0].strip() for text in numbers} <= {"0", "–"}
    page.set_viewport_size({"width": 380, "height": 760})
    box = page.locator(".pst-scrollable-table-container:has(table.my-progress)")
    assert box.evaluate("(box) => box.scrollWidth - box.clientWidth") <= 0
    row = page.locator("table.my-progress tbody tr").first
    label = "(cells) => cells.map((cell) => getComputedStyle(cell, '::before').content)"
    headings = row.locator("td").evaluate_all(label)
    assert len(set(headings)) == 5 and "none" not in headings


def test_progress_is_shown_exported_cleared_and_brought_back(context, site, tmp_path):
    page = opened(context, site)
    page.locator(".exercise label.done input").first.check()
    page.locator(".recap .question input").first.check()
    page.locator(".recap .question").first.get_by_role("button", name="Check").click()
    page.locator("article > section > section").first.locator(
        ":scope > :last-child"
    ).scroll_into_view_if_needed()
    page.wait_for_function(f"({KEPT})().pages?.['{CHAPTER}']?.read.length > 0")
    page = opened(context, site, "appendix/my-progress")
    row = page.locator(f'tr[data-page="{CHAPTER}"]')

    def cell(kind):
        return row.locator(f'td[data-kind="{kind}"]').inner_text()

    assert (
        cell("done").startswith("1 of ")
        and cell("recap").startswith("1 of ")
        and " of " in cell("read")
    )
    with page.expect_download() as download:
        page.get_by_role("button", name="Export").click()
    record = json.loads(download.value.path().read_text("utf8"))
    assert record["pages"][CHAPTER]["done"]
    page.get_by_role("button", name="Clear").click()
    assert " of " in cell("done"), "the first press only asks"
    page.get_by_role("button", name="Yes, clear everything").click()
    assert cell("done").startswith("0 of ") and page.evaluate(KEPT) == {"pages": {}}
    for text in ("[1", '{"other": 1}'):
        (tmp_path / "wrong.json").write_text(text)
        page.locator("input[type=file]").set_input_files(tmp_path / "wrong.json")
        page.wait_for_function(
            "document.querySelector('.said').textContent.includes('nothing has changed')"
        )
        page.evaluate("document.querySelector('.said').textContent = ''")
    assert not page.get_by_text("earlier edition").is_visible()
    record["pages"][CHAPTER]["done"].append("exercise-of-an-earlier-edition")
    (tmp_path / "kept.json").write_text(json.dumps(record))
    page.locator("input[type=file]").set_input_files(tmp_path / "kept.json")
    page.wait_for_function(
        "document.querySelector('.said').textContent === 'Imported: your record is back.'"
    )
    assert (
        cell("done").startswith("1 of ")
        and "1 in all" in page.get_by_text("earlier edition").inner_text()
    )


def test_right_answer_of_the_checker_counts(context, site):
    """The page's Python writes its reply into the article; here the test does, for a third try."""
    page = opened(context, site)
    reply = Reply("chapters/right-handed", "correct")
    reply.tries = 3  # with the record beside it, it is never 0
    page.evaluate(
        "(reply) => document.querySelector('article').insertAdjacentHTML('beforeend', reply)",
        reply._repr_html_(),
    )
    page.wait_for_function(
        f"({KEPT})().pages?.['{CHAPTER}']?.checked.includes('chapters/right-handed')"
    )
