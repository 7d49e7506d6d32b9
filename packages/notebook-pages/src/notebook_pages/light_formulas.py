"""Shorten KaTeX's HTML to a third, because formulas are most of a page's size.

KaTeX writes for every browser and for its own program. This module reads its HTML as a tree and
writes it again for book.css, which draws it alike. The tags of the drawing, which no screen reader
reads, are ``i`` for a box, ``var`` and ``b`` for a slanted or bold letter, and ``s``, ``u`` and
``q`` for the three spaces. ``tests/pages`` compare the position of each letter with KaTeX's own, in
three engines.

MathML alone, set by the browser in Latin Modern Math or STIX, was not as good in November 2026:
Chromium 156 and WebKit 2.50 drew the brackets of a matrix larger than its rows, centred the lines
of ``cases``, put ``cos`` close to its angle, and moved an arrow off its letter; Firefox 153 left
space above and below each formula in STIX; and all three drew wide hats in Latin Modern. KaTeX's
own HTML would give a page 1.8 times as many elements, and 2.3 to 2.6 times as many bytes.
"""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from functools import cache
from html import escape

from .paths import NODE_MODULES, WEBSITE

KATEX_STYLES = NODE_MODULES / "katex" / "dist" / "katex.css"
#: The spaces in a formula, by their width in em.
SPACES = {"0.1667em": "s", "0.2222em": "u", "0.2778em": "q"}
# The size of raised or lowered letters.
SMALL = 0.7
SMALLER = ["katex-sizing", "reset-size6", "size3"]
#: The style that book.css gives to every such box.
USUAL = {"frac-line": ("border-bottom-width", "0.04em"), "arraycolsep": ("width", "0.5em")}
#: Boxes with letters side by side, in which a group without a style of its own changes nothing.
ROWS = {"katex-html", "katex-sizing", "tight", "delimcenter"}
#: Operators that have these attributes by default.
FENCES = set("()[]{},")


@dataclass
class Box:
    tag: str = "i"
    classes: list = field(default_factory=list)
    style: dict = field(default_factory=dict)
    inside: list = field(default_factory=list)  # boxes and text
    rest: dict = field(default_factory=dict)  # other attributes

    def has(self, *names):
        return all(name in self.classes for name in names)

    @property
    def is_letter(self):
        """Whether the box contains only text."""
        return all(isinstance(part, str) for part in self.inside)

    @property
    def is_group(self):
        return self.tag == "i" and not (self.classes or self.style or self.rest)


@cache
def styled():
    """Return the class names in KaTeX's style sheet.

    Its HTML has many more, which only its own program needs.
    """
    return frozenset(re.findall(r"\.([a-zA-Z][\w-]*)", KATEX_STYLES.read_text("utf8")))


def read(element):
    """Return the box of an element of KaTeX's HTML."""
    rest = dict(element.attrib)
    classes = [name for name in rest.pop("class", "").split() if name in styled()]
    style = dict(pair.split(":") for pair in rest.pop("style", "").split(";") if pair)
    inside = [element.text] if element.text else []
    for child in element:
        inside.append(read(child))
        if child.tail:
            inside.append(child.tail)
    tag = element.tag.rpartition("}")[2]
    return Box("i" if tag == "span" else tag, classes, style, inside, rest)


def em(length):
    return float(length.removesuffix("em"))


def in_em(number):
    return f"{round(number, 4):g}em"


def rows_of(table):
    """Return the rows of a table of KaTeX without their struts, and the height of these.

    The struts of a whole table have one height.
    """
    lines = table.inside[0].inside[0].inside
    struts = {line.inside[0].style["height"] for line in lines}
    if len(struts) != 1:
        raise ValueError(f"KaTeX sets the lines of one table at several heights: {sorted(struts)}")
    return [Box("i", [*line.classes], line.style, line.inside[1:]) for line in lines], struts.pop()


