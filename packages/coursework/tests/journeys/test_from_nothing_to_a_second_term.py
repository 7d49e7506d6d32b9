"""An instructor goes from nothing to a second term by the manual's commands, with usual errors."""

import json
import subprocess
import sys
from unittest.mock import Mock

import pytest
from course_by_commands import read_table, run_command, write_table

from coursework.grading import sitting

pytestmark = pytest.mark.usefixtures("libraries_are_loaded_once")
RIGHT = {
    "area": "area = b*h/2",
    "slope": "slope = 2*x*sm.sin(x) + x**2*sm.cos(x)",
    "mean": "mean = lambda numbers: sum(numbers)/len(numbers)",
}
BOOK = """Student,ID,SIS User ID,SIS Login ID,Section,First steps (9)
    Points Possible,,,,,6
"Lee, Ada",1,,ada,x,
"Moe, Ben",2,,ben,x,
"Oz, Cem",3,,cem,x,
"Ek, Dan",4,,dan,x,
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Return a function that runs a command in the course's folder, with nobody there to agree."""
    monkeypatch.chdir(tmp_path)

    def run(command, fails=False):
        return run_command(*command.split(), fails=fails)

    run("new my-course")
    monkeypatch.chdir(tmp_path / "my-course")
    return run


def hand_in(folder, place, **answers):
    """Open the students' notebook, answer, and save it in a student's folder."""
    made = json.loads((folder / "exercises" / "first-steps.ipynb").read_text("utf8"))
    for cell in made["cells"]:
        for name, right in RIGHT.items():
            if "".join(cell["source"]).startswith((f"{name} = ...", f"def {name}(")):
                cell["source"] = answers.get(name, right)
    (folder / place).parent.mkdir(parents=True, exist_ok=True)
    (folder / place).write_text(json.dumps(made), "utf8")


def edited(path, before, after):
    text = path.read_text("utf8")
    assert before in text
    path.write_text(text.replace(before, after), "utf8")


