"""One recording as many instruments, telephones, drones and robots write it down.

After what their makers document and what people have published, headings and odd lines included.
Each gives text or bytes, and what it says of each sensor: in how many of its units one radian per
second, one m/s² or one microtesla is.
"""

import io
import json
import zipfile
from functools import cache
from typing import NamedTuple

import numpy as np
from simulated_recordings import GRAVITY, simulate

DEG = 180 / np.pi
SEED = 4


class Form(NamedTuple):
    """A file, what one unit of the simulation is in it by sensor, and whether it tells the rate."""

    content: bytes
    scales: dict
    counted: bool = False
    called: str = "recording"


@cache
def recording():
    return simulate(SEED, poses=6)


def _table(names, columns, separator=",", number="{:.7g}", head=(), end="", comma=False):
    rows = [
        separator.join(number.format(value) for value in row) + end
        for row in np.column_stack(columns)
    ]
    if comma:
        rows = [row.replace(".", ",") for row in rows]
    return "\n".join([*head, *([separator.join(names)] if names else []), *rows, ""]).encode()


def _parts():
    recorded = recording()
    return recorded, *(
        recorded[kind]
        for kind in ("time", "gyroscope", "accelerometer", "magnetometer", "quaternion")
    )


def _gravity(recorded):
    return recorded["truth"].inv().apply([0, 0, GRAVITY])


def _zipped(files):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return content.getvalue()


def phyphox_zip():
    """phyphox, CSV: a zip of a table for each sensor, in quotes, and two about the telephone."""
    _, time, gyr, acc, mag, _ = _parts()

    def table(stem, unit, values):
        names = ['"Time (s)"', *(f'"{stem}{axis} ({unit})"' for axis in "xyz")]
        return _table(names, (time, values), number="{:.9E}")

    return Form(
        _zipped(
            {
                "Gyroscope.csv": table("Gyroscope ", "rad/s", gyr),
                "Accelerometer.csv": table("Acceleration ", "m/s^2", acc),
                "Magnetometer.csv": table("Magnetic field ", "µT", mag),
                "meta/device.csv": '"property","value"\n"version","1.1.11"\n"build","1011104"\n',
                "meta/time.csv": '"event","experiment time","system time","system time text"\n'
                '"START",0.000000000E0,1.642499117E9,"2022-01-18 10:45:17.461 UTC+01:00"\n'
                '"PAUSE",3.096120000E1,1.642499148E9,"2022-01-18 10:45:48.422 UTC+01:00"\n',
            }
        ),
        {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1},
    )


def phyphox_table():
    """Blanks and units in the headings, semicolons and decimal commas."""
    _, time, gyr, acc, mag, _ = _parts()
    units = {"Gyroscope": "rad/s", "Acceleration": "m/s^2", "Magnetic field": "µT"}
    names = [
        "Time (s)",
        *(f"{sensor} {axis} ({unit})" for sensor, unit in units.items() for axis in "xyz"),
    ]
    return Form(
        _table(names, (time, gyr, acc, mag), ";", comma=True),
        {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1},
    )


def sensor_logger():
    """A zip of one table for each sensor, z before y before x; the accelerometer
    without gravity; beside settings.
    """
    recorded, time, gyr, acc, mag, quaternion = _parts()
    clock = (1.7e18 + 1e9 * time, time)
    gravity = _gravity(recorded)

    def table(values, names="zyx"):
        rows = (
            ",".join([f"{k:.0f}", f"{t:.9f}", *(f"{value:.8f}" for value in row)])
            for k, t, row in zip(*clock, values, strict=True)
        )
        return "\n".join([",".join(["time", "seconds_elapsed", *names]), *rows])

    angles = recorded["truth"].as_euler("ZXY")[:, [2, 1, 0]]
    return Form(
        _zipped(
            {
                "Gyroscope.csv": table(gyr[:, ::-1]),
                "Accelerometer.csv": table((acc - gravity)[:, ::-1]),
                "Gravity.csv": table(gravity[:, ::-1]),
                "TotalAcceleration.csv": table(acc[:, ::-1]),
                "Magnetometer.csv": table(mag[:, ::-1]),
                "Orientation.csv": table(
                    np.column_stack([quaternion[:, ::-1], angles]),
                    ["qz", "qy", "qx", "qw", "roll", "pitch", "yaw"],
                ),
                "Metadata.csv": "version,device name,recording epoch time\n3,phone,1700000000000\n",
                "Annotation.csv": "time,seconds_elapsed,text,millisecond_press_duration\n",
            }
        ),
        {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1, "quaternion": 1, "angles": 1},
    )


