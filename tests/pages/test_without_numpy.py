"""A single orientation in numbers with NumPy's stand-in: the same answers in the same form."""

import json
import subprocess
import sys

from notebook_pages.live.cells import PYTHON

CALLS = """
simple_dcm("z", 0.3)
dcm_from_body_fixed((0.1, 0.2, 0.3), "zxy")
dcm_from_space_fixed((0.1, 0.2, 0.3), "zxz")
body_fixed_from_dcm(dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy"), "zxy")
space_fixed_from_dcm(dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy"), "zxy")
dcm_from_axis_angle((1, 2, 2), 1.2)
axis_angle_from_dcm(dcm_from_axis_angle((1, 2, 2), 1.2))
axis_angle_from_dcm([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
quaternion_from_axis_angle((1, 2, 2), 1.2)
-quaternion_from_axis_angle((1, 2, 2), 1.2)
quaternion_from_dcm(simple_dcm("x", 3.1))
quaternion_from_dcm(simple_dcm("x", 3.1)).round(4)
dcm_from_quaternion((0.6, 0, 0, 0.8))
multiply_quaternions((0.6, 0, 0, 0.8), (0, 1, 0, 0))
interpolate_quaternions((1, 0, 0, 0), (0.6, 0.8, 0, 0), 0.25)
dcm_from_rotation_vector((0.3, -0.4, 1.2))
rotation_vector_from_dcm(dcm_from_rotation_vector((0.3, -0.4, 1.2))) / 2
gimbal_lock_margin((0.3, 1.4, 0.1), "zxy")
angular_velocity_matrix((0.1, 0.2, 0.3), "zxy")
dcm_rate(simple_dcm("y", 0.1), (0, 0, 2.0))
quaternion_rate((1, 0, 0, 0), (0, 0, 2.0))
simple_dcm("z", 0.3) @ simple_dcm("x", 0.2).T
simple_dcm("z", 0.3) @ [1, 2, 3]
simple_dcm("z", 0.3)[0]
simple_dcm("z", 0.3)[0, 1]
simple_dcm("z", 0.3)[:2, 1]
abs(simple_dcm("z", 0.3) - simple_dcm("z", 0.31)).max()
simple_dcm("z", 0.3) * 2 + 1
simple_dcm("z", [0.1, 0.2])
simple_dcm("z", 0.1).trace()
simple_dcm("z", 0.1)[0, 0].round(2)
[row.tolist() for row in simple_dcm("z", 0.3)]
same_orientation(-quaternion_from_axis_angle((0, 0, 1), 1), quaternion_from_dcm(simple_dcm('z', 1)))
same_orientation(simple_dcm("z", 0.3), dcm_from_axis_angle((0, 0, 2), 0.3))
diagnose(simple_dcm("z", 0.3).T, simple_dcm("z", 0.3)).causes
check_dcm([[0.36, 0.48, -0.80], [-0.80, 0.60, 0.00], [0.48, 0.64, 0.60]])
check_dcm([[0.4, 0.5, -0.80], [-0.80, 0.60, 0.00], [0.48, 0.64, 0.60]])
dcm_from_quaternion((0.7, 0.7, 0.0, 0.0))
dcm_from_axis_angle((0, 0, 0), 1.0)
simple_dcm("z", float("nan"))
simple_dcm("z", True)
body_fixed_from_dcm(simple_dcm("z", __import__("sympy").Symbol("t")), "zxy")
simple_dcm("z", __import__("sympy").pi / 6) * 2
body_fixed_from_dcm(simple_dcm("z", __import__("sympy").pi / 6), "zxy")
""".strip().splitlines()
PROGRAM = """
import json, sys
if sys.argv[1] != "with":
    sys.path.append(sys.argv[1])
    import plain_numpy

    class Absent:
        def find_spec(self, name, path=None, target=None):
            if name.partition(".")[0] == "numpy":
                raise ModuleNotFoundError(f"No module named {name!r}", name="numpy")

    sys.meta_path.insert(0, Absent())
    plain_numpy.stand_in()
from orientation import *
told = []
for call in json.load(sys.stdin):
    try:
        value = eval(call)
        told.append([repr(value), str(value)])
    except Exception as error:
        told.append([type(error).__name__, str(error)])
json.dump(told, sys.stdout)
"""


def run(calls, how):
    command = [sys.executable, "-c", PROGRAM, how]
    return json.loads(
        subprocess.run(
            command, input=json.dumps(calls), capture_output=True, text=True, check=True
        ).stdout
    )


def test_answers_and_their_looks_are_the_same():
    """The errors are the same, too."""
    for call, without, with_numpy in zip(
        CALLS, run(CALLS, PYTHON), run(CALLS, "with"), strict=True
    ):
        assert without == with_numpy, call


def test_what_needs_numpy_says_so():
    """The page then fetches it, and a notebook says how: the error names the module."""
    ((kind, message),) = run(["simple_dcm('z', 0.1).cumprod()"], PYTHON)
    assert kind == "ModuleNotFoundError" and "import numpy" in message
