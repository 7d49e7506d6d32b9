"""The reply that a student sees after a check."""

import html
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from .fields import Json
from .question import KnownAnswer, Locker
from .reading import Reading

# Each outcome with its sign, its word and its colour: the word is for those who do not see the sign
# or its colour.
OUTCOMES = {
    "correct": ("✓", "Correct", "#1a7f37"),
    "wrong": ("✗", "Not yet", "#b54708"),
    "invalid": ("!", "Wrong form", "#b54708"),
    "undecided": ("?", "Undecided", "#5b5fc7"),
    "hints": ("→", "So far", "#6b7280"),
    "recorded": ("→", "Recorded", "#5b5fc7"),
    "not attempted": ("…", "Not attempted", "#6b7280"),
}


# The words for each kind of help, from little to much.
HELP = {
    "mistake": "we named your mistake",
    "hint": "we showed a hint",
    "solution": "we showed the worked solution",
}


class Shown(NamedTuple):
    """An answer as it was read.

    Attributes
    ----------
    tex : str
        Empty if it is shown as text only.
    text : str
    picture : str
        HTML for an orientation; empty for other answers.
    """

    tex: str
    text: str
    picture: str = ""

    def as_html(self, formula: Callable[[str], str] = lambda source: _as_tex(source)) -> str:
        written = formula(self.tex) if self.tex else f"<code>{html.escape(self.text)}</code>"
        return f'<div style="margin:.3em 0;overflow-x:auto">We read: {written}</div>{self.picture}'


class Reply:
    """The outcome of a check, shown as HTML in a notebook and as text elsewhere.

    Attributes
    ----------
    question : str
    outcome : str
        A key of `OUTCOMES`.
    note : str
        The mistake, or what is wrong with the form, in a few words; empty if there is none.
    messages : list of str
        Paragraphs, with ``code``, *emphasis* and $formulas$ as in Markdown.
    solution : str
        HTML of the worked solution, once it is earned.
    answer : str
        A hash that all ways of writing this answer share.
    tries : int
        The number of different answers in the record beside the notebook; 0 without one.
    help : str
        The help that the student had before the right answer, a key of `HELP`; empty without any.
    details : dict
        The data for the message about the mistake.
    sibling : str
        The sibling of the question for practice after help; empty if there is none.
    opened : Locker or None
        What else the answer opened: the place of the worked solution, hints for other questions.
    shown : Shown or None
        The answer as it was read.
    known : KnownAnswer or None
        The known mistake that it is, with its hints.
    reading : Reading or None
        The answer's numbers; ``None`` if it has none.
    """

    def __init__(
        self,
        question: str,
        outcome: str,
        note: str = "",
        messages: Iterable[str] = (),
        solution: str = "",
        opened: Locker | None = None,
        known: KnownAnswer | None = None,
        details: Mapping[str, Json] | None = None,
    ) -> None:
        self.question = question
        self.outcome = outcome
        self.note = note
        self.messages = list(messages)
        self.solution = solution
        self.answer = ""
        self.tries = 0
        self.help = ""
        self.sibling = ""
        self.details = details or {}
        self.shown: Shown | None = None
        self.opened, self.known = opened, known
        self.reading: Reading | None = None

    def __bool__(self) -> bool:
        """Return whether nothing is wrong, so that ``assert check(...)`` means what it says."""
        return self.outcome in ("correct", "recorded")

    def __repr__(self) -> str:
        _, word, _ = OUTCOMES[self.outcome]
        lines = [f"{word}: {self.question}", *map(plain_text, self.messages)]
        if self.shown:
            lines.append(f"We read: {self.shown.text}")
        if self.solution:
            lines.append("A worked solution comes with this reply, in the notebook or on the page.")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        sign, word, colour = OUTCOMES[self.outcome]
        name = html.escape(self.question)
        tries = f" · {self.tries} answers so far" if self.tries > 1 else ""
        # The notebook's record of the way to this answer, which the grader reads.
        known = f' data-question="{name}" data-tries="{self.tries}"' if self.tries else ""
        known += f' data-help="{self.help}"' if self.help else ""
        # The book's pages turn it into a button.
        known += f' data-sibling="{html.escape(self.sibling)}"' if self.sibling else ""
        formula = {} if tex_is_typeset() else {"formula": mathml}
        paragraphs = "".join(
            f'<p style="margin:.3em 0">{to_html(message, **formula)}</p>'
            for message in self.messages
        )
        shown = self.shown.as_html(**formula) if self.shown else ""
        solution = (
            "<details><summary>The worked "
            f"solution</summary><div>{for_this_front_end(self.solution)}</div></details>"
            if self.solution
            else ""
        )
        return (
            f'<div class="coursework-reply" role="status" data-outcome="{self.outcome}"{known} '
            f'style="border-left:.3em solid {colour};padding:.2em .8em">'
            f'<p style="margin:.3em 0"><strong><span aria-hidden="true">{sign}</span> '
            f"{word}</strong> "
            f'<span style="opacity:.8">{name}{tries}</span></p>{paragraphs}{shown}{solution}</div>'
        )


