"""The traps that the book warns of exist in the installed libraries, and not in the package.

If one of these tests fails after an update, a library has changed, and so must the page that
mentions it. Traps that a chapter's own cells show are tested there.
"""

import warnings

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import composed, rotation_error
from scipy.spatial.transform import Rotation

from orientation import (
    Frames,
    axis_angle_from_dcm,
    body_fixed_from_dcm,
    check_dcm,
    dcm_from_axis_angle,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    diagnose,
    same_orientation,
    simple_dcm,
)

psi, theta, phi = sm.symbols("psi, theta, varphi")
alpha, beta = sm.symbols("alpha, beta")


def frames_of_sympy(names):
    return (me.ReferenceFrame(name) for name in names)


# --- SymPy ----------------------------------------------------------------------------------------


def test_reference_frames_let_two_paths_contradict_each_other():
    N, A, B = frames_of_sympy("NAB")
    A.orient_axis(N, N.z, alpha)
    B.orient_axis(A, A.z, alpha)
    with pytest.warns(UserWarning, match="Loops are defined"):
        N.orient_axis(B, B.x, beta)
    assert not same_orientation(N.dcm(B), (B.dcm(A) * A.dcm(N)).T)


def test_orient_dcm_takes_a_reflection():
    N, A = frames_of_sympy("NA")
    A.orient_dcm(N, sm.diag(1, 1, -1))
    assert A.dcm(N).det() == -1
    with pytest.raises(ValueError, match="left-handed"):
        check_dcm(A.dcm(N))


def test_a_quaternion_that_is_not_of_unit_length_gives_no_direction_cosines():
    N, A = frames_of_sympy("NA")
    A.orient_quaternion(N, (1, 1, 0, 0))
    assert A.dcm(N) * A.dcm(N).T == 4 * sm.eye(3)
    quaternion = sm.symbols("q_0, q_i, q_j, q_k")
    A.orient_quaternion(N, quaternion)
    A_C_N = sm.Matrix(A.dcm(N))
    length = sm.sqrt(sum(entry**2 for entry in quaternion))
    assert (A_C_N * A_C_N.T - length**4 * sm.eye(3)).expand() == sm.zeros(3)
    with pytest.raises(ValueError, match="length 1.414"):
        dcm_from_quaternion((1, 1, 0, 0))


def test_orient_axis_sorts_its_arguments_by_type():
    N, A, B = frames_of_sympy("NAB")
    A.orient_axis(N, N.z, theta)
    B.orient_axis(N, theta, N.z)  # the opposite rotation, without a warning
    assert A.dcm(N) == B.dcm(N)


def test_sympy_multiplies_turns_about_one_axis_out():
    angles = sm.symbols("a:6")
    chain, joined = [me.ReferenceFrame("F0")], Frames()
    for k, angle in enumerate(angles):
        chain.append(me.ReferenceFrame(f"F{k + 1}"))
        chain[-1].orient_axis(chain[-2], chain[-2].z, angle)
        joined = joined.orient_axis(f"F{k + 1}", f"F{k}", "z", angle)
    theirs, ours = chain[-1].dcm(chain[0]), joined.dcm("F6", "F0")
    assert sm.count_ops(theirs) > 20 * sm.count_ops(ours) and same_orientation(theirs, ours)


def test_simplify_does_not_see_that_two_forms_are_equal():
    ours = dcm_from_body_fixed((psi, theta, phi), "zxz")
    rewritten = ours.applyfunc(lambda entry: entry.rewrite(sm.exp))
    difference = rewritten[0, 2] - ours[0, 2]
    assert sm.simplify(difference) != 0
    assert abs(difference.subs({psi: 0.3, theta: 0.5, phi: 0.7}).evalf()) < 1e-12
    assert same_orientation(rewritten, ours)


# --- SciPy ----------------------------------------------------------------------------------------

ANGLES = (0.1, 0.2, 0.3)