def sensor_logger_json():
    recorded, entries = recording(), []
    for k, time in enumerate(recorded["time"]):
        for sensor in ("gyroscope", "accelerometer", "magnetometer"):
            x, y, z = recorded[sensor][k].round(6)
            entries.append({"sensor": sensor, "seconds_elapsed": time, "x": x, "y": y, "z": z})
    return Form(
        json.dumps(entries).encode(), {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1}
    )


def motion_sense():
    """Core Motion in a data set: a column without a name that counts,
    angles, gravity, turning, acceleration.
    """
    recorded, time, gyr, acc, _, _ = _parts()
    gravity = _gravity(recorded) / GRAVITY
    names = [""] + [f"attitude.{angle}" for angle in ("roll", "pitch", "yaw")]
    names += [
        f"{quantity}.{axis}"
        for quantity in ("gravity", "rotationRate", "userAcceleration")
        for axis in "xyz"
    ]
    angles = recorded["truth"].as_euler("ZXY")[:, [2, 1, 0]]
    columns = [np.arange(len(time)), angles, gravity, gyr, acc / GRAVITY - gravity]
    return Form(
        _table(names, columns),
        {"gyroscope": 1, "accelerometer": 1 / GRAVITY, "angles": 1},
        counted=True,
    )


def xsens_mtw():
    """MT Manager: remarks, tabs, columns that hold nothing, a
    counter, and the rate among the remarks.
    """
    _, time, gyr, acc, mag, quaternion = _parts()
    head = [
        "// Start Time: Unknown",
        "// Sample rate: 100.0Hz",
        "// Scenario: 4.9",
        "// Firmware Version: 4.0.2",
    ]
    names = ["PacketCounter", "SampleTimeFine", "Year", "Month", "Day", "Second", "UTC_Valid"]
    names += [f"{stem}_{axis}" for stem in ("Acc", "Gyr", "Mag") for axis in "XYZ"]
    names += [f"Quat_q{k}" for k in range(4)]
    rows = [
        "\t".join([f"{20_000 + k:05}", *[""] * 6, *(f"{part:.6f}" for part in row)])
        for k, row in enumerate(np.column_stack([acc, gyr, mag / 45, quaternion]))
    ]
    scales = {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1 / 45, "quaternion": 1}
    return Form("\r\n".join([*head, "\t".join(names), *rows, ""]).encode(), scales)


def movella_dot():
    """Its settings above the table, a comma at each end, microseconds that are called
    SampleTimeFine, degrees.
    """
    _, time, gyr, acc, mag, quaternion = _parts()
    head = [
        "sep=,",
        "DeviceTag:,DOT-1",
        "FirmwareVersion:,2.0.0",
        "AppVersion:,v2021.0",
        "SyncStatus:,Synced",
        "OutputRate:,100Hz",
        "FilterProfile:,General",
        "Measurement Mode:,Custom Mode 1",
        # fmt: skip
        "StartTime:,2023-05-09_10-24-58-310_CET",
        "© Xsens Technologies B. V. 2005-2023",
        "",
    ]
    names = ["PacketCounter", "SampleTimeFine", *(f"Quat_{axis}" for axis in "WXYZ")]
    names += [f"{stem}_{axis}" for stem in ("Acc", "Gyr", "Mag") for axis in "XYZ"] + ["Status"]
    columns = [
        np.arange(len(time)),
        np.round(3.1e8 + 1e6 * time),
        quaternion,
        acc,
        DEG * gyr,
        mag / 45,
        0 * time,
    ]
    return Form(
        _table(names, columns, number="{:.10g}", head=head, end=","),
        {"gyroscope": DEG, "accelerometer": 1, "magnetometer": 1 / 45, "quaternion": 1},
    )


