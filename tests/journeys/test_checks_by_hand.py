"""A check judges the present content of the notebook, in a kernel."""

from contextlib import suppress

import nbformat
import pytest
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from places import REPOSITORY

RIGHT = """B_C_N = sm.Matrix([[sm.cos(beta), 0, sm.sin(beta)],
                   [0, 1, 0],
                   [-sm.sin(beta), 0, sm.cos(beta)]])"""
CHECK = "check('simple-orientations/boom', B_C_N)"


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("exercises")
    notebook = nbformat.read(REPOSITORY / "exercises" / "simple-orientations.ipynb", 4)
    client = NotebookClient(notebook, resources={"metadata": {"path": str(folder)}})
    with client.setup_kernel():

        def run(code):
            """Run a cell as a student does; return its output, and the name of its error."""
            cell = nbformat.v4.new_code_cell(code)
            client.nb.cells.append(cell)
            with suppress(CellExecutionError):
                client.execute_cell(cell, len(client.nb.cells) - 1)
            return "".join(
                part.get("data", {}).get("text/html", "") + part.get("text", part.get("ename", ""))
                for part in cell.outputs
            )

        # The slip is in the cell that imports coursework, which cannot know how that cell began.
        assert "as in `student('jdoe')`" in run(
            "import sympy as sm\nbeta = sm.Symbol('beta')\n"
            "from coursework import check, student\nstudent(jdoe)"
        )
        yield run


@pytest.mark.parametrize(
    ("written", "error"),
    [
        (RIGHT.replace("beta", "betta"), "NameError"),
        (RIGHT + ")", "SyntaxError"),
        (f"if True:\n    {RIGHT}".replace("beta", "betta"), "NameError"),
    ],
)
def test_a_cell_that_failed_leaves_nothing_to_be_called_right(kernel, written, error):
    kernel(RIGHT)
    assert "Correct" in kernel(CHECK)
    assert kernel(written) == error
    for _ in range(2):
        reply = kernel(CHECK)
        assert "Correct" not in reply and "The cell that sets <code>B_C_N</code> stopped" in reply
    kernel(RIGHT)
    assert "Correct" in kernel(CHECK)


def test_a_cell_that_failed_says_nothing_of_other_answers(kernel):
    assert kernel("lost_C_N = betta") == "NameError"
    assert "The cell that sets `lost_C_N` stopped with an error. Correct and run it" in kernel(
        CHECK.replace("B_C_N", "lost_C_N")
    )
    kernel(RIGHT)
    assert kernel("A_C_N = sm.Matrix([betta])") == "NameError"
    assert "Correct" in kernel(CHECK)
    assert kernel("B_C_N = betta") == "NameError"
    assert "Correct" in kernel(f"{RIGHT}\n{CHECK}")
    assert kernel(f"{RIGHT}\n1/0") == "ZeroDivisionError"
    assert "stopped before its end" in kernel(CHECK)


@pytest.mark.parametrize(
    ("written", "advice"),
    [
        (CHECK.replace("B_C_N", "boom_C_N"), "No cell that you have run sets `boom_C_N`."),
        ("from sympy import *\nB_C_N = rot_axis2(-beta)", "run `from sympy import *`?"),
        ("import numpy\nB_C_N = numpy.cos(beta)", "For an expression with symbols, use"),
        ("import math\nB_C_N = math.cos(beta)", "For an expression with symbols, use"),
        (f"beta = sm.pi/3\n{RIGHT}\n{CHECK}", "<code>beta</code> is not a symbol now: a cell"),
        ("student(jdoe@uni.example)", "as in `student('jdoe')`"),
        ("import math\nstudent(0123456)", "as in `student('jdoe')`"),
        ("student(Jane Doe)", "as in `student('jdoe')`"),
        ("student(1a2b3c)", "as in `student('jdoe')`"),
        ("if True:\n    student = 'jdoe'", "as in `student('jdoe')`"),
        ("student(\u2018jdoe\u2019)", "straight quotation marks"),
        ("student = 'A'\nstudent('jdoe')", "A cell has set the name of this function to a value."),
        (f"check = {CHECK}\ncheck('a/b', 1)", "A cell has set the name of this function to a"),
        (f"assert {CHECK.replace('B_C_N', '2*B_C_N')}", "write `check(...)` without `assert`"),
        (
            "check('chapters/look-aside', [0, sm.rad(20), 0])",
            "More than one mistake leads to this answer. For example: These are the angles for",
        ),
        ("turned_by = \u22122.4", "Type it on the keyboard instead: `-`"),
        ("turned_by = 2\xa0+ 3", "Type it on the keyboard instead: `-`, `*`, a space"),
    ],
)
def test_a_slip_with_a_name_is_followed_by_its_remedy(kernel, written, advice):
    assert advice in kernel(written)
    # A reader's own variable is no slip.
    assert not kernel(
        "student = 5\nbeta = sm.Symbol('beta')\nfrom coursework import check, student"
    )


