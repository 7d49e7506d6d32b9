"""The Python side of the moving figures: what they accept, and what a notebook stores of them."""

import ast
import json
import math
import re
import subprocess
import sys
from fractions import Fraction
from functools import partial
from pathlib import Path

import nbformat
import numpy as np
import pytest
import sympy as sm
from bs4 import BeautifulSoup
from figure_pages import CHANGES
from scipy.spatial.transform import Rotation
from traitlets import TraitError

import orientation as module
from notebook_pages.live.cells import PYTHON
from notebook_pages.moving import WIDGET
from notebook_pages.notebooks import normalise
from orientation import dcm_from_quaternion
from orientation_figures import moving
from orientation_figures.moving import (
    BeltFigure,
    ChallengeFigure,
    GimbalFigure,
    GraphFigure,
    MotionFigure,
    NineNumbersFigure,
    QuaternionFigure,
    SuccessiveFigure,
    TriadFigure,
    bundle,
    glyphs,
    javascript,
)
from orientation_figures.moving.pictures.quaternion import TOPS

NODE = Path(sys.executable).with_name("node")
FIGURES = [
    figure
    for figure in (getattr(moving, name) for name in moving.__all__)
    if issubclass(figure, moving.MovingFigure) and figure.kind
]


def test_the_module_alone_loads_no_widgets():
    check = (
        "import sys, orientation; assert not {'anywidget', 'ipywidgets', 'matplotlib'} & "
        "set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", check], check=True)


WITHOUT_NUMPY = r"""
import sys
for name in ("matplotlib", "scipy"):
    sys.modules[name] = None
sys.path.append(sys.argv[2])
import plain_numpy
plain_numpy.stand_in()
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "numpy":
            raise ModuleNotFoundError(name, name="numpy")
sys.meta_path.insert(0, Absent())
import traitlets
from orientation_figures import moving

def refused(error, ask):
    try:
        ask()
    except error as refusal:
        return refusal
    raise AssertionError(f"no {error.__name__}")

CHANGES = eval(sys.argv[1])
names = set(moving.__all__) - {"MovingFigure", "SequenceExplorer"}
figures = [getattr(moving, name) for name in sorted(names)]
for kind in figures:
    figure, heard = kind(), []
    (name, value), before = CHANGES[figure.kind], figure.state()
    figure.observe(lambda change: heard.append(change.new), name)
    setattr(figure, name, value)
    assert heard == [value] and figure.state() == before | {name: value}
    figure.set_state({name: before[name]})  # what a message from the front end does
    assert heard == [value, before[name]]
    refused(traitlets.TraitError, lambda: setattr(figure, name, float("nan")))
    assert figure.state() == before
    data, _ = figure._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data and "text/html" not in data, data
    assert figure._esm.endswith("export default { render };\n") and ".moving" in figure._css
    # What is written stands for the figure: it makes the same one again.
    assert eval(repr(figure), vars(moving)).state() == before
    if figure.kind != "motion" and hasattr(figure, "dcm"):  # that one integrates, with NumPy itself
        assert figure.dcm.shape == (3, 3)
cycle = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]
assert abs(moving.TriadFigure(dcm=cycle).angle - 2.0943951023931953) < 1e-12
assert abs(moving.ChallengeFigure(goal=cycle).remaining - 2.0943951023931953) < 1e-12
assert abs(moving.GimbalFigure(dcm=cycle, sequence="zxz").dcm - cycle).max() < 1e-12
gimbal = moving.GimbalFigure(angles=(0.1, 0.2, 0.3))
assert round(gimbal.margin, 6) == 1.370796
explorer = moving.SequenceExplorer("zxz")
explorer.angles = ["psi", "pi/6", "phi"]
assert "0.524 rad away" in explorer.message and "<mfrac>" in explorer.result
assert explorer.dcm.shape == (3, 3) and "text/latex" in explorer._repr_mimebundle_()[0]
print(gimbal)
"""


def test_figures_are_alive_without_numpy():
    changes = {kind: change[:2] for kind, change in CHANGES.items()}
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_NUMPY, repr(changes), PYTHON],
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout == "GimbalFigure(angles=(0.1, 0.2, 0.3), sequence='zxy')\n"


