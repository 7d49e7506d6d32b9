"""Answers in the page: kept in two tabs, through crashes and new editions, submitted, restored."""

import csv
import json
import re
from contextlib import suppress

import nbformat
import pytest
from places import HTML, REPOSITORY
from playwright.sync_api import Error, TimeoutError
from test_live import ELSEWHERE, solution

from coursework.__main__ import main as coursework
from coursework.authoring.release import LEFT_OPEN
from notebook_pages.lite import fingerprint_of_code
from notebook_pages.live.cells import kinds_of_cells
from notebook_pages.take_away import notebook_address

EXERCISE, CHAPTER = "exercises/simple-orientations", "chapters/successive-orientations"
BLANK = "A_C_N = ...  # your answer"
# Cells of the exercise, from 1. Each answer follows the cell that shows its question.
ANSWER, OTHER = 3, 6
CODES = """() => [...document.querySelectorAll('div.cell')].map((cell) =>
  cell.querySelector('.cm-content')?.innerText ?? cell.querySelector('.cell_input pre').textContent)"""
KEPT = (
    "() => Object.fromEntries(Object.entries(localStorage).filter(([key]) => / (answer|earlier) "
    "/.test(key)))"
)


@pytest.fixture
def context(browser):
    made = browser.new_context(viewport={"width": 1300, "height": 900}, accept_downloads=True)
    made.route(ELSEWHERE, lambda route: route.abort())
    yield made
    made.close()


class Tab:
    """A page of the book in one tab."""

    def __init__(self, context, site, name=EXERCISE):
        self.page = context.new_page()
        self.errors = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(f"{site}{name}.html")
        self.page.wait_for_selector("button.run-cell", state="attached")

    def edit(self):
        """Open the editors and the bar, as the first Run or a stored answer does, without Python."""
        # Answers have their editors at once, but the bar appears only when it has something to say.
        if self.page.locator(".live-bar").is_hidden():
            self.page.route("**/pyodide*", lambda route: route.abort())
            self.page.evaluate("document.querySelector('button.run-cell').click()")
            self.page.locator(".live-bar").wait_for()
        self.page.wait_for_selector(".cm-content", state="attached")
        self.page.wait_for_function("!document.querySelector('html.live-busy')")
        return self

    def write(self, number, code):
        cell = self.page.locator("div.cell").nth(number - 1)
        # Only the cells of answers have an editor from the beginning, and it may arrive just before
        # the click.
        while not cell.locator(".cm-content").count():
            with suppress(TimeoutError):
                cell.locator(".cell_input pre").click(timeout=2000)
        cell.locator(".cm-content").focus()
        self.page.keyboard.press("Control+a")
        self.page.keyboard.insert_text(code)
        self.wait(number, code)

    def text(self, number):
        return self.page.evaluate(CODES)[number - 1].strip("\n")

    def wait(self, number, code):
        self.page.wait_for_function(
            f"([number, code]) => ({CODES})()[number - 1].replace(/\\s/g, '') === "
            "code.replace(/\\s/g, '')",
            arg=[number, code],
        )

    def words(self):
        return self.page.inner_text("#live-words")

    def press(self, name):
        self.page.locator(".live-bar").get_by_role("button", name=name).click()

    def menu(self, action):
        self.page.evaluate("document.querySelector('details.take-away').open = true")
        self.page.click(f"button[data-answers={action}]")

    def reload(self):
        self.page.reload()
        self.page.wait_for_selector("button.run-cell", state="attached")

    def take(self, action="handIn"):
        with self.page.expect_download() as download:
            self.menu(action)
        return download.value

    def bring(self, path, action="load"):
        before = self.words()
        with self.page.expect_file_chooser() as chooser:
            self.menu(action)
        chooser.value.set_files(path)
        self.page.wait_for_function(
            "before => document.querySelector('#live-words').textContent !== before", arg=before
        )

    def shown(self):
        """Everything that the page lets its reader see again: editors, offers, earlier text."""
        return "\n".join(
            [*self.page.evaluate(CODES), *self.page.locator(".live-choice pre").all_text_contents()]
        )


