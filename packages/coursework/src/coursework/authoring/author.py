"""Questions as their authors write them, and as we seal them.

In the notebook with the solutions, the cell that checks an answer continues, between nbgrader's
marks for hidden tests, with a call of `question`:

.. code-block:: python

    check('simple-orientations/about-x', A_C_N)
    ### BEGIN HIDDEN TESTS
    question('simple-orientations/about-x', kind='direction cosine matrix', frames=('A', 'N'),
             symbols='theta', turns=[('x', theta)], worth=2,
             solution='The shared axis is $x$, so ...')
    ### END HIDDEN TESTS

The manual of coursework explains each argument.
"""

from __future__ import annotations

import difflib
import hashlib
import html
import inspect
import itertools
import json
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeGuard

from ..checking import sealing
from ..checking.catalogue import by_short_name
from ..checking.catalogue import mistakes as catalogued_mistakes
from ..checking.evaluate import MP
from ..checking.fields import Json, Misread
from ..checking.kinds import KINDS, PARTS, Blank, Fault, Number, Undecidable, sign_limit
from ..checking.mistakes import GENERAL, Mistake, short_name
from ..checking.plain import NotPlain, Plain, to_plain
from ..checking.plugins import kinds
from ..checking.points import ANGLES
from ..checking.question import OUTCOMES, KnownAnswer, Locker, Note, Question, Sealed, Variant
from ..checking.questions import CODE_LETTERS, NEARLY, code_text, compare, rung_key, salt_of_all
from ..checking.reading import (
    Reading,
    calls_for,
    canonical,
    edges_near,
    fingerprint,
    fingerprints,
    read,
    tolerances,
    within,
)
from ..checking.reply import Reply
from ..checking.units import UnknownUnit

#: The default tolerance of answers without symbols: three decimals are enough.
TOLERANCE = 5e-4
#: The widest range of a symbol, since each check searches all quarter turns in it for points.
WIDEST = 10_000
#: We recognise a mistake up to this many tolerances beyond the edge of its cell, since rounding may
#: cross the edge.
REACH = 0.5
#: Round the numbers of an answer to this share of its tolerance, no finer than doubles hold and no
#: coarser than the last share. A seal must not depend on the last bits, which differ between
#: processors.
ROUNDED, DOUBLES, ROUNDED_MOST = MP.mpf("1e-5"), MP.mpf("1e-12"), MP.mpf("1e-1")
#: The fraction of a step at which rounding tips to the next number. No number with few digits or a
#: small denominator lies there.
TIPS = MP.mpf("0.6371")
#: The most edges of cells near an answer. Each adds a locker beyond it, and so does every
#: combination.
MOST_EDGES = 6
#: The same for a wrong answer.
MOST_EDGES_OF_WRONG = 3
#: The same for students with other numbers, since each cell costs a slow hash at release.
MOST_EDGES_FOR_OTHERS = 2
#: We pad the pages of a first variant to a multiple of this.
PAGES_TOGETHER = 4


#: The letter of an axis, and the angle of the rotation about it.
Turn = tuple[Any, Any]


class AuthorError(ValueError):
    """A question has a fault; the message names the question and the reason."""


class Entry(NamedTuple):
    """The meaning of one fingerprint: usually one known answer, also as plain data.

    Numbers are stored if several answers share the fingerprint or it is that of the right answer.
    """

    answers: list[KnownAnswer]
    plain: Plain

    @property
    def outcome(self) -> str:
        return self.answers[0].outcome

    @property
    def notes(self) -> tuple[Note, ...]:
        return self.answers[0].notes


class _Known(NamedTuple):
    """A known answer, with all mistakes that lead to it."""

    outcome: str
    notes: list[Note]
    plain: Plain
    reading: Reading
    numbers: list[Number]


