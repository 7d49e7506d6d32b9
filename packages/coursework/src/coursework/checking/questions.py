"""Find the sealed questions by name.

A name is ``'notebook/question'``; the questions of one notebook are in one file,
``sealed/notebook.json``. The folder ``sealed`` is beside the notebook, or in the package of a
plug-in.
"""

import functools
import hashlib
import itertools
import json
import math
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import cast

from . import sealing
from .catalogue import by_short_name, message, message_of_all
from .evaluate import MP
from .fields import Fields, Json, Misread, anything, by_name, text, whole
from .identity import identity
from .kinds import Blank, Fault, Number, Undecidable, number_of
from .plain import Plain
from .plugins import kind_of_values, kinds, sealed_folders
from .points import spellings
from .question import FORMAT, OUTCOMES, KnownAnswer, Locker, Note, Place, Question, Sealed, Variant
from .reading import Reading, canonical, distance, fault, fingerprint, read, tolerances
from .reply import Reply
from .variants import Given, names_of_variants, own_variant, siblings_of, text_of, without_sibling

# The names of notebooks, from which students' machines make the names of files.
NOTEBOOK = re.compile("[a-z0-9-]{1,60}")
# A file in a folder of sealed questions with the address of the missing ones. Only a browser's
# Python has it.
ELSEWHERE = "elsewhere.txt"
# Letters and digits of a code that opens worked solutions, without those that look alike.
CODE_LETTERS = "23456789ABCDEFGHJKLMNPQRSTUVWXYZ"
NOT_IN_THIS_CATALOGUE = (
    "This is a known mistake, but this version of coursework has no message for it. Install the "
    "package that came with the notebook."
)
# Faults of the form that no right value excuses.
ALWAYS_WRONG = ("not unit length",)
# The note of an answer in degrees, where radians are required.
IN_DEGREES = "in degrees"
# Its message if the check does not know the unit of the question.
PERHAPS_DEGREES = "Multiplied by $\\pi/180$, this is right. Does the question ask for radians?"
# The distance from the right answer, in tolerances, within which its locker opens and the student
# is told that the answer is close.
NEARLY = 3
# The note of an answer that is right for another variant, here and in the marks, and its message.
OTHER_NUMBERS = "other numbers"
FOR_OTHERS = (
    "This is right for numbers other than yours: the default ones, or another student's. Run "
    "the question's cell to see yours in its text."
)
# The distance within which this applies if the locker has opened nevertheless, because its cell is
# wider for several numbers.
CLOSE = 30
# The possible error of numbers that were rounded to two decimals.
COARSE = 0.005
# The denominators up to which a decimal fraction is clearly that fraction: one with few digits, and
# one with all of them.
SMALL, LARGE = 64, 1000
# The number of decimal fractions of an answer that are searched for an exact length.
MOST_LOOKED_AT = 16


# A function that returns what is known of a fingerprint, or nothing.
Find = Callable[[str], Locker | None]


class NoSuchQuestion(KeyError):
    """An error because no question has that name, or its numbers are missing.

    The message suggests the nearest name.
    """

    def __str__(self) -> str:
        return str(self.args[0])


@functools.cache
def notebook_questions(notebook: str, variant: int = 0) -> dict[str, Sealed]:
    """Return the questions of a notebook, by full name; in another variant those that have it.

    Raises
    ------
    RuntimeError
        The file has another format or invalid content.
    """
    questions_by_name = {}
    try:
        questions = _file(notebook)
        for name, about in (_file(notebook, variant) if variant else questions).items():
            about = _on_the_first(questions[name], about) if variant else about
            questions_by_name[name] = Sealed.from_json(about, f"The sealed question {name}")
    except ValueError as error:
        cut = f"The file of sealed questions for {notebook} is incomplete."
        raise RuntimeError(
            f"{error if isinstance(error, Misread) else cut} Unpack the exercises again. You will "
            "not lose your work."
        ) from None
    return questions_by_name


def _file(notebook: str, variant: int = 0) -> dict[str, dict[str, Json]]:
    """Read the fields of each question in a file of sealed questions, by name."""
    if not NOTEBOOK.fullmatch(notebook):
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
            f"The sealed questions of {notebook} have format {format}, but this is coursework "
            f"{__version__}, which reads format {FORMAT}. Install the package that came with the "
            "notebook. `python -m coursework update exercises.zip` tells you how."
        )
    return about.get("questions", by_name(by_name(anything)))


