"""A filter that estimates an orientation and its uncertainty from a gyroscope and directions.

A smoother then improves the earlier estimates with the later measurements.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from .direction_cosines import dcm_array
from .numbers_and_symbols import covariance_array, number_array
from .observations import unit_directions
from .rotation_vector import dcm_from_rotation_vector, rotation_vector_from_dcm

if TYPE_CHECKING:
    import numpy

    from ._types import Array, Numbers, Values


class Innovation(NamedTuple):
    r"""How far a measurement is from what a filter expected, and how far it may be.

    Attributes
    ----------
    difference : array of shape ``(..., 3)``
        Measured minus expected, $\boldsymbol\nu$, along the body.
    covariance : array of shape ``(..., 3, 3)``
        Of the difference, as the filter claims it before it corrects itself, $\mathbf{S} =
        \mathbf{H}\mathbf{P}\mathbf{H}^T + \mathbf{R}$.
    normalised_square : array of shape ``(...)``
        NIS, $\varepsilon = \boldsymbol\nu^T\mathbf{S}^{-1}\boldsymbol\nu$. No truth is needed. If
        the claim is true it is 2 on average for a direction, which can be wrong in two ways, and 3
        for a whole orientation.
    accepted : array of bool of shape ``(...)``
        Whether the square was within the gate. If not, the filter ignored the measurement.
    """

    difference: Array
    covariance: Array
    normalised_square: numpy.float64 | Array
    accepted: numpy.bool_ | Array


class FilterState(NamedTuple):
    r"""The estimate of a filter at one moment, or of a smoother at all of them.

    Attributes
    ----------
    dcm : array of shape ``(..., 3, 3)``
        ${}^{\hat B}\mathbf{C}^N$.
    bias : array of shape ``(..., 3)``
        Radians per second.
    covariance : array of shape ``(..., 6, 6)``
        Of the error state.
    """

    dcm: Array
    bias: Array
    covariance: Array


class Prediction(NamedTuple):
    r"""One step of a filter with its gyroscope, for `smooth`.

    Attributes
    ----------
    before, after : FilterState
    transition : array of shape ``(..., 6, 6)``
        $\boldsymbol\Phi$, which carries the error state over the step.
    """

    before: FilterState
    after: FilterState
    transition: Array


class MultiplicativeKalmanFilter:
    r"""Multiplicative extended Kalman filter of an orientation and of the gyroscope's bias.

    The orientation itself is a direction cosine matrix, which the filter rotates and never adds to.
    The covariance is that of the error state: the small rotation vector $\boldsymbol\delta$ from
    the estimated body to the true one, along the body,

    $$
    {}^B\mathbf{C}^N = \exp\left(-[\boldsymbol\delta]_\times\right)\,{}^{\hat B}\mathbf{C}^N ,
    $$

    followed by the error $\boldsymbol\beta$ of the bias. Everything works for one orientation and
    for a batch. The comments number the lines as the book's algorithm does.

    Parameters
    ----------
    dcm : array of shape ``(..., 3, 3)``
        The first estimate of ${}^B\mathbf{C}^N$.
    covariance : array of shape ``(6, 6)`` or ``(..., 6, 6)``
        Of $\boldsymbol\delta$ (square radians) and the bias (squares of radians per second).
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
    >>> prediction = estimate.turn((0, 0, 1.0), 0.01)
    >>> estimate.observe((0, 0, 1.0), (0, 0, 1.0), 0.01).difference.tolist()
    [0.0, 0.0, 0.0]
    >>> tilt, heading = estimate.covariance[0, 0], estimate.covariance[2, 2]
    >>> bool(tilt < 0.0002 < heading)  # up says nothing of the heading
    True
    >>> bool(estimate.observe((1.0, 0, 0), (0, 0, 1.0), 0.01, gate=9.21).accepted)
    False

    Notes
    -----
    Source: Lefferts, Markley and Shuster (1982); Markley (2003).
    In the book: equations (19.3) and (19.4).
    """

    def __init__(
        self, dcm: Values, covariance: Values, gyroscope_noise: Numbers, bias_noise: Numbers
    ) -> None:
        import numpy

        self.dcm = dcm_array(dcm, "dcm")
        batch = self.dcm.shape[:-2]
        self.bias = numpy.zeros((*batch, 3))
        self.covariance = numpy.broadcast_to(covariance_array(covariance, 6), (*batch, 6, 6)).copy()
        self.gyroscope_noise = number_array(gyroscope_noise, (), "gyroscope_noise")
        self.bias_noise = number_array(bias_noise, (), "bias_noise")

    @property
    def state(self) -> FilterState:
        """Return the filter's present estimate."""
        return FilterState(self.dcm, self.bias, self.covariance)

    def turn(self, angular_velocity: Values, step: Values) -> Prediction:
        r"""Predict: rotate with the gyroscope for one step.

        Parameters
        ----------
        angular_velocity : array of shape ``(..., 3)``
            What the gyroscope reports, bias and noise included, along the body; radians per second.
        step : float or array of shape ``(...)``
            Seconds.

        Returns
        -------
        Prediction
            For `smooth`.
        """
        import numpy

        rate = number_array(angular_velocity, (3,), "angular_velocity")
        step = number_array(step, (), "step")[..., None]
        before = self.state
        # 1
        T = dcm_from_rotation_vector((rate - self.bias) * step)
        # 2
        self.dcm = T @ self.dcm
        # 3
        Phi = numpy.zeros_like(self.covariance) + numpy.eye(6)
        Phi[..., :3, :3] = T
        Phi[..., :3, 3:] = -step[..., None] * numpy.eye(3)
        # 4
        noises = numpy.stack(numpy.broadcast_arrays(self.gyroscope_noise, self.bias_noise), axis=-1)
        Q = numpy.repeat(noises**2 * step, 3, axis=-1)[..., None] * numpy.eye(6)
        # 5
        self.covariance = Phi @ self.covariance @ Phi.swapaxes(-1, -2) + Q
        return Prediction(before, self.state, Phi)

    def observe(
        self,
        observed: Values,
        reference: Values,
        deviation: Values,
        gate: float = float("inf"),
    ) -> Innovation:
        r"""Correct the estimate with one direction that was measured.

        Parameters
        ----------
        observed : array of shape ``(..., 3)``
            The direction along the body, of any length.
        reference : array of shape ``(..., 3)``
            The same direction along $N$, of any length.
        deviation : float or array of shape ``(...)``
            Standard deviation perpendicular to the direction, radians.
        gate : float, optional
            A direction whose normalised square is larger is not used. An honest filter rejects one
            in a hundred at 9.21, one in a thousand at 13.8 ($\chi^2$ with two degrees of freedom,
            $-2\ln p$).

        Returns
        -------
        Innovation
            By how much the direction differed from what was expected, before the correction, and
            whether it was used.
        """
        import numpy

        seen, known = (
            unit_directions(number_array(direction, (3,), name), name)
            for direction, name in ((observed, "observed"), (reference, "reference"))
        )
        # 6
        expected = (self.dcm @ known[..., None])[..., 0]
        difference = seen - expected
        # 7: a body that is rotated by delta sees expected + expected x delta.
        slope = numpy.cross(expected[..., None, :], numpy.eye(3)).swapaxes(-1, -2)
        variance = number_array(deviation, (), "deviation")[..., None, None] ** 2
        return self._correct(difference, slope, variance * numpy.eye(3), gate)

    def observe_dcm(
        self, observed: Values, covariance: Values, gate: float = float("inf")
    ) -> Innovation:
        r"""Correct the estimate with a measured orientation, as from a star camera.

        Parameters
        ----------
        observed : array of shape ``(..., 3, 3)``
            ${}^B\mathbf{C}^N$.
        covariance : array of shape ``(3, 3)`` or ``(..., 3, 3)``
            Of its error along the body, as `directions_covariance` gives it; square radians.
        gate : float, optional
            As for a direction, with three degrees of freedom: 11.34 rejects one in a hundred.

        Returns
        -------
        Innovation
        """
        import numpy

        # 6 and 7, for an orientation
        difference = rotation_vector_from_dcm(
            dcm_array(observed, "observed") @ self.dcm.swapaxes(-1, -2)
        )
        return self._correct(difference, numpy.eye(3), covariance_array(covariance, 3), gate)

    def _correct(self, nu: Array, slope: Array, R: Array, gate: float) -> Innovation:
        import numpy

        H = numpy.zeros((*nu.shape, 6))
        H[..., :3] = slope
        P, identity = self.covariance, numpy.eye(6)
        # 8
        PH = P @ H.swapaxes(-1, -2)
        S = H @ PH + R
        # 9
        square = (nu * numpy.linalg.solve(S, nu[..., None])[..., 0]).sum(axis=-1)
        accepted = square <= gate
        # 10: components without a gain are not corrected below.
        K = numpy.where(accepted[..., None, None], PH @ numpy.linalg.inv(S), 0.0)
        # 11
        x = (K @ nu[..., None])[..., 0]
        # 12: Joseph's form keeps the covariance symmetric and positive in spite of rounding.
        left = identity - K @ H
        P = left @ P @ left.swapaxes(-1, -2) + K @ R @ K.swapaxes(-1, -2)
        # 13
        self.dcm = dcm_from_rotation_vector(x[..., :3]) @ self.dcm
        self.bias = self.bias + x[..., 3:]
        # 14: to second order, since I - X/2 alone would enlarge P a little each time.
        X = numpy.cross(x[..., None, :3], numpy.eye(3)).swapaxes(-1, -2)
        G = numpy.zeros_like(P) + identity
        G[..., :3, :3] += X @ X / 6 - X / 2
        self.covariance = G @ P @ G.swapaxes(-1, -2)
        return Innovation(nu, S, square, accepted)


