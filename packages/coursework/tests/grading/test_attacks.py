"""Every attack of the corpus fails and harms nobody else; without its layer, it succeeds."""

import contextlib
import ctypes
import dataclasses
import json
import multiprocessing
import os
import select
import socket
import subprocess
import sys
import tempfile
from pathlib import Path

import psutil
import pytest
from attacks.corpus import ATTACKS

from coursework.grading.execution.sandbox import Limits, Sandbox, run_notebooks
from coursework.grading.execution.scratch import remove_folder
from coursework.grading.record import Isolation

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="student code runs on Linux only"
)

# Code stopped by processor time has ample wall time, so that a busy machine changes nothing. What
# only wall time stops runs alone.
LIMITS = Limits(
    cell_seconds=1,
    cell_wall_seconds=60,
    answer_seconds=0.5,
    answer_wall_seconds=60,
    grace_seconds=0.5,
    notebook_seconds=20,
    notebook_wall_seconds=300,
    memory_bytes=256 << 20,
    scratch_bytes=32 << 20,
    file_bytes=16 << 20,
    runs=4,
)
SHORT = dataclasses.replace(LIMITS, cell_wall_seconds=2)
HALVES = ("HEIRLOOM", "SPANNER")
HONEST = {"question": {"variable": None}}


class Surroundings:
    """The targets of the attacks: a file, a trap, three listeners, and this process."""

    def __init__(self, folder):
        self.folder = folder
        self.outside = folder / "outside"
        self.outside.mkdir()
        self.canary = self.outside / "canary"
        self.reset()
        self.tcp, self.udp = (
            socket.socket(socket.AF_INET, kind) for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM)
        )
        self.local = socket.socket(socket.AF_UNIX)
        for inet in (self.tcp, self.udp):
            inet.bind(("127.0.0.1", 0))
        self.local_name = f"attacked-{os.getpid()}"
        self.local.bind("\0" + self.local_name)
        for listener in (self.tcp, self.local):
            listener.listen(16)

    def reset(self):
        for file in self.outside.iterdir():
            file.unlink()
        self.canary.write_text("SEALED")
        # It is open to all users, so its mode is not what protects it.
        for path in (self.folder, self.outside):
            path.chmod(0o777)
        self.canary.chmod(0o666)
        os.utime(self.canary, (1_000_000_000, 1_000_000_000))

    def state(self):
        status = self.canary.stat() if self.canary.exists() else None
        return (
            sorted(os.listdir(self.outside)),
            status and (status.st_mode, status.st_mtime, status.st_size),
        )

    def heard(self):
        """Return how many of the listeners have something waiting, and take it away."""
        ready = select.select([self.tcp, self.udp, self.local], [], [], 0)[0]
        for listener in ready:
            if listener is self.udp:
                listener.recv(10)
            else:
                listener.accept()[0].close()
        return len(ready)

    def names(self):
        return (
            f"CANARY, TRAP = {str(self.canary)!r}, {str(self.outside / 'trap')!r}\n"
            f"TCP, UDP, LOCAL = {self.tcp.getsockname()[1]}, {self.udp.getsockname()[1]}, "
            f"{self.local_name!r}\n"
            f"GRADER, SECRET = {os.getpid()}, {HALVES!r}\n"
        )

    def job(self, attack):
        cells = [
            "import sympy\nfrom coursework import check\n" + self.names() + "check('before', 1)",
            attack.code,
            "check('after', 2)",
        ]
        return {
            "id": attack.name,
            "cells": [{"source": source} for source in cells],
            "questions": {name: {"variable": None} for name in ("before", "loot", "after")},
        }


def neighbour(number):
    source = (
        f"from coursework import check\nimport os\n# {''.join(HALVES)}\n"
        f"marker = '{''.join(HALVES)}'\n"
        f"assert os.listdir() == []\nopen('mine', 'w').write(marker)\ncheck('question', {number})"
    )
    return {"id": f"neighbour {number}", "cells": [{"source": source}], "questions": HONEST}


def integer(number):
    return {"value": ["expression", 0], "nodes": [["integer", str(number)]]}


def taken(result):
    return result["answers"]["loot"].get("plain", {}).get("value") == ["text", "taken"]


@contextlib.contextmanager
def attackable():
    # Pytest's own folder is closed to other users, which must not be what keeps attacks out.
    folder = Path(tempfile.mkdtemp(prefix="attacked-"))
    folder.chmod(0o755)
    attacked = Surroundings(folder)
    with attacked.tcp, attacked.udp, attacked.local:
        yield attacked
    remove_folder(folder)


