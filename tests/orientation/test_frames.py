"""A graph of named frames: the right product over every path, and no stale matrices."""

import itertools

import numpy as np
import pytest
import sympy as sm
from orientations import composed, random_dcms, random_unit_vectors, rotation_error

import orientation
from orientation import (
    Frames,
    check_dcm,
    dcm_from_axis_angle,
    dcm_from_body_fixed,
    dcm_from_quaternion,
    same_orientation,
    simple_dcm,
)

psi, theta, phi = SYMBOLS = sm.symbols("psi, theta, varphi")


@pytest.fixture
def gimbal():
    return (
        Frames()
        .orient_axis("B", "A", "z", psi)
        .orient_axis("C", "B", "x", theta)
        .orient_axis("D", "C", "y", phi)
    )


# --- products over paths --------------------------------------------------------------------------


def test_camera_in_handgrip(gimbal):
    assert (gimbal.dcm("D", "A") - composed(SYMBOLS, "zxy")).expand() == sm.zeros(3)
    assert (gimbal.dcm("A", "D") - composed(SYMBOLS, "zxy").T).expand() == sm.zeros(3)
    assert gimbal.dcm("B", "A") == simple_dcm("z", psi)
    assert gimbal.dcm("A", "B") == simple_dcm("z", -psi)
    assert gimbal.dcm("C", "C") == sm.eye(3)
    assert gimbal.path("D", "A") == "D - C - B - A"
    assert gimbal.path("A", "C") == "A - B - C"
    assert gimbal.path("B", "B") == "B"


def random_tree(seed, count=6):
    """Return the edges of a random tree, joined in random order.

    Each edge is given from either end, in every possible form.
    """
    source = np.random.default_rng(seed)
    names = [f"F{k}" for k in range(count)]
    edges = [(names[k], names[source.integers(k)]) for k in range(1, count)]
    source.shuffle(edges)
    frames, truth = Frames(), {}
    for k, edge in enumerate(edges):
        frame, reference = (str(name) for name in edge[:: source.choice((1, -1))])
        angle, kind = float(source.uniform(-3, 3)), (seed + k) % 5
        if kind == 0:
            axis = "xyz"[source.integers(3)]
            frames, dcm = (
                frames.orient_axis(frame, reference, axis, angle),
                composed((angle,), axis),
            )
        elif kind == 1:
            axis = source.normal(size=3)
            frames, dcm = (
                frames.orient_axis(frame, reference, axis, angle),
                dcm_from_axis_angle(axis, angle),
            )
        elif kind == 2:
            angles = source.uniform(-3, 3, 3)
            frames, dcm = (
                frames.orient_body_fixed(frame, reference, angles, "xzx"),
                composed(angles, "xzx"),
            )
        elif kind == 3:
            quaternion = random_unit_vectors(1, seed + k, size=4)[0]
            frames, dcm = (
                frames.orient_quaternion(frame, reference, quaternion),
                dcm_from_quaternion(quaternion),
            )
        else:
            dcm = random_dcms(1, seed + k)[0]
            frames = frames.orient_dcm(frame, reference, dcm)
        truth[frame, reference], truth[reference, frame] = dcm, dcm.T
    return frames, names, complete(truth, names)


def complete(truth, names):
    """Return every pair's matrix, by multiplying the known ones until none is missing."""
    truth = {**truth, **{(name, name): np.eye(3) for name in names}}
    while len(truth) < len(names) ** 2:
        for (a, b), (c, d) in itertools.product(list(truth), repeat=2):
            if b == c and (a, d) not in truth:
                truth[a, d] = truth[a, b] @ truth[c, d]
    return truth


@pytest.mark.parametrize("seed", range(5))
def test_trees_of_every_shape_both_ways_and_as_reference_frames(seed):
    frames, names, truth = random_tree(seed)
    sympy_frames = frames.reference_frames()
    assert set(sympy_frames) == set(names)
    for target, source in itertools.product(names, repeat=2):
        dcm = frames.dcm(target, source)
        check_dcm(dcm)
        assert rotation_error(dcm, truth[target, source]) < 1e-14
        # The truth comes from a separate path; SymPy's frames use the given one.
        assert rotation_error(sympy_frames[target].dcm(sympy_frames[source]), dcm) < 1e-14


