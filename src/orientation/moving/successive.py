"""A chain of simple turns, frame by frame, with the product of their matrices."""
import math

import numpy as np
import traitlets

from .._kinds import number_array
from ..axis_angle import axis_angle_from_dcm
from ..direction_cosines import simple_dcm
from ..drawing import Drawing
from .figure import MovingFigure
from .state import Numbers

REACH, BEFORE, SIZE = 1.25, 0.66, 96   # of the arrows of N, of the frames before the last, pixels
LETTERS = 'NABCD'
COMPARISONS = ('nothing', '1 and 2 exchanged', '2 and 3 exchanged', '3 and 4 exchanged', 'body and space fixed')


class Turns(traitlets.TraitType):
    """One to four turns, each an axis and an angle in radians."""

    def validate(self, obj, value):
        turns = tuple(tuple(turn) for turn in value) if isinstance(value, (list, tuple)) and all(
            isinstance(turn, (list, tuple)) and len(turn) == 2 for turn in value) else ()
        if not 1 <= len(turns) <= 4:
            raise traitlets.TraitError(f'turns is {value!r}: one to four pairs were expected, each an axis and an '
                                       "angle in radians, as (('z', 0.7), ('x', 0.5))")
        return tuple((self._axis(axis), self._angle(angle)) for axis, angle in turns)

    def _axis(self, axis):
        if axis not in ('x', 'y', 'z'):
            raise traitlets.TraitError(f"turns holds the axis {axis!r}: 'x', 'y' or 'z' was expected")
        return axis

    def _angle(self, angle):
        try:
            number = float(number_array(angle, (), 'angle'))
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(f'turns: {error}') from None
        if abs(number) > math.pi + 1e-12:
            raise traitlets.TraitError(f'turns holds the angle {number:.6g}: it must be from -pi to pi. Angles are in '
                                       'radians, not degrees')
        return number


class SuccessiveFigure(MovingFigure):
    r"""A chain of up to four simple turns from :math:`N` to :math:`A`, :math:`B`, :math:`C` and :math:`D`.

    Beside the frames stand the matrices of the turns and their product. With body fixed turns the newest
    stands on the left,

    .. math::

       {}^D\mathbf{C}^N = {}^D\mathbf{C}^C\,{}^C\mathbf{C}^B\,{}^B\mathbf{C}^A\,{}^A\mathbf{C}^N ,

    with turns about the axes of :math:`N` on the right. A second chain can be drawn beside the first, with
    two neighbouring turns exchanged or of the other kind; its end is the frame :math:`E`.

    Attributes
    ----------
    turns : tuple of pairs
        One to four turns, each an axis 'x', 'y' or 'z' and an angle in radians, from :math:`-\pi` to
        :math:`\pi`.
    fixed : {'body', 'space'}
        Whether each turn is about a unit vector of the frame before it, or about one of :math:`N`.
    compare : str
        What the second chain is: one of :data:`COMPARISONS`.
    share : float
        How much of the chain has been gone through, from 0 to 1.

    Examples
    --------
    >>> from orientation.moving import SuccessiveFigure
    >>> figure = SuccessiveFigure(turns=[('z', 1.2), ('x', 0.4)], compare='1 and 2 exchanged')
    >>> figure.dcm.shape, round(figure.angle_between, 6)
    ((3, 3), 0.449655)
    """

    kind = 'successive'
    sheet = (-180, -142, 180, 222)
    room = (685, 1001)
    turns = Turns((('z', math.radians(30)), ('x', math.radians(50)), ('y', math.radians(40)))).tag(sync=True, state=True)
    fixed = traitlets.Enum(('body', 'space'), 'body').tag(sync=True, state=True)
    compare = traitlets.Enum(COMPARISONS, 'nothing').tag(sync=True, state=True)
    share = Numbers(1.0, largest=1.0).tag(sync=True, state=True)

    @traitlets.validate('share')
    def _not_negative(self, proposal):
        if proposal['value'] < 0:
            raise traitlets.TraitError(f'share is {proposal["value"]!r}: a number from 0 to 1 was expected')
        return proposal['value']

    @traitlets.validate('turns', 'compare')
    def _has_both_turns(self, proposal):
        turns, compare = (proposal['value'] if proposal['trait'].name == name else getattr(self, name)
                          for name in ('turns', 'compare'))
        if 1 <= COMPARISONS.index(compare) <= 3 and len(turns) <= COMPARISONS.index(compare):
            raise traitlets.TraitError(f'compare is {compare!r}, but the chain has only {len(turns)} '
                                       f'turn{"s" * (len(turns) > 1)}')
        return proposal['value']

    @property
    def dcms(self):
        """Direction cosine matrices of N and of every further frame with respect to N, shape ``(n + 1, 3, 3)``."""
        return _frames(self.turns, self.fixed)

    @property
    def dcm(self):
        """Direction cosine matrix of the end of the chain with respect to N, shape ``(3, 3)``."""
        return self.dcms[-1]

    @property
    def other(self):
        """Direction cosine matrix of E with respect to N, or None where nothing is compared."""
        return None if self.compare == 'nothing' else _frames(*self._second())[-1]

    @property
    def angle_between(self):
        """Angle of the turn from the end of the chain to E, radians, or None where nothing is compared."""
        return None if self.other is None else float(axis_angle_from_dcm(self.other @ self.dcm.T)[1])

    def _second(self):
        turns, kind = list(self.turns), self.fixed
        k = COMPARISONS.index(self.compare)
        if k < 4:
            turns[k - 1], turns[k] = turns[k], turns[k - 1]
        else:
            kind = 'space' if kind == 'body' else 'body'
        return turns, kind

    def drawing(self):
        count, now = len(self.turns), _partly(self.turns, self.share)
        frames, last = _frames(now, self.fixed), len(now)
        drawing = Drawing(self._words(now, frames), scale=SIZE)
        drawing.triad('N', REACH * np.eye(3))
        second = None if self.compare == 'nothing' else self._second()
        for k in range(1, last):
            drawing.triad(LETTERS[k], frames[k], length=BEFORE, labels=('', '', ''))
        if last and not second:
            axis = (frames[last - 1] if self.fixed == 'body' else np.eye(3))['xyz'.index(now[-1][0])]
            drawing.line([-0.35 * axis, REACH * axis], 'accent', 'guide')
            _around(drawing, axis, now[-1][1], frames[last - 1])
        if last:
            drawing.triad(LETTERS[last], frames[-1])
        if second:
            turns = _partly(second[0], self.share)
            other = _frames(turns, second[1])
            if last:
                axis, angle = axis_angle_from_dcm(other[-1] @ frames[-1].T)
                if angle > 0.02:
                    _around(drawing, axis @ frames[-1], angle, frames[-1])
                drawing.triad('E', other[-1])
            colours = ['N', *['muted'] * (count - 1), 'E']
            _strip(drawing, other, turns, second[1], colours, 195, 22)
        _strip(drawing, frames, now, self.fixed, LETTERS[:count + 1], 143 if second else 168, 22 if second else 27)
        return drawing

    def _words(self, now, frames):
        about = ['n' if self.fixed == 'space' else letter.lower() for letter in LETTERS]
        steps = '; '.join(f'{LETTERS[k + 1]} is turned from {LETTERS[k]} through {math.degrees(angle):.0f} degrees about '
                          f'{about[k]} {axis}' for k, (axis, angle) in enumerate(now))
        rows = [f'{name} at ({", ".join(f"{entry:.2f}" for entry in row)})' for name, row in zip('xyz', frames[-1])]
        end = LETTERS[len(now)]
        words = (f'The triads of the frames {", ".join(LETTERS[:len(now) + 1])} from one origin, and below them each '
                 f'frame by itself, in order, with a small box that turns with it. ')
        words += f'{steps}. ' if steps else 'No turn has been made yet. '
        words += f'Along N, the unit vectors of {end} are {", ".join(rows)}.'
        if self.compare != 'nothing':
            kind = ('with the same turns ' + ('space fixed' if self.fixed == 'body' else 'body fixed')
                    if self.compare == COMPARISONS[4] else f'with turns {self.compare}')
            words += (f' A second chain, {kind}, ends in the frame E; a turn of {math.degrees(self.angle_between):.1f} '
                      f'degrees lies between the two ends.')
        return words


