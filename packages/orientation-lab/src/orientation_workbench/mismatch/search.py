"""The search: every chain of at most three faults that explains the numbers, simplest first."""

import functools
import math
from typing import NamedTuple

import numpy as np

from . import table
from .meaning import dcms_from_numbers, doubt

#: What is left of a computation in single precision when all its digits are printed.
SINGLE_PRECISION = 2e-6
#: Readings of the second side that are compared at a time.
BLOCK = 200
#: A chain is named only if fewer than this many are expected to fit unrelated numbers by chance.
BY_CHANCE = 1e-3


class Chain(NamedTuple):
    """One explanation: how each side is read, and how the two orientations belong together."""

    first: dict
    second: dict
    relation: dict
    faults: int
    rarity: float
    residual: float

    @property
    def cost(self):
        """One for each fault, and how rare they are. Tenths: what addition
        leaves besides decides nothing.
        """
        return round(self.faults + self.rarity, 6)

    def words(self):
        """The faults, each as a phrase."""
        *_, sides = table.of_both(self.first, self.second)
        return sides + table.words_of(self.relation, (self.first["kind"], self.second["kind"]))


@functools.cache
def _relations(mirrored, expected):
    """The relations, by how far each is from the expected one, and their
    two signed permutations as stacks.
    """
    aside = table.left_handed(expected[1]) != table.left_handed(expected[2])
    entries = [table.beyond(entry, expected) for entry in table.relations(mirrored != aside)]
    left = np.array([table.axes_matrix(entry["body"]) for entry in entries], float)
    right = np.array([np.transpose(table.axes_matrix(entry["world"])) for entry in entries], float)
    inverse = np.array([entry["inverse"] for entry in entries])
    faults = np.array([entry["faults"] for entry in entries])
    return entries, left, right, inverse, faults


class Side(NamedTuple):
    """One side as the search needs it: its readings, their
    matrices at each pose, and their doubt.
    """

    readings: list
    dcms: np.ndarray
    doubts: np.ndarray


def side(kinds, numbers, half, declared):
    """Read the numbers of one side in every way.

    Parameters
    ----------
    kinds : sequence of str
        The kinds that the numbers may be of.
    numbers : array of shape ``(poses, count)``
    half : float
        Half a unit of the last digit printed.
    declared : dict
        What is known of the program's convention.
    """
    listed = []
    for kind in kinds:
        # Of an axis and its angle, wherever that stands, only the angle can be large.
        large = kind != "quaternion" and bool((np.abs(numbers) > math.tau + 0.01).any())
        listed += table.readings(kind, declared, large)
    cheapest = {}
    for reading in listed:
        key = _reading_key(reading)
        if key not in cheapest or _price(reading) < _price(cheapest[key]):
            cheapest[key] = reading
    readings = sorted(cheapest.values(), key=_price)
    dcms = np.stack([dcms_from_numbers(reading, numbers) for reading in readings])
    return Side(readings, dcms, np.array([doubt(reading, half) for reading in readings]))


def _price(reading):
    return round(reading["faults"] + reading["rarity"], 6)


def _reading_key(reading):
    """Readings that mean the same by any numbers: space fixed is body fixed from behind."""
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


def chains(first, second, noise, expected=table.expected_relation(None, None, ())):
    """All chains that fit every pose, cheapest first; and how many were tried.

    Parameters
    ----------
    first, second : Side
    noise : float
        Radians by which the orientations may differ besides the rounding of what is printed.
    expected : tuple
        What the programs differ by in any case:
        :func:`orientation_workbench.mismatch.table.expected_relation`.
    """
    hands = [np.linalg.det(one.dcms[0, 0]) > 0 for one in (first, second)]
    relations, left, right, inverse, relation_faults = _relations(hands[0] != hands[1], expected)
    left_first, fits, tried = np.swapaxes(first.dcms, -1, -2), [], 0
    faults, shared = (
        [np.array([reading[what] for reading in one.readings]) for one in (first, second)]
        for what in ("faults", "shared")
    )
    # Signed permutations and the transpose leave the sum of fourth
    # powers alone: most pairs fall here.
    fourth = [(one.dcms**4).sum(axis=(2, 3)) for one in (first, second)]
    for i, reading in enumerate(first.readings):
        tolerance = np.maximum(first.doubts[i] + second.doubts, SINGLE_PRECISION) + noise
        left_over = (
            table.MOST_FAULTS
            - faults[0][i]
            - faults[1]
            + 2 * np.bitwise_count(shared[0][i] & shared[1])
        )
        tried += int(
            sum((relation_faults <= allowed).sum() for allowed in left_over[left_over >= 0])
        )
        near = (np.abs(fourth[0][i] - fourth[1]) <= 12 * tolerance[:, None]).all(axis=1) & (
            left_over >= 0
        )
        for budget in set(left_over[near].tolist()):
            allowed = np.flatnonzero(relation_faults <= budget)
            turned = np.where(inverse[allowed, None, None], left_first[i, 0], first.dcms[i, 0])
            turned = (left[allowed] @ turned @ right[allowed]).reshape(-1, 9)
            those = np.flatnonzero(near & (left_over == budget))
            for block in np.array_split(those, math.ceil(len(those) / BLOCK)):
                wanted = second.dcms[block, 0].reshape(-1, 1, 9)
                close = np.abs(turned - wanted).max(axis=2) <= tolerance[block, None]
                for j, k in zip(*np.nonzero(close)):
                    j, k = block[j], allowed[k]
                    start = left_first[i] if inverse[k] else first.dcms[i]
                    gap = np.abs(left[k] @ start @ right[k] - second.dcms[j]).max()
                    if gap <= tolerance[j]:
                        relation, other = relations[k], second.readings[j]
                        in_both, rare, _ = table.of_both(reading, other)
                        total = in_both + relation["faults"], rare + relation["rarity"]
                        fits.append(Chain(reading, other, relation, *total, float(gap)))
    fits.sort(key=lambda chain: (chain.cost, "; ".join(chain.words())))
    return fits, tried
