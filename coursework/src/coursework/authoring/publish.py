"""``coursework publish``: a site of a course, made by a package that makes pages from notebooks.

Such a package offers itself by an entry point, and gets nothing but files: notebooks, wheels, an
archive. So neither needs to know the other:

.. code-block:: toml

    [project.entry-points."coursework.pages"]
    name = "module:function"

``function(parts, workshop, site)`` makes the folder ``site``, and may work in the folder
``workshop``. ``parts`` is what :func:`parts_of` describes, or a later format of it, which it must
refuse.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from importlib import import_module, metadata
from pathlib import Path

from .author import AuthorError
from .packing import archive, dated, wheel, write_wheel

GROUP = "coursework.pages"
#: Of what is handed to whoever makes the pages.
FORMAT = 1


def publish(course, site, room=False):
    """Make the site of a course.

    Parameters
    ----------
    course : Course
    site : path
        The folder to make; one that holds something else than an earlier site is left alone.
    room : bool
        Also fetch all wheels that the exercises need, for a room without a network.

    Returns
    -------
    Path
        The front page.

    Raises
    ------
    AuthorError
        Nothing that makes pages is installed, or it failed, or the course has no exercises.
    """
    site = Path(site).resolve()
    make = _maker()
    if site.exists() and any(site.iterdir()) and not (site / "index.html").is_file():
        raise AuthorError(f"{site} holds something that is no site; nothing was changed.")
    if not any(course.exercises.glob("*.ipynb")):
        raise AuthorError(
            f"There are no exercises in {course.exercises}: `coursework release` makes them."
        )
    with tempfile.TemporaryDirectory() as folder:
        parts = parts_of(course, folder)
        try:
            make(parts, course.archive.with_name("book"), site)
        except (RuntimeError, ValueError) as error:
            raise AuthorError(str(error)) from None
        if room:
            _fetch_wheels(parts["archive"], site / "wheels")
    return site / "index.html"


def parts_of(course, folder):
    """What the pages of a course are made from.

    Returns
    -------
    dict
        ``format``; ``title``; ``notebooks``, the files that students get, in their order;
        ``archive``, the zip with all of them; ``wheels``, the files of the packages that they
        import, each after those that it needs; ``plugin``, the module among them that holds the
        sealed questions.
    """
    if course.package:
        module, _, function = course.package.partition(":")
        wheels, plugin = list(getattr(import_module(module), function)(folder)), ""
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


def questions_wheel(course, module, folder):
    """The sealed questions of a course as a package that ``check`` finds wherever it is
    installed.
    """
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


def _maker():
    offers = list(metadata.entry_points(group=GROUP))
    if not offers:
        raise AuthorError(
            "Nothing here makes pages from notebooks. Install notebook-pages beside coursework, "
            "from its folder in the "
            "repository of coursework; `python -m notebook_pages.set_up` then fetches what pages "
            "are made with."
        )
    if len(offers) > 1:
        named = " and ".join(f"{one.dist.name} ({one.value})" for one in offers)
        raise AuthorError(
            f"More than one package makes pages: {named}. Leave one of them installed."
        )
    return offers[0].load()


def _fetch_wheels(archive, target):
    with tempfile.TemporaryDirectory() as folder:
        shutil.unpack_archive(archive, folder)
        command = [
            sys.executable,
            "-m",
            "pip",
            "download",
            "--quiet",
            "--disable-pip-version-check",
            "--only-binary=:all:",
        ]
        done = subprocess.run(
            [*command, "--dest", target, "--requirement", "requirements.txt"],
            cwd=Path(folder, "exercises"),
        )
    if done.returncode:
        raise AuthorError("pip could not fetch all wheels: see above. The pages are made.")
