"""Run the notebooks in parallel, and again when their code or anything that they use changes.

A notebook that ``make notebooks`` has stored is not run as long as both are what they were then.
The key of jupyter-cache is the code in the cells, so it does not notice a change in
``src/orientation`` and would keep every stored output. We therefore delete a run when the files
that the notebook uses have changed since. A changed sentence runs nothing.
"""

import json
import logging
from pathlib import Path

from jupyter_cache import get_cache
from jupyter_cache.executors.basic import ExecutionWorkerLocalMProc, JupyterExecutorLocalMproc
from jupyter_cache.executors.utils import single_nb_execution

from .paths import WEBSITE, fingerprint
from .used import MADE_WITH, fingerprint_of_run, fingerprint_of_used, notebook_of
from .warm_kernels import WarmAsyncKernelManager

# These notebooks are shown as they were released, and the tests run them; see ``execute`` in
# _config.yml.
STORED = "exercises/"
#: This file beside the cache lists the files that each notebook used when it ran.
NOTES = "made-with.json"


def name_cache(app, config):
    config.nb_execution_cache_path = str(Path(app.outdir).parent / "jupyter_cache")
    # Read the pages again when the code that makes them changes.
    config.website_fingerprint = fingerprint(WEBSITE)


def throw_away_old_runs(paths, folder):
    """Delete all runs from the cache in ``folder`` except those of unchanged notebooks.

    The runs of a book that was moved or copied go, too, because they name their old places. Returns
    the paths of the notebooks that use changed files.
    """
    notes = Path(folder, NOTES)
    made_with = json.loads(notes.read_text("utf8")) if notes.exists() else {}
    now = {str(path): fingerprint_of_used(notebook_of(path)) for path in paths}
    changed = {path for path, used in now.items() if made_with.get(path) != used}
    cache = get_cache(folder)
    for record in cache.list_cache_records():
        if record.uri not in now.keys() - changed:
            cache.remove_cache(record.pk)
    notes.parent.mkdir(parents=True, exist_ok=True)
    # Write this only after deleting the runs, so that an interruption leaves no outdated run.
    notes.write_text(json.dumps(made_with | now), "utf8")
    return changed


def pages_to_read_again(app, env, added, changed, removed):
    """Return the pages whose notebooks use changed files.

    Sphinx itself finds the pages that have changed.
    """
    if env.mystnb_config.execution_mode != "cache":
        return []
    names = {
        str(env.doc2path(name)): name for name in env.found_docs if not name.startswith(STORED)
    }
    notebooks = [path for path in names if path.endswith(".ipynb")]
    return [
        names[path]
        for path in throw_away_old_runs(notebooks, env.mystnb_config.execution_cache_path)
    ]


class Worker(ExecutionWorkerLocalMProc):
    """Run a notebook as jupyter-cache does, but in a kernel that starts at once."""

    @staticmethod
    def execute(project_nb, data):
        return single_nb_execution(
            project_nb.nb,
            cwd=str(Path(project_nb.uri).parent),
            timeout=data.timeout,
            allow_errors=data.allow_errors,
            kernel_manager_class=WarmAsyncKernelManager,
        )


class Executor(JupyterExecutorLocalMproc):
    _EXECUTION_WORKER = Worker

    def __init__(self, cache):
        # Ignore messages about the start and end of a process.
        logging.getLogger(__name__).setLevel(logging.WARNING)
        super().__init__(cache, logging.getLogger(__name__))


def run_side_by_side(app, env, docnames):
    """Fill the cache with one kernel per core before MyST-NB reads page by page."""
    if env.mystnb_config.execution_mode != "cache":
        return
    cache = get_cache(env.mystnb_config.execution_cache_path)
    # Notebooks with the same code share one run; two at once would store it twice, which fails.
    records = {}
    for path in (str(env.doc2path(name)) for name in docnames if not name.startswith(STORED)):
        if path.endswith(".ipynb"):
            record = cache.add_nb_to_project(path)
            if cache.get_cached_project_nb(record.uri) is None:
                notebook = cache.get_project_notebook(path).nb
                if notebook.metadata.get(MADE_WITH) == fingerprint_of_run(notebook):
                    cache.cache_notebook_file(path)
                else:
                    records[cache.create_hashed_notebook(notebook)[1]] = record
    if len(records) > 1:
        # Cells that fail are not cached: MyST-NB runs them again and reports the failure.
        Executor(cache).run_and_cache(
            filter_pks=[record.pk for record in records.values()],
            timeout=env.mystnb_config.execution_timeout,
        )


def setup(app):
    app.add_config_value("website_fingerprint", "", "env", str)
    app.connect("config-inited", name_cache)
    app.connect("env-get-outdated", pages_to_read_again)
    app.connect("env-before-read-docs", run_side_by_side)
