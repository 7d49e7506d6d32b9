"""The whole book as one PDF: the built pages in one document, printed by Chromium.

Nothing is typeset again. Equations, figures and numbers are those of the pages. Interactive parts
are removed, links between pages become links inside the document, and print.css lays it out on
paper.
"""

import io
import json
import math
import os
import re
from html import escape
from pathlib import Path
from urllib.parse import urldefrag

import pikepdf
from bs4 import BeautifulSoup, Comment
from pikepdf import Array, Dictionary, Name, String

from . import fonts
from .browser import open_browser
from .mathematics import to_html
from .paths import LICENCES_SAID, NODE_MODULES, WEBSITE, edition, moment_of_sources, parts
from .spoken import spoken

FACES = (
    # Use fixed weights of the site's variable fonts, which a PDF would store as drawings. Also
    # set a code font with Greek letters; on screen the reader's own font is used.
    ("Source Sans", "source-sans-3", "latin", 400),
    ("Source Sans", "source-sans-3", "latin", 600),
    ("Source Code Pro", "source-code-pro", "latin", 400),
    ("Source Code Pro", "source-code-pro", "latin", 700),
    ("Source Code Pro Greek", "source-code-pro", "greek", 400),
)
# The most lines of code that must stay on one page.
LONG = 14
# Interactive elements, and others that are out of place on paper: links to themselves, the code
# that draws figures, controls, the list of links on the front page, and the reply of a check to an
# empty answer.
ONLY_ON_SCREEN = (
    "a.headerlink, script, template, details.hide, button, [hidden], .sd-container-fluid, "
    ".whole-book, .output:has([data-outcome='not attempted']), [data-stop] style"
)
# The width of the text in pixels; print.css sets the margins that leave it.
WIDTH = 612
# Attributes that name other elements.
NAMES_OF_OTHERS = ("aria-labelledby", "aria-describedby", "for", "headers")
NOTE = (
    "<strong>On paper.</strong> In this PDF, figures that move on the book\u2019s web pages are "
    "stills, and the code that draws the figures is left out. "
    "The web pages and the notebooks have both."
)
# A prefix of the words of a formula, which distinguishes it from a picture.
FORMULA = "\ue000"
# The smallest size relative to the text; an element that is still too wide stops the printing.
SMALLEST = 0.6

# Shrink elements that are wider than their column, and return those that are still too wide. A page
# is as wide as the document in a window of the same width, so both have the same layout.
FIT = """smallest => {
  for (const box of document.querySelectorAll(".math-box")) {
    const formula = box.querySelector(".katex");
    const size = parseFloat(getComputedStyle(formula).fontSize);
    // A formula shrinks with its font; a little less than all of the room allows for rounding.
    const width = formula.getBoundingClientRect().width;
    if (width > box.clientWidth)
      formula.style.fontSize = Math.max((box.clientWidth - 6) / width, smallest) * size + "px";
  }
  const sheet = document.body.getBoundingClientRect();
  const faults = [];
  for (const element of document.querySelectorAll("article *")) {
    // MathML is there for screen readers, one pixel large.
    if (element.closest("svg, .katex > :first-child") && element.tagName !== "svg") continue;
    if (element.closest(".katex") && element.className !== "katex") continue;
    const box = element.getBoundingClientRect();
    if (box.width && (box.right > sheet.right + 1 || box.left < sheet.left - 30))
      faults.push(
        `${element.tagName.toLowerCase()}.${element.className} ` +
        `in #${element.closest("[id]")?.id}: ${Math.round(box.right - sheet.right)} px too wide: ` +
        element.textContent.slice(0, 60));
  }
  return faults;
}"""

FILL_IN = """numbers => {
  for (const link of document.querySelectorAll(".list-of-contents a"))
    link.querySelector(".page").textContent = numbers[link.hash.slice(1)];
}"""
HEADINGS = """() => [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")].map(
  heading => heading.textContent.replace(/\\s+/g, " ").trim())"""
PAPER = {"prefer_css_page_size": True, "print_background": True, "outline": True, "tagged": True}


def place(page, fragment=""):
    """Return the ID of a place in the combined document, which no two pages share."""
    return f"{page.replace('/', '-')}--{fragment}" if fragment else page.replace("/", "-")


def target(page, address):
    """Return where a link on ``page`` leads in the document, or ``None`` if it leaves the book."""
    path, fragment = urldefrag(address)
    if not path:
        return place(page, fragment)
    file = (Path("/") / page).parent / path
    name = os.path.normpath(file).lstrip("/")
    return place(name.removesuffix(".html"), fragment) if name.endswith(".html") else None


