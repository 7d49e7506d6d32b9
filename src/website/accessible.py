"""Corrections of what other extensions write, where a screen reader would stumble."""

from docutils import nodes
from myst_nb.sphinx_ import HideCodeCellNode


def visit_hidden(translator, node):
    """A fold whose name is what it shows; MyST-NB gives it another name."""
    classes = " ".join(["hide", *node["classes"]])
    translator.body.append(f'<details class="{classes}"><summary>{node["prompt_show"]}</summary>\n')


def depart_hidden(translator, node):
    translator.body.append("</details>\n")


def visit_citation(translator, node):
    """A plain box: docutils writes a list without items, and a withdrawn role."""
    translator.body.append(translator.starttag(node, "div", CLASS="citation"))


def depart_citation(translator, node):
    translator.body.append("</div>\n")


def setup(app):
    app.add_node(HideCodeCellNode, override=True, html=(visit_hidden, depart_hidden))
    app.add_node(nodes.citation, override=True, html=(visit_citation, depart_citation))
