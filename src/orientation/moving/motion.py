"""A racket that tumbles, its orientation integrated as a matrix, as a quaternion and as Euler angles."""
from functools import lru_cache

import numpy as np
import traitlets

from ..axis_angle import axis_angle_from_dcm
from ..direction_cosines import nearest_dcm
from ..drawing import Drawing
from ..euler_angles import body_fixed_from_dcm, dcm_from_body_fixed, gimbal_lock_margin
from ..motion import angular_velocity_matrix, dcm_rate, quaternion_rate
from ..quaternions import dcm_from_quaternion
from .figure import MovingFigure
from .state import Numbers

#: Principal moments of inertia about a_x, a_y and a_z in g m^2; only their ratios matter. The racket's a_x
#: runs along its handle and a_z out of its face; the book's a_x runs along its long edges.
MOMENTS = {'racket': (1.2, 16.0, 17.0), 'book': (6.9, 13.3, 19.7)}
DESCRIPTIONS = {'matrix': 'direction cosine matrix', 'quaternion': 'quaternion', 'angles': 'Euler angles'}
SPIN = 4.0        # rad/s
SECONDS = 20.0
FINER = 10        # the reference takes so many steps for one
LARGEST = 1e6     # numbers beyond this end a run
SAMPLE = 0.1      # seconds between two points of a curve
SIZE, REACH = 118, 1.25   # pixels to the unit, and how long an arrow may be drawn
COLOURS = {'matrix': 'A', 'quaternion': 'D', 'angles': 'C'}
LEFT, RIGHT, PLOT = -128, 168, (-180, 0, 180, 356)
# Top, bottom, value at the bottom and at the top, and the marked values, of each part of the plot.
FAULT, ERROR, MARGIN = (24, 124, -16, 2), (156, 256, -12, 1), (288, 324, 0, 90)
LEGEND = 104


class Between(Numbers):
    """One number from ``least`` to ``largest``."""

    def __init__(self, default, least, largest, unit):
        super().__init__(default)
        self.least, self.largest, self.unit = least, largest, unit

    def validate(self, obj, value):
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = np.nan
        if not self.least <= number <= self.largest:
            raise traitlets.TraitError(f'{self.name} is {value!r}; from {self.least:g} to {self.largest:g} '
                                       f'{self.unit} can be had')
        return number


class Moments(Numbers):
    """Three principal moments of inertia that a body can have, in g m^2."""

    def validate(self, obj, value):
        moments = super().validate(obj, value)
        if not all(0.1 <= moment <= 20 for moment in moments):
            raise traitlets.TraitError(f'{self.name} is {value!r}; from 0.1 to 20 g m^2 can be had')
        largest = max(moments)
        others = sum(moments) - largest
        if largest > others + 1e-9:
            raise traitlets.TraitError(f'{self.name} is {value!r}: no body has such moments of inertia, because the '
                                       f'largest, {largest:g}, is more than the sum of the others, {others:g}')
        return moments


