"""The answer: what two programs mean differently by the numbers
that they give for the same poses.
"""

import functools
import itertools
import math
from typing import NamedTuple

import numpy as np

from orientation import dcm_from_axis_angle, nearest_dcm, random_orientations

from ..programs import expected_of, program_named
from . import search, table
from .meaning import dcms_from_numbers, numbers_from_dcms
from .mounting import mountings
from .text import Poses, read_poses

#: Of so many chains, and of so many readings of the first side, it is seen whether a further pose
#: tells the chains apart; more are told apart by a pose of three turns.
LOOKED_AT, READ_AS = 300, 60


class Explanation(NamedTuple):
    """What :func:`explain` found.

    ``verdict`` is ``'same'``, ``'named'``, ``'undecided'`` or ``'unrelated'``. ``chains`` holds one
    chain for each reading of the numbers that is left, simplest first, and ``faults`` the words of
    the first. ``further_pose`` says which pose would decide between them, and is empty where
    nothing is open. ``residual`` is what is left by the first chain, in degrees. ``mirrored`` names
    the side, ``'first'`` or ``'second'``, whose matrix has the determinant -1 where the other's has
    not; else it is empty.
    """

    verdict: str
    faults: tuple[str, ...]
    residual: float | None
    chains: tuple
    further_pose: str
    poses: int
    mirrored: str

    def __str__(self) -> str:
        return "\n".join(sentences(self))


def explain(
    first,
    second,
    *,
    first_declared: dict | None = None,
    second_declared: dict | None = None,
    first_program: str | None = None,
    second_program: str | None = None,
    noise: float = 0.0,
) -> Explanation:
    """Name the mix-up between two programs from the numbers that they give for the same poses.

    Parameters
    ----------
    first, second : str, or array of shape ``(count,)``, ``(3, 3)`` or ``(poses, ...)``
        What each program gives. Text is read by its digits: what the last one leaves open counts as
        rounding. Numbers as such are taken to be exact to single precision.
    first_declared, second_declared : dict, optional
        What is known of a program, such as ``{'kind': 'Euler angles', 'sequence': 'zyx'}``: the
        groups and choices of :data:`orientation_workbench.mismatch.table.KINDS`.
    first_program, second_program : str, optional
        Names of :data:`orientation_workbench.programs.PROGRAMS`, or a part of one. What a program's
        manual says of its numbers is no mix-up then; if both are named, neither is what their
        manuals differ by.
    noise : float
        Radians by which the two may differ besides rounding.

    Returns
    -------
    Explanation

    Raises
    ------
    ValueError
        If numbers cannot be read as orientations, the two sides hold different numbers of poses, or
        a program is not known.

    Examples
    --------
    >>> from orientation_workbench import explain
    >>> explain('0.7304 0.3604 0.2402 0.5284', '0.3604 0.2402 0.5284 0.7304').faults
    ('in the second numbers the scalar part stands last (x, y, z, w)',)
    """
    sides, programs = [], []
    for name, given, declared, program in (
        ("first", first, first_declared, first_program),
        ("second", second, second_declared, second_program),
    ):
        declared = declared or {}
        poses = (
            given
            if isinstance(given, Poses)
            else read_poses(given, name, declared.get("kind"), noise)
        )
        manual = expected_of(program_named(program)) if program else None
        if manual and "kind" not in declared and len(poses.kinds) == 2:
            poses = poses._replace(kinds=(manual["three numbers"],))
        programs.append(manual)
        # What stands in the text goes before what the manual says, and
        # what the reader says before both.
        sides.append((poses, (manual["declared"] if manual else {}) | poses.declared | declared))
    counts = [len(poses.numbers) for poses, _ in sides]
    # Three rows that are no matrix were taken for three triples of angles.
    if sorted(counts) == [1, 3]:
        side = counts.index(3)
        given = (first, second)[side]
        sides[side] = (
            read_poses(given, ("first", "second")[side], "matrix", noise),
            sides[side][1],
        )
        counts[side] = 1
    if counts[0] != counts[1]:
        raise ValueError(
            f"the first side holds {counts[0]} poses and the second {counts[1]}: they must be the "
            "same poses, in order"
        )
    one, other = (
        search.side(poses.kinds, poses.numbers, poses.half, declared) for poses, declared in sides
    )
    expected = table.expected_relation(*programs, [poses.kinds[0] for poses, _ in sides])
    chains, tried = search.chains(one, other, noise, expected)
    classes = _classes(chains, sides) or mountings(one, other, noise)[:1]
    readings = list({id(chain.first): chain.first for chain in chains}.values())
    return _verdict(classes, readings, one, other, sides, tried, noise)


