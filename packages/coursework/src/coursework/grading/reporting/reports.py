"""Reports from the records: tables of marks, a page for each student, and a page on the class.

Everything here can be made again from the records at any time, with the same result.
"""

from __future__ import annotations

import datetime
import functools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import astuple
from pathlib import Path
from statistics import mean, median
from urllib.parse import quote

from ...checking.fields import by_name, text
from ...checking.plain import Plain
from ...checking.plugins import plugins
from ...checking.reply import OUTCOMES
from ...checking.writing import answer_as_text
from ..judging.journal import case_id
from ..judging.laboratory import PAGE, Laboratory
from ..judging.term import Assignment, Sat, Term, result_of, term_of
from ..record import Cell, Mark, Record, RunNotebook
from ..store import Store, feedback_of, file_name, write
from ..submissions.intake import Refused, refused_of
from ..tables import lines, table
from .templates_of_pages import page

#: The addresses that feedback links to, as the course had them when it was graded.
LINKS = "links.json"
#: The words for outcomes that have a "yet" elsewhere, which would be wrong once work is graded.
FINAL = {"decided": ("✓", "Decided by a person"), "wrong": ("✗", "Not right")}
#: What students did, to follow "31 % of the class ...", by the note of a mistake or of a fault of
#: the form.
DEEDS = {
    "transposed": "gave the transpose",
    "in degrees": "answered in degrees",
    "in radians": "answered in radians where degrees are asked for",
    "sign of a symbol": "gave {symbol} the wrong sign",
    "symbols interchanged": "interchanged {first} and {second}",
    "opposite": "gave the negative",
    "reciprocal": "gave the reciprocal",
    "factor": "gave {factor} times the answer",
    "one wrong": "got one of the {number} wrong",
    "rounded too far": "rounded too far",
    "half": "gave half the answer",
    "double": "gave twice the answer",
    "supplement": "gave the supplementary angle",
    "complement": "gave the complementary angle",
    "not turned": "left the components as they were, along the first frame",
    "turned the wrong way": "multiplied by the transpose",
    "other numbers": "answered with numbers other than their own",
    "stray symbol": "used a symbol that the question does not have",
    "undefined": "gave something without a finite value",
    "too large": "gave something too large to evaluate",
    "not real": "gave complex numbers",
    "shape": "gave something of the wrong shape or kind",
    "frame": "gave the wrong frame",
    "raised an error": "gave a function that stops with an error",
    "returned nothing": "gave a function that returns nothing",
    "printed": "gave a function that prints and returns nothing",
    "not unit length": "gave something not of unit length",
    "degrees": "gave angles in degrees",
    "unreadable": "gave something that cannot be read as an answer",
    "right only where it is checked": "gave something that is right only where the check tests it",
}
# The most answers and names in the report; the tables have all of them.
MOST_UNDECIDED, MOST_NAMES = 200, 200
# The most incomplete cells of a notebook in the feedback.
MOST_STOPPED = 10
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")
NOTES = {
    "works only out of order": "It works only if its cells run in a different order. "
    "The answers count, but next time choose *Restart the kernel "
    "and run all cells* before you hand in the notebook.",
    "wrote into the records": "Its code wrote where answers are recorded. "
    "We treated what it wrote only as an answer.",
    "could not be run": "We could not run it. Your instructor will look at it.",
}


