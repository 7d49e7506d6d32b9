"""The typefaces, reduced to the characters that pages use, and the CSS rules that load them.

Each face is a file of its own, with a hash in its name. The rules are in the page itself, so that
the browser requests the files at once without waiting for a style sheet. Characters that a reduced
face lacks come from the whole face, which is fetched only when a page has such a character. Until
the typefaces arrive, for which layout.html waits a moment, the text is set in the reader's own,
scaled to the same width.
"""

import io
import re
import shutil
from functools import cache
from hashlib import sha256
from itertools import chain, pairwise
from pathlib import Path

from fontTools.ttLib import TTFont

from .first_view import first_part
from .paths import NODE_MODULES, fingerprint

KATEX = NODE_MODULES / "katex" / "dist"
SERIF = NODE_MODULES / "@fontsource" / "source-serif-4" / "files"
SANS = NODE_MODULES / "@fontsource-variable" / "source-sans-3" / "files"
# Characters of the text: those that the book uses, and a few more. A page with any other character
# fetches the whole face.
LATIN = (
    "U+20-7E,U+A0,U+A9,U+B0-B2,U+B5,U+B7,U+B9,U+D7,U+E0,U+E4,U+E8-E9,U+F6,U+F8,U+FC,U+2009,U+2013-2014,U+2018-2019,"
    "U+201C-201D,U+2026,U+202F,U+2032,U+2212"
)
SELDOM = "U+A1-FF,U+131,U+152-153,U+2BC,U+2C6,U+2DA,U+2DC,U+200A-200B,U+2010-2026,U+20AC"
#: Characters of formulas: letters, Greek, operators, brackets and accents.
GREEK = "U+3B1-3B9,U+3BB-3BD,U+3C0,U+3C1,U+3C3,U+3C4,U+3C6-3C9,U+3D1,U+3D5,U+3F5"
FORMULAS = (
    "U+20-7E,U+A0,U+A8,U+AF-B1,U+B4,U+B7,U+D7,U+2C6,U+2C9,U+2D9,U+2DC,U+394,U+398,U+3A3,U+3A6,U+3A9,U+2013-2014,"
    "U+2018-2019,U+201C-201D,U+2026,U+2032,U+20D7,U+2190-2193,U+21D2,U+21D4,U+2202,U+2208,U+2211-2213,U+2217-2218,"
    "U+221A,U+221E,U+2223,U+2225,U+222B,U+223C,U+2248,U+2260-2261,U+2264-2265,U+22A4-22A5,U+2297,U+22C5,U+22EE-22F1,"
    "U+27E8-27E9,U+27F9-27FA,U+E020"
)


def _serif(style):
    return SERIF / f"source-serif-4-latin-{style}.woff2"


def _katex(face):
    return KATEX / "fonts" / f"KaTeX_{face}.woff2"


FACES = (
    # Family, weight, style, file, characters, and whether the whole file is available as well.
    ("Source Serif 4", "400", "normal", _serif("400-normal"), LATIN, True),
    ("Source Serif 4", "400", "italic", _serif("400-italic"), LATIN, True),
    ("Source Serif 4", "600", "normal", _serif("600-normal"), LATIN, True),
    ("Source Sans 3", "400 600", "normal",
     SANS / "source-sans-3-latin-wght-normal.woff2", LATIN, True),
    ("KaTeX_Main", "400", "normal", _katex("Main-Regular"), FORMULAS, True),
    ("KaTeX_Main", "700", "normal", _katex("Main-Bold"),
     "U+20-7E,U+A0,U+2C6-2DC,U+D7,U+3A3,U+3A6,U+3A9", True),
    ("KaTeX_Math", "400", "italic", _katex("Math-Italic"), f"U+20-7E,U+A0,{GREEK}", True),
    ("KaTeX_Math", "700", "italic", _katex("Math-BoldItalic"), f"U+20-7E,U+A0,{GREEK}", True),
    *((f"KaTeX_Size{n}", "400", "normal", _katex(f"Size{n}-Regular"), None, False)
      for n in (1, 2, 3, 4)),
)  # fmt: skip
# Use the reader's own typefaces until the book's have arrived, scaled to the same average width of
# English text.
UNTIL_THEN = {
    "Georgia": 106.7, "Noto Serif": 98.9, "DejaVu Serif": 92.9, "Times New Roman": 117,
    "Roboto": 94, "Arial": 93.8, "DejaVu Sans": 82.5,
}  # fmt: skip
FOLDER = Path("_static", "fonts")
FEATURES = ["kern", "liga", "mark", "mkmk", "ccmp", "locl", "tnum"]