# --- two tabs, reloads, the book's code -----------------------------------------------------------


def test_two_tabs_share_their_answers(context, site):
    first, second = Tab(context, site).edit(), Tab(context, site).edit()
    first.write(ANSWER, "first = 1")
    second.write(OTHER, "second = 2")
    first.wait(OTHER, "second = 2")
    second.wait(ANSWER, "first = 1")
    first.reload()
    first.wait(ANSWER, "first = 1")
    first.wait(OTHER, "second = 2")
    second.write(ANSWER, "first = 10")
    # The tab crashes before it can answer.
    with second.page.expect_event("crash"), suppress(Error):
        second.page.goto("chrome://crash")
    first.wait(ANSWER, "first = 10")
    assert first.errors == second.errors == []
    # Tabs are notified late: the other one, simulated here, changes what it does not know.
    other_tab = context.new_page()
    other_tab.goto(f"{site}search.html")
    change = (
        "([key, text]) => text === null ? localStorage.removeItem(key) : "
        "localStorage.setItem(key, text)"
    )

    def written(code):
        first.write(ANSWER, code)
        kept = first.page.evaluate(KEPT).items()
        [(key, entry)] = [item for item in kept if re.search(f" answer .* {CRANK}$", item[0])]
        return key, json.loads(entry)

    key, entry = written("mine = 1")
    other_tab.evaluate(change, [f"{key}-of-none", json.dumps(entry)])  # news of something else
    first.wait(ANSWER, "mine = 1")
    other_tab.evaluate(change, [f"{key}-of-none", None])
    other_tab.evaluate(change, [key, None])  # it took the book's code for that of the page
    first.wait(ANSWER, BLANK)
    assert "mine = 1" in first.shown()
    key, entry = written("mine = 2")
    other_tab.evaluate(change, [key, json.dumps(entry | {"code": "theirs = 1"})])
    first.wait(ANSWER, "theirs = 1")
    assert "mine = 2" in first.shown()
    key, entry = written("mine = 3")
    late = json.dumps(entry | {"code": "theirs = 2"})
    first.page.evaluate(
        "([key, newValue]) => dispatchEvent(new StorageEvent('storage', { key, newValue }))",
        [key, late],
    )
    assert first.text(ANSWER) == "mine = 3" and "theirs = 2" in first.shown()
    assert first.errors == []


def test_text_of_a_tab_that_slept_is_set_aside(context, site):
    """A tab that has missed another tab's text replaces it, but loses nothing."""
    tab = Tab(context, site).edit()
    tab.write(ANSWER, "mine = 1")
    (key, entry) = next(iter(tab.page.evaluate(KEPT).items()))
    elsewhere = json.loads(entry) | {"code": "theirs = 2"}
    tab.page.evaluate(
        "([key, text]) => localStorage.setItem(key, text)", [key, json.dumps(elsewhere)]
    )
    tab.write(ANSWER, "mine = 3")
    tab.reload()
    tab.wait(ANSWER, "mine = 3")
    tab.page.click(".live-earlier summary")
    assert "theirs = 2" in tab.page.inner_text(".live-earlier")
    tab.page.get_by_role("button", name="Bring it back").click()
    tab.wait(ANSWER, "theirs = 2")
    assert "mine = 3" in tab.shown()
    # Where it cannot be set aside, it is not replaced.
    theirs = f"theirs = {'3' * 200}"
    tab.page.evaluate(
        "([key, text]) => localStorage.setItem(key, text)",
        [key, json.dumps(json.loads(entry) | {"code": theirs})],
    )
    fill(tab)
    tab.write(ANSWER, "mine = 2")
    assert "no room left" in tab.words()
    Tab(context, site).wait(ANSWER, theirs)


