"""The container that the instructors' page shows: what it allows is tried from
inside, with the very same options.

The image is not built here, which needs a registry: the files of this
machine are laid out in its place.
"""

import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from grading_class import handed_in, put, write_sources

from coursework.grading.execution.isolation import readable_paths
from coursework.grading.grade import grade
from coursework.grading.store import Store

ROOT = Path(__file__).resolve().parents[4]
MANUAL = (ROOT / "appendix" / "instructors.md").read_text("utf8")
PROBE = """
import json, os, socket
from coursework.grading.execution import isolation
from coursework.grading.execution.sandbox import Sandbox
found = {"user": os.geteuid()}
found["capabilities"] = open("/proc/self/status").read().split("CapEff:")[1].split()[0]
found["interfaces"] = [name for _, name in socket.if_nameindex()]
found["writable"] = [place for place in ("/", "/usr", "/etc") if os.access(place, os.W_OK)]
with Sandbox(allow_weak_isolation=True) as sandbox:
    found["lacking"] = isolation.lacking(sandbox.report)
    layers = sandbox.report["layers"].items()
    found["layers"] = [name for name, about in layers if about["in force"]]
print(json.dumps(found))
"""


def shown():
    """The options of ``podman run`` on the instructors' page,
    without the volumes and the command.
    """
    (command,) = re.findall(r"podman run (.*?) coursework grade", MANUAL, re.S)
    words = shlex.split(command.replace("\\\n", " "))
    volumes = [number for number, word in enumerate(words) if word == "--volume"]
    return [word for number, word in enumerate(words) if not {number, number - 1} & set(volumes)]


def podman(place, *command, input_text=None):
    """Run a command in a container with these options, and the files of
    this machine in place of an image's.
    """
    layout = place / "layout"
    for name in ("proc", "sys", "dev", "tmp", "etc", "run"):
        (layout / name).mkdir(parents=True, exist_ok=True)
    paths = {
        *readable_paths(),
        "/usr",
        "/bin",
        "/lib",
        "/lib64",
        str(ROOT),
        sys.prefix,
        sys.base_prefix,
    }
    volumes = [
        argument
        for path in sorted(path for path in paths if os.path.exists(path))
        if not any(path != folder and Path(path).is_relative_to(folder) for folder in paths)
        for argument in ("--volume", f"{path}:{path}:ro")
    ]
    volumes += ["--volume", f"{input_text}:/class"] if input_text else []
    own = [
        "--root",
        place / "root",
        "--runroot",
        place / "run",
        "--tmpdir",
        place / "state",
        "--storage-driver",
        "vfs",
    ]
    options = [option for option in shown() if option != "--userns=keep-id"] + [
        "--user",
        "65534:65534",
    ]
    # A container may not raise its own.
    limits = ["--ulimit", "nofile=4096:4096", "--ulimit", "nproc=4096:4096"]
    words = [
        "podman",
        *own,
        "--cgroup-manager",
        "cgroupfs",
        "run",
        "--cgroups=disabled",
        *limits,
        *options,
        *volumes,
    ]
    line = shlex.join(map(str, [*words, "--rootfs", layout, *command]))
    if os.path.ismount("/sys/fs/cgroup/unified"):
        # Two kinds of control groups at once are too much for it: one is hidden, from nobody else.
        line = f"mount --make-rprivate / && umount /sys/fs/cgroup/unified && exec {line}"
        return subprocess.run(
            ["unshare", "--mount", "bash", "-c", line], capture_output=True, text=True
        )
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    if shutil.which("podman") is None:
        pytest.skip("podman is not installed")
    place = tmp_path_factory.mktemp("container")
    started = podman(place, "/bin/echo", "started")
    if started.stdout != "started\n":
        pytest.skip(f"podman starts no container on this machine: {started.stderr[-300:]}")
    return place


