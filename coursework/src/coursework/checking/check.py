"""The check that a student calls in a notebook: ``check('euler-angles/gimbal', D_C_A)``."""

import json
import os
import random
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from .identity import forgotten, identity
from .plain import NotPlain, to_plain
from .question import Locker, Place, Question, Sealed
from .questions import (
    OTHER_NUMBERS,
    code_text,
    find_question,
    judge,
    notebook_questions,
    open_page,
    opened,
    own_number,
    rung_key,
    solution_on,
)
from .reading import calls_for
from .reply import HELP, Reply
from .sealing import unseal
from .variants import siblings_of, without_sibling

#: Where progress is kept: beside the notebook, and nowhere else.
PROGRESS = Path(".coursework", "progress.json")
#: After so many days an earlier mistake is worth another look.
REVIEW_AFTER = 3
DAY = 86_400
#: In the entry of a question: what is known of its other variants, after somebody has said who they are, by number.
OTHERS = "other variants"
#: Different answers of one question that are remembered.
MOST_ANSWERS = 100
#: Of so many wrong answers the notebook tells the grader so many digits: enough to see that two are the same.
MOST_TOLD, DIGITS = 20, 6
#: Notes of wrong answers that are no help on the way to the right one.
NO_HELP = ("", "rounded too far", OTHER_NUMBERS)


#: What the record beside the notebook knows of a question: JSON that a student may have written.
Entry = dict[str, Any]


class NotCorrect(AssertionError):
    """Raised in place of showing the reply where nbgrader runs the notebook: it counts errors."""


def check(name: str, answer: object) -> Reply:
    """Check an answer.

    Parameters
    ----------
    name : str
        The question, as its cell names it: ``'notebook/question'``.
    answer : object
        A SymPy expression or matrix, a reference frame, a vector, numbers, a text or a function, as the
        question asks.

    Returns
    -------
    Reply
        Shown below the cell: whether the answer is right; if not, which mistake leads to it, or what is
        wrong with its form.

    Raises
    ------
    NoSuchQuestion
        If the name is misspelt.
    """
    student = identity()
    sealed = find_question(name, student)
    try:
        reply = judge(name, sealed, to_plain(answer, calls_for(sealed.question), raise_missing=True))
    except NotPlain as error:
        reply = Reply(name, "invalid", "unreadable", [str(error)])
    if reply.outcome == "correct" and reply.opened and reply.opened.solution:
        reply.solution = solution_on(sealed, reply.opened.solution)
    entry = _remember(name, student, reply)
    if reply.outcome == "wrong" and reply.note != OTHER_NUMBERS and entry:
        _show_next_hint(sealed, student, reply, entry)
    if reply.outcome == "correct":
        reply.help = entry.get("help", "")
        _offer_sibling(reply, sealed.question, reply.help)
    if reply.outcome != "not attempted" and forgotten(student, sealed.question):
        reply.messages.append(forgotten(student, sealed.question))
    reply.tries = len(entry.get("answers", [])) + (entry.get("outcome") == "correct")
    if isinstance(entry.get("answers"), list):
        reply.tried = [str(answer)[:DIGITS] for answer in entry["answers"][-MOST_TOLD:]]
    if os.environ.get("NBGRADER_EXECUTION") and reply.outcome not in ("correct", "recorded"):
        raise NotCorrect(repr(reply))
    return reply


# --- help ---------------------------------------------------------------------------------------


def hint(name: str) -> Reply:
    """Show the hints that you have earned for a question: each different answer that is wrong earns one more."""
    student = identity()
    entry = _entry(_read_progress(), name, student)
    steps, earned = _steps(find_question(name, student), entry), _earned(entry)
    if steps[:earned]:
        _note_help(name, student, "hint")
    lines = [f"Hint {order + 1}: {step}" for order, step in enumerate(steps[:earned])]
    for other, page, key in entry.get("after", []):
        with suppress(ValueError, LookupError, TypeError):  # of an earlier release of that question
            locker = Locker.from_json(open_page(find_question(other, student), Place(page, key)), other)
            lines += [f"Hint: {step}" for step in locker.after.get(name, ())]
    left = len(steps) - min(earned, len(steps))
    if not lines:
        lines = ["There is no hint yet."]
    if left:
        lines.append(
            f"{left} more can be earned: hand in what you have to `check`, even if you are not sure of it. "
            "Each different answer counts; pressing Run again does not."
        )
    return Reply(name, "hints", "", lines)


