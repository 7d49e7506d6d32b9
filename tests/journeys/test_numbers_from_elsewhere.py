"""An engineer pastes raw numbers from threads and consoles into the command."""

import io
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from functools import partial

import pytest
from places import REPOSITORY

from orientation_workbench.command import main


def answered(command, *arguments):
    """Return the exit code of the command `orientation`, and all that it prints."""
    printed = io.StringIO()
    with (
        redirect_stdout(printed),
        redirect_stderr(printed),
        pytest.raises(SystemExit) as ended,
    ):
        main([command, *map(str, arguments)])
    return ended.value.code, printed.getvalue()


explained, bench = partial(answered, "explain"), partial(answered, "recording")


# What a reader gives, the exit code, and what the answer has to say.
ASKED = {
    # Small angles, taken as degrees, hardly move, so that a degree of noise fits anything.
    "opposite rotations with noise": (
        ["--noise", "1", "0.21 0.13 -0.32", "-0.21 -0.13 0.32"],
        2,
        ["one is the rotation in the opposite sense"],
    ),
    "more noise than motion": (
        ["--noise", "5", "0.9999 0.0087 0.0052 0.0087", "0.9999 0 0.0141 0"],
        3,
        ["too small to judge", "5 degrees"],
    ),
    "degrees against radians": (
        ["10 20 30", "0.17453 0.34907 0.52360"],
        2,
        ["the first numbers are in degrees, the second in radians"],
    ),
    # Either side may be the one whose rotations are about axes that stay, as in ROS.
    "yaw, pitch, roll against roll, pitch, yaw": (
        ["yaw 30 pitch 20 roll 10", "10 20 30"],
        2,
        [
            "which side's about axes that stay fixed (space fixed)?",
            '--first-is "body fixed" --second-is "space fixed"',
        ],
    ),
    "which of them is space fixed": (
        ["--first-is", "body fixed", "--second-is", "space fixed", "yaw 30 pitch 20 roll 10",
         "10 20 30"],
        0,
        ["the same orientation"],
    ),
    # Axes may be renamed.
    "two sequences": (
        ["-56.523 -7.955 58.222", "-14.216 -55.698 46.402"],
        2,
        [
            "Which sequence of rotations does the first program use?",
            "--first-is zyx --second-is yzx",
            "--first-is yxz --second-is xyz",
        ],
    ),
    "which of them is the first": (
        ["--first-is", "zyx", "-56.523 -7.955 58.222", "-14.216 -55.698 46.402"],
        1,
        ["in the second numbers the sequence of rotations is y-z-x"],
    ),
    "one special pose": (
        ["[3.14,0.2623,0]",
         "array([ 9.91411844e-01,  1.04139110e-04, -1.30774311e-01,  7.89487983e-04])"],
        2,
        ["do not determine the cause"],
    ),
    "a quaternion in lines": (
        ["w 0.7304\nx 0.3604\ny 0.2402\nz 0.5284", "0.3604 0.2402 0.5284 0.7304"],
        1,
        ["scalar part comes last"],
    ),
    "a rounded quaternion": (
        ["qw: 0.782240  qx: 0.589819  qy: 0.199939  qz: 0.000000",
         "qw: 0.000000  qx: 0.782240  qy: 0.589819  qz: 0.199939"],
        2,
        ["has length 0.999881, not 1. We normalised it."],
    ),
    "a whole file of BVH": (
        [
            "HIERARCHY\nROOT Hips\n{\n  OFFSET 0.00 0.00 0.00\n"
            "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n}\n"
            "MOTION\nFrames: 1\nFrame Time: 0.033333\n8.03 35.01 88.36 -3.41 14.78 -164.35",
            "0.7304 0.3604 0.2402 0.5284",
        ],
        3,
        ["only the three angles of one joint", "CHANNELS"],
    ),
    # Follow that advice: paste the joint's angles with their sequence.
    "what was cut out of it": (
        ["--first-is", "zxy", "-3.41 14.78 -164.35", "0.7304 0.3604 0.2402 0.5284"],
        2,
        ["No explanation was found"],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "code", "words"), ASKED.values(), ids=ASKED)
def test_what_is_asked_is_answered(arguments, code, words):
    given, answer = explained(*arguments)
    assert given == code and all(word in answer for word in words), answer


#: ROS's body forward, left, up against forward, right, down: two quaternions, scalar last.
FLU = "0.10050378 0.30151134 -0.50251891 0.80403025"
FRD = "0.80403025 -0.50251891 -0.30151134 -0.10050378"


def test_two_quaternions_scalar_last_are_asked_about():
    code, answer = explained(FLU, FRD)
    assert code == 2 and "Does the scalar part of the quaternions come first or last?" in answer
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
    assert code == 2 and "Are the body's axes the rows or the columns" in answer
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
    rebuilt = Rotation.from_euler("xyz", turn.as_euler("XYZ"))
    for written in (Rotation.as_quat, Rotation.as_matrix):
        texts = [str(written(each)) for each in (turn, rebuilt)]
        code, answer = explained("--first-is", "xyzw", "--second-is", "xyzw", *texts)
        assert "angles were computed as" in answer and "(space fixed)" in answer, answer


