"""What a program can tell of a PDF by the Matterhorn Protocol 1.1, the list of how
files fail PDF/UA-1 (ISO 14289-1).

It reads the file with pikepdf alone, and shares nothing with what makes it. Each fault begins with
the number of the condition. Left out are conditions on what the book has none of: forms, sound,
scripts, layers, files within the file, encryption; and those that a person must judge.
"""

import re
from collections import Counter

import pikepdf

HEADINGS = {f"H{level}": level for level in range(1, 7)}
STANDARD = set(HEADINGS) | set(
    "Document Part Art Sect Div BlockQuote Caption TOC TOCI Index NonStruct Private P H L LI Lbl "
    "LBody Table TR TH TD THead TBody TFoot Span Quote Note Reference BibEntry Code Link Annot "
    "Ruby RB RT RP Warichu WT WP Figure Formula Form".split()
)
#: What may stand in what, for lists and tables.
WITHIN = {
    "LI": {"L"}, "Lbl": {"LI", "P", "Note", "Reference", "TOCI", "Span"}, "LBody": {"LI"},
    "TR": {"Table", "THead", "TBody", "TFoot"}, "TH": {"TR"}, "TD": {"TR"}, "THead": {"Table"},
    "TBody": {"Table"},
}  # fmt: skip
INSIDE = {
    "L": {"LI", "L", "Caption"}, "LI": {"Lbl", "LBody"},
    "Table": {"TR", "THead", "TBody", "TFoot", "Caption"}, "TR": {"TH", "TD"},
}  # fmt: skip
PAINTS = {
    "f",
    "F",
    "f*",
    "S",
    "s",
    "B",
    "B*",
    "b",
    "b*",
    "Tj",
    "TJ",
    "'",
    '"',
    "sh",
    "BI",
    "INLINE IMAGE",
}


def listed(value):
    return list(value) if isinstance(value, pikepdf.Array) else [value]


def of_metadata(pdf):
    root = pdf.Root
    if not root.get("/MarkInfo", {}).get("/Marked"):
        yield "06-001 the file does not say that it is tagged"
    if "/Metadata" not in root:
        yield "06-001 there is no XMP metadata"
    else:
        with pdf.open_metadata(set_pikepdf_as_editor=False, update_docinfo=False) as metadata:
            if metadata.get("pdfuaid:part") != "1":
                yield "06-002 the metadata do not name PDF/UA-1"
            if not metadata.get("dc:title"):
                yield "06-003 the metadata name no title"
    if not root.get("/ViewerPreferences", {}).get("/DisplayDocTitle"):
        yield "07-001 the window would show the name of the file, not the title"
    if not str(root.get("/Lang", "")):
        yield "11-006 the language is not stated"


def elements(pdf):
    """All elements in the order of reading, each with its standard type and its parent's."""
    roles = {
        str(key)[1:]: str(value)[1:]
        for key, value in pdf.Root.StructTreeRoot.get("/RoleMap", {}).items()
    }
    stack = [(node, "") for node in reversed(listed(pdf.Root.StructTreeRoot.K))]
    while stack:
        node, above = stack.pop()
        kind = str(node.S)[1:]
        kind = roles.get(kind, kind)
        yield node, kind, above
        inside = listed(node.K) if "/K" in node else []
        stack += [
            (child, kind)
            for child in reversed(inside)
            if isinstance(child, pikepdf.Dictionary) and "/S" in child
        ]


def of_structure(pdf):
    levels, ids, named_ids = [], set(), set()
    for node, kind, above in elements(pdf):
        inside = listed(node.K) if "/K" in node else []
        facts = {}
        for attributes in listed(node.A) if "/A" in node else []:
            facts |= dict(attributes.items())
        if kind not in STANDARD:
            yield f"02-001 {kind} is no standard type, and stands for none"
        if kind in WITHIN and above not in WITHIN[kind]:
            yield f"09-004 {kind} stands in {above or 'nothing'}"
        if above in INSIDE and kind not in INSIDE[above]:
            yield f"09-005 {kind} stands in {above}"
        if kind in INSIDE and any(isinstance(child, int) or "/MCID" in child for child in inside):
            yield f"09-006 text stands in {kind} itself"
        if kind in ("Figure", "Formula") and len(str(node.get("/Alt", "")).strip()) < 1:
            yield f"{'13-004' if kind == 'Figure' else '17-002'} a {kind} has no words"
        if kind == "Formula" and re.search(r"[\\\ue000{}]", str(node.get("/Alt", ""))):
            yield f"17-002 a formula is not spoken: {str(node.Alt)[:60]}"
        if kind == "Figure" and "/BBox" not in facts:
            yield "BBox a Figure does not say where it stands (ISO 32000-1, table 344)"
        if kind in HEADINGS:
            levels.append(HEADINGS[kind])
        if "/ID" in node:
            ids.add(bytes(node.ID))
        named_ids |= {bytes(name) for name in facts.get("/Headers", [])}
        if kind == "TH" and str(facts.get("/Scope", "")) not in ("/Row", "/Column", "/Both"):
            yield "15-003 a cell that heads others does not say which"
    if levels[:1] != [1]:
        yield f"14-002 the first heading has the level {levels[:1]}"
    yield from (
        f"14-003 a heading of level {level} is followed by one of level {next_one}"
        for level, next_one in zip(levels, levels[1:])
        if next_one > level + 1
    )
    if missing := named_ids - ids:
        yield f"15-003 cells name {len(missing)} headings that are not there"


