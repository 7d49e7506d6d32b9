"""One call for symbols, numbers and batches, and the messages for bad input."""

import inspect
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import composed, random_dcms, random_unit_vectors

import orientation
from orientation import (
    SymbolsNotPossible,
    angle_between,
    angular_velocity_from_dcm_rate,
    angular_velocity_matrix,
    axis_angle_from_dcm,
    body_fixed_from_dcm,
    check_dcm,
    dcm_from_axis_angle,
    dcm_from_body_fixed,
    dcm_from_modified_rodrigues,
    dcm_from_quaternion,
    dcm_from_rodrigues,
    dcm_from_rotation_vector,
    dcm_from_space_fixed,
    dcm_rate,
    gimbal_lock_margin,
    interpolate_quaternions,
    modified_rodrigues_from_dcm,
    multiply_quaternions,
    nearest_dcm,
    quaternion_from_axis_angle,
    quaternion_from_dcm,
    quaternion_rate,
    rodrigues_from_dcm,
    rotation_vector_from_dcm,
    rotation_vector_rate,
    shadow_of_modified_rodrigues,
    simple_dcm,
    space_fixed_from_dcm,
)

psi, theta, phi = SYMBOLS = sm.symbols("psi, theta, varphi")
COUNT = 12
source = np.random.default_rng(1)
ANGLE, SHARE = source.uniform(-3, 3, COUNT), source.uniform(0, 1, COUNT)
ANGLES, AXES, RATES = (source.normal(size=(COUNT, 3)) for _ in range(3))
QUATERNIONS, OTHERS = random_unit_vectors(COUNT, 2, size=4), random_unit_vectors(COUNT, 3, size=4)
DCMS = random_dcms(COUNT, 4)

# Every conversion, with a batch of each of its arguments.
CONVERSIONS = {
    "simple_dcm": (lambda angle: simple_dcm("y", angle), ANGLE),
    "dcm_from_body_fixed": (lambda angles: dcm_from_body_fixed(angles, "zxy"), ANGLES),
    "dcm_from_body_fixed proper": (lambda angles: dcm_from_body_fixed(angles, "yxy"), ANGLES),
    "dcm_from_space_fixed": (lambda angles: dcm_from_space_fixed(angles, "zyx"), ANGLES),
    "angular_velocity_matrix": (lambda angles: angular_velocity_matrix(angles, "zxz"), ANGLES),
    "dcm_from_axis_angle": (dcm_from_axis_angle, AXES, ANGLE),
    "quaternion_from_axis_angle": (quaternion_from_axis_angle, AXES, ANGLE),
    "dcm_from_rotation_vector": (dcm_from_rotation_vector, AXES),
    "dcm_from_quaternion": (dcm_from_quaternion, QUATERNIONS),
    "multiply_quaternions": (multiply_quaternions, QUATERNIONS, OTHERS),
    "dcm_rate": (dcm_rate, DCMS, RATES),
    "quaternion_rate": (quaternion_rate, QUATERNIONS, RATES),
    "angular_velocity_from_dcm_rate": (angular_velocity_from_dcm_rate, DCMS, dcm_rate(DCMS, RATES)),
    "rotation_vector_rate": (rotation_vector_rate, AXES, RATES),
    "dcm_from_rodrigues": (dcm_from_rodrigues, AXES),
    "dcm_from_modified_rodrigues": (dcm_from_modified_rodrigues, AXES),
    "shadow_of_modified_rodrigues": (shadow_of_modified_rodrigues, AXES),
}
NUMBERS_ONLY = {
    "body_fixed_from_dcm": (lambda dcm: body_fixed_from_dcm(dcm, "zxy"), DCMS),
    "body_fixed_from_dcm proper": (lambda dcm: body_fixed_from_dcm(dcm, "xzx"), DCMS),
    "space_fixed_from_dcm": (lambda dcm: space_fixed_from_dcm(dcm, "yzx"), DCMS),
    "gimbal_lock_margin": (lambda angles: gimbal_lock_margin(angles, "zxy"), ANGLES),
    "axis of axis_angle_from_dcm": (lambda dcm: axis_angle_from_dcm(dcm)[0], DCMS),
    "angle of axis_angle_from_dcm": (lambda dcm: axis_angle_from_dcm(dcm)[1], DCMS),
    "quaternion_from_dcm": (quaternion_from_dcm, DCMS),
    "rotation_vector_from_dcm": (rotation_vector_from_dcm, DCMS),
    "rodrigues_from_dcm": (rodrigues_from_dcm, DCMS),
    "modified_rodrigues_from_dcm": (modified_rodrigues_from_dcm, DCMS),
    "angle_between": (angle_between, DCMS, DCMS[::-1]),
    "interpolate_quaternions": (interpolate_quaternions, QUATERNIONS, OTHERS, SHARE),
    "nearest_dcm": (lambda matrix: nearest_dcm(matrix).dcm, DCMS),
    "distance of nearest_dcm": (lambda matrix: nearest_dcm(matrix).distance, DCMS + 0.01),
}
ALL = CONVERSIONS | NUMBERS_ONLY
every = pytest.mark.parametrize("function, batches", [(f, b) for f, *b in ALL.values()], ids=ALL)
symbolic = pytest.mark.parametrize(
    "function, batches", [(f, b) for f, *b in CONVERSIONS.values()], ids=CONVERSIONS
)


