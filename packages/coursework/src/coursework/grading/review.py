"""A local page to mark in, one answer at a time or all equal answers at once.

It shows the records and enters decisions in the journal (`coursework.grading.judging.journal`);
nothing is uploaded. Whoever knows the address can decide, so it contains a secret, and we refuse
requests from other pages or under another name of this machine. Students' work appears as text and
formulas, and a policy forbids the browser to run, load or send anything in it.
"""

import hashlib
import hmac
import itertools
import re
import secrets
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlencode

from markupsafe import Markup
from tornado import httpserver, ioloop, netutil, web

from ..authoring.author import to_page
from ..checking.identity import plain_identity
from ..checking.plain import Plain
from ..checking.variants import text_of
from ..checking.writing import answer_as_text, readable
from .judging.cases import Contracts, changed_since, questions_in
from .judging.contract import Contract
from .judging.journal import (
    LONGEST_WORDS,
    RAISED,
    REJECTED,
    UNDER_REVIEW,
    Appeal,
    Appealed,
    ByPeople,
    Collision,
    Decision,
    Event,
    Journal,
    Worth,
    digest_of_answer,
)
from .record import Answer, Mark, Record
from .reporting import pages
from .reporting.reports import deed
from .reporting.templates_of_pages import ENVIRONMENT, source_of
from .store import Store
from .submissions.intake import SAYS
from .tables import number, reason_of

ALONE = "127.0.0.1"
POLICY = (
    "default-src 'none'; style-src 'self'; script-src 'self'; img-src data:; form-action 'self'; "
    "base-uri 'none'; "
    "frame-ancestors 'none'; require-trusted-types-for 'script'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    # With no-referrer, browsers hide the origin of our own form, too.
    "Referrer-Policy": "same-origin",
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
}
#: The answers that a grader can choose to see.
SHOWN = {
    "waiting": "waiting for a person",
    "wrong": "wrong",
    "correct": "correct",
    "invalid": "not in the required form",
    "not attempted": "not attempted",
    "decided": "decided by a person",
    "appeals": "with an open appeal",
    "earlier": "decided, and changed since",
    "all": "all",
}
# The most cells above an answer's own that are shown first.
MOST_ABOVE = 4
#: We do not hide names shorter than this in what students wrote.
SHORTEST_NAME = 3


class Cluster(NamedTuple):
    """Equal answers to one question.

    Attributes
    ----------
    id : str
    assignment, question : str
    members : list of Record
    """

    id: str
    assignment: str
    question: str
    members: list[Record]

    @property
    def mark(self) -> Mark:
        return self.members[0].marks[self.question]

    @property
    def answer(self) -> Answer:
        return self.members[0].answer(self.question)


