"""What is made of the records: marks as a table, a page for each student, and a page on the class.

Everything here can be made again from the records at any time, and comes out the same.
"""

import functools
import json
from collections import Counter
from statistics import mean, median

from ..checking.plugins import plugins
from ..checking.reply import OUTCOMES
from . import pages
from .ledger import stable_id
from .mathematics import answer_as_mathematics
from .pages import text
from .store import file_name, write
from .tables import lines, number, table

DECIDED = ("✓", "Decided by a person")
#: What the class did, to follow "31 % of the class ...", by the note of a mistake or of a fault of the form.
DEEDS = {
    "transposed": "gave the transpose",
    "in degrees": "answered in degrees",
    "in radians": "answered in radians where degrees are asked for",
    "sign of a symbol": "gave {symbol} the wrong sign",
    "symbols interchanged": "interchanged {first} and {second}",
    "opposite": "gave the opposite",
    "reciprocal": "gave the reciprocal",
    "factor": "gave {factor} times the answer",
    "one wrong": "has one of the {number} wrong",
    "rounded too far": "rounded too far",
    "half": "gave half of it",
    "double": "gave twice of it",
    "supplement": "gave the supplementary angle",
    "complement": "gave the complementary angle",
    "not turned": "left the components as they were, along the first frame",
    "turned the wrong way": "multiplied by the transpose",
    "other numbers": "answered with other numbers than those given to them",
    "stray symbol": "used a symbol that the question does not have",
    "undefined": "gave something without a finite value",
    "too large": "gave something too large to be worked out",
    "not real": "gave complex numbers",
    "shape": "gave something of another shape or kind",
    "frame": "gave another frame than the one asked for",
    "raised an error": "gave a function that stops with an error",
    "returned nothing": "gave a function that returns nothing",
    "printed": "gave a function that prints and returns nothing",
    "not unit length": "gave something that has not unit length",
    "degrees": "gave angles in degrees",
    "unreadable": "gave something that cannot be read as an answer",
    "right only where it is checked": "gave something that is right only where the check looks",
}
MOST_UNDECIDED, MOST_NAMES = 200, 200  # that the report names; all are in the tables
ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth")
NOTES = {
    "works only out of order": "It works only if its cells are run in another order than they stand in. The answers "
    "count; before you hand in, choose *Restart the kernel and run all cells*.",
    "wrote into the records": "Its code wrote where answers are recorded. What it wrote was not taken for more than "
    "an answer.",
    "could not be run": "It could not be run here. Your instructor will look at it.",
}


class _Assignment:
    """What the report says of an assignment, from one record after another.

    What is kept grows with the number of different answers, not with the class.
    """

    def __init__(self):
        self.students, self.points, self.worth, self.titles = 0, Counter(), 0, {}
        self.parts, self.mixups, self.same = {}, Counter(), {}
        self.undecided, self.odd, self.ways, self.versions = [], {}, Counter(), Counter()
        self.waiting = 0

    def add(self, record):
        self.students += 1
        self.points[record["points"]] += 1
        self.worth = max(self.worth, record["worth"])
        for name, mark in record["marks"].items():
            self.titles.setdefault(name, mark["title"])
            self.parts.setdefault(name, Counter())[_part(mark)] += 1
            if mark["outcome"] in ("wrong", "invalid") and mark["note"]:
                self.mixups[name, deed(mark)] += 1
            elif mark["outcome"] == "wrong" and mark["group"]:
                if (name, mark["group"]) not in self.same:
                    self.same[name, mark["group"]] = [0, pages.answer_as_text(record["answers"].get(name))]
                self.same[name, mark["group"]][0] += 1
            if mark["outcome"] == "undecided":
                self.waiting += 1
                if len(self.undecided) < MOST_UNDECIDED:
                    answer = pages.answer_as_text(record["answers"].get(name))
                    self.undecided.append((record["student"], name, mark["messages"], answer))
        for kind in _oddities(record):
            found = self.odd.setdefault(kind, [0, []])
            found[0] += 1
            if len(found[1]) < MOST_NAMES:
                found[1].append(record["student"])
        for notebook in record["notebooks"]:
            isolation = notebook["isolation"]
            self.ways[("WEAK: " if isolation["weak"] else "") + (", ".join(isolation["layers"]) or "none")] += 1
        self.versions[", ".join(f"{name} {version}" for name, version in record["software"].items())] += 1

    @property
    def numbers(self):
        """The number of each question."""
        return {name: order for order, name in enumerate(self.titles, 1)}


