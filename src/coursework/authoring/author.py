"""What an author writes of a question, and what is sealed of it.

In the notebook with the solutions, the cell that checks an answer goes on, between nbgrader's marks for
hidden tests, with a call of :func:`question`:

.. code-block:: python

    check('simple-orientations/about-x', A_C_N)
    ### BEGIN HIDDEN TESTS
    question('simple-orientations/about-x', kind='direction cosine matrix', frames=('A', 'N'),
             symbols='theta', turns=[('x', theta)], worth=2,
             solution='The shared axis is $x$, so ...')
    ### END HIDDEN TESTS

CONTRIBUTING.md explains each argument with an example.
"""

import hashlib
import html
import itertools
import json
import math
from typing import NamedTuple

from ..checking import sealing
from ..checking.evaluate import MP
from ..checking.kinds import Blank, Fault, Undecidable, calls_for, canonical, cell_of, cells, fingerprint, read
from ..checking.mistakes import Mistake
from ..checking.mistakes import mistakes as catalogued_mistakes
from ..checking.plain import NotPlain, to_plain
from ..checking.plugins import kinds
from ..checking.points import ANGLES

#: What answers without symbols may be off by, if the question says nothing: three decimals are enough.
TOLERANCE = 5e-4
#: Farther from the edge of a cell than this, a value rounded to four decimals stays in its cell.
EDGE = 0.05


class AuthorError(ValueError):
    """A question is not well posed; the message says which and why."""


class Entry(NamedTuple):
    """What one fingerprint stands for: an outcome, the mistakes that lead to it, and one such answer."""

    outcome: str
    notes: list
    plain: dict


