"""The sealed questions, found by name.

A name is ``'notebook/question'``; the questions of one notebook lie in one file,
``sealed/notebook.json``. The folder ``sealed`` stands beside the notebook, or in the package of a
plug-in.
"""

import functools
import hashlib
import itertools
import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import TypeVar, cast

from . import sealing
from .catalogue import by_short_name, message
from .evaluate import MP
from .fields import Fields, Json, Misread, anything, by_name, text, whole
from .identity import identity
from .kinds import Blank, Fault, Number, Undecidable
from .plain import Plain
from .plugins import kind_of_values, kinds, sealed_folders
from .points import spellings
from .question import FORMAT, OUTCOMES, KnownAnswer, Locker, Note, Place, Question, Sealed, Variant
from .reading import Reading, canonical, distance, fault, fingerprint, read, tolerances
from .reply import Reply
from .variants import Given, names_of_variants, own_variant, siblings_of, text_of, without_sibling

#: In a folder of sealed questions: where in the web those are that it lacks. Only a
#: browser's Python has such a file.
ELSEWHERE = "elsewhere.txt"
#: Letters and digits of a code that opens worked solutions: none that looks like another.
CODE_LETTERS = "23456789ABCDEFGHJKLMNPQRSTUVWXYZ"
NOT_IN_THIS_CATALOGUE = (
    "This is a mistake that others have made, too, and this version of coursework has no words for "
    "it: install the package that came with the notebook."
)
#: Faults of the form that no right value makes good.
ALWAYS_WRONG = ("not unit length",)
#: The note of an answer in degrees, where radians are asked for.
IN_DEGREES = "in degrees"
#: What is said of it where the question does not tell its unit to the check.
PERHAPS_DEGREES = "Multiplied by $\\pi/180$, this is right. Does the question ask for radians?"
#: Up to so many tolerances from the right answer, its locker opens,
#: and one is told that it is close.
NEARLY = 3
#: The note of an answer that is right for another variant, here and in the marks, and what is said
#: of it.
OTHER_NUMBERS = "other numbers"
FOR_OTHERS = (
    "This is right for other numbers than yours: the default ones, or another student's. Yours "
    "stand in the text of the question, as its cell shows it once it has run."
)
#: As far from it one is told so where the locker has opened all the same: its
#: cell is wider for several numbers.
CLOSE = 30
#: What numbers may be off by that were rounded to two digits after the point.
COARSE = 0.005
#: Denominators up to which a decimal fraction is plainly that fraction: one with few
#: digits, and one with all of them.
SMALL, LARGE = 64, 1000
#: So many decimal fractions of an answer are looked at for an exact length.
MOST_LOOKED_AT = 16


Some = TypeVar("Some")
#: What is known of a fingerprint, or nothing.
Find = Callable[[str], Locker | None]


class NoSuchQuestion(KeyError):
    """There is no question of that name, and the message names the nearest
    one; or its numbers are missing."""

    def __str__(self) -> str:
        return str(self.args[0])


@functools.cache
def notebook_questions(notebook: str, variant: int = 0) -> dict[str, Sealed]:
    """The questions of a notebook, by full name; of another variant than 0 those that have it.

    Raises
    ------
    RuntimeError
        The file is of another format, or is not what it should be.
    """
    found = {}
    try:
        questions = _file(notebook)
        for name, about in (_file(notebook, variant) if variant else questions).items():
            about = _on_the_first(questions[name], about) if variant else about
            found[name] = Sealed.from_json(about, f"The sealed question {name}")
    except ValueError as error:
        cut = f"The sealed questions of {notebook} are no whole file."
        raise RuntimeError(
            f"{error if isinstance(error, Misread) else cut} Unpack the exercises again; what you "
            "have written is kept."
        ) from None
    return found


