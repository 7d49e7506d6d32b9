"""Code in the page: every cell, a student's input, and the browser's requests."""

import gzip
import hashlib
import json
import math
import re
import threading
import zipfile

import nbformat
import pytest
from places import HTML, REPOSITORY, html_pages
from playwright.sync_api import expect
from test_site import NARROW, SIDEWAYS, WIDE, Visit, violations

from coursework.authoring.release import LEFT_OPEN
from coursework.checking.questions import notebook_questions
from coursework.checking.variants import variant_of
from notebook_pages import lite
from notebook_pages.browser import FLAGS, find
from notebook_pages.execution import STORED
from notebook_pages.lighten import in_short
from notebook_pages.live import runtime, scripts
from notebook_pages.live.cells import kinds_of_cells, on_the_page
from notebook_pages.live.fetch import fetch
from notebook_pages.notebooks import all_notebooks
from notebook_pages.serve import Handler, server

PAGES = [name for name in html_pages() if 'id="live-data"' in (HTML / name).read_text("utf8")]
ELSEWHERE = "https://cdn.jsdelivr.net/**"
# This page has cells with and without NumPy, and runs quickly.
QUIET = "chapters/successive-orientations.html"

# The results of a page, as the reader sees them: each cell's output, without intentional
# differences.
RESULTS = r"""() => [...document.querySelectorAll('div.cell')].map((cell) => {
  const output = cell.querySelector(':scope > .cell_output');
  if (!output) return '';
  const copy = output.cloneNode(true);
  // The build writes a formula in fewer words than KaTeX; what is set is the same. It keeps the TeX of those alone
  // that stand by themselves.
  copy.querySelectorAll('.katex').forEach((formula) => {
    const tex = formula.querySelector('annotation');
    tex?.remove();
    const alone = formula.parentElement.matches('.katex-display');
    formula.replaceChildren(alone ? formula.dataset.tex ?? tex.textContent : formula.querySelector('math').textContent);
  });
  // Browsers translate neither: the build says so of each formula, a run of the box around it.
  copy.querySelectorAll('.katex').forEach((formula) => (formula.removeAttribute('data-tex'), formula.removeAttribute('translate')));
  copy.querySelectorAll('.math.display').forEach((box) => box.classList.remove('notranslate'));
  // The figures of a built page share one style, and one set of outlines for their letters.
  // They are compared as text, since a browser fetches what stands in the href of a `use`.
  copy.querySelectorAll('use').forEach((use) => use.replaceWith(`${use.getAttribute('transform')} ${
    document.getElementById(use.getAttribute('href').slice(1))?.getAttribute('d')}`));
  copy.querySelectorAll('svg defs, figure style').forEach((shared) => shared.remove());
  // A script stands in the built page, and comes as a file with what Python gives.
  copy.querySelectorAll('script').forEach((script) => script.remove());
  copy.querySelectorAll('*').forEach((box) => 
    ['tabindex', 'role', 'aria-label', 'data-name'].forEach((n) => box.removeAttribute(n)));
  // The build keeps a formula and the comma after it in one line, and gives Markdown no box of its own.
  copy.querySelectorAll('span.together, .output.text_markdown').forEach((box) => box.replaceWith(...box.childNodes));
  copy.querySelectorAll('pre > span:empty, button.copybtn').forEach((extra) => extra.remove());
  copy.querySelectorAll('pre').forEach((pre) => pre.removeAttribute('id'));
  return copy.innerHTML.replace(/\s+/g, ' ').replace(/> </g, '><').replace(/ <\/pre>/g, '</pre>').trim();
})"""
# Animated drawings have their controls.
PLAYABLE = "() => !document.querySelector('figure[data-moving]:not([data-ready])')"
RAN = (
    "() => document.querySelector('div.cell.running, div.cell.waiting, html.live-busy') === null "
    "&& document.querySelector('#live-words')?.textContent !== ''"
)


opened = []


@pytest.fixture(autouse=True)
def close_pages():
    """Close the pages of a test even if it fails, because a forgotten page keeps working."""
    yield
    while opened:
        page = opened.pop()
        page.evaluate("location.protocol === 'file:' || localStorage.clear()")
        page.close()


# Cells covered by predictions are folded; open them to try everything.
UNFOLD = """() => document.querySelectorAll('.covered').forEach((box) => {
  box.inert = false;
  box.className = 'uncovered';
})"""


class Page:
    """A page of the book in a browser, used as a reader uses it."""

    def __init__(self, context, site, name, refuse=True):
        self.page = context.new_page()
        opened.append(self.page)
        self.asked, self.errors = [], []
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        if refuse:
            self.page.route(ELSEWHERE, lambda route: route.abort())
        self.page.goto(site + name)
        self.page.wait_for_selector("button.run-cell", state="attached")
        self.page.evaluate(UNFOLD)

    def wait(self):
        self.page.wait_for_function(RAN, timeout=120_000)

    def run(self):
        self.page.click("button.run-page")
        self.page.wait_for_selector("html.live-busy", state="attached")
        self.wait()
        assert "ran." in self.words(), self.words()

    def results_of_a_run(self):
        """Return the results below each cell before and after a run, and the notes after it."""
        before = self.page.evaluate(RESULTS)
        self.run()
        self.page.wait_for_function(PLAYABLE)
        notes = [
            self.cell(k).locator(".live-note, .live-error").all_inner_texts()
            for k in range(1, len(before) + 1)
        ]
        return before, self.page.evaluate(RESULTS), notes

    def cell(self, number):
        return self.page.locator("div.cell").nth(number - 1)

    def number(self, text):
        """Return the number of the first cell that contains ``text``."""
        return self.page.evaluate(
            "(text) => [...document.querySelectorAll('div.cell')].findIndex((cell) => "
            "cell.textContent.includes(text)) + 1",
            text,
        )

    def write(self, number, code):
        """Replace the code of a cell, from the keyboard."""
        self.cell(number).locator(".cm-content").focus()
        self.page.keyboard.press("Control+a")
        self.page.keyboard.insert_text(code)
        self.page.wait_for_function(
            "([number, code]) => document.querySelectorAll('div.cell')[number - "
            "1].querySelector('.cm-content')"
            ".innerText.replace(/\\s/g, '') === code.replace(/\\s/g, '')",
            arg=[number, code],
        )

    def try_code(self, number, code, wait=True):
        """Write ``code`` into a cell, run it with the keyboard, and return its output."""
        self.write(number, code)
        self.page.keyboard.press("Shift+Enter")
        if wait:
            self.wait()
        return self.below(number)

    def codes(self):
        return [
            self.cell(k).locator("pre").first.inner_text()
            for k in range(1, self.page.locator("div.cell").count() + 1)
        ]

    def below(self, number):
        return self.cell(number).locator(".cell_output").inner_text()

    def words(self):
        return self.page.inner_text("#live-words")

    def outside(self):
        return [
            url for url in self.asked if not url.startswith(("http://127.0.0.1", "data:", "blob:"))
        ]


@pytest.fixture(scope="module")
def context(browser):
    made = browser.new_context(viewport={"width": 1300, "height": 900})
    yield made
    made.close()


