"""Deciding whether two orientations are the same, and naming the mix-up when they are not.

Everything is decided by numbers, at random values of the symbols: an algebraic simplification can
take seconds, or not come back at all.
"""

import itertools
import math
import random
from typing import NamedTuple

from ._kinds import TOLERANCE, is_symbolic
from .direction_cosines import demand_dcm
from .euler_angles import SEQUENCES, dcm_from_body_fixed, dcm_from_space_fixed
from .quaternions import multiply_quaternions

#: Random values that each symbol is given.
POINTS = 4


def _unknowns(values):
    """Symbols and functions of time in the values, grouped by name."""
    import sympy
    from sympy.core.function import AppliedUndef
    names = {}
    for value in values:
        expression = value if hasattr(value, 'atoms') else sympy.Matrix(value)
        functions = expression.atoms(AppliedUndef)
        hidden = set().union(*(function.free_symbols for function in functions))
        for atom in functions | (expression.free_symbols - hidden):
            names.setdefault(getattr(atom, 'name', None) or atom.func.__name__, set()).add(atom)
    return dict(sorted(names.items()))


def _draw(names):
    """Values for every name: a dictionary for each point, the same ones on every call."""
    source = random.Random(20)
    return [{name: source.uniform(0.2, 1.3) * source.choice((1, -1)) for name in names}
            for _ in range(POINTS)]


def _put_in(value, names, points):
    """Complex array of shape ``(points, ...)`` of a value at the points."""
    import numpy
    import sympy
    if not is_symbolic(value):
        array = numpy.asarray(value, dtype=complex)
        return numpy.broadcast_to(array, (len(points), *array.shape))
    matrix = value if hasattr(value, 'shape') else sympy.Matrix(value)
    shape = matrix.shape if 1 not in matrix.shape else (len(matrix),)
    results = []
    for point in points:
        numbers = {atom: sympy.Float(point[name]) for name, atoms in names.items() for atom in atoms}
        results.append([complex(sympy.sympify(entry).xreplace(numbers).evalf()) for entry in matrix])
    return numpy.array(results).reshape(len(points), *shape)


def values_at_random_points(*values):
    """Complex arrays of shape ``(points, ...)``: the values where their symbols are random numbers."""
    names = _unknowns([value for value in values if is_symbolic(value)])
    points = _draw(names)
    return [_put_in(value, names, points) for value in values]


def _close(first, second, tolerance=TOLERANCE):
    return bool(abs(first - second).max() <= tolerance)


def _up_to_sign(first, second, tolerance=TOLERANCE):
    """Quaternions: the sign of each one is free."""
    sign = ((first * second.conj()).sum(axis=-1).real >= 0) * 2 - 1
    return _close(first, sign[..., None] * second, tolerance)


def same_orientation(first, second, tolerance=TOLERANCE):
    """Tell whether two direction cosine matrices, or two quaternions, are the same orientation.

    Symbols are compared by name, so that ``theta`` with and without assumptions, or as a function of
    time, are one angle. The two quaternions :math:`q` and :math:`-q` are the same orientation.

    Parameters
    ----------
    first, second : SymPy matrices or arrays of shape ``(..., 3, 3)``, or both ``(4,)`` or ``(..., 4)``
    tolerance : float
        Largest difference between two entries that counts as rounding.

    Returns
    -------
    bool

    Raises
    ------
    ValueError
        If one is a matrix and the other a quaternion, or the shapes are neither.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import same_orientation, simple_dcm
    >>> a, b = sm.symbols('a, b')
    >>> same_orientation(simple_dcm('z', a) * simple_dcm('z', b), simple_dcm('z', a + b))
    True
    """
    first, second = values_at_random_points(first, second)
    return _comparison_for(first, second)(first, second, tolerance)


def _comparison_for(first, second):
    if first.shape[-2:] == second.shape[-2:] == (3, 3):
        return _close
    if first.shape[-1] == second.shape[-1] == 4 and first.shape[-2:] != (3, 3):
        return _up_to_sign
    raise ValueError(f'shapes {first.shape[1:]} and {second.shape[1:]} cannot be compared: give two '
                     f'direction cosine matrices (3, 3), or two quaternions (4,)')


class Diagnosis(NamedTuple):
    """What :func:`diagnose` found: whether the answer is right, and every mix-up that explains it."""

    same: bool
    causes: tuple

    def __str__(self):
        if self.same:
            return 'The same orientation.'
        if not self.causes:
            return 'Not the same orientation, and none of the usual mix-ups.'
        if len(self.causes) == 1:
            return f'Not the same orientation: {self.causes[0]}.'
        return ('Not the same orientation. These mix-ups are mathematically the same here: '
                + '; or '.join(self.causes) + '.')


