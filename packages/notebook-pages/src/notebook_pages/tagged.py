"""The structure of a printed PDF, put in order: what a screen
reader is told, by ISO 14289-1 (PDF/UA).

Chromium tags what it prints, nearly well. Here its tree of elements is read, mended and written
anew: empty groups go, formulas become formulas, lists get their parts, links say where they lead,
and whatever is on a page and in no element, such as page numbers, lines and shades, is marked as an
artifact.
"""

import re
from ctypes import byref, c_float
from dataclasses import dataclass, field
from typing import NamedTuple

import pikepdf
import pypdfium2
import pypdfium2.raw as pdfium
from pikepdf import Array, Dictionary, Name, String

#: Words before those of a formula, which distinguish it from a picture.
FORMULA = "\ue000"
#: Types that PDF 1.7 lacks, and the types that replace them.
ROLES = {"Strong": "Span", "Em": "Span"}
GROUPS = ("Document", "Art", "Sect", "Div")
INLINE = ("Span", "Strong", "Em", "Code", "Link", "Formula", "Lbl")
#: Elements that contain only other elements.
BARE = ("L", "Table", "TR")
#: Elements that a screen reader reads by their description and not by their content.
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
    said: str = ""
    name: bytes = b""
    attributes: list = field(default_factory=list)
    inside: list = field(default_factory=list)

    def walk(self):
        """The element and all below it, in the order of reading."""
        yield self
        for one in self.inside:
            if isinstance(one, Element):
                yield from one.walk()

    def pieces(self):
        return [one for element in self.walk() for one in element.inside if isinstance(one, Piece)]


def as_list(value):
    return list(value) if isinstance(value, Array) else [value]


# ---- reading ----------------------------------------------------------------------


def read(pdf):
    """The tree of elements of ``pdf``, as Chromium made it."""
    numbers = {page.objgen: number for number, page in enumerate(pdf.pages)}

    def element(node, page):
        page = numbers[node.Pg.objgen] if "/Pg" in node else page
        found = Element(str(node.S)[1:], str(node.get("/Alt", "")), bytes(node.get("/ID", b"")))
        found.attributes = as_list(node.A) if "/A" in node else []
        for one in as_list(node.K) if "/K" in node else []:
            if isinstance(one, int):
                found.inside.append(Piece(page, (), one))
                continue
            here = numbers[one.Pg.objgen] if "/Pg" in one else page
            if "/S" in one:
                found.inside.append(element(one, here))
            elif one.Type == Name.OBJR:
                found.inside.append(Note(here, one.Obj))
            else:
                found.inside.append(Piece(here, one.Stm.objgen if "/Stm" in one else (), one.MCID))
        return found

    return element(pdf.Root.StructTreeRoot.K, None)


def letters(font):
    """What each code of a font stands for."""
    table, found = font.ToUnicode.read_bytes().decode("ascii"), {}
    for block in re.findall(r"beginbfchar(.*?)endbfchar", table, re.DOTALL):
        for code, sign in re.findall(r"<(\w+)>\s*<(\w+)>", block):
            found[int(code, 16)] = bytes.fromhex(sign).decode("utf-16-be")
    for block in re.findall(r"beginbfrange(.*?)endbfrange", table, re.DOTALL):
        for first, last, sign in re.findall(r"<(\w+)>\s*<(\w+)>\s*<(\w+)>", block):
            for code in range(int(first, 16), int(last, 16) + 1):
                found[code] = chr(int(sign, 16) + code - int(first, 16))
    return found


