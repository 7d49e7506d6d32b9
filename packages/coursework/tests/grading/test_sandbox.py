"""Notebooks in, answers out as plain data: what is recorded, reported, and harms nobody else."""

import base64
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from coursework.grading.execution import records
from coursework.grading.execution.sandbox import Limits, Sandbox, WorkerDied, run_notebooks

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="student code runs on Linux only"
)

LIMITS = Limits(
    cell_seconds=1,
    cell_wall_seconds=60,
    answer_seconds=0.5,
    answer_wall_seconds=60,
    grace_seconds=0.5,
)
IMPORT = "from coursework import check"


@pytest.fixture(scope="module")
def sandbox(lent_sandboxes):
    """A sandbox that is already running, with the limits of this file."""
    (sandbox, _), *_ = lent_sandboxes
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sandbox, "limits", LIMITS)
        yield sandbox


def notebook(*cells, questions=None, **others):
    cells = [
        {"source": cell}
        if isinstance(cell, str)
        else {"source": cell[1], "execution_count": cell[0]}
        for cell in (IMPORT, *cells)
    ]
    return {
        "id": "n",
        "cells": cells,
        "questions": {
            name: about if isinstance(about, dict) else {"variable": about}
            for name, about in (questions or {}).items()
        },
    } | others


def integer(number):
    return {"value": ["expression", 0], "nodes": [["integer", str(number)]]}


def outcomes(result):
    return [cell["outcome"] for cell in result["cells"][1:]]


# ---- which answer is recorded


def test_answers_are_recorded_where_they_are_checked(sandbox):
    result = sandbox.run(notebook("a = 3", "check('q', a); a = 4", questions={"q": "a"}))
    assert result["answers"] == {
        "q": {"outcome": "recorded", "plain": integer(3), "from": "check", "cell": 2}
    }
    assert result["finished"] is True and result["runs"] == 1 and result["notes"] == []


def test_without_the_check_the_variable_counts(sandbox):
    result = sandbox.run(
        notebook("a = 3\na = 4", "b = ...", questions={"q": "a", "blank": "b", "none": "c"})
    )
    assert result["answers"]["q"] == {
        "outcome": "recorded",
        "plain": integer(4),
        "from": "variable",
    }
    assert result["answers"]["blank"]["plain"]["value"] == ["blank"]
    assert result["answers"]["none"] == {"outcome": "missing"}


def test_the_last_check_that_can_be_read_counts(sandbox):
    result = sandbox.run(
        notebook(
            "check('q', 1); check('q', 2); check('q', object())",
            "check('other', 1)",
            questions={"q": None},
        )
    )
    assert result["answers"]["q"]["plain"] == integer(2)
    assert result["unknown questions"] == ["other"]


def test_what_is_not_plain_data_is_named(sandbox):
    result = sandbox.run(
        notebook("check('q', object())", "class A: pass\nx = A()", questions={"q": None, "r": "x"})
    )
    assert (
        result["answers"]["q"]["outcome"] == "unreadable"
        and "`object`" in result["answers"]["q"]["why"]
    )
    assert (
        result["answers"]["r"]["outcome"] == "unreadable" and "`A`" in result["answers"]["r"]["why"]
    )


def test_a_check_tells_nothing_and_breaks_nothing(sandbox):
    result = sandbox.run(
        notebook(
            "r = check('q', 1)\nassert 'correct' not in repr(r).lower()",
            "import coursework\ncoursework.check('s', 2)",
            "from coursework import check, hint, progress\nhint('q'); progress()\n"
            "assert check('q', 1).outcome is None",
            "from coursework.grading import sandbox",
            questions={"q": None, "s": None},
        )
    )
    assert outcomes(result) == ["done", "done", "done", "error"]
    assert result["answers"]["s"]["plain"] == integer(2)


# ---- functions as answers


def calls(*arguments, kind="lists"):
    return {"variable": "f", "calls": {"arguments": list(arguments), "as": kind}}


