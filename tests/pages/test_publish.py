"""The metadata of the built pages, and those that a published book adds with its address."""

import re
from collections import Counter
from functools import cache
from html import unescape
from urllib.parse import parse_qs, urlsplit

import pytest
import yaml
from bs4 import BeautifulSoup
from places import HTML, REPOSITORY
from test_website import build, chapter

import orientation
from notebook_pages.finish import pages_of
from notebook_pages.paths import LICENCES
from notebook_pages.publish import LONGEST

SETTINGS = yaml.safe_load((REPOSITORY / "_config.yml").read_text("utf8"))


@cache
def head(path):
    return path.read_text("utf8").partition("<body")[0]


def meta(text, name):
    (content,) = re.findall(rf'<meta (?:name|property)="{name}" content="([^"]*)"', text)
    return unescape(content)


def test_each_page_describes_itself():
    described = [
        path
        for path in pages_of(HTML)
        if path.name not in ("404.html", "search.html", "genindex.html")
    ]
    descriptions = Counter()
    for path in described:
        words = meta(head(path), "description")
        assert 20 < len(words) <= LONGEST and "\\" not in words and "<" not in words, (
            f"{path}: {words}"
        )
        assert meta(head(path), "og:description") == words
        assert SETTINGS["title"] in meta(head(path), "og:title")
        assert head(path).count('name="viewport"') == 1, path
        assert LICENCES["Text"][1] in path.read_text("utf8").partition("<footer")[2], (
            f"{path} does not name its licence"
        )
        descriptions[words] += 1
    assert [words for words, count in descriptions.items() if count > 1] == []


def test_files_for_machines():
    assert (HTML / ".nojekyll").is_file()
    assert "Allow: /" in (HTML / "robots.txt").read_text("utf8")
    missing = (HTML / "404.html").read_text("utf8")
    assert 'href="/index.html"' in missing and "_static" not in missing, (
        "it stands in for an address in any folder"
    )


def test_index_names_every_term_symbol_and_function():
    """It links from each of them to its explanation and to pages that mention it."""
    page = BeautifulSoup(
        (HTML / "appendix" / "subject-index.html").read_text("utf8"), "lxml"
    ).article
    terms, symbols, functions = (
        page.select(f"#{name} li") for name in ("terms", "symbols", "functions-and-classes")
    )
    first = [item.a.get_text() for item in terms]
    glossary = BeautifulSoup(
        (HTML / "appendix" / "glossary.html").read_text("utf8"), "lxml"
    ).article
    assert set(first) == {
        entry.find(string=True).strip() for entry in glossary.select("dl.glossary > dt")
    }
    assert first == sorted(first, key=str.casefold) and len(first) > 30
    assert all(item.a["href"].startswith("glossary.html#") for item in terms)
    assert sum(len(item.select("a")) > 1 for item in terms) > 0.8 * len(terms), (
        "most terms are in a chapter"
    )
    assert len(symbols) >= 8 and all(item.select_one(".katex") for item in symbols)
    assert {item.a.get_text() for item in functions} >= set(orientation.__all__)
    (slerp,) = [item for item in functions if item.a.get_text() == "interpolate_quaternions"]
    assert any("quaternions-in-full.html" in link["href"] for link in slerp.select("a"))


def test_title_is_said_once():
    """The title is in the settings, and everything else that names the book reads it there."""
    title = SETTINGS["title"]
    sources = REPOSITORY / "packages" / "notebook-pages" / "src" / "notebook_pages"
    programs = [path for kind in ("*.py", "*.js", "*.html") for path in sources.rglob(kind)]
    programs += [*(REPOSITORY / "tests").rglob("test_*.py")]
    assert [path.name for path in programs if title in path.read_text("utf8")] == []


@pytest.mark.long
def test_published_book_names_its_address_and_its_source(tmp_path, monkeypatch):
    monkeypatch.setenv("BOOK_ADDRESS", "https://example.org/books/tiny")
    monkeypatch.setenv("BOOK_REPOSITORY", "https://github.com/example/tiny-book")
    (tmp_path / "CITATION.cff").write_text(
        "version: 3.0\ndate-released: 2026-11-22\ndoi: 10.5281/zenodo.1\n"
    )
    cells = chapter()
    cells[0].source += "\n\n```{cite-this-book}\n```\n"
    code, words = build(tmp_path, {"chapter": cells})
    assert code == 0, words
    site = tmp_path / "_build" / "html"
    text = (site / "chapter.html").read_text("utf8")
    assert '<link rel="canonical" href="https://example.org/books/tiny/chapter.html" />' in text
    assert meta(text, "og:url") == "https://example.org/books/tiny/chapter.html"
    assert "<loc>https://example.org/books/tiny/chapter.html</loc>" in (
        site / "sitemap.xml"
    ).read_text("utf8")
    assert "Sitemap: https://example.org/books/tiny/sitemap.xml" in (site / "robots.txt").read_text(
        "utf8"
    )
    assert 'href="/books/tiny/index.html"' in (site / "404.html").read_text("utf8")
    assert "Edition 3.0, 22 November 2026" in text.partition("<footer")[2]
    assert (
        meta(text, "citation_doi") == "10.5281/zenodo.1"
        and meta(text, "citation_publication_date") == "2026-11-22"
    )
    cited = " ".join(BeautifulSoup(text, "lxml").article.get_text().split())
    assert "A small book. Edition 3.0, 22 November 2026. https://doi.org/10.5281/zenodo.1." in cited
    assert "doi = {10.5281/zenodo.1}, url = {https://example.org/books/tiny/}, }" in cited
    (report,) = re.findall(r'class="report-mistake" href="([^"]*)"', text)
    asked = parse_qs(urlsplit(unescape(report)).query)
    assert "(chapter)" in asked["body"][0] and "Edition 3.0, 22" in asked["body"][0]
    assert 'href="https://github.com/example/tiny-book/edit/main/chapter.ipynb"' in text
    picture = meta(text, "og:image").removeprefix("https://example.org/books/tiny/")
    assert (site / picture).read_bytes().startswith(b"\x89PNG")
