"""``python -m notebook_pages.build``: build the book, and fail unless all of it was built."""

import json
import shutil
import sys
import time
import traceback
from pathlib import Path

import yaml

from . import unchanged
from .paths import (
    BUILD,
    HTML,
    NODE_MODULES,
    contents,
    exam_edition,
    let_everybody_read,
    pages,
)

# The contents of an exam edition.
EXAM_CONTENTS = BUILD / "_toc.yml"


def what_prevents_building():
    """Return a sentence about the first thing without which nothing can be built, or None."""
    for name in ("_config.yml", "_toc.yml"):
        if not Path(name).is_file():
            return f"there is no {name} in {Path.cwd()}. Run this in the folder of the book."
    if (root := contents()["root"]) != "index":
        return (
            f"_toc.yml begins with `root: {root}`. Rename that page to `index`, because browsers "
            "open index.html first, and write `root: index`."
        )
    if "notebook_pages" not in Path("_config.yml").read_text("utf8"):
        return (
            "_config.yml does not use notebook_pages. Set `only_build_toc_files: true`, and below "
            "`sphinx:` set `extra_extensions: [notebook_pages]` and `recursive_update: true`."
        )
    if not NODE_MODULES.is_dir():
        return f"{NODE_MODULES} is missing. Run `python -m notebook_pages.set_up` first."
    for notebook in filter(Path.is_file, (Path(f"{page}.ipynb") for page in pages())):
        try:
            json.loads(notebook.read_text("utf8"))
        except ValueError as error:
            return (
                f"{notebook} is not a notebook: {error}. Perhaps a merge left lines in it that "
                "begin with <<<<<<< or >>>>>>>."
            )
    return None


def forget_site():
    """Remove the built site, so that the next build makes every page anew."""
    for folder in (HTML, BUILD / ".doctrees"):
        shutil.rmtree(folder, ignore_errors=True)


def contents_of_this_edition():
    """Choose the table of contents of this edition, and remove what another edition left behind."""
    if EXAM_CONTENTS.exists() != exam_edition():
        forget_site()
    EXAM_CONTENTS.unlink(missing_ok=True)
    if not exam_edition():
        return []
    BUILD.mkdir(exist_ok=True)
    EXAM_CONTENTS.write_text(yaml.safe_dump(contents(), sort_keys=False), "utf8")
    return ["--toc", str(EXAM_CONTENTS.resolve())]


def make_pages():
    """Run the command ``jupyter-book`` and return its exit code.

    It runs in this process, which has already loaded the same packages, and which can reuse what it
    learns about the notebooks.
    """
    from jupyter_book.cli.main import main as jupyter_book

    options = ["-q", "-W", "-n", "--keep-going", *contents_of_this_edition()]
    try:
        jupyter_book(["build", ".", *options], prog_name="jupyter-book")
    except SystemExit as end:
        return end.code
    # Sphinx raises its own errors.
    except Exception:
        traceback.print_exc()
        return 1


def main():
    start = time.monotonic()
    made_from = unchanged.of_sources()
    if unchanged.is_unchanged(made_from):
        print(f"Nothing has changed since the last build: {HTML / 'index.html'}")
        return
    if reason := what_prevents_building():
        sys.exit(f"The book cannot be built: {reason}")
    # These imports load Sphinx, so import them only if there is something to build.
    from . import install, lite, whole_book

    print(
        "Building the book: minutes for all of it, a minute or two if little has changed. "
        "Nothing more is printed until the pages are done ...",
        flush=True,
    )
    if make_pages():
        # Sphinx warns about a page only when it reads it. Without this, a second build would find
        # nothing to do and would report success for the same faulty book.
        forget_site()
        sys.exit("The book could not be built: see the warnings above.")
    lite.write(HTML)
    whole_book.withdraw_outdated()
    install.write_list(HTML)
    let_everybody_read(HTML)
    unchanged.note(made_from)
    print(f"Built in {time.monotonic() - start:.0f} s: {HTML / 'index.html'}")


if __name__ == "__main__":
    main()
