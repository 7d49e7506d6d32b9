"""The mathematics of the moving figures, run in Node, against
the module: two languages, one book.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from orientations import angles_near, lock_angles, random_dcms, random_unit_vectors, rotation_error
from scipy.spatial.transform import Rotation, Slerp

import orientation as module
from orientation_figures.moving import bundle, formulas
from orientation_workbench.formulas import FORMULAS, LISTS, SIZES

LARGEST = 1e-12  # radians
NODE = Path(sys.executable).with_name("node")
# Applies a function to each of many lists of arguments, which come as JSON, a line for each.
APPLY = """
import { createInterface } from 'node:readline';
const functions = { NAMES };
for await (const line of createInterface({ input: process.stdin })) {
  const [name, calls] = JSON.parse(line);
  console.log(JSON.stringify(calls.map((call) => functions[name](...call))));
}
"""


@pytest.fixture(scope="session")
def in_browser_language(tmp_path_factory):
    """``run(name, *columns)``: the JavaScript function on each row of the columns, as a list."""
    names = [
        name
        for module_name in ("formulas", "mathematics")
        for name in bundle.EXPORT.findall(bundle.source(module_name))
    ]
    script = tmp_path_factory.mktemp("node") / "apply.mjs"
    body = bundle.body("formulas") + bundle.body("mathematics")
    script.write_text(body + APPLY.replace("NAMES", ", ".join(names)), "utf8")

    def run(name, *columns):
        calls = [
            [entry.tolist() if hasattr(entry, "tolist") else entry for entry in row]
            for row in zip(*columns)
        ]
        print(json.dumps([name, calls]), file=node.stdin, flush=True)
        return json.loads(node.stdout.readline())

    # To start it takes longer than any of its answers.
    with subprocess.Popen(
        [NODE, script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as node:
        yield run


def test_the_formulas_are_those_that_the_module_makes():
    assert formulas.FILE.read_text("utf8") == formulas.text(), f"run `{formulas.COMMAND}`"


NEAR = (0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3)


def orientations(sequence="zxy"):
    """Spread evenly, close to the identity and to half turns, and locked in a sequence."""
    axes = random_unit_vectors(10, 3)
    turns = [base + sign * offset for base in (0, np.pi) for sign in (1, -1) for offset in NEAR]
    locked = [
        module.dcm_from_body_fixed(angles_near(middle, 10, 1, offset), sequence)
        for middle in lock_angles(sequence)
        for offset in NEAR
    ]
    half_turns = [np.diag(signs) for signs in ((1.0, -1, -1), (-1, 1, -1), (-1, -1, 1), (1, 1, 1))]
    return np.concatenate(
        [
            random_dcms(300, 1),
            *(module.dcm_from_axis_angle(axes, turn) for turn in turns),
            *locked,
            half_turns,
        ]
    )


CALLS = [
    (name, choice) for name, choices in formulas.NAMES.items() for choice in choices or (None,)
]


def arguments_for(kind, seed, choice):
    random = np.random.default_rng(seed)
    if kind == "matrix":
        return orientations(choice or "zxy")
    size = SIZES[kind]
    if kind == "quaternion":
        return random_unit_vectors(300, seed, size=4)
    return random.normal(size=(300, size)) if kind in LISTS else np.linspace(-7, 7, 300)


@pytest.mark.parametrize("name, choice", CALLS)
def test_formulas_give_what_the_module_gives(in_browser_language, name, choice):
    """Recorded from the module, and still held to its numbers: the
    recording itself could be wrong.
    """
    columns = [
        arguments_for(kind, seed, choice) for seed, kind in enumerate(FORMULAS[name][0].values())
    ]
    count = min(map(len, columns))
    columns = [column[:count] for column in columns]
    chosen = [] if choice is None else [choice]
    first = name == "simple_dcm"
    expected = getattr(module, name)(*(chosen * first), *columns, *(chosen * (not first)))
    lists = [[choice] * count] * len(chosen)
    computed = np.array(
        in_browser_language(
            formulas.camel(name), *(lists * first), *columns, *(lists * (not first))
        )
    )
    # Where the angles have no meaning of their own, the orientation has.
    if name == "body_fixed_from_dcm":
        make = module.dcm_from_body_fixed
        assert rotation_error(make(computed, choice), columns[0]) < LARGEST
        clear = module.gimbal_lock_margin(expected, choice) > 1e-2
        assert (
            clear.sum() > 250
            and np.abs(np.angle(np.exp(1j * (computed - expected))))[clear].max() < LARGEST
        )
        exact = columns[0][-4:]
        assert np.allclose(
            computed[-4:],
            [module.body_fixed_from_dcm(dcm, choice) for dcm in exact],
            rtol=0,
            atol=1e-15,
        )
    else:
        assert np.abs(computed - expected).max() < LARGEST


def test_what_is_made_of_formulas(in_browser_language):
    dcms = orientations()
    computed = in_browser_language("axisAngleFromDcm", dcms)
    axes, angles = map(np.array, zip(*computed))
    assert rotation_error(module.dcm_from_axis_angle(axes, angles), dcms) < LARGEST
    assert np.abs(angles - module.axis_angle_from_dcm(dcms)[1]).max() < LARGEST
    for sequence in ("zxz", "xyz"):
        names = [sequence] * len(dcms)
        angles = np.array(in_browser_language("spaceFixedFromDcm", dcms, names))
        assert rotation_error(module.dcm_from_space_fixed(angles, sequence), dcms) < LARGEST
        assert (
            rotation_error(in_browser_language("dcmFromSpaceFixed", angles, names), dcms) < LARGEST
        )
    matrices, vectors = (
        np.random.default_rng(8).normal(size=(200, 3, 3)),
        random_unit_vectors(200, 2),
    )
    solved = np.array(in_browser_language("solve", matrices, vectors))
    assert np.abs(np.einsum("nij,nj->ni", matrices, solved) - vectors).max() < 1e-9
    product = in_browser_language("multiply", matrices[:100], matrices[100:])
    assert np.abs(product - matrices[:100] @ matrices[100:]).max() < 1e-14


def test_slerp_is_that_of_the_module_and_of_scipy(in_browser_language):
    first, second = random_unit_vectors(300, 5, size=4), random_unit_vectors(300, 6, size=4)
    second *= np.sign(np.sum(first * second, axis=1))[:, None]  # SciPy goes the short way
    second[:3] = first[:3]
    second[3] = (first[3] + 1e-10 * second[3]) / np.linalg.norm(first[3] + 1e-10 * second[3])
    parts = np.linspace(0, 1, 300)
    computed = np.array(in_browser_language("slerp", first, second, parts))
    for q, p, part, between in zip(first, second, parts, computed):
        ends = Rotation.from_quat([q, p], scalar_first=True)
        expected = Slerp([0, 1], ends)(part).as_quat(scalar_first=True)
        assert np.abs(between - module.interpolate_quaternions(q, p, part)).max() < LARGEST
        assert min(np.abs(between - expected).max(), np.abs(between + expected).max()) < LARGEST


def measured(count):
    source = np.random.default_rng(11)
    noise = source.normal(size=(count, 3, 3)) * source.choice((1e-9, 1e-3, 0.1, 0.5), (count, 1, 1))
    return random_dcms(count, 12) * source.uniform(0.2, 4, (count, 1, 1)) + noise


def test_nearest_matrix(in_browser_language):
    matrices = measured(3000)
    scales = np.linalg.svd(matrices, compute_uv=False)
    gap = scales[:, 1] + np.sign(np.linalg.det(matrices)) * scales[:, 2]
    # Close to several equally near ones no method is exact.
    matrices = matrices[gap > 0.05 * scales[:, 0]]
    assert len(matrices) > 2500 and (np.linalg.det(matrices) < 0).any()
    expected = module.nearest_dcm(matrices)
    computed = in_browser_language("nearestDcm", matrices)
    assert rotation_error([nearest["dcm"] for nearest in computed], expected.dcm) < LARGEST
    assert (
        np.abs(np.array([nearest["distance"] for nearest in computed]) - expected.distance).max()
        < LARGEST
    )


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
    valid = orientations()[:200]
    matrices = [
        *valid, *measured(400), *valid.round(3), *valid.round(1), *(valid * [[1], [1], [-1]]),
        *(1.2 * valid[:20]), *(valid + 3e-10 * np.eye(3)), *(valid + 1e-7), *(valid[:, [1, 0, 2]]),
        np.zeros((3, 3)), 1e-5 * np.eye(3), 3e7 * np.eye(3),
    ]  # fmt: skip
    expected = [words_of_the_module(matrix) for matrix in matrices]
    assert {message.split(":")[0] for message in expected} == {
        "",
        "dcm is not orthogonal",
        "dcm is orthogonal but left-handed",
    }
    assert in_browser_language("checkDcm", matrices) == expected
