"""The kit for tests: five libraries are as their manuals say, and every
copy with one thing flipped is caught.
"""

import warnings

import numpy as np
import pytest
import pytransform3d.rotations as pr
import sympy as sm
import sympy.physics.mechanics as me
from scipy.spatial.transform import Rotation

with warnings.catch_warnings():  # of its docstrings, where it has never been imported before
    warnings.simplefilter("ignore")
    import ahrs

import orientation
from orientation_workbench import assert_convention, convention_of


def sympy_matrix(angles):
    A, N = me.ReferenceFrame("A"), me.ReferenceFrame("N")
    A.orient_body_fixed(N, tuple(angles), "zxy")
    return np.array(A.dcm(N), float)


def sympy_quaternion(axis, angle):
    return np.array(sm.Quaternion.from_axis_angle(tuple(axis), angle).args[:4], float)


#: For each library a function, what it takes, and what its manual says of it.
LIBRARIES = {
    "SciPy's angles": (
        lambda a: Rotation.from_euler("ZXY", a).as_matrix(),
        "Euler angles",
        {"sequence": "zxy", "inverse": True},
    ),
    "SciPy's space fixed angles": (
        lambda a: Rotation.from_euler("zxy", a).as_matrix(),
        "Euler angles",
        {"sequence": "zxy", "turns": "space fixed", "inverse": True},
    ),
    "SciPy's vector": (
        lambda v: Rotation.from_rotvec(v).as_quat(),
        "rotation vector",
        {"order": "xyzw"},
    ),
    "pytransform3d's angles": (
        lambda a: pr.matrix_from_euler(a, 2, 0, 1, extrinsic=False),
        "Euler angles",
        {"sequence": "zxy", "inverse": True},
    ),
    "pytransform3d's quaternion": (pr.matrix_from_quaternion, "quaternion", {"inverse": True}),
    "SymPy's angles": (sympy_matrix, "Euler angles", {"sequence": "zxy"}),
    "SymPy's quaternion": (sympy_quaternion, "axis and angle", {}),
    "AHRS's quaternion": (lambda q: ahrs.Quaternion(q).to_DCM(), "quaternion", {"inverse": True}),
    "AHRS's matrix": (lambda m: ahrs.DCM(m).to_quaternion(), "matrix", {"inverse": True}),
    "this book's angles": (
        lambda a: orientation.dcm_from_body_fixed(a, "zxy"),
        "Euler angles",
        {"sequence": "zxy"},
    ),
    "this book's quaternion": (orientation.quaternion_from_dcm, "matrix", {}),
}
NO_TURN = {
    "Euler angles": (np.zeros(3),),
    "rotation vector": (np.zeros(3),),
    "axis and angle": (np.array([1.0, 0, 0]), 0.0),
    "quaternion": (np.array([1.0, 0, 0, 0]),),
    "matrix": (np.eye(3),),
}
MIRROR = np.diag([1.0, -1, 1])


def with_result(change):
    return lambda function, takes: (
        lambda *arguments: change(np.asarray(function(*arguments), float))
    )


def other_hand(result):
    return result * [1, -1, 1, -1] if result.shape == (4,) else MIRROR @ result @ MIRROR


def inverted(function, takes):
    """A copy that gives the transpose; of a quaternion the
    conjugate, wherever its scalar stands.
    """
    scalar = np.argmax(np.abs(np.ravel(function(*NO_TURN[takes]))))

    def flipped(*arguments):
        result = np.asarray(function(*arguments), float)
        return result.T if result.ndim == 2 else np.where(np.arange(4) == scalar, result, -result)

    return flipped


def in_degrees(function, takes):
    """A copy that reads its angles as degrees, if it takes any."""
    if takes == "axis and angle":
        return lambda axis, angle: function(axis, np.radians(angle))
    return (
        (lambda angles: function(np.radians(angles)))
        if takes in ("Euler angles", "rotation vector")
        else None
    )


def other_turns(function, takes):
    return (lambda angles: function(angles[::-1])) if takes == "Euler angles" else None


FLIPS = {
    "transposed or conjugate": inverted,
    "reordered": with_result(lambda r: r[[1, 2, 0]] if r.ndim == 2 else np.roll(r, -1)),
    "the other hand": with_result(other_hand),
    "degrees": in_degrees,
    "angles reversed": other_turns,
}


@pytest.mark.parametrize("name", LIBRARIES)
def test_a_library_has_the_convention_of_its_manual(name):
    function, takes, expected = LIBRARIES[name]
    assert_convention(function, takes, **expected)


# Libraries with the same convention give the same numbers, so one of them is enough.
@pytest.mark.parametrize("flip", FLIPS)
@pytest.mark.parametrize(
    "name", {str(convention): name for name, (_, *convention) in LIBRARIES.items()}.values()
)
def test_every_flipped_copy_is_caught(name, flip):
    function, takes, expected = LIBRARIES[name]
    if (flipped := FLIPS[flip](function, takes)) is None:
        return  # nothing of that kind goes in
    with pytest.raises(AssertionError, match="a different convention from the one expected"):
        assert_convention(flipped, takes, **expected)


def test_what_is_found_is_said_in_words():
    convention = convention_of(lambda q: Rotation.from_quat(q).as_matrix(), "quaternion")
    assert (
        convention.takes == {"order": "xyzw"}
        and convention.inverse
        and "scalar part comes last" in str(convention)
    )


@pytest.mark.parametrize(
    "call, words",
    [
        (
            lambda: convention_of(lambda q: np.eye(3)[[1, 2, 0]], "quaternion"),
            "no convention known to this kit",
        ),
        (lambda: convention_of(lambda q: 2 * np.eye(3), "quaternion"), "not a rotation"),
        (lambda: convention_of(lambda q: np.eye(3), "spinor"), "can take"),
        (
            lambda: assert_convention(lambda q: np.eye(3), "quaternion", sens="other"),
            "sens is not known",
        ),
    ],
)
def test_no_convention_is_told(call, words):
    with pytest.raises(ValueError, match=words):
        call()
