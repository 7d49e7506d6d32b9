"""Byte-compile every wheel in /wheels/in into /wheels/out; runs inside Pyodide.

Importing SymPy from its sources takes the browser twice as long as from byte code. Unneeded files
are left out, and so are the sources of third-party packages, which would double the download. Our
own sources stay, because error messages show their lines.
"""

import hashlib
import importlib.util
import sys
import sysconfig
import warnings
import zipfile
from importlib._bootstrap_external import _code_to_hash_pyc
from pathlib import Path

SITE = sysconfig.get_path("purelib")
OURS = tuple(f"{name}/" for name in Path("/wheels/ours.txt").read_text("utf8").split())
# The sealed variants are fetched individually, because a reader needs few of them. This file lists
# where they are.
APART = "/sealed/variants/"
ELSEWHERE = "/sealed/elsewhere.txt"
# Files that no browser needs: tests, and Jedi's data on 200 packages for completing names.
LEFT_OUT = (APART, "/tests/", "jedi/third_party/typeshed/stubs/", "jedi/third_party/django-stubs/")
# The same sources give the same bytes.
THE_SAME_DATE = (1980, 1, 1, 0, 0, 0)


def compiled(name, source):
    """Return the files that replace one file of a wheel, contents by name."""
    if not name.endswith(".py"):
        return {name: source}
    code = compile(source, f"{SITE}/{name}", "exec", dont_inherit=True)
    # "Unchecked": Python accepts the byte code whatever date the unpacked source has.
    byte_code = bytes(_code_to_hash_pyc(code, importlib.util.source_hash(source), False))
    if not name.startswith(OURS):
        return {name + "c": byte_code}
    folder, _, file = name.rpartition("/")
    return {
        name: source,
        f"{folder}/__pycache__/{file[:-3]}.{sys.implementation.cache_tag}.pyc": byte_code,
    }


def place_of_variants(wheel):
    """Return the file that says where the sealed variants are.

    Their address depends on their contents.
    """
    names = sorted(name for name in wheel.namelist() if APART in name)
    digest = hashlib.sha256(
        b"".join(name.encode() + wheel.read(name) for name in names)
    ).hexdigest()
    return {
        name.partition(APART)[0] + ELSEWHERE: f"sealed-{digest[:12]}/".encode() for name in names
    }


def compile_wheel(path, target):
    with zipfile.ZipFile(path) as wheel:
        files = place_of_variants(wheel)
        for name in wheel.namelist():
            if not any(part in name for part in LEFT_OUT) and not name.endswith(
                (".dist-info/RECORD", "/")
            ):
                files |= compiled(name, wheel.read(name))
        (record,) = (name for name in wheel.namelist() if name.endswith(".dist-info/RECORD"))
    # The hashes of single files do not compress and are left out; the lock file has the wheel's
    # hash.
    files[record] = "".join(f"{name},,\n" for name in [*files, record]).encode()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as wheel:
        for name, content in files.items():
            wheel.writestr(zipfile.ZipInfo(name, THE_SAME_DATE), content, zipfile.ZIP_DEFLATED, 9)


# These warnings are for the packages' authors.
warnings.simplefilter("ignore", SyntaxWarning)
for path in sorted(Path("/wheels/in").glob("*.whl")):
    compile_wheel(path, Path("/wheels/out") / path.name)
