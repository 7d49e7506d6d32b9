"""Record the formulas of ``orientation``: what each computes, step by step, without numbers.

Each conversion is written once, as a formula that takes components and a namespace of functions.
Here the components are instances of `Value`, which remember how they were computed, so evaluating a
formula records its operations in order. `orientation_workbench.languages` writes the record in
other languages.
"""

import math
from types import SimpleNamespace
from unittest import mock

import numpy as np

import orientation

_made = {}


class Value:
    """A number or Boolean that is not known yet: an operation and its operands."""

    __slots__ = ("operation", "parts")
    __hash__ = object.__hash__

    def __init__(self, operation, parts):
        self.operation, self.parts = operation, parts

    def __bool__(self):
        raise TypeError("a recorded formula must use where and pick instead of if")


def made(operation, *parts):
    """Return the value of an operation, always the same object for the same operands."""
    key = (operation, *(id(part) if isinstance(part, Value) else (part,) for part in parts))
    if key not in _made:
        _made[key] = Value(operation, parts)
    return _made[key]


def variable(name):
    """Return a value with a name, a component of one of the formula's arguments."""
    return made("variable", name)


def _is(value, number):
    # An integer only: 0.0 is added on purpose, since it turns -0.0 into 0.0.
    return type(value) is int and value == number


def _negative(value):
    return isinstance(value, Value) and value.operation == "negative"


def negative(value):
    if not isinstance(value, Value):
        return -value
    return value.parts[0] if _negative(value) else made("negative", value)


# Signs are combined only where the result stays the same to the last bit.
def added(first, second):
    if _is(first, 0) or _is(second, 0):
        return second if _is(first, 0) else first
    if _negative(second):
        return first - second.parts[0]
    return made("+", first, second) if Value in (type(first), type(second)) else first + second


def multiplied(first, second):
    for factor, other in ((first, second), (second, first)):
        if type(factor) is int and factor in (0, 1, -1):
            return {0: 0, 1: other, -1: negative(other)}[factor]
        if _negative(factor):
            return negative(multiplied(factor.parts[0], other))
    return made("*", first, second) if Value in (type(first), type(second)) else first * second


def divided(first, second):
    if _is(first, 0) or _is(second, 1):
        return first
    return made("/", first, second) if Value in (type(first), type(second)) else first / second


def _compared(operation):
    return lambda value, other: made(operation, value, other)


#: What Python's operators do with a value. In those with an ``r``, the value is on the right.
_OPERATORS = {
    "add": added,
    "radd": lambda value, other: added(other, value),
    "sub": lambda value, other: (
        added(value, negative(other)) if _negative(other) else made("-", value, other)
    ),
    "rsub": lambda value, other: made("-", other, value),
    "mul": multiplied,
    "rmul": lambda value, other: multiplied(other, value),
    "truediv": divided,
    "rtruediv": lambda value, other: divided(other, value),
    "pow": lambda value, count: multiplied(value, value ** (count - 1)) if count > 1 else value,
    "neg": negative,
    "abs": lambda value: made("abs", value),
    "lt": _compared("<"),
    "gt": _compared(">"),
    "ge": _compared(">="),
    "eq": _compared("=="),
}
for _name, _function in _OPERATORS.items():
    setattr(Value, f"__{_name}__", _function)


def _pick(scores, rows):
    """Return the row with the largest score, or the first of several, entry by entry."""
    *others, last = [
        (made("and", *(score >= other for other in scores if other is not score)), row)
        for score, row in zip(scores, rows)
    ]
    chosen = last[1]
    for best, row in reversed(others):
        chosen = [_where(best, entry, other) for entry, other in zip(row, chosen)]
    return chosen


def _where(condition, yes, no):
    return (
        yes
        if yes is no or (type(yes) is int and _is(no, yes))
        else made("where", condition, yes, no)
    )


#: The namespace of functions that a formula receives.
FUNCTIONS = SimpleNamespace(
    sin=lambda angle: made("sin", angle),
    cos=lambda angle: made("cos", angle),
    atan2=lambda sine, cosine: made("atan2", sine, cosine),
    norm=lambda *components: made("sqrt", sum(entry * entry for entry in components)),
    where=_where,
    pick=_pick,
)


