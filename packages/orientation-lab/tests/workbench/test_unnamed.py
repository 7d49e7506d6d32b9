"""Numbers pasted without naming a program: no flat name that is not what was pasted, and unrelated
numbers are hardly ever called the same.

``python packages/orientation-lab/tests/workbench/test_unnamed.py`` tries 300 mix-ups and 1,000
unrelated pairs, and prints what was said of them.

On 28 November 2026, seed 92000: of the 300, 31 were named rightly, 269 undecided with the truth
among the descriptions, and none named falsely; of the 1,000, none was called the same.
"""

import sys
import time
from collections import Counter

import numpy as np
from scipy.spatial.transform import Rotation

from orientation_workbench import explain
from orientation_workbench.mismatch import table


def printed(turns, form):
    """Rotations from the body to the world, as SciPy has them, in one of the usual forms."""
    rows = {
        "xyzw": lambda: turns.as_quat(),
        "wxyz": lambda: np.roll(turns.as_quat(), 1, axis=1),
        "matrix": lambda: turns.as_matrix().reshape(-1, 9),
        "angles": lambda: turns.as_euler("ZYX", degrees=True),
    }[form]()
    return "\n".join(" ".join(f"{number:.5f}" for number in row) for row in rows)


def mixed_up(rng):
    """Two poses of both programs, and the words of what the second does otherwise."""
    first = Rotation.random(2, random_state=rng)
    whose = rng.choice(["body", "world", "inverse"])
    if whose == "inverse":
        return first, first.inv(), ("conjugate", "transpose")
    known = table.BODY_AXES if whose == "body" else table.WORLD_AXES
    proper = [names for names in known if np.linalg.det(table.axes_matrix(names)) > 0]
    names = proper[rng.integers(len(proper))]
    axes = Rotation.from_matrix(np.array(table.axes_matrix(names), float))
    second = first * axes.inv() if whose == "body" else axes * first
    return first, second, (known[names],)


def said_of_mixups(form, count, seed):
    """How many were named rightly, asked about with the truth in the list, or named falsely."""
    rng, score = np.random.default_rng([seed, len(form)]), Counter()
    for _ in range(count):
        first, second, words = mixed_up(rng)
        explanation = explain(printed(first, form), printed(second, form))
        faults = [explanation.faults] if explanation.verdict in ("named", "same") else []
        faults += [name.faults for name in explanation.names]
        true = any(word in "; ".join(each) for each in faults for word in words)
        score[f"{explanation.verdict}, {'' if true else 'not '}the truth"] += 1
    return score


def said_of_unrelated(count, seed):
    """Verdicts on pairs that have nothing to do with each other, half of them small turns."""
    rng, score = np.random.default_rng(seed), Counter()
    for k in range(count):
        size = rng.uniform(0.15, 0.7) if k % 2 else rng.uniform(0.7, 3.0)
        turns = []
        for _ in range(2):
            axis = rng.normal(size=(1, 3))
            turns.append(Rotation.from_rotvec(size * axis / np.linalg.norm(axis)))
        forms = rng.choice(["xyzw", "wxyz", "matrix", "angles"], 2, p=[0.3, 0.3, 0.3, 0.1])
        try:
            texts = [printed(turn[:1], form) for turn, form in zip(turns, forms, strict=True)]
            score[explain(*texts, noise=np.radians(rng.uniform(0.2, 2))).verdict] += 1
        except ValueError:
            score["too small to judge"] += 1
    return score


def test_no_mixup_is_flatly_named_otherwise():
    for form in ("wxyz", "xyzw", "matrix"):
        score = said_of_mixups(form, 6, 1)
        assert score["named, not the truth"] + score["same, not the truth"] == 0, (form, score)


def test_unrelated_numbers_with_noise_are_not_called_the_same():
    assert said_of_unrelated(25, 1)["same"] == 0


def test_angles_against_angles_take_two_seconds_at_most():
    begun = time.process_time()
    explain("10.2 -33.1 71.9", "12.2 40.1 -7.5")
    assert time.process_time() - begun < 2


if __name__ == "__main__":
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    for form in ("wxyz", "xyzw", "matrix"):
        print(f"{form} against {form}:", dict(said_of_mixups(form, 100, seed)), flush=True)
    print("unrelated, with noise:", dict(said_of_unrelated(1000, seed)))
