"""The whole Gradescope autograder, on a machine laid out like Gradescope's with only our Python."""

import json
import os
import shutil
import subprocess
import venv
import zipfile
from importlib import metadata

import nbformat
import pytest
from grading_class import handed_in, write_sources, write_term

from coursework.__main__ import main
from coursework.grading.export.gradescope import requirements

BWRAP = ["bwrap", "--bind", "/", "/", "true"]
IMITATED = (
    shutil.which("bwrap") and subprocess.run(BWRAP, stderr=subprocess.DEVNULL).returncode == 0
)
needs_a_machine = pytest.mark.skipif(not IMITATED, reason="the machine is imitated with bubblewrap")


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """A folder to become ``/autograder``, unpacked and set up with this environment's packages."""
    place = tmp_path_factory.mktemp("gradescope")
    home = place / "autograder"
    (place / "roster.csv").write_text("student,name,email\nann,Ann Right,ann@uni.example\n")
    solutions = write_sources(place / "solutions")
    write_term(place / "marks", place / "roster.csv", {"homework": ["turns"]})
    main(
        ["gradescope", str(place / "marks"), "--out", str(place / "autograder.zip")]
        + ["--solutions", str(solutions), "--assignment", "homework"]
    )
    assert (place / "autograder.zip").stat().st_mode & 0o077 == 0
    with zipfile.ZipFile(place / "autograder.zip") as archive:
        archive.extractall(home / "source")
        modes = {entry.filename: entry.external_attr >> 16 & 0o777 for entry in archive.infolist()}
    assert modes["setup.sh"] == modes["run_autograder"] == 0o755
    for name in ("setup.sh", "run_autograder"):
        subprocess.run(["bash", "-n", home / "source" / name], check=True)
        (home / "source" / name).chmod(0o755)
    shutil.copy(home / "source" / "run_autograder", home)
    # In place of what setup.sh installs, use exactly the installed files of these requirements.
    venv.create(home / "venv", with_pip=False, symlinks=True)
    (site,) = (home / "venv" / "lib").glob("python*/site-packages")
    (site / "autograder.pth").write_text("/autograder/source/packages\n")
    for line in (home / "source" / "requirements.txt").read_text().split():
        for file in metadata.files(line.partition("==")[0]):
            if ".." not in file.parts:
                (site / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file.locate(), site / file)
    (home / "results").mkdir()
    (home / "submission").mkdir()
    done = there(
        home,
        "/autograder/venv/bin/python",
        "-m",
        "coursework.grading.export.gradescope",
        "--prepare",
    )
    assert done.returncode == 0, done.stderr
    assert len(list((home / "questions").glob("turns-*.json"))) == 1
    return home


def there(home, *command):
    """Run a command where the folder is ``/autograder``."""
    outside = [
        argument
        for name in sorted(os.listdir("/"))
        if name not in ("proc", "dev", "tmp", "autograder")
        for argument in ("--bind", f"/{name}", f"/{name}")
    ]
    layout = [
        "--tmpfs",
        "/",
        *outside,
        "--dev-bind",
        "/dev",
        "/dev",
        "--bind",
        "/proc",
        "/proc",
        "--tmpfs",
        "/tmp",
    ]
    return subprocess.run(
        ["bwrap", *layout, "--bind", str(home), "/autograder", "--chdir", "/", *command],
        capture_output=True,
        text=True,
        env={"PATH": "/usr/bin:/bin"},
    )


def graded(home, made, email="ann@uni.example", name="turns.ipynb"):
    for path in [*(home / "submission").iterdir(), *(home / "results").iterdir()]:
        path.unlink()
    (home / "submission" / name).write_text(
        made if isinstance(made, str) else nbformat.writes(made)
    )
    about = {
        "id": 7,
        "created_at": "2026-11-21T20:01:00-07:00",
        "users": [{"email": email, "id": 1, "name": "A. R."}],
    }
    (home / "submission_metadata.json").write_text(json.dumps(about))
    done = there(home, "/autograder/run_autograder")
    assert done.returncode == 0, done.stderr
    return json.loads((home / "results" / "results.json").read_text())


STEAL = """import os
found = []
for folder, _, files in os.walk('/autograder'):
    found += [os.path.join(folder, name) for name in files
              if name.endswith('.ipynb') or name == '.grading-secret']
for name in ('turns.ipynb', '.grading-secret'):
    place = '/autograder/source/solutions/' + name
    try:
        found.append(open(place).read())
    except OSError:
        pass
try:
    open('/autograder/results/results.json', 'w').write('{"score": 100}')
    found.append('written')
except OSError:
    pass
"""


@pytest.mark.long
@needs_a_machine
def test_a_submission_gets_its_results_or_the_reason_why_not(machine):
    results = graded(machine, handed_in(sum="sine = -sm.sin(alpha + beta)"))
    assert results["score"] == 5 and [test["score"] for test in results["tests"]] == [2, 0, 3]
    assert [test["max_score"] for test in results["tests"]] == [2, 1, 3]
    assert [test["status"] for test in results["tests"]] == ["passed", "failed", "passed"]
    assert {test["visibility"] for test in results["tests"]} == {"visible"}
    undecided = graded(machine, handed_in(sum="sine = sm.sin(alpha + beta)*1.0004"))["tests"][1]
    assert "status" not in undecided and "undecided" in undecided["output"]
    # Nothing of this working copy took part.
    said = there(
        machine,
        "/autograder/venv/bin/python",
        "-c",
        "import coursework; print(coursework.__file__)",
    ).stdout
    assert said.startswith("/autograder/source/packages/coursework/")
    assert "on this course's list" in graded(machine, handed_in(), "stranger@uni.example")["output"]
    results = graded(machine, "{")
    assert results["score"] == 0 and "not well-formed JSON" in results["output"]
    assert "answers.pdf: Not a notebook" in graded(machine, "x", name="answers.pdf")["output"]


@pytest.mark.long
@needs_a_machine
def test_a_submission_reaches_neither_the_solutions_nor_its_results(machine):
    results = graded(machine, handed_in(also=[STEAL, "assert not found, found"]))
    assert results["score"] == 6
    stolen = graded(
        machine, handed_in(sum=STEAL + "sine = sm.Symbol(str(found).replace(' ', '_'))")
    )
    assert stolen["score"] == 5


def test_the_packages_are_named_in_the_versions_that_are_here():
    named = dict(line.split("==") for line in requirements())
    assert {"sympy", "mpmath", "numpy", "matplotlib", "jinja2", "tornado", "latex2mathml"} <= set(
        named
    )
    assert "distributed" not in named and "pytest" not in named and "nbgrader" not in named
    assert not any(name.startswith("orientation") for name in named)
