"""What other libraries answer, as the convention card says: asked again where they are installed.

``pip install eigenpy==3.13.0 transforms3d==0.4.2 mujoco==4.0.0 opencv-python-headless==5.0.0.93``
"""

import ast
import json
from importlib import import_module

import numpy as np
import pytest
from places import REPOSITORY

from orientation import axis_angle_from_dcm, dcm_from_body_fixed


def stored():
    """The table of the card: library, line of code, answer."""
    notebook = json.loads((REPOSITORY / "chapters" / "convention-card.ipynb").read_text("utf8"))
    source = next("".join(cell["source"]) for cell in notebook["cells"] if "ASKED = [" in "".join(cell["source"]))
    assigned = next(node for node in ast.parse(source).body if isinstance(node, ast.Assign))
    return ast.literal_eval(assigned.value)


def given(library):
    """The names that the lines of the card use, for one library."""
    x, y, z = np.eye(3)
    axis, angle = axis_angle_from_dcm(dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy"))
    names = {"x": x, "y": y, "z": z, "psi": 0.4, "theta": 0.7, "phi": -0.3, "thirty": np.radians(30)}
    names |= {"axis": axis, "angle": angle}
    if library == "eigenpy":
        eigenpy = import_module("eigenpy")
        names |= {"eigenpy": eigenpy, "about": lambda a, e: eigenpy.AngleAxis(a, e).toRotationMatrix()}
    elif library == "transforms3d":
        names["euler2mat"] = import_module("transforms3d.euler").euler2mat
        names["axangle2quat"] = import_module("transforms3d.quaternions").axangle2quat
    elif library == "mujoco":
        mujoco = import_module("mujoco")

        def quaternion(axis, angle):
            mujoco.mju_axisAngle2Quat(result := np.zeros(4), axis, angle)
            return result

        def matrix(angles, sequence):
            mujoco.mju_euler2Quat(q := np.zeros(4), np.array(angles), sequence)
            mujoco.mju_quat2Mat(result := np.zeros(9), q)
            return result.reshape(3, 3)

        names |= {"mujoco_quaternion": quaternion, "mujoco_matrix": matrix}
    else:
        names["cv2"] = import_module("cv2")
    return names


MODULES = {"Eigen": "eigenpy", "transforms3d": "transforms3d", "MuJoCo": "mujoco", "OpenCV": "cv2"}


@pytest.mark.long
@pytest.mark.parametrize("library, line, answer", stored())
def test_libraries_answer_as_the_card_says(library, line, answer):
    module = next(module for name, module in MODULES.items() if library.startswith(name))
    pytest.importorskip(module)
    assert np.allclose(eval(line, given(module)), answer, atol=6e-5)


@pytest.mark.long
def test_the_old_way_back_of_eigen_prefers_a_first_angle_from_0_to_pi():
    eigenpy = pytest.importorskip("eigenpy")
    names = given("eigenpy")
    matrix = names["about"](-0.4, names["z"]) @ names["about"](0.7, names["x"]) @ names["about"](-0.3, names["y"])
    assert np.allclose(eigenpy.toEulerAngles(matrix, 2, 0, 1), (2.7416, 2.4416, 2.8416), atol=1e-4)


def test_the_stored_answers_are_of_the_orientation_that_the_card_is_about():
    D_C_A = dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy")
    for _, _, answer in stored():
        if len(answer) == 3:
            assert np.allclose(np.transpose(answer), D_C_A, atol=6e-5)
        else:
            assert sorted(np.round(answer, 4)) == [0, 0, 0.2588, 0.9659]