def test_frames_given_from_either_end_and_trees_joined_later():
    frames = (
        Frames()
        .orient_axis("A", "B", "z", psi)
        .orient_axis("C", "D", "x", theta)
        .orient_axis("B", "C", "y", phi)
    )
    assert frames.path("A", "D") == "A - B - C - D"
    expected = simple_dcm("z", psi) * simple_dcm("y", phi) * simple_dcm("x", theta)
    assert (frames.dcm("A", "D") - expected).expand() == sm.zeros(3)
    sympy_frames = frames.reference_frames()
    for target, source in itertools.product("ABCD", repeat=2):
        ours, theirs = frames.dcm(target, source), sympy_frames[target].dcm(sympy_frames[source])
        assert (ours - theirs).expand() == sm.zeros(3)


def test_reference_frames_of_several_trees():
    frames = Frames().orient_axis("A", "N", "z", psi).orient_axis("C", "B", "x", theta)
    made = frames.reference_frames()
    assert made["A"].dcm(made["N"]) == simple_dcm("z", psi)
    assert made["C"].dcm(made["B"]) == simple_dcm("x", theta)
    with pytest.raises(ValueError, match="no path of orientations connects C and A"):
        frames.dcm("C", "A")


def test_symbols_and_numbers_mix(gimbal):
    mixed = (
        gimbal.orient_axis("E", "D", "z", 0.3)
        .orient_quaternion("F", "E", (0.6, 0, 0.8, 0))
        .orient_dcm("G", "F", simple_dcm("x", 0.1))
        .orient_axis("H", "G", (0, 0.5, 0), psi)
    )
    expected = (
        simple_dcm("y", psi)
        * sm.Matrix(
            simple_dcm("x", 0.1) @ dcm_from_quaternion((0.6, 0, 0.8, 0)) @ simple_dcm("z", 0.3)
        )
        * composed(SYMBOLS, "zxy")
    )
    assert same_orientation(mixed.dcm("H", "A"), expected)
    assert isinstance(mixed.dcm("E", "D"), np.ndarray)
    made = mixed.reference_frames()
    assert same_orientation(made["H"].dcm(made["A"]), expected)


# --- batches --------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [np.array, list, tuple])
def test_batches(kind):
    many, few = np.linspace(-3, 3, 7), np.linspace(0, 1, 7)
    frames = (
        Frames()
        .orient_axis("B", "A", "z", kind(many))
        .orient_axis("C", "B", "z", kind(few))
        .orient_axis("D", "C", [0, 2, 0], kind(few))
        .orient_axis("E", "D", "x", 0.2)
    )
    expected = np.array([composed((a + b, b, 0.2), "zyx") for a, b in zip(many, few)])
    assert frames.dcm("E", "A").shape == (7, 3, 3)
    assert rotation_error(frames.dcm("E", "A"), expected) < 1e-14
    assert rotation_error(frames.dcm("A", "E"), expected.swapaxes(1, 2)) < 1e-14
    angles = np.random.default_rng(1).normal(size=(2, 7, 3))
    frames = frames.orient_body_fixed("G", "E", angles, "zxz").orient_dcm(
        "H", "G", random_dcms(7, 2)
    )
    assert frames.dcm("H", "A").shape == (2, 7, 3, 3)
    assert (
        rotation_error(
            frames.dcm("H", "A"), random_dcms(7, 2) @ dcm_from_body_fixed(angles, "zxz") @ expected
        )
        < 1e-14
    )
    axes = random_unit_vectors(7, 3).tolist()
    assert (
        rotation_error(
            Frames().orient_axis("B", "A", axes, 0.3).dcm("B", "A"), dcm_from_axis_angle(axes, 0.3)
        )
        == 0
    )


@pytest.mark.parametrize("axis", "zx")
@pytest.mark.parametrize(
    "second, words",
    [
        (
            np.zeros(3),
            r"batches along this path have incompatible shapes: \(2,\) and \(3,\)",
        ),
        (psi, "this path has both symbols and a batch"),
    ],
)
def test_batches_that_do_not_fit_are_refused(axis, second, words):
    frames = Frames().orient_axis("B", "A", "z", np.zeros(2)).orient_axis("C", "B", axis, second)
    with pytest.raises(ValueError, match=words):
        frames.dcm("C", "A")