# --- formulas -----------------------------------------------------------------------------------


def tex_is_typeset() -> bool:
    """Check whether the front end typesets TeX in HTML, which VS Code, Colab and marimo do not."""
    return not ("VSCODE_PID" in os.environ or {"google.colab", "marimo"} & set(sys.modules))


def mathml(source: str, display: str = "inline") -> str:
    """Return a formula as MathML, which every browser can show, or else as TeX in a box.

    >>> mathml("x_1")[:40], "TeX" in mathml("x_1")
    ('<math xmlns="http://www.w3.org/1998/Math', False)
    """
    try:
        from latex2mathml.converter import convert

        return str(convert(source, display=display))
    except Exception:
        # There is no converter, or it lacks a command, which must not prevent a reply.
        return f"<code>{html.escape(source)}</code>"


def for_this_front_end(page: str) -> str:
    """Return the HTML of a worked solution, with formulas that this front end can show."""
    if tex_is_typeset():
        return page
    blocks = re.sub(
        r"\$\$([^$]+)\$\$", lambda match: mathml(html.unescape(match[1]), "block"), page
    )
    return re.sub(r"\$([^$]+)\$", lambda match: mathml(html.unescape(match[1])), blocks)


def _as_tex(source: str) -> str:
    return f'<span class="math">${html.escape(source)}$</span>'


# Code, formulas and emphasis, each between two marks; a single mark is text.
MARKED = re.compile(r"`([^`]+)`|\$([^$]+)\$|(?<![\w)])\*([^*\s][^*]*)\*(?!\w)")


def to_html(
    message: str,
    formula: Callable[[str], str] = lambda source: _as_tex(source),
) -> str:
    """Convert a message to HTML; everything that a student wrote is escaped.

    Parameters
    ----------
    message : str
    formula : function, optional
        The HTML of a formula, from its TeX; without it the TeX itself, for a page that typesets it.

    >>> to_html('*Not* `<x>`, but *theta is odd')
    '<em>Not</em> <code>&lt;x&gt;</code>, but *theta is odd'
    """
    pieces, place = [], 0
    for match in MARKED.finditer(message):
        code, source, stressed = match.groups()
        pieces.append(html.escape(message[place : match.start()]))
        if code is not None:
            pieces.append(f"<code>{html.escape(code)}</code>")
        elif source is not None:
            pieces.append(formula(source))
        else:
            pieces.append(f"<em>{html.escape(stressed)}</em>")
        place = match.end()
    return "".join([*pieces, html.escape(message[place:])])


def plain_text(message: str) -> str:
    """Return the message for a terminal, with matrices as in code: ``A_C_N``.

    >>> plain_text(r'This is ${}^{N}\\mathbf{C}^{A}$: *transpose* it.')
    'This is N_C_A: transpose it.'
    """
    return MARKED.sub(lambda match: match[1] or match[3] or _formula_as_text(match[2]), message)


# Replacements of TeX where it cannot be typeset, the innermost braces first.
WRITTEN_OUT = (
    (r"\\(left|right|displaystyle)(?![A-Za-z])", ""),
    (r"\\[,;: ]|\\quad", " "),
    (r"\{\}\^\{?(\w+)\}?\\mathbf\{C\}\^\{?(\w+)\}?", r"\1_C_\2"),
    (r"\\(?:math\w+|text|operatorname|vec|bar|hat|boldsymbol)\{([^{}]*)\}", r"\1"),
    (r"\\[td]?frac\{(\\?\w+)\}\{(\\?\w+)\}", r"\1/\2"),
    (r"\\[td]?frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/(\2)"),
    (r"\\sqrt\{([^{}]*)\}", r"sqrt(\1)"),
    (r"\\dot(?:\{([^{}]*)\}|\s?(\\?\w+))", r"\1\2'"),
    (r"\^?\{?\\circ\}?", "°"),
    (r"\\cdot\s?", "·"),
    (r"\\times\s?", "×"),
    (r"\\otimes\s?", "⊗"),
    (r"\\pm\s?", "±"),
    # Keep two words apart.
    (r"(?<=[A-Za-z0-9)\]])\\(?=[A-Za-z])", " "),
)


def _formula_as_text(source: str) -> str:
    before = ""
    while before != source:
        before = source
        for tex, text in WRITTEN_OUT:
            source = re.sub(tex, text, source)
    return " ".join(source.replace("\\", "").split())
