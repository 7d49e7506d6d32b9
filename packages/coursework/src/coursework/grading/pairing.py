"""Match notebooks to students and assignments, and choose which count, before anything runs."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, TextIO

from ..checking.identity import plain_identity
from .assignments import Course, NothingToGrade, Questions
from .judging.journal import FILE as JOURNAL
from .judging.journal import Journal
from .judging.term import LAST, Term
from .store import Store, write
from .submissions import intake
from .submissions.intake import Notebook, Refused
from .submissions.roster import Roster
from .tables import in_a_line, lines, number_of

WHOSE = "whose.csv"
# The most lines of a table on the screen; a file has the whole table.
MOST_SHOWN = 40


class Work(NamedTuple):
    """One student's, or one group's, submissions for one assignment.

    Attributes
    ----------
    student, assignment : str
    notebooks : list of Notebook
        The notebooks that count.
    superseded : list of Notebook
        The notebooks that do not.
    why : list of str
        The reason for each of these.
    numbers : str
        The student whose numbers it answers; for a group, the member that the notebook names.
    """

    student: str
    assignment: str
    notebooks: list[Notebook]
    superseded: list[Notebook]
    why: list[str]
    numbers: str

    @property
    def key(self) -> tuple[str, str]:
        return self.student, self.assignment

    @property
    def reply(self) -> str:
        """The beginning of the name of the page for the student: that of the newest notebook."""
        return max((*self.notebooks, *self.superseded), key=by_age).claim.reply


#: A notebook that carries the ID of somebody else than the student who handed it in.
Foreign = tuple[Work, Notebook]


class HandedIn(NamedTuple):
    """The submissions, by student and assignment.

    Attributes
    ----------
    work : list of Work
    refused : list of Refused
    left_alone : Counter
        The number of notebooks for each assignment that is not graded now.
    """

    work: list[Work]
    refused: list[Refused]
    left_alone: Counter[str]


def by_age(notebook: Notebook) -> tuple[tuple[int, ...], tuple[int, ...], str]:
    declared, when = notebook.order
    return declared, when if isinstance(when, tuple) else (when,), notebook.file


def read(
    submissions: Path, course: Course, term: Term, student: str | None, out: Path
) -> tuple[list[Notebook], list[Refused]]:
    """Read the submissions.

    Raises
    ------
    NothingToGrade
        It is the folder of the course or of results, or it is empty.
    """
    if course.folder.resolve().is_relative_to(submissions.resolve()):
        raise NothingToGrade(
            f"{submissions} contains the notebooks with solutions. Give the folder with the "
            "submissions."
        )
    if (submissions / "records").is_dir() and (submissions / JOURNAL).is_file():
        raise NothingToGrade(
            f"{submissions} contains grading results. Give the folder with the submissions."
        )
    try:
        notebooks, refused = intake.take_in(
            submissions, course.assignments, term.roster, student, out
        )
    except intake.Unfit as error:
        raise NothingToGrade(str(error)) from None
    if not notebooks and not refused:
        raise NothingToGrade(f"{submissions} is empty: it contains no files.")
    return notebooks, refused


def pair(
    notebooks: Iterable[Notebook],
    refused: Iterable[Refused],
    course: Course,
    term: Term,
    store: Store,
) -> HandedIn:
    """Sort notebooks by student, or group, and assignment, and decide which count.

    A member of a group who was graded alone, and so has a record of their own, worked alone.

    If there are several notebooks for one assignment, the term's rule chooses the one that counts.
    Others count only for questions that it lacks, since an assignment may be handed in as several
    notebooks. An empty notebook never counts if another has an answer.
    """
    refused, left_alone = list(refused), Counter[str]()
    handed_in: dict[tuple[str, str], list[Notebook]] = {}
    for notebook in notebooks:
        answered = course.assignments_of(notebook)
        graded = [name for name in answered if name in course.assignments]
        if not answered:
            refused.append(
                Refused(
                    notebook.file, notebook.student, "It contains no question of any assignment."
                )
            )
        elif not graded:
            left_alone[answered[0]] += 1
        for assignment in graded:
            owner = store.owner(notebook.student, assignment, term.group_of(notebook.student))
            handed_in.setdefault((owner, assignment), []).append(notebook)
    return HandedIn(
        [
            _work_of(student, assignment, mine, course, term)
            for (student, assignment), mine in sorted(handed_in.items(), key=lambda entry: entry[0])
        ],
        refused,
        left_alone,
    )


def _work_of(
    student: str, assignment: str, mine: Sequence[Notebook], course: Course, term: Term
) -> Work:
    """Return the notebooks that count, and the others, each with the reason."""
    ranks = {
        notebook.file: (
            len(mine) == 1 or course.answers_something(notebook),
            term.attempts == LAST or not term.is_late(student, assignment, notebook),
        )
        for notebook in mine
    }
    answers_most, in_time_most = max(ranks.values())
    counting: list[Notebook] = []
    superseded: list[Notebook] = []
    why: list[str] = []
    taken: set[str] = set()
    for notebook in sorted(
        mine, key=lambda notebook: (ranks[notebook.file], by_age(notebook)), reverse=True
    ):
        names = set(notebook.named) & set(course.names[assignment])
        if not counting or (names and not names & taken):
            counting.append(notebook)
            taken |= names
        else:
            answers, in_time = ranks[notebook.file]
            reasons = (
                "it has no answers" if answers_most and not answers else "",
                "it was late, and another was on time" if in_time_most and not in_time else "",
                "another is newer" + ("" if notebook.order[0] else ", by the times of the files"),
            )
            superseded.append(notebook)
            why.append(next(filter(None, reasons)))
    members = {plain_identity(name): name for name in (student, *term.members(student))}
    says = [members.get(plain_identity(notebook.says), student) for notebook in counting]
    counting.sort(key=lambda notebook: notebook.file)
    return Work(student, assignment, counting, superseded, why, says[0])


# --- messages before anything runs ----------------------------------------------------------------


def say(
    handed_in: HandedIn, term: Term, graded: Collection[str], folder: Path, show: TextIO
) -> list[Foreign]:
    """Print whose each file is, how we know, and which do not count; return mismatched notebooks.

    A student in ``graded``, who was graded before, is not reported as missing.
    """
    for name, number in sorted(handed_in.left_alone.items()):
        print(
            f"We skip {number_of(number, 'notebook')} for {name}"
            + (
                f": to grade it, add [assignments.{name}] to term.toml."
                if term.assignments and name not in term.assignments
                else "."
            ),
            file=show,
        )
    _say_whose(handed_in, folder, show)
    _say_alone(handed_in, term, Store(folder), show)
    if term.roster:
        _say_absent(handed_in, term, graded, intake.refused_of(Store(folder)), show)
    return _say_foreign(handed_in.work, show)


def _say_whose(handed_in: HandedIn, folder: Path, show: TextIO) -> None:
    rows: dict[tuple[str, ...], None] = {}
    for submission in handed_in.work:
        reasons = (*[""] * len(submission.notebooks), *submission.why)
        for notebook, why in zip((*submission.notebooks, *submission.superseded), reasons):
            rows[
                submission.student,
                submission.assignment,
                notebook.file,
                notebook.matched,
                notebook.says,
                why,
            ] = None
    header = ("student", "assignment", "file", "known by", "says it is of", "does not count")
    write(folder / WHOSE, lines(header, rows))
    around = {
        notebook.file.partition(notebook.claim.place)[0].strip("/")
        for each in handed_in.work
        for notebook in each.notebooks
    } - {""}
    if len(around) == 1:
        (enclosing,) = around
        print(
            f"All submissions are in the folder {in_a_line(enclosing, 120)!r}, so we did not "
            "take its name for a student's.",
            file=show,
        )
    for student, assignment, file, matched, _, why in itertools.islice(rows, MOST_SHOWN):
        whose = f"  {in_a_line(student, 60)} <- {in_a_line(file, 120)}  ({assignment}; {matched})"
        print(whose + (f" DOES NOT COUNT: {why}" if why else ""), file=show)
    if len(rows) > MOST_SHOWN:
        print(f"  ... and {len(rows) - MOST_SHOWN} more: {folder / WHOSE}", file=show)
    ends = (intake.CLAIMED_TWICE, intake.NOT_MATCHED, intake.NO_GROUP)
    asked = [refused for refused in handed_in.refused if refused.why.endswith(ends)]
    for refused in asked[:MOST_SHOWN]:
        print(f"  ? <- {in_a_line(refused.file, 120)}: {in_a_line(refused.why, 300)}", file=show)


def _say_absent(
    handed_in: HandedIn,
    term: Term,
    graded: Collection[str],
    before: Iterable[Refused],
    show: TextIO,
) -> None:
    people = set(term.roster.people) if term.roster else set()
    came = {*graded, *(submission.student for submission in handed_in.work)}
    present = {member for name in came for member in term.members(name)}
    damaged = {file.student for file in (*handed_in.refused, *before)} & people - present
    missing = sorted(people - present - damaged)
    for names, what in (
        (missing, "handed in nothing"),
        (sorted(damaged), "handed in files that we did not grade"),
    ):
        if names:
            shown = ", ".join(names[:MOST_SHOWN]) + (", ..." if len(names) > MOST_SHOWN else "")
            print(f"Of the students in the roster, {len(names)} {what}: {shown}.", file=show)


def _say_alone(handed_in: HandedIn, term: Term, store: Store, show: TextIO) -> None:
    for assignment, group in sorted(
        {
            (submission.assignment, term.group_of(submission.student, submission.assignment))
            for submission in handed_in.work
        }
    ):
        if alone := [
            member for member in term.groups.get(group, ()) if store.owner(member, assignment, "")
        ]:
            print(
                f"In {assignment}, members of the group {group!r} keep marks of their own: "
                f"{in_a_line(', '.join(alone), 200)}. The group's work counts only for the others "
                "there, and theirs for nobody else. If the group's only work is a file of theirs, "
                f"grade that file with --student {group}.",
                file=show,
            )


def _say_foreign(work: Sequence[Work], show: TextIO) -> list[Foreign]:
    foreign = [
        (submission, notebook)
        for submission in work
        for notebook in submission.notebooks
        if notebook.says and plain_identity(notebook.says) != plain_identity(submission.numbers)
    ]
    for submission, notebook in foreign[:MOST_SHOWN]:
        print(
            f"  ! {in_a_line(notebook.file, 120)} says that it belongs to "
            f"{in_a_line(notebook.says, 60)!r}, but we grade it for "
            f"{in_a_line(submission.student, 60)!r}",
            file=show,
        )
    if len(foreign) > MOST_SHOWN:
        print(f"  ... and {len(foreign) - MOST_SHOWN} more.", file=show)
    return foreign


# --- refusals before anything runs ----------------------------------------------------------------


#: Above both limits of mismatched notebooks, suspect the roster, not the notebooks.
FEW_FOREIGN, SHARE_FOREIGN = 2, 0.2


def demand_own_numbers(
    work: Sequence[Work],
    questions: Mapping[str, Questions],
    foreign: Sequence[Foreign],
    roster: Roster | None,
) -> None:
    """Refuse to grade if many notebooks carry another student's ID.

    Numbers are derived from the ID, so all would be judged by wrong numbers.
    """
    varied = {
        name
        for name, asked in questions.items()
        if any(len(variants) > 1 for variants in asked.values())
    }
    saying = sum(
        bool(notebook.says)
        for submission in work
        if submission.assignment in varied
        for notebook in submission.notebooks
    )
    wrong = [
        (submission, notebook)
        for submission, notebook in foreign
        if submission.assignment in varied
    ]
    if len(wrong) <= max(FEW_FOREIGN, SHARE_FOREIGN * saying):
        return
    (submission, notebook), *_ = wrong
    why = (
        "The roster has different IDs for them. Their numbers depend on the first of its columns "
        "`student`, `email` and `name`."
        if roster
        else "Set a roster in term.toml with the IDs that they wrote, or rename their folders to "
        "these IDs."
    )
    raise NothingToGrade(
        f"Of {number_of(saying, 'notebook')} with an ID, {len(wrong)} carry another student's: for "
        f"example, {notebook.says!r} would be graded as {submission.student!r}. A student's "
        f"numbers depend on the ID, so we would judge their answers by the wrong numbers. {why} "
        "If the list is right anyway, add --as-listed."
    )


#: From this share of the answers to questions with variants on, correct answers to other numbers
#: are no accident.
MANY_OTHER_NUMBERS = 0.1


def say_other_numbers(
    store: Store, work: Sequence[Work], questions: Mapping[str, Questions], show: TextIO
) -> None:
    """Warn if many answers are right for numbers other than the students' own."""
    for assignment, asked in questions.items():
        varied = {name for name, variants in asked.items() if len(variants) > 1}
        given = other = 0
        for submission in work:
            record = (
                store.read(submission.student, assignment)
                if varied and submission.assignment == assignment
                else None
            )
            for name, mark in record.marks.items() if record else ():
                given += name in varied and mark.outcome != "not attempted"
                other += mark.note == "other numbers"
        if other > max(FEW_FOREIGN, MANY_OTHER_NUMBERS * given):
            print(
                f"LOOK AT THIS FIRST: in {assignment}, {other} of {number_of(given, 'answer')} are "
                "right for numbers other than the student's own, so they earn nothing. If "
                "the students wrote other IDs in their notebooks, grade again with the right "
                "roster in term.toml. Nothing is lost.",
                file=show,
            )


