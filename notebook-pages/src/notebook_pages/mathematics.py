"""Mathematics set at build time by KaTeX, so that pages need no script for it.

KaTeX runs in the Node of the environment, in one process for the whole build, and gives HTML for the eye and
MathML for screen readers. TeX that it cannot set becomes a build warning.
"""

import atexit
import json
import os
import re
import subprocess
from contextlib import suppress
from functools import cache
from html import escape

from docutils import nodes
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number

from .paths import NODE, NODE_MODULES, WEBSITE, where

SCRIPT = WEBSITE / "katex.mjs"
KATEX = NODE_MODULES / "katex" / "dist" / "katex.min.js"

PUNCTUATION = tuple(".,;:!?)")
#: What the end of a line may not part from a formula: after it, and before it.
CLOSING, OPENING = ("’s", "'s", *PUNCTUATION), tuple("([“")
SHORT = 18  # signs, as a reader sees them, of a formula that need not be broken: half a line of the narrowest page
#: What TeX needs and nobody sees, or sees above or around another sign.
UNSEEN = re.compile(r"\\(?:math\w+|hat|bar|dot|ddot|vec|tilde|left|right|[dt]?frac|quad)\b|\\[,;:! ]|[{}^_&\s]")
STYLE_SHEETS = (KATEX.with_name("katex.css"), WEBSITE / "static" / "book.css")
#: What holds letters side by side, so that a group within it, which has no style of its own, changes nothing.
ROWS = ("katex-base", "katex-sizing")
#: A letter raised or lowered, which KaTeX sets as a table of one row or two: by how far, and with what room beside it.
RAISED = re.compile(
    r'<span class="msupsub"><span class="vlist-t(?: vlist-t2)?"><span class="vlist-r">'
    r'<span class="vlist" style="[^"]*"><span style="top:(?P<top>-?[\d.]+)em;(?:margin-left:(?P<left>-?[\d.]+)em;)?'
    r'margin-right:(?P<right>[\d.]+)em;"><span class="pstrut" style="height:(?P<strut>[\d.]+)em;"></span>'
    r'<span class="katex-sizing reset-size6 size3">(?P<letters>(?:<span[^>]*>[^<]*</span>|[^<])*)</span></span></span>'
    r'(?:<span class="vlist-s">.</span></span><span class="vlist-r"><span class="vlist" style="[^"]*"><span></span>'
    r"</span>)?</span></span></span>"
)
SMALL = 0.7  # size of such letters


def style_of(*said):
    """The attribute for those of the pairs of name and value that have a value."""
    styles = ";".join(f"{name}:{value}" for name, value in said if value)
    return f" style={styles}" if styles else ""


#: Shorter ways to say in HTML what KaTeX says at length; book.css draws them. The strut that begins each row of a table
#: has one height in the whole table, and needs no element; nor does that of a part of a formula.
ROWS_BEGIN = re.compile(
    r"<span class=vlist style=height:(?P<high>[\d.]+em)>"
    r"(?=<span[^>]*><span class=pstrut style=height:(?P<strut>[\d.]+em)>)"
)
PSTRUT = re.compile(r"<span class=pstrut [^>]*></span>")
BASE_BEGIN = re.compile(
    r"<span class=katex-base><span class=katex-strut"
    r" style=height:(?P<high>[-\d.]+em)(?:;vertical-align:(?P<low>[-\d.]+em))?></span>"
)
SPACE = re.compile(r"<span class=mspace style=margin-right:0\.(1667|2222|2778)em></span>")
SPACES = {"1667": "mu3", "2222": "mu4", "2778": "mu5"}
TIGHT = re.compile(r'class="katex-sizing reset-size6 size3( script)?"')
LETTER = re.compile(r"<span class=mathnormal( style=[^>]*)?>([^<]*)</span>")
#: A hat stands above the middle of its letter: one letter and one hat, in place of a table.
HAT = re.compile(
    r'<span class=katex-accent><span class=(?:vlist-t|"vlist-t vlist-t2")><span class=vlist-r>'
    r"<span class=rows style=height:[\d.]+em(?:;--strut:2.7em)?>"
    r"<span style=top:-(?P<strut>3|2\.7)em>(?P<letter><(?P<kind>var|span)[^>]*>[^<]*</(?P=kind)>|[^<>]+)</span>"
    r"<span style=top:-(?P<top>[\d.]+)em><span class=accent-body(?: style=left:(?P<left>-?[\d.]+em))?>"
    r"<span>(?P<hat>.)</span></span></span></span>"
    r"(?:<span class=vlist-s>.</span></span>"
    r"<span class=vlist-r><span class=vlist style=[^>]*><span></span></span>)?</span></span></span>"
)


def hat(match):
    letter = match["letter"] if match["kind"] else f"<span>{match['letter']}</span>"
    above = round(float(match["strut"]) - float(match["top"]), 4)
    place = style_of(("left", match["left"]), ("top", above and f"{above:g}em"))
    return f"<span class=hat>{letter}<span{place}>{match['hat']}</span></span>"


