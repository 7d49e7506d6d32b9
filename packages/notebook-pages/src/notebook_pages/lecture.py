"""The lecture of a page: the steps that its author marked, each with what
it shows and notes for the speaker.

A mark is a comment in the text, which neither the page nor Jupyter shows::

    <!-- step: One arrow stays, and two sweep a circle.
    shows: figure-simple-moving equation-simple-matrix

    Let them say first which arrow stays. -->

The first paragraph is the line that stands beside what is shown; ``shows:`` names labels of the
page (none, for a line alone), and without it the step shows the next figure, formula, box, table,
list or cell. What follows an empty line is for the speaker. A page without marks is shown section
by section: each heading with a figure, or else with its first displayed formula. A page that moves
its own figure as it is scrolled, an essay, puts ``data-stop`` into each of the sections that are
its steps: the heading is the line, and the text is for the speaker.
"""

import re
from functools import cache
from html import escape
from itertools import pairwise

from docutils import nodes
from markdown_it import MarkdownIt
from mdit_py_plugins.dollarmath import dollarmath_plugin
from sphinx.util import logging

from .mathematics import PUNCTUATION, to_html
from .paths import where
from .questions import question

MARK = re.compile(r"\s*<!--\s*step:\s*(?P<line>.*?)(?:\n\s*\n(?P<notes>.*?))?\s*-->\s*", re.DOTALL)
SHOWS = re.compile(r"^shows:(.*)$", re.MULTILINE)
LECTURES = "chapters/"
STOP = re.compile(r"\bdata-stop=")
#: Parts that an audience sees rather than hears.
SHOWN = (
    nodes.figure, nodes.math_block, nodes.Admonition, nodes.table, nodes.container,
    nodes.literal_block, nodes.image, nodes.enumerated_list, nodes.bullet_list, question,
)  # fmt: skip

logger = logging.getLogger(__name__)


@cache
def typesetter():
    def formula(tex, options):
        return to_html(tex, options.get("display_mode", False))

    return MarkdownIt("commonmark", {"html": False}).use(dollarmath_plugin, renderer=formula)


def in_words(text, whole):
    """HTML of a line, or of the ``whole`` of some paragraphs, of Markdown with formulas."""
    tokens = (typesetter().parse if whole else typesetter().parseInline)(text)
    for block in tokens:
        keep_punctuation(block.children or [])
    return typesetter().renderer.render(tokens, typesetter().options, {})


def keep_punctuation(tokens):
    """Let no line begin with the comma after a formula: it is set within the formula."""
    for formula, after in pairwise(tokens):
        if formula.type == "math_inline" and after.content[:1] in (*PUNCTUATION, "?", "!"):
            formula.content += rf"\text{{{after.content[0]}}}"
            after.content = after.content[1:]


def name_of(node, number):
    """An id by which the browser finds what this node has become; a cell
    stands for the figure that it draws.
    """
    figure = next(node.findall(nodes.figure), None)
    shown = figure if figure is not None else node
    if isinstance(shown, nodes.math_block) and shown.get("label"):
        return nodes.make_id(f"equation-{shown['label']}")
    if not shown["ids"]:
        shown["ids"].append(f"shown-{number}")
    return shown["ids"][0]


def labelled(doctree):
    """The id of each label of a page, as authors write it."""
    found = {}
    for node in doctree.findall(nodes.Element):
        for name in (*node.get("names", ()), *node.get("ids", ())):
            found.setdefault(name, node["ids"][0] if node["ids"] else name)
        if isinstance(node, nodes.math_block) and node.get("label"):
            found[node["label"]] = nodes.make_id(f"equation-{node['label']}")
    return found


def unknown(label, node):
    fault = "a step of the lecture shows %s, which is not a label on this page"
    logger.warning(fault, label, location=where(node), type="website", subtype="lecture")
    return label


def heading_of(node):
    while node is not None and not isinstance(node, nodes.section):
        node = node.parent
    return node["ids"][0] if node is not None else ""


def marked(doctree):
    """Take the marks out of a page, and return their steps."""
    marks = [(node, MARK.fullmatch(node.astext())) for node in doctree.findall(nodes.raw)]
    marks = [(node, mark) for node, mark in marks if mark]
    labels = labelled(doctree) if marks else {}
    steps = []
    for number, (node, mark) in enumerate(marks, 1):
        around, place = node.parent, node.parent.index(node)
        line, notes = mark["line"], mark["notes"] or ""
        if named := SHOWS.search(line):
            line = SHOWS.sub("", line)
            shows = [labels.get(label) or unknown(label, node) for label in named[1].split()]
        else:
            following = [one for one in around[place + 1 :] if isinstance(one, SHOWN)]
            shows = [name_of(one, number) for one in following[:1]]
        steps.append(
            {
                "line": " ".join(line.split()),
                "notes": notes,
                "shows": shows,
                "section": heading_of(around),
            }
        )
    for node, _ in marks:
        node.parent.remove(node)
    return steps


def unmarked(doctree):
    """Steps for a page whose author marked none: what each section shows, under its heading."""
    steps = []
    for section in doctree.findall(nodes.section):
        if (title := next(section.findall(nodes.title), None)) is None:
            continue
        figures = [
            one
            for block in section
            if not isinstance(block, nodes.section)
            for one in block.findall(nodes.figure)
        ]
        formulas = [block for block in section if isinstance(block, nodes.math_block)]
        asked = [block for block in section if isinstance(block, question) and block["predicts"]]
        shown = [[one] for one in figures] or [[]]
        shown[0] += formulas[:1]
        for together in [*filter(None, shown), *([one] for one in asked)]:
            shows = [name_of(one, f"{len(steps)}-{place}") for place, one in enumerate(together)]
            steps.append(
                {"line": title.astext(), "notes": "", "shows": shows, "section": section["ids"][0]}
            )
    return steps


def note_steps(app, doctree):
    page = app.env.docname
    if page.startswith(LECTURES):
        app.env.metadata[page]["steps"] = marked(doctree) or unmarked(doctree)


def as_html(step):
    return (
        f'<li data-shows="{escape(" ".join(step["shows"]))}" '
        f'data-section="{escape(step["section"])}">'
        f"<p>{in_words(step['line'], whole=False)}</p>"
        f"<aside>{in_words(step['notes'], whole=True)}</aside></li>"
    )


def add_lecture(app, pagename, templatename, context, doctree):
    """Give the page its steps, in a template that nobody sees, and the script that shows them."""
    if doctree is None:
        return
    stops = STOP.search(context.get("body", ""))
    steps = app.env.metadata[pagename].get("steps", [])
    if not stops and not steps:
        return
    context["lecture_script"] = context["pathto"]("_static/lecture.js", 1)
    if not stops:
        try:
            items = "".join(map(as_html, steps))
        except ValueError as error:
            logger.warning(
                "bad TeX in a step of the lecture: %s",
                error,
                location=pagename,
                type="website",
                subtype="tex",
            )
        else:
            context["body"] += f'<template id="lecture"><ol>{items}</ol></template>'


def setup(app):
    app.connect("doctree-read", note_steps, priority=900)
    app.connect("html-page-context", add_lecture)