def name_of(function, place):
    """Return a function's name for one of its arguments, which its errors must use too."""
    return list(inspect.signature(function).parameters)[place]


def test_no_conversion_is_forgotten():
    public = {
        name
        for name in orientation.__all__
        if callable(getattr(orientation, name)) and name[0].islower()
    }
    tested = {name.split(" ")[-1] if " of " in name else name.split(" ")[0] for name in ALL}
    elsewhere = {
        "check_dcm",
        "diagnose",
        "same_orientation",
        "dcm_from_scipy_rotation",
        "scipy_rotation_from_dcm",
    }
    # These are not conversions of one orientation, and they have tests of their own.
    elsewhere |= {"dcm_from_directions", "dcm_from_two_directions", "directions_covariance"}
    elsewhere |= {"jacobian", "propagate_covariance", "smooth"}
    elsewhere |= {
        "turns_from_angular_velocity",
        "dcms_after_turns",
        "mean_orientation",
        "random_orientations",
    }
    drawing = {name for name in public if "drawing" in getattr(orientation, name).__module__}
    assert public - elsewhere - drawing == tested


# --- batches --------------------------------------------------------------------------------------


@every
def test_a_batch_is_what_its_items_are(function, batches):
    whole = function(*batches)
    single = np.array([function(*items) for items in zip(*batches)])
    assert whole.dtype == float
    np.testing.assert_allclose(whole, single, atol=2e-15)


@every
def test_batches_of_more_dimensions_and_of_none(function, batches):
    flat = function(*batches)
    for shape in ((3, 4), (2, 1, 6), (1, 12), (12, 1)):
        shaped = function(*(batch.reshape(shape + batch.shape[1:]) for batch in batches))
        assert shaped.shape == shape + flat.shape[1:]
        assert (shaped.reshape(flat.shape) == flat).all()
    for shape in ((0,), (3, 0)):
        assert (
            function(*(np.zeros(shape + batch.shape[1:]) for batch in batches)).shape
            == shape + flat.shape[1:]
        )


