"""An autograder for Gradescope: a zip to upload, and what runs in it.

Gradescope unpacks the zip into ``/autograder/source`` and runs ``setup.sh`` once, with a network.
For each submission it runs ``run_autograder`` in a fresh machine, which finds the work in
``/autograder/submission`` and who handed it in in ``/autograder/submission_metadata.json``, and
writes ``/autograder/results/results.json``.

The solutions and the secret are in the zip, so students' code is isolated
there as everywhere, or not run at all.
"""

import io
import json
import sys
import tempfile
import zipfile
from collections import deque
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path

from ...authoring.course import find_course
from ...checking.fields import Fields, many, text, truth
from ..judging.secret import FILE as SECRET
from ..judging.secret import secret_beside
from ..versions import folders

HOME = Path("/autograder")
CONFIGURATION = "autograder.json"

SETUP = """#!/usr/bin/env bash
# Run once by Gradescope, with a network: Python, what the packages need, and the questions worked
# out.
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


# --- the zip ------------------------------------------------------------------------------------


def write_autograder(
    path: str | Path,
    assignments: Mapping[str, Sequence[str]],
    *,
    solutions: str | Path | None = None,
    roster: str | Path | None = None,
) -> Sequence[str]:
    """Write the zip that Gradescope takes, for one assignment; give the names
    of the notebooks that make it up.

    Parameters
    ----------
    path : path
    assignments : dict
        One name, and its notebooks.
    solutions : path, optional
    roster : path, optional
        Who is in the course, with the addresses by which Gradescope knows students.
    """
    from ..grade import Course

    folder = Path(solutions or find_course().sources)
    course = Course(folder, assignments)
    ((name, stems),) = course.assignments.items()
    secret_beside(folder)  # made here if there is none: marks are to be the same there
    files = {
        "setup.sh": SETUP.encode(),
        "run_autograder": RUN.encode(),
        "requirements.txt": "".join(f"{one}\n" for one in requirements()).encode(),
        CONFIGURATION: json.dumps(
            {"assignment": name, "notebooks": stems, "roster": roster is not None}
        ).encode(),
        **{f"solutions/{stem}.ipynb": course.sources[stem].read_bytes() for stem in stems},
        f"solutions/{SECRET}": (folder / SECRET).read_bytes(),
    }
    if course.edition:
        files["course.toml"] = f"edition = {json.dumps(course.edition)}\n".encode()
    if roster:
        files["roster.csv"] = Path(roster).read_bytes()
    for package in folders():
        for file in sorted(package.rglob("*")):
            if file.is_file() and "__pycache__" not in file.parts:
                files[f"packages/{package.name}/{file.relative_to(package).as_posix()}"] = (
                    file.read_bytes()
                )
    entries = "".join(
        f"{one.name} = {one.value}\n" for one in metadata.entry_points(group="coursework.plugins")
    )
    files["packages/course-1.dist-info/METADATA"] = (
        b"Metadata-Version: 2.1\nName: course\nVersion: 1\n"
    )
    files["packages/course-1.dist-info/entry_points.txt"] = (
        f"[coursework.plugins]\n{entries}".encode()
    )
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for place, content in sorted(files.items()):
            # With a fixed date: the same autograder is the same bytes.
            entry = zipfile.ZipInfo(place)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (
                0o755 if place in ("setup.sh", "run_autograder") else 0o644
            ) << 16
            archive.writestr(entry, content)
    Path(path).write_bytes(data.getvalue())
    return stems


def requirements() -> list[str]:
    """All that grading needs beside these packages, in the versions that are
    installed here: marks follow from them.
    """
    from packaging.requirements import Requirement

    of_packages = metadata.packages_distributions()
    ours = {name for package in folders() for name in of_packages.get(package.name, ())}
    found: dict[str, str] = {}
    waiting = deque((name, frozenset({"", "tools"})) for name in ours)
    seen = set(waiting)
    while waiting:
        name, extras = waiting.popleft()
        distribution = metadata.distribution(name)
        if name not in ours:
            found[distribution.name.lower()] = distribution.version
        for line in distribution.requires or ():
            requirement = Requirement(line)
            if not any(
                requirement.marker is None or requirement.marker.evaluate({"extra": extra})
                for extra in extras
            ):
                continue
            one = requirement.name, frozenset({"", *requirement.extras})
            if one not in seen:
                seen.add(one)
                waiting.append(one)
    return [f"{name}=={version}" for name, version in sorted(found.items())]


# --- what runs there ----------------------------------------------------------------------------


def run(home: Path = HOME) -> None:
    """Grade the submission of one student, or of a group, and write its results.

    Where students' code cannot be kept apart well enough, there are no results: Gradescope says
    that the autograder failed, and nobody has lost a point.
    """
    from ..grade import NothingToGrade, grade
    from ..store import REFUSED, Store
    from ..submissions.intake import Refused
    from ..submissions.roster import Roster
    from .gradebooks import Marks, write_gradescope

    source = home / "source"
    assignments, with_roster = _configuration(source)
    (assignment,) = assignments
    about = home / "submission_metadata.json"
    user, *_ = Fields(json.loads(about.read_text("utf8")), str(about)).get("users", many(_user))
    roster = source / "roster.csv" if with_roster else None
    student = user["email"]
    results = home / "results" / "results.json"
    if roster:
        found, why = Roster(roster).find(
            (("email", user["email"]), ("own", user["email"]), ("name", user["name"]))
        )
        if found is None:
            return _say(
                results, f"You are not in the list of this course ({why}) Ask your instructor."
            )
        student = found
    with tempfile.TemporaryDirectory() as out:
        Path(out, "questions").symlink_to(home / "questions")
        try:
            grade(
                home / "submission",
                out,
                solutions=source / "solutions",
                assignments=assignments,
                roster=roster,
                student=student,
            )
        except NothingToGrade as error:
            return _say(results, str(error))
        store = Store(out)
        if store.read(student, assignment) is None:
            refused = [
                f"{Path(one.file).name}: {one.why}"
                for one in store.said(REFUSED, many(Refused.from_json)) or ()
            ]
            return _say(
                results, "\n".join(["There was no notebook that could be graded.", *refused])
            )
        write_gradescope(results, Marks(store), student)


def _configuration(source: Path) -> tuple[dict[str, tuple[str, ...]], bool]:
    """The notebooks of the assignment, by its name, and whether there is a roster."""
    about = Fields(json.loads((source / CONFIGURATION).read_text("utf8")), CONFIGURATION)
    return {about.get("assignment", text): about.get("notebooks", many(text))}, about.get(
        "roster", truth
    )


def _user(found: object, where: str) -> dict[str, str]:
    about = Fields(found, where)
    return {name: about.get(name, text) for name in ("email", "name")}


def _say(results: Path, said: str) -> None:
    """Results without questions: for nothing there are no points, and the student is told why."""
    from ..tables import readable

    results.write_text(
        json.dumps({"score": 0, "output": readable(said), "output_format": "text"}), "utf8"
    )


def prepare(home: Path = HOME) -> None:
    """Work the questions out, once for all submissions."""
    from ..grade import Course

    assignments, _ = _configuration(home / "source")
    Course(home / "source" / "solutions", assignments).questions(assignments, home / "questions")


if __name__ == "__main__":
    prepare() if sys.argv[1:] == ["--prepare"] else run()