def marks(pdf, stream, where, used):
    """Faults of one stream, and of the forms that it draws; the numbers of its
    marked pieces are added to ``used``.
    """
    stack, resources = [], stream.get("/Resources", {})
    for operands, operator in pikepdf.parse_content_stream(stream):
        operator = str(operator)
        if operator in ("BDC", "BMC"):
            kind = str(operands[0])
            number = (
                operands[1].get("/MCID")
                if operator == "BDC" and isinstance(operands[1], pikepdf.Dictionary)
                else None
            )
            inside = "artifact" in stack or "content" in stack
            if kind == "/Artifact":
                if "content" in stack:
                    yield f"01-003 {where}: an artifact within tagged content"
                stack.append("artifact")
            elif number is not None:
                if inside:
                    yield f"01-004 {where}: tagged content within other"
                used.append(int(number))
                stack.append("content")
            else:
                stack.append("other")
        elif operator == "EMC":
            stack.pop()
        elif operator == "Do":
            drawn = resources.XObject[operands[0]]
            has_marks = "/StructParents" in drawn
            if not has_marks and not {"artifact", "content"} & set(stack):
                yield f"01-005 {where}: something drawn is neither tagged nor an artifact"
        elif operator in PAINTS and not {"artifact", "content"} & set(stack):
            yield f"01-005 {where}: {operator} is neither tagged nor an artifact"
    if stack:
        yield f"01-005 {where}: a marked piece does not end"


def pieces(pdf):
    """How often each marked piece is named by the structure: by the page or
    form that holds it, and its number.
    """
    marks = Counter()
    for node, _, _ in elements(pdf):
        for child in listed(node.K) if "/K" in node else []:
            if isinstance(child, int):
                marks[node.Pg.objgen, child] += 1
            elif child.get("/Type") == "/MCR":
                holder = child.Stm if "/Stm" in child else child.Pg if "/Pg" in child else node.Pg
                marks[holder.objgen, int(child.MCID)] += 1
    return marks


def table_of_parents(pdf):
    waiting, table = [pdf.Root.StructTreeRoot.ParentTree], {}
    while waiting:
        node = waiting.pop()
        waiting += listed(node.get("/Kids", pikepdf.Array()))
        flat = listed(node.get("/Nums", pikepdf.Array()))
        table |= {int(key): value for key, value in zip(flat[::2], flat[1::2])}
    return table


def of_content(pdf):
    parents, named, held = table_of_parents(pdf), pieces(pdf), Counter()
    for number, page in enumerate(pdf.pages, start=1):
        forms = [
            form
            for form in page.get("/Resources", {}).get("/XObject", {}).values()
            if "/StructParents" in form
        ]
        for holder, stream in [(page.obj, page), *((form, form) for form in forms)]:
            used = []
            yield from marks(pdf, stream, f"page {number}", used)
            held.update((holder.objgen, mark) for mark in used)
            table = parents.get(int(holder.get("/StructParents", -1)))
            for mark in used:
                if table is None or mark >= len(table) or table[mark] is None:
                    yield f"01-006 page {number}: a piece does not know its element"
    if held != named:
        lost, unknown = held - named, named - held
        yield (
            f"01-006 {lost.total()} pieces stand in no element or in two, {unknown.total()} "
            "elements name none"
        )


def of_annotations(pdf):
    in_links = set()
    for node, kind, _ in elements(pdf):
        for child in listed(node.K) if "/K" in node else []:
            if isinstance(child, pikepdf.Dictionary) and child.get("/Type") == "/OBJR":
                in_links |= {child.Obj.objgen} if kind == "Link" else set()
    parents = table_of_parents(pdf)
    for number, page in enumerate(pdf.pages, start=1):
        notes = listed(page.get("/Annots", pikepdf.Array()))
        if notes and page.get("/Tabs") != "/S":
            yield f"28-008 page {number}: the tabulator does not follow the structure"
        for note in notes:
            if note.Subtype != "/Link":
                yield f"28-002 page {number}: an annotation of kind {note.Subtype}"
            if note.objgen not in in_links:
                yield f"28-011 page {number}: a link is in no element of links"
            if not re.search(r"\w", str(note.get("/Contents", ""))):
                yield f"28-012 page {number}: a link does not say what it is"
            if int(note.get("/StructParent", -1)) not in parents:
                yield f"28-011 page {number}: a link does not know its element"


def of_fonts(pdf):
    fonts = {}
    for page in pdf.pages:
        resources = [page.get("/Resources", {})]
        resources += [
            form.get("/Resources", {}) for form in resources[0].get("/XObject", {}).values()
        ]
        for resource in resources:
            fonts |= {font.objgen: font for font in resource.get("/Font", {}).values()}
    for font in fonts.values():
        inner = font.DescendantFonts[0] if "/DescendantFonts" in font else font
        name, described = font.get("/BaseFont", "drawn"), inner.get("/FontDescriptor", {})
        if (
            not {"/FontFile", "/FontFile2", "/FontFile3"} & set(described.keys())
            and font.Subtype != "/Type3"
        ):
            yield f"31-009 the typeface {name} is not in the file"
        if "/ToUnicode" not in font:
            yield f"10-001 what the signs of {name} stand for is not said"
        if inner.Subtype == "/CIDFontType2" and "/CIDToGIDMap" not in inner:
            yield f"31-004 {name} does not say which outline is which sign's"


def faults(pdf):
    """All faults that are found, the first of each kind with how many there are like it."""
    kinds_of_faults = Counter()
    first = {}
    for part in (of_metadata, of_structure, of_content, of_annotations, of_fonts):
        for fault in part(pdf):
            number = fault.partition(" ")[0]
            kinds_of_faults[number] += 1
            first.setdefault(number, fault)
    return [f"{first[number]} ({count} such)" for number, count in sorted(kinds_of_faults.items())]
