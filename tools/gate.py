"""Compute the data of the gate's figure, with the filter from chapter 19.

``python -m tools.gate`` writes them to ``gate.json`` beside the figure, which takes a minute or
two.
"""

import json
from pathlib import Path

import numpy as np

from orientation_recordings.walks import STEP, TAKEN, walks

ROOT = Path(__file__).parents[1]
TABLE = (
    ROOT / "packages" / "orientation-lab" / "src" / "orientation_figures" / "moving" / "gate.json"
)
# In microtesla.
STEELS = (0, 2, 4, 6, 8, 10, 12)
# Shares of measurements that the gate of a correctly tuned filter rejects; 0 is no gate.
REJECTED = (0, 0.001, 0.01, 0.1, 0.5, 0.9)
CURVES = 5


def chapter():
    """Return the functions of the chapter's cell, without its output."""
    book = json.loads((ROOT / "chapters" / "orientation-filters.ipynb").read_text("utf8"))
    sources = ("".join(cell["source"]) for cell in book["cells"])
    [cell] = [source for source in sources if "def follow(" in source]
    names = {"np": np}
    exec("from orientation import *\n" + cell[: cell.index("car, no_car =")], names)
    return names


def table(count=100):
    """Return five curves for each steel and gate, and the median and worst errors of all walks."""
    names, rows = chapter(), []
    for steel in STEELS:
        walk, row = walks(count, 1, steel=steel), []
        for share in REJECTED:
            estimate, predictions, looks = names["follow"](
                walk, (-2 * np.log(share) if share else np.inf)
            )
            errors = names["of_the_filter"](walk, estimate, predictions)
            ends = np.sqrt((errors[:, -round(3 / STEP) :] ** 2).mean(axis=1))
            accepted = np.array([look.accepted for look in looks])
            every = round(1 / STEP)
            row.append(
                {
                    "curves": errors[:CURVES, ::every].round(1).tolist(),
                    "middle": round(float(np.median(ends)), 1),
                    "worst": round(float(ends.max()), 1),
                    "rejected": round(float(1 - accepted.mean()), 2),
                }
            )
        rows.append(row)
    return {"start": TAKEN, "steels": STEELS, "rejected": REJECTED, "rows": rows}


if __name__ == "__main__":
    TABLE.write_text(json.dumps(table(), separators=(",", ":")) + "\n", "utf8")