def test_a_function_is_called_with_the_given_arguments(sandbox):
    result = sandbox.run(
        notebook(
            "def f(x): return x[0] + x[1]",
            "check('q', f)",
            questions={"q": calls([[1, 2]], [[3, 4]], [[]])},
        )
    )
    plain = result["answers"]["q"]["plain"]
    assert plain["value"] == [
        "function",
        [["expression", 0], ["expression", 1], ["raised", "IndexError: list index out of range"]],
        True,  # It computes something.
    ]
    assert plain["nodes"] == [["integer", "3"], ["integer", "7"]]


@pytest.mark.parametrize(
    "cells, asked, number",
    [
        (
            ["def f(x, n): return (x * n).sum() + x.ndim"],
            calls([[[1, 2], [3, 4]], 10], kind="arrays"),
            "102",
        ),
        # A function that changes its arguments meets them fresh.
        (
            ["def f(x): x.append(1); return len(x)", "check('q', f); check('q', f)"],
            calls([[]]),
            "1",
        ),
    ],
)
def test_a_function_is_given_arrays_where_the_job_says_so_and_fresh_arguments(
    sandbox, cells, asked, number
):
    result = sandbox.run(notebook(*cells, questions={"q": asked}))
    assert result["answers"]["q"]["plain"]["nodes"] == [["integer", number]]


def test_a_function_that_never_ends_costs_only_its_own_question(sandbox):
    result = sandbox.run(
        notebook(
            "def f(x):\n    while True: pass",
            "check('q', f); check('r', 5)",
            questions={"q": calls([1]), "r": None},
        )
    )
    assert (
        result["answers"]["q"]["outcome"] == "unreadable"
        and "exceeded" in result["answers"]["q"]["why"]
    )
    assert result["answers"]["r"]["plain"] == integer(5)


def test_a_function_that_ends_the_process_costs_only_its_own_question(sandbox):
    result = sandbox.run(
        notebook(
            "import os\ndef f(x): os._exit(3)",
            "check('q', f); check('r', 5)",
            questions={"q": calls([1]), "r": None},
        )
    )
    assert result["answers"]["q"] == {
        "outcome": "exited",
        "error": "The process ended with exit code 3.",
    }
    assert result["answers"]["r"]["plain"] == integer(5)
    assert outcomes(result) == ["done", "done"] and result["runs"] == 2


# ---- one cell's end does not end the others


def test_errors_are_named_with_their_line(sandbox):
    result = sandbox.run(
        notebook(
            "x = 1\ny = nothing",
            "if",
            "raise SystemExit",
            "def f():\n    return 1 / 0\n\nf()",
            "open('none')",
            "object() + 1",
            "check('q', 1)",
            questions={"q": None},
        )
    )
    errors = [(cell.get("error", "")[:40], cell.get("line")) for cell in result["cells"][1:]]
    assert errors[:4] == [
        ("NameError: name 'nothing' is not defined"[:40], 2),
        ("SyntaxError: invalid syntax", 1),
        ("SystemExit", 1),
        ("ZeroDivisionError: division by zero", 2),
    ]
    assert result["answers"]["q"]["outcome"] == "recorded" and result["runs"] == 1


def test_cells_that_end_the_process_are_left_out(sandbox):
    result = sandbox.run(
        notebook(
            "import os\na = 1",
            "os._exit(7)",
            "b = a + 1; check('b', b)",
            "os.abort()",
            "check('c', b + 1)",
            "import ctypes; ctypes.string_at(0)",
            "d = b + 2",
            questions={"b": None, "c": None, "d": "d"},
        )
    )
    assert outcomes(result) == ["done", "exited", "done", "killed", "done", "killed", "done"]
    assert [result["answers"][name]["plain"] for name in "bcd"] == [integer(n) for n in (2, 3, 4)]
    assert result["cells"][4]["error"] == "The process was killed by SIGABRT."
    assert result["finished"] is True and result["runs"] == 4


def test_the_number_of_runs_is_bounded(sandbox):
    cells = ["check('first', 1)", *["import os; os._exit(1)"] * 12, "check('last', 1)"]
    result = sandbox.run(notebook(*cells, questions={"first": None, "last": None}))
    assert result["runs"] == LIMITS.runs and result["finished"] is False
    assert result["answers"]["first"]["outcome"] == "recorded"
    assert result["answers"]["last"] == {"outcome": "missing"}
    assert result["cells"][-1] == {"outcome": "not run"}