def test_keys_carry_the_path_of_the_site(context, site):
    """Editions of two years at one address do not share answers."""
    context.route(
        "**/2027/**", lambda route: route.continue_(url=route.request.url.replace("/2027/", "/"))
    )
    Tab(context, site).edit().write(ANSWER, "of this year = 1")
    next_year = Tab(context, f"{site}2027/").edit()
    assert next_year.text(ANSWER) == BLANK
    next_year.write(ANSWER, "of the next = 1")
    assert {key.split()[1] for key in next_year.page.evaluate(KEPT)} == {"/", "/2027/"}


def test_books_code_asks_and_can_be_undone(context, site):
    tab = Tab(context, site).edit()
    tab.write(ANSWER, "mine = 1")
    tab.write(OTHER, "mine = 2")
    tab.press("Book’s code")
    assert "2 cells" in tab.words() and tab.text(ANSWER) == "mine = 1"
    tab.press("Keep mine")
    assert tab.text(ANSWER) == "mine = 1"
    tab.press("Book’s code")
    tab.press("Bring it back")
    tab.wait(ANSWER, BLANK)
    tab.press("Undo")
    tab.wait(ANSWER, "mine = 1")
    tab.wait(OTHER, "mine = 2")
    tab.write(ANSWER, "mine = 3")
    fill(tab)  # what is set aside needs no room
    tab.press("Book’s code")
    tab.press("Bring it back")
    tab.reload()  # too late for Undo: each cell still has its own text
    tab.page.locator(".live-earlier summary").first.wait_for()
    assert tab.page.locator(".live-earlier").count() == 2
    assert all(f"mine = {number}" in tab.shown() for number in (1, 2, 3))
    assert tab.text(ANSWER) == BLANK


# --- hand in and load, back up and restore --------------------------------------------------------


@pytest.mark.long
def test_page_is_handed_in_and_graded(context, site, tmp_path):
    tab = Tab(context, site).edit()
    right = re.sub("### (BEGIN|END) SOLUTION\n?", "", solution("simple-orientations/crank")).strip()
    who = tab.text(1).replace(LEFT_OPEN, "student('ada')")
    tab.write(1, who)  # the numbers are her own
    tab.write(ANSWER, right)
    download = tab.take()
    assert download.suggested_filename == "simple-orientations.ipynb"
    assert "2 cells of this page" in tab.words()
    handed_in = tmp_path / "class" / "ada" / "simple-orientations.ipynb"
    handed_in.parent.mkdir(parents=True)
    download.save_as(handed_in)
    submitted, original = (
        nbformat.read(path, as_version=4) for path in (handed_in, REPOSITORY / f"{EXERCISE}.ipynb")
    )
    nbformat.validate(submitted)
    assert [cell.metadata for cell in submitted.cells] == [cell.metadata for cell in original.cells]
    changed = [
        k
        for k, (mine, theirs) in enumerate(zip(submitted.cells, original.cells))
        if mine.source != theirs.source
    ]
    assert [submitted.cells[k].source for k in changed] == [who, right]
    coursework(["grade", str(tmp_path / "class"), "--out", str(tmp_path / "out")])
    with open(tmp_path / "out" / "grades.csv", newline="", encoding="utf8") as table:
        (row,) = csv.DictReader(table)
    assert (float(row["points"]), row["simple-orientations/crank: outcome"]) == (2, "correct")


def test_notebook_that_is_taken_away_says_whose_it_is(context, site, tmp_path):
    """On a laptop, the questions have the numbers that the reader had on the page."""
    tab = Tab(context, site).edit()
    before = tab.text(1)
    tab.page.evaluate("bookStore.put('coursework me.txt', { text: 'Ada O\\'Hara', at: 1 })")
    tab.write(ANSWER, "mine = 1")
    tab.take().save_as(tmp_path / "mine.ipynb")
    cells = nbformat.read(tmp_path / "mine.ipynb", as_version=4).cells
    codes = [cell.source for cell in cells if cell.cell_type == "code"]
    assert 'student("Ada O\'Hara")' in codes[0] and LEFT_OPEN in before
    assert codes[ANSWER - 1] == "mine = 1" and "1 cell of this page" in tab.words()
    tab.bring(tmp_path / "mine.ipynb")
    tab.wait(1, before)  # its ID is in the notebook alone
    assert tab.words() == "Nothing differs." and tab.errors == []