def shimmer():
    """Three lines above the numbers: names with what they are at their ends, kinds, and units."""
    _, time, gyr, acc, mag, _ = _parts()
    names = [
        f"Shimmer_4F_{kind}_{axis}_CAL" for kind in ("Gyro", "Accel_LN", "Mag") for axis in "XYZ"
    ]
    head = ["sep=\t", "\t".join(["Shimmer_4F_Timestamp_CAL", *names]), "\t".join(["CAL"] * 10)]
    head.append("\t".join(["ms", *["deg/s"] * 3, *["m/(s^2)"] * 3, *["local_flux"] * 3]))
    return Form(
        _table(None, (1000 * time, DEG * gyr, acc, mag), "\t", head=head),
        {"gyroscope": DEG, "accelerometer": 1, "magnetometer": 1},
    )


def gyroflow():
    """Counts, whose scales stand in the lines above; gravity tells them as well."""
    _, time, gyr, acc, _, _ = _parts()
    head = [
        "GYROFLOW IMU LOG",
        "version,1.3",
        "id,custom_logger_name",
        "orientation,YxZ",
        "note,development_test",
        "fwversion,FIRMWARE_0.1.0",
        "timestamp,1644159993",
        "vendor,potatocam",
        "tscale,0.001",
        "gscale,0.00122173047",
        "ascale,0.00048828125",
    ]
    columns = [1000 * time, gyr / 0.00122173047, acc / GRAVITY / 0.00048828125]
    return Form(
        _table(["t", "gx", "gy", "gz", "ax", "ay", "az"], columns, number="{:.0f}", head=head),
        {"gyroscope": 1 / 0.00122173047, "accelerometer": 1 / GRAVITY / 0.00048828125},
    )


def betaflight():
    """Blackbox as its decoder writes it: settings in quotes, then very many
    columns, of which six are wanted.
    """
    _, time, gyr, acc, _, _ = _parts()
    head = [
        '"Product","Blackbox flight data recorder by Nicholas Sherlock"',
        '"firmwareType","Cleanflight"',
        '"acc_1G","2048"',
        '"gyro_scale","0x3f800000"',
    ]
    names = [
        "loopIteration",
        "time",
        *(f"axisP[{k}]" for k in range(3)),
        *(f"rcCommand[{k}]" for k in range(4)),
    ]
    names += [*(f"gyroADC[{k}]" for k in range(3)), *(f"accSmooth[{k}]" for k in range(3))]
    names += [*(f"motor[{k}]" for k in range(4)), "flightModeFlags (flags)"]
    random = np.random.default_rng(1)
    count = len(time)
    columns = [np.arange(count), 4e7 + 1e6 * time, random.normal(scale=30, size=(count, 3)).round(),
               np.tile([3, -2, 0, 1200], (count, 1)), DEG * gyr, 2048 * acc / GRAVITY,
               random.integers(1100, 1900, (count, 4)), 0 * time]  # fmt: skip
    names = [f'"{name}"' for name in names]
    return Form(
        _table(names, columns, ", ", "{:.9g}", head=head),
        {"gyroscope": DEG, "accelerometer": 2048 / GRAVITY},
    )


def ardupilot():
    """Lines of several kinds, each beginning with its name; two instruments take
    turns, and angles that were wanted.
    """
    recorded, time, gyr, acc, mag, _ = _parts()
    lines = ["FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
             "FMT, 1, 2, IMU, QBffffffIIf, TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T",
             "FMT, 1, 2, MAG, QBhhh, TimeUS,I,MagX,MagY,MagZ",
             "FMT, 1, 2, ATT, Qffff, TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw",
             "PARM, 1, ACRO_BAL_PITCH, 1"]  # fmt: skip
    random = np.random.default_rng(2)
    yaw, pitch, roll = recorded["truth"].as_euler("ZYX", degrees=True).T
    for k, t in enumerate(time):
        for number in (0, 1):
            other = 0.01 * random.normal(size=6) * number
            six = ", ".join(f"{value:.6f}" for value in np.concatenate([gyr[k], acc[k]]) + other)
            lines.append(f"IMU, {1e6 * t:.0f}, {number}, {six}, 0, 0, 41.2")
        lines.append(
            f"MAG, {1e6 * t:.0f}, 0, " + ", ".join(f"{10 * value:.1f}" for value in mag[k])
        )
        lines.append(
            f"ATT, {1e6 * t:.0f}, 0, {roll[k]:.3f}, 0, {pitch[k]:.3f}, 0, {yaw[k] % 360:.3f}"
        )
    scales = {"gyroscope": 1, "accelerometer": 1, "magnetometer": 10, "angles": 1}
    return Form("\n".join(lines).encode(), scales)