@pytest.mark.parametrize("count", [8191, 8192, 8193, 20000])
@every
def test_large_batches_have_no_seams(function, batches, count):
    repeats = -(-count // COUNT)
    large = function(*(np.concatenate(repeats * [batch])[:count] for batch in batches))
    assert (large == np.concatenate(repeats * [function(*batches)])[:count]).all()


@pytest.mark.parametrize("function, batches", [(f, b) for f, *b in ALL.values() if len(b) > 1])
def test_arguments_are_broadcast(function, batches):
    for place in range(len(batches)):
        unbatched = [batch[0] if k == place else batch for k, batch in enumerate(batches)]
        many = [
            np.stack(COUNT * [batch[0]]) if k == place else batch for k, batch in enumerate(batches)
        ]
        assert (function(*unbatched) == function(*many)).all()
    first, *rest = batches
    grid = function(first[:, None], *(batch[None, :5] for batch in rest))
    assert grid.shape[:2] == (COUNT, 5)
    np.testing.assert_allclose(
        grid[3, 2], function(first[3], *(batch[2] for batch in rest)), atol=2e-15
    )
    with pytest.raises(
        ValueError, match=r"the batches have incompatible shapes: .* \(12.* and .* \(11"
    ):
        function(first, *(batch[:11] for batch in rest))


@every
def test_nothing_is_changed_and_nothing_is_shared(function, batches):
    before = [batch.copy() for batch in batches]
    frozen = [batch.copy() for batch in batches]
    for batch in frozen:
        batch.flags.writeable = False
    result = function(*frozen)
    result[...] = 7
    assert all((batch == copy).all() for batch, copy in zip(frozen, before))
    single = function(*(batch[0] for batch in frozen))
    if np.ndim(single):
        single[...] = 7
    assert all((batch == copy).all() for batch, copy in zip(frozen, before))


@every
def test_memory_order_does_not_matter(function, batches):
    expected = function(*batches)
    for form in (
        np.asfortranarray,
        lambda batch: np.repeat(batch, 2, axis=0)[::2],
        lambda batch: np.flip(np.ascontiguousarray(np.flip(batch))),
    ):
        assert (function(*map(form, batches)) == expected).all()


@every
def test_lists_tuples_and_objects(function, batches):
    def nested_tuple(value):
        return tuple(map(nested_tuple, value)) if isinstance(value, list) else value

    expected, single = function(*batches), function(*(batch[0] for batch in batches))
    for form in (
        np.ndarray.tolist,
        lambda batch: nested_tuple(batch.tolist()),
        lambda batch: batch.astype(object),
        lambda batch: batch.astype(np.longdouble),
    ):
        assert (function(*map(form, batches)) == expected).all()
        assert np.all(
            function(*(form(batch[0]) if batch[0].ndim else batch[0] for batch in batches))
            == single
        )


@every
def test_one_item_of_plain_numbers_is_read_at_a_glance(function, batches, monkeypatch):
    """Most of the speed of a single conversion depends on this, and no result shows it."""

    def refuse(*_):
        raise AssertionError("read the long way")

    monkeypatch.setattr(orientation.numbers_and_symbols, "_evaluate_what_is_read", refuse)
    items = [batch[0] for batch in batches]
    for held in (
        [item.tolist() for item in items],
        [tuple(item.tolist()) if item.ndim == 1 else item.tolist() for item in items],
        [item if item.ndim else round(item.item()) for item in items],
    ):
        function(*held)


# --- kinds of numbers -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "kind", [int, np.int8, np.uint8, np.int64, np.float16, np.float32, np.longdouble, Fraction]
)
def test_kinds_of_numbers(kind):
    angles = [kind(1), kind(2), kind(3)]
    expected = dcm_from_body_fixed((1.0, 2.0, 3.0), "zxy")
    for form in (angles, tuple(angles), np.array(angles), [angles, angles]):
        result = dcm_from_body_fixed(form, "zxy")
        assert result.dtype == float and (result == expected).all()
    assert (simple_dcm("x", kind(3)) == simple_dcm("x", 3.0)).all()
    assert (
        dcm_from_axis_angle((kind(0), kind(2), kind(1)), kind(1))
        == dcm_from_axis_angle((0, 2, 1), 1)
    ).all()
    assert (
        quaternion_from_dcm(np.array([[kind(1), 0, 0], [0, kind(1), 0], [0, 0, kind(1)]]))
        == (1, 0, 0, 0)
    ).all()


def test_numbers_of_any_size():
    np.testing.assert_allclose(simple_dcm("z", 10**30), simple_dcm("z", 1e30))
    assert (simple_dcm("z", [10**30, 1]) == simple_dcm("z", [1e30, 1])).all()
    check_dcm(dcm_from_body_fixed((1e15, -1e18, 1e22), "zxz"))


