"""What each kind of question asks for, and the fingerprint of an answer to it.

An answer is *read* into real numbers: its entries at the points of the question. Those numbers, rounded to
whole cells, are its fingerprint; all ways of writing one answer share it. What has several equally right
values is first turned into something that has one: a quaternion and its negative, the many Euler angles of
one orientation.

The same reading serves the student's check, which compares fingerprints through a slow hash, and the
grading, which compares them as they are. It sees only the plain data of :mod:`coursework.checking.plain`.
"""

import json
from types import SimpleNamespace
from typing import NamedTuple

from . import mistakes
from .evaluate import MP, NotSupported, TooLarge, Undefined, UnknownSymbol, real, values
from .plugins import Kind, kind_of_values, kinds
from .points import points

#: Size of a cell where answers are exact: above all rounding of doubles, below every real difference.
EXACT_CELL = MP.mpf(10) ** -9
FUNCTIONS = SimpleNamespace(sin=MP.sin, cos=MP.cos, norm=lambda *parts: MP.sqrt(sum(x * x for x in parts)))


class Blank(Exception):
    """Nothing has been answered yet."""


class Fault(Exception):
    """An answer is not of the form that is asked for: a short note for statistics, and a message."""

    def __init__(self, note, message):
        super().__init__(message)
        self.note = note
        self.message = message


class Undecidable(Exception):
    """An answer has the right form, but its value cannot be found here: a person must look."""


class Reading(NamedTuple):
    """An answer as numbers: ``numbers`` is a list for each point; ``text`` is set for words instead."""

    numbers: list
    text: str | None = None


def calls_for(question):
    """The arguments of each call to a function that is asked for, made anew: it may change them."""
    if question["kind"] != "function":
        return None
    if question["takes"] == "arrays":
        import numpy

        return [
            [numpy.array(part) if isinstance(part, list) else part for part in arguments]
            for arguments in question["calls"]
        ]
    return [json.loads(json.dumps(arguments)) for arguments in question["calls"]]


def read(question, plain):
    """Read an answer.

    Parameters
    ----------
    question : dict
        The public part of a question: its kind, shape, symbols, frames, salt and so on.
    plain : dict
        The answer as :func:`coursework.checking.plain.to_plain` gives it.

    Raises
    ------
    Blank, Fault, Undecidable
    """
    value = plain["value"]
    if _blank(value):
        raise Blank
    if question["kind"] == "function":
        return _read_function(question, plain)
    kind = kinds()[question["kind"]]
    if kind.text:
        return Reading([], kind.text(question, plain))
    leaves = kind.entries(question, value)
    numbers = []
    for point in points(question):
        results = values(plain["nodes"], point)
        numbers.append([_number(question, results[leaf]) for leaf in leaves])
    return Reading(numbers)


def fingerprint(question, reading):
    """Give the text that is the same for all forms of one answer, and for no other answer."""
    if reading.text is not None:
        return reading.text
    return " ".join(str(cell) for cell in cells(question, canonical(question, reading)))


def cells(question, numbers):
    cell = cell_of(question)
    shift = question.get("shift", "")
    return [
        int(MP.nint(number / cell + (MP.mpf(shift[order]) / 2 if shift else 0))) for order, number in enumerate(numbers)
    ]


def cell_of(question):
    """Size of a cell: an answer that is off by no more than the tolerance stays in its cell."""
    tolerance = question.get("tolerance")
    if tolerance is None:
        return EXACT_CELL
    return 4 * kind_of_values(question).parts * MP.mpf(str(tolerance))


def canonical(question, reading):
    """The numbers of a reading with what is a matter of taste removed, all points one after another."""
    unique = kind_of_values(question).unique
    if not unique:
        return [number for numbers in reading.numbers for number in numbers]
    return [number for numbers in reading.numbers for number in unique(question, numbers)]


def fault(question, reading):
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
        return real(result)
    except UnknownSymbol as error:
        name = error.args[0][:40]
        given = list(question.get("symbols", ()))
        wanted = f"this question has the symbols {listed(given)}" if given else "this question has no symbols"
        raise Fault("stray symbol", f"The answer holds `{name}`; {wanted}.") from None
    except Undefined as error:
        raise Fault("undefined", f"The answer has no finite value for some values of its symbols: {error}.") from None
    except TooLarge as error:
        raise Fault("too large", f"The answer is not worked out: {error}.") from None
    except NotSupported as error:
        raise Undecidable(f"The answer holds {error}, whose value is not worked out here.") from None
    except ValueError:
        raise Fault("not real", "The answer has an imaginary part; what is asked for is real.") from None


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
        return f"a list with {len(value[1])} entr{'y' if len(value[1]) == 1 else 'ies'}"
    return {
        "text": "a text",
        "truth": "a truth value",
        "expression": "a single expression",
        "frame": "a reference frame",
        "vector": "a vector",
        "function": "a function",
        "blank": "still blank in part",
        "raised": "an error",
    }[kind]


