"""What a screen reader is told of a PDF: a small one, printed and put in order as
the book is, and each way to fail.

The whole book's PDF is held against the same list in test_whole_book.py.
"""

import base64
import io

import pytest
from accessible_pdf import elements, faults

from notebook_pages import pdf, tagged
from notebook_pages.paths import NODE_MODULES

pikepdf = pytest.importorskip("pikepdf")
Name = pikepdf.Name

DRAWING = (
    '<svg role="img" aria-label="A square with a word in it" width="90" height="90">'
    '<path d="M9 9h60v60h-60z"/><text x="20" y="40" fill="#fff">word</text></svg>'
)
ROW = "<tr><th scope='row'>n</th><td>1</td></tr>"
# The book's own typeface, so that nothing hangs on those of the machine.
FACE = (
    NODE_MODULES
    / "@fontsource"
    / "source-sans-3"
    / "files"
    / "source-sans-3-latin-400-normal.woff2"
)
PAGE = f"""<!doctype html><html lang="en"><head><title>Small</title><style>
@font-face {{ font-family: face; src: url(data:font/woff2;base64,{base64.b64encode(FACE.read_bytes()).decode()}) }}
* {{ font-family: face; }}
@page {{ size: 500px 400px; margin: 50px; @bottom-center {{ content: counter(page); }} }}
.box {{ border: 1px solid; background: #eee; }} em {{ text-decoration: underline; }}
</style></head><body><article><h1>One</h1>
<div class="box"><p>Words, <em>some</em> of them <b>strong</b>, and
<span role="img" aria-label="{tagged.FORMULA}n hat x">n<span style="opacity: 0.5">x</span></span>.</p></div>
<figure>{DRAWING}<figcaption><p>A caption.</p></figcaption></figure>
<h2 id="two">Two</h2><ul><li>first</li><li>second <a href="https://example.org/there">elsewhere</a></li></ul>
<div>Words in a box, and <code>code</code>.</div><hr>
<table><thead><tr><th>name</th><th>value</th></tr></thead><tbody>{ROW * 40}</tbody></table>
<p>Back to <a href="#two">the second part</a>.</p></article></body></html>"""


@pytest.fixture(scope="module")
def printed(browser):
    page = browser.new_context().new_page()
    page.set_content(PAGE)
    page.evaluate("document.fonts.ready")
    made = page.pdf(**pdf.PAPER)
    page.context.close()
    return made


@pytest.fixture(scope="module")
def finished(printed):
    return pdf.finish(printed, ["One", "Two"], "Small", "Somebody")


@pytest.fixture
def book(finished):
    with pikepdf.open(io.BytesIO(finished)) as opened:
        yield opened


def find(book, kind):
    return next(node for node, _, _ in elements(book) if node.S == f"/{kind}")


def numbers(book):
    return {fault.partition(" ")[0] for fault in faults(book)}


def test_what_is_printed_is_put_in_order(printed, book):
    with pikepdf.open(io.BytesIO(printed)) as raw:
        assert {"BBox", "01-005", "02-001", "06-001", "09-005", "13-004", "28-012"} <= numbers(raw)
    assert faults(book) == []
    kinds = [kind for _, kind, _ in elements(book)]
    assert kinds.count("Formula") == kinds.count("Figure") == kinds.count("Caption") == 1
    assert kinds.count("LBody") == 2 and kinds.count("Link") == 2 and kinds.count("TH") == 42
    assert "NonStruct" not in kinds
    assert str(find(book, "Formula").Alt) == "n hat x"
    assert str(book.docinfo.Title) == "Small" and book.pdf_version == "1.7"


def test_all_that_is_there_to_read_is_read_once_and_in_order(printed):
    with pikepdf.open(io.BytesIO(printed)) as raw:
        words = tagged.mend(raw, printed)
    begins = (
        "One Words, some of them strong, and n hat x. A square with a word in it A caption. Two "
        "first second elsewhere"
    )
    whole = f"{begins} Words in a box, and code. name value {'n 1 ' * 40} Back to the second part."
    assert "".join(words.split()) == "".join(whole.split())


