"""The directive ``subject-index``: the pages about each term, symbol and function.

Authors mark nothing for it. Terms are those of the glossary, found where the text refers to them or
else where it mentions them. Symbols are the rows of the notation page. Functions are those of the
reference, found where code or text names them.
"""

import re
from collections import defaultdict

from docutils import nodes
from sphinx import addnodes
from sphinx.util.docutils import SphinxDirective

from .publish import in_order

GLOSSARY, NOTATION = "appendix/glossary", "appendix/notation"
REFERENCE = ("appendix/reference", "appendix/reference-going-further")
# Pages that mention everything.
NOT_LISTED = (GLOSSARY, NOTATION, *REFERENCE, "index")
# The most pages listed for a term that is mentioned but never referred to.
MOST = 6


class subject_index(nodes.General, nodes.Element):
    """A placeholder on its page until all pages have been read."""


class SubjectIndex(SphinxDirective):
    def run(self):
        self.env.metadata[self.env.docname]["shows subjects"] = True
        return [subject_index()]


def section_of(node):
    """Return the name of the section that contains ``node``."""
    # The text of an exercise is a section whose name is removed later, so use the section around
    # it.
    unnamed = ([], ["exercise-content"], ["solution-content"])
    while node is not None and not (isinstance(node, nodes.section) and node["ids"] not in unnamed):
        node = node.parent
    return node["ids"][0] if node is not None else ""


def note_uses(app, doctree):
    """Record the first section of a page that refers to each term and that names each function."""
    terms, names, words = {}, {}, {}
    for reference in doctree.findall(addnodes.pending_xref):
        if reference.get("reftype") == "term":
            terms.setdefault(reference["reftarget"].casefold(), section_of(reference))
    for code in doctree.findall(
        lambda node: isinstance(node, (nodes.literal, nodes.literal_block))
    ):
        for name in re.findall(r"[A-Za-z_]\w+", code.astext()):
            names.setdefault(name, section_of(code))
    for text in doctree.findall(lambda node: isinstance(node, (nodes.paragraph, nodes.title))):
        section = section_of(text)
        words[section] = f"{words.get(section, '')} {text.astext().casefold()}"
    app.env.metadata[app.env.docname]["subjects"] = (terms, names, words)


def pages_mentioning(app, order, term):
    """Return the pages of ``order`` that mention ``term``, each with the first such section."""
    stem = re.escape(term.casefold().removesuffix("s"))
    pattern = re.compile(rf"(?<!\w){stem}s?(?!\w)")
    mentions = []
    for page in order:
        sections = app.env.metadata[page]["subjects"][2].items()
        mentions += [(page, section) for section, words in sections if pattern.search(words)][:1]
    return mentions[:MOST]


def write_anew(app, env):
    """Write the page again, because it depends on all others."""
    return [page for page, facts in env.metadata.items() if "shows subjects" in facts]


def link(app, page, target, anchor, words):
    address = app.builder.get_relative_uri(page, target) + (f"#{anchor}" if anchor else "")
    return nodes.reference("", "", *words, internal=True, refuri=address)


def places(app, page, uses):
    """Return the links to the places of ``uses``, pages with sections, in the book's order."""
    made = []
    for target, section in uses:
        made += [
            nodes.Text(", "),
            link(app, page, target, section, [nodes.Text(app.env.titles[target].astext())]),
        ]
    return made[1:]


def entry(app, page, name, main, uses, formula=None):
    """Return one line: a name that links to its explanation, and the other places that use it."""
    paragraph = nodes.paragraph(
        "", "", *([formula, nodes.Text(" ")] if formula else []), link(app, page, *main, name)
    )
    if uses:
        paragraph += [nodes.Text(": "), *places(app, page, uses)]
    return nodes.list_item("", paragraph)


def terms(app):
    """Return the terms of the glossary as they are written, with their anchors."""
    return {
        written: anchor
        for (kind, written), (page, anchor) in app.env.domains["std"].objects.items()
        if kind == "term" and page == GLOSSARY
    }


def functions(app):
    """Return the entries of the reference by their short names, with their pages and anchors."""
    return {
        name.rpartition(".")[2]: (entry.docname, entry.node_id)
        for name, entry in app.env.domains["py"].objects.items()
        if entry.docname in REFERENCE
        and entry.objtype in ("function", "class", "exception", "data")
    }


def symbols(app):
    """Return the rows of the notation page that begin with a name and a formula, both as nodes."""
    doctree = app.env.get_doctree(NOTATION)
    for row in doctree.findall(nodes.row):
        cells = list(row.findall(nodes.entry))
        formula = next(
            (cell.next_node(nodes.math) for cell in cells[1:2] if cell.next_node(nodes.math)), None
        )
        if formula is not None:
            name = [
                node.deepcopy() if isinstance(node, nodes.math) else nodes.Text(node.astext())
                for node in cells[0].next_node(nodes.paragraph)
            ]
            yield name, formula, section_of(row)


def fill(app, doctree, docname):
    for stand_in in list(doctree.findall(subject_index)):
        order = [name for name in in_order(app.env) if name not in NOT_LISTED]
        uses = defaultdict(list)
        for page in order:
            if page == docname:
                continue
            for kind, glossary in zip(("term", "name"), app.env.metadata[page]["subjects"]):
                for name, section in glossary.items():
                    uses[kind, name].append((page, section))
        texts = [page for page in order if page.startswith("chapters/")]
        made = []

        def part(title, items):
            section = nodes.section(ids=[nodes.make_id(title)], names=[])
            section += [
                nodes.title("", title),
                nodes.bullet_list("", *items, classes=["subject-index"]),
            ]
            made.append(section)

        glossary = sorted(terms(app).items(), key=lambda item: item[0].casefold())
        part(
            "Terms",
            [
                entry(
                    app,
                    docname,
                    [nodes.Text(name)],
                    (GLOSSARY, anchor),
                    uses["term", key] or pages_mentioning(app, texts, name),
                )
                for name, anchor in glossary
                for key in [name.casefold()]
            ],
        )
        part("Symbols", [
            # Use a link of words, which screen readers read.
            entry(app, docname, name, (NOTATION, section), [], formula.deepcopy())
            for name, formula, section in symbols(app)
        ])  # fmt: skip
        part("Functions and classes", [
            entry(app, docname, [nodes.literal("", name)], place, uses["name", name])
            for name, place in sorted(functions(app).items(), key=lambda item: item[0].casefold())
        ])  # fmt: skip
        stand_in.replace_self(made)


def setup(app):
    app.add_node(subject_index)
    app.add_directive("subject-index", SubjectIndex)
    app.connect("doctree-read", note_uses)
    app.connect("env-updated", write_anew)
    app.connect("doctree-resolved", fill)
