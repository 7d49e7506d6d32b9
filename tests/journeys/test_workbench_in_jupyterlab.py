"""The workbench in JupyterLab, where each line of its fields is a pose."""

import pytest
from laboratory import laboratory, open_notebook
from playwright.sync_api import expect

pytest.importorskip("jupyterlab")

CELL = "from orientation_figures.moving import WorkbenchFigure\n\nWorkbenchFigure()"


def test_two_poses_are_written_into_the_workbench(browser, tmp_path):
    with laboratory(tmp_path, [CELL]) as address:
        page = open_notebook(browser, address)
        first = page.get_by_label("What the first program gives")
        first.click()
        page.keyboard.press("Control+a")
        page.keyboard.type("1 0 0 0")
        page.keyboard.press("Enter")
        page.keyboard.type("0.8 0.6 0 0  # a/b, dd, x")
        expect(first).to_be_focused()
        expect(first).to_have_value("1 0 0 0\n0.8 0.6 0 0  # a/b, dd, x")
        page.context.close()
