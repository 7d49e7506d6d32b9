"""What the attributes of a moving figure accept: numbers of one shape, checked, never repaired."""

import math

import traitlets

from orientation._numbers_and_symbols import number_tuples
from orientation.euler_angles import SEQUENCES


class Numbers(traitlets.TraitType):
    """Real numbers of one shape, kept as a float or as (nested) tuples of floats.

    Parameters
    ----------
    default : nested sequences of floats
    shape : tuple
        ``()`` for one number, ``(3,)`` for a vector, ``(3, 3)`` for a matrix.
    largest : float, optional
        No number may be larger than this, or smaller than its negative.
    """

    info_text = "real numbers"

    def __init__(self, default, shape=(), largest=math.inf, **more):
        super().__init__(number_tuples(default, shape, "default"), **more)
        self.shape, self.largest = shape, largest

    def validate(self, obj, value):
        try:
            numbers = number_tuples(value, self.shape, self.name)
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None
        worst = max(map(abs, _entries(numbers)))
        # A slider's end, converted from degrees, may be a rounding beyond.
        if worst > self.largest + 1e-12:
            cause = ". Angles are in radians, not degrees" if (self.largest / math.pi).is_integer() else ""
            raise traitlets.TraitError(
                f"{self.name} is {value!r}: numbers from -{self.largest:.6g} to {self.largest:.6g} were expected{cause}"
            )
        return numbers


class Direction(Numbers):
    """A vector that is not zero, kept at unit length."""

    def __init__(self, default, **more):
        super().__init__(_unit(default), (3,), **more)

    def validate(self, obj, value):
        vector = super().validate(obj, value)
        if not any(vector):
            raise traitlets.TraitError(f"{self.name} is {vector}: a zero vector points nowhere")
        return _unit(vector)


class Sequence(traitlets.TraitType):
    """One of the twelve sequences of Euler angles."""

    def validate(self, obj, value):
        if value not in SEQUENCES:
            raise traitlets.TraitError(f"{self.name} is {value!r}; the twelve are {', '.join(SEQUENCES)}")
        return value


def _unit(vector):
    length = math.hypot(*vector)
    # A vector of unit length stays as it is to the last digit, however often it goes to and fro.
    return vector if abs(length - 1) < 1e-15 else tuple(entry / length for entry in vector)


def _entries(numbers):
    return [one for entry in numbers for one in _entries(entry)] if isinstance(numbers, tuple) else [numbers]
