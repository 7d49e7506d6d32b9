"""The instructors' page of the book shows what its sample class gives."""

import io
import re
import textwrap
from collections import Counter
from pathlib import Path

import pytest
import sample_class

from coursework.grading.commands import ARGUMENTS
from coursework.grading.export import gradebooks
from coursework.grading.grade import grade, regrade
from coursework.grading.judging.journal import Journal
from coursework.grading.store import Store

PAGE = Path(__file__).parents[4] / "appendix" / "instructors.md"


def reference():
    """All commands, as their help says it; what several take is said once."""
    times = Counter(str(argument) for _, arguments in ARGUMENTS.values() for argument in arguments)
    several = {
        str(argument): argument
        for _, arguments in ARGUMENTS.values()
        for argument in arguments
        if times[str(argument)] > 1
    }
    parts = [("common options", "shared by several commands", list(several.values()))]
    for command, (does, arguments) in ARGUMENTS.items():
        own = [argument for argument in arguments if str(argument) not in several]
        parts.append((f"coursework {command}", does, own))
    lines = []
    for command, does, arguments in parts:
        lines += [f"**{command}**: {does}", ""]
        for names, options in arguments:
            name = names[0] if names[0].startswith("--") else options.get("metavar", names[0])
            if name.startswith("--") and options.get("action") != "store_true":
                name += f" {options.get('metavar', name.strip('-').upper())}"
            help_text = options["help"].replace("%(default)s", str(options.get("default")))
            text = f"- `{name}`: {help_text}"
            lines += textwrap.wrap(text, 120, subsequent_indent="  ", break_on_hyphens=False)
        lines += [""] if arguments else []
    return "\n".join(lines).rstrip() + "\n"


def test_the_list_of_commands_is_made_from_their_help():
    made = PAGE.read_text("utf8").partition("This list is generated from the commands' help.\n\n")[
        2
    ]
    assert made == reference(), reference()


def _toml():
    """The examples of term.toml."""
    return re.findall(r"```toml\n(.*?)```", PAGE.read_text("utf8"), re.S)


@pytest.mark.long
def test_the_instructors_page_shows_what_the_sample_class_gives(tmp_path):
    output = io.StringIO()
    notebooks = ["simple-orientations", "unit-quaternions"]
    submissions = sample_class.make_class(tmp_path / "class", 200, 1, notebooks)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "term.toml").write_text(_toml()[0])
    grade(submissions, tmp_path / "out", show=output)
    manual = PAGE.read_text("utf8")
    report = (tmp_path / "out" / "report.html").read_text("utf8")
    for line in output.getvalue().splitlines():
        if line.startswith(("196 to grade", "Isolation:")):
            assert line.partition("(")[0] in manual
    (about,) = re.findall(r"<p>(\d+ students)\. The (mean is .*?)\.</p>", report)
    assert "; the ".join(about) in manual
    rows = re.findall(r"^\| (\d+) % \| .*\((\d+) of (\d+)\) \|$", manual, re.M)
    shares = re.findall(r"<strong>(\d+) %</strong>.*?\((\d+) of (\d+)\)</span>", report, re.S)
    assert len(rows) == 4 and rows == shares[:4]
    # Something is decided, and the gradebook filled, line for line as the page
    # prints it; only places are others.
    store, journal = Store(tmp_path / "out"), Journal(tmp_path / "out")
    (record,) = [
        record_of_class
        for record_of_class in store.all()
        if record_of_class.student == "student-075"
    ]
    journal.add(record, "unit-quaternions/two-ways", 0.5, who="Ann")
    (move,) = regrade(tmp_path / "out", show=output).moves
    assert f"\n  {move}\nMarks changed: 1.\n" in manual
    (printed,) = re.findall(
        r"^\$ coursework export graded --lms class/gradebook.csv.*?\n(.*?)```", manual, re.M | re.S
    )
    fill_report = gradebooks.fill(tmp_path / "class" / "gradebook.csv", gradebooks.Marks(store))
    feedback = gradebooks.write_feedback(tmp_path / "feedback.zip", gradebooks.Marks(store), store)
    fill_report = "\n".join([*fill_report, f"{feedback}\n"])
    assert fill_report.replace(f"{tmp_path}/", "") == printed
