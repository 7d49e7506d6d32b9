"""Every question of the book, tried as students will try it."""

import pytest
from test_release import CELLS, COURSE, made_in, needs_solutions, write_source

from coursework.__main__ import main
from coursework.authoring import release
from coursework.authoring import selftest as selftest_module
from coursework.authoring.attack import BUDGET, CODE, Found
from coursework.authoring.author import AuthorError
from coursework.authoring.packing import archive as pack
from coursework.authoring.selftest import (
    _try_notebook,
    leaks,
    measure,
    measured_of,
    released_texts,
    selftest,
    text_of,
    try_question,
    write_measured,
    write_page,
)
from coursework.authoring.source import measured_strengths, names_asked, said_beyond

SOURCES = {path.stem: path for path in sorted(COURSE.sources.glob("*.ipynb"))}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", SOURCES)
def test_every_question_passes_and_names_its_mistakes(name):
    source = release.read_source(SOURCES[name])
    # How hard each is to guess takes long to find, and is tried elsewhere.
    findings = [try_question(question, budget=0) for question in source.questions.values()]
    assert [fault for finding in findings for fault in finding.faults] == []
    assert "<h1>" in write_page(findings, [])
    if name != release.CHAPTERS:
        assert len(findings) >= 4
        assert leaks([source], released_texts(COURSE.exercises, COURSE.sealed, "none")) == []


@needs_solutions
def test_what_was_measured_of_the_book_is_of_questions_that_it_asks():
    """It stands beside the sources, for the grader's report; a question
    that is gone is to go there, too.
    """
    measured = measured_strengths(COURSE.sources)
    asked = {name for path in SOURCES.values() for name in names_asked(path)}
    assert set(measured) <= asked and len(measured) > 100
    assert all(0 <= tries <= BUDGET for tries in measured.values())


@pytest.mark.long
@needs_solutions
def test_a_question_of_a_chapter_is_attacked_with_its_text_in_the_chapter():
    """Its source has no text: without the chapter's an attack would know none of
    the numbers that a student reads.
    """
    source = release.read_source(SOURCES[release.CHAPTERS])
    texts = [
        text_of(source, question, COURSE).partition(CODE)[0]
        for question in source.questions.values()
    ]
    assert all("{exercise}" in text or "Bind" in text for text in texts)


@needs_solutions
@pytest.mark.long
def test_nothing_leaks_into_the_archive(tmp_path):
    archive = pack(COURSE, tmp_path / "exercises.zip")
    sources = [release.read_source(path) for path in SOURCES.values()]
    assert leaks(sources, released_texts(COURSE.exercises, COURSE.sealed, archive)) == []


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
    with pytest.raises(SystemExit, match="ask no question"):
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
    faults = selftest(made_in(tmp_path, sources=tmp_path), tmp_path / "page.html", budget=50)
    assert any("gives the right answer" in fault for fault in faults)
    assert "gives the right answer" in (tmp_path / "page.html").read_text("utf8")


def test_a_variant_that_is_guessed_sooner_than_the_first_is_found(tmp_path):
    made = made_in(tmp_path)
    write_source(
        made.sources,
        ("markdown", "# Levers"),
        ("code", "from coursework import check, student, variant\nstudent('')"),
        (
            "code",
            "### BEGIN VARIANTS\nlever = draw('levers/arm', count=3, arm=[0.7391234, 1, 2])\n"
            "### END VARIANTS",
        ),
        ("markdown", "A square has sides of {{arm}} m. What is its area?"),
        ("code", "### BEGIN SOLUTION\narm = lever.arm**2\n### END SOLUTION"),
        (
            "code",
            "check('levers/arm', arm)\n### BEGIN HIDDEN TESTS\n"
            "question('levers/arm', kind='expression')\n"
            "### END HIDDEN TESTS",
        ),
        name="levers",
    )
    release.release(made, run=False)
    findings, measured, _ = _try_notebook(made.sources / "levers.ipynb", made, 100)
    assert findings[0].attack.way and findings[0].attack.tries < 100
    # Every variant is attacked, and each counts for its part of the points.
    assert measured["levers/arm"]["tries"][0] == 0 and all(measured["levers/arm"]["tries"][1:])
    assert said_beyond(measured).startswith("33% of 1 point are")


def test_what_was_measured_is_measured_again_only_where_something_has_changed(
    tmp_path, monkeypatch
):
    made = made_in(tmp_path)
    write_source(made.sources, *CELLS)
    tried = []
    monkeypatch.setattr(
        selftest_module,
        "attack",
        lambda question, *_: tried.append(question.name) or Found(7, "a way"),
    )
    source = release.read_source(made.sources / "trial.ipynb")

    def measure_all():
        tried.clear()
        measured = measured_of(source, made, source.questions, all_variants=True)
        write_measured(made.sources, [], measured)
        return list(tried)

    assert measure_all() == list(source.questions) and measure_all() == []
    assert set(measured_strengths(made.sources).values()) == {7}
    monkeypatch.setattr(selftest_module, "digest_of_attack", lambda: "another attack")
    assert measure_all() == list(source.questions)
    cell = next(cell for cell in source.notebook.cells if "BEGIN SOLUTION" in cell.source)
    cell.source += "\n# changed"
    changed = measure_all()
    assert changed and (len(source.questions) == 1 or len(changed) < len(source.questions))


def test_what_was_measured_is_written_down_with_its_version(tmp_path):
    made = made_in(tmp_path)
    write_source(made.sources, *CELLS)
    lines = measure(made)
    measured = measured_strengths(made.sources)
    assert 0 < measured["trial/about-x"] < 1000
    assert any(f"found after {measured['trial/about-x']} slow hashes" in line for line in lines)
    file = made.sources / "strengths.json"
    file.write_text(file.read_text("utf8").replace('"format": 2', '"format": 9'), "utf8")
    with pytest.raises(AuthorError, match="another version"):
        measured_strengths(made.sources)


@pytest.mark.parametrize(
    ("step", "said"),
    [
        ("It is `3 * sm.cos(x) * sm.sin(x)` all along.", "gives the right answer"),
        ("It is `answer = 1.5*sin(2*x)`.", "gives the right answer"),
        ("Write down: answer = 3 * sm.sin(x) * sm.cos(x)", "holds a line of a solution"),
        ("Begin with `sm.sin(x)`, and ask what is missing.", ""),
    ],
)
def test_a_step_of_the_ladder_that_holds_the_answer_is_refused_and_listed(tmp_path, step, said):
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
    if said:
        with pytest.raises(AuthorError, match=f"trial/one.*anybody can open.*{said}"):
            release.release(made, run=False)
    else:
        release.release(made, run=False)
    faults = selftest(made, None, budget=1)
    assert any("anybody can open" in fault and said in fault for fault in faults) == bool(said)