@pytest.fixture(scope="module")
def page_that_has_run(context, site):
    page = Page(context, site, QUIET)
    opened.remove(page.page)
    runtime_files = [url for url in page.asked if "/runtime/" in url]
    page.at_first = runtime_files, page.page.is_visible(".live-bar")
    page.page.route("**/*", lambda route: route.abort())
    page.page.click("button.run-cell >> nth=2")
    page.page.wait_for_selector("#live-words:has-text('does not answer')")
    page.page.unroute_all()
    page.page.route(ELSEWHERE, lambda route: route.abort())
    page.failures = [words_of_a_failure(page, pattern, answer) for pattern, answer, _ in BROKEN]
    page.results = page.results_of_a_run()
    yield page


@pytest.fixture
def shared(page_that_has_run):
    """A page whose cells have run once; tests may leave it running."""
    yield page_that_has_run
    assert page_that_has_run.errors == []
    # Otherwise the next page would restore the edits.
    page_that_has_run.page.evaluate("localStorage.clear()")
    if page_that_has_run.page.locator("html.live-busy").count():
        page_that_has_run.page.reload()


@pytest.fixture(scope="module")
def not_isolated():
    """The address of the book on a server that gives pages no shared memory, as most servers do."""

    class Plain(Handler):
        isolated = False

    book = server(folder=HTML, handler=Plain)
    threading.Thread(target=book.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{book.server_port}/"
    book.shutdown()
    book.server_close()


def kinds(name):
    return kinds_of_cells()[name.removesuffix(".html")]


# --- every cell of the book ---------------------------------------------------------------------


def test_every_notebook_is_a_page_with_code():
    notebooks = {
        str(path.relative_to(REPOSITORY).with_suffix(".html")) for path in all_notebooks(REPOSITORY)
    }
    shown = {f"{name}.html" for name, kinds in kinds_of_cells().items() if on_the_page(kinds)}
    assert set(PAGES) == shown
    # The figures of these pages need no code on the page.
    assert notebooks - shown == {"index.html", "rotations.html"}
    # Exercises are shown as they are stored, since a question is an output. A build once lost all.
    exercises = [name for name in PAGES if name.startswith(STORED)]
    assert [
        name for name in exercises if "cell_output" not in (HTML / name).read_text("utf8")
    ] == []


def all_shown(results):
    """Unhide the messages of checks that nobody has run, which a page shows only after a run."""
    return [result.replace(' hidden=""', "") for result in results]


def equal_the_stored_ones(page, name, before, after, notes):
    """Check that cells which need only SymPy give the printed results, and others say why not."""
    before, after = all_shown(before), list(map(in_short, after))
    for number, (kind, note) in enumerate(zip(kinds(name), notes, strict=True), start=1):
        if not kind["needs"]:
            assert after[number - 1] == before[number - 1], f"cell {number}"
            assert note == [], f"cell {number}"
        elif kind["skip"]:
            assert note == []
        elif kind["needs"] == ["anywidget"]:
            # A moving figure needs nothing beyond the files of the site.
            assert note == [], f"cell {number}"
        else:
            assert "Not run here" in note[0], f"cell {number}"
            built = before[number - 1].partition("<figcaption>")[0]
            assert after[number - 1].startswith(built), f"cell {number} has lost its printed result"
    assert page.errors == []
    needed = any(set(kind["needs"]) - {"anywidget"} and not kind["skip"] for kind in kinds(name))
    assert needed or page.outside() == []


def test_results_of_a_page_equal_the_stored_ones(page_that_has_run):
    equal_the_stored_ones(page_that_has_run, QUIET, *page_that_has_run.results)


# The build has run all cells with the same Python code.
@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [name for name in PAGES if not name.startswith(STORED)])
def test_results_equal_the_stored_ones(context, site, name):
    page = Page(context, site, name)
    if all(kind.get("skip") for kind in kinds(name)):
        page.page.click("button.run-page")
        page.page.wait_for_function(
            "document.querySelector('#live-words').textContent.includes('already there')"
        )
        assert not [url for url in page.asked if url.endswith(".wasm")]
        return
    equal_the_stored_ones(page, name, *page.results_of_a_run())


def test_the_list_of_cells_is_that_of_the_build(site):
    text = (HTML / "appendix" / "code-in-the-page.html").read_text("utf8")
    every = [kind for page in kinds_of_cells().values() for kind in on_the_page(page)]
    alone = sum(set(kind["needs"]) <= {"anywidget"} for kind in every)
    assert f"Of {len(every)} cells, {alone} (" in text
    assert alone >= 0.87 * len(every), "nearly nine cells of ten need no other server"


# --- what is loaded, and when -------------------------------------------------------------------


def test_nothing_is_loaded_before_the_reader_asks(page_that_has_run):
    assert page_that_has_run.at_first == ([], False)


@pytest.mark.parametrize("name", PAGES)
def test_pages_hardly_grow(name):
    data = re.search(
        r'<script type="application/json" id="live-data">.*?</script>',
        (HTML / name).read_text("utf8"),
    )
    button = '<button class="run-page">Run this page</button>' * 3
    added = [(HTML / "_static" / "live.js").read_bytes(), (scripts.JS / "page.css").read_bytes()]
    added.append((data[0] + button).encode())
    assert sum(len(gzip.compress(part)) for part in added) < 5500


def test_formulas_of_the_page_stay_as_they_are_when_python_comes():
    """KaTeX's own rules, which arrive with Python, must not override those of the page.

    They would make all formulas larger.
    """
    (sheet,) = HTML.glob("runtime/scripts-*/live.css")
    before, _, rules = sheet.read_text("utf8").partition("@layer katex {")
    assert ".katex" not in before and ".vlist" in rules and rules.count("{") + 1 == rules.count("}")


@pytest.mark.long
def test_browser_asks_nobody_else(site, browser, tmp_path):
    """Read the browser's own log of the network, from its start to its end."""
    log = tmp_path / "network.json"
    name = "chapters/orientation-with-sympy.html"
    logged = browser.browser_type.launch(
        executable_path=find(),
        args=[*FLAGS, f"--log-net-log={log}", "--net-log-capture-mode=Everything"],
    )
    page = Page(logged.new_context(), site, name, refuse=False)
    page.run()
    opened.remove(page.page)
    logged.close()
    events = [event.get("params", {}) for event in json.loads(log.read_text("utf8"))["events"]]
    # The browser's requests to its maker have no page as their origin.
    asked = {
        params["url"]
        for params in events
        if params.get("initiator", "").startswith("http") and "url" in params
    }
    assert any(url.endswith(".whl") for url in asked), "the log tells what the worker asks for"
    assert {url for url in asked if not url.startswith((site, "data:", "blob:"))} == set()


def test_download_is_small_enough():
    lock = json.loads((HTML / runtime.FOLDER / runtime.LOCK).read_text("utf8"))
    first = runtime.with_dependencies([runtime.DISTRIBUTION], lock["packages"])
    files = [
        HTML / runtime.FOLDER / runtime.pyodide_folder() / name for name in runtime.PYODIDE_FILES
    ]
    files += [HTML / runtime.FOLDER / lock["packages"][name]["file_name"] for name in first]
    assert lock["bytes"] == sum(path.stat().st_size for path in files)
    files += (HTML / scripts.folder_name()).iterdir()
    # The questions, with their figures, come along: every question of the exercises has variants.
    assert sum(len(gzip.compress(path.read_bytes(), 6)) for path in files) <= 18_333_000


