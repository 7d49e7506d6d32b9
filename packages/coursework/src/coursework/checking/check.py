"""The check that a student calls in a notebook: ``check('euler-angles/gimbal', D_C_A)``."""

import os
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

from .cells import outdated, overwritten, watch
from .identity import identity
from .kinds import number_of
from .plain import NotPlain, Plain, by_frame, text_of, to_plain
from .plugins import kinds
from .progress import Entry, Progress
from .question import Locker, Place, Question
from .questions import (
    OTHER_NUMBERS,
    code_text,
    find_question,
    judge,
    notebook_questions,
    open_page,
    opened,
    own_numbers,
    rung_key,
    solution_on,
)
from .reading import Reading, calls_for, fault
from .reply import HELP, Reply, Shown
from .sealing import unseal
from .variants import siblings_of, without_sibling
from .writing import answer_as_tex, answer_as_text

# After so many days an earlier mistake is worth another look.
REVIEW_AFTER = 3
DAY = 86_400
# The number of different answers to one question that are remembered.
MOST_ANSWERS = 100
# Notes of wrong answers that do not help to find the right one.
NO_HELP = ("", "rounded too far", OTHER_NUMBERS)
# The length of the TeX of an answer up to which a reply typesets it.
LONGEST_SHOWN = 1_500

watch()


class NotCorrect(AssertionError):
    """Raised instead of showing the reply when nbgrader, which counts errors, runs a notebook."""


def check(name: str, answer: object) -> Reply:
    """Check an answer.

    Parameters
    ----------
    name : str
        The question, as its cell names it: ``'notebook/question'``.
    answer : object
        A SymPy expression or matrix, a reference frame, a vector, numbers, a string or a function,
        as the question requires.

    Returns
    -------
    Reply
        Shown below the cell: whether the answer is right; if not, which mistake leads to it, or
        what is wrong with its form.

    Raises
    ------
    NoSuchQuestion
        If the name is misspelt.
    """
    student = identity()
    sealed = find_question(name, student)
    if messages := outdated():
        return Reply(name, "invalid", "outdated", messages[:1])
    try:
        plain = to_plain(answer, calls_for(sealed.question), raise_missing=True)
        reply = judge(name, sealed, plain, student)
        if reply.outcome != "not attempted":
            reply.shown = shown(sealed.question, plain, reply.reading)
        elif answer is None:
            reply.messages = [
                "Your answer is `None`. A function that returns nothing, such as `print`, gives "
                "`None`. Set your answer to a value, and run the cells again."
            ]
        if reply.outcome == "wrong":
            reply.messages += overwritten(
                sealed.question.symbols.keys() - {part for node in plain["nodes"] for part in node}
            )
    except NotPlain as error:
        reply = Reply(name, "invalid", "unreadable", [str(error)])
    if reply.outcome == "correct" and reply.opened and reply.opened.solution:
        reply.solution = solution_on(sealed, reply.opened.solution)
    entry = _remember(name, student, sealed.question, reply)
    if reply.outcome == "wrong" and reply.note != OTHER_NUMBERS:
        _show_next_hint(student, reply, entry)
    if reply.outcome == "correct":
        reply.help = entry.help
        _offer_sibling(reply, sealed.question, reply.help)
    reply.tries = len(entry.answers) + (entry.outcome == "correct")
    if os.environ.get("NBGRADER_EXECUTION") and not reply:
        raise NotCorrect(repr(reply))
    return reply


def shown(question: Question, plain: Plain, reading: Reading | None) -> Shown:
    """Return an answer as it was read; of a frame or a vector, the part that the question asks for.

    The picture does not affect the verdict: if it cannot be drawn, as without NumPy, there is none.
    """
    value, picture = plain["value"], ""
    if value[0] in ("frame", "vector") and question.frames:
        source, known = question.frames[-1], by_frame(value)
        if source in known:
            inner = known[source]
            value = ["frame", text_of(value), {source: inner}] if value[0] == "frame" else inner
    draw = kinds()[question.kind].picture
    with suppress(Exception):
        if draw and reading and not question.symbols and not fault(question, reading):
            picture = draw(question, reading.numbers[0])
    plain = {"value": value, "nodes": plain["nodes"]}
    text = ("a function that " if value[0] == "function" else "") + answer_as_text(plain)
    tex = answer_as_tex(plain)
    return Shown(tex if len(tex) <= LONGEST_SHOWN else "", text, picture)


# --- help ---------------------------------------------------------------------------------------


