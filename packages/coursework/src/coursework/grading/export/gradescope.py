"""An autograder for Gradescope: a zip file to upload, and the code that runs in it.

Gradescope unpacks the zip file into ``/autograder/source`` and runs ``setup.sh`` once, with a
network. For each submission it runs ``run_autograder`` on a fresh machine, which finds the work in
``/autograder/submission`` and its students in ``/autograder/submission_metadata.json``, and writes
``/autograder/results/results.json``.

The zip file contains the solutions and the secret, so students' code is isolated there as
everywhere, or not run at all.
"""

import json
import os
import shutil
import sys
import tempfile
from collections import deque
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

from ...authoring.course import find_course
from ...authoring.packing import zipped
from ...authoring.source import files_of
from ..judging.secret import FILE as SECRET
from ..judging.secret import secret_beside
from ..judging.term import FILE, term_of
from ..store import write
from ..versions import folders

HOME = Path("/autograder")
ROSTER = "roster.csv"

SETUP = """#!/usr/bin/env bash
# Gradescope runs this once, with a network. It installs Python and the packages, and works out the
# questions.
set -eu
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
apt-get install -y -qq bubblewrap || true
for version in 3.13 3.12 3.11; do
    apt-get install -y -qq python$version python$version-venv && break
done
python$version -m venv /autograder/venv
/autograder/venv/bin/python -m pip install --quiet --requirement /autograder/source/requirements.txt
site=$(/autograder/venv/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
echo /autograder/source/packages > "$site/autograder.pth"
chmod 700 /autograder/source/solutions
/autograder/venv/bin/python -m coursework.grading.export.gradescope --prepare
"""
RUN = """#!/usr/bin/env bash
exec /autograder/venv/bin/python -m coursework.grading.export.gradescope
"""


# --- the zip file -------------------------------------------------------------------------------


def write_autograder(
    path: str | Path, marks: str | Path, assignment: str, *, solutions: str | Path | None = None
) -> Sequence[str]:
    """Write the zip file for Gradescope, for one assignment, and return its notebooks' names.

    Parameters
    ----------
    path : path
    marks : path
        The folder of marks, with the term. Its roster has the addresses by which Gradescope knows
        students.
    assignment : str
    solutions : path, optional
    """
    from ..assignments import Course

    folder, term = Path(solutions or find_course().sources), term_of(marks)
    course = Course(folder, term, [assignment])
    stems = course.assignments[assignment]
    there = (
        f'time-zone = "UTC"\n[assignments.{json.dumps(assignment)}]\n'
        f"notebooks = {json.dumps(stems)}\n"
    )
    # Create the secret here if necessary, so that both places give the same marks.
    secret_beside(folder)
    files = {
        "setup.sh": SETUP.encode(),
        "run_autograder": RUN.encode(),
        "requirements.txt": "".join(f"{requirement}\n" for requirement in requirements()).encode(),
        **{
            f"solutions/{name}": data
            for stem in stems
            for name, data in files_of(course.sources[stem]).items()
        },
        f"solutions/{SECRET}": (folder / SECRET).read_bytes(),
    }
    if course.edition:
        files["course.toml"] = f"edition = {json.dumps(course.edition)}\n".encode()
    if term.roster:
        files[ROSTER] = term.roster.path.read_bytes()
        there = f'roster = "{ROSTER}"\n{there}'
    files[FILE] = there.encode()
    for package in folders():
        for file in sorted(package.rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                files[f"packages/{package.name}/{file.relative_to(package).as_posix()}"] = (
                    file.read_bytes()
                )
    entries = "".join(
        f"{plugin.name} = {plugin.value}\n"
        for plugin in metadata.entry_points(group="coursework.plugins")
    )
    files["packages/course-1.dist-info/METADATA"] = (
        b"Metadata-Version: 2.1\nName: course\nVersion: 1\n"
    )
    files["packages/course-1.dist-info/entry_points.txt"] = (
        f"[coursework.plugins]\n{entries}".encode()
    )
    # The file contains the solutions and the secret.
    write(path, zipped(files, ("setup.sh", "run_autograder")), private=True)
    return stems


def requirements() -> list[str]:
    """Return the versions, as installed here, of everything else that marks depend on."""
    from packaging.requirements import Requirement

    of_packages = metadata.packages_distributions()
    ours = {name for package in folders() for name in of_packages.get(package.name, ())}
    versions: dict[str, str] = {}
    waiting = deque((name, frozenset({"", "tools"})) for name in ours)
    seen = set(waiting)
    while waiting:
        name, extras = waiting.popleft()
        distribution = metadata.distribution(name)
        if name not in ours:
            versions[distribution.name.lower()] = distribution.version
        for line in distribution.requires or ():
            requirement = Requirement(line)
            if not any(
                requirement.marker is None or requirement.marker.evaluate({"extra": extra})
                for extra in extras
            ):
                continue
            named = requirement.name, frozenset({"", *requirement.extras})
            if named not in seen:
                seen.add(named)
                waiting.append(named)
    return [f"{name}=={version}" for name, version in sorted(versions.items())]


# --- the code that runs there -------------------------------------------------------------------


def run(home: Path = HOME) -> None:
    """Grade the submission of one student, or of a group, and write its results.

    If students' code cannot be isolated well enough, there are no results. Gradescope then reports
    that the autograder failed, and nobody has lost a point.
    """
    from ..assignments import NothingToGrade
    from ..grade import grade
    from ..store import Store
    from ..submissions.intake import refused_of
    from .gradebooks import Marks, write_gradescope

    source = home / "source"
    term = term_of(source)
    (assignment,) = term.assignments
    submission = json.loads((home / "submission_metadata.json").read_text("utf8"))
    user = submission["users"][0]
    student: str = user["email"]
    results = home / "results" / "results.json"
    if term.roster:
        known_student, why = term.roster.find(
            (("email", user["email"]), ("own", user["email"]), ("name", user["name"]))
        )
        if known_student is None:
            return _say(
                results,
                f"We cannot find you on this course's list. {why} Ask your instructor.",
            )
        student = known_student
    with tempfile.TemporaryDirectory() as out:
        Path(out, "questions").symlink_to(home / "questions")
        for name in {FILE, ROSTER} & set(os.listdir(source)):
            shutil.copy(source / name, out)
        try:
            grade(
                home / "submission",
                out,
                solutions=source / "solutions",
                student=student,
            )
        except NothingToGrade as error:
            return _say(results, str(error))
        store = Store(out)
        if store.read(student, assignment) is None:
            refused = [f"{Path(file.file).name}: {file.why}" for file in refused_of(store)]
            return _say(
                results, "\n".join(["There was no notebook that we could grade.", *refused])
            )
        write_gradescope(results, Marks(store), student)


def _say(results: Path, said: str) -> None:
    """Write results without questions or points, and with the reason for the student."""
    from ...checking.writing import readable

    results.write_text(
        json.dumps({"score": 0, "output": readable(said), "output_format": "text"}), "utf8"
    )


def prepare(home: Path = HOME) -> None:
    """Process the questions once for all submissions."""
    from ..assignments import Course

    term = term_of(home / "source")
    Course(home / "source" / "solutions", term).questions(term.assignments, home)


if __name__ == "__main__":
    prepare() if sys.argv[1:] == ["--prepare"] else run()
