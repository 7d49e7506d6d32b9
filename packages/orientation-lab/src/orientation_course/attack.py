"""What an attack tries for answers that are orientations: turns about the
axes, in every order, axis and sign.
"""

import itertools
import math

import numpy as np

from coursework.authoring.attack import Family, of_pools, of_words, one_sign, size_of
from coursework.checking.reading import calls_for

#: To be raised when what is tried gets better: what was measured before is measured again then.
VERSION = 2


def families(public, at):
    """The generators of candidates for a question, in the order in which they are tried."""
    kind = public.kind
    if kind == "sequence":
        yield of_words(
            "all sequences", ["xyz"] * 3, "".join, lambda word: word[0] != word[1] != word[2]
        )
    elif kind == "function":
        yield from _of_library(public)
        yield from _of_chains(public)
    elif kind in ("direction cosine matrix", "Euler angles", "axis and angle"):
        yield from _of_orientations(public, at, _dcm_of, 9)
    elif kind == "quaternion":
        yield from _of_orientations(public, at, lambda quaternions: quaternions, 4)
        yield from of_pools(public, at, 4)
    elif kind == "matrix" and public.shape == (3, 3):
        yield from _of_orientations(public, at, _dcm_of, 9)
    elif kind == "vector" and public.length in (None, 3):
        yield from _of_rates(public, at)
        yield from _of_turned(public, at)


# Orientations: products of turns about the axes. A turn is an axis and an angle at each point.


def _of_orientations(public, at, build, size):
    def family(name, sizes, quaternions):
        """A family whose candidates are quaternions, shape (candidates, points, 4)."""
        return Family(
            name,
            sizes,
            lambda choices: one_sign(
                public, build(quaternions(choices)).reshape(len(choices), -1), size
            ),
        )

    symbols = np.array([at.values[name] for name in at.angular]).reshape(
        len(at.angular), len(at.ones)
    )
    if at.angular:
        yield family("turns about the axes through the symbols", *_turns_of(at, symbols))
        yield family("the same, one of them from a quarter turn on", *_shifted(at, symbols))
        yield family("the same with half turns of the frames", *_reframed(at, symbols[:2]))
        yield family("the same and a special angle", *_turns_of(at, symbols, at.constants(15)))
        yield family(
            "the same and two special angles",
            *_turns_of(at, symbols[:2], at.constants(30), at.constants(90)),
        )
        return
    fine, coarse = at.constants(5), at.constants(15)
    yield family("one turn about a special axis", *_special_axes(fine))
    yield family(
        "two turns through given or special angles",
        *_turns_of(at, np.zeros((0, len(at.ones))), coarse, coarse),
    )
    yield family(
        "three turns through special angles",
        *_turns_of(at, np.zeros((0, len(at.ones))), *[at.constants(45)] * 3),
    )


def _about(axis, angles):
    """Quaternions of turns about the axes x, y, z (given by number), scalar first."""
    found = np.zeros((*angles.shape, 4))
    found[..., 0] = np.cos(angles / 2)
    np.put_along_axis(
        found[..., 1:],
        np.broadcast_to(
            axis.reshape(-1, *[1] * angles.ndim)[: len(angles)].reshape(
                len(angles), *[1] * angles.ndim
            ),
            (*angles.shape, 1),
        ),
        np.sin(angles / 2)[..., None],
        axis=-1,
    )
    return found


def _times(first, second):
    a, b, c, d = np.moveaxis(first, -1, 0)
    e, f, g, h = np.moveaxis(second, -1, 0)
    return np.stack(
        [
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ],
        axis=-1,
    )


def _turns_of(at, symbols, *constants):
    """Turns through every symbol once, and through one of each list of
    constants, in every order, axis and sign.
    """
    count = len(symbols) + len(constants)
    orders = np.array(list(itertools.permutations(range(count)))[:120])
    sizes = (len(orders), *[3] * count, *[2] * len(symbols), *map(len, constants))

    def quaternions(choices):
        order, axes = orders[choices[:, 0]], choices[:, 1 : 1 + count]
        signs = 1 - 2 * choices[:, 1 + count : 1 + count + len(symbols)]
        which = choices[:, 1 + count + len(symbols) :]
        angles = [symbols[k] * signs[:, k, None] for k in range(len(symbols))]
        angles += [constant[which[:, k]] for k, constant in enumerate(constants)]
        angles = np.stack(
            [np.broadcast_to(part, (len(choices), len(at.ones))) for part in angles], axis=1
        )
        result = None
        for place in range(count):
            angle = np.take_along_axis(angles, order[:, place, None, None], axis=1)[:, 0]
            turn = _about(axes[:, place], angle)
            result = turn if result is None else _times(result, turn)
        return result

    return sizes, quaternions


