"""The reader's own phone: both makers' conventions give the same orientation, force and file.

Without sensors a recording plays.
"""

import csv
import io

import numpy as np
import pytest
from figure_pages import front_end, open_figure, settle  # noqa: F401  (fixtures)

from orientation import body_fixed_from_dcm, dcm_from_body_fixed, dcm_from_quaternion
from orientation_figures.moving import PhoneFigure, bundle
from orientation_recordings import x_imu

# What a phone at these angles reports: on Android from north and with the force that it feels, on
# iOS from anywhere, with a compass beside it, and with the opposite sign.
SEND = """([maker, angles, force, rate, from, to]) => {
  const [alpha, beta, gamma] = angles, [x, y, z] = force, android = maker === 'android';
  const kind = android ? 'deviceorientationabsolute' : 'deviceorientation', start = 40;
  for (let k = from; k <= to; k++) {
    const turned = new DeviceOrientationEvent(kind, { alpha: android ? alpha : (alpha + start) % 360, beta, gamma,
      absolute: android });
    if (!android) Object.defineProperty(turned, 'webkitCompassHeading', { value: (360 - alpha) % 360 });
    window.dispatchEvent(turned);
    const sign = android ? 1 : -1;
    const moved = new DeviceMotionEvent('devicemotion', { interval: 100,
      accelerationIncludingGravity: { x: sign * x, y: sign * y, z: sign * z },
      rotationRate: { alpha: rate[0], beta: rate[1], gamma: rate[2] } });
    Object.defineProperty(moved, 'timeStamp', { value: 5000 + 100 * k });
    window.dispatchEvent(moved);
  }
}"""
# Chromium asks too by now, and without windows it has nobody to ask
# and refuses: here the answer is set.
ASKED = """
  for (const kind of [DeviceOrientationEvent, DeviceMotionEvent])
    kind.requestPermission = async () => window.permission ?? 'granted';
"""
ANDROID = f"() => {{ {ASKED} }}"
IOS = f"() => {{ delete window.ondeviceorientationabsolute; {ASKED} }}"
ANSWERED = (
    "/Waiting for the sensors|refused/.test(document.querySelector('.live .words').innerText)"
)
ANGLES, RATE = (70, 15, -10), (5.0, -20.0, 30.0)


def numbers(page, name):
    cells = page.locator(f".live [aria-label='{name}'] .number").all_inner_texts()
    return [float(cell.replace("\N{MINUS SIGN}", "-")) for cell in cells]


def use(page, maker):
    page.evaluate(IOS if maker == "ios" else ANDROID)
    page.get_by_role("button", name="Use the sensors").click()
    page.wait_for_function(ANSWERED)


@pytest.mark.parametrize("maker", ["android", "ios"])
def test_both_makers_are_read_alike(open_figure, maker):
    page = open_figure("phone")
    use(page, maker)
    dcm = dcm_from_body_fixed(np.radians(ANGLES), "zxy")
    force = 9.81 * dcm[:, 2]
    page.evaluate(SEND, [maker, ANGLES, force.tolist(), RATE, 0, 3])
    settle(page)
    assert numbers(
        page, "Direction cosine matrix of the phone with respect to the ground"
    ) == pytest.approx(dcm.ravel().tolist(), abs=6e-4)
    assert numbers(
        page, "Specific force along the axes of the phone, in metres per second squared"
    ) == pytest.approx(force, abs=0.006)
    assert numbers(
        page, "Angular velocity along the axes of the phone, in degrees per second"
    ) == pytest.approx(RATE, abs=0.06)
    assert "magnetic north" in page.locator(".live .words").inner_text()
    page.get_by_role("button", name="Record").click()
    # Tells nothing, and is no sample.
    page.evaluate("window.dispatchEvent(new DeviceMotionEvent('devicemotion'))")
    page.evaluate(SEND, [maker, ANGLES, force.tolist(), RATE, 10, 110])
    settle(page)
    with page.expect_download() as download:
        page.get_by_role("link", name="Download").click()
    rows = list(csv.DictReader(io.StringIO(download.value.path().read_text("utf8"))))
    assert len(rows) == 101 and float(rows[-1]["time_s"]) == pytest.approx(10)
    last = {name: float(value) for name, value in rows[-1].items()}
    assert [last[f"{name}_deg"] for name in ("alpha", "beta", "gamma")] == pytest.approx(
        ANGLES, abs=1e-3
    )
    assert [last[f"force_{axis}"] for axis in "xyz"] == pytest.approx(force, abs=1e-4)
    assert [last[f"rate_{axis}"] for axis in "xyz"] == pytest.approx(np.radians(RATE), abs=1e-4)


def test_a_refusal_and_a_missing_sensor_are_told(open_figure):
    page = open_figure("phone")
    page.evaluate("window.permission = 'denied'")
    use(page, "ios")
    page.wait_for_function("document.querySelector('.live .words').textContent.includes('refused')")
    page = open_figure("phone")
    use(page, "android")
    page.wait_for_function(
        "document.querySelector('.live .words').textContent.includes('recording')", timeout=30_000
    )
    assert page.get_by_role("button", name="Record").is_disabled()


def test_the_recording_is_the_one_of_the_book(open_figure):
    page = open_figure("phone")
    recording = x_imu()
    dcms = dcm_from_quaternion(recording.quaternion).swapaxes(-1, -2)
    for time in (2.0, 7.5, 12.0):
        page.get_by_role("spinbutton", name="time of the recording in seconds").fill(str(time))
        settle(page)
        shown = np.reshape(
            numbers(page, "Direction cosine matrix of the phone with respect to the ground"), (3, 3)
        )
        true = dcms[np.searchsorted(recording.quaternion_time, time)]
        assert np.abs(shown - true).max() < 0.03, "whole degrees are kept"


def test_angles_are_those_of_the_standard():
    figure = PhoneFigure(angles=np.radians(ANGLES).tolist())
    assert np.degrees(body_fixed_from_dcm(figure.dcm, "zxy")) == pytest.approx(ANGLES)
    assert "fetch(" not in bundle.source("phone") and "XMLHttpRequest" not in bundle.source("phone")
