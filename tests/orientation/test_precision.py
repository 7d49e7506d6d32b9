"""Arrays of narrower types, tables of other libraries, and numbers at the edge of their range."""

import warnings

import numpy as np
import pytest

import orientation as o

DCM = o.dcm_from_body_fixed((0.1, 0.2, 0.3), "zxy")


class Table:
    """A table like a DataFrame: it has a shape, and becomes an array on request."""

    def __init__(self, values):
        self.values = np.asarray(values, dtype=float)
        self.shape, self.ndim = self.values.shape, self.values.ndim

    def __array__(self, dtype=None, copy=None):
        return self.values


@pytest.mark.parametrize("batch", [(), (4,)])
def test_single_precision_stays_itself_and_is_accepted(batch):
    """Rotations from torch, glTF and ROS are float32, and were once refused at 1e-9."""
    dcm = np.broadcast_to(DCM, (*batch, 3, 3)).astype(np.float32)
    quaternion = o.quaternion_from_dcm(dcm)
    back = o.dcm_from_quaternion(quaternion)
    assert quaternion.dtype == back.dtype == np.float32
    np.testing.assert_allclose(back, dcm, atol=3e-7)
    assert o.same_orientation(back, np.broadcast_to(DCM, back.shape))
    np.testing.assert_allclose(
        o.body_fixed_from_dcm(back, "zxy"), np.broadcast_to((0.1, 0.2, 0.3), (*batch, 3)), atol=1e-6
    )


def test_single_precision_is_held_to_its_own_digits():
    with pytest.raises(ValueError, match="not orthogonal: row . has length 1.0000100"):
        o.check_dcm((DCM * 1.00001).astype(np.float32))
    # Widened, they claim digits that they do not have.
    with pytest.raises(ValueError, match="Were its entries rounded or measured"):
        o.check_dcm(DCM.astype(np.float32).astype(float))
    o.check_dcm(o.nearest_dcm(DCM.astype(np.float32)).dcm)
    assert not o.same_orientation((DCM * 1.00001).astype(np.float32), DCM)
    assert o.diagnose(DCM.astype(np.float32), DCM).same
    turned = o.dcm_from_body_fixed(np.linspace((0.1, 0.2, 0.3), (0.7, 0.8, 0.9), 5), "zxy")
    for metric in ("entries", "angle"):
        mean = o.mean_orientation(turned.astype(np.float32), metric=metric)
        assert o.angle_between(mean, o.mean_orientation(turned, metric=metric)) < 1e-7


def test_tables_are_read_as_arrays_are():
    np.testing.assert_array_equal(o.quaternion_from_dcm(Table(DCM)), o.quaternion_from_dcm(DCM))
    angles = np.array([[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]])
    np.testing.assert_array_equal(
        o.dcm_from_body_fixed(Table(angles), "zxy"), o.dcm_from_body_fixed(angles, "zxy")
    )


@pytest.mark.parametrize(
    "conversion, vector",
    [
        (o.dcm_from_rodrigues, (1e200, 0, 0)),
        (o.dcm_from_rodrigues, (3e160, -4e160, 1.0)),
        (o.dcm_from_rotation_vector, (0, 1e160, 1e160)),
        (o.dcm_from_modified_rodrigues, (1e200, -3.0, 0)),
        (o.dcm_from_modified_rodrigues, (1e308, 1e308, 1e308)),
        (o.shadow_of_modified_rodrigues, (1e200, 0, -1e200)),
    ],
)
def test_a_batch_gives_what_one_item_gives(conversion, vector):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        np.testing.assert_allclose(conversion([vector] * 2)[1], conversion(vector), atol=1e-12)


def test_a_matrix_of_zeros_is_called_one():
    with pytest.raises(ValueError, match="every entry of matrix is zero"):
        o.nearest_dcm(np.zeros((3, 3)))


def test_a_star_tracker_and_a_magnetometer_fix_an_orientation():
    """The weights have a ratio of two millions, which is no reason to refuse them."""
    dcm = o.dcm_from_body_fixed((0.3, -1.1, 2.0), "zxy")
    reference = np.array([[1, 0, 0], [0.2, 0.9, 0.3]])
    fitted = o.dcm_from_directions(reference @ dcm.T, reference, [2.4e-5, 0.035])
    assert o.angle_between(fitted, dcm) < 1e-14
    with pytest.raises(ValueError, match="they lie along one line"):
        along = np.array([[1, 0, 0], [1, 1e-9, 0]])
        o.dcm_from_directions(along @ dcm.T, along, [2.4e-5, 0.035])


@pytest.mark.parametrize("entry", [np.nan, np.inf])
def test_what_is_missing_in_a_batch_is_called_so(entry):
    """The check of the values comes first, and must not report a wrong length."""
    axes = np.ones((3, 3))
    axes[2, 1] = entry
    with pytest.raises(ValueError, match=r"axis\[2, 1\] is (nan|inf): a number is missing"):
        o.dcm_from_axis_angle(axes, np.ones(3))
    angles = np.array([0.1, entry, 0.3])
    with pytest.raises(ValueError, match=r"angle\[1\] is (nan|inf): a number is missing"):
        o.dcm_from_axis_angle(np.ones((3, 3)), angles)
    dcms = np.stack([np.eye(3)] * 4)
    dcms[3, 0, 1] = entry
    with pytest.raises(ValueError, match=r"dcm\[3, 0, 1\] is (nan|inf): a number is missing"):
        o.quaternion_from_dcm(dcms)


@pytest.mark.parametrize("length", [1e-300, 1e-160, 1e140, 1e160, 1e300])
@pytest.mark.parametrize(
    "conversion",
    [o.dcm_from_rotation_vector, o.dcm_from_rodrigues, o.dcm_from_modified_rodrigues],
)
def test_a_vector_of_any_length_gives_an_orthogonal_matrix(conversion, length):
    o.check_dcm(conversion([(0.6 * length, -0.8 * length, 0.1 * length)] * 2))
    o.check_dcm(conversion((0.6 * length, -0.8 * length, 0.1 * length)))