def worked_solution(name: str, code: str) -> Reply:
    """Show the worked solution of a question to one who gives up, with the code that the instructor gave out."""
    student = identity()
    sealed = find_question(name, student)
    locker = opened(sealed, code_text(str(code)))
    if locker is None or locker.solution is None:
        return Reply(
            name, "hints", "", ["This code opens no solution. Your instructor gives the code out when it is time."]
        )
    _note_help(name, student, "solution")
    entry = _entry(_read_progress(), name, student)
    said = ["Read it, close it, and write it out for yourself."]
    reply = Reply(name, "hints", "", said, solution_on(sealed, locker.solution))
    _offer_sibling(reply, sealed.question, entry.get("help", ""))
    return reply


def _note_help(name: str, student: str, kind: str) -> None:
    """Write down that somebody had help; after the right answer it is none."""
    record = _read_progress()
    entry = record[name] = _entry(record, name, student)
    if entry.get("outcome") != "correct":
        kinds = list(HELP)
        entry["help"] = max(kind, entry.get("help", kind), key=lambda one: kinds.index(one) if one in kinds else -1)
        _write_progress(record)


def _offer_sibling(reply: Reply, question: Question, help_had: str) -> None:
    """Say of the siblings of a question what concerns one who had help, or who has solved one without."""
    asked, order = without_sibling(reply.question)
    siblings = siblings_of(asked, question.variants)
    if not help_had:
        reply.messages += (
            [f"Solved without help: with a right answer to `{asked}` itself, it counts in full."] if order else []
        )
    elif siblings:
        said = f"You had help: {HELP.get(help_had, 'it was shown')}."
        if order == len(siblings):
            reply.messages.append(f"{said} There is no further sibling.")
            return
        reply.sibling = siblings[order]
        reply.messages.append(
            f"{said} For the rest of the points of `{asked}`, solve it with other numbers and without help: "
            f"`variant('{reply.sibling}')` shows them, and `check('{reply.sibling}', ...)` checks your answer."
        )


def _steps(sealed: Sealed, entry: Entry) -> list[str]:
    """All hints of a question: those of the last mistake, and then the ladder."""
    steps: list[str] = []
    if entry.get("page"):
        with suppress(ValueError, LookupError, TypeError):  # the page is of an earlier release of the question
            locker = Locker.from_json(open_page(sealed, Place(*entry["page"])), "A page")
            steps = next((list(known.hints) for known in locker.answers if known.hints), [])
    return steps + [unseal(step, rung_key(sealed.question, number)) for number, step in enumerate(sealed.ladder)]


def _earned(entry: Entry) -> int:
    """A first wrong answer gets its message; each other one earns a hint."""
    return max(0, len(entry.get("answers", [])) - 1)


def _show_next_hint(sealed: Sealed, student: str, reply: Reply, entry: Entry) -> None:
    steps, earned = _steps(sealed, entry), _earned(entry)
    if steps[:earned]:
        _note_help(reply.question, student, "hint")
    reply.messages += [f"Hint: {step}" for step in steps[:earned]]
    if len(steps) > earned:
        # In words, and not as a call of `hint`, which few notebooks import.
        reply.messages.append("Each new answer earns you a hint." if earned == 0 else "")
    reply.messages = [line for line in reply.messages if line]


# --- progress -----------------------------------------------------------------------------------


def progress() -> Reply:
    """Show how far you are, by chapter, and what is worth another look; from the record beside this notebook."""
    record, student = _read_progress(), identity()
    known = {name: entry for name in record if "outcome" in (entry := _entry(record, name, student))}
    record = {name: entry for name, entry in known.items() if not without_sibling(name)[1]}
    if not record:
        return Reply("progress", "hints", "", ["Nothing has been checked in this folder yet."])
    right = {name for name, entry in record.items() if entry["outcome"] == "correct"}
    lines = [f"{len(right)} of the {len(record)} questions that you have tried are right."]
    if len(record) == 1:
        lines = [f"The one question that you have tried is {'right' if right else 'not right yet'}."]
    for notebook in sorted({name.partition("/")[0] for name in record}):
        lines.append(_of_notebook(notebook, record, right))
    lines += _right_with_help(known, right, student)
    lines += _worth_another_look(record)
    return Reply("progress", "correct" if len(right) == len(record) else "hints", "", lines)


def _of_notebook(notebook: str, record: Mapping[str, Entry], right: set[str]) -> str:
    questions: dict[str, float] = {}
    with suppress(RuntimeError):  # of another release
        questions = {name: sealed.worth for name, sealed in notebook_questions(notebook).items()}
    questions = questions or {name: 1 for name in record if name.startswith(f"{notebook}/")}
    points = sum(questions.values())
    earned = sum(worth for name, worth in questions.items() if name in right)
    taken_down = {name for name in questions if record.get(name, {}).get("outcome") == "recorded"}
    open_ = [name for name in questions if name not in right and name not in taken_down]
    # What was begun comes before what is new.
    open_.sort(key=lambda name: name not in record)
    line = f"*{notebook}*: {len(right & set(questions))} of {len(questions)} right, {earned} of {points} points."
    if taken_down:
        line += f" Taken down, and marked later: {', '.join(f'`{name}`' for name in sorted(taken_down))}."
    return line + (f" Still open: {', '.join(f'`{name}`' for name in open_)}." if open_ else "")