def _on_the_first(first: Mapping[str, Json], own: Mapping[str, Json]) -> dict[str, Json]:
    """Complete a variant, stored as its differences from the first one (see `beside`)."""
    pages = [
        page
        for variant_fields in (first, own)
        if isinstance(page_list := variant_fields.get("pages"), list)
        for page in page_list
    ]
    fields = {**first, **own, "pages": pages or None}
    return {name: value for name, value in fields.items() if value is not None}


def places() -> list[Traversable]:
    """Return the folders ``sealed``: that beside the notebook, and those of plug-ins."""
    beside = Path("sealed")
    return [*([beside] if beside.is_dir() else []), *sealed_folders()]


def find_question(name: str, student: str) -> Sealed:
    """Return a question by its full name, in a student's variant; a sibling by its own name.

    Raises
    ------
    NoSuchQuestion
    """
    if not isinstance(name, str):
        raise NoSuchQuestion(
            "Give the name of the question first, as a string: `check('notebook/question', "
            f"answer)`. Yours is of type `{type(name).__name__[:40]}`."
        )
    notebook, _, _ = name.partition("/")
    questions = notebook_questions(notebook)
    asked, order = without_sibling(name)
    if asked in questions:
        siblings = siblings_of(asked, questions[asked].question.variants)
        if order > len(siblings):
            there = (
                f"the siblings of '{asked}' are {' and '.join(siblings)}"
                if siblings
                else f"'{asked}' has only one set of numbers, so it has no siblings"
            )
            raise NoSuchQuestion(f"'{name}' does not exist: {there}.")
        number = own_variant(student, asked, questions[asked].question, order)
        of_variant = notebook_questions(notebook, number)
        if asked not in of_variant:
            raise NoSuchQuestion(
                f"Your numbers for '{asked}' are missing. They should be in "
                f"`sealed/variants/{notebook}-{number}.json`. Unpack the exercises again. You "
                "will not lose your work."
            )
        of_question = of_variant[asked].question
        if unknown := {of_question.kind, of_question.kind_of_values} - set(kinds()):
            raise RuntimeError(
                f"'{asked}' is of an unknown kind, {unknown.pop()!r}. Install the package that "
                "came with the notebook."
            )
        return of_variant[asked]
    files = [file.name for folder in places() for file in folder.iterdir()]
    if not files:
        raise NoSuchQuestion(
            f"We cannot find '{name[:80]}' or any other question: the folder `sealed` that came "
            f"with this notebook is not beside it (in {Path.cwd()}), and no package with sealed "
            "questions is installed."
        )
    notebooks = sorted(file.removesuffix(".json") for file in files if file.endswith(".json"))
    if name in notebooks:
        raise NoSuchQuestion(
            f"'{name}' is a notebook. Its questions are {', '.join(map(repr, questions))}."
        )
    # Only this needs it.
    import difflib

    nearest = difflib.get_close_matches(notebook.lower(), notebooks, 1, cutoff=0)
    near = difflib.get_close_matches(name.lower(), notebook_questions(nearest[0]), cutoff=0.5)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    if "/" not in name and not near:
        hint = " A name begins with that of its notebook, as in 'notebook/question'."
    raise NoSuchQuestion(f"There is no question '{name[:80]}'.{hint}")


def variant(name: str) -> Given:
    """Show your variant of a question, and return its numbers.

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
    own = find_question(name, identity()).question.variant or Variant()
    return Given(text_of(own), own.given)


def own_numbers(name: str, student: str) -> tuple[int, str]:
    """Return a student's variant of a question or sibling, and the name of its numbers.

    The result is 0 and an empty name if there is only one, or for a question of another release.
    The name is empty if the variant cannot be read, as without a network.
    """
    (asked, order), notebook = without_sibling(name), name.partition("/")[0]
    number = 0
    with suppress(RuntimeError, KeyError):
        number = own_variant(student, asked, notebook_questions(notebook)[asked].question, order)
        variant = notebook_questions(notebook, number)[asked].question.variant
        return number, names_of_variants([variant])[0] if variant else ""
    return number, ""


def beside(question: Mapping[str, Json], first: Mapping[str, Json]) -> dict[str, Json]:
    """Return the differences between a sealed variant and the first one, which alone are stored.

    Its pages are those that the first one lacks, and are counted after the first one's.

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
    """Compare an answer, as plain data, with the sealed part; the reply contains the opened locker.

    A classmate's answer is searched for only if there is a student ID: it costs a slow hash, and
    without an ID nobody has other numbers.
    """
    if sealed.question.exam:
        return compare(name, sealed.question, plain, None)
    for_others = (
        functools.partial(is_right_for_others, sealed, plain) if student and sealed.others else None
    )
    return compare(name, sealed.question, plain, functools.partial(opened, sealed), for_others)