def _file(notebook: str, variant: int = 0) -> dict[str, dict[str, Json]]:
    """Read what a file of sealed questions says of each of them, by name."""
    if not re.fullmatch("[a-z0-9-]{1,60}", notebook):
        return {}
    name = f"variants/{notebook}-{variant}.json" if variant else f"{notebook}.json"
    content = next(
        (file.read_text("utf8") for folder in places() if (file := folder / name).is_file()), None
    )
    if content is None and variant:
        from .elsewhere import fetched

        content = next(
            (fetched(file, name) for folder in places() if (file := folder / ELSEWHERE).is_file()),
            None,
        )
    if content is None:
        return {}
    about = Fields(json.loads(content), f"The sealed questions of {notebook}")
    format = about.get("format", whole)
    if format != FORMAT:
        from .. import __version__

        raise RuntimeError(
            f"The sealed questions of {notebook} are of format {format}, and this is coursework "
            f"{__version__}, which reads format {FORMAT}. Install the package that came with the "
            "notebook: `python -m coursework update exercises.zip` says how."
        )
    return about.get("questions", by_name(by_name(anything)))


def _on_the_first(first: Mapping[str, Json], own: Mapping[str, Json]) -> dict[str, Json]:
    """A variant, of which only what differs from the first one is kept, as :func:`beside` does."""
    pages = [
        page
        for one in (first, own)
        if isinstance(found := one.get("pages"), list)
        for page in found
    ]
    return {
        name: value
        for name, value in {**first, **own, "pages": pages or None}.items()
        if value is not None
    }


def places() -> list[Traversable]:
    """Where sealed questions may lie: the folder ``sealed`` beside the
    notebook, and those of plug-ins.
    """
    beside = Path("sealed")
    return [*([beside] if beside.is_dir() else []), *sealed_folders()]


def find_question(name: str, student: str) -> Sealed:
    """Give a question by its full name, in the variant of a student; a sibling by its own name.

    Raises
    ------
    NoSuchQuestion
    """
    if not isinstance(name, str):
        raise NoSuchQuestion(
            "The name of a question is a text and comes first: `check('notebook/question', "
            "answer)`. "
            f"This is of type `{type(name).__name__[:40]}`."
        )
    notebook, _, _ = name.partition("/")
    questions = notebook_questions(notebook)
    asked, order = without_sibling(name)
    if asked in questions:
        siblings = siblings_of(asked, questions[asked].question.variants)
        if order > len(siblings):
            there = (
                f"its siblings are {' and '.join(siblings)}"
                if siblings
                else "it has no other numbers"
            )
            raise NoSuchQuestion(f"There is no '{name}': of '{asked}', {there}.")
        number = own_variant(student, asked, questions[asked].question, order)
        of_variant = notebook_questions(notebook, number)
        if asked not in of_variant:
            raise NoSuchQuestion(
                f"Your numbers of '{asked}' are missing: they stand in `variants/{notebook}-"
                f"{number}.json` in the folder `sealed`. Unpack the exercises again; what you have "
                "written is kept."
            )
        of_question = of_variant[asked].question
        if unknown := {of_question.kind, of_question.kind_of_values} - set(kinds()):
            raise RuntimeError(
                f"'{asked}' is of a kind that is not known here, {unknown.pop()!r}: install the "
                "package that came with the notebook."
            )
        return of_variant[asked]
    found = [file.name for folder in places() for file in folder.iterdir()]
    if not found:
        raise NoSuchQuestion(
            f"There is no question '{name[:80]}', and no other: the folder `sealed` that came with "
            f"this notebook is not beside it (in {Path.cwd()}), and no package with sealed "
            "questions is installed."
        )
    notebooks = sorted(file.removesuffix(".json") for file in found if file.endswith(".json"))
    if name in notebooks:
        raise NoSuchQuestion(
            f"'{name}' is a notebook. Its questions are {', '.join(map(repr, questions))}."
        )
    import difflib  # needed here alone

    near = difflib.get_close_matches(
        name.lower(), [*(questions or notebook_questions(notebook.lower())), *notebooks], cutoff=0.5
    )
    raise NoSuchQuestion(
        f"There is no question '{name[:80]}'." + (f" Did you mean '{near[0]}'?" if near else "")
    )


def variant(name: str) -> Given:
    """Show your variant of a question, and give its numbers.

    Parameters
    ----------
    name : str
        The question, as its check names it; with ``/sibling`` after it, the same question with
        other numbers.

    Returns
    -------
    Given

    Raises
    ------
    NoSuchQuestion
        If the name is misspelt.
    """
    found = find_question(name, identity()).question.variant or Variant()
    return Given(text_of(found), found.given)


