"""The questions for another system, read back and marked by the tests' own readers."""

import html
import re
import stat
from functools import cache, partial

import pytest
from exported_banks import marked_by_moodle, marked_by_qti, of_moodle, of_qti
from trial_course import PROJECT, SETUP, made_in, write_source

from coursework.__main__ import main
from coursework.authoring.author import AuthorError
from coursework.authoring.bank import bank
from coursework.authoring.course import find_course
from coursework.authoring.source import read_source

FORMATS = {"moodle": (of_moodle, marked_by_moodle), "qti": (of_qti, marked_by_qti)}


def judged_as_here(course, format, names, place):
    """Mark the right answer of two variants, the author's mistakes and a wrong one elsewhere."""
    read_back, marked = FORMATS[format]
    exported, left = bank(course, place / "bank", format, names)
    questions = read_back(place / "bank")
    assert len(questions) == sum(map(len, exported.values()))
    for name in exported:
        path = course.sources / f"{name.partition('/')[0]}.ipynb"
        of_notebook = tuple(other for other in exported if other.startswith(f"{path.stem}/"))
        # Variants differ in their numbers alone.
        count = authored(path, 0, only=of_notebook).questions[name].public.variants
        for number in {0, count - 1}:
            question = authored(path, number, only=of_notebook).questions[name]
            mark = partial(marked, questions.pop(f"{name}, variant {number}"))
            right = values(question.answer)
            assert mark(right)[0] == pytest.approx(1)
            for mistake in question.mistakes:
                text = str(mistake.details.get("text"))
                if mistake.note != "authored":
                    continue
                share, reply = mark(values(mistake.answer))
                assert share < 1
                assert plainly(text) in plainly(reply), (name, number, text, reply)
                if format == "qti" or len(right) == 1:
                    assert share == pytest.approx(question.credit.get("authored", 0))
            wrong = ["-777.5" if is_number(value) else "nonsense" for value in right]
            assert mark(wrong) == (0, "")
    return left


# A notebook is read once for both formats.
authored = cache(read_source)


def values(answer):
    """Return the entries of an answer, row by row, as a student types or chooses them."""
    if isinstance(answer, str):
        return [answer]
    if hasattr(answer, "tolist"):
        answer = answer.tolist()
    if isinstance(answer, (list, tuple)):
        return [value for part in answer for value in values(part)]
    return [str(answer) if isinstance(answer, bool) else f"{float(answer):.9f}"]


def is_number(value):
    return re.fullmatch(r"-?[\d.]+", value) is not None


def plainly(text):
    """Return the letters of a reply without formulas, which each format writes in its own way."""
    text = re.sub(r"\$[^$]+\$|\\\(.*?\\\)|<(\w+:)?math.*?</(\w+:)?math>", "", text)
    return re.sub(r"<[^>]*>|\W", "", html.unescape(text))


@pytest.mark.parametrize("format", FORMATS)
def test_every_variant_is_judged_elsewhere_as_it_is_here(format, tmp_path):
    course = find_course(PROJECT / "examples" / "plane-statics")
    left = judged_as_here(course, format, [], tmp_path)
    assert {
        "equilibrium/cantilever: its answer is a function.",
        "equilibrium/ladder: its answer is a formula in W, theta.",
        "units/torque: its answer is a number with a unit.",
    } <= set(left)
    listed = (tmp_path / "bank-not-exported.txt").read_text("utf8")
    assert listed.splitlines() == left
    assert stat.S_IMODE((tmp_path / "bank").stat().st_mode) == 0o600


ODD = 'Is <i>1</i> < 2 & 3 > 2, says "he"? {1:SHORTANSWER:=cheat} ]]> $a < b$ <br>'
CHOICE = """
### BEGIN HIDDEN TESTS
question('trial/odd', kind='words', options=['=a~b#c', 'x & {y}', '50% <z>'], length=2, worth=2,
         credit={'authored': 0.5}, solution='$\\\\{a\\\\} < b$ ]]>',
         mistakes={'Not ~ } # $\\\\{a\\\\}$ `=` <b>': ['50% <z>', 'x & {y}']})
### END HIDDEN TESTS"""


@pytest.fixture
def odd(tmp_path):
    course = made_in(tmp_path / "course", tmp_path / "solutions")
    solution = "given = [7, 11]\n### BEGIN SOLUTION\nodd = ['=a~b#c', 'x & {y}']\n### END SOLUTION"
    cells = [
        ("code", SETUP),
        ("markdown", ODD),
        ("code", solution),
        ("code", f"check('trial/odd', odd){CHOICE}"),
    ]
    write_source(course.sources, *cells)
    return course


@pytest.mark.parametrize("format", FORMATS)
def test_signs_with_a_meaning_are_only_signs(odd, format, tmp_path):
    read_back, marked = FORMATS[format]
    ((item,),) = bank(odd, tmp_path / "bank", format)[0].values()
    (question,) = read_back(tmp_path / "bank").values()
    assert item.text.endswith("```python\ngiven = [7, 11]\n```")
    assert marked(question, ["=a~b#c", "x & {y}"])[0] == 1
    share, reply = marked(question, ["50% <z>", "x & {y}"])
    # Moodle adds half of the first entry and all of the second.
    assert share == {"moodle": 0.75, "qti": 0.5}[format]
    assert "Not ~ } # " in reply and "<code>=</code> &lt;b&gt;" in re.sub(
        r"\w+:(?=code)", "", reply
    )


def test_what_holds_answers_is_not_written_where_students_look(odd, tmp_path, monkeypatch, capsys):
    for folder in (odd.exercises, odd.sealed, odd.archive.parent):
        with pytest.raises(AuthorError, match="would contain all answers"):
            bank(odd, folder / "deep" / "bank.xml", "moodle")
    monkeypatch.chdir(PROJECT / "examples" / "plane-statics")
    to_moodle = ["bank", str(tmp_path / "a.xml"), "--format", "moodle", "--questions"]
    for name, why in (
        ("units/even", "no question or notebook 'units/even'"),
        ("units/torque", r"(?s)no file was written.*units/torque: its answer"),
    ):
        with pytest.raises(SystemExit, match=why):
            main([*to_moodle, name])
    assert not [*tmp_path.glob("a*")]
    main([*to_moodle, "units/which"])
    assert "HOLDS ALL ANSWERS AND SOLUTIONS. It is for instructors only" in capsys.readouterr().out
