"""The downloads of the whole book: the content of the PDF, and the zip as opened from disk."""

import io
import math
import re
import shutil
import subprocess
import sys
import unicodedata
import urllib.request
import zipfile
from collections import Counter
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import yaml
from bs4 import BeautifulSoup
from places import BROWSER_REQUIRED, HTML, REPOSITORY
from test_site import SIDEWAYS

from notebook_pages import browser as browser_module
from notebook_pages import install, offline, pdf, whole_book
from notebook_pages.paths import edition, pages, parts
from notebook_pages.spoken import spoken

pikepdf = pytest.importorskip("pikepdf")
pdfium = pytest.importorskip("pypdfium2")

PDF, EPUB, ZIP = (REPOSITORY / path for path in (whole_book.PDF, whole_book.EPUB, whole_book.ZIP))
TITLE = yaml.safe_load((REPOSITORY / "_config.yml").read_text("utf8"))["title"]
CHAPTERS = [page for page in pages() if page.startswith("chapters/")]
MARGIN = 20  # millimetres at either side that nothing may enter
MILLIMETRE = 72 / 25.4


@pytest.fixture(autouse=True)
def made(request):
    """All files, made by `make take-away` from the present site; `make test` does not check them."""
    if request.node.get_closest_marker("long") and not all(
        path.exists() for path in (PDF, EPUB, ZIP)
    ):
        reason = "the whole book was not made: run `make take-away`"
        pytest.fail(reason) if browser_module.find() or BROWSER_REQUIRED else pytest.skip(reason)


@cache
def article(page):
    """Return the text of a page of the site, without the interactive parts."""
    soup = BeautifulSoup((HTML / f"{page}.html").read_text("utf8"), "lxml").select_one("article")
    for element in soup.select(pdf.ONLY_ON_SCREEN):
        element.decompose()
    return soup


def plain(text):
    """Return text on one line, without the effects of typesetting: lines, ligatures."""
    text = re.sub("\ufffe\\s*", "-", text)  # PDFium's form of a hyphen at the end of a line
    return re.sub(r"\s+", " ", unicodedata.normalize("NFKC", text))


@pytest.fixture(scope="module")
def book():
    with pikepdf.open(PDF) as opened:
        yield opened


@pytest.fixture(scope="module")
def texts():
    """Return the text of each page of the PDF, as a viewer's search finds it."""
    document = pdfium.PdfDocument(PDF)
    page_texts = []
    for page in document:
        text = page.get_textpage()
        page_texts.append(plain(text.get_text_range()))
        text.close()
        page.close()
    document.close()
    return page_texts


@pytest.fixture(scope="module")
def places(book):
    """Return the page, counted from 0, of every named place."""
    numbers = {page.objgen: number for number, page in enumerate(book.pages)}
    return {
        name.removeprefix("/"): numbers[place[0].objgen] for name, place in book.Root.Dests.items()
    }


@pytest.fixture(scope="module")
def chapter_texts(places, texts):
    """Return the texts of the pages of each chapter in the PDF, without headers and footers."""
    starts = [(name, places[pdf.place(name)]) for name in pages() if name != "index"]
    ends = [start for _, start in starts[1:]] + [len(texts)]
    by_page = {}
    for (name, start), end in zip(starts, ends):
        head = plain(pdf.heading(article(name).h1))
        by_page[name] = [
            texts[number].removeprefix(f"{head} {number + 1} ").rstrip()
            for number in range(start, end)
        ]
    return by_page


def is_there(words, texts):
    """Whether a page contains ``words``, or they go on at the top of the next page."""

    def goes_on(here, there):
        ends = [space.start() for space in re.finditer(" ", words)]
        return any(words[:end] in here and there.startswith(words[end + 1 :]) for end in ends)

    return any(words in text for text in texts) or any(
        goes_on(*pair) for pair in zip(texts, texts[1:])
    )