class Stream:
    """What a page, or a form on it, draws: lines with an operator at the end
    of each, as Chromium writes them.
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
        """The words of each marked sequence, by its number."""
        # The stack: the number of each open sequence, or what it says it stands for.
        found, stack, font = ({}, [], {})
        for line in self.lines:
            operator = line.rsplit(" ", 1)[-1]
            number = next((one for one in reversed(stack) if isinstance(one, int)), None)
            if operator.endswith(("BDC", "BMC")):
                mark = re.search(r"/MCID (\d+)", line)
                stands_for = re.search(r"/ActualText (?:<FEFF(\w*)>|\((\w*)\))", line)
                if mark:
                    stack.append(int(mark[1]))
                    found.setdefault(stack[-1], "")
                else:
                    stack.append(None)
                    if stands_for:
                        stack[-1] = stands_for[2] or bytes.fromhex(stands_for[1]).decode(
                            "utf-16-be"
                        )
                    if stands_for and number is not None:
                        found[number] += stack[-1]
            elif operator == "EMC":
                stack.pop()
            elif operator == "Tf":
                font = self.fonts[line.split()[0][1:]]
            elif operator in SHOW and number is not None and not isinstance(stack[-1], str):
                for code in re.findall(r"<([0-9A-Fa-f]+)>", line):
                    found[number] += "".join(
                        font.get(int(code[k : k + 4], 16), "") for k in range(0, len(code), 4)
                    )
            elif operator == "ET" and number is not None:
                found[number] += " "
        return {number: said.replace("\u200b", "") for number, said in found.items()}

    def marked(self, kept, forms_with_marks):
        """The stream with every sequence that is not ``kept``, and all that
        stands outside of any, as artifacts.
        """
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
                is_kept = int(number[1]) in kept if number else bool(open_sequences)
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
    """The streams of all pages and of the forms on them, by page and object."""
    found, known_letters = {}, {}
    for number, page in enumerate(pdf.pages):
        page.contents_coalesce()
        waiting = [((), page.Contents, page.get("/Resources", Dictionary()))]
        while waiting:
            key, content, resources = waiting.pop()
            if (number, key) in found:
                continue
            stream = found[number, key] = Stream(number, key, content, resources, known_letters)
            for form in stream.forms.values():
                waiting.append((form.objgen, form, form.get("/Resources", Dictionary())))
    return found


def boxes(printed, pages):
    """Where the marked sequences of some ``pages`` of a PDF draw: left, bottom, right and top, by
    :class:`Piece`.

    What is drawn by a form on the page is left out: its numbers are its own.
    """
    found, sides = {}, [c_float() for _ in range(4)]
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
                least = found.setdefault(Piece(number, (), mark), [width, height, 0, 0])
                # Nobody sees what the edge of the page cuts off.
                least[:2] = max(0, min(least[0], left)), max(0, min(least[1], bottom))
                least[2:] = min(width, max(least[2], right)), min(height, max(least[3], top))
            page.close()
    return found


# ---- mending ------------------------------------------------------------------------


def without_groups(element):
    """Take out elements that only group others and say nothing of them."""
    inside = []
    for one in element.inside:
        if isinstance(one, Element):
            without_groups(one)
            if one.kind == "NonStruct":
                inside += one.inside
                continue
        inside.append(one)
    element.inside = inside


def name_figures(element):
    """Tell formulas from pictures; what holds a picture and its caption is no picture itself."""
    for one in element.walk():
        if one.kind == "Figure" and one.said.startswith(FORMULA):
            one.kind, one.said = "Formula", one.said.removeprefix(FORMULA)
        elif one.kind == "Figure" and not one.said:
            one.kind = "Div"
        if one.kind in WORDED:
            one.inside = one.pieces()


def drop_blank(element, texts):
    """Leave out what shows nothing to read: lines and shades. A
    picture keeps all that it is drawn of.
    """
    if element.kind in WORDED:
        return
    inside = []
    for one in element.inside:
        if isinstance(one, Element):
            drop_blank(one, texts)
            if not one.inside and one.kind not in ("TD", "TH"):
                continue
        elif isinstance(one, Piece) and (element.kind in BARE or not texts.get(one, "").strip()):
            continue
        inside.append(one)
    element.inside = inside


def once(element):
    """The head of a table that goes on is printed again on the next page: it is read once."""
    for one in element.walk():
        if one.kind == "TH" and (pieces := one.pieces()):
            first = min(piece.page for piece in pieces)
            for cell in one.walk():
                cell.inside = [
                    part
                    for part in cell.inside
                    if not isinstance(part, Piece) or part.page == first
                ]


def in_paragraphs(element):
    """Text that stands in a group among blocks is a paragraph; what follows
    the sign of an item is its body.
    """
    for one in element.inside:
        if isinstance(one, Element):
            in_paragraphs(one)
    if element.kind == "LI":
        labels = [one for one in element.inside if isinstance(one, Element) and one.kind == "Lbl"]
        body = [one for one in element.inside if one not in labels]
        element.inside = [*labels, Element("LBody", inside=body)]
    elif element.kind in GROUPS:
        inside, run = [], []
        for one in [*element.inside, None]:
            if one is not None and (
                not isinstance(one, Element) or one.kind in INLINE and one.kind != "Formula"
            ):
                run.append(one)
                continue
            if run:
                inside.append(Element("P", inside=run))
                run = []
            if one is not None:
                inside.append(one)
        element.inside = inside


def place_pictures(root, printed):
    """Say of each picture and formula where on its page it stands, if it stands on one page."""
    worded = [one for one in root.walk() if one.kind in WORDED]
    pieces = {one: one.pieces() for one in worded}
    whole = [one for one in worded if len({piece.page for piece in pieces[one]}) == 1]
    drawn = boxes(printed, {pieces[one][0].page for one in whole})
    for one in whole:
        sides = [drawn[piece] for piece in pieces[one] if piece in drawn]
        if sides:
            left, bottom, right, top = zip(*sides)
            box = [round(side, 2) for side in (min(left), min(bottom), max(right), max(top))]
            one.attributes.append(Dictionary(O=Name.Layout, BBox=Array(box)))


def words(element, texts):
    """What is read of an element."""
    if element.kind in WORDED:
        return element.said
    said = (
        words(one, texts)
        if isinstance(one, Element)
        else texts.get(one, "")
        if isinstance(one, Piece)
        else ""
        for one in element.inside
    )
    return re.sub(r"\s+", " ", "".join(said)).strip()


def describe_links(element, texts, places):
    """Say of each link what it is and where it leads."""
    for one in element.walk():
        notes = [part for part in one.inside if isinstance(part, Note)]
        for note in notes:
            annotation, said = note.annotation, words(one, texts)
            if "/A" in annotation and "/URI" in annotation.A:
                address = str(annotation.A.URI)
                said = said if address in said else f"{said} ({address})"
            elif "/Dest" in annotation:
                said = f"{said}, page {places[str(annotation.Dest)] + 1}"
            annotation.Contents = String(said)


# ---- writing ------------------------------------------------------------------------


def write(pdf, root, found):
    """Put the tree ``root`` into ``pdf``, in the place of the one that it has."""
    pages = [page.obj for page in pdf.pages]
    parents, names = {}, []
    keys = {}
    for (number, key), stream in found.items():
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
        if element.said:
            here.Alt = String(element.said)
        if element.name:
            here.ID = String(element.name)
            names.append((element.name, here))
        if element.attributes:
            here.A = (
                Array(element.attributes) if len(element.attributes) > 1 else element.attributes[0]
            )
        inside, page = [], None
        for one in element.inside:
            if isinstance(one, Element):
                inside.append(put(one, here))
            elif isinstance(one, Note):
                reference = Dictionary(Type=Name.OBJR, Obj=one.annotation, Pg=pages[one.page])
                inside.append(reference)
                parents[int(one.annotation.StructParent)] = here
            else:
                if page is None and not one.stream:
                    page, here.Pg = one.page, pages[one.page]
                if one.page == page and not one.stream:
                    inside.append(one.number)
                else:
                    piece = Dictionary(Type=Name.MCR, Pg=pages[one.page], MCID=one.number)
                    if one.stream:
                        piece.Stm = pdf.get_object(one.stream)
                    inside.append(piece)
                table = parents.setdefault(keys[one.page, one.stream], {})
                table[one.number] = here
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
    """Put the structure of ``pdf``, opened from the bytes ``printed``, in
    order; return the words that are read.
    """
    found = streams(pdf)
    texts = {
        Piece(number, key, mark): said
        for (number, key), stream in found.items()
        for mark, said in stream.texts().items()
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
    kept = {}
    for piece in root.pieces():
        kept.setdefault((piece.page, piece.stream), set()).add(piece.number)
    forms_with_marks = {key for (_, key) in kept if key}
    for (number, key), stream in found.items():
        if not key or key in forms_with_marks:
            stream.content.write(stream.marked(kept.get((number, key), ()), forms_with_marks))
    write(pdf, root, found)
    for page in pdf.pages:
        page.Tabs = Name.S
    return words(root, texts)