def _shifted(at, symbols):
    """Turns through the symbols, of which one begins at a quarter turn, or at half a turn."""
    inner, _ = _turns_of(at, symbols)
    shifts = np.array([math.pi / 2, -math.pi / 2, math.pi])
    ways = [
        _turns_of(at, symbols + shift * np.eye(len(symbols))[:, which, None])[1]
        for which in range(len(symbols))
        for shift in shifts
    ]

    def quaternions(choices):
        found = np.zeros((len(choices), len(at.ones), 4))
        for number, way in enumerate(ways):
            rows = choices[:, 0] == number
            found[rows] = way(choices[rows, 1:])
        return found

    return (len(ways), *inner), quaternions


def _reframed(at, symbols):
    """Turns with the frames named otherwise: one of the 24 quarter
    turns of a cube before and after.
    """
    inner, turned = _turns_of(at, symbols)
    cube = _cube()

    def quaternions(choices):
        middle = turned(choices[:, 2:])
        before, after = cube[choices[:, 0]][:, None], cube[choices[:, 1]][:, None]
        return _times(_times(before, middle), after)

    return (24, 24, *inner), quaternions


def _cube():
    quarter = [
        np.array([math.cos(math.pi / 4), *(math.sin(math.pi / 4) * np.eye(3)[k])]) for k in range(3)
    ]
    found = [np.array([1.0, 0, 0, 0])]
    for one in found:
        for turn in quarter:
            other = _times(one, turn)
            if not any(abs(abs(other @ known) - 1) < 1e-9 for known in found):
                found.append(other)
    return np.array(found)


def _special_axes(angles):
    axes = [
        axis
        for axis in itertools.product(range(-3, 4), repeat=3)
        if any(axis) and math.gcd(*axis) == 1
    ]
    axes.sort(key=lambda axis: (sum(map(abs, axis)), axis))
    axes = np.array([np.array(axis) / np.linalg.norm(axis) for axis in axes])

    def quaternions(choices):
        half = angles[choices[:, 1]] / 2
        axis = axes[choices[:, 0]][:, None, :]
        return np.concatenate([np.cos(half)[..., None], np.sin(half)[..., None] * axis], axis=-1)

    return (len(axes), len(angles)), quaternions


def _dcm_of(quaternions):
    a, b, c, d = np.moveaxis(quaternions, -1, 0)
    return np.stack(
        [
            a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c),
            2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b),
            2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d,
        ],
        axis=-1,
    )  # fmt: skip


def _of_turned(public, at):
    """Components that turns of the frame give of a vector along an axis."""
    symbols = np.array([at.values[name] for name in at.angular]).reshape(
        len(at.angular), len(at.ones)
    )
    others = [name for name in at.symbols if name not in at.angular]
    scales = [at.ones, *(at.values[name] for name in others)]
    scales += [at.values[a] * at.values[b] for a, b in itertools.combinations(others, 2)]
    scales += [number * at.ones for number in at.given if number]
    scales = np.array(scales)
    if not at.angular:
        inner, turned = _turns_of(at, symbols, at.constants(15))
    else:
        inner, turned = _turns_of(at, symbols)

    def evaluate(choices):
        dcm = _dcm_of(turned(choices[:, 3:])).reshape(len(choices), -1, 3, 3)
        column = np.take_along_axis(dcm, choices[:, 1, None, None, None], axis=3)[..., 0]
        numbers = (1 - 2 * choices[:, 2, None, None]) * scales[choices[:, 0]][..., None] * column
        return one_sign(public, numbers.reshape(len(choices), -1), 3)

    yield Family("a unit vector, turned", (len(scales), 3, 2, *inner), evaluate)


