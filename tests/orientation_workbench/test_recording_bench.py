"""The bench for recordings: what it must find, on simulated instruments with one thing wrong and on real ones."""

import io
import json
import zipfile

import numpy as np
import pytest
from places import REPOSITORY
from scipy.spatial.transform import Rotation
from scipy.stats import chi2
from simulated_recordings import FAULTS, NAMES, as_text, faulty, simulate

from orientation import MultiplicativeKalmanFilter, dcm_from_rotation_vector
from orientation_workbench.command import main
from orientation_workbench.recording import RecordingError, examine
from orientation_workbench.recording.content import read_content
from orientation_workbench.recording.judged import chi_square_bounds
from orientation_workbench.recording.motion import ASSIGNMENTS, dcm_of_quaternions, readings
from orientation_workbench.recording.table import read_tables

DATA = REPOSITORY / "src" / "orientation_recordings" / "data"


@pytest.mark.sampled(3)
@pytest.mark.parametrize("kind", FAULTS)
def test_one_wrong_thing_makes_its_light_red(kind):
    text, light = faulty(kind, 3)
    found = examine(text, kind, judged=False)
    assert found.light(light) == "wrong", str(found)


@pytest.mark.long
def test_of_two_hundred_wrong_recordings_nearly_all_are_found_and_honest_ones_are_left_alone():
    missed = [
        (kind, seed)
        for kind in FAULTS
        for seed in range(200, 217)
        if examine(faulty(kind, seed)[0], judged=False).light(FAULTS[kind][0]) != "wrong"
    ]
    assert len(missed) <= 10, missed
    blamed = [
        seed
        for seed in range(700, 740)
        if any(verdict.light == "wrong" for verdict in examine(as_text(simulate(seed), quaternion=True)).verdicts)
    ]
    assert len(blamed) <= 2, blamed


def test_an_honest_recording_has_no_red_light_and_its_numbers_are_right():
    recording = simulate(11)
    found = examine(as_text(recording, quaternion=True), "honest")
    assert not [verdict for verdict in found.verdicts if verdict.light == "wrong"], str(found)
    assert found.facts["scale of the gyroscope"] == pytest.approx(1, abs=0.01)
    assert sum(one.still for one in found.still) >= 4
    [judgement] = found.judgements
    true = recording["truth"].inv().as_matrix()[np.searchsorted(recording["time"], judgement.times)]
    tilt = np.degrees(np.arccos(np.clip(np.einsum("ni,ni->n", true[:, :, 2], judgement.dcms[:, :, 2]), -1, 1)))
    assert np.sqrt((tilt**2).mean()) < 3 * max(judgement.claimed, judgement.found) < 1


def test_a_hand_is_told_from_a_table():
    held = examine([DATA / "x_imu_sensors.csv"], rate=256, judged=False)
    assert held.light("stillness") == "look" and not any(one.still for one in held.still)
    lying = examine([DATA / "ngimu_sensors.csv"], judged=False)
    assert lying.light("stillness") == "as it should be" and any(one.still for one in lying.still)


REAL = {"x_imu": (256, True), "ngimu": (None, True), "x_imu3": (None, False), "xsens": (50, False)}


@pytest.mark.parametrize("name", REAL)
def test_the_convention_of_real_instruments(name):
    rate, conjugate = REAL[name]
    files = (
        [DATA / "xsens.csv"] if name == "xsens" else [DATA / f"{name}_{part}.csv" for part in ("sensors", "quaternion")]
    )
    reading = examine(files, rate=rate, judged=False).facts["convention of the quaternion"]
    assert (reading.order, reading.conjugate) == ("scalar first", conjugate)
    assert np.allclose(reading.mounting, np.eye(3))


def scrambled(ways, seed):
    """Whether each of so many scrambled versions of each real recording is put right again."""
    random = np.random.default_rng(seed)
    for name, (rate, conjugate) in REAL.items():
        files = (
            [DATA / "xsens.csv"]
            if name == "xsens"
            else [DATA / f"{name}_{part}.csv" for part in ("sensors", "quaternion")]
        )
        groups = read_content(files, rate=rate).groups
        gyroscope, quaternion = groups["gyroscope"], groups["quaternion"]
        rates = gyroscope.values * (1 if name == "xsens" else np.pi / 180)
        ours = dcm_of_quaternions(quaternion.values, "scalar first")
        ours = ours.swapaxes(-1, -2) if conjugate else ours
        for _ in range(ways):
            axes, mounting = ASSIGNMENTS[random.integers(48)], ASSIGNMENTS[random.integers(24)]
            turned = mounting @ ours
            flipped, order = bool(random.integers(2)), ("scalar first", "scalar last")[random.integers(2)]
            printed = quaternions(turned.swapaxes(-1, -2) if flipped else turned)
            printed = np.roll(printed, -1, axis=1) if order == "scalar last" else printed
            candidates = {one: dcm_of_quaternions(printed, one) for one in ("scalar first", "scalar last")}
            found = readings(gyroscope.time, rates @ axes.T, quaternion.time, candidates)
            best = [one for one in found if one.disagreement < found[0].disagreement + 1e-6]
            yield (
                any(
                    (one.order, one.conjugate) == (order, flipped) and np.allclose(one.mounting, mounting @ axes.T)
                    for one in best
                ),
                len(best),
                next(one for one in found if one not in best).disagreement / found[0].disagreement,
            )