def test_notebook_is_loaded_back(context, site, tmp_path):
    tab = Tab(context, site).edit()
    tab.write(1, "imports = 'mine'")
    tab.write(ANSWER, "answer = 'mine'")
    path = tmp_path / "mine.ipynb"
    tab.take().save_as(path)
    tab.write(ANSWER, "answer = 'newer'")
    tab.bring(path)
    tab.wait(ANSWER, "answer = 'mine'")
    assert "answer = 'newer'" in tab.shown()
    # Add a cell of one's own among the others, as from JupyterLab.
    with_more = nbformat.read(path, as_version=4)
    with_more.cells.insert(2, nbformat.v4.new_code_cell("scratch = 1"))
    with_more.cells[-1].source += "  # seen"
    nbformat.write(with_more, path)
    tab.bring(path)
    assert "1 cell of yours" in tab.words()
    # In a new notebook, nothing says which cell is which.
    codes = [cell.source for cell in with_more.cells if cell.cell_type == "code"]
    pasted = nbformat.v4.new_notebook(cells=[*map(nbformat.v4.new_code_cell, codes)])
    nbformat.write(pasted, tmp_path / "pasted.ipynb")
    path.write_text("no notebook", "utf8")
    for file, words in (
        (tmp_path / "pasted.ipynb", "We cannot tell what the file has for 2 cells of this page:"),
        (path, "not a notebook"),
        (HTML / notebook_address(CHAPTER), "not the notebook of this page"),
    ):
        tab.bring(file)
        assert words in tab.words()
    assert tab.text(ANSWER) == "answer = 'mine'" and tab.errors == []


@pytest.mark.long
def test_chapter_is_taken_away_and_loaded(context, site, browser, tmp_path):
    tab = Tab(context, site, CHAPTER).edit()
    tab.write(3, "mine = 3")
    tab.take().save_as(tmp_path / "mine.ipynb")
    other_context = browser.new_context()
    fresh = Tab(other_context, site, CHAPTER)
    fresh.bring(tmp_path / "mine.ipynb")
    fresh.wait(3, "mine = 3")
    other_context.close()


@pytest.mark.long
def test_everything_is_backed_up_and_restored(context, site, browser, tmp_path):
    tab = Tab(context, site).edit()
    tab.write(ANSWER, "answer = 1")
    Tab(context, site, CHAPTER).edit().write(3, "chapter = 3")
    visit_notebook(tab.page, site, EXERCISE, {"simple-orientations-boom": "boom = 2"})
    download = tab.take("backUp")
    assert "2 answers and 1 notebook" in tab.words()
    download.save_as(tmp_path / "all.json")
    other_context = browser.new_context()
    fresh = Tab(other_context, site).edit()
    fresh.write(ANSWER, "answer = 'newer'")
    fresh.bring(tmp_path / "all.json", "restore")
    assert fresh.text(ANSWER) == "answer = 'newer'" and "answer = 1" in fresh.shown()
    fresh.reload()
    fresh.wait(OTHER, "boom = 2")
    Tab(other_context, site, CHAPTER).wait(3, "chapter = 3")
    fresh.bring(HTML / notebook_address(CHAPTER), "restore")
    assert "not a backup" in fresh.words()
    other_context.close()


# --- the page and its notebook --------------------------------------------------------------------

