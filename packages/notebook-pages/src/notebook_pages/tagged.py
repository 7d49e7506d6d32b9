"""Correct the structure of a printed PDF for screen readers, by ISO 14289-1 (PDF/UA).

Chromium tags what it prints, with some faults. This module reads its tree of elements, corrects it
and writes it again: empty groups are removed, formulas become formulas, lists get their parts, and
links get a description of their target. Whatever is on a page but in no element, such as page
numbers, lines and shades, is marked as an artifact.
"""

import re
from ctypes import byref, c_float
from dataclasses import dataclass, field
from typing import NamedTuple

import pikepdf
import pypdfium2
import pypdfium2.raw as pdfium
from pikepdf import Array, Dictionary, Name, String

# A prefix of the words of a formula, which distinguishes it from a picture.
FORMULA = "\ue000"
# Types that PDF 1.7 lacks, and the types that replace them.
ROLES = {"Strong": "Span", "Em": "Span"}
GROUPS = ("Document", "Art", "Sect", "Div")
INLINE = ("Span", "Strong", "Em", "Code", "Link", "Formula", "Lbl")
# Elements that contain only other elements.
BARE = ("L", "Table", "TR")
# Elements that a screen reader reads by their description and not by their content.
WORDED = ("Figure", "Formula")
PATH = {"m", "l", "c", "v", "y", "h", "re", "W", "W*"}
PAINT = {"f", "F", "f*", "S", "s", "B", "B*", "b", "b*", "n"}
SHOW = {"Tj", "TJ", "'", '"'}


class Piece(NamedTuple):
    """A marked sequence of the stream of a page, or of a form on it."""

    page: int
    stream: tuple
    number: int


class Note(NamedTuple):
    """An annotation, such as a link, and its page."""

    page: int
    annotation: pikepdf.Object


@dataclass(eq=False)
class Element:
    kind: str
    description: str = ""
    name: bytes = b""
    attributes: list = field(default_factory=list)
    inside: list = field(default_factory=list)

    def walk(self):
        """Iterate over the element and all below it, in reading order."""
        yield self
        for child in self.inside:
            if isinstance(child, Element):
                yield from child.walk()

    def pieces(self):
        return [
            child for element in self.walk() for child in element.inside if isinstance(child, Piece)
        ]


def as_list(value):
    return list(value) if isinstance(value, Array) else [value]


# ---- reading ----------------------------------------------------------------------


def read(pdf):
    """Return the tree of elements of ``pdf``, as Chromium made it."""
    numbers = {page.objgen: number for number, page in enumerate(pdf.pages)}

    def element(node, page):
        page = numbers[node.Pg.objgen] if "/Pg" in node else page
        tagged = Element(str(node.S)[1:], str(node.get("/Alt", "")), bytes(node.get("/ID", b"")))
        tagged.attributes = as_list(node.A) if "/A" in node else []
        for child in as_list(node.K) if "/K" in node else []:
            if isinstance(child, int):
                tagged.inside.append(Piece(page, (), child))
                continue
            here = numbers[child.Pg.objgen] if "/Pg" in child else page
            if "/S" in child:
                tagged.inside.append(element(child, here))
            elif child.Type == Name.OBJR:
                tagged.inside.append(Note(here, child.Obj))
            else:
                tagged.inside.append(
                    Piece(here, child.Stm.objgen if "/Stm" in child else (), child.MCID)
                )
        return tagged

    return element(pdf.Root.StructTreeRoot.K, None)


def letters(font):
    """Return the characters that each code of a font represents."""
    table, signs = font.ToUnicode.read_bytes().decode("ascii"), {}
    for block in re.findall(r"beginbfchar(.*?)endbfchar", table, re.DOTALL):
        for code, sign in re.findall(r"<(\w+)>\s*<(\w+)>", block):
            signs[int(code, 16)] = bytes.fromhex(sign).decode("utf-16-be")
    for block in re.findall(r"beginbfrange(.*?)endbfrange", table, re.DOTALL):
        for first, last, sign in re.findall(r"<(\w+)>\s*<(\w+)>\s*<(\w+)>", block):
            for code in range(int(first, 16), int(last, 16) + 1):
                signs[code] = chr(int(sign, 16) + code - int(first, 16))
    return signs


