"""What programs promise: numbers made as their manuals and sources say
are found to differ by nothing else.
"""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_mismatch import printed

from orientation import quaternion_from_axis_angle
from orientation_workbench import explain
from orientation_workbench.programs import PROGRAMS, program_named
from tools.programs.__main__ import ORIENTATIONS, STORED

ANGLES = np.array([[0.3, 0.5, -0.4], [1.0, -0.2, 0.7]])
ROTATION = Rotation.from_euler("XYZ", ANGLES)
MATRICES, QUATERNIONS = ROTATION.as_matrix(), ROTATION.as_quat()
FIXED = Rotation.from_euler("xyz", ANGLES)
SCALAR_FIRST = [3, 0, 1, 2]


def unreal_quaternion(pitch, yaw, roll):
    """``FRotator::Quaternion`` of Unreal's source, in degrees."""
    (sp, cp), (sy, cy), (sr, cr) = (
        (np.sin(a), np.cos(a)) for a in np.radians([pitch, yaw, roll]) / 2
    )
    return [cr * sp * sy - sr * cp * cy, -cr * sp * cy - sr * cp * sy, cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy]  # fmt: skip


TURNS = np.array([(20.0, 35, -50), (-40, 100, 15)])
IN_UNREAL = np.array([unreal_quaternion(*turn) for turn in TURNS])
#: Unreal's forward, right, up as Unity's right, up, forward; and OpenCV's camera as PyTorch3D's.
TO_UNITY, LEFT_UP = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]), np.diag([-1, -1, 1])

PROMISES = {
    # numbers out of rawify/Quaternion.js 12
    "Unity's angles": (
        "unity",
        "-0.24479 -0.18215 0.36758 0.87851",
        "unity",
        "342.77 328.43 50.31",
    ),
    "Unreal's angles": ("unreal", printed(IN_UNREAL), "unreal", printed(TURNS)),
    "Unreal's angles by name": (
        "unreal",
        printed(IN_UNREAL),
        "unreal",
        "\n".join("P={:.4f} Y={:.4f} R={:.4f}".format(*turn) for turn in TURNS),
    ),
    "Unreal and Unity": (
        "unreal",
        printed(Rotation.from_quat(IN_UNREAL).as_matrix()),
        "unity",
        printed(
            Rotation.from_matrix(
                TO_UNITY @ Rotation.from_quat(IN_UNREAL).as_matrix() @ TO_UNITY.T
            ).as_quat()
        ),
    ),
    "three.js": ("three", printed(QUATERNIONS), "three", printed(ANGLES)),
    "ROS": ("ros", printed(FIXED.as_quat()), "urdf", printed(ANGLES)),
    "PyBullet": ("pybullet", printed(FIXED.as_quat()), "pybullet", printed(ANGLES)),
    "Drake": ("drake", printed(FIXED.as_quat()[:, SCALAR_FIRST]), "drake", printed(ANGLES)),
    "Blender": ("blender", printed(FIXED.as_quat()[:, SCALAR_FIRST]), "blender", printed(ANGLES)),
    # siemens/ros-sharp 126, carla-simulator/ros-bridge
    "ROS and Unity": (
        "ros",
        printed(QUATERNIONS),
        "unity",
        printed(QUATERNIONS[:, [1, 2, 0, 3]] * [1, -1, -1, 1]),
    ),
    "ROS and Unreal": (
        "ros",
        printed(QUATERNIONS),
        "unreal",
        printed(QUATERNIONS * [-1, 1, -1, 1]),
    ),
    # KhronosGroup/glTF-Blender-IO 438
    "Blender and glTF": (
        "blender",
        "0.5709 0.1691 0.2722 0.7559\n0.7805 0.4835 0.2087 0.3369",
        "gltf",
        "0.16907575 0.75588035 -0.27217138 0.57094753\n"
        "0.48353603 0.33687159 -0.20870360 0.78048271",
    ),
    "COLMAP and PyTorch3D": (
        "colmap",
        printed(MATRICES),
        "pytorch3d",
        printed(np.swapaxes(LEFT_UP @ MATRICES, 1, 2)),
    ),
    "COLMAP and OpenCV": (
        "colmap",
        printed(QUATERNIONS[:, SCALAR_FIRST]),
        "opencv solvepnp",
        printed(MATRICES),
    ),
    "OpenCV's Rodrigues": ("opencv", printed(ROTATION.as_rotvec()), "scipy", printed(MATRICES)),
    "OpenCV's solvePnP": (
        "opencv solvepnp",
        printed(ROTATION.as_rotvec()),
        "opencv solvepnp",
        printed(MATRICES),
    ),
}


@pytest.mark.parametrize("promise", PROMISES)
def test_programs_that_keep_their_promises_differ_by_nothing_else(promise):
    first_program, first, second_program, second = PROMISES[promise]
    explanation = explain(first, second, first_program=first_program, second_program=second_program)
    assert explanation.verdict == "same", str(explanation)


ANSWERS = json.loads(STORED.read_text("utf8"))


@pytest.mark.parametrize("program", ANSWERS)
def test_programs_that_were_run_answered_as_the_table_says(program):
    """``python -m tools.programs`` asks them anew."""
    assert PROGRAMS[program]["version"].endswith(ANSWERS[program]["version"])
    truth = np.array(
        [quaternion_from_axis_angle(np.array(axis), angle) for axis, angle in ORIENTATIONS]
    )
    for answer in ANSWERS[program]["answers"]:
        known = {
            name: answer["form"][name] for name in ("kind", "sequence") if name in answer["form"]
        }
        explanation = explain(
            truth,
            np.array(answer["numbers"]),
            first_program="this book",
            second_program=program,
            second_declared=known,
            noise=2e-5,
        )
        assert explanation.verdict == "same", (answer["asked"], str(explanation))


def test_what_claims_to_have_been_run_has_been():
    assert {name for name, facts in PROGRAMS.items() if facts["version"]} == {
        *ANSWERS,
        "SymPy mechanics",
    }


def test_what_goes_beyond_the_manuals_is_among_the_names_shown():
    explanation = explain(
        printed(QUATERNIONS),
        printed(QUATERNIONS * [-1, 1, -1, 1] * [-1, -1, -1, 1]),
        first_program="ros",
        second_program="unreal",
    )
    # Angles on the way explain the same numbers, so the true name stands among those shown.
    assert explanation.question and [
        name.declare
        for name in explanation.names
        if len(name.faults) == 1 and "the conjugate" in name.faults[0]
    ] == [
        (
            {"order": "xyzw", "way": "body in world"},
            {"order": "xyzw", "way": "world in body"},
        )
    ]


def test_a_program_is_called_by_a_part_of_its_name():
    assert (
        program_named("ros") == "ROS tf2 (C++)"
        and program_named("OPENCV") == "OpenCV"
        and len(PROGRAMS) >= 25
    )
    with pytest.raises(ValueError, match="several programs"):
        program_named("matlab")
    with pytest.raises(ValueError, match="unknown program"):
        program_named("Maya 2027")


def test_every_program_says_where_its_manual_stands():
    assert [
        name for name, facts in PROGRAMS.items() if not facts["manual"].startswith("https://")
    ] == ["this book"]