@pytest.mark.long
def test_it_says_what_it_is_and_lists_its_parts(book):
    """The bookmarks are the parts, chapters and sections."""
    assert str(book.docinfo.Title) == TITLE
    assert str(book.docinfo.Subject) == edition().words != ""
    with book.open_metadata(set_pikepdf_as_editor=False, update_docinfo=False) as metadata:
        assert (metadata["dc:title"], metadata["dc:description"]) == (TITLE, edition().words)
        assert metadata["dc:date"] == [edition().date]
    assert str(book.Root.Lang).startswith("en")
    assert book.Root.MarkInfo.Marked
    assert book.Root.PageMode == pikepdf.Name.UseOutlines
    with book.open_outline() as outline:
        bookmarks = {item.title: item.children for item in outline.root}
    headings = {
        page: [pdf.heading(h) for h in article(page).find_all(["h1", "h2"])] for page in pages()
    }
    for caption, names in parts():
        children = bookmarks.pop(caption)
        assert [child.title for child in children] == [headings[name][0] for name in names]
        for child, name in zip(children, names):
            # Replies to questions, which a fold hides on the page, are at the end of the printed
            # chapter.
            hidden = 'class="replies' in (HTML / f"{name}.html").read_text("utf8")
            assert [section.title for section in child.children] == headings[name][1:] + [
                "Answers"
            ] * hidden
    assert list(bookmarks) == [TITLE, "Contents", "About this book"]


@pytest.mark.long
def test_links_lead_somewhere(book, places):
    """Each link of the pages is a link of the PDF, and each of those has a target."""
    inside, outside = set(), set()
    for page in book.pages:
        for note in page.get("/Annots", []):
            if "/Dest" in note:
                inside.add(str(note.Dest).removeprefix("/"))
            elif "/A" in note:
                outside.add(str(note.A.URI))
    assert inside <= set(places)
    for name in pages():
        links = [
            link["href"] for link in article(name).select("a[href]") if link.get_text(strip=True)
        ]
        for link in links:
            if re.match(r"\w+:", link):
                assert link in outside
            elif (target := pdf.target(name, link)) is not None:
                assert target in inside, f"{name}: {link}"


@pytest.mark.long
def test_every_chapter_is_whole_and_listed_with_its_page(places, texts, chapter_texts):
    """Its sentences can be found; its equations, figures and exercises have their numbers."""
    # A check that nobody has answered has no result to print.
    assert not [number for number, text in enumerate(texts, 1) if "Not attempted" in text]
    listed = " ".join(texts[1 : places[pdf.place(pages()[1])]])
    for name in pages()[1:]:
        title = plain(pdf.heading(article(name).h1))
        number = places[pdf.place(name)] + 1
        assert re.search(rf"{re.escape(title)}[ .]* {number}\b", listed), title
        assert title in texts[number - 1]
        assert re.search(rf"(^|\D){number}(\D|$)", texts[number - 1]), (
            "the page bears another number"
        )
        text = " ".join(chapter_texts[name])
        for number in article(name).select(".eqno"):
            assert number.get_text(strip=True) in text, name
        for caption in article(name).select(
            "figcaption .caption-number, table caption .caption-number"
        ):
            assert plain(caption.get_text(strip=True)) in text, name
        simple = [
            paragraph
            for paragraph in article(name).find_all("p")
            if not paragraph.find(["code", "span", "a", "math"])
        ]
        assert simple or name.startswith(("appendix/reference", "exercises/")), name
        for paragraph in simple:
            words = plain(paragraph.get_text()).strip()
            # The lines of a table's cell are between those of the cells beside it.
            parts = words.split() if paragraph.find_parent(["td", "th"]) else [words]
            assert all(is_there(part, chapter_texts[name]) for part in parts), (name, words)


def structure(node):
    """Return all elements of the PDF's structure, which screen readers follow."""
    if isinstance(node, pikepdf.Array):
        for child in node:
            yield from structure(child)
    elif isinstance(node, pikepdf.Dictionary) and "/S" in node:
        yield node
        if "/K" in node:
            yield from structure(node.K)


