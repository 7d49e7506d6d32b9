"""The versions of all that answers and marks may depend on."""

import functools
import hashlib
import platform
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

from ..checking.plugins import folders_of, packages


def folders() -> list[Path]:
    """The folders of this package and of those that a course brings.

    A changed line in any changes how somebody is judged, and then everybody is judged again.
    """
    return [Path(__file__).parents[1], *map(Path, folders_of(packages()))]


@functools.cache
def software() -> dict[str, str]:
    """The versions, by name; this package and those of the course are told by all their code."""
    return {
        "python": platform.python_version(),
        **{name: metadata.version(name) for name in ("sympy", "mpmath", "numpy", "matplotlib")},
        "coursework": digest_of_packages(),
    }


def digest_of_packages(of: Iterable[Path] = ()) -> str:
    """A short text that follows from every line of code of the packages."""
    digest = hashlib.sha256()
    for package in of or folders():
        for path in sorted(package.rglob("*.py")):
            code = path.read_bytes()
            digest.update(f"{path.relative_to(package)} {len(code)} ".encode() + code)
    return digest.hexdigest()[:16]