class Class:
    """All answers of a class, grouped where they are equal.

    Parameters
    ----------
    folder : path
        The folder of results.
    """

    def __init__(self, folder: str | Path) -> None:
        self.store = Store(folder)
        self.journal = Journal(self.store.folder)
        self.standing = self.journal.standing()
        self.questions = {
            name: about
            for path in sorted(
                (self.store.folder / "questions").glob("*.json"),
                key=lambda path: path.stat().st_mtime_ns,
            )
            for name, (about, *_) in questions_in(path).items()
        }
        self.contracts = Contracts(self.store.folder)
        self.records = list(self.store.all())
        self.aliases = {
            student: f"student {order}" for order, student in enumerate(self._shuffled(), 1)
        }
        self._know_names()
        groups: defaultdict[tuple[str, ...], list[Record]] = defaultdict(list)
        for record in self.records:
            for question, mark in record.marks.items():
                judged = mark.judged
                # Answers with the same fingerprint are equal; without one, only identical copies
                # are.
                same = mark.group or digest_of_answer(record, question)
                # Each variant has its own right answer, so the same words to other numbers are
                # another answer.
                groups[
                    record.assignment, question, mark.version, judged.outcome, judged.note, same
                ].append(record)
        self.clusters = {}
        for key, members in groups.items():
            name = hashlib.sha256("\n".join(key).encode()).hexdigest()[:16]
            self.clusters[name] = Cluster(name, key[0], key[1], members)

    def contract(self, cluster: Cluster) -> Contract | None:
        """Return the contract, in the right variant, that judged a cluster, or ``None``."""
        return self.contracts.of(cluster.mark.version)

    def without_names(self, text: str) -> str:
        """Return a text with everybody in the class, including its author, replaced by a number."""
        if not text:
            return text
        said = SAYS.sub(
            lambda match: match[0].replace(match["who"], self._alias(match["who"])), text
        )
        return self._names.sub(lambda match: self._alias(match[0]), said)

    def _alias(self, name: str) -> str:
        return self._known.get(plain_identity(name), "somebody")

    def _know_names(self) -> None:
        """Collect all names of students, from records and from their notebooks."""
        self._known: dict[str, str] = {}
        parts: dict[str, str] = {}
        for record in self.records:
            called = record.identity.called
            email = called.get("email", "")
            names = [
                record.student,
                *(called.get(kind, "") for kind in ("name", "canvas", "moodle")),
            ]
            names += [email, email.partition("@")[0], *(record.identity.own or ()), *record.says]
            for name in names:
                if len(name) >= SHORTEST_NAME:
                    self._known.setdefault(plain_identity(name), self.aliases[record.student])
            # Include a capitalised first name alone: `mark` is a word, but Mark is a person.
            for part in re.findall(r"\w+", called.get("name", "")):
                if len(part) >= SHORTEST_NAME and part[0].isupper():
                    parts.setdefault(part, self.aliases[record.student])

        def any_of(names: Iterable[str]) -> str:
            longest_first = sorted(names, key=len, reverse=True)
            return (
                "|".join(re.escape(name).replace(r"\ ", r"\s+") for name in longest_first) or "(?!)"
            )

        self._names = re.compile(rf"(?<!\w)(?:(?i:{any_of(self._known)})|{any_of(parts)})(?!\w)")
        for part, alias in parts.items():
            self._known.setdefault(plain_identity(part), alias)

    def _shuffled(self) -> list[str]:
        """Return the students in an order that depends on their names but does not reveal them."""
        students = {record.student for record in self.records}
        return sorted(
            students, key=lambda student: hashlib.sha256(f"alias {student}".encode()).digest()
        )

    def read(self) -> None:
        """Read the decisions made in the meantime."""
        self.journal.read()
        self.standing = self.journal.standing()

    def outcome(self, cluster: Cluster) -> tuple[str, list[str]]:
        """Return a cluster's current outcome, decided only if all of it is, and who decided."""
        decided = [
            decision
            for each in cluster.members
            if (decision := self.standing.decision(each, cluster.question))
        ]
        if len(decided) == len(cluster.members):
            return "decided", sorted({decision.who for decision in decided})
        return cluster.mark.judged.outcome, []

    def decision_on(self, cluster: Cluster, record: Record) -> Decision | None:
        """Return the last decision on this answer, or on one handed in before it."""
        return self.standing.decisions.get((record.student, cluster.assignment, cluster.question))

    def earlier(self, cluster: Cluster, record: Record) -> str:
        """Return what changed since a person decided: ``"answer"``, ``"question"`` or nothing."""
        return changed_since(self.decision_on(cluster, record), record, self.contracts)

    def appeals(self, cluster: Cluster, record: Record) -> Sequence[Appealed]:
        """Return the appeals against a mark, the oldest first."""
        return self.standing.appeals.get((record.student, cluster.assignment, cluster.question), ())

    def waits(self, cluster: Cluster) -> int:
        """Return how many answers of a cluster wait for a person, including open appeals."""
        undecided = cluster.mark.judged.outcome == "undecided"
        return sum(
            undecided
            and not self.standing.decision(record, cluster.question)
            or any(appeal.is_open for appeal in self.appeals(cluster, record))
            for record in cluster.members
        )

    def is_shown(self, cluster: Cluster, what: str) -> bool:
        if what == "appeals":
            return any(
                appeal.is_open
                for record in cluster.members
                for appeal in self.appeals(cluster, record)
            )
        if what == "earlier":
            return any(self.earlier(cluster, record) for record in cluster.members)
        if what == "waiting":
            return self.waits(cluster) > 0
        return what in ("all", self.outcome(cluster)[0])

    def lines(
        self, cluster: Cluster, record: Record
    ) -> list[tuple[str, float | None, float | None, int]]:
        """Return a rubric's lines, each with its worth now and in the source, and its use count."""
        source = record.marks[cluster.question].rubric
        lines = dict.fromkeys(
            self.questions[cluster.question].rubric if cluster.question in self.questions else ()
        )
        lines |= dict.fromkeys(source)
        lines |= dict.fromkeys(
            line
            for event in self.journal.by_people
            if isinstance(event, Decision) and event.question == cluster.question
            for line in event.rubric
        )
        used = Counter(
            line
            for decision in self.standing.decisions.values()
            if decision.question == cluster.question
            for line in set(decision.rubric)
        )
        lines |= {
            line: None for question, line in self.standing.worths if question == cluster.question
        }
        return [
            (
                line,
                self.standing.worth(cluster.question, line, source.get(line)),
                source.get(line),
                used[line],
            )
            for line in lines
        ]

    def chosen(self, filters: Mapping[str, str], hide_names: bool = False) -> list[Cluster]:
        """Return the clusters that a grader chose to see, the largest of each question first."""
        text = filters.get("search", "").casefold()
        orders = {name: order for order, name in enumerate(self.questions)}
        return sorted(
            (
                cluster
                for cluster in self.clusters.values()
                if self.is_shown(cluster, filters.get("show", "waiting"))
                and filters.get("question") in (None, "", cluster.question)
                and (not text or text in self.searchable(cluster, hide_names))
            ),
            key=lambda cluster: (
                cluster.assignment,
                orders.get(cluster.question, 0),
                -len(cluster.members),
                cluster.id,
            ),
        )

    def searchable(self, cluster: Cluster, hide_names: bool = False) -> str:
        names = self.aliases if hide_names else {}
        students = " ".join(names.get(record.student, record.student) for record in cluster.members)
        said = " ".join(cluster.mark.messages)
        answer = answer_as_text(cluster.answer.plain, 2_000)
        return (
            f"{students} {cluster.question} {cluster.mark.title} {cluster.mark.note} {said} "
            f"{answer}"
        ).casefold()

    def cells(
        self, cluster: Cluster, record: Record
    ) -> tuple[Sequence[str], list[int], dict[int, tuple[str, ...]]]:
        """Return the code of a student's notebook, the cells to show first, and its pictures.

        The first are the cell of the answer and those above it, up to another question's check. Of
        several notebooks, it is the one in which the question is asked.
        """
        cell = record.answer(cluster.question).cell
        kept = [
            (notebook.sha256, cells)
            for notebook in record.notebooks
            if (cells := self.store.work(notebook.sha256))
        ]
        kept.sort(key=lambda work: not any(cluster.question in source for source in work[1]))
        for digest, cells in kept:
            near: list[int] = []
            if isinstance(cell, int) and 0 <= cell < len(cells):
                above = range(cell - 1, max(-1, cell - MOST_ABOVE - 1), -1)
                own = itertools.takewhile(lambda order: "check(" not in cells[order], above)
                near = [*sorted(own), cell]
            return cells, near, self.store.pictures(digest)
        return [], [], {}


