"""Two programs that disagree: every mix-up is found by the
numbers, none is named of unrelated ones.
"""

import functools
import itertools
import json
import random
import re
from pathlib import Path

import numpy as np
import pytest
from pasted import PASTED
from places import REPOSITORY
from scipy.spatial.transform import Rotation

from coursework.checking import questions as questions_module
from orientation import (
    SEQUENCES,
    body_fixed_from_dcm,
    quaternion_from_dcm,
    random_orientations,
    simple_dcm,
)
from orientation_workbench import explain
from orientation_workbench.command import main
from orientation_workbench.mismatch import explanation, mend, search, table
from orientation_workbench.mismatch.meaning import dcms_from_numbers, numbers_from_dcms
from orientation_workbench.mismatch.text import read_poses


def printed(poses, decimals=5):
    return "\n".join(
        " ".join(f"{number:.{decimals}f}" for number in np.ravel(pose)) for pose in poses
    )


def known(generator):
    """A kind of numbers, and the sequence of its angles as a user would say it."""
    kind = generator.choice(list(table.COUNTS))
    return {"kind": kind} | (
        {"sequence": generator.choice(SEQUENCES)} if kind == "Euler angles" else {}
    )


@functools.cache
def by_faults(what):
    """Readings of what is declared, or relations, by how many faults they have."""
    if what == "relations":
        listed = table.relations()
    else:
        declared = dict(what)
        listed = table.readings(declared.pop("kind"), declared)
    return {faults: [entry for entry in listed if entry["faults"] == faults] for faults in range(4)}


def random_chain(generator, declared, faults):
    parts = [by_faults(tuple(sorted(side.items()))) for side in declared] + [by_faults("relations")]
    shares = [shares for shares in itertools.product(range(4), repeat=3) if sum(shares) == faults
              and all(part[share] for part, share in zip(parts, shares))]  # fmt: skip
    chosen = [generator.choice(part[share]) for part, share in zip(parts, generator.choice(shares))]
    both, rarity, _ = table.of_both(*chosen[:2])
    return search.Chain(*chosen, both + chosen[2]["faults"], rarity + chosen[2]["rarity"], 0.0)


def both_sides(chain, dcms):
    """What the two programs give for orientations of the first, by a chain."""
    related = np.swapaxes(dcms, 1, 2) if chain.relation["inverse"] else dcms
    left, right = (
        np.array(table.axes_matrix(chain.relation[whose])) for whose in ("body", "world")
    )
    return numbers_from_dcms(chain.first, dcms)[0], numbers_from_dcms(
        chain.second, left @ related @ right.T
    )[0]


def same_meaning(chains, first, kind):
    """Which chains do the same to whatever is pasted as the first of them."""
    keys = explanation._predictions(
        chains, {kind: explanation._samples(kind, read_poses(first, "first", kind))}, 5
    )
    return [not keys[0].isdisjoint(key) for key in keys]


def test_mixtures_of_up_to_three_faults():
    """The true chain is always among the answers, first in 95 of 100;
    elsewhere what is first costs no more.
    """
    generator, orientations = random.Random(500), np.random.default_rng(500)
    first_place, count = 0, 30
    for _ in range(count):
        declared = known(generator), known(generator)
        truth = random_chain(generator, declared, generator.randint(1, 3))
        first, second = map(printed, both_sides(truth, random_orientations(2, orientations)))
        explained = explain(first, second, first_declared=declared[0], second_declared=declared[1])
        same = same_meaning([truth, *explained.chains], first, declared[0]["kind"])[1:]
        assert any(same), (truth.words(), str(explained))
        first_place += same[0]
        if not same[0]:
            assert explained.chains[0].cost <= truth.cost
        if explained.verdict == "named":
            texts = zip((first, second), declared, strict=True)
            all_wanted, other = (
                read_poses(text, "one", known["kind"]).numbers for text, known in texts
            )
            names = {"np": np, "Rotation": Rotation}
            for wanted, second in zip(all_wanted, other, strict=True):
                kind = declared[1]["kind"]
                second = second.reshape(3, 3) if kind == "matrix" else second
                mended = eval(mend.python_line(explained.chains[0]), names | {"second": second})
                mended = dcms_from_numbers(explained.chains[0].first, np.ravel(mended)[None])
                assert np.allclose(
                    mended, dcms_from_numbers(explained.chains[0].first, wanted[None]), atol=1e-3
                )
    assert first_place >= 0.95 * count