class MotionFigure(MovingFigure):
    r"""A body that tumbles freely, integrated in three descriptions with or without the restoring step.

    The body spins with 4 rad/s about one of its principal axes, slightly disturbed. Its orientation is
    carried along as a direction cosine matrix, as a quaternion and as Euler angles in the sequence
    :math:`z`-:math:`x`-:math:`y`; one of them is drawn, and dashed the reference, a quaternion
    integrated with steps ten times finer. Plots show how the drift grows.

    Attributes
    ----------
    moments : tuple of three floats
        The principal moments of inertia about :math:`\hat{a}_x`, :math:`\hat{a}_y` and :math:`\hat{a}_z`, from
        0.1 to 20 g m\ :sup:`2`, none larger than the sum of the others. A racket is drawn for its own,
        otherwise the uniform block that has them.
    axis : str
        The principal axis that it spins about, 'x', 'y' or 'z'.
    disturbance : float
        Angular velocity about the two other axes at the start, 0 to 0.5 rad/s.
    method : str
        'Euler' or 'Runge-Kutta' (of fourth order).
    step : float
        From 0.005 to 0.1 seconds.
    restored : bool
        Whether after every step the matrix is replaced by the nearest orthogonal one, and the quaternion
        divided by its length.
    description : str
        Which one is drawn: 'matrix', 'quaternion' or 'angles'.
    time : float
        From 0 to 20 seconds. The figure computes up to here, and further as the reader plays it.

    Examples
    --------
    >>> from orientation.moving import MotionFigure
    >>> figure = MotionFigure(method='Runge-Kutta', step=0.02, time=3)
    >>> figure.flips
    0
    >>> figure.time = 4
    >>> figure.flips
    1
    """

    kind = 'motion'
    sheet = (-180, -150, 180, 150)
    room = (684, 1255)
    moments = Moments(MOMENTS['racket'], (3,)).tag(sync=True, state=True)
    axis = traitlets.Enum(tuple('xyz'), 'y').tag(sync=True, state=True)
    disturbance = Between(0.01, 0, 0.5, 'rad/s').tag(sync=True, state=True)
    method = traitlets.Enum(('Euler', 'Runge-Kutta'), 'Euler').tag(sync=True, state=True)
    step = Between(0.01, 0.005, 0.1, 'seconds').tag(sync=True, state=True)
    restored = traitlets.Bool(False).tag(sync=True, state=True)
    description = traitlets.Enum(tuple(DESCRIPTIONS), 'matrix').tag(sync=True, state=True)
    time = Between(6.0, 0, SECONDS, 'seconds').tag(sync=True, state=True)

    def run(self):
        """Return what has been computed from 0 to ``time``, as a dict of arrays with one row for each step.

        ``'time'``; ``'angular_velocity'`` along A; ``'matrix'``, ``'quaternion'``, ``'angles'`` as
        integrated; and ``'reference'``, the unit quaternion of the fine integration. A run ends early where
        its numbers have grown beyond a million.
        """
        count = int(self.time / self.step + 1e-9)
        return _run(self.moments, self.axis, self.disturbance, self.method, self.step, self.restored, count)

    @property
    def dcm(self):
        """The matrix of the drawn description at ``time``, orthogonal or not, shape ``(3, 3)``."""
        return _matrices(self.run(), self.description, slice(-1, None))[0]

    @property
    def body(self):
        """What is drawn: 'racket', 'book' or, for other moments of inertia, 'block'."""
        return next((name for name, moments in MOMENTS.items() if moments == self.moments), 'block')

    @property
    def flips(self):
        """How often the body has turned its spin axis over against the angular momentum."""
        toward = self._truth() @ self._momentum()
        return int((np.diff(np.sign(toward['xyz'.index(self.axis)::3])) != 0).sum())

    def _truth(self):
        # All rows of all matrices of the reference, one after the other.
        return dcm_from_quaternion(self.run()['reference']).reshape(-1, 3)

    def _momentum(self):
        # At the start A is N, and the components along both are the same.
        momentum = self.moments * self.run()['angular_velocity'][0]
        return momentum / np.linalg.norm(momentum)

    def still(self):
        plot = self.plot().svg(bounds=np.add(PLOT, (8, 8, -8, -8)))
        end = '</div></figure>'
        return super().still().removesuffix(end) + plot + end

    def drawing(self):
        dcm, run = self.dcm, self.run()
        fault, error = (curve[-1] for curve in (_fault(dcm[None]), _error(dcm[None], run['reference'][-1:])))
        lengths = ', '.join(f'{length:.2f}' for length in np.linalg.norm(dcm, axis=1))
        restored = 'restored after every step' if self.restored else 'not restored'
        middle = sorted(self.moments)[1] == self.moments['xyz'.index(self.axis)]
        times = {0: 'has not flipped yet' if middle else 'does not flip', 1: 'has flipped once'}.get(self.flips, f'has flipped {self.flips} times')
        drawing = Drawing(
            f'A {self.body} that spins freely about its {self.axis} axis, with the moments of inertia '
            f'{", ".join(f"{moment:g}" for moment in self.moments)} g m^2 about x, y and z, drawn with its triad A as its '
            f'{DESCRIPTIONS[self.description]} says after {run["time"][-1]:.1f} seconds, {restored}, with the '
            f'{self.method} method in steps of {1000 * self.step:g} milliseconds. It {times}. The unit vectors of A, '
            f'which should be 1 long, are {lengths} long; the matrix is not orthogonal by {_words(fault)}, and the '
            f'orientation is wrong by {_words(error)} radians. Dashed: the reference, computed with steps ten times '
            f'finer. The arrow H is the angular momentum, which keeps its direction. In the corner stands the triad of N.',
            scale=SIZE)
        corner = np.array((-136, -108, 0)) / SIZE @ drawing.view
        drawing.triad('N', np.eye(3), corner, 0.28)
        drawing.arrow(1.4 * self._momentum(), colour='accent', label=r'$\mathbf{H}$')
        # A body that has grown out of the sheet is drawn smaller, and with it what it really is.
        drawing.scale = SIZE * min(1, REACH / np.linalg.norm(dcm, axis=1).max())
        toward = dcm @ drawing.view[2] > 0

        def arrow(k):
            drawing.arrow(dcm[k], colour='A', label=rf'$\hat{{a}}_{"xyz"[k]}$')

        if not toward[2]:
            arrow(2)
        if self.body == 'racket':
            _draw_racket(drawing, dcm)
        else:
            _draw_block(drawing, dcm, _edges(self.moments))
        for k in range(3 if toward[2] else 2):
            arrow(k)
        for points in RACKET if self.body == 'racket' else [_cut(_edges(self.moments))]:
            drawing.line(points @ dcm_from_quaternion(run['reference'][-1]), 'muted', 'guide')
        return drawing

    def plot(self):
        """Return the ``Drawing`` of how the drift has grown up to ``time``."""
        run, every = self.run(), max(1, round(SAMPLE / self.step))
        times, reference = run['time'][::every], run['reference'][::every]
        curves = {name: _matrices(run, name, slice(None, None, every)) for name in DESCRIPTIONS}
        faults = {name: _fault(curve) for name, curve in curves.items()}
        errors = {name: _error(curve, reference) for name, curve in curves.items()}
        angles = body_fixed_from_dcm(dcm_from_quaternion(run['reference']), 'zxy')
        margins = np.degrees(gimbal_lock_margin(angles, 'zxy'))
        margin = np.array([margins[max(0, k - every + 1):k + 1].min() for k in range(0, len(margins), every)])
        last = '; '.join(f'{title}, not orthogonal by {_words(faults[name][-1])}, error {_words(errors[name][-1])} radians'
                         for name, title in DESCRIPTIONS.items())
        drawing = Drawing(
            f'Three plots over the {SECONDS:.0f} seconds of the run, which has come to {times[-1]:.1f} seconds. Above, on a '
            f'logarithmic scale, by how much each description is not orthogonal; in the middle, its error against the '
            f'reference; below, the margin of the Euler angles to gimbal lock, at the least {margin.min():.0f} degrees. '
            f'At the last: {last}.')
        for part, title, marks in (
                (FAULT, r'$\mathrm{not\ orthogonal\ by}$', {-15: '10^{-15}', -10: '10^{-10}', -5: '10^{-5}', 0: '1'}),
                (ERROR, r'$\mathrm{error\ (rad)}$', {-10: '10^{-10}', -5: '10^{-5}', 0: '1'}),
                (MARGIN, r'$\mathrm{margin\ to\ gimbal\ lock\ (degrees)}$', {0: '0', 90: '90'})):
            top, bottom, *_ = part
            drawing.label((0, 0, 0), title, 'ink', ((LEFT + RIGHT) / 2, top - 13), 16)
            for second in range(0, int(SECONDS) + 1, 5):
                drawing.path('ML', [(_across(second), top), (_across(second), bottom)], 'faint muted')
            for value, words in marks.items():
                drawing.path('ML', [(LEFT, _down(part, value)), (RIGHT, _down(part, value))], 'faint muted')
                drawing.label((0, 0, 0), f'${words}$', 'muted', (LEFT - 26, _down(part, value)), 14)
        for second in range(0, int(SECONDS) + 1, 5):
            drawing.label((0, 0, 0), f'${second}$', 'muted', (_across(second), MARGIN[1] + 13), 14)
        drawing.label((0, 0, 0), r'$t\ \mathrm{(s)}$', 'ink', (_across(17.5), MARGIN[1] + 15), 16)
        for part, values in ((FAULT, faults), (ERROR, errors)):
            for name, colour in COLOURS.items():
                _curve(drawing, times, np.log10(np.maximum(values[name], 1e-30)), part, f'axis {colour}')
        _curve(drawing, times, margin, MARGIN, 'ink')
        # What the figure says in its table, where curves only pass through on their way up.
        for name, words, place, middle in (('matrix', 'matrix', -120, -73), ('quaternion', 'quaternion', -40, 19),
                                           ('angles', r'Euler\ angles', 64, 127)):
            colour = COLOURS[name]
            drawing.path('ML', [(place, LEGEND), (place + 22, LEGEND)], f'axis {colour}')
            drawing.label((0, 0, 0), rf'$\mathrm{{{words}}}$', colour, (middle, LEGEND), 14)
        return drawing


