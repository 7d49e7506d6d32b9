"""The command ``publish``: a course's site, by a package that makes pages from notebooks.

Such a package registers itself by an entry point and receives only files: notebooks, wheels and an
archive. Neither package thus needs to know the other:

.. code-block:: toml

    [project.entry-points."coursework.pages"]
    name = "module:function"

``function(parts, workshop, site)`` makes the folder ``site``, and may work in the folder
``workshop``. ``parts`` is the dictionary that `parts_of` returns. The function must refuse formats
that it does not know.
"""

import re
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import TypedDict

from .author import AuthorError
from .course import Course
from .packing import archive, dated, own_wheels, wheel, write_wheel

GROUP = "coursework.pages"
#: The version of the format of `Parts`.
FORMAT = 1


class Parts(TypedDict):
    """The input of a function that makes the pages.

    Attributes
    ----------
    format : int
    title : str
    notebooks : list of Path
        The files that students get, in order.
    archive : Path
        The zip file with all of them.
    wheels : list of Path
        The packages that they import, each after those that it needs.
    plugin : str
        The module among them that contains the sealed questions; empty if the course has a package
        of its own.
    """

    format: int
    title: str
    notebooks: list[Path]
    archive: Path
    wheels: list[Path]
    plugin: str


def publish(course: Course, site: str | Path) -> Path:
    """Make the site of a course.

    Parameters
    ----------
    course : Course
    site : path
        The folder to make. A folder with anything but an earlier site is left alone.

    Returns
    -------
    Path
        The front page.

    Raises
    ------
    AuthorError
        No package that makes pages is installed, or it failed, or the course has no exercises.
    """
    site = Path(site).resolve()
    make = _maker()
    if site.exists() and any(site.iterdir()) and not (site / "index.html").is_file():
        raise AuthorError(
            f"{site} contains files but no index.html, so it is not a site. We changed nothing. "
            "Give another folder with --site."
        )
    if not any(course.exercises.glob("*.ipynb")):
        raise AuthorError(
            f"There are no exercises in {course.exercises}. Build them with `coursework release`."
        )
    with tempfile.TemporaryDirectory() as folder:
        parts = parts_of(course, folder)
        try:
            make(parts, course.archive.with_name("book"), site)
        except (RuntimeError, ValueError) as error:
            raise AuthorError(str(error)) from None
    return site / "index.html"


def parts_of(course: Course, folder: str | Path) -> Parts:
    """Return the parts from which the pages of a course are built."""
    if course.package:
        wheels, plugin = own_wheels(course, folder), ""
    else:
        plugin = re.sub(r"[^a-z0-9]+", "_", course.title.lower()).strip("_") + "_questions"
        wheels = [wheel("coursework-checks", folder), questions_wheel(course, plugin, folder)]
    return {
        "format": FORMAT,
        "title": course.title,
        "notebooks": sorted(course.exercises.glob("*.ipynb")),
        "archive": archive(course),
        "wheels": wheels,
        "plugin": plugin,
    }


def questions_wheel(course: Course, module: str, folder: str | Path) -> Path:
    """Build a package of the course's sealed questions, which ``check`` finds when installed."""
    sealed = sorted(course.sealed.rglob("*.json"))
    version = dated("1.0", f"{module}-1.0", course.sealed, files=sealed)
    return write_wheel(
        folder,
        module.replace("_", "-"),
        version,
        f"Sealed questions of {course.title}",
        ["coursework-checks"],
        {f"{module}/__init__.py": b""}
        | {
            f"{module}/sealed/{path.relative_to(course.sealed).as_posix()}": path.read_bytes()
            for path in sealed
        },
        f"[coursework.plugins]\n{module} = {module}\n",
    )


def _maker() -> Callable[[Parts, Path, Path], None]:
    offers = tuple(metadata.entry_points(group=GROUP))
    if not offers:
        raise AuthorError(
            "Publishing needs notebook-pages. Install it from its folder in the repository of "
            "coursework, then run `python -m notebook_pages.set_up` to download its parts."
        )
    make: Callable[[Parts, Path, Path], None] = offers[0].load()
    return make