def quaternions(dcms):
    """By SciPy, whose matrices turn components of the body into the ground's; scalar first."""
    return np.roll(Rotation.from_matrix(dcms.swapaxes(-1, -2)).as_quat(), 1, axis=1)


@pytest.mark.parametrize("ways", [25, pytest.param(1000, marks=pytest.mark.long)])
def test_scrambled_conventions_are_found(ways):
    """Axes, signs, order, conjugate and mounting: the right reading is among those that fit best.

    There are two of these always: with the scalar moved to the other end, the conjugate and another mounting give the
    same orientations, but for one turn of the ground. Only gravity tells them apart.
    """
    found = list(scrambled(ways, ways))
    assert all(right for right, _, _ in found)
    assert max(equal for _, equal, _ in found) == 2
    assert min(margin for _, _, margin in found) > 1.4


# --- reading ----------------------------------------------------------------------------------------


def sensor_logger():
    """A zip of one table for each sensor, z before y before x, beside settings: as Sensor Logger writes it."""
    recording, content = simulate(4), io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for file, kind in (
            ("Gyroscope", "gyroscope"),
            ("Accelerometer", "accelerometer"),
            ("Magnetometer", "magnetometer"),
        ):
            rows = [
                f"{1.7e18 + 1e9 * time:.0f},{time:.6f},{z:.6f},{y:.6f},{x:.6f}"
                for time, (x, y, z) in zip(recording["time"], recording[kind], strict=True)
            ]
            archive.writestr(f"{file}.csv", "\n".join(["time,seconds_elapsed,z,y,x", *rows]))
        archive.writestr("Metadata.csv", "version,device\n3,phone\n")
    return content.getvalue()


def phyphox():
    """Blanks and units in the headings, semicolons and decimal commas."""
    units = {"Gyroscope": "rad/s", "Acceleration": "m/s^2", "Magnetic field": "µT"}
    names = ["Time (s)", *(f"{one} {axis} ({unit})" for one, unit in units.items() for axis in "xyz")]
    text = as_text(simulate(4), names)
    return text.replace(",", ";").replace(".", ",").encode()


def drone():
    """Lines of several kinds, each beginning with its name, as ArduPilot's logs are as text."""
    recording = simulate(4)
    lines = [
        "FMT, 1, 2, IMU, Qffffff, TimeUS, GyrX, GyrY, GyrZ, AccX, AccY, AccZ",
        "FMT, 1, 2, MAG, Qfff, TimeUS, MagX, MagY, MagZ",
    ]
    for time, gyr, acc, mag in zip(
        *(recording[key] for key in ("time", "gyroscope", "accelerometer", "magnetometer")), strict=True
    ):
        lines.append(f"IMU, {1e6 * time:.0f}, " + ", ".join(f"{one:.6f}" for one in (*gyr, *acc)))
        lines.append(f"MAG, {1e6 * time:.0f}, " + ", ".join(f"{10 * one:.2f}" for one in mag))
    return "\n".join(lines).encode()


def robot():
    """As `rostopic echo -p` writes it: a percent sign, nanoseconds, a frame's name, and the orientation first."""
    recording = simulate(4)
    names = ["%time", "field.header.seq", "field.header.frame_id", *(f"field.orientation.{one}" for one in "xyzw")]
    names += [f"field.{one}.{axis}" for one in ("angular_velocity", "linear_acceleration") for axis in "xyz"]
    lines = [",".join(names)]
    for k, time in enumerate(recording["time"]):
        numbers = [*np.roll(recording["quaternion"][k], -1), *recording["gyroscope"][k], *recording["accelerometer"][k]]
        lines.append(f"{1.7e18 + 1e9 * time:.0f},{k},imu_link," + ",".join(f"{one:.7f}" for one in numbers))
    return "\n".join(lines).encode()


def no_headings():
    return "\n".join(as_text(simulate(4), quaternion=True).replace(",", "\t").splitlines()[1:]).encode()