def test_missing_samples_are_not_passed_over():
    masked = np.ma.masked_array(ANGLES, np.zeros_like(ANGLES, dtype=bool))
    assert (dcm_from_body_fixed(masked, "zxy") == dcm_from_body_fixed(ANGLES, "zxy")).all()
    masked[3, 1] = np.ma.masked
    with pytest.raises(ValueError, match=r"angles\[3, 1\] is nan: a number is missing"):
        dcm_from_body_fixed(masked, "zxy")


# --- symbols --------------------------------------------------------------------------------------


@symbolic
def test_symbols_give_the_numbers_that_numbers_give(function, batches):
    points = [batch[0] for batch in batches]
    names = iter(sm.symbols("s:30", real=True))
    held, values = [], {}
    for point in points:
        symbols = [next(names) for _ in range(point.size)]
        values |= dict(zip(symbols, point.ravel()))
        held.append(
            symbols[0]
            if point.ndim == 0
            else sm.Matrix(3, 3, symbols)
            if point.ndim == 2
            else symbols
        )
    result = function(*held)
    assert isinstance(result, sm.MatrixBase)
    expected = function(*points)
    assert result.shape == (*expected.shape, 1)[:2]
    np.testing.assert_allclose(
        np.array(result.subs(values), dtype=float).reshape(expected.shape), expected, atol=2e-15
    )


@symbolic
def test_exact_numbers_stay_exact(function, batches):
    exact = {
        (): sm.pi / 6,
        (3,): [1, sm.Rational(1, 2), sm.pi],
        (4,): [sm.Rational(1, 2)] * 4,
        (3, 3): sm.eye(3),
    }
    result = function(*(exact[batch.shape[1:]] for batch in batches))
    assert isinstance(result, sm.MatrixBase) and not result.atoms(sm.Float)
    expected = function(*(np.array(exact[batch.shape[1:]], dtype=float) for batch in batches))
    np.testing.assert_allclose(
        np.array(result.evalf(), dtype=float).reshape(expected.shape), expected, atol=1e-15
    )


def test_every_way_to_hold_symbols():
    expected = composed(SYMBOLS, "zxy")
    for form in (
        SYMBOLS,
        list(SYMBOLS),
        sm.Matrix(SYMBOLS),
        sm.Matrix(SYMBOLS).T,
        sm.ImmutableMatrix(SYMBOLS),
        np.array(SYMBOLS),
        sm.Array(SYMBOLS),
        sm.Tuple(*SYMBOLS),
        np.array([SYMBOLS]).T,
    ):
        assert (dcm_from_body_fixed(form, "zxy") - expected).expand() == sm.zeros(3)
        assert (
            dcm_from_space_fixed(form, "zxy") - composed(SYMBOLS[::-1], "yxz")
        ).expand() == sm.zeros(3)
    for form in (
        expected,
        expected.as_immutable(),
        expected.tolist(),
        np.array(expected),
        sm.Array(expected),
        [expected[0, :], list(expected[1, :]), tuple(expected[2, :])],
        [expected[k, :].T for k in range(3)],
    ):
        check_dcm(form)


def test_symbols_among_numbers():
    expected = composed((psi, 0.5, 2), "zxy")
    for form in (
        (psi, 0.5, 2),
        (psi, np.float64(0.5), np.int64(2)),
        np.array((psi, 0.5, 2)),
        [psi, sm.Float(0.5), 2],
    ):
        difference = np.array(
            (dcm_from_body_fixed(form, "zxy") - expected).subs(psi, 0.3), dtype=float
        )
        assert abs(difference).max() < 1e-15
    assert dcm_from_axis_angle(np.array((0, 0, 1)), theta) == simple_dcm("z", theta)


@pytest.mark.parametrize(
    "function, batches", [(f, b) for f, *b in NUMBERS_ONLY.values()], ids=NUMBERS_ONLY
)
def test_what_needs_numbers_says_so(function, batches):
    symbols = sm.symbols("s:9")
    first = {(3,): list(symbols[:3]), (4,): list(symbols[:4]), (3, 3): sm.Matrix(3, 3, symbols)}[
        batches[0].shape[1:]
    ]
    with pytest.raises(
        SymbolsNotPossible, match="holds .*s0.*, and this conversion needs numbers.*subs"
    ):
        function(first, *(batch[0] for batch in batches[1:]))


# --- bad input ------------------------------------------------------------------------------------