def codes(signs):
    """Iterate over the code points that a ``unicode-range`` names."""
    for part in re.findall(r"U\+([0-9A-F]+(?:-[0-9A-F]+)?)", signs):
        first, _, last = part.partition("-")
        yield from range(int(first, 16), int(last or first, 16) + 1)


def beyond(file, signs, seldom):
    """Return the ``unicode-range`` of the characters of ``file`` beyond ``signs``.

    It is limited to ``seldom``, if that is given. Every page waits for these ranges, so two of them
    become one where little lies between them, and none of ``signs``.
    """
    known = set(codes(signs))
    left = sorted((set(codes(seldom)) if seldom else set(TTFont(file).getBestCmap())) - known)
    gaps = [(a, b) for a, b in pairwise(left) if b - a > 16 or not known.isdisjoint(range(a, b))]
    ends = [left[0], *chain(*gaps), left[-1]]
    return ",".join(
        f"U+{a:X}" if a == b else f"U+{a:X}-{b:X}" for a, b in zip(ends[::2], ends[1::2])
    )


def cut(file, signs, weights):
    """Return the face ``file`` as bytes, with only ``signs`` and, if variable, only ``weights``."""
    from fontTools import subset
    from fontTools.varLib import instancer

    font = TTFont(file)
    # Without hints, browsers that round to whole pixels would make the letters of a formula wider.
    options = subset.Options(layout_features=FEATURES, hinting=True, notdef_outline=True)
    cutter = subset.Subsetter(options)
    cutter.populate(unicodes=list(codes(signs)) if signs else list(font.getBestCmap()))
    cutter.subset(font)
    if "fvar" in font:
        whole = io.BytesIO()
        font.flavor = None
        font.save(whole)
        font = instancer.instantiateVariableFont(
            TTFont(whole), {"wght": tuple(map(int, weights.split()))}
        )
    # Keep the dates, so that the bytes are the same each time.
    font["head"].modified = font["head"].created
    font.recalcTimestamp = False
    font.flavor = "woff2"
    made = io.BytesIO()
    font.save(made)
    return made.getvalue()


@cache
def cut_faces():
    """Return the folder with all reduced faces, made once for each version to save seconds."""
    folder = (
        NODE_MODULES
        / ".cache"
        / f"fonts-{fingerprint(Path(__file__), *(face[3] for face in FACES))}"
    )
    folder.mkdir(parents=True, exist_ok=True)
    for _, weight, _, file, signs, _ in FACES:
        if not (folder / file.name).exists():
            part = folder / f"{file.name}.part"
            part.write_bytes(cut(file, signs, weight))
            part.replace(folder / file.name)
    return folder


@cache
def files():
    """Return the source file of each file in the folder of fonts, by name."""
    copies = {}
    for _, _, _, file, _, whole in FACES:
        for source in (cut_faces() / file.name, *([file] if whole else [])):
            copies[f"{file.stem}-{sha256(source.read_bytes()).hexdigest()[:8]}.woff2"] = source
    return copies


def name_of(source):
    return next(name for name, known in files().items() if known == source)


def face_rule(folder, family, weight, style, source, reach):
    signs = f";unicode-range:{reach}" if reach else ""
    return (
        f'@font-face{{font-family:"{family}";font-weight:{weight};'
        f"{f'font-style:{style};' * (style != 'normal')}"
        f'font-display:swap;src:url({folder}/{name_of(source)}) format("woff2"){signs}}}'
    )


