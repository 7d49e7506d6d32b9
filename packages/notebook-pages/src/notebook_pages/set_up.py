"""``python -m notebook_pages.set_up``: fetch the pinned packages that pip does not install.

npm packages (``package.json``) go into ``node_modules``, and Python packages for browsers
(``live/wheels.txt`` and ``lite/wheels.txt``) into ``.venv/runtime``, in the folder of the book or
in ``NOTEBOOK_PAGES_FETCHED``.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from .paths import FETCHED, NODE, NODE_MODULES, WEBSITE

PACKAGE, LOCK = WEBSITE / "package.json", WEBSITE / "package-lock.json"
WHEELS = [WEBSITE / place / "wheels.txt" for place in ("live", "lite")]
#: These wheels run in browsers, so the Python that downloads them does not matter.
IN_BROWSERS = (
    "--python-version",
    "3.14",
    "--platform",
    "any",
    "--implementation",
    "py",
    "--abi",
    "none",
)


def npm(*arguments, **keywords):
    program = NODE.parent.parent / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    return subprocess.run([NODE, program, *arguments], check=True, text=True, **keywords)


def fetch_packages():
    print(f"Setting up KaTeX, the typefaces and Python for browsers in {NODE_MODULES} ...")
    FETCHED.mkdir(parents=True, exist_ok=True)
    # Work in a new folder, because this one may have a package.json of its own.
    with tempfile.TemporaryDirectory(dir=FETCHED) as folder:
        for file in (PACKAGE, LOCK):
            shutil.copy(file, folder)
        # npm prints its own errors. Its cache is here because some home folders are read-only.
        quietly = ("--loglevel=error", "--no-progress", "--no-audit", "--no-fund")
        npm("ci", "--ignore-scripts", *quietly, "--cache", Path(folder, "cache"), cwd=folder)
        shutil.rmtree(NODE_MODULES, ignore_errors=True)
        Path(folder, "node_modules").rename(NODE_MODULES)


def fetch_wheels():
    runtime = FETCHED / ".venv" / "runtime"
    print(f"Setting up Python packages for browsers in {runtime} ...")
    command = [
        sys.executable,
        "-m",
        "pip",
        "download",
        "--quiet",
        "--disable-pip-version-check",
        "--no-deps",
        "--only-binary=:all:",
        *IN_BROWSERS,
        "--require-hashes",
    ]
    runtime.parent.mkdir(parents=True, exist_ok=True)
    # Replace the old wheels only when all new ones have arrived.
    with tempfile.TemporaryDirectory(dir=runtime.parent) as folder:
        for wheels in WHEELS:
            place = Path(folder, "runtime", wheels.parent.name)
            subprocess.run([*command, "--requirement", wheels, "--dest", place], check=True)
        shutil.rmtree(runtime, ignore_errors=True)
        Path(folder, "runtime").rename(runtime)


PARTS = {"packages": fetch_packages, "wheels": fetch_wheels}


def main(names):
    if unknown := set(names) - set(PARTS):
        sys.exit(
            f"cannot set up {', '.join(sorted(unknown))}; give {' or '.join(PARTS)}, or nothing "
            "for both"
        )
    for name in names or PARTS:
        try:
            PARTS[name]()
        except subprocess.CalledProcessError as error:
            sys.exit(f"Could not download what the pages need: see above (code {error.returncode})")


if __name__ == "__main__":
    main(sys.argv[1:])
