"""Search for every chain of at most three faults that explains the numbers, simplest first."""

import functools
import itertools
import math
from typing import NamedTuple

import numpy as np

from orientation import (
    PROPER_EULER,
    SEQUENCES,
    body_fixed_from_dcm,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    nearest_dcm,
    quaternion_from_dcm,
    random_orientations,
)

from . import table
from .meaning import dcms_from_numbers, doubt

#: The rounding error of a single-precision computation whose digits are all printed.
SINGLE_PRECISION = 2e-6
#: How many readings of the second side are compared at a time.
BLOCK = 200
#: A chain is named only if fewer than this many are expected to fit unrelated numbers by chance.
BY_CHANCE = 1e-3
#: More chains than these add no information.
MANY = 500
#: The bit for scalar-last order, which both sides of a quaternion may share.
QUATERNION_SHARED = 1 << table.SHARED.index(("order", "xyzw"))
#: A reading counts only if the motion is at least this many times the uncertainty of the numbers.
MOTION = 3


class Chain(NamedTuple):
    """One explanation: how to read each side, and how their orientations are related."""

    first: dict
    second: dict
    relation: dict
    faults: int
    rarity: float
    residual: float

    @property
    def cost(self):
        """One for each fault, plus their rarity, rounded to ignore the errors of addition."""
        return round(self.faults + self.rarity, 6)

    @property
    def kinds(self):
        return self.first["kind"], self.second["kind"]

    def words(self, ways=(None, None), which=0):
        """Return the faults as phrases; ``which`` chooses if body and world may be swapped."""
        *_, sides = table.of_both(self.first, self.second)
        swapped = table.second_is_inverse(self.relation, self.kinds, ways)
        return sides + table.words_of(self.relation, self.kinds, swapped[which])


@functools.cache
def _relations(mirrored, expected):
    """Return the relations relative to the expected one, with their matrices as stacks."""
    aside = table.left_handed(expected[1]) != table.left_handed(expected[2])
    entries = [table.beyond(entry, expected) for entry in table.relations(mirrored != aside)]
    left = np.array([table.axes_matrix(entry["body"]) for entry in entries], float)
    right = np.array([np.transpose(table.axes_matrix(entry["world"])) for entry in entries], float)
    inverse = np.array([entry["inverse"] for entry in entries])
    faults = np.array([entry["faults"] for entry in entries])
    return entries, left, right, inverse, faults


class Side(NamedTuple):
    """One side in the search: its readings, their matrices at each pose, and their doubt."""

    readings: list
    dcms: np.ndarray
    doubts: np.ndarray


def side(kinds, numbers, half, declared, noise):
    """Read the numbers of one side in every possible way.

    Parameters
    ----------
    kinds : sequence of str
        The possible kinds of the numbers.
    numbers : array of shape ``(poses, count)``
    half : float
        Half a unit of the last digit printed.
    declared : dict
        What is known about the program's convention.
    noise : float
        Radians by which the two sides may differ.
    """
    listed = []
    for kind in kinds:
        # Of an axis and its angle, in either order, only the angle can be large.
        large = kind != "quaternion" and bool((np.abs(numbers) > math.tau + 0.01).any())
        listed += table.readings(kind, declared, large)
    cheapest = {}
    for reading in listed:
        key = _reading_key(reading)
        if key not in cheapest or _price(reading) < _price(cheapest[key]):
            cheapest[key] = reading
    readings = sorted(cheapest.values(), key=_price)
    dcms = np.stack([dcms_from_numbers(reading, numbers) for reading in readings])
    doubts = np.array([doubt(reading, half) for reading in readings])
    if not noise:
        return Side(readings, dcms, doubts)
    # Small angles read as degrees hardly move, and within the noise anything fits them.
    moves = np.array([motion(each) for each in dcms])
    some = moves >= MOTION * (doubts + noise)
    # Refuse the input if this would exclude a reading that is not a fault, or one that both sides
    # may share.
    if any(
        not enough and (reading["faults"] == 0 or reading["shared"] & QUATERNION_SHARED)
        for reading, enough in zip(readings, some, strict=True)
    ):
        raise ValueError(
            f"the tolerance is {math.degrees(noise):.3g} degrees, but the numbers describe a "
            f"rotation of only {math.degrees(moves.min()):.3g} degrees, too small to judge. Give "
            "larger rotations, or a smaller tolerance"
        )
    return Side([each for each, fits in zip(readings, some) if fits], dcms[some], doubts[some])


