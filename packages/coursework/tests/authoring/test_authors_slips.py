"""An author's omissions and typos are refused before anything is released, with advice."""

from pathlib import Path

import pytest
from trial_course import made_in, write_source

from coursework.authoring.author import AuthorError
from coursework.authoring.release import release
from coursework.authoring.source import read_source
from coursework.authoring.trial import trial

SETUP = "import sympy as sm\nfrom coursework import check, student, variant\nx = sm.Symbol('x')"
ANSWER = "### BEGIN SOLUTION\nanswer = 3 * x\n### END SOLUTION"
CHECK = "check('trial/one', answer)"
QUESTION = (
    "### BEGIN HIDDEN TESTS\nquestion('trial/one', kind='expression', symbols='x')\n"
    "### END HIDDEN TESTS"
)
DRAWN = "### BEGIN VARIANTS\ndrawn = draw('trial/one', count=3, n=[1, 2, 3])\n### END VARIANTS"


def sources(
    folder, answer=ANSWER, check=CHECK, question=QUESTION, before=(), text="Give it as `answer`."
):
    cells = [
        ("code", SETUP),
        *before,
        ("markdown", text),
        ("code", "\n".join([answer, check, question])),
    ]
    return write_source(folder, *cells)


def changed(old, new, text=QUESTION):
    assert old in text
    return text.replace(old, new)


