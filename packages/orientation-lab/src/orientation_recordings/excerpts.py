"""Cut the excerpts in ``data/`` out of the recordings they come from,
and the stars out of their catalogue.

Run it with ``python -m orientation_recordings.excerpts WHEEL STARS``.

``WHEEL`` is the file ``scikit_kinematics-0.10.4-py3-none-any.whl``, ``STARS`` any wheel of
``ephem`` 4.2.1. Lines are taken as they stand, so that every digit is the instrument's, or the
catalogue's; only columns that the book does not use are left out.
"""

import io
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

DATA = Path(__file__).parent / "data"
SOURCE = "tests/data"
OTHER_NAMES = {
    "Adara",
    "Agena",
    "Albereo",
    "Alcaid",
    "Etamin",
    "Formalhaut",
    "Gienah Corvi",
    "Sirrah",
}


def excerpts(wheel: str) -> dict[str, str]:
    """Give the text of each file of ``data/``, by its name."""
    archive = zipfile.ZipFile(wheel)

    def lines(name: str) -> list[str]:
        with archive.open(f"{SOURCE}/{name}") as file:
            return io.TextIOWrapper(file, "utf8").read().splitlines()

    def rows(
        name: str,
        first: float,
        last: float,
        separator: str = ",",
        columns: Sequence[int] | None = None,
        head: int = 1,
    ) -> str:
        """The column names and the rows whose first number lies between two values."""
        text = lines(name)
        kept = [
            text[head - 1],
            *(line for line in text[head:] if first <= float(line.split(separator)[0]) < last),
        ]
        cells = ([cell.strip() for cell in line.split(separator)] for line in kept)
        return "".join(
            ",".join([row[k] for k in columns] if columns else row) + "\n" for row in cells
        )

    # The first 16 s: held in a hand, carried about, held again.
    x_imu = (115, 6355)
    leg = (37328, 37328 + 14 * 120)
    sensors = range(7)  # counter, accelerometer, gyroscope
    return {
        "x_imu_sensors.csv": rows("data_xio/00033_CalInertialAndMag.csv", *x_imu),
        "x_imu_quaternion.csv": rows("data_xio/00033_Quaternion.csv", *x_imu),
        "x_imu_euler_angles.csv": rows("data_xio/00033_EulerAngles.csv", *x_imu),
        # One second is enough for what follows from the quaternion.
        "x_imu_rotation_matrix.csv": rows("data_xio/00033_RotationMatrix.csv", 2845, 3235),
        "x_imu_registers.csv": "\n".join(lines("data_xio/00033_Registers.csv")) + "\n",
        "x_imu3_sensors.csv": rows("data_xio3/Inertial.csv", 0, float("inf")),
        "x_imu3_quaternion.csv": rows("data_xio3/Quaternion.csv", 0, float("inf")),
        "ngimu_sensors.csv": rows("data_ngimu/sensors.csv", 0, float("inf"), columns=range(10)),
        "ngimu_quaternion.csv": rows("data_ngimu/quaternion.csv", 0, float("inf")),
        "xsens.csv": rows("data_xsens.txt", 0, float("inf"), "\t", range(14), head=5),
        "upper_leg.csv": rows("walking_xsens_upperLeg.txt", *leg, "\t", sensors, head=5),
        "lower_leg.csv": rows("walking_xsens_lowerLeg.txt", *leg, "\t", sensors, head=5),
    }


def bright_stars(wheel: str) -> str:
    """Give the table of the stars: each once, under the name that astronomers have agreed on."""
    with zipfile.ZipFile(wheel).open("ephem/stars.py") as file:
        lines = [line.split(",") for line in io.TextIOWrapper(file, "utf8") if ",f|S|" in line]
    found = "name,right ascension (hours),declination (degrees),magnitude\n"
    for name, _, ascension, declination, magnitude in lines:
        if name not in OTHER_NAMES:
            found += ",".join(
                [name, ascension.partition("|")[0], declination.partition("|")[0], magnitude]
            )
    return found


def main(wheel: str, stars: str) -> None:
    DATA.mkdir(exist_ok=True)
    for name, text in {**excerpts(wheel), "bright_stars.csv": bright_stars(stars)}.items():
        (DATA / name).write_text(text, "utf8")
        print(f"{name}: {text.count(chr(10)) - 1} rows")


if __name__ == "__main__":
    main(*sys.argv[1:])
