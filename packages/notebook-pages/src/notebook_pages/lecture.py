"""The lecture of a page: the steps that its author marked, each with speaker's notes.

A mark is a comment in the text, which neither the page nor Jupyter shows::

    <!-- step: One arrow stays, and two sweep a circle.
    shows: figure-simple-moving equation-simple-matrix

    Let them say first which arrow stays. -->

The first paragraph is the line beside the displayed elements. ``shows:`` names labels of the page
(none, for a line alone); without it, the step shows the next figure, formula, box, table, list or
cell. The text after an empty line is for the speaker. A page without marks is shown section by
section: each heading with a figure, or else with its first displayed formula. A page that animates
its own figure as it is scrolled, an essay, has ``data-stop`` in each section that is a step: the
heading is the line, and the text is for the speaker.
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
# Elements that an audience sees rather than hears.
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
    """Render a line, or the paragraphs of a ``whole`` text, from Markdown with formulas to HTML."""
    tokens = (typesetter().parse if whole else typesetter().parseInline)(text)
    for block in tokens:
        keep_punctuation(block.children or [])
    return typesetter().renderer.render(tokens, typesetter().options, {})


def keep_punctuation(tokens):
    """Keep the comma after a formula on its line by setting it within the formula."""
    for formula, after in pairwise(tokens):
        if formula.type == "math_inline" and after.content[:1] in PUNCTUATION:
            formula.content += rf"\text{{{after.content[0]}}}"
            after.content = after.content[1:]


def name_of(node, number):
    """Return an ID by which the browser finds this node; for a cell, that of its figure."""
    figure = next(node.findall(nodes.figure), None)
    shown = figure if figure is not None else node
    if isinstance(shown, nodes.math_block) and shown.get("label"):
        return nodes.make_id(f"equation-{shown['label']}")
    if not shown["ids"]:
        shown["ids"].append(f"shown-{number}")
    return shown["ids"][0]


def labelled(doctree):
    """Return the ID of each label of a page, by the label as authors write it."""
    ids = {}
    for node in doctree.findall(nodes.Element):
        for name in (*node.get("names", ()), *node.get("ids", ())):
            ids.setdefault(name, node["ids"][0] if node["ids"] else name)
        if isinstance(node, nodes.math_block) and node.get("label"):
            ids[node["label"]] = nodes.make_id(f"equation-{node['label']}")
    return ids


def unknown(label, node):
    fault = "a step of the lecture shows %s, which is not a label on this page"
    logger.warning(fault, label, location=where(node), type="website", subtype="lecture")
    return label


def heading_of(node):
    while node is not None and not isinstance(node, nodes.section):
        node = node.parent
    return node["ids"][0] if node is not None else ""


def marked(doctree):
    """Remove the marks from a page, and return their steps."""
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
            following = [block for block in around[place + 1 :] if isinstance(block, SHOWN)]
            shows = [name_of(block, number) for block in following[:1]]
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
    """Return steps for a page without marks: each section's figures or formula, by its heading."""
    steps = []
    for section in doctree.findall(nodes.section):
        if (title := next(section.findall(nodes.title), None)) is None:
            continue
        figures = [
            figure
            for block in section
            if not isinstance(block, nodes.section)
            for figure in block.findall(nodes.figure)
        ]
        formulas = [block for block in section if isinstance(block, nodes.math_block)]
        asked = [block for block in section if isinstance(block, question) and block["predicts"]]
        shown = [[figure] for figure in figures] or [[]]
        shown[0] += formulas[:1]
        for together in [*filter(None, shown), *([block] for block in asked)]:
            shows = [name_of(node, f"{len(steps)}-{place}") for place, node in enumerate(together)]
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
    """Give the page its steps, in a hidden template, and the script that shows them."""
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
