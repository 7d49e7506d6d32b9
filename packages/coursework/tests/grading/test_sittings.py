"""A sheet of a sitting has everything that its questions need."""

from trial_course import SETUP, write_source

from coursework.grading import sitting as sittings

DRAWN = (
    "### BEGIN VARIANTS\n"
    "bench = draw('trial/sum', count=2, numbers=[[31, 41], [59, 26]])\n"
    "### END VARIANTS"
)
ANSWERED = "numbers = bench.numbers\n### BEGIN SOLUTION\ntotal = sum(numbers)\n### END SOLUTION"
ASKED = (
    "check('trial/sum', total)\n### BEGIN HIDDEN TESTS\n"
    "question('trial/sum', kind='expression')\n### END HIDDEN TESTS"
)


def test_a_sheet_shows_the_numbers_that_only_a_cell_has(tmp_path, monkeypatch):
    monkeypatch.setattr(sittings, "BROWSERS", ())  # These would make a PDF of it.
    cells = [("code", SETUP), ("code", DRAWN), ("markdown", "Set `total` to their sum.")]
    cells += [("code", ANSWERED), ("code", ASKED)]
    source = write_source(tmp_path / "solutions", *cells)
    (tmp_path / "marks").mkdir()
    (tmp_path / "marks" / "term.toml").write_text("time-zone = 'UTC'\n[assignments.trial]\n")
    (tmp_path / "roster.csv").write_text("student,name\nada,Ada\nben,Ben\ncem,Cem\ndan,Dan\n")
    sheets, markers, _ = sittings.sitting(
        tmp_path / "marks",
        "quiz",
        ["trial/sum"],
        roster=str(tmp_path / "roster.csv"),
        solutions=source.parent,
    )
    text = sheets.read_text("utf8")
    assert "≈ 72<" in markers.read_text("utf8")
    assert "numbers = [31, 41]" in text and "numbers = [59, 26]" in text