def rostopic():
    """As `rostopic echo -p` writes it: nanoseconds, a frame's name, and
    covariances between the vectors.
    """
    _, time, gyr, acc, _, quaternion = _parts()
    names = ["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id"]
    names += [f"field.orientation.{component}" for component in "xyzw"] + [
        f"field.orientation_covariance{k}" for k in range(9)
    ]
    names += [f"field.angular_velocity.{axis}" for axis in "xyz"]
    names += [f"field.angular_velocity_covariance{k}" for k in range(9)]
    names += [f"field.linear_acceleration.{axis}" for axis in "xyz"]
    names += [f"field.linear_acceleration_covariance{k}" for k in range(9)]
    covariance = ",".join(["0.0025", "0.0", "0.0"] * 3)
    lines = [",".join(names)]
    for k, t in enumerate(time):
        stamp = f"{1_700_000_000 * 10**9 + round(1e9 * t)}"
        vectors = [
            ",".join(f"{component:.8f}" for component in row[k])
            for row in (np.roll(quaternion, -1, axis=1), gyr, acc)
        ]
        lines.append(
            f"{stamp},{k},{stamp},imu_link,"
            + ",".join(f"{vector},{covariance}" for vector in vectors)
        )
    return Form("\n".join(lines).encode(), {"gyroscope": 1, "accelerometer": 1, "quaternion": 1})


def gnss_logger():
    """Lines that begin with what they hold, their headings among the remarks, and two clocks."""
    _, time, gyr, acc, mag, _ = _parts()
    lines = ["# ", "# Version: v3.0.5.6 Platform: 13", "#"]
    kinds = {"Accel": ("Mps2", acc), "Gyro": ("RadPerSec", gyr), "Mag": ("MicroT", mag)}
    for name, (unit, _) in kinds.items():
        lines.append(
            f"# {name},utcTimeMillis,elapsedRealtimeNanos,"
            + ",".join(f"{name}{axis}{unit}" for axis in "XYZ")
        )
    for k, t in enumerate(time):
        for name, (_, values) in kinds.items():
            clock = f"{1.7e12 + 1000 * t:.0f},{9.1e13 + 1e9 * t:.0f}"
            lines.append(f"{name},{clock}," + ",".join(f"{value:.6f}" for value in values[k]))
    return Form("\n".join(lines).encode(), {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1})


def no_headings():
    _, time, gyr, acc, mag, quaternion = _parts()
    scales = {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1, "quaternion": 1}
    return Form(_table(None, [time, gyr, acc, mag, quaternion], "\t", "{:.6f}"), scales)


def arduino():
    """What a small board prints: a word before each line, counts, no time."""
    _, _, gyr, acc, _, _ = _parts()
    counts = np.column_stack([acc / GRAVITY * 16384, DEG * gyr * 131]).round()
    rows = ["a/g:\t" + "\t".join(f"{count:.0f}" for count in row) for row in counts]
    text = "\n".join(
        [
            "Initializing I2C devices...",
            "Testing device connections...",
            "MPU6050 connection successful",
            *rows,
        ]
    )
    return Form(
        text.encode(), {"gyroscope": DEG * 131, "accelerometer": 16384 / GRAVITY}, counted=True
    )