def shorten(drawn):
    """What KaTeX draws, in fewer elements."""

    def rows(match):
        strut = match["strut"] if match["strut"] != "3em" else None
        return f"<span class=rows{style_of(('height', match['high']), ('--strut', strut))}>"

    def base(match):
        return f"<span class=base{style_of(('--high', match['high']), ('--low', match['low']))}>"

    drawn = PSTRUT.sub("", ROWS_BEGIN.sub(rows, drawn))
    drawn = SPACE.sub(lambda match: f"<span class={SPACES[match[1]]}></span>", BASE_BEGIN.sub(base, drawn))
    drawn = TIGHT.sub(lambda match: "class=script" if match[1] else "class=tight", drawn)
    return HAT.sub(hat, LETTER.sub(r"<var\1>\2</var>", drawn))


logger = logging.getLogger(__name__)


class KaTeX:
    """A process that sets one formula after another."""

    def __init__(self):
        self.process = subprocess.Popen(
            [NODE, SCRIPT, KATEX], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf8"
        )
        atexit.register(self.close)

    def __call__(self, tex, display, stretch):
        try:
            self.process.stdin.write(json.dumps({"tex": tex, "display": display, "stretch": stretch}) + "\n")
            self.process.stdin.flush()
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            raise RuntimeError(
                f"KaTeX ended with code {self.process.wait()} (its last words stand above), at the formula {tex}"
            )
        return json.loads(answer)

    def close(self):
        atexit.unregister(self.close)
        with suppress(BrokenPipeError):
            self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()


@cache
def katex(process):
    """The process that sets formulas for the Python process of this number; forks have pipes of their own."""
    return KaTeX()


@cache
def styled():
    """The names of classes that a style sheet knows; KaTeX also writes many that only its own program needs."""
    return frozenset(
        name for path in STYLE_SHEETS for name in re.findall(r"\.([a-zA-Z][\w-]*)", path.read_text("utf8"))
    )


def without_groups(drawn):
    """The HTML without elements that only group letters of a row."""
    found, open_tags = [], []
    for tag in re.split(r"(</?span[^>]*>)", drawn):
        if tag.startswith("<span"):
            parent = open_tags[-1] if open_tags else ""
            in_row = parent in ("", "<span>") or any(name in parent for name in ROWS)
            needed = tag != "<span>" or not in_row
            open_tags.append(tag if needed else "")
            found.append(tag if needed else "")
        elif tag == "</span>":
            found.append(tag if not open_tags or open_tags.pop() else "")
        else:
            found.append(tag)
    return "".join(found)


def moved(match):
    """A raised or lowered letter as one element: the strut of its row keeps the room for it."""
    style = f"top:{(float(match['top']) + float(match['strut'])) / SMALL:.4g}em"
    if float(match["left"] or 0):
        style += f";margin-left:{float(match['left']) / SMALL:.3g}em"
    if match["right"] != "0.05":
        style += f";margin-right:{float(match['right']) / SMALL:.3g}em"
    return f'<span class="katex-sizing reset-size6 size3 script" style="{style}">{match["letters"]}</span>'


def lighten(html, tex):
    """The same formula for eye and ear in half of the text: formulas are most of what a page weighs.

    Left out are classes that nothing names, elements that say nothing, quotes that HTML does not need, and the frame
    around the TeX, which stands in ``data-tex`` for those who print it.
    """
    spoken, middle, drawn = html.partition('<span class="katex-html" aria-hidden="true">')
    spoken = re.sub(r'<annotation.*?</annotation>|</?semantics>| xmlns="[^"]*"', "", spoken, flags=re.DOTALL)
    spoken = spoken.replace('class="katex">', f'class="katex" data-tex="{escape(tex)}">', 1)

    def known(match):
        names = " ".join(name for name in match[1].split() if name in styled())
        return f' class="{names}"' if names else ""

    drawn = RAISED.sub(moved, without_groups(re.sub(r' class="([^"]*)"', known, drawn)))
    drawn = re.sub(r'(<span[^>]*?) style="([^"]*);"', r'\1 style="\2"', drawn)
    drawn = re.sub(r'="([\w.:;%#-]+)"(?=[^<]*>)', r"=\1", drawn)
    return spoken + middle + shorten(drawn)


@cache
def to_html(tex, display):
    """KaTeX's HTML for ``tex``; raises ValueError with KaTeX's own words."""
    # KaTeX sets the rows of a matrix so close that fractions in them would touch.
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
    """How many signs a reader sees of a formula, about."""
    return len(re.sub(r"\\[a-zA-Z]+", "x", UNSEEN.sub("", tex)))


def keep_punctuation(app, doctree, docname):
    """Let no line begin with the full stop, comma or ’s after a short formula, nor end with the bracket before it."""
    for formula in list(doctree.findall(nodes.math)):
        if signs(formula.astext()) > SHORT:
            continue
        parent = formula.parent
        place = parent.index(formula)
        before, after = (
            parent[k] if 0 <= k < len(parent) and isinstance(parent[k], nodes.Text) else nodes.Text("")
            for k in (place - 1, place + 1)
        )
        opening = before[-1:] if before.endswith(OPENING) else ""
        closing = next((mark for mark in CLOSING if after.startswith(mark)), "")
        if opening or closing:
            parent[place] = together = nodes.inline("", "", classes=["together"])
            together += [nodes.Text(opening), formula, nodes.Text(closing)]
            if closing:
                parent[place + 1] = nodes.Text(after[len(closing) :])
            if opening:
                parent[place - 1] = nodes.Text(before[:-1])


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
    app.connect("doctree-resolved", keep_punctuation)
    app.add_html_math_renderer("katex", inline_renderers=(visit_inline, None), block_renderers=(visit_display, None))
