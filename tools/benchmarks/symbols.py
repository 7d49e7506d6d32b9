"""Symbolic matrices and their comparison, against SymPy's reference frames and ``simplify``.

SymPy remembers what it has computed. Its cache is emptied before every call, for all contestants,
and emptying it does not count.
"""

import itertools
import statistics
import time

import sympy as sm
import sympy.physics.mechanics as me
from sympy.core.cache import clear_cache
from sympy.simplify.fu import TR8

import orientation

ANGLES = sm.symbols("psi, theta, varphi")
TWELVE = sm.symbols("a:12")


def rows():
    """Yield ``(what, N, seconds by contestant)``."""
    expected = orientation.dcm_from_body_fixed(ANGLES, "zxy")
    sums = expected.applyfunc(TR8)  # products of cosines and sines written as sums
    mistaken = orientation.dcm_from_space_fixed(ANGLES, "zxy")
    yield (
        "symbolic matrix of Euler angles zxy",
        1,
        _seconds(lambda: orientation.dcm_from_body_fixed(ANGLES, "zxy"), _body_fixed, rounds=25),
    )
    yield (
        "symbolic chain of 12 turns about z",
        1,
        _seconds(lambda: _our_chain("z"), lambda: _their_chain("z"), rounds=5),
    )
    yield (
        "symbolic chain of 12 turns about x, y, z in turn",
        1,
        _seconds(lambda: _our_chain("xyz"), lambda: _their_chain("xyz"), rounds=5),
    )
    yield (
        "two forms of one zxy matrix are the same (SymPy: simplify)",
        1,
        _seconds(
            lambda: orientation.same_orientation(sums, expected),
            lambda: sm.simplify(sums - expected) == sm.zeros(3),
            rounds=3,
        ),
    )
    yield (
        "space fixed for body fixed is recognised (SymPy: simplify for each mix-up)",
        1,
        _seconds(
            lambda: orientation.diagnose(mistaken, expected).causes,
            lambda: _diagnosis(mistaken, expected),
            rounds=3,
        ),
    )


def sizes():
    """Yield ``(what, operations by contestant)``."""
    for axes, what in (("z", "about z"), ("xyz", "about x, y, z in turn")):
        yield (
            f"operations in a symbolic chain of 12 turns {what}",
            {
                "orientation": sm.count_ops(_our_chain(axes)),
                "SymPy": sm.count_ops(_their_chain(axes)),
            },
        )


def _seconds(ours, theirs, rounds):
    samples = {"orientation": [], "SymPy": []}
    for _ in range(rounds):
        for name, function in (("orientation", ours), ("SymPy", theirs)):
            clear_cache()
            start = time.process_time()
            result = function()
            samples[name].append(time.process_time() - start)
            if not result:
                raise AssertionError(f"{name} did not find the answer")
    return {name: statistics.median(times) for name, times in samples.items()}


def _body_fixed():
    A, D = me.ReferenceFrame("A"), me.ReferenceFrame("D")
    D.orient_body_fixed(A, ANGLES, "zxy")
    return D.dcm(A)


def _our_chain(axes):
    frames = orientation.Frames()
    for k, (angle, axis) in enumerate(zip(TWELVE, itertools.cycle(axes))):
        frames = frames.orient_axis(f"F{k + 1}", f"F{k}", axis, angle)
    return frames.dcm("F12", "F0")


def _their_chain(axes):
    frames = [me.ReferenceFrame(f"F{k}") for k in range(13)]
    for k, (angle, axis) in enumerate(zip(TWELVE, itertools.cycle(axes))):
        frames[k + 1].orient_axis(frames[k], getattr(frames[k], axis), angle)
    return frames[12].dcm(frames[0])


def _diagnosis(given, expected):
    """The usual way: undo each mix-up and let SymPy simplify the difference."""
    mixups = [expected.T]
    mixups += [expected.subs(angle, -angle) for angle in ANGLES]
    mixups += [
        expected.subs({a: b, b: a}, simultaneous=True) for a, b in itertools.combinations(ANGLES, 2)
    ]
    mixups.append(orientation.dcm_from_space_fixed(ANGLES, "zxy"))
    return any(sm.simplify(given - mixup) == sm.zeros(3) for mixup in mixups)