def test_scipy_1_17_wants_one_angle_for_each_axis_in_the_last_dimension():
    # Before 1.17 the first gave a stack of one rotation and the second a stack of two.
    assert Rotation.from_euler("z", [0.3]).as_matrix().shape == (3, 3)
    with pytest.raises(ValueError, match="last dimension of `angles`"):
        Rotation.from_euler("z", [0.3, 0.4])
    assert simple_dcm("z", [0.3]).shape == (1, 3, 3) and simple_dcm("z", [0.3, 0.4]).shape == (
        2,
        3,
        3,
    )


def test_scipy_repairs_without_a_word():
    skewed = composed(ANGLES, "zxy") + [[0, 0.1, 0], [0, 0, 0], [0, 0, 0]]
    repaired = Rotation.from_matrix(skewed).as_matrix()
    assert abs(repaired - skewed).max() > 0.01
    assert Rotation.from_quat((0, 0, 0, 2)).as_quat().tolist() == [0, 0, 0, 1]
    with pytest.raises(ValueError, match="not orthogonal: row"):
        check_dcm(skewed)
    with pytest.raises(ValueError, match="length 2"):
        dcm_from_quaternion((2, 0, 0, 0))


@pytest.mark.parametrize("sequence, lock", [("zxy", np.pi / 2), ("zxz", 0.0)])
def test_scipy_snaps_to_gimbal_lock_near_it(sequence, lock):
    dcm = composed((0.3, lock + 9e-8, 0.7), sequence)
    with pytest.warns(UserWarning, match="Gimbal lock detected"):
        theirs = Rotation.from_matrix(dcm.T).as_euler(sequence.upper())
    assert rotation_error(composed(theirs, sequence), dcm) > 1e-8
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ours = body_fixed_from_dcm(dcm, sequence)
    assert rotation_error(composed(ours, sequence), dcm) < 1e-14


# --- formulas -------------------------------------------------------------------------------------


def test_division_by_the_scalar_part_loses_the_axis_near_half_a_turn():
    dcm = dcm_from_axis_angle((1, 2, 3), np.pi - 1e-9)
    scalar = np.sqrt(max(1 + np.trace(dcm), 0)) / 2
    with np.errstate(all="ignore"):
        by_scalar = (dcm[1, 2] - dcm[2, 1]) / (4 * scalar)
    exact = 1 / np.sqrt(14)
    assert not abs(by_scalar - exact) < 1e-3
    assert abs(axis_angle_from_dcm(dcm)[0][0] - exact) < 1e-15


# --- the two slips of the source chapter ----------------------------------------------------------


def test_third_line_of_the_dot_product_block_is_about_a_z():
    N, A = frames_of_sympy("NA")
    A.orient_body_fixed(N, (psi, theta, phi), "zxy")
    third_line = sum((A.z.dot(n) * n for n in (N.x, N.y, N.z)), me.Vector(0))
    # Printed there with a_x on its left; it holds for a_z.
    for left, holds in ((A.z, True), (A.x, False)):
        components = (left - third_line).to_matrix(N)
        at_numbers = components.subs({psi: 0.3, theta: 0.5, phi: 0.7}).evalf()
        assert (max(map(abs, at_numbers)) < 1e-12) == holds


def test_answer_of_the_exercise_on_orient_explicit_is_the_transpose_of_what_is_asked():
    # Asked: orient D with respect to F about y through beta, that is, D_C_F.
    D, F = frames_of_sympy("DF")
    D.orient_axis(F, F.y, beta)
    asked = D.dcm(F)
    # Shown: a matrix called F_C_D, and F.orient_explicit(D, F_C_D.transpose()), then F.dcm(D).
    shown = sm.Matrix(
        [[sm.cos(beta), 0, -sm.sin(beta)], [0, 1, 0], [sm.sin(beta), 0, sm.cos(beta)]]
    )
    D, F = frames_of_sympy("DF")
    F.orient_explicit(D, shown.transpose())
    assert F.dcm(D) == shown and D.dcm(F) == asked.T != asked
    assert diagnose(D.dcm(F), asked).causes == (
        "it is the transpose, which is the inverse orientation",
        "beta has the wrong sign",
    )
    # Right:
    D, F = frames_of_sympy("DF")
    D_C_F = shown
    F.orient_explicit(D, D_C_F)
    assert D.dcm(F) == asked == simple_dcm("y", beta)