def _words(value):
    if value >= 1e-3 or value < 1e-15:
        return f'{value:.2g}' if value >= 1e-3 else 'less than 10 to the -15'
    mantissa, exponent = f'{value:.1e}'.split('e')
    return f'{mantissa} times 10 to the {int(exponent)}'


def _across(time):
    return LEFT + (RIGHT - LEFT) * time / SECONDS


def _down(part, value):
    top, bottom, least, most = part
    return bottom - (bottom - top) * (np.clip(value, least, most) - least) / (most - least)


def _curve(drawing, times, values, part, kind):
    drawing.path('M' + 'L' * (len(times) - 1), np.stack([_across(times), _down(part, values)], axis=-1), kind)


# The integration. Its results are kept: an unchanged figure draws the same run again and again.

@lru_cache(maxsize=8)
def _run(moments, axis, disturbance, method, step, restored, count):
    start = np.where([axis == other for other in 'xyz'], SPIN, disturbance)
    rows = [(start, np.eye(3), np.eye(4)[0], np.zeros(3))]

    def rates(omega, matrix, quaternion, angles):
        return (np.array(_angular_acceleration(omega, moments)), dcm_rate(matrix, omega),
                quaternion_rate(quaternion, omega), np.linalg.solve(angular_velocity_matrix(angles, 'zxy'), omega))

    for _ in range(count):
        with np.errstate(all='ignore'):
            omega, matrix, quaternion, angles = _step(rates, rows[-1], step, method)
        largest = max(abs(omega).max(), abs(matrix).max(), abs(quaternion).max())
        if not largest < LARGEST or not np.isfinite(angles).all():
            break
        if restored:
            matrix, quaternion = nearest_dcm(matrix).dcm, quaternion / np.linalg.norm(quaternion)
        rows.append((omega, matrix, quaternion, angles))
    names = 'angular_velocity', 'matrix', 'quaternion', 'angles'
    return {'time': step * np.arange(len(rows)), 'reference': _reference(start, moments, step / FINER, FINER * (len(rows) - 1))[::FINER],
            **{name: np.array(column) for name, column in zip(names, zip(*rows))}}