def far_from_last_bits(question: Question, reading: Reading) -> Reading:
    """Round an answer with a tolerance, so that its seals are the same on every processor."""
    if question.tolerance is None or reading.text is not None:
        return reading
    absolute, relative = tolerances(question)

    def rounded(number: Number) -> Number:
        allowed = absolute + relative * abs(number)
        share = min(max(ROUNDED * allowed, DOUBLES * abs(number)), ROUNDED_MOST * allowed)
        if not share:
            return number
        step = MP.mpf(10) ** MP.floor(MP.log10(share) + TIPS - 1)
        return MP.sign(number) * MP.floor(abs(number) / step + 1 - TIPS) * step

    return Reading([[rounded(number) for number in numbers] for numbers in reading.numbers])


class AuthoredQuestion:
    """A question with everything that its author knows about it.

    Attributes
    ----------
    name : str
    public : Question
        The part that a student's computer may know.
    answer : object
        The right answer.
    worth : int
    credit : dict
        The share of the worth for a mistake, by its note.
    partial : bool
        Whether an answer in several words earns the share of them that is right, beyond a guess.
    rubric : tuple of str, or dict
        The criteria for a person who marks the answers; with the points of each line.
    fixed : str
        Why the question has one answer for everybody.
    entries : dict
        `Entry` by fingerprint: the right answer and every mistake that differs from it.
    slips : list of str
        The author's slips in names, texts, mistakes and options. We release no such question.
    near : list
        Fingerprints of answers that agree with an exact one to about three digits.
    """

    def __init__(
        self,
        name: str,
        public: Question,
        answer: Any,
        *,
        variable: str | None = None,
        worth: float = 1,
        credit: Mapping[str, float] | None = None,
        partial: bool = False,
        rubric: Mapping[str, float] | Iterable[str] | None = None,
        hints: Mapping[str, Sequence[str]] | None = None,
        ladder: Iterable[str] | None = None,
        after: Mapping[str, Sequence[str]] | None = None,
        solution: str = "",
        title: str = "",
        fixed: str = "",
        turns: Iterable[Turn] = (),
        turned: Turn | None = None,
        authored: Mapping[str, Any] | None = None,
        exam: bool = False,
    ) -> None:
        self.name, self.public, self.answer, self.variable = name, public, answer, variable
        self.title = title or name.partition("/")[2].replace("-", " ")
        self.worth, self.partial, self.fixed = worth, partial, fixed
        self.credit = dict(credit or {})
        self.rubric = dict(rubric) if isinstance(rubric, dict) else tuple(rubric or ())
        self.solution, self.turned = solution, turned
        self.hints, self.after = dict(hints or {}), dict(after or {})
        self.pages, self.turns = Pages(b""), list(turns)
        self.ladder = ladder_of(public, ladder, self.turns)
        self.plain = self.to_plain(answer)
        held = {node[1] for node in self.plain["nodes"] if node[0] == "symbol"}
        every_symbol = bool(public.symbols) and held >= set(public.symbols)
        self.public = replace(
            public, exam=True if exam else None, every_symbol=every_symbol or None
        )
        self._settle_points()
        self._demand_turns()
        # The author's words about a mistake suit the question better than the catalogue's.
        self.mistakes = [
            Mistake("authored", {"text": text}, wrong) for text, wrong in (authored or {}).items()
        ]
        self.mistakes += self._catalogued()
        self._demand_notes()
        steps = itertools.chain(*self.hints.values(), *self.after.values(), self.ladder)
        self.near: list[str] = []
        self.slips = [
            f"Its options {first!r} and {second!r} count as the same answer."
            for first, second in itertools.combinations(public.options, 2)
            if first.lower() == second.lower()
        ]
        self.slips += [
            f"Python reads a backslash in {text!r} as a special character. Put an r in front "
            "of the quotation mark, or double each backslash."
            for text in (*(authored or {}), *steps, *self.rubric, solution)
            if re.search(r"[\a\b\f\r\t\v]", text)
        ]
        if not unicodedata.is_normalized("NFC", name):
            self.slips.append(
                "An accent in this name is a character of its own, so nobody who types the name "
                "gets the same. Type the letter anew here and in the check."
            )
        self.entries = {} if kinds()[public.kind].by_a_person else self._entries()

    @property
    def number(self) -> int:
        """The number of the variant."""
        return self.public.variant.number if self.public.variant else 0

    def to_plain(self, answer: Any) -> Plain:
        return to_plain(answer, calls_for(self.public))

    def fingerprint_of(self, plain: Plain) -> str:
        return fingerprint(self.public, self.read(plain))

    def read(self, plain: Plain) -> Reading:
        """Read an answer that the author knows, as numbers that are the same on every processor."""
        return far_from_last_bits(self.public, read(self.public, plain))

    def find(self, text: str) -> Locker | None:
        """Return the entry of a fingerprint as a locker, or ``None``."""
        if text in self.entries:
            return Locker(tuple(self.entries[text].answers))
        return Locker() if text in self.near else None

    def reply_to(self, plain: Plain) -> Reply:
        """Return the reply that a student gets to an answer, found without the slow hash."""
        return compare(self.name, self.public, plain, self.find)

    def _settle_points(self) -> None:
        """Choose the salt, and thus the points, so that each entry takes each sign that it can.

        Nearly every salt satisfies this for nearly every answer, so the choice reveals nothing.
        """
        # Each variant has its own salt, so that a guess at one does not help with the others.
        number = self.number
        seed = f"{self.name} variant {number}" if number else self.name
        varying = None
        for attempt in range(50):
            self.public = replace(
                self.public, salt=hashlib.sha256(f"{seed} {attempt}".encode()).hexdigest()[:16]
            )
            try:
                reading = self.read(self.plain)
                numbers = canonical(self.public, reading)
                if varying is None:
                    varying = self._varying()
            except (Blank, Fault, Undecidable) as error:
                raise AuthorError(
                    f"{self.name}: the right answer cannot be read. {error}"
                ) from None
            if not varying <= _varying_in(reading.numbers):
                continue
            limit = sign_limit(self.public)
            if self.public.either_sign and any(
                0.4 * limit < abs(number) < 1.6 * limit for number in numbers
            ):
                continue
            if len(edges_near(self.public, numbers)) <= MOST_EDGES:
                return
        raise AuthorError(
            f"{self.name}: we found no points at which to compare this answer reliably. Is it "
            "well defined for all values of its symbols?"
        )

    def _varying(self) -> set[int]:
        """Return the indices of the answer's entries whose sign depends on the symbols."""
        if not self.public.symbols:
            return set()
        readings = (
            read(replace(self.public, salt=f"{self.name} {k}"), self.plain).numbers
            for k in range(8)
        )
        return _varying_in([numbers for reading in readings for numbers in reading])

    def _demand_turns(self) -> None:
        if not self.turns:
            return
        build = kinds()[self.public.kind].build
        if build is None:
            raise AuthorError(
                f"{self.name}: a question of kind {self.public.kind!r} cannot have `turns`."
            )
        if self.fingerprint_of(self.to_plain(build(self.turns))) != self.fingerprint_of(self.plain):
            raise AuthorError(f"{self.name}: the product of the `turns` is not the right answer.")

    def _demand_notes(self) -> None:
        """Reject hints and credit for unknown mistakes, which nobody would ever get."""
        notes = dict.fromkeys(mistake.note for mistake in self.mistakes)
        texts = [mistake.details["text"] for mistake in self.mistakes if mistake.note == "authored"]
        for argument, keys, known in (
            ("hints", self.hints, [*notes, *texts]),
            ("credit", self.credit, [*notes, "help"]),
        ):
            for key in keys:
                if key not in known:
                    raise AuthorError(
                        f"{self.name}: `{argument}` names {key!r}, but this question has no "
                        "such mistake. Its mistakes are "
                        f"{', '.join(repr(mistake) for mistake in known)}."
                    )

    def _catalogued(self) -> list[Mistake]:
        if self.public.kind != "function":
            return catalogued_mistakes(self.public, self.answer, self.turns, self.turned)
        inner = replace(self.public, kind=self.public.kind_of_values)
        results = [self.answer(*arguments) for arguments in calls_for(self.public) or ()]
        columns = [
            {
                (mistake.note, json.dumps(mistake.details)): mistake.answer
                for mistake in catalogued_mistakes(inner, result)
            }
            for result in results
        ]
        shared = [known for known in columns[0] if all(known in column for column in columns)]
        mistakes = []
        for note, details in shared:
            wrong_results = [column[note, details] for column in columns]
            mistakes.append(Mistake(note, json.loads(details), _replay(wrong_results)))
        return mistakes

    def _entries(self) -> dict[str, Entry]:
        right, *wrong = self._known()
        exact = self.public.tolerance is None
        by_text: dict[str, list[_Known]] = {}
        for text in fingerprints(
            self.public, right.reading, 1 if exact else NEARLY, most=MOST_EDGES
        ):
            by_text[text] = [right]
        for answer in wrong:
            for text in fingerprints(self.public, answer.reading, REACH, most=MOST_EDGES_OF_WRONG):
                by_text.setdefault(text, []).append(answer)
        if right.numbers and exact:
            self.near = fingerprints(self.public, right.reading, near=True)
        entries = {}
        for text, known in by_text.items():
            answers = [self._known_answer(answer, alone=len(known) == 1) for answer in known]
            entries[text] = Entry(answers, known[0].plain)
        return entries

    def _known(self) -> list[_Known]:
        """Return the right answer, then every other answer that a mistake leads to."""
        known = [self._one("correct", [], self.plain)]
        for mistake in self.mistakes:
            try:
                answer = self._one(
                    "mistake", [Note(mistake.note, mistake.details)], self.to_plain(mistake.answer)
                )
            except (Fault, Undecidable, NotPlain):
                # The form of such an answer is refused, with a message of its own.
                continue
            same = next((other for other in known if self._same(answer, other)), None)
            if same is None:
                known.append(answer)
            elif (
                same is not known[0]
                and answer.notes[0] not in same.notes
                and mistake.note not in GENERAL
            ):
                same.notes.append(answer.notes[0])
            elif same is known[0] and mistake.note == "authored":
                self.slips.append(
                    f"This authored mistake gives the right answer: {mistake.details['text']}"
                )
        return known

    def _one(self, outcome: str, notes: list[Note], plain: Plain) -> _Known:
        reading = self.read(plain)
        return _Known(outcome, notes, plain, reading, canonical(self.public, reading))

    def _same(self, answer: _Known, other: _Known) -> bool:
        if answer.reading.text is not None or other.reading.text is not None:
            return answer.reading.text == other.reading.text
        # An answer within the tolerance of the right one counts as right.
        return within(
            self.public, answer.numbers, other.numbers, 1 if other.outcome == "correct" else 0.1
        )

    def _known_answer(self, answer: _Known, alone: bool) -> KnownAnswer:
        steps = [
            step
            for note, details in answer.notes
            # An author's hints name a mistake by its words, or all of them by `authored`.
            for key in dict.fromkeys((str(details["text"]) if note == "authored" else note, note))
            for step in self.hints.get(key, [])
        ]
        needed = self.public.tolerance is not None and (answer.outcome == "correct" or not alone)
        numbers = [MP.nstr(number, 17) for number in answer.numbers] if needed else []
        return KnownAnswer(answer.outcome, tuple(answer.notes), tuple(steps), tuple(numbers))

    def names_for_others(self) -> list[str]:
        """Return the names by which students with other variants can find this answer."""
        if self.public.exam or kinds()[self.public.kind].by_a_person:
            return []
        common = replace(self.public, salt=salt_of_all(self.name))
        reading = far_from_last_bits(common, read(common, self.plain))
        texts = fingerprints(common, reading, most=MOST_EDGES_FOR_OTHERS)
        return [sealing.name_of(sealing.slow_key(common.salt, text)).hex() for text in texts]

    def sealed(self, code: str | None = None, first: Pages | None = None) -> Sealed:
        """Return what a student receives of the question, as `Sealed`.

        Parameters
        ----------
        code : str, optional
            The code that opens the worked solution for students who give up.
        first : Pages, optional
            The pages of the first variant, `pages` of its question when it was sealed, which are
            not sealed again.

        Nothing of an exam's question is sealed. Students receive the same whatever the answer.
        """
        answer = self.variable or ""
        if self.public.exam:
            salt = hashlib.sha256(f"{self.name} {self.number}".encode()).hexdigest()[:16]
            return Sealed(
                replace(self.public, every_symbol=None, scale=None, salt=salt),
                "",
                self.worth,
                answer,
            )
        secret = sealing.slow_key(self.public.salt, f"pages {self.fingerprint_of(self.plain)}")
        pages = self.pages = Pages(secret, first)
        catalogue = by_short_name(self.public)
        solution = None
        if self.solution:
            solution = pages.add_solution(to_page(self.solution), self.public.variant)
        wanted: list[tuple[str, str, list[bytes], dict[str, Json] | None]] = []
        for text, entry in self.entries.items():
            names = [short_name(*note) for note in entry.notes[:2]]
            # The author's own words for a mistake are not in the catalogue.
            known = all(name in catalogue for name in names)
            plain = (
                len(entry.answers) == 1
                and not entry.answers[0].hints
                and not entry.answers[0].numbers
                and known
            )
            after: dict[str, tuple[str, ...]] = {}
            if entry.outcome == "correct":
                after = {name: tuple(steps) for name, steps in self.after.items()}
                plain = plain and not solution and not after
            if plain:
                wanted.append((text, entry.outcome, names, None))
                continue
            shortened = tuple(replace(answer, notes=answer.notes[:2]) for answer in entry.answers)
            wanted.append((text, entry.outcome, [], Locker(shortened, after).as_json()))
        chosen: list[tuple[str, str, list[bytes], bytes | None]] = []
        for text, outcome, names, content in wanted:
            page_of_solution = solution if outcome == "correct" else None
            page = pages.add(content, page_of_solution) if content else None
            chosen.append((text, outcome, names, page))
        chosen += [(text, "mistake", [], None) for text in self.near]
        if solution and code:
            chosen.append((code_text(code), "mistake", [], solution))
        places = pages.seal(f"{code} {self.public.salt}")
        lockers = []
        for text, outcome, names, page in chosen:
            place = (places[page], page) if page else ()
            key = sealing.slow_key(self.public.salt, text)
            lockers.append(sealing.locker(key, OUTCOMES.index(outcome), names, *place))
        ladder = [
            sealing.seal(step, rung_key(self.public, number))
            for number, step in enumerate(self.ladder)
        ]
        return Sealed(
            self.public,
            sealing.pack(lockers),
            self.worth,
            answer,
            tuple(pages.sealed),
            tuple(ladder),
        )


