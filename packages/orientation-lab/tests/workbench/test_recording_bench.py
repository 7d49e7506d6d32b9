"""The bench for recordings: what it must find, on simulated instruments
with one thing wrong and on real ones.
"""

import gzip
import warnings
import zipfile

import numpy as np
import pytest
from formats import DEG, FORMS, GRAVITY, core_motion, recording
from places import REPOSITORY
from scipy.spatial.transform import Rotation
from simulated_recordings import NAMES, as_text, simulate, unit

from orientation import dcms_after_turns
from orientation_workbench.command import main
from orientation_workbench.recording import RecordingError, examine
from orientation_workbench.recording.allan import allan_deviation, noise_of
from orientation_workbench.recording.content import _kind, _stem_and_axis, read_content
from orientation_workbench.recording.field import fit_ellipsoid
from orientation_workbench.recording.motion import ASSIGNMENTS, dcm_of_quaternions, readings
from orientation_workbench.recording.report import as_code, as_csv
from orientation_workbench.recording.table import read_tables

DATA = REPOSITORY / "packages" / "orientation-lab" / "src" / "orientation_recordings" / "data"


def test_gaps_and_rows_that_repeat_are_seen():
    given = simulate(3)
    rows = np.arange(len(given["time"]))
    for light, kept in (
        ("gaps", rows[(rows < 500) | (rows > 540)]),
        ("repeated rows", np.where(rows % 3, rows, np.maximum(rows - 1, 0))),
    ):
        text = as_text({
            kind: values[kept if light == "gaps" or kind != "time" else rows]
            for kind, values in given.items()
            if kind != "truth"
        })  # fmt: skip
        assert examine(text, light, judged=False).light(light) == "wrong"


@pytest.mark.parametrize("limit, red", [(1, False), (0.8, True)])
def test_the_peak_of_a_smooth_rotation_is_not_called_clipped(limit, red):
    time = np.arange(0, 20, 0.01)
    rate = np.clip(np.sin(time), -limit, limit) / 2
    rows = [f"{t:.2f},0,0,9.81,{x:.5f},0,0.1" for t, x in zip(time, rate)]
    verdicts = examine("\n".join(["time,ax,ay,az,gx,gy,gz", *rows]), "simulated").verdicts
    assert any("clipped" in verdict.words for verdict in verdicts) == red


def test_a_quaternion_against_its_headings_is_seen():
    given = simulate(3)
    given["quaternion"] = np.roll(given["quaternion"], -1, axis=1)
    assert examine(as_text(given, quaternion=True), judged=False).light("quaternion") == "wrong"


def test_an_honest_recording_has_no_red_light_and_its_numbers_are_right():
    recording = simulate(11)
    examined = examine(as_text(recording, quaternion=True), "honest")
    assert not [verdict for verdict in examined.verdicts if verdict.light == "wrong"], str(examined)
    assert examined.facts["scale of the gyroscope"] == pytest.approx(1, abs=0.01)
    assert sum(stretch.still for stretch in examined.still) >= 4
    [judgement] = examined.judgements
    true = recording["truth"].inv().as_matrix()[np.searchsorted(recording["time"], judgement.times)]
    tilt = np.degrees(
        np.arccos(np.clip(np.einsum("ni,ni->n", true[:, :, 2], judgement.dcms[:, :, 2]), -1, 1))
    )
    assert np.sqrt((tilt**2).mean()) < 3 * max(judgement.claimed, judgement.found) < 1


def test_on_a_foot_pushes_neither_accuse_a_unit_nor_exclude_the_true_axes():
    """A stride a second: rotations and pushes of five harmonics, which never come to rest."""
    strides = 2 * np.pi * np.outer(np.arange(0, 20, 0.01), range(1, 6))
    for seed in (1, 4):
        weights = np.random.default_rng(seed).normal(size=(10, 6))
        waves = np.concatenate([np.sin(strides), np.cos(strides)], axis=1) @ weights
        dcms = dcms_after_turns(np.eye(3), np.radians(waves[1:, :3]))
        given = {
            "time": np.arange(0, 20, 0.01),
            "gyroscope": 100 * waves[:, :3],
            "accelerometer": np.einsum("nij,nj->ni", dcms, [0, 0, GRAVITY] + 5 * waves[:, 3:]),
            "magnetometer": 0 * dcms[:, 0],
        }
        names = [name + " [deg/s]" * name.startswith("gyr") for name in NAMES]
        report = str(examine(as_text(given, names), judged=False))
        assert "RED " not in report and "nothing determines them" in report, (seed, report)