@pytest.mark.parametrize("file", [runtime.LOCK, lite.LOCK])
def test_lock_names_what_is_there(file):
    lock = json.loads((HTML / runtime.FOLDER / file).read_text("utf8"))
    official = runtime.official_lock()["packages"]
    for name, package in lock["packages"].items():
        if "://" in package["file_name"]:
            assert package["file_name"].startswith(runtime.official_address())
            assert package["sha256"] == official[name]["sha256"]
        else:
            wheel = HTML / runtime.FOLDER / package["file_name"]
            assert hashlib.sha256(wheel.read_bytes()).hexdigest() == package["sha256"]
            assert not [
                member for member in zipfile.ZipFile(wheel).namelist() if "/tests/" in member
            ]
        assert all(needed in lock["packages"] for needed in package["depends"])


# --- NumPy and Matplotlib: official, a folder, off ------------------------------------------------


@pytest.fixture
def made_wheels(tmp_path):
    """Return wheels in place of the official ones, and a list of packages that names them."""
    packages = {}
    for name in runtime.with_dependencies(runtime.NUMERICAL, runtime.official_lock()["packages"]):
        package = dict(runtime.official_lock()["packages"][name])
        wheel = tmp_path / package["file_name"]
        with zipfile.ZipFile(wheel, "w") as file:
            file.writestr(f"{package['imports'][0]}.py", f"__version__ = 'made {name}'\npi = 3\n")
            info = f"{name.replace('-', '_')}-{package['version']}.dist-info"
            file.writestr(
                f"{info}/METADATA",
                f"Metadata-Version: 2.1\nName: {name}\nVersion: {package['version']}\n",
            )
            file.writestr(f"{info}/RECORD", "")
        packages[name] = package | {"sha256": hashlib.sha256(wheel.read_bytes()).hexdigest()}
    return tmp_path, {"packages": packages}


def test_numpy_from_a_folder(made_wheels, tmp_path_factory):
    folder, official = made_wheels
    target = tmp_path_factory.mktemp("runtime")
    packages = runtime.numerical_packages(str(folder), target, official, "unused")
    assert set(packages) == set(official["packages"])
    for package in packages.values():
        content = (target / package["file_name"]).read_bytes()
        assert hashlib.sha256(content).hexdigest() == package["sha256"]
    numpy = folder / official["packages"]["numpy"]["file_name"]
    numpy.write_bytes(numpy.read_bytes() + b"more")
    with pytest.raises(Exception, match="numpy-.* is not the official file"):
        runtime.numerical_packages(str(folder), target, official, "unused")
    numpy.unlink()
    with pytest.raises(Exception, match="no numpy-"):
        runtime.numerical_packages(str(folder), target, official, "unused")


def test_one_command_brings_the_wheels_once_and_checks_each(made_wheels, tmp_path_factory):
    folder, official = made_wheels
    target = tmp_path_factory.mktemp("fetched")
    address = folder.as_uri() + "/"
    names = {package["file_name"] for package in official["packages"].values()}
    assert set(fetch(target, official["packages"], address)) == names
    assert fetch(target, official["packages"], address) == []
    numpy = official["packages"]["numpy"]["file_name"]
    (target / numpy).write_bytes(b"half of it")
    assert fetch(target, official["packages"], address) == [numpy]
    (target / numpy).unlink()
    (folder / numpy).write_bytes(b"another file")
    with pytest.raises(RuntimeError, match="differs from the file in Pyodide's list"):
        fetch(target, official["packages"], address)
    assert not (target / numpy).exists()


def test_one_setting_puts_them_beside_the_pages(monkeypatch):
    """Set it like the workflow that publishes, which uses the makefile's command and folder."""
    monkeypatch.setenv("BOOK_NUMPY", "_build/numpy")
    assert runtime.numpy_setting("official") == "_build/numpy"
    monkeypatch.setenv("BOOK_NUMPY", "")
    assert runtime.numpy_setting("official") == "official"
    assert "notebook_pages.live.fetch _build/numpy" in (REPOSITORY / "Makefile").read_text("utf8")
    steps = (REPOSITORY / ".github" / "workflows" / "publish.yml").read_text("utf8")
    assert (
        steps.index("run: make numpy")
        < steps.index("run: make take-away")
        < steps.index("BOOK_NUMPY: _build/numpy")
    )


@pytest.mark.parametrize("setting", ["off", False])
def test_numpy_off(setting, tmp_path):
    assert runtime.numerical_packages(setting, tmp_path, runtime.official_lock(), "unused") == {}


def numpy_page(context, site, lock, wheel):
    """Return a page whose list of packages is ``lock``; the official address returns ``wheel``."""
    page = Page(context, site, QUIET, refuse=False)
    page.page.route("**/pyodide-lock.json", lambda route: route.fulfill(json=lock))
    headers = {"Access-Control-Allow-Origin": "*", "Content-Type": "application/octet-stream"}
    page.page.route(ELSEWHERE, lambda route: route.fulfill(body=wheel, headers=headers))
    return page


@pytest.mark.long
def test_numpy_is_fetched_and_checked(context, site, made_wheels):
    folder, made = made_wheels
    lock = json.loads((HTML / runtime.FOLDER / runtime.LOCK).read_text("utf8"))
    lock["packages"]["numpy"]["sha256"] = made["packages"]["numpy"]["sha256"]
    wheel = (folder / made["packages"]["numpy"]["file_name"]).read_bytes()
    page = numpy_page(context, site, lock, wheel)
    page.page.click("button.run-cell >> nth=2")  # a cell of SymPy requests nothing
    page.wait()
    assert page.outside() == []
    assert "made numpy" in page.try_code(3, "import numpy as np\nprint(np.__version__)")
    assert page.outside() == [lock["packages"]["numpy"]["file_name"]]
    assert page.outside()[0].startswith("https://cdn.jsdelivr.net/pyodide/v")

    page = numpy_page(context, site, lock, wheel + b"one byte too many")
    page.page.click("button.run-cell >> nth=2")
    page.wait()
    page.try_code(3, "import numpy as np\nnp.fft.fft([1, 2])")
    assert "NumPy could not be fetched from cdn.jsdelivr.net" in page.below(3)


def test_plain_python_stands_in_for_numpy_and_says_so(shared):
    page = shared
    text = page.try_code(
        3, "import numpy as np\na = np.array([[2.0, 1], [0, 4]])\na @ a.T / [4, -8]"
    )
    assert "array([[ 1.25, -0.5 ]," in text
    assert "computed by plain Python instead of NumPy" in page.words()
    assert page.outside() == []
    # The page fetches NumPy for a method that the stand-in's arrays lack, as it does for a function,
    # for all of its names, and for SymPy's plots, which look up functions that the stand-in lacks.
    for code in (
        "a = np.array([1.0, 2])\na.cumprod()",
        "from numpy import *\narray([1, 2])",
        "import sympy as sm\nsm.plot(sm.sin(sm.Symbol('x')))",
    ):
        page.try_code(3, code)
        assert "NumPy could not be fetched from cdn.jsdelivr.net" in page.below(3), code
    assert page.try_code(3, "print(repr(a[1]))").strip() == "np.float64(2.0)"