@pytest.mark.parametrize(
    ("answer", "shown"),
    [
        ("None", "Your answer is <code>None</code>. A function that returns nothing"),
        ("{beta, 1}", "This is a set, which has no order: write a list, in square brackets."),
        ("[[float('nan')] * 3] * 3", "The answer has no finite value: it is NaN"),
        ("{'answer': beta}", "This is a dictionary. Give the value in it"),
        ("lambda beta: beta", "This is a function. Call it, and give what it returns."),
        ("sm.eye(3).row(0)", r'We read: <span class="math">$\begin{bmatrix} 1 &amp; 0 &amp; 0'),
        ("[[1, 0, 0], [0, 1, 0], [0, 0, sm.cos(beta)/2]]", r"\frac{1}{2} \, \cos(\beta)"),
        ("'A'", "We read: <code>&#x27;A&#x27;</code>"),
        ("B", r"{}^{B}\mathbf{C}^{N} = \begin{bmatrix} 1"),
    ],
)
def test_a_reply_shows_the_answer_as_it_was_read(kernel, answer, shown):
    kernel("import sympy.physics.mechanics as me\nB, N = map(me.ReferenceFrame, 'BN')")
    kernel("B.orient_axis(N, N.x, beta)")
    assert shown in kernel(f"check('simple-orientations/boom', {answer})")


DIRECTIONS = """psi, slope = sm.symbols('psi, {}')
line = sm.Matrix([sm.cos(slope)*sm.cos(psi), sm.cos(slope)*sm.sin(psi), {}sm.sin(slope)])
level = sm.Matrix([0, 0, 1]).cross(line).normalized()
third = {}
check('{}', {})"""


@pytest.mark.parametrize(
    "words",
    [
        ("gamma", "-", "level.cross(line)", "reference-frames/climb", "third"),
        (
            *("theta", "", "line.cross(level)", "direction-cosine-matrices/east-north-up"),
            "[level, third, line]",
        ),
    ],
)
def test_a_direction_may_be_a_cross_product_divided_by_its_length(kernel, words):
    """Its formula then contains a root, which is right where the text of the question holds."""
    assert "Correct" in kernel(DIRECTIONS.format(*words))


def test_an_orientation_is_shown_as_a_triad(kernel):
    reply = kernel(
        "matrix = sm.Matrix([[0, 1, 0], [0, 0, 1], [1, 0, 0]])\n"
        "check('simple-orientations/crank', matrix)"
    )
    # Its x axis lies along the y axis of N: to the right.
    assert 'aria-label="The triad of A, as we read your answer, drawn in the triad of N."' in reply
    assert "We read: [[0, 1, 0], [0, 0, 1], [1, 0, 0]]" in kernel(
        "print(repr(check('simple-orientations/crank', matrix)))"
    )
    # An answer that is no orientation has no picture.
    assert "<svg" not in kernel("check('simple-orientations/crank', 2*matrix)")