def diagnose(given, expected, angles=None, sequence=None):
    """Say whether an orientation is the expected one and, if it is not, which mix-up explains it.

    A mix-up is named only if it reproduces the given answer at every random value of the symbols. If
    several do, they are mathematically the same for this answer, and all of them are named.

    Parameters
    ----------
    given, expected : direction cosine matrices of shape ``(3, 3)``, or quaternions of shape ``(4,)``
        Symbols or numbers.
    angles, sequence : optional
        The Euler angles and the body fixed sequence that ``expected`` is made of. For a symbolic
        matrix of up to three angles they are recognised without being given.

    Returns
    -------
    Diagnosis
        ``same``, and ``causes``: a tuple of sentences. As a string, one message.

    Examples
    --------
    >>> import sympy as sm
    >>> from orientation import diagnose, dcm_from_body_fixed, dcm_from_space_fixed
    >>> angles = sm.symbols('psi, theta, varphi')
    >>> expected = dcm_from_body_fixed(angles, 'zxy')
    >>> print(diagnose(expected.T, expected))
    Not the same orientation: it is the transpose, the orientation the other way round.
    >>> diagnose(dcm_from_space_fixed(angles, 'zxy'), expected).causes
    ('the matrices are multiplied in the other order, which is space fixed',)
    """
    names = _unknowns([value for value in (given, expected, angles) if is_symbolic(value)])
    points = _draw(names)
    given_values, expected_values = (_put_in(value, names, points) for value in (given, expected))
    matches = _comparison_for(given_values, expected_values)
    if matches(given_values, expected_values):
        return Diagnosis(True, ())
    if matches is _close:
        # A reflection cannot come from a turn, so its faults are told first and alone.
        candidates = itertools.chain(
            [('it is the transpose, the orientation the other way round', expected_values.swapaxes(1, 2))],
            _substitution_mixups(expected, names, points),
            _sequence_mixups(expected_values, names, points, angles, sequence))
        fault = _matrix_fault(given_values)
    else:
        candidates = _quaternion_mixups(expected_values)
        fault = _quaternion_fault(given_values)
    if fault:
        return Diagnosis(False, (fault,))
    causes = [cause for cause, values in candidates if matches(given_values, values)]
    return Diagnosis(False, tuple(dict.fromkeys(causes)))


def _matrix_fault(values):
    try:
        demand_dcm(values.real, where='', name='it')
    except ValueError as error:
        return str(error)
    return None


def _quaternion_fault(values):
    lengths = (abs(values)**2).sum(axis=-1)**0.5
    worst = lengths[abs(lengths - 1).argmax()]
    return f'its length is {worst:.6g}, not 1' if abs(worst - 1) > TOLERANCE else None


def _substitution_mixups(expected, names, points):
    """Mix-ups of the angles' signs, places and units in a symbolic matrix."""
    if not is_symbolic(expected):
        return

    def with_changes(change):
        return _put_in(expected, names, [{**point, **change(point)} for point in points])

    for name in names:
        yield f'the angle {name} has the wrong sign', with_changes(lambda p: {name: -p[name]})
    for first, second in itertools.combinations(names, 2):
        yield (f'the angles {first} and {second} have changed places',
               with_changes(lambda p: {first: p[second], second: p[first]}))
    for group in {tuple(names): None, **{(name,): None for name in names}}:
        those = ', '.join(group)
        yield (f'degrees were put in for {those} where radians are expected',
               with_changes(lambda p: {name: p[name] * 180 / math.pi for name in group}))
        yield (f'{those} was turned from degrees to radians once too often',
               with_changes(lambda p: {name: p[name] * math.pi / 180 for name in group}))


def _sequence_mixups(expected_values, names, points, angles, sequence):
    """Mix-ups of a body fixed sequence, given or recognised."""
    if angles is not None:
        values = _put_in(angles, names, points).real
    else:
        values, sequence = _recognise(expected_values, names, points)
    if sequence is None:
        return
    yield ('the matrices are multiplied in the other order, which is space fixed',
           dcm_from_space_fixed(values, sequence))
    if angles is None and len(names) < 3:
        return
    yield 'the angles are in reverse order', dcm_from_body_fixed(values[:, ::-1], sequence)
    for other in SEQUENCES:
        if other != sequence:
            yield f'it is the sequence {other}, not {sequence}', dcm_from_body_fixed(values, other)
    if not names:
        for which, signs in (('first', (-1, 1, 1)), ('second', (1, -1, 1)), ('third', (1, 1, -1))):
            yield (f'the angle of the {which} turn has the wrong sign',
                   dcm_from_body_fixed(values * signs, sequence))
        yield ('degrees were put in where radians are expected',
               dcm_from_body_fixed(values * 180 / math.pi, sequence))
        yield ('the angles were turned from degrees to radians once too often',
               dcm_from_body_fixed(values * math.pi / 180, sequence))


def _recognise(expected_values, names, points):
    """Find the sequence and the signed angles that make the expected matrix out of its symbols."""
    import numpy
    if not 1 < len(names) <= 3:
        return None, None
    values = numpy.array([[point[name] for name in names] + [0.0] * (3 - len(names)) for point in points])
    orders = [values[:, order] * signs for order in itertools.permutations(range(3))
              for signs in itertools.product((1, -1), repeat=3)]
    for sequence in SEQUENCES:
        found = abs(dcm_from_body_fixed(numpy.array(orders), sequence) - expected_values).max(axis=(1, 2, 3))
        if found.min() <= TOLERANCE:
            return orders[int(found.argmin())], sequence
    return None, None


def _quaternion_mixups(expected):
    import numpy
    conjugate = expected * [1, -1, -1, -1]
    yield 'the scalar part stands last; in this book it stands first', numpy.roll(expected, -1, axis=-1)
    yield 'it is the conjugate, the orientation the other way round', conjugate
    yield ('it is the conjugate, and the scalar part stands last; in this book it stands first',
           numpy.roll(conjugate, -1, axis=-1))
    yield ('the angle was not halved: a quaternion holds the cosine and sine of half the angle',
           multiply_quaternions(expected.real, expected.real))
