"""Integrate an angular velocity to orientations, by exponential steps.

Every step is a rotation, so the result is a direction cosine matrix for steps of any length. Only
its accuracy depends on them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from .direction_cosines import demand_dcm
from .numbers_and_symbols import number_array
from .rotation_vector import dcm_from_rotation_vector

if TYPE_CHECKING:
    from ._types import Array, Numbers

ORDERS = (1, 2, 4)


def turns_from_angular_velocity(
    angular_velocity: Callable[[Array], Numbers], times: Numbers, order: int = 4
) -> Array:
    r"""Return the rotation vector of each interval of time.

    For a step of duration $h$ from $t$, order 1 takes the angular velocity at its beginning,
    $h\,\boldsymbol{\omega}(t)$, and order 2 the one in its middle, $h\,\boldsymbol{\omega}(t +
    \frac{h}{2})$. Order 4 takes it at the two Gauss points $t + (\frac{1}{2} \mp
    \frac{\sqrt{3}}{6})h$, and adds the effect of the order of the rotations in between (Magnus):

    $$
    \mathbf{r} = \frac{h}{2}\left(\boldsymbol{\omega}_1 + \boldsymbol{\omega}_2\right)
    + \frac{\sqrt{3}\,h^2}{12}\,\boldsymbol{\omega}_1\times\boldsymbol{\omega}_2
    $$

    Parameters
    ----------
    angular_velocity : callable
        ``angular_velocity(times)`` takes an array of shape ``(n,)`` and returns the components
        along the rotating frame $A$, shape ``(n, 3)``, radians per second. It is called once for
        each point of a step.
    times : array of shape ``(n + 1,)``
        Seconds.
    order : {1, 2, 4}
        The power of the step with which the error of the orientations decreases.

    Returns
    -------
    array of shape ``(n, 3)``
        Rotation vectors, radians.

    Raises
    ------
    TypeError
        If ``angular_velocity`` is not a function.
    ValueError
        If the order is not one of these, or the function returns another shape or numbers that are
        not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from orientation import turns_from_angular_velocity
    >>> faster = lambda t: np.outer(t, [0, 0, 2.0])
    >>> turns_from_angular_velocity(faster, [0, 1, 2]).round(12).tolist()
    [[0.0, 0.0, 1.0], [0.0, 0.0, 3.0]]

    Notes
    -----
    Source: Iserles and Norsett (1999), Blanes et al. (2009).
    """
    import numpy

    if not callable(angular_velocity):
        raise TypeError(
            "angular_velocity must be a function of the times. For the samples of a gyroscope, "
            "give dcms_after_turns each sample times the time to the next"
        )
    if order not in ORDERS:
        raise ValueError(f"order must be 1, 2 or 4, not {order!r}")
    times = number_array(times, (), "times")
    if times.ndim != 1 or len(times) < 2:
        raise ValueError(
            "times must have shape (n + 1,), the boundaries of one or more intervals, not "
            f"{times.shape}"
        )
    starts, steps = times[:-1], numpy.diff(times)[:, None]

    def at(share: float) -> Array:
        rates = number_array(
            angular_velocity(starts + share * steps[:, 0]), (3,), "angular_velocity(times)"
        )
        if rates.shape not in ((3,), (len(starts), 3)):
            raise ValueError(
                f"angular_velocity(times) must have shape ({len(starts)}, 3) for {len(starts)} "
                f"times, not {rates.shape}"
            )
        return numpy.broadcast_to(rates, (len(starts), 3))

    if order < 4:
        return steps * at((order - 1) / 2)
    first, second = at(0.5 - 3**0.5 / 6), at(0.5 + 3**0.5 / 6)
    return steps / 2 * (first + second) + 3**0.5 / 12 * steps**2 * numpy.cross(first, second)


def dcms_after_turns(start: Numbers, turns: Numbers) -> Array:
    r"""Return an orientation, and those reached from it by successive rotations.

    $$
    \mathbf{C}_{k+1} = \exp\left(-[\mathbf{r}_k]_\times\right)\mathbf{C}_k
    $$

    Parameters
    ----------
    start : array of shape ``(3, 3)``
        ${}^A\mathbf{C}^N$ before the first rotation.
    turns : array of shape ``(n, 3)``
        Rotation vectors along the rotating frame $A$, radians, such as those of
        `turns_from_angular_velocity` or the increments of a gyroscope.

    Returns
    -------
    array of shape ``(n + 1, 3, 3)``

    Raises
    ------
    ValueError
        If ``start`` is not a direction cosine matrix or a shape is wrong.

    Examples
    --------
    >>> import numpy as np
    >>> from orientation import dcms_after_turns
    >>> dcms = dcms_after_turns(np.eye(3), [[0, 0, np.pi/2], [np.pi/2, 0, 0]])
    >>> (dcms[-1].round(12) + 0.0).tolist()
    [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    """
    import numpy

    start, turns = number_array(start, (3, 3), "start"), number_array(turns, (3,), "turns")
    for name, array, expected in (("start", start, "(3, 3)"), ("turns", turns, "(n, 3)")):
        if array.ndim != 2:
            raise ValueError(f"{name} must have shape {expected}, not {array.shape}")
    demand_dcm(start.ravel().tolist(), name="start")
    dcms = numpy.empty((len(turns) + 1, 3, 3))
    dcms[0] = start
    for k, turn in enumerate(dcm_from_rotation_vector(turns)):
        dcms[k + 1] = turn @ dcms[k]
    return dcms