@every
def test_missing_numbers_are_found(function, batches):
    for place in range(len(batches)):
        name = name_of(function, place)
        for bad in (np.nan, np.inf, -np.inf):
            spoilt = [batch.copy() for batch in batches]
            spoilt[place].reshape(COUNT, -1)[7, -1] = bad
            with pytest.raises(
                ValueError,
                match=rf"^{name}\[7.*\] is (nan|inf|-inf): a number is missing, or there was a",
            ):
                function(*spoilt)
            with pytest.raises(
                ValueError,
                match=rf"^{name}(\[.*\])? is (nan|inf|-inf): a number is missing, or there was a",
            ):
                function(*(batch[7] for batch in spoilt))


def kalman_filter():
    return orientation.MultiplicativeKalmanFilter(DCMS, np.eye(6), 0.1, 0.1)


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (check_dcm, DCMS[:1]),
        (orientation.same_orientation, DCMS[:2]),
        (orientation.diagnose, DCMS[:2]),
        (orientation.scipy_rotation_from_dcm, DCMS[:1]),
        (orientation.mean_orientation, (DCMS, ANGLE**2)),
        (orientation.dcms_after_turns, (DCMS[0], RATES)),
        (
            lambda times: orientation.turns_from_angular_velocity(lambda _: RATES[0], times),
            (ANGLE,),
        ),
        (orientation.dcm_from_two_directions, (AXES[:2], RATES[:2])),
        (orientation.dcm_from_directions, (AXES, AXES, ANGLE**2)),
        (orientation.directions_covariance, (AXES, ANGLE**2)),
        (
            orientation.MultiplicativeKalmanFilter,
            (DCMS, np.eye(6) + np.zeros((COUNT, 1, 1)), ANGLE, ANGLE),
        ),
        (
            lambda angular_velocity, step: kalman_filter().turn(angular_velocity, step),
            (RATES, ANGLE),
        ),
        (
            lambda observed, reference, deviation: kalman_filter().observe(
                observed, reference, deviation
            ),
            (AXES, RATES, ANGLE),
        ),
        (
            lambda observed, covariance: kalman_filter().observe_dcm(observed, covariance),
            (DCMS, np.eye(3) + np.zeros((COUNT, 1, 1))),
        ),
    ],
)
def test_whoever_takes_numbers_says_which_are_none(function, arguments):
    function(*arguments)
    for place, argument in enumerate(arguments):
        name, bad = name_of(function, place), argument.copy()
        bad.reshape(-1)[-1] = np.nan
        for wrong, error, message in (
            (bad, ValueError, r"\[.*\] is nan: a number is missing"),
            ({"angle": 1}, TypeError, " must hold real numbers"),
        ):
            with pytest.raises(error, match=f"^{name}{message}"):
                function(*arguments[:place], wrong, *arguments[place + 1 :])


@every
def test_wrong_shapes_are_told(function, batches):
    for place in range(len(batches)):
        item = batches[place].shape[1:]
        if item == ():
            continue
        for wrong in (
            np.zeros(item[:-1] + (2,)),
            np.zeros((5, 5)),
            1.0,
            np.float64(1),
            np.array(1.0),
            [],
            [[]],
        ):
            bad = [wrong if k == place else batch[0] for k, batch in enumerate(batches)]
            with pytest.raises(
                ValueError,
                match=rf"^{name_of(function, place)} has shape \(.*\), "
                rf"where \({item[0]}.*\) or \(\.\.\., ",
            ):
                function(*bad)


@every
def test_what_is_no_number_is_told(function, batches):
    for wrong in (
        "abc",
        None,
        True,
        1j,
        [1, [2, 3]],
        {"angle": 1},
        ["a", "b", "c"],
        [None, 1, 2],
        10**400,
        object(),
    ):
        with pytest.raises(
            TypeError, match="must hold real numbers or SymPy expressions in a regular shape, not"
        ):
            function(wrong, *(batch[0] for batch in batches[1:]))


