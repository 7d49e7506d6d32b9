"""Which edition the book is, and the edition for exams: without solutions,
and without a word that leads to one.
"""

import io
import json
import os
import re
import shutil
import subprocess
import sys
import threading
import zipfile
from importlib import import_module

import nbformat
import pytest
import yaml
from bs4 import BeautifulSoup
from docutils import nodes
from places import HTML, REPOSITORY
from sphinx import addnodes
from test_website import build, chapter

import coursework
import orientation
from coursework.checking.questions import NoSuchQuestion, find_question
from notebook_pages import exam, paths
from notebook_pages.finish import pages_of
from notebook_pages.serve import server

SETTINGS = yaml.safe_load((REPOSITORY / "_config.yml").read_text("utf8"))
CITATION = yaml.safe_load((REPOSITORY / "CITATION.cff").read_text("utf8"))


def test_the_edition_is_said_in_one_place():
    stated = CITATION["preferred-citation"]
    which = paths.edition(REPOSITORY)
    assert (which.name, which.date) == (stated["edition"], stated["date-released"])
    assert which.words == f"{which.name}, {which.day}"
    news = (REPOSITORY / "appendix" / "changes.md").read_text("utf8")
    assert which.name == re.search(r"^## The (\w+ edition)$", news, re.MULTILINE)[1].capitalize()
    assert {CITATION["title"], stated["title"]} == {SETTINGS["title"]}
    assert {one["name"] for one in CITATION["authors"] + stated["authors"]} == {SETTINGS["author"]}
    sources = [
        *REPOSITORY.glob("*.ipynb"),
        *(REPOSITORY / "notebook-pages" / "src" / "notebook_pages").rglob("*.py"),
    ]
    assert [path.name for path in sources if which.words in path.read_text("utf8")] == []


def test_every_page_says_which_edition_it_is():
    which = paths.edition(REPOSITORY)
    for path in pages_of(HTML):
        if path.name not in ("404.html",):
            text = path.read_text("utf8")
            assert which.words in text.partition("<footer")[2], path
            assert f'<meta name="citation_publication_date" content="{which.date}">' in text, path
            assert f'<meta name="dcterms.hasVersion" content="{which.name}">' in text, path


def test_the_front_page_says_how_the_book_is_cited():
    front = BeautifulSoup((HTML / "index.html").read_text("utf8"), "lxml").article
    words, which = " ".join(front.get_text().split()), paths.edition(REPOSITORY)
    assert f"{SETTINGS['author']}, {SETTINGS['title']}. {which.words}." in words
    assert (
        re.search(rf"@book{{[a-z-]+, title = {{{SETTINGS['title']}}},", words)
        and f"{{{which.name}}}" in words
    )
    assert front.select_one('a[href^="appendix/changes.html"]')


def test_what_is_new_is_told_of_chapters_that_are_there():
    """Each chapter that readers of the last edition do not know is
    named among those that are new.
    """
    page = BeautifulSoup((HTML / "appendix" / "changes.html").read_text("utf8"), "lxml").article
    new = {link["href"] for link in page.select("#chapters-that-are-new dt a[href]")}
    assert new == {
        f"../chapters/{name}.html#chapter-{name}"
        for name in ("angular-velocity", "map-of-descriptions", "orientation-from-sensors")
    }
    grown = {link["href"] for link in page.select("#chapters-that-have-grown dt a[href]")}
    chapters = [name for name in paths.pages() if name.startswith("chapters/")]
    assert {
        address.partition("#")[0].removeprefix("../").removesuffix(".html")
        for address in new | grown
    } <= set(chapters)


# ---- what an earlier edition had an address for -------------------------------


SECOND = json.loads(
    (
        REPOSITORY / "tests" / "orientation_course" / "editions" / "second" / "addresses.json"
    ).read_text("utf8")
)


def test_every_page_and_label_of_the_second_edition_leads_somewhere():
    """What moved is named under `moved` in _config.yml."""
    lost = [page for page in SECOND["pages"] if not (HTML / f"{page}.html").is_file()]
    for page in sorted(set(SECOND["pages"]) - set(lost)):
        text = (HTML / f"{page}.html").read_text("utf8")
        if 'http-equiv="refresh"' not in text:
            there = set(re.findall(r'\bid="([^"]+)"', text))
            lost += [f"{page}#{label}" for label in SECOND["pages"][page] if label not in there]
    assert lost == []


