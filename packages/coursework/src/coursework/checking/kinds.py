"""The kinds of questions that no course owns: the entries of an answer, and the check of its form.

Plug-ins build their kinds from these functions. An answer is the plain data of
`coursework.checking.plain`; `coursework.checking.reading` processes its entries.
"""

import itertools
import unicodedata
from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

from . import mistakes
from .evaluate import MP
from .kind import Kind
from .plain import Plain, Value, by_frame, entries_of, node_of, operands, parts_of, size_of, text_of
from .question import Question
from .units import unit

# The separators of the parts of an answer in words.
PARTS = {"words": " | ", "order": " < ", "truth values": ""}
FUNCTIONS = SimpleNamespace(
    sin=MP.sin, cos=MP.cos, norm=lambda *parts: MP.sqrt(sum(x * x for x in parts))
)


# A number of mpmath.
Number = Any


class Blank(Exception):
    """The question has not been answered yet."""


class Fault(Exception):
    """An answer does not have the required form: a short note for statistics, and a message."""

    def __init__(self, note: str, message: str) -> None:
        super().__init__(message)
        self.note = note
        self.message = message


class Undecidable(Exception):
    """An answer has the right form, but has no value here, so a person must decide."""


# --- the entries of an answer -------------------------------------------------------------------


def is_blank(value: Value) -> bool:
    if value[0] == "list":
        return bool(parts_of(value)) and all(map(is_blank, parts_of(value)))
    return value[0] == "blank"


def listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def number_of(count: float, noun: str, plural: str = "") -> str:
    """Return a number of things in words.

    >>> number_of(1, "file"), number_of(0, "file"), number_of(2, "entry", "entries")
    ('1 file', '0 files', '2 entries')
    """
    return f"{count} {noun if count == 1 else plural or f'{noun}s'}"


def shape_fault(expected: str, got: Value | str) -> Fault:
    return Fault(
        "shape",
        f"Give {expected[0].lower()}{expected[1:]}; this is "
        f"{got if isinstance(got, str) else _describe(got)}.",
    )


def _describe(value: Value) -> str:
    kind = str(value[0])
    if kind == "matrix":
        return f"a matrix of size {value[1]} × {value[2]}"
    if kind == "list":
        parts = parts_of(value)
        lengths = {len(parts_of(row)) for row in parts if row[0] == "list"}
        if len(lengths) == 1 and all(row[0] == "list" for row in parts):
            rows, each = (f"{len(parts)} rows", " each") if len(parts) > 1 else ("one row", "")
            return f"a list of {rows} with {number_of(lengths.pop(), 'entry', 'entries')}{each}"
        if [part[0] for part in parts] == ["expression", "text"]:
            return "a number with a unit, or with a string"
        return (
            f"a list with {number_of(len(parts), 'entry', 'entries')}" if parts else "an empty list"
        )
    return {
        "text": "a string",
        "truth": "a Boolean",
        "expression": "a single expression",
        "frame": "a reference frame",
        "vector": "a vector",
        "function": "a function",
        "frames": "a set of reference frames",
        "printed": "something printed",
        "blank": "blank in part",
        "raised": "an error",
    }[kind]


def _holding(whole: Value, part: Value) -> str:
    """Describe a list that contains one part of the wrong kind."""
    if is_blank(part):
        return "a list with blanks"
    if part[0] == "text":
        return "a list that contains a string"
    return f"a list with {len(parts_of(whole))} entries, one of which is {_describe(part)}"


def _fault_of_numbers(expected: str, value: Value) -> Fault:
    return shape_fault(
        expected, "a string: write it without quotation marks" if value[0] == "text" else value
    )


def leaf(value: Value, expected: str) -> int:
    """Return the only expression of a value, which may be a list or matrix of one entry."""
    if value[0] == "matrix" and value[1] == value[2] == 1:
        [entry] = entries_of(value)
        return entry
    parts = parts_of(value) if value[0] == "list" else []
    # Degrees are not a unit.
    if parts and parts[1:] in ([], [["text", "1"]]):
        return leaf(parts[0], expected)
    if value[0] != "expression":
        raise _fault_of_numbers(expected, value)
    return node_of(value)


