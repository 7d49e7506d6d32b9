"""What turns the chapters into the web site: one small Sphinx extension.

Each module has one purpose and a ``setup`` of its own; none of them knows
what the book is about.
"""

from . import (
    accessible,
    alternative_text,
    exam,
    execution,
    exercises,
    finish,
    first_view,
    fonts,
    install,
    lecture,
    lite,
    live,
    mathematics,
    moved,
    moving,
    page,
    pictures,
    previews,
    progress,
    publish,
    questions,
    search,
    sidebar,
    subject_index,
    take_away,
)


def setup(app):
    pages = (
        execution,
        fonts,
        mathematics,
        alternative_text,
        accessible,
        questions,
        exercises,
        progress,
        lecture,
        subject_index,
    )
    for module in (
        exam,
        *pages,
        first_view,
        take_away,
        page,
        sidebar,
        search,
        previews,
        publish,
        pictures,
        moved,
        moving,
        live,
        lite,
        install,
        finish,
    ):
        module.setup(app)
    return {"version": "1.0", "parallel_read_safe": True, "parallel_write_safe": True}