def moved(line, strut):
    """Return a raised or lowered letter as one element; the strut of its row reserves its space."""
    place = {"top": f"{(em(line.style['top']) + em(strut)) / SMALL:.4g}em"}
    for side, usual in (("left", 0), ("right", 0.05)):
        margin = em(line.style.get(f"margin-{side}", "0em"))
        if margin != usual:
            place[f"margin-{side}"] = f"{margin / SMALL:.3g}em"
    return Box("i", ["script"], place, line.inside[0].inside)


def hat(letter, mark, strut):
    """Replace the table of a letter with a hat by the letter and the hat, centred above it."""
    above = round(em(strut) + em(mark.style["top"]), 4)
    body = mark.inside[0]
    place = {"left": body.style.get("left"), "top": above and in_em(above)}
    place = {name: value for name, value in place.items() if value}
    return Box("i", ["hat"], {}, [letter, Box("i", [], place, body.inside[0].inside)])


def table(box, holder):
    """Shorten a table of KaTeX within ``holder``.

    It is a letter with a mark or an index, or lines at given heights.
    """
    lines, strut = rows_of(box)
    if holder.has("msupsub") and len(lines) == 1 and lines[0].inside[0].has(*SMALLER):
        letters = lines[0].inside[0]
        if all(isinstance(part, str) or part.is_letter for part in row(letters).inside):
            return moved(Box("i", [], lines[0].style, [row(letters)]), strut)
    if holder.has("katex-accent") and len(lines) == 2:
        letter, mark = row(lines[0].inside[0]), lines[1]
        stands = em(lines[0].style["top"]) == -em(strut) and strut in ("3em", "2.7em")
        plain = mark.inside[0].has("accent-body") and mark.inside[0].inside[0].is_letter
        if stands and plain and letter.is_letter and len(mark.inside[0].inside[0].inside[0]) == 1:
            return hat(letter, mark, strut)
    rows = Box("i", ["rows"], {} if strut == "3em" else {"--strut": strut})
    for line in lines:
        line.inside = spread([row(part) for part in line.inside])
        rows.inside.append(line)
    return rows


def spread(boxes):
    """Return the boxes of a row, with groups replaced by their content.

    The free space that KaTeX leaves beside a fraction becomes the margin of the fraction.
    """
    parts = []
    for box in boxes:
        parts += spread(box.inside) if isinstance(box, Box) and box.is_group else [box]
    free = [isinstance(box, Box) and box.classes == ["nulldelimiter"] for box in parts]
    for place, box in enumerate(parts):
        is_fraction = isinstance(box, Box) and box.classes == ["mfrac"]
        if is_fraction and free[place - 1 : place] == free[place + 1 : place + 2] == [True]:
            parts[place - 1] = parts[place + 1] = ""
            box.classes = ["frac"]
    return parts


def row(box):
    """Return a box and its content in their short form."""
    if not isinstance(box, Box):
        return box
    style = dict(box.style)
    if box.has("katex-base"):
        strut, *inside = box.inside
        style = {"--h": strut.style["height"]}
        if "vertical-align" in strut.style:
            style["--l"] = strut.style["vertical-align"]
        return Box("i", [], style, spread([row(part) for part in inside]))
    if box.has("mspace") and list(style) == ["margin-right"] and style["margin-right"] in SPACES:
        return Box(SPACES[style["margin-right"]])
    if box.tag == "svg":
        return Box(
            "svg",
            [],
            {},
            box.inside,
            {name: value for name, value in box.rest.items() if name != "xmlns"},
        )
    inside = [
        table(part, box) if isinstance(part, Box) and part.has("vlist-t") else row(part)
        for part in box.inside
    ]
    classes = box.classes
    if box.has(*SMALLER):
        classes = ["tight", *(name for name in classes if name not in SMALLER)]
    elif box.has("delimsizing", "mult") and not any(part.has("delim-size1") for part in walk(box)):
        classes = [name for name in classes if name not in ("delimsizing", "mult")]
    if "delimcenter" in classes and style == {"top": "0em"}:
        classes, style = [name for name in classes if name != "delimcenter"], {}
    for name, (property, usual) in USUAL.items():
        if name in classes and style.get(property) == usual:
            del style[property]
    tag = box.tag
    for name, short in (("mathnormal", "var"), ("mathbf", "b")):
        if classes == [name] and box.is_letter:
            tag, classes = short, []
    if (
        len(inside) == 1
        and classes in (["msupsub"], ["katex-accent"])
        and inside[0].classes in (["script"], ["hat"])
    ):
        return inside[0]
    written = Box(tag, classes, style, inside, box.rest)
    if tag == "i" and (written.is_group or ROWS & set(classes)):
        written.inside = spread(inside)
    return written