class _Assignment:
    """The data of the report on an assignment, collected from one record after another.

    Its size grows with the number of different answers, not with the class.
    """

    def __init__(self, says: str = "") -> None:
        self.says, self.students, self.waiting = says, 0, 0
        self.worth: float = 0
        self.points: Counter[float] = Counter()
        self.titles: dict[str, str] = {}
        self.parts: dict[str, Counter[str]] = {}
        self.mixups: Counter[tuple[str, str]] = Counter()
        self.same: Counter[tuple[str, str]] = Counter()
        self.examples: dict[tuple[str, str], str] = {}
        self.tries: dict[str, Counter[int]] = {}
        self.undecided: list[tuple[str, str, tuple[str, ...], str]] = []
        self.odd: dict[str, tuple[int, list[str]]] = {}
        self.ways: Counter[str] = Counter()

    def add(self, record: Record) -> None:
        self.students += 1
        self.points[record.points] += 1
        self.worth = max(self.worth, record.worth)
        for name, mark in record.marks.items():
            self.titles.setdefault(name, mark.title)
            self.parts.setdefault(name, Counter())[_part(mark)] += 1
            if mark.tries:
                self.tries.setdefault(name, Counter())[mark.tries] += 1
            if mark.outcome in ("wrong", "invalid") and mark.note:
                self.mixups[name, deed(mark)] += 1
            elif mark.outcome == "wrong" and mark.group:
                if (name, mark.group) not in self.same:
                    self.examples[name, mark.group] = answer_as_text(record.answer(name).plain)
                self.same[name, mark.group] += 1
            if mark.outcome == "undecided":
                self.waiting += 1
                if len(self.undecided) < MOST_UNDECIDED:
                    answer = answer_as_text(record.answer(name).plain)
                    self.undecided.append((record.student, name, mark.messages, answer))
        for kind in _oddities(record):
            number, names = self.odd.get(kind, (0, []))
            self.odd[kind] = (
                number + 1,
                [*names, record.student] if len(names) < MOST_NAMES else names,
            )
        for notebook in record.notebooks:
            isolation = notebook.isolation
            self.ways[
                ("WEAK: " if isolation.weak else "") + (", ".join(isolation.layers) or "none")
            ] += 1

    @property
    def numbers(self) -> dict[str, int]:
        """The number of each question."""
        return {name: order for order, name in enumerate(self.titles, 1)}


def write_all(store: Store) -> Iterator[str]:
    """Write the tables and the pages of all records, holding only one record at a time.

    Report each table that a person has changed.
    """
    classes: dict[str, _Assignment] = {}
    names: dict[str, None] = {}
    links, term = store.said(LINKS, by_name(text)) or {}, term_of(store.folder)
    for record in store.all():
        place = store.folder / feedback_of(record.student, record.assignment)
        sittings = {name: store.read(record.student, name) for name in term.sittings}
        sat = {name: sheet.marks for name, sheet in sittings.items() if sheet}
        _write_if_new(place, feedback(record, links, term, sat))
        classes.setdefault(
            record.assignment,
            _Assignment(term.assignments.get(record.assignment, Assignment()).says),
        ).add(record)
        names.update(dict.fromkeys(record.marks))
    refused = refused_of(store)
    yield from store.write_table(
        "grades.csv",
        grades(store.all(), list(names), term),
        "No command reads marks from it: change them with `coursework review`.",
    )
    yield from store.write_table(
        "undecided.csv",
        lines(UNDECIDED, _undecided_of(store.all())),
        "Its decisions count once you give it to `coursework merge`.",
    )
    write(store.folder / "refused.csv", table(("file", "student", "why"), map(astuple, refused)))
    write(
        store.folder / "report.html",
        report(classes, refused),
    )


def write_moves(laboratory: Laboratory, folder: Path) -> None:
    """Write the page of possible changes to marks."""
    groups = (
        ("Who would gain", laboratory.gain),
        ("Who would lose", laboratory.lose),
        ("What we must run again, because the stored answers are not enough", laboratory.again),
        ("Whose share of the points would stay the same", laboratory.even),
    )
    write(folder / PAGE, page("laboratory.html", groups=groups, lines=laboratory.lines()))


#: The columns of a table that becomes one of decisions when filled in. ``id`` and ``version``
#: identify the answer and the question of each line. Without the sign in front, a spreadsheet would
#: read a digest such as 2389540731e5 as a number.
UNDECIDED = (
    "id", "version", "student", "question", "credit", "comment", "worth", "why", "message", "answer"
)  # fmt: skip


def _undecided_of(records: Iterable[Record]) -> Iterator[tuple[object, ...]]:
    for record in records:
        for name, mark in record.marks.items():
            if mark.outcome == "undecided":
                yield (
                    f"#{case_id(record, name)}",
                    f"#{mark.version}",
                    record.student,
                    name,
                    "",
                    "",
                    mark.worth,
                    mark.note,
                    " ".join(mark.messages),
                    answer_as_text(record.answer(name).plain),
                )


def _write_if_new(path: Path, content: str) -> None:
    if not path.exists() or path.read_text("utf8") != content:
        write(path, content, lasting=False)