def test_a_hand_is_told_from_a_table():
    held = examine([DATA / "x_imu_sensors.csv"], rate=256, judged=False)
    assert held.light("stillness") == "look" and not any(stretch.still for stretch in held.still)
    lying = examine([DATA / "ngimu_sensors.csv"], judged=False)
    assert lying.light("stillness") == "as it should be" and any(
        stretch.still for stretch in lying.still
    )


REAL = {"x_imu": (256, True), "ngimu": (None, True), "x_imu3": (None, False), "xsens": (50, False)}


@pytest.mark.parametrize("name", REAL)
def test_the_convention_of_real_instruments(name):
    rate, conjugate = REAL[name]
    files = (
        [DATA / "xsens.csv"]
        if name == "xsens"
        else [DATA / f"{name}_{part}.csv" for part in ("sensors", "quaternion")]
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
            flipped, order = (
                bool(random.integers(2)),
                ("scalar first", "scalar last")[random.integers(2)],
            )
            printed = quaternions(turned.swapaxes(-1, -2) if flipped else turned)
            printed = np.roll(printed, -1, axis=1) if order == "scalar last" else printed
            candidates = {
                assumed: dcm_of_quaternions(printed, assumed)
                for assumed in ("scalar first", "scalar last")
            }
            ranked = readings(gyroscope.time, rates @ axes.T, quaternion.time, candidates)
            best = [
                reading
                for reading in ranked
                if reading.disagreement < ranked[0].disagreement + 1e-6
            ]
            yield (
                any(
                    (reading.order, reading.conjugate) == (order, flipped)
                    and np.allclose(reading.mounting, mounting @ axes.T)
                    for reading in best
                ),
                len(best),
                next(reading for reading in ranked if reading not in best).disagreement
                / ranked[0].disagreement,
            )


def quaternions(dcms):
    """By SciPy, whose matrices turn components of the body into the ground's; scalar first."""
    return np.roll(Rotation.from_matrix(dcms.swapaxes(-1, -2)).as_quat(), 1, axis=1)


def test_scrambled_conventions_are_found():
    """Axes, signs, order, conjugate and mounting: the right reading is among those that fit best.

    There are two of these always: with the scalar moved to the other end, the conjugate and another
    mounting give the same orientations, but for one turn of the ground. Only gravity tells them
    apart.
    """
    results = list(scrambled(8, 25))
    assert all(right for right, _, _ in results)
    assert max(equal for _, equal, _ in results) == 2
    assert min(margin for _, _, margin in results) > 1.4


# --- reading --------------------------------------------------------------------------------------


#: What the reader answers of files that do not say what their columns are.
TOLD = {
    "no_headings": "time=1 gyroscope=2-4 accelerometer=5-7 magnetometer=8-10 quaternion=11-14",
    "arduino": "accelerometer=1-3 gyroscope=4-6",
}


@pytest.mark.parametrize("form", FORMS)
def test_many_forms_hold_one_recording(form):
    """Each sensor is the one that it is, along the right axes, sample by sample:
    without a word to help where headings name it, else when the question is answered.
    """
    given, true = form(), recording()
    if form.__name__ in TOLD:
        with pytest.raises(RecordingError, match="--columns"):
            read_content(given.content, "recording")
    content = read_content(given.content, "recording", columns=TOLD.get(form.__name__, ""))
    assert set(content.groups) == set(given.scales), {
        kind: group.names for kind, group in content.groups.items()
    }
    assert content.counted == given.counted
    if not given.counted:
        steps = np.diff(content.groups["gyroscope"].time)
        assert np.median(steps) == pytest.approx(0.01, rel=1e-3) and (steps > 0).all()
    for kind, allowed in (("gyroscope", 0.02), ("accelerometer", 0.02), ("magnetometer", 0.06)):
        if kind in given.scales:
            off = content.groups[kind].values / given.scales[kind] - true[kind]
            assert np.abs(off).max() < allowed, (kind, content.groups[kind].names)
    if "quaternion" in given.scales:
        values = content.groups["quaternion"].values
        first, last = (
            np.abs(np.roll(values, k, axis=1) - true["quaternion"]).max() for k in (0, 1)
        )
        assert min(first, last) < 1e-3


#: Headings of further loggers, with the names of their tables.
HEADINGS = {
    "gyroscope": [
        ("w_RS_S_x [rad s^-1]", "data"),
        ("gyro_rad[0]", ""),
        ("wx(deg/s)", ""),
        ("roll_rate_dps", ""),
        ("Drehrate x", ""),
        ("GyX", ""),
    ],
    "accelerometer": [
        ("a_RS_S_x [m s^-2]", "data"),
        ("accelerometer_m_s2[0]", ""),
        ("Beschleunigung x (m/s^2)", "Rohdaten"),
        ("Beschleunigung x", ""),
        ("x-axis (g)", "MetaWear_2024_Accelerometer_100.000Hz_1.7.3"),
        ("gFx", ""),
        ("AcX", ""),
        ("acc_x_m/s^2", ""),
    ],
    "magnetometer": [("magnetometer_ga[0]", ""), ("MAGNETIC FIELD X (μT)", ""), ("hx(uT)", "")],
    "linear acceleration": [
        ("LINEAR ACCELERATION X (m/s²)", ""),
        ("linAccX", ""),
        ("FreeAcc_X", ""),
        ("Lineare Beschleunigung x", ""),
    ],
    "": [("velocity x (m/s)", ""), ("position.x", "fields"), ("dq_0", "")],
}


@pytest.mark.parametrize("kind", HEADINGS)
def test_headings_of_further_loggers_are_known(kind):
    for heading, table in HEADINGS[kind]:
        stem, axis = _stem_and_axis(heading)
        assert axis in ("x", "0") and _kind(stem, heading, table) == kind, heading


KINDS = ("gyro", "accel")
SIX = "gyr_x,gyr_y,gyr_z,acc_x,acc_y,acc_z"


def lines(time, names="time", count=300, columns=7, head=""):
    """Rows of a time, given as a function of the row's number, and of other numbers."""
    values = np.random.default_rng(1).normal(size=(count, columns - 1))
    rows = [",".join([str(time(k)), *map("{:.4f}".format, row)]) for k, row in enumerate(values)]
    return "\n".join([head, names, *rows])


#: What the bench says of times and unused columns: the text, and what its content must contain.
SAID = [
    (lines(lambda k: 40 * k, f"time,{SIX}", head="Sample Rate: 100 Hz"), "time, in ms|"),
    (lines(lambda k: 10000 * k, f"time (ms),{SIX}"), "in us (its heading says ms)"),
    (lines(lambda k: 10 * k, f"millis,{SIX}"), "millis, in ms|"),
    # The address of a device is no time.
    (lines(lambda k: f"{10 * k},WT9(d1:22)", f"millis,device,{SIX}"), "'gyroscope']|[]"),
    (lines(lambda k: f"{10 * k},C0:83:12:5f:0a:11", f"millis,device,{SIX}"), "'gyroscope']|[]"),
    (
        lines(lambda k: (10_000 * k - 2_000_000) % 2**32, f"micros,{SIX}"),
        "micros, in us, which passes 2³² and starts again at 0 (1 time)|",
    ),
    (lines(lambda k: f"9:05:{k / 100:06.3f}", f"time,{SIX}"), "time, in s|"),
    (lines(lambda k: f"0:00:{k / 100:06.3f}", f"time,{SIX}"), "time, in s|"),
    (lines(lambda k: f"9:05:{k // 10:02}", f"time,{SIX}"), "time has the same value as in the row"),
    (lines(lambda k: f"9:05:{k // 10:02} AM", f"time,{SIX}"), "time has the same value as in the"),
    (
        lines(lambda k: f"9th hour, 5:{k // 10:02}", f"time,{SIX}"),
        "no column gives each row's time",
    ),
    # Midnight comes after 100 rows.
    (
        lines(
            lambda k: f"{'11:59:59' if k < 100 else '12:00:00'}.{k % 100:02} {'PA'[k > 99]}M",
            f"time,{SIX}",
            200,
        ),
        "time, in s|",
    ),
    (
        lines(lambda k: f"{k / 100:.2f}", f"Zeit,{SIX}")
        .replace(",", '","')
        .replace(".", ",")
        .replace("\n", '"\n"')[1:]
        + '"',
        "Zeit, in s|",
    ),
    (lines(lambda k: k / 100, f"time (s),{SIX}", head="Sample rate: ..Hz"), "time (s), in s|"),
    # A log of two kinds of lines, between spaces, with an empty line.
    (
        "#gyro time x y z\n#accel time x y z\n\n"
        + "".join(f"{kind} {k / 100} {k % 7} {k % 5} 9\n" for k in range(99) for kind in KINDS),
        "time, in s|",
    ),
    (lines(lambda k: f"label{k // 10}", f"which,{SIX}", 6000), "accelerometer"),
    # An arrow stands for the Arduino IDE only if it follows the time of each row.
    (lines(lambda k: f"{k},up -> down", f"time (ms),note,{SIX}"), "in ms||"),
    (lines(lambda k: f"{1.7645e9 + k / 100:.2f}", f"epoch,{SIX}"), "epoch, in s|"),
    (
        lines(lambda k: f"25 Oct 2026 02:59:{k / 10:04.1f}", f"when,{SIX}"),
        "left out column 1 (when): '25 Oct 2026 02:59:07.4' is a time of a form that we cannot",
    ),
    (
        lines(lambda k: f"10/25/2026 02:59:{k / 10:04.1f} AM", f"time,{SIX}"),
        "time, in s|",
    ),
    (lines(lambda k: f"25/10/2026 9:05:{k / 10:04.1f}", f"time,{SIX}"), "time, in s|"),
    (lines(lambda k: f"9:05:{k / 100:06.3f} -> {k}", f"time,count,{SIX}"), "time, in s|count|"),
    (
        lines(lambda k: k, f"time (ms),{SIX},motionYaw(rad),motionPitch(rad),rollDeg", columns=10),
        "'angles'",
    ),
    (
        lines(lambda k: k, f"time (ms),{SIX},AngleX(deg),AngleY(deg),AngleZ(deg)", columns=10),
        "AngleZ(deg) (if these are angles, name them: --columns 'roll=8 pitch=9 yaw=10')",
    ),
    (lines(lambda k: k, f"time (ms),{SIX},attempt,template", columns=9), "attempt, template"),
    # The units are in a line of their own.
    (
        lines(lambda k: k, f"t,{SIX},volume\nms,dps,dps,dps,g,g,g,dB", columns=8),
        "t [ms], in ms|volume [dB]",
    ),
    (lines(lambda k: k, f"time (ms),{SIX},imuTemp", columns=8), "'temperature'"),
]


@pytest.mark.parametrize(("text", "words"), SAID)
def test_times_and_further_columns_are_told(text, words):
    content = read_content(text, "recording")
    said = f"{content.clock}|{', '.join(content.unused)}|{list(content.groups)}|{content.remarks}"
    assert words in said and {"gyroscope", "accelerometer"} <= set(content.groups), said
    assert all((np.diff(group.time) >= 0).all() for group in content.groups.values())


UNITS = (
    {DEG: "°/s", 1.0: "rad/s"},
    {1: "m/s²", 1 / GRAVITY: "g", -1 / GRAVITY: "g", 1000 / GRAVITY: "mg"},
)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("form", FORMS)
def test_units_and_axes_of_many_forms_come_out_by_themselves(form):
    given = form()
    examined = examine(
        given.content,
        "recording",
        100 if given.counted else None,
        TOLD.get(form.__name__, ""),
        judged=False,
    )
    words = {verdict.about: verdict.words for verdict in examined.verdicts}
    of_rates, of_forces = (given.scales[kind] for kind in ("gyroscope", "accelerometer"))
    assert words["unit of the gyroscope"].startswith(UNITS[0].get(of_rates, "counts"))
    assert words["unit of the accelerometer"].startswith(UNITS[1].get(of_forces, "counts"))
    assert words["axes of the gyroscope"] == "those of the accelerometer"
    assert examined.facts["scale of the gyroscope"] == pytest.approx(1, abs=0.03)
    assert not [verdict for verdict in examined.verdicts if verdict.light == "wrong"], str(examined)


def test_an_accelerometer_that_says_down_is_told():
    """An iPhone's does. A ground with z down would look the same: both are said."""
    examined = examine(core_motion().content, "phone", judged=False)
    assert examined.light("level") == "look" and "-z axis" in str(examined)


def test_bad_files_get_a_clear_word_with_line_and_column(tmp_path, capsys):
    text = as_text(simulate(4)).splitlines()
    broken = [*text[:400], text[400].replace(text[400].split(",")[4], "ERR"), *text[401:]]
    [table] = read_tables("\n".join(broken))
    assert (
        "left out 1 row: line 401, column 5 (acc_x): 'ERR'" in table.remarks[0]
        and len(table.values) == len(text) - 2
    )
    bad = [line if k % 9 else line.replace(",", ",x", 1) for k, line in enumerate(text)]
    with pytest.raises(RecordingError, match="line 10, column 2"):
        read_tables("\n".join(bad))
    for content, words in (
        (b"", "empty"),
        (b"\0\1\2" * 99, "not a text file"),
        (b"Dear all,\nI am here.\nBye\n", "not a table"),
        (b"[1, 2", "line 1"),
        (b"t,ax,ay,az\n" + (b"1,2,3,4\n" * 5 + b"1,2,inf,4\n") * 3, "3 of 18 rows cannot be read"),
        (b"ax:0.1 ay:0.2 az:0.3\nmx:0 my:20 mz:30\n" * 9, "not a table"),
        (b"ax:3,5 ay:3,25 az:3,75\n" * 9, "not a table"),
        (b"x:1 y:2 z:3 Gyro x:4 y:5 z:6\n" * 9, "not a table"),
        (b"ULog\1", "ulog2csv"),
        (b"\xd0\xcf\x11\xe0\0\0", "save it as CSV"),
    ):
        with pytest.raises(RecordingError, match=words):
            read_tables(content, "file")
    for names, words in (
        ("time,price,count,age", "which columns come from which sensor. Its headings"),
        ("time,roll,pitch,yaw", "It contains orientations"),
    ):
        with pytest.raises(RecordingError, match=words):
            read_content(
                "\n".join([names, *(f"{k},{k * 3 % 7},{k % 5},{k % 3}" for k in range(50))])
            )
    with pytest.raises(RecordingError, match="right ascension"):
        examine(DATA / "bright_stars.csv")
    (tmp_path / "empty.csv").write_bytes(b"")
    (tmp_path / "cut.csv.gz").write_bytes(gzip.compress(b"1,2,3,4\n" * 99)[:-9])
    (tmp_path / "walk.csv").write_text("\n".join(text))
    for options, words in (
        (["empty.csv"], "empty"),
        (["cut.csv.gz"], "cannot be unpacked"),
        (["walk.csv", "--rate", "-5"], "the rate is -5"),
        (["walk.csv", "--rate", "0"], "the rate is 0"),
        (["walk.csv", "--columns", "gyroscope=2-4:furlongs"], "'furlongs' is not a unit"),
        (["walk.csv", "--html", "none/report.html"], "there is no folder"),
        (["walk.csv", "--csv", str(tmp_path / "walk.csv")], "not the recording"),
        (["walk.csv", "--convention", "zyx"], "invalid choice: 'zyx'"),
    ):
        with pytest.raises(SystemExit) as ended:
            main(["recording", str(tmp_path / options[0]), *options[1:]])
        assert ended.value.code == 3 and words in capsys.readouterr().err


def test_folders_and_zips_in_them_are_opened_and_a_broken_table_is_told(tmp_path):
    """A zip in a folder, packed tables, settings beside them: what holds no
    numbers is passed over, not the rest.
    """
    given = simulate(5, poses=2)
    files = {}
    for kind in ("gyroscope", "accelerometer", "magnetometer"):
        rows = np.column_stack([given["time"], given[kind]])
        files[f"{kind}.csv"] = "\n".join(
            ["time,x,y,z", *(",".join(f"{value:.6f}" for value in row) for row in rows)]
        )
    (tmp_path / "deep").mkdir()
    with zipfile.ZipFile(tmp_path / "deep" / "walk.zip", "w") as archive:
        archive.writestr("today/gyroscope.csv", files["gyroscope.csv"])
        archive.writestr("__MACOSX/today/._gyroscope.csv", b"\0\5\x16\7" * 9)
        archive.writestr("device.json", '{"model": "phone"}')
    (tmp_path / "accelerometer.csv.gz").write_bytes(
        gzip.compress(files["accelerometer.csv"].encode())
    )
    lines = files["magnetometer.csv"].splitlines()
    torn = [line if k % 9 else line.replace(",", ",x", 1) for k, line in enumerate(lines)]
    (tmp_path / "magnetometer.csv").write_text("\n".join(torn))
    for source in (tmp_path, sorted(tmp_path.iterdir())):
        content = read_content(source)
        assert set(content.groups) == {"gyroscope", "accelerometer"}
        assert "line 10, column 2" in " ".join(content.remarks) and len(content.remarks) == 1
    # Two walks with the same columns, and the instruments of the book.
    (tmp_path / "deep" / "later.zip").write_bytes((tmp_path / "deep" / "walk.zip").read_bytes())
    for folder, files in (
        (tmp_path / "deep", "gyroscope: later.zip/today/gyroscope.csv, walk.zip/today/gyroscope"),
        (DATA, "accelerometer: lower_leg.csv, ngimu_sensors.csv, upper_leg.csv"),
    ):
        with pytest.raises(RecordingError, match=f"several recordings.* its own {files}"):
            read_content(folder)
    with pytest.raises(RecordingError, match="no table of numbers; .*ulog2csv"):
        (tmp_path / "only").mkdir()
        (tmp_path / "only" / "flight.log").write_bytes(b"ULog\1\2")
        read_tables(tmp_path / "only")


def spoilt(kind, change):
    given = simulate(3, poses=2)
    return given | {kind: change(given[kind])}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {kind: values[:9] for kind, values in simulate(3, poses=2).items() if kind != "truth"},
            "too few",
        ),
        (spoilt("time", lambda values: values[::-1]), "runs backwards"),
        (spoilt("time", lambda values: 0 * values), "was it rounded?"),
        (spoilt("gyroscope", lambda values: np.tile(values[:1], (len(values), 1))), "never change"),
        (spoilt("accelerometer", lambda values: 0 * values), "never change"),
        (spoilt("gyroscope", lambda values: 1e12 * values), "rotates that fast"),
        (
            spoilt(
                "magnetometer",
                lambda values: np.where(np.arange(len(values))[:, None] % 3, values, np.nan),
            ),
            "magnetometer: µT",
        ),
    ],
)
def test_strange_recordings_are_told_and_never_a_crash(given, words):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        examined = examine(as_text(given, quaternion=True), "strange")
        assert words in " ".join(str(examined).split())
        assert as_csv(examined) and as_code(examined)


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


