"""Trait types of interactive figures: numbers of one shape, checked but never repaired."""

import math

import traitlets

from orientation.euler_angles import SEQUENCES
from orientation.numbers_and_symbols import number_tuples


class Numbers(traitlets.TraitType):
    """Real numbers of one shape, kept as a float or as (nested) tuples of floats.

    Parameters
    ----------
    default : nested sequences of floats
    shape : tuple
        ``()`` for one number, ``(3,)`` for a vector, ``(3, 3)`` for a matrix.
    largest : float, optional
        The largest allowed number.
    smallest : float, optional
        The smallest allowed number, by default the negative of ``largest``.
    """

    info_text = "real numbers"

    def __init__(self, default, shape=(), largest=math.inf, smallest=None, **more):
        super().__init__(number_tuples(default, shape, "default"), **more)
        self.shape, self.largest = shape, largest
        self.smallest = -largest if smallest is None else smallest

    def validate(self, obj, value):
        try:
            numbers = number_tuples(value, self.shape, self.name)
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None
        entries = _entries(numbers)
        # The end of a slider, converted from degrees, may exceed the limit by a rounding error.
        if max(entries) > self.largest + 1e-12 or min(entries) < self.smallest - 1e-12:
            cause = (
                ". Angles are in radians, not degrees"
                if (self.largest / math.pi).is_integer()
                else ""
            )
            raise traitlets.TraitError(
                f"{self.name} is {value!r}: expected numbers from {self.smallest:.6g} to "
                f"{self.largest:.6g}{cause}"
            )
        return numbers


class Direction(Numbers):
    """A nonzero vector of ``size`` components, normalised."""

    def __init__(self, default, size=3, **more):
        super().__init__(_unit(default), (size,), **more)

    def validate(self, obj, value):
        vector = super().validate(obj, value)
        if not any(vector):
            raise traitlets.TraitError(f"{self.name} is {vector}: a zero vector has no direction")
        return _unit(vector)


class Turns(traitlets.TraitType):
    """A few rotations, each an axis and an angle in radians."""

    def __init__(self, default, fewest=1, most=4, **more):
        super().__init__(default, **more)
        self.fewest, self.most = fewest, most

    def validate(self, obj, value):
        if not (
            isinstance(value, (list, tuple))
            and self.fewest <= len(value) <= self.most
            and all(isinstance(turn, (list, tuple)) and len(turn) == 2 for turn in value)
        ):
            least = f"{self.fewest} to" if self.fewest else "at most"
            raise traitlets.TraitError(
                f"{self.name} is {value!r}: expected {least} {self.most} pairs, each an "
                "axis and an angle in radians, such as (('z', 0.7), ('x', 0.5))"
            )
        return tuple((self._axis(axis), self._angle(angle)) for axis, angle in value)

    def _axis(self, axis):
        if axis not in ("x", "y", "z"):
            raise traitlets.TraitError(
                f"{self.name} has the axis {axis!r}: expected 'x', 'y' or 'z'"
            )
        return axis

    def _angle(self, angle):
        try:
            number = number_tuples(angle, (), "angle")
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(f"{self.name}: {error}") from None
        if abs(number) > math.pi + 1e-12:
            raise traitlets.TraitError(
                f"{self.name} has the angle {number:.6g}: it must be from -pi to pi. "
                "Angles are in radians, not degrees"
            )
        return number


class Sequence(traitlets.TraitType):
    """One of the twelve sequences of Euler angles."""

    def validate(self, obj, value):
        if value not in SEQUENCES:
            raise traitlets.TraitError(
                f"{self.name} is {value!r}; the twelve sequences are {', '.join(SEQUENCES)}"
            )
        return value


def _unit(vector):
    length = math.hypot(*vector)
    # A unit vector stays the same to the last digit, however often it is converted back and forth.
    return vector if abs(length - 1) < 1e-15 else tuple(entry / length for entry in vector)


def _entries(numbers):
    return (
        [number for entry in numbers for number in _entries(entry)]
        if isinstance(numbers, tuple)
        else [numbers]
    )