def motion(dcms):
    """Return the largest angle of rotation in some poses, in radians, whatever their handedness."""
    hand = np.sign(np.linalg.det(dcms[0]))
    across = np.linalg.norm(hand * dcms - np.eye(3), axis=(1, 2)).max()
    return float(2 * np.arcsin(min(1.0, across / math.sqrt(8))))


def _price(reading):
    return round(reading["faults"] + reading["rarity"], 6)


def _reading_key(reading):
    """Return a key shared by equivalent readings: space fixed is body fixed in reverse order."""
    choices = dict(reading["choices"])
    if choices.get("axes of the turns") == "space fixed":
        turned = str.maketrans("123", "321")
        choices |= {
            "axes of the turns": "body fixed",
            "sequence": choices["sequence"][::-1],
            "places": choices["places"].translate(turned),
            "signs": choices["signs"][::-1],
        }
    return reading["kind"], tuple(sorted(choices.items()))


def chains(first, second, noise, expected, special):
    """Return all chains that fit every pose, cheapest first, and how many were tried by faults.

    Parameters
    ----------
    first, second : Side
    noise : float
        Radians by which the orientations may differ besides the rounding of the printed numbers.
    expected : tuple
        The difference that the programs' manuals predict:
        `orientation_workbench.mismatch.table.expected_relation`.
    special : bool
        Whether the poses leave several readings open, however simple one is.
    """
    hands = [np.linalg.det(side.dcms[0, 0]) > 0 for side in (first, second)]
    relations, left, right, inverse, relation_faults = _relations(hands[0] != hands[1], expected)
    exactly = [np.flatnonzero(relation_faults == count) for count in range(table.MOST_FAULTS + 1)]
    left_first, fits, pairs = np.swapaxes(first.dcms, -1, -2), [], []
    tried = np.zeros(table.MOST_FAULTS + 1)
    # Signed permutations and the transpose preserve the sum of fourth powers, which excludes most
    # pairs.
    fourth = [(side.dcms**4).sum(axis=(2, 3)) for side in (first, second)]
    for i, both in enumerate(_faults_of_pairs(first, second)):
        tolerance = np.maximum(first.doubts[i] + second.doubts, SINGLE_PRECISION) + noise
        for faults, count in enumerate(np.bincount(both)[: table.MOST_FAULTS + 1]):
            tried[faults:] += (
                count * np.array([*map(len, exactly)])[: table.MOST_FAULTS + 1 - faults]
            )
        near = (np.abs(fourth[0][i] - fourth[1]) <= 12 * tolerance[:, None]).all(axis=1)
        those = np.flatnonzero(near & (both <= table.MOST_FAULTS))
        if those.size:
            pairs.append((i, those, both[those], tolerance))
    lowest = table.MOST_FAULTS
    angles = max(len(first.readings), len(second.readings)) > len(_ORDERS)
    for level in range(table.MOST_FAULTS + 1):
        # Angles have a thousand readings, so we drop those with two faults more than the simplest.
        if (level > lowest + 1 or len(fits) > MANY) and angles:
            break
        for i, near, both, tolerance in pairs:
            for of_both in set(both[both <= level].tolist()):
                allowed = exactly[level - of_both]
                turned = np.where(inverse[allowed, None, None], left_first[i, 0], first.dcms[i, 0])
                turned = (left[allowed] @ turned @ right[allowed]).reshape(-1, 9)
                those = near[both == of_both]
                for block in np.array_split(those, math.ceil(len(those) / BLOCK)):
                    wanted = second.dcms[block, 0].reshape(-1, 1, 9)
                    close = np.abs(turned - wanted).max(axis=2) <= tolerance[block, None]
                    for j, k in zip(*np.nonzero(close)):
                        j, k = block[j], allowed[k]
                        start = left_first[i] if inverse[k] else first.dcms[i]
                        gap = np.abs(left[k] @ start @ right[k] - second.dcms[j]).max()
                        if gap <= tolerance[j]:
                            readings = first.readings[i], second.readings[j]
                            fits.append(_chain(*readings, relations[k], gap))
        if fits:
            lowest = min(lowest, level)
    # For a special pose these would add nothing to the other readings.
    if hands[0] == hands[1] and not (special and fits):
        inside, more = _inside(first, second, noise)
        fits += [chain for chain in inside if not fits or chain.faults <= lowest]
        tried += more
    fits.sort(key=lambda chain: (chain.cost, "; ".join(chain.words())))
    return fits, tried