def write_all(store):
    """Make the tables and the pages of all records; no more than one record is held at a time."""
    classes, names = {}, {}
    for record in _readable(store):
        place = store.folder / "feedback" / file_name(record["student"]) / f"{file_name(record['assignment'])}.html"
        _write_if_new(place, feedback(record))
        classes.setdefault(record["assignment"], _Assignment()).add(record)
        names.update(dict.fromkeys(record["marks"]))
    refused = [tuple(entry) for entry in _read(store.folder / "refused.json", [])]
    write(store.folder / "grades.csv", grades(store.all(), list(names)))
    write(store.folder / "undecided.csv", lines(UNDECIDED, _undecided_of(_readable(store))))
    write(store.folder / "refused.csv", table(("file", "student", "why"), refused))
    write(store.folder / "report.html", report(classes, refused))


def _readable(store):
    for record in store.all():
        record["answers"] = {name: answer.get("plain") for name, answer in record["answers"].items()}
        yield record


UNDECIDED = ("id", "student", "question", "credit", "comment", "worth", "why", "message", "answer")


def _undecided_of(records):
    for record in records:
        for name, mark in record["marks"].items():
            if mark["outcome"] == "undecided":
                yield (
                    stable_id(record["student"], record["assignment"], name),
                    record["student"],
                    name,
                    "",
                    "",
                    mark["worth"],
                    mark["note"],
                    " ".join(mark["messages"]),
                    pages.answer_as_text(record["answers"].get(name)),
                )


def _read(path, otherwise):
    return json.loads(path.read_text("utf8")) if path.exists() else otherwise


def _write_if_new(path, content):
    if not path.exists() or path.read_text("utf8") != content:
        write(path, content, lasting=False)


def grades(records, names):
    """All marks as CSV, line by line: one for each student and assignment."""
    header = ["student", "assignment", "points", "worth", "undecided", "late", *names]
    return lines([*header, *(f"{name}: outcome" for name in names)], (_grades_of(record, names) for record in records))


def _grades_of(record, names):
    marks = [record["marks"].get(name) for name in names]
    return [
        record["student"],
        record["assignment"],
        record["points"],
        record["worth"],
        record["undecided"],
        "late" if any(notebook["late"] for notebook in record["notebooks"]) else "",
        *(mark["points"] if mark else "" for mark in marks),
        *(mark["outcome"] if mark else "" for mark in marks),
    ]


# --- for a student ------------------------------------------------------------------------------


def feedback(record):
    """The page that a student gets."""
    open_ = record["undecided"]
    pending = (
        f'<p class="soft">{_count(open_, "answer is", "answers are")} still to be looked at by a person.</p>'
        if open_
        else ""
    )
    body = [
        f'<header><p class="soft">{text(record["student"])}</p><h1>{text(record["assignment"])}</h1>'
        f'<p class="big">{number(record["points"])} of {number(record["worth"])} points</p>{pending}</header>'
    ]
    body += [
        _question(order, name, mark, record["answers"].get(name))
        for order, (name, mark) in enumerate(record["marks"].items(), 1)
    ]
    body.append(_about_notebooks(record))
    return pages.page(f"{record['assignment']}: {record['student']}", "\n".join(body))


def _question(order, name, mark, plain):
    sign, word = DECIDED if mark["outcome"] == "decided" else OUTCOMES[mark["outcome"]][:2]
    paragraphs = "".join(f"<p>{pages.message(said)}</p>" for said in mark["messages"])
    # What a function returned is not repeated: a list of it would do for a friend's answer.
    is_shown = plain and mark["outcome"] != "not attempted" and plain["value"][0] != "function"
    read = pages.answer_as_text(plain) if is_shown else ""
    drawn = answer_as_mathematics(plain) if is_shown else ""
    shown = f'<div class="scroll" tabindex="0" role="region" aria-label="Your answer">{drawn}</div>' if drawn else ""
    shown = shown or f"<pre>{text(read, 2_000)}</pre>"
    answer = f'<p class="soft">Your answer, as it was read:</p>{shown}' if read else ""
    return (
        f'<section class="question {mark["outcome"].replace(" ", "-")}"><div class="head"><h3>{order}. {text(_capital(mark["title"]))}</h3>'
        f'<span class="verdict"><span aria-hidden="true">{sign}</span> {word} · {_points(mark)}</span></div>'
        f'<p class="soft"><code>{text(name)}</code></p>{paragraphs}{answer}</section>'
    )


