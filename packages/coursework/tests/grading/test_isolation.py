"""The layers of isolation: tested, named, refused if insufficient, and complete for any user."""

import contextlib
import ctypes
import errno
import json
import os
import shutil
import struct
import subprocess
import sys

import pytest

from coursework.grading.execution import isolation, scratch, system_calls
from coursework.grading.execution.isolation import LANDLOCK, LAYERS, LIMITS, NAMESPACES, SECCOMP
from coursework.grading.execution.sandbox import Limits, Sandbox, WeakIsolation, run_notebooks
from coursework.grading.execution.warm_parent import WarmParent
from coursework.grading.record import Isolation

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="student code runs on Linux only"
)

HONEST = {
    "id": "honest",
    "cells": [{"source": "answer = 6 * 7"}],
    "questions": {"q": {"variable": "answer"}},
}


@pytest.fixture(scope="module")
def sandbox(lent_sandboxes):
    (sandbox, _), *_ = lent_sandboxes
    return sandbox


def test_every_attempt_is_stopped_and_the_result_says_by_what(sandbox):
    assert sandbox.report["not stopped"] == isolation.lacking(sandbox.report) == []
    result = sandbox.run(HONEST)
    assert result["answers"]["q"]["plain"]["nodes"] == [["integer", "42"]]
    assert Isolation.from_json(result["isolation"]).weak is False
    assert {SECCOMP, LIMITS, "no privileges"} <= set(result["isolation"]["layers"])
    assert {NAMESPACES, LANDLOCK} & set(result["isolation"]["layers"])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("without", [[SECCOMP], [LIMITS], [NAMESPACES, LANDLOCK]], ids=" and ".join)
def test_no_student_code_runs_where_isolation_is_weak(without):
    with pytest.raises(WeakIsolation) as refused:
        next(run_notebooks([HONEST], workers=1, without=without))
    for layer in without:
        assert layer in str(refused.value) and isolation.HOW_TO_GET[layer] in str(refused.value)
    assert "--allow-weak-isolation" in str(refused.value)


@pytest.mark.long
def test_each_layer_alone_stops_what_it_is_for(sandbox):
    """Every layer is tested with all others off, so that nothing else can have helped."""
    for layer in sandbox.isolation_in_force().layers:
        if layer == NAMESPACES:
            continue  # Each start tests it alone; what it hides cannot be tested from outside.
        others = set(LAYERS) - {layer}
        with Sandbox(without=others, allow_weak_isolation=True) as alone:
            in_force = alone.report["layers"]
            assert [name for name in LAYERS if in_force[name]["in force"]] == [layer]
            if layer != LIMITS:  # These hold for users, not for root.
                assert not set(isolation.must_stop(layer)) & set(alone.report["not stopped"])


def test_a_process_that_cannot_be_confined_runs_nothing(sandbox, monkeypatch):
    monkeypatch.setattr(sandbox, "limits", Limits(open_files=-5))
    with pytest.raises(WeakIsolation, match="could not isolate"):
        sandbox.run(HONEST)


def test_a_crash_is_handled_by_nobody(sandbox):
    """No file or program receives a crashed notebook's memory, whatever the system's settings."""
    cell = """
import ctypes, resource
library = ctypes.CDLL(None)
core = [*resource.getrlimit(resource.RLIMIT_CORE), library.prctl(3, 0, 0, 0, 0)]
library.prctl(4, 1, 0, 0, 0)  # to be dumped again
core.append(library.prctl(3, 0, 0, 0, 0))
"""
    job = {
        "id": "one",
        "cells": [{"source": cell}],
        "questions": {"core": {"variable": "core"}},
        "seed": 0,
    }
    result = sandbox.run(job)
    numbers = [int(node[1]) for node in result["answers"]["core"]["plain"]["nodes"]]
    said = [numbers[entry[1]] for entry in result["answers"]["core"]["plain"]["value"][1]]
    assert said[:3] == [1, 1, 0] and (len(said) == 3 or said[3] == 0)


def test_a_layer_that_does_not_exist_is_an_error():
    with pytest.raises(ValueError, match="unknown layers \\['armour'\\]"):
        Sandbox(without=["armour"])


# ---- other users, with bubblewrap and without