def test_the_labels_are_kept_as_they_are_set():
    stored = glyphs.FILE.read_text("utf8")
    assert stored == glyphs.glyphs(), (
        f"{glyphs.FILE.name} is not what its generator makes: run `{glyphs.COMMAND}`"
    )


def test_what_the_page_takes_in_order_is_not_named():
    """JavaScript has no arguments by name: a colour would be an object there, and no colour."""
    with pytest.raises(ValueError, match="pass the arguments of line by position"):
        javascript.expression(ast.parse("sheet.line(points, colour='N')", mode="eval").body)


def texts_of(source):
    """The strings in a module of the front end, with a null where a value is filled in."""
    strings, stack = [], []
    for token in re.findall(r"\\.|\$\{|.", re.sub(" {2,}// .*", "", source), re.DOTALL):
        if stack and stack[-1][0] in "'`":
            if token == stack[-1][0]:
                strings.append(stack.pop()[1])
            elif token == "${" and stack[-1][0] == "`":
                stack[-1][1] += "\0"
                stack.append(["{", ""])
            else:
                stack[-1][1] += token[token[0] == "\\" :]
        elif token in ("'", "`", "{"):
            stack.append([token, ""])
        elif token == "}":
            stack.pop()
    assert stack == []
    return strings


@pytest.mark.parametrize("kind", [figure.kind for figure in FIGURES])
def test_every_formula_of_a_figure_can_be_set(kind):
    source = bundle.source(kind) + bundle.source(f"{kind}_picture")
    formulas = [formula for text in texts_of(source) for formula in text.split("$")[1::2]]
    patterns = {formula: "[^ ]+".join(map(re.escape, formula.split("\0"))) for formula in formulas}
    assert patterns, "no formulas were found"
    missing = [
        formula
        for formula in formulas
        if not any(re.fullmatch(patterns[formula], label) for label in glyphs.LABELS)
    ]
    assert missing == [], (
        f"add them to LABELS in orientation/moving/glyphs.py, then run `{glyphs.COMMAND}`"
    )


def test_every_top_of_the_plot_of_speeds_can_be_set():
    assert {rf"{top}^\circ/\mathrm{{s}}" for top in TOPS} <= set(glyphs.LABELS)


def bundle_of(figure):
    data, _ = figure._repr_mimebundle_()
    return data, BeautifulSoup(data["text/html"], "html.parser").select_one(
        "figure.orientation-figure.moving"
    )


@pytest.mark.parametrize("figure", FIGURES)
def test_what_a_cell_puts_out(figure):
    data, still = bundle_of(figure())
    assert WIDGET in data and data["text/plain"].startswith(figure.__name__)
    assert still["data-figure"] == figure.kind
    picture = still.select_one(".still > svg[role=img]")
    assert len(picture["aria-label"].split()) > 10
    assert "<script" not in data["text/html"]
    # Nothing of it differs from run to run.
    again, _ = bundle_of(figure())
    assert {key: again[key] for key in again if key != WIDGET} == {
        key: data[key] for key in data if key != WIDGET
    }


@pytest.mark.parametrize("figure", FIGURES)
def test_state_goes_to_the_page_and_back(figure):
    first = figure()
    _, still = bundle_of(first)
    state = json.loads(still["data-state"])
    # Constants of the front end.
    constants = {name: state.pop(name) for name in first.trait_names(constant=True)}
    assert constants == {name: getattr(first, name) for name in constants}
    assert state and set(state) == set(first.state())
    second = figure(**state)
    assert second.state() == first.state()
    assert first.state() == {name: getattr(first, name) for name in first.trait_names(state=True)}


@pytest.mark.parametrize("figure", FIGURES)
def test_front_end_is_one_module_that_needs_nothing(figure, tmp_path):
    text = figure()._esm
    assert "import " not in text.replace("important", "") and text.count("export ") == 1
    assert text.endswith("export default { render };\n")
    module_file, script_file = tmp_path / "figure.mjs", tmp_path / "figure.js"
    module_file.write_text(text, "utf8")
    script_file.write_text(bundle.shared_script() + bundle.script(figure.kind), "utf8")
    # It must also load where there is no page yet; the script of a page must be one.
    check = (
        f"new (require('vm').Script)(require('fs').readFileSync({str(script_file)!r}, 'utf8'));"
        f"import('{module_file.as_uri()}').then((figure) => "
        "{ if (typeof figure.default.render !== 'function') process.exit(1); })"
    )
    subprocess.run([NODE, "-e", check], check=True)
    assert (
        not any(word in text for word in ("http://", "https://"))
        or "http://www.w3.org/2000/svg" in text
    )
    assert text.count("http") == 1