# --- the server ---------------------------------------------------------------------------------


class _Page(web.RequestHandler):
    """The base of all pages, which decides who may ask and what the browser may do."""

    def set_default_headers(self) -> None:
        for name, value in HEADERS.items():
            self.set_header(name, value)
        self.clear_header("Server")

    def prepare(self) -> None:
        settings = self.settings
        # Reject foreign host names that lead here, and forms on foreign pages.
        if self.request.host not in settings["hosts"]:
            raise web.HTTPError(403, "another host")
        if not hmac.compare_digest(self.path_args[0].encode(), settings["secret"].encode()):
            raise web.HTTPError(404)
        if self.request.method != "GET":
            origin = self.request.headers.get("Origin")
            site = self.request.headers.get("Sec-Fetch-Site")
            if origin not in settings["origins"] or site not in (None, "same-origin"):
                raise web.HTTPError(403, "another page")

    @property
    def graded(self) -> Class:
        graded: Class = self.settings["graded"]
        return graded

    def write_error(self, status_code: int, **about: object) -> None:
        self.finish(f"{status_code}\n")

    def filters(self) -> dict[str, str]:
        filters = {
            name: self.get_argument(name, "")[:200] for name in ("show", "question", "search")
        }
        filters["show"] = filters["show"] if filters["show"] in SHOWN else "waiting"
        return filters

    def show(self, template: str, **about: object) -> None:
        settings = self.settings
        names = settings["hide_names"]

        def name_of(student: str) -> str:
            return self.graded.aliases[student] if names else readable(student, 120)

        self.finish(
            ENVIRONMENT.get_template(template).render(
                root=f"/{settings['secret']}/",
                grader=settings["grader"],
                shown=SHOWN,
                name_of=name_of,
                hidden=self.graded.without_names if names else lambda text: text,
                query=lambda **changed: urlencode(
                    {key: value for key, value in changed.items() if value}
                ),
                **about,
            )
        )


