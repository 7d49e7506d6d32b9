"""Plug-ins of courses, with further kinds of questions and sealed questions.

A plug-in is a module that an installed distribution names in its entry points:

.. code-block:: toml

    [project.entry-points."coursework.plugins"]
    orientation = "orientation_course"

Its folder ``sealed``, if it has one, contains sealed questions. It may define these names:

``KINDS``
    A `coursework.checking.kind.Kind` for each further kind of question, by its name.
``DEEDS``
    What students did, for the instructor's report, by the note of a mistake: ``"conjugate": "gave
    the conjugate"``.
``CLOSED``
    The number of possible answers for each kind of question that has only a few, by its name.
``PACKAGES``
    The names of the packages that the course's notebooks import, which grading must have.
"""

import functools
import importlib.util
from collections.abc import Iterable
from importlib import metadata, resources
from importlib.resources.abc import Traversable
from types import ModuleType

# Plug-ins import it from here.
from .kind import Kind as Kind
from .kinds import KINDS
from .question import Question

GROUP = "coursework.plugins"


@functools.cache
def plugins() -> list[ModuleType]:
    """Return the plug-ins of all installed distributions.

    Raises
    ------
    RuntimeError
        One of them cannot be imported; the message says which.
    """
    modules = []
    for entry in sorted(metadata.entry_points(group=GROUP)):
        try:
            modules.append(entry.load())
        except Exception as error:
            brought = (
                f", which {entry.dist.name} {entry.dist.version} provides for coursework,"
                if entry.dist
                else ""
            )
            raise RuntimeError(
                f"The plug-in {entry.name!r} ({entry.value}){brought} cannot be loaded: "
                f"{type(error).__name__}: {error}"
            ) from error
    return modules


@functools.cache
def kinds() -> dict[str, Kind]:
    """Return all kinds of questions, by name."""
    all_kinds = dict(KINDS)
    for plugin in plugins():
        for name, kind in getattr(plugin, "KINDS", {}).items():
            if name in all_kinds:
                raise RuntimeError(
                    f"{plugin.__name__} provides a kind of question named {name!r}, but another "
                    "kind already has that name."
                )
            all_kinds[name] = kind
    return all_kinds


def kind_of_values(question: Question) -> Kind:
    """Return the kind of the compared values; for a function, that of its results."""
    return kinds()[question.kind_of_values]


def packages() -> list[str]:
    """Return the names of the plug-ins and of the packages that installed courses import."""
    names = []
    for plugin in plugins():
        names += [plugin.__name__.partition(".")[0], *getattr(plugin, "PACKAGES", ())]
    return list(dict.fromkeys(names))


def folders_of(names: Iterable[str]) -> list[str]:
    """Return the folders of the packages that are installed."""
    specs = [importlib.util.find_spec(name) for name in names]
    return [folder for spec in specs if spec for folder in spec.submodule_search_locations or ()]


def sealed_folders() -> list[Traversable]:
    """Return the folders of sealed questions in plug-ins."""
    folders = [resources.files(plugin) / "sealed" for plugin in plugins()]
    return [folder for folder in folders if folder.is_dir()]