def leaf(value, wanted):
    """The one expression that a value is; a list or matrix of one entry is that entry."""
    if value[0] == "matrix" and value[1] == value[2] == 1:
        return value[3][0]
    if value[0] == "list" and len(value[1]) == 1:
        return leaf(value[1][0], wanted)
    if value[0] != "expression":
        raise shape_fault(wanted, value)
    return value[1]


def _expression(question, value):
    return [leaf(value, "A single expression")]


def components(value, length, wanted):
    if value[0] == "matrix" and sorted(value[1:3]) == sorted((1, length)):
        return value[3]
    if value[0] == "list" and len(value[1]) == length:
        return [leaf(part, wanted) for part in value[1]]
    if value[0] == "list" and len(value[1]) == 1 and value[1][0][0] == "list":
        return components(value[1][0], length, wanted)
    raise shape_fault(wanted, value)


def _vector(question, value):
    length = question.get("length", 3)
    frame = question.get("frames", (None,))[0]
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
        return [leaf for row in value[1] for leaf in components(row, columns, wanted)]
    raise shape_fault(wanted, value)


def _matrix(question, value):
    rows, columns = question.get("shape", (3, 3))
    return row_entries(value, rows, columns, f"A matrix of {rows} × {columns}")


def _read_function(question, plain):
    value = plain["value"]
    if value[0] != "function":
        raise Fault("shape", "A function is asked for: give its name, without calling it.")
    inner = {**question, "kind": question["result"], "symbols": {}}
    if all(map(_blank, value[1])):
        raise Blank  # the body of the function is still empty
    results = values(plain["nodes"], {})
    numbers = []
    for order, result in enumerate(value[1]):
        which = f"In call {order + 1} of {len(value[1])} the function"
        if result[0] == "raised":
            raise Fault("raised an error", f"{which} raised `{result[1]}`.")
        if _blank(result):
            raise Fault("returned nothing", f"{which} returned nothing. Is there a `return`?")
        try:
            numbers.append([_number(inner, results[leaf]) for leaf in kinds()[inner["kind"]].entries(inner, result)])
        except Fault as found:
            raise Fault(found.note, f"{which} returned something else than was asked for. {found.message}") from None
    if len(numbers) != len(question["calls"]):
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


def _choice(question, plain):
    given = " ".join(word(plain, f"One of {listed(question['options'])}").split())
    text = given.lower()
    options = {option.lower(): option for option in question["options"]}
    if text not in options:
        raise Fault("shape", f"The answer is one of {listed(question['options'])}; this is `{given[:40]}`.")
    return text


def _truths(question, plain):
    value, length = plain["value"], question["length"]
    wanted = f"A list of {length} truth values, `True` or `False`,"
    if value[0] != "list" or len(value[1]) != length:
        raise shape_fault(wanted, value)
    for part in value[1]:
        if part[0] != "truth":
            raise shape_fault(wanted, part, f"a list that holds {_describe(part)}")
    return "".join("T" if part[1] else "F" for part in value[1])


def _words(question, plain):
    value, length, options = plain["value"], question["length"], question["options"]
    wanted = f"A list of {length} words, each one of {listed(options)},"
    if value[0] != "list" or len(value[1]) != length:
        raise shape_fault(wanted, value)
    return " | ".join(_choice(question, {"value": part}) for part in value[1])


# --- one value for what can be written in several ways ------------------------------------------


def one_sign(question, numbers):
    # Of two opposites the one whose first component that is not zero is positive.
    limit = 2 * cell_of(question)
    leading = next((number for number in numbers if abs(number) > limit), MP.one)
    return numbers if leading > 0 or not question.get("either sign") else [-number for number in numbers]


# --- what is wrong with the form ----------------------------------------------------------------


def slack(question):
    tolerance = question.get("tolerance")
    return MP.mpf("1e-9") if tolerance is None else 6 * MP.mpf(str(tolerance))


def short(number):
    return MP.nstr(number, 3)


def _unit_vector_fault(question, numbers):
    if question.get("unit vector"):
        length = FUNCTIONS.norm(*numbers)
        if abs(length - 1) > slack(question):
            return Fault("not unit length", f"A unit vector is asked for; this one has length {short(length)}.")
    return None


KINDS = {
    "expression": Kind(entries=_expression, mistakes=mistakes.of_expression),
    "vector": Kind(entries=_vector, unique=one_sign, fault=_unit_vector_fault, mistakes=mistakes.of_vector),
    "matrix": Kind(entries=_matrix, needs=("shape",), mistakes=mistakes.of_matrix),
    "choice": Kind(text=_choice, needs=("options",)),
    "words": Kind(text=_words, needs=("options", "length")),
    "truth values": Kind(text=_truths, needs=("length",)),
    "function": Kind(needs=("calls", "result")),
}
