"""Every chapter has its parts, missing ones are reported, and new ones are complete."""

import os
import re
import shutil
import subprocess
import sys

import nbformat
import pytest
from places import REPOSITORY

import orientation
import orientation_course
from coursework import check
from coursework.authoring.source import names_asked, read_source
from coursework.checking.kinds import KINDS
from notebook_pages.notebooks import all_notebooks
from tools import chapters, new


@pytest.fixture
def book(tmp_path, monkeypatch):
    """Copy the texts of the book into a folder of their own."""
    for name in ("chapters", "appendix", "exercises", "tests/solutions"):
        shutil.copytree(REPOSITORY / name, tmp_path / name, ignore=shutil.ignore_patterns(".*"))
    for path in (REPOSITORY / "_toc.yml", *REPOSITORY.glob("*.ipynb")):
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_every_chapter_has_its_parts(monkeypatch):
    monkeypatch.chdir(REPOSITORY)
    faults = list(chapters.faults())
    assert not faults, "\n" + "\n".join(faults)


def test_code_that_readers_see_is_not_wider_than_the_page():
    # In a window of 1300 pixels or more a cell has room for 83 characters, and for 78 within a
    # solution. Longer lines wrap without indentation.
    too_long = [
        f"{path.relative_to(REPOSITORY)}:{number} (cell {position}): {len(line)} characters, "
        f"more than the page has room for: {line.strip()}"
        for path in all_notebooks(REPOSITORY)
        for position, cell in enumerate(nbformat.read(path, as_version=4).cells, 1)
        if cell.cell_type == "code"
        and not {"hide-input", "remove-input", "remove-cell"} & {*cell.metadata.get("tags", [])}
        for number, line in enumerate(cell.source.splitlines(), 1)
        if len(line) > (78 if path.name.startswith("solutions") else 82)
    ]
    assert not too_long, "\n" + "\n".join(too_long)


FORGOTTEN = {
    "objectives": (
        "chapters/gimbal-lock.ipynb",
        ":class: objectives",
        "",
        r"chapters/gimbal-lock.ipynb:1 \(cell 1\): no objectives",
    ),
    "summary": (
        "chapters/gimbal-lock.ipynb",
        ":class: summary",
        "",
        r"chapters/gimbal-lock.ipynb:\d+ \(cell \d+\): no summary",
    ),
    "label": (
        "chapters/gimbal-lock.ipynb",
        "(chapter-gimbal-lock)=",
        "(gimbal)=",
        r"gimbal-lock.ipynb:1 \(cell 1\)",
    ),
    "solution": (
        "appendix/solutions-going-further.ipynb",
        "{solution-start} exercise-scalar-last",
        "{solution-start} exercise-scalar",
        r"chapters/unit-quaternions.ipynb:\d+ \(cell \d+\): exercise-scalar-last has no",
    ),
    "sealed question": (
        "tests/solutions/chapters.ipynb",
        "question('chapters/scalar-last'",
        "question('chapters/scalar'",
        r"chapters/unit-quaternions.ipynb:\d+ \(cell \d+\): chapters/scalar-last is not a question",
    ),
    "place among the chapters": (
        "_toc.yml",
        "      - file: chapters/gimbal-lock\n",
        "",
        r"_toc.yml:\d+: the chapter chapters/gimbal-lock.ipynb is not in",
    ),
    "place among the exercises": (
        "_toc.yml",
        "      - file: exercises/gimbal-lock\n",
        "",
        r"_toc.yml:\d+: exercises/gimbal-lock is not in",
    ),
    "page": (
        "_toc.yml",
        "- file: chapters/gimbal-lock",
        "- file: chapters/gimbal-lok",
        r"_toc.yml:\d+: there is no page chapters/gimbal-lok$",
    ),
    "line of the index": (
        "exercises/index.md",
        "- {doc}`gimbal-lock`\n",
        "",
        r"exercises/index.md:\d+: .*gimbal-lock",
    ),
    "sentence": (
        "chapters/gimbal-lock.ipynb",
        "# Gimbal lock",
        "# TO BE WRITTEN",
        r"chapters/gimbal-lock.ipynb:2 \(cell 1\): # TO BE WRITTEN",
    ),
}


