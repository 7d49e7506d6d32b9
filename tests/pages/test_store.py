"""The browser's data of the book are one store with one version; newer data are left alone."""

import json
import re
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

from places import REPOSITORY
from test_answers import ANSWER, BLANK, EMPTY, EXERCISE, OTHER, Tab, fill
from test_answers import context as context  # noqa: PLC0414 -- a fixture
from test_questions import CHAPTER, opened

SMALL = "exercises/orientation-filters"  # a short page, where its content does not matter
NEWER_LIST = {"format": 99, "edition": "x"}
PUT = (
    "(kept) => { for (const [key, text] of Object.entries(kept)) localStorage.setItem(key, text); }"
)
ALL = (
    "() => Object.fromEntries(Object.entries(localStorage).filter(([key]) => "
    "/^(book|progress|code) /.test(key)))"
)
HERE = "() => bookStore.record()"


def kept_before(page, site, stored):
    """Return a browser that stores ``stored`` before the page is opened."""
    page.goto(f"{site}search.html")
    page.evaluate(PUT, stored)


# --- three tabs -----------------------------------------------------------------------------------


AT_ONE_MOMENT = """([moment, number, question]) => new Promise((done) => {
  setTimeout(() => {
    for (let k = 0; k < 20; k += 1) {
      progress.change((here) => { here.read.push(`section-${number}-${k}`); here.answers[`question-${number}-${k}`]
        = { first: "A", last: "A", right: true, rightAtFirst: true }; });
      bookStore.keepTries(JSON.stringify({ [`own/${number}-${k}`]: { outcome: "correct" } }));
    }
    bookStore.keepTries(JSON.stringify({ [question]: { outcome: "wrong", answers: [`of ${number}`] } }));
    done();
  }, moment - Date.now());
})"""


def test_three_tabs_that_write_at_one_moment_lose_nothing(context, site):
    tabs = [opened(context, site, SMALL) for _ in range(3)]
    moment = (time.time() + 2) * 1000
    for number, tab in enumerate(tabs):
        tab.evaluate(
            f"(given) => {{ window.over = ({AT_ONE_MOMENT})(given); }}",
            [moment, number, "shared/one"],
        )
    for tab in tabs:
        tab.evaluate("() => window.over")
    page = opened(context, site, SMALL)
    here = page.evaluate(HERE)[SMALL]
    names = {f"{number}-{k}" for number in range(3) for k in range(20)}
    assert {f"section-{name}" for name in names} <= set(here["read"])
    assert {f"question-{name}" for name in names} <= set(here["answers"])
    tries = json.loads(page.evaluate("bookStore.tries().text"))
    assert {f"own/{name}" for name in names} <= set(tries)
    assert tries["shared/one"]["outcome"] == "wrong"


TYPE = """([moment, cell, code]) => { window.over = new Promise((done) => setTimeout(() => {
  document.querySelectorAll("div.cell")[cell - 1].querySelector(".cm-content").focus();
  document.execCommand("selectAll");
  document.execCommand("insertText", false, code);
  done();
}, moment - Date.now())); }"""


def test_three_tabs_that_type_in_one_cell_at_one_moment_lose_nothing(context, site):
    tabs = [Tab(context, site).edit() for _ in range(3)]
    moment = (time.time() + 2) * 1000
    for number, tab in enumerate(tabs):
        tab.page.evaluate(TYPE, [moment, ANSWER, f"tab = {number}"])
    for tab in tabs:
        tab.page.evaluate("() => window.over")
    tabs[0].page.wait_for_function(
        "(texts) => texts.every((text) => "
        "JSON.stringify(Object.values(localStorage)).includes(text))",
        arg=[f"tab = {number}" for number in range(3)],
    )
    assert [tab.errors for tab in tabs] == [[], [], []]


def test_what_a_run_takes_away_of_its_own_stays_away(context, site):
    """Only text that another tab has written meanwhile is joined; a reviewed mistake is gone."""
    page = opened(context, site, SMALL)
    keep = (
        "([text, base]) => bookStore.keepTries(JSON.stringify(text), Date.now(), base && "
        "JSON.stringify(base))"
    )
    before = {"q": {"mistake": "transposed", "outcome": "wrong"}}
    page.evaluate(keep, [before, None])
    after = {"q": {"outcome": "correct"}}
    page.evaluate(keep, [after, before])
    assert json.loads(page.evaluate("bookStore.tries().text")) == after
    # A tab that began earlier writes now.
    page.evaluate(keep, [{"q": {"outcome": "wrong", "answers": ["a"]}}, before])
    assert json.loads(page.evaluate("bookStore.tries().text"))["q"]["outcome"] == "correct"


# --- full, and newer ------------------------------------------------------------------------------


