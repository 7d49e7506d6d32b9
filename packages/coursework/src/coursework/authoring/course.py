"""A course: the locations of its notebooks with solutions and of what is made from them."""

import re
import tomllib
from pathlib import Path
from typing import NamedTuple

from .author import AuthorError

FILE = "course.toml"


class Course(NamedTuple):
    """The settings in ``course.toml``; all paths are absolute.

    Attributes
    ----------
    title : str
    sources : Path
        The folder of the notebooks with solutions. Only releasing and grading need it.
    exercises, sealed : Path
        The folders of the notebooks that students get and of the sealed questions.
    archive : Path
        The archive that students download.
    package : str
        The ``module:function`` that builds the wheels for students, including coursework's, into a
        folder and returns their paths, for a course with its own package; empty for one that needs
        only coursework.
    edition : str
        Each edition, such as an exam or another year, draws the variants of questions anew.
    chapter, solution : str
        Addresses for the graders' feedback, with ``{notebook}`` and ``{question}``: where to read
        on, and the worked solution, given here once it is released.
    variants : str
        How students get variants: ``"by name"``, so that removing one affects only those who had
        it, or by number if empty. Set it before a term begins, since it changes students' numbers.
    roster : bool
        Whether the course has a roster. Each notebook then asks for the student's ID.
    """

    root: Path
    title: str
    sources: Path
    exercises: Path
    sealed: Path
    archive: Path
    package: str = ""
    edition: str = ""
    chapter: str = ""
    solution: str = ""
    variants: str = ""
    roster: bool = False


#: The settings of a course that are not paths.
TEXTS = ("package", "edition", "chapter", "solution", "variants")
BY_NAME = "by name"
DEFAULTS = {
    "sources": "solutions",
    "exercises": "exercises",
    "sealed": "exercises/sealed",
    "archive": "build/exercises.zip",
}


def find_course(start: str | Path = ".") -> Course:
    """Return the course of a folder, that of the nearest ``course.toml`` there or above.

    Raises
    ------
    AuthorError
        There is none, or it is invalid.
    """
    if (course := course_around(start)) is None:
        raise AuthorError(
            f"There is no {FILE} in {Path(start).resolve()}, or in any folder above it. Run "
            "this in the folder of your course, or create a course with `coursework new COURSE`."
        )
    return course


def course_around(start: str | Path) -> Course | None:
    """Return the course that a folder belongs to, or ``None``."""
    first = Path(start).resolve()
    file = next(
        (folder / FILE for folder in (first, *first.parents) if (folder / FILE).is_file()), None
    )
    return _read(file) if file else None


def gives_by_name(folder: str | Path) -> bool:
    """Check whether the course of a folder assigns variants by their names."""
    course = course_around(folder)
    return course is not None and course.variants == BY_NAME


def links_of(folder: str | Path) -> dict[str, str]:
    """Return the addresses in the course of a folder, by their purpose."""
    course = course_around(folder)
    return {
        name: address
        for name in ("chapter", "solution")
        if course and (address := getattr(course, name))
    }


def _read(path: Path) -> Course:
    try:
        said = tomllib.loads(path.read_text("utf-8-sig"))
    except ValueError as error:
        raise AuthorError(
            f"{path}: {error}. Put text in quotation marks, write / in paths, and save the file in "
            "UTF-8."
        ) from None
    if said.get("variants", BY_NAME) != BY_NAME:
        raise AuthorError(
            f'{path}: set variants = "{BY_NAME}" or leave it out; it is {said["variants"]!r}.'
        )
    roster = said.pop("roster", False)
    if not isinstance(roster, bool):
        raise AuthorError(f"{path}: set roster = true or leave it out; it is {roster!r}.")
    unknown = sorted(set(said) - {*DEFAULTS, "title", *TEXTS})
    if unknown or not all(isinstance(value, str) for value in said.values()):
        raise AuthorError(
            f"{path}: the settings are title, {', '.join((*TEXTS, *DEFAULTS))} (all "
            "strings) and roster (true or false)"
            + (f", but not {unknown[0]!r}." if unknown else ".")
        )
    others = {name: said.get(name, "") for name in TEXTS}
    for name in ("chapter", "solution"):
        if others[name] and not re.fullmatch(
            r"https?://[^{}\s]*(\{(notebook|question)\}[^{}\s]*)+", others[name]
        ):
            raise AuthorError(
                f"{path}: `{name}` must be an address with {{notebook}} or {{question}} in it, "
                f"not {others[name]!r}."
            )
    return Course(
        path.parent,
        said.get("title", path.parent.name),
        **{name: path.parent / said.get(name, default) for name, default in DEFAULTS.items()},
        **others,
        roster=roster,
    )
