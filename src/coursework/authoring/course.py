"""A course: where its notebooks with solutions are, and where what is made of them goes."""

import tomllib
from pathlib import Path
from typing import NamedTuple

from .author import AuthorError

FILE = "course.toml"


class Course(NamedTuple):
    """What ``course.toml`` says; all paths are absolute.

    Attributes
    ----------
    title : str
    sources : Path
        The folder of the notebooks with solutions. Nothing but releasing and grading needs it.
    exercises, sealed : Path
        The folders of the notebooks that students get and of the sealed questions.
    archive : Path
        What students download.
    package : str
        ``module:function`` that builds the wheel for students into a folder, for a course with a package of its own;
        empty for one that needs nothing but coursework.
    edition : str
        Each edition draws the variants of questions afresh: an exam, say, or another year.
    """

    root: Path
    title: str
    sources: Path
    exercises: Path
    sealed: Path
    archive: Path
    package: str = ""
    edition: str = ""


DEFAULTS = {
    "sources": "solutions",
    "exercises": "exercises",
    "sealed": "exercises/sealed",
    "archive": "build/exercises.zip",
}


def find_course(start="."):
    """The course of a folder: that of the nearest ``course.toml``, there or above.

    Raises
    ------
    AuthorError
        There is none, or it is not understood.
    """
    start = Path(start).resolve()
    for folder in (start, *start.parents):
        if (folder / FILE).is_file():
            return _read(folder / FILE)
    raise AuthorError(
        f"There is no {FILE} in {start}, nor in a folder above it. `coursework new COURSE` makes a course that has one."
    )


def edition_of(folder):
    """The edition of the course that a folder belongs to; empty where it belongs to none."""
    try:
        return find_course(folder).edition
    except AuthorError:
        return ""


def _read(path):
    try:
        said = tomllib.loads(path.read_text("utf8"))
    except ValueError as error:
        raise AuthorError(f"{path}: {error}") from None
    unknown = sorted(set(said) - {*DEFAULTS, "title", "package", "edition"})
    if unknown or not all(isinstance(value, str) for value in said.values()):
        raise AuthorError(
            f"{path}: it has texts under the names title, package, edition, {', '.join(DEFAULTS)}, and nothing else"
            + (f"; what is {unknown[0]!r}?" if unknown else ".")
        )
    places = {name: path.parent / said.get(name, default) for name, default in DEFAULTS.items()}
    others = {name: said.get(name, "") for name in ("package", "edition")}
    return Course(path.parent, said.get("title", path.parent.name), **places, **others)
