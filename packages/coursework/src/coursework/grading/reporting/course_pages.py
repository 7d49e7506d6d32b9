"""A table of all marks of a course, a page for each student, and pages on the questions."""

import datetime
from collections.abc import Mapping, Sequence
from pathlib import Path

from ...checking.writing import answer_as_text
from ..judging.term import DAMAGED, FILE, Result, Term, results_of, unknown_times
from ..record import Record
from ..store import Store, feedback_of, file_name, write
from ..submissions.intake import refused_of
from ..tables import lines
from .statistics import Question, Same, Statistics
from .templates_of_pages import ENVIRONMENT, page

FOLDER = "course"
#: The words on the page for each state; an assignment that simply counts needs none.
STATES = {
    "counted": "",
    "dropped": "dropped: it does not count",
    "excused": "excused",
    "missing": "nothing was handed in",
    "damaged": "your file has not been graded, because a person has to look at it first",
    "not due": "not due yet",
}
OUTCOMES = {
    "correct": "right",
    "wrong": "wrong",
    "invalid": "not in the required form",
    "undecided": "undecided",
    "decided": "decided by a person",
    "not attempted": "not attempted",
}
# The most answers of one group on one page.
MOST_ANSWERS = 100
ENVIRONMENT.filters["moment"] = lambda moment: moment.strftime("%Y-%m-%d %H:%M %Z")


def write_course(store: Store, term: Term, *, now: datetime.datetime | None = None) -> list[str]:
    """Write the totals of a course to the folder ``course`` of the results.

    Parameters
    ----------
    store : Store
    term : Term
    now : datetime, optional

    Returns
    -------
    list of str
        Messages for a person.

    Raises
    ------
    BadTerm
        An extension is for nobody in the course.
    """
    now = now or datetime.datetime.now(datetime.UTC)
    statistics = Statistics()
    worth: dict[str, float] = {}
    students: set[str] = set()
    for record in store.all():
        statistics.add(record)
        worth[record.assignment] = record.worth
        students.update(term.members(record.student))
    people = term.roster.people if term.roster else students
    messages = _misspelt(term, worth) + [
        f"{student} has marks but is not in the roster. The table and the statistics still "
        "include this student. For somebody who has left the course, move "
        f"{store.records / file_name(student)} to {store.folder}/put-aside/{file_name(student)}."
        for student in sorted(students.difference(people))
    ]
    students.update(people)
    term.demand_people(store.folder / FILE, students)
    folder = store.folder / FOLDER
    rows, all_results = list[list[object]](), list[Result]()
    refused = {file.student for file in refused_of(store)}
    damaged: dict[str, list[str]] = {}
    for student in sorted(students):
        records: dict[str, Record] = {}
        for name in term.assignments:
            owner = store.owner(student, name, term.group_of(student, name))
            own_record = store.read(owner, name)
            if own_record is not None:
                records[name] = own_record
        results, total = results_of(student, records, term, worth, now, refused)
        for result in results:
            if result.state == DAMAGED:
                damaged.setdefault(result.assignment, []).append(student)
        _write_student(
            folder,
            student,
            {name: own_record.student for name, own_record in records.items()},
            results,
            total,
            term,
        )
        rows.append(_row(student, results, total))
        all_results += results
    messages += unknown_times(all_results, term)
    messages += [
        f"{name}: we did not grade the files of {', '.join(those)}. The totals leave them out "
        f"until a person has looked at them: {store.folder / 'refused.csv'} says why."
        for name, those in damaged.items()
    ]
    messages += store.write_table(
        f"{FOLDER}/course.csv",
        lines(_header(term), rows),
        "No command reads marks from it: change them with `coursework review`.",
    )
    _write_questions(folder, statistics, term.name)
    return messages