@pytest.mark.long
def test_the_structure_is_that_of_the_pages(book):
    """Headings nest, tables have their heads, and figures and formulas have their words."""
    elements = list(structure(book.Root.StructTreeRoot.K))
    kinds = Counter(str(element.S)[1:] for element in elements)
    levels = [int(str(element.S)[2]) for element in elements if re.match("/H[1-6]", str(element.S))]
    assert levels[0] == 1 and all(below <= level + 1 for level, below in pairwise(levels))
    for kind, tag in (("Table", "table"), ("TR", "tr"), ("TH", "th"), ("TD", "td")):
        assert kinds[kind] == sum(len(article(name).find_all(tag)) for name in pages()), kind
    assert not [element for element in elements if element.S == "/Figure" and "/Alt" not in element]
    descriptions = [str(element.Alt) for element in elements if "/Alt" in element]
    # The site keeps the essay's later stills in files of their own.
    shown = [
        picture.get("aria-label") or picture["alt"]
        for name in pages()
        for picture in article(name).select("svg[aria-label], img[src*='stills/']")
    ]
    assert len(shown) > 40
    assert sorted(set(shown) - set(descriptions)) == []
    assert sum(text in set(shown) for text in descriptions) == len(shown)
    spoken_formulas = Counter(str(element.Alt) for element in elements if element.S == "/Formula")
    expected = Counter(
        spoken(math) for name in pages() for math in article(name).select(".katex math")
    )
    assert expected - spoken_formulas == Counter()
    # The words contain no symbols and no TeX.
    said = re.compile(r"(?!.*([,;] ?[,;]|  ))[A-Za-z0-9 ,.;:\u00a0'’-]+")
    assert [words for words in spoken_formulas if not said.fullmatch(words)] == []


@pytest.mark.long
def test_pages_are_filled_and_nothing_reaches_into_the_margins(places, texts):
    """At most one page in forty is less than half full, other than the last of a chapter.

    The content that follows is in one piece.
    """
    document = pdfium.PdfDocument(PDF)
    last = {places[pdf.place(name)] for name in pages()[1:]} | {len(document)}
    last.add(next(k for k, text in enumerate(texts) if text.startswith(f"{k + 1} About this book")))
    scale, empty = 0.4, []
    edge = int(MARGIN * MILLIMETRE * scale)
    for number, page in enumerate(document, start=1):
        picture = page.render(scale=scale, grayscale=True).to_numpy()
        body = picture[int(23 * MILLIMETRE * scale) : -int(22 * MILLIMETRE * scale)]
        ink = np.flatnonzero(body.min(axis=1) < 225)
        if number not in last and (ink.max(initial=0) < 0.5 * len(body)):
            empty.append(number)
        assert picture.min() < 200, f"page {number} is empty"
        assert picture[:, :edge].min() > 200 and picture[:, -edge:].min() > 200, (
            f"page {number} is too wide"
        )
        page.close()
    assert len(empty) <= len(document) / 40, empty
    document.close()


@pytest.mark.long
def test_no_glyph_comes_from_elsewhere(book):
    """Where our typefaces lack a glyph, the browser would take the machine's, or draw a box."""
    fonts = {}
    for page in book.pages:
        for font in page.get("/Resources", {}).get("/Font", {}).values():
            fonts[str(font.BaseFont) if "/BaseFont" in font else "drawn"] = font
    names = {re.sub(r"^/[A-Z]{6}\+", "", name) for name in fonts}
    assert all(
        re.match(r"SourceSerif4|SourceSans3|SourceCodePro|KaTeX_", name) for name in names
    ), names
    for font in fonts.values():
        assert "/FontFile2" in font.DescendantFonts[0].FontDescriptor