class _Overview(_Page):
    def get(self, secret: str) -> None:
        filters, graded = self.filters(), self.graded
        graded.read()
        shown = graded.chosen(filters, self.settings["hide_names"])
        outcomes = {cluster.id: graded.outcome(cluster) for cluster in shown}
        clusters = graded.clusters.values()
        self.show(
            "overview.html",
            filters=filters,
            clusters=shown,
            outcomes=outcomes,
            left=sum(map(graded.waits, clusters)),
            appeals={cluster.id for cluster in clusters if graded.is_shown(cluster, "appeals")},
            earlier=sum(graded.is_shown(cluster, "earlier") for cluster in clusters),
            titles={cluster.question: cluster.mark.title for cluster in graded.clusters.values()},
            text=lambda cluster: answer_as_text(cluster.answer.plain, 120),
        )


class _Answer(_Page):
    def get(self, secret: str, name: str) -> None:
        cluster = self.graded.clusters.get(name)
        if cluster is None:
            raise web.HTTPError(404)
        self.show_cluster(cluster, self.filters())

    def show_cluster(
        self, cluster: Cluster, filters: Mapping[str, str], collision: Collision | None = None
    ) -> None:
        """Show an answer; after a collision, with everything that the grader typed."""
        graded, name = self.graded, cluster.id
        graded.read()
        order = [cluster.id for cluster in graded.chosen(filters, self.settings["hide_names"])]
        place = order.index(name) if name in order else None
        contract = graded.contract(cluster)
        right = contract.plain if contract else None
        chosen = self.get_argument("member", "")
        number = int(chosen) if chosen.isdecimal() and int(chosen) < len(cluster.members) else 0
        record = cluster.members[number]
        seen = [graded.decision_on(cluster, member) for member in cluster.members]
        cells, near, pictures = graded.cells(cluster, record)
        judged = cluster.mark.judged
        students = {member.student for member in cluster.members}
        lines = graded.lines(cluster, record)
        self.show(
            "answer.html",
            cluster=cluster,
            filters=filters,
            mark=cluster.mark,
            judged=judged,
            # The author's own words appear below, verbatim.
            deed=deed(judged)
            if judged.outcome == "wrong" and judged.note not in ("", "authored")
            else "",
            record=record,
            number=number,
            cells=cells,
            near=near,
            pictures=pictures,
            collision=collision,
            seen=" ".join(decision.id if decision else NONE for decision in seen),
            typed={field: self.get_body_argument(field, "") for field in TYPED},
            ticked=self.get_body_arguments("rubric"),
            decisions={
                member.student: graded.standing.decision(member, cluster.question)
                for member in cluster.members
            },
            points_of=lambda member: graded.standing.points(member, cluster.mark),
            earlier={member.student: graded.earlier(cluster, member) for member in cluster.members},
            before={
                member.student: graded.decision_on(cluster, member) for member in cluster.members
            },
            appeals=[
                (place, member, appeal)
                for place, member in enumerate(cluster.members)
                for appeal in graded.appeals(cluster, member)
            ],
            history=_history(graded.journal.by_people, cluster, students),
            asked=Markup(_as_asked(contract)),
            given=contract.variant.given if contract else {},
            calls=contract.question.calls if contract else (),
            case=record.cases.get(cluster.question),
            right=Markup(pages.answer_as_mathematics(right)),
            right_text=answer_as_text(right, 2_000),
            answer=Markup(pages.answer_as_mathematics(cluster.answer.plain)),
            answer_text=answer_as_text(cluster.answer.plain, 2_000),
            right_prose=_prose(right),
            answer_prose=_prose(cluster.answer.plain),
            by_a_person=judged.note == "for a person",
            place=place,
            total=len(order),
            following=order[place + 1] if place is not None and place + 1 < len(order) else None,
            previous=order[place - 1] if place else None,
            rubric=[
                (
                    line,
                    worth,
                    used,
                    self.worth_in_force(cluster, line) or NONE,
                )
                for line, worth, _, used in lines
            ],
            by_rubric=any(worth is not None for _, worth, *_ in lines),
        )

    def post(self, secret: str, name: str) -> None:
        graded, filters = self.graded, self.filters()
        cluster = graded.clusters.get(name)
        if cluster is None:
            raise web.HTTPError(404)
        graded.read()
        deed_of_form = {
            "decision": self.decide,
            "appeal": self.appeal,
            "worths": self.change_worths,
        }
        if self.get_argument("form", "decision") not in deed_of_form:
            raise web.HTTPError(400, "no such form")
        comment, why, *_ = typed = [self.get_argument(field, "").strip() for field in TYPED]
        order = [cluster.id for cluster in graded.chosen(filters, self.settings["hide_names"])]
        try:
            if max(map(len, typed)) > LONGEST_WORDS:
                raise Collision(f"This is longer than {LONGEST_WORDS} characters.")
            stays = deed_of_form[self.get_argument("form", "decision")](cluster, comment, why)
        except (Collision, OSError) as error:
            self.set_status(507 if isinstance(error, OSError) else 409)
            if isinstance(error, OSError):
                error = Collision(f"We could not save it: {reason_of(error)}.")
            self.show_cluster(cluster, filters, collision=error)
            return
        # Go to the next answer, although the list may be shorter now.
        later = order[order.index(name) + 1 :] if name in order else []
        target = later[0] if later and not stays else name
        query = urlencode({key: value for key, value in filters.items() if value})
        self.redirect(f"/{self.settings['secret']}/answer/{target}?{query}", status=303)

    def decide(self, cluster: Cluster, comment: str, why: str) -> bool:
        """Enter or take back a decision on a cluster or one answer; return whether to stay."""
        graded, who, worth = self.graded, self.settings["grader"], cluster.mark.worth
        # The button beside the field for other points has no value of its own.
        said = self.get_argument("credit") or self.get_argument("given")
        only = self.get_argument("only", "")
        seen = dict(enumerate(self.get_argument("seen", "").split()))
        members = [
            (place, member)
            for place, member in enumerate(cluster.members)
            if only in ("", str(place))
        ]
        if not members:
            raise web.HTTPError(400, "no such student")
        if said == "back":
            graded.journal.take_back([record for _, record in members], cluster.question, who, why)
            return bool(only)
        rubric = list(
            dict.fromkeys(line.strip() for line in self.get_arguments("rubric") if line.strip())
        )
        lines = {line: points for line, points, *_ in graded.lines(cluster, cluster.members[0])}
        made: list[Event] = []
        if new := self.get_argument("new", "").strip():
            rubric.append(new)
            if self.get_argument("new_points", "").strip():
                now = lines[new] = self.points_said(self.get_argument("new_points"), worth)
                change = {new: (now, self.worth_in_force(cluster, new))}
                made += graded.journal.worths(cluster.question, change, cluster.mark.rubric, who)
        points = [lines.get(line) for line in rubric] if said == "rubric" else None
        if points is None:
            all_points = self.points_said(said, worth, least=0)
        else:
            all_points = min(worth, max(0, sum(line_points or 0 for line_points in points)))
        accepts = self.get_argument("accepts", "") == "yes"
        for place, record in members:
            waiting = [
                appeal.id
                for appeal in graded.appeals(cluster, record)
                if appeal.is_open and accepts
            ]
            made.append(
                graded.journal.decision(
                    record,
                    cluster.question,
                    all_points / worth if worth else 0.0,
                    who=who,
                    comment=comment,
                    rubric=rubric,
                    why=why,
                    after=seen.get(place, NONE).removeprefix(NONE),
                    points=points,
                    appeal=waiting[0] if waiting else "",
                )
            )
        graded.journal.append(made, collisions=True)
        return bool(only)

    def appeal(self, cluster: Cluster, comment: str, why: str) -> bool:
        """Raise an appeal, take it up, or reject it."""
        number = self.get_argument("only", "")
        if not number.isdecimal() or int(number) >= len(cluster.members):
            raise web.HTTPError(400, "no such student")
        record, state = cluster.members[int(number)], self.get_argument("state")
        appeals = {appeal.id: appeal for appeal in self.graded.appeals(cluster, record)}
        of = appeals.get(self.get_argument("of", ""))
        if bool(of) != (state in (UNDER_REVIEW, REJECTED)):
            raise web.HTTPError(400, "no such step")
        try:
            self.graded.journal.appeal(
                record,
                cluster.question,
                self.get_argument("words", ""),
                state=state if of else RAISED,
                of=of,
                after=self.get_argument("step", "") if of else "",
                who=self.settings["grader"],
            )
        except Collision:
            raise
        except ValueError as error:
            raise Collision(str(error)) from None
        return True

    def change_worths(self, cluster: Cluster, comment: str, why: str) -> bool:
        """Change the worth of lines of the rubric, which changes all marks that use them."""
        changes: dict[str, tuple[float, str]] = {}
        now = {line: points for line, points, *_ in self.graded.lines(cluster, cluster.members[0])}
        for line, said, step in zip(
            *map(self.get_arguments, ("line", "points", "step")), strict=False
        ):
            if line not in now:
                raise web.HTTPError(400, "no such line")
            if said.strip():
                points = self.points_said(said, cluster.mark.worth)
                if points != now[line]:
                    changes[line] = points, step.removeprefix(NONE)
        if changes:
            made = self.graded.journal.worths(
                cluster.question, changes, cluster.mark.rubric, self.settings["grader"]
            )
            self.graded.journal.append(made, collisions=True)
        return True

    def points_said(self, said: str, worth: float, least: float | None = None) -> float:
        try:
            points = float(said.replace(",", "."))
            # A line of a rubric may deduct points.
            if not (-worth if least is None else least) <= points <= worth:
                raise ValueError
            return points
        except ValueError:
            raise Collision(
                f"{repr(said) if said else 'An empty field'} is not a number of points from "
                f"{number(-worth if least is None else least)} to {number(worth)}."
            ) from None

    def worth_in_force(self, cluster: Cluster, line: str) -> str:
        worth = self.graded.standing.worths.get((cluster.question, line))
        return worth.id if worth else ""