def own_numbers(name: str, student: str) -> tuple[int, str]:
    """The variant in which a student finds a question, or a sibling,
    and what its numbers are called.

    0 and nothing where there is only one, and for a question of another release; no name where the
    variant cannot be had, as without a network.
    """
    (asked, order), notebook = without_sibling(name), name.partition("/")[0]
    number = 0
    with suppress(RuntimeError, KeyError):
        number = own_variant(student, asked, notebook_questions(notebook)[asked].question, order)
        variant = notebook_questions(notebook, number)[asked].question.variant
        return number, names_of_variants([variant])[0] if variant else ""
    return number, ""


def beside(question: Mapping[str, Json], first: Mapping[str, Json]) -> dict[str, Json]:
    """What of a sealed variant differs from the first one: that is all that is kept of it.

    Its pages are those that the first one has not, and follow upon them.

    >>> first = {'kind': 'vector', 'salt': 'a', 'ladder': []}
    >>> beside({'kind': 'vector', 'salt': 'b', 'shown': {'arm': '2'}}, first)
    {'salt': 'b', 'shown': {'arm': '2'}, 'ladder': None}
    """
    return {
        name: question.get(name)
        for name in {**question, **first}
        if question.get(name) != first.get(name)
    }


def judge(name: str, sealed: Sealed, plain: Plain, student: str = "") -> Reply:
    """Compare an answer, as plain data, with what is sealed; the reply holds what it opened.

    What a classmate has answered is looked for where somebody has said who works here: it costs a
    slow hash, and others have no numbers of their own.
    """
    if sealed.question.exam:
        return compare(name, sealed.question, plain, None)
    for_others = (
        functools.partial(is_right_for_others, sealed, plain) if student and sealed.others else None
    )
    return compare(name, sealed.question, plain, functools.partial(opened, sealed), for_others)


def salt_of_all(name: str) -> str:
    """The salt that all variants of a question have in common: for what is right in one of them."""
    return hashlib.sha256(f"{name}, all variants".encode()).hexdigest()[:16]


def is_right_for_others(sealed: Sealed, plain: Plain) -> bool:
    """Whether a wrong answer is right in some other variant of the
    question, as a classmate's pasted one is.
    """
    if not sealed.others:
        return False
    salt, names = sealed.others
    common = replace(sealed.question, salt=salt)
    try:
        known = fingerprint(common, read(common, plain))
    except (Blank, Fault, Undecidable):
        return False
    return sealing.is_among(names, sealing.slow_key(salt, known))


def code_text(code: str) -> str:
    """What is hashed of a code that opens worked solutions, however it is typed."""
    return "code " + "".join(letter for letter in code.upper() if letter in CODE_LETTERS)


def rung_key(question: Question, number: int) -> bytes:
    """The key of a step of the ladder of hints: no secret, it only keeps the
    step from being read in passing.
    """
    return hashlib.sha256(f"step {number} for {question.kind}".encode()).digest()[
        : sealing.PAGE_KEY
    ]


def opened(sealed: Sealed, fingerprint: str) -> Locker | None:
    """What the locker of a fingerprint holds, or ``None``."""
    found = sealing.open_locker(sealed.lockers, sealing.slow_key(sealed.question.salt, fingerprint))
    if found is None:
        return None
    outcome, page, inside = found
    if page is not None:
        place = Place(page, inside.hex())
        return Locker.from_json(open_page(sealed, place), f"Page {page}", place)
    known = by_short_name(sealed.question)
    unknown = Note("authored", {"text": NOT_IN_THIS_CATALOGUE})
    notes = [known.get(name, unknown) for name in sealing.mistakes_in(inside)]
    return Locker((KnownAnswer(OUTCOMES[outcome], tuple(notes)),))


def open_page(sealed: Sealed, place: Place) -> object:
    """What stands on a page, as JSON."""
    return sealing.unseal(sealed.pages[place.page], bytes.fromhex(place.key))