def move_answers(text):
    """Move the replies to the questions of a page, which a fold would hide, to its end."""
    folds = text.select("details.replies")
    if not folds:
        return
    answers = BeautifulSoup(
        '<section id="answers"><h2>Answers</h2></section>', "html.parser"
    ).section
    for fold in folds:
        box = fold.find_parent(class_="question")
        name = box.select_one(".admonition-title, .question-name").get_text().strip()
        answers.append(
            BeautifulSoup(f'<p class="question-name leads-on">{name}</p>', "html.parser")
        )
        answers.append(fold.ul.extract())
        fold.decompose()
    text.section.append(answers)


def as_picture(formula):
    """Replace MathML, which a PDF lacks, by a description in words for screen readers."""
    formula["role"], formula["aria-label"] = (
        "img",
        FORMULA + spoken(formula.select_one("math")),
    )
    heard, drawn = formula.find_all(recursive=False)
    heard.decompose()
    del drawn["aria-hidden"]


def as_drawn(state):
    """Return the TeX of the numbers that a still figure shows, or nothing if there are none."""

    def degrees(angle):
        return rf"{round(math.degrees(angle), 1) + 0:g}^\circ"

    def vector(numbers):
        return "(" + r",\ ".join(f"{round(number, 3) + 0:g}" for number in numbers) + ")"

    axis, turns = state.get("axis"), state.get("turns")
    if "angles" in state and "sequence" in state:
        names = (r"\psi", r"\theta", r"\varphi")
        return r",\ ".join(
            f"{name} = {degrees(angle)}" for name, angle in zip(names, state["angles"], strict=True)
        )
    if "angle" in state and axis:
        return (
            rf"{degrees(state['angle'])}\text{{ about "
            rf"}}{axis if isinstance(axis, str) else vector(axis)}"
        )
    if turns:
        return r"\text{, then }".join(
            rf"{degrees(angle)}\text{{ about }}{name}" for name, angle in turns
        )
    if "matrix" in state:
        return (
            r"\begin{bmatrix}"
            + r"\\".join(" & ".join(f"{n:g}" for n in row) for row in state["matrix"])
            + r"\end{bmatrix}"
        )
    return ""


def tell_numbers(text):
    """Write the numbers that the still of each moving figure shows below it."""
    for figure in text.select("figure[data-figure]"):
        if tex := as_drawn(json.loads(figure.get("data-state", "{}"))):
            words = (
                f'<p class="as-drawn">As drawn: <span class="math">{to_html(tex, False)}</span></p>'
            )
            # Inside the drawing, a PDF would draw the brackets.
            figure.insert_after(BeautifulSoup(words, "html.parser"))


def name_places(text, page):
    """Give the places of a page, and the references to them, names that no other page has."""
    for element in text.find_all(True):
        if element.get("id"):
            element["id"] = place(page, element["id"])
        for name, value in list(element.attrs.items()):
            if name == "href" and not re.match(r"\w+:", value):
                if (destination := target(page, value)) is None:
                    # This download is not part of the PDF.
                    element.unwrap()
                else:
                    element["href"] = f"#{destination}"
            elif name in NAMES_OF_OTHERS:
                names = value if isinstance(value, list) else value.split()
                element[name] = " ".join(place(page, name_on_page) for name_on_page in names)
            elif isinstance(value, str) and "url(#" in value:
                element[name] = value.replace("url(#", f"url(#{place(page)}--")


def article(site, page, set_formula=as_picture):
    """Return the text of a page, ready to be combined with the others in one document."""
    soup = BeautifulSoup((site / f"{page}.html").read_text("utf8"), "lxml")
    text = soup.select_one("article")
    for still in text.select("[data-stop] > img"):
        file = (site / page).parent / still["src"]
        still.replace_with(BeautifulSoup(file.read_bytes(), "html.parser").svg)
    for element in text.select(ONLY_ON_SCREEN):
        element.decompose()
    for heading in text.select("section > :is(h2, h3):only-child"):
        # Everything under this heading was for the screen.
        heading.parent.decompose()
    move_answers(text)
    tell_numbers(text)
    for formula in text.select(".katex"):
        set_formula(formula)
    for comment in text.find_all(string=lambda string: isinstance(string, Comment)):
        comment.extract()
    for paragraph in text.find_all("p"):
        # Remove a sentence that continues below, and a remark in italics directly under a heading.
        words, before = paragraph.get_text().strip(), paragraph.find_previous_sibling()
        remark = paragraph.em and paragraph.em.get_text() == words
        if words.endswith((":", ",")) or (remark and before and before.name in ("h1", "h2", "h3")):
            paragraph["class"] = [*paragraph.get("class", []), "leads-on"]
    for code in text.select("div.cell_input, .cell_output .output"):
        if len(code.get_text().strip().splitlines()) > LONG:
            code["class"].append("long")
    for element in text.find_all(True):
        if element.get("role", "").startswith("doc-"):
            # With this role it would not be a link in a PDF.
            del element["role"]
        if element.name == "figure":
            # With this attribute, a PDF would read out only that name.
            element.attrs.pop("aria-labelledby", None)
    name_places(text, page)
    text["id"] = place(page)
    return text