def applied(formula, *components):
    """Return the recorded results of a formula ``formula(f, *components)``."""
    return list(formula(FUNCTIONS, *components))


def recorded(function, *arguments):
    """Return the recorded results of a public function of ``orientation``, in a flat list."""

    def record(formula, shape, *given, guard=None):
        components = [entry for _, value, _ in given for entry in _flat(value)]
        results = np.empty(math.prod(shape), object)
        results[:] = applied(formula, *components)
        return results.reshape(shape)

    # The function looks its helpers up in its module's globals, so patching those records it.
    helpers = {
        "evaluate": record,
        "evaluate_numbers": record,
        "is_symbolic": lambda value: True,
        "symbol_components": lambda value, *what: value,
    }
    with mock.patch.dict(function.__globals__, helpers):
        return list(np.ravel(function(*arguments)))


def _flat(value):
    return (
        [entry for row in value for entry in _flat(row)]
        if isinstance(value, (list, tuple))
        else [value]
    )


#: The formulas to take away: the kind of each argument, by name, and of the result.
FORMULAS = {
    "simple_dcm": ({"angle": "angle"}, "matrix"),
    "dcm_from_body_fixed": ({"angles": "angles"}, "matrix"),
    "dcm_from_space_fixed": ({"angles": "angles"}, "matrix"),
    "body_fixed_from_dcm": ({"dcm": "matrix"}, "angles"),
    "space_fixed_from_dcm": ({"dcm": "matrix"}, "angles"),
    "gimbal_lock_margin": ({"angles": "angles"}, "angle"),
    "dcm_from_axis_angle": ({"axis": "vector", "angle": "angle"}, "matrix"),
    "quaternion_from_axis_angle": ({"axis": "vector", "angle": "angle"}, "quaternion"),
    "dcm_from_quaternion": ({"quaternion": "quaternion"}, "matrix"),
    "quaternion_from_dcm": ({"dcm": "matrix"}, "quaternion"),
    "multiply_quaternions": ({"first": "quaternion", "second": "quaternion"}, "quaternion"),
    "interpolate_quaternions": (
        {"first": "quaternion", "second": "quaternion", "share": "number"},
        "quaternion",
    ),
    "dcm_from_rotation_vector": ({"vector": "angles"}, "matrix"),
    "rotation_vector_from_dcm": ({"dcm": "matrix"}, "angles"),
    "angular_velocity_matrix": ({"angles": "angles"}, "entries"),
    "dcm_rate": ({"dcm": "matrix", "angular_velocity": "vector"}, "matrix"),
    "quaternion_rate": ({"quaternion": "quaternion", "angular_velocity": "vector"}, "quaternion"),
    "rotation_vector_rate": ({"vector": "vector", "angular_velocity": "vector"}, "vector"),
}
#: How many numbers each kind has; a single one is not a list.
SIZES = {
    "angle": 1,
    "number": 1,
    "angles": 3,
    "vector": 3,
    "quaternion": 4,
    "matrix": 9,
    "entries": 9,
}
LISTS = ("angles", "vector", "quaternion", "matrix", "entries")
#: Arguments that are chosen once for a whole function and are not numbers.
CHOICES = {
    "simple_dcm": ("axis", orientation.direction_cosines.AXES),
    **{
        name: ("sequence", orientation.SEQUENCES)
        for name in (
            "dcm_from_body_fixed", "dcm_from_space_fixed", "body_fixed_from_dcm",
            "space_fixed_from_dcm", "gimbal_lock_margin", "angular_velocity_matrix",
        )
    },
}  # fmt: skip


def formula_of(name, components, choice=None):
    """Return the results of one of `FORMULAS`, given a list of values for each argument."""
    given = [
        [entries[k : k + 3] for k in (0, 3, 6)]
        if kind in ("matrix", "entries")
        else entries
        if kind in LISTS
        else entries[0]
        for kind, entries in zip(FORMULAS[name][0].values(), components)
    ]
    chosen = [] if choice is None else [choice]
    return recorded(
        getattr(orientation, name),
        *([*chosen, *given] if name == "simple_dcm" else [*given, *chosen]),
    )
