"""The directive ``cells-that-need-more``: the cells that need more than SymPy, by page, and why."""

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective

from .cells import kinds_of_cells, on_the_page

SOURCES = {
    "official": "Here NumPy and Matplotlib are fetched from `cdn.jsdelivr.net` when a cell needs "
    "them.",
    "off": "This site does not offer NumPy and Matplotlib: those cells keep their printed results.",
    "folder": "Here NumPy and Matplotlib come from the same server as the pages.",
}


def asks_nobody(kind):
    """Check whether a cell runs with the packages of this site, as that of a moving figure does."""
    return set(kind["needs"]) <= {"anywidget"}


class NeedsMore(SphinxDirective):
    def run(self):
        cells = kinds_of_cells()
        pages = {
            page: on_the_page(cells[page])
            for page in self.config.external_site_map
            if page in cells
        }
        lacking = {
            page: [str(number) for number, kind in enumerate(kinds, 1) if not asks_nobody(kind)]
            for page, kinds in pages.items()
        }
        count, more = sum(map(len, pages.values())), sum(map(len, lacking.values()))
        setting = self.config.numpy_in_the_page or "off"
        lines = [
            SOURCES.get(setting, SOURCES["folder"]),
            f"Of {count} cells, {count - more} ({int(100 * (count - more) / count)} per cent) run "
            "in the page without any other server. The table lists the others, by their numbers "
            "from the top of each page. A cell that uses a name defined in one of them needs the "
            "same packages.",
            "",
            "| page | cells | that need more |",
            "|---|---|---|",
            *(
                f"| {{doc}}`/{page}` | {len(pages[page])} | {', '.join(numbers)} |"
                for page, numbers in lacking.items()
                if numbers
            ),
        ]
        # The needs of a cell depend on our packages, too.
        self.env.note_reread()
        container = nodes.Element()
        self.state.nested_parse(StringList(lines, self.env.docname), self.content_offset, container)
        return container.children
