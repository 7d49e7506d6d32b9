"""The recordings are what the book says of them."""

import numpy as np
import pytest

import orientation_recordings as recordings
from orientation import dcm_from_body_fixed, dcm_from_quaternion, rotation_vector_from_dcm


def body_from_earth(recording, conjugated):
    """The matrices of a recording's quaternions, read in the book's way or as conjugates."""
    dcms = dcm_from_quaternion(recording.quaternion)
    return dcms.swapaxes(-1, -2) if conjugated else dcms


def disagreement_with_gyroscope(recording, conjugated):
    """How badly the turns between successive quaternions follow the
    gyroscope, as a share of the turning.
    """
    dcms = body_from_earth(recording, conjugated)
    turned = rotation_vector_from_dcm(dcms[1:] @ dcms[:-1].swapaxes(-1, -2))
    steps = np.diff(recording.time, prepend=recording.time[0])[:, None] * recording.angular_velocity
    path = np.cumsum(steps, axis=0)
    at = np.clip(np.searchsorted(recording.time, recording.quaternion_time + 1e-9) - 1, 0, None)
    measured = path[at[1:]] - path[at[:-1]]
    return np.linalg.norm(turned - measured) / np.linalg.norm(measured)


@pytest.mark.parametrize(
    ("name", "conjugated"), [("x_imu", True), ("ngimu", True), ("x_imu3", False), ("xsens", False)]
)
def test_the_gyroscope_tells_in_which_convention_the_quaternion_is(name, conjugated):
    recording = getattr(recordings, name)()
    right = disagreement_with_gyroscope(recording, conjugated)
    wrong = disagreement_with_gyroscope(recording, not conjugated)
    assert right < 0.5 < 1 < wrong


def test_the_x_imu_contradicts_itself():
    """Its matrix is that of its quaternion in the book's reading; its angles, body
    fixed z-y-x, give the transpose.
    """
    recording = recordings.x_imu()
    time, matrices = recordings.x_imu_rotation_matrix()
    which = np.searchsorted(
        recordings.table("x_imu_quaternion")[:, 0], recordings.table("x_imu_rotation_matrix")[:, 0]
    )
    dcms = dcm_from_quaternion(recording.quaternion)
    assert np.abs(dcms[which] - matrices).max() < 1e-6
    angles = np.radians(recordings.x_imu_euler_angles()[:, ::-1])
    assert np.abs(dcm_from_body_fixed(angles, "zyx") - dcms.swapaxes(-1, -2)).max() < 1e-5
    assert np.degrees(angles[:, 1].max()) > 89.7 and time[0] > 6


def test_times_and_units():
    for name, rate in (("x_imu", 256), ("x_imu3", 50), ("ngimu", 50), ("xsens", 50)):
        recording = getattr(recordings, name)()
        assert np.median(np.diff(recording.time)) == pytest.approx(1 / rate, rel=0.02)
        assert 0.95 < np.median(np.linalg.norm(recording.specific_force, axis=1)) < 1.05
        assert len(recording.quaternion) == len(recording.quaternion_time) and (
            recording.quaternion_time[0] >= recording.time[0] - 0.03
        )
    thigh, shank = recordings.walking_leg()
    assert len(thigh.time) == len(shank.time) == 14 * 120
    # A packet that comes after a sample has its time.
    packets = recordings.table("x_imu_sensors")[:, 0]
    assert np.allclose(recordings.x_imu_time(packets + 0.5), recordings.x_imu().time)


def test_what_the_files_hold_is_licensed():
    from importlib import resources

    data = resources.files(recordings) / "data"
    for name, words in (
        ("LICENSE.txt", ("Thomas Haslwanter", "Redistribution")),
        ("LICENSE-stars.txt", ("Brandon Rhodes", "MIT")),
    ):
        assert all(word in (data / name).read_text("utf8") for word in words)


# Hours, minutes and seconds, degrees, minutes and seconds, as tables of the
# sky print them for the epoch 2000.
KNOWN = {
    "Sirius": (6, 45, 8.9, -1, 16, 42, 58),
    "Vega": (18, 36, 56.3, 1, 38, 47, 1),
    "Betelgeuse": (5, 55, 10.3, 1, 7, 24, 25),
    "Rigel": (5, 14, 32.3, -1, 8, 12, 6),
    "Dubhe": (11, 3, 43.7, 1, 61, 45, 3),
}


@pytest.mark.parametrize("name", KNOWN)
def test_the_stars_stand_where_other_tables_have_them(name):
    hours, minutes, seconds, sign, degrees, arcminutes, arcseconds = KNOWN[name]
    ascension = np.radians(15 * (hours + minutes / 60 + seconds / 3600))
    declination = np.radians(sign * (degrees + arcminutes / 60 + arcseconds / 3600))
    names, directions, magnitudes = recordings.bright_stars()
    # Azimuth and elevation, by another way than the sines and cosines of the table's reader.
    x, y, z = directions[names.index(name)]
    assert np.arctan2(y, x) % (2 * np.pi) == pytest.approx(ascension, abs=np.radians(3 / 3600))
    assert np.arcsin(z) == pytest.approx(declination, abs=np.radians(3 / 3600))
    assert (
        len(set(names)) == len(names) == len(magnitudes)
        and np.abs(np.linalg.norm(directions, axis=1) - 1).max() < 1e-12
    )
