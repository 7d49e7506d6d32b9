"""The page on language models quotes the reply of a check."""

import nbformat
from places import REPOSITORY

from coursework import check


def test_the_page_quotes_the_reply_to_the_numbers_as_they_stand(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = nbformat.read(REPOSITORY / "appendix" / "with-a-language-model.ipynb", as_version=4)
    (quoted,) = [
        line.removeprefix("> ")
        for cell in page.cells
        for line in cell.source.splitlines()
        if line.startswith("> ")
    ]
    assert quoted in str(check("chapters/scalar-last", [0, 0, 0.3827, 0.9239]))
