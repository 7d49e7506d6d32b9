"""A filter that follows an orientation: gyroscope in, directions in,
orientation and its uncertainty out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from .direction_cosines import check_dcm
from .numbers_and_symbols import number_array
from .observations import unit_directions
from .rotation_vector import dcm_from_rotation_vector

if TYPE_CHECKING:
    import numpy

    from ._types import Array, Numbers, Values


class Innovation(NamedTuple):
    r"""By how much a measured direction differs from what a filter
    expected, and by how much it might.

    Attributes
    ----------
    difference : array of shape ``(..., 3)``
        Measured less expected, :math:`\tilde{y} - \hat{y}`, along the body.
    covariance : array of shape ``(..., 3, 3)``
        Of the difference, as the filter claims it before it corrects itself,
        :math:`\mathbf{S} = \mathbf{H}\mathbf{P}\mathbf{H}^T + \sigma^2\mathbf{I}`.
    """

    difference: Array
    covariance: Array

    @property
    def normalised_square(self) -> numpy.float64 | Array:
        r"""The square :math:`(\tilde{y} -
        \hat{y})^T\mathbf{S}^{-1}(\tilde{y} - \hat{y})`, shape ``(...)``.

        A direction differs from another in two ways, so of a true claim this is 2
        on average. No truth is needed.
        """
        import numpy

        solved = numpy.linalg.solve(self.covariance, self.difference[..., None])[..., 0]
        square: numpy.float64 | Array = (self.difference * solved).sum(axis=-1)
        return square


class MultiplicativeKalmanFilter:
    r"""Multiplicative extended Kalman filter of an orientation and of the gyroscope's bias.

    The orientation itself is a direction cosine matrix and is turned, never added to. What has a
    covariance is the small rotation vector :math:`\boldsymbol\delta` from the estimated body to the
    true one, along the body,

    .. math::

       {}^B\mathbf{C}^N = \exp\left(-[\boldsymbol\delta]_\times\right)\,{}^{\hat B}\mathbf{C}^N ,

    followed by the error of the bias :math:`\mathbf{b}`. Everything works for
    one orientation and for a batch.

    Parameters
    ----------
    dcm : array of shape ``(..., 3, 3)``
        The first estimate of :math:`{}^B\mathbf{C}^N`.
    covariance : array of shape ``(6, 6)`` or ``(..., 6, 6)``
        Of :math:`\boldsymbol\delta` (square radians) and the bias (squares of radians per second).
    gyroscope_noise : float or array of shape ``(...)``
        Angle random walk, radians per square root of a second.
    bias_noise : float or array of shape ``(...)``
        Random walk of the bias, radians per second per square root of a second.

    Attributes
    ----------
    dcm : array of shape ``(..., 3, 3)``
    bias : array of shape ``(..., 3)``
        Radians per second.
    covariance : array of shape ``(..., 6, 6)``
    gyroscope_noise, bias_noise : arrays of shape ``(...)``
        As they were given.

    Examples
    --------
    >>> import numpy as np
    >>> from orientation import MultiplicativeKalmanFilter
    >>> estimate = MultiplicativeKalmanFilter(np.eye(3), 0.01 * np.eye(6), 0.001, 0.0001)
    >>> estimate.turn((0, 0, 1.0), 0.01)
    >>> estimate.observe((0, 0, 1.0), (0, 0, 1.0), 0.01).difference.tolist()
    [0.0, 0.0, 0.0]
    >>> tilt, heading = estimate.covariance[0, 0], estimate.covariance[2, 2]
    >>> bool(tilt < 0.0002 < heading)  # up says nothing of the heading
    True

    Notes
    -----
    Source: Lefferts, Markley and Shuster (1982); Markley (2003).
    In the book: :eq:`equation-filter-turn` and :eq:`equation-filter-observe`.
    """

    def __init__(
        self, dcm: Values, covariance: Values, gyroscope_noise: Numbers, bias_noise: Numbers
    ) -> None:
        import numpy

        self.dcm = number_array(dcm, (3, 3), "dcm")
        check_dcm(self.dcm)
        batch = self.dcm.shape[:-2]
        self.bias = numpy.zeros((*batch, 3))
        covariance = number_array(covariance, (6, 6), "covariance")
        self.covariance = numpy.broadcast_to(covariance, (*batch, 6, 6)).copy()
        self.gyroscope_noise = number_array(gyroscope_noise, (), "gyroscope_noise")
        self.bias_noise = number_array(bias_noise, (), "bias_noise")

    def turn(self, angular_velocity: Values, step: Values) -> None:
        r"""Turn with the gyroscope for one step.

        Parameters
        ----------
        angular_velocity : array of shape ``(..., 3)``
            What the gyroscope says, bias and noise included, along the body; radians per second.
        step : float or array of shape ``(...)``
            Seconds.
        """
        import numpy

        rate = number_array(angular_velocity, (3,), "angular_velocity") - self.bias
        step = number_array(step, (), "step")[..., None]
        turned = dcm_from_rotation_vector(rate * step)
        self.dcm = turned @ self.dcm
        carried = numpy.zeros_like(self.covariance) + numpy.eye(6)
        carried[..., :3, :3] = turned
        carried[..., :3, 3:] = -step[..., None] * numpy.eye(3)
        noises = numpy.stack(numpy.broadcast_arrays(self.gyroscope_noise, self.bias_noise), axis=-1)
        noise = numpy.repeat(noises**2 * step, 3, axis=-1)[..., None] * numpy.eye(6)
        self.covariance = carried @ self.covariance @ carried.swapaxes(-1, -2) + noise

    def observe(self, observed: Values, reference: Values, deviation: Values) -> Innovation:
        r"""Correct the estimate with one direction that was measured.

        Parameters
        ----------
        observed : array of shape ``(..., 3)``
            The direction along the body, of any length.
        reference : array of shape ``(..., 3)``
            The same direction along :math:`N`, of any length.
        deviation : float or array of shape ``(...)``
            Standard deviation across the direction, radians.

        Returns
        -------
        Innovation
            By how much the direction differed from what was expected, before the correction.
        """
        import numpy

        seen, known = (
            unit_directions(number_array(direction, (3,), name), name)
            for direction, name in ((observed, "observed"), (reference, "reference"))
        )
        expected = (self.dcm @ known[..., None])[..., 0]
        # A body turned by delta sees expected + expected x delta.
        slope = numpy.zeros((*expected.shape, 6))
        across = numpy.cross(expected[..., None, :], numpy.eye(3))
        slope[..., :3] = across.swapaxes(-1, -2)
        spread = self.covariance @ slope.swapaxes(-1, -2)
        variance = number_array(deviation, (), "deviation")[..., None, None] ** 2
        innovation = Innovation(seen - expected, slope @ spread + variance * numpy.eye(3))
        gain = spread @ numpy.linalg.inv(innovation.covariance)
        change = (gain @ innovation.difference[..., None])[..., 0]
        self.dcm = dcm_from_rotation_vector(change[..., :3]) @ self.dcm
        self.bias = self.bias + change[..., 3:]
        # Joseph's form keeps the covariance symmetric and positive in spite of rounding.
        kept = numpy.eye(6) - gain @ slope
        kept_covariance = kept @ self.covariance @ kept.swapaxes(-1, -2)
        self.covariance = kept_covariance + variance * gain @ gain.swapaxes(-1, -2)
        return innovation