@symbolic
def test_what_is_no_expression_is_told(function, batches):
    item, name = batches[0].shape[1:], name_of(function, 0)
    count = int(np.prod(item, dtype=int))
    rest = [batch[0] for batch in batches[1:]]
    for wrong in ("theta", None, True, sm.true):
        entries = [psi] * (count - 1) + [wrong]
        if item:
            with pytest.raises(
                TypeError, match=f"^{name} holds .* neither a number nor a SymPy expression"
            ):
                function(
                    entries if len(item) == 1 else [entries[:3], entries[3:6], entries[6:]], *rest
                )
    for wrong in (sm.nan, sm.oo, -sm.oo, sm.zoo, psi + sm.oo):
        entries = [psi] * (count - 1) + [wrong]
        with pytest.raises(ValueError, match=f"^{name} .*there was a division by zero"):
            function(
                wrong if item == () else entries if len(item) == 1 else sm.Matrix(3, 3, entries),
                *rest,
            )
    for wrong in ([psi, psi], sm.Matrix([psi, psi]), [[psi], [psi]]):
        with pytest.raises(
            ValueError, match=f"^{name} has shape .*, where .* expected .*one item at a time"
        ):
            function(wrong, *rest)
    with pytest.raises(
        TypeError, match=f"^{name} is the vector N.x; give its components along one frame"
    ):
        function(me.ReferenceFrame("N").x, *rest)


@pytest.mark.parametrize(
    "call",
    [
        lambda sequence: dcm_from_body_fixed((1, 2, 3), sequence),
        lambda sequence: dcm_from_body_fixed(SYMBOLS, sequence),
        lambda sequence: dcm_from_space_fixed((1, 2, 3), sequence),
        lambda sequence: body_fixed_from_dcm(np.eye(3), sequence),
        lambda sequence: space_fixed_from_dcm(np.eye(3), sequence),
        lambda sequence: gimbal_lock_margin((1, 2, 3), sequence),
        lambda sequence: angular_velocity_matrix((1, 2, 3), sequence),
    ],
)
@pytest.mark.parametrize(
    "sequence, words",
    [
        *(
            (
                sequence,
                f"'{sequence}' is not a sequence .*: two successive rotations about one axis",
            )
            for sequence in ("zzx", "xyy", "xxx")
        ),
        *(
            (sequence, f"'{sequence}' is not .*: write '{sequence.lower()}': .*body fixed")
            for sequence in ("ZXY", "Zxz")
        ),
        *(
            (sequence, "is not a sequence of Euler angles: the twelve sequences are zxz, ")
            for sequence in ("zx", "", "zxyz", "abc", "313", 313, None, tuple("zxy"), list("zxy"))
        ),
    ],
)
def test_sequences_that_are_none(call, sequence, words):
    with pytest.raises(ValueError, match=words):
        call(sequence)


@pytest.mark.parametrize(
    "axis", ["X", "w", "", "xy", "-y", 3, None, (0, 0, 1), np.eye(3)[2], me.ReferenceFrame("N").z]
)
def test_axes_that_are_none(axis):
    with pytest.raises(
        ValueError, match="axis must be 'x', 'y' or 'z', not .*; .*dcm_from_axis_angle"
    ):
        simple_dcm(axis, 0.1)


@pytest.mark.parametrize("function", [dcm_from_axis_angle, quaternion_from_axis_angle])
@pytest.mark.parametrize("angle", [0.5, theta, np.zeros(2)])
def test_axes_without_a_direction(function, angle):
    for axis, message in (
        ((0, 0, 0), "a zero vector has no direction"),
        ((0.0, -0.0, 0), "a zero vector has no direction"),
        ((1e-200, 0, 0), "too short"),
        ((0, 1e200, 0), "too long"),
    ):
        with pytest.raises(ValueError, match=rf"axis.* is \(.*\): {message}"):
            function(axis, angle)
    if angle is not theta:
        with pytest.raises(
            ValueError, match=r"axis \(item \[1\]\) is \(0\.0, 0\.0, 0\.0\): a zero vector"
        ):
            function([(1, 0, 0), (0, 0, 0)], angle)


