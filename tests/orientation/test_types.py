"""What editors and type checkers are told of a result: numbers give an array, whatever kind of numbers they are."""

import subprocess
import sys

PROGRAM = """
import numpy
from orientation import dcm_from_axis_angle, quaternion_from_dcm, simple_dcm

one = simple_dcm("z", 0.3)
reveal_type(one)
reveal_type(simple_dcm("z", [0.3, 0.4]))
reveal_type(simple_dcm("z", numpy.zeros(3)))
reveal_type(dcm_from_axis_angle((1, 2, 2), numpy.zeros(3)))
reveal_type(quaternion_from_dcm(one))
simple_dcm(0.3, "z")
"""


def test_numbers_give_arrays(tmp_path):
    file = tmp_path / "program.py"
    file.write_text(PROGRAM)
    command = [sys.executable, "-m", "mypy", "--ignore-missing-imports", "--follow-imports", "silent"]
    done = subprocess.run(
        [*command, "--cache-dir", tmp_path / "cache", file], cwd=tmp_path, capture_output=True, text=True
    )
    told = [line for line in done.stdout.splitlines() if "Revealed type" in line]
    assert len(told) == 5 and all("ndarray" in line and "float64" in line for line in told), done.stdout
    assert 'program.py:11: error: No overload variant of "simple_dcm"' in done.stdout
