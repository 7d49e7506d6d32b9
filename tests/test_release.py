"""From the notebooks with solutions to what students receive: nothing more, and always the same."""

import base64
import json
import re
import zipfile
from pathlib import Path

import nbformat
import pytest

from coursework.authoring import release
from coursework.authoring.author import AuthorError
from coursework.authoring.selftest import leaks, released_texts, secrets_of

SETUP = 'import sympy as sm\nfrom coursework import check\ntheta = sm.symbols("theta")'
SOLUTION = (
    "### BEGIN SOLUTION\nworking = sm.sin(theta)\nA_C_N = sm.Matrix([[1, 0, 0], [0, sm.cos(theta), working], "
    "[0, -working, sm.cos(theta)]])\n### END SOLUTION"
)
HIDDEN = (
    "### BEGIN HIDDEN TESTS\nquestion('trial/about-x', kind='direction cosine matrix', frames=('A', 'N'), "
    "symbols='theta', turns=[('x', theta)], worth=2, solution='The shared axis is the first one, which does not move.')\n"
    "### END HIDDEN TESTS"
)
FUNCTION = (
    '### BEGIN SOLUTION\ndef conjugate(quaternion):\n    """Return the conjugate."""\n    "a quoted remark"\n'
    "    return [quaternion[0], *(-part for part in quaternion[1:])]\n### END SOLUTION"
)
HIDDEN_FUNCTION = (
    "### BEGIN HIDDEN TESTS\nquestion('trial/conjugate', kind='function', result='quaternion', "
    "calls=[[[0.5, 0.5, 0.5, 0.5]], [[0.6, 0, 0.8, 0]]])\n### END HIDDEN TESTS"
)
FIGURE = (
    "import numpy as np\nfrom orientation_figures.drawing import Drawing\n"
    'd = Drawing("A triad whose three arrows are named, long enough to stand for the picture")\n'
    'd.triad("N", np.eye(3))\nd'
)


def write_source(folder, *cells, name="trial"):
    notebook = nbformat.v4.new_notebook()
    for number, (kind, text, *tags) in enumerate(cells):
        cell = nbformat.v4.new_code_cell(text) if kind == "code" else nbformat.v4.new_markdown_cell(text)
        cell["id"] = f"cell-{number}"
        cell.metadata["tags"] = list(tags)
        notebook.cells.append(cell)
    folder.mkdir(exist_ok=True)
    nbformat.write(notebook, folder / f"{name}.ipynb")
    return folder / f"{name}.ipynb"


CELLS = [
    ("markdown", "# Exercises"),
    ("code", SETUP),
    ("code", FIGURE, "figure"),
    ("code", SOLUTION),
    ("code", f"check('trial/about-x', A_C_N)\n{HIDDEN}"),
    ("code", FUNCTION),
    ("code", f"check('trial/conjugate', conjugate)\n{HIDDEN_FUNCTION}"),
]


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trial")
    write_source(folder / "sources", *CELLS)
    release.release(folder / "sources", folder / "exercises", folder / "sealed", run=False)
    return folder


def test_the_exercise_has_blanks_where_the_solution_was(trial):
    text = [cell.source for cell in nbformat.read(trial / "exercises" / "trial.ipynb", as_version=4).cells]
    assert text[3] == "A_C_N = ...  # your answer"
    assert text[4] == "check('trial/about-x', A_C_N)"
    assert text[5] == 'def conjugate(quaternion):\n    """Return the conjugate."""\n    ...  # your code'


def test_a_figure_becomes_a_picture_with_its_text(trial):
    picture = nbformat.read(trial / "exercises" / "trial.ipynb", as_version=4).cells[2].source
    text, data = re.fullmatch(
        r'<p><img alt="(.*)" width="\d+" src="data:image/svg\+xml;base64,(.*)"></p>', picture
    ).groups()
    assert "long enough to stand for the picture" in text
    assert base64.b64decode(data).startswith(b"<svg xmlns=")


def test_a_release_is_the_same_each_time(trial, tmp_path):
    release.release(trial / "sources", tmp_path / "exercises", tmp_path / "sealed", run=False)
    assert release.differences(trial / "exercises", tmp_path / "exercises", "*") == []
    assert release.differences(trial / "sealed", tmp_path / "sealed", "*") == []