def walk(box):
    yield box
    for part in box.inside:
        if isinstance(part, Box):
            yield from walk(part)


def attribute(name, value):
    return (
        f" {name}={value}" if re.fullmatch(r"[\w.:;%#-]+", value) else f' {name}="{escape(value)}"'
    )


def short(value):
    """Return a length without its redundant characters."""
    return re.sub(r"(?<![\d.])0(?=\.\d)", "", re.sub(r"^-?0em$", "0", value))


@cache
def names_of_styles():
    """Return the names that book.css gives to the most frequent styles.

    Capitals are raised or lowered letters.
    """
    sheet = (WEBSITE / "static" / "book.css").read_text("utf8")
    names = {}
    for name, styles in re.findall(r"^\.katex \.([A-Za-z]) \{ (.*); \}$", sheet, re.MULTILINE):
        pairs = [pair.split(": ") for pair in styles.split("; ")]
        style = ";".join(f"{property}:{short(value)}" for property, value in pairs)
        names[(*(["script"] if name.isupper() else []), style)] = name
    return names


def write(part):
    """Return the HTML of a box."""
    if isinstance(part, str):
        return escape(part, quote=False)
    attributes = {name: re.sub(r"\s+", " ", value) for name, value in part.rest.items()}
    style = ";".join(f"{name}:{short(value)}" for name, value in part.style.items())
    if name := names_of_styles().get((*part.classes, style)):
        attributes["class"] = name
    else:
        attributes |= {"class": " ".join(part.classes)} if part.classes else {}
        attributes |= {"style": style} if style else {}
    begin = f"<{part.tag}{''.join(attribute(*pair) for pair in attributes.items())}>"
    if part.tag == "path":
        return f"{begin[:-1]} />"
    return f"{begin}{''.join(write(inside) for inside in part.inside)}</{part.tag}>"


def spoken(box):
    """Return MathML for screen readers, without rows that group nothing and without appearance."""
    if isinstance(box, str):
        return box
    inside = [
        spoken(part) for part in box.inside if isinstance(part, str) or part.tag != "annotation"
    ]
    if box.tag in ("math", "mtd"):
        while (
            len(inside) == 1
            and inside[0].tag in ("mrow", "mstyle")
            and inside[0].rest in ({}, IN_A_CELL)
        ):
            inside = inside[0].inside
    if box.tag == "semantics":
        return inside[0]
    rest = {name: value for name, value in box.rest.items() if name != "xmlns"}
    if box.tag == "mo" and box.inside and box.inside[0] in FENCES:
        rest = {name: value for name, value in rest.items() if name not in ("fence", "separator")}
    return Box(box.tag, [], {}, inside, rest)


# These are the defaults in a table.
IN_A_CELL = {"scriptlevel": "0", "displaystyle": "false"}


def lighten(html, tex):
    """Shorten KaTeX's ``html`` of a formula: MathML for screen readers, and boxes for the eye.

    Browsers must not translate its letters. Its TeX is in ``data-tex``, from which readers copy the
    formula and by which the search finds equations.
    """
    whole = ElementTree.fromstring(html)
    formula = whole if whole.get("class") == "katex" else whole[0]
    heard, drawn = formula
    heard, drawn = write(spoken(read(heard[0]))), row(read(drawn))
    boxes = "".join(write(part) for part in spread(drawn.inside))
    light = (
        f'<span class=katex translate=no data-tex="{escape(tex)}">'
        f"<i>{heard}</i><i aria-hidden=true>{boxes}</i></span>"
    )
    return light if formula is whole else f"<span class=katex-display>{light}</span>"