def test_the_code_of_the_report_corrects_the_file_as_the_bench_did():
    given = simulate(6) | {}
    given["gyroscope"] = np.degrees(given["gyroscope"])[:, [1, 0, 2]] * [1, -1, 1] / 1.3 + 2
    given["magnetometer"] = given["magnetometer"] @ np.diag([0.8, 1, 1.2]) + [20, -10, 5]
    examined = examine(as_text(given, digits=9), judged=False)
    names = {kind: given[kind] for kind in ("gyroscope", "accelerometer", "magnetometer")}
    exec(as_code(examined), names)
    for name in ("rates", "forces", "field"):
        assert np.allclose(names[name], getattr(examined, name), atol=1e-6), name
    assert np.abs(names["rates"] - simulate(6)["gyroscope"]).max() < np.radians(5)


# --- numbers --------------------------------------------------------------------------------------


def test_an_unknown_scale_of_the_gyroscope_is_found_to_three_per_cent(count=3):
    random = np.random.default_rng(count)
    for seed in range(count):
        recording, scale = simulate(seed, poses=4 + seed % 3), random.uniform(0.5, 2)
        recording["gyroscope"] = recording["gyroscope"] / scale
        estimate = examine(as_text(recording), judged=False).facts["scale of the gyroscope"]
        assert estimate == pytest.approx(scale, rel=0.03)