@pytest.mark.parametrize("figure", FIGURES)
def test_a_misspelt_attribute_is_an_error(figure):
    name = next(iter(figure().state()))
    misspelt = name[:-2] + name[-1] + name[-2] + "e"
    message = (
        rf"{figure.__name__} has no {misspelt} \(did you mean {name}\?\); you can set "
        rf".*{name}"
    )
    with pytest.raises(TypeError, match=message):
        figure(**{misspelt: 1})
    instance = figure()
    before = instance.state()
    with pytest.raises(AttributeError, match=message):
        setattr(instance, misspelt, 1)
    with pytest.raises(AttributeError, match=f"{figure.__name__} has no xyzzy; you can set"):
        instance.xyzzy = 1
    assert instance.state() == before and not hasattr(instance, misspelt)


@pytest.mark.parametrize("seed", range(3))
def test_a_matrix_and_a_quaternion_of_ones_own(seed):
    """What is set is what is given back, and what is none is refused with nothing changed."""
    quaternion = Rotation.random(random_state=seed).as_quat(scalar_first=True)
    dcm = dcm_from_quaternion(quaternion)
    for figure in (
        moving.TriadFigure(dcm=dcm),
        moving.TriadFigure(quaternion=-quaternion),
        moving.TriadFigure(dcm=sm.Matrix(dcm)),
        *(moving.GimbalFigure(dcm=dcm, sequence=sequence) for sequence in ("zxy", "zyz")),
    ):
        assert np.abs(figure.dcm - dcm).max() < 1e-12
        before = figure.state()
        for wrong in (2 * dcm, -dcm, dcm[:2]):
            with pytest.raises(ValueError, match="dcm"):
                figure.dcm = wrong
        assert figure.state() == before
    challenge = moving.ChallengeFigure(goal=dcm)
    assert np.abs(challenge.goal - dcm).max() < 1e-12
    assert challenge.remaining == pytest.approx(moving.TriadFigure(dcm=dcm).angle)
    with pytest.raises(ValueError, match="not orthogonal"):
        challenge.goal = 1.1 * dcm
    with pytest.raises(ValueError, match="the goal of the task 'undo' follows from `given`"):
        moving.ChallengeFigure(task="undo", goal=dcm)


ONE_TURN = partial(SuccessiveFigure, turns=[("z", 0.1)])
ONE_FRAME = partial(GraphFigure, edges=[("A", "N", "z", 0.7)], target="N", source="N")