def _capital(title):
    return title[:1].upper() + title[1:]


def _points(mark):
    earned = "–" if mark["outcome"] == "undecided" else number(mark["points"])
    return f"{earned} of {number(mark['worth'])}"


def _about_notebooks(record):
    items = []
    for notebook in record["notebooks"]:
        name = f"<code>{text(notebook['file'])}</code>"
        items += [f"<li>{name}: {pages.message(NOTES.get(note, note))}</li>" for note in notebook["notes"]]
        failed = [
            (order, cell)
            for order, cell in enumerate(notebook["cells"], 1)
            if cell["outcome"] not in ("done", "not run")
        ]
        items += [
            f"<li>{name}: code cell {order} stopped{_line(cell)}. <code>{text(cell.get('error', cell['outcome']))}</code></li>"
            for order, cell in failed[:10]
        ]
        if notebook["unknown questions"]:
            items.append(
                f"<li>{name}: no question is called {', '.join(f'<code>{text(one)}</code>' for one in notebook['unknown questions'][:5])}.</li>"
            )
    items += [
        f"<li><code>{text(notebook['file'])}</code> was not counted: a newer notebook answers the same questions.</li>"
        for notebook in record["superseded"]
    ]
    return f"<h2>Your notebook</h2><ul>{''.join(items)}</ul>" if items else ""


def _line(cell):
    return f" in line {cell['line']}" if "line" in cell else ""


def _count(how_many, one, more):
    return f"{how_many} {one if how_many == 1 else more}"


# --- for the instructor -------------------------------------------------------------------------


def feedback_of(student, assignment):
    """Where a page of feedback lies, from the folder of results."""
    return f"feedback/{file_name(student)}/{file_name(assignment)}.html"


def deed(mark):
    """What was done, in words that follow "31 % of the class"."""
    if mark["note"] == "authored":
        return f"were told: “{mark['messages'][0]}”"
    # Where there is only one turn, it has no number.
    details = {
        name: ORDINALS[value] if isinstance(value, int) and name != "number" else value or ""
        for name, value in mark["details"].items()
    }
    # Two mistakes at once are named together, as in "transposed, and sign of one turn".
    notes = [mark["note"]] if mark["note"] in _deeds() else mark["note"].split(", and ")
    return " ".join(", and ".join(_deeds().get(note, note) for note in notes).format(**details).split())


@functools.cache
def _deeds():
    return DEEDS | {note: deed for plugin in plugins() for note, deed in getattr(plugin, "DEEDS", {}).items()}


def report(classes, refused):
    """The page on the class."""
    body = ["<h1>How the class did</h1>"]
    if not classes:
        body.append("<p>Nothing has been graded.</p>")
    for assignment, found in sorted(classes.items()):
        body.append(_assignment(assignment, found))
    if refused:
        rows = "".join(f"<tr><td><code>{text(file)}</code></td><td>{text(why)}</td></tr>" for file, _, why in refused)
        body.append(
            f'<h2 id="refused">Files that were not graded</h2><p>{_count(len(refused), "file was", "files were")} refused. '
            "Whoever handed one in may not know.</p>"
            f'<div class="scroll"><table><thead><tr><th>File</th><th>Why</th></tr></thead><tbody>{rows}</tbody></table></div>'
        )
    body.append(_how(classes))
    return pages.page("How the class did", "\n".join(body))


def _assignment(assignment, found):
    points = list(found.points.elements())
    said = (
        f'<section><h2 id="{file_name(assignment)}">{text(assignment)}</h2>'
        f"<p>{_count(found.students, 'student', 'students')}. The mean is {mean(points):.1f} of {number(found.worth)} "
        f"points, the median {number(median(points))}.</p>"
    )
    return (
        said
        + _histogram(found.points, found.worth)
        + _success(found)
        + _mixups(found)
        + _clusters(found)
        + _undecided(assignment, found)
        + _odd(found)
        + "</section>"
    )


