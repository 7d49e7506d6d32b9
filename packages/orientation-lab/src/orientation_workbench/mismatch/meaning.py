"""Convert numbers to direction cosine matrices by a reading, and back."""

import math

import numpy as np

from orientation import (
    axis_angle_from_dcm,
    body_fixed_from_dcm,
    dcm_from_axis_angle,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    dcm_from_rotation_vector,
    quaternion_from_dcm,
    rotation_vector_from_dcm,
)


def _angles_and_sequence(choices, numbers):
    """Return the three rotations in order, in radians and body fixed, and their sequence."""
    places, signs = choices["places"], choices["signs"]
    turns = np.stack([numbers[..., places.index(which)] for which in "123"], axis=-1)
    turns = turns * [-1.0 if sign == "-" else 1.0 for sign in signs]
    sequence = choices["sequence"]
    if choices["axes of the turns"] == "space fixed":
        turns, sequence = turns[..., ::-1], sequence[::-1]
    return turns * _radians(choices), sequence


def _radians(choices):
    return math.pi / 180 if choices.get("unit") == "degrees" else 1.0


def dcms_from_numbers(reading, numbers):
    r"""Return the matrices ${}^A\mathbf{C}^N$ that numbers mean by one reading.

    Parameters
    ----------
    reading : dict
        An entry of the list that `orientation_workbench.mismatch.table.readings` returns.
    numbers : array of shape ``(poses, count)``
        Quaternions and axes need not be of unit length.

    Returns
    -------
    array of shape ``(poses, 3, 3)``
        A given matrix is returned unchanged, even if it is left-handed.
    """
    kind, choices = reading["kind"], reading["choices"]
    if kind == "matrix":
        return numbers.reshape(-1, 3, 3)
    if kind == "quaternion":
        parts = numbers[:, [choices["order"].index(part) for part in "wxyz"]]
        return dcm_from_quaternion(parts / np.linalg.norm(parts, axis=1, keepdims=True))
    if kind == "Euler angles":
        return dcm_from_body_fixed(*_angles_and_sequence(choices, numbers))
    if kind == "rotation vector":
        return dcm_from_rotation_vector(numbers * _radians(choices))
    last = choices["place of the angle"] == "last"
    axes, angles = (numbers[:, :3], numbers[:, 3]) if last else (numbers[:, 1:], numbers[:, 0])
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    return dcm_from_axis_angle(axes, angles * _radians(choices))


def numbers_from_dcms(reading, dcms):
    """Return the numbers of orientations by a reading; Euler angles have two triples.

    Parameters
    ----------
    dcms : array of shape ``(poses, 3, 3)``

    Returns
    -------
    list of arrays of shape ``(poses, count)``
    """
    kind, choices = reading["kind"], reading["choices"]
    if kind == "matrix":
        return [dcms.reshape(-1, 9)]
    if kind == "quaternion":
        return [quaternion_from_dcm(dcms)[:, ["wxyz".index(part) for part in choices["order"]]]]
    if kind == "rotation vector":
        return [rotation_vector_from_dcm(dcms) / _radians(choices)]
    if kind == "axis and angle":
        axes, angles = axis_angle_from_dcm(dcms)
        both = [axes, angles[:, None] / _radians(choices)]
        return [
            np.concatenate(both if choices["place of the angle"] == "last" else both[::-1], axis=1)
        ]
    sequence = choices["sequence"]
    from_behind = -1 if choices["axes of the turns"] == "space fixed" else 1
    turns = body_fixed_from_dcm(dcms, sequence[::from_behind])
    middle = math.pi - turns[:, 1] if sequence[0] != sequence[2] else -turns[:, 1]
    signs = [-1.0 if sign == "-" else 1.0 for sign in choices["signs"]]
    places = [int(which) - 1 for which in choices["places"]]
    written = []
    for triple in (turns, np.stack([turns[:, 0] + math.pi, middle, turns[:, 2] + math.pi], axis=1)):
        triple = (triple[:, ::from_behind] * signs + math.pi) % math.tau - math.pi
        written.append(triple[:, places] / _radians(choices))
    return written


def doubt(reading, half):
    """Bound the error of a matrix entry if each number is off by at most ``half``."""
    unit = _radians(reading["choices"])
    times = {"matrix": 1, "quaternion": 4, "axis and angle": 4 + unit}
    return times.get(reading["kind"], 3 * unit) * half
