"""From the notebooks with solutions to what students receive: nothing more, and always the same."""

import base64
import json
import os
import random
import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from datetime import UTC, datetime
from pathlib import Path

import nbformat
import pytest
from seed import SEED
from trial_course import SETUP, SOLUTION, made_in, write_source

from coursework.authoring import release
from coursework.authoring.author import AuthorError
from coursework.authoring.course import find_course
from coursework.authoring.packing import archive
from coursework.authoring.selftest import found_in, released_texts, secrets_of
from coursework.checking import sealing
from notebook_pages import packing

COURSE = find_course(Path(__file__).parent)
INSTRUCTORS = (COURSE.root / "appendix" / "instructors.md").read_text("utf8")


HIDDEN = (
    "### BEGIN HIDDEN TESTS\n"
    "question('trial/about-x', kind='direction cosine matrix', frames=('A', 'N'), symbols='theta', "
    "turns=[('x', theta)], worth=2, solution='The shared axis is the first one, which does not "
    "move.')\n"
    "### END HIDDEN TESTS"
)
FUNCTION = (
    '### BEGIN SOLUTION\ndef conjugate(quaternion):\n    """Return the conjugate."""\n'
    '    "a quoted remark"\n'
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
    release.release(made_in(folder), run=False)
    return folder


def test_the_exercise_has_blanks_where_the_solution_was(trial):
    text = [
        cell.source
        for cell in nbformat.read(trial / "exercises" / "trial.ipynb", as_version=4).cells
    ]
    assert text[3] == "A_C_N = ...  # your answer"
    assert text[4] == "check('trial/about-x', A_C_N)"
    assert (
        text[5]
        == 'def conjugate(quaternion):\n    """Return the conjugate."""\n    ...  # your code'
    )


def test_a_figure_becomes_a_picture_with_its_text(trial):
    picture = nbformat.read(trial / "exercises" / "trial.ipynb", as_version=4).cells[2].source
    text, data = re.fullmatch(
        r'<p><img alt="(.*)" width="\d+" src="data:image/svg\+xml;base64,(.*)"></p>', picture
    ).groups()
    assert "long enough to stand for the picture" in text
    assert base64.b64decode(data).startswith(b"<svg xmlns=")


def test_a_release_is_the_same_each_time(trial, tmp_path):
    release.release(made_in(tmp_path, sources=trial / "sources"), run=False)
    assert release.differences(trial / "exercises", tmp_path / "exercises", "*") == []
    assert release.differences(trial / "sealed", tmp_path / "sealed", "*") == []


def test_a_planted_secret_is_found(trial, tmp_path):
    source = release.read_source(trial / "sources" / "trial.ipynb")
    secrets, sealed, none = secrets_of(source), trial / "sealed", tmp_path / "none.zip"
    assert len(secrets) > 5
    assert found_in(released_texts(trial / "exercises", sealed, none), secrets) == []
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
        leaks = found_in(released_texts(folder, sealed, none), secrets)
        assert leaks or "turns" in planted
    with zipfile.ZipFile(tmp_path / "box.zip", "w") as box:
        box.writestr("inner.txt", source.questions["trial/about-x"].solution)
    assert found_in(released_texts(trial / "exercises", sealed, tmp_path / "box.zip"), secrets)


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        (
            [("code", SETUP), ("code", SOLUTION), ("code", "check('trial/about-x', A_C_N)")],
            "these checks have no question",
        ),
        ([("code", SETUP), ("code", f"A_C_N = 1\n{HIDDEN}")], "below its check"),
        (
            [
                ("code", SETUP),
                ("code", SOLUTION),
                ("code", f"check('other/about-x', A_C_N)\n{HIDDEN.replace('trial', 'other')}"),
            ],
            "name each question of this notebook 'trial/...'",
        ),
        (
            [
                ("code", SETUP),
                ("code", SOLUTION),
                ("code", f"check('trial/about-x', A_C_N * 1)\n{HIDDEN}"),
            ],
            "plain variable name",
        ),
        (
            [
                ("code", SETUP),
                ("code", SOLUTION),
                ("code", f"check('trial/about-x', A_C_N)\n{HIDDEN}\n{HIDDEN}"),
            ],
            "two questions",
        ),
        ([("code", SETUP), ("code", "undefined_name")], "cell 1: NameError"),
    ],
)
def test_an_author_is_told_what_is_wrong(tmp_path, cells, words):
    with pytest.raises(AuthorError, match=re.escape(words)):
        release.read_source(write_source(tmp_path, *cells))