def test_a_picture_says_where_it_stands(book):
    left, bottom, right, top = map(float, find(book, "Figure").A.BBox)
    # The square is 60 pixels wide, 45 points; its corner is 9 pixels from that
    # of the drawing, which is indented.
    assert (right - left, top - bottom) == pytest.approx((45, 45), abs=0.5)
    assert 37.5 < left < 200 and 37.5 < bottom < 262


def test_a_link_says_where_it_leads(book):
    assert {str(note.Contents) for note in notes(book)} == {
        "elsewhere (https://example.org/there)",
        "the second part, page 2",
    }


def test_the_same_print_gives_the_same_file(printed, finished):
    assert pdf.finish(printed, ["One", "Two"], "Small", "Somebody") == finished


def without(holder, key):
    del holder[key]


def rename(book, kind, new_kind):
    find(book, kind).S = Name(f"/{new_kind}")


def change(stream, before, after):
    stream.write(stream.read_bytes().replace(before, after))


def change_content(book, before, after):
    for page in book.pages:
        change(page.Contents, before, after)


def notes(book):
    return [note for page in book.pages for note in page.get("/Annots", [])]


def forget_piece(book):
    node = next(
        node for node, kind, _ in elements(book) if kind == "P" and isinstance(node.K[0], int)
    )
    node.K = pikepdf.Array(list(node.K)[1:])


def fonts(book):
    return [font for page in book.pages for font in page.Resources.Font.values()]


FAILURES = {
    "01-003": lambda book: change_content(book, b"BDC\n", b"BDC\n/Artifact BMC\nEMC\n"),
    "01-004": lambda book: change_content(book, b"/Artifact BMC\n", b"/Artifact BMC\n/P <</MCID "
        b"0>> BDC\nEMC\n"),
    "01-005": lambda book: change_content(book, b"/Artifact BMC\n", b"/Span BMC\n"),
    "01-006": forget_piece,
    "02-001": lambda book: without(book.Root.StructTreeRoot.RoleMap, "/Em"),
    "06-001": lambda book: without(book.Root, "/Metadata"),
    "06-002": lambda book: change(book.Root.Metadata, b"pdfuaid:part", b"pdfuaid:rev"),
    "07-001": lambda book: without(book.Root.ViewerPreferences, "/DisplayDocTitle"),
    "09-004": lambda book: rename(book, "L", "Div"),
    "09-005": lambda book: rename(book, "LBody", "Div"),
    "10-001": lambda book: without(fonts(book)[0], "/ToUnicode"),
    "11-006": lambda book: without(book.Root, "/Lang"),
    "13-004": lambda book: without(find(book, "Figure"), "/Alt"),
    "BBox": lambda book: without(find(book, "Figure"), "/A"),
    "14-002": lambda book: rename(book, "H1", "H2"),
    "14-003": lambda book: rename(book, "H2", "H4"),
    "15-003": lambda book: without(find(book, "TH"), "/A"),
    "17-002": lambda book: find(book, "Formula").__setattr__("Alt", pikepdf.String(r"\hat{n}_x")),
    "28-008": lambda book: [without(page, "/Tabs") for page in book.pages],
    "28-011": lambda book: rename(book, "Link", "Span"),
    "28-012": lambda book: without(notes(book)[0], "/Contents"),
    "31-004": lambda book: without(fonts(book)[0].DescendantFonts[0], "/CIDToGIDMap"),
    "31-009": lambda book: without(fonts(book)[0].DescendantFonts[0].FontDescriptor, "/FontFile2"),
}  # fmt: skip


@pytest.mark.parametrize("number", FAILURES)
def test_the_list_finds(number, book):
    FAILURES[number](book)
    assert number in numbers(book)