@pytest.mark.parametrize(
    "figure, name, value, message",
    [
        (TriadFigure, "angle", 35, "radians, not degrees"),
        (TriadFigure, "angle", math.nan, "angle is nan"),
        (TriadFigure, "angle", (1, 2), "one number was expected"),
        (TriadFigure, "angle", "0.3", "real numbers"),
        (TriadFigure, "axis", (0, 0, 0), "has no direction"),
        (TriadFigure, "axis", (1, 0), r"\(3,\)"),
        (TriadFigure, "axis", [[1, 0, 0]], "expected"),
        (TriadFigure, "axis", (1, math.inf, 0), "inf"),
        (TriadFigure, "sequence", "zzx", "zzx.*the twelve sequences are"),
        (TriadFigure, "sequence", "ZXY", "the twelve sequences are"),
        (GimbalFigure, "angles", (0, 90, 0), "radians, not degrees"),
        (GimbalFigure, "angles", (0, 1), r"\(3,\)"),
        (GimbalFigure, "sequence", 313, "the twelve sequences are"),
        (NineNumbersFigure, "matrix", np.eye(2), r"\(3, 3\)"),
        (NineNumbersFigure, "matrix", [[1, 0, 0], [0, 1, 0], [0, 0, None]], "real numbers"),
        (NineNumbersFigure, "matrix", 100 * np.eye(3), "from -10 to 10"),
        (NineNumbersFigure, "matrix", [[1, 0, 0], [0, 1], [0, 0, 1]], "regular shape"),
        (
            NineNumbersFigure,
            "matrix",
            [[1, 0, 0], [0, 1, math.nan], [0, 0, 1]],
            r"matrix\[1, 2\] is nan",
        ),
        (NineNumbersFigure, "matrix", np.eye(3, dtype=bool), "real numbers"),
        (NineNumbersFigure, "matrix", sm.diag(1, 1, sm.Symbol("x")), "holds x, .* needs numbers"),
        (GimbalFigure, "angles", np.array((0, 1j, 0)), "real numbers"),
        (GimbalFigure, "angles", (0, True, 0), "real numbers"),
        (GimbalFigure, "angles", (0, 10**400, 0), "real numbers"),
        (GimbalFigure, "angles", np.ma.array((0, 1, 2), mask=(0, 1, 0)), r"angles\[1\] is nan"),
        (SuccessiveFigure, "turns", [("x", (1,))], r"angle has shape \(1,\), where one number"),
        (SuccessiveFigure, "turns", [("x", sm.I)], "holds I"),
        (SuccessiveFigure, "turns", (), "expected 1 to 4 pairs"),
        (SuccessiveFigure, "turns", [("z", 0.1)] * 5, "expected 1 to 4 pairs"),
        (SuccessiveFigure, "turns", [("w", 0.1)], "the axis 'w'"),
        (SuccessiveFigure, "turns", [("z", 90)], "radians, not degrees"),
        (SuccessiveFigure, "turns", [("z", math.nan)], "turns: "),
        (ONE_TURN, "compare", "1 and 2 exchanged", "the chain has only 1 turn"),
        (SuccessiveFigure, "share", 1.5, "share is 1.5"),
        (SuccessiveFigure, "share", -0.5, "share is -0.5"),
        (QuaternionFigure, "angle", 360, "radians, not degrees"),
        (QuaternionFigure, "angle", -0.5, "from 0 to 4 pi"),
        (QuaternionFigure, "axis", (0, 0, 0), "a zero vector has no direction"),
        (QuaternionFigure, "first", (0, 100, 0), "radians, not degrees"),
        (QuaternionFigure, "unit_vector", "w", "unit_vector"),
        (QuaternionFigure, "share", 2.0, "share is 2.0"),
        (ChallengeFigure, "given", (), "given is .*: expected 1 to 3 pairs"),
        (ChallengeFigure, "turns", [("x", 0.1)] * 21, "turns is .*: expected at most 20 pairs"),
        (BeltFigure, "angle", -0.1, "numbers from 0 to 12.5664"),
        (BeltFigure, "angle", 4 * math.pi + 0.1, "numbers from 0 to 12.5664"),
        # A tree has each frame once, and its reference before.
        (ONE_FRAME, "edges", [("B", "A", "x", 1)], "edges orients B in A, but there is no frame A"),
        (ONE_FRAME, "edges", [("A", "N", "x", 1), ("A", "N", "y", 1)], "edges defines the frame"),
        (ONE_FRAME, "edges", [("Q", "N", "x", 1)], "edges defines the frame"),
        (ONE_FRAME, "target", "C", "target is C, but the frames are N, A"),
        (MotionFigure, "time", "3", "real numbers"),
        (MotionFigure, "time", math.nan, "time is nan"),
        (MotionFigure, "time", 21, "from 0 to 20 seconds"),
        (MotionFigure, "time", -1, "from 0 to 20"),
        (MotionFigure, "time", "now", "'now'"),
        (MotionFigure, "step", 5, "0.005 to 0.1 seconds"),
        (MotionFigure, "step", math.nan, "nan"),
        (MotionFigure, "disturbance", 1, "rad/s"),
        (MotionFigure, "method", "euler", "Euler"),
        (MotionFigure, "axis", 0, "axis"),
        (MotionFigure, "moments", (1, 2), "shape"),
        (
            MotionFigure,
            "moments",
            (1, 2, 4),
            "no body has such moments.*the largest, 4, is more than the sum of the others, 3",
        ),
        (MotionFigure, "moments", (-1, 2, 2), "from 0.1 to 20"),
        (MotionFigure, "moments", (16, 17, 21), "from 0.1 to 20"),
        (MotionFigure, "description", "dcm", "matrix"),
        (MotionFigure, "restored", "perhaps", "restored"),
    ],
)
def test_bad_values_are_refused_and_change_nothing(figure, name, value, message):
    instance = figure()
    before = instance.state()
    with pytest.raises(TraitError, match=message):
        setattr(instance, name, value)
    assert instance.state() == before
    with pytest.raises(TraitError, match=message):
        figure(**{name: value})


