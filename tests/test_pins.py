"""Every version that the set-up installs is exact, and lists that name the same package agree."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version
from places import REPOSITORY

from notebook_pages import pins

CONSTRAINTS = pins.pins(pins.CONSTRAINTS.read_text("utf8"))


@pytest.mark.parametrize("path", pins.WHEELS, ids=lambda path: path.parent.name)
def test_wheels_for_browsers_are_those_of_the_book(path):
    text = path.read_text("utf8")
    for name, version in pins.pins(text).items():
        assert CONSTRAINTS.get(name, version) == version, name
        assert re.search(
            rf"^{name}=={re.escape(version)} --hash=sha256:[0-9a-f]{{64}}$", text, re.M
        ), name


def test_the_lock_of_npm_names_no_address():
    text = pins.LOCK.read_text("utf8")
    assert '"resolved"' not in text and "://" not in re.sub(
        r'"funding": (".*"|{[^}]*}|\[[^]]*\])', "", text
    )
    stated, locked = json.loads(pins.PACKAGE.read_text("utf8")), json.loads(text)["packages"]
    for name, version in (stated["dependencies"] | stated["devDependencies"]).items():
        assert locked[f"node_modules/{name}"]["version"] == version, name
        assert locked[f"node_modules/{name}"]["integrity"].startswith("sha512-"), name


def report(name, version):
    archive = {"hashes": {"sha256": f"{len(name):064x}"}}
    return {
        "metadata": {"name": name, "version": version},
        "download_info": {"archive_info": archive},
    }


def test_wheels_are_renewed_to_the_versions_of_the_book(monkeypatch):
    asked = []

    def resolve(*arguments):
        asked.extend(arguments)
        return [report("IPython", "9.99"), report("micropip", "0.12")]

    monkeypatch.setattr(pins, "resolve", resolve)
    old = "# Why.\nipython==9.18.1 --hash=sha256:0\nmicropip==0.11.1 --hash=sha256:0\n"
    text = pins.wheels(old, {"ipython": "9.99"})
    assert "ipython==9.99" in asked and "micropip>=0.11.1" in asked
    assert (
        text
        == f"# Why.\nipython==9.99 --hash=sha256:{7:064x}\nmicropip==0.12 --hash=sha256:{8:064x}\n"
    )


def test_without_a_network_nothing_is_renewed(tmp_path):
    done = subprocess.run(
        ["env", "UV_OFFLINE=1", f"UV_CACHE_DIR={tmp_path}", sys.executable, "-m", pins.__name__],
        capture_output=True,
        text=True,
    )
    assert "Nothing was written" in done.stderr and "Traceback" not in done.stderr, done.stderr


@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13", "3.14", "3.15"])
def test_one_set_of_pins_serves_every_python(python):
    """For 3.15 four pins once had no wheels, since 3.11 held them back."""
    text = pins.CONSTRAINTS.read_text("utf8")
    pinned = pins.pins(text, python)
    for requirement in map(Requirement, pins.asked_for()):
        version = pinned[canonicalize_name(requirement.name)]
        assert requirement.specifier.contains(version), f"{requirement} is pinned to {version}"
    newer = [Version(pinned[name]) for name in ("numpy", "scipy", "contourpy", "pyyaml")]
    if python == "3.15":
        assert newer >= [Version(text) for text in ("2.5", "1.18", "1.4", "6.0.4")]
    assert "://" not in text


def newer_pythons():
    """Iterate over this machine's newer Pythons that the pins support, the newest last."""
    for minor in range(sys.version_info.minor + 1, 16):
        program = shutil.which(f"python3.{minor}")
        yield from [program] if program else []  # which may be a name without a working Python
        yield from sorted(Path.home().glob(f".pyenv/versions/3.{minor}.*/bin/python"))


@pytest.mark.long
def test_a_newer_python_needs_no_compiler(tmp_path):
    """QuickJS once had no wheel past 3.12: the set-up ended in "No such file: gcc"."""
    answering = [
        program
        for program in newer_pythons()
        if subprocess.run([program, "-c", ""], capture_output=True).returncode == 0
    ]
    if not answering:
        pytest.skip("there is no newer Python here")
    subprocess.run([answering[-1], "-m", "venv", tmp_path / "newer"], check=True)
    command = [
        tmp_path / "newer" / "bin" / "python",
        "-m",
        "pip",
        "install",
        "--dry-run",
        "--only-binary=:all:",
        "--quiet",
        "--constraint",
        pins.CONSTRAINTS,
    ]
    done = subprocess.run([*command, *pins.asked_for()], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]


def test_every_command_that_is_named_exists():
    """`make renew-pins` was once named where updates are switched off, and did not exist."""
    targets = set(re.findall(r"^([a-z-]+):", (REPOSITORY / "Makefile").read_text("utf8"), re.M))
    names = [
        "README.md",
        "CONTRIBUTING.md",
        "Makefile",
        ".ci/run",
        ".pre-commit-config.yaml",
        "appendix/instructors.md",
    ]
    for path in [*(REPOSITORY / name for name in names), *(REPOSITORY / ".github").rglob("*.yml")]:
        for named in re.findall(r"(?:`|run: |\n)make ([a-z-]+)", path.read_text("utf8")):
            assert named in targets, f"{path.relative_to(REPOSITORY)} names `make {named}`"


def test_every_program_that_is_named_exists():
    """`python -m benchmarks.grading` was once named where it does not run."""
    roots = [REPOSITORY, REPOSITORY / "src", *REPOSITORY.glob("packages/*/src")]
    documents = [*REPOSITORY.glob("*.md"), *REPOSITORY.glob("*/*.md"), REPOSITORY / "Makefile"]
    scripts = (REPOSITORY / "tools").rglob("*.py")
    for path in [*documents, *scripts]:
        for name in re.findall(r"python -m\s+([a-z_]+(?:\.[a-z_]+)*)", path.read_text("utf8")):
            places = [root.joinpath(*name.split(".")) for root in roots]
            assert name in ("pip", "venv", "pytest") or any(
                place.with_suffix(".py").is_file() or (place / "__main__.py").is_file()
                for place in places
            ), f"{path.relative_to(REPOSITORY)} names `python -m {name}`"
