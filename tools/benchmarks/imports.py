"""Time to import each library beyond NumPy's, in a fresh interpreter each time."""

import statistics
import subprocess
import sys

PACKAGES = {
    "orientation": "orientation",
    "SciPy": "scipy.spatial.transform",
    "pytransform3d": "pytransform3d.rotations",
    "SymPy": "sympy.physics.mechanics",
}
ROUNDS = 9


def rows():
    """Yield ``(what, N, seconds by contestant)``."""
    samples = {name: [] for name in PACKAGES}
    for _ in range(ROUNDS):
        for name, package in PACKAGES.items():
            code = (
                f"import time, numpy\nstart = time.process_time()\nimport {package}\n"
                "print(time.process_time() - start)"
            )
            done = subprocess.run(
                [sys.executable, "-c", code], capture_output=True, text=True, check=True
            )
            samples[name].append(float(done.stdout))
    yield (
        "import, beyond NumPy",
        1,
        {name: statistics.median(times) for name, times in samples.items()},
    )