class Question:
    """A question with everything its author knows of it.

    Attributes
    ----------
    name : str
    public : dict
        What a student's computer may know.
    answer : object
        The right answer.
    worth : int
    credit : dict
        Share of the worth for a mistake, by its note.
    entries : dict
        :class:`Entry` by fingerprint: the right answer and every mistake that differs from it.
    """

    def __init__(
        self,
        name,
        public,
        answer,
        *,
        variable=None,
        worth=1,
        credit=None,
        hints=None,
        after=None,
        solution="",
        title="",
        turns=(),
        turned=None,
        authored=None,
    ):
        self.name, self.public, self.answer, self.variable = name, public, answer, variable
        self.worth, self.credit, self.title = (
            worth,
            dict(credit or {}),
            title or name.partition("/")[2].replace("-", " "),
        )
        self.hints, self.after, self.solution = dict(hints or {}), dict(after or {}), solution
        self.turns, self.turned = list(turns), turned
        self.plain = self.to_plain(answer)
        self.public.setdefault("salt", None)
        held = {node[1] for node in self.plain["nodes"] if node[0] == "symbol"}
        if self.public.get("symbols") and held >= set(self.public["symbols"]):
            self.public["every symbol"] = True
        self._settle_points()
        self._demand_turns()
        # What the author says of a mistake is closer to the question than what the catalogue says of it.
        self.mistakes = [
            *(Mistake("authored", {"text": text}, wrong) for text, wrong in (authored or {}).items()),
            *self._catalogued(),
        ]
        self.entries = self._entries()

    def to_plain(self, answer):
        return to_plain(answer, calls_for(self.public))

    def fingerprint_of(self, plain):
        return fingerprint(self.public, read(self.public, plain))

    def _settle_points(self):
        """Choose the salt, and with it the points, so that the answer lies well inside its cells."""
        # Each variant has a salt of its own, so that a guess is worth nothing for the others.
        number = self.public.get("variant", 0)
        seed = f"{self.name} variant {number}" if number else self.name
        for attempt in range(50):
            self.public["salt"] = hashlib.sha256(f"{seed} {attempt}".encode()).hexdigest()[:16]
            self.public.pop("shift", None)
            try:
                reading = read(self.public, self.plain)
                numbers = canonical(self.public, reading) if reading.text is None else []
            except (Blank, Fault, Undecidable) as error:
                raise AuthorError(f"{self.name}: the right answer cannot be read. {error}") from None
            shares = [number / cell_of(self.public) for number in numbers]
            if self.public.get("tolerance") is not None:
                # One bit for each number: whether its cells are moved by half a cell.
                self.public["shift"] = "".join("01"[abs(share - MP.nint(share)) > 0.25] for share in shares)
                return
            if all(abs(abs(share - MP.nint(share)) - 0.5) > 1e-3 for share in shares):
                return
        raise AuthorError(f"{self.name}: no points were found at which the answer is not on the edge of a cell.")

    def _demand_turns(self):
        if not self.turns:
            return
        build = kinds()[self.public["kind"]].build
        if build is None:
            raise AuthorError(f"{self.name}: an answer of the kind {self.public['kind']!r} is not made of turns.")
        built = self.to_plain(build(self.turns))
        if self.fingerprint_of(built) != self.fingerprint_of(self.plain):
            raise AuthorError(f"{self.name}: the turns do not give the right answer.")

    def _catalogued(self):
        if self.public["kind"] != "function":
            return catalogued_mistakes(self.public, self.answer, self.turns, self.turned)
        inner = {**self.public, "kind": self.public["result"]}
        results = [self.answer(*arguments) for arguments in calls_for(self.public)]
        columns = [
            {(found.note, json.dumps(found.details)): found.answer for found in catalogued_mistakes(inner, result)}
            for result in results
        ]
        shared = [known for known in columns[0] if all(known in column for column in columns)]
        return [
            Mistake(note, json.loads(details), _replay([column[note, details] for column in columns]))
            for note, details in shared
        ]

    def _entries(self):
        right = self.fingerprint_of(self.plain)
        entries = {right: Entry("correct", [], self.plain)}
        for mistake in self.mistakes:
            try:
                plain = self.to_plain(mistake.answer)
                fingerprints = self._fingerprints(plain)
            except (Fault, Undecidable, NotPlain):
                continue  # such an answer is refused for its form, which is a message of its own
            if right in fingerprints:
                continue  # on this question the mistake makes no difference
            for text in fingerprints:
                known = entries.setdefault(text, Entry("mistake", [], plain))
                if [mistake.note, mistake.details] not in known.notes:
                    known.notes.append([mistake.note, mistake.details])
        return entries

    def _fingerprints(self, plain):
        """The fingerprint of a mistake, and its neighbours where rounding might cross the edge of a cell."""
        reading = read(self.public, plain)
        if reading.text is not None or self.public.get("tolerance") is None:
            return [fingerprint(self.public, reading)]
        numbers, cell = canonical(self.public, reading), cell_of(self.public)
        choices, spare = [], 3
        for number, middle in zip(numbers, cells(self.public, numbers)):
            options = {middle}
            if spare:
                options |= set(cells_near(self.public, number, len(choices), EDGE * cell))
                spare -= len(options) > 1
            choices.append(sorted(options))
        return [" ".join(map(str, chosen)) for chosen in itertools.product(*choices)]

    def sealed(self):
        """What a student receives of the question: its public part and its lockers."""
        contents = {text: {"outcome": entry.outcome, "notes": entry.notes} for text, entry in self.entries.items()}
        keys = {text: sealing.slow_key(self.public["salt"], text) for text in contents}
        length = max(
            len(sealing.base64.b64decode(sealing.seal(content, keys[text]))) - 16 for text, content in contents.items()
        )
        lockers = {
            sealing.locker(keys[text]): sealing.seal(content, keys[text], length=length)
            for text, content in contents.items()
        }
        beside = {}
        for text, entry in self.entries.items():
            for purpose, content in self._beside(entry).items():
                beside[sealing.locker(keys[text], purpose)] = sealing.seal(content, keys[text], purpose)
        sealed = {**self.public, "lockers": dict(sorted(lockers.items()))}
        if beside:
            sealed["beside"] = dict(sorted(beside.items()))
        return sealed

    def _beside(self, entry):
        if entry.outcome == "correct":
            found = {"solution": to_page(self.solution)} if self.solution else {}
            if self.after:
                found["hints"] = self.after
            return found
        steps = [step for note, _ in entry.notes for step in self.hints.get(note, [])]
        return {"hints": {self.name: steps}} if steps else {}

    def guessing_bits(self):
        """About how many bits a student must guess who tries answers instead of finding one."""
        public, kind = self.public, self.public["kind"]
        symbols = max(1, len(public.get("symbols", {})))
        if kind == "choice":
            return math.log2(len(public["options"]))
        if kind == "words":
            return public["length"] * math.log2(len(public["options"]))
        if kind == "truth values":
            return public["length"]
        if kind == "sequence":
            return math.log2(12)
        if self.turns:
            # Each turn about one of three axes, either way round, through any of the angles.
            return len(self.turns) * math.log2(6 * max(symbols, len(self.turns)))
        if public.get("tolerance") is not None and kind != "function":
            freedom = {"direction cosine matrix": 3, "quaternion": 3, "Euler angles": 3, "axis and angle": 3}.get(
                kind, len(self.public.get("shift", "1"))
            )
            return freedom * math.log2(2 / float(cell_of(public)))
        # As many as it takes to write the answer down, from eight operations and the symbols.
        plain = self.plain if kind != "function" else None
        return min(256, 3 * len(plain["nodes"])) if plain else 64