def test_every_question_of_the_second_edition_is_there_or_has_left_word():
    """What has another name is named under [moved] in course.toml."""
    for notebook, names in SECOND["questions"].items():
        for name in names:
            try:
                assert find_question(f"{notebook}/{name}", "")
            except NoSuchQuestion as error:
                assert "is called" in str(error), error


def test_every_name_of_the_second_edition_is_there():
    """CHANGELOG.md promises a warning, in a version before, of each that goes."""
    for module, names in SECOND["names"].items():
        assert [name for name in names if not hasattr(import_module(module), name)] == []


@pytest.mark.long
def test_who_kept_an_address_gets_to_where_it_is_now(tmp_path, browser):
    cells = chapter()
    moved = {
        "chapters/gone": "chapter",
        "gone-too": "chapter#fig-line",
        "chapter#fig-first-line": "chapter#fig-line",
        "index#fig-old": "chapter#fig-line",
    }
    code, words = build(tmp_path, {"chapter": cells}, moved=moved)
    assert code == 0, words
    book = server(folder=tmp_path / "_build" / "html")
    threading.Thread(target=book.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{book.server_port}"
    page = browser.new_context(bypass_csp=False).new_page()
    for old, new in (
        ("chapters/gone.html", "chapter.html"),
        ("chapters/gone.html#fig-line", "chapter.html#fig-line"),
        ("gone-too.html", "chapter.html#fig-line"),
    ):
        page.goto(f"{address}/{old}")
        page.wait_for_url(f"{address}/{new}")
    page.goto(f"{address}/chapter.html#fig-first-line")
    at = "document.getElementById('{}').getBoundingClientRect().top"
    assert (
        abs(page.evaluate(at.format("fig-first-line")) - page.evaluate(at.format("fig-line"))) < 60
    )
    page.goto(f"{address}/index.html")
    note = page.locator("#fig-old")
    assert not note.is_visible()
    page.goto(f"{address}/index.html#fig-old")
    assert note.is_visible()
    assert note.inner_text() == "What stood here has moved: A chapter"
    assert note.locator("a").get_attribute("href") == "chapter.html#fig-line"
    page.context.close()
    book.shutdown()
    book.server_close()


@pytest.mark.long
@pytest.mark.parametrize(
    "moved",
    [
        {"gone": "nowhere"},
        {"gone": "chapter#no-such-label"},
        {"chapter": "index"},  # it is there
        {"gone#label": "chapter"},  # of a page that is gone, the page is named
    ],
)
def test_what_leads_nowhere_is_refused(tmp_path, moved):
    code, words = build(tmp_path, {"chapter": chapter()}, moved=moved)
    assert code != 0 and "moved, in _config.yml" in words and next(iter(moved)) in words


def test_the_newest_version_is_the_same_everywhere():
    """In the packages, in how the book is cited, and on top of the changelog."""
    changes = re.findall(
        r"^## ([0-9.]+)$", (REPOSITORY / "CHANGELOG.md").read_text("utf8"), re.MULTILINE
    )
    assert changes == sorted(
        changes, key=lambda version: list(map(int, version.split("."))), reverse=True
    )
    assert {orientation.__version__, coursework.__version__, CITATION["version"]} == {changes[0]}


# ---- the edition for exams ------------------------------------------------------


def refers(label, kind="ref"):
    return addnodes.pending_xref(
        "", nodes.inline("", "there"), refdomain="std", reftype=kind, reftarget=label
    )


def paragraph(*parts):
    found = nodes.paragraph(
        "", "", *(nodes.Text(part) if isinstance(part, str) else part for part in parts)
    )
    page = nodes.section("", found)
    exam.strip(None, page)
    return [one.astext() for one in page.children]


def test_only_the_sentence_that_leads_to_a_solution_goes():
    solution, other = refers("solution-door"), refers("/exercises/door", "doc")
    assert paragraph(
        "Worked solutions: ", solution, " and ", refers("solution-x"), ". More: ", other, "."
    ) == ["More: there."]
    assert paragraph("Try first! The solutions are ", refers("solutions"), ". They wait.") == [
        "Try first! They wait."
    ]
    assert paragraph("See ", refers("solution-door"), ".") == []
    assert paragraph("See ", refers("chapter-door"), ". It solves.") == ["See there. It solves."]
    assert paragraph(
        "In ", refers("/appendix/solutions-going-further", "doc"), " it is. Good."
    ) == ["Good."]
    assert paragraph("In ", refers("solutions-going-further"), ".") == []


def test_the_pages_of_solutions_are_left_out(monkeypatch):
    monkeypatch.chdir(REPOSITORY)
    whole = paths.pages()
    assert not paths.exam_edition() and "without" not in paths.edition().words
    monkeypatch.setenv("BOOK_EXAM", "1")
    assert [page for page in whole if page not in paths.pages()] == [
        "appendix/solutions",
        "appendix/solutions-going-further",
    ]
    assert "without solutions" in paths.edition().words
    monkeypatch.setenv("BOOK_EXAM", "0")
    assert paths.pages() == whole


@pytest.mark.long
def test_a_page_that_led_to_a_solution_is_built_without(tmp_path, monkeypatch):
    cells = chapter()
    cells[
        0
    ].source += "\n\nA worked solution: {ref}`here <solution-one>`. And {ref}`chapter-one` stays.\n"
    (tmp_path / "usual").mkdir()
    code, words = build(tmp_path / "usual", {"chapter": cells})
    assert code != 0 and "solution-one" in words
    monkeypatch.setenv("BOOK_EXAM", "1")
    (tmp_path / "exam").mkdir()
    code, words = build(tmp_path / "exam", {"chapter": cells})
    assert code == 0, words
    text = (tmp_path / "exam" / "_build" / "html" / "chapter.html").read_text("utf8")
    assert "worked solution" not in text and "stays." in text


def passages():
    """Runs of plain words from the worked solutions, long enough to be found by nothing else."""
    for path in sorted((REPOSITORY / "appendix").glob("solutions*.ipynb")):
        for cell in nbformat.read(path, as_version=4).cells:
            if cell.cell_type == "markdown":
                for run in re.findall(
                    r"[A-Za-z][A-Za-z ,\n]{45,}", re.sub(r"```.*", "", cell.source)
                ):
                    yield " ".join(run.split())


def contents(name, content):
    """The files in ``content``, also those within archives."""
    if content[:2] == b"PK":
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            for inside in archive.namelist():
                yield from contents(f"{name}/{inside}", archive.read(inside))
    elif content[:4] == b"%PDF":
        pdfium = pytest.importorskip("pypdfium2")
        texts = (page.get_textpage().get_text_range() for page in pdfium.PdfDocument(content))
        yield name, " ".join(" ".join(texts).split())
    else:
        text = re.sub(r"<[^>]+>|\\n|&[a-z]+;", " ", content.decode("utf8", "replace"))
        yield name, " ".join(text.split())


def with_solutions(folder, wanted):
    """The files below ``folder`` that hold one of the passages ``wanted``."""
    pattern = re.compile("|".join(map(re.escape, wanted)))
    files = [path for path in folder.rglob("*") if path.is_file()]
    found = (
        one for path in files for one in contents(str(path.relative_to(folder)), path.read_bytes())
    )
    return {name: match[0] for name, text in found if (match := pattern.search(text))}


@pytest.mark.long
def test_no_file_of_an_exam_edition_holds_a_solution(tmp_path):
    wanted = set(passages())
    assert len(wanted) > 80
    there = with_solutions(HTML / "appendix", wanted)
    assert set(there) >= {"solutions.html", "solutions-going-further.html"}, (
        "the passages are found where they are"
    )
    for name in ("chapters", "exercises", "appendix", "src", "coursework", "notebook-pages"):
        shutil.copytree(
            REPOSITORY / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__")
        )
    for path in REPOSITORY.iterdir():
        if path.is_file():
            shutil.copy(path, tmp_path / path.name)
    if (REPOSITORY / "_build" / "jupyter_cache").is_dir():
        shutil.copytree(
            REPOSITORY / "_build" / "jupyter_cache", tmp_path / "_build" / "jupyter_cache"
        )
    environment = os.environ | {"BOOK_EXAM": "1", "NOTEBOOK_PAGES_FETCHED": str(REPOSITORY)}
    for module in ("notebook_pages.build", "notebook_pages.whole_book"):
        done = subprocess.run(
            [sys.executable, "-m", module],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    site = tmp_path / "_build" / "html"
    assert with_solutions(site, wanted) == {}
    pages = [path for path in pages_of(site) if path.name != "404.html"]
    assert len(pages) > 50
    for path in [
        *pages,
        *(
            site / name
            for name in (
                "llms.txt",
                "_static/search.js",
                "_static/search-words.js",
                "offline.json",
                "objects.inv",
            )
        ),
    ]:
        text = path.read_text("utf8", "replace")
        assert not re.search(
            r"appendix/solutions|[\"/]solutions(-going-further)?\.(html|ipynb|py)|#solution-", text
        ), path
    assert "without solutions" in (site / "index.html").read_text("utf8")
