r"""The one place where this book's matrices meet SciPy's rotations.

SciPy's ``Rotation`` of a frame $A$ in $N$ converts components along $A$ to components along $N$, so
its matrix is ${}^N\mathbf{C}^A$. The transpose happens here and nowhere else.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .direction_cosines import DCM_GUARD
from .numbers_and_symbols import evaluate_numbers

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

    from ._types import Array, Component, Functions, Values


def scipy_rotation_from_dcm(dcm: Values) -> Rotation:
    r"""SciPy ``Rotation`` of a direction cosine matrix.

    Parameters
    ----------
    dcm : array of shape ``(3, 3)`` or ``(..., 3, 3)``
        ${}^A\mathbf{C}^N$. Numbers only.

    Returns
    -------
    scipy.spatial.transform.Rotation
        Its ``as_matrix()`` is ${}^N\mathbf{C}^A$, the transpose.

    Raises
    ------
    ValueError
        If the matrix is not a direction cosine matrix.

    Examples
    --------
    >>> from orientation import dcm_from_body_fixed, scipy_rotation_from_dcm
    >>> rotation = scipy_rotation_from_dcm(dcm_from_body_fixed((0.1, 0.2, 0.3), 'zxy'))
    >>> rotation.as_euler('ZXY').round(12).tolist()  # capitals are SciPy's way to say body fixed
    [0.1, 0.2, 0.3]
    """
    from scipy.spatial.transform import Rotation

    def transposed(f: Functions[Component], *entries: Component) -> Sequence[Component]:
        return [entries[3 * column + row] for row in range(3) for column in range(3)]

    return Rotation.from_matrix(
        evaluate_numbers(transposed, (3, 3), ("dcm", dcm, (3, 3)), guard=DCM_GUARD)
    )


def dcm_from_scipy_rotation(rotation: Rotation) -> Array:
    r"""Direction cosine matrix ${}^A\mathbf{C}^N$ of a SciPy ``Rotation``.

    Parameters
    ----------
    rotation : scipy.spatial.transform.Rotation
        One rotation or a stack of them.

    Returns
    -------
    array of shape ``(3, 3)`` or ``(..., 3, 3)``

    Raises
    ------
    TypeError
        If it is something else, such as a matrix.

    Examples
    --------
    >>> from scipy.spatial.transform import Rotation
    >>> from orientation import dcm_from_body_fixed, dcm_from_scipy_rotation, same_orientation
    >>> rotation = Rotation.from_euler('ZXY', (0.1, 0.2, 0.3))
    >>> dcm = dcm_from_scipy_rotation(rotation)
    >>> same_orientation(dcm, dcm_from_body_fixed((0.1, 0.2, 0.3), 'zxy'))
    True
    """
    if not hasattr(rotation, "as_matrix"):
        raise TypeError(f"rotation must be a SciPy Rotation, not {type(rotation).__name__}")
    matrices: Array = rotation.as_matrix()
    return matrices.swapaxes(-1, -2)
