"""An engineer pastes raw numbers, as they stand in threads and consoles, into the command."""

import subprocess
import sys

import pytest
from places import REPOSITORY


def explained(*arguments):
    done = subprocess.run(
        [sys.executable, "-m", "orientation_workbench", "explain", *arguments],
        capture_output=True,
        text=True,
    )
    return done.returncode, done.stdout + done.stderr


def test_noise_makes_no_opposite_turns_the_same():
    """Small angles, read as degrees, hardly move: then a degree of noise fits anything."""
    code, answer = explained("--noise", "1", "0.21 0.13 -0.32", "-0.21 -0.13 0.32")
    assert code == 2 and "the same orientation" not in answer
    assert "one is the turn in the other sense" in answer


def test_where_the_noise_exceeds_the_motion_nothing_is_judged():
    code, answer = explained("--noise", "5", "0.9999 0.0087 0.0052 0.0087", "0.9999 0 0.0141 0")
    assert code == 3 and "too little to judge by" in answer and "5 degrees" in answer


def test_degrees_against_radians_is_no_agreement():
    code, answer = explained("10 20 30", "0.17453 0.34907 0.52360")
    assert code == 2 or (code == 1 and "degrees" in answer)
    assert "the first numbers are in degrees, the second in radians" in answer


#: ROS's body forward, left, up against forward, right, down: two quaternions, scalar last.
FLU = "0.10050378 0.30151134 -0.50251891 0.80403025"
FRD = "0.80403025 -0.50251891 -0.30151134 -0.10050378"


def test_two_quaternions_scalar_last_are_asked_about():
    code, answer = explained(FLU, FRD)
    assert code == 2 and "Does the scalar part of the quaternions stand first or last?" in answer
    assert "y and z of the body reversed (FRD and FLU" in answer
    last = ("--first-is", "xyzw", "--second-is", "xyzw")
    assert " ".join(last) in answer  # the answer, ready to be typed
    code, answer = explained(*last, FLU, FRD)
    assert code == 1 and "y and z of the body reversed" in answer and "world" not in answer


#: A camera-to-world matrix in OpenCV's axes and in OpenGL's: the camera's axes are the columns.
OPENCV = "0.86869 -0.47475 0.14141\n0.31313 0.74748 0.58586\n-0.38384 -0.46465 0.79798"
OPENGL = "0.86869 0.47475 -0.14141\n0.31313 -0.74748 -0.58586\n-0.38384 0.46465 -0.79798"


def test_two_camera_to_world_matrices_are_asked_about():
    code, answer = explained(OPENCV, OPENGL)
    assert code == 2 and "the body's axes its rows or its columns?" in answer
    for program in (("--first-is", "columns"), ("--first", "nerfstudio"), ("--first", "SciPy")):
        code, answer = explained(*program, OPENCV, OPENGL)
        assert code == 1 and "of the body reversed" in answer and "world" not in answer, answer


@pytest.mark.parametrize(
    "first",
    [
        # SciPy's as_euler('XYZ') put into from_euler('xyz'), as quaternions and as matrices.
        "0.36021 -0.07018 0.13431 0.92050",
        "-0.54312134 0.42388916 -0.45617676 0.5632019",
    ],
)
def test_angles_that_were_read_and_built_by_two_sequences_are_named(first):
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_quat([float(number) for number in first.split()])
    other = Rotation.from_euler("xyz", turn.as_euler("XYZ"))
    for written in (Rotation.as_quat, Rotation.as_matrix):
        texts = [str(written(each)) for each in (turn, other)]
        code, answer = explained("--first-is", "xyzw", "--second-is", "xyzw", *texts)
        assert "they were read off as" in answer and "(space fixed)" in answer, answer


def test_one_special_pose_decides_nothing():
    code, answer = explained(
        "[3.14,0.2623,0]",
        "array([ 9.91411844e-01,  1.04139110e-04, -1.30774311e-01,  7.89487983e-04])",
    )
    assert code == 2 and "cannot decide" in answer


def test_a_quaternion_in_lines_is_read_and_one_that_is_rounded_is_said():
    code, answer = explained(
        "w 0.7304\nx 0.3604\ny 0.2402\nz 0.5284", "0.3604 0.2402 0.5284 0.7304"
    )
    assert code == 1 and "scalar part stands last" in answer
    code, answer = explained("qw: 0.782240  qx: 0.589819  qy: 0.199939  qz: 0.000000",
                             "qw: 0.000000  qx: 0.782240  qy: 0.589819  qz: 0.199939")  # fmt: skip
    assert code == 2 and "has length 0.999881: it was taken for one of length 1" in answer


def bench(*arguments):
    done = subprocess.run(
        [sys.executable, "-m", "orientation_workbench", "recording", *map(str, arguments)],
        capture_output=True,
        text=True,
    )
    return done.returncode, done.stdout + done.stderr


#: A trajectory as TUM's benchmark prints it: positions and quaternions, and no instrument.
TUM = "\n".join(
    f"{1305031102.1758 + 0.01 * k:.4f} {1.3405 + 0.01 * k:.4f} 0.6266 1.6575 0.6574 0.6126 -0.2949 "
    "-0.3248"
    for k in range(60)
)


def test_a_trajectory_is_taken_for_no_instrument_and_the_answer_to_the_question_is_heard(tmp_path):
    file = tmp_path / "groundtruth.txt"
    file.write_text(TUM)
    code, answer = bench(file, "--quick")
    assert code == 3 and "which columns are an instrument's" in answer and "--columns" in answer
    assert "1.3405 0.6266 1.6575" in answer  # its first rows are shown
    code, answer = bench(file, "--quick", "--columns", "time=1 gyroscope=2-6")
    assert code == 3 and "a vector has three" in answer


@pytest.mark.long
def test_of_the_public_disagreements_none_is_named_falsely():
    done = subprocess.run(
        [sys.executable, "-m", "tools.disagreements"],
        capture_output=True,
        text=True,
        cwd=REPOSITORY,
    )
    score = done.stdout.strip().splitlines()[-1]
    assert "right" in score and "FALSE" not in score and "not read" not in score, done.stdout