def test_a_thread_is_blamed_on_the_cell_that_left_it(sandbox):
    wait = "time.sleep(0.5)"
    result = sandbox.run(
        notebook(
            "import os, threading, time",
            "threading.Thread(target=lambda: (time.sleep(0.3), os._exit(0))).start()",
            wait,
            wait,
            wait,
            wait,
            "check('q', 1)",
            questions={"q": None},
        )
        | {"id": "threads"}
    )
    assert result["answers"]["q"]["plain"] == integer(1)
    assert outcomes(result)[1] == "exited"


def test_an_answer_stands_though_a_later_cell_never_ends(sandbox):
    result = sandbox.run(
        notebook(
            "check('q', 1)", "while True: pass", "check('r', 2)", questions={"q": None, "r": None}
        )
    )
    assert outcomes(result) == ["done", "timeout", "done"]
    assert [result["answers"][name]["plain"] for name in "qr"] == [integer(1), integer(2)]


def test_an_earlier_cells_damage_is_undone(sandbox):
    result = sandbox.run(
        notebook(
            "import signal, sys\nsys.setrecursionlimit(50)\n"
            "signal.signal(signal.SIGPROF, signal.SIG_IGN)",
            "import sympy\ncheck('q', sympy.trigsimp(sympy.sin(sympy.Symbol('x'))**2 + "
            "sympy.cos(sympy.Symbol('x'))**2))",
            "while True: pass",
            questions={"q": None},
        )
    )
    assert outcomes(result) == ["done", "done", "timeout"]
    assert result["answers"]["q"]["plain"] == integer(1)


# ---- the order of the cells


def test_a_notebook_that_works_only_out_of_order_is_told_so(sandbox):
    job = notebook(
        (3, "check('q', later + 1)"),
        (2, "later = 1"),
        (None, "check('r', later)"),
        questions={"q": None, "r": None},
    )
    result = sandbox.run(job)
    assert result["answers"]["q"]["plain"] == integer(2)
    assert result["answers"]["r"]["plain"] == integer(1)
    assert result["notes"] == ["works only out of order"]
    assert result["cells"][1]["error"].startswith("NameError")  # In the order in which it is read.


@pytest.mark.parametrize(
    "cells, answer",
    [
        ([(5, "a = 1"), (4, "a = 2"), (3, "check('q', a)")], integer(2)),
        ([(2, "check('q', nowhere)"), (1, "x = 1")], "missing"),
    ],
)
def test_top_to_bottom_is_what_counts_where_it_works_or_no_order_does(sandbox, cells, answer):
    result = sandbox.run(notebook(*cells, questions={"q": None}))
    recorded = result["answers"]["q"]
    assert recorded.get("plain", recorded["outcome"]) == answer and result["notes"] == []


# ---- honest notebooks


