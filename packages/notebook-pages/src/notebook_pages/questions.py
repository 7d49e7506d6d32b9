"""Questions that the reader answers on the page: predictions, and recaps of chapters.

The directive `predict` is one question; `recap` contains several, each a `question`. A question
ends with a definition list: each term is a choice, and its definition is the reply to readers who
choose it. The page as built is complete without a script, with the replies in a fold;
`questions.js` lets the reader commit to a choice first.
"""

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

from .paths import where

# The reply to a number that has no reply of its own.
ANY_OTHER = "anything else"
LETTERS = "ABCDEFGH"

logger = logging.getLogger(__name__)


class question(nodes.General, nodes.Element):
    """A question with its choices.

    Attributes: ``predicts``; ``place``, its number on the page; ``kind``, one of the options
    ``answer`` (a letter), ``number`` and ``angle`` (in degrees); ``answer``, the right answer;
    ``tolerance``; ``covers``, how many of the following blocks are covered until the reader has
    answered.
    """


class choice_list(nodes.General, nodes.Element):
    """The choices of a question; absent if the answer is a number."""


class choice(nodes.General, nodes.Element):
    """One choice; attribute: ``letter``."""


class reply_list(nodes.General, nodes.Element):
    """The replies, behind a fold."""


class reply(nodes.General, nodes.Element):
    """The reply to a choice; attributes: ``name`` (the letter, or the number), ``right``."""


class recap(nodes.Admonition, nodes.Element):
    """The questions at the end of a chapter."""


class QuestionDirective(SphinxDirective):
    has_content = True
    option_spec = {
        "label": directives.unchanged_required,
        "answer": directives.unchanged,
        "number": float,
        "angle": float,
        "tolerance": float,
        "covers": directives.nonnegative_int,
    }
    predicts = False

    def fault(self, words):
        logger.warning(
            "in a question: %s",
            words,
            location=self.get_source_info(),
            type="website",
            subtype="questions",
        )
        return []

    def run(self):
        box = question(predicts=self.predicts)
        self.set_source_info(box)
        if "label" not in self.options:
            return self.fault("it needs a `:label:`, under which the reader's answer is stored")
        box["ids"] = [nodes.make_id(self.options["label"])]
        self.state.nested_parse(self.content, self.content_offset, box)
        if not box.children or not isinstance(box[-1], nodes.definition_list):
            return self.fault("it must end with its choices, each followed by a line `: reply`")
        items = list(box.pop().children)
        kinds = [kind for kind in ("answer", "number", "angle") if kind in self.options]
        if len(kinds) != 1:
            return self.fault(
                "give the right answer as `:answer: B`, `:number: 0.5` or `:angle: 30`"
            )
        box["kind"], box["answer"] = kinds[0], self.options[kinds[0]]
        box["covers"] = self.options.get("covers", 0)
        if box["kind"] == "answer":
            names = list(LETTERS[: len(items)])
        else:
            names = [item[0].astext().strip() for item in items]
            box["tolerance"] = self.options.get("tolerance", 0.0)
            if ANY_OTHER not in names:
                return self.fault(
                    f"a question that asks for a number needs a last reply, for `{ANY_OTHER}`"
                )
        rights = [self.is_right(box, name) for name in names]
        if sum(rights) != 1:
            return self.fault(
                f"the right answer is {box['answer']}, but there are replies for {', '.join(names)}"
            )
        if box["kind"] == "answer":
            choices = choice_list()
            for name, item in zip(names, items, strict=True):
                choices += choice("", nodes.paragraph("", "", *item[0].children), letter=name)
            box += choices
        replies = reply_list()
        for name, item, right in zip(names, items, rights, strict=True):
            replies += reply("", *item[-1].children, name=name, right=right)
        box += replies
        return [box]

    @staticmethod
    def is_right(box, name):
        if box["kind"] == "answer":
            return name == box["answer"]
        return name != ANY_OTHER and abs(float(name) - box["answer"]) <= box["tolerance"]


class PredictDirective(QuestionDirective):
    predicts = True


class RecapDirective(SphinxDirective):
    has_content = True

    def run(self):
        box = recap(classes=["recap"])
        self.set_source_info(box)
        box += nodes.title("", "Recap")
        self.state.nested_parse(self.content, self.content_offset, box)
        return [box]


def number_questions(app, doctree):
    """Number the predictions of a page and the questions of its recap, each from 1."""
    counts = {True: 0, False: 0}
    labels = set()
    for box in doctree.findall(question):
        counts[box["predicts"]] += 1
        box["place"] = counts[box["predicts"]]
        (label,) = box["ids"]
        if label in labels:
            logger.warning(
                "two questions have the label %s",
                label,
                location=where(box),
                type="website",
                subtype="questions",
            )
        labels.add(label)


def name_of(box):
    """Return the name of a question on its page."""
    return f"Prediction {box['place']}" if box["predicts"] else f"Question {box['place']}"


def visit_question(translator, node):
    attributes = {
        "data-kind": node["kind"],
        "data-answer": f"{node['answer']}",
        "data-covers": f"{node['covers']}",
    }
    if "tolerance" in node:
        attributes["data-tolerance"] = f"{node['tolerance']}"
    classes = "question admonition predict" if node["predicts"] else "question"
    translator.body.append(translator.starttag(node, "div", CLASS=classes, **attributes))
    if node["predicts"]:
        translator.body.append(
            f'<p class="admonition-title">Predict, then see ({node["place"]})</p>\n'
        )
    else:
        translator.body.append(f'<p class="question-name">Question {node["place"]}</p>\n')


def visit_choice_list(translator, node):
    translator.body.append('<ol class="choices" type="A">\n')


def visit_choice(translator, node):
    translator.body.append(f'<li data-name="{node["letter"]}">')


def visit_reply_list(translator, node):
    translator.body.append('<details class="replies"><summary>The answer</summary>\n<ul>\n')


def visit_reply(translator, node):
    name = translator.encode(node["name"])
    right = ' class="right"' if node["right"] else ""
    words = "right" if node["right"] else "not so"
    capital = name[0].upper() + name[1:]
    translator.body.append(
        f'<li data-name="{name}"{right}><p class="verdict"><strong>{capital}</strong>: '
        f"{words}.</p>\n<div>"
    )


def visit_recap(translator, node):
    translator.body.append(translator.starttag(node, "div", CLASS="admonition"))


def closing(*tags):
    text = "".join(f"</{tag}>" for tag in tags) + "\n"
    return lambda translator, node: translator.body.append(text)


def add_script(app, pagename, templatename, context, doctree):
    if doctree is not None and next(doctree.findall(question), None):
        app.add_js_file("questions.js", loading_method="defer")


def setup(app):
    app.add_directive("predict", PredictDirective)
    app.add_directive("recap", RecapDirective)
    app.add_directive("question", QuestionDirective)
    app.add_node(question, html=(visit_question, closing("div")))
    app.add_node(choice_list, html=(visit_choice_list, closing("ol")))
    app.add_node(choice, html=(visit_choice, closing("li")))
    app.add_node(reply_list, html=(visit_reply_list, closing("ul", "details")))
    app.add_node(reply, html=(visit_reply, closing("div", "li")))
    app.add_node(recap, html=(visit_recap, closing("div")))
    app.connect("doctree-read", number_questions)
    app.connect("html-page-context", add_script)