@pytest.mark.parametrize(
    "frames",
    [
        Frames().orient_axis("B", "A", "z", np.zeros(2)),
        Frames().orient_dcm("B", "A", random_dcms(2, 1)),
        Frames().orient_body_fixed("B", "A", np.zeros((2, 3)), "zxy"),
    ],
)
def test_a_batch_is_no_reference_frame(frames):
    with pytest.raises(
        ValueError, match=r"B in A is a batch of shape \(2,\), but a ReferenceFrame holds one"
    ):
        frames.reference_frames()


# --- successive turns about one axis are joined ---------------------------------------------------


def test_chain_of_twelve_turns_about_z_stays_small():
    angles = sm.symbols("a:12")
    frames = Frames()
    for k, angle in enumerate(angles):
        frames = frames.orient_axis(f"F{k + 1}", f"F{k}", "z", angle)
    dcm = frames.dcm("F12", "F0")
    assert dcm == simple_dcm("z", sum(angles))
    assert sm.count_ops(dcm) < 60
    assert frames.dcm("F0", "F12") == simple_dcm("z", -sum(angles))
    assert frames.dcm("F3", "F1") == simple_dcm("z", angles[1] + angles[2])


def test_turns_are_joined_within_and_across_orientations():
    frames = Frames().orient_body_fixed("B", "A", SYMBOLS, "zxz").orient_axis("C", "B", "z", -phi)
    expected = simple_dcm("x", theta) * simple_dcm("z", psi)
    assert (frames.dcm("C", "A") - expected) == sm.zeros(3)


def test_turns_about_other_axes_are_not_joined():
    frames = (
        Frames()
        .orient_axis("B", "A", "z", psi)
        .orient_axis("C", "B", "x", theta)
        .orient_axis("D", "C", "z", -psi)
    )
    assert not same_orientation(frames.dcm("D", "A"), simple_dcm("x", theta))
    frames = Frames().orient_axis("B", "A", "z", 0.1).orient_axis("C", "B", (0, 0, 1), 0.2)
    assert rotation_error(frames.dcm("C", "A"), simple_dcm("z", 0.3)) < 1e-15


# --- nothing goes stale ---------------------------------------------------------------------------


def test_orienting_leaves_the_frames_as_they_were():
    empty = Frames()
    first = empty.orient_axis("A", "N", "z", psi)
    second = first.orient_axis("B", "A", "x", theta)
    alternative = first.orient_axis("B", "A", "y", theta)
    assert (
        repr(empty) == "Frames()"
        and repr(first) == "Frames(A in N)"
        and repr(second) == "Frames(A in N, B in A)"
    )
    with pytest.raises(
        ValueError, match=r"no frame named 'A' in this Frames\(\): it is still empty"
    ):
        empty.dcm("A", "N")
    with pytest.raises(ValueError, match=r"no frame named 'B' in this Frames\(\): it has A, N"):
        first.dcm("B", "N")
    assert not same_orientation(second.dcm("B", "N"), alternative.dcm("B", "N"))


ORIENTATIONS = {
    "axis": lambda frames, x: frames.orient_axis("D", "A", "z", x),
    "other axis": lambda frames, x: frames.orient_axis("D", "A", (1, 2, 3), x),
    "body fixed": lambda frames, x: frames.orient_body_fixed("D", "A", (x, 0.2, 0.3), "zxy"),
    "matrix": lambda frames, x: frames.orient_dcm("D", "A", simple_dcm("z", x)),
    "quaternion": lambda frames, x: frames.orient_quaternion(
        "D",
        "A",
        (np.cos(x), 0, 0, np.sin(x)) if isinstance(x, float) else (sm.cos(x), 0, 0, sm.sin(x)),
    ),
}


