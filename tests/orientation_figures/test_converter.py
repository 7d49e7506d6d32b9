"""The converter: every program's numbers there and back, each line of code run by the library that it is for."""

import io
import itertools
import json
import re
import subprocess
import sys
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import matplotlib
import numpy as np
import pypdfium2
import pytest
import sympy as sm
import sympy.physics.mechanics as me
from orientations import random_dcms, rotation_error
from scipy.spatial.transform import Rotation

import orientation
from orientation_figures import card
from orientation_figures.moving import ConverterFigure, bundle
from orientation_workbench.programs import FORMS, OTHER
from orientation_workbench.programs import WITH_CODE as PROGRAMS

NODE = Path(sys.executable).with_name("node")
APPLY = """
import { readFileSync } from 'node:fs';
const { programs, jobs } = JSON.parse(readFileSync(0));
const { settled, read, told, line, shown } = (() => {
BODY
return { settled, read, told, line, shown };
})();
const attempt = (work) => { try { return work(); } catch (error) { return { fault: error.message }; } };
console.log(JSON.stringify(jobs.map(({ side, dcm, text }) => attempt(() => {
  const means = settled(side, programs);
  if (dcm) { const numbers = told(means, dcm); return { text: shown(numbers), line: line(means, numbers, programs) }; }
  return read(means, text);
}))));
"""
# SciPy, SymPy and pytransform3d are there for every test, the others where somebody has installed them.
MODULES = {"transforms3d": "transforms3d", "Eigen (C++)": "eigenpy", "MuJoCo model": "mujoco", "OpenCV": "cv2"}
RUN = ("this book", "SymPy mechanics", "SciPy", "pytransform3d", *MODULES)


