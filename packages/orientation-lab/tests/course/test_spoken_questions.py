"""Every notebook of exercises has three questions to ask aloud."""

import re

from test_release import COURSE, needs_solutions

from coursework.authoring.release import CHAPTERS


def _parts(text, heading):
    """What stands under each heading of this level, by the heading."""
    parts = re.split(rf"^{heading} (.*)$", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


@needs_solutions
def test_each_notebook_has_three_questions_with_a_good_answer_and_three_wrong_ones():
    notebooks = _parts((COURSE.sources / "spoken-questions.md").read_text("utf8"), "##")
    assert set(notebooks) == {path.stem for path in COURSE.sources.glob("*.ipynb")} - {CHAPTERS}
    for name, text in notebooks.items():
        questions = _parts(text, "###")
        assert len(questions) == 3, name
        for title, question in questions.items():
            assert question.count("\n**A good answer**: ") == 1, (name, title)
            assert len(re.findall(r"^- \*\*.+?\*\*", question, re.MULTILINE)) == 3, (name, title)
