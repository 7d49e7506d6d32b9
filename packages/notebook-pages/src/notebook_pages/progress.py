"""The page *My progress*: the tasks of each chapter, filled in by the reader's own browser.

The build counts the tasks. `progress.js` stores what the reader has done, and `my-progress.js`
shows it. Without a script, the page still lists what to read, predict, answer and solve.
"""

import re
from html import escape
from pathlib import Path

import nbformat
from docutils import nodes
from sphinx.util.docutils import SphinxDirective
from sphinx_exercise.nodes import exercise_enumerable_node, exercise_node

from .live import cells_with_code
from .paths import parts
from .questions import question

CHECK = re.compile(r"^check\(\s*[\"']([^\"']+)", re.MULTILINE)
# The columns in order: what each counts, its heading, and the explanation below the table.
COLUMNS = {
    "read": "Sections read",
    "predictions": "Predictions",
    "recap": "Recap",
    "done": "Exercises",
    "checked": "Checked questions",
}


class progress_table(nodes.General, nodes.Element):
    """The table of all chapters."""


class ProgressDirective(SphinxDirective):
    def run(self):
        self.env.metadata[self.env.docname]["shows progress"] = True
        return [progress_table()]


def questions_in(notebook):
    """Return the names of the questions that the notebook at this path passes to the checker."""
    if not notebook.is_file():
        return []
    cells = nbformat.read(notebook, as_version=4).cells
    return [
        name for cell in cells if cell.cell_type == "code" for name in CHECK.findall(cell.source)
    ]


def companion(page):
    """Return the notebook of sealed questions that belongs to a chapter."""
    return Path("exercises") / f"{Path(page).name}.ipynb"


def count(app, doctree):
    """Record the tasks of a page: names by column, as `progress.js` stores them."""
    page = app.env.docname
    whole = next(doctree.findall(nodes.section), [])
    sections = [section for section in whole if isinstance(section, nodes.section)]
    boxes = list(doctree.findall(question))
    exercises = [
        node
        for node in doctree.findall()
        if isinstance(node, (exercise_node, exercise_enumerable_node))
    ]
    app.env.metadata[page]["to do"] = {
        "read": [section["ids"][0] for section in sections],
        "predictions": [box["ids"][0] for box in boxes if box["predicts"]],
        "recap": [box["ids"][0] for box in boxes if not box["predicts"]],
        "done": [exercise["ids"][0] for exercise in exercises if exercise["ids"]],
        "checked": questions_in(Path(f"{page}.ipynb")),
    }


def chapters(env):
    """Return the chapters of the book, which are the numbered pages, in the contents' order."""
    return [
        page for _, pages in parts() for page in pages if env.toc_secnumbers.get(page, {}).get("")
    ]


def visit_table(translator, node):
    env = translator.builder.env
    here = translator.builder.current_docname
    rows = []
    for page in chapters(env):
        tasks = dict(env.metadata[page]["to do"])
        tasks["checked"] = tasks["checked"] + questions_in(companion(page))
        number = env.toc_secnumbers[page][""][0]
        address = translator.builder.get_relative_uri(here, page)
        cells = "".join(
            f'<td data-kind="{kind}" data-heading="{heading}" '
            f'data-names="{escape(" ".join(tasks[kind]), quote=True)}">'
            f"{len(tasks[kind]) or '–'}</td>"
            for kind, heading in COLUMNS.items()
        )
        title = escape(env.titles[page].astext())
        companions = f' data-companion="{companion(page).with_suffix("")}"'
        rows.append(
            f'<tr data-page="{page}"{companions}>'
            f'<th scope="row">{number}. <a href="{address}">{title}</a></th>{cells}</tr>'
        )
    heads = "".join(f'<th scope="col">{heading}</th>' for heading in COLUMNS.values())
    translator.body.append(
        '<div class="pst-scrollable-table-container" tabindex="0" role="group" '
        'aria-label="Progress by chapter">'
        '<table class="table my-progress"><thead><tr><th '
        f'scope="col">Chapter</th>{heads}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>\n"
    )
    raise nodes.SkipNode


def write_again(app, env):
    """Write the page with the table at every build, because it counts tasks on other pages."""
    return [page for page, facts in env.metadata.items() if "shows progress" in facts]


def add_scripts(app, pagename, templatename, context, doctree):
    if doctree is None:
        return
    has_table = next(doctree.findall(progress_table), None) is not None
    is_notebook = (
        str(app.env.doc2path(pagename)).endswith(".ipynb") and pagename != app.config.root_doc
    )
    if has_table or is_notebook or cells_with_code(doctree):
        # This script must come before those that use it.
        app.add_js_file("progress.js", loading_method="defer", priority=400)
    if has_table:
        app.add_js_file("my-progress.js", loading_method="defer")


def setup(app):
    app.add_directive("progress", ProgressDirective)
    app.add_node(progress_table, html=(visit_table, None))
    app.connect("doctree-read", count)
    app.connect("env-updated", write_again)
    app.connect("html-page-context", add_scripts)