@pytest.mark.sampled(3)
@pytest.mark.parametrize("path, old, replacement, says", FORGOTTEN.values(), ids=FORGOTTEN)
def test_what_is_forgotten_is_told_by_its_place(book, path, old, replacement, says):
    text = (book / path).read_text("utf8")
    assert old in text
    (book / path).write_text(text.replace(old, replacement), "utf8")
    faults = list(chapters.faults())
    assert any(re.search(says, fault) for fault in faults), faults


def test_a_notebook_of_exercises_that_is_not_there(book):
    (book / "tests/solutions/gimbal-lock.ipynb").unlink()
    (book / "exercises/gimbal-lock.ipynb").unlink()
    faults = "\n".join(chapters.faults())
    assert "its exercises are missing, tests/solutions/gimbal-lock.ipynb" in faults
    assert re.search(
        r"_toc.yml:\d+: there is no page exercises/gimbal-lock; `make release` makes it", faults
    )


def make(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "tools.new", *arguments],
        env=os.environ | {"PYTHONPATH": str(REPOSITORY)},
        capture_output=True,
        text=True,
    )


def test_a_new_chapter_has_all_its_parts(book):
    done = make(
        "chapter", "chapter-of-the-tests", "Chapter of the tests", "--after", "quaternions-in-full"
    )
    assert done.returncode == 0, done.stderr
    # A release would put it there.
    shutil.copy("tests/solutions/chapter-of-the-tests.ipynb", "exercises")
    faults = list(chapters.faults())
    assert faults and all("TO BE WRITTEN" in fault for fault in faults), faults
    assert re.search(
        r"\n## quaternions-in-full\n(?:(?!## ).*\n)*## chapter-of-the-tests\n\n### 1. TO BE WRITTEN"
        r"(?:(?!## ).*\n)*### 3. TO BE WRITTEN",
        (book / "tests/solutions/spoken-questions.md").read_text("utf8"),
    )
    contents = (book / "_toc.yml").read_text("utf8")
    for folder in ("chapters", "exercises"):
        assert re.search(
            rf"file: {folder}/quaternions-in-full\n *- file: {folder}/chapter-of-the-tests\n",
            contents,
        )
    for cell in nbformat.read("chapters/chapter-of-the-tests.ipynb", as_version=4).cells:
        if "check(" not in cell.source and cell.cell_type == "code":
            exec(cell.source, {})
    # The answer of the first one, which is not written yet, has another name than this one's.
    new.new_chapter("next-of-the-tests", "Next of the tests", None)
    asked = names_asked(chapters.CHAPTERS_SOURCE)
    answers = [asked[f"chapters/{name}-of-the-tests"] for name in ("chapter", "next")]
    assert len({*answers}) == 2, answers


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (
            ("chapter", "Chapter of the tests", "Chapter of the tests"),
            "NAME made of lower-case letters and hyphens",
        ),
        (("chapter", "chapter-of-the-tests", ""), "a TITLE"),
        (("chapter", "gimbal-lock", "Gimbal lock"), "already exists; nothing was changed"),
        (
            ("chapter", "chapter-of-the-tests", "Chapter of the tests", "--after", "gimbals"),
            "no chapter 'gimbals'; it has",
        ),
        (("question", "gimbal-lock", ""), "is CHAPTER/QUESTION"),
        (
            ("question", "chapter-of-the-tests/twist", ""),
            "`make new-chapter NAME=chapter-of-the-tests",
        ),
        (
            ("question", "gimbal-lock/twist", "", "--kind", "riddle"),
            "no KIND of question 'riddle'; choose from expr",
        ),
    ],
)
def test_what_cannot_be_made_is_told_and_nothing_changed(
    book, capsys, monkeypatch, arguments, says
):
    before = {path: path.read_bytes() for path in book.rglob("*") if path.is_file()}
    monkeypatch.setattr(sys, "argv", ["new", *arguments])
    with pytest.raises(SystemExit, match=says):
        new.main()
    assert {path: path.read_bytes() for path in book.rglob("*") if path.is_file()} == before


