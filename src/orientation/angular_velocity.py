"""Orientation in motion: how the angular velocity changes each description.

The angular velocity :math:`\\boldsymbol{\\omega}` of :math:`A` in :math:`N` is given by its components
along :math:`A`, as a gyroscope that is carried by :math:`A` measures them, in radians per second.
"""

from ._numbers_and_symbols import evaluate
from ._types import Result, Values
from .direction_cosines import AXES
from .euler_angles import layout_of


def angular_velocity_matrix(angles: Values, sequence: str) -> Result:
    r"""Matrix that turns the rates of body fixed Euler angles into the angular velocity.

    .. math::

       \boldsymbol{\omega}_D = \mathbf{M}\begin{bmatrix} \dot\psi & \dot\theta & \dot\varphi \end{bmatrix}^T

    Its columns are the unit vectors that the three turns are about, along the frame :math:`D` that the
    last turn leads to. At gimbal lock the first and the last column are parallel, the determinant is
    zero, and angular velocities in one direction cannot be had from any rates.

    Parameters
    ----------
    angles : SymPy expressions or floats ``(psi, theta, phi)``, or array of shape ``(..., 3)``
        Radians.
    sequence : str
        One of :data:`orientation.SEQUENCES`.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Raises
    ------
    ValueError
        If the sequence is not one of the twelve, a shape is wrong or an angle is not finite.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import angular_velocity_matrix
    >>> angular_velocity_matrix(sm.symbols('psi, theta, varphi'), 'zxy')
    Matrix([
    [-sin(varphi)*cos(theta), cos(varphi), 0],
    [             sin(theta),           0, 1],
    [ cos(theta)*cos(varphi), sin(varphi), 0]])

    Notes
    -----
    Source: Kane, Likins and Levinson (1983).
    """
    i, j, k, sign = layout_of(sequence)
    last = AXES.index(sequence[2])

    def formula(f, psi, theta, phi):
        s2, c2, s3, c3 = sign * f.sin(theta), f.cos(theta), sign * f.sin(phi), f.cos(phi)
        entries = [0] * 9
        entries[3 * last + 2] = 1
        if last == i:
            entries[3 * i], entries[3 * j], entries[3 * k] = c2, s2 * s3, s2 * c3
            entries[3 * j + 1], entries[3 * k + 1] = c3, -s3
        else:
            entries[3 * i], entries[3 * j], entries[3 * k] = c2 * c3, -c2 * s3, s2
            entries[3 * i + 1], entries[3 * j + 1] = s3, c3
        return entries

    return evaluate(formula, (3, 3), ("angles", angles, (3,)))


def dcm_rate(dcm: Values, angular_velocity: Values) -> Result:
    r"""Time derivative of a direction cosine matrix.

    .. math::

       \frac{d}{dt}{}^A\mathbf{C}^N = -[\boldsymbol{\omega}]_\times\,{}^A\mathbf{C}^N

    Parameters
    ----------
    dcm : SymPy matrix, or array of shape ``(3, 3)`` or ``(..., 3, 3)``
        :math:`{}^A\mathbf{C}^N`. It is not checked: an integration may have let it drift.
    angular_velocity : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Components along :math:`A`, radians per second.

    Returns
    -------
    SymPy matrix, array of shape ``(3, 3)`` or stack of shape ``(..., 3, 3)``

    Examples
    --------
    >>> from orientation import dcm_rate
    >>> dcm_rate([[1, 0, 0], [0, 1, 0], [0, 0, 1]], (0, 0, 2.0)).tolist()
    [[0.0, 2.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.0, 0.0]]

    Notes
    -----
    Source: Hughes (1986).
    """

    def formula(f, xx, xy, xz, yx, yy, yz, zx, zy, zz, x, y, z):
        return (
            z * yx - y * zx,
            z * yy - y * zy,
            z * yz - y * zz,
            x * zx - z * xx,
            x * zy - z * xy,
            x * zz - z * xz,
            y * xx - x * yx,
            y * xy - x * yy,
            y * xz - x * yz,
        )

    return evaluate(formula, (3, 3), ("dcm", dcm, (3, 3)), ("angular_velocity", angular_velocity, (3,)))


def quaternion_rate(quaternion: Values, angular_velocity: Values) -> Result:
    r"""Time derivative of a quaternion.

    .. math::

       \dot{q} = \tfrac{1}{2}\,q\,\left(\omega_x i + \omega_y j + \omega_z k\right)

    Parameters
    ----------
    quaternion : SymPy expressions, floats or array of shape ``(4,)`` or ``(..., 4)``
        Scalar first. It is not checked: an integration may have let its length drift.
    angular_velocity : SymPy expressions, floats or array of shape ``(3,)`` or ``(..., 3)``
        Components along :math:`A`, radians per second.

    Returns
    -------
    SymPy column of four, array of shape ``(4,)`` or ``(..., 4)``

    Examples
    --------
    >>> from orientation import quaternion_rate
    >>> quaternion_rate((1, 0, 0, 0), (0, 0, 2.0)).tolist()
    [0.0, 0.0, 0.0, 1.0]

    Notes
    -----
    Source: Shuster (1993).
    """

    def formula(f, a, b, c, d, x, y, z):
        return (
            (-b * x - c * y - d * z) / 2,
            (a * x + c * z - d * y) / 2,
            (a * y + d * x - b * z) / 2,
            (a * z + b * y - c * x) / 2,
        )

    return evaluate(formula, (4,), ("quaternion", quaternion, (4,)), ("angular_velocity", angular_velocity, (3,)))
