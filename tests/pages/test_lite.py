"""Notebooks in the browser: JupyterLite opens a chapter and an exercise, and runs them offline."""

import json
import math
import re

import nbformat
import pytest
from places import HTML, REPOSITORY
from test_live import ELSEWHERE, solution
from test_release import COURSE

from coursework.checking.questions import notebook_questions
from coursework.checking.variants import variant_of
from notebook_pages.lite import FOLDER, LOCK
from notebook_pages.live import runtime
from notebook_pages.live.cells import kinds_of_cells, names_bound, names_taken, stored_outputs
from notebook_pages.take_away import notebook_pages

LITE = HTML / FOLDER
PATIENCE = 120_000  # milliseconds, for a busy machine; nothing waits longer than it must
CHAPTER, EXERCISE = "chapters/gimbal-lock", "exercises/simple-orientations"
SETTINGS = json.loads((LITE / "jupyter-lite.json").read_text("utf8"))["jupyter-config-data"]
KERNEL = SETTINGS["litePluginSettings"]["@jupyterlite/pyodide-kernel-extension:kernel"]


def notebook(page):
    return nbformat.read(LITE / "files" / f"{page}.ipynb", as_version=4)


def codes(page):
    return [cell.source for cell in notebook(page).cells if cell.cell_type == "code"]


# --- what is there --------------------------------------------------------------------------------


def test_every_notebook_is_there_and_its_page_opens_it():
    assert len(notebook_pages()) > 30
    for page in notebook_pages():
        link = re.search(
            r'<a [^>]*open-notebook[^>]*href="([^"]*)"', (HTML / f"{page}.html").read_text("utf8")
        )[1]
        up = "../" * page.count("/")
        assert link == f"{up}{FOLDER}/notebooks/index.html?path={page}.ipynb"
        nbformat.validate(notebook(page))


@pytest.mark.parametrize("page", notebook_pages())
def test_notebook_is_the_page_ready_to_run(page):
    """Exercises are as released; chapters have all their code, and a note where NumPy is needed."""
    source = nbformat.read(REPOSITORY / f"{page}.ipynb", as_version=4)
    if page.startswith("exercises/"):
        released = notebook(page)
        assert set(released.metadata.pop("book")["cells"]) == {
            c.id for c in source.cells if c.cell_type == "code"
        }
        assert released == source
        return
    assert "pip install" not in notebook(page).cells[0].source
    announced = [
        cell.get("id") == "numpy" for cell in notebook(page).cells if cell.cell_type == "code"
    ]
    kinds = kinds_of_cells()[page]
    needs = [
        kind["numpy"] or "numpy" in kind["needs"] or "matplotlib" in kind["needs"] for kind in kinds
    ]
    if any(needs):
        assert announced.index(True) == needs.index(True)
        # The note comes before all code that imports it.
        before = "\n".join(codes(page)[: needs.index(True)])
        assert "import numpy" not in before and "from numpy" not in before
    expected = [cell.source for cell in source.cells if cell.cell_type == "code"]
    assert [code for code, new in zip(codes(page), announced) if not new] == expected


def test_the_interface_leaves_the_pages_their_dates():
    """A page that is older than its source is written again by the next build.

    Once this happened to all, since JupyterLite gives the files beside it the date of the commit.
    """
    younger = [
        page
        for page in notebook_pages()
        if (HTML / f"{page}.html").stat().st_mtime < (REPOSITORY / f"{page}.ipynb").stat().st_mtime
    ]
    assert younger == [], "`make book` has not come to an end since these were changed"


def test_the_kernel_loads_what_the_site_serves():
    packages = json.loads((HTML / runtime.FOLDER / LOCK).read_text("utf8"))["packages"]
    loaded = KERNEL["loadPyodideOptions"]["packages"]
    # Without "comm" among them, the kernel hangs silently.
    assert {"sympy", "ipywidgets", "anywidget", "comm", "orientation-of-reference-frames"} <= set(
        loaded
    )
    assert all("://" not in packages[name]["file_name"] for name in loaded)