def solution_on(sealed: Sealed, solution: Place | str) -> str:
    """The worked solution as HTML, from where it stands.

    That of a variant is what differs from words that all variants have
    in common, on a page of their own.
    """
    if isinstance(solution, str):
        return solution
    page = open_page(sealed, solution)
    if solution.short:
        return sealing.lengthen(solution.short, Fields(page, "A page").get("words", text))
    return solution_on(sealed, Locker.from_json(page, "A page").solution or "")


def compare(
    name: str,
    question: Question,
    plain: Plain,
    find: Find | None,
    for_others: Callable[[], bool] | None = None,
) -> Reply:
    """Compare an answer, as plain data, with what is known of a question. Gives the reply.

    Parameters
    ----------
    name : str
    question : Question
    plain : dict
    find : function or None
        ``None`` where there is nothing to compare with, as in an exam: then only the form of the
        answer is looked at. It gives the locker of a fingerprint, or ``None``.
    for_others : function, optional
        It says of an answer that is not known whether it is right for other numbers. It is asked at
        once, beside ``find``, where two things can be done at a time.
    """
    try:
        reading = read(question, plain)
        if kinds()[question.kind].by_a_person:
            words = len(cast(str, reading.text).split())
            said = (
                f"A person will read this text of {words} {'word' if words == 1 else 'words'} and "
                "decide."
            )
            return Reply(name, "undecided", "for a person", [said])
        text = fingerprint(question, reading)
        if find is None:
            reply = _taken_down(name, question, reading)
        else:
            reply = _compare(name, question, plain, reading, text, find, for_others)
        reply.answer = hashlib.sha256(text.encode()).hexdigest()[:12]
        return reply
    except Blank:
        return Reply(
            name,
            "not attempted",
            "",
            ["Put your answer in place of the `...` and run the cells again."],
        )
    except Fault as found:
        return Reply(name, "invalid", found.note, [found.message])
    except Undecidable as found:
        return Reply(
            name,
            "undecided",
            "undecidable",
            [f"{found} Try another form, or ask your instructor to look at it."],
        )


def _taken_down(name: str, question: Question, reading: Reading) -> Reply:
    found = fault(question, reading)
    if found:
        return Reply(name, "invalid", found.note, [found.message])
    return Reply(
        name,
        "recorded",
        "",
        [
            "Your answer can be read, and has the right form. "
            "It is marked later: nothing that you have tells whether it is right."
        ],
    )


def _compare(
    name: str,
    question: Question,
    plain: Plain,
    reading: Reading,
    fingerprint: str,
    find: Find,
    for_others: Callable[[], bool] | None,
) -> Reply:
    for_others = _begun(for_others) if for_others else None
    locker = find(fingerprint)
    known = _known_in(question, reading, locker)
    wrong_form = fault(question, reading) if known is None or known.outcome == "correct" else None
    if wrong_form and (known is None or wrong_form.note in ALWAYS_WRONG):
        # What comes of rounding is not called a fault of geometry.
        stray = wrong_form.note == "stray symbol"
        said = "" if stray else _decimals(question, plain, reading) or _coarse(question, reading)
        return Reply(
            name,
            "invalid",
            wrong_form.note,
            [said, wrong_form.message] if said else [wrong_form.message],
        )
    if known is None:
        return _not_known(name, question, plain, reading, find, locker, for_others)
    if known.outcome == "correct":
        return Reply(name, "correct", opened=locker)
    note, details = known.notes[0]
    return Reply(
        name,
        "wrong",
        note,
        [message(question, note, details)],
        opened=locker,
        known=known,
        details=details,
    )


def _close(name: str, question: Question) -> Reply:
    """The reply to an answer that rounding has made wrong, or seems to have."""
    allowed = "" if question.tolerance is None else f" the {question.tolerance:g} that is"
    said = (
        f"This is close, but off by more than{allowed} allowed. If you rounded, here or on the "
        "way, keep all digits until the end."
    )
    return Reply(name, "wrong", "rounded too far", [said])


def _known_in(question: Question, reading: Reading, locker: Locker | None) -> KnownAnswer | None:
    """Which of the answers of a locker this is: the nearest, if
    that is near enough; or ``None``.
    """
    if locker is None or not locker.answers:
        return None
    far = [_far(question, reading, known) for known in locker.answers]
    least = min(far)
    return locker.answers[far.index(least)] if least <= 1 else None