@pytest.mark.parametrize("start", ["planar", "at rest"])
def test_the_pose_that_is_asked_for_decides(start):
    """One more pose decides, turned about as far as was asked; where an entry happens to print as
    zero again, as one in some hundred does, the next.
    """
    generator, asked_twice, count = random.Random(700), 0, 7
    for _ in range(count):
        axis = generator.choice("xyz")
        angle = generator.uniform(0.2, 1.2) if start == "planar" else 0.0
        dcms = [np.array(simple_dcm(axis, angle))]
        kinds = [{"kind": generator.choice(["matrix", "quaternion"])} for _ in range(2)]
        truth = random_chain(generator, kinds, generator.randint(1, 2))
        for asked in range(3):
            texts = [printed(numbers) for numbers in both_sides(truth, np.array(dcms))]
            explained = explain(*texts, first_declared=kinds[0], second_declared=kinds[1])
            if asked and not explained.further_pose:
                break
            turns = next(
                turns for words, turns in table.FURTHER_POSES if words == explained.further_pose
            )
            dcm = dcms[-1]
            for name, degrees in turns:
                turn = simple_dcm(name, np.radians(degrees + generator.uniform(-4, 4)))
                dcm = np.array(turn) @ dcm
            dcms.append(dcm)
        asked_twice += asked == 2
        assert explained.verdict in ("named", "same") or explained.names, (texts, str(explained))
        # Orders that nobody uses are not asked about.
        if explained.names and usual_orders(truth):
            assert shows(explained, truth, kinds), (texts, truth.words(), str(explained))
        assert same_meaning([truth, *explained.chains], texts[0], kinds[0]["kind"])[1]
    assert asked_twice <= 0.01 * count


def test_what_special_poses_leave_open():
    """Of the 2,304 relations by signed axes, a turn about one axis leaves
    eight and rest leaves forty-eight.
    """
    turned = printed([simple_dcm("z", 0.5)])
    back = printed([simple_dcm("z", -0.5)])
    assert len(explain(turned, back).chains) == 8
    assert len(explain("1 0 0\n0 1 0\n0 0 1", "1 0 0\n0 1 0\n0 0 1").chains) == 48


def test_a_mounting_is_told_by_three_poses_and_two_by_four():
    poses, constants = (
        random_orientations(4, np.random.default_rng(8)),
        random_orientations(2, np.random.default_rng(9)),
    )
    one_side = explain(printed(poses[:3]), printed(constants[0] @ poses[:3]))
    both = explain(printed(poses), printed(constants[0] @ poses @ constants[1]))
    assert [one_side.verdict, both.verdict] == ["named", "named"]
    assert np.abs(one_side.chains[0].relation["body turn"] - constants[0]).max() < 1e-3
    assert np.abs(both.chains[0].relation["world turn"] - constants[1]).max() < 1e-3
    assert explain(printed(poses[:2]), printed(constants[0] @ poses[:2])).verdict == "unrelated"


def test_noise_is_said():
    poses = random_orientations(3, np.random.default_rng(4))
    shaken = random_orientations(3, np.random.default_rng(4))
    shaken = np.array([np.array(simple_dcm("x", 0.02)) @ dcm for dcm in shaken])
    assert (
        explain(printed(poses), printed(np.swapaxes(shaken, 1, 2)), noise=0.03)
        .faults[0]
        .startswith("one is the tr")
    )