@pytest.mark.parametrize(
    "source",
    [
        "%matplotlib inline\n!pip install nothing\nfiles = !ls\nassert files == "
        "[]\ndisplay(1)\nget_ipython().magic('x')",
        "%%time\nx = 1",
        "%time x = 1",
        "%%capture output\nx = 1",
        "import matplotlib.pyplot as plt\nplt.plot([1, 2]); plt.title('$x^2$'); "
        "plt.savefig('f.png'); plt.show()",
        "import warnings\nwarnings.warn('careful'); import numpy as np; np.array([1.0]) / 0",
        "import sympy as sm\nsm.init_printing(use_latex='mathjax')\nsm.Symbol('x')\n"
        "import sympy.physics.mechanics as me\nme.init_vprinting()\n"
        "a, b = me.dynamicsymbols('a, b')\nN, A = me.ReferenceFrame('N'), me.ReferenceFrame('A')\n"
        "A.orient_body_fixed(N, (a, b, 0), 'zxz'); A.ang_vel_in(N); sm.simplify(A.dcm(N).T * "
        "A.dcm(N))",
        "import numpy as np\nnp.linalg.eig(np.random.rand(50, 50)); np.save('a', np.eye(3)); "
        "np.load('a.npy')",
        "import sympy as sm, numpy as np\nx = sm.Symbol('x')\nassert sm.lambdify(x, sm.sin(x), "
        "'numpy')(np.zeros(2)).size == 2",
        "from concurrent.futures import ThreadPoolExecutor\n"
        "assert list(ThreadPoolExecutor(4).map(abs, [-1])) == [1]",
        "import tempfile\nwith tempfile.TemporaryDirectory() as d: open(d + '/x', 'w').write('x')",
        "import pathlib, shutil\npathlib.Path('a').write_text('x'); shutil.copyfile('a', 'b'); "
        "pathlib.Path('b').unlink()",
        "from IPython.display import display, HTML, Latex, Math\ndisplay(Math('x'), HTML('<b>'))",
        "from ipywidgets import interact, FloatSlider\n@interact(x=FloatSlider())\n"
        "def f(x=1.0): return x",
        "import dataclasses, enum, pickle, copy\n@dataclasses.dataclass\nclass P: x: int = 1\n"
        "assert pickle.loads(pickle.dumps(P())) == copy.deepcopy(P())",
        "from scipy.spatial.transform import Rotation\n"
        "Rotation.from_euler('ZXY', [1, 2, 3]).as_matrix()",
        "import urllib.request, asyncio, multiprocessing, sqlite3, decimal, fractions, zoneinfo, "
        "ctypes, unittest",
        "print('x' * 10_000_000)",
    ],
)
def test_honest_cells_run(sandbox, source, monkeypatch):
    # They must run to their end even on a slow machine.
    monkeypatch.setattr(sandbox, "limits", Limits())
    if "scipy" in source:
        pytest.importorskip("scipy")
    result = sandbox.run(notebook("x = 1", source, "check('q', x)", questions={"q": None}))
    assert outcomes(result)[1] == "done", result["cells"]
    assert result["answers"]["q"]["plain"]["nodes"] and result["notes"] == []


@pytest.mark.parametrize(
    "cells",
    [
        ["3 * 4", "x = _ + 1\ncheck('q', x)"],
        [(7, "3 * 4"), (8, "check('q', Out[7] + 1)")],
        [(7, "3 * 4"), (8, "check('q', _7 + 1)")],
        ["12", "None", "1 if False else None", "check('q', _ + 1)"],
        [(7, "12"), (8, "check('q', eval(In[7]) + 1)")],
        ["import asyncio\nasync def f():\n    await asyncio.sleep(0)\n    return 13",
         "x = await f()", "check('q', x)"],
        ["import asyncio", "check('q', (await asyncio.gather(asyncio.sleep(0, 13)))[0])"],
        ["%%writefile own.py\nvalue = 12", "%%writefile -a own.py\nvalue += 1",
         "import own\ncheck('q', own.value)"],
        ["from helpers import own\ncheck('q', own.value)"],
        ["check('q', int(open('data/table.csv').read().split(',')[1]))"],
    ],
)  # fmt: skip
def test_cells_run_as_in_jupyter(sandbox, cells):
    beside = {
        "helpers/own.py": b"value = 13",
        "helpers/__init__.py": b"",
        "data/table.csv": b"12,13",
    }
    files = {name: base64.b64encode(data).decode() for name, data in beside.items()}
    result = sandbox.run(notebook(*cells, questions={"q": None}) | {"files": files})
    assert result["answers"]["q"].get("plain") == integer(13), result["cells"]


def test_files_beside_lead_nowhere(sandbox):
    """Names come from an archive and were checked before; here they may be anything."""
    files = {
        "../outside": "",
        "/tmp/outside": "",
        "a/../../outside": "",
        "fine": base64.b64encode(b"x").decode(),
    }
    result = sandbox.run(
        notebook("check('q', len(open('fine').read()))", questions={"q": None}) | {"files": files}
    )
    assert result["answers"]["q"]["plain"] == integer(1)


def test_a_cell_of_text_only_for_the_shell_does_nothing(sandbox):
    result = sandbox.run(
        notebook("%%bash\nrm -rf *", "%%html\n<b>x</b>", "?print", "", "# nothing")
    )
    assert outcomes(result) == ["done"] * 5