def _far(question: Question, reading: Reading, known: KnownAnswer) -> Number:
    return (
        MP.zero
        if not known.numbers
        else distance(
            question, canonical(question, reading), [MP.mpf(number) for number in known.numbers]
        )
    )


def _not_known(
    name: str,
    question: Question,
    plain: Plain,
    reading: Reading,
    find: Find,
    locker: Locker | None,
    for_others: Callable[[], bool] | None,
) -> Reply:
    """The reply to an answer that is neither right nor a mistake of the catalogue."""
    if locker is not None and any(
        known.outcome == "correct" and _far(question, reading, known) <= CLOSE
        for known in locker.answers
    ):
        return _close(name, question)
    decimals = _decimals(question, plain, reading)
    # Each look costs a slow hash: what is exact was not rounded, and what was rounded
    # is no known mistake to the digit.
    precise, rounded = _precision(plain) if decimals else (True, False)
    near = [fingerprint(question, reading, near=True)] if not precise else []
    others = [] if rounded else list(other_readings(question, reading))
    texts = near + [fingerprint(question, turned) for _, _, turned in others]
    lockers = _each(find, texts)
    if for_others and for_others():
        return Reply(name, "wrong", OTHER_NUMBERS, [FOR_OTHERS])
    if near and lockers.pop(0) is not None:
        return Reply(
            name,
            "wrong",
            "rounded too far",
            [
                "This agrees with the exact answer to about three digits, but the question asks "
                "for an exact answer.",
                decimals,
            ],
        )
    for (slip, why, turned), of_slip in zip(others, lockers):
        known = _known_in(question, turned, of_slip)
        if known and known.outcome == "correct" and slip == IN_DEGREES:
            said = message(question, slip, {}) if question.quantity else PERHAPS_DEGREES
            return Reply(name, "wrong", slip, [said])
        if known and known.outcome != "correct" and (question.quantity or slip != IN_DEGREES):
            note, details = known.notes[0]
            if note == slip:
                # What is right once a slip is undone twice is the right answer
                # itself, but for the last digits.
                return _close(name, question)
            said = f"Two things at once: {why} {message(question, note, details)}"
            return Reply(name, "wrong", f"{slip}, and {note}", [said], details=details)
    # Whoever has rounded right work hears of that first, and not that the value is wrong.
    few = _few_digits(question, plain)
    right = what_can_be_said(question, plain)
    lines = [decimals, few, f"Otherwise: {right[:1].lower()}{right[1:]}" if few else right]
    if question.symbols and not any(node[0] == "symbol" for node in plain["nodes"]):
        lines = [right]
    return Reply(name, "wrong", "", [" ".join(filter(None, lines))])


def _begun(work: Callable[[], Some]) -> Callable[[], Some]:
    """Begin some work in a thread, since the slow hash lets others run; what it
    gives comes when it is asked for.
    """
    from concurrent.futures import ThreadPoolExecutor  # needed here alone

    threads = ThreadPoolExecutor(1)
    try:
        return threads.submit(work).result
    except RuntimeError:  # a browser's Python has no threads: then it is done if it is asked for
        return work
    finally:
        threads.shutdown(wait=False)


def _each(find: Find, texts: Sequence[str]) -> list[Locker | None]:
    """What is known of each fingerprint, all looked up at once."""
    if len(texts) < 2:
        return [find(text) for text in texts]
    begun = [_begun(functools.partial(find, text)) for text in texts]
    return [found() for found in begun]


def other_readings(question: Question, reading: Reading) -> Iterator[tuple[str, str, Reading]]:
    """The answer with one common slip undone, by what is said of the
    slip: it may be a known mistake then.
    """
    if reading.text is None:
        for name, (said, undo) in kind_of_values(question).slips.items():
            numbers = [undo(question, numbers) for numbers in reading.numbers]
            if None not in numbers:
                yield name, said, Reading(numbers)
        # Without a quantity the question may ask for degrees: then only the right answer counts.
        angles = question.quantity in (None, "angle")
        if angles and question.kind_of_values in ("expression", "vector", "matrix"):
            said = "it is in degrees, and in radians it has another mistake."
            radians = [[number * MP.pi / 180 for number in numbers] for numbers in reading.numbers]
            yield IN_DEGREES, said, Reading(radians)