DCM = random_orientations(1, np.random.default_rng(2))[0]
Q = quaternion_from_dcm(DCM)
SPELLINGS = {
    "brackets": "[[{}, {}, {}],\n [{}, {}, {}],\n [{}, {}, {}]]",
    "one line of brackets": "[[{}, {}, {}], [{}, {}, {}], [{}, {}, {}]]",
    "C": "double m[3][3] = {{{{{}, {}, {}}}, {{{}, {}, {}}}, {{{}, {}, {}}}}};",
    "C floats": "const float m[9] = {{{}f, {}f, {}f, {}f, {}f, {}f, {}f, {}f, {}f}};",
    "MATLAB": "R = [{} {} {}; {} {} {}; {} {} {}]",
    "NumPy": "array([[{}, {}, {}],\n       [{}, {}, {}],\n       [{}, {}, {}]], dtype=float32)",
    "with a place": "[{}, {}, {}, 4.5]\n[{}, {}, {}, -7.25]\n[{}, {}, {}, 1]\n[0, 0, 0, 1]",
    "YAML": "rows:\n - [{}, {}, {}]\n - [{}, {}, {}]\n - [{}, {}, {}]",
}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_spellings_of_a_matrix(spelling):
    text = SPELLINGS[spelling].format(*(f"{entry:.6f}" for entry in DCM.ravel()))
    poses = read_poses(text, "first")
    assert poses.kinds == ("matrix",) and np.abs(poses.numbers - DCM.ravel()).max() < 1e-6
    assert poses.half == pytest.approx(5e-7)


QUATERNIONS = {
    "ROS": "pose:\n  position:\n    x: 1.5\n    y: 0.2\n    z: 9.0\n"
    "  orientation:\n    x: {x}\n    y: {y}\n    z: {z}\n    w: {w}",
    "JSON": '{{"position": {{"x": 3, "y": 1, "z": 2}}, "orientation": {{"w": {w}, "x": {x}, "y": '
    '{y}, "z": {z}}}}}',
    "a trajectory": "1305031102.1758 1.3405 0.6266 1.6575 {x} {y} {z} {w}",
    "Unity": "({x}, {y}, {z}, {w})",
    "minus signs": "({x}, {y}, {z}, {w})",
}


@pytest.mark.parametrize("spelling", QUATERNIONS)
def test_spellings_of_a_quaternion(spelling):
    text = QUATERNIONS[spelling].format(**{part: f"{entry:.6f}" for part, entry in zip("wxyz", Q)})
    if spelling == "minus signs":
        text = text.replace("-", "\N{MINUS SIGN}")
    (numbers,) = read_poses(text, "first").numbers
    wanted = Q if spelling in ("ROS", "JSON") else np.roll(Q, -1)
    assert np.abs(numbers - wanted).max() < 1e-6


def entries(form="{:.6f}"):
    return [form.format(entry) for entry in DCM.ravel()]


def parts(form="{:.6f}"):
    return dict(zip("wxyz", (form.format(part) for part in Q)))


