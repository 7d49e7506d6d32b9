"""The runtime folder of the site: Pyodide from npm, wheels from PyPI and our own, and a lock file.

``notebook_pages.set_up`` fetches the wheels, pinned and hash-checked; this module byte-compiles and
installs them. A wheel is compiled once, and the result is stored under the hash of its contents.
"""

import fcntl
import hashlib
import json
import os
import shutil
import subprocess
import tempfile
import zipfile
from contextlib import contextmanager
from pathlib import Path

from sphinx.errors import ConfigError

from .. import paths
from ..packing import PROJECTS
from ..paths import NODE, NODE_MODULES, PACKAGES, REPOSITORY, fingerprint
from ..take_away import FOLDER as TAKE_AWAY

HERE = Path(__file__).parent
# The folder in which the set-up puts the wheels of wheels.txt.
FETCHED = paths.FETCHED / ".venv" / "runtime" / "live"
# The folder for the wheels of lite/wheels.txt.
FETCHED_FOR_NOTEBOOKS = FETCHED.with_name("lite")
COMPILED = REPOSITORY / "_build" / "runtime"
PYODIDE = NODE_MODULES / "pyodide"
# Names in the site, with the names in npm's package. A server that does not know .mjs would not
# send it as a script.
PYODIDE_FILES = {
    "pyodide.js": "pyodide.mjs",
    "pyodide.asm.js": "pyodide.asm.mjs",
    "pyodide.asm.wasm": "pyodide.asm.wasm",
    "python_stdlib.zip": "python_stdlib.zip",
}
COMPILER = (HERE / "compile.mjs", HERE / "compile_wheels.py")

FOLDER = "runtime"
LOCK = "pyodide-lock.json"
# The book's own package, or SymPy alone. Its dependencies are everything that a page's Python
# starts with.
DISTRIBUTION = PROJECTS[-1].name if PROJECTS else "sympy"
# Wheels for the communication between moving figures and their Python, which the notebook interface
# needs as well.
WIDGETS = ("comm", "ipywidgets", "psygnal", "traitlets", "typing-extensions")
DEPENDS = {
    "sympy": ["mpmath"],
    **{
        project.name: ["sympy", *(project.name for project in PROJECTS[:number])]
        for number, project in enumerate(PROJECTS)
    },
    "anywidget": list(WIDGETS),
    "ipywidgets": ["comm", "traitlets"],
}
# PyPI has no versions of these for browsers; see the setting numpy_in_the_page.
NUMERICAL = ("numpy", "matplotlib")


def pyodide_folder():
    """Return Pyodide's place in the runtime folder; its files are named alike in each version."""
    return f"pyodide-{fingerprint(*(PYODIDE / source for source in PYODIDE_FILES.values()))}"


def sha256(content):
    return hashlib.sha256(content).hexdigest()


def size(path):
    return path.stat().st_size


def official_lock():
    """Return Pyodide's own list of packages, as npm delivers it."""
    return json.loads((PYODIDE / LOCK).read_text("utf8"))


def official_address():
    """Return the address at which the Pyodide project serves the packages of its list."""
    version = json.loads((PYODIDE / "package.json").read_text("utf8"))["version"]
    return f"https://cdn.jsdelivr.net/pyodide/v{version}/full/"


def with_dependencies(names, packages):
    """Return ``names`` and the names of all their dependencies among ``packages``."""
    names_needed, waiting = set(), list(names)
    while waiting:
        name = waiting.pop()
        if name not in names_needed:
            names_needed.add(name)
            waiting += packages[name]["depends"]
    return sorted(names_needed)


