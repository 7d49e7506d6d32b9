"""What each kind of question asks for, and the fingerprint of an answer to it.

An answer is *read* into real numbers: its entries at the points of the question. Those numbers, rounded to
whole cells, are its fingerprint; all ways of writing one answer share it. What has several equally right
values is first turned into something that has one: a quaternion and its negative, the many Euler angles of
one orientation.

Where the cells begin follows from the salt and from nothing else, so it tells nothing of the answer. An answer
near the edge of a cell has a locker for the cell beyond it too. Cells are several tolerances wide: what the
fingerprint opens holds the right numbers, and with those an answer is compared to the digit.

The same reading serves the student's check, which compares fingerprints through a slow hash, and the
grading, which compares them as they are. It sees only the plain data of :mod:`coursework.checking.plain`.
"""

import functools
import hashlib
import itertools
import json
from collections.abc import Iterable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, NamedTuple

from . import mistakes
from .evaluate import MP, NotSupported, TooLarge, Undefined, UnknownSymbol, real, values
from .plain import Plain
from .plugins import Kind, kind_of_values, kinds
from .points import points
from .question import Question
from .units import UnknownUnit, unit

#: What an exact answer may be off by, absolutely and relatively: above all rounding of doubles.
EXACT = MP.mpf(10) ** -12
#: Width of its cells in that unit: far below every real difference.
EXACT_WIDTH = 1000
#: What an answer may be off by that is said to be nearly right where an exact one is asked for: three digits.
NEAR = MP.mpf("2e-3")
#: What two units that measure something else are apart, in tolerances.
FAR = 10**6
#: What stands between the parts of an answer in words.
PARTS = {"words": " | ", "order": " < ", "truth values": ""}
FUNCTIONS = SimpleNamespace(sin=MP.sin, cos=MP.cos, norm=lambda *parts: MP.sqrt(sum(x * x for x in parts)))


#: One of mpmath.
Number = Any


class Blank(Exception):
    """Nothing has been answered yet."""


class Fault(Exception):
    """An answer is not of the form that is asked for: a short note for statistics, and a message."""

    def __init__(self, note: str, message: str) -> None:
        super().__init__(message)
        self.note = note
        self.message = message


class Undecidable(Exception):
    """An answer has the right form, but its value cannot be found here: a person must look."""


class Reading(NamedTuple):
    """An answer as numbers: ``numbers`` is a list for each point; ``text`` is set for words instead."""

    numbers: list[list[Number]]
    text: str | None = None


def calls_for(question: Question) -> list[list[Any]] | None:
    """The arguments of each call to a function that is asked for, made anew: it may change them."""
    if question.kind != "function":
        return None
    if question.takes == "arrays":
        import numpy

        return [
            [numpy.array(part) if isinstance(part, list) else part for part in arguments]
            for arguments in question.calls
        ]
    return [json.loads(json.dumps(arguments)) for arguments in question.calls]


def read(question: Question, plain: Plain) -> Reading:
    """Read an answer.

    Parameters
    ----------
    question : Question
    plain : dict
        The answer as :func:`coursework.checking.plain.to_plain` gives it.

    Raises
    ------
    Blank, Fault, Undecidable
    """
    value = plain["value"]
    if _blank(value):
        raise Blank
    if question.kind == "function":
        return _read_function(question, plain)
    kind = kinds()[question.kind]
    if kind.text:
        return Reading([], kind.text(question, plain))
    leaves = kind.entries(question, value)
    numbers = []
    for point in points(question):
        results = values(plain["nodes"], point)
        numbers.append([_number(question, results[leaf]) for leaf in leaves])
    return Reading(_with_units(question, value, numbers) if question.kind == "measurement" else numbers)


def fingerprint(question: Question, reading: Reading, near: bool = False) -> str:
    """Give the text that is the same for all forms of one answer, and for no other answer.

    With ``near``, the text that answers share which agree to about three digits.
    """
    if reading.text is not None:
        return reading.text
    places = _places(question, canonical(question, reading), near)
    return _text_of([int(MP.floor(place)) for place in places], near)


