"""One table of ratios, all measured in this run: ``python -m tools.benchmarks``.

The other modules here are programs of their own, each described at its head; most measure the built
book. Checking and grading are measured in ``packages/coursework/benchmarks``.
"""

import itertools
import platform
from importlib.metadata import version

from . import conversions, imports, symbols

PEERS = ("SciPy", "pytransform3d", "SymPy")


def main():
    packages = ", ".join(
        f"{name} {version(name)}" for name in ("numpy", "scipy", "pytransform3d", "sympy")
    )
    print(f"Python {platform.python_version()}, {packages}, {platform.machine()}.")
    print(
        "The time of orientation, and how many times as long the others take (medians of processor "
        "time; below 1 they are faster)."
    )
    print("benchmarks/conversions.py, symbols.py and imports.py say what exactly is compared.\n")
    print(f"| what | N | orientation | {' | '.join(f'{peer} takes' for peer in PEERS)} |")
    print(f"|---|---|---|{'---|' * len(PEERS)}")
    for what, size, seconds in itertools.chain(conversions.rows(), symbols.rows(), imports.rows()):
        print(
            _line(what, f"{size:,}", _in_words(seconds["orientation"] / size), seconds), flush=True
        )
    for what, operations in symbols.sizes():
        print(_line(what, "1", f"{operations['orientation']:,}", operations))


def _line(what, size, ours, measured):
    ratios = (
        f"{measured[peer] / measured['orientation']:.3g} x" if measured.get(peer) else ""
        for peer in PEERS
    )
    return f"| {what} | {size} | {ours} | {' | '.join(ratios)} |"


def _in_words(seconds):
    for unit, size in (("s", 1), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


if __name__ == "__main__":
    main()