# ---- the same results everywhere


def class_of_notebooks():
    sources = [
        "import random, numpy\ncheck('q', random.random()); check('r', float(numpy.random.rand()))",
        "check('q', hash('text')); check('r', list({'a', 'b', 'c', 'd'}))",
        "import os; check('q', 1); os._exit(1)",
        "x = object(); raise ValueError(x)",
        "check('q', 1/0)",
        "open(os.path.abspath('none'))",
        "import os\ncheck('r', os.getcwd() != ''); open(os.path.abspath('none'))",
    ]
    return [
        notebook(source, "check('s', 1)", questions={"q": None, "r": None, "s": None})
        | {"id": f"{number}"}
        for number, source in enumerate(sources * 2)
    ]


def bytes_of(results):
    return json.dumps(sorted(results, key=lambda result: int(result["id"])), sort_keys=True)


@pytest.mark.sampled(2, of="sandboxes under strain")
def test_the_same_bytes_on_any_number_of_workers_and_when_one_is_killed(sandbox):
    before = warm_parents()
    results = run_notebooks(class_of_notebooks(), workers=2, limits=LIMITS)
    begun = []
    # Each worker begins with one of these two.
    while not {"0", "1"} <= {result["id"] for result in begun}:
        begun.append(next(results))
    # Kill a warm parent, whatever it is doing.
    [process for process in warm_parents() if process not in before][-1].kill()
    assert bytes_of([*begun, *results]) == bytes_of(map(sandbox.run, class_of_notebooks()))


@pytest.mark.parametrize(
    "ticks, charged",
    [
        ([(0.5, 0.0, 1)] * 3, 1.5),  # Asleep: it wakes at each tick, and at once.
        ([(0.5, 0.5, 0)] * 3, 1.5),  # Alone at work.
        ([(0.5, 0.1, 30)] * 3, 0.3),  # At work and reading files, with a fifth of a busy machine.
        # At work, with almost nothing of a very busy machine
        ([(0.5, 0.001, 0)] * 3, 0.003),
        ([(40.0, 0.001, 0)], 0.001),
        ([(40.0, 0.0, 1)], 0.5),  # Nobody knows how long it slept.
    ],
)
def test_what_a_busy_machine_withholds_is_charged_to_nobody(monkeypatch, ticks, charged):
    from coursework.grading.execution import notebook as inside

    cell = inside._Notebook.__new__(inside._Notebook)
    cell.writing, cell.wall_left, cell.looked, moment = False, 100.0, (0, 0, 0), (0, 0, 0)
    for tick in ticks:
        moment = tuple(before + more for before, more in zip(moment, tick, strict=True))
        monkeypatch.setattr(inside._Notebook, "moment", lambda self, moment=moment: moment)
        cell.time_is_up(signal.SIGALRM, None)
    assert 100 - cell.wall_left == pytest.approx(charged)


@pytest.mark.long
def test_an_answer_that_gets_next_to_nothing_of_a_processor_is_not_lost():
    limits = Limits(
        cell_seconds=30, cell_wall_seconds=1.5, grace_seconds=0.5, notebook_wall_seconds=600
    )
    begun = "import time\nbegun = time.process_time()"
    source = "while time.process_time() - begun < 0.1:\n    pass\ncheck('q', 1)"
    processor = min(os.sched_getaffinity(0))
    with Sandbox(limits) as sandbox:
        sandbox.run(notebook("1"))
        first = psutil.Process(sandbox.process.pid)
        for process in (first, *first.children(recursive=True)):
            process.nice(19)
            process.cpu_affinity([processor])
            # Some systems first distribute processor time among sessions.
            with contextlib.suppress(OSError):
                Path(f"/proc/{process.pid}/autogroup").write_text("19")
        other = subprocess.Popen([sys.executable, "-c", "while True: pass"])
        try:
            psutil.Process(other.pid).cpu_affinity([processor])
            start = time.monotonic()
            result = sandbox.run(notebook(begun, source, questions={"q": None}))
        finally:
            other.kill()
            other.wait()
    assert result["answers"]["q"]["outcome"] == "recorded", result
    assert time.monotonic() - start > 2  # Otherwise there was no strain.


