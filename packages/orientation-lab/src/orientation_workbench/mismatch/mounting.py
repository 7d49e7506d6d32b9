"""Constant rotations before or after (mounting, hand-eye), which only several poses determine."""

import itertools

import numpy as np

from orientation import dcm_from_two_directions, nearest_dcm, rotation_vector_from_dcm

from .search import SINGLE_PRECISION, Chain
from .table import MOST_FAULTS, SAME_AXES, of_both

#: The fewest poses that leave redundancy to check a constant rotation found from them.
ON_ONE_SIDE, ON_BOTH_SIDES = 3, 4


def mountings(first, second, noise):
    """Return all chains with constant rotations that fit every pose, cheapest first.

    The rotations are on one side or on both.

    The constant rotations $\\mathbf{L}$ and $\\mathbf{R}$ follow from
    $\\mathbf{M}_2 = \\mathbf{L}\\,\\mathbf{M}_1\\,\\mathbf{R}$ at three or more poses. A rotation
    found from some poses must hold at all of them.
    """
    if first.dcms.shape[1] < ON_ONE_SIDE:
        return []
    chains = []
    for (i, reading), (j, other), inverse in itertools.product(
        enumerate(first.readings), enumerate(second.readings), (False, True)
    ):
        in_both, rarity, _ = of_both(reading, other)
        faults = in_both + inverse
        if faults >= MOST_FAULTS:
            continue
        start = np.swapaxes(first.dcms[i], -1, -2) if inverse else first.dcms[i]
        tolerance = 3 * (max(first.doubts[i] + second.doubts[j], SINGLE_PRECISION) + noise)
        for body, world in _constant_turns(start, second.dcms[j]):
            both = faults + (body is not None) + (world is not None)
            left, right = (np.eye(3) if turn is None else turn for turn in (body, world))
            gap = np.abs(left @ start @ right - second.dcms[j]).max()
            if gap <= tolerance and both <= MOST_FAULTS:
                relation = {
                    "inverse": inverse,
                    "hand": False,
                    "body": SAME_AXES,
                    "world": SAME_AXES,
                    "body turn": body,
                    "world turn": world,
                }
                chains.append(Chain(reading, other, relation, both, rarity, float(gap)))
                break
    return sorted(chains, key=lambda chain: chain.cost)


def _constant_turns(start, end):
    """Yield candidates for the two constant rotations: on the body's side, the world's, or both."""
    across = np.swapaxes(start, -1, -2)
    yield (end @ across)[0], None
    yield None, (across @ end)[0]
    if len(start) < ON_BOTH_SIDES:
        return
    # Rotations since the first pose have the same angle on both sides, and their axes differ by the
    # constant rotation.
    moved = [
        rotation_vector_from_dcm(nearest_dcm(dcms[1:] @ dcms[0].T).dcm) for dcms in (start, end)
    ]
    largest = int(np.argmax(np.linalg.norm(moved[0], axis=1)))
    apart = np.linalg.norm(np.cross(moved[0], moved[0][largest]), axis=1)
    second = int(np.argmax(apart))
    if apart[second] < 1e-3:
        # All poses rotate about one axis, so the constant rotation about it is undetermined.
        return
    before, after = ([vectors[largest], vectors[second]] for vectors in moved)
    if min(np.linalg.norm(np.cross(*pair)) for pair in (before, after)) < 1e-6:
        return
    body = dcm_from_two_directions(after, before)
    yield body, (body @ start[0]).T @ end[0]
