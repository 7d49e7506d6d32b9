"""The converter: every program's numbers there and back, each line of code
run by the library that it is for.
"""

import itertools
from importlib import import_module
from importlib.metadata import version

import numpy as np
import pypdfium2
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import random_dcms, rotation_error
from scipy.spatial.transform import Rotation

import orientation
from orientation_figures import card
from orientation_figures.moving import ConverterFigure
from orientation_workbench import explain
from orientation_workbench.programs import OTHER, PROGRAMS
from tools.programs.converter import converted, sides

#: Libraries that are there for every test; the others are asked by ``python -m tools.programs``.
HERE = ("this book", "SymPy mechanics", "SciPy", "pytransform3d")


def examples():
    """Orientations far from lock and from half turns, at a half turn, and at no turn."""
    return [*random_dcms(3, 7), np.diag([1.0, -1, -1]), np.eye(3)]


def run_line(program, line):
    """The orientation, as this book's matrix, of a line that the converter gives for a program."""
    names = {"np": np, "sm": sm, "Rotation": Rotation} | vars(orientation)
    if program == "this book":
        return eval(line, names)
    if program == "SymPy mechanics":
        names |= {"N": me.ReferenceFrame("N"), "A": me.ReferenceFrame("A")}
        eval(line, names)
        return np.array(names["A"].dcm(names["N"]), float)
    if program == "SciPy":
        return eval(line, names).as_matrix().T
    return eval(line, names | {"pr": import_module("pytransform3d.rotations")}).T


@pytest.mark.parametrize("program", HERE)
def test_each_line_makes_the_orientation_in_its_library(program):
    jobs = [{"side": side, "dcm": dcm.tolist()} for side in sides(program) for dcm in examples()]
    for job, answer in zip(jobs, converted(jobs), strict=True):
        assert answer["line"], job["side"]
        matrix = np.asarray(run_line(program, answer["line"]), float)
        assert np.allclose(matrix, job["dcm"], atol=1e-8), (job["side"], answer)


def test_what_one_side_writes_every_other_reads():
    """There and back through text for every pair of programs, and
    each pair of forms at least once.
    """
    random = np.random.default_rng(3)
    everything = {program: sides(program) for program in (*PROGRAMS, OTHER)}
    pairs = [
        (
            everything[first][random.integers(len(everything[first]))],
            everything[second][random.integers(len(everything[second]))],
        )
        for first, second in itertools.product(everything, repeat=2)
    ] + [(side, side) for sides in everything.values() for side in sides]
    dcms = random_dcms(len(pairs), 4)
    texts = converted(
        [{"side": first, "dcm": dcm.tolist()} for (first, _), dcm in zip(pairs, dcms)]
    )
    between = converted(
        [{"side": first, "text": text["text"]} for (first, _), text in zip(pairs, texts)]
    )
    texts = converted(
        [{"side": second, "dcm": answer["dcm"]} for (_, second), answer in zip(pairs, between)]
    )
    ends = converted(
        [{"side": second, "text": text["text"]} for (_, second), text in zip(pairs, texts)]
    )
    assert max(rotation_error(np.array(end["dcm"]), dcm) for end, dcm in zip(ends, dcms)) < 1e-7


def known(side):
    """What the numbers of a side of the converter are, in the words of the workbench."""
    if "angles" not in side["form"]:
        return {"kind": {"axis times angle": "rotation vector"}.get(side["form"], side["form"])}
    axes = side["form"].removesuffix(" angles")
    return {
        "kind": "Euler angles",
        "sequence": side["sequence"],
        "axes of the turns": axes,
        "places": "123",
        "signs": "+++",
    }