@pytest.mark.parametrize("angle, changed", [(psi, theta), (0.1, 0.2), (psi, 0.2)])
@pytest.mark.parametrize("orientation", ORIENTATIONS.values(), ids=ORIENTATIONS)
def test_a_cell_can_be_run_again_but_not_with_another_answer(orientation, angle, changed):
    frames = orientation(Frames().orient_axis("A", "N", "x", phi), angle)
    assert orientation(frames, angle) is frames
    # The same orientation, from the other end.
    assert frames.orient_dcm("A", "D", frames.dcm("A", "D")) is frames
    with pytest.raises(
        ValueError, match="D and A are already connected, by D - A: a second path could contradict"
    ):
        orientation(frames, changed)


def test_a_cell_can_be_run_again_with_another_form_of_the_same_orientation(gimbal):
    assert gimbal.orient_axis("B", "A", "z", psi + 2 * sm.pi) is gimbal
    assert gimbal.orient_axis("A", "B", "z", -psi) is gimbal
    assert gimbal.orient_axis("B", "A", (0, 0, 3), psi) is gimbal


def test_a_second_path_is_refused_and_the_first_is_named(gimbal):
    for frame, reference, path in (
        ("D", "A", "D - C - B - A"),
        ("A", "D", "A - B - C - D"),
        ("C", "A", "C - B - A"),
    ):
        with pytest.raises(
            ValueError, match=f"{frame} and {reference} are already connected, by {path}:"
        ):
            gimbal.orient_axis(frame, reference, "z", 1)
    with pytest.raises(ValueError, match="already connected"):
        gimbal.orient_dcm("D", "A", gimbal.dcm("D", "A"))


def test_a_batch_run_again_with_other_data():
    frames = Frames().orient_axis("B", "A", "z", np.zeros(3))
    assert frames.orient_axis("B", "A", "z", np.zeros(3)) is frames
    for other_angle in (np.ones(3), np.zeros(2), 0.0):
        with pytest.raises(ValueError, match="already connected"):
            frames.orient_axis("B", "A", "z", other_angle)
    empty = Frames().orient_axis("B", "A", "z", np.zeros(0))
    assert empty.orient_axis("B", "A", "z", np.zeros(0)) is empty


def test_what_was_given_can_change_afterwards():
    angle, angles, axis = np.array([0.1, 0.2]), np.array([0.1, 0.2, 0.3]), np.array([0.0, 1, 0])
    dcm, matrix, quaternion = simple_dcm("x", 0.3), simple_dcm("x", psi), np.array([1.0, 0, 0, 0])
    frames = (
        Frames()
        .orient_axis("B", "A", "z", angle)
        .orient_axis("C", "B", axis, angle)
        .orient_body_fixed("D", "C", angles, "zxy")
        .orient_dcm("E", "D", dcm)
        .orient_quaternion("F", "E", quaternion)
        .orient_dcm("M", "N", matrix)
    )
    before = frames.dcm("F", "A"), frames.dcm("M", "N")
    for argument in (angle, angles, axis, dcm, quaternion, matrix):
        argument[0] = 7
    assert (frames.dcm("F", "A") == before[0]).all() and frames.dcm("M", "N") == before[1]


def test_a_zero_that_was_given_has_no_sign():
    negative = np.where(np.eye(3) == 0, -0.0, 1.0)
    dcm = Frames().orient_dcm("A", "N", negative).dcm("A", "N")
    assert (dcm == np.eye(3)).all() and not np.signbit(dcm).any()
    frames = Frames().orient_axis("A", "N", (-0.0, 0, 1), -0.0)
    assert r"(0, 0, 1),\ 0}" in str(frames.equation("A", "N"))


def test_what_was_returned_can_change_afterwards():
    frames = (
        Frames()
        .orient_dcm("A", "N", simple_dcm("x", 0.3))
        .orient_dcm("C", "B", simple_dcm("x", psi))
        .orient_dcm("E", "D", random_dcms(2, 1))
    )
    for pair in (("A", "N"), ("C", "B"), ("E", "D"), ("A", "A")):
        before = frames.dcm(*pair)
        frames.dcm(*pair)[0, 0] = 7
        assert same_orientation(frames.dcm(*pair), before)