@pytest.mark.parametrize(
    "function",
    [
        lambda dcm: body_fixed_from_dcm(dcm, "zxy"),
        lambda dcm: space_fixed_from_dcm(dcm, "zxz"),
        quaternion_from_dcm,
        axis_angle_from_dcm,
        rotation_vector_from_dcm,
        rodrigues_from_dcm,
        modified_rodrigues_from_dcm,
        check_dcm,
        orientation.scipy_rotation_from_dcm,
    ],
)
def test_matrices_that_are_no_orientation(function):
    dcm = composed((0.3, 0.4, 0.5), "zxy")
    swapped, typo = dcm[[1, 0, 2]], dcm.copy()
    typo[1, 2] = 2
    for bad, message in (
        (
            swapped,
            "is orthogonal but left-handed: its determinant is -1, not .1. One row or column",
        ),
        (-dcm, "is orthogonal but left-handed"),
        (
            dcm.round(4),
            r"is not orthogonal: row.* Were its entries rounded or measured\? nearest_dcm",
        ),
        (2 * dcm, "is not orthogonal: row . has length 2, not 1. The whole matrix is 2 times an"),
        (typo, r"is not orthogonal: row y has length 2\..*An entry or a sign is wrong"),
        (np.zeros((3, 3)), "is not orthogonal: row x has length 0, not 1. Every entry is zero"),
        (np.full((3, 3), 1e200), "is not orthogonal: row x has length inf"),
    ):
        with pytest.raises(ValueError, match="dcm " + message):
            function(bad)
        with pytest.raises(ValueError, match=r"dcm \(item \[9000\]\) " + message):
            function(np.concatenate([np.stack(9000 * [dcm]), [bad]]))
        with pytest.raises(ValueError, match=r"dcm \(item \[1, 2\]\) " + message):
            function(np.stack([*5 * [dcm], bad]).reshape(2, 3, 3, 3))


@pytest.mark.parametrize(
    ("function", "good", "message"),
    [
        (angle_between, DCMS[:3], "is not orthogonal: row x has length 2"),
        (lambda *two: interpolate_quaternions(*two, 0.5), QUATERNIONS[:3], "has length 2, not 1"),
    ],
)
def test_which_of_two_is_no_orientation_is_told(function, good, message):
    twice = [2 * good[1] if k == 1 else matrix for k, matrix in enumerate(good)]
    for name, pair in (("first", (twice, good)), ("second", (good, twice))):
        with pytest.raises(ValueError, match=rf"^{name} \(item \[1\]\) {message}"):
            function(*pair)
        with pytest.raises(ValueError, match=f"^{name} {message}"):
            function(*(matrix[1] for matrix in pair))


SYMBOLIC = composed(SYMBOLS, "zxy")


@pytest.mark.parametrize(
    "value, fault",
    [
        (SYMBOLIC + sm.eye(3), "dcm at random values of its symbols is not orthogonal"),
        (-SYMBOLIC, "dcm at random values of its symbols is orthogonal but left-handed"),
        (SYMBOLIC + sm.I * sm.ones(3), "is not real: an entry has an imaginary part of 1"),
        (sm.eye(3) - sm.I * sm.ones(3), "is not real: an entry has an imaginary part of 1"),
        (2 * sm.eye(3), "^dcm is not orthogonal: row x has length 2"),
        (SYMBOLS, "^dcm has shape"),
        (np.eye(4), "^dcm has shape .*take the rotation out of each pose"),
        (np.ones((3, 3, 7)), "^dcm has shape .*put the batch first"),
    ],
)
def test_matrices_of_symbols_or_of_other_shapes_that_are_no_orientation(value, fault):
    with pytest.raises(ValueError, match=fault):
        check_dcm(value)


@pytest.mark.parametrize(
    "function, arguments, error, words",
    [
        (
            dcm_from_body_fixed,
            (tuple(ANGLES.T), "zxy"),
            ValueError,
            "a sequence of 3 arrays, which can be read in two ways.*axis=-1",
        ),
        (dcm_from_quaternion, (list(QUATERNIONS.T),), ValueError, "a sequence of 4 arrays"),
        (
            dcm_from_body_fixed,
            ((ANGLES[:, 0], 0.0, 0.0), "zyx"),
            TypeError,
            "Join numbers and arrays with numpy.stack",
        ),
        (
            check_dcm,
            (orientation.scipy_rotation_from_dcm(np.eye(3)),),
            TypeError,
            "use dcm_from_scipy_rotation",
        ),
    ],
)
def test_components_in_separate_arrays_are_not_guessed_at(function, arguments, error, words):
    with pytest.raises(error, match=words):
        function(*arguments)
    assert dcm_from_body_fixed(list(ANGLES), "zxy").shape == (COUNT, 3, 3)