#: One orientation as it stands in consoles, logs and files.
SPELLED = {
    "PyTorch": "tensor([[{}, {}, {}],\n        [{}, {}, {}],\n"
    "        [{}, {}, {}]], device='cuda:0',\n"
    "       dtype=torch.float64, grad_fn=<StackBackward0>)".format(*entries()),
    "TensorFlow": "<tf.Tensor: shape=(3, 3), dtype=float32, numpy=\narray("
    "[[{}, {}, {}],\n [{}, {}, {}],\n [{}, {}, {}]], dtype=float32)>".format(*entries()),
    "NumPy 2": "[" + ", ".join(f"np.float64({entry})" for entry in entries()) + "]",
    "Eigen": "{} {} {}\n{} {} {}\n{} {} {}".format(
        *(f"{entry:>10}" for entry in entries("{:.6g}"))
    ),
    "glm": "mat3x3(({}, {}, {}), ({}, {}, {}), ({}, {}, {}))".format(*entries()),
    "by index": "\n".join(f"R[{k // 3}][{k % 3}] = {entry};" for k, entry in enumerate(entries())),
    "by index in C++": "\n".join(
        f"R({k // 3},{k % 3}) = {entry};" for k, entry in enumerate(entries())
    ),
    "MATLAB's console": "R =\n\n    {}    {}    {}\n    {}    {}    {}\n"
    "    {}    {}    {}\n".format(*entries()),
    "MATLAB's pages": "R(:,:,1) =\n\n    {}    {}    {}\n    {}    {}    {}\n"
    "    {}    {}    {}\n".format(*entries()),
    "KUKA": "{{X 512.3, Y -80.1, Z 300.0, A {:.6f}, B {:.6f}, C {:.6f}}}".format(
        *np.degrees(body_fixed_from_dcm(DCM, "zyx"))
    ),
    "KUKA with its status": "XP1={{E6POS: X 512.3,Y -80.1,Z 300.0,A {:.6f},B {:.6f},C {:.6f},S 2,"
    "T 35,E1 0.0}}".format(*np.degrees(body_fixed_from_dcm(DCM, "zyx"))),
    "vectors in brackets before their names": "first ({}, {}, {}), second ({}, {}, {}), "
    "third ({}, {}, {}): rows".format(*entries()),
    "Fanuc": "X = 512.3 mm, Y = -80.1 mm, Z = 300.0 mm,\n"
    "W = {2:.6f} deg, P = {1:.6f} deg, R = {0:.6f} deg".format(
        *np.degrees(body_fixed_from_dcm(DCM, "zyx"))
    ),
    "R": "       [,1]    [,2]    [,3]\n[1,] {} {} {}\n[2,] {} {} {}\n[3,] {} {} {}".format(
        *entries()
    ),
    "MATLAB's live script": "R = 3\u00d73\n    {}    {}    {}\n    {}    {}    {}\n"
    "    {}    {}    {}".format(*entries()),
    "Julia": "3\u00d73 SMatrix{{Float64}} with indices SOneTo(3)\u00d7SOneTo(3):\n {} {} {}\n"
    " {} {} {}\n"
    " {} {} {}".format(*entries()),
    "Blender": "<Matrix 3x3 ({}, {}, {})\n            ({}, {}, {})\n"
    "            ({}, {}, {})>".format(*entries()),
    "nalgebra": "  \u250c              \u2510\n  \u2502 {} {} {} \u2502\n  \u2502 {} {} {} \u2502"
    "\n  \u2502 {} {} {} \u2502\n  \u2514         \u2518".format(*entries()),
    "OpenCV's YAML": "R: !!opencv-matrix\n"
    "   rows: 3\n"
    "   cols: 3\n"
    "   dt: d\n"
    "   data: [ {},\n"
    "       {}, {}, {},\n"
    "       {}, {}, {}, {}, {} ]".format(*entries("{:.10e}")),
    "TeX": r"\begin{{bmatrix}} {} & {} & {} \\ {} & {} & {} \\ {} & {} & {} \end{{bmatrix}}".format(
        *entries()
    ),
    "Markdown": "| {} | {} | {} |\n|---|---|---|\n| {} | {} | {} |\n| {} | {} | {} |".format(
        *entries()
    ),
    "quoted": "> {}, {}, {}\n> {}, {}, {}\n> {}, {}, {}".format(*entries()),
    "decimal commas": "{}; {}; {}\n{}; {}; {}\n{}; {}; {}".format(
        *(entry.replace(".", ",") for entry in entries())
    ),
    "Fortran": "{} {} {}\n{} {} {}\n{} {} {}".format(
        *(entry.replace("e", "D") for entry in entries("{:.10e}"))
    ),
    "NeRF": '{{"camera_angle_x": 0.6911, "frames": [{{"file_path": "./images/0001.png", '
    '"rotation": '
    "0.0125, "
    '"transform_matrix": [[{}, {}, {}, 1.5], [{}, {}, {}, 2.0], [{}, {}, {}, 0.25], [0.0, 0.0, '
    "0.0, 1.0]]}}]}}".format(*entries()).replace('"rotation": 0.0125, ', ""),
    "KITTI": "{} {} {} 4.7 {} {} {} -1.25 {} {} {} 0.5".format(*entries()),
    "ROS 2 in Python": "geometry_msgs.msg.Pose(position=geometry_msgs.msg.Point(x=1.0, y=2.0, "
    "z=3.0), orientation=geometry_msgs.msg.Quaternion(x={x}, y={y}, z={z}, "
    "w={w}))".format(**parts()),
    "an Imu message": "header:\n"
    "  seq: 12\n"
    "  stamp:\n"
    "    secs: 1574817405\n"
    "    nsecs: 846164606\n"
    "  frame_id: imu_link\n"
    "orientation:\n"
    "  x: {x}\n"
    "  y: {y}\n"
    "  z: {z}\n"
    "  w: {w}\n"
    "orientation_covariance: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n"
    "angular_velocity:\n"
    "  x: 0.1\n"
    "  y: 0.2\n"
    "  z: 0.3\n"
    "angular_velocity_covariance: [0.0, 0.0, 0.0]\n"
    "linear_acceleration:\n"
    "  x: 0.1\n"
    "  y: 0.2\n"
    "  z: 9.8\n"
    "---".format(**parts()),
    "tf2_echo": "At time 1641239122.213901124\n"
    "- Translation: [1.000, 2.000, 3.000]\n"
    "- Rotation: in Quaternion (xyzw) [{x}, {y}, {z}, {w}]\n"
    "- Rotation: in RPY (radian) [0.1, 0.2, 0.3]\n"
    "- Rotation: in RPY (degree) [5.7, 11.4, 17.1]\n"
    "- Matrix:\n"
    "  1.000  0.000  0.000  1.000".format(**parts()),
    "three.js": '{{"isQuaternion":true,"_x":{x},"_y":{y},"_z":{z},"_w":{w}}}'.format(**parts()),
    "Blender's quaternion": "<Quaternion (w={w}, x={x}, y={y}, z={z})>".format(**parts()),
    "Unreal": "X={x} Y={y} Z={z} W={w}".format(**parts()),
    "pyquaternion": "{w} {x}i {y}j {z}k".format(**parts("{:+.6f}")),
    "a sum": "{w} + {x}*i + {y}*j + {z}*k".format(**parts()),
    "URDF": '<origin xyz="0.1 0.2 0.3" quat="{x} {y} {z} {w}"/>'.format(**parts()),
    "a table": "#timestamp [ns],p_x,p_y,p_z,qw,qx,qy,qz,v_x,v_y,v_z\n"
    "1403636580838555648,4.688319,-1.786938,0.783338,"
    "{w},{x},{y},{z},-0.027876,0.033207,0.800006".format(**parts()),
    "COLMAP": "1 {w} {x} {y} {z} -0.737434 1.02973 3.74354 1 P1180141.JPG".format(**parts()),
    "C#": "Debug.Log: ({x}f, {y}f, {z}f, {w}f)".format(**parts()),
    "in words": "x {x} y {y} z {z} w {w}".format(**parts()),
    "a forum": "My sensor gives w={w} x={x} y={y} z={z} when I hold it at about 45 degrees. "
    "Why??".format(**parts()),
    "in a fence": "```python\n>>> r.as_quat()\narray([{x}, {y}, {z}, {w}])\n```\nThanks!!".format(
        **parts()
    ),
    "arguments": "--x 0.1 --y 0 --z 0.2 --qx {x} --qy {y} --qz {z} --qw {w}".format(**parts()),
    "a trajectory's head": "# timestamp tx ty tz qx qy qz qw\n"
    "1305031102.1758 1.3405 0.6 1.6 {x} {y} {z} {w}".format(**parts()),
    "a serial port": "qW: {w} qX: {x} qY: {y} qZ: {z}\t\tSys:3 G:3 A:0 M:1".format(**parts()),
    "Godot": "[X: ({}, {}, {}), Y: ({}, {}, {}), Z: ({}, {}, {}), O: (0.0, 1.5, 2.0)]".format(
        *entries()
    ),
    "three.js's elements": "elements: Array(16)\n"
    "(16) [{}, {}, {}, 0, {}, {}, {}, 0, {}, {}, {}, 0, 0, 0, 0, 1]".format(*entries()),
    "MATLAB's factor": "ans =\n\n   1.0e+00 *\n\n  {} {} {}\n  {} {} {}\n  {} {} {}\n\n>> ".format(
        *entries()
    ),
    "a document": "{} {} {}\n{} {} {}\n{} {} {}".format(*entries()).replace("-", "\u2212 "),
    "a letter": "[{}, {}, {}, {}, {}, {}, {}, {}, {}]".format(*entries()).replace("-", "- "),
    "rows by number": "row 0: {} {} {}\nrow 1: {} {} {}\nrow 2: {} {} {}\ndet = 1.0000".format(
        *entries()
    ),
}


