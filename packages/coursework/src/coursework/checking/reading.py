"""Convert an answer to numbers, and compute its fingerprint.

An answer is *read* into real numbers: its entries at the points of the question. These numbers,
rounded to whole cells, are its fingerprint, which all ways of writing the answer share. An answer
with several equally right values is first converted to one of them: a quaternion and its negative,
the many Euler angles of one orientation.

The edges of the cells depend only on the salt, so they reveal nothing of the answer. An answer near
the edge of a cell has a locker for the cell beyond it, too. Cells are several tolerances wide: the
opened locker contains the right numbers, with which an answer is compared to the digit.

The student's check, which compares fingerprints through a slow hash, and the grading, which
compares them directly, use the same functions. They see only the plain data of
`coursework.checking.plain`.
"""

import functools
import hashlib
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

from .evaluate import MP, NotSupported, TooLarge, Undefined, UnknownSymbol, real, values
from .kinds import Blank, Fault, Number, Undecidable, is_blank, listed
from .plain import Plain, Value, arguments_of, parts_of, text_of
from .plugins import kind_of_values, kinds
from .points import points
from .question import Question
from .units import UnknownUnit, unit

# The tolerance of an exact answer, absolute and relative: mostly the rounding of doubles.
EXACT = MP.mpf(10) ** -12
# Width of its cells in that unit: far below every real difference.
EXACT_WIDTH = 1000
# The tolerance within which an answer is called nearly right where an exact one is required: three
# digits.
NEAR = MP.mpf("2e-3")
# The distance between units of different quantities, in tolerances.
FAR = 10**6


class Reading(NamedTuple):
    """An answer as numbers, a list for each point in ``numbers``; for words, ``text`` is set."""

    numbers: list[list[Number]]
    text: str | None = None


def calls_for(question: Question) -> list[list[Any]] | None:
    """Return new arguments of each call to a function; ``None`` if it does not ask for one."""
    if question.kind != "function":
        return None
    return arguments_of(question.calls, question.takes or "lists")


def read(question: Question, plain: Plain) -> Reading:
    """Read an answer.

    Parameters
    ----------
    question : Question
    plain : dict
        The answer as `coursework.checking.plain.to_plain` gives it.

    Raises
    ------
    Blank, Fault, Undecidable
    """
    value = plain["value"]
    if is_blank(value) or value == ["text", ""]:
        raise Blank
    if question.kind == "function":
        return _read_function(question, plain)
    kind = kinds()[question.kind]
    if kind.text:
        return Reading([], kind.text(question, plain))
    leaves = _entries(question, value)
    varies = any(node[0] == "symbol" for node in plain["nodes"])
    numbers = []
    for point in points(question):
        results = values(plain["nodes"], point)
        numbers.append([_number(question, results[leaf], varies) for leaf in leaves])
    if question.kind == "measurement":
        numbers = _with_units(question, value, numbers)
    return Reading(numbers)


def fingerprint(question: Question, reading: Reading, near: bool = False) -> str:
    """Return the text that is the same for all forms of one answer, and for no other answer.

    With ``near``, it is the text that answers share which agree to about three digits.
    """
    if reading.text is not None:
        return reading.text
    places = _places(question, canonical(question, reading), near)
    return _text_of([int(MP.floor(place)) for place in places], near)


def fingerprints(
    question: Question, reading: Reading, reach: float = 1, near: bool = False, most: int = 6
) -> list[str]:
    """Return the fingerprints of an answer's cell and of those within ``reach`` tolerances.

    If there are more than ``most`` such edges, the nearest are used.
    """
    if reading.text is not None:
        return [reading.text]
    numbers = canonical(question, reading)
    choices = [[int(MP.floor(place))] for place in _places(question, numbers, near)]
    for _, order, beside in edges_near(question, numbers, reach, near)[:most]:
        choices[order].append(beside)
    return [_text_of(chosen, near) for chosen in itertools.product(*choices)]


