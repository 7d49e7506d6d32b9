"""The style sheet that carries the typefaces and KaTeX's rules.

The fonts every page needs ride inside it: a style sheet is there before the
first paint, so no line of text or mathematics moves when its font arrives.
"""

import base64
import re
import shutil
from pathlib import Path

from .paths import NODE_MODULES

KATEX = NODE_MODULES / "katex" / "dist"
INLINE_KATEX = {
    "Main-Regular", "Main-Bold", "Math-Italic",
    "Size1-Regular", "Size2-Regular", "Size3-Regular", "Size4-Regular",
}  # fmt: skip
SERIF = NODE_MODULES / "@fontsource" / "source-serif-4" / "files"
SANS = NODE_MODULES / "@fontsource-variable" / "source-sans-3" / "files"
TEXT_FACES = (
    # family, weight, style, file
    ("Source Serif 4", "400", "normal", SERIF / "source-serif-4-latin-400-normal.woff2"),
    ("Source Serif 4", "400", "italic", SERIF / "source-serif-4-latin-400-italic.woff2"),
    ("Source Serif 4", "600", "normal", SERIF / "source-serif-4-latin-600-normal.woff2"),
    ("Source Sans 3", "200 900", "normal", SANS / "source-sans-3-latin-wght-normal.woff2"),
)


def inline(font):
    data = base64.b64encode(font.read_bytes()).decode()
    return f'src:url(data:font/woff2;base64,{data}) format("woff2")'


def text_faces():
    return "".join(
        f'@font-face{{font-family:"{family}";font-weight:{weight};font-style:{style};{inline(file)}}}\n'
        for family, weight, style, file in TEXT_FACES
    )


def katex_rules(folder):
    """KaTeX's style sheet; fonts that few pages need go to ``folder`` as files."""

    def source(match):
        name = match["name"]
        font = KATEX / "fonts" / f"KaTeX_{name}.woff2"
        if name in INLINE_KATEX:
            return inline(font)
        shutil.copyfile(font, folder / font.name)
        return f'src:url({font.name}) format("woff2")'

    rules = (KATEX / "katex.min.css").read_text("utf8")
    rules, count = re.subn(r"src:url\(fonts/KaTeX_(?P<name>[\w-]+)\.woff2\)[^}]*", source, rules)
    if count < len(INLINE_KATEX):
        raise RuntimeError("KaTeX's style sheet no longer names its fonts as expected")
    return rules


def write(app):
    if app.builder.format == "html":
        folder = Path(app.outdir) / "_static" / "fonts"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "fonts.css").write_text(text_faces() + katex_rules(folder), "utf8")


def setup(app):
    app.connect("builder-inited", write)
