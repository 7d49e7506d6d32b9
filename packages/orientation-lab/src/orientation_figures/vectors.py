"""Vectors as lists of numbers, with the same functions in Python and in ``js/mathematics.js``.

They do without NumPy, as figures do until they are drawn.
"""

import math

AXES = "xyz"
IDENTITY = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


degrees = math.degrees


def in_degrees(angle):
    """Return an angle in whole degrees for screen readers: '1 degree', '71 degrees'."""
    number = round(degrees(angle))
    return f"{number} degree{'s' * (abs(number) != 1)}"


def add(*vectors):
    return [sum(entries) for entries in zip(*vectors)]


def subtract(u, v):
    return [a - b for a, b in zip(u, v)]


def scale(factor, v):
    return [factor * entry for entry in v]


def dot(u, v):
    return sum(a * b for a, b in zip(u, v))


def cross(u, v):
    return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]


def length(v):
    return math.hypot(*v)


def unit(v):
    """Return ``v`` at unit length; a zero vector stays zero."""
    return scale(1 / (length(v) or 1), v)


def transpose(matrix):
    return matrix.T


def times(matrix, v):
    """Return v_A = A_C_N v_N."""
    return [dot(row, v) for row in matrix]


def multiply(first, second):
    return first @ second


def full_turns(angle):
    """Return the number of full rotations of the plate if it is 1 or 2, else 0."""
    numbers = [turns for turns in [1, 2] if abs(angle - 2 * math.pi * turns) < 1e-8]
    return numbers[0] if len(numbers) else 0


def quaternion_at(angle, passed, part):
    """Return the unit quaternion of the belt at a share of its length.

    Its first and last sixth stay straight, so that the plate keeps away from the wall.
    """
    share = min(1, max(0, 1.5 * part - 0.25))
    turns = full_turns(angle)
    if turns == 2:
        # Circles through 1 on the sphere of quaternions, from a great circle down to a point.
        tilt, way = passed * math.pi / 2, 2 * math.pi * share
        size = math.cos(tilt)
        return [
            1 - size * size * (1 - math.cos(way)), 0, size * math.sin(way),
            size * math.sin(tilt) * (1 - math.cos(way))
        ]  # fmt: skip
    # Half circles from 1 to -1, from one side to the other.
    tilt, half = passed * math.pi if turns == 1 else 0, angle * share / 2
    return [math.cos(half), 0, math.cos(tilt) * math.sin(half), math.sin(tilt) * math.sin(half)]