def test_the_page_shows_a_container_without_a_network_that_nothing_can_be_written_in():
    options = shown()
    assert {
        "--network=none",
        "--read-only",
        "--cap-drop=all",
        "--security-opt=no-new-privileges",
    } <= set(options)
    recipe = (ROOT / "Containerfile").read_text("utf8")
    assert "USER 65534" in recipe and "coursework wheels" in recipe and "bubblewrap" in recipe
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf8"))["project"]
    copied = set(re.search(r"COPY (pyproject.toml .*) /book/", recipe)[1].split())
    assert {"pyproject.toml", "constraints.txt", *project["license-files"]} == copied
    folders = set(re.findall(r"COPY (\w+) /book/\1", recipe))
    assert folders == {"src", "packages"} and all(
        (ROOT / name).exists() for name in copied | folders
    )


#: What Docker's own filter of system calls denies to whoever has no privileges, of what keeping
#: apart could use: as in profiles/seccomp/default.json of moby/moby. Podman's allows it.
NAMESPACE_OF_USERS = 0x10000000
OF_DOCKER = {
    "defaultAction": "SCMP_ACT_ALLOW",
    "syscalls": [
        {
            "names": [
                "unshare",
                "setns",
                "mount",
                "umount",
                "umount2",
                "mount_setattr",
                "move_mount",
                "open_tree",
            ]
            + [
                "fsopen",
                "fsmount",
                "fsconfig",
                "fspick",
                "pivot_root",
                "chroot",
                "sethostname",
                "bpf",
            ],
            "action": "SCMP_ACT_ERRNO",
            "errnoRet": 1,
        },
        {"names": ["clone3"], "action": "SCMP_ACT_ERRNO", "errnoRet": 38},
        {
            "names": ["clone"],
            "action": "SCMP_ACT_ERRNO",
            "errnoRet": 1,
            "args": [
                {
                    "index": 0,
                    "value": NAMESPACE_OF_USERS,
                    "valueTwo": NAMESPACE_OF_USERS,
                    "op": "SCMP_CMP_MASKED_EQ",
                }
            ],
        },
    ],
}


@pytest.mark.long
@pytest.mark.parametrize("engine", ["podman", "docker"])
def test_isolation_holds_inside(place, engine, monkeypatch):
    if engine == "docker":
        (place / "docker.json").write_text(json.dumps(OF_DOCKER))
        options = [*shown(), f"--security-opt=seccomp={place / 'docker.json'}"]
        monkeypatch.setattr(sys.modules[__name__], "shown", lambda: options)
    done = podman(place, sys.executable, "-c", PROBE)
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["user"] == 65534 and set(report["capabilities"]) == {"0"}
    assert report["interfaces"] in ([], ["lo"]) and report["writable"] == []
    assert report["lacking"] == [], report
    assert ("namespaces" in report["layers"]) == (engine == "podman") and "landlock" in report[
        "layers"
    ]


@pytest.mark.long
def test_a_class_is_graded_inside(place):
    folder = place / "class"
    folder.mkdir()
    solutions = write_sources(folder / "solutions")
    put(folder / "submissions", "right", handed_in())
    put(folder / "submissions", "mistaken", handed_in(sum="sine = -sm.sin(alpha + beta)"))
    (folder / "graded").mkdir()
    for path in (folder, solutions, folder / "graded"):
        path.chmod(0o777)
    command = ["-m", "coursework", "grade", "/class/submissions", "--out", "/class/graded"]
    done = podman(
        place, sys.executable, *command, "--solutions", "/class/solutions", input_text=folder
    )
    assert done.returncode == 0, done.stderr
    assert "2 of 2 graded" in done.stderr and "WEAK" not in done.stderr
    store = Store(folder / "graded")
    assert [store.read(student, "turns")["points"] for student in ("right", "mistaken")] == [6, 5]
    # Whoever grades outside gets the same bytes: records, marks, report and every page of feedback.
    grade(folder / "submissions", place / "outside", solutions=solutions, show=io.StringIO())
    inside, outside = (
        {str(path.relative_to(out)): path.read_bytes() for path in out.rglob("*") if path.is_file()}
        for out in (folder / "graded", place / "outside")
    )
    for results in (inside, outside):
        del results["run.log"], results["lock"]
    assert {
        "report.html",
        "grades.csv",
        "feedback/right/turns.html",
        "records/right/turns.json",
    } <= set(inside)
    assert inside == outside