def test_too_wide_a_line_stops_the_printing(browser):
    katex = '<div class="math-box"><span class="katex" style="white-space: nowrap">{}</span></div>'
    style = "<style>.katex { display: inline-block; font-size: 16px }</style>"
    page = browser.new_context(viewport={"width": pdf.WIDTH, "height": 900}).new_page()

    def faults(inside):
        page.set_content(f'{style}<body style="margin: 0"><article id="a">{inside}</article>')
        return page.evaluate(pdf.FIT, pdf.SMALLEST)

    assert faults("<p>Some words.</p>") == []
    wide = katex.format("m" * 55)
    assert faults(wide) == []
    assert (
        page.evaluate("parseFloat(getComputedStyle(document.querySelector('.katex')).fontSize)")
        < 15
    )
    (fault,) = faults(katex.format("m" * 200))
    assert "px too wide: mmm" in fault
    (fault,) = faults('<table><tr><td style="min-width: 900px">cell</td></tr></table>')[:1]
    assert "too wide" in fault
    page.context.close()


THIRD = math.pi / 3


@pytest.mark.parametrize(
    ("state", "words"),
    [
        (
            {"angles": [THIRD, 0, -THIRD / 2], "sequence": "zxy"},
            r"\psi = 60^\circ,\ \theta = 0^\circ,\ \varphi = -30^\circ",
        ),
        ({"angle": 1, "axis": "z"}, r"57.3^\circ\text{ about }z"),
        ({"angle": THIRD, "axis": [0.6, -0.0, -0.8]}, r"60^\circ\text{ about }(0.6,\ 0,\ -0.8)"),
        (
            {"turns": [["z", THIRD], ["x", -THIRD]]},
            r"60^\circ\text{ about }z\text{, then }-60^\circ\text{ about }x",
        ),
        ({"matrix": [[1, 0], [0.5, -1]]}, r"\begin{bmatrix}1 & 0\\0.5 & -1\end{bmatrix}"),
        # The answer to a puzzle is not given away, and a run has no number of its own.
        ({"given": [["z", 1.0]], "turns": []}, ""),
        ({"time": 6.0}, ""),
    ],
)
def test_a_still_has_the_numbers_beside_the_interactive_figure(state, words):
    assert pdf.as_drawn(state) == words


def test_a_still_tells_its_numbers():
    """Readers would read them off the interactive figure."""
    figure = BeautifulSoup(
        '<figure data-figure="simple" data-state=\'{"angle": 1, "axis": "z"}\'></figure>', "lxml"
    )
    pdf.tell_numbers(figure)
    assert spoken(figure.select_one(".as-drawn math")) == "57.3 degrees about z"


def test_without_a_browser_it_says_so(monkeypatch):
    monkeypatch.setattr(browser_module.shutil, "which", lambda name: None)
    with pytest.raises(SystemExit, match="This machine has neither Chromium nor Chrome"):
        with browser_module.open_browser():
            pass


def test_offer_is_written_and_withdrawn():
    front = "<h1>Book</h1><!-- whole-book --><p>Text</p>"
    offered = whole_book.with_offer(front, ['<a href="x.pdf">PDF</a>'])
    assert '<a href="x.pdf">' in offered and offered.endswith("<p>Text</p>")
    assert whole_book.with_offer(offered, ["other"]).count("<p class") == 1
    # A book that offers nothing needs no place for it.
    assert [whole_book.with_offer(page, []) for page in (offered, "<h1>")] == [front, "<h1>"]
    with pytest.raises(RuntimeError, match="one place"):
        whole_book.with_offer("<h1>Book</h1>", ["PDF"])


# ---- the EPUB -------------------------------------------------------------------


@pytest.fixture(scope="module")
def chapters_of_epub():
    with zipfile.ZipFile(EPUB) as archive:
        # All files are text, and those that a parser of XML reads have no characters of several
        # bytes, at which parsers have failed.
        return {
            name.removeprefix("book/"): archive.read(name).decode(
                "utf8" if name.endswith(".css") else "ascii"
            )
            for name in archive.namelist()
        }


