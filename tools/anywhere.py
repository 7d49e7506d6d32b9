"""Compare the book's numbers with those of other processors.

``python -m tools.anywhere`` runs every cell, every release and every doctest as other processors
would: with each kernel of OpenBLAS, without the instructions that NumPy would not have there, on
one thread and on many. A table shows which numbers changed and by how much. The Python of browsers
is left to ``tests/pages/test_live.py``, which compares each page's results with the stored ones.
"""

import argparse
import ctypes
import json
import math
import os
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import nbformat
from nbclient import NotebookClient

from coursework.authoring.course import find_course
from coursework.authoring.source import notebooks_in
from notebook_pages.execution import STORED
from notebook_pages.moves import moves_of_outputs
from notebook_pages.notebooks import all_notebooks
from notebook_pages.paths import REPOSITORY
from notebook_pages.warm_kernels import WarmAsyncKernelManager

from .released import digests_of

#: Kernels of OpenBLAS, oldest first. Each has the instructions that NumPy would use here but a
#: processor of that age lacks.
KERNELS = {
    "Prescott": ("X86_V3", "X86_V4", "AVX512_ICL", "AVX512_SPR"),
    "Nehalem": ("X86_V3", "X86_V4", "AVX512_ICL", "AVX512_SPR"),
    "Haswell": ("X86_V4", "AVX512_ICL", "AVX512_SPR"),
    "SkylakeX": (),
}
#: The instructions that SkylakeX needs.
NEEDED = "X86_V4"
#: OpenBLAS reports this kernel under an older processor's name.
CALLED = {"Prescott": "Katmai"}
#: OpenBLAS divides sums among threads, which adds them in another order.
THREADS = {"one thread": "1", "four threads": "4"}
DOCTESTS = (
    "src/orientation",
    "packages/orientation-lab/src/orientation_figures",
    "packages/orientation-lab/src/orientation_recordings",
    "packages/coursework/src/coursework",
)


# --- on one machine -----------------------------------------------------------------------------


def numbers_here(only):
    """Return the numbers of this process: moves of cells, failed doctests, digests of releases."""
    return {
        "kernel": kernel_in_use(),
        "cells": moves_of_cells(only),
        "doctests": failed_doctests(),
        "released": digests_of_releases(only),
    }


def kernel_in_use():
    """Return the kernel that NumPy's OpenBLAS reports, or nothing if NumPy uses another library."""
    # Importing NumPy loads the library.
    import numpy

    for file in Path(numpy.__file__).parent.with_name("numpy.libs").glob("*openblas*"):
        name = ctypes.CDLL(str(file)).scipy_openblas_get_corename64_
        name.restype = ctypes.c_char_p
        return name().decode()
    return ""


def notebooks(only):
    paths = [*all_notebooks(REPOSITORY), *sorted(REPOSITORY.glob(f"{STORED}*.ipynb"))]
    return [path for path in paths if not only or path.stem in only]


def moves_of_cells(only):
    # Each notebook runs in a process of its own, which forks kernels.
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        return [
            move
            for moves_of_notebook in pool.map(moves_in, notebooks(only))
            for move in moves_of_notebook
        ]


def moves_in(path):
    """Run a notebook; return each move as its place, its description, and its relative size."""
    stored, now = (nbformat.read(path, as_version=4) for _ in range(2))
    NotebookClient(
        now,
        timeout=600,
        allow_errors=True,
        coalesce_streams=True,
        kernel_manager_class=WarmAsyncKernelManager,
        resources={"metadata": {"path": str(path.parent)}},
    ).execute()
    cells = [pair for pair in zip(stored.cells, now.cells) if pair[0].cell_type == "code"]
    return [
        move
        for number, (before, after) in enumerate(cells)
        if before.execution_count is not None
        for move in in_words(
            place_of(path, number), moves_of_outputs(before.outputs, after.outputs)
        )
    ]


def place_of(path, number):
    return f"{path.relative_to(REPOSITORY).with_suffix('')}, cell {number}"


def in_words(place, number_moves):
    if number_moves is None:
        return [(place, "outputs that differ from the stored ones", math.inf)]
    # Releases are compared byte by byte.
    exact = place.startswith(STORED)
    return [(place, str(move), math.inf if exact else move.share) for move in number_moves]


def failed_doctests():
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "--doctest-modules",
            "-q",
            "-p",
            "no:cacheprovider",
            "-o",
            "addopts=",
            *DOCTESTS,
        ],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
    )
    failed = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed or ([done.stdout + done.stderr] if done.returncode else [])


def digests_of_releases(only):
    """Return digests of the release of each notebook and each variant, before the slow hash."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        return {
            name: digest
            for digests in pool.map(digests_of, sources(only))
            for name, digest in digests.items()
        }


def sources(only):
    return [
        path
        for path in notebooks_in(find_course(REPOSITORY).sources)
        if not only or path.stem in only
    ]


# --- on all of them -----------------------------------------------------------------------------


def machines():
    """Return the machines that this processor can emulate, with their environment, and the rest."""
    import numpy._core._multiarray_umath as umath

    has = {name for name, there in umath.__cpu_features__.items() if there}
    possible, impossible = {"as it is": {}}, {}
    for kernel, lacking in KERNELS.items():
        if kernel == "SkylakeX" and NEEDED not in has:
            impossible[kernel] = "this processor has no AVX-512"
            continue
        disabled = " ".join(name for name in lacking if name in has)
        for words, threads in THREADS.items():
            possible[f"{kernel}, {words}"] = {
                "OPENBLAS_CORETYPE": kernel,
                "OPENBLAS_NUM_THREADS": threads,
                **({"NPY_DISABLE_CPU_FEATURES": disabled} if disabled else {}),
            }
    return possible, impossible


def numbers_of(environment, only):
    done = subprocess.run(
        [sys.executable, "-m", __spec__.name, "--here", *only],
        cwd=REPOSITORY,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "only",
        nargs="*",
        help="names of the notebooks to run (default: all)",
    )
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.here:
        print(json.dumps(numbers_here(options.only)))
        return
    possible, impossible = machines()
    faults, first = [], None
    print(
        "| machine | cells that changed | largest change | doctests that fail "
        "| releases that differ |"
    )
    print("| --- | ---: | --- | ---: | ---: |")
    for name, environment in possible.items():
        results = numbers_of(environment, options.only)
        requested = environment.get("OPENBLAS_CORETYPE")
        if requested and results["kernel"] not in ("", requested, CALLED.get(requested)):
            faults.append(f"{name}: OpenBLAS has chosen {results['kernel']}")
        first = first or results["released"]
        others = [name for name, known in results["released"].items() if first.get(name) != known]
        print(row(name, results["cells"], results["doctests"], others), flush=True)
        faults += [
            f"{name}: {place}: {words}" for place, words, share in results["cells"] if share > 1
        ]
        faults += [f"{name}: {line}" for line in results["doctests"]]
        faults += [
            f"{name}: the release of {notebook} differs from the one on this machine as it is"
            for notebook in others
        ]
    for name, why in impossible.items():
        print(f"| {name} | not tried: {why} | | | |")
    sys.exit("\n".join(faults) or 0)


def row(name, moved, doctests, released):
    places = defaultdict(list)
    for place, words, _ in moved:
        places[place].append(words)
    largest = max(moved, key=lambda move: move[2], default=("", "", 0))
    largest_move = f"{largest[0]}: {largest[1]}" if moved else ""
    return f"| {name} | {len(places)} | {largest_move} | {len(doctests)} | {len(released)} |"


if __name__ == "__main__":
    main()