@pytest.mark.parametrize("where", SPELLED)
def test_numbers_as_programs_print_them(where):
    """Whatever stands around the numbers, the orientation is the one that was printed."""
    explained = explain(printed([DCM], 6), SPELLED[where])
    order = "scalar part comes last"
    assert (
        explained.verdict == "same"
        or [fault for fault in explained.faults if order not in fault] == []
    ), str(explained)


def test_angles_as_programs_print_them():
    yaw, pitch, roll = body_fixed_from_dcm(DCM, "zyx")
    degrees = np.degrees([yaw, pitch, roll])
    for text in (
        f"rpy: {roll:.6f} {pitch:.6f} {yaw:.6f}",
        f"roll: {roll:.6f}\npitch: {pitch:.6f}\nyaw: {yaw:.6f}",
        f'<origin rpy="{roll:.6f} {pitch:.6f} {yaw:.6f}" xyz="1 2 3"/>',
        f"roll {roll:.6f} pitch {pitch:.6f} yaw {yaw:.6f}",
        f"<pose>1 2 3 {roll:.6f} {pitch:.6f} {yaw:.6f}</pose>",
        f"[INFO] [1641239122.213901124] [node]: r:{roll:.6f} p:{pitch:.6f} y:{yaw:.6f}",
        f"P={degrees[1]:.6f} Y={degrees[0]:.6f} R={degrees[2]:.6f} degrees",
        f"yaw = {degrees[0]:.6f}\u00b0, pitch = {degrees[1]:.6f}\u00b0, roll = "
        f"{degrees[2]:.6f}\u00b0",
        f"{degrees[0]:.6f}deg {degrees[1]:.6f}deg {degrees[2]:.6f}deg yaw, pitch, roll",
    ):
        assert explain(printed([DCM], 6), text).verdict == "same", text