def hint(name: str) -> Reply:
    """Show the hints that you have earned: each different wrong answer earns one more."""
    student = identity()
    entry = _entry(Progress.read(), name, student)
    steps, earned = _steps(name, student, entry), _earned(entry)
    if steps[:earned]:
        _note_help(name, student, "hint")
    lines = [f"Hint {order + 1}: {step}" for order, step in enumerate(steps[:earned])]
    for later_question, place in entry.after:
        lines += [
            f"Hint: {step}" for step in _page(later_question, student, place).after.get(name, ())
        ]
    left = len(steps) - min(earned, len(steps))
    if not lines:
        lines = ["There is no hint yet."]
    if left:
        lines.append(
            f"You can earn {left} more. Pass what you have to `check`, even if you are not sure "
            "of it. Each different answer counts, but running the same one again does not."
        )
    return Reply(name, "hints", "", lines)


def worked_solution(name: str, code: str) -> Reply:
    """Show the worked solution to a student who gives up, with the code from the instructor."""
    student = identity()
    sealed = find_question(name, student)
    locker = opened(sealed, code_text(str(code)))
    if locker is None or locker.solution is None:
        return Reply(
            name,
            "hints",
            "",
            [
                "This code does not open a solution. Your instructor will give you the code when "
                "it is time."
            ],
        )
    entry = _note_help(name, student, "solution")
    reply = Reply(
        name,
        "hints",
        "",
        ["Read it, close it, and write it out for yourself."],
        solution_on(sealed, locker.solution),
    )
    _offer_sibling(reply, sealed.question, entry.help)
    return reply


def _note_help(name: str, student: str, kind: str) -> Entry:
    """Record that a student had help; after the right answer, help does not count."""
    progress = Progress.read()
    entry = _entry(progress, name, student)
    if entry.outcome != "correct":
        most = next(
            kind_of_help for kind_of_help in reversed(HELP) if kind_of_help in (kind, entry.help)
        )
        entry = replace(entry, help=most)
        progress.put({name: entry})
    return entry


def _offer_sibling(reply: Reply, question: Question, help_had: str) -> None:
    """Offer a sibling to a student who had help, or who has solved one without help."""
    asked, order = without_sibling(reply.question)
    siblings = siblings_of(asked, question.variants)
    if not help_had:
        reply.messages += ["Solved without help."] if order else []
    elif siblings:
        notice = f"You had help: {HELP.get(help_had, 'we showed it')}."
        if order == len(siblings):
            reply.messages.append(f"{notice} There are no more siblings of this question.")
            return
        reply.sibling = siblings[order]
        reply.messages.append(
            f"{notice} For practice, solve the question with other numbers and without help. "
            f"`variant('{reply.sibling}')` shows them, and `check('{reply.sibling}', ...)` checks "
            "your answer."
        )


def _page(name: str, student: str, place: Place) -> Locker:
    """Return the content of a page of a question, or nothing if it is from an earlier release."""
    with suppress(ValueError, LookupError):
        return Locker.from_json(open_page(find_question(name, student), place), "A page")
    return Locker()


def _steps(name: str, student: str, entry: Entry) -> list[str]:
    """Return all hints of a question: those of the last mistake, and then the ladder."""
    sealed = find_question(name, student)
    known = _page(name, student, entry.page).answers if entry.page else ()
    return [
        *next((answer.hints for answer in known if answer.hints), ()),
        *(
            unseal(step, rung_key(sealed.question, number))
            for number, step in enumerate(sealed.ladder)
        ),
    ]


def _earned(entry: Entry) -> int:
    """Return the number of earned hints: every wrong answer but the first earns one."""
    return max(0, len(entry.answers) - 1)


def _show_next_hint(student: str, reply: Reply, entry: Entry) -> None:
    steps, earned = _steps(reply.question, student, entry), _earned(entry)
    if steps[:earned]:
        _note_help(reply.question, student, "hint")
    reply.messages += [f"Hint: {step}" for step in steps[:earned]]
    if len(steps) > earned == 0:
        # Use words here and not a call of `hint`, which few notebooks import.
        reply.messages.append("Each new answer earns you a hint.")


# --- progress -----------------------------------------------------------------------------------