def share_styles(articles):
    """Keep one copy of each style sheet that figures contain."""
    seen = set()
    for text in articles:
        for style in text.find_all("style"):
            if style.string in seen:
                style.decompose()
            else:
                seen.add(style.string)


def lower_headings(text):
    """Lower the headings by one level, because the parts are above the chapters."""
    for level in (5, 4, 3, 2, 1):
        for heading in text.find_all(f"h{level}"):
            heading.name = f"h{level + 1}"


def heading(element):
    return re.sub(r"\s+", " ", element.get_text()).strip()


def contents_list(chapters):
    """Return the table of contents, with space for the page numbers."""

    def line(kind, where, title):
        return (
            f'<li class="{kind}"><a href="#{where}"><span class="entry">{escape(title)}</span>'
            f'<span class="dots"></span><span class="page"></span></a></li>'
        )

    lines = []
    for caption, page, text in chapters:
        if caption:
            lines.append(f'<li class="part">{escape(caption)}</li>')
        lines.append(line("chapter", place(page), heading(text.h2)))
        if page.startswith("chapters/"):
            lines += [
                line("section", section.parent["id"], heading(section))
                for section in text.find_all("h3")
            ]
    return "".join(lines)


def running_heads(chapters):
    """Return a named page style for each chapter, with its title in the header."""
    rules = []
    for _, page, text in chapters:
        title = heading(text.h2).replace("\\", "\\\\").replace('"', '\\"')
        rules += [
            f'@page {place(page)} {{ @top-right {{ content: "{title}"; }} }}',
            f"#{place(page)} {{ page: {place(page)}; }}",
        ]
    return "\n".join(rules)


def faces():
    files = NODE_MODULES / "@fontsource"
    return "".join(
        f'@font-face {{ font-family: "{family}"; font-weight: {weight}; '
        f"src: url({(files / name / 'files' / file).as_uri()}); }}\n"
        for family, name, script, weight in FACES
        for file in [f"{name}-{script}-{weight}-normal.woff2"]
    )


def title_page(front, title):
    """Return the title page from the beginning of the front page; the rest remains as a preface."""
    figure = front.select_one("figure.orientation-figure:not(.moving)").extract()
    words = front.section.find_all("p", recursive=False)
    question, beginning = words[0].extract(), words[1].extract()
    front.h1.string = "About this book"
    front.section.append(BeautifulSoup(f"<p>{NOTE}</p>", "html.parser"))
    which = edition()
    link = f'<a href="https://doi.org/{which.doi}">doi:{which.doi}</a><br>' if which.doi else ""
    return (
        f'<header class="title-page"><h1>{escape(title)}</h1><p '
        f'class="question">{question.get_text()}</p>'
        f"{figure}{beginning}"
        f"<p class='edition'>{escape(which.words)}<br>{link}{LICENCES_SAID}</p></header>"
    )


def document(site, title):
    """Return the book as one HTML document."""
    front = article(site, "index")
    chapters = [
        (caption if first else None, page, article(site, page))
        for caption, pages in parts()
        for first, page in zip([True, *[False] * len(pages)], pages)
    ]
    cover = title_page(front, title)
    texts = [front, *(text for *_, text in chapters)]
    share_styles(texts)
    for *_, text in chapters:
        lower_headings(text)
    body = [
        cover,
        '<nav class="list-of-contents" '
        f'aria-label="Contents"><h1>Contents</h1><ol>{contents_list(chapters)}</ol></nav>',
        str(front),
    ]
    for caption, _, text in chapters:
        if caption:
            text.insert(0, BeautifulSoup(f'<h1 class="part">{escape(caption)}</h1>', "html.parser"))
        body.append(str(text))
    static = (site / "_static").resolve().as_uri()
    styles = ["style.css", "moving/moving.css"]
    links = "".join(f'<link rel="stylesheet" href="{static}/{name}">' for name in styles)
    own = (WEBSITE / "print.css").read_text("utf8")
    return (
        '<!doctype html><html lang="en" data-theme="light"><head><meta '
        f'charset="utf-8"><title>{escape(title)}</title>'
        f"{links}<style>{fonts.face_rules(static + '/fonts')}{faces()}{own}"
        f"{running_heads(chapters)}</style></head>"
        f"<body>{''.join(body)}</body></html>"
    )


def page_numbers(printed):
    """Return the page number of each named place of a PDF, counted from 1."""
    with pikepdf.open(io.BytesIO(printed)) as pdf:
        pages = {page.objgen: number for number, page in enumerate(pdf.pages, start=1)}
        return {
            name.removeprefix("/"): pages[place[0].objgen] for name, place in pdf.Root.Dests.items()
        }