def test_nothing_is_asked_of_others_by_setting():
    address, lock = KERNEL["pyodideUrl"], KERNEL["loadPyodideOptions"]["lockFileURL"]
    assert (LITE / address.partition("?")[0]).is_file() and (
        LITE / lock.partition("?")[0]
    ).is_file()
    assert KERNEL["disablePyPIFallback"] is True


# --- in a browser ---------------------------------------------------------------------------------


class Interface:
    """A notebook of the book, opened from its page as a reader opens it."""

    def __init__(self, context, site, page):
        self.asked, self.errors = [], []
        self.site = site
        context.set_default_timeout(PATIENCE)
        context.on("request", lambda request: self.asked.append(request.url))
        context.on("weberror", lambda error: self.errors.append(str(error.error)))
        context.route(ELSEWHERE, lambda route: route.abort())
        # The tests read the interface's model of the notebook, which a reader does not need.
        shown = {**SETTINGS, "exposeAppInBrowser": True}
        settings = {"jupyter-lite-schema-version": 0, "jupyter-config-data": shown}
        context.route(f"**/{FOLDER}/jupyter-lite.json", lambda route: route.fulfill(json=settings))
        front = context.new_page()
        front.goto(f"{site}{page}.html")
        with context.expect_page() as opened:
            front.click("a.open-notebook")
        front.close()
        self.page = opened.value
        self.wait_until_open()

    def wait_until_open(self):
        self.page.wait_for_function(
            "window.jupyterapp?.shell.currentWidget?.sessionContext?.session?.kernel?.status === "
            "'idle'"
        )

    def cells(self):
        """Return the cells of the interface's model, also those that are out of sight."""
        return self.page.evaluate(
            "() => jupyterapp.shell.currentWidget.content.widgets.map(cell => cell.model.toJSON())"
        )

    def number(self, code):
        """Return the place of the cell that begins with ``code``."""
        (place,) = (
            place
            for place, cell in enumerate(self.cells())
            if "".join(cell["source"]).startswith(code)
        )
        return place

    def enter(self, place):
        """Put the cursor into the code of a cell."""
        self.page.evaluate(
            "async place => { const { content } = jupyterapp.shell.currentWidget;"
            " content.activeCellIndex = place; await content.scrollToItem(place); }",
            place,
        )
        cell = self.page.locator(".jp-Notebook .jp-Cell.jp-mod-active")
        # The code that draws a figure is folded.
        folded = self.cells()[place]["metadata"].get("jupyter", {}).get("source_hidden")
        (cell if folded else cell.locator(".cm-content")).focus()

    def run(self, place):
        """Run a cell with the keyboard, and return its output."""
        model = "jupyterapp.shell.currentWidget.content.widgets[place].model"
        self.page.evaluate(f"place => {{ {model}.executionCount = null; }}", place)
        self.enter(place)
        self.page.keyboard.press("Control+Enter")
        self.page.wait_for_function(f"place => {model}.executionCount !== null", arg=place)
        return self.cells()[place]["outputs"]

    def write(self, place, code):
        self.enter(place)
        self.page.keyboard.press("Control+a")
        self.page.keyboard.insert_text(code)
        assert "".join(self.cells()[place]["source"]) == code

    def outside(self):
        return [url for url in self.asked if not url.startswith((self.site, "data:", "blob:"))]


def reply(outputs):
    """Return the outcome and the words of a checked answer."""
    (output,) = outputs
    html = "".join(output["data"]["text/html"])
    return re.search(r'data-outcome="([^"]*)"', html)[1], html


# Some browsers cannot let Python wait for JavaScript: WebAssembly there has no stack switching.
NO_SWITCHING = (
    "delete WebAssembly.Suspending; delete WebAssembly.promising; delete WebAssembly.Suspender;"
)