def fingerprints(
    question: Question, reading: Reading, reach: float = 1, near: bool = False, most: int = 6
) -> list[str]:
    """The fingerprints of all answers that are within ``reach`` tolerances of one: its cell and those beside it.

    Of more than ``most`` edges that are as near as that, the nearest are taken.
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
    """The edges within ``reach`` tolerances, nearest first: how far, of which number, and the cell beyond."""
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
    """What each number of an answer may be off by: an absolute part, and a share of the right number."""
    if question.tolerance is None:
        return EXACT, EXACT
    return kind_of_values(question).parts * MP.mpf(str(question.tolerance)), MP.mpf(str(question.relative or 0))


def distance(question: Question, numbers: Sequence[Number], right: Sequence[Number]) -> Number:
    """How far an answer is from the right one, in tolerances: up to 1 it is right."""
    absolute, relative = tolerances(question)
    return max(abs(number - other) / (absolute + relative * abs(other)) for number, other in zip(numbers, right))


def within(question: Question, numbers: Sequence[Number], right: Sequence[Number], share: float = 1) -> bool:
    """Whether an answer is within some share of the tolerance; quicker than :func:`distance` where it is not."""
    absolute, relative = tolerances(question)
    return all(
        abs(number - other) <= share * (absolute + relative * abs(other)) for number, other in zip(numbers, right)
    )


def _width(question: Question, count: int, near: bool) -> int:
    """Width of a cell in tolerances. The more numbers, the wider: so the cells that an answer is near stay few."""
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
    """A number on a scale on which each step of 1 is one tolerance, however large the number."""
    if not relative:
        return number / absolute
    size = MP.log(1 + relative * abs(number) / absolute) / relative
    return size if number >= 0 else -size


@functools.lru_cache(256)
def offsets(salt: str, count: int) -> list[Number]:
    data = hashlib.shake_256(f"{salt} edges of the cells".encode()).digest(8 * count)
    return [int.from_bytes(data[8 * k : 8 * k + 8], "big") / MP.mpf(2) ** 64 for k in range(count)]


def canonical(question: Question, reading: Reading) -> list[Number]:
    """The numbers of a reading with what is a matter of taste removed, all points one after another."""
    unique = kind_of_values(question).unique
    if not unique:
        return [number for numbers in reading.numbers for number in numbers]
    return [number for numbers in reading.numbers for number in unique(question, numbers)]


def fault(question: Question, reading: Reading) -> Fault | None:
    """Say what is wrong with the form of an answer that was read, or give ``None``."""
    find = kind_of_values(question).fault
    if find and reading.text is None:
        for numbers in reading.numbers:
            found = find(question, numbers)
            if found:
                return found
    return None


# --- reading the entries ------------------------------------------------------------------------


def _blank(value):
    if value[0] == "list":
        return bool(value[1]) and all(map(_blank, value[1]))
    return value[0] == "blank"


def _number(question, result):
    try:
        return real(result, _imaginary_rest(question, result))
    except UnknownSymbol as error:
        name = error.args[0][:40]
        given = list(question.symbols)
        wanted = f"this question has the symbols {listed(given)}" if given else "this question has no symbols"
        raise Fault("stray symbol", f"The answer holds `{name}`; {wanted}.") from None
    except Undefined as error:
        raise Fault("undefined", f"The answer has no finite value for some values of its symbols: {error}.") from None
    except TooLarge as error:
        raise Fault("too large", f"The answer is not worked out: {error}.") from None
    except NotSupported as error:
        raise Undecidable(f"The answer holds {error}, whose value is not worked out here.") from None
    except ValueError:
        raise Fault("not real", "The answer has an imaginary part; the question asks for something real.") from None


def _imaginary_rest(question, result):
    """What may remain of exponentials that should cancel: as much as the answer may be off by."""
    if not isinstance(result, MP.mpc):
        return 0
    absolute, relative = tolerances(question)
    return max(absolute, EXACT) + max(relative, EXACT) * abs(result.real)


def listed(names):
    return ", ".join(f"`{name}`" for name in names)


def shape_fault(wanted, value, got=None):
    return Fault("shape", f"{wanted} is asked for; this is {got or _describe(value)}.")


def _describe(value):
    kind = value[0]
    if kind == "matrix":
        return f"a matrix of {value[1]} × {value[2]}"
    if kind == "list":
        rows = [part for part in value[1] if part[0] == "list"]
        if rows and len(rows) == len(value[1]) and len({len(row[1]) for row in rows}) == 1:
            return f"a list of {len(rows)} rows with {len(rows[0][1])} entries each"
        if [part[0] for part in value[1]] == ["expression", "text"]:
            return "a number with a unit, or with a text"
        return f"a list with {len(value[1])} entr{'y' if len(value[1]) == 1 else 'ies'}"
    return {
        "text": "a text",
        "truth": "a truth value",
        "expression": "a single expression",
        "frame": "a reference frame",
        "vector": "a vector",
        "function": "a function",
        "frames": "a set of reference frames",
        "printed": "something printed",
        "blank": "still blank in part",
        "raised": "an error",
    }[kind]


def _holding(whole, part):
    """What a list is, one part of which is of another kind than is asked for."""
    if part[0] == "blank" or _blank(part):
        return "a list that is still blank in part"
    if part[0] == "text":
        return "a list that holds a text"
    return f"a list with {len(whole[1])} entries, one of which is {_describe(part)}"


def leaf(value, wanted):
    """The one expression that a value is; a list or matrix of one entry is that entry."""
    if value[0] == "matrix" and value[1] == value[2] == 1:
        return value[3][0]
    if value[0] == "list" and len(value[1]) == 1:
        return leaf(value[1][0], wanted)
    if value[0] != "expression":
        raise shape_fault(wanted, value)
    return value[1]


def _leaf_of(whole, part, wanted):
    """The one expression that a part of a list is."""
    try:
        return leaf(part, wanted)
    except Fault:
        said = ": numbers stand without quotation marks" if part[0] == "text" else ""
        raise shape_fault(wanted, whole, _holding(whole, part) + said) from None


def _expression(question, value):
    return [leaf(value, "A single expression")]


def components(value, length, wanted):
    if value[0] == "matrix" and sorted(value[1:3]) == sorted((1, length)):
        return value[3]
    if value[0] == "list" and len(value[1]) == length:
        return [_leaf_of(value, part, wanted) for part in value[1]]
    if value[0] == "list" and len(value[1]) == 1 and value[1][0][0] == "list":
        return components(value[1][0], length, wanted)
    raise shape_fault(wanted, value)


def _measurement(question, value):
    wanted = "A number and its unit, such as `(3.2, 'N m')`,"
    if value[0] != "list" or len(value[1]) != 2 or value[1][1][0] != "text":
        raise shape_fault(wanted, value)
    return [leaf(value[1][0], wanted)]


def _with_units(question, value, numbers):
    """The number in base units, in terms of the question's scale, and which these are.

    The unit is part of the answer: another one differs from it by more than any tolerance.
    """
    text = value[1][1][1]
    try:
        found = unit(text)
    except UnknownUnit as error:
        raise Fault(
            "unknown unit",
            f"`{error}` is no unit that is known here. Write products with a space and quotients with a stroke: "
            "`kN m`, `m/s^2`, `J/(kg K)`.",
        ) from None
    absolute, _ = tolerances(question)
    far = [exponent * FAR * max(absolute, NEAR) for exponent in found.exponents]
    scale = MP.mpf(question.scale or 1)  # in an exam it is not told
    return [[number * found.size / scale, *far] for [number] in numbers]


def scale_of(answer):
    """What the sealed part of a measurement tells of its unit: how large it is, and not what it measures."""
    return {"scale": MP.nstr(unit(answer[1]).size, 15)}


def _vector(question, value):
    length = question.length or 3
    frame = question.frames[0] if question.frames else None
    if value[0] == "vector":
        # The zero vector belongs to every frame.
        if frame is None:
            raise shape_fault(f"A list of {length} components", value)
        if frame not in value[1]:
            raise Fault("frame", f"This vector is not connected with the frame `{frame}` that the question names.")
        value = value[1][frame]
    return components(value, length, f"A list of {length} components")


def row_entries(value, rows, columns, wanted):
    if value[0] == "matrix" and tuple(value[1:3]) == (rows, columns):
        return value[3]
    if value[0] == "list" and len(value[1]) == rows:
        return [entry for row in value[1] for entry in _row(value, row, columns, wanted)]
    raise shape_fault(wanted, value)


def _row(whole, row, columns, wanted):
    if row[0] == "list" and len(row[1]) not in (1, columns) and not _blank(row):
        described = _describe(whole)
        uneven = f"a list of rows, one of which has {len(row[1])} entries"
        raise shape_fault(wanted, whole, described if "rows" in described else uneven)
    if row[0] == "list" or row[0] == "matrix" and 1 in row[1:3]:
        return components(row, columns, wanted)
    raise shape_fault(wanted, whole, _holding(whole, row))


def _matrix(question, value):
    rows, columns = question.shape or (3, 3)
    return row_entries(value, rows, columns, f"A matrix of {rows} × {columns}")


def _read_function(question, plain):
    value = plain["value"]
    if value[0] != "function":
        raise Fault("shape", "The question asks for a function: give its name, without calling it.")
    inner = replace(question, kind=question.kind_of_values, symbols={})
    if all(map(_blank, value[1])):
        if not value[2]:
            raise Blank  # the body of the function is still empty
        raise Fault(
            "returned nothing",
            "The function works something out and returns nothing. End it with a line that begins with `return`.",
        )
    if any(result[0] == "printed" for result in value[1]):
        raise Fault(
            "printed",
            "The function prints its result and returns nothing, so nothing else can work with it. "
            "Write `return` in place of `print`.",
        )
    results = values(plain["nodes"], {})
    numbers = []
    for order, result in enumerate(value[1]):
        which = f"In call {order + 1} of {len(value[1])} the function"
        if result[0] == "raised":
            raise Fault("raised an error", f"{which} raised `{result[1]}`.")
        if _blank(result):
            raise Fault("returned nothing", f"{which} returned nothing. Is there a `return`?")
        try:
            numbers.append([_number(inner, results[leaf]) for leaf in kinds()[inner.kind].entries(inner, result)])
        except Fault as found:
            raise Fault(found.note, f"{which} returned something else than was asked for. {found.message}") from None
    if len(numbers) != len(question.calls):
        raise Fault("raised an error", "The function did not answer all calls.")
    return Reading(numbers)


# --- answers in words ---------------------------------------------------------------------------


def word(plain, wanted):
    value = plain["value"]
    if value[0] == "list" and value[1] and all(part[0] == "text" for part in value[1]):
        return "".join(part[1] for part in value[1])
    if value[0] != "text":
        raise shape_fault(wanted, value)
    return value[1]


def _spelled(plain):
    """The word that is meant by a number or a symbol: ``-1`` for ``'-1'``, the symbol ``-i`` for ``'-i'``."""
    if plain["value"][0] != "expression":
        return None
    nodes = plain["nodes"]
    node = nodes[plain["value"][1]]
    if node[0] == "Mul" and len(node) == 3:
        signs = [part for part in node[1:] if nodes[part] == ["integer", "-1"]]
        names = [nodes[part][1] for part in node[1:] if nodes[part][0] == "symbol"]
        return f"-{names[0]}" if signs and names else None
    if node[0] == "float" and float(node[1]).is_integer():
        return f"{float(node[1]):.0f}"
    return node[1] if node[0] in ("integer", "symbol") else None


def _choice(question, plain):
    given = _spelled(plain) or word(plain, f"One of {listed(question.options)}, in quotation marks,")
    given = " ".join(given.split())
    # A minus of typography is no mistake; nor is a plus that nobody asked for, or one that is left out.
    text = given.lower().translate(MINUS)
    options = {option.lower(): option for option in question.options}
    bare = text.replace("- ", "-").replace("+ ", "+")
    found = [one for one in (text, bare, bare.removeprefix("+"), f"+{bare}") if one in options]
    if not found:
        raise Fault("shape", f"The answer is one of {listed(question.options)}; this is `{given[:40]}`.")
    return found[0]


def _truths(question, plain):
    value, length = plain["value"], question.length
    wanted = f"A list of {length} truth values, `True` or `False`,"
    if value[0] != "list" or len(value[1]) != length:
        raise shape_fault(wanted, value)
    given = []
    for part in value[1]:
        number = plain["nodes"][part[1]] if part[0] == "expression" else None
        if number in (["integer", "0"], ["integer", "1"]):
            part = ["truth", number[1] == "1"]
        if part[0] == "text" and part[1].strip().lower() in ("true", "false"):
            part = ["truth", part[1].strip().lower() == "true"]
        if part[0] != "truth":
            raise shape_fault(wanted, value, _holding(value, part))
        given.append(part[1])
    return "".join("T" if part else "F" for part in given)


def _words(question, plain):
    value, length, options = plain["value"], question.length, question.options
    wanted = f"A list of {length} words, each one of {listed(options)},"
    if value[0] != "list" or len(value[1]) != length:
        raise shape_fault(wanted, value)
    if any(map(_blank, value[1])):
        said = ": `'none'` is a text, too" if "none" in options else ""
        raise shape_fault(wanted, value, f"a list that is still blank in part{said}")
    return PARTS["words"].join(_choice(question, {**plain, "value": part}) for part in value[1])


def _order(question, plain):
    value, options = plain["value"], question.options
    wanted = f"A list with each of {listed(options)} once"
    if value[0] != "list" or len(value[1]) != len(options):
        raise shape_fault(wanted, value)
    parts = [_choice(question, {**plain, "value": part}) for part in value[1]]
    twice = next((part for part in parts if parts.count(part) > 1), None)
    if twice is not None:
        raise Fault("shape", f"{wanted} is asked for; here `{twice}` stands {parts.count(twice)} times.")
    return PARTS["order"].join(parts)


def _free_text(question, plain):
    text = word(plain, "A text").strip()
    if not text:
        raise Blank
    return text


#: What a keyboard or a text program may make of a minus.
MINUS = str.maketrans("\u2212\u2010\u2011\u2013", "----")


# --- one value for what can be written in several ways ------------------------------------------


def one_sign(question: Question, numbers: list[Number]) -> list[Number]:
    # Of two opposites the one whose first component that is not zero is positive.
    limit = sign_limit(question)
    leading = next((number for number in numbers if abs(number) > limit), MP.one)
    return numbers if leading > 0 or not question.either_sign else [-number for number in numbers]


def sign_limit(question: Question) -> Number:
    """Below this a component counts as zero, so that rounding does not decide which sign is taken."""
    return MP.mpf("2e-9") if question.tolerance is None else 8 * tolerances(question)[0]


# --- what is wrong with the form ----------------------------------------------------------------


def slack(question: Question) -> Number:
    return MP.mpf("1e-9") if question.tolerance is None else 6 * MP.mpf(str(question.tolerance))


def short(number):
    return MP.nstr(number, 3)


def length_in_words(length):
    """A length that should be 1, with as many digits as show that it is not."""
    for digits in range(3, 16):
        text = MP.nstr(length, digits, strip_zeros=True)
        if MP.mpf(text) != 1:
            return text.removesuffix(".0")
    return MP.nstr(length, 20)


def _unit_vector_fault(question, numbers):
    if question.unit_vector:
        length = FUNCTIONS.norm(*numbers)
        if abs(length - 1) > slack(question):
            return Fault(
                "not unit length",
                f"The question asks for a unit vector; this one has length {length_in_words(length)}.",
            )
    return None


def transposed(question, numbers):
    """The entries of the transpose; ``None`` where it is of another shape."""
    rows, columns = question.shape or (3, 3)
    if rows != columns:
        return None
    return [numbers[row * columns + column] for column in range(columns) for row in range(rows)]


TRANSPOSED = {"transposed": ("the matrix is transposed, and its transpose has another mistake.", transposed)}
SEVERAL = "More than one of these is not right."
#: Where to begin with each kind of question.
BEGIN = {
    "expression": "Name what is known and what is asked for, and write down one equation that connects them.",
    "vector": "Along which frame are the components asked for? Write the vector down where it is simplest.",
    "matrix": "Take one entry and work it out alone; then ask which rule gives all the others.",
    "choice": "Put each of the possibilities to the test on the simplest case that tells them apart.",
    "words": "Take them one by one, and begin with those that you are sure of; find a test for the others.",
    "truth values": "Look for an example that breaks a claim; where there is none, look for the proof.",
    "measurement": "Work with the units as with the numbers: what do those that are given make together?",
    "order": "Find the first and the last; then compare two at a time.",
    "function": "Work out by hand what it should return for the simplest arguments, and compare.",
}
KINDS = {
    "expression": Kind(begin=BEGIN["expression"], entries=_expression, mistakes=mistakes.of_expression),
    "vector": Kind(
        begin=BEGIN["vector"], entries=_vector, unique=one_sign, fault=_unit_vector_fault, mistakes=mistakes.of_vector
    ),
    "matrix": Kind(
        begin=BEGIN["matrix"], entries=_matrix, needs=("shape",), mistakes=mistakes.of_matrix, slips=TRANSPOSED
    ),
    "choice": Kind(begin=BEGIN["choice"], text=_choice, needs=("options",)),
    "words": Kind(
        begin=BEGIN["words"], text=_words, needs=("options", "length"), wrong=SEVERAL, mistakes=mistakes.of_parts
    ),
    "truth values": Kind(
        begin=BEGIN["truth values"], text=_truths, needs=("length",), wrong=SEVERAL, mistakes=mistakes.of_parts
    ),
    "measurement": Kind(
        begin=BEGIN["measurement"],
        entries=_measurement,
        wrong="It is a number with a unit, but the number, the unit or both are wrong.",
        public=scale_of,
        mistakes=mistakes.of_measurement,
        messages=mistakes.OF_MEASUREMENTS,
        details={"power": mistakes.POWERS},
    ),
    "order": Kind(
        begin=BEGIN["order"],
        text=_order,
        needs=("options",),
        wrong="The order is not right.",
        mistakes=mistakes.of_order,
        messages=mistakes.OF_ORDERS,
    ),
    "free text": Kind(text=_free_text, by_a_person=True),
    "function": Kind(begin=BEGIN["function"], needs=("calls", "result")),
}
