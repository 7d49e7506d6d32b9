"""Add a chapter or a question with every part that it needs.

The parts that the author must write are marked TO BE WRITTEN, and `tools.chapters` lists those that
remain. Run it with ``python -m tools.new``.
"""

import argparse
import re
import sys
from pathlib import Path
from typing import NamedTuple

import nbformat

from notebook_pages.notebooks import METADATA, normalise

from .chapters import CHAPTERS_SOURCE, INDEX, SOLUTIONS, SPOKEN, TO_BE_WRITTEN, source_of

NAME = r"[a-z][a-z0-9]*(-[a-z0-9]+)*"


class Example(NamedTuple):
    """An answer of one kind: its variable, its statements, its description, and facts about it."""

    variable: str
    code: str
    is_: str
    arguments: str


THETA = "an expression in the symbol `theta` (radians)"
#: One example of each kind of question, which an author replaces.
EXAMPLES = {
    "expression": Example("height", "height = sm.sin(theta)", THETA, "symbols='theta'"),
    "vector": Example(
        "direction",
        "direction = [sm.cos(theta), sm.sin(theta), 0]",
        "its three components in $N$, a list of expressions in `theta` (radians)",
        "length=3, frames=('N',), symbols='theta', unit_vector=True",
    ),
    "direction cosine matrix": Example(
        "A_C_N",
        "A_C_N = sm.Matrix([[1, 0, 0], [0, sm.cos(theta), sm.sin(theta)], [0, -sm.sin(theta), "
        "sm.cos(theta)]])",
        "the direction cosine matrix ${}^A\\mathbf{C}^N$, in the symbol `theta` (radians)",
        "frames=('A', 'N'), symbols='theta', turns=[('x', theta)]",
    ),
    "matrix": Example(
        "shear",
        "shear = sm.Matrix([[1, theta], [0, 1]])",
        "a matrix in `theta`",
        "shape=(2, 2), symbols='theta'",
    ),
    "quaternion": Example(
        "q",
        "q = [sm.cos(theta/2), sm.sin(theta/2), 0, 0]",
        "the quaternion of $A$ in $N$, scalar first, in the symbol `theta` (radians)",
        "symbols='theta', turns=[('x', theta)]",
    ),
    "Euler angles": Example(
        "angles",
        "angles = [0.1, 0.2, 0.3]",
        "the three angles in radians, to four decimals",
        "sequence='zxy'",
    ),
    "axis and angle": Example(
        "turn",
        "turn = ([0, 0, 1], sm.pi/3)",
        "a pair of the unit vector's components and the angle in radians",
        "",
    ),
    "sequence": Example("order", "order = 'zxy'", "the sequence as a string such as `'xyz'`", ""),
    "choice": Example(
        "side",
        "side = 'left'",
        "one of `'left'`, `'right'`, `'neither'`",
        "options=['left', 'right', 'neither']",
    ),
    "words": Example(
        "sides",
        "sides = ['left', 'right']",
        "a list of two strings, each `'left'` or `'right'`",
        "length=2, options=['left', 'right']",
    ),
    "measurement": Example(
        "rate", "rate = (3.2, 'rad/s')", "the number and its unit, such as `(1.5, 'm/s')`", ""
    ),
    "order": Example(
        "steps",
        "steps = ['first', 'then', 'last']",
        "a list of the three strings in their order",
        "options=['first', 'last', 'then']",
    ),
    "free text": Example(
        "why",
        "why = 'Since the axis is shared.'",
        "one or two sentences, as a string",
        "rubric=['names the shared axis']",
    ),
    "truth values": Example("holds", "holds = [True, False]", "a list of two Booleans", "length=2"),
    "function": Example(
        "doubled",
        "def doubled(number):\n    return 2*number",
        "a function `doubled(number)`",
        "calls=[[1], [-2.5]], result='expression'",
    ),
}


def markdown(*paragraphs):
    return nbformat.v4.new_markdown_cell("\n\n".join(paragraphs))


def code(text, **metadata):
    return nbformat.v4.new_code_cell(text, metadata=metadata)


def question_cells(name, kind, example):
    """Return the two cells of a question: the answer, and its check with the author's facts."""
    arguments = ", ".join(filter(None, [f"kind={kind!r}", example.arguments]))
    return [
        code(
            "theta = sm.symbols('theta')\n" * ("theta" in example.code)
            + f"### BEGIN SOLUTION\n{example.code}\n### END SOLUTION"
        ),
        code(
            f"check('{name}', {example.variable})\n### BEGIN HIDDEN TESTS\n"
            f"question('{name}', {arguments}, worth=2,\n"
            f"         solution='{TO_BE_WRITTEN}: how to get there.')\n"
            "### END HIDDEN TESTS"
        ),
    ]


