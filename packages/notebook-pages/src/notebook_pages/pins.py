"""``python -m notebook_pages.pins``: renew every exact version that the
set-up installs, all of them or none.

- ``constraints.txt``: the newest versions that pyproject.toml allows and that come as wheels, for
  every Python that the book supports and for every system, found by uv;
- the wheels for browsers, ``live/wheels.txt`` and ``lite/wheels.txt``: the same versions, with
  their hashes;
- ``package.json`` and ``package-lock.json``: the newest of each major version, found by npm. The
  lock names no
  addresses, so that it serves whoever has another registry.

A new major version in ``package.json``, or a package that a wheel for browsers newly needs, is a
decision: the first is made by hand there, the second is told here.
"""

import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from packaging.markers import default_environment
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from .packing import PROJECTS
from .paths import REPOSITORY, WEBSITE
from .set_up import IN_BROWSERS, LOCK, PACKAGE, WHEELS, npm

CONSTRAINTS = REPOSITORY / "constraints.txt"
#: npm packages that are not updated, with the reasons.
HELD = {"codemirror": "later numbers hold an older editor, published by mistake"}
#: Front ends, which wheels for browsers require and do not get, since JupyterLite has its own.
NOT_IN_BROWSERS = {"jupyterlab-widgets", "widgetsnbextension"}


def comments(text):
    """The lines of comment that a list of pins begins with."""
    return [line for line in text.splitlines() if line.startswith("#")]


def pins(text, python=None):
    """The versions in a list of pins, by name: on this Python, or on another such as ``"3.15"``."""
    environment = {"python_version": python, "python_full_version": f"{python}.0"} if python else {}
    stated = (
        Requirement(line.partition(" --hash")[0])
        for line in text.splitlines()
        if line.strip() and not line.startswith("#")
    )
    return {
        canonicalize_name(one.name): str(one.specifier).removeprefix("==")
        for one in stated
        if one.marker is None or one.marker.evaluate(environment)
    }


def resolve(*arguments):
    """List pip's reports on each package that it would install, without installing any."""
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
        ]
        command += [
            "--disable-pip-version-check",
            "--only-binary=:all:",
            "--report",
            report,
            *arguments,
        ]
        subprocess.run(command, check=True)
        return json.loads(report.read_text("utf8"))["install"]


def asked_for():
    """What the projects of this repository ask for, each with all
    its extras, but for one another.
    """
    folders = [*(project.folder for project in PROJECTS), WEBSITE.parents[1]]
    stated = [
        tomllib.loads(Path(REPOSITORY, folder, "pyproject.toml").read_text("utf8"))["project"]
        for folder in folders
    ]
    ours = {project["name"] for project in stated}
    every = [
        one
        for project in stated
        for group in (project["dependencies"], *project.get("optional-dependencies", {}).values())
        for one in group
    ]
    return [one for one in dict.fromkeys(every) if Requirement(one).name not in ours]


def constraints():
    """The new text of ``constraints.txt``."""
    oldest = PROJECTS[-1].about["requires-python"].removeprefix(">=")
    quiet = ("--quiet", "--no-header", "--no-annotate", "--only-binary=:all:")
    command = [sys.executable, "-m", "uv", "pip", "compile", "--universal", *quiet]
    found = subprocess.run(
        [*command, "--python-version", oldest, "-"],
        check=True,
        input="\n".join(asked_for()),
        stdout=subprocess.PIPE,
        text=True,
    ).stdout
    return "\n".join([*comments(CONSTRAINTS.read_text("utf8")), found])


def wheels(old, versions):
    """The new text of a list of wheels for browsers, whose old text is
    ``old``, and what pip reports of each.
    """
    wanted = [
        f"{name}=={versions[name]}" if name in versions else f"{name}>={version}"
        for name, version in pins(old).items()
    ]
    with tempfile.TemporaryDirectory() as folder:
        reports = resolve(
            "--no-deps", *IN_BROWSERS, "--ignore-requires-python", "--target", folder, *wanted
        )
    found = {canonicalize_name(one["metadata"]["name"]): one for one in reports}
    lines = comments(old)
    for name in pins(old):
        digest = found[name]["download_info"]["archive_info"]["hashes"]["sha256"]
        lines.append(f"{name}=={found[name]['metadata']['version']} --hash=sha256:{digest}")
    return "\n".join(lines) + "\n", reports


def missing(reports):
    """Return a sentence for each package that wheels for browsers need and no list has."""
    browser = default_environment() | {
        "python_version": "3.14",
        "python_full_version": "3.14.0",
        "sys_platform": "emscripten",
        "platform_system": "Emscripten",
    }
    there = {canonicalize_name(one["metadata"]["name"]) for one in reports} | NOT_IN_BROWSERS
    for one in reports:
        for requirement in map(Requirement, one["metadata"].get("requires_dist", ())):
            needed = requirement.marker is None or requirement.marker.evaluate(
                browser | {"extra": ""}
            )
            if needed and canonicalize_name(requirement.name) not in there:
                yield (
                    f"{one['metadata']['name']} {one['metadata']['version']} needs "
                    f"{requirement.name}"
                )


def scripts():
    """The new texts of ``package.json`` and ``package-lock.json``."""
    wanted = json.loads(PACKAGE.read_text("utf8"))
    for group in ("dependencies", "devDependencies"):
        for name, version in wanted[group].items():
            if name not in HELD:
                found = json.loads(
                    npm(
                        "view", f"{name}@^{version}", "version", "--json", stdout=subprocess.PIPE
                    ).stdout
                )
                wanted[group][name] = max([found] if isinstance(found, str) else found, key=Version)
    with tempfile.TemporaryDirectory() as folder:
        text = json.dumps(wanted, indent=2, ensure_ascii=False) + "\n"
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
    new, reports = {CONSTRAINTS: constraints()}, []
    for path in WHEELS:
        new[path], found = wheels(path.read_text("utf8"), pins(new[CONSTRAINTS]))
        reports += found
    new[PACKAGE], new[LOCK] = scripts()
    if untold := list(missing(reports)):
        sys.exit(
            "Nothing was written. In browsers "
            + "; ".join(untold)
            + ": add a line with its name and version to notebook_pages/lite/wheels.txt, then try "
            "again."
        )
    for path, text in new.items():
        changed = path.read_text("utf8") != text
        path.write_text(text, "utf8")
        print(f"{path.relative_to(REPOSITORY)}: {'renewed' if changed else 'unchanged'}")
    print("Now: .ci/run")


if __name__ == "__main__":
    main()