def test_a_line_that_names_the_columns_is_read():
    """Each table says of its numbers what its head says, in the order in which they stand."""
    yaw, pitch, roll = (f"{angle:.4f}" for angle in np.degrees(body_fixed_from_dcm(DCM, "zyx")))
    named = parts()
    turns = {"sequence": "zyx", "axes of the turns": "body fixed", "unit": "degrees"}
    for text, said in (
        ("qw,qx,qy,qz\n{w},{x},{y},{z}", {"order": "wxyz"}),
        ("x y z w\n{x} {y} {z} {w}\n{x} {y} {z} {w}", {"order": "xyzw"}),
        ("# x y z w\n[{x}, {y}, {z}, {w}]", {"order": "xyzw"}),
        ("time;p_x;p_y;p_z;q_z;q_y;q_x;q_w\n0.01;1;2;3;{z};{y};{x};{w}", {"order": "zyxw"}),
        ("| w | x | y | z |\n|---|---|---|---|\n| {w} | {x} | {y} | {z} |", {"order": "wxyz"}),
        (
            "IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
            "1 {w} {x} {y} {z} 1 2 3 1 a.jpg",
            {"order": "wxyz"},
        ),
        ("quaternion (x, y, z, w): {x} {y} {z} {w}", {"order": "xyzw"}),
        (f"time,roll_deg,pitch_deg,yaw_deg\n0.1,{roll},{pitch},{yaw}", turns | {"places": "321"}),
        (
            f"Yaw (\N{DEGREE SIGN})\tPitch (\N{DEGREE SIGN})\tRoll (\N{DEGREE SIGN})\n"
            f"{yaw}\t{pitch}\t{roll}",
            turns | {"places": "123"},
        ),
    ):
        text = text.format(**named)
        assert read_poses(text, "first").declared == said, text
        assert (
            explain(
                "\n".join([printed([DCM], 6)] * len(read_poses(text, "first").numbers)), text
            ).verdict
            == "same"
        ), text


#: The kinds of mix-up, and where in the table of links each stands.
FAULTS = {
    "transposed": "inverse matrix",
    "conjugate": "inverse quaternion",
    "columns first": "inverse matrix",
    "another order of storage": "order",
    "the other product (JPL)": "inverse quaternion",
    "the body's axes": "body",
    "the world's axes": "world",
    "the other hand": "hand",
    "space fixed for body fixed": "axes of the turns",
    "another sequence": "sequence",
    "angles printed in another order": "places",
    "one angle's sign": "signs",
    "degrees for radians": "unit",
    "a vector of the other sense": "inverse rotation vector",
    "an axis and angle of the other sense": "inverse axis and angle",
    "angles of the inverse": "inverse Euler angles",
    "the angle before its axis": "place of the angle",
    "a constant turn": "turn",
}