@pytest.fixture(scope="module")
def converter(tmp_path_factory):
    """``converter(jobs)``: what the front end makes of each side with a matrix to write or a text to read."""
    script = tmp_path_factory.mktemp("node") / "converter.mjs"
    shared = "".join(map(bundle.body, bundle.SHARED))
    script.write_text(shared + APPLY.replace("BODY", bundle.body("converter")), "utf8")

    def run(jobs):
        given = json.dumps({"programs": PROGRAMS, "jobs": jobs})
        done = subprocess.run([NODE, script], input=given, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[-2000:]
        return json.loads(done.stdout)

    return run


def sides(program):
    """Every form and sequence that a program of the table takes; for another program every reading as well."""
    if program == OTHER:
        readings = itertools.product(FORMS, ("zxy", "xyx"), ("as here", "transposed"), ("first", "last"), UNITS)
        return [
            dict(zip(("program", "form", "sequence", "matrix", "scalar", "unit"), (OTHER, *one))) for one in readings
        ]
    found = []
    for form in PROGRAMS[program]["lines"]:
        allowed = PROGRAMS[program].get("sequences", {}).get(form, orientation.SEQUENCES)
        found += [
            {"program": program, "form": form, "sequence": one} for one in (allowed if "angles" in form else ["zyx"])
        ]
    return found


UNITS = ("radians", "degrees")


def examples():
    """Orientations far from lock and from half turns, at a half turn, and at no turn."""
    return [*random_dcms(3, 7), np.diag([1.0, -1, -1]), np.eye(3)]


class Factor(np.ndarray):
    """A matrix whose star is the product of matrices, as in Eigen."""

    def __new__(cls, entries):
        return np.asarray(entries).view(cls)

    def __mul__(self, other):
        return Factor(np.asarray(self) @ np.asarray(other))


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
    if program == "pytransform3d":
        return eval(line, names | {"pr": import_module("pytransform3d.rotations")}).T
    module = pytest.importorskip(MODULES[program])
    if program == "transforms3d":
        names["euler2mat"] = import_module("transforms3d.euler").euler2mat
        names["quat2mat"] = import_module("transforms3d.quaternions").quat2mat
        return eval(line, names).T
    if program == "OpenCV":
        return eval(line, names | {"cv2": module}).T
    if program == "Eigen (C++)":
        axes = type(
            "Vector3d", (), {f"Unit{name}": staticmethod(lambda k=k: np.eye(3)[k]) for k, name in enumerate("XYZ")}
        )
        names |= {
            "Vector3d": axes,
            "AngleAxisd": lambda angle, axis: Factor(module.AngleAxis(angle, axis).toRotationMatrix()),
            "Quaterniond": lambda *parts: module.Quaternion(*parts).toRotationMatrix(),
        }
        return np.asarray(eval(line.replace("::", "."), names)).T
    compiler, body = re.fullmatch(r"(<compiler [^>]*>)? ?(<body [^>]*)/>", line).groups()
    geometry = "<geom size='0.1'/></body>"
    model = module.MjModel.from_xml_string(f"<mujoco>{compiler or ''}<worldbody>{body}>{geometry}</worldbody></mujoco>")
    data = module.MjData(model)
    module.mj_forward(model, data)
    return data.xmat[1].reshape(3, 3).T


@pytest.mark.parametrize(
    "program", [pytest.param(one, marks=[pytest.mark.long] if one in MODULES else []) for one in RUN]
)
def test_each_line_makes_the_orientation_in_its_library(converter, program):
    jobs = [{"side": side, "dcm": dcm.tolist()} for side in sides(program) for dcm in examples()]
    for job, answer in zip(jobs, converter(jobs), strict=True):
        assert answer["line"], job["side"]
        found = np.asarray(run_line(program, answer["line"]), float)
        assert np.allclose(found, job["dcm"], atol=1e-8), (job["side"], answer)


def test_what_one_side_writes_every_other_reads(converter):
    """There and back through text for every pair of programs, and each pair of forms at least once."""
    random = np.random.default_rng(3)
    everything = {program: sides(program) for program in (*PROGRAMS, OTHER)}
    pairs = [
        (
            everything[first][random.integers(len(everything[first]))],
            everything[second][random.integers(len(everything[second]))],
        )
        for first, second in itertools.product(everything, repeat=2)
    ] + [(side, side) for found in everything.values() for side in found]
    dcms = random_dcms(len(pairs), 4)
    texts = converter([{"side": first, "dcm": dcm.tolist()} for (first, _), dcm in zip(pairs, dcms)])
    between = converter([{"side": first, "text": text["text"]} for (first, _), text in zip(pairs, texts)])
    texts = converter([{"side": second, "dcm": one["dcm"]} for (_, second), one in zip(pairs, between)])
    ends = converter([{"side": second, "text": text["text"]} for (_, second), text in zip(pairs, texts)])
    assert max(rotation_error(np.array(end["dcm"]), dcm) for end, dcm in zip(ends, dcms)) < 1e-7


def test_numbers_that_libraries_give_are_read_as_they_mean_them(converter):
    D_C_A = orientation.dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy")
    theirs = Rotation.from_matrix(D_C_A.T)
    given = [
        ("SciPy", "quaternion", "zxy", theirs.as_quat()),
        ("SciPy", "matrix", "zxy", theirs.as_matrix()),
        ("SciPy", "axis times angle", "zxy", theirs.as_rotvec()),
        ("SciPy", "body fixed angles", "zyx", theirs.as_euler("ZYX")),
        ("SciPy", "space fixed angles", "zyx", theirs.as_euler("zyx")),
        ("SymPy mechanics", "matrix", "zxy", D_C_A),
    ]
    jobs = [
        {"side": {"program": program, "form": form, "sequence": sequence}, "text": str(np.asarray(numbers).tolist())}
        for program, form, sequence, numbers in given
    ]
    for one, answer in zip(given, converter(jobs), strict=True):
        assert rotation_error(np.array(answer["dcm"]), D_C_A) < 1e-12, one
        assert answer["said"] == ""


def test_the_example_of_a_manual_that_cannot_be_run(converter):
    """MathWorks prints what ``angle2dcm`` gives for 0.7854, 0.1, 0, and for two triples of 'YXZ'."""
    printed = [
        ("zyx", "0.7854 0.1 0", [[0.7036, 0.7036, -0.0998], [-0.7071, 0.7071, 0], [0.0706, 0.0706, 0.9950]]),
        ("yxz", "0.1 0 0.7854", [[0.7036, 0.7071, -0.0706], [-0.7036, 0.7071, 0.0706], [0.0998, 0, 0.9950]]),
        ("yxz", "0.3 0.1 0.5", [[0.8525, 0.4770, -0.2136], [-0.4321, 0.8732, 0.2254], [0.2940, -0.0998, 0.9506]]),
    ]
    side = {"program": "MATLAB Aerospace", "form": "body fixed angles"}
    answers = converter([{"side": side | {"sequence": sequence}, "text": text} for sequence, text, _ in printed])
    for (_, text, expected), answer in zip(printed, answers):
        assert np.allclose(answer["dcm"], expected, atol=6e-5), text


@pytest.mark.parametrize(
    "form, text, message",
    [
        ("quaternion", "1 0 0", "3 numbers are there, and 4 were expected"),
        ("quaternion", "2, 0, 0, 0", "length 2.0000, not 1"),
        ("matrix", "1 0 0 0 1 0 0 0 -1", "left-handed"),
        ("matrix", "nothing", "0 numbers"),
    ],
)
def test_what_means_no_orientation_is_refused_in_the_readers_terms(converter, form, text, message):
    (answer,) = converter([{"side": {"program": "this book", "form": form, "sequence": "zyx"}, "text": text}])
    assert message in answer["fault"]


def test_rounded_numbers_are_taken_and_said_to_be(converter):
    side = {"program": "this book", "sequence": "zyx"}
    quaternion, matrix, degrees = converter(
        [
            {"side": side | {"form": "quaternion"}, "text": "q = [0.97, 0, 0, 0.26]"},
            {"side": side | {"form": "matrix"}, "text": "[[0.87, 0.5, 0], [\u22120.5, 0.87, 0], [0, 0, 1]]"},
            {"side": side | {"form": "body fixed angles"}, "text": "30, 0, 0"},
        ]
    )
    assert "is made 1" in quaternion["said"] and "rounded" in matrix["said"] and "degrees?" in degrees["said"]
    assert rotation_error(np.array(matrix["dcm"]), orientation.simple_dcm("z", np.radians(30))) < 0.01


def test_the_table_names_the_versions_that_are_here():
    for program, package in (("SymPy mechanics", "sympy"), ("SciPy", "scipy"), ("pytransform3d", "pytransform3d")):
        assert PROGRAMS[program]["version"] == version(package)


def test_a_side_that_does_not_exist_is_refused():
    for side, message in (
        ({"program": "SciPi"}, "there is this book, SymPy"),
        ({"program": "OpenCV", "form": "quaternion"}, "OpenCV takes no quaternion; it takes matrix"),
        ({"programme": "SciPy"}, "what can be chosen is program"),
    ):
        with pytest.raises(Exception, match=message):
            ConverterFigure(source=side)


def test_the_printed_card_is_what_the_table_makes():
    """One page with every line of every program; the committed files are those of the generator."""
    (text,) = [page.get_textpage().get_text_bounded() for page in pypdfium2.PdfDocument(card.FILES[0])]
    for program, _, convention, lines in card.rows():
        assert program in text and convention in text
        for form, line in lines:
            assert form in text and line.split(" * ")[0] in text, line
    assert "C.T" in dict(dict((name, lines) for name, _, _, lines in card.rows())["SciPy"])["matrix"]
    with matplotlib.rc_context(card.SETTINGS):
        drawn = io.BytesIO()
        card.draw().savefig(drawn, format="pdf", metadata=card.metadata("pdf"))
    assert drawn.getvalue() == card.FILES[0].read_bytes(), f"run `{card.COMMAND}`"