@pytest.fixture(scope="module")
def surroundings():
    with attackable() as attacked:
        yield attacked


def suffer(answer):
    """Run all attacks on two workers, each before an honest notebook; send what they left."""
    # Make orphans children of this process, so that none can hide.
    assert ctypes.CDLL(None).prctl(36, 1, 0, 0, 0) == 0
    os.environ["TOKEN"] = "SEALED"
    results = {}
    with attackable() as surroundings:
        temporary = surroundings.folder / "temporary"
        temporary.mkdir(mode=0o755)
        tempfile.tempdir = str(temporary)
        for limits, waits in ((LIMITS, False), (SHORT, True)):
            jobs = [
                job
                for number, attack in enumerate(ATTACKS)
                if attack.waits == waits
                for job in (surroundings.job(attack), neighbour(number))
            ]
            results |= {
                result["id"]: result
                for result in run_notebooks(jobs, workers=1 if waits else 2, limits=limits)
            }
        left = [str(child) for child in psutil.Process().children(recursive=True)]
        answer.send(
            {
                "results": results,
                "left": left,
                "state": surroundings.state(),
                "heard": surroundings.heard(),
                "temporary": os.listdir(temporary),
            }
        )


@pytest.fixture(scope="module")
def aftermath():
    """What all attacks left behind, in a process of their own without others' children."""
    spawn = multiprocessing.get_context("spawn")
    receiver, sender = spawn.Pipe(duplex=False)
    process = spawn.Process(target=suffer, args=(sender,))
    process.start()
    sender.close()
    with receiver:
        sent = receiver.recv()
    process.join()
    return sent


@pytest.mark.parametrize("attack", ATTACKS, ids=lambda attack: attack.name)
def test_attack_ends_with_its_name_and_takes_nothing(attack, aftermath):
    result = aftermath["results"][attack.name]
    assert Isolation.from_json(result["isolation"]).weak is False
    assert result["cells"][1]["outcome"] in attack.outcome.split(" or "), result["cells"]
    assert not taken(result)
    assert result["answers"]["before"].get("plain") == integer(1), "an earlier answer was lost"
    if not attack.spoils:
        assert result["answers"]["after"].get("plain") == integer(2), "a later answer was lost"
    assert ("wrote into the records" in result["notes"]) >= attack.noticed
    # Only plain data came out.
    assert json.loads(json.dumps(result)) == result
    json.dumps(result, ensure_ascii=False).encode("utf-8")


def test_the_neighbours_are_unharmed(aftermath):
    for number in range(len(ATTACKS)):
        result = aftermath["results"][f"neighbour {number}"]
        assert result["cells"] == [{"outcome": "done"}]
        assert result["answers"]["question"]["plain"] == integer(number)


def test_nothing_is_written_sent_or_left_running(aftermath):
    assert aftermath["state"] == (["canary"], (0o100666, 1_000_000_000, 6))
    assert aftermath["heard"] == 0 and aftermath["left"] == aftermath["temporary"] == []


UNPROTECTED = sorted({attack.without for attack in ATTACKS if attack.without})


@pytest.mark.sampled(1)
@pytest.mark.parametrize("layers", UNPROTECTED, ids=" and ".join)
def test_attacks_succeed_without_their_layers(layers, surroundings):
    """The same cells succeed when the layers against them are off, so we know what stops them."""
    with Sandbox(LIMITS, allow_weak_isolation=True, without=layers) as sandbox:
        for attack in ATTACKS:
            if attack.without == layers:
                surroundings.reset()
                result = sandbox.run(surroundings.job(attack))
                # Only an explicit request allows it, and every result says so.
                assert Isolation.from_json(result["isolation"]).weak is True
                assert result["isolation"]["not stopped"]
                assert not set(layers) & set(result["isolation"]["layers"])
                assert taken(result), (attack.name, result["cells"][1], sandbox.report)
                surroundings.heard()
    surroundings.reset()


NAIVE = """
import json, sympy, sys
answers = {}
TRAP = GRADER = None
exec(sys.argv[1], globals() | {"check": lambda name, answer: answers.update({name: answer})})
print(json.dumps({"mark": int(answers["loot"] == 42)}))
"""


@pytest.mark.sampled(2)
@pytest.mark.parametrize("attack", [a for a in ATTACKS if a.forges], ids=lambda attack: attack.name)
def test_a_verdict_in_the_students_process_is_forged(attack):
    """What a grader that compares in the student's process would make of the same cell."""
    run = subprocess.run(
        [sys.executable, "-c", NAIVE, attack.code], capture_output=True, text=True, check=True
    )
    assert json.loads(run.stdout)["mark"] == 1