def in_order(bookmarks):
    """Iterate over all bookmarks, each before those under it."""
    for bookmark in bookmarks:
        yield bookmark
        yield from in_order(bookmark.children)


def describe(pdf, title, author):
    """Write the metadata of the file, for library programs."""
    which = edition()
    with pdf.open_metadata(set_pikepdf_as_editor=False, update_docinfo=False) as metadata:
        metadata["dc:title"] = title
        metadata["dc:creator"] = [author]
        metadata["dc:language"] = {"en"}
        metadata["dc:rights"] = LICENCES_SAID
        metadata["dc:description"] = which.words
        if which.date:
            metadata["dc:date"] = [which.date]
        if which.doi:
            metadata["dc:identifier"] = f"https://doi.org/{which.doi}"
        metadata["xmp:CreateDate"] = metadata["xmp:ModifyDate"] = (
            f"{moment_of_sources():%Y-%m-%dT%H:%M:%SZ}"
        )


def read_once(head):
    """Keep the first page's content of a table's head, which Chromium repeats on later pages."""
    inside = head.get("/K", Array())
    inside = list(inside) if isinstance(inside, Array) else [inside]
    head.K = Array(
        part
        for part in inside
        if isinstance(part, int) or part.Type != Name.MCR or part.Pg == head.Pg
    )
    for part in inside:
        if isinstance(part, Dictionary) and part.Type == Name.StructElem:
            read_once(part)


def correct_structure(pdf):
    """Give Chromium's elements, which screen readers follow, the types that PDF 1.7 has for them.

    A formula is no picture, and neither is a group of a picture and its caption.
    """
    pdf.Root.StructTreeRoot.RoleMap = Dictionary(Strong=Name.Span, Em=Name.Span)
    for element in pdf.objects:
        kind = element.get("/S") if isinstance(element, Dictionary) else None
        if kind == Name.TH:
            read_once(element)
        elif kind == Name.Figure:
            words = str(element.get("/Alt", ""))
            if words.startswith(FORMULA):
                element.S, element.Alt = Name.Formula, String(words.removeprefix(FORMULA))
            elif not words:
                element.S = Name.Div
    for page in pdf.pages:
        page.Tabs = Name.S


def finish(printed, headings, title, author):
    """Write the metadata of the PDF, without the time and the machine on which it was made."""
    date = moment_of_sources().strftime("D:%Y%m%d%H%M%SZ")
    file = io.BytesIO()
    with pikepdf.open(io.BytesIO(printed)) as pdf:
        facts = {
            "/Title": title,
            "/Author": author,
            "/Subject": edition().words,
            "/CreationDate": date,
            "/ModDate": date,
        }
        pdf.trailer.Info = pdf.make_indirect(Dictionary(facts))
        with pdf.open_outline() as outline:
            # Chromium makes the bookmarks, with some of their words twice.
            for bookmark, words in zip(in_order(outline.root), headings, strict=True):
                bookmark.title = words
        # Open with the bookmarks beside the page.
        pdf.Root.PageMode = Name.UseOutlines
        correct_structure(pdf)
        describe(pdf, title, author)
        pdf.save(
            file,
            min_version="1.7",
            object_stream_mode=pikepdf.ObjectStreamMode.generate,
            deterministic_id=True,
        )
    return file.getvalue()


def print_document(browser, file, numbers):
    """Print the document ``file`` with the page ``numbers``, if any, in its table of contents.

    Returns the PDF and the headings, which become its bookmarks. The document is opened anew for
    each print, because Chromium breaks some pages elsewhere when it prints a document a second
    time.
    """
    page = browser.new_page(viewport={"width": WIDTH, "height": 900})
    page.emulate_media(media="print", color_scheme="light")
    # A slow machine needs longer than the default timeout.
    page.goto(file.resolve().as_uri(), timeout=0)
    page.evaluate("document.fonts.ready.then(() => true)")
    if faults := page.evaluate(FIT, SMALLEST):
        raise RuntimeError("too wide for the page of the PDF:\n" + "\n".join(faults))
    if numbers:
        page.evaluate(FILL_IN, numbers)
    headings = page.evaluate(HEADINGS)
    printed = page.pdf(**PAPER)
    page.close()
    return printed, headings


def make(site, file, title, author):
    """Return the PDF of the built book in ``site``, printed from the document ``file``."""
    file.parent.mkdir(exist_ok=True)
    file.write_text(document(site, title), "utf8")
    # The table of contents needs the page numbers, so print, read them, and print again until they
    # no longer change.
    with open_browser() as browser:
        numbers = None
        for _ in range(4):
            printed, headings = print_document(browser, file, numbers)
            current = page_numbers(printed)
            if current == numbers:
                return finish(printed, headings, title, author)
            numbers = current
    raise RuntimeError("adding the page numbers to the table of contents moved the pages")