@pytest.mark.long
def test_a_file_that_is_dropped_is_handed_to_python_and_to_nobody_else(context, site):
    """Byte by byte; the report says that it needs a download."""
    page = Page(context, site, "workbench.html")
    tagged = (
        "[...document.querySelectorAll('div.cell')].findIndex((cell) => "
        "cell.matches('.tag_takes-file')) + 1"
    )
    number = page.page.evaluate(tagged)
    sent = []
    page.page.on("request", lambda request: sent.append(request.post_data))
    content = bytes(range(256)) * 40
    name = "a walk.csv"
    page.page.locator("div.cell.tag_takes-file").scroll_into_view_if_needed()
    page.page.set_input_files(
        "label.takes-file input", {"name": name, "mimeType": "text/csv", "buffer": content}
    )
    page.page.wait_for_selector("html.live-busy", state="attached")
    page.wait()
    assert "could not be fetched from cdn.jsdelivr.net" in page.below(number)
    look = "import hashlib, os\nfor name in os.listdir('dropped'):\n"
    look += "    print(name, hashlib.sha256(open(f'dropped/{name}', 'rb').read()).hexdigest())"
    assert page.try_code(number, look).split("\n")[:1] == [
        f"{name} {hashlib.sha256(content).hexdigest()}"
    ]
    assert page.errors == [] and not any(sent)


@pytest.mark.long
def test_hidden_code_runs_and_printed_results_come_back(context, site):
    """On a page with a cell tagged ``remove-cell``, the build adds its code to the next one.

    A printed result remains beside an error, and is alone again with the book's code. All are back
    when Python starts afresh.
    """

    # A moving figure is where the reader has left it, or where its own random numbers put it.
    def results():
        return ["moves" if "data-figure=" in html else html for html in page.page.evaluate(RESULTS)]

    def with_hidden_code(route):
        page = route.fetch()
        text, count = re.subn(
            r'"cells":\s*\{', r'"cells":{"2":{"before":"hidden = 6 * 7"},', page.text(), count=1
        )
        assert count == 1
        text = re.sub(r'"hidden = 6 \* 7"\},\s*\}', '"hidden = 6 * 7"}}', text)
        route.fulfill(response=page, body=text)

    context.route(f"**/{QUIET}", with_hidden_code)
    try:
        page = Page(context, site, QUIET)
    finally:
        context.unroute(f"**/{QUIET}")
    before = results()
    page.run()
    assert "42" in page.try_code(3, "hidden")
    page.try_code(3, "1 / 0")
    assert "ZeroDivisionError" in page.below(3)
    page.cell(3).locator("details.live-built summary").click()
    assert page.cell(3).locator(".katex").first.is_visible()
    page.cell(3).get_by_role("button", name="Bring back").click()
    page.page.keyboard.press("Shift+Enter")
    page.wait()
    assert results()[2] == before[2]
    page.try_code(3, "gone = 1\nprint('something else')")
    page.page.click(".live-bar button:has-text('Start afresh')")
    assert results() == before
    assert "NameError" in page.try_code(3, "gone")
    assert page.errors == []


# --- what a student would type ------------------------------------------------------------------


def test_edit_and_run(shared):
    assert "42" in shared.try_code(3, "print(6 * 7)")
    assert "cell 3 ran. Result: 42" in shared.words().replace("Cell", "cell")
    assert shared.try_code(3, "a = 1; a;").strip() == ""
    assert shared.try_code(
        3, "a, b = 'é', '数'\nprint(a + b)\nnäme = '\\N{GREEK SMALL LETTER PSI}'\nnäme"
    ).split() == [
        "é数",
        "'ψ'",
    ]
    assert "made anew" in shared.try_code(3, "a = 'made anew'\na")
    assert "made anew" in shared.try_code(4, "a")
    waited = shared.try_code(
        3, "import asyncio\nprint(await asyncio.sleep(0, 'waited'))\nawait asyncio.sleep(0, 7)"
    )
    assert set(waited.split()) == {"waited", "7"}
    for code, name in (("import scipy", "scipy"), ("from scipi.spatial import Rotation", "scipi")):
        assert f"{name} is not part of this page's Python" in shared.try_code(3, code)


# What a reader may write that fails, and what the page says of it.
FAILURES = [
    (
        "import sympy as sm\nsm.Matrx([1])",
        ("AttributeError", 'File "cell 3", line 2', r"sm\.Matrx\(\[1\]\)"),
    ),
    ("for i in range(3)\n    print(i)", ("SyntaxError: expected ':'",)),
    ("theta = 1\nthta + 1", ("NameError", "Did you mean: 'theta'")),
    ("input('Your name? ')", (r"input\(\) and breakpoint\(\) do not work on this page",)),
    ("breakpoint()", (r"input\(\) and breakpoint\(\) do not work on this page",)),
    ("exit()", ("SystemExit", "On this page only the cell ends")),
    ("def f(n):\n    return f(n + 1)\nf(0)", ("RecursionError|Python stopped",)),
    ("%matplotlib inline", ("SyntaxError", "this page has only Python")),
    ("!pip install x", ("SyntaxError", "Nothing can be installed")),
    ("len?", ("SyntaxError", r"help\(len\)")),
]


def test_an_error_is_told_in_words_and_python_goes_on(shared):
    for code, words in FAILURES:
        text = shared.try_code(3, code)
        assert "error" in shared.words() and all(re.search(part, text) for part in words), code
        assert len(text) < 5000 and not re.search("session|pyodide|ast.py", text), code
    # As an example of the reference, with its prompt and its output.
    assert shared.try_code(3, ">>> print('still here')\nstill here").startswith("still here")


def test_endless_printing_is_cut(shared):
    text = shared.try_code(3, "for i in range(200_000):\n    print('line', i)")
    assert "more characters, which are not shown" in text and "line 100" in text
    assert len(text) < 100_000


FORMS = [
    (
        "class Reply:\n    def _repr_html_(self):\n        return '<p class=\"reply\">Right.</p>'\nReply()",
        "p.reply:has-text('Right.')",
        1,
    ),
    (
        "import sympy as sm\nx = sm.Symbol('x')\ndisplay(x**2)\ndisplay(x/3, 'text')",
        ".cell_output:has-text(\"'text'\") .katex",
        2,
    ),
    ("HTML('<b>bold</b>')", "b", 1),
    ("from IPython.display import Math\nMath(r'\\hat{a}_x')", ".katex", 1),
    (
        "HTML('<figure class=orientation-figure><svg role=img><title>A line</title></svg></figure>')",
        "figure svg",
        1,
    ),
]


@pytest.mark.parametrize(("code", "shown", "count"), FORMS)
def test_forms_of_values(shared, code, shown, count):
    shared.try_code(3, f"from IPython.display import HTML\n{code}")
    assert shared.cell(3).locator(shown).count() == count