@pytest.mark.long
def test_exercise_is_solved_kept_and_downloaded(browser, site):
    context = browser.new_context(viewport={"width": 1300, "height": 900}, accept_downloads=True)
    context.route(
        "**/pyodide.js?as=.mjs",
        lambda route: route.fulfill(
            body=NO_SWITCHING
            + (HTML / runtime.FOLDER / runtime.pyodide_folder() / "pyodide.js").read_text("utf8"),
            content_type="text/javascript",
        ),
    )
    interface = Interface(context, site, EXERCISE)
    assert interface.run(interface.number("import math")) == []
    interface.run(interface.number("bicycle = variant("))  # the data of the question
    answer, check = (
        interface.number(code) for code in ("A_C_N = ...", "check('simple-orientations/crank'")
    )
    right = (
        solution("simple-orientations/crank")
        .replace("### BEGIN SOLUTION\n", "")
        .replace("\n### END SOLUTION", "")
    )
    for code, outcome in (
        ("A_C_N = ...", "not attempted"),
        (f"{right}\nA_C_N = A_C_N.T", "wrong"),
        (right, "correct"),
    ):
        interface.write(answer, code)
        assert interface.run(answer) == []
        shown_outcome, html = reply(interface.run(check))
        assert shown_outcome == outcome and (outcome != "wrong" or "transpose" in html), html
    # Progress is stored beside the notebook, in this browser.
    interface.write(check, "from coursework import progress\nprogress()")
    assert "1 " in reply(interface.run(check))[1]
    interface.page.keyboard.press("Control+s")
    interface.page.wait_for_function("!jupyterapp.shell.currentWidget.context.model.dirty")
    interface.page.locator("#jp-title h1").click()
    interface.page.locator(".jp-Dialog input").press_sequentially("my crank\n")
    interface.page.wait_for_url("**/index.html?path=*crank.ipynb")
    interface.page.reload()
    interface.wait_until_open()
    assert "".join(interface.cells()[answer]["source"]) == right, "the answer outlives the page"
    interface.page.get_by_role("menuitem", name="File").click()
    with interface.page.expect_download() as download:
        interface.page.get_by_role("menuitem", name="Download", exact=True).click()
    handed_in = nbformat.reads(download.value.path().read_text("utf8"), as_version=4)
    original = nbformat.read(REPOSITORY / f"{EXERCISE}.ipynb", as_version=4).cells[answer]
    assert (right, original.metadata.get("nbgrader")) in [
        (cell.source, cell.metadata.get("nbgrader")) for cell in handed_in.cells
    ]
    assert interface.outside() == [] and interface.errors == []
    context.close()