@pytest.mark.long
def test_epub_is_valid():
    """The checker is that of the standard's authors."""
    checker = shutil.which("epubcheck")
    if not checker:
        pytest.fail("epubcheck is not installed") if BROWSER_REQUIRED else pytest.skip(
            "epubcheck is not installed"
        )
    # Debian's command is the archive of Java itself.
    done = subprocess.run(
        ["java", "-jar", checker, "--failonwarnings", EPUB], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


@pytest.mark.long
def test_epub_holds_every_formula_and_every_figure(chapters_of_epub):
    for page in pages():
        site = BeautifulSoup((HTML / f"{page}.html").read_text("utf8"), "lxml").article
        text = BeautifulSoup(chapters_of_epub[f"{page.replace('/', '-')}.xhtml"], "xml")
        for fold in site.select("details.hide, button, script, .whole-book, .sd-container-fluid"):
            fold.decompose()
        assert len(text.find_all("math")) - len(text.select("p.as-drawn math")) == len(
            site.select(".katex")
        ), page
        assert all(math["alttext"] for math in text.find_all("math"))
        assert not text.select("script, button, input, .katex, details.hide")
        for drawing in text.select("figure > svg[role=img]"):
            assert drawing.get("aria-label") or drawing.get("aria-labelledby"), page
        names = {element["id"] for element in text.find_all(id=True)}
        assert {use["href"][1:] for use in text.find_all("use")} <= names, page


# ---- the zip -------------------------------------------------------------------


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("a stick with spaces")
    with zipfile.ZipFile(ZIP) as archive:
        archive.extractall(folder)
    (inside,) = folder.iterdir()
    return inside


@pytest.mark.long
def test_zip_holds_the_site_once():
    with zipfile.ZipFile(ZIP) as archive:
        entries = archive.infolist()
    names = [entry.filename.partition("/")[2] for entry in entries]
    assert names == sorted(set(names))
    site = {str(path.relative_to(HTML)) for path in HTML.rglob("*") if path.is_file()}
    # The list of files for offline reading is already complete.
    assert set(names) == site - {f"take-away/{ZIP.name}", install.LIST} | {"README.txt", "serve.py"}
    assert [name for name in names if name.endswith((".pdf", ".zip"))].count(
        f"take-away/{PDF.name}"
    ) == 1
    assert len({entry.date_time for entry in entries}) == 1


def test_same_files_give_the_same_zip():
    first = offline.pack({"b/page.html": b"words", "a.txt": b"more"}, "book", "A Book")
    second = offline.pack({"a.txt": b"more", "b/page.html": b"words"}, "book", "A Book")
    assert first == second


def test_pages_in_the_zip_ask_for_nothing_ahead():
    """Chromium warns on every page from a disk that it cannot use a preloaded typeface."""
    page = (
        '<head>\n  <link rel="preload" as="font" crossorigin href="a.woff2">\n'
        "  <style></style></head>"
    )
    packed = offline.pack(
        {"page.html": page.encode(), "kept.js": b'<link rel="preload">'}, "book", "A Book"
    )
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        assert archive.read("book/page.html") == b"<head>\n  <style></style></head>"
        assert archive.read("book/kept.js") == b'<link rel="preload">'


@pytest.mark.long
def test_front_page_offers_all_and_that_in_the_zip_what_is_not_the_zip(unpacked):
    front = (HTML / "index.html").read_text("utf8")
    (place,) = whole_book.PLACE.findall(front)
    for path in (PDF, EPUB, ZIP):
        assert f'href="take-away/{path.name}"' in place
        assert f"{path.stat().st_size / 1e6:.1f} MB" in place
    front = (unpacked / "index.html").read_text("utf8")
    (place,) = whole_book.PLACE.findall(front)
    assert re.findall(r'href="([^"]*)"', place) == [
        f"take-away/{path.name}" for path in (PDF, EPUB)
    ]
    assert (unpacked / "take-away" / PDF.name).read_bytes() == PDF.read_bytes()
    assert "python serve.py" in (unpacked / "README.txt").read_text("utf8")


@pytest.fixture
def from_disk(browser, unpacked):
    """A page without a network, with its messages and requests, none of which may fail."""
    context = browser.new_context(viewport={"width": 1300, "height": 900}, offline=True)
    page, faults = context.new_page(), []

    def note_failure(request):
        # These requests were pending when the reader left the page.
        if request.failure != "net::ERR_ABORTED":
            faults.append(f"{request.failure}: {request.url}")

    def note_words(message):
        # Messages of the graphics driver about its speed are not faults of the page.
        if message.type in ("error", "warning") and "GL Driver Message" not in message.text:
            faults.append(message.text)

    page.on("console", note_words)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("requestfailed", note_failure)
    page.on(
        "request",
        lambda r: r.url.startswith(("file:", "data:", "blob:")) or faults.append(f"asks: {r.url}"),
    )
    page.goto((unpacked / "index.html").as_uri())
    yield page
    assert faults == []
    context.close()


def settled(page):
    page.wait_for_function("!document.documentElement.matches('.settling, .in-parts')")
    return page


@pytest.mark.long
def test_pages_open_from_disk(from_disk, unpacked):
    for name in pages()[::4]:
        from_disk.goto((unpacked / f"{name}.html").as_uri())
        settled(from_disk)
        assert (
            from_disk.evaluate(
                "document.fonts.check('1em \"Source Serif 4\"') && document.fonts.status"
            )
            == "loaded"
        )
        assert from_disk.evaluate(
            "getComputedStyle(document.querySelector('article')).fontFamily"
        ).startswith('"Source Serif')
        assert from_disk.evaluate(SIDEWAYS) <= 0


@pytest.mark.long
def test_reader_goes_through_the_book_from_disk_moves_a_figure_and_searches(from_disk, unpacked):
    page = settled(from_disk)
    page.click("article .sd-card a >> nth=0")
    assert "/rotations.html" in page.url
    page.click(".prev-next-footer a.right-next")
    here = page.url
    page.click("article a.reference.internal >> nth=0")
    assert page.url != here and page.url.startswith(unpacked.as_uri())
    page.click(".theme-switch-button")
    assert page.evaluate("document.documentElement.dataset.mode") != "auto"
    # A figure moves.
    name = next(
        name
        for name in CHAPTERS
        if 'data-figure="gimbal"' in (HTML / f"{name}.html").read_text("utf8")
    )
    from_disk.goto((unpacked / f"{name}.html").as_uri())
    figure = from_disk.locator('[data-figure="gimbal"][data-ready]').first
    drawn = (
        "figure => [...figure.querySelectorAll('.sheet .marks *')].map(m => "
        "m.getAttribute('d')).join()"
    )
    before = figure.evaluate(drawn)
    slider = figure.locator("input[type=range]").first
    slider.focus()
    slider.press("ArrowRight")
    from_disk.wait_for_function(
        f"before => ({drawn})(document.querySelector('[data-figure=gimbal]')) !== before",
        arg=before,
    )
    # The search finds a word.
    page.keyboard.press("Control+k")
    page.keyboard.type("gimbal lock")
    page.wait_for_selector("ul.found a")
    page.keyboard.press("Enter")
    page.wait_for_url("**/gimbal-lock.html*")


@pytest.mark.long
def test_small_server_of_the_zip(unpacked, tmp_path):
    """It can be started from anywhere, and has the types that modules and WebAssembly need."""
    process = subprocess.Popen(
        [sys.executable, "-I", unpacked / "serve.py", "0"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        address = re.search(r"http://127\.0\.0\.1:\d+/", process.stdout.readline())[0]
        for kind, expected in (
            (".html", "text/html"),
            (".js", "text/javascript"),
            (".css", "text/css"),
            # fmt: skip
            (".mjs", "text/javascript"),
            (".wasm", "application/wasm"),
        ):
            files = sorted(path.relative_to(unpacked) for path in unpacked.rglob(f"*{kind}"))
            assert files or kind in (".mjs", ".wasm")
            for file in files[:1]:
                with urllib.request.urlopen(address + file.as_posix()) as answer:
                    assert answer.headers["Content-Type"].startswith(expected)
    finally:
        process.terminate()
        process.wait()
        process.stdout.close()