def _histogram(points, worth):
    bins = min(10, max(1, round(worth)))
    counts = [0] * bins
    for value, students in points.items():
        counts[min(bins - 1, int(value / worth * bins)) if worth else 0] += students
    width, height, left, base = 660, 190, 34, 158
    step, top = (width - 2 * left) / bins, max(counts)
    bars = []
    for order, count in enumerate(counts):
        tall = count / top * 120 if top else 0
        x = left + order * step
        low, high = worth * order / bins, worth * (order + 1) / bins
        bars.append(
            f'<rect class="bar" x="{x + 3:.1f}" y="{base - tall:.1f}" width="{step - 6:.1f}" height="{tall:.1f}"/>'
            f'<text x="{x + step / 2:.1f}" y="{base - tall - 6:.1f}" text-anchor="middle">{count or ""}</text>'
            f'<text x="{x:.1f}" y="{base + 17}" text-anchor="middle">{number(round(low, 1))}</text>'
        )
        if order == bins - 1:
            bars.append(
                f'<text x="{x + step:.1f}" y="{base + 17}" text-anchor="middle">{number(round(high, 1))}</text>'
            )
    spoken = "; ".join(
        f"{number(round(worth * order / bins, 1))} to {number(round(worth * (order + 1) / bins, 1))} points: {count}"
        for order, count in enumerate(counts)
    )
    return (
        f'<figure><svg viewBox="0 0 {width} {height}" role="img" aria-label="Number of students by points. {spoken}.">'
        f'<line class="axis" x1="{left}" y1="{base}" x2="{width - left}" y2="{base}"/>{"".join(bars)}</svg>'
        "<figcaption>Number of students by points.</figcaption></figure>"
    )


#: What a bar is made of, in order: outcomes, and what they are called.
PARTS = (
    ("correct", "right"),
    ("wrong", "wrong"),
    ("invalid", "not in the form asked for"),
    ("undecided", "undecided"),
    ("none", "not attempted"),
)


def _success(found):
    rows = []
    for order, (name, counts) in enumerate(found.parts.items(), 1):
        total = sum(counts.values())
        x, bars = 0.0, []
        for part, _ in PARTS:
            if counts[part]:
                wide = 300 * counts[part] / total
                bars.append(f'<rect class="edge of-{part}" x="{x:.1f}" y="0" width="{wide:.1f}" height="18"/>')
                x += wide
        spoken = ", ".join(f"{counts[part]} {word}" for part, word in PARTS if counts[part])
        rows.append(
            f'<tr><td class="number">{order}</td><td>{text(_capital(found.titles[name]))}<br><span class="soft">{spoken}</span></td>'
            f'<td><svg viewBox="0 0 300 18" width="300" height="18" role="img" aria-label="{spoken}">{"".join(bars)}</svg></td>'
            f'<td class="number">{_percent(counts["correct"], total)}</td></tr>'
        )
    key = "".join(
        f'<span><svg width="11" height="11" viewBox="0 0 11 11" aria-hidden="true"><rect class="of-{part}" width="11" height="11"/></svg>'
        f"{word}</span>"
        for part, word in PARTS
    )
    return (
        '<h3>Question by question</h3><div class="scroll"><table><thead><tr><th class="number">No.</th><th>Question</th>'
        '<th>The class</th><th class="number">Right</th></tr></thead>'
        f'<tbody>{"".join(rows)}</tbody></table></div><p class="key">{key}</p>'
    )


def _part(mark):
    return {"not attempted": "none", "decided": "correct" if mark["points"] else "wrong"}.get(
        mark["outcome"], mark["outcome"]
    )


def _percent(part, whole):
    share = 100 * part / whole
    return f"{share:.0f} %" if share >= 1 or not part else "under 1 %"


