"""Types of results for type checkers: arrays for numbers, SymPy matrices for symbols."""

import subprocess
import sys

PROGRAM = """
from typing import assert_type

import numpy
import sympy
from numpy.typing import NDArray

from orientation import (
    angle_between,
    dcm_from_axis_angle,
    dcm_from_body_fixed,
    quaternion_from_dcm,
    simple_dcm,
)


class Symbol:  # what type checkers know of SymPy's objects, where SymPy has no types
    @property
    def free_symbols(self) -> set["Symbol"]:
        return set()


Array = NDArray[numpy.float64]
theta, one, batch = Symbol(), simple_dcm("z", 0.3), numpy.zeros(3)
assert_type(one, Array)
assert_type(simple_dcm("z", [0.3, 0.4]), Array)
assert_type(simple_dcm("z", batch), Array)
assert_type(simple_dcm("z", theta), sympy.MutableDenseMatrix)
assert_type(dcm_from_body_fixed((0.1, 0.2, 0.3), "zxy"), Array)
assert_type(dcm_from_body_fixed((theta, theta, theta), "zxy"), sympy.MutableDenseMatrix)
assert_type(dcm_from_body_fixed((theta, 0.2, 0), "zxy"), sympy.MutableDenseMatrix)
assert_type(dcm_from_axis_angle((1, 2, 2), batch), Array)
assert_type(dcm_from_axis_angle((1, 2, 2), theta), sympy.MutableDenseMatrix)
assert_type(quaternion_from_dcm(one), Array)
assert_type(angle_between(one, one), float | Array)
dcm_from_body_fixed(batch, "zxx")
simple_dcm(0.3, "z")
"""


def test_the_kind_of_a_result_follows_from_that_of_the_arguments(tmp_path):
    file = tmp_path / "program.py"
    file.write_text(PROGRAM)
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--ignore-missing-imports",
        "--follow-imports",
        "silent",
    ]
    done = subprocess.run(
        [*command, "--cache-dir", tmp_path / "cache", file],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    errors = [line for line in done.stdout.splitlines() if " error: " in line]
    expected = ("dcm_from_body_fixed", "simple_dcm")
    assert len(errors) == len(expected), done.stdout
    for line, name, error in zip((-1, 0), expected, errors):
        place = f"program.py:{PROGRAM.count(chr(10)) + line}: error: "
        assert error.startswith(f'{place}No overload variant of "{name}"'), done.stdout