def test_full_storage_stops_nothing(context, site):
    page = context.new_page()
    faults = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.goto(f"{site}{CHAPTER}.html")
    fill(SimpleNamespace(page=page))
    page.locator(".exercise label.done input").last.check()
    assert len(page.evaluate(HERE)[CHAPTER]["done"]) == 1, "as long as the page lasts"
    page.evaluate(EMPTY)
    page.locator(".exercise label.done input").first.check()
    page.reload()
    assert len(page.evaluate(HERE)[CHAPTER]["done"]) >= 1
    assert faults == []


def test_what_a_newer_edition_has_kept_is_left_alone_and_said(context, site):
    newer = {
        "book / version": "99",
        f"book / answer {EXERCISE} simple-orientations-crank": '"in a form of its own"',
        "book / record whole": "[1, 2, 3]",
        "book / question x": "7",
    }
    page = context.new_page()
    kept_before(page, site, newer)
    before = page.evaluate(ALL)
    page.evaluate(
        "async (list) => (await caches.open('book /')).put('/kept.json', new Response(list))",
        json.dumps(NEWER_LIST),
    )
    page.goto(f"{site}{CHAPTER}.html")
    page.locator(".exercise label.done input").first.check()
    tab = Tab(context, site)
    assert tab.words().startswith("A newer edition of this book")
    assert tab.edit().text(ANSWER) == BLANK
    tab.write(OTHER, "mine = 1")
    assert "A newer edition" in tab.words() and "Take away" in tab.words()
    assert "mine = 1" in tab.take().path().read_text("utf8")
    tab.menu("backUp")
    tab.page.wait_for_function(
        "document.querySelector('#live-words').textContent.startsWith('A newer edition')"
    )
    tab.page.evaluate("document.querySelector('button.keep-book').click()")
    tab.page.wait_for_function("!document.querySelector('.live-choices button')")
    page.goto(f"{site}appendix/my-progress.html")
    assert page.locator(".said").inner_text().startswith("A newer edition")
    assert page.evaluate(ALL) == before
    stored_list = page.evaluate(
        "async () => (await (await caches.open('book /')).match('/kept.json')).json()"
    )
    assert stored_list == NEWER_LIST
    assert tab.errors == []


def test_backup_of_a_newer_edition_is_refused_in_words(context, site, tmp_path):
    tab = Tab(context, site).edit()
    path = tmp_path / "answers.json"
    path.write_text(
        json.dumps({"kind": "answers to the exercises of a book", "version": 99, "kept": {}})
    )
    tab.bring(path, "restore")
    assert "newer edition" in tab.words() and "nothing was changed" in tab.words()


def test_no_other_script_asks_the_browser_to_keep_anything():
    """Exceptions are data that end with the tab, and the page's head, which works without storage."""
    asks = re.compile(r"\blocalStorage\b|\bindexedDB\b|\bcaches\.|document\.cookie")
    sources = [
        path
        for path in (REPOSITORY / "packages" / "notebook-pages" / "src").rglob("*.js")
        if "node_modules" not in path.parts
    ]
    sources += (REPOSITORY / "packages" / "orientation-lab" / "src").rglob("*.js")
    scripts = {
        path.name for path in sources if asks.search(re.sub(r"//.*", "", path.read_text("utf8")))
    }
    assert scripts == {"store.js", "editions.js", "notebooks.js"}


NAME = "levers/see-saw"


def test_page_and_notebook_join_no_records_of_different_variants(tmp_path):
    script = REPOSITORY / "packages/notebook-pages/src/notebook_pages/live/js/store.js"
    call = "\nconsole.log(joinProgress(...process.argv.slice(2)));"
    (tmp_path / "join.mjs").write_text(script.read_text("utf8") + call, "utf8")

    def joined(*records):
        texts = [json.dumps({NAME: record}) for record in records]
        node = Path(sys.executable).with_name("node")
        done = subprocess.run(
            [node, tmp_path / "join.mjs", *texts], capture_output=True, check=True, text=True
        )
        return json.loads(done.stdout)[NAME]

    before = {"outcome": "correct", "help": "hint", "answers": ["a"]}
    after = {"outcome": "wrong", "variant": 3, "answers": ["b"]}
    assert joined(before, after) == {**after, "other variants": {"0": before}}
    record = {**after, "other variants": {"0": before}}
    assert joined(record, {**after, "answers": ["c"]}) == {**record, "answers": ["b", "c"]}
    # Two editions have different numbers in the same place, and the record keeps whose they were.
    first = {"outcome": "correct", "variant": 3, "numbers": "aa", "whose": "ada"}
    second = {"outcome": "wrong", "variant": 3, "numbers": "bb", "whose": "ada", "answers": ["d"]}
    everybodys = {**before, "numbers": "00", "whose": ""}
    assert joined(first, second) == {**second, "other variants": {"3": first}}
    assert joined({**everybodys, "other variants": {"3": second}}, first) == {
        **first,
        "other variants": {"0": everybodys, "3": second},
    }
    assert joined({**first, "other variants": {"3": second}}, {**second, "answers": ["e"]}) == {
        **second,
        "answers": ["d", "e"],
        "other variants": {"3": first},
    }