def solution(name):
    """Return the instructors' code of one answer: the cell above its check."""
    path = REPOSITORY / "tests" / "solutions" / f"{name.partition('/')[0]}.ipynb"
    codes = [
        cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"
    ]
    (place,) = (number for number, code in enumerate(codes) if code.startswith(f"check('{name}'"))
    return codes[place - 1]


def test_exercise_is_checked_in_the_page(context, site):
    """Nothing is called right that is wrong, or that no longer stands there."""
    name = "exercises/simple-orientations.html"
    page = Page(context, site, name)
    places = {cell["name"]: number for number, cell in enumerate(kinds(name), start=1)}
    blank, check = places["simple-orientations-crank"], places["check-simple-orientations-crank"]

    def run():
        page.page.click(f"button.run-cell >> nth={check - 1}")  # an edited cell above runs first
        page.wait()
        return page.cell(check).inner_text()

    def reply_to(code):
        page.write(blank, code)
        return run()

    run()
    outcome = page.cell(check).locator("[data-outcome]")
    assert outcome.get_attribute("data-outcome") == "not attempted"
    right = solution("simple-orientations/crank")
    # Without NumPy, its stand-in makes arrays of its own, which are read as well.
    with_module = (
        "from orientation import dcm_from_axis_angle\n\nA_C_N = dcm_from_axis_angle((0, 1, 0), 0.3)"
    )
    for code, expected in (
        (with_module, "wrong"),
        (right, "correct"),
        (f"{right}\nA_C_N = A_C_N.T", "wrong"),
        (right, "correct"),
    ):
        reply = reply_to(code)
        assert outcome.get_attribute("data-outcome") == expected, reply
        if code == with_module:
            assert "but not the right one" in reply
        elif expected == "wrong":
            assert "transpose" in reply and "$" not in page.below(check)
            assert page.cell(check).locator("[data-outcome] .katex").count() > 0
            assert "transpose" in page.words()
    blank, check = places["simple-orientations-boom"], places["check-simple-orientations-boom"]
    right = (
        "B_C_N = sm.Matrix([[sm.cos(beta), 0, sm.sin(beta)], [0, 1, 0], "
        "[-sm.sin(beta), 0, sm.cos(beta)]])"
    )
    reply = reply_to("other = 1")
    # The book has no result of a question that nobody has answered, so none is announced.
    assert "No cell that you have run sets `B_C_N`." in reply and "The book’s result" not in reply
    for slip, said in (
        (right.replace("beta", "betta"), "The cell that sets B_C_N stopped"),
        (right.replace("B_C_N", "B_C_n"), "The cell that set B_C_N no longer sets it"),
        (f"# {right}", "The cell that set B_C_N no longer sets it"),
    ):
        reply = reply_to(right)
        assert "Correct" in reply and "earlier answer" not in reply
        page.write(blank, slip)
        assert "reply to an earlier answer" in page.below(check)
        reply = run()
        if "betta" in slip:
            assert "reply to an earlier answer" in reply  # the cell fails, and no check runs
            reply = run()
        assert "Correct" not in reply and said in reply
    reply = reply_to(right)
    assert "Correct" in reply and "earlier answer" not in reply
    assert page.outside() == [] and page.errors == []


def students_by_variant(question):
    """Return the ID of one student for each variant of ``question``."""
    count = notebook_questions(question.partition("/")[0])[question].question.variants
    ids = [f"s{k}@uni.example" for k in range(60)]
    return {variant_of(who, question, count): who for who in ids}


def signed(code, who):
    """Return the first cell as a student with an ID writes it."""
    assert LEFT_OPEN in code
    return code.replace(LEFT_OPEN, f"student('{who}')")


@pytest.mark.long
def test_page_shows_a_students_own_numbers_and_fetches_one_small_file(context, site):
    name, question = "exercises/simple-orientations.html", "simple-orientations/compass"
    students = students_by_variant(question)
    page = Page(context, site, name)
    sealed = []
    page.page.on(
        "response",
        lambda response: (
            "/sealed-" in response.url and sealed.append((response.url, len(response.body())))
        ),
    )
    codes = page.codes()
    shown = next(k for k, code in enumerate(codes, 1) if question in code)

    def run(page):
        page.page.click(f"button.run-cell >> nth={shown - 1}")
        page.wait()
        return page.below(shown)

    everybodys = run(page)
    # A reader who learns alone sees nothing of this.
    assert sealed == [] and page.page.locator(".live-who").count() == 0
    assert "default" not in page.page.inner_text("main")
    own = max(students)
    page.write(1, signed(codes[0], f" {students[own].upper()} "))
    page.page.click("button.run-cell >> nth=0")
    page.wait()
    assert f"You are {students[own]}." in page.below(1)
    mine = run(page)
    assert mine != everybodys and page.errors == []
    # One small file for each question above with variants, and no others.
    assert any(
        address.endswith(f"/variants/simple-orientations-{own}.json") for address, _ in sealed
    )
    above = sum("variant(" in code for code in codes[:shown])
    assert len(sealed) <= above and sum(size for _, size in sealed) < 15_000 * above, sealed
    opened.remove(page.page)
    page.page.close()
    again = Page(context, site, name)
    # Before anything is run, the reader's own numbers are shown, and not the default ones.
    cell = f"document.querySelectorAll('div.cell')[{shown - 1}]"
    again.page.wait_for_function(
        f"{cell}.querySelector('.text_markdown')?.innerText && !{cell}.querySelector('.live-known')"
    )
    assert again.below(shown) == mine
    assert run(again) == mine
    again.write(1, signed(codes[0], students[0]))
    assert run(again) == everybodys
    assert f"You are {students[0]} now, and were {students[own]} before, " in again.below(1)


def test_a_page_that_is_opened_again_says_what_is_known_of_the_reader(context, site):
    """Its outputs contain the default numbers, and questions without an attempt."""
    name, question = "exercises/unit-quaternions.html", "unit-quaternions/dish"
    page = Page(context, site, name)
    codes = page.codes()
    shown = next(k for k, code in enumerate(codes, 1) if "variant(" in code)
    check = next(k for k, code in enumerate(codes, 1) if f"check('{question}'" in code)
    assert page.below(check) == "", "what nobody has attempted is known from the dots"
    record = json.dumps({question: {"outcome": "correct", "whose": "ada"}})
    page.page.evaluate(
        "(record) => { bookStore.put('coursework me.txt', { text: 'ada', at: 1 }); "
        "bookStore.keepTries(record, 1); }",
        record,
    )
    page.page.reload()
    assert "Correct, in an earlier check" in page.below(
        check
    ) and "Not attempted" not in page.below(check)
    assert "the numbers of ada" in page.below(shown)
    assert (
        page.cell(shown).locator("details:has-text('The default numbers')").get_attribute("open")
        is None
    )