def _of_rates(public, at):
    """Angular velocities of frames turned one after another, through the symbols
    whose rates are among the question's.
    """
    names = [name for name in at.angular if f"{name}'" in at.symbols]
    if not names:
        return
    count = len(names)
    angles, rates = (
        np.array([at.values[f"{name}{end}"] for name in names]).reshape(count, -1)
        for end in ("", "'")
    )
    orders = np.array(list(itertools.permutations(range(count)))[:120])

    def evaluate(choices):
        order, axes = orders[choices[:, 1]], choices[:, 2 : 2 + count]
        signs = 1 - 2 * choices[:, 2 + count :]
        omega = np.zeros((len(choices), len(at.ones), 3))
        dcm = np.broadcast_to(np.eye(3), (*omega.shape, 3))
        for place in range(count):
            which = order[:, place]
            sign = np.take_along_axis(signs, which[:, None], axis=1)
            turn = _dcm_of(_about(axes[:, place], sign * angles[which])).reshape(dcm.shape)
            omega = (turn @ omega[..., None])[..., 0]
            omega += (sign * rates[which])[..., None] * np.eye(3)[axes[:, place]][:, None]
            dcm = turn @ dcm
        along_the_first = (np.swapaxes(dcm, -1, -2) @ omega[..., None])[..., 0]
        numbers = np.where(choices[:, :1, None] == 0, omega, along_the_first)
        return one_sign(public, numbers.reshape(len(choices), -1), 3)

    sizes = (2, len(orders), *[3] * count, *[2] * count)
    yield Family("the angular velocity of turns", sizes, evaluate)


def _of_library(public):
    """What the functions of the library give for the arguments, in any order of them."""
    import orientation

    calls, size = calls_for(public), size_of(public)
    candidates = []
    for name in orientation.__all__:
        function = getattr(orientation, name)
        if callable(function) and name[0].islower():
            for order in itertools.permutations(range(len(calls[0]))):
                rows = []
                try:
                    for arguments in calls:
                        rows.append(
                            np.asarray(
                                function(*(arguments[place] for place in order)), dtype=float
                            ).ravel()
                        )
                except Exception:
                    continue
                if all(len(row) == size for row in rows):
                    candidates += [np.array(rows), -np.array(rows)]
                    if size == 9:
                        candidates += [np.array([row.reshape(3, 3).T.ravel() for row in rows])]
                    if size == 4:
                        candidates += [np.array(rows) * [1, -1, -1, -1], np.roll(rows, -1, axis=1)]
    if candidates:
        table = np.array(candidates).reshape(len(candidates), -1)
        if size == 4:
            table = one_sign(public, table, 4)
        yield Family(
            "functions of the library", (len(table),), lambda choices: table[choices[:, 0]]
        )


#: Which of a list of turns are made. Not all of them: a loop over the turns is what such a question
#: asks for, and who writes it has solved it. Tried is what one gets without.
SOME = (slice(1), slice(-1, None), slice(1, 2), slice(2), slice(-2, None), slice(0, None, 2))


def _of_chains(public):
    """Where the argument is a list of turns, each an axis and an angle: what some
    of them give, one after another.
    """
    size = size_of(public)
    calls = [_turns_in(call) for call in calls_for(public)]
    if None in calls or size not in (4, 9):
        return

    def evaluate(choices):
        found = []
        for other_order, degrees, half, backwards, added, some in choices.tolist():
            row = []
            for turns in calls:
                whole = np.array([1.0, 0, 0, 0])
                some_turns = turns[SOME[some]]
                if added:  # all angles together, about the axis of the first of them
                    some_turns = (
                        [(some_turns[0][0], sum(angle for _, angle in some_turns))]
                        if some_turns
                        else []
                    )
                for axis, angle in some_turns:
                    angle = (
                        (math.radians(angle) if degrees else angle)
                        * (-1 if backwards else 1)
                        / (2 if half else 1)
                    )
                    turn = np.array([math.cos(angle / 2), *(math.sin(angle / 2) * axis)])
                    whole = _times(turn, whole) if other_order else _times(whole, turn)
                row.append(_dcm_of(whole).reshape(9) if size == 9 else whole)
            found.append(np.concatenate(row))
        return one_sign(public, np.array(found), size)

    yield Family("some of the turns", (2, 2, 2, 2, 2, len(SOME)), evaluate)


def _turns_in(call):
    """The axes, as unit vectors, and the angles of a call whose one
    argument is a list of them; or ``None``.
    """
    if len(call) != 1 or not isinstance(call[0], list):
        return None
    turns = []
    for one in call[0]:
        if not isinstance(one, list) or len(one) != 2 or not isinstance(one[1], (int, float)):
            return None
        axis = (
            np.eye(3)["xyz".index(one[0])]
            if one[0] in ("x", "y", "z")
            else np.array(one[0], dtype=float)
        )
        if axis.shape != (3,):
            return None
        turns.append((axis / np.linalg.norm(axis), one[1]))
    return turns
