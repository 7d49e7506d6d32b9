"""What every chapter contains, and the claims of the first eight.

The chapters' own code is run and compared with other results.
"""

import re
from functools import cache

import nbformat
import numpy as np
import pytest
import sympy as sm
from places import REPOSITORY

from orientation import multiply_quaternions

FIRST = (
    "reference-frames", "simple-orientations", "direction-cosine-matrices",
    "successive-orientations", "orientation-with-sympy", "euler-angles", "other-descriptions",
    "unit-quaternions",
)  # fmt: skip

ALL = sorted(path.stem for path in (REPOSITORY / "chapters").glob("*.ipynb"))


@cache
def cells(name):
    return nbformat.read(REPOSITORY / "chapters" / f"{name}.ipynb", as_version=4).cells


@cache
def names_of(name):
    """Return the names that a chapter's code defines, without its figures and exercises."""
    names = {"__name__": name}
    for cell in cells(name):
        if (
            cell.cell_type == "code"
            and "hide-input" not in cell.metadata.get("tags", [])
            and "check(" not in cell.source
        ):
            exec(cell.source, names)
    return names


# --- what every chapter has -----------------------------------------------------------------------


def text_of(name):
    return "\n\n".join(cell.source for cell in cells(name) if cell.cell_type == "markdown")


BOXES = re.compile(r"^`{3,}\{(predict|exercise|recap)\}.*?^`{3,}$", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("name", ALL)
def test_a_chapter_is_read_first_and_practised_at_its_end(name):
    """The number of questions between the text is up to the author; the others are at the end."""
    text = text_of(name)
    reading, _, practice = text.partition("## Exercises\n")
    assert practice and "\n## " not in practice
    assert [box[1] for box in BOXES.finditer(reading) if box[1] != "predict"] == []
    kinds = [box[1] for box in BOXES.finditer(practice)]
    assert "predict" not in kinds and "exercise" in kinds and "recap" not in kinds[1:]
    assert reading.rstrip().endswith(":::") or ":class: summary" in reading
    assert "admonition} Predict" not in text, "a prediction can be answered on the page"
    for question in re.findall(
        r"^```\{(?:question|predict)\}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL
    ):
        assert len(re.findall(r"\n\n(?=[^\n]+\n: )", question)) >= 2, question
    for exercise in re.findall(
        r"^`{3,}\{exercise\}.*?\n(.*?)^`{3,}$", text, re.MULTILINE | re.DOTALL
    ):
        assert re.search(r"^:difficulty: [123]$", exercise, re.MULTILINE), exercise
        assert re.search(r"^:minutes: \d+$", exercise, re.MULTILINE), exercise


@pytest.mark.parametrize("name", ALL)
def test_some_exercise_asks_for_a_proof_or_an_explanation(name):
    text = text_of(name)
    exercises = re.findall(r"^`{3,}\{exercise\}.*?\n(.*?)^`{3,}$", text, re.MULTILINE | re.DOTALL)
    assert any(
        re.search(r"\b([Pp]rove|[Ss]how|[Ee]xplain|[Ww]hy)\b", exercise) for exercise in exercises
    )


@pytest.mark.parametrize("name", ALL)
def test_no_sentence_is_cut_in_two_by_a_cell(name):
    """Text before a cell ends like a sentence, or with a colon, and text after it begins so."""
    for before, cell in zip(cells(name), cells(name)[1:]):
        # Without the marks of a lecture.
        text = re.sub(r"<!--.*?-->", "", before.source, flags=re.DOTALL).rstrip()
        if before.cell_type == "markdown" and text:
            last = text.splitlines()[-1]
            assert re.search(r"([.:?!)*]|\$\$.*|:::|```+|</\w+>|^#.*|\|)$", last), last
        if cell.cell_type == "markdown":
            assert not re.match(r"[a-z,;]", cell.source), cell.source[:60]


@pytest.mark.parametrize("name", ALL)
def test_a_chapter_says_what_for_shows_something_real_and_sums_up(name):
    """A chapter has a moving figure or a recording of an instrument."""
    text = text_of(name)
    for part in ("objectives", "summary"):
        [points] = re.findall(
            rf"^:::\{{admonition\}} .*\n:class: {part}\n(.*?)^:::$", text, re.MULTILINE | re.DOTALL
        )
        assert re.search(r"^- ", points, re.MULTILINE)
    code = "\n".join(cell.source for cell in cells(name) if cell.cell_type == "code")
    assert re.search(
        r"^(from orientation_figures\.(moving|animation) import |import orientation_recordings)",
        code,
        re.MULTILINE,
    )


@pytest.mark.parametrize("name", ALL)
def test_a_chapter_has_sealed_questions(name):
    notebook = nbformat.read(REPOSITORY / "exercises" / f"{name}.ipynb", as_version=4)
    code = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "code")
    assert re.search(rf"^check\([\"']({name}/[\w-]+)[\"']", code, re.MULTILINE)