def cells_near(public, number, order, distance):
    near = {**public, "shift": public.get("shift", "")[order : order + 1]} if public.get("shift") else public
    return [cells(near, [number + side * distance])[0] for side in (-1, 1)]


def _replay(results):
    """A function that gives prepared results, one for each call: what a mistaken function would return."""
    following = iter(itertools.cycle(results))
    return lambda *arguments: next(following)


def to_page(markdown):
    """Markdown of an author as HTML."""
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    def formula(content, options):
        mark = "$$" if options["display_mode"] else "$"
        return f"{mark}{html.escape(content, quote=False)}{mark}"

    return MarkdownIt().use(dollarmath_plugin, renderer=formula).render(markdown)


def question(
    name,
    kind,
    answer,
    *,
    frames=None,
    symbols=None,
    unit=None,
    shape=None,
    length=None,
    options=None,
    tolerance=None,
    calls=None,
    takes="lists",
    result=None,
    quantity=None,
    either_sign=None,
    unit_vector=None,
    mistakes=None,
    variant=None,
    **rest,
):
    """Build a :class:`Question` from what its author wrote.

    Raises
    ------
    AuthorError
        The question is not well posed.
    """
    if kind not in kinds():
        raise AuthorError(f"{name}: the kind {kind!r} is none of {sorted(kinds())}.")
    known, values = kinds()[kind], kinds()[result or kind]
    public = {"kind": kind, **(variant or {})}
    if isinstance(symbols, str):
        symbols = {symbol: ANGLES for symbol in symbols.replace(",", " ").split()}
    symbols = {symbol: list(limits or ANGLES) for symbol, limits in (symbols or {}).items()}
    if tolerance is None and not symbols and not known.text:
        tolerance = TOLERANCE
    for key, value in {
        "frames": list(frames) if frames else None,
        "symbols": symbols,
        "unit": unit,
        "shape": shape and list(shape),
        "length": length,
        **{argument: rest.pop(argument, None) for argument in values.arguments},
        "options": options and list(options),
        "tolerance": tolerance,
        "calls": calls,
        "takes": takes if kind == "function" else None,
        "result": result,
        "quantity": quantity,
        "either sign": either_sign if either_sign is not None else values.either_sign or None,
        "unit vector": unit_vector,
    }.items():
        if value not in (None, {}, []):
            public[key] = value
    for needed in known.needs:
        if needed not in public:
            raise AuthorError(f"{name}: a question of kind {kind!r} needs {needed!r}.")
    return Question(name, public, answer, authored=mistakes, **rest)