def spoilt_by_iron(seed, poses, random):
    recording = simulate(seed, poses=poses)
    turn = Rotation.random(random_state=seed).as_matrix()
    soft = turn @ np.diag(random.uniform([0.75, 0.9, 1.1], [0.9, 1.1, 1.35])) @ turn.T
    hard = unit(random.normal(size=3)) * random.uniform(10, 60)
    return recording | {"magnetometer": recording["magnetometer"] @ soft.T + hard}


def test_soft_and_hard_iron_are_taken_away_to_a_degree_of_heading(count=3):
    random = np.random.default_rng(count)
    for seed in range(count):
        recording = spoilt_by_iron(seed, 8, random)
        examined = examine(as_text(recording), judged=False)
        level = np.einsum("nji,nj->ni", recording["truth"].inv().as_matrix(), examined.field)
        off = np.degrees(np.arctan2(level[:, 1], level[:, 0]))
        by_pose = [np.mean(off[stretch.first : stretch.last]) for stretch in examined.still]
        assert (
            examined.light("offset of the magnetometer") == "wrong" and np.abs(by_pose).max() < 1
        ), seed


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
        "magnetometer": truth.inv().apply([20, 0, -40])
        + [30, 0, 0]
        + 0.3 * random.normal(size=(2000, 3)),
    }
    examined = examine(as_text(recording), judged=False)
    assert examined.light("offset of the magnetometer") == "cannot tell", str(examined)