@cache
def face_rules(folder):
    """Return the rules for a page whose fonts are in ``folder``."""
    rules = [
        face_rule(folder, family, weight, style, cut_faces() / file.name, signs if whole else None)
        for family, weight, style, file, signs, whole in FACES
    ]
    for name, width in UNTIL_THEN.items():
        rules.append(
            f'@font-face{{font-family:"{name} for now";src:local("{name}");size-adjust:{width}%}}'
        )
    return "\n".join(rules)


def whole_face_rules(folder):
    """Return the rules of the whole faces, for characters that the reduced ones lack.

    ``folder`` is the folder of the fonts as seen from the style sheet.
    """
    return "\n".join(
        face_rule(
            folder,
            family,
            weight,
            style,
            file,
            beyond(file, signs, SELDOM if signs == LATIN else None),
        )
        for family, weight, style, file, signs, whole in FACES
        if whole
    )


def katex_rules(folder):
    """Return KaTeX's rules without those that the page itself has.

    ``folder`` is the folder of the fonts as seen from the style sheet.
    """
    known = {face[3].name for face in FACES}

    def rule(match):
        font = re.search(r"KaTeX_[\w-]+\.woff2", match[0])[0]
        if font in known:
            known.remove(font)
            return ""
        return re.sub(r"src:url\([^}]*", f'src:url({folder}/{font}) format("woff2")', match[0])

    rules = re.sub(r"@font-face\{[^}]*\}", rule, (KATEX / "katex.min.css").read_text("utf8"))
    if any(name.startswith("KaTeX") for name in known):
        raise RuntimeError("KaTeX's style sheet no longer names its fonts as expected")
    # KaTeX no longer uses these classes.
    return re.sub(r"\.katex \.fontsize-ensurer[\w.-]+,", "", rules)


def write(app):
    if app.builder.format == "html":
        folder = Path(app.outdir, FOLDER)
        folder.mkdir(parents=True, exist_ok=True)
        for outdated in folder.iterdir():
            if outdated.name not in files():
                outdated.unlink()
        known = {face[3].name for face in FACES}
        seldom = {
            font.name: font for font in (KATEX / "fonts").glob("*.woff2") if font.name not in known
        }
        for name, source in (files() | seldom).items():
            shutil.copyfile(source, folder / name)


# Patterns in the HTML of a part of a page which show that it uses a face. Faces that are not listed
# here are on every page.
SEEN_BY = {
    ("Source Serif 4", "400", "italic"): r"<(?:em|cite|dfn)\b",
    ("KaTeX_Main", "400", "normal"): r"class=katex\b",
    ("KaTeX_Main", "700", "normal"): r"<b>",
    ("KaTeX_Math", "400", "italic"): r"<var\b|\bboldsymbol\b",
    ("KaTeX_Math", "700", "italic"): r"\bboldsymbol\b",
    ("KaTeX_Size1", "400", "normal"): r"\b(?:delimsizing size1|delim-size1|small-op)\b",
    ("KaTeX_Size2", "400", "normal"): r"\b(?:delimsizing size2|large-op)\b",
    ("KaTeX_Size3", "400", "normal"): r"\bdelimsizing size3\b",
    ("KaTeX_Size4", "400", "normal"): r"\b(?:delimsizing size4|delim-size4)\b",
}


def faces_in(html):
    """Return the faces that ``html`` uses."""
    return [face for face in FACES if re.search(SEEN_BY.get(face[:3], ""), html)]


def add_to_head(app, pagename, templatename, context, doctree):
    """Give the page its font rules, and preload the faces of its first view."""
    folder = context["pathto"](str(FOLDER), 1)
    body = context.get("body", "")
    context["font_faces"] = face_rules(folder)
    context["first_fonts"] = [
        f"{folder}/{name_of(cut_faces() / face[3].name)}" for face in faces_in(first_part(body))
    ]
    # The format of a style sheet, so that a script can ask for the font.
    for name, html in (("first_faces", first_part(body)), ("all_faces", body)):
        context[name] = [
            f'{style} {weight.split()[0]} 1em "{family}"'
            for family, weight, style, *_ in faces_in(html)
        ]


def setup(app):
    app.connect("builder-inited", write)
    app.connect("html-page-context", add_to_head)
