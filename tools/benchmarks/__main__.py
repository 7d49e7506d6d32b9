"""Print tables, all measured in this run: ``python -m tools.benchmarks``."""

import platform
from importlib.metadata import version

from . import conversions

#: A row that is slower than the fastest by more than this factor needs a reason.
ALLOWED = 1.5
#: The reasons, each with the size up to which it holds.
REASONS = {
    1: "the input may be of any kind and is checked; the other takes floats as they are",
    1000: "dozens of calls of NumPy, half a microsecond each, and checks, against compiled code",
    1_000_000: "each operation of the formula and of the checks reads and writes memory once",
}


def main():
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    print(f"Python {platform.python_version()}, {packages}, {platform.machine()}.")
    print(
        "Each time is the shortest processor time for one item. The largest error follows it, in "
        "units in the last place of 1. If the ratio is below 1, the module is the fastest.\n"
    )
    others = list(conversions.PEERS)
    print(f"| conversion | N | orientation | {' | '.join(others)} | to the fastest | why |")
    print(f"|---|---|---|{'---|' * len(others)}---|---|")
    for task, size, seconds, errors in conversions.rows():
        cells = (
            f"{_in_words(seconds[name] / size)}, {errors[name]:.1f}" if name in seconds else ""
            for name in ("orientation", *others)
        )
        ratio = seconds["orientation"] / min(seconds[name] for name in seconds if name in others)
        why = next(why for most, why in REASONS.items() if size <= most) if ratio > ALLOWED else ""
        print(f"| {task} | {size:,} | {' | '.join(cells)} | {ratio:.2g} | {why} |", flush=True)
    print("\nA lower limit for the time of any such library, at N = 1,000,000:")
    for task, seconds in conversions.limits():
        print(f"{task}: {_in_words(seconds / 1_000_000)} an item")


def _in_words(seconds):
    for unit, size in (("s", 1), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


if __name__ == "__main__":
    main()