def progress() -> Reply:
    """Show your progress by chapter, and what is worth another look.

    It comes from the record beside this notebook.
    """
    stored, student = Progress.read(), identity()
    record = {
        name: entry
        for name, entry in {name: _entry(stored, name, student) for name in stored.entries}.items()
        if entry.outcome and not without_sibling(name)[1]
    }
    others = _right_for_others(stored, student)
    if not record:
        return Reply(
            "progress", "hints", "", others or ["You have not checked anything in this folder yet."]
        )
    right = {name for name, entry in record.items() if entry.outcome == "correct"}
    notebooks = sorted({name.split("/")[0] for name in record})
    lines = [
        f"You have tried {number_of(len(record), 'question')}: {len(right)} right.",
        *(_of_notebook(notebook, record, right) for notebook in notebooks),
        *others,
        *_worth_another_look(record),
    ]
    return Reply("progress", "correct" if len(right) == len(record) else "hints", "", lines)


def _of_notebook(notebook: str, record: Mapping[str, Entry], right: set[str]) -> str:
    questions: dict[str, float] = {name: 1 for name in record if name.startswith(f"{notebook}/")}
    # The notebook may be from another release.
    with suppress(RuntimeError):
        questions = {
            name: sealed.worth for name, sealed in notebook_questions(notebook).items()
        } or questions
    points = sum(questions.values())
    earned = sum(worth for name, worth in questions.items() if name in right)
    taken_down = {
        name for name in questions if name in record and record[name].outcome == "recorded"
    }
    open_ = [name for name in questions if name not in right and name not in taken_down]
    # Questions that were begun come before new ones.
    open_.sort(key=lambda name: name not in record)
    line = (
        f"*{notebook}*: {len(right & set(questions))} of {len(questions)} right, {earned} of "
        f"{number_of(points, 'point')}."
    )
    if taken_down:
        line += (
            " Recorded, to be marked later: "
            f"{', '.join(f'`{name}`' for name in sorted(taken_down))}."
        )
    return line + (f" Still open: {', '.join(f'`{name}`' for name in open_)}." if open_ else "")


def _worth_another_look(record: Mapping[str, Entry]) -> list[str]:
    reminders = [
        f"`{name}` ({number_of(days, 'day')} ago: {entry.mistake})"
        for name, entry in sorted(record.items())
        if (days := int(entry.mistake_at and (time.time() - entry.mistake_at) / DAY))
        >= REVIEW_AFTER
        and entry.mistake
    ]
    return (
        [f"Look again at these, where you made a mistake: {', '.join(reminders)}."]
        if reminders
        else []
    )


def _right_for_others(progress: Progress, student: str) -> list[str]:
    """Return a message on questions that were solved with other numbers than the student's own."""
    names = [
        f"`{name}`"
        for name in sorted(progress.entries)
        if (entry := _entry(progress, name, student)).outcome != "correct"
        and any(variant_entry.outcome == "correct" for variant_entry in entry.others)
    ]
    return (
        [f"Right with other numbers, but not yet with yours: {', '.join(names)}."] if names else []
    )


def _entry(progress: Progress, name: str, student: str) -> Entry:
    """Return the record of a question with a student's numbers."""
    return progress.entry(name).with_numbers(*own_numbers(name, student))


def _remember(name: str, student: str, question: Question, reply: Reply) -> Entry:
    """Record the outcome, and where hints can be read again, but never the hints themselves."""
    progress = Progress.read()
    entry = _entry(progress, name, student)
    if reply.outcome == "not attempted":
        return entry
    if question.variants > 1:
        entry = replace(entry, whose=student)
    # A right answer remains right: another try in the same cell does not change it.
    if entry.outcome != "correct":
        helped = reply.outcome == "wrong" and reply.note not in NO_HELP
        entry = replace(
            entry, outcome=reply.outcome, help=entry.help or ("mistake" if helped else "")
        )
    entry = replace(entry, note=reply.note)
    # An answer for other numbers is no try at one's own.
    if reply.outcome == "wrong" and reply.note != OTHER_NUMBERS:
        answers = entry.answers
        if reply.answer not in answers and len(answers) < MOST_ANSWERS:
            answers = *answers, reply.answer
        entry = replace(
            entry,
            answers=answers,
            page=reply.opened.place if reply.known and reply.known.hints and reply.opened else None,
            mistake=reply.note or "another value",
            mistake_at=int(time.time()),
        )
    elif reply.outcome == "correct" and entry.mistake_at < time.time() - REVIEW_AFTER * DAY:
        # The mistake was reviewed, and the answer is right.
        entry = replace(entry, mistake="")
    changed = {name: entry}
    if reply.opened and reply.opened.place and reply.outcome == "correct":
        for later_question in reply.opened.after:
            later = changed.get(later_question, progress.entry(later_question))
            changed[later_question] = replace(
                later, after=tuple(dict.fromkeys((*later.after, (name, reply.opened.place))))
            )
    progress.put(changed)
    return entry