def test_from_nothing_to_a_second_term(run, tmp_path, monkeypatch):
    folder = tmp_path / "my-course"
    (folder / "roster.csv").write_text(
        "student,name\nada,Ada Lee\nben,Ben Moe\ncem,C Oz\ndan,D Ek\n"
    )
    (folder / "book.csv").write_text(BOOK)
    assert "Every question passed." in run("selftest solutions/first-steps.ipynb")
    monkeypatch.setattr(
        "coursework.authoring.selftest.selftest", Mock(side_effect=KeyboardInterrupt)
    )
    assert run("selftest", fails=True) == "\nStopped.\n"
    assert run("new ../kurs-für-Anfänger") and "Kurs für Anfänger" in (
        tmp_path / "kurs-für-Anfänger" / "course.toml"
    ).read_text("utf8")
    # Before anything is graded, each command says so, and what it cannot use.
    hand_in(folder, "handed-in/ada/first-steps.ipynb")
    for command, said in (
        ("regrade marks", "There are no records"),
        ("why marks ada first-steps", "nobody yet. If your marks are elsewhere"),
        ("term new marks --roster course.toml", "lists no students"),
        ("grade handed-out --out marks", "does not exist"),
        ("merge marks handed-out.csv", "does not exist"),
        ("cluster --keys keys --host 192.0.2.7", "cluster: Cannot assign requested address"),
        ("cluster --keys keys", "give the address at which workers can reach this machine"),
        ("term marks", "marks/term.toml: No such file or directory. Create it with"),
        ("merge marks solutions", "solutions is a folder. Give the file journal.jsonl in it."),
        ("merge marks handed-in/ada/first-steps.ipynb", "the columns student, question and words"),
        ("export marks --as-of 1.12.2026", "invalid time value: '1.12.2026'"),
    ):
        refused = run(command, fails=True)
        assert said in refused and len(refused) < 1200
    assert not (folder / "marks").exists()
    assert "Read it, and make your choices" in run("term new marks --roster roster.csv")
    term = folder / "marks" / "term.toml"
    begun = "[assignments.first-steps]\n"
    edited(term, begun, f'{begun}due = 2025-10-05T23:59:00\ncolumn = "First steps"\n')
    hand_in(folder, "handed-in/ben/first-steps.ipynb", area="area = b*h")
    hand_in(folder, "handed-in/cem/first-steps.ipynb", area="area = ...", slope="slope = ...")
    assert "Give the folder with the submissions" in run("grade . --out marks", fails=True)
    assert "handed in nothing: dan" in run("grade handed-in --out marks")
    assert "ada, first-steps: 6 of 6 points." in run("why marks ada first-steps")
    assert "area: wrong (This is the area of the rectangle" in run("why marks ben first-steps")
    for command, said in (
        ("why marks ada first-step", "Did you mean 'first-steps'?"),
        ("why marks ada FIRST-STEPS", "Did you mean 'first-steps'?"),
        ("why marks ADA first-steps", "Did you mean 'ada'?"),
        ("export marks --lms solutions", "We cannot read solutions: Is a directory."),
        ("export marks --feedback solutions", "solutions is a folder. Give"),
        (
            "gradescope marks --assignment first-steps --out solutions",
            "solutions is a folder. Give",
        ),
    ):
        assert said in run(command, fails=True) and not list(folder.glob(".half-*"))
    said = run("export marks --lms book.csv --feedback feedback.zip")
    assert "4 marks filled in" in said and "3 pages of feedback" in said
    # A corrected question changes marks once somebody agrees, and the next export lists the
    # changes.
    edited(
        folder / "solutions" / "first-steps.ipynb", "symbols='x', worth=2", "symbols='x', worth=4"
    )
    assert "'ben', first-steps: 5 of 6 -> 7 of 8" in run("regrade marks", fails=True)
    assert "Marks changed: 3." in run("regrade marks --yes")
    term.write_text(term.read_text() + '\n[extensions.cemm]\nfirst-steps = "excused"\n')
    assert "nobody in the course has that ID" in run("export marks --lms book.csv", fails=True)
    edited(term, "extensions.cemm", "extensions.cem")
    said = run("export marks --lms book-filled.csv --filled book-filled.csv")
    assert "  ben: 5 -> 5.25" in said and "  cem: 3 stays" in said
    # Then come a second attempt, an appeal, and the totals.
    hand_in(folder, "handed-in/ben/first-steps-2.ipynb")
    assert "'ben', first-steps: 7 -> 8" in run("grade handed-in --out marks", fails=True)
    run("grade handed-in --out marks --yes")
    (folder / "appeals.csv").write_text("student,question,words\ncem,first-steps/area,Why?\n")
    assert "Lines imported from appeals.csv: 1." in run("merge marks appeals.csv --grader Ann")
    assert "Lines imported from appeals.csv: 0." in run("merge marks appeals.csv --grader Ann")
    run("term marks")
    assert '"ben","100"' in (folder / "marks" / "course" / "course.csv").read_text()
    # The next term has other students and other numbers.
    edited(folder / "course.toml", 'title = "My course"', 'title = "My course"\nedition = "2027"')
    edited(folder / "course.toml", 'edition = "2027"', 'edition = "2027"\nroster = true')
    # After the deadline, whoever gave up may read the worked solution.
    code = run("release first-steps").rpartition("first-steps: ")[2].strip()
    asked = f"import coursework; print(coursework.worked_solution('first-steps/slope', '{code}'))"
    shown = subprocess.check_output(
        [sys.executable, "-c", asked], cwd=folder / "exercises", text=True
    )
    assert "A worked solution comes" in shown
    (folder / "next.csv").write_text("student\neva\nfay\n")
    run("term new marks-2027 --roster next.csv")
    assert "already exists" in run("term new marks-2027 --roster next.csv", fails=True)
    hand_in(folder, "next/eva/first-steps.ipynb")
    run("grade next --out marks-2027")
    assert "6 points" not in run("why marks-2027 eva first-steps")


def ticked(table, **ticks):
    """Fill in the column `tick` like a spreadsheet: for each question, by a student's name."""
    rows = read_table(table)
    for row in rows:
        row["tick"] = ticks[row["question"].partition("/")[2]](row["student"])
    write_table(table, rows)