def renamed(example, ending):
    """Return an example with another name for its answer, as no two of a notebook may be equal."""
    return example._replace(
        variable=f"{example.variable}_{ending}",
        code=re.sub(rf"\b{example.variable}\b", rf"\g<0>_{ending}", example.code),
        is_=example.is_.replace(f"`{example.variable}", f"`{example.variable}_{ending}"),
    )


def chapter_cells(name, title, example):
    return [
        markdown(
            f"(chapter-{name})=\n# {title}",
            ":::{admonition} Learning objectives\n"
            ":class: objectives\n"
            "After this chapter you can\n"
            "\n"
            f"- {TO_BE_WRITTEN}: what a reader can do, in a verb that can be checked.\n"
            ":::",
            f"{TO_BE_WRITTEN}: a question from practice, which the chapter answers.",
            f"## {TO_BE_WRITTEN}: the first idea",
            f"{{numref}}`figure-{name}` {TO_BE_WRITTEN}: a picture before the formula.",
        ),
        code(
            "import numpy as np\n"
            "\n"
            "from orientation import simple_dcm\n"
            "from orientation_figures.drawing import Drawing\n"
            "\n"
            f"drawing = Drawing('{TO_BE_WRITTEN}: the picture in words, for readers who "
            "cannot see it.')\n"
            "drawing.triad('N', np.eye(3)).triad('A', simple_dcm('z', np.radians(30)))",
            tags=["hide-input"],
            mystnb={
                "figure": {
                    "name": f"figure-{name}",
                    "caption": f"{TO_BE_WRITTEN}: what to see here.",
                }
            },
        ),
        markdown(
            "## Exercises",
            f"```{{exercise}} {TO_BE_WRITTEN}\n:label: exercise-{name}\n"
            f"{TO_BE_WRITTEN}: the question. "
            f"Set `{example.variable}` to {example.is_}.\n```",
        ),
        code(
            f"from coursework import check\n\n{example.variable} = ...  # your answer\n"
            f"check('chapters/{name}', {example.variable})"
        ),
        markdown(
            f"Worked solution: {{ref}}`in the appendix <solution-{name}>`. More questions: "
            f"{{doc}}`/exercises/{name}`.",
            "## Summary",
            f":::{{admonition}} Summary\n:class: summary\n- {TO_BE_WRITTEN}: what to "
            "remember.\n:::",
        ),
    ]


def exercise_cells(notebook, question, title, kind):
    """Return the cells of a question of an exercise notebook, with its text and its number."""
    number = 1 + sum(
        cell.cell_type == "markdown" and cell.source.startswith("## ") for cell in notebook.cells
    )
    example = EXAMPLES[kind]
    if any(f", {example.variable})\n" in cell.source for cell in notebook.cells):
        example = renamed(example, number)
    return [
        markdown(
            f"## {number}. {title}",
            f"{TO_BE_WRITTEN}: the question, with symbols, frames in order, units of angles.",
            f"Set `{example.variable}` to {example.is_}.",
        ),
        *question_cells(question, kind, example),
    ]


def add_cells(path, cells):
    notebook = nbformat.read(path, as_version=4)
    notebook.cells += cells
    nbformat.write(normalise(notebook), path)


def add_line(path, after, line):
    """Put ``line`` after the line ``after``, with the same indentation."""
    lines = path.read_text("utf8").splitlines()
    places = [number for number, text in enumerate(lines) if text.strip() == after]
    if len(places) != 1:
        sys.exit(
            f"{path}:1: the line `{after}`, which `{line}` should follow, occurs {len(places)} "
            "times, not once"
        )
    lines.insert(places[0] + 1, lines[places[0]].replace(after, line))
    path.write_text("\n".join(lines) + "\n", "utf8")


#: One of the questions to ask aloud, by its number.
ASKED_ALOUD = (
    f"\n### {{number}}. {TO_BE_WRITTEN}\n\n{TO_BE_WRITTEN}: a question that takes a minute, "
    f"without a formula.\n\n**A good answer**: {TO_BE_WRITTEN}: what it contains.\n\n"
    + f'- **"{TO_BE_WRITTEN}: a common wrong answer."** The idea that is missing.\n'
    * 3
)


def add_spoken(name, after):
    """Insert placeholders for three questions to ask aloud, after those of another notebook."""
    new = f"\n## {name}\n" + "".join(ASKED_ALOUD.format(number=number) for number in (1, 2, 3))
    own = rf"\n## {after}\n(?:.*\n)*?(?=\n## |\Z)"
    text = re.sub(own, lambda section: section[0] + new, SPOKEN.read_text("utf8"))
    SPOKEN.write_text(text, "utf8")