def _verdict(classes, readings, one, other, sides, tried, noise):
    poses = len(sides[0][0].numbers)
    hands = [np.linalg.det(side.dcms[0, 0]) > 0 for side in (one, other)]
    mirrored = "" if hands[0] == hands[1] else ("first", "second")[hands.index(False)]
    if not classes:
        return Explanation("unrelated", (), None, (), "", poses, mirrored)
    best = classes[0]
    tolerance = max(one.doubts[0] + other.doubts[0], search.SINGLE_PRECISION) + noise
    expected = tried * min(1.0, (1.5 * tolerance) ** 3 / (6 * math.pi)) ** poses
    decided = len(classes) == 1 and (best.faults == 0 or expected < search.BY_CHANCE)
    verdict = "same" if best.faults == 0 else "named" if decided else "undecided"
    further = "" if decided else _further_pose(classes, readings, sides)
    residual = math.degrees(2 * math.asin(min(1.0, best.residual / 2)))
    return Explanation(
        verdict, tuple(best.words()), residual, tuple(classes), further, poses, mirrored
    )


# --- which chains say the same --------------------------------------------------------------------


def _classes(chains, sides):
    """Of chains that do the same to whatever is pasted, the simplest; simplest first."""
    found, seen = [], set()
    samples = {
        kind: _samples(kind, sides[0][0]) for kind in {chain.first["kind"] for chain in chains}
    }
    for chain, keys in zip(chains, _predictions(chains, samples, 5)):
        if seen.isdisjoint(keys):
            found.append(chain)
            seen.update(keys)
    return found


def _predictions(chains, samples, decimals):
    """What each chain predicts that the second side gives where the first
    gives these numbers, as sets of keys.

    Two chains that share a key are mathematically the same, if the numbers are not special: both
    may print the same (an orientation has two triples of Euler angles, and either may be printed).
    What the second side would write is read by one plain reading, whichever reading the chain has:
    that makes the keys comparable.
    """
    dcms, members = {}, {}
    for which, chain in enumerate(chains):
        if (reading := id(chain.first)) not in dcms:
            dcms[reading] = dcms_from_numbers(chain.first, samples[chain.first["kind"]])
        members.setdefault(id(chain.second), []).append(which)
    keys = [None] * len(chains)
    for those in members.values():
        second = chains[those[0]].second
        predicted = np.concatenate(
            [_related(chains[which].relation, dcms[id(chains[which].first)]) for which in those]
        )
        plain = _plain_reading(second["kind"])
        rounded = [
            (
                np.round(dcms_from_numbers(plain, numbers).reshape(len(those), -1, 9), decimals)
                + 0.0
            ).tolist()
            for numbers in numbers_from_dcms(second, predicted)
        ]
        for place, which in enumerate(those):
            each_sample = zip(
                *([tuple(entries) for entries in written[place]] for written in rounded)
            )
            kinds = (chains[which].first["kind"], second["kind"])
            keys[which] = {(kinds, *combined) for combined in itertools.product(*each_sample)}
    return keys


def _related(relation, dcms):
    """The second side's orientations, by signed axes, of the first side's."""
    left, right = (
        np.array(table.axes_matrix(relation["body"])),
        np.transpose(table.axes_matrix(relation["world"])),
    )
    return left @ (np.swapaxes(dcms, -1, -2) if relation["inverse"] else dcms) @ right


