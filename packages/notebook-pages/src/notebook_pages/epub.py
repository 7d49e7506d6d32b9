"""The whole book as an EPUB 3, with formulas in MathML and drawings with text descriptions.

It is made from the built pages by the same steps as the PDF; the reading program sets the formulas
itself.
"""

import io
import re
import zipfile
from html import escape
from string import ascii_lowercase, ascii_uppercase, digits
from uuid import NAMESPACE_URL, uuid5
from xml.etree import ElementTree

from .paths import LICENCES_SAID, WEBSITE, edition, moment_of_sources, parts
from .pdf import article, heading, place
from .spoken import spoken

STYLE = WEBSITE / "epub.css"
MATHML, SVG = "http://www.w3.org/1998/Math/MathML", "http://www.w3.org/2000/svg"
# HTML parsers write all names in lower case, but in XML these have capitals.
CAPITALS = {
    name.lower(): name
    for name in """
    viewBox preserveAspectRatio clipPath clipPathUnits gradientUnits gradientTransform
    linearGradient radialGradient textLength lengthAdjust markerWidth markerHeight markerUnits
    attributeName attributeType animateTransform animateMotion keyTimes keySplines keyPoints
    calcMode repeatCount repeatDur refX refY pathLength patternUnits patternTransform textPath
    """.split()
}
BOLD = {ord(sign): 0x1D400 + k for k, sign in enumerate(ascii_uppercase + ascii_lowercase)}
BOLD |= {ord(sign): 0x1D7CE + k for k, sign in enumerate(digits)}
#: Elements that need a script or a form, styles, which book.css has, and lines that a script draws.
LEFT_OUT = (
    "input, select, textarea, button, .dial, .number, .actions, label.done, .cover-note, "
    ".progress-bar, style, path:not([d]), path[d='']"
)
PAGE = """<?xml version="1.0" encoding="utf-8"?>
<html xmlns="http://www.w3.org/1999/xhtml" xmlns:epub="http://www.idpf.org/2007/ops" lang="en"
 xml:lang="en">
<head><title>{title}</title><link rel="stylesheet" type="text/css" href="book.css"/></head>
<body>{body}</body>
</html>
"""
CONTAINER = """<?xml version="1.0" encoding="utf-8"?>
<container version="1.0" xmlns="urn:oasis:names:tc:opendocument:xmlns:container">
<rootfiles>
<rootfile full-path="book/package.opf" media-type="application/oebps-package+xml"/>
</rootfiles>
</container>
"""
PACKAGE = """<?xml version="1.0" encoding="utf-8"?>
<package xmlns="http://www.idpf.org/2007/opf" version="3.0" unique-identifier="identifier"
 xml:lang="en">
<metadata xmlns:dc="http://purl.org/dc/elements/1.1/">
<dc:identifier id="identifier">{identifier}</dc:identifier>
<dc:title>{title}</dc:title>
<dc:creator>{author}</dc:creator>
<dc:language>en</dc:language>
<dc:rights>{licences}</dc:rights>
<dc:description>{edition}</dc:description>
{more}
<meta property="dcterms:modified">{moment}</meta>
<meta property="schema:accessMode">textual</meta>
<meta property="schema:accessMode">visual</meta>
<meta property="schema:accessModeSufficient">textual</meta>
<meta property="schema:accessibilityFeature">MathML</meta>
<meta property="schema:accessibilityFeature">alternativeText</meta>
<meta property="schema:accessibilityFeature">structuralNavigation</meta>
<meta property="schema:accessibilityFeature">tableOfContents</meta>
<meta property="schema:accessibilityHazard">none</meta>
<meta property="schema:accessibilitySummary">Formulas are MathML; every figure has a text
description.</meta>
</metadata>
<manifest>
<item id="nav" href="nav.xhtml" media-type="application/xhtml+xml" properties="nav"/>
<item id="style" href="book.css" media-type="text/css"/>
{items}
</manifest>
<spine>
<itemref idref="nav"/>
{spine}
</spine>
</package>
"""


def as_mathml(formula):
    """Return the MathML of a formula, and its words for programs that do not support it."""
    math = formula.select_one("math").extract()
    math["alttext"] = spoken(math)
    # Reading programs know only the bold letters that are separate characters.
    for letter in math.select("[mathvariant=bold]"):
        letter.string = letter.get_text().translate(BOLD)
        del letter["mathvariant"]
    formula.replace_with(math)


def written_out(styles):
    """Return the style sheets with each ``:is(...)`` written out.

    Older reading programs do not know this selector, and neither does their checker.
    """
    return re.sub(
        r"([^{},]*):is\(([^()]*)\)([^{},]*)",
        lambda match: ",".join(match[1] + selector + match[3] for selector in match[2].split(",")),
        styles,
    )


