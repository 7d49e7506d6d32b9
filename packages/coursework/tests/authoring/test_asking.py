"""A notebook is asked of a language model, and its reply comes back as a notebook."""

import json

import nbformat
import pytest

from coursework.__main__ import main


@pytest.fixture
def notebook(tmp_path):
    cells = [
        nbformat.v4.new_markdown_cell(
            "## 1. A crank\n\n![A crank, turned](data:image/png;base64,AAAA)"
        ),
        nbformat.v4.new_code_cell(
            "crank = variant('levers/crank')\ncrank",
            outputs=[
                nbformat.v4.new_output(
                    "execute_result", {"text/markdown": "It is 2 m long.", "text/plain": "2 m"}
                )
            ],
        ),
        nbformat.v4.new_code_cell(
            "moment = ...  # your answer", metadata={"nbgrader": {"solution": True}}
        ),
        nbformat.v4.new_code_cell("check('levers/crank', moment)"),
        nbformat.v4.new_code_cell(
            "def mean(numbers):\n    ...", metadata={"nbgrader": {"solution": True}}
        ),
    ]
    path = tmp_path / "levers.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
    return path


def test_a_notebook_is_printed_and_a_reply_comes_back(notebook, tmp_path, capsys):
    main(["ask", str(notebook)])
    asked = capsys.readouterr().out
    assert "[Figure: A crank, turned]" in asked and "It is 2 m long." in asked
    assert "moment = ..." in asked and "base64" not in asked and "check(" not in asked
    reply = tmp_path / "reply.txt"
    reply.write_text(
        "First:\n```python\nmoment = 1\n```\nNo:\n```python\nmoment = 6\n```\n", "utf8"
    )
    target = tmp_path / "handed-in" / "model" / "levers.ipynb"
    main(["ask", str(notebook), "--answers", str(reply), "--to", str(target)])
    assert "answers moment." in capsys.readouterr().out
    sources = ["".join(cell["source"]) for cell in json.loads(target.read_text("utf8"))["cells"]]
    assert sources[2] == "moment = 6\n" and sources[4].endswith("...")
    assert nbformat.read(target, 4)


def test_a_reply_without_an_answer_is_refused_in_words(notebook, tmp_path):
    reply = tmp_path / "reply.txt"
    reply.write_text("It is 6.", "utf8")
    with pytest.raises(SystemExit, match="The reply has no block of Python"):
        main(["ask", str(notebook), "--answers", str(reply), "--to", str(tmp_path / "new.ipynb")])
    with pytest.raises(SystemExit, match="give both --answers and --to"):
        main(["ask", str(notebook), "--answers", str(reply)])
    with pytest.raises(SystemExit, match="cannot read .* as a notebook"):
        main(["ask", str(tmp_path / "none.ipynb")])