@pytest.mark.parametrize("kind", [np.uint8, np.int8, int, np.float32, np.float64, sm.Integer])
def test_every_kind_of_number_turns_back_and_joins(kind):
    frames = Frames().orient_axis("B", "A", "z", kind(100)).orient_axis("C", "B", "z", kind(100))
    assert rotation_error(sm.Matrix(frames.dcm("C", "A")).evalf(), simple_dcm("z", 200.0)) < 1e-14
    assert rotation_error(sm.Matrix(frames.dcm("A", "B")).evalf(), simple_dcm("z", -100.0)) < 1e-14


# --- the equation ---------------------------------------------------------------------------------


def test_equation(gimbal):
    tex = str(gimbal.equation("D", "A"))
    assert tex == (
        r"{}^{D}\mathbf{C}^{A} = "
        r"\underbrace{{}^{D}\mathbf{C}^{C}}_{y,\ \varphi}\; "
        r"\underbrace{{}^{C}\mathbf{C}^{B}}_{x,\ \theta}\; "
        r"\underbrace{{}^{B}\mathbf{C}^{A}}_{z,\ \psi}"
    )
    assert gimbal.equation("D", "A")._repr_latex_() == rf"$\displaystyle {tex}$"
    back = str(gimbal.equation("A", "B"))
    assert back == r"{}^{A}\mathbf{C}^{B} = \underbrace{{}^{A}\mathbf{C}^{B}}_{z,\ - \psi}"
    assert str(gimbal.equation("A", "A")) == r"{}^{A}\mathbf{C}^{A} = \mathbf{I}"


def test_equation_tells_what_each_factor_is():
    frames = (
        Frames()
        .orient_axis("B", "A", (0, 1, 1), 0.5)
        .orient_dcm("C", "B", simple_dcm("x", psi))
        .orient_quaternion("D", "C", (1, 0, 0, 0))
        .orient_axis("E_1", "D", "z", np.zeros(3))
        .orient_body_fixed("F", "E_1", SYMBOLS, "zxy")
        .orient_axis("G", "F", (sm.sqrt(2), 0, 1), 0.5)
    )
    for target, source, subscript in (
        ("B", "A", r"\text{axis }(0, 1, 1),\ 0.5"),
        ("C", "B", r"\text{matrix}"),
        ("B", "C", r"\text{matrix},\ \text{back}"),
        ("D", "C", r"\text{quaternion}"),
        ("E_1", "D", r"z,\ \text{batch}"),
        ("F", "E_1", r"z,\ \psi;\ x,\ \theta;\ y,\ \varphi"),
        ("G", "F", r"\text{axis }(\sqrt{2}, 0, 1),\ 0.5"),
        ("E_1", "F", r"y,\ - \varphi;\ x,\ - \theta;\ z,\ - \psi"),
    ):
        tex = str(frames.equation(target, source))
        assert rf"_{{{subscript}}}" in tex
    assert r"E\_1" in str(frames.equation("E_1", "D"))  # an underscore of a name is not a subscript


# --- errors ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "orient, message",
    [
        *(
            (
                lambda frames, pair=pair: frames.orient_axis(*pair, "z", 0.1),
                "the name of a frame must be a string such as",
            )
            for name in ("", " ", 3, None)
            for pair in (("A", name), (name, "A"))
        ),
        (
            lambda frames: frames.orient_axis("A", "A", "z", 0.1),
            "A cannot be oriented with respect to itself",
        ),
        (lambda frames: frames.orient_axis("B", "A", "q", 1), "axis must be .* not 'q'"),
        (lambda frames: frames.orient_axis("B", "A", "z", np.nan), "angle is nan"),
        (
            lambda frames: frames.orient_axis("B", "A", (0, 0, 0), 1),
            "a zero vector has no direction",
        ),
        (
            lambda frames: frames.orient_axis("B", "A", (0, 0, 0), psi),
            "a zero vector has no direction",
        ),
        (lambda frames: frames.orient_axis("B", "A", "z", (psi, psi)), r"^angle has shape \(2,\)"),
        (lambda frames: frames.orient_axis("B", "A", 3, 1), r"axis has shape \(\)"),
        (
            lambda frames: frames.orient_body_fixed("B", "A", (1, 2, 3), "zzx"),
            "'zzx' is not a sequence",
        ),
        (
            lambda frames: frames.orient_body_fixed("B", "A", (1, 2), "zxy"),
            r"angles has shape \(2,\)",
        ),
        (lambda frames: frames.orient_dcm("B", "A", np.diag((1, 1, -1))), "left-handed"),
        (
            lambda frames: frames.orient_dcm("B", "A", 2 * simple_dcm("x", psi)),
            "not orthogonal: row x has length 2",
        ),
        (lambda frames: frames.orient_quaternion("B", "A", (1, 1, 0, 0)), "length 1.414"),
    ],
)
def test_bad_input_is_refused_when_it_is_given(orient, message):
    with pytest.raises(ValueError, match=message):
        orient(Frames())