def _frames(turns, kind):
    frames = [np.eye(3)]
    for axis, angle in turns:
        turn = simple_dcm(axis, angle)
        # A turn about the frame's own unit vector multiplies from the left, one about N's from the right.
        frames.append(turn @ frames[-1] if kind == 'body' else frames[-1] @ turn)
    return np.array(frames)


def _partly(turns, share):
    """Return the turns made so far; each begins and ends at rest."""
    done = share * len(turns)
    whole = min(math.floor(done + 1e-9), len(turns))
    rest = max(0.0, done - whole)
    turns = list(turns)
    if rest > 1e-9:
        axis, angle = turns[whole]
        return [*turns[:whole], (axis, rest * rest * (3 - 2 * rest) * angle)]
    return turns[:whole]


def _around(drawing, axis, angle, starts):
    for start in starts:
        foot = start @ axis * axis
        if (radius := np.linalg.norm(start - foot)) > 1e-6:
            drawing.turn(axis, angle, start - foot, radius, origin=foot, colour='muted', head=False)


def _strip(drawing, frames, turns, kind, colours, down, radius):
    """Draw the frames side by side in their order, with the unit vector that each turn is about."""
    width, reach = 340 / len(colours), radius / SIZE

    def at(x, y=0):
        return np.array((x, -(down + y), 0)) / SIZE @ drawing.view

    for k, dcm in enumerate(frames):
        x = (k - (len(colours) - 1) / 2) * width
        drawing.box(dcm, (1.1 * reach, 0.8 * reach, 0.28 * reach), at(x), colours[k])
        drawing.triad(colours[k], dcm, at(x), reach, labels=('', '', ''))
        if colours[k] != 'muted':
            drawing.label(at(x - radius + 1, -radius + 1), f'${colours[k]}$', colours[k], size=16)
        if k:
            start, end = x - width + radius + 7, x - radius - 3
            short = max(0, (end - start - 26) / 2)
            drawing.arrow(at(end - short, 4), at(start + short, 4), 'muted')
            letter, axis = ('N' if kind == 'space' else colours[k - 1]), turns[k - 1][0]
            # The frames on the way of the second chain have no names.
            name = axis if letter == 'muted' else rf'\hat{{{letter.lower()}}}_{axis}'
            drawing.label(at((start + end) / 2, -8), f'${name}$', size=15)