def _plain_reading(kind):
    groups = {group["group"] for group in table.KINDS[kind]}
    choices = table.BOOK | {"sequence": "zyx"}
    return {"kind": kind, "choices": {name: choices[name] for name in groups}}


def _samples(kind, poses):
    """Numbers of one kind for two orientations, neither of them special."""
    dcms, plain = _generic_dcms(), _plain_reading(kind)
    if kind == "matrix" and np.linalg.det(poses.numbers[0].reshape(3, 3)) < 0:
        dcms = -dcms
    if poses.large and "unit" in plain["choices"]:
        plain["choices"]["unit"] = "degrees"
    return numbers_from_dcms(plain, dcms)[0]


@functools.cache
def _generic_dcms():
    return random_orientations(2, np.random.default_rng(20))


# --- the pose that decides ------------------------------------------------------------------------


def _further_pose(chains, readings, sides):
    """Words for a pose, from the last one pasted, at which the chains that are left would disagree.

    Whichever chain is true, the thing is turned as the words say; what the first program then gives
    depends on how its numbers are to be read. So the pose must decide by each reading of the first
    side that fits, also by those that say the same as another.
    """
    if len(chains) > LOOKED_AT or len(readings) > READ_AS:
        return table.FURTHER_POSES[-1][0]
    for words, turns in table.FURTHER_POSES:
        if all(
            _tells_apart(chains, _turned(reading, sides[0][0].numbers[-1:], turns))
            for reading in readings
        ):
            return words
    return table.FURTHER_POSES[-1][0]


def _turned(reading, numbers, turns):
    """What the first program gives after some turns about the body's own
    axes, by one reading of its numbers.
    """
    dcm = dcms_from_numbers(reading, numbers)[0]
    hand = 1.0 if np.linalg.det(dcm) > 0 else -1.0
    dcm = nearest_dcm(hand * dcm).dcm
    for axis, angle in turns:
        dcm = (
            dcm_from_axis_angle([float(axis == name) for name in "xyz"], math.radians(angle)) @ dcm
        )
    return {reading["kind"]: numbers_from_dcms(reading, hand * dcm[None])[0]}


def _tells_apart(chains, samples):
    keys = _predictions([chain for chain in chains if chain.first["kind"] in samples], samples, 2)
    return len(set().union(*keys)) == sum(map(len, keys))


# --- in words -------------------------------------------------------------------------------------


def sentences(explanation):
    """The answer as a reader is told it, a sentence a line."""
    several = f"these {explanation.poses} poses" if explanation.poses > 1 else "this pose"
    left = len(explanation.chains)
    more = f"{left - 1} other reading{'s' * (left != 2)}"
    if explanation.verdict == "unrelated":
        yield (
            f"These are not the same motion: no mix-up of up to {table.MOST_FAULTS} faults "
            f"explains {several}."
        )
        if explanation.mirrored:
            yield (
                f"The {explanation.mirrored} side's matrix has the determinant -1: a mirror image, "
                "and no rotation."
            )
        return
    if explanation.verdict == "same":
        yield "Both sides give the same orientation" + (f" in {several}." if left > 1 else ".")
    elif explanation.verdict == "named":
        yield "The two sides differ by " + _count(explanation.faults) + ":"
    else:
        yield (
            f"The numbers cannot decide. The simplest reading of {several} is "
            + _count(explanation.faults)
            + ":"
        )
    for fault in explanation.faults:
        yield f"- {fault}"
    if explanation.residual > 1e-3:
        yield f"What is left then is {explanation.residual:.2g} degrees."
    if explanation.further_pose:
        if left > 1:
            yield f"{more[0].upper()}{more[1:]} fit{'s' * (left == 2)} as well."
        yield f"To decide, {explanation.further_pose}, and paste that pose as well."


def _count(faults):
    return "one mix-up" if len(faults) == 1 else f"{len(faults)} mix-ups"