@pytest.mark.parametrize(
    "value",
    [
        range(3),
        np.array((0, 1, 2), "f4"),
        [np.int8(0), np.float64(1), np.array(2)],
        sm.Matrix((0, 1, 2)),
        sm.Tuple(0, 1, 2),
        [0, sm.sqrt(4) / 2, Fraction(4, 2)],
        np.array((sm.Integer(0), Fraction(1), 2), object),
    ],
)
def test_numbers_come_in_many_kinds(value):
    figure = GimbalFigure(angles=value)
    assert figure.angles == (0, 1, 2) and set(map(type, figure.angles)) == {float}


def test_the_end_of_a_slider_is_within_bounds():
    TriadFigure(angle=180 * math.pi / 180)
    GimbalFigure(angles=(-math.pi, math.nextafter(math.pi, 4), 0))


def test_the_axis_is_kept_at_unit_length_and_does_not_wander():
    figure = TriadFigure(axis=(3, 0, -4))
    assert figure.axis == (0.6, 0.0, -0.8)
    figure.axis = (1, 2, 3)
    first = figure.axis
    for _ in range(5):
        figure.axis = figure.axis
    assert figure.axis == first and math.hypot(*first) == pytest.approx(1, abs=1e-15)


@pytest.mark.parametrize("sequence", module.SEQUENCES)
def test_computed_attributes(sequence):
    triad = TriadFigure(axis=(1, -2, 0.5), angle=2.5, sequence=sequence)
    assert module.same_orientation(triad.dcm, module.dcm_from_axis_angle((1, -2, 0.5), 2.5))
    assert module.same_orientation(module.dcm_from_quaternion(triad.quaternion), triad.dcm)
    assert module.same_orientation(module.dcm_from_body_fixed(triad.angles, sequence), triad.dcm)
    gimbal = GimbalFigure(angles=(0.3, -0.8, 2), sequence=sequence)
    assert module.same_orientation(gimbal.dcm, module.dcm_from_body_fixed((0.3, -0.8, 2), sequence))
    assert gimbal.margin == module.gimbal_lock_margin((0.3, -0.8, 2), sequence)
    assert len(gimbal.drawing().marks) > 20
    with pytest.raises(AttributeError):
        triad.angles = (0, 0, 0)  # in which sequence is another attribute's


def test_stills_of_extreme_states_can_be_drawn():
    for axis, angle in (((0, 0, 1), 0), ((1, 0, 0), math.pi), ((0.77, 0.48, 0.41), -3)):
        assert "<svg" in TriadFigure(axis=axis, angle=angle).still()
    for matrix in (np.zeros((3, 3)), np.diag((1, 1, -1)), np.eye(3), np.ones((3, 3))):
        assert "<svg" in NineNumbersFigure(matrix=matrix).still()
    for sequence in ("zxy", "zxz"):
        for middle in (0, math.pi / 2, math.pi):
            assert "<svg" in GimbalFigure(angles=(0, middle, 0), sequence=sequence).still()


def test_a_stored_notebook_holds_the_still_and_no_widget():
    data, metadata = TriadFigure()._repr_mimebundle_()
    output = nbformat.v4.new_output(
        "execute_result", data=data, metadata=metadata, execution_count=1
    )
    notebook = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_code_cell("TriadFigure()", outputs=[output])]
    )
    notebook.metadata["widgets"] = {
        "application/vnd.jupyter.widget-state+json": {"state": {"a": {}}}
    }
    stored = nbformat.writes(normalise(notebook))
    assert "vnd.jupyter.widget" not in stored
    assert 'data-figure=\\"triad\\"' in stored
