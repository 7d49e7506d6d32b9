"""Check that every chapter has all its parts: ``python -m tools.chapters``.

It reports each missing part by file, line and cell.
"""

import re
import sys
from pathlib import Path
from typing import NamedTuple

import nbformat

TO_BE_WRITTEN = "TO BE WRITTEN"
CONTENTS, INDEX = Path("_toc.yml"), Path("exercises/index.md")
#: There are two pages, since one would be too large. New solutions go into the last.
SOLUTIONS = (Path("appendix/solutions.ipynb"), Path("appendix/solutions-going-further.ipynb"))
SOURCES = Path("tests/solutions")
CHAPTERS_SOURCE = SOURCES / "chapters.ipynb"
#: Three questions for each notebook of exercises, which a tutor asks aloud.
SPOKEN = SOURCES / "spoken-questions.md"


def source_of(name):
    """Return the notebook with solutions from which the exercises of a chapter are made."""
    return SOURCES / f"{name}.ipynb"


class Line(NamedTuple):
    """A line of a notebook's source; its ``str`` is its place."""

    path: Path
    cell: int
    number: int
    text: str

    def __str__(self):
        return f"{self.path}:{self.number} (cell {self.cell})"


def lines(path):
    """Return all lines of a notebook."""
    notebook = nbformat.read(path, as_version=4)
    return [
        Line(path, position, number, text)
        for position, cell in enumerate(notebook.cells, 1)
        for number, text in enumerate(cell.source.splitlines(), 1)
    ]


def lines_matching(all_lines, pattern):
    """Return the lines that match a pattern, by the content of its first group."""
    matches = ((line, re.search(pattern, line.text)) for line in all_lines)
    return {match[1]: line for line, match in matches if match}


def faults():
    """Return a sentence for each part that a chapter lacks, beginning with the place."""
    solutions, asked = [line for path in SOLUTIONS for line in lines(path)], lines(CHAPTERS_SOURCE)
    solved = lines_matching(solutions, r"{solution-start} (\S+)")
    sealed = lines_matching(asked, r"question\(['\"](chapters/[^'\"]+)")
    listed = {
        match[1]: number
        for number, text in enumerate(CONTENTS.read_text("utf8").splitlines(), 1)
        if (match := re.match(r" *- file: (\S+)", text))
    }
    index = INDEX.read_text("utf8")
    last_chapter = max(
        (number for page, number in listed.items() if page.startswith("chapters/")), default=1
    )
    last_exercise = max(
        (number for page, number in listed.items() if page.startswith("exercises/")), default=1
    )
    for page, number in listed.items():
        if not any(Path(f"{page}.{ending}").is_file() for ending in ("ipynb", "md")):
            made = (
                f"; `make release` makes it from {source_of(Path(page).name)}"
                if page.startswith("exercises/")
                else ""
            )
            yield f"{CONTENTS}:{number}: there is no page {page}{made}"
    chapters = sorted(Path("chapters").glob("*.ipynb"))
    for path in chapters:
        name, text = path.stem, lines(path)
        if f"chapters/{name}" not in listed:
            yield f"{CONTENTS}:{last_chapter}: the chapter {path} is not in the table of contents"
        if not text or text[0].text != f"(chapter-{name})=":
            yield f"{path}:1 (cell 1): a chapter begins with its label, `(chapter-{name})=`"
        for part, where in (("objectives", text[:1]), ("summary", text[-1:])):
            if not lines_matching(text, rf"^(:class: {part})\s*$"):
                yield (
                    f"{where[0] if where else path}: no {part}; add an `{{admonition}}` with "
                    f"`:class: {part}`"
                )
        exercises = lines_matching(text, r"^:label: (exercise-\S+)")
        if not exercises:
            yield (
                f"{text[-1] if text else path}: the chapter has no exercise; add an "
                f"`{{exercise}}` with a label here"
            )
        for label, line in exercises.items():
            if label not in solved:
                yield (
                    f"{line}: {label} has no `{{solution-start}} {label}` in "
                    f"{' or '.join(map(str, SOLUTIONS))}"
                )
        for question, line in lines_matching(text, r"check\(['\"](chapters/[^'\"]+)").items():
            if question not in sealed:
                yield f"{line}: {question} is not a question of {CHAPTERS_SOURCE}"
        if not source_of(name).is_file():
            yield f"{path}:1 (cell 1): its exercises are missing, {source_of(name)}"
        if f"exercises/{name}" not in listed:
            yield f"{CONTENTS}:{last_exercise}: exercises/{name} is not in the table of contents"
        if f"{{doc}}`{name}`" not in index:
            yield (
                f"{INDEX}:{len(index.splitlines())}: the exercises of the chapter {name} are not "
                "listed"
            )
    yield from (
        f"{SPOKEN}:{number}: {text}"
        for number, text in enumerate(SPOKEN.read_text("utf8").splitlines(), 1)
        if TO_BE_WRITTEN in text
    )
    for path in [*chapters, *SOLUTIONS, *sorted(SOURCES.glob("*.ipynb"))]:
        yield from (
            f"{line}: {line.text.strip()}" for line in lines(path) if TO_BE_WRITTEN in line.text
        )
        for position, cell in enumerate(nbformat.read(path, as_version=4).cells, 1):
            if TO_BE_WRITTEN in str(cell.metadata):
                yield f"{path}:1 (cell {position}): {TO_BE_WRITTEN} in the cell's metadata"


def main():
    sys.exit("\n".join(faults()) or 0)


if __name__ == "__main__":
    main()