def slug(heading):
    return re.sub(r"[^a-z0-9]+", "-", re.sub(r"^#+ (\d+\. )?", "", heading).lower()).strip("-")


def test_every_fault_leads_to_a_section_and_to_a_checked_question():
    """Each fault that can be named has links; each leads to a heading, that of
    a question to something checked.
    """
    groups = {group["group"] for groups in table.KINDS.values() for group in groups}
    assert (
        {*FAULTS.values()}
        == {*table.TAUGHT}
        == groups | {f"inverse {kind}" for kind in table.COUNTS} | {"body", "world", "hand", "turn"}
    )
    for section, *questions in table.TAUGHT.values():
        assert questions
        for (address, title), folder in (
            (section, "chapters"),
            *((question, "tests/solutions") for question in questions),
        ):
            page, _, anchor = address.partition("#")
            cells = json.loads(
                (REPOSITORY / folder / Path(page).with_suffix(".ipynb").name).read_text("utf8")
            )["cells"]
            below, sources = False, []
            for cell in cells:
                source = "".join(cell["source"])
                headings = [line for line in source.split("\n") if line.startswith("#")]
                if cell["cell_type"] == "markdown" and headings:
                    below = anchor in map(slug, headings)
                if below:
                    sources.append(source)
            assert sources and title, address
            if folder != "chapters":
                checked = [
                    name
                    for name in re.findall(
                        r"check\(['\"]([^'\"]+)['\"]", "\n".join(sources), re.MULTILINE
                    )
                ]
                assert checked and all(
                    questions_module.find_question(name, "") for name in checked
                ), address


BAD = {
    "13 numbers": (" ".join(map(str, range(13))), "13 numbers"),
    "positions and angles": ("300 2 3 0.1 0.2 0.3\n4 5 6 0.1 0.2 0.3", "leave out positions"),
    "two poses of a robot": ("p[0.3, 0.2, 0.5, 1, 0, 0]\np[0.3, 0.2, 0.5, 0, 1, 0]", "12 numbers"),
    "a machine tool": ("L X+10 Y+20 Z+30 A+45 B+0 C+10", "6 numbers"),
    "no number": ("nan 0 0 1", "'nan'"),
    "something to be worked out": ("0 0 pi/2", "'pi'"),
    "a fraction": ("1/2 1/2 1/2 1/2", "'1/2'"),
    "text": ("which way", "no numbers: 'which way"),
    "nothing": ("  ", "empty"),
    "no rotation": ("1 0 0\n0 2 0\n0 0 1", "row 2 has length 2"),
    "not at right angles": ("1 0 0\n0.6 0.8 0\n0 0 1", "rows 1 and 2"),
    "no length 1": ("0.5 0.5 0.5 0.9", "neither a quaternion"),
    "minutes and seconds": (
        "12\u00b030'15\" 5\u00b010'20\" 3\u00b00'5\"",
        "degrees, minutes and seconds",
    ),
    "minutes with colons": ("12:30:15 5:10:20 3:00:05", "degrees, minutes and seconds"),
    "minutes without signs": ("12 30 15 5 10 20 3 0 5", "looks like three angles in degrees, min"),
}


@pytest.mark.parametrize("what", BAD)
def test_bad_input_is_told_what_was_read(what, capsys):
    text, words = BAD[what]
    with pytest.raises(ValueError, match=words):
        explain(text, "1 0 0 0")
    with pytest.raises(SystemExit) as left:
        main(["explain", text, "1 0 0 0"])
    assert left.value.code == 3 and "Traceback" not in capsys.readouterr().err


def test_the_command(tmp_path, capsys):
    poses = random_orientations(2, np.random.default_rng(11))
    quaternions = quaternion_from_dcm(poses)
    files = {
        "here": printed(quaternions),
        "there": printed(quaternions[:, [1, 2, 3, 0]]),
        "elsewhere": printed(
            quaternion_from_dcm(random_orientations(2, np.random.default_rng(12)))
        ),
    }
    # Windows PowerShell writes UTF-16, and older programs neither that nor UTF-8.
    for (name, text), encoding in zip(files.items(), ("utf-16", "latin-1", "utf-8"), strict=True):
        (tmp_path / name).write_text(f"# \xb0\n{text}", encoding)
    for second, code, verdict in (
        ("here", 0, "same"),
        ("there", 1, "named"),
        ("elsewhere", 2, "unrelated"),
    ):
        with pytest.raises(SystemExit) as left:
            main(["explain", str(tmp_path / "here"), str(tmp_path / second), "--json"])
        answer = json.loads(capsys.readouterr().out)
        assert (left.value.code, answer["verdict"], answer["format"]) == (code, verdict, 1)
    with pytest.raises(SystemExit):
        main(["explain", str(tmp_path / "here"), str(tmp_path / "there")])
    assert "second[[3, 0, 1, 2]]" in capsys.readouterr().out