class Stream:
    """The drawing operations of a page or of a form on it.

    Chromium writes them as lines with an operator at the end of each.
    """

    def __init__(self, page, key, content, resources, known_letters):
        self.page, self.key, self.content = page, key, content
        self.lines = content.read_bytes().decode("latin-1").split("\n")
        self.forms = {
            name[1:]: form
            for name, form in resources.get("/XObject", {}).items()
            if form.Subtype == Name.Form
        }
        self.fonts = {}
        for name, font in resources.get("/Font", {}).items():
            if font.objgen not in known_letters:
                known_letters[font.objgen] = letters(font)
            self.fonts[name[1:]] = known_letters[font.objgen]

    def texts(self):
        """Return the words of each marked sequence, by its number."""
        # The stack contains the number of each open sequence, or its replacement text.
        texts, stack, font = ({}, [], {})
        for line in self.lines:
            operator = line.rsplit(" ", 1)[-1]
            number = next((entry for entry in reversed(stack) if isinstance(entry, int)), None)
            if operator.endswith(("BDC", "BMC")):
                mark = re.search(r"/MCID (\d+)", line)
                stands_for = re.search(r"/ActualText (?:<FEFF(\w*)>|\((\w*)\))", line)
                if mark:
                    stack.append(int(mark[1]))
                    texts.setdefault(stack[-1], "")
                else:
                    stack.append(None)
                    if stands_for:
                        stack[-1] = stands_for[2] or bytes.fromhex(stands_for[1]).decode(
                            "utf-16-be"
                        )
                    if stands_for and number is not None:
                        texts[number] += stack[-1]
            elif operator == "EMC":
                stack.pop()
            elif operator == "Tf":
                font = self.fonts[line.split()[0][1:]]
            elif operator in SHOW and number is not None and not isinstance(stack[-1], str):
                for code in re.findall(r"<([0-9A-Fa-f]+)>", line):
                    texts[number] += "".join(
                        font.get(int(code[k : k + 4], 16), "") for k in range(0, len(code), 4)
                    )
            elif operator == "ET" and number is not None:
                texts[number] += " "
        return {number: text.replace("\u200b", "") for number, text in texts.items()}

    def marked(self, numbers_kept, forms_with_marks):
        """Return the stream with all content outside of ``numbers_kept`` marked as artifacts."""
        out, open_sequences, open_artifact, path = [], [], False, None

        def close():
            nonlocal open_artifact
            if open_artifact:
                out.append("EMC")
                open_artifact = False

        for line in self.lines:
            operator = line.rsplit(" ", 1)[-1]
            if operator.endswith(("BDC", "BMC")):
                close()
                number = re.search(r"/MCID (\d+)", line)
                if number and any(open_sequences):
                    raise RuntimeError(
                        f"page {self.page + 1} of the PDF has a marked sequence within another"
                    )
                # Leave the replacement text of a sequence alone if it is inside another sequence.
                is_kept = int(number[1]) in numbers_kept if number else bool(open_sequences)
                open_sequences.append(bool(number))
                out.append(line if is_kept else "/Artifact BMC")
                continue
            if operator == "EMC":
                open_sequences.pop()
            elif not open_sequences:
                # A path becomes an artifact when it is painted, but not when it only clips what
                # follows.
                if operator in PATH and path is None:
                    path = len(out)
                elif operator in PAINT:
                    if operator != "n" and path is not None:
                        out[path:path] = ["/Artifact BMC"]
                        out += [line, "EMC"]
                        path = None
                        continue
                    path = None
                elif operator in SHOW and not open_artifact:
                    out.append("/Artifact BMC")
                    open_artifact = True
                elif operator == "ET":
                    close()
                elif operator in ("Do", "sh"):
                    form = self.forms.get(line.split()[0][1:]) if operator == "Do" else None
                    if form is None or form.objgen not in forms_with_marks:
                        out += ["/Artifact BMC", line, "EMC"]
                        continue
            out.append(line)
        return "\n".join(out).encode("latin-1")


def streams(pdf):
    """Return the streams of all pages and of the forms on them, by page and object."""
    by_page, known_letters = {}, {}
    for number, page in enumerate(pdf.pages):
        page.contents_coalesce()
        waiting = [((), page.Contents, page.get("/Resources", Dictionary()))]
        while waiting:
            key, content, resources = waiting.pop()
            if (number, key) in by_page:
                continue
            stream = by_page[number, key] = Stream(number, key, content, resources, known_letters)
            for form in stream.forms.values():
                waiting.append((form.objgen, form, form.get("/Resources", Dictionary())))
    return by_page