AS_NOBODY = """
import ctypes, os, sys
from pathlib import Path
from coursework.grading.execution import isolation as i
AT_FDCWD, AT_RECURSIVE, OPEN_TREE, MOVE_MOUNT = -100, 0x8000, 428, 429
# Python may be installed where only root can go: its folder is moved to where all can.
python = os.path.dirname(os.path.dirname(os.path.realpath(sys.executable)))
i._call("unshare", i._library.unshare(i.CLONE_NEWNS))
i._call("mount", i._library.mount(None, b"/", None, i.MS_REC | i.MS_PRIVATE, None))
closed = [p for p in map(str, Path(python).parents) if not os.stat(p).st_mode & 1]
if closed:
    tree = i._system_call("open_tree", OPEN_TREE, AT_FDCWD, python.encode(), 1 | AT_RECURSIVE)
    options = b"size=1m,mode=0755"
    i._call("mount", i._library.mount(b"tmpfs", closed[-1].encode(), b"tmpfs", 0, options))
    os.makedirs(python)
    i._system_call("move_mount", MOVE_MOUNT, tree, b"", AT_FDCWD, python.encode(), 4)
os.setgroups([]); os.setresgid(65534, 65534, 65534); os.setresuid(65534, 65534, 65534)
os.execv(sys.executable, [sys.executable, "-c", sys.argv[1], *sys.argv[2:]])
"""
TRY = """
import json, os, sys
from coursework.grading.execution.sandbox import Sandbox
job = json.loads(sys.argv[2])
with Sandbox(without=json.loads(sys.argv[1]), allow_weak_isolation=True) as sandbox:
    print(json.dumps([os.geteuid(), sandbox.report, sandbox.run(job)]))
"""


@pytest.mark.sampled(1)
@pytest.mark.parametrize("without", [[], [NAMESPACES]], ids=["bubblewrap", "no namespaces"])
def test_an_ordinary_user_is_as_safe(without):
    nobody = os.geteuid() == 0
    if nobody and ctypes.CDLL(None).prctl(23, 21, 0, 0, 0) != 1:
        pytest.skip("root without the right to mount cannot lay out Python for another user")
    if not without and shutil.which("bwrap") is None:
        pytest.skip("bubblewrap is not installed")
    start = [sys.executable, "-c", *([AS_NOBODY, TRY] if nobody else [TRY])]
    run = subprocess.run(
        [*start, json.dumps(without), json.dumps(HONEST)], capture_output=True, text=True, cwd="/"
    )
    assert run.returncode == 0, run.stderr
    user, report, result = json.loads(run.stdout)
    if not without and not report["layers"][NAMESPACES]["in force"]:
        pytest.skip(f"no namespaces on this machine: {report['layers'][NAMESPACES]['why not']}")
    assert user != 0 and isolation.lacking(report) == []
    assert (NAMESPACES in result["isolation"]["layers"]) == (not without)
    assert result["answers"]["q"]["outcome"] == "recorded"


# ---- the filter of system calls, interpreted instruction by instruction

ALLOW, REFUSE, UNKNOWN, KILL = (
    0x7FFF0000,
    0x00050000 | errno.EPERM,
    0x00050000 | errno.ENOSYS,
    0x80000000,
)
OWN = 4711


def decision(machine, number, *arguments, architecture=None):
    """Return the filter's decision on one system call, by interpreting its few instructions."""
    code = system_calls.program(OWN, machine)
    data = struct.pack(
        "=iI Q 6Q",
        ctypes.c_int32(number).value,
        architecture or system_calls.MACHINES[machine][0],
        0,
        *[a & (2**64 - 1) for a in arguments],
        *[0] * (6 - len(arguments)),
    )
    accumulator, position = 0, 0
    while True:
        operation, if_true, if_false, value = struct.unpack_from("=HBBI", code, 8 * position)
        position += 1
        if operation == 0x06:
            return value
        if operation == 0x20:
            accumulator = struct.unpack_from("=I", data, value)[0]
            continue
        holds = {
            0x15: accumulator == value,
            0x35: accumulator >= value,
            0x45: bool(accumulator & value),
        }[operation]
        position += if_true if holds else if_false