@pytest.mark.parametrize("everything", [False, pytest.param(True, marks=pytest.mark.further)])
def test_converter_and_workbench_mean_the_same_by_a_program(everything):
    """What the converter writes for a second program is what, for the
    workbench, both manuals promise.

    Each program beside this book's, and each two neighbours of those whose
    axes are known; with --every-case all pairs.
    """
    with_axes = [program for program, facts in PROGRAMS.items() if facts.get("body")]
    pairs = [("this book", program) for program in PROGRAMS] + list(itertools.pairwise(with_axes))
    if everything:
        pairs = list(itertools.product(PROGRAMS, repeat=2))
    dcms, jobs = random_dcms(2, 12), []
    for which, pair in enumerate(pairs):
        first, second = (sides(program)[which % len(sides(program))] for program in pair)
        for dcm in dcms:
            jobs += [
                {"side": first, "dcm": dcm.tolist()},
                {"source": first, "side": second, "dcm": dcm.tolist()},
            ]
    answers, exchanged = converted(jobs), 0
    for which, pair in enumerate(pairs):
        job, other_job, *_ = jobs[4 * which : 4 * which + 4]
        texts = [
            "\n".join(answers[4 * which + k]["text"] for k in those) for those in ((0, 2), (1, 3))
        ]
        sentence = answers[4 * which + 1]["said"]
        exchanged += "x, y, z point" in sentence
        if "none are exchanged" in sentence:
            continue
        explanation = explain(
            *texts,
            first_program=pair[0],
            second_program=pair[1],
            first_declared=known(job["side"]),
            second_declared=known(other_job["side"]),
        )
        assert explanation.verdict == "same", (pair, texts, str(explanation))
    assert exchanged >= 8


def test_numbers_that_libraries_give_are_read_as_they_mean_them():
    D_C_A = orientation.dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy")
    theirs = Rotation.from_matrix(D_C_A.T)
    sources = [
        ("SciPy", "quaternion", "zxy", theirs.as_quat()),
        ("SciPy", "matrix", "zxy", theirs.as_matrix()),
        ("SciPy", "axis times angle", "zxy", theirs.as_rotvec()),
        ("SciPy", "body fixed angles", "zyx", theirs.as_euler("ZYX")),
        ("SciPy", "space fixed angles", "zyx", theirs.as_euler("zyx")),
        ("SymPy mechanics", "matrix", "zxy", D_C_A),
    ]
    jobs = [
        {
            "side": {"program": program, "form": form, "sequence": sequence},
            "text": str(np.asarray(numbers).tolist()),
        }
        for program, form, sequence, numbers in sources
    ]
    for source, answer in zip(sources, converted(jobs), strict=True):
        assert rotation_error(np.array(answer["dcm"]), D_C_A) < 1e-12, source
        assert answer["said"] == ""


def test_the_example_of_a_manual_that_cannot_be_run():
    """MathWorks prints what ``angle2dcm`` gives for 0.7854, 0.1,
    0, and for two triples of 'YXZ'.
    """
    printed = [
        (
            "zyx",
            "0.7854 0.1 0",
            [[0.7036, 0.7036, -0.0998], [-0.7071, 0.7071, 0], [0.0706, 0.0706, 0.9950]],
        ),
        (
            "yxz",
            "0.1 0 0.7854",
            [[0.7036, 0.7071, -0.0706], [-0.7036, 0.7071, 0.0706], [0.0998, 0, 0.9950]],
        ),
        (
            "yxz",
            "0.3 0.1 0.5",
            [[0.8525, 0.4770, -0.2136], [-0.4321, 0.8732, 0.2254], [0.2940, -0.0998, 0.9506]],
        ),
    ]
    side = {"program": "MATLAB Aerospace", "form": "body fixed angles"}
    answers = converted(
        [{"side": side | {"sequence": sequence}, "text": text} for sequence, text, _ in printed]
    )
    for (_, text, expected), answer in zip(printed, answers):
        assert np.allclose(answer["dcm"], expected, atol=6e-5), text