def _angular_acceleration(omega, moments):
    """Return the change of the angular velocity along the principal axes, without torque."""
    (x, y, z), (a, b, c) = omega, moments
    return -(y * (c * z) - z * (b * y)) / a, -(z * (a * x) - x * (c * z)) / b, -(x * (b * y) - y * (a * x)) / c


def _reference(start, moments, step, count):
    """Return the unit quaternions of so many Runge-Kutta steps from the identity, shape ``(count + 1, 4)``.

    The rate is linear in the quaternion: once the angular velocity is known, each step is a 4 by 4 matrix,
    and those of all steps are found together, which is ten times as fast as one after the other.
    """
    def beyond(length, slope):
        return [value + length * change for value, change in zip(omega, slope)]

    omega, stages = start.tolist(), []
    for _ in range(count):
        first = _angular_acceleration(omega, moments)
        second = _angular_acceleration(middle := beyond(step / 2, first), moments)
        third = _angular_acceleration(again := beyond(step / 2, second), moments)
        fourth = _angular_acceleration(end := beyond(step, third), moments)
        stages.append((omega, middle, again, end))
        omega = beyond(step / 6, [a + 2 * b + 2 * c + d for a, b, c, d in zip(first, second, third, fourth)])
    quaternions = [np.eye(4)[0]]
    if count:
        # The fixed quaternions 1, i, j, k, and in front of them an axis for the steps.
        units, (first, second, third, fourth) = np.eye(4), np.array(stages).transpose(1, 0, 2)[:, :, None]
        a = quaternion_rate(units, first)
        b = quaternion_rate(units + step / 2 * a, second)
        c = quaternion_rate(units + step / 2 * b, third)
        d = quaternion_rate(units + step * c, fourth)
        for matrix in units + step / 6 * (a + 2 * b + 2 * c + d):
            quaternion = quaternions[-1] @ matrix
            quaternions.append(quaternion / np.sqrt(quaternion @ quaternion))
    return np.array(quaternions)