def _chain(first, second, relation, gap):
    in_both, rarity, _ = table.of_both(first, second)
    return Chain(
        first,
        second,
        relation,
        in_both + relation["faults"],
        rarity + relation["rarity"],
        float(gap),
    )


def _faults_of_pairs(first, second):
    """Count the faults of each reading of the first side with each of the second side's."""
    faults, shared, codes = (
        [np.array([reading[what] for reading in side.readings]) for side in (first, second)]
        for what in ("faults", "shared", "codes")
    )
    for i in range(len(first.readings)):
        alike = np.bitwise_count(shared[0][i] & shared[1])
        yield faults[0][i] + faults[1] - 2 * alike + table.changed(codes[0][i], codes[1])


# --- causes inside --------------------------------------------------------------------------------


_ORDERS = table.KINDS["quaternion"][0]["choices"]
_PERMUTED = ["".join(places) for places in itertools.permutations("123")]
#: Scalar last read as scalar first, and the reverse.
_MISREAD = ("xyzw", "zwxy")
#: How much more doubt angles have after the conversion, which grows near the middle one's
#: singularity.
_LOOSER = 6


@functools.cache
def _inner_relations():
    """List the faults between two programs that exchange angles or a quaternion internally.

    The output is a matrix or a quaternion. The angles are read by one sequence and built by
    another, or scalar first is confused with scalar last. The list has each fault as it is, and
    then with the inverse besides.
    """
    listed = []
    for read, built, places in itertools.product(SEQUENCES, SEQUENCES, _PERMUTED):
        rarity = 0.2 if places in ("123", "321") else 0.4
        rarity -= 0.1 * (built == read[::-1] and places == "321")
        rarity += 0.4 * (read in PROPER_EULER or built in PROPER_EULER)
        listed.append({"inside": ("angles", read, built, places), "rarity": rarity})
    listed += [{"inside": ("quaternion", "wxyz", order, ""), "rarity": 0.1} for order in _MISREAD]
    plain = {"inverse": False, "body": table.SAME_AXES, "world": table.SAME_AXES, "hand": False}
    return [
        plain | each | {"inverse": inverse, "faults": 1 + inverse}
        for inverse in (False, True)
        for each in listed
    ]


@functools.cache
def _distinct():
    """Mark the relations to try, which are not mere renamings of axes except for two known ones."""
    dcm = random_orientations(1, np.random.default_rng(20))
    _, left, right, inverse, _ = _relations(False, table.expected_relation(None, None, ()))
    start = np.where(inverse[:, None, None], np.swapaxes(dcm, -1, -2), dcm)
    renamed = {tuple(each) for each in (left @ start @ right).reshape(-1, 9).round(6) + 0.0}
    made = _all_inside(dcm).reshape(-1, 9).round(6) + 0.0
    return np.array([
        tuple(entries) not in renamed
        or what == "quaternion"
        or (built, places) == (read[::-1], "321")
        for entries, relation in zip(made, _inner_relations(), strict=True)
        for what, read, built, places in [relation["inside"]]
    ]) & (np.abs(made - dcm.reshape(9)).max(axis=1) > 1e-6)  # fmt: skip