def _decimals(question: Question, plain: Plain, reading: Reading) -> str:
    if not (question.tolerance is None and reading.text is None) or not any(
        node[0] == "float" for node in plain["nodes"]
    ):
        return ""
    exact_forms = "`sm.Rational(1, 2)` and `sm.sqrt(3)`"
    return (
        "Your answer has decimal fractions, but the question asks for an exact one: write "
        f"{exact_forms}."
    )


def _few_digits(question: Question, plain: Plain) -> str:
    """What is said of numbers that are given to fewer places than the answer
    may be off by: they may be rounded.

    It follows from what the student wrote and from the tolerance alone, so it tells nothing of the
    right answer. Components that make an exact length together, such as 0.6 and 0.8, are exact.
    """
    if question.tolerance is None:
        return ""
    absolute, relative = (float(part) for part in tolerances(question))
    floats = [str(node[1]) for node in plain["nodes"] if node[0] == "float"]
    floats = [digits for digits in floats if "e" not in digits][:MOST_LOOKED_AT]
    squares = [Fraction(digits) ** 2 for digits in floats if float(digits)]
    lengths = [
        sum(squares, Fraction()),
        *(one + other for one, other in itertools.combinations(squares, 2)),
    ]
    if len(squares) > 1 and any(map(_is_square, lengths)):
        return ""
    for digits in floats:
        places = len(digits.partition(".")[2])
        allowed = absolute + relative * abs(float(digits))
        if 0.5 * 10.0**-places > allowed and Fraction(digits).denominator > 4:
            count = f"{places} place{'' if places == 1 else 's'}"
            return (
                f"If you rounded, keep all digits until the end: `{float(digits):g}` has {count}, "
                f"and an answer may be off by {allowed:.1g}."
            )
    return ""


def _is_square(number: Fraction) -> bool:
    """Whether a fraction is the square of another."""
    return all(math.isqrt(part) ** 2 == part for part in (number.numerator, number.denominator))


def _coarse(question: Question, reading: Reading) -> str:
    """What is said of numbers that do not fit together, and would
    if fewer of their digits counted.
    """
    if question.tolerance is None or fault(replace(question, tolerance=COARSE), reading):
        return ""
    return "The numbers nearly fit together. If you rounded, keep all digits until the end."


def _precision(plain: Plain) -> tuple[bool, bool]:
    """Of the decimal fractions of an answer: whether each is plainly exact, and
    whether one of them is plainly rounded.

    >>> numbers = lambda *texts: {"nodes": [["float", text] for text in texts]}
    >>> _precision(numbers("0.5", "0.8660254037844386")), _precision(numbers("0.5", "0.866"))
    ((True, False), (False, True))
    """
    precise, rounded = True, False
    for node in plain["nodes"]:
        if node[0] == "float":
            size = abs(float(node[1]))
            short = float(f"{size:.8g}") == size
            most = SMALL if short else LARGE
            # A root of a fraction has all of its digits.
            numbers = [size] if short else [size, size * size]
            if not any(
                abs(one - Fraction(one).limit_denominator(most)) <= 1e-13 * max(1, one)
                for one in numbers
            ):
                precise, rounded = False, rounded or short
    return precise, rounded


def what_can_be_said(question: Question, plain: Plain) -> str:
    """What a wrong answer has right, so that its author does not look for the fault there."""
    named = {node[1] for node in plain["nodes"] if node[0] == "symbol"}
    missing = [symbol for symbol in question.symbols if not {symbol, *spellings(symbol)} & named]
    symbols = ", ".join(f"`{symbol}`" for symbol in question.symbols)
    if symbols and not named:
        return f"The question is asked with {symbols}, and your answer holds numbers only."
    said = kind_of_values(question).wrong
    if question.every_symbol and missing:
        said += f" It holds no {' and no '.join(f'`{symbol}`' for symbol in missing)}."
    return said
