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

from orientation.axis_angle import axis_angle_formula
from orientation.euler_angles import body_fixed_formula

from .evaluate import MP, NotSupported, TooLarge, Undefined, UnknownSymbol, real, values
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
    if question["kind"] in WORDS:
        return Reading([], WORDS[question["kind"]](question, plain))
    leaves = ENTRIES[question["kind"]](question, value)
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
    # An entry of a matrix that is built of three numbers is off by what all three are.
    parts = 3 if _kind_of_values(question) in ("Euler angles", "axis and angle") else 1
    return 4 * parts * MP.mpf(str(tolerance))


def canonical(question, reading):
    """The numbers of a reading with what is a matter of taste removed, all points one after another."""
    unique = UNIQUE.get(_kind_of_values(question))
    if not unique:
        return [number for numbers in reading.numbers for number in numbers]
    return [number for numbers in reading.numbers for number in unique(question, numbers)]


def fault(question, reading):
    """Say what is wrong with the form of an answer that was read, or give ``None``."""
    find = FAULTS.get(_kind_of_values(question))
    if find and reading.text is None:
        for numbers in reading.numbers:
            found = find(question, numbers)
            if found:
                return found
    return None


def dcm_name(question):
    target, source = question.get("frames", ("A", "N"))
    return rf"${{}}^{target}\mathbf{{C}}^{source}$"


# --- reading the entries ------------------------------------------------------------------------


def _kind_of_values(question):
    return question["result"] if question["kind"] == "function" else question["kind"]


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
        wanted = f"this question has the symbols {_listed(given)}" if given else "this question has no symbols"
        raise Fault("stray symbol", f"The answer holds `{name}`; {wanted}.") from None
    except Undefined as error:
        raise Fault("undefined", f"The answer has no finite value for some values of its symbols: {error}.") from None
    except TooLarge as error:
        raise Fault("too large", f"The answer is not worked out: {error}.") from None
    except NotSupported as error:
        raise Undecidable(f"The answer holds {error}, whose value is not worked out here.") from None
    except ValueError:
        raise Fault("not real", "The answer has an imaginary part; what is asked for is real.") from None


def _listed(names):
    return ", ".join(f"`{name}`" for name in names)


def _shape_fault(wanted, value, got=None):
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


def _leaf(value, wanted):
    """The one expression that a value is; a list or matrix of one entry is that entry."""
    if value[0] == "matrix" and value[1] == value[2] == 1:
        return value[3][0]
    if value[0] == "list" and len(value[1]) == 1:
        return _leaf(value[1][0], wanted)
    if value[0] != "expression":
        raise _shape_fault(wanted, value)
    return value[1]


def _expression(question, value):
    return [_leaf(value, "A single expression")]


def _components(value, length, wanted):
    if value[0] == "matrix" and sorted(value[1:3]) == sorted((1, length)):
        return value[3]
    if value[0] == "list" and len(value[1]) == length:
        return [_leaf(part, wanted) for part in value[1]]
    if value[0] == "list" and len(value[1]) == 1 and value[1][0][0] == "list":
        return _components(value[1][0], length, wanted)
    raise _shape_fault(wanted, value)


def _vector(question, value):
    length = question.get("length", 3)
    frame = question.get("frames", (None,))[0]
    if value[0] == "vector":
        # The zero vector belongs to every frame.
        if frame is None:
            raise _shape_fault(f"A list of {length} components", value)
        if frame not in value[1]:
            raise Fault("frame", f"This vector is not connected with the frame `{frame}` that the question names.")
        value = value[1][frame]
    return _components(value, length, f"A list of {length} components")


def _rows(value, rows, columns, wanted):
    if value[0] == "matrix" and tuple(value[1:3]) == (rows, columns):
        return value[3]
    if value[0] == "list" and len(value[1]) == rows:
        return [leaf for row in value[1] for leaf in _components(row, columns, wanted)]
    raise _shape_fault(wanted, value)