@pytest.mark.parametrize(
    "machine, numbers",
    [
        (
            "x86_64",
            dict(
                read=0,
                write=1,
                mmap=9,
                openat=257,
                clone=56,
                kill=62,
                prlimit=302,
                fcntl=72,
                ioctl=16,
                socket=41,
                socketpair=53,
                fork=57,
                vfork=58,
                execve=59,
                ptrace=101,
                mount=165,
                bpf=321,
                chmod=90,
                unshare=272,
                memfd=319,
                setrlimit=160,
                prctl=157,
                keyctl=250,
                perf=298,
                faults=323,
            ),
        ),
        (
            "aarch64",
            dict(
                read=63,
                write=64,
                mmap=222,
                openat=56,
                clone=220,
                kill=129,
                prlimit=261,
                fcntl=25,
                ioctl=29,
                socket=198,
                socketpair=199,
                execve=221,
                ptrace=117,
                mount=40,
                bpf=280,
                chmod=53,
                unshare=97,
                memfd=279,
                setrlimit=164,
                prctl=167,
                keyctl=219,
                perf=241,
                faults=282,
            ),
        ),
    ],
)
def test_the_filter_lets_computing_through_and_nothing_else(machine, numbers):
    def says(name, *arguments):
        return decision(machine, numbers[name], *arguments)

    allowed = {"read", "write", "mmap", "openat"}
    conditional = {"clone", "kill", "prlimit", "fcntl", "ioctl", "prctl"}
    for name in numbers:
        if name in allowed:
            assert says(name) == ALLOW, name
        elif name not in conditional:
            assert says(name) == REFUSE, name
    # Threads are allowed, but not processes, and never with new namespaces.
    thread = 0x003D0F00
    assert says("clone", thread) == ALLOW
    assert (
        says("clone", 17) == says("clone", 0x4111) == says("clone", thread | 0x10000000) == REFUSE
    )
    # Signals may go only to itself.
    assert says("kill", OWN, 9) == ALLOW
    assert (
        says("kill", OWN + 1, 9)
        == says("kill", -1, 9)
        == says("kill", 0, 9)
        == says("kill", -OWN, 9)
        == REFUSE
    )
    # Limits may be read, but not set.
    assert says("prlimit", 0, 7, 0, 1) == ALLOW
    assert (
        says("prlimit", 0, 7, 1 << 40, 0)
        == says("prlimit", 0, 7, 64, 0)
        == says("prlimit", 99, 7, 0, 1)
        == REFUSE
    )
    # There are no locks on shared files, no signals through a file, and no input into a terminal.
    assert says("fcntl", 3, 1) == says("ioctl", 1, 0x5401) == says("prctl", 15) == ALLOW
    assert (
        says("fcntl", 3, 8)
        == says("fcntl", 3, 6)
        == says("ioctl", 0, 0x5412)
        == says("prctl", 1)
        == REFUSE
    )
    # New calls fail as on a kernel that lacks them, so that C libraries work without them.
    assert {decision(machine, number) for number in (425, 435, 437, 447, 470)} == {UNKNOWN}
    # Calls of another kind of program on the same machine end the process, or are refused.
    assert decision(machine, numbers["read"], architecture=0x40000003) == KILL
    assert decision(machine, numbers["read"] | 0x40000000) == REFUSE


def test_the_filter_says_for_which_machines_it_is_written():
    with pytest.raises(OSError, match="no system-call filter for riscv64"):
        system_calls.program(1, "riscv64")


# ---- messages about what is missing


def test_what_is_missing_is_said_with_its_remedy():
    layers = {layer: {"in force": True, "why not": ""} for layer in LAYERS}
    layers[SECCOMP] = {"in force": False, "why not": "the container forbids it"}
    assert isolation.lacking({"layers": layers, "not stopped": []}) == []
    [line] = isolation.lacking({"layers": layers, "not stopped": ["start a program"]})
    assert line.startswith(
        "student code could start a program. Missing: seccomp (the container forbids it): use Linux"
    )
    [line] = isolation.lacking(
        {"layers": layers, "not stopped": ["the layers of isolation do not work together: why"]}
    )
    assert line == "the layers of isolation do not work together: why"


# ---- scratch folders on disk


def test_a_hostile_folder_is_removed_and_nothing_else(tmp_path):
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "kept").write_text("kept")
    folder = tmp_path / "scratch"
    folder.mkdir()
    (folder / "link").symlink_to(outside)
    (folder / "loop").symlink_to(folder)
    (folder / "odd\n\x7f name").write_text("x")
    os.mkfifo(folder / "pipe")
    handle = os.open(folder, os.O_RDONLY)
    for _ in range(1100):  # Deeper than paths may be long, and than Python may recurse.
        os.mkdir("deep", dir_fd=handle)
        inner = os.open("deep", os.O_RDONLY, dir_fd=handle)
        os.close(handle)
        handle = inner
    os.close(handle)
    (folder / "closed" / "within").mkdir(parents=True)
    (folder / "closed" / "within" / "file").write_text("x")
    (folder / "closed" / "within").chmod(0)
    (folder / "closed").chmod(0)
    scratch.remove_folder(folder)
    assert sorted(os.listdir(tmp_path)) == ["outside"] and (outside / "kept").read_text() == "kept"


def test_the_room_that_files_take_is_measured(tmp_path):
    assert scratch.used_bytes(tmp_path, 10**9) == 0
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "file").write_bytes(b"x" * 100_000)
    (tmp_path / "link").symlink_to("/")
    assert 100_000 <= scratch.used_bytes(tmp_path, 10**9) < 200_000
    assert scratch.used_bytes(tmp_path, 1000) > 1000
    with contextlib.suppress(FileNotFoundError):
        assert scratch.used_bytes(tmp_path / "none", 1000) == 0


def test_what_root_alone_may_read_is_opened_and_not_given_to_root(tmp_path, monkeypatch):
    """Root must let others read its Python, since it owns it already."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sympy.__file__", "/nobody/may/read/this.py")
    (said,) = [line for line in WarmParent.cannot_work() if "cannot read" in line]
    assert "chmod -R o+rX" in said and "umask" in said and "user who owns them" not in said