def ladder_of(public: Question, authored: Iterable[str] | None, turns: Sequence[Turn]) -> list[str]:
    """Return the steps of a ladder: the author's, or where to begin and how the answer is built.

    No secret protects them, so none come from the solution, whose first sentence is often the
    answer.
    """
    if authored is not None:
        return list(authored)
    begin = kinds()[public.kind].begin
    steps = [begin] if begin else []
    if len(turns) > 1:
        steps.append(
            f"It is built of {len(turns)} rotations, one after another. Check each of them alone."
        )
    return steps


class Pages:
    """The pages of a question. Each has its own key, which nobody can make without the answer.

    Parameters
    ----------
    secret : bytes
        Determines the keys. It follows from the answer by the slow hash, which costs one for each
        guess at a page, as for a locker.
    first : Pages, optional
        The pages of the first variant of the question, which all variants share.
    """

    def __init__(self, secret: bytes, first: Pages | None = None) -> None:
        self.secret, self.first = secret, first
        self.contents: dict[bytes, tuple[dict[str, Json], bytes | None]] = {}
        self.sealed: list[str] = []
        self.words: bytes | None = None

    def _key(self, text: str) -> bytes:
        return hashlib.blake2b(
            text.encode("utf8"), key=self.secret, digest_size=sealing.PAGE_KEY
        ).digest()

    def add(self, content: dict[str, Json], solution: bytes | None = None) -> bytes:
        """Add a page once, and return its key. The right answer's page locates the solution."""
        text = json.dumps(content, ensure_ascii=False, sort_keys=True)
        if self.first:
            shared = self.first._key(text)
            if self.first.contents.get(shared) == (content, solution):
                return shared
        key = self._key(text)
        self.contents[key] = (content, solution)
        return key

    def add_solution(self, text: str, variants: Variant | None) -> bytes:
        """Add the worked solution; for variants, as the difference from words beside the first."""
        if self.first and self.first.words:
            place = self.first.places()[self.first.words]
            short = sealing.shorten(text, str(self.first.contents[self.first.words][0]["words"]))
            return self.add({"solution": [place, self.first.words.hex(), short]})
        if variants:
            # Leave numbers out. They are what differs, and not everybody may have those of the
            # first variant.
            self.words = self.add({"words": re.sub(r"\d+", "", text)})
        return self.add({"solution": text})

    def places(self) -> dict[bytes, int]:
        """Return each page's place by its key, in a meaningless order after the first variant's."""
        before = self.first.places() if self.first else {}
        start = len(self.first.sealed) if self.first else 0
        return before | {key: place for place, key in enumerate(sorted(self.contents), start=start)}

    def seal(self, code: str) -> dict[bytes, int]:
        """Seal all pages but the first variant's, and return the place of each page by its key.

        The code of the solutions determines which pages are empty.
        """
        places = self.places()
        if len(places) >= sealing.NO_PAGE:
            raise AuthorError(
                "The mistakes, hints and worked solution of a question make "
                f"{len(places)} sealed entries, but only {sealing.NO_PAGE - 1} are possible. "
                "Remove some mistakes or hints."
            )
        for key in sorted(self.contents):
            content, solution = self.contents[key]
            if solution:
                content = {**content, "solution": [places[solution], solution.hex()]}
            self.sealed.append(sealing.seal(content, key))
        if not self.first:
            count = -(-len(self.sealed) // PAGES_TOGETHER) * PAGES_TOGETHER
            self.sealed = sealing.pages_filled_up(self.sealed, count, code)
        return places


def solution_code(notebook: Mapping[str, Any]) -> str:
    """Return the code that opens a notebook's worked solutions, which only its source determines.

    The variants of its questions have the same code.
    """
    texts = json.dumps([cell["source"] for cell in notebook["cells"]], ensure_ascii=False)
    digest = hashlib.sha256(f"code {texts}".encode()).digest()
    letters = "".join(CODE_LETTERS[byte % len(CODE_LETTERS)] for byte in digest[:12])
    return "-".join(letters[start : start + 4] for start in (0, 4, 8))


def _varying_in(rows: Sequence[Sequence[Number]]) -> set[int]:
    """Return the indices of the entries that are positive in one row and negative in another."""
    return {
        place
        for place in range(len(rows[0]) if rows else 0)
        if min(row[place] for row in rows) < -1e-6 and max(row[place] for row in rows) > 1e-6
    }


def _replay(results: Iterable[object]) -> Callable[..., object]:
    """Return a function with a prepared result for each call, like a mistaken function."""
    following = iter(itertools.cycle(results))
    return lambda *arguments: next(following)


def to_page(markdown: str, formula: Callable[[str], str] | None = None) -> str:
    """Convert an author's Markdown to HTML; ``formula`` converts TeX, which otherwise stays."""
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    def written(content: str, options: Mapping[str, bool]) -> str:
        if formula is not None:
            return formula(content)
        mark = "$$" if options["display_mode"] else "$"
        return f"{mark}{html.escape(content, quote=False)}{mark}"

    return str(MarkdownIt().use(dollarmath_plugin, renderer=written).render(markdown))


def _demand_arguments(name: str, given: set[str]) -> None:
    """Reject an argument that `question` does not have."""
    known = [
        parameter.name
        for function in (question, AuthoredQuestion.__init__)
        for parameter in inspect.signature(function).parameters.values()
        if parameter.kind is parameter.KEYWORD_ONLY
    ]
    for argument in sorted(given - set(known)):
        # In nbgrader, the points of a question are called so.
        close = ["worth"] if argument == "points" else difflib.get_close_matches(argument, known, 1)
        raise AuthorError(
            f"{name}: `question` has no argument `{argument}`."
            + (f" Did you mean `{close[0]}`?" if close else "")
        )


def _demand_forms(
    name: str, mistakes: object, hints: Any, after: Any, credit: Any, worth: object
) -> None:
    """Reject arguments whose form is not the one in the manual."""
    for argument, value, example in (
        ("mistakes", mistakes, "{'what the student is told': the_wrong_answer}"),
        ("hints", hints, "{'opposite': ['the first step', 'the second']}"),
        ("after", after, "{'levers/see-saw': ['what helps there']}"),
        ("credit", credit, "{'opposite': 0.5}"),
    ):
        if value is not None and not (
            isinstance(value, dict) and all(isinstance(key, str) for key in value)
        ):
            raise AuthorError(
                f"{name}: `{argument}` must be a dictionary whose keys are strings, such as "
                f"{example}."
            )
    for note, steps in [*(hints or {}).items(), *(after or {}).items()]:
        if not isinstance(steps, (list, tuple)) or not all(isinstance(step, str) for step in steps):
            raise AuthorError(f"{name}: the hints of {note!r} must be a list of strings.")
    for note, share in (credit or {}).items():
        if not _is_number(share) or not 0 <= share <= 1:
            raise AuthorError(
                f"{name}: the credit of {note!r} must be a fraction from 0 to 1, not {share!r}."
            )
    if worth is not None and (not _is_number(worth) or worth < 0):
        raise AuthorError(f"{name}: `worth` must be a number of points, not {worth!r}.")


def _demand_rubric(name: str, rubric: object, worth: float) -> None:
    """Reject a rubric whose lines do not add up to the points of the question."""
    if not isinstance(rubric, dict):
        return
    for line, points in rubric.items():
        if not _is_number(points) or abs(points) > worth:
            raise AuthorError(
                f"{name}: rubric line {line!r} is worth {points!r}, but the question only "
                f"{worth} points."
            )
    earned = sum(points for points in rubric.values() if points > 0)
    if earned < worth:
        raise AuthorError(
            f"{name}: the lines of its rubric add up to {earned} of {worth} points, so nobody "
            "could earn full marks."
        )


def _demand_tolerance(name: str, tolerance: object, relative: object) -> None:
    """Reject a tolerance of zero, since the last digits differ from machine to machine."""
    if tolerance is not None and (not _is_number(tolerance) or tolerance <= 0):
        also = (
            ""
            if relative is None
            else " With `relative`, it is the tolerance for an answer of zero."
        )
        raise AuthorError(f"{name}: `tolerance` must be more than zero, not {tolerance!r}.{also}")
    if relative is not None and (not _is_number(relative) or not 0 < relative < 1):
        raise AuthorError(
            f"{name}: `relative` must be a fraction between 0 and 1, not {relative!r}."
        )


def _demand_calls(name: str, calls: object) -> None:
    if calls is None:
        return
    if (
        not isinstance(calls, (list, tuple))
        or not calls
        or not all(isinstance(call, (list, tuple)) for call in calls)
    ):
        raise AuthorError(
            f"{name}: `calls` must be a list of calls, each a list of arguments; calls=[[1], [2]] "
            f"calls the function with 1, and then with 2. Here it is {calls!r}."
        )


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def question(
    name: str,
    kind: str,
    answer: Any,
    *,
    frames: Iterable[str] | None = None,
    symbols: str | Mapping[str, Iterable[float]] | None = None,
    unit: Any = None,
    shape: Iterable[int] | None = None,
    length: int | None = None,
    options: Iterable[str] | None = None,
    tolerance: float | None = None,
    relative: float | None = None,
    calls: Sequence[Sequence[Any]] | None = None,
    takes: str = "lists",
    result: str | None = None,
    quantity: str | None = None,
    either_sign: bool | None = None,
    unit_vector: bool | None = None,
    mistakes: Mapping[str, Any] | None = None,
    variant: Variant | None = None,
    **rest: Any,
) -> AuthoredQuestion:
    """Build an `AuthoredQuestion` from what its author wrote.

    Raises
    ------
    AuthorError
        The question is not well posed.
    """
    if kind not in kinds():
        raise AuthorError(
            f"{name}: there is no kind {kind!r}. The kinds are {', '.join(sorted(kinds()))}."
        )
    known, values = kinds()[kind], kinds()[result or kind]
    _demand_arguments(name, {*rest} - {*values.arguments})
    _demand_forms(
        name,
        mistakes,
        hints=rest.get("hints"),
        after=rest.get("after"),
        credit=rest.get("credit"),
        worth=rest.get("worth"),
    )
    _demand_tolerance(name, tolerance, relative)
    _demand_calls(name, calls)
    try:
        about = {"kind": kind, **(known.public(answer) if known.public else {})}
    except (TypeError, LookupError, AttributeError, UnknownUnit) as error:
        what = (
            f"`{error}` is not a unit we know."
            if isinstance(error, UnknownUnit)
            else f"Here it is {answer!r}."
        )
        raise AuthorError(
            f"{name}: the right answer cannot be read. For the kind {kind!r}, give a number and "
            f"its unit, such as `(3.2, 'kN m')`. {what}"
        ) from None
    if rest.get("rubric") and not known.by_a_person:
        raise AuthorError(
            f"{name}: only the kind 'free text' has a `rubric`, since a person marks it."
        )
    _demand_rubric(name, rest.get("rubric"), rest.get("worth", 1))
    if rest.get("partial") and kind not in PARTS:
        raise AuthorError(f"{name}: only the kinds {', '.join(PARTS)} can be `partial`.")
    if isinstance(symbols, str):
        symbols = {symbol: ANGLES for symbol in symbols.replace(",", " ").split()}
    ranges = {symbol: list(limits or ANGLES) for symbol, limits in (symbols or {}).items()}
    if tolerance is None and not ranges and not known.text:
        tolerance = TOLERANCE
    for key, value in {
        "frames": list(frames) if frames else None,
        "symbols": ranges,
        "unit": unit,
        "shape": shape and list(shape),
        "length": length,
        **{argument: rest.pop(argument, None) for argument in values.arguments},
        "options": options and list(options),
        "tolerance": tolerance,
        "relative": relative,
        "calls": calls,
        "takes": takes if kind == "function" else None,
        "result": result,
        "quantity": quantity,
        "either sign": either_sign if either_sign is not None else values.either_sign or None,
        "unit vector": unit_vector,
    }.items():
        if value not in (None, {}, []):
            about[key] = value
    for needed in known.needs:
        if needed not in about:
            raise AuthorError(f"{name}: a question of kind {kind!r} needs {needed!r}.")
    if known.text and not (known.another or known.by_a_person or kind in KINDS):
        raise AuthorError(
            f"{name}: the kind {kind!r} of a plug-in has answers in words, so its `Kind` needs "
            "`another`, a function that returns a wrong answer of the right form."
        )
    try:
        public = replace(Question.from_json(about, name), variant=variant)
    except Misread as error:
        raise AuthorError(str(error)) from None
    for symbol, (low, high) in public.symbols.items():
        # This form also rejects NaN.
        if not abs(high - low) <= WIDEST:
            raise AuthorError(
                f"{name}: {symbol!r} is tried from {low:g} to {high:g}, but a range must be at "
                f"most {WIDEST} wide. It need not be realistic: (0.5, 3) will do for any length, "
                "force or stiffness."
            )
    return AuthoredQuestion(name, public, answer, authored=mistakes, **rest)
