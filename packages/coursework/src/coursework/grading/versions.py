"""The versions of everything that answers and marks may depend on."""

import functools
import hashlib
import platform
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

from ..checking.plugins import folders_of, packages


def folders() -> list[Path]:
    """Return the folders of this package and of a course's own packages.

    A changed line in any of them may change marks, so everybody is judged again.
    """
    return [Path(__file__).parents[1], *map(Path, folders_of(packages()))]


@functools.cache
def software() -> dict[str, str]:
    """Return the versions by name, with a digest of all code of this package and the course's."""
    return {
        "python": platform.python_version(),
        **{name: metadata.version(name) for name in ("sympy", "mpmath", "numpy", "matplotlib")},
        "coursework": digest_of_packages(),
    }


def digest_of_packages(of: Iterable[Path] = ()) -> str:
    """Return a digest of all code of the packages."""
    digest = hashlib.sha256()
    for package in of or folders():
        for path in sorted(package.rglob("*.py")):
            code = path.read_bytes()
            digest.update(f"{path.relative_to(package)} {len(code)} ".encode() + code)
    return digest.hexdigest()[:16]