@pytest.mark.long
def test_chapter_runs_and_its_figure_moves(browser, site):
    context = browser.new_context(viewport={"width": 1300, "height": 900})
    interface = Interface(context, site, CHAPTER)
    page = interface.page
    # The cells that the page runs without NumPy give the printed results here, too.
    stored = nbformat.read(REPOSITORY / f"{CHAPTER}.ipynb", as_version=4)
    cells = [cell for cell in stored.cells if cell.cell_type == "code"]
    ran, absent = 0, set()  # names that only cells with NumPy assign
    for cell, kind in zip(cells, kinds_of_cells()[CHAPTER], strict=True):
        if kind["needs"] or kind["numpy"] or names_taken(cell.source) & absent:
            absent |= names_bound(cell.source)
        else:
            outputs = [
                nbformat.from_dict(output)
                for output in interface.run(interface.number(cell.source))
            ]
            assert stored_outputs(cell) == stored_outputs(
                nbformat.from_dict({"outputs": outputs})
            ), cell.source
            ran += 1
    assert ran >= 7
    interface.run(interface.number("from math import radians\n\nfrom orientation_figures.moving"))
    page.get_by_label("theta in degrees", exact=True).first.wait_for()
    assert interface.outside() == []

    # Python moves a figure, and is notified when the reader does.
    place = interface.number("at_lock = M.subs")
    interface.write(place, "figure = GimbalFigure(angles=(0.1, 0.2, 0.3))\nfigure")
    interface.run(place)
    slider = (
        page.locator(".jp-Cell.jp-mod-active")
        .get_by_label("theta in degrees", exact=True)
        .element_handle()
    )
    shown = "([field, value]) => Math.abs(field.value - value) < 0.01"
    page.wait_for_function(shown, arg=[slider, 11.46])
    place = interface.number("from orientation import SEQUENCES")
    interface.write(place, "figure.angles = (0.1, 0.25, 0.3)")
    interface.run(place)
    page.wait_for_function(shown, arg=[slider, 14.32])
    slider.focus()
    page.keyboard.press("ArrowDown")
    moved = float(slider.input_value())
    assert moved < 14.32
    interface.write(place, "figure.angles[1]")
    (output,) = interface.run(place)
    assert abs(math.degrees(float("".join(output["data"]["text/plain"]))) - moved) < 0.01
    assert interface.outside() == [] and interface.errors == []

    # Where NumPy cannot be fetched, the cell that fetches it says so, and the others run.
    (output,) = interface.run(interface.number("import numpy as np"))
    assert output["output_type"] == "error"
    assert {url.split("/")[2] for url in interface.outside()} == {"cdn.jsdelivr.net"}
    place = interface.number("from orientation import angular_velocity_matrix")
    assert interface.run(place)[0]["output_type"] == "execute_result"
    context.close()


@pytest.mark.long
def test_who_works_is_said_once_for_pages_and_notebooks(browser, site):
    """An ID given on a page applies in the notebook, and the other way round."""
    question = "simple-orientations/compass"
    count = notebook_questions("simple-orientations")[question].question.variants
    ada, ben = (
        next(s for s in (f"s{k}" for k in range(99)) if variant_of(s, question, count) == n)
        for n in (3, 5)
    )
    context = browser.new_context(viewport={"width": 1300, "height": 900})
    page = context.new_page()
    page.goto(f"{site}{EXERCISE}.html")
    page.evaluate(f"bookStore.put('coursework me.txt', {{ text: '{ada}', at: 1 }})")
    interface = Interface(context, site, EXERCISE)
    first = interface.number("import math")
    interface.run(first)
    sealed = []
    interface.page.on(
        "response",
        lambda response: "/sealed-" in response.url and sealed.append(len(response.body())),
    )
    shown = next(
        k
        for k, cell in enumerate(interface.cells())
        if f'variant("{question}")' in "".join(cell["source"])
    )
    own = json.loads((COURSE.sealed / "variants" / "simple-orientations-3.json").read_text("utf8"))[
        "questions"
    ][question]
    (output,) = interface.run(shown)
    assert all(text in "".join(output["data"]["text/markdown"]) for text in own["shown"].values())
    # One small file has all questions of the exercises in the variant.
    assert len(sealed) == 1 and sealed[0] < 25_000
    interface.write(first, f"from coursework import student, variant\nstudent('{ben}')")
    assert f"You are {ben} now, and were {ada} before, " in interface.run(first)[0]["text"]
    page.reload()
    page.wait_for_selector(f".live-known:has-text('the numbers of {ben}')")
    assert interface.outside() == [] and interface.errors == []
    context.close()


@pytest.mark.long
def test_notebook_opens_where_what_brings_the_answers_has_not_come(browser, site):
    """If the script is lost once, it is requested again; if twice, the notebook opens as stored."""
    context = browser.new_context()
    asked = []

    def answer(route):
        asked.append(route.request.url)
        route.continue_() if len(asked) == 4 else route.abort()

    context.route("**/runtime/scripts-*/notebook.js*", answer)
    page = context.new_page()
    for requests in (2, 4):
        page.goto(
            f"{site}{FOLDER}/notebooks/index.html?path=chapters/successive-orientations.ipynb"
        )
        page.wait_for_selector(".jp-Notebook .jp-Cell")
        assert len(asked) == requests
    context.close()
