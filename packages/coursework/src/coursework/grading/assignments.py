"""The assignments of a course, their questions, and which of them a notebook answers."""

from __future__ import annotations

import functools
import itertools
import json
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from ..authoring.course import course_around, find_course
from ..authoring.source import names_asked, posed
from .judging import marking
from .judging.contract import Contract
from .judging.secret import secret_beside
from .judging.term import Term
from .submissions import intake
from .submissions.intake import Notebook

#: The questions of an assignment, each in all its variants, by name.
Questions = Mapping[str, Sequence[Contract]]


class NothingToGrade(ValueError):
    """An error if there is nothing to grade; the message says what we looked for."""


class Course:
    """The assignments of a course, and the names of their questions.

    Parameters
    ----------
    solutions : path
        The folder of the notebooks with solutions.
    term : Term, optional
        Determines the notebooks of each assignment; without it, each notebook is an assignment.
    only : collection of str
        The assignments to grade now, if not all.

    Attributes
    ----------
    assignments : dict of str to tuple of str
        The notebooks of each assignment that is graded now.
    names : dict of str to list of str
        The questions of every assignment, first those of the assignments graded now.
    """

    def __init__(
        self,
        solutions: str | Path | None = None,
        term: Term | None = None,
        only: Collection[str] = (),
    ) -> None:
        folder = self.folder = Path(solutions or find_course().sources)
        course = course_around(folder)
        self.edition = course.edition if course else ""
        self.sources = {path.stem: path for path in sorted(folder.glob("*.ipynb"))}
        if not self.sources:
            raise NothingToGrade(f"There is no notebook with solutions in {folder}.")
        of_term = (term or Term()).assignments
        known = {name: about.notebooks for name, about in of_term.items()}
        #: The questions of sittings, which students answer on paper and not in a notebook.
        self.sittings = {
            name: about.questions for name, about in of_term.items() if about.questions
        }
        homework = [name for name in known if name not in self.sittings] or list(self.sources)
        known |= {stem: (stem,) for stem in homework if stem not in known}
        used = {stem for name in homework for stem in known[name]}
        if unknown := sorted(used - set(self.sources)):
            raise NothingToGrade(
                f"{folder} has no notebook with solutions named "
                f"{', '.join(map(repr, unknown))}; choose from {', '.join(self.sources)}."
            )
        if strangers := sorted(set(only) - set(known)):
            raise NothingToGrade(
                f"There is no assignment {strangers[0]!r}; choose from {', '.join(known)}."
            )
        self.assignments = {name: known[name] for name in known if name in (only or homework)}
        known = (
            self.assignments | known | {stem: (stem,) for stem in self.sources if stem not in used}
        )
        asked = {stem: list(names_asked(path)) for stem, path in self.sources.items()}
        there = list(itertools.chain(*asked.values()))
        if lost := set(itertools.chain(*self.sittings.values())).difference(there):
            raise NothingToGrade(
                f"There is no question {min(lost)!r}; choose from {', '.join(there)}."
            )
        self.names = {
            name: list(
                self.sittings.get(name, [question for stem in stems for question in asked[stem]])
            )
            for name, stems in known.items()
        }

    def assignments_of(self, notebook: Notebook) -> list[str]:
        """Return the assignments that a notebook answers, whether or not they are graded now.

        The names in its cells decide, or else its own name and folder.
        """
        by_cell = {name.replace("/", "-"): name for name in self.all_questions}
        named = {by_cell.get(name.removeprefix("check-"), name) for name in notebook.named}
        counts = {
            assignment: len(named & set(names))
            for assignment, names in self.names.items()
            if assignment not in self.sittings
        }
        # Take the assignment that the notebook names most questions of, and any other of which it
        # names at least half, since some students work in a single notebook.
        first = max(counts, key=lambda name: counts[name])
        if counts[first]:
            return [
                name
                for name, count in counts.items()
                if name == first or 2 * count >= len(self.names[name]) > 0
            ]
        for place in (notebook.folder, notebook.file.rpartition("/")[2]):
            if fitting := [name for name in counts if name in place]:
                return [max(fitting, key=len)]
        if notebook.of_assignment:
            return [notebook.of_assignment]
        return list(self.assignments) if len(self.assignments) == 1 else []

    def questions(self, assignments: Iterable[str], results: Path) -> dict[str, Questions]:
        """Load the questions of some assignments, by assignment and name.

        The processed questions are stored in the folder of results.
        """
        stems = sorted(
            {stem for assignment in assignments for stem in self.assignments[assignment]}
        )
        questions = marking.load_questions(
            [self.sources[stem] for stem in stems],
            results,
            secret_beside(self.folder),
            self.edition,
        )
        return {
            assignment: {name: questions[name] for name in self.names[assignment]}
            for assignment in assignments
        }

    @property
    def all_questions(self) -> list[str]:
        """The names of all questions, including those that are not graded now."""
        return [name for names in self.names.values() for name in names]

    @functools.cached_property
    def blanks(self) -> frozenset[str]:
        """The code cells of all notebooks as students get them."""
        cells = {""}
        for path in self.sources.values():
            owners = {variable: name for name, variable in names_asked(path).items()}
            for cell in json.loads(path.read_text("utf8"))["cells"]:
                if cell["cell_type"] == "code":
                    cells.add(_answered(posed("".join(cell["source"]), owners)))
        return frozenset(cells)

    def answers_something(self, notebook: Notebook) -> bool:
        """Check whether a notebook contains any code that the exercise did not."""
        return not self.blanks.issuperset(_answered(cell["source"]) for cell in notebook.cells)


def _answered(source: str) -> str:
    """Return the part of a cell that may be an answer, without comments and the student's ID."""
    return intake.bare(re.sub(r"\b(?:me|student)\([^()\n]*\)", "", source))
