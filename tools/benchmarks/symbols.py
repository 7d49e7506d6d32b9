"""Compare symbolic matrices with SymPy's frames and ``simplify``, and the times of imports.

SymPy caches what it has computed. Its cache is emptied before every call, for all contestants, and
this is not timed. Imports are timed beyond NumPy's, each in a new interpreter.
"""

import itertools
import statistics
import subprocess
import sys
import time

import sympy as sm
import sympy.physics.mechanics as me
from sympy.core.cache import clear_cache
from sympy.simplify.fu import TR8

import orientation

ANGLES = sm.symbols("psi, theta, varphi")
TWELVE = sm.symbols("a:12")
PACKAGES = {
    "orientation": "orientation",
    "SciPy": "scipy.spatial.transform",
    "pytransform3d": "pytransform3d.rotations",
    "SymPy": "sympy.physics.mechanics",
}


def rows():
    """Yield ``(task, N, seconds by contestant)``."""
    expected = orientation.dcm_from_body_fixed(ANGLES, "zxy")
    sums = expected.applyfunc(TR8)  # products of cosines and sines written as sums
    for task, ours, theirs, rounds in (
        (
            "symbolic matrix of Euler angles zxy",
            lambda: orientation.dcm_from_body_fixed(ANGLES, "zxy"),
            _body_fixed,
            25,
        ),
        (
            "symbolic chain of 12 turns about z",
            lambda: _our_chain("z"),
            lambda: _their_chain("z"),
            5,
        ),
        (
            "symbolic chain of 12 turns about x, y, z in turn",
            lambda: _our_chain("xyz"),
            lambda: _their_chain("xyz"),
            5,
        ),
        (
            "two forms of one zxy matrix are the same (SymPy: simplify)",
            lambda: orientation.same_orientation(sums, expected),
            lambda: sm.simplify(sums - expected) == sm.zeros(3),
            3,
        ),
    ):
        yield task, 1, _seconds(ours, theirs, rounds)

    yield "import, beyond NumPy", 1, {name: _import(package) for name, package in PACKAGES.items()}


def _import(package):
    return min(
        float(
            subprocess.check_output(
                [
                    sys.executable,
                    "-c",
                    f"import numpy, time; start = time.process_time(); "
                    f"import {package}; print(time.process_time() - start)",
                ]
            )
        )
        for _ in range(9)
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
