"""Mathematics set at build time by KaTeX, so that pages need no script for it.

KaTeX runs inside Python (quickjs) and gives HTML for the eye and MathML for
screen readers. TeX that it cannot set becomes a build warning.
"""

from functools import cache
from html import escape

import quickjs
from docutils import nodes
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

from .paths import NODE_MODULES, where

KATEX = NODE_MODULES / "katex" / "dist" / "katex.min.js"
RENDER = """(function (tex, display, stretch) {
  try {
    return "+" + katex.renderToString(tex, {
      displayMode: display, output: "htmlAndMathml", throwOnError: true, strict: "error",
      macros: {"\\\\arraystretch": stretch}
    });
  } catch (error) { return "-" + error.message; }
})"""

logger = logging.getLogger(__name__)


@cache
def katex():
    context = quickjs.Context()
    context.eval("globalThis.console = {log() {}, warn() {}, error() {}}")
    context.eval(KATEX.read_text("utf8"))
    return context.eval(RENDER)


@cache
def to_html(tex, display):
    """KaTeX's HTML for ``tex``; raises ValueError with KaTeX's own words."""
    # KaTeX sets the rows of a matrix so close that fractions in them would touch.
    answer = katex()(tex, display, "1.6" if r"\frac" in tex else "1.15")
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


def setup(app):
    app.add_html_math_renderer("katex", inline_renderers=(visit_inline, None), block_renderers=(visit_display, None))