def _mixups(found):
    numbers, titles = found.numbers, found.titles
    shown = sorted(found.mixups.items(), key=lambda entry: (-entry[1], numbers[entry[0][0]], entry[0][1]))[:20]
    rows = "".join(
        f'<tr><td class="number"><strong>{_percent(count, found.students)}</strong></td>'
        f'<td><svg viewBox="0 0 120 12" width="120" height="12" role="img" aria-label="{count} of {found.students}">'
        f'<rect class="of-none" width="120" height="12"/><rect class="of-wrong" width="{120 * count / found.students:.1f}" height="12"/></svg></td>'
        f'<td>{pages.message(what)} in question {numbers[name]}, <em>{text(titles[name])}</em> <span class="soft">({count} of {found.students})</span></td></tr>'
        for (name, what), count in shown
        if count > 1 or found.students < 30
    )
    return (
        (
            '<h3>What was mixed up</h3><p>Of the class,</p><div class="scroll"><table><thead><tr><th class="number">Share</th><th></th>'
            f"<th>did this</th></tr></thead><tbody>{rows}</tbody></table></div>"
        )
        if rows
        else ""
    )


def _clusters(found):
    numbers = found.numbers
    shown = sorted(
        (entry for entry in found.same.items() if entry[1][0] > 1),
        key=lambda entry: (-entry[1][0], numbers[entry[0][0]], entry[0][1]),
    )[:15]
    rows = "".join(
        f'<tr><td class="number">{students}</td><td class="number">{numbers[name]}</td><td><code>{text(answer)}</code></td></tr>'
        for (name, _), (students, answer) in shown
    )
    return (
        (
            "<h3>The same wrong answer, without a name</h3><p>These answers were given more than once and no mistake that is "
            'known leads to them. A look may show one that should be.</p><div class="scroll"><table><thead><tr>'
            '<th class="number">Students</th><th class="number">Question</th><th>One of these answers</th></tr></thead>'
            f"<tbody>{rows}</tbody></table></div>"
        )
        if rows
        else ""
    )


def _undecided(assignment, found):
    rows = "".join(
        f'<tr><td><a href="{feedback_of(student, assignment)}">{text(student)}</a></td>'
        f'<td class="number">{found.numbers[name]}</td>'
        f"<td>{' '.join(map(pages.message, messages))}</td><td><code>{text(answer)}</code></td></tr>"
        for student, name, messages, answer in found.undecided
    )
    left = found.waiting - len(found.undecided)
    more = f"<p>And {left} more, in <code>undecided.csv</code>.</p>" if left else ""
    return (
        (
            "<h3>For you to decide</h3><p>Copy <code>undecided.csv</code> to <code>decisions.csv</code>, write a credit "
            "from 0 to 1 into its lines, and run <code>coursework regrade</code>. Until then these answers earn nothing and "
            'are counted nowhere as wrong.</p><div class="scroll"><table><thead><tr><th>Student</th><th class="number">Question</th>'
            f"<th>Why</th><th>The answer</th></tr></thead><tbody>{rows}</tbody></table></div>{more}"
        )
        if rows
        else ""
    )


def _oddities(record):
    """What is worth a look in a record, each kind once."""
    found = {}
    for notebook in record["notebooks"]:
        found.update(dict.fromkeys(notebook["notes"]))
        found.update(dict.fromkeys(f"its code {said}" for said in notebook.get("tried", ())))
        outcomes = sorted({cell["outcome"] for cell in notebook["cells"]} - {"done", "not run", "error"})
        found.update(dict.fromkeys(f"stopped by a limit or by itself: {outcome}" for outcome in outcomes))
    if record["superseded"]:
        found["handed in more than once; the newest counts"] = None
    return found


def _odd(found):
    rows = "".join(
        f'<tr><td>{text(kind)}</td><td class="number">{students}</td><td>{text(", ".join(names), 4_000)}'
        f"{' and others' if students > len(names) else ''}</td></tr>"
        for kind, (students, names) in sorted(found.odd.items())
    )
    return (
        (
            '<h3>Notebooks worth a look</h3><div class="scroll"><table><thead><tr><th>What</th><th class="number">How many</th><th>Whose</th></tr></thead>'
            f"<tbody>{rows}</tbody></table></div>"
        )
        if rows
        else ""
    )


def _how(classes):
    ways = sum((found.ways for found in classes.values()), Counter())
    versions = sum((found.versions for found in classes.values()), Counter())
    items = [
        f"<li>{_count(count, 'notebook', 'notebooks')} isolated by {text(way)}.</li>"
        for way, count in sorted(ways.items())
    ]
    items += [
        f"<li>{_count(count, 'record', 'records')} made with {text(version)}.</li>"
        for version, count in sorted(versions.items())
    ]
    return f'<h2>How it was graded</h2><ul class="soft">{"".join(items)}</ul>' if items else ""