def boxes(printed, pages):
    """Return where the marked sequences of some ``pages`` of a PDF draw, by :class:`Piece`.

    The order is left, bottom, right, top. Forms are left out, because they have numbers of their
    own.
    """
    by_piece, sides = {}, [c_float() for _ in range(4)]
    with pypdfium2.PdfDocument(printed) as document:
        for number in sorted(pages):
            page = document[number]
            width, height = page.get_size()
            for place in range(pdfium.FPDFPage_CountObjects(page)):
                drawn = pdfium.FPDFPage_GetObject(page, place)
                mark = pdfium.FPDFPageObj_GetMarkedContentID(drawn)
                if mark < 0 or not pdfium.FPDFPageObj_GetBounds(drawn, *map(byref, sides)):
                    continue
                left, bottom, right, top = (side.value for side in sides)
                least = by_piece.setdefault(Piece(number, (), mark), [width, height, 0, 0])
                # Cut the box at the edges of the page, because nothing beyond them is visible.
                least[:2] = max(0, min(least[0], left)), max(0, min(least[1], bottom))
                least[2:] = min(width, max(least[2], right)), min(height, max(least[3], top))
            page.close()
    return by_piece


# ---- mending ------------------------------------------------------------------------


def without_groups(element):
    """Replace elements that only group others by their content."""
    inside = []
    for child in element.inside:
        if isinstance(child, Element):
            without_groups(child)
            if child.kind == "NonStruct":
                inside += child.inside
                continue
        inside.append(child)
    element.inside = inside


def name_figures(element):
    """Distinguish formulas from pictures; a group of a picture and its caption is not a picture."""
    for part in element.walk():
        if part.kind == "Figure" and part.description.startswith(FORMULA):
            part.kind, part.description = "Formula", part.description.removeprefix(FORMULA)
        elif part.kind == "Figure" and not part.description:
            part.kind = "Div"
        if part.kind in WORDED:
            part.inside = part.pieces()


def drop_blank(element, texts):
    """Remove parts without text, such as lines and shades, but keep all parts of a picture."""
    if element.kind in WORDED:
        return
    inside = []
    for child in element.inside:
        if isinstance(child, Element):
            drop_blank(child, texts)
            if not child.inside and child.kind not in ("TD", "TH"):
                continue
        elif isinstance(child, Piece) and (
            element.kind in BARE or not texts.get(child, "").strip()
        ):
            continue
        inside.append(child)
    element.inside = inside


def once(element):
    """Keep only the first head of a table that goes on on another page, so that it is read once."""
    for head in element.walk():
        if head.kind == "TH" and (pieces := head.pieces()):
            first = min(piece.page for piece in pieces)
            for cell in head.walk():
                cell.inside = [
                    part
                    for part in cell.inside
                    if not isinstance(part, Piece) or part.page == first
                ]


def in_paragraphs(element):
    """Make text among blocks a paragraph, and what follows the label of an item its body."""
    for child in element.inside:
        if isinstance(child, Element):
            in_paragraphs(child)
    if element.kind == "LI":
        labels = [
            child for child in element.inside if isinstance(child, Element) and child.kind == "Lbl"
        ]
        body = [child for child in element.inside if child not in labels]
        element.inside = [*labels, Element("LBody", inside=body)]
    elif element.kind in GROUPS:
        inside, run = [], []
        for child in [*element.inside, None]:
            if child is not None and (
                not isinstance(child, Element) or child.kind in INLINE and child.kind != "Formula"
            ):
                run.append(child)
                continue
            if run:
                inside.append(Element("P", inside=run))
                run = []
            if child is not None:
                inside.append(child)
        element.inside = inside


def place_pictures(root, printed):
    """Record the position of each picture and formula that is on a single page."""
    worded = [part for part in root.walk() if part.kind in WORDED]
    pieces = {part: part.pieces() for part in worded}
    whole = [part for part in worded if len({piece.page for piece in pieces[part]}) == 1]
    drawn = boxes(printed, {pieces[part][0].page for part in whole})
    for part in whole:
        sides = [drawn[piece] for piece in pieces[part] if piece in drawn]
        if sides:
            left, bottom, right, top = zip(*sides)
            box = [round(side, 2) for side in (min(left), min(bottom), max(right), max(top))]
            part.attributes.append(Dictionary(O=Name.Layout, BBox=Array(box)))


def words(element, texts):
    """Return the text that a screen reader reads for an element."""
    if element.kind in WORDED:
        return element.description
    contents = (
        words(child, texts)
        if isinstance(child, Element)
        else texts.get(child, "")
        if isinstance(child, Piece)
        else ""
        for child in element.inside
    )
    return re.sub(r"\s+", " ", "".join(contents)).strip()