def grades(records: Iterable[Record], names: Sequence[str], term: Term) -> Iterator[str]:
    """Return all marks as lines of CSV, one for each student and assignment."""
    header = ["student", "assignment", "points", "worth", "undecided", "late", *names]
    now = datetime.datetime.now(datetime.UTC)
    return lines(
        [*header, *(f"{name}: outcome" for name in names)],
        (_grades_of(record, names, term, now) for record in records),
    )


def _grades_of(
    record: Record, names: Sequence[str], term: Term, now: datetime.datetime
) -> list[object]:
    marks = [record.marks.get(name) for name in names]
    result = result_of(record.student, record.assignment, record, term, {}, now)
    return [
        record.student,
        record.assignment,
        record.points,
        record.worth,
        record.undecided,
        "late" if result.late else "",
        *(mark.points if mark else "" for mark in marks),
        *(mark.outcome if mark else "" for mark in marks),
    ]


# --- for a student ------------------------------------------------------------------------------


def feedback(
    record: Record,
    links: Mapping[str, str] | None = None,
    term: Term | None = None,
    sat: Sat | None = None,
) -> str:
    """Return a student's page.

    ``links`` are the addresses of the course, and ``sat`` the marks of the student's sittings.
    """
    term = term or Term()
    now = datetime.datetime.now(datetime.UTC)
    (member, *_) = term.members(record.student)
    return page(
        "feedback.html",
        record=record,
        result=result_of(member, record.assignment, record, term, {}, now, sat),
        questions=[
            (
                name,
                mark,
                FINAL.get(mark.outcome) or OUTCOMES[mark.outcome][:2],
                _shown(record, name),
            )
            for name, mark in record.marks.items()
        ],
        notebooks=[(notebook, _stopped(notebook)) for notebook in record.notebooks],
        notes=NOTES,
        links={name: _addresses(name, links or {}) for name in record.marks},
    )


#: The link texts for the addresses of a course.
LEADS_TO = {"chapter": "the chapter", "solution": "the worked solution"}


def _addresses(question: str, links: Mapping[str, str]) -> list[tuple[str, str]]:
    notebook, _, own = question.partition("/")
    return [
        (said, links[name].replace("{notebook}", quote(notebook)).replace("{question}", quote(own)))
        for name, said in LEADS_TO.items()
        if name in links
    ]


def _shown(record: Record, name: str) -> tuple[Plain, str] | None:
    """Return an answer as plain data and as text; ``None`` if there is nothing to show."""
    plain = record.answer(name).plain
    # Do not repeat what a function returned, which a friend could use as a table of values.
    if (
        not plain
        or record.marks[name].outcome == "not attempted"
        or plain["value"][0] == "function"
    ):
        return None
    return plain, answer_as_text(plain)


def _stopped(notebook: RunNotebook) -> list[tuple[int, Cell]]:
    """Return the cells of a notebook that did not run to their end, with their numbers."""
    return [
        (order, cell)
        for order, cell in enumerate(notebook.cells, 1)
        if cell.outcome not in ("done", "not run")
    ][:MOST_STOPPED]


# --- for the instructor -------------------------------------------------------------------------


def deed(mark: Mark) -> str:
    """Return what the student did, in words that follow "31 % of the class"."""
    if mark.note == "authored":
        return f"were told: “{mark.messages[0]}”"
    # A single rotation has no number.
    details = {
        name: ORDINALS[value] if isinstance(value, int) and name != "number" else value or ""
        for name, value in mark.details.items()
    }
    # Two mistakes at once have one note, as in "transposed, and sign of one turn".
    notes = [mark.note] if mark.note in _deeds() else mark.note.split(", and ")
    return " ".join(
        ", and ".join(_deeds().get(note, note) for note in notes).format(**details).split()
    )


@functools.cache
def _deeds() -> dict[str, str]:
    return DEEDS | {
        note: deed for plugin in plugins() for note, deed in getattr(plugin, "DEEDS", {}).items()
    }


def report(classes: Mapping[str, _Assignment], refused: Sequence[Refused]) -> str:
    """Return the page on the class."""
    ways = sum((assignment.ways for assignment in classes.values()), Counter())
    return page(
        "report.html",
        classes=[
            (name, file_name(name), assignment, _about(assignment))
            for name, assignment in sorted(classes.items())
        ],
        refused=refused,
        ways=sorted(ways.items()),
        parts=PARTS,
        feedback_of=feedback_of,
    )