@pytest.mark.sampled(2, of="sandboxes under strain")
def test_addresses_are_the_same_each_time(lent_sandboxes):
    """Some of a notebook's results depend on them."""
    asked = notebook("check('q', [id(object), id([])])", questions={"q": None})
    first, second = (sandbox.run(asked)["answers"]["q"] for sandbox, _ in lent_sandboxes)
    assert first["outcome"] == "recorded" and first == second


def warm_parents():
    """Return the processes of the workers, oldest first."""
    processes = []
    for process in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.Error):  # It may end in the meantime.
            if "coursework.grading.execution.warm_parent" in " ".join(process.cmdline()):
                processes.append(process)
    assert processes
    return sorted(processes, key=lambda process: process.pid)


def test_a_worker_that_always_dies_is_named(sandbox, monkeypatch):
    monkeypatch.setattr(Sandbox, "send", lambda *a: (_ for _ in ()).throw(WorkerDied("gone")))
    monkeypatch.setattr(Sandbox, "start", lambda self: None)
    monkeypatch.setattr(Sandbox, "close", lambda self: None)
    with pytest.raises(WorkerDied, match="3 times while it ran notebook 'n'"):
        sandbox.run(notebook("1"))


@pytest.mark.sampled(2, of="sandboxes under strain")
def test_who_stops_listening_leaves_nothing_running():
    before = {process.pid for process in psutil.Process().children(recursive=True)}
    sleeping = notebook("import time; time.sleep(600)")
    results = run_notebooks([notebook("1"), *[sleeping] * 5], workers=2, limits=LIMITS)
    next(results)
    results.close()
    # Another test's process may have ended meanwhile.
    assert {process.pid for process in psutil.Process().children(recursive=True)} <= before


KILLED = """
import json, sys
from coursework.grading.execution.sandbox import run_notebooks
jobs = json.loads(sys.argv[1])
options = {"without": json.loads(sys.argv[2]), "allow_weak_isolation": True}
# A single notebook has a single worker, whose only child is the process that removes the folder.
for result in run_notebooks(jobs, workers=min(2, len(jobs)), **options):
    print(result["id"], flush=True)
"""


@pytest.fixture(params=["with bubblewrap", "without bubblewrap"])
def environment(request, tmp_path):
    """A grader's environment with its own temporary folder, with or without bubblewrap."""
    bubblewrap = shutil.which("bwrap")
    if request.param == "with bubblewrap" and bubblewrap is None:
        pytest.skip("bubblewrap is not installed")
    folders = {name: tmp_path / name for name in ("programs", "temporary")}
    for folder in folders.values():
        folder.mkdir()
    if request.param == "with bubblewrap":
        (folders["programs"] / "bwrap").symlink_to(bubblewrap)
    return os.environ | {"TMPDIR": str(folders["temporary"]), "PATH": str(folders["programs"])}


def folders_in(place):
    """Return our own folders; Python itself tests such a place with an empty file."""
    return [entry.name for entry in os.scandir(place) if entry.is_dir()]


def children_of(grader):
    with contextlib.suppress(psutil.NoSuchProcess):
        return psutil.Process(grader.pid).children(recursive=True)
    return []


@pytest.mark.sampled(2, of="graders that are killed")
@pytest.mark.parametrize("without", [[], ["namespaces"]], ids=["in memory", "on disk"])
def test_a_grader_that_is_killed_leaves_nothing(environment, without):
    jobs = [notebook("1"), *[notebook("import time; time.sleep(600)")] * 2]
    grader = subprocess.Popen(
        [sys.executable, "-c", KILLED, json.dumps(jobs), json.dumps(without)],
        stdout=subprocess.PIPE,
        text=True,
        env=environment,
    )
    assert grader.stdout.readline() == "n\n"
    end_at_once(grader)
    assert folders_in(environment["TMPDIR"]) == []


def end_at_once(grader):
    below = children_of(grader)
    assert len(below) >= 2
    grader.kill()
    grader.wait()
    if grader.stdout:
        grader.stdout.close()
    _, alive = psutil.wait_procs(below, timeout=300)
    assert alive == []