@pytest.mark.long
def test_what_was_right_with_everybodys_numbers_is_not_taken_for_ones_own(context, site):
    """After any answers, names, corrections and reloads, the page says whose numbers one had."""
    name, question = "exercises/simple-orientations.html", "simple-orientations/compass"
    students = students_by_variant(question)
    page = Page(context, site, name)
    codes = page.codes()
    check = next(k for k, code in enumerate(codes, 1) if f"check('{question}'" in code)
    reply = page.cell(check).locator(".coursework-reply:visible")

    def run():
        page.page.click(f"button.run-cell >> nth={check - 1}")
        page.wait()
        return page.below(check)

    def call_oneself(who):
        page.write(1, signed(codes[0], who))
        page.page.click("button.run-cell >> nth=0")
        page.wait()
        return page.below(check)

    def reopened():
        page.page.reload()
        # It requests its scripts, since there are edits to restore.
        page.page.wait_for_selector(".cm-content")
        return page.below(check)

    run()  # the editors arrive with Python
    page.write(check - 1, solution(question))
    assert "Correct" in run()
    assert "✓ Correct" in reopened() and reply.count() == 0
    for who in (students[3], students[5]):  # the first ID is mistyped
        reply_text = call_oneself(who)
        assert (
            "✓ Right with the default numbers" in reply_text
            and f"are those of {who} now" in reply_text
        )
    run()
    # The answer is compared with the new numbers.
    assert reply.get_attribute("data-outcome") == "correct", page.below(check)
    assert "default" not in page.below(check)
    assert "✓ Right with" not in reopened() and "✓ Correct" in page.below(check)
    run()
    assert "✓ Right with" in call_oneself(students[3]) and reply.count() == 0
    assert (
        page.cell(check)
        .locator("details:has-text('The reply to other numbers')")
        .get_attribute("open")
        is None
    )
    reply_text = call_oneself(students[5])
    assert "✓ Correct" in reply_text and "Right with" not in reply_text
    page.page.goto(site + "appendix/my-progress.html")
    counted = page.page.locator(
        "tr:has(td[data-names*='simple-orientations/compass']) td[data-kind=checked]"
    )
    assert counted.first.inner_text().startswith("1 of")
    page.page.evaluate(
        "name => bookStore.put('coursework me.txt', { text: name, at: 2 })", students[6]
    )
    page.page.reload()
    assert counted.first.inner_text().startswith("0 of")
    assert page.errors == []


OFFERED = """from IPython.display import HTML
HTML('<div class="coursework-reply" data-sibling="simple-orientations/compass/sibling">Right, with help</div>')"""


@pytest.mark.long
def test_tries_outlive_the_page_and_a_sibling_question_is_one_button_away(context, site):
    name = "exercises/simple-orientations.html"
    places = {cell["name"]: number for number, cell in enumerate(kinds(name), start=1)}
    blank, check = places["simple-orientations-crank"], places["check-simple-orientations-crank"]
    for code in ("A_C_N = sm.eye(3)", "A_C_N = sm.diag(1, -1, -1)"):
        page = Page(context, site, name)
        page.page.click(f"button.run-cell >> nth={check - 1}")
        page.wait()
        page.write(blank, code)
        page.page.click(f"button.run-cell >> nth={check - 1}")
        page.wait()
        reply_text = page.below(check)
        if "1, -1" not in code:
            opened.remove(page.page)
            page.page.close()
    assert "2 answers so far" in reply_text and "Hint:" in reply_text
    place = places["check-simple-orientations-compass"]
    page.page.click(f"button.run-cell >> nth={place - 1}")
    page.wait()
    assert page.cell(place).locator("button.sibling").count() == 0
    page.write(place, OFFERED)
    page.page.click(f"button.run-cell >> nth={place - 1}")
    page.wait()
    page.cell(place).locator("button.sibling").click()
    page.cell(place).locator("[data-outcome='not attempted']").wait_for()
    page.wait()
    code = page.cell(place).locator(".cm-content").inner_text()
    assert code.startswith(OFFERED.partition("\n")[0])
    assert "sibling = variant('simple-orientations/compass/sibling')" in code
    assert "check('simple-orientations/compass/sibling', other_compass)" in code
    # Without an ID the sibling is the next variant. The page writes a minus where Python has a
    # hyphen, and typesets numbers.
    own = notebook_questions("simple-orientations", 1)[
        "simple-orientations/compass"
    ].question.variant.shown
    shown = "".join(page.below(place).replace("\N{MINUS SIGN}", "-").split())
    assert all(number in shown for text in own.values() for number in re.findall(r"-?\d+", text)), (
        own
    )
    assert page.errors == []
    # It is the reader's own text now and survives the page; the book's code can be restored.
    opened.remove(page.page)
    page.page.close()
    again = Page(context, site, name)
    again.cell(place).locator(".cm-content", has_text="compass/sibling").wait_for()


# --- stopping and starting afresh -----------------------------------------------------------------

ENDLESS = "kept = 'kept'\nprint('begun')\nwhile True:\n    pass"
HUGE = (
    "print('begun')\nimport sympy as sm\nM = sm.Matrix(60, 60, lambda i, j: "
    "sm.Symbol(f'a{i}{j}'))\nM.det(method='berkowitz')"
)
ONE_STEP = "print('begun')\nmax(range(10 ** 15))"  # one operation, in which Python does not listen


def stop(page, number, code):
    """Run endless code, press Stop once it has begun, and return the output."""
    page.try_code(number, code, wait=False)
    page.page.wait_for_function(
        "number => document.querySelectorAll('div.cell')[number - "
        "1].querySelector('.cell_output').innerText.includes('begun')",
        arg=number,
    )
    page.page.click(".live-bar button:has-text('Stop')")
    page.wait()
    return page.below(number)


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "code",
    [
        ENDLESS,
        HUGE,
        # What an interrupt raises while an object is deleted is ignored: Python is asked again.
        "class Slow:\n    def __del__(self):\n        print('begun')\n        while True:\n"
        "            pass\nslow = Slow()\ndel slow\nwhile True:\n    pass",
    ],
)
def test_stop_keeps_the_names_in_an_isolated_page(shared, code):
    assert shared.page.evaluate("crossOriginIsolated")
    shared.try_code(3, "kept = 'kept'")
    text = stop(shared, 3, code)
    assert "Stopped." in text and "still there" in text
    assert "kept" in shared.try_code(4, "kept"), "a cell further down leaves the stopped one out"
    assert "Stopped." in shared.below(3)


@pytest.mark.long
def test_stop_in_a_page_without_shared_memory(browser, not_isolated):
    context = browser.new_context(service_workers="block")  # or one would isolate the pages
    page = Page(context, not_isolated, QUIET)
    assert not page.page.evaluate("crossOriginIsolated")
    page.page.click("button.run-cell >> nth=2")
    page.wait()
    text = stop(page, 4, ENDLESS)
    assert "Stopped." in text and "restarts" in text
    # The cells above run again first, so that their names are defined.
    text = page.try_code(4, "theta, kept if 'kept' in globals() else 'new'")
    assert "new" in text and page.errors == []
    opened.remove(page.page)
    context.close()


# --- failures of the network, named ---------------------------------------------------------------


def words_of_a_failure(page, pattern, answer):
    """Return the page's message when a file that Python needs does not arrive as it should."""
    page.page.route(pattern, lambda route: route.fulfill(**answer))
    page.page.click("button.run-cell >> nth=2")
    page.page.wait_for_function(
        "document.querySelector('#live-words').textContent.includes('could not be started')",
        timeout=90_000,
    )
    page.page.unroute(pattern)
    return page.words()


