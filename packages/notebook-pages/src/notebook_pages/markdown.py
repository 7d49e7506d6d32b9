"""A resolved page of the book as plain Markdown, for Jupyter or any editor.

The page's tree is read after Sphinx has numbered and linked everything, so that a reference is
simply its text, such as "Figure 2.1", "Exercise 2.1" or "Moore"; a reference to another page is a
link if the book has an address. The output contains only markup that every Markdown reader knows.
"""

from textwrap import indent
from urllib.parse import urljoin

from docutils import nodes
from sphinx import addnodes

from . import questions

SILENT = (
    nodes.comment, nodes.target, nodes.raw, nodes.system_message, nodes.substitution_definition,
    addnodes.toctree, addnodes.index, addnodes.highlightlang,
)  # fmt: skip


def quote(text):
    return "\n".join(f"> {line}".rstrip() for line in text.splitlines())


class MarkdownWriter:
    """Turn the nodes of one page into Markdown."""

    def __init__(self, env, docname):
        self.figure_numbers = env.toc_fignumbers.get(docname, {})
        self.section_numbers = env.toc_secnumbers.get(docname, {})
        self.names = env.config.numfig_format
        base = env.config.html_baseurl
        self.address = f"{base.rstrip('/')}/{docname}.html" if base else ""
        self.pieces = []  # (is_cell, Markdown or the cell's node)
        self.answers = []  # replies to the questions of the page, written at its end

    # ---- what has a number -------------------------------------------------

    def digits(self, kind, node):
        """Return the number of ``node`` among those of its kind, such as "2.1", or ``None``."""
        numbers = self.figure_numbers.get(kind, {})
        numbers_of_node = [numbers[name] for name in node.get("ids", ()) if name in numbers]
        return ".".join(map(str, numbers_of_node[0])) if numbers_of_node else None

    def number(self, kind, node):
        digits = self.digits(kind, node)
        return self.names[kind] % digits if digits else ""

    def heading(self, node, level):
        section = node.parent
        number = self.section_numbers.get("#" + section["ids"][0]) if section["ids"] else None
        if number is None and level == 1:
            number = self.section_numbers.get("")
        digits = ".".join(map(str, number)) + ". " if number else ""
        return "#" * level + " " + digits + self.inline(node)

    # ---- inline ------------------------------------------------------------

    def inline(self, node):
        return "".join(map(self.inline_node, node.children)).strip()

    def inline_node(self, node):
        if isinstance(node, nodes.Text):
            return str(node).replace("\n", " ")
        if isinstance(node, nodes.math):
            return f"${node.astext().strip()}$"
        if isinstance(node, nodes.literal):
            ticks = "``" if "`" in node.astext() else "`"
            inner = all(isinstance(child, nodes.Text) for child in node.children)
            # A number that Sphinx marks up as code ("Exercise 2.1") is not code.
            is_reference = isinstance(node.parent, nodes.reference)
            return (
                ticks + node.astext() + ticks if inner and not is_reference else self.inline(node)
            )
        if isinstance(node, SILENT):
            return ""
        if isinstance(node, nodes.image):
            return f"[Picture: {node.get('alt', '')}]"
        text = self.inline(node)
        if isinstance(node, nodes.emphasis):
            return f"*{text}*"
        if isinstance(node, nodes.strong):
            return f"**{text}**"
        uri = node.get("refuri", "") if isinstance(node, nodes.reference) else ""
        if "://" in uri or uri and self.address:
            return f"[{text}]({urljoin(self.address, uri)})"
        if isinstance(node, nodes.footnote_reference):
            return f"[{text}]"
        # Leave the spaces at the edges of nested text as they are.
        return "".join(map(self.inline_node, node.children))

    # ---- blocks ------------------------------------------------------------

    def blocks(self, children, level=1):
        return "\n\n".join(filter(None, (self.block(child, level) for child in children)))

    def block(self, node, level):
        if isinstance(node, SILENT):
            return ""
        if isinstance(node, nodes.title):
            return self.heading(node, level)
        if isinstance(node, nodes.math_block):
            number = self.digits("displaymath", node)
            tag = f" \\tag{{{number}}}" if number else ""
            return f"$$\n{node.astext().strip()}{tag}\n$$"
        if isinstance(node, nodes.literal_block):
            language = node.get("language", "")
            return f"```{'' if language in ('none', 'default') else language}\n{node.astext()}\n```"
        if isinstance(node, (nodes.bullet_list, nodes.enumerated_list)):
            return self.list(node, level)
        if isinstance(node, nodes.definition_list_item):
            term = "**" + self.inline(node[0]) + "**"
            return term + "\n\n" + self.blocks(node[-1].children, level)
        if isinstance(node, nodes.table):
            return self.table(node)
        if isinstance(node, nodes.figure):
            return self.figure(node, level)
        if isinstance(node, nodes.block_quote):
            return quote(self.blocks(node.children, level))
        if isinstance(node, questions.question):
            return self.question(node, level)
        if isinstance(node, (nodes.Admonition, nodes.topic, nodes.sidebar)):
            return self.admonition(node, level)
        if isinstance(node, nodes.TextElement):
            return self.inline(node)
        if isinstance(node, nodes.image):
            return self.inline_node(node)
        return self.blocks(node.children, level)

    def list(self, node, level):
        items = []
        for position, item in enumerate(node.children, start=node.get("start", 1)):
            mark = f"{position}. " if isinstance(node, nodes.enumerated_list) else "- "
            body = indent(self.blocks(item.children, level), " " * len(mark))
            items.append(mark + body.lstrip(" "))
        return "\n".join(items) if all("\n\n" not in item for item in items) else "\n\n".join(items)

    def table(self, node):
        rows = [
            "| " + " | ".join(self.cell_text(entry) for entry in row.children) + " |"
            for row in node.findall(nodes.row)
        ]
        columns = len(next(node.findall(nodes.row)).children)
        rows.insert(1, "|" + " --- |" * columns)
        titles = [
            f"**{self.number('table', node)}** " + self.inline(t)
            for t in node
            if isinstance(t, nodes.title)
        ]
        return "\n\n".join([*titles, "\n".join(rows)])

    def cell_text(self, entry):
        return self.blocks(entry.children).replace("\n", " ").replace("|", "\\|")

    def figure(self, node, level):
        parts = []
        for child in node.children:
            if isinstance(child, nodes.caption):
                number = self.number("figure", node)
                parts.append(
                    f"**{number}.** {self.inline(child)}" if number else self.inline(child)
                )
            else:
                parts.append(self.block(child, level))
        return "\n\n".join(filter(None, parts))

    def admonition(self, node, level):
        children = list(node.children)
        title = type(node).__name__.capitalize()
        if children and isinstance(children[0], nodes.title):
            title = self.inline(children.pop(0))
        title = (self.number("exercise", node) + " " + title).strip()
        return quote(f"**{title}**\n\n{self.blocks(children, level)}".strip())

    def question(self, node, level):
        """Write a question with its choices; the replies are kept for the end of the page."""
        name = questions.name_of(node)
        title = f"Predict, then see ({node['place']})" if node["predicts"] else f"{name}."
        parts, replies = [f"**{title}**"], []
        for child in node.children:
            if isinstance(child, questions.choice_list):
                choices = [
                    f"- **{choice['letter']}.** {self.blocks(choice.children)}"
                    for choice in child.children
                ]
                parts.append("\n".join(choices))
            elif isinstance(child, questions.reply_list):
                for reply in child.children:
                    verdict = "right" if reply["right"] else "not so"
                    body = indent(self.blocks(reply.children), "  ").lstrip()
                    replies.append(f"- **{reply['name']}**, {verdict}: {body}")
            else:
                parts.append(self.block(child, level))
        self.answers.append("\n\n".join([f"**{name}.**", "\n".join(replies)]))
        text = "\n\n".join(filter(None, parts))
        return quote(text) if node["predicts"] else text

    # ---- the page ----------------------------------------------------------

    def page(self, document):
        """Return the page as a list of ``(is_cell, text or node)``, in order."""
        self.walk(document, 0)
        if self.answers:
            self.say("\n\n".join(["## Answers to the predictions and the recap", *self.answers]))
        return self.pieces

    def say(self, text):
        if text:
            self.pieces.append((False, text))

    def walk(self, node, level):
        for child in node.children:
            if isinstance(child, nodes.section):
                self.walk(child, level + 1)
            elif isinstance(child, nodes.container) and child.get("nb_element") == "cell_code":
                self.pieces.append((True, child))
                for figure in child.findall(nodes.figure):
                    self.say(self.figure_caption(figure))
            elif any(c.get("nb_element") == "cell_code" for c in child.findall(nodes.container)):
                if isinstance(child, nodes.Admonition):
                    title = self.admonition(type(child)("", *child.children[:1]), level)
                    self.say(title)
                    self.walk(type(child)("", *child.children[1:]), level)
                else:
                    self.walk(child, level)
            else:
                self.say(self.block(child, max(level, 1)))

    def figure_caption(self, figure):
        captions = nodes.figure(
            "", *[c for c in figure.children if isinstance(c, (nodes.caption, nodes.legend))]
        )
        captions["ids"] = figure["ids"]
        return self.figure(captions, 1)