def test_a_new_question_of_every_kind_is_one_that_can_be_released(book):
    assert set(new.EXAMPLES) == {*KINDS, *orientation_course.KINDS}
    path = book / "tests" / "solutions" / "trial.ipynb"
    nbformat.write(
        nbformat.v4.new_notebook(
            cells=[new.code("import sympy as sm\n\nfrom coursework import check")]
        ),
        path,
    )
    for number, kind in enumerate([*new.EXAMPLES] * 2):
        new.new_question(f"trial/{kind.replace(' ', '-').lower()}-{number}", "", kind)
    assert len(read_source(path).questions) == 2 * len(new.EXAMPLES)
    with pytest.raises(SystemExit, match="already has a question trial/words-9"):
        new.new_question("trial/words-9", "", "words")


#: Docstrings name equations by number, since a terminal shows no links. They mean these.
EQUATIONS = {
    "angular_velocity_matrix": ["three-rates"],
    "axis_angle_from_dcm": ["back-axis"],
    "body_fixed_from_dcm": ["back-psi", "back-rest"],
    "check_dcm": ["orthogonal"],
    "dcm_from_axis_angle": ["axis-angle"],
    "dcm_from_body_fixed": ["gimbal-chain"],
    "dcm_from_directions": ["wahba"],
    "dcm_from_quaternion": ["quaternion-vector"],
    "dcm_from_rotation_vector": ["exponential-closed"],
    "dcm_from_two_directions": ["triad"],
    "dcm_rate": ["dcm-rate"],
    "directions_covariance": ["directions-covariance"],
    "interpolate_quaternions": ["slerp"],
    "multiply_quaternions": ["quaternion-product"],
    "MultiplicativeKalmanFilter": ["filter-turn", "filter-observe"],
    "nearest_dcm": ["nearest"],
    "quaternion_from_axis_angle": ["half-angle"],
    "quaternion_from_dcm": ["back-quaternion"],
    "quaternion_rate": ["quaternion-rate"],
    "simple_dcm": ["simple-matrix"],
    "smooth": ["smoother"],
}


def test_docstrings_name_equations_by_the_numbers_of_the_book():
    labels = [
        re.findall(r'"\$\$ \(equation-([\w-]+)\)', (REPOSITORY / f"{page}.ipynb").read_text("utf8"))
        for page in re.findall(r"file: (chapters/\S+)", (REPOSITORY / "_toc.yml").read_text("utf8"))
    ]
    notes = {
        name: re.findall(
            r"\(\d+\.\d+\)",
            str(getattr(orientation, name).__doc__).partition("In the book: ")[2],
        )
        for name in orientation.__all__
    }
    assert {name: numbers for name, numbers in notes.items() if numbers} == {
        name: [
            f"({k}.{n})"
            for label in wanted
            for k, own in enumerate(labels, 1)
            for n, other in enumerate(own, 1)
            if other == label
        ]
        for name, wanted in EQUATIONS.items()
    }, (
        "on the right, the numbers that the docstrings should name, by the labels in EQUATIONS of "
        "this file; a new chapter or equation moves those after it"
    )


def test_the_page_quotes_the_reply_to_the_numbers_as_they_stand(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (quoted,) = [
        line.removeprefix("> ")
        for cell in nbformat.read(
            REPOSITORY / "appendix" / "with-a-language-model.ipynb", as_version=4
        ).cells
        for line in cell.source.splitlines()
        if line.startswith("> ")
    ]
    assert quoted in str(check("chapters/scalar-last", [0, 0, 0.3827, 0.9239]))