CHANGE_COPY = """async ([path, changes]) => {
  const settled = (request) => new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
  const [name] = (await indexedDB.databases()).map(({ name }) => name).filter((name) => name.startsWith('JupyterLite'));
  if (!name) return undefined;
  const database = await settled(indexedDB.open(name));
  const copy = database.objectStoreNames.contains('files')
    ? await settled(database.transaction('files').objectStore('files').get(path)) : undefined;
  if (!copy) return database.close();
  const text = (cell) => [cell.source].flat().join('');
  for (const cell of copy.content.cells) {
    const code = changes?.[cell.metadata.nbgrader?.grade_id];
    if (code !== undefined) cell.source = code;
  }
  if (changes) {
    copy.last_modified = new Date().toISOString();
    await settled(database.transaction('files', 'readwrite').objectStore('files').put(copy, path));
  }
  database.close();
  return copy.content.cells.map((cell) => [cell.metadata.nbgrader?.grade_id ?? null, text(cell)]);
}"""
WRITE_COPY = """async ([path, content]) => {
  const settled = (request) => new Promise((resolve) => (request.onsuccess = () => resolve(request.result)));
  const opening = indexedDB.open('JupyterLite Storage - /lite/', 1);
  opening.onupgradeneeded = () => opening.result.createObjectStore('files');
  const database = await settled(opening);
  const now = new Date().toISOString();
  const copy = { name: path, path, last_modified: now, created: now, format: 'json', mimetype: 'application/json',
    content, size: 1, writable: true, type: 'notebook' };
  await settled(database.transaction('files', 'readwrite').objectStore('files').put(copy, path));
  database.close();
}"""


READ_COPY = """async (path) => {
  const settled = (request) => new Promise((resolve) => (request.onsuccess = () => resolve(request.result)));
  const database = await settled(indexedDB.open('JupyterLite Storage - /lite/'));
  const copy = await settled(database.transaction('files').objectStore('files').get(path));
  database.close();
  return copy.content;
}"""


def visit_notebook(page, site, name, changes=None, choose="Open the new version"):
    """Open the notebook in JupyterLite, and save its copy with ``changes`` by grade_id.

    The page's own script runs, as before JupyterLite starts; only JupyterLite itself is simulated.
    """
    tab = page.context.new_page()
    tab.goto(f"{site}search.html?path={name}.ipynb")
    start(tab, choose)
    if changes is not None and tab.evaluate(CHANGE_COPY, [f"{name}.ipynb", None]) is None:
        # JupyterLite saves the file that it was given.
        served = json.loads((HTML / "lite" / "files" / f"{name}.ipynb").read_text("utf8"))
        tab.evaluate(WRITE_COPY, [f"{name}.ipynb", served])
    cells = tab.evaluate(CHANGE_COPY, [f"{name}.ipynb", changes])
    tab.close()
    return cells and {grade_id: text for grade_id, text in cells if grade_id}


def start(tab, choose):
    (folder,) = (HTML / "runtime").glob("scripts-*")
    script = f"/runtime/{folder.name}/notebook.js"
    tab.evaluate(
        f"() => {{ window.started = import('{script}').then((m) => m.prepare()).then(() => "
        "'done'); }"
    )
    tab.evaluate(
        """(choose) => Promise.race([window.started, new Promise((resolve) => {
          const look = () => {
            const found = [...document.querySelectorAll('.book-choice button')].find((b) => b.textContent === choose);
            if (found) { found.click(); resolve(); } else setTimeout(look, 20);
          };
          look();
        })]).then(() => window.started)""",
        choose,
    )


ALL_COPIES = """async () => {
  if (!(await indexedDB.databases()).length) return [];
  const settled = (request) => new Promise((resolve) => (request.onsuccess = () => resolve(request.result)));
  const database = await settled(indexedDB.open('JupyterLite Storage - /lite/'));
  const all = database.objectStoreNames.contains('files')
    ? await settled(database.transaction('files').objectStore('files').getAll()) : [];
  database.close();
  return all.map((copy) => [copy.path, copy.content.cells.map((cell) => [cell.source].flat().join('')).join('\\n')]);
}"""
CRANK, BOOM = "simple-orientations-crank", "simple-orientations-boom"