def _leaf_of(whole: Value, part: Value, expected: str) -> int:
    """Return the only expression of a part of a list."""
    try:
        return leaf(part, expected)
    except Fault:
        advice = "; write numbers without quotation marks" if part[0] == "text" else ""
        raise shape_fault(expected, _holding(whole, part) + advice) from None


def _expression(question: Question, value: Value) -> list[int]:
    return [leaf(value, "A single expression")]


def components(value: Value, length: int, expected: str) -> list[int]:
    if value[0] == "matrix" and value[1:3] in ([1, length], [length, 1]):
        return entries_of(value)
    if value[0] == "list":
        parts = parts_of(value)
        if len(parts) == length:
            return [_leaf_of(value, part, expected) for part in parts]
        if len(parts) == 1 and parts[0][0] == "list":
            return components(parts[0], length, expected)
    raise _fault_of_numbers(expected, value)


def _measurement(question: Question, value: Value) -> list[int]:
    expected = "A number and its unit, such as `(3.2, 'N m')`"
    parts = parts_of(value) if value[0] == "list" else []
    if len(parts) != 2 or parts[1][0] != "text":
        raise shape_fault(expected, value)
    return [leaf(parts[0], expected)]


def scale_of(answer: Any) -> dict[str, str]:
    """Return the size of a measurement's unit for the sealed part, without what it measures."""
    return {"scale": MP.nstr(unit(answer[1]).size, 15)}


def _vector(question: Question, value: Value) -> list[int]:
    frame = question.frames[0] if question.frames else None
    parts = "components" if frame else "expressions" if question.symbols else "numbers"
    expected = f"A list of {question.length or 3} {parts}"
    if value[0] == "vector":
        # The zero vector belongs to every frame.
        if frame is None:
            raise shape_fault(expected, value)
        if frame not in by_frame(value):
            raise Fault(
                "frame",
                f"This vector is not connected to the question's frame `{frame}`.",
            )
        value = by_frame(value)[frame]
    return components(value, question.length or 3, expected)


def row_entries(value: Value, rows: int, columns: int, expected: str) -> list[int]:
    if value[0] == "matrix" and value[1:3] == [rows, columns]:
        return entries_of(value)
    parts = parts_of(value) if value[0] == "list" else []
    if len(parts) == rows:
        return [entry for row in parts for entry in _row(value, row, columns, expected)]
    # A function for stacks returns a stack of one, whose rows are lists.
    if len(parts) == 1 and (
        parts[0][0] == "matrix"
        or (parts[0][0] == "list" and all(row[0] == "list" for row in parts_of(parts[0])))
    ):
        return row_entries(parts[0], rows, columns, expected)
    raise _fault_of_numbers(expected, value)


def _row(whole: Value, row: Value, columns: int, expected: str) -> list[int]:
    length = len(parts_of(row)) if row[0] == "list" else columns
    if length not in (1, columns):
        described = _describe(whole)
        uneven = f"a list of rows, one of which has {length} entries"
        raise shape_fault(expected, described if " row" in described else uneven)
    in_line = row[0] == "list" or row[0] == "matrix" and 1 in size_of(row)
    if is_blank(row) or not in_line:
        raise shape_fault(expected, _holding(whole, row))
    return components(row, columns, expected)


def _matrix(question: Question, value: Value) -> list[int]:
    rows, columns = question.shape or (3, 3)
    return row_entries(value, rows, columns, f"A matrix of size {rows} × {columns}")


# --- answers in words ---------------------------------------------------------------------------


def word(plain: Plain, expected: str) -> str:
    value = plain["value"]
    parts = parts_of(value) if value[0] == "list" else []
    if parts and all(part[0] == "text" for part in parts):
        return "".join(map(text_of, parts))
    if value[0] != "text":
        raise shape_fault(expected, value)
    return text_of(value)