def describe_links(element, texts, places):
    """Describe each link and its target."""
    for link in element.walk():
        notes = [part for part in link.inside if isinstance(part, Note)]
        for note in notes:
            annotation, label = note.annotation, words(link, texts)
            if "/A" in annotation and "/URI" in annotation.A:
                address = str(annotation.A.URI)
                label = label if address in label else f"{label} ({address})"
            elif "/Dest" in annotation:
                label = f"{label}, page {places[str(annotation.Dest)] + 1}"
            annotation.Contents = String(label)


# ---- writing ------------------------------------------------------------------------


def write(pdf, root, streams_by_page):
    """Replace the tree of ``pdf`` by the tree ``root``."""
    pages = [page.obj for page in pdf.pages]
    parents, names = {}, []
    keys = {}
    for (number, key), stream in streams_by_page.items():
        holder = stream.content if key else pages[number]
        if "/StructParents" in holder:
            keys[number, key] = int(holder.StructParents)
    top = pdf.make_indirect(Dictionary(Type=Name.StructTreeRoot, RoleMap=Dictionary()))
    for kind, known in ROLES.items():
        top.RoleMap[f"/{kind}"] = Name(f"/{known}")

    def put(element, above):
        here = pdf.make_indirect(
            Dictionary(Type=Name.StructElem, S=Name(f"/{element.kind}"), P=above)
        )
        if element.description:
            here.Alt = String(element.description)
        if element.name:
            here.ID = String(element.name)
            names.append((element.name, here))
        if element.attributes:
            here.A = (
                Array(element.attributes) if len(element.attributes) > 1 else element.attributes[0]
            )
        inside, page = [], None
        for child in element.inside:
            if isinstance(child, Element):
                inside.append(put(child, here))
            elif isinstance(child, Note):
                reference = Dictionary(Type=Name.OBJR, Obj=child.annotation, Pg=pages[child.page])
                inside.append(reference)
                parents[int(child.annotation.StructParent)] = here
            else:
                if page is None and not child.stream:
                    page, here.Pg = child.page, pages[child.page]
                if child.page == page and not child.stream:
                    inside.append(child.number)
                else:
                    piece = Dictionary(Type=Name.MCR, Pg=pages[child.page], MCID=child.number)
                    if child.stream:
                        piece.Stm = pdf.get_object(child.stream)
                    inside.append(piece)
                table = parents.setdefault(keys[child.page, child.stream], {})
                table[child.number] = here
        here.K = Array(inside)
        return here

    top.K = put(root, top)
    numbers = []
    for key, held in sorted(parents.items()):
        if isinstance(held, dict):
            held = pdf.make_indirect(Array([held.get(number) for number in range(max(held) + 1)]))
        numbers += [key, held]
    top.ParentTree = pdf.make_indirect(Dictionary(Nums=Array(numbers)))
    top.ParentTreeNextKey = max(parents, default=-1) + 1
    if names:
        names.sort(key=lambda pair: pair[0])
        flat = [part for name, element in names for part in (String(name), element)]
        limits = Array([String(names[0][0]), String(names[-1][0])])
        leaf = pdf.make_indirect(Dictionary(Names=Array(flat), Limits=limits))
        top.IDTree = pdf.make_indirect(Dictionary(Kids=Array([leaf])))
    pdf.Root.StructTreeRoot = top


def mend(pdf, printed):
    """Correct the structure of ``pdf``, opened from the bytes ``printed``; return its words."""
    streams_by_page = streams(pdf)
    texts = {
        Piece(number, key, mark): text
        for (number, key), stream in streams_by_page.items()
        for mark, text in stream.texts().items()
    }
    places = {page.objgen: number for number, page in enumerate(pdf.pages)}
    places = {
        name: places[place[0].objgen]
        for name, place in pdf.Root.get("/Dests", Dictionary()).items()
    }
    root = read(pdf)
    without_groups(root)
    name_figures(root)
    place_pictures(root, printed)
    once(root)
    drop_blank(root, texts)
    in_paragraphs(root)
    describe_links(root, texts, places)
    numbers_kept = {}
    for piece in root.pieces():
        numbers_kept.setdefault((piece.page, piece.stream), set()).add(piece.number)
    forms_with_marks = {key for (_, key) in numbers_kept if key}
    for (number, key), stream in streams_by_page.items():
        if not key or key in forms_with_marks:
            stream.content.write(
                stream.marked(numbers_kept.get((number, key), ()), forms_with_marks)
            )
    write(pdf, root, streams_by_page)
    for page in pdf.pages:
        page.Tabs = Name.S
    return words(root, texts)