def salt_of_all(name: str) -> str:
    """Return the salt that all variants of a question share."""
    return hashlib.sha256(f"{name}, all variants".encode()).hexdigest()[:16]


def is_right_for_others(sealed: Sealed, plain: Plain) -> bool:
    """Check whether a wrong answer is right in another variant, like a classmate's."""
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
    """Return the hashed text of a code that opens worked solutions, however it is typed."""
    return "code " + "".join(letter for letter in code.upper() if letter in CODE_LETTERS)


def rung_key(question: Question, number: int) -> bytes:
    """Return the key of a step of the ladder of hints.

    It is no secret and only prevents accidental reading.
    """
    seed = f"step {number} for {question.kind}"
    return hashlib.sha256(seed.encode()).digest()[: sealing.PAGE_KEY]


def opened(sealed: Sealed, fingerprint: str) -> Locker | None:
    """Return the content of the locker of a fingerprint, or ``None``."""
    content = sealing.open_locker(
        sealed.lockers, sealing.slow_key(sealed.question.salt, fingerprint)
    )
    if content is None:
        return None
    outcome, page, inside = content
    if page is not None:
        place = Place(page, inside.hex())
        return Locker.from_json(open_page(sealed, place), f"Page {page}", place)
    known = by_short_name(sealed.question)
    unknown = Note("authored", {"text": NOT_IN_THIS_CATALOGUE})
    notes = [known.get(name, unknown) for name in sealing.mistakes_in(inside)]
    return Locker((KnownAnswer(OUTCOMES[outcome], tuple(notes)),))


def open_page(sealed: Sealed, place: Place) -> object:
    """Return the content of a page, as JSON."""
    return sealing.unseal(sealed.pages[place.page], bytes.fromhex(place.key))