def _right_with_help(known: Mapping[str, Entry], right: set[str], student: str) -> list[str]:
    """The questions whose points are not all earned, since they were right with help and no sibling without."""
    alone = {without_sibling(name)[0] for name, entry in known.items() if _is_alone(name, entry)}
    found = []
    for name in sorted(right - alone):
        try:
            count = find_question(name, student).question.variants
        except (LookupError, RuntimeError):
            continue  # a question of another release
        if known[name].get("help") and count > 1:
            found.append(f"`{name}`")
    return [f"Right with help, so that a sibling earns the rest: {', '.join(found)}."] if found else []


def _is_alone(name: str, entry: Entry) -> bool:
    """Whether this is a sibling that was solved without help."""
    return without_sibling(name)[1] > 0 and entry["outcome"] == "correct" and not entry.get("help")


def _worth_another_look(record: Mapping[str, Entry]) -> list[str]:
    today = time.time()
    found: list[str] = []
    for name, entry in sorted(record.items()):
        days = int((today - entry.get("mistake at", today)) // DAY)
        if days >= REVIEW_AFTER and entry.get("mistake"):
            found.append(f"`{name}` ({days} days ago: {entry['mistake']})")
    return [f"Worth another look, since you made a mistake there: {', '.join(found)}."] if found else []


def _entry(record: Mapping[str, Any], name: str, student: str) -> Entry:
    """What the record knows of a question in a student's variant; that of others stays beside it."""
    entry, own = record.get(name), _own_number(name, student)
    entry = dict(entry) if isinstance(entry, dict) else {}
    if not entry or entry.get("variant", 0) == own:
        return {**entry, "variant": own} if own else entry
    others = entry.pop(OTHERS, {})
    others = {**(others if isinstance(others, dict) else {}), str(entry.get("variant", 0)): entry}
    found = others.pop(str(own), None)
    if not isinstance(found, dict):
        found = {"after": entry["after"]} if "after" in entry else {}
    return {**found, **({"variant": own} if own else {}), OTHERS: others}


def _own_number(name: str, student: str) -> int:
    try:
        return own_number(name, student)
    except (LookupError, RuntimeError):
        return 0  # a question of another release


def _read_progress() -> dict[str, Any]:
    try:
        record = json.loads(PROGRESS.read_text("utf8"))
        return record if isinstance(record, dict) else {}
    except (OSError, ValueError):
        return {}


def _write_progress(record: Mapping[str, Any]) -> None:
    """Write the record; a folder that cannot be written to costs the record and nothing else."""
    try:
        PROGRESS.parent.mkdir(exist_ok=True)
        draft = PROGRESS.with_name(f"progress-{os.getpid()}-{random.randrange(10**9)}.json")
        draft.write_text(json.dumps(record, indent=1, sort_keys=True), "utf8")
        draft.replace(PROGRESS)
    except OSError:
        pass


def _remember(name: str, student: str, reply: Reply) -> Entry:
    """Write down the outcome, and where hints can be read again: never the hints themselves."""
    record = _read_progress()
    entry = _entry(record, name, student)
    if reply.outcome == "not attempted":
        return entry
    # What was right once stays right: another try in the same cell takes nothing away.
    if entry.get("outcome") != "correct":
        entry["outcome"] = reply.outcome
        if reply.outcome == "wrong" and reply.note not in NO_HELP:
            entry.setdefault("help", "mistake")
    entry["note"] = reply.note
    if reply.outcome == "wrong" and reply.note != OTHER_NUMBERS:  # which is no try at one's own
        answers = entry.setdefault("answers", [])
        if isinstance(answers, list) and reply.answer not in answers and len(answers) < MOST_ANSWERS:
            answers.append(reply.answer)
        has_hints = reply.known is not None and reply.known.hints
        entry["page"] = _page_of(reply.opened) if has_hints else None
        entry["mistake"], entry["mistake at"] = reply.note or "another value", int(time.time())
    elif reply.outcome == "correct" and entry.get("mistake at", 0) < time.time() - REVIEW_AFTER * DAY:
        entry.pop("mistake", None)  # looked at again, and right
    record[name] = entry
    for other in reply.opened.after if reply.opened and reply.outcome == "correct" else ():
        known = record.setdefault(other, {}).setdefault("after", [])
        if [name, *_page_of(reply.opened)] not in known:
            known.append([name, *_page_of(reply.opened)])
    _write_progress(record)
    return entry


def _page_of(locker: Locker | None) -> list[int | str]:
    """Where it is read again what an answer opened."""
    return [locker.place.page, locker.place.key] if locker and locker.place else []
