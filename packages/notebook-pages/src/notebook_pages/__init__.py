"""What turns the chapters into the web site: one small Sphinx extension.

Each module has one purpose and a ``setup`` of its own; none of them knows what the book is about.
"""

import gc


def setup(app):
    # Here, and not above: commands of this package that make no page are there at once.
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

    # Pages that are read back are large trees: to look through them for memory to be freed as often
    # as Python does takes longer than to read them.
    gc.set_threshold(50_000, 20, 50)
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
        moving,
        live,
        lite,
        install,
        finish,
    ):
        module.setup(app)
    return {"version": "1.0", "parallel_read_safe": True, "parallel_write_safe": True}
