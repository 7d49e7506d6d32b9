"""Verdicts: from a student's answers, as plain data, to outcomes and points.

Only here are right answers held. What is judged came out of the sandbox as JSON and is checked again; no code
that a student wrote runs in this process, and the verdict is the one that the student's own check gives,
reached by the same functions. An answer that cannot be decided is put aside for a person and never counted
as wrong; nothing is earned by default.
"""

import hashlib
import json
from pathlib import Path
from types import SimpleNamespace

from ..authoring.source import checked_names, read_source
from ..checking.evaluate import MP
from ..checking.kinds import Blank, Fault, Undecidable, canonical, read
from ..checking.plain import NotPlain, read_plain
from ..checking.plugins import folders_of, packages
from ..checking.questions import compare
from ..checking.reply import Reply
from ..checking.variants import variant_of
from .store import write

#: An exact question is not decided by an answer that is off by less than this: it may be rounded.
NEARLY = MP.mpf("1.5e-3")
#: How the sandbox says that reading an answer was cut short, by a limit and not by the answer's form.
CUT_SHORT = ("It took longer than it may.", "It took more memory than it may.")


# --- what is known of each question -------------------------------------------------------------


def names_asked(path):
    """The names of the questions of a notebook with solutions, and the variable of each; nothing is run."""
    # Not with nbformat, which takes a second to be imported, and this is looked up at each start.
    cells = [
        SimpleNamespace(cell_type=cell["cell_type"], source="".join(cell["source"]))
        for cell in json.loads(Path(path).read_text("utf8"))["cells"]
    ]
    return checked_names(SimpleNamespace(cells=cells))


def questions_of(path, edition=""):
    """All that marks need of the questions of a notebook with solutions, as JSON can hold it, by name."""
    source = read_source(path, edition=edition)
    found = {name: about(question) for name, question in source.questions.items()}
    for number in range(1, max((rule.count for rule in source.rules.values()), default=1)):
        for name, question in read_source(path, number, edition).questions.items():
            found[name].setdefault("others", []).append(about(question))
    return found


def of_student(questions, identity):
    """The questions of a student, each in the student's own variant.

    Parameters
    ----------
    questions : dict
        As :func:`load_questions` gives them.
    identity : str
        Of the student, as the roster has it: what a notebook says of itself does not count.
    """
    own = {}
    for name, question in questions.items():
        variants = [question, *question.get("others", [])]
        number = variant_of(identity, name, len(variants), question["public"].get("edition", ""))
        own[name] = variants[number]
        if len(variants) > 1:
            siblings = [other for order, other in enumerate(variants) if order != number]
            own[name] = {**own[name], "siblings": siblings}
    return own


def about(question):
    """All that marks need of a :class:`coursework.authoring.author.Question`, and a version that follows from it."""
    found = json.loads(
        json.dumps(
            {
                "title": question.title,
                "variable": question.variable,
                "worth": question.worth,
                "credit": question.credit,
                "public": question.public,
                "known": {
                    **{text: {"cases": []} for text in question.near},
                    **{text: {"cases": entry.cases} for text, entry in question.entries.items()},
                },
                "right": _canonical_of(question),
            }
        )
    )
    return {**found, "version": hashlib.sha256(json.dumps(found, sort_keys=True).encode()).hexdigest()[:16]}


def _canonical_of(question):
    reading = read(question.public, question.plain)
    if reading.text is not None or question.public.get("tolerance") is not None:
        return None
    return [MP.nstr(number, 30) for number in canonical(question.public, reading)]


def load_questions(paths, kept, edition=""):
    """The questions of several notebooks with solutions, by name.

    What came of working them out is kept in the folder ``kept``, under a name that follows from the bytes of the
    notebook and of this package.
    """
    ours, found = _digest_of_package(), {}
    for path in map(Path, paths):
        place = (
            Path(kept)
            / f"{path.stem}-{hashlib.sha256(ours + edition.encode() + path.read_bytes()).hexdigest()[:16]}.json"
        )
        if not place.exists():
            write(place, json.dumps(questions_of(path, edition), ensure_ascii=False))
        found.update(json.loads(place.read_text("utf8")))
    return found


def _digest_of_package():
    import sympy

    digest = hashlib.sha256(sympy.__version__.encode())
    for folder in [Path(__file__).parents[1], *folders_of(packages())]:
        for path in sorted(Path(folder).rglob("*.py")):
            digest.update(path.read_bytes())
    return digest.digest()


