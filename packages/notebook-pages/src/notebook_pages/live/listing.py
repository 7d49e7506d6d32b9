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
WIDGET = "hold a moving figure"
COLUMNS = (WIDGET, "draw with Matplotlib", "compute with NumPy", "need SciPy")


def column(kind):
    if "scipy" in kind["needs"]:
        return "need SciPy"
    if set(kind["needs"]) & {"numpy", "matplotlib"}:
        return (
            "draw with Matplotlib"
            if kind["needs"] == ["matplotlib"] or kind["figure"]
            else "compute with NumPy"
        )
    return WIDGET


def asks_nobody(kind):
    """Check whether a cell runs with the packages of this site, as that of a moving figure does."""
    return set(kind["needs"]) <= {"anywidget"}


def row(page, kinds):
    cells = {name: [] for name in COLUMNS}
    for number, kind in enumerate(kinds, start=1):
        if kind["needs"]:
            cells[column(kind)].append(str(number))
    numbers = " | ".join(", ".join(cells[name]) for name in COLUMNS)
    return (
        f"| {{doc}}`/{page}` | {sum(map(asks_nobody, kinds))}\u00a0of\u00a0{len(kinds)} | "
        f"{numbers} |"
    )


class NeedsMore(SphinxDirective):
    def run(self):
        order = list(self.config.external_site_map)
        pages = {
            page: on_the_page(kinds) for page, kinds in kinds_of_cells().items() if page in order
        }
        setting = self.config.numpy_in_the_page or "off"
        every = [kind for kinds in pages.values() for kind in kinds]
        alone = sum(map(asks_nobody, every))
        some = [page for page, kinds in pages.items() if any(kind["needs"] for kind in kinds)]
        lines = [
            SOURCES.get(setting, SOURCES["folder"]),
            f"Of {len(every)} cells, {alone} ({int(100 * alone / len(every))} per cent) run in the "
            "page without any other server. "
            "Pages that need nothing but SymPy and this book's own packages: "
            f"{len(pages) - len(some)} of {len(pages)}. "
            "The table lists the cells that need more, by their numbers from the top of each page. "
            "A cell that uses a name defined in one of them needs the same packages. "
            "The packages for moving figures are part of this site.",
            "",
            f"| page | run | {' | '.join(COLUMNS)} |",
            "|---|---|" + "---|" * len(COLUMNS),
            *(row(page, pages[page]) for page in sorted(some, key=order.index)),
        ]
        # The needs of a cell depend on our packages, too.
        self.env.note_reread()
        container = nodes.Element()
        self.state.nested_parse(StringList(lines, self.env.docname), self.content_offset, container)
        return container.children
