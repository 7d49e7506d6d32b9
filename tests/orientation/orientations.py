"""Test orientations and their distance, computed without the package."""

import numpy as np
from scipy.linalg import expm

COORDINATE_AXES = [sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)]


def cross_product_matrix(vector):
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=float)


def unit_vectors_after_turn(axis, angle, unit_vectors=np.eye(3)):
    """Rotate vectors, given as rows, about an axis by the right-hand rule.

    This follows the motion itself, in many small steps that each add the cross product of the axis
    and the vector.
    """
    axis = np.asarray(axis, dtype=float)
    return unit_vectors @ expm(angle * cross_product_matrix(axis / np.linalg.norm(axis))).T


def random_unit_vectors(count, seed, size=3):
    vectors = np.random.default_rng(seed).normal(size=(count, size))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def random_dcms(count, seed):
    """Return uniformly distributed direction cosine matrices, from random triads."""
    first, helper = random_unit_vectors(count, seed), random_unit_vectors(count, seed + 1)
    third = np.cross(first, helper)
    third /= np.linalg.norm(third, axis=1, keepdims=True)
    return np.stack([first, np.cross(third, first), third], axis=1)


def rotation_error(dcm, expected):
    """Return the largest angle, in radians, between orientations that are almost the same."""
    difference = np.asarray(dcm, dtype=float) - np.asarray(expected, dtype=float)
    return float(np.linalg.norm(difference, axis=(-2, -1)).max() / np.sqrt(2))


def angles_near(middle, count, seed, offset=0.0):
    """Return triples of angles whose second one is ``offset`` above or below ``middle``."""
    source = np.random.default_rng(seed)
    angles = source.uniform(-np.pi, np.pi, (count, 3))
    angles[:, 1] = middle + offset * source.choice((-1, 1), count)
    return angles


def lock_angles(sequence):
    """Return the middle angles at which the first and the last axis of a sequence are parallel."""
    return (0.0, np.pi) if sequence[0] == sequence[2] else (np.pi / 2, -np.pi / 2)


def composed(angles, sequence):
    """Return a body fixed direction cosine matrix as a product of matrices written out by hand."""
    if any(hasattr(angle, "free_symbols") for angle in angles):
        import sympy as library

        matrix = library.Matrix
    else:
        library, matrix = np, np.array
    result = matrix(np.eye(3, dtype=int).tolist())
    for axis, angle in zip(sequence, angles):
        c, s = library.cos(angle), library.sin(angle)
        simple = {
            "x": [[1, 0, 0], [0, c, s], [0, -s, c]],
            "y": [[c, 0, -s], [0, 1, 0], [s, 0, c]],
            "z": [[c, s, 0], [-s, c, 0], [0, 0, 1]],
        }[axis]
        result = matrix(simple) @ result
    return result
