"""The mathematics of the moving figures, run in Node, against the module: two languages, one book."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from orientations import angles_near, lock_angles, random_dcms, random_unit_vectors, rotation_error
from scipy.spatial.transform import Rotation, Slerp

import orientation as module
from orientation_figures.moving import bundle

LARGEST = 1e-12  # radians
NODE = Path(sys.executable).with_name("node")
OFFSETS = (0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3)
COORDINATE_HALF_TURNS = [np.diag(signs) for signs in ((1, -1, -1), (-1, 1, -1), (-1, -1, 1), (1, 1, 1))]
# Applies a function to each of many lists of arguments, which come as JSON.
APPLY = """
import { readFileSync } from 'node:fs';
const { jobs } = JSON.parse(readFileSync(0));
const functions = { NAMES };
console.log(JSON.stringify(jobs.map(([name, calls]) => calls.map((call) => functions[name](...call)))));
"""


@pytest.fixture(scope="session")
def in_browser_language(tmp_path_factory):
    """``run(name, *columns)``: the JavaScript function on each row of the columns, as a list."""
    names = bundle.EXPORT.findall(bundle.source("mathematics"))
    script = tmp_path_factory.mktemp("node") / "apply.mjs"
    script.write_text(bundle.body("mathematics") + APPLY.replace("NAMES", ", ".join(names)), "utf8")

    def run(name, *columns):
        calls = [[entry.tolist() if hasattr(entry, "tolist") else entry for entry in row] for row in zip(*columns)]
        done = subprocess.run(
            [NODE, script], input=json.dumps({"jobs": [[name, calls]]}), capture_output=True, text=True, check=True
        )
        return json.loads(done.stdout)[0]

    return run


def orientations():
    """More than 10,000: spread evenly, close to the identity and to half turns, and locked in every sequence."""
    axes = random_unit_vectors(60, 3)
    turns = [0, np.pi] + [base + sign * offset for base in (0, np.pi) for sign in (1, -1) for offset in OFFSETS[1:]]
    near = [module.dcm_from_axis_angle(axes, turn) for turn in turns]
    locked = [
        module.dcm_from_body_fixed(angles_near(middle, 40, seed, offset), sequence)
        for seed, sequence in enumerate(module.SEQUENCES)
        for middle in lock_angles(sequence)
        for offset in OFFSETS
    ]
    exact = np.array([half for half in COORDINATE_HALF_TURNS], dtype=float)
    quarter = np.array([module.simple_dcm(axis, turn * np.pi / 2) for axis in "xyz" for turn in (1, 2, 3)])
    return np.concatenate([random_dcms(5000, 1), *near, *locked, exact, quarter])


DCMS = orientations()


def test_there_are_enough():
    assert len(DCMS) > 10_000
    assert bundle.EXPORT.findall(bundle.source("mathematics")), "nothing is exported"


@pytest.mark.sampled(5)
@pytest.mark.parametrize("sequence", module.SEQUENCES)
@pytest.mark.parametrize("fixed", ["body", "space"])
def test_euler_angles(in_browser_language, sequence, fixed):
    back, there = f"{fixed}FixedFromDcm", f"dcmFrom{fixed.capitalize()}Fixed"
    python_there = getattr(module, f"dcm_from_{fixed}_fixed")
    names = [sequence] * len(DCMS)
    angles = np.array(in_browser_language(back, DCMS, names))
    assert rotation_error(python_there(angles, sequence), DCMS) < LARGEST
    assert rotation_error(in_browser_language(there, angles, names), python_there(angles, sequence)) < LARGEST
    # The same angles too, where they have a meaning of their own.
    expected = getattr(module, f"{fixed}_fixed_from_dcm")(DCMS, sequence)
    clear = module.gimbal_lock_margin(expected, sequence) > 1e-2
    apart = np.abs(np.angle(np.exp(1j * (angles - expected))))[clear]
    assert clear.sum() > 5000 and apart.max() < 1e-12


def test_angles_are_those_of_the_module_at_exact_lock(in_browser_language):
    for sequence in module.SEQUENCES:
        angles = np.array([module.body_fixed_from_dcm(dcm, sequence) for dcm in COORDINATE_HALF_TURNS])
        assert np.allclose(
            in_browser_language("bodyFixedFromDcm", COORDINATE_HALF_TURNS, [sequence] * 4), angles, rtol=0, atol=1e-15
        )
        margins = in_browser_language("gimbalLockMargin", angles, [sequence] * 4)
        assert np.allclose(margins, module.gimbal_lock_margin(angles, sequence), rtol=0, atol=1e-15)


def test_axis_and_angle(in_browser_language):
    found = in_browser_language("axisAngleFromDcm", DCMS)
    axes, angles = np.array([one["axis"] for one in found]), np.array([one["angle"] for one in found])
    assert rotation_error(module.dcm_from_axis_angle(axes, angles), DCMS) < LARGEST
    assert rotation_error(in_browser_language("dcmFromAxisAngle", axes, angles), DCMS) < LARGEST
    assert np.abs(angles - module.axis_angle_from_dcm(DCMS)[1]).max() < LARGEST
    quaternions = in_browser_language("quaternionFromAxisAngle", 2.5 * axes, angles)
    assert np.abs(quaternions - module.quaternion_from_axis_angle(axes, angles)).max() < LARGEST


def test_quaternions(in_browser_language):
    found = np.array(in_browser_language("quaternionFromDcm", DCMS))
    assert np.abs(found - module.quaternion_from_dcm(DCMS)).max() < LARGEST  # sign included
    assert rotation_error(in_browser_language("dcmFromQuaternion", found), DCMS) < LARGEST
    others = random_unit_vectors(len(found), 9, size=4)
    product = in_browser_language("multiplyQuaternions", found, others)
    assert np.abs(product - module.multiply_quaternions(found, others)).max() < LARGEST
    ones = np.array(in_browser_language("multiplyQuaternions", found, in_browser_language("conjugate", found)))
    assert np.abs(ones - [1, 0, 0, 0]).max() < LARGEST


def test_slerp_is_that_of_the_module_and_of_scipy(in_browser_language):
    first, second = random_unit_vectors(300, 5, size=4), random_unit_vectors(300, 6, size=4)
    second *= np.sign(np.sum(first * second, axis=1))[:, None]  # SciPy goes the short way
    second[:3] = first[:3]
    second[3] = (first[3] + 1e-10 * second[3]) / np.linalg.norm(first[3] + 1e-10 * second[3])
    parts = np.linspace(0, 1, 300)
    found = np.array(in_browser_language("slerp", first, second, parts))
    for q, p, part, between in zip(first, second, parts, found):
        ends = Rotation.from_quat([q, p], scalar_first=True)
        expected = Slerp([0, 1], ends)(part).as_quat(scalar_first=True)
        assert np.abs(between - module.interpolate_quaternions(q, p, part)).max() < LARGEST
        assert min(np.abs(between - expected).max(), np.abs(between + expected).max()) < LARGEST


def test_simple_matrices_and_products(in_browser_language):
    angles = np.linspace(-7, 7, 99)
    for axis in "xyz":
        assert (
            np.abs(in_browser_language("simpleDcm", [axis] * 99, angles) - module.simple_dcm(axis, angles)).max()
            < 1e-15
        )
    product = in_browser_language("multiply", DCMS[:500], DCMS[500:1000])
    assert np.abs(product - DCMS[:500] @ DCMS[500:1000]).max() < 1e-15
    vectors = random_unit_vectors(500, 2)
    assert (
        np.abs(in_browser_language("times", DCMS[:500], vectors) - np.einsum("nij,nj->ni", DCMS[:500], vectors)).max()
        < 1e-15
    )
    assert np.abs(np.array(in_browser_language("determinant", DCMS)) - 1).max() < LARGEST


def measured(count):
    source = np.random.default_rng(11)
    noise = source.normal(size=(count, 3, 3)) * source.choice((1e-9, 1e-3, 0.1, 0.5), (count, 1, 1))
    return random_dcms(count, 12) * source.uniform(0.2, 4, (count, 1, 1)) + noise


def test_nearest_matrix(in_browser_language):
    matrices = measured(3000)
    scales = np.linalg.svd(matrices, compute_uv=False)
    gap = scales[:, 1] + np.sign(np.linalg.det(matrices)) * scales[:, 2]
    matrices = matrices[gap > 0.05 * scales[:, 0]]  # close to several equally near ones no method is exact
    assert len(matrices) > 2500 and (np.linalg.det(matrices) < 0).any()
    expected = module.nearest_dcm(matrices)
    found = in_browser_language("nearestDcm", matrices)
    assert rotation_error([one["dcm"] for one in found], expected.dcm) < LARGEST
    assert np.abs(np.array([one["distance"] for one in found]) - expected.distance).max() < LARGEST


SEVERAL_NEAREST = [
    np.diag((1, 1, -1)),
    np.zeros((3, 3)),
    np.diag((2, 0, 0)),
    np.outer((1, 2, 3), (0.1, -0.4, 2)),
    -np.eye(3),
]


@pytest.mark.parametrize("matrix", SEVERAL_NEAREST)
def test_no_nearest_matrix_where_several_are_equally_near(in_browser_language, matrix):
    with pytest.raises(ValueError, match="equally near"):
        module.nearest_dcm(matrix)
    assert in_browser_language("nearestDcm", [np.asarray(matrix, dtype=float)])[0]["dcm"] is None


def words_of_the_module(matrix):
    try:
        module.check_dcm(matrix)
    except ValueError as error:
        return str(error)
    return ""


def test_faults_are_told_in_the_words_of_check_dcm(in_browser_language):
    valid = np.array(DCMS[:200])
    matrices = [
        *valid, *measured(400), *valid.round(3), *valid.round(1), *(valid * [[1], [1], [-1]]), *(1.2 * valid[:20]),
        *(valid + 3e-10 * np.eye(3)), *(valid + 1e-7), *(valid[:, [1, 0, 2]]), np.zeros((3, 3)), 1e-5 * np.eye(3),
        3e7 * np.eye(3),
    ]  # fmt: skip
    expected = [words_of_the_module(matrix) for matrix in matrices]
    assert {message.split(":")[0] for message in expected} == {
        "",
        "dcm is not orthogonal",
        "dcm is orthogonal but left-handed",
    }
    assert in_browser_language("checkDcm", matrices) == expected


def test_both_know_the_same_sequences(tmp_path):
    script = tmp_path / "sequences.mjs"
    script.write_text(bundle.body("mathematics") + "console.log(JSON.stringify([PROPER_EULER, TAIT_BRYAN]));")
    found = json.loads(subprocess.run([NODE, script], capture_output=True, text=True, check=True).stdout)
    assert [tuple(names) for names in found] == [module.PROPER_EULER, module.TAIT_BRYAN]
