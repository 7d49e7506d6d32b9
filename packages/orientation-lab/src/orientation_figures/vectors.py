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
