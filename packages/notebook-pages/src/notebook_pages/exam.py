"""The exam edition: the book without worked solutions, and without sentences that lead to one.

``exam_edition: true`` in ``_config.yml`` makes it, or BOOK_EXAM=1 for one build. The contents leave
out the pages of solutions (see `notebook_pages.paths`), so that nothing is made of them. This
module removes the sentences that refer to them.
"""

import re

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.config import Config

from .paths import exam_edition, is_solutions

# The space between two sentences of a paragraph.
BETWEEN = re.compile(r"(?<=[.!?])\s+")
# The label of a worked solution begins like this; the label of a page of solutions matches it
# completely.
LABEL = re.compile(r"solutions?(?:-|$)")


def leads_to_solution(node: nodes.Node) -> bool:
    """Check whether ``node`` refers to a worked solution, or to a page of them."""
    if not isinstance(node, addnodes.pending_xref):
        return False
    target = node["reftarget"]
    return is_solutions(target) if node["reftype"] == "doc" else LABEL.match(target) is not None


def sentences(paragraph: nodes.paragraph) -> list[list[nodes.Node]]:
    """Return the children of ``paragraph`` by sentence, with text nodes split between sentences."""
    by_sentence: list[list[nodes.Node]] = [[]]
    for child in paragraph.children:
        if not isinstance(child, nodes.Text):
            by_sentence[-1].append(child)
            continue
        for place, piece in enumerate(BETWEEN.split(child.astext())):
            if place:
                by_sentence.append([])
            if piece:
                by_sentence[-1].append(nodes.Text(piece))
    return [sentence for sentence in by_sentence if sentence]


def without_solutions(paragraph: nodes.paragraph) -> None:
    """Remove the sentences that lead to a solution from ``paragraph``, or all if none remains."""
    remaining = [
        sentence
        for sentence in sentences(paragraph)
        if not any(leads_to_solution(node) for child in sentence for node in child.findall())
    ]
    if not remaining:
        paragraph.parent.remove(paragraph)
        return
    paragraph.clear()
    for place, sentence in enumerate(remaining):
        paragraph += [*([nodes.Text(" ")] if place else []), *sentence]


def strip(app: Sphinx, doctree: nodes.document) -> None:
    """Remove everything that leads to a solution from a page."""
    for paragraph in list(doctree.findall(nodes.paragraph)):
        if any(leads_to_solution(node) for node in paragraph.findall()):
            without_solutions(paragraph)


def begin(app: Sphinx, config: Config) -> None:
    if exam_edition():
        # Run this before other extensions record the references of a page.
        app.connect("doctree-read", strip, priority=100)


def setup(app: Sphinx) -> None:
    app.add_config_value("exam_edition", False, "env", bool)
    app.connect("config-inited", begin)