@pytest.mark.long
def test_answers_go_to_the_notebook_and_come_back(context, site):
    tab = Tab(context, site).edit()
    tab.write(ANSWER, "page = 1")
    assert visit_notebook(tab.page, site, EXERCISE)[CRANK] == "page = 1"
    visit_notebook(tab.page, site, EXERCISE, {BOOM: "notebook = 2"})
    tab.reload()
    tab.wait(OTHER, "notebook = 2")
    tab.wait(ANSWER, "page = 1")
    # The newer text of each side goes to the other one, cell by cell.
    tab.write(ANSWER, "page = 3")
    cells = visit_notebook(tab.page, site, EXERCISE, {BOOM: "notebook = 4"})
    assert (cells[CRANK], cells[BOOM]) == ("page = 3", "notebook = 4")
    tab.reload()
    tab.wait(ANSWER, "page = 3")
    tab.wait(OTHER, "notebook = 4")
    # The book's code, restored on the page, goes to the notebook as well.
    tab.press("Book’s code")
    tab.press("Bring it back")
    cells = visit_notebook(tab.page, site, EXERCISE)
    assert cells[CRANK] == BLANK
    assert "page = 3" in tab.shown()


def test_progress_is_one_for_pages_and_notebooks(context, site):
    """A right answer on either side counts on both, and no wrong answer and no help is lost."""
    tab = Tab(context, site)
    path = "exercises/.coursework/progress.json"
    here = {
        "a/page": {"outcome": "correct", "answers": ["1"]},
        "a/both": {"outcome": "correct", "answers": ["2"], "help": "hint"},
        "a/tried": {"outcome": "wrong", "answers": ["3", "4"], "help": "solution"},
    }
    there = {
        "a/notebook": {"outcome": "correct"},
        "a/both": {"outcome": "wrong", "answers": ["5"], "help": "mistake"},
        "a/tried": {"outcome": "wrong", "answers": ["4", "6"], "help": "hint"},
    }
    tab.page.evaluate("(text) => bookStore.keepTries(text, 1)", json.dumps(here))
    tab.page.evaluate(WRITE_COPY, [path, there])
    notebook = tab.page.context.new_page()
    notebook.goto(f"{site}search.html?path={EXERCISE}.ipynb")
    start(notebook, "")
    progress = json.loads(tab.page.evaluate("bookStore.tries().text"))
    copy = json.loads(notebook.evaluate(READ_COPY, path))
    assert progress == copy
    assert {name: entry["outcome"] for name, entry in progress.items()} == {
        "a/page": "correct", "a/notebook": "correct", "a/both": "correct", "a/tried": "wrong",
    }  # fmt: skip
    assert (sorted(progress["a/both"]["answers"]), progress["a/both"]["help"]) == (
        ["2", "5"],
        "hint",
    )
    assert (sorted(progress["a/tried"]["answers"]), progress["a/tried"]["help"]) == (
        ["3", "4", "6"],
        "solution",
    )
    # The page reads the notebook's record whenever it is opened.
    notebook.evaluate(WRITE_COPY, [path, {**progress, "a/later": {"outcome": "correct"}}])
    tab.reload()
    tab.page.wait_for_function("bookStore.tries().text.includes('a/later')")


def test_both_changed_the_newer_text_stands(context, site):
    tab = Tab(context, site).edit()
    tab.write(ANSWER, "agreed = 1")
    visit_notebook(tab.page, site, EXERCISE)
    # JupyterLite has the notebook open while the page is used.
    tab.write(ANSWER, "page = '数𝐂é'")
    tab.page.evaluate(CHANGE_COPY, [f"{EXERCISE}.ipynb", {CRANK: "notebook = 3"}])
    tab.reload()
    tab.wait(ANSWER, "notebook = 3")
    # The page names what it sets aside by its fingerprint, which Python computes too.
    assert "page = '数𝐂é'" in tab.shown() and any(
        key.endswith(fingerprint_of_code("page = '数𝐂é'")) for key in tab.page.evaluate(KEPT)
    )
    assert visit_notebook(tab.page, site, EXERCISE)[CRANK] == "notebook = 3"
    # The other way round, the text of the notebook is set aside.
    tab.page.evaluate(CHANGE_COPY, [f"{EXERCISE}.ipynb", {CRANK: "notebook = 4"}])
    tab.write(ANSWER, "page = 5")
    assert visit_notebook(tab.page, site, EXERCISE)[CRANK] == "page = 5"
    tab.reload()
    tab.wait(ANSWER, "page = 5")
    assert "notebook = 4" in tab.shown()


