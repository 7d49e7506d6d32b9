"""The linter, the formatter and the type checker find nothing."""

import inspect
import subprocess
import sys

import pytest
from places import REPOSITORY

import coursework
import orientation


@pytest.mark.parametrize(
    "command",
    [
        ("ruff", "check", "."),
        ("ruff", "format", "--check", "."),
        ("mypy", "--cache-dir", "_build/mypy"),
    ],
    ids=["linter", "formatter", "types"],
)
def test_tools_find_nothing(command):
    done = subprocess.run(
        [sys.executable, "-m", *command], cwd=REPOSITORY, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def public_functions():
    """Iterate over the public functions and methods, by their full names."""
    for package in (orientation, coursework):
        for name in package.__all__:
            value = getattr(package, name)
            if inspect.isfunction(value):
                yield f"{package.__name__}.{name}", value
            elif inspect.isclass(value) and not issubclass(value, (tuple, Exception)):
                for inner, method in vars(value).items():
                    if inspect.isfunction(method) and not inner.startswith("_"):
                        yield f"{package.__name__}.{name}.{inner}", method


@pytest.mark.parametrize(
    "name, function", [pytest.param(*pair, id=pair[0]) for pair in public_functions()]
)
def test_public_functions_say_what_they_take_and_give(name, function):
    signature = inspect.signature(function)
    untold = [
        parameter.name
        for parameter in signature.parameters.values()
        if parameter.annotation is parameter.empty and parameter.name != "self"
    ]
    assert not untold, f"{name} does not say what {', '.join(untold)} may be"
    assert signature.return_annotation is not signature.empty, f"{name} does not say what it gives"
