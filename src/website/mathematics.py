"""Mathematics set at build time by KaTeX, so that pages need no script for it.

KaTeX runs inside Python (quickjs) and gives HTML for the eye and MathML for
screen readers. TeX that it cannot set becomes a build warning.
"""

import base64
import re
import shutil
from functools import lru_cache
from html import escape
from pathlib import Path

import quickjs
from docutils import nodes
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

from .paths import NODE_MODULES, where

KATEX = NODE_MODULES / "katex" / "dist"
# The fonts that matrices, hats and Greek letters need ride inside the style
# sheet: it is there before the first paint, so nothing moves when they show.
INLINE_FONTS = {
    "Main-Regular", "Main-Bold", "Math-Italic",
    "Size1-Regular", "Size2-Regular", "Size3-Regular", "Size4-Regular",
}  # fmt: skip
RENDER = """(function (tex, display) {
  try {
    return "+" + katex.renderToString(tex, {
      displayMode: display, output: "htmlAndMathml", throwOnError: true, strict: "error"
    });
  } catch (error) { return "-" + error.message; }
})"""

logger = logging.getLogger(__name__)


@lru_cache(maxsize=None)
def katex():
    context = quickjs.Context()
    context.eval("globalThis.console = {log() {}, warn() {}, error() {}}")
    context.eval((KATEX / "katex.min.js").read_text("utf8"))
    return context.eval(RENDER)


@lru_cache(maxsize=None)
def to_html(tex, display):
    """KaTeX's HTML for ``tex``; raises ValueError with KaTeX's own words."""
    answer = katex()(tex, display)
    if answer[0] == "-":
        raise ValueError(answer[1:].replace("\u0332", ""))
    return answer[1:]


def render(node, display):
    tex = node.astext().strip()
    try:
        return to_html(tex, display)
    except ValueError as error:
        logger.warning("bad TeX: %s", error, location=where(node), type="website", subtype="tex")
        return f'<code class="bad-tex">{escape(tex)}</code>'


def visit_inline(translator, node):
    translator.body.append(f'<span class="math">{render(node, display=False)}</span>')
    raise nodes.SkipNode


def visit_display(translator, node):
    translator.body.append(translator.starttag(node, "div", CLASS="math display"))
    translator.body.append(f'<div class="math-box">{render(node, display=True)}</div>')
    if node.get("number"):
        number = get_node_equation_number(translator, node)
        translator.body.append(f'<span class="eqno">({number})')
        translator.add_permalink_ref(node, "Link to this equation")
        translator.body.append("</span>")
    translator.body.append("</div>\n")
    raise nodes.SkipNode


def write_styles(app):
    """Copy KaTeX's style sheet with its woff2 fonts only."""
    if app.builder.format != "html":
        return
    target = Path(app.outdir) / "_static" / "katex"
    target.mkdir(parents=True, exist_ok=True)

    def source(match):
        name = match["name"]
        font = KATEX / "fonts" / f"KaTeX_{name}.woff2"
        if name in INLINE_FONTS:
            data = base64.b64encode(font.read_bytes()).decode()
            return f'src:url(data:font/woff2;base64,{data}) format("woff2")'
        shutil.copyfile(font, target / font.name)
        return f'src:url({font.name}) format("woff2")'

    css = (KATEX / "katex.min.css").read_text("utf8")
    css, count = re.subn(r"src:url\(fonts/KaTeX_(?P<name>[\w-]+)\.woff2\)[^}]*", source, css)
    if count < len(INLINE_FONTS):
        raise RuntimeError("KaTeX's style sheet no longer names its fonts as expected")
    (target / "katex.css").write_text(css, "utf8")


def setup(app):
    app.add_html_math_renderer(
        "katex", inline_renderers=(visit_inline, None), block_renderers=(visit_display, None)
    )
    app.connect("builder-inited", write_styles)
    app.add_css_file("katex/katex.css", priority=300)