def _misspelt(term: Term, worth: Mapping[str, float]) -> list[str]:
    return [
        f"{name} has not been graded, so it does not count yet."
        for name in term.assignments
        if name not in worth
    ] + [
        f"{name} was graded but is not in term.toml, so it does not count."
        for name in sorted(set(worth) - set(term.assignments))
    ]


def _header(term: Term) -> list[str]:
    parts = ("points", "state", "handed in", "late: share lost", "share that counts")
    return [
        "student",
        "total in %",
        "undecided",
        *(f"{name}: {part}" for name in term.assignments for part in parts),
    ]


def _row(student: str, results: Sequence[Result], total: float | None) -> list[object]:
    row: list[object] = [
        student,
        "" if total is None else round(100 * total, 2),
        sum(result.undecided for result in results),
    ]
    for result in results:
        graded = result.state not in ("missing", DAMAGED, "not due")
        row += [
            result.points if graded else "",
            result.state,
            result.handed_in.isoformat() if result.handed_in else "",
            result.penalty or "",
            round(result.share, 4) if result.state in ("counted", "missing", "dropped") else "",
        ]
    return row


def _write_student(
    folder: Path,
    student: str,
    owners: Mapping[str, str],
    results: Sequence[Result],
    total: float | None,
    term: Term,
) -> None:
    links = {name: f"../../{feedback_of(owner, name)}" for name, owner in owners.items()}
    content = page(
        "student.html",
        name=term.name,
        student=student,
        total=total,
        results=results,
        waiting=sum(result.undecided for result in results),
        links=links,
        weights={name: about.weight for name, about in term.assignments.items()},
        words=STATES,
    )
    write(folder / "students" / f"{file_name(student)}.html", content, lasting=False)


def _write_questions(folder: Path, statistics: Statistics, name: str) -> None:
    assignments: dict[str, list[dict[str, object]]] = {}
    for (assignment, question), statistic in statistics.questions.items():
        place = f"answers/{file_name(assignment + ' ' + question)}.html"
        groups, anchors = _groups(statistic, assignment)
        write(
            folder / place,
            page("answers.html", found=statistic, question=question, groups=groups, words=OUTCOMES),
            lasting=False,
        )
        assignments.setdefault(assignment, []).append(
            {"found": statistic, "page": place, "anchors": anchors}
        )
    content = page(
        "statistics.html",
        name=name,
        assignments=sorted(assignments.items()),
    )
    write(folder / "statistics.html", content)


def _groups(question: Question, assignment: str) -> tuple[list[dict[str, object]], dict[str, str]]:
    """Group the answers to a question by outcome and mistake, the most frequent first."""
    groups: dict[tuple[str, str], list[Same]] = {}
    anchors: dict[str, str] = {}
    for (outcome, did, _), same in question.answers.items():
        groups.setdefault((outcome, did), []).append(same)
    order = list(OUTCOMES)
    made: list[dict[str, object]] = []
    outcomes: set[str] = set()
    ranked = sorted(
        groups.items(),
        key=lambda entry: (order.index(entry[0][0]), -sum(same.number for same in entry[1])),
    )
    for place, ((outcome, did), answers) in enumerate(ranked, 1):
        anchor = f"group-{place}" if outcome in outcomes else outcome.replace(" ", "-")
        outcomes.add(outcome)
        anchors.setdefault(did, anchor)
        answers.sort(key=lambda same: (-same.number, same.who))
        made.append(
            {
                "anchor": anchor,
                "outcome": outcome,
                "did": did,
                "number": sum(same.number for same in answers),
                "left": max(0, len(answers) - MOST_ANSWERS),
                "answers": [
                    {
                        "number": same.number,
                        "plain": same.plain,
                        "text": answer_as_text(same.plain, 600),
                        "who": [
                            {
                                "student": student,
                                "page": f"../../{feedback_of(student, assignment)}",
                            }
                            for student in same.who
                        ],
                    }
                    for same in answers[:MOST_ANSWERS]
                ],
            }
        )
    return made, anchors