# What the network may bring in place of a file that Python needs, and a word for it.
BROKEN = [
    ("**/pyodide-lock.json", dict(status=500), "500"),
    ("**/*.wasm", dict(body=b"\0asm, but broken", content_type="application/wasm"), "damaged"),
    ("**/sympy*.whl", dict(body=b"no wheel"), "not the file of this edition"),
]


def test_failures_are_named_and_the_next_run_tries_again(page_that_has_run):
    """The shared page has met them all, and a network that brought no script, before it ran."""
    for failure, (_, _, word) in zip(page_that_has_run.failures, BROKEN, strict=True):
        assert word in failure


@pytest.mark.long
def test_tab_that_is_older_than_the_pages_says_so(context, site):
    """Its scripts are gone from the server, where the same page now requests others."""
    page = Page(context, site, QUIET)
    page.page.route("**/runtime/scripts-*/*.js*", lambda route: route.fulfill(status=404))
    text = re.sub(
        r"runtime/scripts-\w+", "runtime/scripts-0123456789ab", (HTML / QUIET).read_text("utf8")
    )
    page.page.route(f"**/{QUIET}", lambda route: route.fulfill(body=text, content_type="text/html"))
    page.page.click("button.run-cell >> nth=2")
    page.page.wait_for_selector("#live-words:has-text('has been updated')")
    page.page.unroute_all()
    with page.page.expect_navigation():
        page.page.click(".live-choices button:has-text('Reload')")
    page.page.click("button.run-cell >> nth=2")
    page.page.wait_for_selector("#live-words:has-text('Cell 3 ran')")


# --- a hurried hand -------------------------------------------------------------------------------

BEGUN = (
    "number => document.querySelectorAll('div.cell')[number - 1].querySelector('.cell_output')"
    ".innerText.includes('begun')"
)
SLOW = "print('begun')\nimport time\nuntil = time.time() + 4\nwhile time.time() < until: pass\n"


@pytest.mark.long
def test_page_stopped_and_asked_for_twice_runs_once_and_in_order(context, site):
    """While Python loads, and during the run; otherwise cells above would run again last.

    All sites of one address share the storage, so it may be full before the book is opened.
    """
    page = Page(context, site, QUIET)
    page.page.evaluate("""() => {
      for (const storage of [localStorage, sessionStorage])
        for (let size = 1 << 22; size; size >>= 1) try {
          for (;;) storage.setItem(`neighbour ${storage.length}`, "x".repeat(size));
        } catch {}
    }""")
    page.page.evaluate("""() => {
      window.order = [];
      const seen = new MutationObserver((changes) => changes.forEach(({ target }) => {
        const number = [...document.querySelectorAll('div.cell')].indexOf(target) + 1;
        if (target.classList.contains('running') && order.at(-1) !== number) order.push(number);
      }));
      document.querySelectorAll('div.cell').forEach((cell) => seen.observe(cell, { attributeFilter: ['class'] }));
    }""")
    page.page.click("button.run-cell >> nth=2")
    page.page.click(".live-bar button:has-text('Stop')")
    page.page.wait_for_selector("#live-words:has-text('Python was not loaded')")
    assert page.page.locator("div.cell:is(.running, .waiting)").count() == 0
    page.page.evaluate("order.length = 0")
    page.page.dblclick("button.run-page")
    page.page.wait_for_function("order.length >= 3")
    page.page.click("button.run-page")
    page.wait()
    order = page.page.evaluate("order")
    assert order == sorted(set(order)) and len(order) > 5 and page.errors == []
    page.page.evaluate("() => { localStorage.clear(); sessionStorage.clear(); }")


def test_a_cell_that_runs_is_not_run_twice_nor_taken_for_what_is_written_meanwhile(shared):
    shared.try_code(3, "count = 0")
    shared.try_code(3, f"{SLOW}count += 1\nword = 'old'", wait=False)
    shared.page.wait_for_function(BEGUN, arg=3)
    shared.page.click("button.run-cell >> nth=2")  # once more
    shared.write(3, "word = 'new'")
    shared.wait()
    assert "1 new" in shared.try_code(4, "print(count, word)")  # a cell that needs it


@pytest.mark.long
def test_stop_ends_what_does_not_listen_and_what_is_asked_for_right_after_it_runs(shared):
    """Here Python does not respond: it ends, and the cells above run again first."""
    assert "Stopped." in stop(shared, 3, ONE_STEP)
    shared.try_code(3, "above = 'there'")
    shared.try_code(4, ONE_STEP, wait=False)
    shared.page.wait_for_function(BEGUN, arg=4)
    shared.page.click(".live-bar button:has-text('Stop')")
    assert "there" in shared.try_code(4, "above")
    assert "Cell 4 ran" in shared.words()


# --- the reader's edits ---------------------------------------------------------------------------


@pytest.mark.long
def test_edits_survive_a_reload_and_can_be_undone(browser, site):
    context = browser.new_context()
    page = Page(context, site, QUIET)
    page.page.click("button.run-cell >> nth=2")
    page.wait()
    original = page.cell(3).locator(".cm-content").inner_text()
    page.try_code(3, "print('mine')")
    page.page.reload()
    page.page.wait_for_selector(".cm-content", state="attached")
    assert "print('mine')" in page.cell(3).locator(".cm-content").inner_text()
    assert "Your edits are restored" in page.words()
    assert not [url for url in page.asked[-20:] if url.endswith(".wasm")], (
        "only the editor is loaded"
    )
    page.page.click(".live-bar button:has-text('Book’s code')")
    page.page.click(".live-bar button:has-text('Bring it back')")
    assert page.cell(3).locator(".cm-content").inner_text() == original
    page.page.reload()
    page.page.locator(".live-earlier summary").click()
    assert "print('mine')" in page.page.inner_text(".live-earlier")
    opened.remove(page.page)
    context.close()


def test_edit_of_code_that_has_changed_is_offered(browser, site):
    context = browser.new_context()  # in the other, a tab may still keep what was written there
    page = Page(context, site, QUIET)
    page.page.evaluate(
        "([page, entry]) => bookStore.put(`answer ${page} other-0`, entry)",
        [
            QUIET.removesuffix(".html"),
            {"number": 3, "original": "other", "code": "print('old edit')", "at": 1},
        ],
    )
    page.page.reload()
    choice = page.page.locator(".live-choice")
    choice.wait_for()
    assert "has changed since you edited it" in choice.inner_text()
    assert "old edit" not in page.cell(3).locator(".cm-content").inner_text()
    choice.get_by_role("button", name="Use mine").click()
    assert "old edit" in page.cell(3).locator(".cm-content").inner_text()
    page.page.reload()
    page.page.wait_for_selector(".cm-content", state="attached")
    assert "old edit" in page.cell(3).locator(".cm-content").inner_text()
    assert choice.count() == 0
    opened.remove(page.page)
    context.close()


# --- keyboard, screen readers, small screens ------------------------------------------------------


