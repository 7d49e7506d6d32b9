"""Correct the HTML of other extensions where it would confuse a screen reader."""

from docutils import nodes
from myst_nb.sphinx_ import HideCodeCellNode
from sphinx.writers.html5 import HTML5Translator


def visit_hidden(translator, node):
    """Name a fold after its content; MyST-NB gives it another name."""
    classes = " ".join(["hide", *node["classes"]])
    translator.body.append(f'<details class="{classes}"><summary>{node["prompt_show"]}</summary>\n')


def depart_hidden(translator, node):
    translator.body.append("</details>\n")


def visit_citation(translator, node):
    """Write a plain box: docutils writes a list without items, and a withdrawn role."""
    translator.body.append(translator.starttag(node, "div", CLASS="citation"))


def depart_citation(translator, node):
    translator.body.append("</div>\n")


def visit_entry(translator, node):
    """Write the empty corner of a table as an ordinary cell, since it heads nothing."""
    HTML5Translator.visit_entry(translator, node)
    if not node.astext().strip() and translator.body[-1].startswith("<th"):
        translator.body[-1] = translator.body[-1].replace("<th", "<td", 1)
        translator.context[-1] = translator.context[-1].replace("</th>", "</td>")


def depart_entry(translator, node):
    HTML5Translator.depart_entry(translator, node)


def name_of_caption(node):
    """Return the ID of the element that names a figure with a caption.

    Browsers no longer take the name of a figure from its caption.
    """
    has_caption = any(isinstance(part, nodes.caption) for part in node)
    return f"{node['ids'][0]}-name" if has_caption and node["ids"] else None


def visit_figure(translator, node):
    HTML5Translator.visit_figure(translator, node)
    if name := name_of_caption(node):
        translator.body[-1] = translator.body[-1].replace(
            "<figure", f'<figure aria-labelledby="{name}"', 1
        )


def visit_caption(translator, node):
    """Name a figure by its number or, without one, by the words of its caption."""
    start = len(translator.body)
    HTML5Translator.visit_caption(translator, node)
    if isinstance(node.parent, nodes.figure) and (name := name_of_caption(node.parent)):
        written = "".join(translator.body[start:])
        translator.body[start:] = [
            written.replace('<span class="caption-', f'<span id="{name}" class="caption-', 1)
        ]


def setup(app):
    app.add_node(nodes.figure, override=True, html=(visit_figure, HTML5Translator.depart_figure))
    app.add_node(nodes.caption, override=True, html=(visit_caption, HTML5Translator.depart_caption))
    app.add_node(nodes.entry, override=True, html=(visit_entry, depart_entry))
    app.add_node(HideCodeCellNode, override=True, html=(visit_hidden, depart_hidden))
    app.add_node(nodes.citation, override=True, html=(visit_citation, depart_citation))
