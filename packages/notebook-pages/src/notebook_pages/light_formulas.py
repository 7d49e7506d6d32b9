"""What KaTeX draws, said in a third of the words: formulas are most of what a page weighs.

KaTeX writes for every browser and for its own program. Here its HTML is read as a tree and written
again with what book.css draws alike. The words of the drawing, which no screen reader hears, are
``i`` for a box, ``var`` and ``b`` for a letter, slanted or bold, and ``s``, ``u`` and ``q`` for the
three spaces. ``tests/pages`` compare where each letter stands with KaTeX's own, in three engines.
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
    inside: list = field(default_factory=list)  # of boxes and of text
    rest: dict = field(default_factory=dict)  # other attributes

    def has(self, *names):
        return all(name in self.classes for name in names)

    @property
    def is_letter(self):
        """Whether there is nothing but text in it."""
        return all(isinstance(part, str) for part in self.inside)

    @property
    def is_group(self):
        return self.tag == "i" and not (self.classes or self.style or self.rest)


@cache
def styled():
    """The names of classes that KaTeX's style sheet knows; it also writes many
    that only its own program needs.
    """
    return frozenset(re.findall(r"\.([a-zA-Z][\w-]*)", KATEX_STYLES.read_text("utf8")))


def read(element):
    """The box of an element of KaTeX's HTML."""
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
    """The rows of a table of KaTeX, without their struts, and the height of
    these, which is one in a whole table.
    """
    lines = table.inside[0].inside[0].inside
    struts = {line.inside[0].style["height"] for line in lines}
    if len(struts) != 1:
        raise ValueError(f"KaTeX sets the lines of one table at several heights: {sorted(struts)}")
    return [Box("i", [*line.classes], line.style, line.inside[1:]) for line in lines], struts.pop()


def moved(line, strut):
    """A raised or lowered letter as one element: the strut of its row keeps the room for it."""
    place = {"top": f"{(em(line.style['top']) + em(strut)) / SMALL:.4g}em"}
    for side, usual in (("left", 0), ("right", 0.05)):
        margin = em(line.style.get(f"margin-{side}", "0em"))
        if margin != usual:
            place[f"margin-{side}"] = f"{margin / SMALL:.3g}em"
    return Box("i", ["script"], place, line.inside[0].inside)


def hat(letter, mark, strut):
    """A hat stands above the middle of its letter: one letter and one hat, in place of a table."""
    above = round(em(strut) + em(mark.style["top"]), 4)
    body = mark.inside[0]
    place = {"left": body.style.get("left"), "top": above and in_em(above)}
    place = {name: value for name, value in place.items() if value}
    return Box("i", ["hat"], {}, [letter, Box("i", [], place, body.inside[0].inside)])


def table(box, holder):
    """A table of KaTeX, within ``holder``: a letter with a mark or an index, or
    lines that stand at their heights.
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
    found = Box("i", ["rows"], {} if strut == "3em" else {"--strut": strut})
    for line in lines:
        line.inside = spread([row(part) for part in line.inside])
        found.inside.append(line)
    return found


def spread(boxes):
    """The boxes of a row: what a group holds stands in its place, and what KaTeX leaves free beside
    a fraction is the margin of the fraction."""
    found = []
    for box in boxes:
        found += spread(box.inside) if isinstance(box, Box) and box.is_group else [box]
    free = [isinstance(box, Box) and box.classes == ["nulldelimiter"] for box in found]
    for place, box in enumerate(found):
        if isinstance(box, Box) and box.classes == ["mfrac"]:
            if free[place - 1 : place] == free[place + 1 : place + 2] == [True]:
                found[place - 1] = found[place + 1] = ""
                box.classes = ["frac"]
    return found


def row(box):
    """A box and all that is in it, in fewer words."""
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
    for name, (what, usual) in USUAL.items():
        if name in classes and style.get(what) == usual:
            del style[what]
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
    found = Box(tag, classes, style, inside, box.rest)
    if tag == "i" and (found.is_group or ROWS & set(classes)):
        found.inside = spread(inside)
    return found


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
    """A length without what says nothing."""
    return re.sub(r"(?<![\d.])0(?=\.\d)", "", re.sub(r"^-?0em$", "0", value))


@cache
def names_of_styles():
    """The names that book.css gives to the styles that stand oftenest:
    capitals are raised or lowered letters.
    """
    sheet = (WEBSITE / "static" / "book.css").read_text("utf8")
    found = {}
    for name, styles in re.findall(r"^\.katex \.([A-Za-z]) \{ (.*); \}$", sheet, re.MULTILINE):
        pairs = [pair.split(": ") for pair in styles.split("; ")]
        style = ";".join(f"{what}:{short(value)}" for what, value in pairs)
        found[(*(["script"] if name.isupper() else []), style)] = name
    return found


def write(part):
    """The HTML of a box."""
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
    """MathML for the ear, without what tells how it would look and
    without rows that group nothing.
    """
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


IN_A_CELL = {"scriptlevel": "0", "displaystyle": "false"}  # of a table, where this is so anyhow


def lighten(html, tex):
    """KaTeX's ``html`` of a formula in fewer words: for the ear as MathML, for the eye as boxes.

    Browsers must not translate its letters. Its TeX is in ``data-tex``, where readers who copy the
    formula get it from, and where the search finds equations.
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
