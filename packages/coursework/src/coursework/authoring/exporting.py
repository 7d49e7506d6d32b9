"""Questions in the formats of other systems: Moodle XML, and a QTI 2.2 package.

Moodle gets a category for each question, with a question for each variant. An answer with several
entries becomes a cloze question, whose entries Moodle marks one by one. QTI gets an item for each
variant, which judges the whole answer, and a test that draws one variant of each question.
"""

from __future__ import annotations

import base64
import hashlib
import html
import re
import urllib.parse
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from markupsafe import Markup

from ..checking.mistakes import GENERAL
from ..checking.reply import mathml, to_html
from .author import to_page
from .packing import zipped
from .pages import ENVIRONMENT

#: A picture within a page, as authors' figures are stored.
EMBEDDED = re.compile(r'(?<=src=")data:image/(svg|png|jpe?g|gif)[^,"]*?(;base64)?,([^"]+)')
#: Elements without content, which XML closes.
VOID = re.compile(r"<(img|br|hr)\b([^>]*?)/?>")
#: Text that would be an entry of a cloze question.
CLOZE = re.compile(r"\{(?=\d*:)")
#: Characters with a meaning in the answers of a cloze question, as the importer decodes them.
SPECIAL = {ord(sign): f"&#{ord(sign)};" for sign in "{}~#=%"}
#: The most replies to one entry that anybody would read.
MOST_REPLIES = 2
#: Moodle compares one entry at a time, but a reply is to a whole answer.
PERHAPS = Markup("<p>If your other entries show the same mistake:</p>")


class Wrong(NamedTuple):
    """The answer that a mistake leads to, its note and share of the points, and the reply to it."""

    values: tuple[str, ...]
    note: str
    share: float
    reply: str


class Item(NamedTuple):
    """One variant of a question.

    Attributes
    ----------
    name : str
    number : int
        The number of the variant.
    worth : float
    text, solution : str
        As Markdown with embedded pictures.
    columns : int
        The number of entries in a row.
    options : tuple of str
        The words to choose from, if the answer consists of them.
    tolerances : tuple of float
        One for each number of the answer; empty if it consists of words.
    right : tuple of tuples of str
        The right answer, and its opposite if the question accepts both.
    wrong : list of Wrong
    """

    name: str
    number: int
    worth: float
    text: str
    solution: str
    columns: int
    options: tuple[str, ...]
    tolerances: tuple[float, ...]
    right: tuple[tuple[str, ...], ...]
    wrong: list[Wrong]

    @property
    def identifier(self) -> str:
        """A name that is a valid identifier in XML."""
        return re.sub(r"[^A-Za-z0-9_-]", ".", f"Q-{self.name}") + f".{self.number}"

    @property
    def heading(self) -> str:
        return f"{self.name}, variant {self.number}"

    @property
    def places(self) -> int:
        return len(self.right[0])

    def same(self, place: int, first: str, second: str) -> bool:
        """Check whether two values of an entry are the same answer."""
        if not self.tolerances:
            return first == second
        return abs(float(first) - float(second)) <= self.tolerances[place]


class Page(Markup):
    """HTML that is also XML, with pictures as separate files."""

    files: dict[str, bytes]

    @classmethod
    def of(cls, text: str, folder: str) -> Page:
        files: dict[str, bytes] = {}

        def as_file(match: re.Match[str]) -> str:
            kind, coded, content = match.groups()
            data = urllib.parse.unquote_to_bytes(content)
            data = base64.b64decode(data) if coded else data
            name = f"{hashlib.sha256(data).hexdigest()[:12]}.{kind}"
            files[name] = data
            return f"{folder}/{name}"

        page = cls(VOID.sub(r"<\1\2/>", EMBEDDED.sub(as_file, text)))
        page.files = files
        return page


class Answer(NamedTuple):
    """A value of one entry, its share of the entry's points, and the replies to it."""

    value: str
    share: float
    replies: list[str]

    @property
    def percent(self) -> str:
        return f"{100 * self.share:.7g}"

    @property
    def reply(self) -> Page:
        replies = (f"<p>{to_html(text, in_moodle)}</p>" for text in self.replies[:MOST_REPLIES])
        return Page.of("".join(replies), "@@PLUGINFILE@@")


def in_moodle(tex: str) -> str:
    """Return a formula for Moodle's filter. The importer drops the backslash before a brace."""
    tex = tex.replace(r"\{", r"\lbrace ").replace(r"\}", r"\rbrace ")
    return html.escape(rf"\({tex}\)", quote=False)


def answers(item: Item, place: int) -> list[Answer]:
    """Return an entry's known answers, the right one first; for words, all in the given order.

    Moodle takes the first answer that matches, so the mistakes that earn most come before the
    others.
    """
    known = [Answer(item.right[0][place], 1, [])]
    for wrong in sorted(item.wrong, key=lambda wrong: -wrong.share):
        if wrong.note in GENERAL and item.places > 1:
            # A mistake such as a factor of two in one entry says nothing about the others.
            continue
        value = wrong.values[place]
        same = next((answer for answer in known if item.same(place, answer.value, value)), None)
        if same is None:
            known.append(Answer(value, wrong.share, [wrong.reply]))
        elif same.share < 1:
            same.replies.append(wrong.reply)
    by_value = {answer.value: answer for answer in known}
    return [by_value.get(option, Answer(option, 0, [])) for option in item.options] or known


def cloze(kind: str, item: Item, place: int) -> Markup:
    """Return one entry of a cloze question, whose contents the importer decodes again."""

    def plain(text: str) -> str:
        # Convert to a plain string, since Markup would escape the replacements.
        return html.escape(str(text)).translate(SPECIAL)

    allowed = f":{item.tolerances[place]}" if item.tolerances else ""
    known = (
        f"{'=' if answer.share == 1 else f'%{answer.percent}%'}{plain(answer.value)}{allowed}"
        + (f"#{plain(PERHAPS + answer.reply)}" if answer.replies else "")
        for answer in answers(item, place)
    )
    return Markup("{{1:{}:{}}}".format(kind.upper(), "~".join(known)))


def moodle(title: str, questions: Mapping[str, Iterable[Item]]) -> bytes:
    """Return the file that Moodle imports."""

    def page(markdown: str) -> Page:
        return Page.of(CLOZE.sub("&#123;", to_page(markdown, in_moodle)), "@@PLUGINFILE@@")

    return (
        ENVIRONMENT.get_template("moodle.xml")
        .render(title=title, questions=questions, page=page, answers=answers, cloze=cloze)
        .encode()
    )


def qti(title: str, questions: Mapping[str, Iterable[Item]]) -> bytes:
    """Return the QTI package."""
    contents, files = dict[str, bytes](), dict[str, list[str]]()

    def add(place: str, template: str, **about: object) -> None:
        contents[place] = ENVIRONMENT.get_template(template).render(**about).encode()

    for item in (item for items in questions.values() for item in items):
        text, solution = (
            Page.of(to_page(markdown, mathml), "pictures")
            for markdown in (item.text, item.solution)
        )
        pictures = {
            f"pictures/{name}": data for name, data in (text.files | solution.files).items()
        }
        add(f"{item.identifier}.xml", "qti-item.xml", item=item, text=text, solution=solution)
        contents |= pictures
        files[item.identifier] = list(pictures)
    add("test.xml", "qti-test.xml", title=title, questions=questions)
    add("imsmanifest.xml", "imsmanifest.xml", files=files)
    return zipped(contents)