@pytest.mark.parametrize(
    "arguments, said",
    [
        (["first.txt", "1 0 0 0"], "no such file: first.txt"),
        (["runs/2026-11/first.csv", "1 0 0 0"], "no such file: runs"),
        (["1 0 0 0"], "required: second"),
        (["1 0 0 0", "1 0 0 0\n0 1 0 0"], "the first side has 1 pose and the second 2:"),
        (["1 0 0 0", "1 0 0 0", "--noise", "much"], "--noise"),
        (["1 0 0 0", "1 0 0 0", "--noise", "-3"], "--noise is -3: it must be at least 0 degrees"),
        (["1 0 0 0", "1 0 0 0", "--noise", "nan"], "--noise is nan: it must be at least 0 degrees"),
        (["1 0 0 0", "1 0 0 0", "--first", "Maya"], "unknown program"),
        (["1 0 0 0", "1 0 0 0", "--first", "ros2"], "'ros2' (did you mean ros?): "),
        (["1 0 0 0", "1 0 0 0", "--first-is", "eulr"], "(did you mean 'Euler angles'?): "),
        (["1 0 0 0", "1 0 0 0", "--first-is", "sideways"], "give a kind of description"),
    ],
)
def test_a_command_that_is_misspelt_is_bad_input(arguments, said, capsys):
    """It ends with 3: 2 would be an answer."""
    with pytest.raises(SystemExit) as left:
        main(["explain", *arguments])
    assert left.value.code == 3 and said in capsys.readouterr().err


def test_every_reading_comes_back():
    generator = random.Random(1)
    for kind in table.COUNTS:
        for reading in generator.sample(listed := table.readings(kind, {}), min(60, len(listed))):
            dcms = random_orientations(3, np.random.default_rng(7))
            for numbers in numbers_from_dcms(reading, dcms):
                assert np.abs(dcms_from_numbers(reading, numbers) - dcms).max() < 1e-9


@pytest.mark.parametrize("case", PASTED, ids=lambda case: case["thread"])
def test_numbers_that_were_pasted_in_threads(case):
    explained = explain(
        case["first"],
        case["second"],
        first_declared=case["known"][0],
        second_declared=case["known"][1],
    )
    assert explained.verdict == case["verdict"], str(explained)
    assert all(words in "; ".join(explained.faults) for words in case["words"]), str(explained)


def shows(explained, truth, known):
    """Whether one of the answers to what is asked is the true description.

    The orders of quaternions must be the true ones, and the other faults the same. Of a fault that
    undoes itself, such as a wrong sign, numbers do not tell on which side it stands.
    """
    readings = [
        next(
            reading
            for large in (False, True)
            for reading in table.readings(side["kind"], declared, large)
            if reading["choices"] == side["choices"]
        )
        for side, declared in zip((truth.first, truth.second), known, strict=True)
    ]
    orders = [side["choices"].get("order") for side in (truth.first, truth.second)]
    # An axis reversed in the world and on the body is told as the other hand.
    axes = truth.relation["body"]
    reversed_too = axes == truth.relation["world"] and table._reverses_one(axes)
    relation = truth.relation | {"hand": reversed_too}
    right = without_sides(search.Chain(*readings, relation, 0, 0.0, 0.0).words())
    return any(
        [side.get("order") for side in name.declare] == orders
        and without_sides(name.faults) == right
        for name in explained.names
    )


def usual_orders(truth):
    return all(
        side["choices"].get("order") in (None, "wxyz", "xyzw")
        for side in (truth.first, truth.second)
    )


def without_sides(faults):
    return sorted(re.sub("in the (first|second) numbers ", "", fault) for fault in faults)
