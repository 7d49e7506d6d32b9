"""``python -m notebook_pages.pins``: renew every pinned version that the set-up installs, or none.

- ``constraints.txt``: the newest versions that pyproject.toml allows and that come as wheels, for
  every Python that the book supports and for every system, found by uv;
- the wheels for browsers, ``live/wheels.txt`` and ``lite/wheels.txt``: the same versions, with
  their hashes;
- ``package.json`` and ``package-lock.json``: the newest of each major version, found by npm. The
  lock file contains no addresses, so that it works with any registry.

Two things need a decision: a new major version in ``package.json``, which is made by hand there,
and a package that a wheel for browsers newly needs. The tests of ``.ci/run`` that open notebooks in
a browser fail without it; add a line with its name and version to ``lite/wheels.txt``.
"""

import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from .packing import PROJECTS
from .paths import REPOSITORY, WEBSITE
from .set_up import IN_BROWSERS, LOCK, PACKAGE, WHEELS, npm

CONSTRAINTS = REPOSITORY / "constraints.txt"
# npm packages that are not updated, with the reasons.
HELD = {"codemirror": "later versions contain an older editor, published by mistake"}


def comments(text):
    """Return the comment lines at the beginning of a list of pins."""
    return [line for line in text.splitlines() if line.startswith("#")]


def pins(text, python=None):
    """Return the versions in a list of pins by name, for this Python or another (``"3.15"``)."""
    environment = {"python_version": python, "python_full_version": f"{python}.0"} if python else {}
    stated = (
        Requirement(line.partition(" --hash")[0])
        for line in text.splitlines()
        if line.strip() and not line.startswith("#")
    )
    return {
        canonicalize_name(requirement.name): str(requirement.specifier).removeprefix("==")
        for requirement in stated
        if requirement.marker is None or requirement.marker.evaluate(environment)
    }


def resolve(*arguments):
    """Return pip's report on each package that it would install, without installing any."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder, "report.json")
        command = [
            sys.executable,
            "-m",
            "pip",
            "install",
            "--quiet",
            "--dry-run",
            "--ignore-installed",
            "--disable-pip-version-check",
            "--only-binary=:all:",
            "--report",
            report,
            *arguments,
        ]
        subprocess.run(command, check=True)
        return json.loads(report.read_text("utf8"))["install"]


def asked_for():
    """Return the requirements of this repository's projects, with extras; none on each other."""
    folders = [*(project.folder for project in PROJECTS), WEBSITE.parents[1]]
    stated = [
        tomllib.loads(Path(REPOSITORY, folder, "pyproject.toml").read_text("utf8"))["project"]
        for folder in folders
    ]
    ours = {project["name"] for project in stated}
    every = [
        requirement
        for project in stated
        for group in (project["dependencies"], *project.get("optional-dependencies", {}).values())
        for requirement in group
    ]
    return [
        requirement
        for requirement in dict.fromkeys(every)
        if Requirement(requirement).name not in ours
    ]


def constraints():
    """Return the new text of ``constraints.txt``."""
    oldest = PROJECTS[-1].about["requires-python"].removeprefix(">=")
    quiet = ("--quiet", "--no-header", "--no-annotate", "--only-binary=:all:")
    command = [sys.executable, "-m", "uv", "pip", "compile", "--universal", *quiet]
    resolved = subprocess.run(
        [*command, "--python-version", oldest, "-"],
        check=True,
        input="\n".join(asked_for()),
        stdout=subprocess.PIPE,
        text=True,
    ).stdout
    return "\n".join([*comments(CONSTRAINTS.read_text("utf8")), resolved])


def wheels(old, versions):
    """Return the new text of a list of wheels for browsers, from ``old``."""
    requirements = [
        f"{name}=={versions[name]}" if name in versions else f"{name}>={version}"
        for name, version in pins(old).items()
    ]
    with tempfile.TemporaryDirectory() as folder:
        reports = resolve(
            "--no-deps", *IN_BROWSERS, "--ignore-requires-python", "--target", folder, *requirements
        )
    by_name = {canonicalize_name(report["metadata"]["name"]): report for report in reports}
    lines = comments(old)
    for name in pins(old):
        digest = by_name[name]["download_info"]["archive_info"]["hashes"]["sha256"]
        lines.append(f"{name}=={by_name[name]['metadata']['version']} --hash=sha256:{digest}")
    return "\n".join(lines) + "\n"


def scripts():
    """Return the new texts of ``package.json`` and ``package-lock.json``."""
    package = json.loads(PACKAGE.read_text("utf8"))
    for group in ("dependencies", "devDependencies"):
        for name, version in package[group].items():
            if name not in HELD:
                newest = json.loads(
                    npm(
                        "view", f"{name}@^{version}", "version", "--json", stdout=subprocess.PIPE
                    ).stdout
                )
                package[group][name] = max(
                    [newest] if isinstance(newest, str) else newest, key=Version
                )
    with tempfile.TemporaryDirectory() as folder:
        text = json.dumps(package, indent=2, ensure_ascii=False) + "\n"
        Path(folder, PACKAGE.name).write_text(text, "utf8")
        npm(
            "install",
            "--package-lock-only",
            "--omit-lockfile-registry-resolved",
            "--ignore-scripts",
            "--no-audit",
            "--no-fund",
            "--silent",
            cwd=folder,
        )
        return text, Path(folder, LOCK.name).read_text("utf8")


def main():
    new = {CONSTRAINTS: constraints()}
    for path in WHEELS:
        new[path] = wheels(path.read_text("utf8"), pins(new[CONSTRAINTS]))
    new[PACKAGE], new[LOCK] = scripts()
    for path, text in new.items():
        changed = path.read_text("utf8") != text
        path.write_text(text, "utf8")
        print(f"{path.relative_to(REPOSITORY)}: {'updated' if changed else 'unchanged'}")
    print("Now run .ci/run")


if __name__ == "__main__":
    try:
        main()
    except subprocess.CalledProcessError as error:
        sys.exit(
            "Nothing was written, because we could not find the newest versions: see above "
            f"(code {error.returncode})"
        )