def javascript():
    recording, entries = simulate(4), []
    for k, time in enumerate(recording["time"]):
        for sensor in ("gyroscope", "accelerometer", "magnetometer"):
            x, y, z = recording[sensor][k].round(6)
            entries.append({"sensor": sensor, "seconds_elapsed": time, "x": x, "y": y, "z": z})
    return json.dumps(entries).encode()


def gravity_apart():
    """As some telephones have it: acceleration without gravity, and gravity by itself; z before y before x."""
    recording, names = simulate(4), ["seconds_elapsed"]
    up = recording["truth"].inv().apply([0, 0, 9.80665])
    for stem in ("gyroscope_", "gravity_", "accelerometer_"):
        names += [stem + axis for axis in "zyx"]
    names += ["orientation_qz", "orientation_qy", "orientation_qx", "orientation_qw"]
    rows = np.column_stack(
        [
            recording["time"],
            recording["gyroscope"][:, ::-1],
            up[:, ::-1],
            (recording["accelerometer"] - up)[:, ::-1],
            recording["quaternion"][:, ::-1],
        ]
    )
    return "\n".join([",".join(names), *(",".join(f"{one:.7f}" for one in row) for row in rows)]).encode()


def shimmer():
    """Three lines above the numbers: names with what they are at their ends, kinds, and units."""
    recording = simulate(4)
    names = [f"Shimmer_4F_{kind}_{axis}_CAL" for kind in ("Gyro", "Accel_LN", "Mag") for axis in "XYZ"]
    head = ["sep=\t", "\t".join(["Shimmer_4F_Timestamp_CAL", *names]), "\t".join(["CAL"] * 10)]
    head.append("\t".join(["ms", *["deg/s"] * 3, *["m/(s^2)"] * 3, *["local_flux"] * 3]))
    scaled = recording | {"time": 1000 * recording["time"]}
    return "\n".join([*head, *as_text(scaled).replace(",", "\t").splitlines()[1:]]).encode()


FORMS = [sensor_logger, phyphox, drone, robot, no_headings, javascript, gravity_apart, shimmer]


@pytest.mark.parametrize("form", FORMS)
def test_many_forms_hold_one_recording(form):
    recording = simulate(4)
    found = read_content(form(), form.__name__)
    expected = {"gyroscope", "accelerometer"} | ({"magnetometer"} if form not in (robot, gravity_apart) else set())
    assert expected <= set(found.groups), found.groups.keys()
    assert np.median(np.diff(found.groups["gyroscope"].time)) == pytest.approx(0.01, rel=1e-3)
    for kind in expected:
        scale = 10 if form is drone and kind == "magnetometer" else 1
        assert np.abs(found.groups[kind].values / scale - recording[kind]).max() < 0.011, kind


def test_bad_files_get_a_clear_word_with_line_and_column(tmp_path, capsys):
    text = as_text(simulate(4)).splitlines()
    broken = [*text[:400], text[400].replace(text[400].split(",")[4], "ERR"), *text[401:]]
    [table] = read_tables("\n".join(broken))
    assert "line 401, column 5 (acc_x): 'ERR'" in table.remarks[0] and len(table.values) == len(text) - 2
    bad = [line if k % 9 else line.replace(",", ",x", 1) for k, line in enumerate(text)]
    with pytest.raises(RecordingError, match="line 10, column 2"):
        read_tables("\n".join(bad))
    for content, words in (
        (b"", "empty"),
        (b"\0\1\2" * 99, "no text"),
        (b"Dear all,\nI am here.\nBye\n", "no table"),
        (b"[1, 2", "line 1"),
    ):
        with pytest.raises(RecordingError, match=words):
            read_tables(content, "file")
    with pytest.raises(RecordingError, match="no instrument"):
        read_content("\n".join(["time,price,count,age", *(f"{k},{k * 3 % 7},{k % 5},{k % 3}" for k in range(50))]))
    (tmp_path / "empty.csv").write_bytes(b"")
    with pytest.raises(SystemExit) as ended:
        main(["recording", str(tmp_path / "empty.csv")])
    assert ended.value.code == 3 and "empty" in capsys.readouterr().err


def test_the_command_writes_report_and_corrected_recording(tmp_path, capsys):
    (tmp_path / "walk.csv").write_text(as_text(simulate(4, poses=4)), "utf8")
    with pytest.raises(SystemExit) as ended:
        main(["recording", str(tmp_path / "walk.csv"), "--html", str(tmp_path / "report.html"),
              "--csv", str(tmp_path / "right.csv"), "--convention", "xyzw"])  # fmt: skip
    assert ended.value.code == 0 and "axes of the gyroscope" in capsys.readouterr().out
    page = (tmp_path / "report.html").read_text("utf8")
    assert page.count("<svg") >= 2 and "http" not in page.replace("http://www.w3.org", "")
    again = np.genfromtxt(tmp_path / "right.csv", delimiter=",", names=True)
    assert len(again) == len(simulate(4, poses=4)["time"]) and "qw" in again.dtype.names
    assert NAMES[0] == "time (s)"