def _history(
    events: Iterable[ByPeople], cluster: Cluster, students: Collection[str]
) -> list[tuple[str, ...]]:
    """Return the history of a cluster's answers and its rubric in words."""
    said: list[tuple[str, ...]] = []
    for event in events:
        if isinstance(event, Worth):
            if event.question == cluster.question:
                said.append(
                    (
                        event.when,
                        event.who,
                        "",
                        f"“{event.line}” is worth {number(event.points)}",
                        "",
                    )
                )
        elif (event.assignment, event.question) == (
            cluster.assignment,
            cluster.question,
        ) and event.student in students:
            if isinstance(event, Appeal):
                said.append(
                    (event.when, event.who, event.student, f"appeal {event.state}", event.words)
                )
            elif event.credit is None:
                said.append(
                    (event.when, event.who, event.student, "took a decision back", event.why)
                )
            else:
                words = (
                    f"{number(event.credit * cluster.mark.worth)} points"
                    + ("" if event.points is None else " by the rubric")
                    + (", appeal accepted" if event.appeal else "")
                )
                said.append((event.when, event.who, event.student, words, event.why))
    return said


#: The fields of the page that a person types into.
TYPED = ("comment", "why", "words", "new", "new_points", "of", "given")
#: Stands on the page in place of a decision that does not exist.
NONE = "-"