def _matrix(question, value):
    rows, columns = question.get("shape", (3, 3))
    return _rows(value, rows, columns, f"A matrix of {rows} × {columns}")


def _dcm(question, value):
    if value[0] == "frame":
        target, source = question["frames"]
        name, others = value[1], value[2]
        if target not in (name,) or source not in others:
            raise Fault(
                "frame",
                f"This is the frame `{name}`, connected with {_listed(others)}; the question asks "
                f"for the orientation of `{target}` with respect to `{source}`.",
            )
        value = others[source]
    return _rows(value, 3, 3, "A matrix of 3 × 3")


def _quaternion(question, value):
    return _components(value, 4, "A list of four numbers, the scalar first,")


def _angles(question, value):
    return _components(value, 3, "A list of three angles")


def _axis_and_angle(question, value):
    wanted = "An axis with three components and an angle, `(axis, angle)`,"
    if value[0] != "list" or len(value[1]) != 2:
        raise _shape_fault(wanted, value)
    first, second = value[1]
    if first[0] == "expression":
        first, second = second, first
    if first[0] == "vector":
        first = next(iter(first[1].values()), ["list", []])
    return [*_components(first, 3, wanted), _leaf(second, wanted)]


ENTRIES = {
    "expression": _expression,
    "vector": _vector,
    "matrix": _matrix,
    "direction cosine matrix": _dcm,
    "quaternion": _quaternion,
    "Euler angles": _angles,
    "axis and angle": _axis_and_angle,
}


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
            numbers.append([_number(inner, results[leaf]) for leaf in ENTRIES[inner["kind"]](inner, result)])
        except Fault as found:
            raise Fault(found.note, f"{which} returned something else than was asked for. {found.message}") from None
    if len(numbers) != len(question["calls"]):
        raise Fault("raised an error", "The function did not answer all calls.")
    return Reading(numbers)


# --- answers in words ---------------------------------------------------------------------------


def _word(plain, wanted):
    value = plain["value"]
    if value[0] == "list" and value[1] and all(part[0] == "text" for part in value[1]):
        return "".join(part[1] for part in value[1])
    if value[0] != "text":
        raise _shape_fault(wanted, value)
    return value[1]


def _sequence(question, plain):
    text = "".join(
        letter for letter in _word(plain, "A sequence of three axes, such as `'xyz'`,").lower() if letter.isalnum()
    )
    if len(text) != 3 or set(text) - set("xyz"):
        raise Fault("shape", f"A sequence is three of the letters x, y and z, such as `'xyz'`; this is `{text[:20]}`.")
    if text[0] == text[1] or text[1] == text[2]:
        raise Fault(
            "impossible sequence",
            f"`{text}` has two turns in a row about one axis, which are one turn: it is none of the 12 sets.",
        )
    return text


def _choice(question, plain):
    given = " ".join(_word(plain, f"One of {_listed(question['options'])}").split())
    text = given.lower()
    options = {option.lower(): option for option in question["options"]}
    if text not in options:
        raise Fault("shape", f"The answer is one of {_listed(question['options'])}; this is `{given[:40]}`.")
    return text


def _truths(question, plain):
    value, length = plain["value"], question["length"]
    wanted = f"A list of {length} truth values, `True` or `False`,"
    if value[0] != "list" or len(value[1]) != length:
        raise _shape_fault(wanted, value)
    for part in value[1]:
        if part[0] != "truth":
            raise _shape_fault(wanted, part, f"a list that holds {_describe(part)}")
    return "".join("T" if part[1] else "F" for part in value[1])


def _words(question, plain):
    value, length, options = plain["value"], question["length"], question["options"]
    wanted = f"A list of {length} words, each one of {_listed(options)},"
    if value[0] != "list" or len(value[1]) != length:
        raise _shape_fault(wanted, value)
    return " | ".join(_choice(question, {"value": part}) for part in value[1])


WORDS = {"sequence": _sequence, "choice": _choice, "truth values": _truths, "words": _words}