def smooth(predictions: Sequence[Prediction], last: FilterState) -> FilterState:
    r"""Smooth the estimates of a filter: at each time, use the later measurements as well.

    The smoother of Rauch, Tung and Striebel, with the correction as a factor of the orientation.
    Backwards from the last state, with ${}^{-}$ for before and ${}^{+}$ for after a step,

    $$
    \mathbf{A} = \mathbf{P}^{-}\boldsymbol\Phi^T(\mathbf{P}^{+})^{-1} , \qquad
    \mathbf{x} = \mathbf{A}\,\mathbf{x}_{\text{later}} , \qquad
    \mathbf{P} = \mathbf{P}^{-} +
    \mathbf{A}\left(\mathbf{P}_{\text{later}} - \mathbf{P}^{+}\right)\mathbf{A}^T .
    $$

    Parameters
    ----------
    predictions : list of Prediction
        The ``n`` results of `MultiplicativeKalmanFilter.turn`, in order.
    last : FilterState
        The filter's ``state`` at the end.

    Returns
    -------
    FilterState
        With a first axis of length ``n + 1``: the beginning of each step, and the end.

    Examples
    --------
    >>> import numpy as np
    >>> from orientation import MultiplicativeKalmanFilter, smooth
    >>> covariance = np.diag([0.01] * 3 + [1e-4] * 3)
    >>> estimate = MultiplicativeKalmanFilter(np.eye(3), covariance, 0.001, 0.0001)
    >>> predictions = [estimate.turn((0, 0, 0), 0.1) for _ in range(5)]
    >>> innovation = estimate.observe((0, 0.1, 1.0), (0, 0, 1.0), 0.01)
    >>> smoothed = smooth(predictions, estimate.state)
    >>> smoothed.dcm.shape  # what is seen at the end was so before
    (6, 3, 3)
    >>> bool(smoothed.covariance[0, 0, 0] < 0.001 < predictions[0].before.covariance[0, 0])
    True

    Notes
    -----
    Source: Rauch, Tung and Striebel (1965).
    In the book: equation (19.9).
    """
    import numpy

    states = [last]
    for before, after, Phi in reversed(predictions):
        later = states[-1]
        gain = numpy.linalg.solve(after.covariance, Phi @ before.covariance).swapaxes(-1, -2)
        turned = rotation_vector_from_dcm(later.dcm @ after.dcm.swapaxes(-1, -2))
        x = numpy.concatenate([turned, later.bias - after.bias], axis=-1)
        x = (gain @ x[..., None])[..., 0]
        states.append(
            FilterState(
                dcm_from_rotation_vector(x[..., :3]) @ before.dcm,
                before.bias + x[..., 3:],
                before.covariance
                + gain @ (later.covariance - after.covariance) @ gain.swapaxes(-1, -2),
            )
        )
    return FilterState(*(numpy.stack(each[::-1]) for each in zip(*states, strict=True)))