def demand_a_class(work: Sequence[Work], roster: Roster | None, student: str | None) -> None:
    """Reject a class in which one student would own everything, or notebooks name the students.

    The folder around everything may have been taken for a student, and loose notebooks have only
    their own names.
    """
    by_name = [
        (submission, notebook)
        for submission in work
        for notebook in (*submission.superseded, *submission.notebooks)
        if not notebook.claim.given_by_system
    ]
    students = {submission.student for submission in work}
    several = len(students) == 1 and any(
        notebook in submission.superseded for submission, notebook in by_name
    )
    of_notebooks = {
        submission.student
        for submission, notebook in by_name
        if any(name.startswith(f"{submission.student}/") for name in notebook.named)
    }
    if (several or of_notebooks) and roster is None and student is None:
        why = (
            f"{', '.join(sorted(of_notebooks))} would be graded as a student, but that is the name "
            "of a notebook."
            if of_notebooks
            else f"All notebooks would belong to one student, {min(students)!r}, and only one of "
            "them would count."
        )
        raise NothingToGrade(
            f"{why} If one student handed in all of them, add --student and the student's ID. If "
            "not, give the folder in which each student has a folder, or set a roster in term.toml."
        )


def follow_renamed(
    store: Store, handed_in: HandedIn, journal: Journal, term: Term, dry_run: bool = False
) -> Iterator[str]:
    """Move records of students whose very notebooks now belong to another, and report each.

    Their folder was renamed, so their marks and people's decisions go with them. A student whose
    notebook is still in its place but refused has no new name: the roster lacks the old one. Where
    others are missing too, the folder may hold only late work, and an equal notebook elsewhere may
    be a copy, so both marks stay.
    """
    work, refused = handed_in.work, {file.file for file in handed_in.refused}
    present = {(submission.student, submission.assignment) for submission in work}
    records = [
        (record.student, record.assignment, {(each.file, each.sha256) for each in record.notebooks})
        for record in store.all()
    ]
    known = {(student, assignment) for student, assignment, _ in records}
    # Nobody whom the term still knows by name was renamed.
    named = {
        *term.groups,
        *itertools.chain(*term.groups.values()),
        *(term.roster.people if term.roster else ()),
    }
    absent = [
        (student, assignment, files)
        for student, assignment, files in records
        if (student, assignment) not in present
        and student not in named
        and not refused & {file for file, _ in files}
    ]
    owners: dict[tuple[str, frozenset[str]], list[Work]] = {}
    for submission in work if absent else ():
        if (submission.student, submission.assignment) not in known:
            digests = frozenset(notebook.digest for notebook in submission.notebooks)
            owners.setdefault((submission.assignment, digests), []).append(submission)
    equal = [
        owners.get((assignment, frozenset(digest for _, digest in files)), [])
        for _, assignment, files in absent
    ]
    incomplete = {assignment for (_, assignment, _), fitting in zip(absent, equal) if not fitting}
    for (student, assignment, files), fitting in zip(absent, equal):
        # Prefer, among equal notebooks, those still in their place: then a roster has renamed the
        # student.
        there = [
            submission
            for submission in fitting
            if files == {(notebook.file, notebook.digest) for notebook in submission.notebooks}
        ]
        names = [
            submission.student
            for submission in there or fitting
            if submission.student not in term.groups
        ]
        if names and not there and assignment in incomplete:
            yield (
                f"{' and '.join(map(repr, names))} handed in the very notebook of {student!r}, who "
                "is not in this folder. Both keep their marks. If a student only has a new name, "
                f"move {store.place(student, assignment).parent} to {store.folder}/put-aside."
            )
        elif names:
            now = f"{student!r} is now {' or '.join(map(repr, names))}"
            if dry_run:
                yield (
                    f"{now}: we would move the record of {assignment}, and then show who gains and "
                    "who loses."
                )
            elif len(names) == 1:
                store.rename(student, assignment, names[0])
                journal.hand_on(student, assignment, names[0])
                yield (
                    f"{now}: the record of {assignment}, its marks, and all decisions and appeals "
                    "are now under the new name."
                )
            else:
                yield (
                    f"{now}: we moved the record of {assignment} to "
                    f"{store.put_aside(student, assignment)}. Its marks, decisions and appeals no "
                    "longer count, because we do not know which of these students they belong to."
                )