@pytest.mark.long
def test_accessible_in_use(browser, site):
    """In light, and in dark on a telephone."""
    with Visit(browser, site, QUIET, "light", WIDE) as visit:
        page = visit.page
        page.route(ELSEWHERE, lambda route: route.abort())
        page.click("button.run-page")
        page.wait_for_selector("html.live-busy", state="attached")
        assert violations(page) == []
        page.wait_for_selector("html:not(.live-busy)", timeout=120_000)
        page.locator(".cm-content").nth(2).focus()
        page.keyboard.press("Control+a")
        page.keyboard.insert_text("print('a' * 500)\nthis_is_not_a_name")
        page.keyboard.press("Shift+Enter")
        page.wait_for_selector(".live-error")
        page.wait_for_selector("html:not(.live-busy)")
        assert violations(page) == []
        page.set_viewport_size(NARROW)
        page.emulate_media(color_scheme="dark")
        page.wait_for_selector("html[data-theme=dark]")
        assert violations(page) == [] and page.evaluate(SIDEWAYS) <= 0


def test_page_from_disk_says_what_to_do(browser):
    context = browser.new_context()
    page = context.new_page()
    page.goto((HTML / QUIET).as_uri())
    page.click("button.run-page")
    assert "python serve.py" in page.inner_text("#live-words")
    context.close()


# --- figures that move --------------------------------------------------------------------------

FIGURES = "chapters/simple-orientations.html"


class FigurePage(Page):
    """The page whose code gives its figure a name."""

    def __init__(self, context, site):
        super().__init__(context, site, FIGURES)
        self.page.wait_for_selector(".moving[data-ready]", state="attached")
        self.figure, self.asking = self.number("SimpleFigure("), self.number("figure.angle")

    def field(self):
        """Return the input for its angle; another figure of the page may have one of the same name."""
        return self.cell(self.figure).get_by_label("theta in degrees")

    def turn(self, degrees):
        self.field().fill(str(degrees))

    def angle(self):
        return float(self.field().input_value())

    def run_below(self, number):
        self.cell(number).locator("button.run-cell").click()
        self.page.wait_for_selector("html.live-busy", state="attached")
        self.wait()

    def says(self, number, text):
        self.page.wait_for_function(
            "([number, text]) => document.querySelectorAll('div.cell')[number - "
            "1].querySelector('.cell_output')"
            ".textContent.includes(text)",
            arg=[number, text],
        )


@pytest.mark.long
def test_the_figure_that_the_reader_has_turned_is_the_one_that_code_asks(context, site):
    page = FigurePage(context, site)
    as_the_code_says = page.angle()
    page.turn(90)
    page.run_below(page.asking)  # and, before it, the figure's own cell
    assert page.angle() == 90
    assert page.try_code(page.asking, "print(figure.angle)").startswith("1.5707963")
    page.turn(-30)
    assert page.try_code(page.asking, "print(figure.angle)").startswith("-0.5235987")
    # Python moves the figure as well, also by a matrix.
    page.try_code(page.asking, "figure.angle = 0.5")
    expect(page.field()).to_have_value("28.65")
    assert "0.479" in page.try_code(page.asking, "figure.dcm")
    assert "did you mean angle" in page.try_code(page.asking, "figure.angel = 0.5")
    assert "Angles are in radians" in page.try_code(page.asking, "figure.angle = 30")
    # Output and errors of observers appear below the figure.
    page.try_code(
        page.asking, "figure.observe(lambda change: print(f'now {change.new:.3f}'), 'angle')"
    )
    page.turn(45)
    page.says(page.figure, "now 0.785")
    page.try_code(
        page.asking, "figure.unobserve_all(); figure.observe(lambda change: 1 / 0, 'angle')"
    )
    page.turn(60)
    page.says(page.figure, "ZeroDivisionError")
    # A run of the figure's own cell makes a new figure from its code, and a cell further down uses
    # that.
    page.cell(page.figure).locator("summary").first.click()
    page.cell(page.figure).locator("button.run-cell").click()
    expect(page.field()).to_have_value(str(as_the_code_says))
    page.wait()
    assert page.cell(page.figure).locator(".moving").count() == 1
    angle = float(page.try_code(page.asking, "print(figure.angle)"))
    assert angle == pytest.approx(math.radians(as_the_code_says), abs=1e-3)
    # Other controls need a notebook, and say so.
    assert "The notebook can" in page.try_code(
        page.asking, "import ipywidgets\nipywidgets.IntSlider()"
    )
    assert page.outside() == [] and page.errors == []


def test_a_figure_stays_turned_where_the_page_has_to_be_loaded_once_more(browser, not_isolated):
    """Without shared memory from the server, the first run reloads the page with a service worker."""
    context = browser.new_context()
    page = FigurePage(context, not_isolated)
    page.turn(90)
    page.cell(page.asking).locator("button.run-cell").click()
    page.page.wait_for_function("() => crossOriginIsolated")
    page.page.wait_for_selector("html.live-busy", state="attached")
    page.wait()
    assert page.angle() == 90
    opened.remove(page.page)
    context.close()


@pytest.mark.long
def test_a_figure_is_set_from_a_matrix_of_the_readers_own(context, site):
    page = Page(context, site, "chapters/direction-cosine-matrices.html")
    number = page.number("TriadFigure(")
    cell = page.cell(number)
    cell.locator("summary").first.click()
    cell.locator("button.run-cell").click()
    page.wait()
    turned = (
        "from orientation_figures.moving import TriadFigure\n"
        "figure = TriadFigure(axis=(0, 0, 1), angle=1.0)\n"
    )
    for matrix, angle, entry in (
        ("[[0, 1, 0], [0, 0, 1], [1, 0, 0]]", "120", "a x dot n y: \u20071.000"),
        ("sm.Matrix([[1, 0, 0], [0, 0, -1], [0, 1, 0]])", "-90", "a z dot n y: \u20071.000"),
        ("simple_dcm('y', 0.5)", "28.65", "a z dot n x: \u20070.479"),
    ):
        page.try_code(
            number,
            "import sympy as sm\nfrom orientation import simple_dcm\n"
            f"{turned}figure.dcm = {matrix}\nfigure",
        )
        cell.get_by_role("button", name=entry, exact=True).wait_for()
        shown = abs(float(cell.get_by_label("theta in degrees").input_value()))
        # About the opposite axis it is the opposite angle.
        assert shown == abs(float(angle)), matrix
    # A reflection is refused, and the figure says why.
    assert "left-handed" in page.try_code(
        number, f"{turned}figure.dcm = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]\nfigure"
    )
    assert page.errors == []


@pytest.mark.long
def test_the_explorer_of_sequences_works_in_the_page(context, site):
    page = Page(context, site, "chapters/euler-angles.html")
    cell = page.cell(page.number("SequenceExplorer("))
    cell.locator("button.run-cell").click()
    cell.get_by_label("Sequence", exact=True).select_option("zyz")
    cell.get_by_text("z-y-z locks at θ = 0 and θ = π").first.wait_for()
    assert cell.locator("math").count() == 5
    cell.get_by_label("theta: a symbol or radians").fill("pi/6")
    cell.get_by_text("Here it is 0.524 rad away from that.").first.wait_for()
    cell.get_by_label("Rotations are").select_option("space")
    cell.locator("msqrt").first.wait_for()
    assert page.outside() == [] and page.errors == []