@pytest.mark.parametrize(
    "slip, said",
    [
        (
            {"answer": "answer = 3 * x"},
            "no solution in trial.ipynb sets `answer`, so students would see the answer",
        ),
        (
            {"answer": ANSWER.removesuffix("### END SOLUTION")},
            "cell 2: `### BEGIN SOLUTION` has no `### END SOLUTION`",
        ),
        (
            {"answer": ANSWER.removeprefix("### BEGIN SOLUTION")},
            "`### END SOLUTION` has no `### BEGIN SOLUTION` before",
        ),
        (
            {"answer": changed("BEGIN SOLUTION", "BEGIN SOLUTIONS", ANSWER)},
            "`### BEGIN SOLUTIONS` is not a marker; the",
        ),
        ({"answer": changed("### BEGIN", "# BEGIN", ANSWER)}, "`# BEGIN SOLUTION` is not a marker"),
        (
            {"answer": changed("BEGIN SOLUTION", "begin solution", ANSWER)},
            "`### begin solution` is not a marker",
        ),
        (
            {"question": QUESTION.removesuffix("### END HIDDEN TESTS")},
            "has no `### END HIDDEN TESTS`",
        ),
        (
            {"question": "question('trial/one', kind='expression', symbols='x')"},
            "or students would see it",
        ),
        (
            {"check": "check('trial/other', answer)"},
            "call `question` below its check; checked so far: trial/other",
        ),
        ({"question": changed("kind='expression', ", "")}, "trial/one: give its kind"),
        (
            {
                "question": changed("expression", "sense"),
                "answer": changed("3 * x", "'left'", ANSWER),
            },
            "the kind 'sense' of a plug-in has answers in words, so its `Kind` needs `another`",
        ),
        (
            {"question": changed("symbols", "symbol")},
            "`question` has no argument `symbol`. Did you mean `symbols`?",
        ),
        ({"question": changed("'x')", "'x', points=3)")}, "Did you mean `worth`?"),
        (
            {"question": changed("'x')", "'x', hints=['Think.'])")},
            "`hints` must be a dictionary whose keys are strings",
        ),
        (
            {"question": changed("'x')", "'x', hints={'opposite': 'Think.'})")},
            "hints of 'opposite' must be a list of strings",
        ),
        (
            {"question": changed("'x')", "'x', hints={'oposite': ['Think.']})")},
            "`hints` names 'oposite', but this",
        ),
        (
            {"question": changed("'x')", "'x', after={'a/b': 'Think.'})")},
            "hints of 'a/b' must be a list of strings",
        ),
        (
            {"question": changed("'x')", "'x', credit={'oposite': 0.5})")},
            "has no such mistake. Its mistakes are 'opposite'",
        ),
        (
            {"question": changed("'x')", "'x', credit={'opposite': 50})")},
            "must be a fraction from 0 to 1, not 50",
        ),
        (
            {"question": changed("'x')", "'x', tolerance=0, relative=0.01)")},
            "more than zero, not 0. With `rel",
        ),
        (
            {"question": changed("'x')", "'x', relative=2)")},
            "`relative` must be a fraction between 0 and 1, not 2",
        ),
        (
            {
                "question": changed(
                    "expression', symbols='x'", "function', result='expression', calls=[1, 2]"
                )
            },
            "`calls` must be a list of calls, each a list of arguments; calls=[[1], [2]]",
        ),
        (
            {"answer": changed("3 * x", "3.14 * x", ANSWER)},
            "the solution uses 3.14 for pi, so a student who uses all",
        ),
        ({"answer": changed("3 * x", "3.1416 * x", ANSWER)}, "the solution uses 3.1416 for pi"),
        ({"before": [("code", DRAWN)]}, "trial/one: you draw n, but students would not see it"),
        (
            {
                "before": [("code", changed("[1, 2, 3]", "[0.1 + 0.2, 1, 2]", DRAWN))],
                "text": "Of {{n}}, give `answer`.",
            },
            "its text would show 0.30000000000000004 for n. Round it",
        ),
        (
            {"question": changed("'x')", "'x', worth='two')")},
            "`worth` must be a number of points, not 'two'",
        ),
        (
            {"question": changed("'x')", "'x', mistakes={x: 'It is more.'})")},
            "`mistakes` must be a dictionary whose",
        ),
        (
            {
                "question": changed("expression', symbols='x'", "measurement'"),
                "answer": changed("3 * x", "3.2", ANSWER),
            },
            "give a number and its unit, such as `(3.2, 'kN m')`. Here it is 3.2.",
        ),
        (
            {
                "question": changed("expression', symbols='x'", "measurement'"),
                "answer": changed("3 * x", "(25, '°C')", ANSWER),
            },
            "`°C` is not a unit we know",
        ),
        (
            {"question": changed("symbols='x'", "symbols={'x': (1e11, 3e11)}")},
            "'x' is tried from 1e+11 to 3e+11, but a range must be at most 10000 wide. It need",
        ),
        (
            {"question": changed("symbols='x'", "symbols={'x': (1, float('inf'))}")},
            "'x' is tried from 1 to inf, but a range must be at most 10000 wide",
        ),
        (
            {"before": [("code", changed("[1, 2, 3]", "'123'", DRAWN))], "text": "Add {{n}}."},
            "trial/one: give n a list of values, or a function such as",
        ),
        (
            {"before": [("code", changed("[1, 2, 3]", "[]", DRAWN))], "text": "Add {{n}}."},
            "chance.randint(1, 6)`, not []",
        ),
        (
            {"before": [("code", changed("=3", "='3'", DRAWN))], "text": "Add {{n}}."},
            "`count` must be a whole number, at least 1, not '3'",
        ),
        (
            {"before": [("code", "drawn = draw('trial/one', n=[1])")], "text": "Add {{n}}."},
            "call `draw` between `### BEGIN VARIANTS`",
        ),
        (
            {"before": [("code", DRAWN)], "text": "Add {{m}}."},
            "its text shows {{m}}, which you have not drawn; you have drawn n.",
        ),
        *(
            (
                {"before": [("code", f"import math\n{line}")]},
                f"trial.ipynb, cell 1, line 2: `{line}` is not Python. It works only in Jupyter",
            )
            for line in ("%matplotlib inline", "!ls", "?print", "print?", "files = !ls")
        ),
        ({"before": [("code", "y = (1")]}, "cell 1, line 1: `y = (1` is not Python ('(' was never"),
        (
            {"before": [("code", changed("trial/one", "trial/none", DRAWN))], "text": "Add {{n}}."},
            "trial/none: trial.ipynb draws variants for it, but asks no such question; it asks "
            "trial/one.",
        ),
    ],
)
def test_a_slip_is_refused_and_explained(tmp_path, slip, said):
    read_source(sources(tmp_path))
    with pytest.raises(AuthorError) as told:
        read_source(sources(tmp_path, **slip))
    assert said in str(told.value)


@pytest.mark.parametrize(
    "slip, said",
    [
        (
            {"question": changed("'x')", "'x', mistakes={'Not so.': x + 2 * x})")},
            "gives the right answer: Not so.",
        ),
        (
            {"before": [("code", DRAWN)], "text": "Add {{n}}."},
            "all students would get the same numbers",
        ),
        (
            {
                "answer": changed("3 * x", "'left'", ANSWER),
                "question": changed("symbols='x'", "options=['left', 'right', 'Left']").replace(
                    "expression", "choice"
                ),
            },
            "Its options 'left' and 'Left' count as the same answer",
        ),
        (
            {"question": changed("'x')", "'x', solution='So $\\theta$ is $\\frac{1}{2}$.')")},
            "Python reads a backslash in 'So $\\theta$ is $\\x0crac{1}{2}$.' as a special",
        ),
        (
            {
                "check": "check('trial/o\u0308ne', answer)",
                "question": changed("trial/one", "trial/o\u0308ne"),
            },
            "An accent in this name is a character of its own",
        ),
    ],
)
def test_the_release_refuses_what_would_not_work(tmp_path, slip, said):
    made = made_in(tmp_path)
    sources(made.sources, **slip)
    with pytest.raises(AuthorError) as told:
        release(made, run=False)
    assert said in str(told.value) and not list(made.exercises.glob("*"))


