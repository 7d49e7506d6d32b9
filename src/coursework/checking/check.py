"""The check that a student calls in a notebook: ``check('euler-angles/gimbal', D_C_A)``."""

import json
import os
import random
from pathlib import Path

from .kinds import calls_for
from .plain import NotPlain, to_plain
from .questions import find_question, judge, opened
from .reply import Reply

#: Where progress is kept: beside the notebook, and nowhere else.
PROGRESS = Path(".coursework", "progress.json")


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
    question = find_question(name)
    try:
        reply, key = judge(name, question, to_plain(answer, calls_for(question)))
    except NotPlain as error:
        reply, key = Reply(name, "invalid", "unreadable", [str(error)]), None
    if key is not None and reply.outcome == "correct":
        reply.solution = opened(question, key, "solution") or ""
    record = _remember(name, reply, opened(question, key, "hints") if key is not None else None)
    _show_next_hint(name, reply, record)
    if os.environ.get("NBGRADER_EXECUTION") and reply.outcome != "correct":
        raise NotCorrect(repr(reply))
    return reply


def hint(name: str) -> Reply:
    """Show the hints that you have earned for a question: by a mistake that has one, or by an earlier answer."""
    find_question(name)
    earned = _read_progress().get(name, {}).get("hints", [])
    if not earned:
        return Reply(
            name,
            "not attempted",
            "",
            [
                "There is no hint yet. A hint is earned by an answer: hand in what "
                "you have to `check`, even if you are not sure of it."
            ],
        )
    return Reply(name, "not attempted", "", [f"Hint {order + 1}: {text}" for order, text in enumerate(earned)])


def progress() -> Reply:
    """Show how far you are, from the record beside this notebook."""
    record = _read_progress()
    if not record:
        return Reply("progress", "not attempted", "", ["Nothing has been checked in this folder yet."])
    right = sorted(name for name, entry in record.items() if entry.get("outcome") == "correct")
    open_ = sorted(name for name, entry in record.items() if entry.get("outcome") != "correct")
    lines = [f"{len(right)} of the {len(record)} questions that you have tried are right."]
    if open_:
        lines.append("Still open: " + ", ".join(f"`{name}`" for name in open_) + ".")
    return Reply("progress", "correct" if not open_ else "not attempted", "", lines)


def _show_next_hint(name, reply, record):
    steps = record.get("steps", [])
    if reply.outcome == "wrong" and steps:
        # A first mistake gets its message; made again, it gets one more hint each time.
        shown = steps[: max(0, record["repeats"] - 1)]
        reply.messages += [f"Hint: {step}" for step in shown]


def _read_progress():
    try:
        record = json.loads(PROGRESS.read_text("utf8"))
        return record if isinstance(record, dict) else {}
    except (OSError, ValueError):
        return {}


def _remember(name, reply, hints):
    """Write down the outcome; a folder that cannot be written to costs the record and nothing else."""
    progress_now = _read_progress()
    entry = progress_now.get(name)
    entry = entry if isinstance(entry, dict) else {}
    if reply.outcome == "not attempted":
        return entry
    same = entry.get("note") == reply.note and entry.get("outcome") == reply.outcome == "wrong"
    entry["repeats"] = entry.get("repeats", 0) + 1 if same else 1
    # What was right once stays right: another try in the same cell takes nothing away.
    if entry.get("outcome") != "correct":
        entry["outcome"] = reply.outcome
    entry["note"] = reply.note
    hints = hints or {}
    entry["steps"] = hints.get(name, [])
    if entry["steps"] and reply.outcome == "wrong":
        entry["hints"] = entry["steps"][: max(1, entry["repeats"] - 1)]
    progress_now[name] = entry
    for other, steps in hints.items():
        if other != name:
            progress_now.setdefault(other, {})["hints"] = steps
    try:
        PROGRESS.parent.mkdir(exist_ok=True)
        draft = PROGRESS.with_name(f"progress-{os.getpid()}-{random.randrange(10**9)}.json")
        draft.write_text(json.dumps(progress_now, indent=1, sort_keys=True), "utf8")
        draft.replace(PROGRESS)
    except OSError:
        pass
    return entry