def _about(assignment: _Assignment) -> dict[str, object]:
    """Return the computed values that the report shows for an assignment."""
    points = list(assignment.points.elements())
    return {
        "mean": f"{mean(points):.1f}",
        "median": median(points),
        "bars": _histogram(assignment.points, assignment.worth),
        "success": [
            (*_success(name, counts), _tries(assignment.tries.get(name)))
            for name, counts in assignment.parts.items()
        ],
        "mixups": _mixups(assignment),
        "same": _same(assignment),
        "odd": sorted(assignment.odd.items()),
    }


# The sizes of the histogram.
WIDTH, HEIGHT, LEFT, BASE, TALLEST = 660, 190, 34, 158, 120


def _histogram(points: Mapping[float, int], worth: float) -> list[dict[str, float]]:
    """Return for each bar its position, width, height, number of students, and range of points."""
    bins = min(10, max(1, round(worth)))
    counts = [0] * bins
    for value, students in points.items():
        counts[min(bins - 1, int(value / worth * bins)) if worth else 0] += students
    step, top = (WIDTH - 2 * LEFT) / bins, max(counts)
    return [
        {
            "x": LEFT + order * step,
            "step": step,
            "tall": count / top * TALLEST if top else 0,
            "count": count,
            "low": round(worth * order / bins, 1),
            "high": round(worth * (order + 1) / bins, 1),
        }
        for order, count in enumerate(counts)
    ]


#: The parts of a bar, in order: outcomes, and what they are called.
PARTS = (
    ("correct", "right"),
    ("wrong", "wrong"),
    ("invalid", "not in the required form"),
    ("undecided", "undecided"),
    ("none", "not attempted"),
)


def _success(
    name: str, counts: Counter[str]
) -> tuple[str, list[tuple[str, float, float]], str, str]:
    total, x, bars = sum(counts.values()), 0.0, []
    for part, _ in PARTS:
        if counts[part]:
            wide = 300 * counts[part] / total
            bars.append((part, x, wide))
            x += wide
    spoken = ", ".join(f"{counts[part]} {word}" for part, word in PARTS if counts[part])
    return name, bars, spoken, _percent(counts["correct"], total)


def _tries(counts: Counter[int] | None) -> str:
    """Return how many different answers students tried, as far as notebooks show it."""
    if not counts:
        return ""
    known, most = list(counts.elements()), max(counts)
    return (
        f"{median(known):g} ({most} at most, {len(known)} known)"
        if len(known) > 1
        else f"{most} (1 known)"
    )


def _part(mark: Mark) -> str:
    return {"not attempted": "none", "decided": "correct" if mark.points else "wrong"}.get(
        mark.outcome, mark.outcome
    )


def _percent(part: int, whole: int) -> str:
    share = 100 * part / whole
    return f"{share:.0f} %" if share >= 1 or not part else "under 1 %"


def _mixups(assignment: _Assignment) -> list[tuple[str, str, int, str, float]]:
    shown = sorted(
        assignment.mixups.items(),
        key=lambda entry: (-entry[1], assignment.numbers[entry[0][0]], entry[0][1]),
    )[:20]
    return [
        (name, what, count, _percent(count, assignment.students), 120 * count / assignment.students)
        for (name, what), count in shown
        if count > 1 or assignment.students < 30
    ]


def _same(assignment: _Assignment) -> list[tuple[str, int, str]]:
    shown = sorted(
        (entry for entry in assignment.same.items() if entry[1] > 1),
        key=lambda entry: (-entry[1], assignment.numbers[entry[0][0]], entry[0][1]),
    )[:15]
    return [(key[0], students, assignment.examples[key]) for key, students in shown]


def _oddities(record: Record) -> dict[str, None]:
    """Return what is worth a look in a record, each kind once."""
    oddities: dict[str, None] = {}
    for notebook in record.notebooks:
        oddities.update(dict.fromkeys(notebook.notes))
        if notebook.unknown_questions:
            oddities["it checks an answer to a question that is not in the assignment"] = None
        outcomes = sorted({cell.outcome for cell in notebook.cells} - {"done", "not run", "error"})
        oddities.update(
            dict.fromkeys(
                f"stopped by a limit, or ended by itself: {outcome}" for outcome in outcomes
            )
        )
    if record.superseded:
        oddities["handed in more than once; their feedback says which counts, and why"] = None
    return oddities