def after_inside(inside, dcms):
    """Return the orientations after reading and rebuilding them as ``inside`` says."""
    what, read, built, places = inside
    if what == "quaternion":
        return dcm_from_quaternion(
            quaternion_from_dcm(dcms)[..., [read.index(part) for part in built]]
        )
    angles = body_fixed_from_dcm(dcms, read)
    return dcm_from_body_fixed(angles[..., [int(place) - 1 for place in places]], built)


def _all_inside(dcms):
    """Return the same for all of `_inner_relations`, an array ``(relations, poses, 3, 3)``."""
    dcms, permuted = nearest_dcm(dcms).dcm, [[int(k) - 1 for k in places] for places in _PERMUTED]
    made = []
    for read in SEQUENCES:
        angles = np.moveaxis(body_fixed_from_dcm(dcms, read)[:, permuted], 0, 1)
        made += [dcm_from_body_fixed(angles, built) for built in SEQUENCES]
    parts = quaternion_from_dcm(dcms)
    orders = [["wxyz".index(part) for part in order] for order in _MISREAD]
    made.append(dcm_from_quaternion(np.moveaxis(parts[:, orders], 0, 1)))
    made = np.concatenate(made)
    return np.concatenate([made, np.swapaxes(made, -1, -2)])


def _inside(first, second, noise):
    """Return the chains with one internal cause, and how many of each fault count were tried."""
    relations, fits = _inner_relations(), []
    tried = np.zeros(table.MOST_FAULTS + 1)
    handed_on = [
        [
            k
            for k, reading in enumerate(side.readings)
            if reading["kind"] in ("matrix", "quaternion")
        ]
        for side in (first, second)
    ]
    for i in handed_on[0]:
        reading = first.readings[i]
        others = [
            j
            for j in handed_on[1]
            if table.of_both(reading, second.readings[j])[0] <= 1
            and reading["rarity"] + second.readings[j]["rarity"] == 0
        ]
        if not others:
            continue
        made = _all_inside(first.dcms[i])
        changes = np.abs(made - first.dcms[i]).max(axis=(1, 2, 3))
        for j in others:
            both = table.of_both(reading, second.readings[j])[0]
            tolerance = max(first.doubts[i] + second.doubts[j], SINGLE_PRECISION) + noise
            tolerance *= _LOOSER
            gaps = np.abs(made - second.dcms[j]).max(axis=(1, 2, 3))
            # If one side gives a quaternion, the fault is in reading that side rather than inside.
            matrices = reading["kind"] == second.readings[j]["kind"] == "matrix"
            tried_here = _distinct() & [
                matrices or relation["inside"][0] != "quaternion" for relation in relations
            ]
            tried[both + 1 : both + 3] += len(relations) / 2
            # A relation that changes nothing explains nothing.
            fits += [
                _chain(reading, second.readings[j], relations[k], gaps[k])
                for k in np.flatnonzero((gaps <= tolerance) & (changes > tolerance) & tried_here)
            ]
    return fits, tried


def with_orders(best, first, second, noise, expected):
    """Return the cheapest chain for each order of the best one's quaternions.

    The order is scalar first or last. A chain here may have more faults than usual.
    """
    hands = [np.linalg.det(side.dcms[0, 0]) > 0 for side in (first, second)]
    relations, left, right, inverse, _ = _relations(hands[0] != hands[1], expected)
    listed = []
    for (i, one), (j, other) in itertools.product(
        _usual_orders(first, best.first), _usual_orders(second, best.second)
    ):
        tolerance = max(first.doubts[i] + second.doubts[j], SINGLE_PRECISION) + noise
        start = first.dcms[i][:, None]
        start = np.where(inverse[:, None, None], np.swapaxes(start, -1, -2), start)
        gaps = np.abs(left @ start @ right - second.dcms[j][:, None]).max(axis=(0, 2, 3))
        fits = [
            _chain(one, other, relations[k], gaps[k]) for k in np.flatnonzero(gaps <= tolerance)
        ]
        listed += sorted(fits, key=lambda chain: chain.cost)[:1]
    return listed


def _usual_orders(side, best):
    for k, reading in enumerate(side.readings):
        usual = reading["choices"].get("order") in ("wxyz", "xyzw")
        if reading is best or (usual and best["kind"] == "quaternion"):
            yield k, reading