# --- what the package loads -----------------------------------------------------------------------


def python(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_import_loads_almost_nothing_and_numbers_load_no_sympy():
    imported, used = python(
        "import sys, orientation as o\n"
        "print(*sys.modules)\n"
        'dcm = o.dcm_from_body_fixed((1, 2, 3), "zxy")\n'
        'o.body_fixed_from_dcm(dcm, "zxy"), o.axis_angle_from_dcm(dcm), '
        "o.quaternion_from_dcm([dcm, dcm])\n"
        'o.same_orientation(dcm, dcm), o.diagnose(dcm.T, dcm, (1, 2, 3), "zxy"), '
        "o.nearest_dcm(dcm)\n"
        'frames = o.Frames().orient_body_fixed("D", "A", (1, 2, 3), "zxy").orient_axis("E", "D", '
        '"x", 1)\n'
        'frames.dcm("A", "E"), frames.equation("A", "E")\n'
        "print(*sys.modules)"
    ).splitlines()
    large = {"scipy", "sympy", "mpmath", "matplotlib", "ipywidgets", "anywidget", "IPython"}
    assert not {"numpy", *large} & set(imported.split())
    assert "numpy" in used.split() and not large & set(used.split())


def test_symbols_work_without_numpy():
    """A browser may not have NumPy."""
    output = python("""
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split('.')[0] == 'numpy':
            raise ImportError('there is no numpy here')

sys.meta_path.insert(0, Blocked())
import sympy as sm
import orientation as o
s = a, b, c = sm.symbols('a b c')
q = sm.symbols('q:4')
dcm = o.dcm_from_body_fixed(s, 'zxy')
o.check_dcm(dcm), o.check_dcm(dcm.tolist())
assert o.same_orientation(o.simple_dcm('y', c) * o.simple_dcm('x', b) * o.simple_dcm('z', a), dcm)
assert o.same_orientation(o.dcm_from_space_fixed(s, 'zxy'), o.dcm_from_body_fixed((c, b, a), 'yxz'))
assert o.same_orientation(o.dcm_from_quaternion(o.quaternion_from_axis_angle((1, 2, 2), a)),
                          o.dcm_from_axis_angle((1, 2, 2), a))
o.multiply_quaternions(q, q), o.dcm_from_body_fixed((a, 0, 0.1), 'zxz')
o.dcm_from_rotation_vector(s)
print(o.diagnose(dcm.T, dcm))
print(o.diagnose(o.dcm_from_body_fixed((c, b, a), 'yxz'), dcm))
print(o.diagnose((q[1], q[2], q[3], q[0]), q))
frames = (o.Frames().orient_axis('B', 'A', 'z', a).orient_axis('C', 'B', (1, 0, 0), b)
          .orient_body_fixed('D', 'C', (c, 0, 0.5), 'yxz').orient_dcm('E', 'D', dcm)
          .orient_quaternion('F', 'E', o.quaternion_from_axis_angle((0, 1, 0), a)))
assert frames.orient_axis('B', 'A', 'z', a) is frames
o.check_dcm(frames.dcm('F', 'A')), frames.dcm('A', 'F'), frames.dcm('A', 'A')
frames.equation('F', 'A')
frames.reference_frames()
try:
    frames.orient_axis('C', 'A', 'x', a)
except ValueError as error:
    print(error)
assert 'numpy' not in sys.modules
""")
    assert [line.split(":")[-1].strip() for line in output.splitlines()] == [
        "it is the transpose, which is the inverse orientation.",
        "the matrices are multiplied in reverse order, which gives space fixed rotations.",
        "the scalar part comes last; in this book it comes first.",
        "a second path could contradict the first. "
        "To change an orientation, build the frames again",
    ]