COMMITTED = sorted(path.stem for path in COURSE.sources.glob("*.ipynb"))
needs_solutions = pytest.mark.skipif(
    not COMMITTED, reason="the solutions are kept elsewhere and are not here"
)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", COMMITTED)
def test_what_is_committed_is_what_the_source_makes(name, tmp_path):
    write_to = tmp_path / "sources", tmp_path / "exercises", tmp_path / "sealed"
    # All of them: what a right answer opens hints for may stand in another notebook.
    shutil.copytree(COURSE.sources, write_to[0])
    chosen_variant = random.Random(f"{SEED} {name}").randrange(1, 8)
    # The other variants say how many lockers each of them is filled up to.
    (write_to[2] / "variants").mkdir(parents=True)
    for path in (COURSE.sealed / "variants").glob(f"{name}-*.json"):
        if path.stem.removeprefix(f"{name}-") != str(chosen_variant):
            shutil.copy(path, write_to[2] / "variants")
    release.release(made_in(tmp_path), [name], variants=[chosen_variant])
    variants = [
        folder / "variants" / f"{name}-{chosen_variant}.json"
        for folder in (write_to[2], COURSE.sealed)
    ]
    message = (
        "Run `make release` and commit what it changes: "
        "the exercises or the sealed questions are not what this makes."
    )
    made = COURSE.exercises / f"{name}.ipynb", COURSE.sealed / f"{name}.json"
    if name != release.CHAPTERS:
        assert (write_to[1] / made[0].name).read_bytes() == made[0].read_bytes(), message
    here, there = (
        json.loads(file.read_text("utf8"))["questions"]
        for file in (write_to[2] / made[1].name, made[1])
    )
    others = {key: about.pop("others") for key, about in there.items() if "others" in about}
    assert {key for key, about in here.items() if about.pop("others", None)} == set(others), message
    assert here == there, message
    # What is right for others comes from all variants: here it is that of the two that were made.
    for number in (0, chosen_variant):
        for key, asked in release.read_source(
            COURSE.sources / f"{name}.ipynb", number
        ).questions.items():
            data = base64.b85decode(others[key][1]) if key in others else b""
            known = {
                data[start : start + sealing.NAME].hex()
                for start in range(0, len(data), sealing.NAME)
            }
            assert key not in others or set(asked.names_for_others()) <= known, message
    made, committed = (path.read_bytes() if path.is_file() else None for path in variants)
    assert made == committed, message


@needs_solutions
def test_nothing_is_committed_that_has_no_source():
    assert sorted(path.stem for path in COURSE.sealed.glob("*.json")) == COMMITTED
    assert sorted(path.stem for path in COURSE.exercises.glob("*.ipynb")) == sorted(
        {*COMMITTED} - {release.CHAPTERS}
    )


def test_there_is_a_notebook_of_exercises_for_every_chapter():
    chapters = {path.stem for path in (COURSE.root / "chapters").glob("*.ipynb")}
    assert {path.stem for path in COURSE.exercises.glob("*.ipynb")} == chapters
    questions = [
        name
        for path in COURSE.sealed.glob("*.json")
        for name in json.loads(path.read_text("utf8"))["questions"]
    ]
    assert sum(not name.startswith("chapters/") for name in questions) >= 60


def unpacked(archive_file, folder):
    with zipfile.ZipFile(archive_file) as box:
        box.extractall(folder)
    return folder / "exercises"