# --- one value for what can be written in several ways ------------------------------------------


def _one_sign(question, numbers):
    # Of two opposites the one whose first component that is not zero is positive.
    limit = 2 * cell_of(question)
    leading = next((number for number in numbers if abs(number) > limit), MP.one)
    return numbers if leading > 0 or not question.get("either sign") else [-number for number in numbers]


def _of_angles(question, numbers):
    return body_fixed_formula(question["sequence"])(FUNCTIONS, *numbers)


def _of_axis_and_angle(question, numbers):
    if not any(numbers[:3]):
        raise Fault("zero axis", "The axis is zero, and a zero vector points nowhere.")
    return axis_angle_formula(FUNCTIONS, *numbers)


UNIQUE = {
    "quaternion": _one_sign,
    "vector": _one_sign,
    "Euler angles": _of_angles,
    "axis and angle": _of_axis_and_angle,
}


# --- what is wrong with the form ----------------------------------------------------------------


def _slack(question):
    tolerance = question.get("tolerance")
    return MP.mpf("1e-9") if tolerance is None else 6 * MP.mpf(str(tolerance))


def _short(number):
    return MP.nstr(number, 3)


def _dcm_fault(question, numbers):
    rows = [numbers[0:3], numbers[3:6], numbers[6:9]]
    worst = max(
        ((abs(_dot(rows[i], rows[j]) - (i == j)), i, j) for i in range(3) for j in range(i, 3)),
        key=lambda found: found[0],
    )
    size, i, j = worst
    where = " at the values tried" if question.get("symbols") else ""
    if size > _slack(question):
        names = ("first", "second", "third")
        if i == j:
            length = MP.sqrt(_dot(rows[i], rows[i]))
            said = f"the {names[i]} row should be a unit vector and has length {_short(length)}{where}"
        else:
            said = (
                f"the {names[i]} and the {names[j]} row should be perpendicular, and their dot product is "
                f"{_short(_dot(rows[i], rows[j]))}{where}"
            )
        return Fault("not orthogonal", f"This is no direction cosine matrix: {said}.")
    if _determinant(rows) < 0:
        return Fault(
            "left-handed",
            "The rows are perpendicular unit vectors, but their determinant is −1: they make "
            "a left-handed triad. Has one row, or one sign too many, been turned round?",
        )
    return None


def _quaternion_fault(question, numbers):
    length = FUNCTIONS.norm(*numbers)
    if abs(length - 1) > _slack(question):
        where = " at the values tried" if question.get("symbols") else ""
        return Fault(
            "not unit length",
            f"The quaternion of an orientation has length 1; this one has length {_short(length)}{where}.",
        )
    return None


def _angles_fault(question, numbers):
    largest = max(numbers, key=abs)
    if abs(largest) > 2 * MP.pi + MP.mpf("0.01"):
        return Fault(
            "degrees",
            f"One of the angles is {_short(largest)}, which is more than a full turn of "
            f"$2\\pi$ rad. Is it in degrees? Angles are in radians here.",
        )
    return None


def _axis_fault(question, numbers):
    length = FUNCTIONS.norm(*numbers[:3])
    if abs(length - 1) > _slack(question) and question.get("unit axis", True):
        return Fault("not unit length", f"The axis should be a unit vector; this one has length {_short(length)}.")
    return _angles_fault(question, numbers[3:])


def _unit_vector_fault(question, numbers):
    if question.get("unit vector"):
        length = FUNCTIONS.norm(*numbers)
        if abs(length - 1) > _slack(question):
            return Fault("not unit length", f"A unit vector is asked for; this one has length {_short(length)}.")
    return None


def _dot(first, second):
    return sum(a * b for a, b in zip(first, second))


def _determinant(rows):
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


FAULTS = {
    "direction cosine matrix": _dcm_fault,
    "quaternion": _quaternion_fault,
    "Euler angles": _angles_fault,
    "axis and angle": _axis_fault,
    "vector": _unit_vector_fault,
}
