"""Decide which blocks of a page are laid out first, and which later.

Most of the work of opening a long page is the layout of blocks that nobody sees yet. The build
marks the blocks below the first view with the class ``later``. layout.html has the browser skip
them until they are near the screen, and book.js removes the marks, a few blocks at a time, as soon
as the first view is shown.
"""

import re

from docutils import nodes
from sphinx import addnodes

LATER = "later"
# The start of a block with this mark. The word alone also occurs in sentences.
MARKED = re.compile(rf'class="(?:[^"]* )?{LATER}(?: [^"]*)?"')
# More characters than the first view of a large screen can show, and the number that a large block
# counts for.
FIRST_VIEW, LARGEST = 3200, 800
# The characters of one line, which is the least that a block counts for.
LINE = 80
# Elements without a box of their own, or whose box cannot be left empty.
WITHOUT_BOX = (
    nodes.title,
    nodes.raw,
    nodes.target,
    nodes.comment,
    addnodes.index,
    nodes.section,
)


def blocks_of(doctree):
    """Iterate over the blocks in the sections of a page, in order."""
    for block in doctree.findall(nodes.Element):
        if isinstance(block.parent, nodes.section) and not isinstance(block, WITHOUT_BOX):
            yield block


def mark(app, doctree, docname):
    if app.builder.format != "html":
        return
    seen = 0
    for block in list(blocks_of(doctree)):
        if seen > FIRST_VIEW:
            if isinstance(block, nodes.table):
                # A table has to be laid out to know its size, a box around it does not.
                table, block = block, nodes.container()
                table.parent.replace(table, block)
                block.append(table)
            block["classes"].append(LATER)
        seen += max(LINE, min(LARGEST, len(block.astext())))


def first_part(body):
    """Return the HTML of a page up to the first block below the first view."""
    return MARKED.split(body, maxsplit=1)[0]


def setup(app):
    # Run this after every change to the page's content.
    app.connect("doctree-resolved", mark, priority=990)