def newer_book(notebook):
    """Return the notebook of a new edition: an exercise is reworded, and a new one comes first."""
    changed = json.loads(json.dumps(notebook).replace(BLANK, "A_C_N = ...  # nine entries"))
    for name, (cell, _) in changed["metadata"]["book"]["cells"].items():
        if cell == CRANK:
            changed["metadata"]["book"]["cells"][name] = [
                CRANK,
                fingerprint_of_code("A_C_N = ...  # nine entries"),
            ]
    return changed


def test_old_copy_is_told_from_the_new_edition(context, site):
    tab = Tab(context, site).edit()
    tab.write(ANSWER, "crank = 1")
    tab.write(OTHER, "boom = 2")
    visit_notebook(tab.page, site, EXERCISE)
    served = json.loads((HTML / "lite" / "files" / f"{EXERCISE}.ipynb").read_text("utf8"))
    context.route(
        f"**/lite/files/{EXERCISE}.ipynb", lambda route: route.fulfill(json=newer_book(served))
    )
    cells = visit_notebook(tab.page, site, EXERCISE, choose="Open my copy as it is")
    assert (cells[CRANK], cells[BOOM]) == ("crank = 1", "boom = 2")
    # The next visit asks again.
    cells = visit_notebook(tab.page, site, EXERCISE, choose="Open the new version")
    assert (cells[CRANK], cells[BOOM]) == ("A_C_N = ...  # nine entries", "boom = 2")
    old = next(content for path, content in tab.page.evaluate(ALL_COPIES) if "my copy of" in path)
    assert "crank = 1" in old and "boom = 2" in old


def test_what_was_written_for_a_question_that_is_gone_stands_in_no_other_cell(context, site):
    """The next edition lacks a question: its answer is shown, named, and put into no cell."""
    tab = Tab(context, site)
    gone = {"code": "gone = 1", "number": OTHER, "original": "of code that is gone", "at": 1}
    tab.page.evaluate(
        "([page, entry]) => bookStore.put(`answer ${page} simple-orientations-gone`, entry)",
        [EXERCISE, gone],
    )
    tab.reload()
    box = tab.page.locator(".live-choice", has_text="simple-orientations-gone")
    box.wait_for()
    assert "gone = 1" in box.inner_text() and "has changed" not in box.inner_text()
    assert tab.page.locator("div.cell .live-choice", has_text="gone = 1").count() == 0
    box.get_by_role("button").click()
    assert "gone = 1" not in tab.shown()
    tab.reload()
    tab.edit()
    assert "gone = 1" not in tab.shown() and "gone = 1" in json.dumps(tab.page.evaluate(KEPT))
    assert tab.errors == []


def test_copies_of_one_minute_stand_beside_each_other(context, site):
    """The names of copies contain only the minute, which does not distinguish them."""
    tab = Tab(context, site)
    served = json.loads((HTML / "lite" / "files" / f"{EXERCISE}.ipynb").read_text("utf8"))
    visit_notebook(tab.page, site, EXERCISE, {CRANK: "first = 1"})
    editions = [newer_book(served), served]
    context.route(f"**/lite/files/{EXERCISE}.ipynb", lambda route: route.fulfill(json=editions[0]))
    for mine in ("second = 2", "third = 3"):
        visit_notebook(tab.page, site, EXERCISE)
        tab.page.evaluate(CHANGE_COPY, [f"{EXERCISE}.ipynb", {CRANK: mine}])
        del editions[0]
    copies = tab.page.evaluate(ALL_COPIES)
    for mine in ("first = 1", "second = 2", "third = 3"):
        assert any(mine in content for _, content in copies), [path for path, _ in copies]