@pytest.mark.sampled(2, of="graders that are killed")
def test_a_grader_that_is_killed_while_it_starts_leaves_nothing(environment):
    """Kill it as soon as the folder exists, while libraries load and nothing has been tested."""
    grader = subprocess.Popen(
        [sys.executable, "-c", KILLED, json.dumps([notebook("1")]), "[]"], env=environment
    )
    while not (folders_in(environment["TMPDIR"]) and len(children_of(grader)) >= 2):
        assert grader.poll() is None
    end_at_once(grader)
    assert folders_in(environment["TMPDIR"]) == []


def test_a_job_that_is_no_job_is_refused(sandbox):
    with pytest.raises(TypeError, match="strings"):
        sandbox.run({"id": 1, "cells": [], "questions": {}})


def test_a_large_notebook_and_a_large_answer_come_through(sandbox):
    source = (
        "import sympy\n# "
        + "x" * 300_000
        + "\nm = sympy.symbols('m:2000')\ncheck('q', sympy.Add(*m))"
    )
    result = sandbox.run(notebook(source, questions={"q": None}))
    assert len(result["answers"]["q"]["plain"]["nodes"]) == 2001


# ---- records as bytes

RECORD = {"answer": "q", "from": "check", "cell": 0, "plain": integer(1)}


def read(*lines, cells=3):
    reader = records.Records(cells)
    return reader.feed(b"".join(line + b"\n" for line in lines)), reader


def test_records_may_come_in_any_pieces():
    data = (json.dumps(RECORD) + "\n\n" + json.dumps({"done": True}) + "\n").encode()
    for size in (1, 2, 7, 1000):
        reader = records.Records(1)
        received = [
            record
            for start in range(0, len(data), size)
            for record in reader.feed(data[start : start + size])
        ]
        assert received == [RECORD, {"done": True}] and reader.damaged == 0


@pytest.mark.parametrize(
    "changed",
    [
        {"answer": 1},
        {"answer": "q" * 201},
        {"from": "grader"},
        {"cell": 3},
        {"cell": -1},
        {"cell": True},
        {"cell": 0.0},
        {"plain": None},
        {"plain": {"value": ["expression", 1], "nodes": [["integer", "1"]]}},
        {"plain": {"value": ["expression", 0], "nodes": [["integer", "1; import os"]]}},
        {"mark": 1},
        {"answer": "\ud800"},
        {"unreadable": "both"},
    ],
)
def test_a_record_of_another_form_is_dropped_and_counted(changed):
    received, reader = read(json.dumps(RECORD | changed).encode(), json.dumps(RECORD).encode())
    assert received == [RECORD] and reader.damaged == 1


@pytest.mark.parametrize(
    "line",
    [
        b"null",
        b"[]",
        b"{",
        b'{"done": 1}',
        b"\xff",
        b"[" * 100_000,
        b'{"done": true, "done2": NaN}',
        b"1" * 10_000,
        b'{"begin": ["cell", 9]}',
        b'{"begin": ["marks", 1]}',
        b'{"end": ["cell", 1], "outcome": "correct"}',
        b'{"end": ["cell", 1], "outcome": "done", "line": 1e400}',
        b'{"end": ["cell", 1], "outcome": ["done"]}',
    ],
)
def test_what_is_no_record_is_dropped_and_counted(line):
    received, reader = read(line)
    assert received == [] and reader.damaged == 1


def test_floods_are_noticed():
    assert read(*[b"{}"] * (records.MOST_RECORDS + 1))[1].too_many
    reader = records.Records(1)
    reader.feed(b"x" * (records.LONGEST_LINE + 1))
    assert reader.too_many and not read(json.dumps(RECORD).encode())[1].too_many


def test_nothing_here_unpickles_or_evaluates():
    """The trusted side has no way to run what a student wrote."""
    folder = Path(records.__file__).parent
    for name in ("sandbox.py", "records.py", "scratch.py"):
        text = (folder / name).read_text()
        for word in (
            "pickle.",
            "eval(",
            "exec(",
            "sympify",
            "srepr",
            "lambdify",
            "import pickle",
            "import sympy",
        ):
            assert word not in text, (name, word)
