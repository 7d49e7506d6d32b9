"""Mathematics set at build time by KaTeX, so that pages need no script for it.

KaTeX runs in the Node of the environment, in one process for the whole build, and gives HTML for
the eye and MathML for screen readers. TeX that it cannot set becomes a build warning.
"""

import atexit
import json
import os
import re
import subprocess
from contextlib import suppress
from functools import cache
from html import escape
from textwrap import indent

from docutils import nodes
from sphinx import addnodes
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

from .light_formulas import lighten
from .paths import NODE, NODE_MODULES, WEBSITE, where

SCRIPT = WEBSITE / "katex.mjs"
KATEX = NODE_MODULES / "katex" / "dist" / "katex.min.js"

PUNCTUATION = tuple(".,;:!?)")
#: Characters that a line break must not separate from a formula: after it, and before it.
CLOSING, OPENING = ("’s", "'s", *PUNCTUATION), tuple("([“")
# A formula of at most this many visible characters, half a line of the narrowest page, need not
# be broken.
SHORT = 18
# Commands that TeX needs but that show nothing, or show it above or around another character.
UNSEEN = re.compile(
    r"\\(?:math\w+|hat|bar|dot|ddot|vec|tilde|left|right|[dt]?frac|quad)\b|\\[,;:! ]|[{}^_&\s]"
)
logger = logging.getLogger(__name__)


class KaTeX:
    """A process that sets one formula after another."""

    def __init__(self):
        self.process = subprocess.Popen(
            [NODE, SCRIPT, KATEX],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            encoding="utf8",
        )
        atexit.register(self.close)

    def __call__(self, tex, display, stretch):
        try:
            self.process.stdin.write(
                json.dumps({"tex": tex, "display": display, "stretch": stretch}) + "\n"
            )
            self.process.stdin.flush()
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            raise RuntimeError(
                f"KaTeX ended with code {self.process.wait()} (see its last message above), at "
                f"the formula {tex}"
            )
        return json.loads(answer)

    def close(self):
        with suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()


@cache
def katex(process):
    """Return the KaTeX process of the Python process with this number; forks need their own."""
    return KaTeX()


@cache
def to_html(tex, display):
    """Return KaTeX's HTML for ``tex``; raise ValueError with KaTeX's own message."""
    # KaTeX sets the rows of a matrix so close together that fractions in them would touch.
    answer = katex(os.getpid())(tex, display, "1.6" if r"\frac" in tex else "1.15")
    if "fault" in answer:
        raise ValueError(answer["fault"].replace("\u0332", ""))
    return lighten(answer["html"], tex)


def render(node, display):
    tex = node.astext().strip()
    try:
        return to_html(tex, display)
    except ValueError as error:
        logger.warning("bad TeX: %s", error, location=where(node), type="website", subtype="tex")
        return f'<code class="bad-tex">{escape(tex)}</code>'


def signs(tex):
    """Return roughly how many characters of a formula a reader sees."""
    return len(re.sub(r"\\[a-zA-Z]+", "x", UNSEEN.sub("", tex)))


def keep_punctuation(app, doctree, docname):
    """Keep punctuation on the same line as the formula before or after it.

    A short formula is not broken. A longer one, which may be, gets the punctuation at its ends.
    """
    for formula in list(doctree.findall(nodes.math)):
        parent = formula.parent
        place = parent.index(formula)
        before, after = (
            parent[k]
            if 0 <= k < len(parent) and isinstance(parent[k], nodes.Text)
            else nodes.Text("")
            for k in (place - 1, place + 1)
        )
        opening = before[-1:] if before.endswith(OPENING) else ""
        closing = next((mark for mark in CLOSING if after.startswith(mark)), "")
        if not (opening or closing):
            continue
        tex = formula.astext()
        if signs(tex) > SHORT:
            ends = [rf"\text{{{mark}}}" if mark else "" for mark in (opening, closing)]
            parent[place] = nodes.math("", tex.join(ends))
        else:
            parent[place] = together = nodes.inline("", "", classes=["together"])
            together += [nodes.Text(opening), formula, nodes.Text(closing)]
        if closing:
            parent[place + 1] = nodes.Text(after[len(closing) :])
        if opening:
            parent[place - 1] = nodes.Text(before[:-1])


def typeset_docstring(app, what, name, documented, options, lines):
    r"""Make formulas of the TeX between dollars, which a docstring has since a terminal shows it.

    As in a chapter, no space may stand just inside the dollars, and code is left as it is.

    >>> lines = ["Turn $A$ by", "", "$$", r"\theta", "$$", "", "``$x$``, $HOME and $PATH."]
    >>> typeset_docstring(None, "", "", None, None, lines)
    >>> lines
    ['Turn :math:`A` by', '', '.. math::', '', '   \\theta', '', '', '``$x$``, $HOME and $PATH.']
    """
    text = re.sub(
        r"^( *)\$\$\n(.*?)^ *\$\$$",
        lambda match: f"{match[1]}.. math::\n\n" + indent(match[2], "   "),
        "\n".join(lines),
        flags=re.MULTILINE | re.DOTALL,
    )
    lines[:] = re.sub(
        r"``.+?``|\$(?!\s)([^$]+)(?<!\s)\$(?!\d)",
        lambda match: f":math:`{match[1]}`" if match[1] else match[0],
        text,
        flags=re.DOTALL,
    ).split("\n")


def link_equations(app, doctree, docname):
    """Make links of the numbers by which docstrings name equations, after *In the book*."""
    places = {
        f"({'.'.join(map(str, number))})": app.builder.get_relative_uri(docname, page) + f"#{place}"
        for page, numbers in app.env.toc_fignumbers.items()
        for place, number in numbers.get("displaymath", {}).items()
    }
    texts = [
        text
        for described in doctree.findall(addnodes.desc_content)
        for text in described.findall(nodes.Text)
        if "In the book: " in text
    ]
    for text in texts:
        parts = [
            nodes.reference("", part, refuri=places[part], internal=True)
            if part in places
            else nodes.Text(part)
            for part in re.split(r"(\([\d.]+\))", text)
        ]
        text.parent.replace(text, parts)


def visit_inline(translator, node):
    translator.body.append(render(node, display=False))
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
    app.setup_extension("sphinx.ext.autodoc")
    app.connect("autodoc-process-docstring", typeset_docstring)
    app.connect("doctree-resolved", link_equations)
    app.connect("doctree-resolved", keep_punctuation)
    app.add_html_math_renderer(
        "katex", inline_renderers=(visit_inline, None), block_renderers=(visit_display, None)
    )