def test_a_planted_secret_is_found(trial, tmp_path):
    source = release.read_source(trial / "sources" / "trial.ipynb")
    assert len(secrets_of(source)) > 5
    assert leaks([source], released_texts(trial / "exercises", trial / "sealed", tmp_path / "none.zip")) == []
    for planted in (
        "The shared axis is the first one,\nwhich does  not move.",
        "[0, -sin(theta), cos(theta)]]",
        "turns=[('x', theta)], worth=2",
    ):
        folder = tmp_path / str(len(planted))
        write_source(
            folder,
            ("markdown", f"x {planted} y")
            if "sin" not in planted
            else ("markdown", str(source.questions["trial/about-x"].answer)),
        )
        found = leaks([source], released_texts(folder, trial / "sealed", tmp_path / "none.zip"))
        assert found or "turns" in planted
    with zipfile.ZipFile(tmp_path / "box.zip", "w") as box:
        box.writestr("inner.txt", source.questions["trial/about-x"].solution)
    assert leaks([source], released_texts(trial / "exercises", trial / "sealed", tmp_path / "box.zip"))


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        ([("code", SETUP), ("code", SOLUTION), ("code", "check('trial/about-x', A_C_N)")], "without a question"),
        ([("code", SETUP), ("code", f"A_C_N = 1\n{HIDDEN}")], "before its check"),
        (
            [
                ("code", SETUP),
                ("code", SOLUTION),
                ("code", f"check('other/about-x', A_C_N)\n{HIDDEN.replace('trial', 'other')}"),
            ],
            "named 'trial/...'",
        ),
        ([("code", SETUP), ("code", SOLUTION), ("code", f"check('trial/about-x', A_C_N * 1)\n{HIDDEN}")], "plain name"),
        (
            [("code", SETUP), ("code", SOLUTION), ("code", f"check('trial/about-x', A_C_N)\n{HIDDEN}\n{HIDDEN}")],
            "two questions",
        ),
        ([("code", SETUP), ("code", "undefined_name")], "cell 1: NameError"),
    ],
)
def test_an_author_is_told_what_is_wrong(tmp_path, cells, words):
    with pytest.raises(AuthorError, match=re.escape(words)):
        release.read_source(write_source(tmp_path, *cells))


def test_what_is_committed_is_what_the_sources_make(tmp_path):
    release.release(release.SOURCES, tmp_path / "exercises", tmp_path / "sealed")
    message = "Run `make release` and commit exercises/ and src/coursework/checking/sealed/: they are not what the sources make."
    assert release.differences(release.SEALED, tmp_path / "sealed", "*.json") == [], message
    assert release.differences(release.EXERCISES, tmp_path / "exercises", "*.ipynb") == [], message


def test_there_is_a_notebook_of_exercises_for_every_chapter():
    chapters = {path.stem for path in (release.REPOSITORY / "chapters").glob("*.ipynb")}
    assert {path.stem for path in release.EXERCISES.glob("*.ipynb")} == chapters
    questions = [
        name for path in release.SEALED.glob("*.json") for name in json.loads(path.read_text("utf8"))["questions"]
    ]
    assert sum(not name.startswith("chapters/") for name in questions) >= 60


def test_the_archive_is_the_same_each_time_and_installs_what_it_says(tmp_path):
    first, second = (release.archive(tmp_path / name / "exercises.zip") for name in "ab")
    assert first.read_bytes() == second.read_bytes()
    with zipfile.ZipFile(first) as box:
        names = {Path(name).name for name in box.namelist()}
        wheel = next(name for name in names if name.endswith(".whl"))
        assert wheel in box.read("exercises/README.txt").decode()
    assert {path.name for path in release.EXERCISES.glob("*.ipynb")} < names


def test_an_update_never_writes_over_what_a_student_wrote(tmp_path):
    def pack(name, **files):
        with zipfile.ZipFile(tmp_path / name, "w") as box:
            for file, text in files.items():
                box.writestr(f"exercises/{file}.ipynb", text)
        return tmp_path / name

    work = tmp_path / "work"
    work.mkdir()
    release.update(pack("one.zip", a="a", b="b"), work)
    (work / "a.ipynb").write_text("my answer")
    for _ in range(2):
        release.update(pack("two.zip", a="a, mended", b="b", c="c"), work)
    assert {path.name: path.read_text() for path in work.iterdir()} == {
        "a.ipynb": "my answer",
        "a-new-1.ipynb": "a, mended",
        "b.ipynb": "b",
        "c.ipynb": "c",
    }