def test_a_magnetometer_without_a_gyroscope_is_put_right_by_lengths_or_refused():
    """As far as lengths can: up to a turn. Gravity, which stands beside
    it, tells that the dip is one then.
    """
    for seed, poses in ((1, 9), (2, 9), (3, 3)):
        given = spoilt_by_iron(seed, poses, np.random.default_rng(seed))
        rows = np.column_stack([given["time"], given["accelerometer"], given["magnetometer"]])
        names = ["time (s)", *NAMES[4:]]
        lines = [",".join(f"{value:.5f}" for value in row) for row in rows]
        examined = examine("\n".join([",".join(names), *lines]), judged=False)
        assert "no usable column has the name of a gyroscope" in " ".join(str(examined).split())
        if poses < 9:
            assert examined.light("offset of the magnetometer") in ("cannot tell", "wrong")
            continue
        ups = given["truth"].inv().apply([0, 0, 1])
        dips = np.degrees(
            np.arcsin((examined.field * ups).sum(axis=1) / np.linalg.norm(examined.field, axis=1))
        )
        lengths = np.linalg.norm(examined.field, axis=1)
        assert lengths.std() < 0.02 and dips.std() < 2.5
        assert examined.light("axes of the magnetometer") == "cannot tell"


def test_an_ellipsoid_is_found_up_to_a_turn_or_refused(count=8):
    random = np.random.default_rng(count)
    for seed in range(count):
        turn = Rotation.random(random_state=seed).as_matrix()
        soft = turn @ np.diag(random.uniform(0.7, 1.4, 3)) @ turn.T
        ways = unit(random.normal(size=(60, 3)))
        values = 45 * ways @ soft.T + random.uniform(-60, 60, 3) + 0.2 * random.normal(size=(60, 3))
        fit = fit_ellipsoid(values)
        corrected = (values - fit.offset) @ fit.shape.T / fit.strength
        off = np.linalg.norm(np.cross(corrected, ways), axis=1) / np.linalg.norm(corrected, axis=1)
        assert np.degrees(np.arcsin(off)).max() < 2 and fit.uncertainty < 0.03
        level = 45 * unit(ways * [1, 1, 0.01])  # all the poses lie nearly in a plane
        assert fit_ellipsoid(level @ soft.T + 20 + 0.2 * random.normal(size=(60, 3))) is None