@pytest.mark.parametrize("name", ALL)
def test_directives_begin_their_line(name):
    """Within a line, directives would be printed as they are, without a warning."""
    assert re.findall(r"^[^`:\n].*(?:`{3,}|:{3,})\{[\w-]+\}.*$", text_of(name), re.MULTILINE) == []


# --- chapter 1: hands -----------------------------------------------------------------------------


def test_a_left_handed_triad_passes_along_itself_and_fails_along_a_right_handed_one():
    names = names_of("reference-frames")
    mirrored, turned = (
        sm.Matrix.hstack(*(names[f"{letter}_{axis}"] for axis in "xyz")) for letter in "ma"
    )
    assert mirrored.det() == -1 and turned.det() == 1
    for triad in (mirrored, turned):
        assert triad * triad.T == sm.eye(3)
        # With respect to itself every triad is the identity, whatever its handedness.
        assert triad.T * triad == sm.eye(3)
    # The chapter names the cross products as the rule.
    assert mirrored.col(0).cross(mirrored.col(1)) == -mirrored.col(2)
    assert turned.col(0).cross(turned.col(1)) == turned.col(2)


# --- chapter 8: the half angle, the matrix, and drift ---------------------------------------------


def test_the_matrix_of_a_quaternion_is_that_of_rodrigues_for_every_unit_axis():
    names = names_of("unit-quaternions")
    difference, e, c, s = (
        names["by_quaternion"] - names["by_rodrigues"],
        names["e"],
        names["c"],
        names["s"],
    )
    # With the two conditions that the text names, every entry is zero: they divide it.
    conditions = sm.groebner([e.dot(e) - 1, c**2 + s**2 - 1], *e, c, s)
    assert all(conditions.contains(sm.expand(entry)) for entry in difference)
    assert not conditions.contains(
        sm.expand((names["by_quaternion"] - names["by_rodrigues"].T)[0, 1])
    )


def test_drift_of_quaternions_and_of_matrices_is_alike_when_like_is_set_against_like():
    """The square |q|^2 is comparable to the stretch of a matrix.

    One angle for all steps would share one rounding error.
    """
    names = names_of("unit-quaternions")
    squared, matrices = names["drifts"]((111, 112, 113, 114, 115, 116, 117, 118))
    quaternion, matrix = abs(squared - 1), names["worst_stretch"](matrices)
    assert max(*quaternion, *matrix) < 5e-5
    assert 1 / 5 < np.exp(np.mean(np.log(quaternion / matrix))) < 5
    constant = np.float32([np.cos(0.01), np.sin(0.01)])
    assert abs(np.hypot(*constant.astype(float)) ** 20_000 - 1) > 1e-4
    # The matrix of a quaternion stretches by its length squared, and one step of Newton's method
    # corrects a matrix.
    q = np.array([0.7, -0.2, 0.5, 0.6])
    image = multiply_quaternions(multiply_quaternions(q, [0, 1, 2, 3]), q * [1, -1, -1, -1])
    assert np.linalg.norm(image) == pytest.approx(q @ q * np.sqrt(14))
    assert abs(np.linalg.svd(names["restored"], compute_uv=False) - 1).max() < 1e-9 < matrix.min()


def test_two_full_turns_shrink_to_a_point_with_both_ends_held_and_one_does_not():
    names = names_of("unit-quaternions")
    parts = sm.lambdify(
        (names["beta"], names["half_turned"]), [names["scalar"], names["along_e"], names["along_u"]]
    )
    turned = np.linspace(0, 2 * np.pi, 200)
    loops = np.array(
        [np.broadcast_arrays(*parts(beta, turned)) for beta in np.linspace(0, np.pi / 2, 50)]
    )
    assert np.allclose(np.linalg.norm(loops, axis=1), 1)
    assert np.allclose(loops[:, :, [0, -1]], np.array([1, 0, 0])[:, None])
    # Two full turns about e.
    assert np.allclose(loops[0], [np.cos(turned), np.sin(turned), 0 * turned])
    assert np.allclose(loops[-1], np.array([1, 0, 0])[:, None])  # flat
    assert abs(np.diff(loops, axis=0)).max() < 0.1  # nothing jumps