def new_chapter(name, title, after):
    """Make a chapter and its exercises, and add both to all lists of the book."""
    if not re.fullmatch(NAME, name) or not title.strip():
        sys.exit(
            "A chapter needs a TITLE, and a NAME made of lower-case letters and hyphens; you gave "
            f"{name!r} and {title!r}."
        )
    chapter, source = Path("chapters", f"{name}.ipynb"), source_of(name)
    for path in (chapter, source):
        if path.exists():
            sys.exit(f"{path} already exists; nothing was changed.")
    listed = re.findall(r"^ *- file: chapters/(\S+)$", Path("_toc.yml").read_text("utf8"), re.M)
    after = after or listed[-1]
    if after not in listed:
        sys.exit(f"_toc.yml lists no chapter {after!r}; it has {', '.join(listed)}.")
    add_line(Path("_toc.yml"), f"- file: chapters/{after}", f"- file: chapters/{name}")
    add_line(Path("_toc.yml"), f"- file: exercises/{after}", f"- file: exercises/{name}")
    add_line(INDEX, f"- {{doc}}`{after}`", f"- {{doc}}`{name}`")
    add_spoken(name, after)
    exercises = nbformat.v4.new_notebook(
        cells=[
            markdown(
                f"# Exercises: {title}",
                f"After the chapter *{title}*. {TO_BE_WRITTEN}: what applies to all of them.",
            ),
            code("import sympy as sm\n\nfrom coursework import check"),
        ],
        metadata=METADATA,
    )
    exercises.cells += exercise_cells(exercises, f"{name}/first", TO_BE_WRITTEN, "expression")
    nbformat.write(normalise(exercises), source)
    # The questions of all chapters stand in one notebook.
    example = renamed(EXAMPLES["expression"], name.replace("-", "_"))
    new = nbformat.v4.new_notebook(cells=chapter_cells(name, title, example), metadata=METADATA)
    nbformat.write(normalise(new), chapter)
    add_cells(
        CHAPTERS_SOURCE,
        [
            markdown(f"## {title}"),
            *question_cells(f"chapters/{name}", "expression", example),
        ],
    )
    add_cells(
        SOLUTIONS[-1],
        [
            markdown(
                f"## {title}",
                f"```{{solution-start}} exercise-{name}\n:label: solution-{name}\n```",
                f"{TO_BE_WRITTEN}: the worked solution, in as many cells as it takes.",
            ),
            markdown("```{solution-end}\n```"),
        ],
    )
    return [
        f"created  {chapter}: the chapter",
        f"created  {source}: its exercises, with their solutions",
        f"added to _toc.yml and {INDEX}: both pages, after those of {after}",
        f"added to {CHAPTERS_SOURCE}: the question chapters/{name}, which the chapter asks",
        f"added to {SOLUTIONS[-1]}: its worked solution",
        f"added to {SPOKEN}: space for three questions to ask aloud",
    ]


def new_question(name, title, kind):
    """Add a question to a notebook of exercises."""
    notebook, _, question = name.partition("/")
    if not re.fullmatch(f"{NAME}/{NAME}", name) or notebook == "chapters":
        sys.exit(
            "The NAME of a question is CHAPTER/QUESTION in lower-case letters and hyphens; you "
            f"gave {name!r}."
        )
    if kind not in EXAMPLES:
        sys.exit(f"There is no KIND of question {kind!r}; choose from {', '.join(EXAMPLES)}.")
    source = source_of(notebook)
    if not source.exists():
        sys.exit(f"There is no {source}: `make new-chapter NAME={notebook} TITLE=...` makes it.")
    old = nbformat.read(source, as_version=4)
    if any(f"('{name}'" in cell.source or f'("{name}"' in cell.source for cell in old.cells):
        sys.exit(f"{source} already has a question {name}; nothing was changed.")
    add_cells(
        source, exercise_cells(old, name, title or question.replace("-", " ").capitalize(), kind)
    )
    return [f"added to {source}: the question {name}, its answer and its check"]


def main():
    parser = argparse.ArgumentParser(
        prog="python -m tools.new", description=__doc__.partition("\n")[0]
    )
    commands = parser.add_subparsers(required=True)
    chapter = commands.add_parser("chapter", help="add a chapter")
    chapter.add_argument("name", help="name of its files, such as belt-trick")
    chapter.add_argument("title", help="title of the chapter")
    chapter.add_argument("--after", help="the chapter that it follows (default: the last one)")
    chapter.set_defaults(make=new_chapter)
    question = commands.add_parser("question", help="add a question to a chapter")
    question.add_argument("name", help="chapter and question, such as belt-trick/twist")
    question.add_argument("title", help="title of the question")
    question.add_argument(
        "--kind", default="expression", help="kind of answer (default: %(default)s)"
    )
    question.set_defaults(make=new_question)
    options = vars(parser.parse_args())
    print(
        *options.pop("make")(**options),
        f"Now replace each {TO_BE_WRITTEN}; `make check` lists them.",
        sep="\n",
    )


if __name__ == "__main__":
    main()
