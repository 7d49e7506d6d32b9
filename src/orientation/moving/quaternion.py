"""The quaternion and its double, and three ways from one orientation to another."""
import math

import numpy as np
import traitlets

from ..axis_angle import axis_angle_from_dcm, quaternion_from_axis_angle
from ..direction_cosines import nearest_dcm
from ..drawing import Drawing
from ..euler_angles import dcm_from_body_fixed
from ..quaternions import dcm_from_quaternion, interpolate_quaternions, quaternion_from_dcm
from .figure import MovingFigure
from .state import Direction, Numbers

# As in quaternion.js: pixels, places on the sheet, seconds.
SIZE, KNOB, MIDDLE, RADIUS, SECONDS, BALL, SAMPLES = 96, 1.32, (142, 130), 70, 4, 104, 60
LEFT, RIGHT, TOP, BOTTOM = -120, 150, 144, 196
TOPS = (30, 60, 90, 120, 180, 360, 720)
FULL = 4 * math.pi
STEP = 1e-4


class QuaternionFigure(MovingFigure):
    r"""Half angles, and what they are good for, in two views.

    In the view 'double' a frame :math:`A` turns in :math:`N` about an axis, and beside it
    :math:`q = \cos\frac{\theta}{2} + \sin\frac{\theta}{2}\,\hat{e}` goes round a circle at half the speed.
    After one full turn it has come to :math:`-q`, after two it is back.

    In the view 'way' three frames go from the orientation of :math:`A` to that of :math:`B` in four
    seconds: :math:`C` by interpolating quaternions (slerp), :math:`D` by interpolating Euler angles z-x-y,
    :math:`E` by the direction cosine matrix nearest to the interpolated matrix entries.

    Attributes
    ----------
    view : {'double', 'way'}
    axis : tuple of three floats
        Direction of :math:`\hat{e}`, kept at unit length.
    angle : float
        :math:`\theta` in radians, from 0 to :math:`4\pi`.
    first, second : tuples of three floats
        Body fixed angles ``(psi, theta, phi)`` of :math:`A` and :math:`B` in :math:`N` for the sequence
        'zxy', in radians, each from :math:`-\pi` to :math:`\pi`.
    unit_vector : {'x', 'y', 'z'}
        The unit vector whose tip is followed.
    share : float
        How much of the way has been gone, from 0 to 1.

    Examples
    --------
    >>> from orientation.moving import QuaternionFigure
    >>> figure = QuaternionFigure(axis=(0, 0, 1), angle=6.283185307179586)
    >>> figure.quaternion.round(6).tolist()
    [-1.0, 0.0, 0.0, 0.0]
    """

    kind = 'quaternion'
    view = traitlets.Enum(('double', 'way'), 'double').tag(sync=True, state=True)
    axis = Direction((-1, 2, 4)).tag(sync=True, state=True)
    angle = Numbers(math.radians(60), largest=FULL).tag(sync=True, state=True)
    first = Numbers(np.radians((-70, -30, 70)), (3,), largest=math.pi).tag(sync=True, state=True)
    second = Numbers(np.radians((90, 80, -120)), (3,), largest=math.pi).tag(sync=True, state=True)
    unit_vector = traitlets.Enum(('x', 'y', 'z'), 'y').tag(sync=True, state=True)
    share = Numbers(0.3, largest=1.0).tag(sync=True, state=True)

    @traitlets.validate('angle', 'share')
    def _not_negative(self, proposal):
        name, value = proposal['trait'].name, proposal['value']
        if value < 0:
            raise traitlets.TraitError(f'{name} is {value:.6g}: it must be from 0 to {"1" if name == "share" else "4 pi"}')
        return value

    @property
    def sheet(self):
        """Left, top, right and bottom of the drawing, in pixels from its origin."""
        return (-118, -142, 242, 222) if self.view == 'double' else (-180, -142, 180, 222)

    @property
    def room(self):
        """Height of the figure in pixels with its controls beside and below it."""
        return (614, 842) if self.view == 'double' else (691, 888)

    @property
    def quaternion(self):
        """The unit quaternion of half the angle, scalar first, shape ``(4,)``."""
        return quaternion_from_axis_angle(self.axis, self.angle)

    @property
    def dcm(self):
        r""":math:`{}^A\mathbf{C}^N` of the view 'double', shape ``(3, 3)``."""
        return dcm_from_quaternion(self.quaternion)

    def ways(self, share):
        r"""Return :math:`{}^C\mathbf{C}^N`, :math:`{}^D\mathbf{C}^N` and :math:`{}^E\mathbf{C}^N` part of the way.

        None stands for a way that does not exist: slerp between orientations half a turn apart, or blended
        entries to which several matrices are equally near.
        """
        first, second = self._ends()
        angles = (1 - share) * np.array(self.first) + share * np.array(self.second)
        return (_or_none(lambda: dcm_from_quaternion(interpolate_quaternions(
                    quaternion_from_dcm(first), quaternion_from_dcm(second), share))),
                dcm_from_body_fixed(angles, 'zxy'),
                _or_none(lambda: nearest_dcm(self.blend(share)).dcm))

    def blend(self, share):
        """Return the matrix whose entries lie part of the way between those of the ends; its rows are too short."""
        first, second = self._ends()
        return (1 - share) * first + share * second

    def speeds(self, share):
        """Return the three angular speeds part of the way, radians per second for a way of four seconds."""
        early, late = max(0, share - STEP), min(1, share + STEP)
        return tuple(_angle(before, after) / (SECONDS * (late - early))
                     for before, after in zip(self.ways(early), self.ways(late)))

    def _ends(self):
        return dcm_from_body_fixed(np.array([self.first, self.second]), 'zxy')

    def drawing(self):
        return self._double() if self.view == 'double' else self._way()

    def _double(self):
        axis, half = np.array(self.axis), self.angle / 2
        q = ', '.join(f'{entry:.3f}' for entry in self.quaternion)
        drawing = Drawing(
            f'The triad of N, and from the same origin the triad of A, turned from N through theta, '
            f'{math.degrees(self.angle):.0f} degrees, about the unit vector e with the components '
            f'({", ".join(f"{entry:.2f}" for entry in axis)}). Beside it a circle of radius 1 with the scalar part of a '
            f'quaternion to the right and its part along e upwards. The point q stands at half the angle, '
            f'{math.degrees(half):.0f} degrees, and minus q opposite to it. q is ({q}), scalar first; minus q is the '
            f'same orientation.', scale=SIZE)
        drawing.line([-0.6 * axis, KNOB * axis], 'accent', 'guide')
        drawing.triad('N', 1.25 * np.eye(3)).triad('A', self.dcm).arrow(axis, colour='accent')
        drawing.dot(KNOB * axis, 'accent', 5).label(KNOB * axis, r'$\hat{e}$', 'accent', (17, 2))
        start = np.eye(3)[np.argmin(np.abs(axis))]
        start = start - start @ axis * axis
        rest = self.angle - 2 * math.pi
        if rest > 1e-9:
            for part in (0, math.pi):
                drawing.turn(axis, math.pi, start if part == 0 else -start, 0.5, colour='accent', head=False)
        if self.angle > 0:
            drawing.turn(axis, rest if rest > 1e-9 else self.angle, start, 0.6 if rest > 1e-9 else 0.5,
                         r'$\theta$', colour='accent', kind='thick')

        def at(radius, angle):
            return _placed(drawing, MIDDLE[0] + radius * math.cos(angle), MIDDLE[1] - radius * math.sin(angle))

        def round_to(radius, angle):
            return [at(radius, part * angle) for part in np.linspace(0, 1, 49)]

        for angle in (0, math.pi / 2):
            drawing.line([at(-RADIUS - 12, angle), at(RADIUS + 12, angle)], 'muted', 'faint')
        drawing.line(round_to(RADIUS, 2 * math.pi), 'muted')
        drawing.label(at(RADIUS + 12, 0), '$q_0$', shift=(3, 13), size=16)
        drawing.label(at(RADIUS + 12, math.pi / 2), r'$\hat{e}$', 'accent', (12, 2), 16)
        if half > 1e-9:
            drawing.line(round_to(RADIUS, half), 'accent', 'thick').line(round_to(22, half), 'accent')
            drawing.label(at(40, half / 2), r'$\theta/2$', 'accent', size=16)
        drawing.arrow(at(RADIUS, half), at(0, 0), 'accent', '$q$')
        return drawing.arrow(at(-RADIUS, half), at(0, 0), 'muted', '$-q$')

    def _way(self):
        first, second = self._ends()
        k = 'xyz'.index(self.unit_vector)
        shares = np.linspace(0, 1, SAMPLES + 1)
        tracks = list(zip(*map(self.ways, shares)))
        speeds = [[_angle(*pair) * SAMPLES / SECONDS for pair in zip(track, track[1:])] for track in tracks]
        lengths = np.linalg.norm(self.blend(self.share), axis=1)
        now = [f'{speed:.0f}' if math.isfinite(speed) else 'not defined' for speed in np.degrees(self.speeds(self.share))]
        drawing = Drawing(
            f'A sphere with three ways of the tip of a unit vector {self.unit_vector} from the orientation of A to that of '
            f'B, a turn of {math.degrees(_angle(first, second)):.0f} degrees: of C by slerp, an even turn about one axis; '
            f'of D by interpolated Euler angles z-x-y; of E, the same way as C but at another pace, by the matrix nearest to interpolated entries. A '
            f'straight dashed line inside the sphere shows where the blended entries lead before they are repaired. '
            f'Shown after {self.share * SECONDS:.1f} of {SECONDS} seconds, when the speeds of C, D and E are {now[0]}, {now[1]} and {now[2]} '
            f'degrees per second, and the blended rows have the lengths '
            f'{", ".join(f"{length:.2f}" for length in lengths)}. Below, the three speeds over time.', scale=BALL)
        drawing.circle(drawing.view[2], kind='faint').circle((0, 0, 1), kind='faint')
        drawing.line([first[k], second[k]], 'E', 'guide')
        for letter, track in zip('CD', tracks):
            if track[0] is not None:
                drawing.line([dcm[k] for dcm in track], letter, 'axis')
        # E goes the same way round as C, at another pace: dots a fifth of a second apart.
        for dcm in tracks[2][::3]:
            if dcm is not None:
                drawing.dot(dcm[k], 'E', 3)
        letters = {letter: rf'$\hat{{{letter.lower()}}}_{self.unit_vector}$' for letter in 'ABCDE'}
        drawing.arrow(first[k], colour='A', label=letters['A']).arrow(second[k], colour='B', label=letters['B'])
        raw = self.blend(self.share)[k]
        drawing.line([(0, 0, 0), raw], 'E').dot(raw, 'E', 4)
        for letter, dcm in zip('CDE', self.ways(self.share)):
            if dcm is not None and 1e-9 < self.share < 1 - 1e-9:
                drawing.arrow(dcm[k], colour=letter, label=letters[letter])
            elif dcm is not None:
                drawing.dot(dcm[k], letter, 5)
        return self._plot(drawing, speeds)

    def _plot(self, drawing, speeds):
        fast = np.degrees(np.nanmax(speeds[:2]))
        highest = next((top for top in TOPS if top >= fast), TOPS[-1])

        def at(part, speed):
            height = min(1.15, speed / highest)
            return _placed(drawing, LEFT + part * (RIGHT - LEFT), BOTTOM - height * (BOTTOM - TOP))

        drawing.line([at(0, 0), at(1, 0)], 'muted').line([at(0, 0), at(0, highest)], 'muted')
        drawing.line([at(0, highest), at(1, highest)], 'muted', 'faint')
        drawing.label(at(0, highest), rf'${highest}^\circ/\mathrm{{s}}$', shift=(-30, 0), size=14)
        drawing.label(at(0, 0), '$0$', shift=(-11, 0), size=14)
        drawing.label(at(1, 0), rf'${SECONDS}\,\mathrm{{s}}$', shift=(0, 14), size=14)
        drawing.line([at(self.share, 0), at(self.share, highest)], 'ink', 'guide')
        for letter, track in zip('CDE', speeds):
            points = [at((n + 0.5) / SAMPLES, math.degrees(speed)) for n, speed in enumerate(track) if math.isfinite(speed)]
            if len(points) > 1:
                drawing.line(points, letter, 'axis')
        return drawing


def _placed(drawing, right, down):
    """Return a point of N that is seen at a place of the sheet."""
    return np.array((right, -down, 0)) / drawing.scale @ drawing.view


def _angle(before, after):
    """Return the angle of the turn between two orientations, NaN where one of them is missing."""
    return math.nan if before is None or after is None else float(axis_angle_from_dcm(after @ before.T)[1])


def _or_none(compute):
    try:
        return compute()
    except ValueError:
        return None
