"""The sealed questions, found by name.

A name is ``'notebook/question'``; the questions of one notebook lie in one file, ``sealed/notebook.json``. The
folder ``sealed`` stands beside the notebook, or in the package of a plug-in.
"""

import difflib
import functools
import json
import re
from pathlib import Path

from . import sealing
from .kinds import Blank, Fault, Reading, Undecidable, fault, fingerprint, read
from .mistakes import message
from .plugins import kind_of_values, sealed_folders
from .points import TWINS
from .reply import Reply
from .variants import own_variant

FORMAT = 1


class NoSuchQuestion(KeyError):
    """There is no question of that name; the message names the nearest one."""

    def __str__(self):
        return self.args[0]


@functools.cache
def notebook_questions(notebook, variant=0):
    """The public parts and the lockers of the questions of a notebook, by full name.

    Those of variant 0 are all questions; those of another are the questions that have it.
    """
    if not re.fullmatch("[a-z0-9-]{1,60}", notebook):
        return {}
    name = f"variants/{notebook}-{variant}.json" if variant else f"{notebook}.json"
    file = next((folder / name for folder in places() if (folder / name).is_file()), None)
    if file is None:
        return {}
    data = json.loads(file.read_text("utf8"))
    if data["format"] != FORMAT:
        raise RuntimeError(
            f"The questions of {notebook} need another version of coursework: install the one "
            "that came with the notebook."
        )
    return data["questions"]


def places():
    """Where sealed questions may lie: the folder ``sealed`` beside the notebook, and those of plug-ins."""
    beside = Path("sealed")
    return [*([beside] if beside.is_dir() else []), *sealed_folders()]


def find_question(name):
    """Give a question by its full name, in the variant of whoever works here.

    Raises
    ------
    NoSuchQuestion
    """
    notebook, _, _ = name.partition("/")
    questions = notebook_questions(notebook)
    if name in questions:
        number = own_variant(name, questions[name])
        return notebook_questions(notebook, number)[name] if number else questions[name]
    found = [file.name for folder in places() for file in folder.iterdir()]
    if not found:
        raise NoSuchQuestion(
            f"There is no question '{name[:80]}', and no other: the folder `sealed` that came with this notebook is "
            "not "
            f"beside it (in {Path.cwd()}), and no package with sealed questions is installed."
        )
    notebooks = sorted(file.removesuffix(".json") for file in found if file.endswith(".json"))
    near = difflib.get_close_matches(name, [*questions, *notebooks], 1, 0.5)
    raise NoSuchQuestion(f"There is no question '{name[:80]}'." + (f" Did you mean '{near[0]}'?" if near else ""))


def judge(name, question, plain):
    """Compare an answer, as plain data, with what is sealed. Gives the reply and the key it earned."""
    earned = None

    def open_locker(text):
        nonlocal earned
        key = sealing.slow_key(question["salt"], text)
        sealed = question["lockers"].get(sealing.locker(key))
        if sealed is None:
            return None
        earned = key
        return sealing.unseal(sealed, key)

    return compare(name, question, plain, open_locker), earned


def compare(name, question, plain, find):
    """Compare an answer, as plain data, with what is known of a question. Gives the reply.

    Parameters
    ----------
    name : str
    question : dict
        The public part of the question.
    plain : dict
    find : function
        What is known of a fingerprint: its outcome and notes, or ``None``.
    """
    try:
        reading = read(question, plain)
        text = fingerprint(question, reading)
    except Blank:
        return Reply(name, "not attempted", "", ["Put your answer in place of the `...` and run the cells again."])
    except Fault as found:
        return Reply(name, "invalid", found.note, [found.message])
    except Undecidable as found:
        return Reply(
            name, "undecided", "undecidable", [f"{found} Try another form, or ask your instructor to look at it."]
        )
    content = find(text)
    if content is None:
        found = fault(question, reading)
        if found:
            return Reply(name, "invalid", found.note, [found.message])
        return Reply(name, "wrong", "", [what_can_be_said(question, plain, reading)])
    if content["outcome"] == "correct":
        return Reply(name, "correct")
    notes = content["notes"]
    messages = [message(question, note, details) for note, details in notes[:2]]
    if len(messages) > 1:
        messages[1] = f"Or, which comes to the same here: {messages[1]}"
    return Reply(name, "wrong", notes[0][0], messages)


def opened(question, key, purpose):
    """Open what lies beside a locker: the worked solution, or hints; ``None`` where there is nothing."""
    sealed = question.get("beside", {}).get(sealing.locker(key, purpose))
    return None if sealed is None else sealing.unseal(sealed, key, purpose)


def what_can_be_said(question, plain, reading: Reading):
    """What a wrong answer has right, so that its author does not look for the fault there."""
    said = kind_of_values(question).wrong
    named = {node[1] for node in plain["nodes"] if node[0] == "symbol"}
    missing = [symbol for symbol in question.get("symbols", {}) if not {symbol, TWINS.get(symbol)} & named]
    if question.get("every symbol") and named and missing:
        said += f" It holds no {' and no '.join(f'`{symbol}`' for symbol in missing)}."
    if (
        any(node[0] == "float" for node in plain["nodes"])
        and question.get("tolerance") is None
        and reading.text is None
    ):
        said += (
            " It holds decimal fractions; where an exact answer is asked for, write `sm.Rational(1, 2)` and "
            "`sm.sqrt(3)`."
        )
    return said
