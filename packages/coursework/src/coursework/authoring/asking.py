"""The questions of an exercise notebook as plain text, and answers to them read back in.

So an instructor can find out what a language model of today makes of them: paste the text, save the
reply, and grade the notebook that comes of it as any other, in the sandbox.
"""

import re
from pathlib import Path

import nbformat
from nbformat import NotebookNode

from .author import AuthorError

ASK = (
    "Answer every question of this notebook. For each one reply with a fenced block of Python that "
    "assigns the answer to the name that the question gives."
)
PICTURE = re.compile(r"!\[([^\]]*)\]\([^)]*\)|<img[^>]*alt=\"([^\"]*)\"[^>]*>")
BLOCK = re.compile(r"^```[ \t]*(?:python|py)?[ \t]*\n(.*?)^```", re.M | re.S | re.I)
BLANK = re.compile(r"^(\w+) = \.\.\.|^def (\w+)", re.M)


def as_text(path: str | Path) -> str:
    """Return the text of a notebook, its code and what its questions print.

    Of a picture its text alternative is given. A variant is everybody's, as it was released.
    """
    parts = [ASK]
    for cell in _read(path)["cells"]:
        if cell["cell_type"] == "markdown":
            parts.append(_without_pictures(cell["source"]))
        elif not cell["source"].lstrip().startswith("check("):
            parts.append(f"```python\n{cell['source']}\n```")
            for output in cell["outputs"]:
                data = output.get("data", {})
                shown = data.get("text/markdown", data.get("text/plain", output.get("text", "")))
                parts.append(_without_pictures(shown))
    return "\n\n".join(part for part in parts if part.strip()) + "\n"


def with_answers(path: str | Path, reply: str, target: str | Path) -> list[str]:
    """Write a notebook with the answers of a reply, and return the names it answers.

    Raises
    ------
    AuthorError
        No block of code in the reply gives an answer.
    """
    notebook, answered = _read(path), []
    blocks = BLOCK.findall(reply)
    for cell in notebook["cells"]:
        blank = BLANK.search(cell["source"])
        if not (blank and cell["metadata"].get("nbgrader", {}).get("solution")):
            continue
        name = blank[1] or blank[2]
        gives = re.compile(rf"^(?:{name}\s*=|def {name}\b)", re.M)
        block = next((block for block in reversed(blocks) if gives.search(block)), None)
        if block is not None:
            cell["source"], cell["outputs"] = block, []
            answered.append(name)
    if not answered:
        raise AuthorError(
            "The reply has no block of Python that assigns an answer of this notebook."
        )
    Path(target).parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, target)
    return answered


def _without_pictures(text: str) -> str:
    return PICTURE.sub(lambda found: f"[Figure: {found[1] or found[2]}]", text)


def _read(path: str | Path) -> NotebookNode:
    try:
        notebook: NotebookNode = nbformat.read(path, as_version=4)
    except (OSError, ValueError) as error:  # nbformat's own errors are of values
        raise AuthorError(f"We cannot read {path} as a notebook: {error}") from None
    return notebook