def matlab_mobile():
    """Written by a spreadsheet of a German office: decimal commas, a date and time of the day."""
    _, time, gyr, acc, mag, _ = _parts()
    names = [
        "Timestamp",
        *(
            f"{stem}_{axis}"
            for stem in ("AngularVelocity", "Acceleration", "MagneticField")
            for axis in "XYZ"
        ),
    ]
    rows = [
        f"01.03.2024 12:{int(t) // 60:02}:{t % 60:06.3f};"
        + ";".join(f"{value:.6f}".replace(".", ",") for value in row)
        for t, row in zip(time, np.column_stack([gyr, acc, mag]), strict=True)
    ]
    return Form(
        "\n".join([";".join(names), *rows]).encode("utf-16"),
        {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1},
    )


def polar():
    """A table for each sensor with the same three headings; [G] is gauss, as
    only the name of its table says.
    """
    _, time, gyr, acc, mag, _ = _parts()

    def table(unit, values):
        head = f"Phone timestamp;sensor timestamp [ns];X [{unit}];Y [{unit}];Z [{unit}] "
        rows = (
            f"2024-03-05T09:{int(t) // 60:02}:{t % 60:06.3f};"
            f"{599_628_000_000_000_000 + round(1e9 * t)};" + ";".join(f"{part:.5f}" for part in row)
            for t, row in zip(time, values, strict=True)
        )
        return "\n".join([head, *rows])

    files = {
        "ACC": table("mg", 1000 * acc / GRAVITY),
        "GYRO": table("dps", DEG * gyr),
        "MAGN": table("G", mag / 100),
    }
    return Form(
        _zipped(
            {f"Polar_Sense_B36B5B28_20240305_{name}.txt": text for name, text in files.items()}
        ),
        {"gyroscope": DEG, "accelerometer": 1000 / GRAVITY, "magnetometer": 0.01},
    )


def core_motion():
    """JSON of an iPhone: dictionaries in dictionaries, and gravity down."""
    recorded, entries = recording(), []
    gravity = -_gravity(recorded) / GRAVITY
    pushed = -recorded["accelerometer"] / GRAVITY - gravity

    def components(values, names="xyz"):
        return dict(zip(names, values.round(6).tolist(), strict=True))

    for k, time in enumerate(recorded["time"]):
        entries.append(
            {
                "timestamp": round(81234.5 + float(time), 5),
                "attitude": {
                    "quaternion": components(np.roll(recorded["quaternion"][k], -1), "xyzw")
                },
                "rotationRate": components(recorded["gyroscope"][k]),
                "gravity": components(gravity[k]),
                "userAcceleration": components(pushed[k]),
                "magneticField": {"field": components(recorded["magnetometer"][k]), "accuracy": 2},
            }
        )
    return Form(
        json.dumps({"metadata": {"device": "iPhone14,2"}, "samples": entries}).encode(),
        {"gyroscope": 1, "accelerometer": -1 / GRAVITY, "magnetometer": 1, "quaternion": 1},
    )


def xsens_mtw_with_a_clock():
    """Its clock counts ten thousandths of a second, which nothing
    says but the rate above the table.
    """
    _, time, gyr, acc, mag, _ = _parts()
    head = [
        "// MT Manager version: 2022.2.0",
        "// Update Rate: 100.0Hz",
        "// Coordinate system: ENU",
    ]
    names = [
        "PacketCounter",
        "SampleTimeFine",
        *(f"{sensor}_{axis}" for sensor in ("Acc", "Gyr", "Mag") for axis in "XYZ"),
    ]
    columns = [np.arange(len(time)) + 65_400, 99 + np.round(1e4 * time), acc, gyr, mag / 45]
    return Form(
        _table(None, columns, "\t", head=[*head, "\t".join(names)]),
        {"gyroscope": 1, "accelerometer": 1, "magnetometer": 1 / 45},
    )


FORMS = [
    phyphox_zip,
    phyphox_table,
    sensor_logger,
    sensor_logger_json,
    motion_sense,
    xsens_mtw,
    movella_dot,
    shimmer,
    gyroflow,
    betaflight,
    ardupilot,
    rostopic,
    gnss_logger,
    no_headings,
    arduino,
    matlab_mobile,
    polar,
    core_motion,
    xsens_mtw_with_a_clock,
]