Q, P = "0.7304 0.3604 0.2402 0.5284", "0.7404 0.3504 0.2302 0.5254"
MATRIX = "-0.9999 0.0042 -0.0133 -0.0140 -0.2997 0.9539 0.0000 0.9540 0.2997"
# Complete files, pasted whole, and the orientations in them.
FILES = {
    "COLMAP's images.txt": (
        "# Image list with two lines of data per image:\n"
        "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
        "#   POINTS2D[] as (X, Y, POINT3D_ID)\n"
        f"1 {Q} -0.737434 1.02973 3.74354 1 P1180141.JPG\n"
        "2362.39 248.498 58396 1784.7 268.254 59027 1784.7 268.254 -1\n"
        f"2 {P} -0.741434 1.01973 3.71354 1 P1180142.JPG\n\n",
        f"{Q}\n{P}",
    ),
    "a German spreadsheet": (
        f"w;x;y;z\n{Q.replace(' ', ';')}\n{P.replace(' ', ';')}".replace(".", ","),
        f"{Q}\n{P}",
    ),
    "a German spreadsheet without names": (
        f"{Q.replace(' ', ';')}\n{P.replace(' ', ';')}".replace(".", ","),
        f"{Q}\n{P}",
    ),
    "a joint of URDF": (
        '<joint name="camera_joint" type="fixed">\n  <parent link="base_link"/>\n'
        '  <origin xyz="0.12 -0.03 0.4" rpy="0.1 -0.35 1.57"/>\n</joint>',
        "0.68863 0.15742 -0.08847 0.70224",
    ),
    "a node of glTF": (
        '{"nodes":[{"name":"Camera","rotation":[0.3604,0.2402,0.5284,0.7304],'
        '"translation":[0.1,0.2,0.3]}]}',
        "0.3604 0.2402 0.5284 0.7304",
    ),
    "a table of PX4": (
        "timestamp,timestamp_sample,q[0],q[1],q[2],q[3],delta_q_reset[0],quat_reset_counter\n"
        f"10412000,10411000,{Q.replace(' ', ',')},1,1\n"
        f"10422000,10421000,{P.replace(' ', ',')},1,1",
        f"{Q}\n{P}",
    ),
    "a table of OptiTrack": (
        ",,RigidBody,RigidBody,RigidBody,RigidBody,RigidBody,RigidBody,RigidBody\n"
        ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\n"
        "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z\n"
        "0,0.000000,0.3604,0.2402,0.5284,0.7304,0.123,0.456,0.789\n"
        "1,0.008333,0.3504,0.2302,0.5254,0.7404,0.124,0.457,0.788",
        "0.3604 0.2402 0.5284 0.7304\n0.3504 0.2302 0.5254 0.7404",
    ),
    "transforms.json": (
        '{"camera_angle_x": 0.69, "frames": [{"file_path": "./r_0", "rotation": 0.0125, '
        '"transform_matrix": [[-0.9999, 0.0042, -0.0133, -0.0538], [-0.0140, -0.2997, 0.9539, '
        "3.8455], [0.0, 0.9540, 0.2997, 1.2081], [0.0, 0.0, 0.0, 1.0]]}]}",
        MATRIX,
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_pasted_whole(name):
    code, answer = explained(*FILES[name])
    assert code == 0 and "the same orientation" in answer, answer


# A trajectory as TUM's benchmark prints it: positions and quaternions, without an instrument.
TUM = "\n".join(
    f"{1305031102.1758 + 0.01 * k:.4f} {1.3405 + 0.01 * k:.4f} 0.6266 1.6575 0.6574 0.6126 -0.2949 "
    "-0.3248"
    for k in range(60)
)


def test_a_trajectory_is_taken_for_no_instrument_and_the_answer_to_the_question_is_heard(tmp_path):
    file = tmp_path / "groundtruth.txt"
    file.write_text(TUM)
    code, answer = bench(file, "--quick")
    assert code == 3 and "which columns come from which sensor" in answer and "--columns" in answer
    assert "1.3405 0.6266 1.6575" in answer  # the answer shows its first rows
    for columns, words in (
        ("time=1 gyroscope=2-6", "a vector three"),
        (
            "time=1 gyrscope=2-4",
            "'gyrscope' is not a kind of column: choose from time, gyroscope, accelerometer",
        ),
        ("time=1 gyroscope=7-9", "does not describe columns from 1 to 8"),
        ("gyroscope=2,3,4", "write an entry such as gyroscope=2-4"),
    ):
        code, answer = bench(file, "--quick", "--columns", columns)
        assert code == 3 and words in answer


def test_of_a_walking_leg_no_axes_are_named_that_are_not_its_own():
    """Acceleration exceeds gravity there, and there is no magnetometer."""
    legs = REPOSITORY / "packages" / "orientation-lab" / "src" / "orientation_recordings" / "data"
    for leg in ("lower_leg.csv", "upper_leg.csv"):
        code, answer = bench(
            legs / leg, "--quick", "--rate", "120", "--columns", "gyroscope=5-7:rad/s"
        )
        findings = " ".join(
            answer.partition("axes of the gyroscope")[2].partition("ok  ")[0].split()
        )
        assert code == 0 and ("x, y, z" in findings or "acceleration hides gravity" in findings), (
            answer
        )


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
