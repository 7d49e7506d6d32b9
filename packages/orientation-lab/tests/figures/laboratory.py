"""A JupyterLab of our own, with one notebook."""

import json
import os
import subprocess
import sys
import time
from contextlib import contextmanager

import nbformat
import pytest

TOKEN = "figures"
PATIENCE = 120  # seconds, for a busy machine; nothing waits longer than it must


@contextmanager
def laboratory(folder, cells):
    """Start JupyterLab in ``folder`` on a notebook of these cells; give its address."""
    notebook = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_code_cell(source, id=f"c{k}") for k, source in enumerate(cells)]
    )
    notebook.metadata["kernelspec"] = {
        "name": "python3",
        "display_name": "Python 3",
        "language": "python",
    }
    nbformat.write(notebook, folder / "figures.ipynb")
    # Every cell stands in the page, also those out of sight; no questions about news.
    for name, values in (
        ("notebook-extension/tracker", {"windowingMode": "none"}),
        ("apputils-extension/notification", {"fetchNews": "false", "checkForUpdates": False}),
    ):
        file = folder / "settings" / "@jupyterlab" / f"{name}.jupyterlab-settings"
        file.parent.mkdir(parents=True)
        file.write_text(json.dumps(values), "utf8")
    homes = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    places = {name: str(folder / name.lower()) for name in homes}
    environment = (
        os.environ
        | places
        | {"JUPYTERLAB_SETTINGS_DIR": str(folder / "settings"), "JUPYTER_PREFER_ENV_PATH": "1"}
    )
    with (folder / "log").open("w") as log:
        server = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "jupyterlab",
                "--no-browser",
                "--allow-root",
                "--port=0",
                "--ip=127.0.0.1",
                f"--IdentityProvider.token={TOKEN}",
                f"--ServerApp.root_dir={folder}",
                "--LabApp.expose_app_in_browser=True",
            ],
            env=environment,
            stdout=log,
            stderr=log,
        )
        try:
            yield wait_for_address(server, folder)
        finally:
            server.terminate()
            server.wait()


def wait_for_address(server, folder):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        for file in (folder / "jupyter_runtime_dir").glob("jpserver-*.json"):
            if file.name.endswith(f"{server.pid}.json") and (
                text := file.read_text("utf8")
            ).endswith("}"):
                return json.loads(text)["url"]
        if server.poll() is not None:
            break
        time.sleep(0.1)
    pytest.fail(f"JupyterLab does not start: {(folder / 'log').read_text('utf8')[-2000:]}")


# What Lab itself waits for before a reader can run a cell.
RUN_ALL = """async () => {
  const picture = () => new Promise((done) => requestAnimationFrame(done));
  const { shell, commands, restored } = window.jupyterapp;
  await restored;
  while (!shell.currentWidget?.sessionContext) await picture();
  const { context, revealed, sessionContext } = shell.currentWidget;
  await Promise.all([context.ready, revealed, sessionContext.ready]);
  while (sessionContext.session?.kernel?.status !== 'idle') await picture();
  commands.execute('notebook:run-all-cells');
}"""


def open_notebook(browser, address):
    """The notebook in a page of its own, with every cell run."""
    context = browser.new_context(viewport={"width": 1300, "height": 1000})
    context.set_default_timeout(1000 * PATIENCE)
    page = context.new_page()
    page.goto(f"{address}lab/tree/figures.ipynb?token={TOKEN}")
    page.wait_for_function("document.querySelector('.jp-CodeCell') && window.jupyterapp")
    page.evaluate(RUN_ALL)
    return page