def test_a_sitting_of_a_class(run, tmp_path, monkeypatch):
    """It is printed, ticked, merged, appealed and exported, with homework on the same questions."""
    folder = tmp_path / "my-course"
    place = folder / "marks" / "sittings" / "quiz"
    (folder / "roster.csv").write_text("student\n" + "".join(f"s-{n:02}\n" for n in range(30)))
    edited(
        folder / "solutions" / "first-steps.ipynb", "worth=1", "worth=1, credit={'authored': 0.5}"
    )
    run("term new marks --roster roster.csv")
    hand_in(folder, "handed-in/s-00/first-steps.ipynb")
    run("grade handed-in --out marks")
    assert "mean asks for a function" in run("sitting marks no --questions first-steps/mean", True)
    command = "sitting marks quiz --questions first-steps/area first-steps/slope"
    assert "quiz/sheets." in run(command)
    monkeypatch.setattr(sitting, "BROWSERS", ())
    assert "Print the pages from your browser" in run("sitting marks quiz --paper letter")
    sheets, markers = ((place / f"{name}.html").read_text() for name in ("sheets", "markers"))
    assert "size: letter" in sheets and sheets.count("<section") == markers.count("<section") == 30
    assert (
        "check(" not in sheets
        and "rectangle" not in sheets
        and "Run the cell" not in sheets
        and "rectangle" in markers
    )
    assert "`coursework review`: 30." in run("export marks --assignment quiz --nbgrader n.csv")
    # A letter without a box enters nothing. Each box is worth what it says.
    merge = "merge marks marks/sittings/quiz/ticks.csv --grader Ann"
    ticked(place / "ticks.csv", area=lambda student: "Q", slope=lambda student: "A")
    assert "'Q' is neither a credit from 0 to 1, nor points" in run(merge, fails=True)
    ticked(
        place / "ticks.csv", area=lambda name: "b" if name < "s-10" else "A", slope=lambda _: "A"
    )
    assert "ticks.csv: 60." in run(merge) and "ticks.csv: 0." in run(merge)
    assert "quiz: 2.5 of 3 points" in run("why marks s-00 quiz")
    # Printed again, the table keeps its ticks, and the answers keep their decisions.
    run(command)
    assert "ticks.csv: 0." in run(merge)
    (folder / "appeals.csv").write_text("student,question,words\ns-01,first-steps/area,Why?\n")
    run("merge marks appeals.csv")
    page = folder / "marks" / "feedback" / "s-01" / "quiz.html"
    assert "area of the rectangle" in page.read_text() and "Your appeal" in page.read_text()
    ticked(
        place / "ticks.csv", area=lambda name: "b" if name == "s-00" else "A", slope=lambda _: "A"
    )
    assert "9 students would gain" in run(merge, fails=True)
    run("regrade marks --yes")
    # Later submissions are graded as usual, and the sheets stay as they are.
    hand_in(folder, "handed-in/s-01/first-steps.ipynb")
    assert "28 handed in nothing" in run("grade handed-in --out marks")
    # Homework on the same questions counts up to the share in the sitting, and a little more.
    (folder / "book.csv").write_text(BOOK.replace("ada", "s-00").replace("ben", "s-01"))
    columns = "column = 'First steps'\nhomework-cap = 0.25\n"
    edited(
        folder / "marks" / "term.toml", '"quiz"]\n', f'"quiz"]\n{columns}homework-factor = 0.5\n'
    )
    assert "has both: choose one" in run("term marks", fails=True)
    edited(folder / "marks" / "term.toml", "homework-factor = 0.5\n", "")
    run("regrade marks")
    run("term marks")
    assert "plus 25 % of the points" in (folder / "marks" / "report.html").read_text()
    run("export marks --lms book.csv --assignment first-steps")
    assert '"Lee, Ada",1,,s-00,x,5.75' in (folder / "book-filled.csv").read_text()
    run("export marks --lms book.csv --assignment quiz")
    assert '"Moe, Ben",2,,s-01,x,6' in (folder / "book-filled.csv").read_text()
