"""Every question of the book, tried as students will try it."""

import pytest
from test_release import CELLS, COURSE, made_in, needs_solutions, write_source

from coursework.__main__ import main
from coursework.authoring import release
from coursework.authoring.author import AuthorError
from coursework.authoring.packing import archive as pack
from coursework.authoring.selftest import (
    found_in,
    released_texts,
    secrets_of,
    selftest,
    try_question,
    write_page,
)

SOURCES = {path.stem: path for path in sorted(COURSE.sources.glob("*.ipynb"))}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", SOURCES)
def test_every_question_passes_and_names_its_mistakes(name):
    source = release.read_source(SOURCES[name])
    findings = [try_question(question) for question in source.questions.values()]
    assert [fault for finding in findings for fault in finding.faults] == []
    assert "<h1>" in write_page(findings, [])
    if name != release.CHAPTERS:
        assert len(findings) >= 4
        released = released_texts(COURSE.exercises, COURSE.sealed, "none")
        assert found_in(released, secrets_of(source)) == []


@needs_solutions
@pytest.mark.long
def test_nothing_leaks_into_the_archive(tmp_path):
    archive = pack(COURSE, tmp_path / "exercises.zip")
    sources = [release.read_source(path) for path in SOURCES.values()]
    received = released_texts(COURSE.exercises, COURSE.sealed, archive)
    for source in sources:
        if source.name != release.CHAPTERS:
            assert found_in(received, secrets_of(source)) == []
    # The questions to ask aloud stand beside the solutions.
    assert not any("spoken-questions" in name for name in received)


def test_nothing_to_try_is_not_a_pass(tmp_path):
    with pytest.raises(SystemExit, match="no notebook with solutions in .*empty"):
        main(
            [
                "selftest",
                "--sources",
                str(tmp_path / "empty"),
                "--page",
                str(tmp_path / "page.html"),
            ]
        )
    write_source(tmp_path / "text", ("markdown", "# Nothing is asked here"))
    with pytest.raises(SystemExit, match="have no questions"):
        main(
            ["selftest", "--sources", str(tmp_path / "text"), "--page", str(tmp_path / "page.html")]
        )
    assert not (tmp_path / "page.html").exists()


def test_a_question_with_a_fault_is_found(tmp_path):
    cells = [
        (kind, text.replace("worth=2,", "worth=2, mistakes={'A wrong remark.': A_C_N},"), *tags)
        for kind, text, *tags in CELLS
    ]
    write_source(tmp_path, *cells)
    faults = selftest(made_in(tmp_path, sources=tmp_path), tmp_path / "page.html")
    assert any("gives the right answer" in fault for fault in faults)
    assert "gives the right answer" in (tmp_path / "page.html").read_text("utf8")


@pytest.mark.parametrize(
    ("step", "message"),
    [
        ("It is `3 * sm.cos(x) * sm.sin(x)` all along.", "gives the right answer"),
        ("It is `answer = 1.5*sin(2*x)`.", "gives the right answer"),
        ("Write down: answer = 3 * sm.sin(x) * sm.cos(x)", "contains a line of a solution"),
        ("Begin with `sm.sin(x)`, and ask what is missing.", ""),
    ],
)
def test_a_step_of_the_ladder_that_holds_the_answer_is_refused_and_listed(tmp_path, step, message):
    """No secret locks the ladder: whoever reads our code can open it."""
    made = made_in(tmp_path)
    write_source(
        made.sources,
        ("code", "import sympy as sm\nfrom coursework import check\nx = sm.Symbol('x')"),
        ("markdown", "What is it? Call it `answer`."),
        (
            "code",
            "### BEGIN SOLUTION\nanswer = 3 * sm.sin(x) * sm.cos(x)\n### END SOLUTION\n"
            "check('trial/one', answer)\n"
            "### BEGIN HIDDEN TESTS\nquestion('trial/one', kind='expression', symbols='x', "
            f"ladder=[{step!r}])\n"
            "### END HIDDEN TESTS",
        ),
    )
    if message:
        with pytest.raises(AuthorError, match=f"trial/one.*anybody can open.*{message}"):
            release.release(made, run=False)
    else:
        release.release(made, run=False)
    faults = selftest(made, None)
    assert any("anybody can open" in fault and message in fault for fault in faults) == bool(
        message
    )
