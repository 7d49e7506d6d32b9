"""Mark exercises with their difficulty and duration, and link chapters with their questions."""

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx import addnodes
from sphinx_exercise.directive import ExerciseDirective

from .progress import companion, questions_in

HARDEST = 3


def difficulty(text):
    level = directives.positive_int(text)
    if level > HARDEST:
        raise ValueError(f"difficulty must be from 1 to {HARDEST}, not {level}")
    return level


class MarkedExercise(ExerciseDirective):
    """An exercise with `:difficulty:` (1 to 3) and `:minutes:`."""

    option_spec = ExerciseDirective.option_spec | {
        "difficulty": difficulty,
        "minutes": directives.positive_int,
    }

    def run(self):
        level, minutes = self.options.pop("difficulty", None), self.options.pop("minutes", None)
        nodes_of_exercise = super().run()
        if level and minutes:
            words = f"Difficulty {level} of {HARDEST}, about {minutes} minutes"
            (exercise,) = [node for node in nodes_of_exercise if isinstance(node, nodes.Admonition)]
            exercise.insert(
                1, nodes.paragraph("", words, classes=["effort", f"difficulty-{level}"])
            )
        return nodes_of_exercise


def lead_on(app, doctree):
    """End a chapter with a link to its checked questions, and begin their page with a link back."""
    page = app.env.docname
    if (whole := next(doctree.findall(nodes.section), None)) is None:
        return
    notebook = companion(page)
    if page.startswith("chapters/"):
        if number := len(questions_in(notebook)):
            link = reference(page, str(notebook.with_suffix("")), f"{number} checked questions")
            whole += nodes.paragraph("", "Practise: ", link, nodes.Text("."), classes=["practise"])
    elif page.startswith("exercises/") and (chapter := chapter_of(app, page)):
        link = reference(page, chapter, "the chapter that they belong to")
        words = nodes.paragraph(
            "", "These questions practise ", link, nodes.Text("."), classes=["practise"]
        )
        whole.insert(1, words)


def name_nothing_twice(app, doctree, page):
    """Remove the IDs that sphinx-exercise gives to the texts of all exercises alike."""
    for section in doctree.findall(nodes.section):
        if section["ids"] in (["exercise-content"], ["solution-content"]):
            section["ids"] = []


def chapter_of(app, page):
    chapter = page.replace("exercises/", "chapters/", 1)
    return chapter if chapter in app.env.found_docs else None


def reference(page, target, words):
    """Return a link to another page, which Sphinx resolves."""
    return addnodes.pending_xref(
        "", nodes.inline("", words), refdomain="std", reftype="doc", refdoc=page,
        reftarget=f"/{target}", refexplicit=True, refwarn=True,
    )  # fmt: skip


def setup(app):
    app.setup_extension("sphinx_exercise")
    app.add_directive("exercise", MarkedExercise, override=True)
    app.connect("doctree-read", lead_on)
    app.connect("doctree-resolved", name_nothing_twice)
