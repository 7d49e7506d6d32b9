"""What a page shows first, and what comes later.

Most of the work of opening a long page is to lay out what nobody sees yet. The build marks the
blocks below the first view with the class ``later``; layout.html has the browser leave them alone
until they are near the screen, and book.js takes the marks off, a few blocks at a time, as soon as
the first view stands: then the page is what it always was.
"""

import re

from docutils import nodes
from sphinx import addnodes

LATER = "later"
#: The start of a block with this mark. The word alone also occurs in sentences.
MARKED = re.compile(rf'class="(?:[^"]* )?{LATER}(?: [^"]*)?"')
#: More characters than the first view of a large screen can show, and the number that a large block
#: counts for.
FIRST_VIEW, LARGEST = 3200, 800
#: The characters of one line, the least that a block counts for.
LINE = 80
#: Elements without a box of their own, or whose box cannot be left empty.
WITHOUT_BOX = (
    nodes.title,
    nodes.raw,
    nodes.target,
    nodes.comment,
    nodes.table,
    addnodes.index,
    nodes.section,
)


def blocks_of(doctree):
    """The blocks of a page, in their order: what stands in its sections."""
    for block in doctree.findall(nodes.Element):
        if isinstance(block.parent, nodes.section) and not isinstance(block, WITHOUT_BOX):
            yield block


def mark(app, doctree, docname):
    if app.builder.format != "html":
        return
    seen = 0
    for block in blocks_of(doctree):
        if seen > FIRST_VIEW:
            block["classes"].append(LATER)
        seen += max(LINE, min(LARGEST, len(block.astext())))


def first_part(body):
    """The HTML of a page up to the first block below the first view."""
    return MARKED.split(body, maxsplit=1)[0]


def setup(app):
    app.connect("doctree-resolved", mark, priority=990)  # after all that changes what a page holds