def _as_asked(contract: Contract | None) -> str:
    """Return the text of a question with these students' numbers. We trust its author."""
    if not contract:
        return ""
    return to_page("\n\n".join([contract.text, text_of(contract.variant)]), pages.formula)


def _prose(plain: Plain | None) -> str | None:
    """Return the words of an answer that is a string; ``None`` if it is something else."""
    return str(plain["value"][1]) if plain and plain["value"][0] == "text" else None


class _Static(_Page):
    FILES = {"review.js": "text/javascript; charset=utf-8", "review.css": "text/css; charset=utf-8"}

    def get(self, secret: str, name: str) -> None:
        if name not in self.FILES:
            raise web.HTTPError(404)
        self.set_header("Content-Type", self.FILES[name])
        self.finish(source_of(name))


def application(graded: Class, grader: str, port: int, hide_names: bool = False) -> web.Application:
    """Return the pages as a Tornado application."""
    secret = secrets.token_urlsafe(24)
    hosts = (f"{ALONE}:{port}", f"localhost:{port}")
    return web.Application(
        [
            (r"/([^/]+)/", _Overview),
            (r"/([^/]+)/answer/([0-9a-f]{16})", _Answer),
            (r"/([^/]+)/(review\.(?:js|css))", _Static),
        ],
        graded=graded,
        secret=secret,
        grader=grader,
        hide_names=hide_names,
        hosts=hosts,
        origins=tuple(f"http://{host}" for host in hosts),
    )


def review(
    folder: str | Path,
    grader: str,
    *,
    hide_names: bool = False,
    port: int = 0,
    say: Callable[[str], None] = print,
) -> None:
    """Serve the page until it is stopped; ``say`` receives its address."""
    graded = Class(folder)
    if not graded.records:
        raise ValueError(f"There are no records in {folder}. Grade first.")
    sockets = netutil.bind_sockets(port, ALONE)
    made = application(graded, grader, sockets[0].getsockname()[1], hide_names)
    server = httpserver.HTTPServer(made, max_body_size=1 << 20)
    server.add_sockets(sockets)
    say(f"http://{ALONE}:{sockets[0].getsockname()[1]}/{made.settings['secret']}/")
    try:
        ioloop.IOLoop.current().start()
    finally:
        server.stop()
