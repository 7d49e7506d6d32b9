"""Run the notebooks once, side by side, and again when the module they use changes.

The key of jupyter-cache is the code in the cells. A change in
``src/orientation`` would leave it, and every stored output, as it was; so the
name of the cache folder holds a fingerprint of the module and of the pins.
"""

import shutil
from pathlib import Path

from jupyter_cache import get_cache
from jupyter_cache.executors import load_executor

from .paths import PACKAGE_FOLDERS, REPOSITORY, WEBSITE, fingerprint

#: Notebooks that are shown as they were released and run by the tests; see ``execute`` in _config.yml.
STORED = "exercises/"


def name_cache(app, config):
    folder = Path(app.outdir).parent / "jupyter_cache"
    inputs = fingerprint(*PACKAGE_FOLDERS, REPOSITORY / "constraints.txt")
    config.nb_execution_cache_path = str(folder / inputs)
    for outdated in folder.glob("*"):
        if outdated.name != inputs:
            shutil.rmtree(outdated)
    # Pages are read again when the code that makes them changes.
    config.website_fingerprint = fingerprint(WEBSITE, REPOSITORY / "package-lock.json")


def run_side_by_side(app, env, docnames):
    """Fill the cache with one kernel per core before MyST-NB reads page by page."""
    if env.mystnb_config.execution_mode != "cache":
        return
    cache = get_cache(env.mystnb_config.execution_cache_path)
    records = []
    for path in (env.doc2path(name) for name in docnames if not name.startswith(STORED)):
        if path.endswith(".ipynb"):
            record = cache.add_nb_to_project(path)
            if cache.get_cached_project_nb(record.uri) is None:
                records.append(record)
    if len(records) > 1:
        # A cell that fails is not cached: MyST-NB meets it again and reports it.
        load_executor("local-parallel", cache).run_and_cache(
            filter_pks=[record.pk for record in records],
            timeout=env.mystnb_config.execution_timeout,
        )


def setup(app):
    app.add_config_value("website_fingerprint", "", "env", str)
    app.connect("config-inited", name_cache)
    app.connect("env-before-read-docs", run_side_by_side)