def _spelled(plain: Plain) -> str | None:
    """Return the word of a number or a symbol: ``-1`` for ``'-1'``, ``-i`` for ``'-i'``."""
    if plain["value"][0] != "expression":
        return None
    nodes = plain["nodes"]
    node = nodes[node_of(plain["value"])]
    if node[0] == "Mul" and len(node) == 3:
        factors = [nodes[factor] for factor in operands(node)]
        names = [factor[1] for factor in factors if factor[0] == "symbol"]
        return f"-{names[0]}" if ["integer", "-1"] in factors and names else None
    if node[0] == "float" and float(node[1]).is_integer():
        return f"{float(node[1]):.0f}"
    return str(node[1]) if node[0] in ("integer", "symbol") else None


def _choice(question: Question, plain: Plain, entry: str = "") -> str:
    answer = _spelled(plain) or word(
        plain, f"One of {listed(question.options)}{entry}, in quotation marks"
    )
    answer = " ".join(answer.split())
    # A typographic minus is no mistake, and neither is an unrequested or missing plus.
    text = answer.lower().translate(MINUS)
    options = {option.lower(): option for option in question.options}
    # Neither are wide letters, or quotation marks within those of Python.
    bare = unicodedata.normalize("NFKC", text).strip(QUOTES).replace("- ", "-").replace("+ ", "+")
    matches = [
        spelling
        for spelling in (text, bare, bare.removeprefix("+"), f"+{bare}")
        if spelling in options
    ]
    if not matches:
        raise Fault(
            "shape",
            f"The answer{entry} must be one of {listed(question.options)}, not `{answer[:40]}`.",
        )
    return matches[0]


def _choices(question: Question, plain: Plain) -> list[str]:
    """Return each part of a list as one of the options."""
    return [
        _choice(question, {"value": part, "nodes": plain["nodes"]}, f" in entry {order}")
        for order, part in enumerate(parts_of(plain["value"]), 1)
    ]


def _truths(question: Question, plain: Plain) -> str:
    value, length = plain["value"], question.length
    expected = f"A list of {length} Booleans, `True` or `False`"
    if value[0] != "list" or len(parts_of(value)) != length:
        raise shape_fault(expected, value)
    letters = ""
    for part in parts_of(value):
        content: object = text_of(part).strip().lower() if part[0] == "text" else None
        if part[0] == "expression":
            content = plain["nodes"][node_of(part)]
        if part == ["truth", True] or content in ("true", ["integer", "1"]):
            letters += "T"
        elif part == ["truth", False] or content in ("false", ["integer", "0"]):
            letters += "F"
        else:
            raise shape_fault(expected, _holding(value, part))
    return letters


def _words(question: Question, plain: Plain) -> str:
    value, length, options = plain["value"], question.length, question.options
    expected = f"A list of {length} words, each one of {listed(options)}"
    if value[0] != "list" or len(parts_of(value)) != length:
        raise shape_fault(expected, value)
    if any(map(is_blank, parts_of(value))):
        advice = ": `'none'` is a string too" if "none" in options else ""
        raise shape_fault(expected, f"a list with blanks{advice}")
    return PARTS["words"].join(_choices(question, plain))


def _order(question: Question, plain: Plain) -> str:
    value, options = plain["value"], question.options
    expected = f"A list with each of {listed(options)} once"
    if value[0] != "list" or len(parts_of(value)) != len(options):
        raise shape_fault(expected, value)
    parts = _choices(question, plain)
    twice = next((part for part in parts if parts.count(part) > 1), None)
    if twice is not None:
        raise shape_fault(expected, f"one in which `{twice}` appears {parts.count(twice)} times")
    return PARTS["order"].join(parts)


def _free_text(question: Question, plain: Plain) -> str:
    text = word(plain, "A text").strip()
    if not text:
        raise Blank
    return text


# Characters that a text program puts around a word that is quoted twice, and its forms of a minus.
QUOTES = " \"'`\u2018\u2019\u201a\u201b\u201c\u201d\u201e\u00ab\u00bb"
MINUS = str.maketrans("\u2212\u2010\u2011\u2013", "----")