# --- as engineers use them ------------------------------------------------------------------------


def test_names_of_other_programs_are_names():
    """ROS names frames with slashes, other programs with spaces and hyphens."""
    frames = Frames().orient_axis("imu link", "robot/base-link", "z", 0.3)
    assert frames.names == ("robot/base-link", "imu link")
    assert frames.path("imu link", "robot/base-link") == "imu link - robot/base-link"
    assert r"\text{robot/base-link}" in str(frames.equation("imu link", "robot/base-link"))
    assert same_orientation(frames.dcm("imu link", "robot/base-link"), simple_dcm("z", 0.3))


def test_a_vector_is_expressed_along_another_frame():
    frames = Frames().orient_axis("A", "N", "z", np.pi / 2)
    np.testing.assert_allclose(frames.express((1, 0, 0), "A", "N"), (0, -1, 0), atol=1e-15)
    np.testing.assert_allclose(
        frames.express(np.eye(3), "A", "N"), frames.dcm("A", "N").T, atol=1e-15
    )
    x, theta = sm.symbols("x, theta")
    turned = Frames().orient_axis("A", "N", "z", theta)
    assert turned.express((x, 0, 0), "A", "N") == sm.Matrix(
        [x * sm.cos(theta), -x * sm.sin(theta), 0]
    )


def test_an_orientation_is_replaced():
    frames = Frames().orient_axis("A", "N", "z", 0.1).orient_axis("B", "A", "x", 0.2)
    replaced = frames.without("N", "A").orient_axis("A", "N", "z", 0.5)
    assert same_orientation(replaced.dcm("B", "N"), simple_dcm("x", 0.2) @ simple_dcm("z", 0.5))
    with pytest.raises(ValueError, match="no orientation connects B and N directly; .*B - A - N"):
        frames.without("B", "N")


def test_other_descriptions_orient_frames():
    angles, vector = (0.1, 0.2, 0.3), (0.3, -0.2, 0.5)
    fixed = Frames().orient_space_fixed("A", "N", angles, "zxy")
    np.testing.assert_allclose(
        fixed.dcm("A", "N"), orientation.dcm_from_space_fixed(angles, "zxy"), atol=1e-15
    )
    batch = np.array([angles, vector])
    np.testing.assert_allclose(
        Frames().orient_space_fixed("A", "N", batch, "xyz").dcm("A", "N"),
        orientation.dcm_from_space_fixed(batch, "xyz"),
        atol=1e-15,
    )
    turned = Frames().orient_rotation_vector("A", "N", vector)
    np.testing.assert_allclose(
        turned.dcm("A", "N"), orientation.dcm_from_rotation_vector(vector), atol=1e-15
    )


def test_frames_are_equal_by_what_they_hold():
    first = Frames().orient_axis("A", "N", "z", 0.1).orient_axis("B", "A", "x", 0.2)
    second = Frames().orient_axis("B", "A", "x", 0.2).orient_axis("N", "A", "z", -0.1)
    assert first == second and first != second.without("A", "N") and first != "A"
    assert first != Frames().orient_axis("A", "N", "z", 0.1).orient_axis("B", "A", "x", 0.3)


def test_values_are_put_in_for_symbols():
    psi, theta = sm.symbols("psi, theta")
    frames = Frames().orient_axis("A", "N", "z", psi).orient_axis("B", "A", (1, 1, 0), theta)
    put_in = frames.subs({psi: 0.3, theta: 0.2})
    assert put_in.names == frames.names
    assert same_orientation(put_in.dcm("B", "N"), frames.dcm("B", "N").subs({psi: 0.3, theta: 0.2}))