def test_allan_deviation_is_that_of_the_formulas():
    """Of white noise, and of a random walk; against means over stretches taken one by one."""
    random, step = np.random.default_rng(3), 0.02
    white = random.normal(size=(20_000, 2))
    times, deviations = allan_deviation(white, step)
    few = times < 4
    assert np.allclose(deviations[few], np.sqrt(step / times[few])[:, None], rtol=0.15)
    walk = np.cumsum(random.normal(size=(40_000, 8)), axis=0) * np.sqrt(step)
    times, deviations = allan_deviation(walk, step)
    some = (times > 10 * step) & (times < 8)
    assert np.allclose(
        np.sqrt((deviations[some] ** 2).mean(axis=1)), np.sqrt(times[some] / 3), rtol=0.2
    )
    size = round(times[5] / step)
    means = walk[: len(walk) // size * size].reshape(-1, size, 8).mean(axis=1)
    plain = np.sqrt((np.diff(means, axis=0) ** 2).mean(axis=0) / 2)
    assert np.allclose(plain, deviations[5], rtol=0.1)


def test_noise_is_read_off_where_it_shows_and_not_where_a_hand_is():
    random, step = np.random.default_rng(5), 0.01
    time = step * np.arange(30_000)
    white = 0.05 / np.sqrt(step) * random.normal(size=(len(time), 3))
    noise = noise_of(*allan_deviation(white, step))
    assert (
        np.allclose(noise.angle_random_walk, 0.05, rtol=0.05)
        and np.isnan(noise.bias_instability).all()
    )
    hand = np.sin(2 * np.pi * 3 * time + random.normal(size=(3, 1))).T * 2
    assert np.isnan(noise_of(*allan_deviation(white / 20 + hand, step)).angle_random_walk).all()
