"""Grading on a Dask cluster: no byte differs, and a captured worker harms nobody but itself."""

import contextlib
import functools
import io
import json
import os
import pickle
import signal
import subprocess
import sys
import threading

import psutil
import pytest
from grading_class import LIMITS, contents, grade_quietly, handed_in, put, write_sources

from coursework.grading import commands
from coursework.grading.execution import cluster_keys
from coursework.grading.execution.sandbox import given_up
from coursework.grading.grade import grade
from coursework.grading.judging.journal import Journal
from coursework.grading.running import Running

distributed = pytest.importorskip("distributed")
clusters = pytest.importorskip("coursework.grading.execution.cluster")
pytestmark = [
    pytest.mark.skipif(
        not sys.platform.startswith("linux"), reason="student code runs on Linux only"
    ),
    pytest.mark.filterwarnings("ignore"),
]


@contextlib.contextmanager
def cluster(folder, workers=1, preload=None, keys=()):
    """Start the scheduler and workers of a cluster, and return its address and its processes."""
    place = folder / "scheduler.json"
    address = ["--scheduler-file", str(place)]
    local = ["--host", "127.0.0.1", "--no-dashboard", *keys]
    commands = [["scheduler", *address, *local, "--port", "0"]]
    loads = ["--preload", str(preload)] if preload else []
    commands += [
        ["worker", *address, *local, "--nthreads", "1", "--local-directory", str(folder), *loads]
    ] * workers
    processes = [
        subprocess.Popen(
            [sys.executable, "-m", "dask", *command],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        for command in commands
    ]
    try:
        while not place.exists() or not place.read_text().endswith("}"):
            assert processes[0].poll() is None
        yield json.loads(place.read_text())["address"], processes
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            process.wait()


@pytest.fixture
def submissions(tmp_path):
    """The notebooks of a few students."""
    for number in range(6):
        put(
            tmp_path / "submissions",
            f"student-{number}",
            handed_in(sum=f"sine = {number}*sm.sin(alpha + beta)"),
        )
    put(tmp_path / "submissions", "leaves", handed_in(sum="import os\nos._exit(0)"))
    return tmp_path / "submissions"


@pytest.fixture
def solutions(tmp_path):
    return write_sources(tmp_path / "solutions")


@pytest.mark.long
def test_a_cluster_that_loses_a_worker_changes_no_byte(submissions, solutions, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    grade_quietly(submissions, here, solutions)
    lost, over = [], threading.Event()

    def lose_a_worker():
        while not over.wait(0.01):
            if list((there / "records").glob("*/*.json")):
                # The worker is a child of the command that was started.
                victims = [processes[1], *psutil.Process(processes[1].pid).children(recursive=True)]
                lost.extend(victims)
                for victim in victims:
                    with contextlib.suppress(psutil.NoSuchProcess):
                        victim.send_signal(signal.SIGKILL)
                return

    with cluster(tmp_path, workers=2) as (address, processes):
        killer = threading.Thread(target=lose_a_worker)
        killer.start()
        try:
            said = grade_quietly(submissions, there, solutions, address)
        finally:
            over.set()
            killer.join()
    assert lost and said["graded"] == 7
    assert contents(there) == contents(here)
    # The journal also has the time of marks, and random IDs of its lines.
    given_there, given_here = (
        {key: given.marks for key, given in Journal(folder).standing().given.items()}
        for folder in (there, here)
    )
    assert given_there == given_here


HOSTILE = """
import os
from pathlib import Path
from coursework.grading.execution import cluster
from coursework.grading.running import Running

class Evil:
    def __reduce__(self):
        # Whoever unpickles this leaves a file that is called after its process, and gets an honest
        # error.
        file = "open({folder!r} + '/' + str(__import__('os').getpid()), 'w')"
        return eval, (file + ".close() or ValueError('x')",)

class EvilError(Exception):
    def __reduce__(self):
        return Evil().__reduce__()

def run_job(job, name):
    {deed}

cluster.run_job = run_job
"""


@pytest.mark.parametrize(
    "damage",
    [
        {"finished": "yes"},
        {"cells": [{"outcome": 3}]},
        {"cells": "done"},
        {"isolation": {"layers": [], "weak": 0}},
        {
            "answers": {
                "turns/sum": {
                    "outcome": "recorded",
                    "plain": {"nodes": [], "value": ["no such kind"]},
                }
            }
        },
        {"answers": {}},
        {"id": "another"},
    ],
)
def test_what_a_captured_worker_sends_is_read_as_strictly_as_what_a_notebook_sends(damage):
    # Import it only when we know that Dask is installed.
    from coursework.grading.execution import cluster as of_a_cluster

    job = {"id": "1", "cells": [], "questions": {"turns/sum": {}}}
    result, ours = given_up(job, "a trial"), {"python": "3"}
    assert of_a_cluster._demand_sound({"result": result, "software": ours}, job, ours) == result
    with pytest.raises(ValueError, match="The cluster sent damaged data"):
        of_a_cluster._demand_sound({"result": result | damage, "software": ours}, job, ours)


@pytest.mark.long
@pytest.mark.parametrize("deed", ["raise EvilError", "return [b'x', Evil()]"])
def test_a_captured_worker_runs_nothing_here(submissions, solutions, tmp_path, deed):
    touched = tmp_path / "touched"
    touched.mkdir()
    preload = tmp_path / "hostile.py"
    preload.write_text(HOSTILE.format(folder=str(touched), deed=deed))
    with cluster(tmp_path, preload=preload) as (address, _):
        with pytest.raises(ValueError, match="sent something other than a result"):
            grade_quietly(submissions, tmp_path / "out", solutions, address)
    assert str(os.getpid()) not in os.listdir(touched)
    assert not list((tmp_path / "out" / "records").glob("*/*"))


@pytest.mark.long
def test_a_lost_scheduler_is_said_and_nothing_is_lost(
    submissions, solutions, tmp_path, monkeypatch
):
    from coursework.grading.execution import cluster as running

    monkeypatch.setattr(running, "CONNECT_WITHIN", "8s")  # It gives up after this time.
    # The last by name is at work, and not yet recorded, when the scheduler is lost.
    put(submissions, "takes-long", handed_in(sum="import time\ntime.sleep(20)\nsine = 0"))
    out, over = tmp_path / "out", threading.Event()

    def lose_the_scheduler():
        while not over.wait(0.01):
            if len(list((out / "waiting").glob("*/*.json"))) >= 2:
                # The scheduler may be a child of the command that was started.
                for victim in [
                    processes[0],
                    *psutil.Process(processes[0].pid).children(recursive=True),
                ]:
                    with contextlib.suppress(psutil.NoSuchProcess):
                        victim.kill()
                return

    with cluster(tmp_path) as (address, processes):
        killer = threading.Thread(target=lose_the_scheduler)
        killer.start()
        try:
            with pytest.raises(ValueError, match="lost the connection to the scheduler at"):
                grade_quietly(submissions, out, solutions, address)
        finally:
            over.set()
            killer.join()
    kept = len(list((out / "waiting").glob("*/*.json")))
    assert kept >= 2
    put(submissions, "takes-long", handed_in())
    done = grade_quietly(submissions, out, solutions)
    assert (done["graded"], done["kept"], done["refused"]) == (8 - kept, kept, 0)


def test_no_pickle_is_read_while_a_cluster_is_used():
    from distributed import client, core, protocol

    from coursework.grading.execution.cluster import no_pickles

    harmless = pickle.dumps(ValueError("x"))
    with no_pickles():
        for loads in (protocol.pickle.loads, client.loads, client.pickle.loads):
            with pytest.raises(TypeError, match="refused"):
                loads(harmless)
            assert loads(pickle.dumps([b"plain", 1.5, None])) == [b"plain", 1.5, None]
        assert core.clean_exception(harmless)[1].args == (harmless,)
    assert isinstance(protocol.pickle.loads(harmless), ValueError) and client.pickle is pickle


def test_a_cluster_that_is_not_there_is_said(submissions, solutions, tmp_path, monkeypatch):
    from coursework.grading.execution import cluster

    monkeypatch.setattr(cluster, "CONNECT_WITHIN", "0.5s")
    with pytest.raises(ValueError, match="cannot reach a Dask scheduler at tcp://127.0.0.1:1"):
        grade_quietly(submissions, tmp_path / "out", solutions, "tcp://127.0.0.1:1")


@pytest.mark.long
def test_a_cluster_listens_to_those_alone_who_have_its_key(tmp_path, submissions):
    """An open scheduler runs anybody's code on all of its machines."""
    keys = tmp_path / "keys"
    assert cluster_keys.make_keys(keys) and not cluster_keys.make_keys(keys)
    assert all(path.stat().st_mode & 0o077 == 0 for path in (keys, keys / cluster_keys.KEY))
    for command in (
        cluster_keys.scheduler(keys, "192.0.2.7"),
        cluster_keys.worker(keys, "tls://192.0.2.7:8786", 2),
    ):
        assert command[command.index("--protocol") + 1] == "tls" and "--tls-ca-file" in command
    options = {"solutions": write_sources(tmp_path / "solutions"), "show": io.StringIO()}
    with cluster(tmp_path, keys=[*cluster_keys.options(keys), "--protocol", "tls"]) as (address, _):
        assert address.startswith("tls://")
        with pytest.raises(OSError):
            distributed.Client(address.replace("tls:", "tcp:"), timeout="5s")
        running = functools.partial(Running, limits=LIMITS, scheduler=address)
        cluster_keys.make_keys(tmp_path / "other")
        with pytest.raises(ValueError, match="cannot reach a Dask scheduler"):
            grade(
                submissions, tmp_path / "none", running=running(keys=tmp_path / "other"), **options
            )
        grade(submissions, tmp_path / "there", running=running(keys=keys), **options)
    grade(submissions, tmp_path / "here", running=Running(limits=LIMITS), **options)
    there, here = ((tmp_path / place / "grades.csv").read_bytes() for place in ("there", "here"))
    assert there == here


@pytest.mark.parametrize(
    "address, keys, said",
    [
        ("tcp://192.0.2.7:8786", None, "does not require a key"),
        ("192.0.2.7:8786", None, "does not require a key"),
        ("tls://192.0.2.7:8786", None, "--keys FOLDER"),
        ("tls://192.0.2.7:8786", "nowhere", "Copy the folder"),
    ],
)
def test_a_cluster_without_keys_is_refused(tmp_path, address, keys, said):
    with pytest.raises(cluster_keys.NoKeys, match=said):
        cluster_keys.demand_keys(address, keys and tmp_path / keys)
    cluster_keys.demand_keys("tcp://127.0.0.1:8786", None)
    # With keys, nothing is sent unencrypted, whatever the scheduler offers.
    assert clusters._security(tmp_path).require_encryption


def test_a_cluster_without_its_package_says_which(tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(SystemExit, match="pip install distributed"):
        commands.cluster(str(tmp_path / "keys"), "192.0.2.7", 8786, None, None)
    assert not (tmp_path / "keys").exists()
