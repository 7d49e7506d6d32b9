"""``python -m orientation_figures.card``: the convention card on one page, as PDF and SVG, from the table."""

import textwrap
from pathlib import Path

from orientation_workbench.programs import WITH_CODE

COMMAND = "python -m orientation_figures.card"
SETTINGS = {"svg.hashsalt": "convention card", "svg.fonttype": "path", "pdf.fonttype": 42}
FOLDER = Path(__file__).parents[2] / "chapters"
FILES = tuple(FOLDER / f"convention-card.{kind}" for kind in ("pdf", "svg"))
WIDTH, HEIGHT, MARGIN = 595, 842, 34  # points: A4
# What stands in the lines: the parts of a quaternion, of a rotation vector and of a matrix, and the gimbal's angles.
QUATERNION = {"w": "q0", "x": "qi", "y": "qj", "z": "qk"}
VECTOR = {"x": "rx", "y": "ry", "z": "rz"}
ANGLES = {
    "a": "psi",
    "b": "theta",
    "c": "phi",
    "s": "zxy",
    "S": "ZXY",
    "A": "Z",
    "B": "X",
    "C": "Y",
    "i": 2,
    "j": 0,
    "k": 1,
}
BY_AXIS = {"az": "psi", "ax": "theta", "ay": "phi"}
LONGEST = 82  # characters of a line of code that fit beside the name of its form
QUESTIONS = (
    ("1  Which way round?", "+30 degrees about z: first row (0.87, 0.5, 0) as here, (0.87, -0.5, 0) transposed."),
    ("2  Body or space fixed?", "90 degrees about z, then 90 about x: x ends along y body fixed, along z space fixed."),
    ("3  Where is the scalar?", "The quaternion of no turn: the 1 is the scalar."),
    ("4  Conjugate?", "The quaternion of +30 degrees about z: 0.259 beside 0.966 as here, -0.259 the conjugate."),
)


def rows():
    """What the card says of each program: its name, its convention, and a line of code for each form."""
    found = []
    for program, facts in WITH_CODE.items():
        scalar = f"scalar {facts['scalar']}" if facts["scalar"] else "no quaternions"
        lines = []
        for form, line in facts["lines"].items():
            names = QUATERNION if form == "quaternion" else VECTOR if form == "axis times angle" else ANGLES | BY_AXIS
            only = facts.get("sequences", {}).get(form, [])
            if len(only) == 1:
                names = dict(zip("abc", ("phi", "theta", "psi")))
                form = f"{form}, {'-'.join(only[0])}"
            lines.append((form, line.format(**names, m="C.T" if facts["matrix"] == "transposed" else "C")))
        found.append((program, facts["version"], f"matrix {facts['matrix']}, {scalar}, {facts['unit']}", lines))
    return found


def draw():
    """Return the card as a Matplotlib figure of one page."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH / 72, HEIGHT / 72))
    down = HEIGHT - MARGIN

    def write(x, text, size=7.2, **look):
        figure.text(x / WIDTH, down / HEIGHT, text, fontsize=size, va="baseline", **look)

    write(MARGIN, "The convention card", 17, weight="bold")
    down -= 15
    write(
        MARGIN,
        "Orientation of Reference Frames. “As here” is the matrix whose rows are the unit vectors of A in N;",
        7.6,
    )
    down -= 10
    write(
        MARGIN,
        "a program with the transposed one gives its columns. Quaternions are Hamilton's, q0 the scalar; angles z-x-y.",
        7.6,
    )
    down -= 14
    for question, answer in QUESTIONS:
        write(MARGIN, question, weight="bold")
        write(MARGIN + 118, answer)
        down -= 10
    for program, version, convention, lines in rows():
        down -= 7
        figure.add_artist(_rule(down + 9.5))
        write(MARGIN, program, 8.6, weight="bold")
        write(MARGIN + 118, convention + (f"; run with {version}" if version else ""), style="italic")
        down -= 10.5
        for form, line in lines:
            write(MARGIN, form)
            for part in textwrap.wrap(line, LONGEST, break_long_words=False):
                write(MARGIN + 118, part, 7, family="monospace")
                down -= 9.6
    return figure


def _rule(height):
    from matplotlib.lines import Line2D

    return Line2D((MARGIN / WIDTH, 1 - MARGIN / WIDTH), (height / HEIGHT,) * 2, linewidth=0.5, color="0.6")


def metadata(kind):
    """What a file says of itself: no dates, so that it is the same every time."""
    dates = {"CreationDate": None, "ModDate": None} if kind == "pdf" else {"Date": None}
    return dates | {"Title": "The convention card"}


def main():
    """Write both files, the same bytes every time."""
    import matplotlib

    with matplotlib.rc_context(SETTINGS):
        for file in FILES:
            draw().savefig(file, metadata=metadata(file.suffix[1:]))


if __name__ == "__main__":
    main()
