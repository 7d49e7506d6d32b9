"""A kit for tests: which convention a function has, found by what it
answers, and asserted in one line.
"""

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

#: Three orientations that nothing special can be said of; no angle of
#: theirs is small or near half a turn.
_TURNS = ((0.4, 0.7, -0.3), (-1.1, 0.5, 0.9), (0.8, -0.6, 1.3))

#: What a function may take, and the arguments of this book's convention that it is called with.
TAKES = {
    "axis and angle": axis_angle_from_dcm,
    "rotation vector": lambda dcm: (rotation_vector_from_dcm(dcm),),
    "Euler angles": None,
    "quaternion": lambda dcm: (quaternion_from_dcm(dcm),),
    "matrix": lambda dcm: (dcm,),
}


class Convention(NamedTuple):
    """What `convention_of` found.

    ``takes`` and ``gives`` say how the arguments and the result are to be read: for each group of
    `orientation_workbench.mismatch.table.KINDS` the choice. ``inverse`` is whether the result is
    the transpose of this book's matrix, the conjugate of its quaternion, or the turn in the other
    sense. ``body`` and ``world`` are the axes that the result calls x, y and z. ``words`` are all
    departures from this book, each as a phrase.
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

    The function is called with three orientations as this book writes them, and what
    it answers is read in every way.

    Parameters
    ----------
    function : callable
        Is given an axis of shape ``(3,)`` and an angle, or one array: a rotation vector or angles
        of shape ``(3,)``, a quaternion ``(4,)``, a matrix ``(3, 3)``. Returns a matrix of shape
        ``(3, 3)`` or ``(4, 4)``, a quaternion, or three numbers.
    takes : str
        ``'axis and angle'``, ``'rotation vector'``, ``'Euler angles'``, ``'quaternion'`` or
        ``'matrix'``.
    gives : str, optional
        The same of the result: needed where that is three numbers, or an axis and its angle.
    sequence : str, optional
        The sequence of the angles; without it all twelve are tried.

    Returns
    -------
    Convention

    Raises
    ------
    ValueError
        If the answers are no orientations, or follow from the arguments by no convention that is
        known.

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
        # The same three numbers as angles, or the orientation that they make as something else.
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
    found = explain(np.array(asked), result, first_declared=known[0], second_declared=known[1])
    if not found.chains:
        raise ValueError(
            "no convention known to this kit explains the answer: for "
            f"{np.round(asked[0], 4).tolist()} the function returned "
            f"{np.round(result[0], 4).tolist()}"
        )
    best = found.chains[0]
    relation = best.relation
    return Convention(
        best.first["choices"], best.second["choices"], relation["inverse"], relation["body"],
        relation["world"], found.faults,
    )  # fmt: skip


#: Words of an expectation, and the group of a reading that each is of.
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
    """Assert in one line of a test that a function has a convention;
    what is not said is as in this book.

    Parameters
    ----------
    function, takes, gives, sequence
        As for `convention_of`.
    inverse : bool
        Whether it gives the transpose, or the conjugate, of what this book does, as SciPy's
        matrices are.
    body, world : str
        What it calls x, y and z, as ``'x -y -z'``.
    order, turns, places, signs, unit, place : str
        Of a quaternion ``'wxyz'`` or ``'xyzw'``; of angles ``'body fixed'`` or ``'space fixed'``,
        how they are printed and signed, and ``'radians'`` or ``'degrees'``; whether the angle of an
        axis stands ``'first'`` or ``'last'``.

    Raises
    ------
    AssertionError
        With what the function does otherwise.
    ValueError
        As for `convention_of`, and for a word that is not known.

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
    found = convention_of(function, takes, gives=gives, sequence=sequence)
    wrong = []
    for word, group in EXPECTED.items():
        wanted = expected.get(word, table.BOOK[group])
        wrong += [
            f"{group}: {side[group]}, not {wanted}" for side in (found.takes, found.gives)
            if group in side and side[group] != wanted
        ]  # fmt: skip
    if sequence:
        wrong += [
            f"sequence: {side['sequence']}, not {sequence}"
            for side in (found.takes, found.gives) if side.get("sequence", sequence) != sequence
        ]  # fmt: skip
    if found.inverse != inverse:
        wrong.append(
            "the inverse, transposed or conjugate"
            if found.inverse
            else "the inverse was expected, but this is not the inverse"
        )
    for name, axes, wanted in (("body", found.body, body), ("world", found.world, world)):
        if " ".join(axes) != wanted:
            wrong.append(f"the {name}'s axes: {' '.join(axes)}, not {wanted}")
    assert not wrong, f"a different convention from the one expected: {'; '.join(wrong)}"
