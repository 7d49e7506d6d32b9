"""``python -m orientation_figures.card``: draw the two sides of the convention card."""

import io
import textwrap
from pathlib import Path

from orientation_workbench.programs import PROGRAMS

COMMAND = "python -m orientation_figures.card"
SETTINGS = {"svg.hashsalt": "convention card", "svg.fonttype": "path", "pdf.fonttype": 42}
FOLDER = Path(__file__).parents[4] / "chapters"
FILES = {
    name: FOLDER / name
    for name in ("convention-card.pdf", "convention-card.svg", "convention-card-back.svg")
}
FILE = FILES["convention-card.pdf"]
# In points, for A4.
WIDTH, HEIGHT, MARGIN = 595, 842, 34
# The names of the parts of a quaternion, a rotation vector and a matrix, and of the gimbal's
# angles, in the lines of code.
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
# The most characters in a line of code that fit beside the name of its form.
LONGEST = 82
ON_THE_FRONT = 12
FRONT = (
    "Orientation of Reference Frames. "
    "“As here” is the matrix whose rows are the unit vectors of A in N;",
    "a program with the transposed matrix has them as columns. Quaternions are Hamilton's, with "
    "the scalar q0; angles z-x-y.",
)
BACK = (
    "Numbers called “inverse” describe the inverse orientation. In sequences other than z-x-y, the "
    "angles phi, theta, psi are",
    "about x, y, z. If two programs name their axes differently, reorder both the rows and the "
    "columns of the matrix, with their signs.",
)
QUESTIONS = (
    (
        "1  Which way round?",
        "+30 degrees about z: first row (0.87, 0.5, 0) as here, (0.87, -0.5, 0) transposed.",
    ),
    (
        "2  Body or space fixed?",
        "90 degrees about z, then 90 about x: body fixed, x ends up along y; space fixed, along z.",
    ),
    ("3  Where is the scalar?", "The identity quaternion: the 1 is the scalar."),
    (
        "4  Conjugate?",
        "+30 degrees about z: 0.966 and 0.259 as here, 0.966 and -0.259 conjugated.",
    ),
)


def rows():
    """Return what the card states about each program.

    That is its name, the version that was run, its convention, and a line of code for each form.
    """
    programs = []
    for program, facts in PROGRAMS.items():
        scalar = f"scalar {facts['scalar']}" if facts["scalar"] else "no quaternions"
        matrix = "C.T" if facts["matrix"] == "transposed" else "C"
        whole = {"m": matrix, "t": f"columns of {matrix}"}
        lines = []
        for form, line in facts["lines"].items():
            names = (
                QUATERNION
                if form == "quaternion"
                else VECTOR
                if form == "axis times angle"
                else ANGLES | BY_AXIS
            )
            only = facts.get("sequences", {}).get(form, [])
            if len(only) == 1:
                by_axis = BY_AXIS if only[0] == "zxy" else {"ax": "phi", "ay": "theta", "az": "psi"}
                names = by_axis | dict(zip("abc", (by_axis[f"a{letter}"] for letter in only[0])))
                form = f"{form}, {'-'.join(only[0])}"
            names |= {f"-{name}": f"-{names[name]}" for name in "abc" if name in names}
            if {"quaternion": form, "axis times angle": "rotation vector"}.get(form) in facts.get(
                "inverse", ()
            ):
                form = f"{form}, inverse"
            lines.append((form, line.replace("}f", "}").format(**names, **whole)))
        convention = f"matrix {facts['matrix']}, {scalar}, {facts['unit']}"
        if facts.get("body"):
            convention += f"; x, y, z point {', '.join(facts['body'])}"
        programs.append((program, facts["version"], convention, lines))
    return programs


class _Side:
    """One side of the sheet, written from the top."""

    def __init__(self):
        from matplotlib.figure import Figure

        self.figure, self.down = Figure(figsize=(WIDTH / 72, HEIGHT / 72)), HEIGHT - MARGIN

    def write(self, x, text, size=7.2, **look):
        self.figure.text(x / WIDTH, self.down / HEIGHT, text, fontsize=size, va="baseline", **look)

    def program(self, name, version, convention, lines):
        self.down -= 7
        self.figure.add_artist(_rule(self.down + 9.5))
        self.write(MARGIN, name, 8.6, weight="bold")
        self.write(
            MARGIN + 118, convention + (f"; run with {version}" if version else ""), style="italic"
        )
        self.down -= 10.5
        for form, line in lines:
            self.write(MARGIN, form)
            for part in textwrap.wrap(line, LONGEST, break_long_words=False):
                self.write(MARGIN + 118, part, 7, family="monospace")
                self.down -= 9.6


def draw():
    """Return both sides of the card as Matplotlib figures."""
    front, back = _Side(), _Side()
    for side, title, words in (
        (front, "The convention card", FRONT),
        (back, "Cameras, graphics, simulators, robots", BACK),
    ):
        side.write(MARGIN, title, 17, weight="bold")
        side.down -= 5
        for line in words:
            side.down -= 10
            side.write(MARGIN, line, 7.6)
        side.down -= 14
    for question, answer in QUESTIONS:
        front.write(MARGIN, question, weight="bold")
        front.write(MARGIN + 118, answer)
        front.down -= 10
    for number, row in enumerate(rows()):
        (front if number < ON_THE_FRONT else back).program(*row)
    return front.figure, back.figure


def _rule(height):
    from matplotlib.lines import Line2D

    return Line2D(
        (MARGIN / WIDTH, 1 - MARGIN / WIDTH), (height / HEIGHT,) * 2, linewidth=0.5, color="0.6"
    )


def metadata(kind):
    """Return the metadata of a file, without dates, so that it is reproducible."""
    dates = {"CreationDate": None, "ModDate": None} if kind == "pdf" else {"Date": None}
    return dates | {"Title": "The convention card"}


def drawn():
    """Return the bytes of each file, by its name; they are reproducible."""
    import matplotlib
    from matplotlib.backends.backend_pdf import PdfPages

    with matplotlib.rc_context(SETTINGS):
        sides, paper = draw(), io.BytesIO()
        with PdfPages(paper, metadata=metadata("pdf")) as pages:
            for side in sides:
                pages.savefig(side)
        files = {FILE.name: paper.getvalue()}
        for name, side in zip(list(FILES)[1:], sides):
            side.savefig(picture := io.BytesIO(), format="svg", metadata=metadata("svg"))
            files[name] = picture.getvalue()
    return files


def main():
    """Write the files."""
    for name, content in drawn().items():
        FILES[name].write_bytes(content)


if __name__ == "__main__":
    main()
