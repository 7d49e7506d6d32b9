"""What a screen reader is told of a small PDF, printed and finished as that of the book is.

The whole book's PDF is compared with the pages in test_whole_book.py.
"""

import io
from collections import Counter

import pytest

from notebook_pages import pdf

pikepdf = pytest.importorskip("pikepdf")

DRAWING = (
    '<svg role="img" aria-label="A square with a word in it" width="90" height="90">'
    '<path d="M9 9h60v60h-60z"/><text x="20" y="40" fill="#fff">word</text></svg>'
)
ROW = "<tr><th scope='row'>n</th><td>1</td></tr>"
PAGE = f"""<!doctype html><html lang="en"><head><title>Small</title><style>
@page {{ size: 500px 400px; margin: 50px; }}
</style></head><body><article><h1>One</h1>
<p>Words, <em>some</em> of them <strong>strong</strong>, and
<span role="img" aria-label="{pdf.FORMULA}n hat x">n<span style="opacity: 0.5">x</span></span>.</p>
<figure>{DRAWING}<figcaption><p>A caption.</p></figcaption></figure>
<h2 id="two">Two</h2><ul><li>first</li><li>second <a href="https://example.org/">there</a></li></ul>
<table><thead><tr><th>name</th><th></th></tr></thead><tbody>{ROW * 40}</tbody></table>
<p>Back to <a href="#two">the second part</a>.</p></article></body></html>"""


@pytest.fixture(scope="module")
def printed(browser):
    page = browser.new_context().new_page()
    page.set_content(PAGE)
    made = page.pdf(**pdf.PAPER)
    page.context.close()
    return made


@pytest.fixture(scope="module")
def finished(printed):
    return pdf.finish(printed, ["One", "Two"], "Small", "Somebody")


def parts(element):
    """Return what is directly in an element: other elements, and the numbers of marked content."""
    inside = element.get("/K", [])
    return list(inside) if isinstance(inside, pikepdf.Array) else [inside]


def walk(element):
    """Iterate over an element and all below it, in the order of reading."""
    yield element
    for part in parts(element):
        if isinstance(part, pikepdf.Dictionary) and "/S" in part:
            yield from walk(part)


@pytest.fixture(scope="module")
def elements(finished):
    with pikepdf.open(io.BytesIO(finished)) as opened:
        yield list(walk(opened.Root.StructTreeRoot.K))


def test_each_part_has_its_kind(finished, elements):
    kinds = Counter(str(element.S)[1:] for element in elements)
    expected = {"H1": 1, "H2": 1, "Figure": 1, "Formula": 1, "Caption": 1, "L": 1, "LI": 2}
    expected |= {"Link": 2, "Table": 1, "TR": 41, "TH": 42, "TD": 40, "Strong": 1, "Em": 1}
    assert {kind: kinds[kind] for kind in expected} == expected
    with pikepdf.open(io.BytesIO(finished)) as opened:
        assert str(opened.docinfo.Title) == "Small" and str(opened.Root.Lang) == "en"
        assert opened.Root.MarkInfo.Marked and opened.Root.ViewerPreferences.DisplayDocTitle
        assert {*opened.Root.StructTreeRoot.RoleMap.keys()} == {"/Strong", "/Em"}
        with opened.open_outline() as outline:
            assert [bookmark.title for bookmark in pdf.in_order(outline.root)] == ["One", "Two"]


def test_pictures_and_formulas_are_read_in_words(elements):
    described = [(str(element.S), str(element.Alt)) for element in elements if "/Alt" in element]
    assert described == [("/Formula", "n hat x"), ("/Figure", "A square with a word in it")]


def test_the_head_of_a_table_on_several_pages_is_read_once(elements, finished):
    with pikepdf.open(io.BytesIO(finished)) as opened:
        assert len(opened.pages) > 2
    head = next(element for element in elements if element.S == "/TH")
    content = [part for element in walk(head) for part in parts(element)]
    assert sum(isinstance(part, int) or "/S" not in part for part in content) == 1


def test_the_same_print_gives_the_same_file(printed, finished):
    assert pdf.finish(printed, ["One", "Two"], "Small", "Somebody") == finished
