"""A kit for tests: find out a function's convention by calling it, and assert it in one line."""

from typing import NamedTuple

import numpy as np

from orientation import (
    axis_angle_from_dcm,
    dcm_from_body_fixed,
    quaternion_from_dcm,
    rotation_vector_from_dcm,
)

from .mismatch import table
from .mismatch.explanation import explain

#: Three generic orientations, none with an angle that is small or near half a turn.
_TURNS = ((0.4, 0.7, -0.3), (-1.1, 0.5, 0.9), (0.8, -0.6, 1.3))

#: The inputs a function may take, and the arguments in this book's convention to call it with.
TAKES = {
    "axis and angle": axis_angle_from_dcm,
    "rotation vector": lambda dcm: (rotation_vector_from_dcm(dcm),),
    "Euler angles": None,
    "quaternion": lambda dcm: (quaternion_from_dcm(dcm),),
    "matrix": lambda dcm: (dcm,),
}


class Convention(NamedTuple):
    """What `convention_of` found.

    ``takes`` and ``gives`` say how to read the arguments and the result, with the choice in each
    group of `orientation_workbench.mismatch.table.KINDS`. ``inverse`` says whether the result is
    the transpose of this book's matrix, the conjugate of its quaternion, or the rotation in the
    opposite sense. ``body`` and ``world`` are the axes that the result calls x, y and z. ``words``
    are all departures from this book, each as a phrase.
    """

    takes: dict
    gives: dict
    inverse: bool
    body: tuple
    world: tuple
    words: tuple

    def __str__(self) -> str:
        return "; ".join(self.words) or "as in this book"


def convention_of(
    function, takes: str, *, gives: str | None = None, sequence: str | None = None
) -> Convention:
    """Find out by a few experiments which convention a function of orientations has.

    The function is called with three orientations, written as in this book, and its answers are
    read in every possible way.

    Parameters
    ----------
    function : callable
        Takes an axis of shape ``(3,)`` and an angle, or one array: a rotation vector or angles of
        shape ``(3,)``, a quaternion ``(4,)`` or a matrix ``(3, 3)``. Returns a matrix of shape
        ``(3, 3)`` or ``(4, 4)``, a quaternion, or three numbers.
    takes : str
        ``'axis and angle'``, ``'rotation vector'``, ``'Euler angles'``, ``'quaternion'`` or
        ``'matrix'``.
    gives : str, optional
        The same for the result; required if it is three numbers, or an axis and its angle.
    sequence : str, optional
        The sequence of the angles; by default all twelve are tried.

    Returns
    -------
    Convention

    Raises
    ------
    ValueError
        If the answers are not orientations, or no known convention explains them.

    Examples
    --------
    >>> from scipy.spatial.transform import Rotation
    >>> from orientation_workbench import convention_of
    >>> by_angles = lambda angles: Rotation.from_euler('zxy', angles).as_matrix()
    >>> found = convention_of(by_angles, 'Euler angles', sequence='zxy')
    >>> found.takes['axes of the turns'], found.takes['unit'], found.inverse
    ('space fixed', 'radians', True)
    """
    if takes not in TAKES:
        raise ValueError(f"a function can take {', '.join(TAKES)}, not {takes!r}")
    asked, answered = [], []
    for angles in _TURNS:
        # The same three numbers serve as angles, or as the orientation they describe.
        arguments = (
            (np.array(angles),)
            if takes == "Euler angles"
            else TAKES[takes](dcm_from_body_fixed(angles, "zxy"))
        )
        asked.append(np.concatenate([np.ravel(argument) for argument in arguments]))
        answered.append(np.asarray(function(*arguments), float))
    known = [
        ({"kind": kind} if kind else {})
        | ({"sequence": sequence} if sequence and kind == "Euler angles" else {})
        for kind in (takes, gives)
    ]
    result = np.array(answered)
    if result.shape[1:] in ((3, 4), (4, 4)):
        result = result[:, :3, :3]
    result = result.reshape(len(_TURNS), -1)
    explanation = explain(
        np.array(asked), result, first_declared=known[0], second_declared=known[1]
    )
    if not explanation.chains:
        raise ValueError(
            "no convention known to this kit explains the answer: for "
            f"{np.round(asked[0], 4).tolist()} the function returned "
            f"{np.round(result[0], 4).tolist()}"
        )
    best = explanation.chains[0]
    relation = best.relation
    return Convention(
        best.first["choices"], best.second["choices"], relation["inverse"], relation["body"],
        relation["world"], explanation.faults,
    )  # fmt: skip


#: Keywords for an expectation, and the group of a reading that each belongs to.
EXPECTED = {
    "order": "order",
    "turns": "axes of the turns",
    "places": "places",
    "signs": "signs",
    "unit": "unit",
    "place": "place of the angle",
}


def assert_convention(
    function,
    takes: str,
    *,
    gives: str | None = None,
    sequence: str | None = None,
    inverse: bool = False,
    body: str = "x y z",
    world: str = "x y z",
    **expected: str,
) -> None:
    """Assert in one line of a test that a function has a convention, by default this book's.

    Parameters
    ----------
    function, takes, gives, sequence
        As for `convention_of`.
    inverse : bool
        Whether the function returns the transpose or conjugate of what this book does, as SciPy
        does for matrices.
    body, world : str
        The function's x, y and z axes, such as ``'x -y -z'``.
    order, turns, places, signs, unit, place : str
        For a quaternion ``'wxyz'`` or ``'xyzw'``. For angles ``'body fixed'`` or ``'space fixed'``,
        their order and signs, and ``'radians'`` or ``'degrees'``. For an axis and an angle, whether
        the angle comes ``'first'`` or ``'last'``.

    Raises
    ------
    AssertionError
        If the convention differs; the message says how.
    ValueError
        As for `convention_of`, and for an unknown keyword.

    Examples
    --------
    >>> from scipy.spatial.transform import Rotation
    >>> from orientation_workbench import assert_convention
    >>> of_scipy = lambda q: Rotation.from_quat(q).as_matrix()
    >>> assert_convention(of_scipy, 'quaternion', order='xyzw', inverse=True)
    """
    if unknown := set(expected) - set(EXPECTED):
        raise ValueError(
            f"{', '.join(sorted(unknown))} is not known; choose from {', '.join(EXPECTED)}"
        )
    convention = convention_of(function, takes, gives=gives, sequence=sequence)
    wrong = []
    for word, group in EXPECTED.items():
        wanted = expected.get(word, table.BOOK[group])
        wrong += [
            f"{group}: {side[group]}, not {wanted}" for side in (convention.takes, convention.gives)
            if group in side and side[group] != wanted
        ]  # fmt: skip
    if sequence:
        wrong += [
            f"sequence: {side['sequence']}, not {sequence}"
            for side in (convention.takes, convention.gives)
            if side.get("sequence", sequence) != sequence
        ]  # fmt: skip
    if convention.inverse != inverse:
        wrong.append(
            "the inverse, transposed or conjugate"
            if convention.inverse
            else "the inverse was expected, but this is not the inverse"
        )
    for name, axes, wanted in (("body", convention.body, body), ("world", convention.world, world)):
        if " ".join(axes) != wanted:
            wrong.append(f"the {name}'s axes: {' '.join(axes)}, not {wanted}")
    assert not wrong, f"a different convention from the one expected: {'; '.join(wrong)}"
