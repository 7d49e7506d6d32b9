"""Typeset the labels of the interactive figures and write them into ``js/glyphs.js``.

Run it with ``python -m orientation_figures.moving.glyphs``.

They look like those of ``orientation_figures.drawing``. The file is committed with the others, so
that the figures work without Matplotlib.
"""

import json

from ..drawing import typeset
from .bundle import FOLDER

COMMAND = "python -m orientation_figures.moving.glyphs"
FILE = FOLDER / "js" / "glyphs.js"

# Every label that a figure typesets as mathematics.
LABELS = (
    *(rf"\hat{{{frame}}}_{axis}" for frame in "nabcdm" for axis in "xyz"),
    r"\hat{e}",
    *(rf"\hat{{u}}_{number}" for number in "12"),
    *(rf"\mathbf{{v}}{primes}" for primes in ("", "'", "''")),
    *"NABCDtxyz",
    # Matrices between any two of the frames of a tree.
    *(rf"{{}}^{target}\mathbf{{C}}^{source}" for target in "NABCDE" for source in "NABCDE"),
    r"\alpha",
    r"\beta",
    r"\gamma",
    r"\psi",
    r"\theta",
    r"\theta/2",
    r"\cos(\theta/2)",
    r"\sin(\theta/2)",
    r"\varphi",
    "q_0",
    "q_i",
    "q_j",
    "q_k",
    "e_x",
    "e_y",
    "e_z",
    "I_x",
    "I_y",
    "I_z",
    r"\hat{a}_x\times\hat{a}_y",
    *(rf"\hat{{e}}_{axis}" for axis in "xyz"),
    "E",
    "q",
    "-q",
    "0",
    r"4\,\mathrm{s}",
    *(rf"{top}^\circ/\mathrm{{s}}" for top in (30, 60, 90, 120, 180, 360, 720)),
    r"\mathrm{cut\ off}",
    *(rf"\mathbf{{C}}_{axis}" for axis in "xyz"),
    # The axes of the plots of motion.
    r"\mathbf{H}",
    r"\mathrm{departure\ from\ orthogonality}",
    r"\mathrm{error\ (rad)}",
    r"\mathrm{margin\ to\ gimbal\ lock\ (degrees)}",
    r"t\ \mathrm{(s)}",
    "10^{-15}",
    "10^{-10}",
    "10^{-5}",
    "0",
    *"1234",
    "5",
    "10",
    "15",
    "20",
    "90",
    # The axes of a walk past a car.
    r"\mathrm{heading\ error\ (degrees)}",
    r"\mathrm{car}",
    "-60",
    "-30",
    "30",
    "40",
    "60",
)


def glyphs():
    """Return the module of outlines and of their places in each label, 1000 units to the em."""
    outlines, labels = {}, {}
    for text in LABELS:
        placed, ink = typeset(f"${text}$")
        labels[text] = {
            "ink": [round(float(edge)) for edge in ink.ravel()],
            "glyphs": [
                [
                    outlines.setdefault(outline, len(outlines)),
                    round(float(x)),
                    round(float(y)),
                    round(float(size), 3),
                ]
                for outline, (x, y), size in placed
            ],
        }
    return (
        f"// Made by `{COMMAND}`.\n"
        f"export const OUTLINES = {json.dumps(list(outlines), separators=(',', ':'))};\n"
        f"export const LABELS = {json.dumps(labels, separators=(',', ':'))};\n"
    )


if __name__ == "__main__":
    FILE.write_text(glyphs(), "utf8")
