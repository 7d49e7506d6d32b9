"""The edition of the book, and the edition for exams, without solutions and links to them."""

import io
import os
import re
import shutil
import subprocess
import sys
import zipfile

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
from notebook_pages import exam, paths
from notebook_pages.finish import pages_of

SETTINGS = yaml.safe_load((REPOSITORY / "_config.yml").read_text("utf8"))
CITATION = yaml.safe_load((REPOSITORY / "CITATION.cff").read_text("utf8"))


def test_the_edition_is_said_in_one_place():
    stated = CITATION["preferred-citation"]
    which = paths.edition(REPOSITORY)
    assert (which.name, which.date) == (stated["edition"], stated["date-released"])
    assert which.words == f"{which.name}, {which.day}"
    assert {CITATION["title"], stated["title"]} == {SETTINGS["title"]}
    assert {author["name"] for author in CITATION["authors"] + stated["authors"]} == {
        SETTINGS["author"]
    }
    sources = [
        *REPOSITORY.glob("*.ipynb"),
        *(REPOSITORY / "packages" / "notebook-pages" / "src" / "notebook_pages").rglob("*.py"),
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


def test_the_newest_version_is_the_same_everywhere():
    """In the packages, in the citation, and on top of the changelog."""
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
    node = nodes.paragraph(
        "", "", *(nodes.Text(part) if isinstance(part, str) else part for part in parts)
    )
    page = nodes.section("", node)
    exam.strip(None, page)
    return [part.astext() for part in page.children]


SOLUTIONS = "/appendix/solutions-going-further"


@pytest.mark.parametrize(
    ("parts", "left"),
    [
        (
            (
                "Worked solutions: ",
                ("solution-door",),
                " and ",
                ("solution-x",),
                ". More: ",
                ("/exercises/door", "doc"),
                ".",
            ),
            ["More: there."],
        ),
        (
            ("Try first! The solutions are ", ("solutions",), ". They wait."),
            ["Try first! They wait."],
        ),
        (("See ", ("solution-door",), "."), []),
        (("See ", ("chapter-door",), ". It solves."), ["See there. It solves."]),
        (("In ", (SOLUTIONS, "doc"), " it is. Good."), ["Good."]),
        (("In ", ("solutions-going-further",), "."), []),
    ],
)
def test_only_the_sentence_that_leads_to_a_solution_goes(parts, left):
    """A part is a text, or the target of a reference."""
    assert paragraph(*(part if isinstance(part, str) else refers(*part) for part in parts)) == left


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
    """Return runs of plain words from the worked solutions, long enough to be unique."""
    for path in sorted((REPOSITORY / "appendix").glob("solutions*.ipynb")):
        for cell in nbformat.read(path, as_version=4).cells:
            if cell.cell_type == "markdown":
                for run in re.findall(
                    r"[A-Za-z][A-Za-z ,\n]{45,}", re.sub(r"```.*", "", cell.source)
                ):
                    yield " ".join(run.split())


def contents(name, content):
    """Iterate over the files in ``content``, also those within archives."""
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


def with_solutions(folder, sought):
    """Return the files below ``folder`` that contain one of the passages ``sought``."""
    pattern = re.compile("|".join(map(re.escape, sought)))
    files = [path for path in folder.rglob("*") if path.is_file()]
    texts = (
        text
        for path in files
        for text in contents(str(path.relative_to(folder)), path.read_bytes())
    )
    return {name: match[0] for name, text in texts if (match := pattern.search(text))}


@pytest.mark.long
def test_no_file_of_an_exam_edition_holds_a_solution(tmp_path):
    sought = set(passages())
    assert len(sought) > 80
    there = with_solutions(HTML / "appendix", sought)
    assert set(there) >= {"solutions.html", "solutions-going-further.html"}, (
        "the passages are found where they are"
    )
    for name in ("chapters", "exercises", "appendix", "src", "packages"):
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
    # The PDF and the EPUB are made from the pages of this site, and from nothing else.
    done = subprocess.run(
        [sys.executable, "-m", "notebook_pages.build"],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    site = tmp_path / "_build" / "html"
    assert with_solutions(site, sought) == {}
    pages = [path for path in pages_of(site) if path.name != "404.html"]
    assert len(pages) > 50
    for path in [
        *pages,
        *(
            site / name
            for name in (
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