@contextmanager
def one_at_a_time():
    """Make a second process wait, so that it reuses the result of the first."""
    COMPILED.mkdir(parents=True, exist_ok=True)
    with open(COMPILED / "lock", "w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def our_packages_in(wheel):
    """Return our packages in a wheel; without any, its compiled form is the same for every book."""
    with zipfile.ZipFile(wheel) as file:
        held = {name.partition("/")[0] for name in file.namelist()}
    return [package for package in PACKAGES if package in held]


def compiled_form(wheel):
    """Return the path of a compiled wheel, whether it exists or not."""
    program = b"".join(path.read_bytes() for path in (*COMPILER, PYODIDE / "package.json"))
    digest = sha256(program + "\n".join(our_packages_in(wheel)).encode() + wheel.read_bytes())
    return COMPILED / digest[:12] / wheel.name


@one_at_a_time()
def compile_wheels(wheels):
    """Return the compiled form of each of ``wheels``, compiling those that are not in the cache."""
    compiled = {wheel: compiled_form(wheel) for wheel in wheels}
    missing = {wheel: target for wheel, target in compiled.items() if not target.exists()}
    if missing:
        with tempfile.TemporaryDirectory() as folder:
            for name in ("in", "out"):
                Path(folder, name).mkdir()
            for wheel in missing:
                shutil.copy(wheel, Path(folder, "in"))
            Path(folder, "ours.txt").write_text("\n".join(PACKAGES), "utf8")
            command = [NODE, COMPILER[0], PYODIDE / "pyodide.mjs", COMPILER[1], folder]
            subprocess.run(command, check=True)
            for wheel, target in missing.items():
                for outdated in COMPILED.glob(f"*/{wheel.name}"):
                    shutil.rmtree(outdated.parent)
                target.parent.mkdir(parents=True)
                shutil.move(Path(folder, "out", wheel.name), target)
    return list(compiled.values())


def entry(name, version, imports, file_name, digest):
    """Return the entry of a package in the lock file, in the form that Pyodide reads."""
    return {
        "name": name,
        "version": version,
        "file_name": file_name,
        "install_dir": "site",
        "sha256": digest,
        "package_type": "package",
        "imports": list(imports),
        "depends": DEPENDS.get(name, []),
    }


def own_packages(wheels, target):
    """Put ``wheels`` into the folder ``target`` and return their part of the lock file.

    Each is in a folder named by its contents, so that a browser that cached an older wheel of the
    same name does not reuse it.
    """
    packages, imports_of_ours = (
        {},
        {project.name: [Path(place).name for place in project.packages] for project in PROJECTS},
    )
    for wheel in wheels:
        content = wheel.read_bytes()
        distribution, version = wheel.name.split("-")[:2]
        name = distribution.replace("_", "-")
        place = target / "wheels" / sha256(content)[:12]
        place.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(wheel, place / wheel.name)
        imports = imports_of_ours.get(name, (name,))
        path = str((place / wheel.name).relative_to(target))
        packages[name] = entry(name, version, imports, path, sha256(content))
    return packages


def numpy_setting(stated):
    """Return the setting numpy_in_the_page.

    It is the folder in BOOK_NUMPY, or else what ``_config.yml`` has ``stated``.
    """
    return os.environ.get("BOOK_NUMPY") or stated


def numerical_packages(setting, target, official, address):
    """Return NumPy's and Matplotlib's part of the lock file: see the setting numpy_in_the_page.

    If ``setting`` is the path of a folder, the wheels that ``official`` names are copied from it.
    """
    if setting in (False, "off"):
        return {}
    packages = official["packages"]
    chosen = {name: dict(packages[name]) for name in with_dependencies(NUMERICAL, packages)}
    for package in chosen.values():
        if setting == "official":
            package["file_name"] = address + package["file_name"]
            continue
        wheel = REPOSITORY / setting / package["file_name"]
        if not wheel.is_file():
            raise ConfigError(f"numpy_in_the_page: no {package['file_name']} in {setting}")
        content = wheel.read_bytes()
        if sha256(content) != package["sha256"]:
            raise ConfigError(
                f"numpy_in_the_page: {wheel.name} in {setting} is not the official file"
            )
        place = target / "wheels" / package["sha256"][:12]
        place.mkdir(parents=True, exist_ok=True)
        (place / wheel.name).write_bytes(content)
        package["file_name"] = str((place / wheel.name).relative_to(target))
    return chosen


def write_variants(wheels, compiled, target):
    """Write the sealed variants, which ``wheels`` have and ``compiled`` lack, as separate files."""
    current = set()
    for before, after in zip(wheels, compiled, strict=True):
        with zipfile.ZipFile(before) as whole, zipfile.ZipFile(after) as rest:
            for place in rest.namelist():
                if place.endswith("/sealed/elsewhere.txt"):
                    folder, address = place.removesuffix("elsewhere.txt"), rest.read(place).decode()
                    current.add((target / address).resolve())
                    for name in whole.namelist():
                        file = target / address / name.removeprefix(folder)
                        # Their names contain a hash of the content.
                        if name.startswith(f"{folder}variants/") and not file.is_file():
                            file.parent.mkdir(parents=True, exist_ok=True)
                            file.write_bytes(whole.read(name))
    for outdated in target.glob("sealed-*/"):
        if outdated.resolve() not in current:
            shutil.rmtree(outdated)


def wheels_of_widgets():
    """Return the wheels that a moving figure's Python needs, beginning with anywidget."""
    names = [name.replace("-", "_") for name in ("anywidget", *WIDGETS)]
    return [wheel for name in names for wheel in FETCHED_FOR_NOTEBOOKS.glob(f"{name}-*.whl")]


def write(site, setting):
    """Write the runtime folder of ``site``, a folder with the built pages."""
    target = site / FOLDER
    shutil.rmtree(target / "wheels", ignore_errors=True)
    pyodide = target / pyodide_folder()
    for outdated in target.glob("pyodide*/"):
        if outdated != pyodide:
            shutil.rmtree(outdated)
    pyodide.mkdir(parents=True, exist_ok=True)
    for name, source in PYODIDE_FILES.items():
        content = (PYODIDE / source).read_bytes()
        if name.endswith(".js"):
            content = content.replace(b"pyodide.asm.mjs", b"pyodide.asm.js")
        (pyodide / name).write_bytes(content)
    own = [site / TAKE_AWAY / project.wheel_name() for project in PROJECTS]
    wheels = [*own, *sorted(FETCHED.glob("*.whl")), *wheels_of_widgets()]
    official = official_lock()
    compiled = compile_wheels(wheels)
    packages = own_packages(compiled, target)
    write_variants(own, compiled[: len(own)], target)
    packages |= numerical_packages(setting, target, official, official_address())
    first = with_dependencies([DISTRIBUTION], packages)
    loaded = [pyodide / name for name in PYODIDE_FILES]
    loaded += [target / packages[name]["file_name"] for name in first]
    lock = {
        "info": official["info"],
        "packages": packages,
        "first": DISTRIBUTION,
        "bytes": sum(map(size, loaded)),
    }
    content = json.dumps(lock, indent=1).encode()
    for outdated in target.glob("lock-*/"):
        shutil.rmtree(outdated)
    for place in (target / LOCK, target / f"lock-{sha256(content)[:12]}" / LOCK):
        place.parent.mkdir(exist_ok=True)
        place.write_bytes(content)
