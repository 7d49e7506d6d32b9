"""A small course for an instructor: its solutions, its students, and the command `coursework`."""

import contextlib
import csv
import io
import os
import sys
from pathlib import Path

import nbformat
import pytest
from trial_course import notebook

from coursework.__main__ import main

SECRET = "5eed" * 16


def run_command(*words, fails=False, stdin=""):
    """Run the command, and return all of its output.

    It runs in this process, which has loaded SymPy; in a process of its own, it would take
    seconds.
    """
    said, status = io.StringIO(), 0
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(sys, "stdin", io.StringIO(stdin))
            try:
                main([*map(str, words)])
            except SystemExit as ended:
                status = ended.code
                print(status or "")
    assert bool(status) == fails, said.getvalue()
    return said.getvalue()


def read_table(path):
    with open(path, encoding="utf8", newline="") as file:
        return list(csv.DictReader(file))


def write_table(path, rows):
    with open(path, "w", encoding="utf8", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    return path


class Course:
    """Solutions, a folder of submissions, and the marks.

    Each question asks for a number or a text; `questions` gives the right answer and the points.
    """

    def __init__(self, place, **assignments):
        self.place = Path(place)
        self.solutions, self.handed_in = self.place / "solutions", self.place / "handed-in"
        self.marks = self.place / "marks"
        self.solutions.mkdir(parents=True)
        self.handed_in.mkdir()
        (self.solutions / ".grading-secret").write_text(SECRET)
        self.assignments = assignments
        for name in assignments:
            self.write_source(name)

    def write_source(self, name):
        cells = ["from coursework import check"]
        for question, (right, worth) in self.assignments[name].items():
            kind = "free text" if isinstance(right, str) else "expression"
            cells += [
                ("markdown", f"How much is {question}?"),
                f"### BEGIN SOLUTION\n{question} = {right!r}\n### END SOLUTION",
                f"check('{name}/{question}', {question})\n### BEGIN HIDDEN TESTS\n"
                f"question('{name}/{question}', kind={kind!r}, worth={worth})\n"
                "### END HIDDEN TESTS",
            ]
        nbformat.write(notebook(cells), self.solutions / f"{name}.ipynb")

    def change(self, name, **questions):
        """Change the source to another right answer or another worth."""
        self.assignments[name] |= questions
        self.write_source(name)

    def answers(self, name, **given):
        """Return a student's notebook, right except for the answers `given`; `None` is a blank."""
        cells = ["from coursework import check"]
        for question, (right, _) in self.assignments[name].items():
            answer = given.get(question, right)
            cells.append(f"{question} = {'...' if answer is None else repr(answer)}")
            cells.append(f"check('{name}/{question}', {question})")
        return notebook(cells)

    def hands_in(self, student, name, file=None, **given):
        path = self.handed_in / student / (file or f"{name}.ipynb")
        path.parent.mkdir(parents=True, exist_ok=True)
        nbformat.write(self.answers(name, **given), path)
        return path

    def run(self, *words, **more):
        with contextlib.chdir(self.place):
            return run_command(*words, **more)

    def grade(self, *words, **more):
        return self.run(
            "grade", "handed-in", "--out", "marks", "--solutions", "solutions", *words, **more
        )

    def regrade(self, *words, **more):
        return self.run("regrade", "marks", "--solutions", "solutions", *words, **more)

    def export(self, book, *words, **more):
        return self.run("export", "marks", "--lms", book, "--filled", book, *words, **more)

    def points(self, assignment=None):
        """Return the points in grades.csv of each student, or of each student in one assignment."""
        return {
            row["student"]: float(row["points"])
            for row in self.table("grades.csv")
            if assignment in (None, row["assignment"])
        }

    def table(self, name):
        return read_table(self.marks / name)

    def write_table(self, name, rows):
        return write_table(self.place / name, rows)

    def canvas_book(self, *columns, name="book.csv"):
        """Write an empty Canvas gradebook of everybody who has handed in."""
        students = sorted(os.listdir(self.handed_in))
        rows = [
            {"Student": student, "ID": number, "SIS User ID": "", "SIS Login ID": student,
             "Section": "x"} | dict.fromkeys(columns, "")
            for number, student in enumerate(students, 1)
        ]  # fmt: skip
        return self.write_table(name, rows)

    def column(self, book, column):
        """Return the contents of a column in a filled gradebook for each student."""
        rows = read_table(book)
        key = "SIS Login ID" if "SIS Login ID" in rows[0] else next(iter(rows[0]))
        return {row[key]: row[column] for row in rows}
