"""Somebody else's course, made, released, tried and handed out without anything of this book."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path

import pytest
from trial_course import CELLS, PROJECT, made_in, write_source

import coursework
from coursework.__main__ import main
from coursework.authoring.author import AuthorError
from coursework.authoring.course import find_course
from coursework.authoring.packing import DISTRIBUTIONS, archive, next_version, wheel
from coursework.authoring.release import release
from coursework.authoring.trial import trial
from coursework.checking.update import update

EXAMPLE = PROJECT / "examples" / "plane-statics"


@pytest.fixture(scope="module")
def statics(tmp_path_factory):
    place = tmp_path_factory.mktemp("courses") / "plane-statics"
    main(["new", str(place)])
    return place


def contents(folder):
    return {
        path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def test_a_new_course_is_whole(statics):
    course = find_course(statics / "exercises")
    assert course.title == "Plane statics" and course.root == statics
    names = {str(path.relative_to(statics)) for path in statics.rglob("*") if path.is_file()}
    assert {
        "README.md",
        "course.toml",
        "tests/test_course.py",
        ".github/workflows/test.yml",
    } <= names
    assert {
        "solutions/first-steps.ipynb",
        "exercises/first-steps.ipynb",
        "exercises/sealed/first-steps.json",
    } <= names
    with zipfile.ZipFile(course.archive) as box:
        assert {"exercises/first-steps.ipynb", "exercises/sealed/first-steps.json"} < {
            *box.namelist()
        }
        # A student who starts the kernel anew and runs only a check sees this from Python.
        assert b"name 'check' is not defined" in box.read("exercises/README.txt")
    # Another new course writes nothing over it.
    before = contents(statics)
    with pytest.raises(SystemExit, match="already exists"):
        main(["new", str(statics)])
    assert contents(statics) == before


def test_a_release_from_the_wrong_folder_deletes_nothing(statics, tmp_path, monkeypatch):
    """`release --sources MINE` in another course's folder once deleted that course's exercises."""
    write_source(tmp_path / "mine", *CELLS)
    shutil.copytree(statics / "exercises", tmp_path / "exercises")
    (tmp_path / "course.toml").write_text("")
    before = contents(tmp_path)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(
        SystemExit,
        match=r"No notebook in \S*mine makes \S*first-steps.ipynb, \S*json\. We changed nothing",
    ):
        main(["release", "--sources", "mine"])
    assert contents(tmp_path) == before


def test_one_notebook_is_released_alone(tmp_path):
    course = made_in(tmp_path)
    for name in ("trial", "other"):
        write_source(
            course.sources,
            *((kind, text.replace("trial/", f"{name}/"), *tags) for kind, text, *tags in CELLS),
            name=name,
        )
    assert [made.name for made in release(course, run=False)] == ["other", "trial"]
    before = contents(tmp_path)
    for path in (course.exercises / "trial.ipynb", course.sealed / "trial.json"):
        path.unlink()
    (course.sealed / "other.json").write_text("untouched")
    assert [made.name for made in release(course, ["trial"], run=False)] == ["trial"]
    assert (course.sealed / "other.json").read_text() == "untouched"
    (course.sealed / "other.json").write_bytes(before[Path("sealed/other.json")])
    assert contents(tmp_path) == before
    with pytest.raises(AuthorError, match="no nothing.ipynb"):
        release(course, ["nothing"], run=False)


@pytest.mark.parametrize(
    ("files", "says"),
    [
        ({}, "coursework new COURSE"),
        ({"course.toml": "title = 3"}, "course.toml: .*the settings are title"),
        ({"course.toml": "titel = 'Statics'"}, "course.toml: .*but not 'titel'"),
        # Windows' editor may put a byte order mark first.
        ({"course.toml": "\ufefftitel = 'Statics'"}, "course.toml: .*but not 'titel'"),
        ({"course.toml": "title = "}, "course.toml: .*Invalid value"),
        ({"course.toml": 'sealed = "C:\\Users"'}, "write / in paths"),
        (
            # Git leaves this after a merge with conflicts.
            {"course.toml": "", "solutions/trial.ipynb": "<<<<<<< HEAD"},
            "solutions/trial.ipynb is not a notebook that we can read .*line 1",
        ),
        *(
            (
                {"course.toml": "", f"solutions/{name}.ipynb": "{}", "solutions/trial.ipynb": "{}"},
                f"{name}.ipynb: rename this notebook, .* such as week-2",
            )
            for name in ("week_2", "Week2", "Woche 2", "übung", "long" * 16)
        ),
    ],
)
def test_a_course_that_cannot_be_read_is_refused(tmp_path, monkeypatch, files, says):
    monkeypatch.chdir(tmp_path)
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text, "utf8")
    with pytest.raises(SystemExit, match=says):
        main(["release"])


def test_the_preview_shows_what_students_hear(statics, tmp_path):
    text = Path(trial(find_course(statics), "first-steps/area", tmp_path / "try.html")).read_text(
        "utf8"
    )
    for part in (
        "A triangle has a base",
        "This is the area of the rectangle",
        "Draw the rectangle",
        "Two such triangles",
    ):
        assert part in text
    assert "slope" not in text and "Leaks" not in text
    assert "<math" in text and "$b$" not in text
    with pytest.raises(
        AuthorError, match="first-steps.ipynb has first-steps/area, first-steps/slope"
    ):
        trial(find_course(statics), "first-steps/none", tmp_path / "try.html")


def test_without_the_solutions_students_still_get_everything(statics, tmp_path):
    published = tmp_path / "published"
    shutil.copytree(statics, published, ignore=shutil.ignore_patterns("solutions", "build"))
    course = find_course(published)
    with (
        zipfile.ZipFile(archive(course)) as ours,
        zipfile.ZipFile(find_course(statics).archive) as theirs,
    ):
        assert {name: ours.read(name) for name in ours.namelist()} == {
            name: theirs.read(name) for name in theirs.namelist()
        }
    with pytest.raises(AuthorError, match="private repository"):
        release(course)


def test_the_students_package_has_no_grader(tmp_path):
    names = {name: set(zipfile.ZipFile(wheel(name, tmp_path)).namelist()) for name in DISTRIBUTIONS}
    assert not any("grading" in name or "authoring" in name for name in names["coursework-checks"])
    assert "coursework/checking/check.py" in names["coursework-checks"]
    assert "coursework/grading/execution/sandbox.py" in names["coursework-tools"]
    packed = {name for files in names.values() for name in files if name.startswith("coursework/")}
    root = PROJECT / "src"
    assert packed == {
        path.relative_to(root).as_posix()
        for path in (root / "coursework").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


#: Modules imported only where they exist, on request or by type checkers: a browser's own, a
#: cluster, pictures in replies.
ON_REQUEST = {"js", "pyodide_js", "distributed", "_typeshed"}
OF_STUDENTS_ON_REQUEST = {"numpy", "latex2mathml"}


def test_what_the_packages_import_they_ask_for():
    """They do not rely on what other packages happen to install."""
    belongs_to = metadata.packages_distributions()
    for name, (patterns, needs, _) in DISTRIBUTIONS.items():
        asked = {re.match(r"[a-z0-9-]+", need)[0] for need in needs}
        if "coursework-checks" in asked:
            asked |= {
                re.match(r"[a-z0-9-]+", need)[0] for need in DISTRIBUTIONS["coursework-checks"][1]
            } | {"mpmath"}
        allowed = (
            asked
            | ON_REQUEST
            | ({"mpmath"} | OF_STUDENTS_ON_REQUEST if name == "coursework-checks" else set())
        )
        root = PROJECT / "src" / "coursework"
        for path in {
            path for pattern in patterns for path in root.glob(pattern) if path.suffix == ".py"
        }:
            for node in ast.walk(ast.parse(path.read_text("utf8"))):
                imported = (
                    [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                )
                if isinstance(node, ast.ImportFrom) and not node.level:
                    imported = [node.module]
                for module in {module.partition(".")[0] for module in imported} - set(
                    sys.stdlib_module_names
                ):
                    brought_by = {
                        distribution.lower() for distribution in belongs_to.get(module, [module])
                    }
                    assert module == "coursework" or brought_by & allowed, (name, path.name, module)


@pytest.mark.long
def test_a_mended_package_has_another_version(tmp_path):
    """Other contents have another version, so that pip replaces them; only a release's is plain."""
    shutil.copytree(
        Path(coursework.__file__).parent,
        tmp_path / "coursework",
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    stated = coursework.__version__

    def git(*arguments):
        about = {
            "GIT_COMMITTER_DATE": "2026-12-01T08:00:00Z",
            "HOME": str(tmp_path),
            "PATH": os.environ["PATH"],
        }
        name = ["-c", "user.name=An author", "-c", "user.email=author@example.org"]
        subprocess.run(
            ["git", *name, *arguments], cwd=tmp_path, env=about, check=True, capture_output=True
        )

    def built(
        place,
        code="import sys; from coursework.__main__ import main; main(['wheels', sys.argv[1]])",
    ):
        environment = {**os.environ, "PYTHONPATH": str(place), "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-c", code, str(tmp_path / "wheels")]
        subprocess.run(command, env=environment, check=True, capture_output=True, cwd=tmp_path)
        wheels = {path.name.split("-")[0]: path for path in (tmp_path / "wheels").iterdir()}
        versions = {path.name.split("-")[1] for path in wheels.values()}
        with zipfile.ZipFile(wheels["coursework_tools"]) as box:
            (about,) = (name for name in box.namelist() if name.endswith("METADATA"))
            assert [
                f"Requires-Dist: coursework-checks=={version}" in box.read(about).decode()
                for version in versions
            ] == [True]
        kept = tmp_path / "kept" / wheels["coursework_checks"].name
        kept.parent.mkdir(exist_ok=True)
        shutil.copy(wheels["coursework_checks"], kept)
        shutil.rmtree(tmp_path / "wheels")
        return *versions, kept

    git("init", "--quiet")
    git("add", "coursework")
    git("commit", "-m", "first")
    assert built(tmp_path)[0] == f"{stated}.dev20261201080000"
    git("tag", f"coursework-checks-{stated}")
    assert built(tmp_path)[0] == stated
    (tmp_path / "coursework" / "grading" / "new.py").write_text("")
    os.utime(tmp_path / "coursework" / "grading" / "new.py", (1796202000, 1796202000))
    version, wheel_file = built(tmp_path)
    assert version == f"{next_version(stated)}.dev20261202090000"
    # An instructor who has installed it, and makes a course with it, hands out the same.
    with zipfile.ZipFile(wheel_file) as box:
        box.extractall(tmp_path / "installed")
    said = subprocess.check_output(
        [sys.executable, "-c", "import coursework; print(coursework.__version__)"],
        env={**os.environ, "PYTHONPATH": str(tmp_path / "installed")},
        cwd=tmp_path / "installed",
        text=True,
    )
    assert said.strip() == version


def test_where_nothing_can_be_written_commands_say_so(statics, tmp_path, monkeypatch, capsys):
    """With another path for its page, it runs and stores nothing."""
    course = shutil.copytree(statics, tmp_path / "course", ignore=shutil.ignore_patterns("build"))
    (course / "build").write_text("in the way")
    monkeypatch.chdir(course)
    for command, said in (
        (["selftest"], "We cannot write the page '.*build.selftest.html'"),
        (["try", "first-steps"], "We cannot write the page '.*build.try.html'"),
        (["new", "build/inside"], "Not a directory: .*build"),
        (["wheels", "build/inside"], "Not a directory: .*build"),
    ):
        with pytest.raises(SystemExit, match=f"^coursework {command[0]}: {said}"):
            main(command)
    main(["selftest", "--page", str(tmp_path / "page.html")])
    assert (
        "Every question passed." in capsys.readouterr().out and (tmp_path / "page.html").is_file()
    )


def test_a_release_says_which_points_trying_or_a_copy_earns(statics, tmp_path, monkeypatch, capsys):
    course = shutil.copytree(statics, tmp_path / "course")

    def asked(name, kind, answer, about, worth):
        return (
            "code",
            f"### BEGIN SOLUTION\n{name} = {answer}\n### END SOLUTION\n"
            f"check('beam/{name}', {name})\n### BEGIN HIDDEN TESTS\n"
            f"question('beam/{name}', kind='{kind}', worth={worth}{about})\n"
            "### END HIDDEN TESTS",
        )

    cells = [
        ("code", "from coursework import check"),
        ("markdown", "Four questions about one beam."),
        asked("support", "choice", "'left'", ", options=['left', 'right']", 3),
        asked("bent", "expression", "0.6", ", mistakes={'Twice.': 1.2, 'Sum.': 0.6 + 0.6}", 2),
        asked("loads", "vector", "[1, 0, -2]", ", length=3", 2),
        asked(
            "ends", "truth values", "[True, False]", ", length=2, exam=True, fixed='Two ends.'", 1
        ),
    ]
    write_source(course / "solutions", *cells, name="beam")
    monkeypatch.chdir(course)
    main(["release", "beam"])
    said = capsys.readouterr().out
    assert "beam/support, 3 points: it has only 2 possible answers, so" in said
    assert (
        "beam/loads, 2 points: it has only 125 possible answers, so" in said
        and "beam/bent: these mistakes give the same answer" in said
        and "Twice. / Sum." in said
    )
    assert "5 of 8 points are for answers that a script" in said and "beam/bent, 2" not in said
    assert (
        "8 of 8 points in exercise notebooks are for questions with one answer for everybody."
        in said
    )
    assert "beam/bent (2): vary it, or" in said and "beam/ends (1): Two ends." in said


def test_one_notebook_is_tried_alone(statics, tmp_path, monkeypatch, capsys):
    course = shutil.copytree(statics, tmp_path / "course")
    shutil.copy(EXAMPLE / "solutions" / "moments.ipynb", course / "solutions")
    monkeypatch.chdir(course)
    main(["selftest", "first-steps"])
    text = (course / "build" / "selftest.html").read_text("utf8")
    assert "first-steps/" in text and "moments/" not in text
    with pytest.raises(SystemExit, match="has no levers.ipynb; choose from"):
        main(["selftest", "levers"])


@pytest.mark.parametrize(
    "package, fault, said",
    [
        ("build_tools:wheels", AuthorError, "but we cannot use it: No module named 'build_tools'"),
        ("json", AuthorError, "package = 'json', but we cannot use it: it is not a function"),
        ("a b:c", AuthorError, "package = 'a b:c', but we cannot use it"),
        ("builtins:print", AuthorError, "builtins:print in course.toml returned no wheels"),
        # This function's own error is its author's to see.
        ("importlib:import_module", ImportError, "^No module named '/"),
    ],
)
def test_a_function_for_the_package_that_cannot_be_used_is_told(statics, package, fault, said):
    with pytest.raises(fault, match=said):
        archive(find_course(statics)._replace(package=package))


def test_an_update_brings_new_sealed_questions(statics, tmp_path):
    with zipfile.ZipFile(find_course(statics).archive) as box:
        box.extractall(tmp_path)
    work = tmp_path / "exercises"
    (work / "first-steps.ipynb").write_text("mine")
    (work / "manifest.json").unlink()  # It was unpacked before there were manifests.
    (work / "sealed" / "first-steps.json").write_text("older")
    said = update(find_course(statics).archive, work)
    assert (
        "replaced    sealed/first-steps.json" in said
        and json.loads((work / "sealed" / "first-steps.json").read_text("utf8"))["questions"]
        and (work / "first-steps.ipynb").read_text() == "mine"
        and (work / "first-steps-new-1.ipynb").exists()
    )


@pytest.mark.long
def test_a_second_course_with_variants(tmp_path, monkeypatch):
    """A notebook of plane statics has questions in variants.

    The test of the manual uses an environment with nothing of a book.
    """
    course = shutil.copytree(EXAMPLE, tmp_path / "plane-statics")
    monkeypatch.chdir(course)
    main(["release", "equilibrium"])
    main(["selftest", "equilibrium"])
    variants = course / "exercises" / "sealed" / "variants"
    assert len(list(variants.glob("*.json"))) == 15