def edges_near(
    question: Question, numbers: Sequence[Number], reach: float = 1, near: bool = False
) -> list[tuple[Number, int, int]]:
    """Return the edges within ``reach`` tolerances, nearest first.

    Each has its distance, the index of its number, and the cell beyond.
    """
    margin = MP.mpf(reach) / _width(question, len(numbers), near)
    edges = []
    for order, place in enumerate(_places(question, numbers, near)):
        cell = int(MP.floor(place))
        for far, beside in ((place - cell, cell - 1), (cell + 1 - place, cell + 1)):
            if far < margin:
                edges.append((far, order, beside))
    return sorted(edges)


def _text_of(cells: Iterable[int], near: bool) -> str:
    return ("near " if near else "") + " ".join(map(str, cells))


def tolerances(question: Question) -> tuple[Number, Number]:
    """Return the tolerance of each number: an absolute part, and a share of the right number."""
    if question.tolerance is None:
        return EXACT, EXACT
    absolute = kind_of_values(question).parts * MP.mpf(str(question.tolerance))
    relative = MP.mpf(str(question.relative or 0))
    return absolute, relative


def distance(question: Question, numbers: Sequence[Number], right: Sequence[Number]) -> Number:
    """Return the distance of an answer from the right one, in tolerances: up to 1 it is right."""
    absolute, relative = tolerances(question)
    return max(
        abs(number - right_number) / (absolute + relative * abs(right_number))
        for number, right_number in zip(numbers, right)
    )


def within(
    question: Question, numbers: Sequence[Number], right: Sequence[Number], share: float = 1
) -> bool:
    """Check whether an answer is within a share of the tolerance, faster than `distance` if not."""
    absolute, relative = tolerances(question)
    return all(
        abs(number - right_number) <= share * (absolute + relative * abs(right_number))
        for number, right_number in zip(numbers, right)
    )


def _width(question: Question, count: int, near: bool) -> int:
    """Return the width of a cell in tolerances.

    It grows with the count of numbers, so that an answer is near few cells.
    """
    if near:
        return 4 * count
    return EXACT_WIDTH if question.tolerance is None else 3 * count


def _places(question: Question, numbers: Sequence[Number], near: bool) -> list[Number]:
    absolute, relative = (NEAR, NEAR) if near else tolerances(question)
    width = _width(question, len(numbers), near)
    return [
        _in_tolerances(number, absolute, relative) / width + offset
        for number, offset in zip(numbers, offsets(question.salt, len(numbers)))
    ]


def _in_tolerances(number: Number, absolute: Number, relative: Number) -> Number:
    """Return a number on a scale in units of its tolerance, however large the number."""
    if not relative:
        return number / absolute
    size = MP.log(1 + relative * abs(number) / absolute) / relative
    return size if number >= 0 else -size


@functools.lru_cache(256)
def offsets(salt: str, count: int) -> list[Number]:
    data = hashlib.shake_256(f"{salt} edges of the cells".encode()).digest(8 * count)
    return [int.from_bytes(data[8 * k : 8 * k + 8], "big") / MP.mpf(2) ** 64 for k in range(count)]


def canonical(question: Question, reading: Reading) -> list[Number]:
    """Return the numbers of a reading in a canonical form, all points one after another.

    Words have none.
    """
    unique = kind_of_values(question).unique
    if not unique:
        return [number for numbers in reading.numbers for number in numbers]
    return [number for numbers in reading.numbers for number in unique(question, numbers)]


def fault(question: Question, reading: Reading) -> Fault | None:
    """Return the fault of the form of an answer, or ``None``."""
    find = kind_of_values(question).fault
    if find:
        for numbers in reading.numbers:
            form_fault: Fault | None = find(question, numbers)
            if form_fault:
                return form_fault
    return None


# --- reading the entries ------------------------------------------------------------------------


def _entries(question: Question, value: Value) -> Sequence[int]:
    """Return the nodes of the entries of an answer that does not consist of words."""
    entries = kinds()[question.kind].entries
    assert entries is not None
    return cast("Sequence[int]", entries(question, value))


