"""Shared by the tests: the choice of tests, the built site, a server for it, and a browser."""

import gc
import os
import threading
from collections import defaultdict
from importlib import metadata

import pytest

# Tests already run on all cores. Further threads of OpenBLAS wait for one another, for seconds on a
# busy machine.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

try:
    import nbval.kernel
    import nbval.plugin
    import stored_outputs
    import times
    from places import BROWSER_REQUIRED, HTML, PATIENCE
    from seed import spread
    from xdist.scheduler import LoadFileScheduling

    from notebook_pages import warm_kernels
    from notebook_pages.browser import FLAGS, MISSING, find
except ModuleNotFoundError as missing:
    pytest.exit(
        f"The Python package {missing.name} is not there. `make test` sets up everything and runs "
        "all tests; after that, `.venv/bin/python -m pytest` runs those that you name."
    )

# Tests that are slow and share nothing with the others of their file.
APART = (
    "tests/pages/test_site.py::test_page_in_",
    "tests/pages/test_live.py::test_results_equal_the_stored_ones[",
    "packages/orientation-lab/tests/course/test_release.py::test_what_is_committed_is_what_the_source_makes[",
    "packages/orientation-lab/tests/course/test_selftest.py::test_every_question_passes_and_names_its_mistakes[",
    "tests/pages/test_takeaway.py::test_script_runs[",
)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """Use one process more than there are cores, because tests often wait for a page."""
    return (os.cpu_count() or 1) + 1


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Distribute the tests by file, because tests often share a kernel or a fixture.

    The tests of ``APART`` are distributed individually, after the larger files, so that no process
    is idle.
    """

    class ByFile(LoadFileScheduling):
        def _split_scope(self, nodeid):
            return nodeid if nodeid.startswith(APART) else super()._split_scope(nodeid)

    return ByFile(config, log)


def pytest_configure(config):
    # The installed package must agree with pyproject.toml, because entry points are read from the
    # installed metadata.
    if not any(
        entry.value == "orientation_course"
        for entry in metadata.entry_points(group="coursework.plugins")
    ):
        raise pytest.UsageError("What is installed is older than pyproject.toml: run `make setup`.")
    nbval.plugin.IPyNbCell.compare_outputs = stored_outputs.compare_outputs
    nbval.plugin.IPyNbCell.format_output_compare = stored_outputs.format_output_compare
    nbval.kernel.KernelManager = warm_kernels.WarmKernelManager
    config.pluginmanager.register(times.Times(config), "times")
    config.addinivalue_line(
        "markers",
        "sampled(number, of=None): of a test's cases, of a file's tests, or of a file's tests with "
        "the same `of`, only so many run, spread evenly over all; the rest are further cases",
    )
    config.addinivalue_line(
        "markers", "further: a case much like others that run; only `--every-case` runs it too"
    )


def pytest_addoption(parser):
    parser.addoption(
        "--every-case",
        action="store_true",
        help="also run the cases that are much like others (for whoever changes what they test)",
    )


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Disable the garbage collector while collecting, which saves a third of the time.

    Collected tests stay in memory to the end, so there is nothing to free.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(tryfirst=True)  # before the tests that are marked as long are left out
def pytest_collection_modifyitems(config, items):
    cases = defaultdict(list)
    for item in items:
        for node, marker in item.iter_markers_with_node("sampled"):
            name = node.nodeid.partition("[")[0]  # of the test, or of the file that is marked
            if "of" in marker.kwargs:
                name = f"{name.partition('::')[0]} {marker.kwargs['of']}"
            cases[name, marker.args[0]].append(item)
            break  # the closest
    for (_, number), cases_of_test in cases.items():
        chosen = spread(cases_of_test, number)
        for item in cases_of_test:
            if item not in chosen:
                item.add_marker(pytest.mark.further)
    if not config.getoption("every_case"):
        further = [item for item in items if item.get_closest_marker("further")]
        config.hook.pytest_deselected(items=further)
        items[:] = [item for item in items if not item.get_closest_marker("further")]


def pytest_unconfigure():
    warm_kernels.warm.end()


@pytest.fixture(scope="session")
def site():
    """The address of the built book, served locally."""
    from notebook_pages.serve import server

    if not (HTML / "index.html").exists():
        pytest.fail("the book is not built: run `make book`")
    book = server(folder=HTML)
    threading.Thread(target=book.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{book.server_port}/"
    book.shutdown()
    book.server_close()


@pytest.fixture(scope="session")
def browser():
    """Headless Chromium; tests are skipped with a reason if there is none."""
    from playwright.sync_api import sync_playwright

    path_of_browser = find()
    if path_of_browser is None:
        reason = MISSING
        pytest.fail(reason) if BROWSER_REQUIRED else pytest.skip(reason)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path_of_browser, args=list(FLAGS))
        open_context = chromium.new_context

        # A test's wait conditions are programs, which the pages' own policy forbids. Only tests of
        # the policy itself (``bypass_csp=False``) enforce it.
        def open_patient_context(**options):
            context = open_context(**{"bypass_csp": True, **options})
            context.set_default_timeout(PATIENCE)
            return context

        chromium.new_context = open_patient_context
        yield chromium
        chromium.close()


@pytest.fixture
def page(browser):
    """A page in a window as wide as a laptop's, which keeps nothing of another test."""
    context = browser.new_context(viewport={"width": 1300, "height": 900})
    yield context.new_page()
    context.close()