# --- where nothing can be kept --------------------------------------------------------------------


def test_reader_is_told_that_nothing_can_be_kept(browser, site):
    context = browser.new_context()
    context.add_init_script(
        "for (const name of ['localStorage', 'sessionStorage']) Object.defineProperty(window, name,"
        " { configurable: true, get() { throw new DOMException('denied', 'SecurityError'); } });"
    )
    tab = Tab(context, site).edit()
    tab.write(ANSWER, "mine = 1")
    assert "does not let this page store anything" in tab.words() and "Take away" in tab.words()
    path = tab.take().path()
    assert "mine = 1" in path.read_text("utf8")
    assert tab.errors == []
    context.close()


def fill(tab):
    """Fill the browser's storage."""
    tab.page.evaluate(
        "() => { let k = 0, text = 'x'.repeat(4e6); while (text.length > 4) { try { "
        "localStorage.setItem(`filler ${k++}`, text); } catch { text = text.slice(0, text.length / "
        "2); } } }"
    )


# as when the reader comes back to the tab
AWAKE = "() => document.dispatchEvent(new Event('visibilitychange'))"
EMPTY = """() => Object.keys(localStorage).filter((key) => key.startsWith('filler'))
  .forEach((key) => localStorage.removeItem(key))"""


def test_what_found_no_room_stays_on_the_page_and_can_be_taken_away(context, site):
    tab, other_tab = Tab(context, site).edit(), Tab(context, site).edit()
    tab.write(ANSWER, "mine = 1")
    other_tab.wait(ANSWER, "mine = 1")
    fill(tab)
    long = f"mine = {'2' * 200}"
    tab.write(ANSWER, long)
    assert "no room left" in tab.words()
    # The tab is left and resumed, and another one changes the stored text: neither removes the
    # text.
    tab.page.evaluate(AWAKE)
    tab.page.evaluate("addEventListener('storage', () => (window.heard = true))")
    other_tab.write(ANSWER, "mine = 9")  # as long as before: there is room for that
    tab.page.wait_for_function("window.heard")
    assert tab.text(ANSWER) == long
    assert long in tab.take().path().read_text("utf8"), "as the page says"
    # There is room again, so it is stored with the next letter.
    tab.page.evaluate(EMPTY)
    tab.write(ANSWER, f"{long}0")
    other_tab.wait(ANSWER, f"{long}0")
    assert "mine = 9" in other_tab.shown()
    assert tab.errors == other_tab.errors == []


@pytest.mark.long
def test_stored_number_does_not_stand_under_other_code(context, site):
    """Without NumPy, the book's result is folded away from below the reader's changed code."""
    page = "chapters/measured-matrices"
    tab = Tab(context, site, page)
    with_results = tab.page.evaluate(
        "[...document.querySelectorAll('div.cell')].map((cell) => !cell.closest('[inert]') && "
        "!!cell.querySelector('.cell_output'))"
    )
    number = next(
        place
        for place, cell in enumerate(kinds_of_cells()[page], 1)
        if "numpy" in cell["needs"] and with_results[place - 1]
    )
    tab.page.click(f"button.run-cell >> nth={number - 1}")
    cell = tab.page.locator("div.cell").nth(number - 1)
    cell.locator(".live-note").wait_for(timeout=120_000)
    tab.page.wait_for_function("document.querySelector('html.live-busy') === null", timeout=120_000)
    assert cell.locator("details.live-built").count() == 0, "the book's code has the book's result"
    tab.write(number, "import numpy as np\nnp.fft.fft([1, 2])")
    tab.page.keyboard.press("Shift+Enter")
    cell.locator("details.live-built").wait_for(timeout=120_000)
    assert not cell.locator("details.live-built > .output").is_visible()
    assert "The result of the book’s code" in cell.inner_text()