def _number(question: Question, result: Any, varies: bool = False) -> Number:
    try:
        # Allow as much of exponentials that should cancel as the answer may be off by.
        return real(result, *(max(part, EXACT) for part in tolerances(question)))
    except UnknownSymbol as error:
        name = error.args[0][:40]
        symbols = "symbol" if len(question.symbols) == 1 else "symbols"
        named = f"the {symbols} {listed(question.symbols)}" if question.symbols else "no symbols"
        raise Fault(
            "stray symbol", f"The answer contains `{name}`, but this question has {named}."
        ) from None
    except Undefined as error:
        somewhere = " for some values of its symbols" if varies else ""
        raise Fault("undefined", f"The answer has no finite value{somewhere}: {error}.") from None
    except TooLarge as error:
        raise Fault("too large", f"We cannot evaluate the answer: {error}.") from None
    except NotSupported as error:
        raise Undecidable(f"The answer contains {error}, which we cannot evaluate.") from None
    except ValueError:
        raise Fault(
            "not real",
            "The answer has an imaginary part, but the question asks for a real answer.",
        ) from None


def _with_units(
    question: Question, value: Value, numbers: list[list[Number]]
) -> list[list[Number]]:
    """Return the number in base units, divided by the question's scale, and its unit.

    The unit is part of the answer, and another one differs from it by more than any tolerance.
    """
    _, name = parts_of(value)
    try:
        unit_given = unit(text_of(name))
    except UnknownUnit as error:
        raise Fault(
            "unknown unit",
            f"We do not know the unit `{error}`. Write products with a space and quotients with a "
            "slash: `kN m`, `m/s^2`, `J/(kg K)`.",
        ) from None
    absolute, _ = tolerances(question)
    far = [exponent * FAR * max(absolute, NEAR) for exponent in unit_given.exponents]
    # In an exam, the scale is not public.
    scale = MP.mpf(question.scale or 1)
    return [[number * unit_given.size / scale, *far] for [number] in numbers]


def _read_function(question: Question, plain: Plain) -> Reading:
    value = plain["value"]
    if value[0] != "function":
        raise Fault("shape", "The question asks for a function. Give its name, without calling it.")
    inner = replace(question, kind=question.kind_of_values, symbols={})
    returned = parts_of(value)
    if all(map(is_blank, returned)):
        if not value[2]:
            # The body of the function is still empty.
            raise Blank
        raise Fault(
            "returned nothing",
            "The function computes something but returns nothing. End it with a line that begins "
            "with `return`.",
        )
    if any(result[0] == "printed" for result in returned):
        raise Fault(
            "printed",
            "The function prints its result but returns nothing, so nothing else can use it. "
            "Write `return` instead of `print`.",
        )
    results = values(plain["nodes"], {})
    numbers = []
    for order, result in enumerate(returned):
        if result[0] == "raised":
            which = _which_call(question, order, len(returned))
            raise Fault("raised an error", f"{which} raised `{text_of(result)}`.")
        if is_blank(result):
            which = _which_call(question, order, len(returned))
            raise Fault("returned nothing", f"{which} returned nothing. Is there a `return`?")
        try:
            numbers.append([_number(inner, results[leaf]) for leaf in _entries(inner, result)])
        except Fault as fault_of_result:
            which = _which_call(question, order, len(returned))
            raise Fault(
                fault_of_result.note,
                f"{which} did not return what the question asks for. {fault_of_result.message}",
            ) from None
    if len(numbers) != len(question.calls):
        raise Fault("raised an error", "The function did not return a result for every call.")
    return Reading(numbers)


def _which_call(question: Question, order: int, count: int) -> str:
    """Return the beginning of a sentence about one call of a function."""
    arguments = ", ".join(map(repr, question.calls[order])) if order < len(question.calls) else ""
    # Arguments of more than a line, such as a log, would hide what went wrong.
    shown = f", with `{arguments}`," if 0 < len(arguments) <= 60 else ""
    return f"In call {order + 1} of {count}{shown} the function"