@pytest.mark.parametrize(
    "form, text, message",
    [
        ("quaternion", "1 0 0", "There are 3 numbers here, but quaternion needs 4"),
        ("quaternion", "1", "There is 1 number here, but quaternion needs 4"),
        ("quaternion", "2, 0, 0, 0", "length 2.0000, not 1"),
        ("matrix", "1 0 0 0 1 0 0 0 -1", "left-handed"),
        ("matrix", "nothing", "0 numbers"),
        ("body fixed angles", "0,5 0 0", "Write 0.5 for one half: a comma separates two numbers."),
        *(
            ("body fixed angles", f"{angle} 0 0", f"This contains '{angle}': work it out")
            for angle in ("pi/2", "\u03c0/2", "2*pi", "2pi", "sqrt2", "1/2")
        ),
        ("body fixed angles", "90\u00b0 0 0", "These are degrees"),
        ("body fixed angles", "roll=0.1 pitch=0.2 yaw=0.3", "named roll, pitch, yaw. Write them"),
        ("matrix", str(np.eye(4).tolist()), "only the three columns of its rotation"),
    ],
)
def test_what_means_no_orientation_is_refused_in_the_readers_terms(form, text, message):
    (answer,) = converted(
        [{"side": {"program": "this book", "form": form, "sequence": "zyx"}, "text": text}]
    )
    assert message in answer["fault"]


@pytest.mark.parametrize("program", ["this book", "SciPy"])
def test_named_parts_are_read_by_their_names(program):
    quaternion = {"program": program, "form": "quaternion", "sequence": "zyx"}
    angles = {"program": program, "form": "body fixed angles", "sequence": "zyx"}
    texts = [
        "w=0.8, x=0, y=0, z=0.6",
        '{"x": 0, "y": 0, "z": 0.6, "w": 0.8}',
        "x: 0\ny: 0\nz: 0.6\nw: 0.8",
        "Quaternion(x=0, w=0.8, z=0.6, y=0)",
    ]
    jobs = [{"side": quaternion, "text": text} for text in texts]
    jobs += [{"side": angles, "text": f"yaw={2 * np.arcsin(0.6)}, pitch=0, roll=0"}]
    about_z = orientation.simple_dcm("z", 2 * np.arcsin(0.6))
    expected = about_z if program == "this book" else None
    dcms = [np.array(answer["dcm"]) for answer in converted(jobs)]
    for dcm in dcms:
        assert rotation_error(dcm, dcms[0] if expected is None else expected) < 1e-12
    assert abs(abs(dcms[0][0, 1]) - 0.96) < 1e-12


def test_rounded_numbers_are_taken_and_said_to_be():
    side = {"program": "this book", "sequence": "zyx"}
    quaternion, matrix, degrees = converted(
        [
            {"side": side | {"form": "quaternion"}, "text": "0,97; 0,0; 0,0; 0,26"},
            {
                "side": side | {"form": "matrix"},
                "text": "[[0.87, 0.5, 0], [\u2212 0.5, 0.87, - 0.0], [0, 0, 1]]",
            },
            {"side": side | {"form": "body fixed angles"}, "text": "30, 0, 0"},
        ]
    )
    assert (
        "set to 1" in quaternion["said"]
        and "rounded" in matrix["said"]
        and "degrees?" in degrees["said"]
    )
    assert (
        rotation_error(np.array(matrix["dcm"]), orientation.simple_dcm("z", np.radians(30))) < 0.01
    )


def test_the_table_names_the_version_that_is_here():
    assert PROGRAMS["SymPy mechanics"]["version"] == version("sympy")


def test_a_side_that_does_not_exist_is_refused():
    for side, message in (
        ({"program": "SciPi"}, "choose from this book, SymPy"),
        (
            {"program": "OpenCV", "form": "quaternion"},
            "OpenCV does not take quaternion; it takes matrix",
        ),
        ({"programme": "SciPy"}, "choose from program"),
    ):
        with pytest.raises(Exception, match=message):
            ConverterFigure(source=side)


def test_the_printed_card_is_what_the_table_makes():
    """Two pages with every line of every program; the committed
    files are those of the generator.
    """
    text = "".join(
        page.get_textpage().get_text_bounded() for page in pypdfium2.PdfDocument(card.FILE)
    )
    for program, _, convention, lines in card.rows():
        assert program in text and convention in text
        for form, line in lines:
            assert form in text and line.split(" * ")[0] in text, line
    assert (
        "C.T" in dict(dict((name, lines) for name, _, _, lines in card.rows())["SciPy"])["matrix"]
    )
    assert {name: file.read_bytes() for name, file in card.FILES.items()} == card.drawn(), (
        f"run `{card.COMMAND}`"
    )
