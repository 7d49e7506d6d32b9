"""An explanation of how a mark came about, in a few lines."""

import datetime
import difflib

from ...checking.reply import plain_text
from ..judging import term as of_term
from ..judging.journal import WAS, Appeal, Decision, Exported, Given, Journal
from ..store import Store
from ..submissions.intake import refused_of
from ..tables import in_a_line, number


def life_of(store: Store, student: str, assignment: str) -> list[str]:
    """Return the lines that explain a student's mark for an assignment.

    Raises
    ------
    ValueError
        The student has no mark for it.
    """
    term, journal = of_term.term_of(store.folder), Journal(store.folder)
    whose = store.owner(student, assignment, term.group_of(student, assignment))
    key = whose, assignment
    record, all_given = store.read(*key), journal.standing().given
    given = all_given.get(key)
    refused = [file for file in refused_of(store) if file.student in (student, whose)]
    expected = assignment in (*term.assignments, *(name for _, name in all_given)) and (
        refused or (term.roster and student in term.roster.people)
    )
    if given and record is None or not given and not expected:
        own = sorted(name for owner, name in all_given if owner == whose)
        known = own or sorted({owner for owner, _ in all_given})
        typed = assignment if own else student
        near = [
            *(name for name in known if name.casefold() == typed.casefold()),
            *difflib.get_close_matches(typed, known, 1),
        ]
        renamed = [
            event.student
            for (_, name), event in all_given.items()
            if name == assignment and event.why.endswith(WAS.format(student))
        ]
        if renamed:
            raise ValueError(f"{student!r} is now {renamed[-1]!r}: the marks are under that name.")
        raise ValueError(
            f"{student!r} has no marks for {assignment!r} in {store.folder}. There are "
            f"marks for {', '.join(known[:40]) or 'nobody yet'}"
            f"{', but its record is gone: grade again' if given else ''}."
            f"{f' Did you mean {near[0]!r}?' if near and not given else ''}"
            f"{'' if all_given else ' If your marks are elsewhere, give their folder.'}"
        )
    comes_to = _of(given) if given else "nothing has been graded"
    lines = [f"{student}{f' (in {whose})' if whose != student else ''}, {assignment}: {comes_to}."]
    lines += [f"  not graded: {in_a_line(file.file, 120)}: {file.why}" for file in refused]
    cases = record.cases if record else {}
    for notebook in record.notebooks if record else ():
        when = f", handed in {notebook.handed_in}" if notebook.handed_in else ""
        lines.append(f"  counts: {in_a_line(notebook.file, 120)}{when}")
    lines += [
        f"  does not count: {in_a_line(other.file, 120)}, since {other.why}"
        for other in (record.superseded if record else ())
    ]
    result = of_term.result_of(
        student,
        assignment,
        record,
        term,
        {assignment: 0},
        datetime.datetime.now(datetime.UTC),
        refused={file.student for file in refused},
    )
    due = f"due {result.due:%Y-%m-%d %H:%M %Z}" if result.due else "no due date"
    late = (
        f"late: {number(round(100 * result.penalty))} % lost"
        if result.late
        else "in time"
        if result.handed_in
        else "we do not know when it was handed in"
    )
    if not record:
        late = (
            "it is exported as 0"
            if result.due and result.state == "missing"
            else "no mark is exported"
        )
    lines.append(f"  {due}; {'excused' if result.state == of_term.EXCUSED else late}")
    for name, mark in record.marks.items() if record else ():
        case = cases.get(name)
        rule = f", variant {case.own.variant} ({case.rule})" if case and case.rule else ""
        decided = f", decided by {mark.decided['who']}" if mark.decided else ""
        note = plain_text(mark.messages[0]) if mark.note == "authored" else mark.note
        said = f" ({in_a_line(note, 120)})" if note else ""
        lines.append(
            f"  {name}{rule}: {mark.outcome}{said}, {number(mark.points)} of {number(mark.worth)}"
            f"{decided}"
        )
    for event in journal.events:
        happened = ""
        if isinstance(event, Exported):
            if event.assignment == assignment and student in event.marks:
                happened = f"{event.marks[student]} written to {event.column!r} of {event.file}"
        elif isinstance(event, Given):
            if (event.student, event.assignment) == key:
                happened = f"{_of(event)}: {event.why}"
        elif isinstance(event, Decision | Appeal) and event.key[:2] == key:
            happened = f"{event.question}: {_step(event)}"
        if happened:
            lines.append(f"  {event.when[:16].replace('T', ' ')} {event.who}: {happened}")
    return lines


def _of(given: Given) -> str:
    waiting = f", {given.undecided} undecided" if given.undecided else ""
    return f"{number(given.points)} of {number(given.worth)} points{waiting}"


def _step(event: Decision | Appeal) -> str:
    if isinstance(event, Appeal):
        return f"appeal {event.state}: {in_a_line(event.words, 120)}"
    if event.credit is None:
        return "took a decision back"
    said = f" “{in_a_line(event.comment, 120)}”" if event.comment else ""
    return f"gave {number(round(100 * event.credit, 2))} % of the points{said}"