def in_xml(text):
    """Turn HTML that XML does not allow into XML."""
    for element in text.select(LEFT_OUT):
        element.decompose()
    for label in text.find_all("label"):
        label.name, label.attrs = "span", {}
    for element in text.find_all(True):
        element.name = CAPITALS.get(element.name, element.name)
        if element.name in ("svg", "math"):
            element["xmlns"] = SVG if element.name == "svg" else MATHML
        attributes = {}
        for name, value in element.attrs.items():
            words = " ".join(value) if isinstance(value, list) else value
            # These attributes are used only by scripts and by the site's styles.
            if (
                name.startswith(("data-", "on"))
                or name in ("tabindex", "translate", "valign", "align", "focusable")
                or (name in ("width", "height") and element.name in ("col", "table", "td", "th"))
            ):
                continue
            attributes[CAPITALS.get(name, name)] = words
        element.attrs = attributes
    return text


def files(site, title, author):
    """Return the files of the book, text or bytes, by name."""
    pages = ["index", *(page for _, names in parts() for page in names)]
    texts = {page: article(site, page, as_mathml) for page in pages}
    styles = {
        style.string for text in texts.values() for style in text.find_all("style") if style.string
    }
    home = {
        element["id"]: page
        for page, text in texts.items()
        for element in [text, *text.find_all(id=True)]
    }
    written, items, spine = {}, [], []
    for page, text in texts.items():
        in_xml(text)
        here = {element["id"] for element in [text, *text.find_all(id=True)] if element.get("id")}
        for link in text.find_all("a", href=re.compile("^#")):
            name = link["href"][1:]
            if name not in home:
                link.unwrap()
            elif home[name] != page:
                link["href"] = f"{place(home[name])}.xhtml#{name}"
            elif name not in here:
                # The target of this link exists only on the screen.
                link.unwrap()
        body = str(text)
        properties = [
            kind for kind, mark in (("mathml", "<math "), ("svg", "<svg ")) if mark in body
        ]
        properties = f' properties="{" ".join(properties)}"' if properties else ""
        name = place(page)
        written[f"{name}.xhtml"] = PAGE.format(title=escape(heading(text.h1)), body=body)
        items.append(
            f'<item id="{name}" href="{name}.xhtml" '
            f'media-type="application/xhtml+xml"{properties}/>'
        )
        spine.append(f'<itemref idref="{name}"/>')
    entries = "".join(
        f"<li><span>{escape(caption)}</span><ol>"
        + "".join(
            f'<li><a href="{place(page)}.xhtml">{escape(heading(texts[page].h1))}</a></li>'
            for page in names
        )
        + "</ol></li>"
        for caption, names in parts()
    )
    entries = f'<li><a href="index.xhtml">About this book</a></li>{entries}'
    contents = f'<nav epub:type="toc" id="toc"><h1>Contents</h1><ol>{entries}</ol></nav>'
    written["nav.xhtml"] = PAGE.format(title="Contents", body=contents)
    written["book.css"] = STYLE.read_text("utf8") + written_out("\n".join(sorted(styles)))
    for name, text in written.items():
        if name.endswith(".xhtml"):
            try:
                ElementTree.fromstring(text)
            except ElementTree.ParseError as error:
                raise RuntimeError(f"{name} is not XML: {error}") from None
    which = edition()
    identity = f"urn:uuid:{uuid5(NAMESPACE_URL, f'{title} {which.words}')}"
    more = [f"<dc:date>{which.date}</dc:date>"] if which.date else []
    more += (
        [f"<dc:identifier>https://doi.org/{escape(which.doi)}</dc:identifier>"] if which.doi else []
    )
    written["package.opf"] = PACKAGE.format(
        identifier=identity, title=escape(title), author=escape(author), licences=LICENCES_SAID,
        edition=escape(which.words), more="\n".join(more),
        moment=f"{moment_of_sources():%Y-%m-%dT%H:%M:%SZ}", items="\n".join(items),
        spine="\n".join(spine),
    )  # fmt: skip
    # Java's parser of XML, which readers and epubcheck use, fails where a character of four bytes
    # extends over the end of its buffer, so write characters as references.
    return {
        name: text if name.endswith(".css") else text.encode("ascii", "xmlcharrefreplace").decode()
        for name, text in written.items()
    }


def make(site, title, author):
    """Return the EPUB of the built book in ``site`` as bytes, reproducible for the same book."""
    date = moment_of_sources().timetuple()[:6]
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:

        def add(name, text, kind=zipfile.ZIP_DEFLATED):
            entry = zipfile.ZipInfo(name, date)
            entry.compress_type, entry.create_system, entry.external_attr = kind, 3, 0o644 << 16
            archive.writestr(entry, text)

        # The standard requires this file first and uncompressed.
        add("mimetype", "application/epub+zip", zipfile.ZIP_STORED)
        add("META-INF/container.xml", CONTAINER)
        for name, text in sorted(files(site, title, author).items()):
            add(f"book/{name}", text)
    return packed.getvalue()