def solution_on(sealed: Sealed, solution: Place | str) -> str:
    """Return the worked solution as HTML, from its place.

    That of a variant is stored as its differences from words that all variants share, on a separate
    page.
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
    """Compare an answer, as plain data, with what is known of a question, and return the reply.

    Parameters
    ----------
    name : str
    question : Question
    plain : dict
    find : function or None
        Returns the locker of a fingerprint, or ``None``. Without the function, as in an exam, only
        the form of the answer is checked.
    for_others : function, optional
        Returns whether an unknown answer is right for other numbers. It is called at once, in
        parallel to ``find`` where possible.
    """
    try:
        reading = read(question, plain)
        if kinds()[question.kind].by_a_person:
            words = len(cast(str, reading.text).split())
            return Reply(
                name,
                "undecided",
                "for a person",
                [f"A person will mark this answer ({number_of(words, 'word')})."],
            )
        text = fingerprint(question, reading)
        if find is None:
            reply = _taken_down(name, question, reading)
        else:
            reply = _compare(name, question, plain, reading, text, find, for_others)
        reply.answer, reply.reading = hashlib.sha256(text.encode()).hexdigest()[:12], reading
        return reply
    except Blank:
        return Reply(
            name,
            "not attempted",
            "",
            ["Put your answer in place of the `...` and run the cells again."],
        )
    except Fault as reason:
        return Reply(name, "invalid", reason.note, [reason.message])
    except Undecidable as reason:
        return Reply(
            name,
            "undecided",
            "undecidable",
            [f"{reason} Try another form, or ask your instructor to look at it."],
        )


def _taken_down(name: str, question: Question, reading: Reading) -> Reply:
    form_fault = fault(question, reading)
    if form_fault:
        return Reply(name, "invalid", form_fault.note, [form_fault.message])
    return Reply(
        name,
        "recorded",
        "",
        [
            "We can read your answer, and it has the right form. It will be marked later, "
            "and nothing in your files shows whether it is right."
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
    locker = find(fingerprint)
    known = _known_in(question, reading, locker)
    # Only the direction of an axis is compared, so its length may be wrong beside a known mistake.
    mistaken = known is not None and known.outcome != "correct"
    compared = mistaken and len(canonical(question, reading)) == sum(map(len, reading.numbers))
    wrong_form = None if compared else fault(question, reading)
    if wrong_form and (known is None or wrong_form.note in ALWAYS_WRONG):
        # Rounding errors are not reported as faults of geometry.
        explanation = (
            ""
            if wrong_form.note == "stray symbol"
            else _decimals(question, plain, reading) or _coarse(question, reading)
        )
        return Reply(
            name,
            "invalid",
            wrong_form.note,
            [explanation, wrong_form.message] if explanation else [wrong_form.message],
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
        [message_of_all(question, known.notes)],
        opened=locker,
        known=known,
        details=details,
    )


def _close(name: str, question: Question) -> Reply:
    """Return the reply to an answer that is, or seems to be, wrong only by rounding."""
    allowed = "" if question.tolerance is None else f" the {question.tolerance:g} that is"
    return Reply(
        name,
        "wrong",
        "rounded too far",
        [
            f"This is close, but off by more than{allowed} allowed. If you rounded, here or "
            "earlier, keep all digits until the end."
        ],
    )


def _known_in(question: Question, reading: Reading, locker: Locker | None) -> KnownAnswer | None:
    """Return the answer in a locker that is nearest, if it is near enough, or ``None``."""
    if locker is None or not locker.answers:
        return None
    far = [_far(question, reading, known) for known in locker.answers]
    least = min(far)
    return locker.answers[far.index(least)] if least <= 1 else None


def _far(question: Question, reading: Reading, known: KnownAnswer) -> Number:
    if not known.numbers:
        return MP.zero
    return distance(
        question, canonical(question, reading), [MP.mpf(number) for number in known.numbers]
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
    """Return the reply to an answer that is neither right nor a mistake of the catalogue."""
    if locker is not None and any(
        known.outcome == "correct" and _far(question, reading, known) <= CLOSE
        for known in locker.answers
    ):
        return _close(name, question)
    decimals = _decimals(question, plain, reading)
    # Each search costs a slow hash: exact numbers were not rounded, and rounded ones are no known
    # mistake to the digit.
    precise, rounded = _precision(plain) if decimals else (True, False)
    if for_others and for_others():
        return Reply(name, "wrong", OTHER_NUMBERS, [FOR_OTHERS])
    if not precise and find(fingerprint(question, reading, near=True)) is not None:
        return Reply(
            name,
            "wrong",
            "rounded too far",
            ["This agrees with the right answer to three digits or more.", decimals],
        )
    for slip, why, turned in () if rounded else other_readings(question, reading):
        known = _known_in(question, turned, find(fingerprint(question, turned)))
        if known and known.outcome == "correct" and slip == IN_DEGREES:
            message_text = message(question, slip, {}) if question.quantity else PERHAPS_DEGREES
            return Reply(name, "wrong", slip, [message_text])
        if known and known.outcome != "correct" and (question.quantity or slip != IN_DEGREES):
            note, details = known.notes[0]
            if note == slip:
                # An answer that is right after undoing a slip twice is the right answer itself,
                # except for the last digits.
                return _close(name, question)
            message_text = f"Two mistakes at once: {why} {message_of_all(question, known.notes)}"
            return Reply(name, "wrong", f"{slip}, and {note}", [message_text], details=details)
    # Report rounding first if it is the only fault, and not that the value is wrong.
    few = _few_digits(question, plain)
    right = what_can_be_said(question, plain)
    lines = [decimals, few, f"Otherwise: {right[:1].lower()}{right[1:]}" if few else right]
    if question.symbols and not any(node[0] == "symbol" for node in plain["nodes"]):
        lines = [right]
    return Reply(name, "wrong", "", [" ".join(filter(None, lines))])


def other_readings(question: Question, reading: Reading) -> Iterator[tuple[str, str, Reading]]:
    """Iterate over the answer with one common slip undone, which may be a known mistake.

    Each comes with the note and the message of the slip.
    """
    if reading.text is None:
        for name, (message_text, undo) in kind_of_values(question).slips.items():
            numbers = [undo(question, numbers) for numbers in reading.numbers]
            if None not in numbers:
                yield name, message_text, Reading(numbers)
        # Without a quantity the question may ask for degrees: then only the right answer counts.
        angles = question.quantity in (None, "angle")
        if angles and question.kind_of_values in ("expression", "vector", "matrix"):
            message_text = "the answer is in degrees, and it has another mistake."
            radians = [[number * MP.pi / 180 for number in numbers] for numbers in reading.numbers]
            yield IN_DEGREES, message_text, Reading(radians)


def _decimals(question: Question, plain: Plain, reading: Reading) -> str:
    exact = question.tolerance is None and reading.text is None
    if not exact or not any(node[0] == "float" for node in plain["nodes"]):
        return ""
    return (
        "Your answer has decimal fractions. Write symbols or exact numbers instead, such as "
        "`sm.Rational(1, 2)` and `sm.sqrt(3)`."
    )


def _few_digits(question: Question, plain: Plain) -> str:
    """Return a message on numbers with fewer decimals than the tolerance: they may be rounded.

    It depends only on the student's input and the tolerance, so it reveals nothing of the right
    answer. Components that make an exact length together, such as 0.6 and 0.8, are exact, and so
    is 2.4 beside a number with all its digits.
    """
    if question.tolerance is None:
        return ""
    absolute, relative = (float(part) for part in tolerances(question))
    floats = [
        str(node[1]) for node in plain["nodes"] if node[0] == "float" and "e" not in str(node[1])
    ][:MOST_LOOKED_AT]
    squares = [Fraction(digits) ** 2 for digits in floats if float(digits)]
    lengths = [
        sum(squares, Fraction()),
        *(first + second for first, second in itertools.combinations(squares, 2)),
    ]
    # A number with nine decimal places or more was not rounded by hand.
    if any(len(digits.partition(".")[2]) > 8 for digits in floats) or (
        len(squares) > 1 and any(map(_is_square, lengths))
    ):
        return ""
    for digits in floats:
        places = len(digits.partition(".")[2])
        allowed = absolute + relative * abs(float(digits))
        if 0.5 * 10.0**-places > allowed and Fraction(digits).denominator > 4:
            return (
                f"If you rounded, keep all digits until the end: `{digits}` has "
                f"{number_of(places, 'decimal place')}, but an answer may be off by at most "
                f"{allowed:.1g}."
            )
    return ""


def _is_square(number: Fraction) -> bool:
    """Check whether a fraction is the square of another."""
    return all(math.isqrt(part) ** 2 == part for part in (number.numerator, number.denominator))


def _coarse(question: Question, reading: Reading) -> str:
    """Return a message on numbers that are inconsistent, but would fit with fewer digits."""
    if question.tolerance is None or fault(replace(question, tolerance=COARSE), reading):
        return ""
    return "The numbers nearly fit together. If you rounded, keep all digits until the end."


def _precision(plain: Plain) -> tuple[bool, bool]:
    """Return whether all decimal fractions of an answer are clearly exact, and one clearly rounded.

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
                abs(size_of_number - Fraction(size_of_number).limit_denominator(most))
                <= 1e-13 * max(1, size_of_number)
                for size_of_number in numbers
            ):
                precise, rounded = False, rounded or short
    return precise, rounded


def what_can_be_said(question: Question, plain: Plain) -> str:
    """Return what is right in a wrong answer, so that its author does not look there."""
    named = {node[1] for node in plain["nodes"] if node[0] == "symbol"}
    missing = [symbol for symbol in question.symbols if not {symbol, *spellings(symbol)} & named]
    symbols = ", ".join(f"`{symbol}`" for symbol in question.symbols)
    if symbols and not named:
        return f"The question uses {symbols}, but your answer contains only numbers."
    message_text = kind_of_values(question).wrong
    if question.every_symbol and missing:
        message_text += (
            f" Your answer contains no {' and no '.join(f'`{symbol}`' for symbol in missing)}."
        )
    return message_text