def fake_wheel(folder, version, digest, package="sealed_trial"):
    """A package that holds one file, made without any tool."""
    name = f"{package}-{version}-py3-none-any.whl"
    about = f"{package}-{version}.dist-info"
    with zipfile.ZipFile(folder / name, "w") as box:
        box.writestr(f"{package}.py", f"DIGEST = {digest!r}\n")
        box.writestr(
            f"{about}/METADATA", f"Metadata-Version: 2.1\nName: {package}\nVersion: {version}\n"
        )
        box.writestr(
            f"{about}/WHEEL",
            "Wheel-Version: 1.0\nGenerator: a test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        )
        box.writestr(
            f"{about}/RECORD",
            f"{package}.py,,\n{about}/METADATA,,\n{about}/WHEEL,,\n{about}/RECORD,,\n",
        )
    return folder / name


def in_bash(text, prompt):
    """The commands of a text, each on a line of its own after ``prompt``."""
    return [line.removeprefix(prompt) for line in text.splitlines() if line.startswith(prompt)]


@pytest.mark.long
def test_the_archive_is_the_same_each_time_and_can_be_followed(tmp_path):
    """To the letter: with a system's Python that takes no packages,
    and in a room without a network.
    """
    file = archive(COURSE, tmp_path / "exercises.zip")
    assert archive(COURSE, tmp_path / "again.zip").read_bytes() == file.read_bytes()
    with zipfile.ZipFile(file) as box:
        names = {Path(name).name for name in box.namelist()}
        packages = {f"./{name}" for name in names if name.endswith(".whl")}
        assert len(packages) == 3 and packages < set(
            box.read("exercises/requirements.txt").decode().splitlines()
        )
    assert {path.name for path in COURSE.exercises.glob("*.ipynb")} < names
    work = unpacked(file, tmp_path)
    index = tmp_path / "index"
    index.mkdir()
    for name in ("jupyterlab", "latex2mathml"):
        fake_wheel(index, "1.0", "", name)
    readme = (work / "README.txt").read_text("utf8")
    first, second, third, windows, *_, offline, lab, _ = in_bash(readme, " " * 7)
    assert (windows, lab) == ("py -m venv environment", "jupyter lab")
    environment = {
        **os.environ,
        "PIP_NO_INDEX": "1",
        "PIP_NO_DEPS": "1",
        "PIP_DISABLE_PIP_VERSION_CHECK": "1",
    }

    python = shlex.quote(sys.executable)
    assert first.startswith("python3 ")
    first = first.replace("python3", python, 1)
    check = "python -c 'import importlib.util as u; print(u.find_spec(\"coursework\").origin)'"

    def run(*lines, **more):
        script = "\n".join(["set -eu", *lines, check])
        done = subprocess.run(
            ["bash", "-c", script],
            cwd=work,
            env={**environment, **more},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        return Path(done.stdout.splitlines()[-1])

    assert run(first, second, third, PIP_FIND_LINKS=str(index)).is_relative_to(work / "environment")
    shutil.rmtree(work / "environment")
    (fetch,) = [line for line in in_bash(INSTRUCTORS, "$ ") if "pip download" in line]
    (same,) = [line for line in in_bash(INSTRUCTORS, "$ ") if "--no-index" in line]
    assert same.replace("--requirement", "-r") == offline
    run(first, second, third, fetch, PIP_FIND_LINKS=str(index))
    shutil.rmtree(work / "environment")
    shutil.rmtree(index)
    assert run(first, second, offline).is_relative_to(work / "environment")


def test_a_version_follows_from_the_sources(tmp_path):
    def git(*arguments, when="2026-11-22T09:30:00Z"):
        about = {
            "GIT_COMMITTER_DATE": when,
            "GIT_AUTHOR_DATE": when,
            "HOME": str(tmp_path),
            "PATH": os.environ["PATH"],
        }
        name = ["-c", "user.name=An author", "-c", "user.email=author@example.org"]
        subprocess.run(
            ["git", *name, *arguments], cwd=book, env=about, check=True, capture_output=True
        )

    def version(book=tmp_path / "book"):
        project = packing.Project(
            "maths", ["src/orientation", "src/tools"], ["src/tools/grading"], repository=book
        )
        return project.version()

    def touch(name, text, moment):
        path = book / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        os.utime(path, (moment, moment))

    def at(*moment):
        return datetime(*moment, tzinfo=UTC).timestamp()

    book = tmp_path / "book"
    for name in ("maths/README.md", "src/orientation/a.py", "src/tools/grading/grade.py"):
        touch(name, "", at(2026, 11, 1))
    touch(
        "maths/pyproject.toml",
        "[project]\nname = 'maths'\ndynamic = ['version']\n",
        at(2026, 11, 1),
    )
    touch("src/orientation/__init__.py", '__version__ = "1.1.0"\n', at(2026, 11, 1))
    # No repository: when the newest file was written.
    assert version() == "1.1.0.dev20261101000000"
    git("init", "--quiet")
    git("add", ".")
    git("commit", "-m", "first")
    assert version() == "1.1.0.dev20261122093000"
    touch("chapters/a.ipynb", "{}", at(2026, 12, 1))
    touch("src/tools/grading/grade.py", "# mended", at(2026, 12, 1))
    git("add", ".")
    git("commit", "-m", "what students do not get", when="2026-12-01T00:00:00Z")
    assert version() == "1.1.0.dev20261122093000"
    touch("src/orientation/a.py", "# mended", at(2026, 12, 2, 10))
    assert version() == "1.1.0.dev20261202100000"  # not committed yet
    git("commit", "-am", "mended", when="2026-12-02T11:00:00Z")
    assert version() == "1.1.0.dev20261202110000"
    git("clone", "--quiet", "--no-local", "--depth=1", f"file://{book}", str(tmp_path / "shallow"))
    assert version(tmp_path / "shallow") == "1.1.0.dev20261202110000"
    os.remove(book / "src/orientation/a.py")
    os.utime(book / "src/orientation", (at(2026, 12, 3), at(2026, 12, 3)))
    assert version() == "1.1.0.dev20261203000000"
    # Released, it is plain: as long as the sources are those of its tag,
    # whatever else the repository gets.
    git("checkout", ".")
    git("tag", "maths-1.1.0")
    touch("chapters/a.ipynb", "{ }", at(2026, 12, 4))
    assert version() == "1.1.0"
    for undo in (
        lambda: touch("src/orientation/b.py", "", at(2026, 12, 5)),
        lambda: (
            os.remove(book / "src/orientation/b.py"),
            touch("src/orientation/a.py", "# again", at(2026, 12, 5)),
        ),
    ):
        undo()
        assert version() == "1.1.1.dev20261205000000"