# --- one value for what can be written in several ways ------------------------------------------


def one_sign(question: Question, numbers: list[Number]) -> list[Number]:
    # Of two opposites, use the one whose first nonzero component is positive.
    limit = sign_limit(question)
    leading = next((number for number in numbers if abs(number) > limit), MP.one)
    return numbers if leading > 0 or not question.either_sign else [-number for number in numbers]


def sign_limit(question: Question) -> Number:
    """Return the limit below which a component counts as zero, so that rounding decides no sign."""
    return MP.mpf("2e-9") if question.tolerance is None else 8 * MP.mpf(str(question.tolerance))


# --- what is wrong with the form ----------------------------------------------------------------


def slack(question: Question) -> Number:
    return MP.mpf("1e-9") if question.tolerance is None else 6 * MP.mpf(str(question.tolerance))


def short(number: Number) -> str:
    return str(MP.nstr(number, 3))


def length_in_words(length: Number) -> str:
    """Return a length that should be 1, with enough digits to show that it is not."""
    texts = (str(MP.nstr(length, digits)) for digits in itertools.count(3))
    return next(text for text in texts if MP.mpf(text) != 1).removesuffix(".0")


def _unit_vector_fault(question: Question, numbers: list[Number]) -> Fault | None:
    if question.unit_vector:
        length = FUNCTIONS.norm(*numbers)
        if abs(length - 1) > slack(question):
            return Fault(
                "not unit length",
                "The question asks for a unit vector, but this one has length "
                f"{length_in_words(length)}.",
            )
    return None


def transposed(question: Question, numbers: list[Number]) -> list[Number] | None:
    """Return the entries of the transpose, or ``None`` for another shape."""
    rows, columns = question.shape or (3, 3)
    if rows != columns:
        return None
    return [numbers[row * columns + column] for column in range(columns) for row in range(rows)]


TRANSPOSED = {"transposed": ("the matrix is transposed, and it has another mistake.", transposed)}
SEVERAL = "At least two of these are wrong."
KINDS = {
    "expression": Kind(entries=_expression, mistakes=mistakes.of_expression),
    "vector": Kind(
        entries=_vector,
        unique=one_sign,
        fault=_unit_vector_fault,
        mistakes=mistakes.of_vector,
    ),
    "matrix": Kind(
        entries=_matrix,
        needs=("shape",),
        mistakes=mistakes.of_matrix,
        slips=TRANSPOSED,
    ),
    "choice": Kind(
        begin="Test each possibility on the simplest case that distinguishes them.",
        text=_choice,
        needs=("options",),
    ),
    "words": Kind(
        begin="Take them one by one, starting with those that you are sure of. Find a test for the "
        "others.",
        text=_words,
        needs=("options", "length"),
        wrong=SEVERAL,
        mistakes=mistakes.of_parts,
    ),
    "truth values": Kind(
        begin="Look for an example that refutes a claim. If there is none, look for a proof.",
        text=_truths,
        needs=("length",),
        wrong=SEVERAL,
        mistakes=mistakes.of_parts,
    ),
    "measurement": Kind(
        begin="Calculate with the units as with the numbers. What do the given units combine to?",
        entries=_measurement,
        wrong="This is a number with a unit, but the number, the unit or both are wrong.",
        public=scale_of,
        mistakes=mistakes.of_measurement,
        messages=mistakes.OF_MEASUREMENTS,
        details={"power": mistakes.POWERS},
    ),
    "order": Kind(
        begin="Find the first and the last, then compare two at a time.",
        text=_order,
        needs=("options",),
        wrong="The order is wrong.",
        mistakes=mistakes.of_order,
        messages=mistakes.OF_ORDERS,
    ),
    "free text": Kind(text=_free_text, by_a_person=True),
    "function": Kind(
        begin="Work out by hand what it should return for the simplest arguments, and compare.",
        needs=("calls", "result"),
    ),
}