def test_a_source_finds_the_files_beside_it(tmp_path):
    """As in Jupyter. Students do not get these files, so their own cells must not need them."""
    made = made_in(tmp_path)
    reads = "from slopes import slope\nanswer = slope(open('slopes.csv')) * x"
    source = sources(
        made.sources,
        answer=changed("answer = 3 * x", reads, ANSWER),
        before=[("markdown", "A note of the author's")],
        text="![A beam](beam.png) Give it as `answer`. ![A beam](attachment:a.png) <img width='9' "
        "src='beam.png'>",
    )
    source.write_text(
        source.read_text()
        .replace('"cell_type": "markdown"', '"cell_type": "raw"', 1)
        .replace('"markdown"', '"markdown", "attachments": {"a.png": {"image/png": "BBBB"}}')
    )
    (made.sources / "beam.png").write_bytes(bytes(3))
    (made.sources / "slopes.py").write_text("def slope(lines):\n    return int(*lines)\n")
    (made.sources / "slopes.csv").write_text("3\n")
    assert [notebook.name for notebook in release(made, run=False)] == ["trial"]
    kept = (made.exercises / "trial.ipynb").read_text()
    assert kept.count("png;base64,AAAA") == 2 and "png;base64,BBBB" in kept and '"raw"' in kept
    sources(made.sources, before=[("code", "text = open('slopes.csv').read()")])
    with pytest.raises(AuthorError, match="do not get the files beside your notebook"):
        release(made)


def test_line_ends_of_windows_and_spaces_after_a_mark_change_nothing(tmp_path):
    from coursework.authoring.release import exercise_notebook

    written = [
        exercise_notebook(read_source(path))
        for path in (
            sources(tmp_path / "plain"),
            sources(
                tmp_path / "crlf",
                answer=ANSWER.replace("\n", "\r\n"),
                question=QUESTION.replace("\n", "\r\n"),
            ),
            sources(tmp_path / "spaces", answer=ANSWER.replace("SOLUTION", "SOLUTION  ")),
        )
    ]
    assert written[0] == written[1] == written[2] and "3 * x" not in str(written)


def test_hints_may_belong_to_one_mistake_of_the_author(tmp_path):
    hinted = "hints={'Too many.': ['Count again.'], 'authored': ['Count.']}"
    named = f"mistakes={{'Too few.': 2 * x, 'Too many.': 5 * x}}, {hinted}"
    question = read_source(sources(tmp_path, question=changed("'x')", f"'x', {named})"))).questions[
        "trial/one"
    ]
    hints = {
        entry.notes[0].details["text"]: list(entry.answers[0].hints)
        for entry in question.entries.values()
        if entry.notes and entry.notes[0][0] == "authored"
    }
    assert hints == {"Too few.": ["Count."], "Too many.": ["Count again.", "Count."]}


def test_the_preview_shows_all_that_stands_above_a_question(tmp_path):
    """The heading above a question with variants and the figure above its text were left out."""
    drawing = (
        "class Line:\n    alt = 'A line'\n    picture = lambda self: '<svg "
        'width="9"></svg>\'\nLine()'
    )
    cells = [
        ("code", f"{SETUP}\nstudent('')"),
        ("markdown", "## Another heading"),
        ("code", ANSWER.replace("answer", "other") + "\ncheck('trial/other', other)\n"
         + QUESTION.replace("/one", "/other")),
        ("markdown", "## The heading"),
        ("code", drawing, "figure"),
        ("code", DRAWN),
        ("markdown", "Add {{n}} to `x`."),
        ("code", "\n".join([ANSWER, CHECK, QUESTION.replace("'x')", "'x', exam=True)")])),
    ]  # fmt: skip
    made = made_in(tmp_path)
    write_source(made.sources, *cells)
    page = Path(trial(made, "trial/one", tmp_path / "try.html")).read_text("utf8")
    heading, figure, text = (
        page.index(part) for part in ("<h3>The heading</h3>", 'alt="A line"', "Add 1 to")
    )
    assert heading < figure < text and "Another heading" not in page and "{{n}}" not in page
    # It fits the screen of a telephone, and follows the reader's preference for a dark page.
    assert (
        'name="viewport"' in page and "color-scheme:light dark" in page and 'data-of="Kind"' in page
    )


def test_variants_with_one_answer_are_refused(tmp_path):
    made = made_in(tmp_path)
    sources(
        made.sources,
        before=[("code", "student('')"), ("code", DRAWN)],
        text="Of {{n}} apples, give `answer`.",
    )
    with pytest.raises(AuthorError, match="trial/one: all of its 3 variants have the same answer"):
        release(made, run=False)