def _step(rates, state, step, method):
    """Return the ``state``, a tuple of arrays, one step later."""
    def beyond(length, slopes):
        return tuple(value + length * slope for value, slope in zip(state, slopes))

    first = rates(*state)
    if method == 'Euler':
        return beyond(step, first)
    second = rates(*beyond(step / 2, first))
    third = rates(*beyond(step / 2, second))
    fourth = rates(*beyond(step, third))
    return beyond(step / 6, [a + 2 * b + 2 * c + d for a, b, c, d in zip(first, second, third, fourth)])


# What the numbers of a run say.

def _matrices(run, description, which):
    """Return the direction cosine matrices of a description; that of a quaternion is |q|^2 times orthogonal."""
    values = run[description][which]
    if description == 'matrix':
        return values
    if description == 'angles':
        return dcm_from_body_fixed(values, 'zxy')
    lengths = np.linalg.norm(values, axis=-1, keepdims=True)
    return dcm_from_quaternion(values / lengths) * lengths[..., None]**2


def _fault(dcms):
    """Return the largest entry by which each matrix times its transpose differs from the identity."""
    return abs(dcms @ dcms.swapaxes(-1, -2) - np.eye(3)).max(axis=(-2, -1))


def _error(dcms, references):
    """Return the angle between the nearest valid orientation and the reference, in radians."""
    return axis_angle_from_dcm(nearest_dcm(dcms @ dcm_from_quaternion(references).swapaxes(-1, -2)).dcm)[1]


# The bodies, along A.

def _ring(middle, along, across, count=28):
    turn = 2 * np.pi * np.arange(count + 1) / count
    return np.stack([middle + along * np.cos(turn), across * np.sin(turn), 0 * turn], axis=-1)


HEAD = _ring(0.45, 0.47, 0.36)
STRINGS = np.array([(x, side * 0.36 * np.sqrt(1 - ((x - 0.45) / 0.47)**2), 0)
                    for x in (0.12, 0.285, 0.45, 0.615, 0.78) for side in (-1, 1)]
                   + [(0.45 + side * 0.47 * np.sqrt(1 - (y / 0.36)**2), y, 0) for y in (-0.2, 0, 0.2) for side in (-1, 1)])
THROAT = np.array([(0.065, 0.206, 0), (-0.24, 0, 0), (0.065, -0.206, 0)])
HANDLE = np.array([(-0.24, 0, 0), (-0.85, 0, 0)])
RACKET = HEAD, THROAT, HANDLE
COVER = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)])
LONGEST_EDGE = 1.4


def _edges(moments):
    """Return the edges of a uniform block: about each axis the moment is that of the two other edges squared."""
    edges = np.sqrt(np.maximum(sum(moments) / 2 - np.array(moments), 0))
    return LONGEST_EDGE * edges / edges.max()


def _cut(edges):
    """Return the outline of the widest cut through the middle of a block."""
    thin = np.argmin(edges)
    return np.roll(np.insert(COVER, 0, 0, axis=1), thin, axis=1) * edges / 2


def _draw_racket(drawing, dcm):
    front = dcm[2] @ drawing.view[2] > 0

    def handle():
        drawing.line(THROAT @ dcm, 'A', 'thick').line(HANDLE @ dcm, 'A', 'tube')

    if dcm[0] @ drawing.view[2] > 0:
        handle()
    drawing.area(HEAD[:-1] @ dcm, 'A', 8 if front else 38, edge=False)
    drawing.path('ML' * (len(STRINGS) // 2), drawing.on_sheet(STRINGS @ dcm), 'faint A')
    drawing.line(HEAD @ dcm, 'A', 'thick')
    if not dcm[0] @ drawing.view[2] > 0:
        handle()


def _draw_block(drawing, dcm, edges):
    # Cross products of the edges: the faces of a skewed box do not look along the rows.
    half = dcm * edges[:, None] / 2
    for k, fill in enumerate((26, 26, 8)):
        u, v = half[(k + 1) % 3], half[(k + 2) % 3]
        for side in (-1, 1):
            if side * np.cross(u, v) @ drawing.view[2] > 0:
                corners = side * half[k] + np.array([u + v, v - u, -u - v, u - v])
                drawing.area(corners, 'A', 38 if k == 2 and side < 0 else fill)