# --- numbers ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [3, pytest.param(40, marks=pytest.mark.long)])
def test_an_unknown_scale_of_the_gyroscope_is_found_to_three_per_cent(count):
    random = np.random.default_rng(count)
    for seed in range(count):
        recording, scale = simulate(seed, poses=5), random.uniform(0.5, 2)
        recording["gyroscope"] = recording["gyroscope"] / scale
        found = examine(as_text(recording), judged=False).facts["scale of the gyroscope"]
        assert found == pytest.approx(scale, rel=0.03)


def spoilt_by_iron(seed, poses, random):
    recording = simulate(seed, poses=poses)
    turn = Rotation.random(random_state=seed).as_matrix()
    soft = turn @ np.diag(random.uniform([0.75, 0.9, 1.1], [0.9, 1.1, 1.35])) @ turn.T
    hard = random.normal(size=3)
    hard = hard / np.linalg.norm(hard) * random.uniform(10, 60)
    return recording | {"magnetometer": recording["magnetometer"] @ soft.T + hard}


@pytest.mark.parametrize("count", [3, pytest.param(40, marks=pytest.mark.long)])
def test_soft_and_hard_iron_are_taken_away_to_a_degree_of_heading(count):
    random = np.random.default_rng(count)
    for seed in range(count):
        recording = spoilt_by_iron(seed, 8, random)
        found = examine(as_text(recording), judged=False)
        level = np.einsum("nji,nj->ni", recording["truth"].inv().as_matrix(), found.field)
        off = np.degrees(np.arctan2(level[:, 1], level[:, 0]))
        by_pose = [np.mean(off[one.first : one.last]) for one in found.still]
        assert found.light("offset of the magnetometer") == "wrong" and np.abs(by_pose).max() < 1, seed


def test_iron_is_refused_where_the_turns_do_not_suffice():
    """A few degrees about one axis."""
    time = np.arange(0, 20, 0.01)
    truth = Rotation.from_rotvec(np.outer(0.1 * np.sin(time), [0, 0, 1]))
    random = np.random.default_rng(3)
    rates = np.outer(0.1 * np.cos(time), [0, 0, 1]) + 0.001 * random.normal(size=(2000, 3))
    recording = {
        "time": time,
        "gyroscope": rates,
        "accelerometer": truth.inv().apply([0, 0, 9.81]) + 0.02 * random.normal(size=(2000, 3)),
        "magnetometer": truth.inv().apply([20, 0, -40]) + [30, 0, 0] + 0.3 * random.normal(size=(2000, 3)),
    }
    found = examine(as_text(recording), judged=False)
    assert found.light("offset of the magnetometer") == "cannot tell", str(found)


def test_innovations_of_an_honest_filter_stay_within_their_bounds():
    """In 95 of 100 runs, give or take two: four hundred runs of twenty seconds, at two directions."""
    runs, step, random = 400, 0.02, np.random.default_rng(5)
    noise, wander, deviations = 0.01, 0.002, (0.03, 0.08)
    references = np.array([[0, 0, 1.0], [0.6, 0, -0.8]])
    truth = dcm_from_rotation_vector(random.normal(size=(runs, 3)))
    first = np.diag([0.03**2] * 3 + [0.02**2] * 3)
    wrong = dcm_from_rotation_vector(0.03 * random.normal(size=(runs, 3)))
    estimate = MultiplicativeKalmanFilter(wrong @ truth, first, noise, wander)
    bias, squares = 0.02 * random.normal(size=(runs, 3)), []
    for k in range(1000):
        rate = np.sin([0.7, 1.1, 0.4] * np.array(k * step))
        truth = dcm_from_rotation_vector(rate * step) @ truth
        estimate.turn(rate + bias + noise / np.sqrt(step) * random.normal(size=(runs, 3)), step)
        bias = bias + wander * np.sqrt(step) * random.normal(size=(runs, 3))
        if k % 5 == 4:
            for reference, deviation in zip(references, deviations, strict=True):
                seen = truth @ reference + deviation * random.normal(size=(runs, 3))
                told = estimate.observe(seen, np.broadcast_to(reference, (runs, 3)), deviation)
                squares.append(told.normalised_square)
    low, high = chi_square_bounds(2 * len(squares))
    means = np.mean(squares, axis=0) / 2
    assert 0.93 <= np.mean((low < means) & (means < high)) <= 0.97
    assert np.allclose(chi_square_bounds(800), chi2.ppf([0.025, 0.975], 800) / 800, rtol=1e-3)