def asked_of_sandbox(questions):
    """What the sandbox is told of each question: the answer's name and the calls of a function, no more."""
    variables = [question["variable"] for question in questions.values()]
    return {
        name: {
            # Two questions may call their answers the same, in two notebooks that were joined: then only the
            # checks tell them apart.
            "variable": question["variable"] if variables.count(question["variable"]) == 1 else None,
            "calls": None
            if question["public"]["kind"] != "function"
            else {"arguments": question["public"]["calls"], "as": question["public"]["takes"]},
        }
        # The numbers of the student's own variant, which its notebook may use by name.
        | ({"given": question["public"]["given"]} if question["public"].get("given") else {})
        for name, question in questions.items()
    }


# --- one answer ---------------------------------------------------------------------------------


def mark(name, question, answer, finished=True):
    """Judge what the sandbox says of an answer.

    Parameters
    ----------
    name : str
    question : dict
        As :func:`questions_of` gives it.
    answer : dict
        As :mod:`coursework.grading.sandbox` gives it.
    finished : bool
        Whether the notebook came to its end; if not, an answer that is missing may be due to that.

    Returns
    -------
    dict
        ``outcome``, ``note`` with its ``details``, ``messages``, ``points``, ``worth``, the ``version`` of the
        question, and ``group``, which identical answers have in common.
    """
    reply, text = judge(name, question, answer, finished)
    if reply.outcome == "wrong" and any(
        judge(name, other, answer)[0].outcome == "correct" for other in question.get("siblings", [])
    ):
        reply = Reply(name, "wrong", "other numbers", ["This is right for other numbers than the ones given to you."])
    share = {"correct": 1, "wrong": question["credit"].get(reply.note, 0) if reply.note else 0}.get(reply.outcome, 0)
    return {
        "outcome": reply.outcome,
        "note": reply.note,
        "details": reply.details,
        "messages": reply.messages,
        "points": round(question["worth"] * share, 4),
        "worth": question["worth"],
        "group": hashlib.sha256(text.encode()).hexdigest()[:16] if text else "",
        "version": question["version"],
    }


def judge(name, question, answer, finished=True):
    """Give the :class:`coursework.checking.reply.Reply` to an answer, and its fingerprint if it has one."""
    state = answer["outcome"]
    if state == "missing":
        if not finished:
            return _undecided(
                name, "not reached", "The notebook did not come to its end, and this answer was not reached."
            ), ""
        variable = f" under the name `{question['variable']}`" if question["variable"] else ""
        return Reply(name, "not attempted", "missing", [f"No answer was found{variable}."]), ""
    if state == "unreadable" and answer["why"] not in CUT_SHORT:
        return Reply(name, "invalid", "unreadable", [answer["why"]]), ""
    if state != "recorded":
        return _undecided(
            name,
            "stopped while it was read",
            f"Reading this answer was stopped. {answer.get('why') or answer.get('error', '')}".strip(),
        ), ""
    found = []

    def look_up(text):
        if not found:  # what is looked up after that is another reading of the same answer
            found.append(text)
        return question["known"].get(text)

    try:
        plain = read_plain(answer["plain"])
        reply = compare(name, question["public"], plain, look_up)
        rounded = reply.outcome == "wrong" and reply.note in ("", "rounded too far")
        if rounded and _nearly_right(question, plain):
            reply = _undecided(
                name,
                "nearly right",
                "The value agrees with the right one to about three digits: it "
                "may have been rounded where an exact answer is asked for.",
            )
    except NotPlain as error:
        reply = Reply(name, "invalid", "unreadable", [str(error)])
    except Exception as error:  # a fault of ours costs no student a mark
        reply = _undecided(name, "not worked out", f"This answer could not be worked out ({type(error).__name__}).")
    return reply, "".join(found)


def _undecided(name, note, message):
    return Reply(name, "undecided", note, [message])


def _nearly_right(question, plain):
    if question["right"] is None:
        return False
    try:
        numbers = canonical(question["public"], read(question["public"], plain))
    except (Blank, Fault, Undecidable):
        return False
    right = [MP.mpf(number) for number in question["right"]]
    return len(numbers) == len(right) and all(
        abs(number - other) <= NEARLY * max(1, abs(other)) for number, other in zip(numbers, right)
    )
