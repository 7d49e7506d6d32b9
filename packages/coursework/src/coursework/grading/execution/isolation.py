"""Isolation of students' code, in layers that are tested before we trust them.

Each layer stops something on its own; together they must stop every attempt of `ATTEMPTS`, which we
test at each start. Otherwise we run no student code.

namespaces
    The warm parent and its children see a root folder of their own with Python and its libraries,
    read only; a network with no way out; and no processes but their own, so that ending the first
    ends all. Each notebook has its own scratch folder in memory, of limited size. Made by
    bubblewrap, where it is installed and works. Does not limit memory or processor time, and leaves
    the whole system-call interface open. Missing on systems that forbid unprivileged user
    namespaces (as Ubuntu 24.04 does), inside most containers, and always without Linux.
landlock
    The kernel lets the process read only Python's own files and write only in its scratch folder.
    From Linux 6.2 on it can replace the root folder of its own; from 6.7 it refuses TCP, and from
    6.12 local sockets and signals. Does not cover UDP, hide whether a file exists, or stop changes
    of modes and owners, which the next layer does.
seccomp
    A list of system calls (see `coursework.grading.execution.system_calls`): no socket of any
    kind, no new process, no other program, no signal to others, no change of modes. Cannot tell one
    file from another.
resource limits
    Memory, processor time, size of a file, open files, threads, no core files. They apply to one
    process, so they limit a notebook only together with seccomp, which allows it only one.
no privileges
    No capabilities, no way to gain any, and, if grading is started by root, another user.

Sufficient are therefore seccomp, resource limits and no privileges, with namespaces or a recent
Landlock. Every start also empties the environment, closes files and discards output.

It knows nothing about notebooks or answers.
"""

import contextlib
import ctypes
import encodings.idna  # noqa: F401  an attempt needs it where its file can no longer be read
import errno
import mmap
import os
import resource
import signal
import socket
import stat
import struct
import sys
import sysconfig
import threading
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NotRequired, TypedDict

from coursework.checking.plugins import folders_of, packages
from coursework.grading.execution import system_calls
from coursework.grading.reading import AsJson

NAMESPACES, LANDLOCK, SECCOMP = "namespaces", "landlock", "seccomp"
LIMITS, PRIVILEGES = "resource limits", "no privileges"
LAYERS = (NAMESPACES, LANDLOCK, SECCOMP, LIMITS, PRIVILEGES)

HOW_TO_GET = {
    NAMESPACES: "install bubblewrap, and allow unprivileged user namespaces (sysctl "
    "kernel.apparmor_restrict_unprivileged_userns=0 on Ubuntu) or start as root",
    LANDLOCK: "use Linux 6.2 or newer with Landlock enabled (lsm=landlock,... on the kernel's "
    "command line)",
    SECCOMP: "use Linux on x86-64 or ARM64 with seccomp filters, outside any container that "
    "forbids them",
    LIMITS: "grade on a system that lets a program lower its limits on memory, time and files",
    PRIVILEGES: "grade as an ordinary user, or as root with the right to change users",
}


@dataclass(frozen=True)
class Limits(AsJson):
    """The limits of one notebook. Seconds are processor time unless they are wall time.

    Wall times are for code that waits. Time in which the code could have run but the machine was
    busy does not count, so that load costs nobody an answer.
    """

    cell_seconds: float = 20
    cell_wall_seconds: float = 40
    answer_seconds: float = 10
    answer_wall_seconds: float = 20
    notebook_seconds: float = 60
    # For all runs of the notebook together.
    notebook_wall_seconds: float = 180
    # Wall time after a limit, before the process is killed.
    grace_seconds: float = 1
    # In addition to the libraries.
    memory_bytes: int = 1 << 30
    file_bytes: int = 32 << 20
    scratch_bytes: int = 64 << 20
    open_files: int = 256
    threads: int = 64
    # Of one notebook, in each order.
    runs: int = 8


#: The targets of the attempts that test the isolation.
Target = TypedDict(
    "Target",
    {
        "tcp": int,
        "udp": int,
        "local": str,
        "files": NotRequired[list[str]],
        "limits": NotRequired[Limits],
        "threads in use": NotRequired[int],
    },
)
Layer = TypedDict("Layer", {"in force": bool, "why not": str})
#: The result of testing it.
Report = TypedDict(
    "Report",
    {
        "layers": dict[str, Layer],
        "not stopped": list[str],
        "landlock version": int,
    },
)


class IsolationError(OSError):
    """An error for a layer that could not be put in force; the message says which and why."""


_library = ctypes.CDLL(None, use_errno=True)
_library.mount.argtypes = (
    ctypes.c_char_p,
    ctypes.c_char_p,
    ctypes.c_char_p,
    ctypes.c_ulong,
    ctypes.c_char_p,
)


def _call(what: str, result: int) -> int:
    if result < 0:
        code = ctypes.get_errno()
        raise IsolationError(code, f"{what}: {os.strerror(code)}")
    return result


def _system_call(what: str, number: int, *arguments: int | bytes) -> int:
    longs = [ctypes.c_long(a) if isinstance(a, int) else a for a in arguments]
    return _call(what, _library.syscall(ctypes.c_long(number), *longs))


# ---- files that Python must be able to read

DEVICES = ("/dev/null", "/dev/zero", "/dev/urandom", "/dev/random")


def readable_paths() -> list[str]:
    """Return the files and folders that Python and the libraries are loaded from, and no others."""
    import site

    wanted = [sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")]
    wanted += site.getsitepackages()
    # Include shared libraries, first of this Python, then of the system.
    wanted += [
        sysconfig.get_config_var("LIBDIR"),
        "/lib",
        "/lib64",
        "/lib32",
        "/usr/lib",
        "/usr/lib64",
        "/usr/local/lib",
        "/etc/ld.so.cache",
        "/usr/share/zoneinfo",
    ]
    # Include the interpreter itself, for bubblewrap to start.
    wanted += [
        sys.executable,
        os.path.realpath(sys.executable),
        os.path.join(sys.prefix, "pyvenv.cfg"),
    ]
    # Include this package and the course's, even if installed from a working copy.
    wanted.append(str(Path(__file__).resolve().parents[2]))
    wanted += folders_of(packages())
    existing = sorted({os.path.abspath(path) for path in wanted if path and os.path.exists(path)})
    kept: list[str] = []
    for path in existing:
        if not any(path == outer or path.startswith(outer + "/") for outer in kept):
            kept.append(path)
    return kept


# ---- namespaces

CLONE_NEWNS, CLONE_NEWUSER = 0x00020000, 0x10000000
MS_NOSUID, MS_NODEV, MS_REC, MS_PRIVATE = 2, 4, 16384, 1 << 18
OUTSIDER = 65534
SCRATCH = "/scratch"


def bubblewrap_command(bubblewrap: str, readable: Iterable[str]) -> list[str]:
    """Return the command line in front of the warm parent that gives it namespaces."""
    command = [bubblewrap, "--as-pid-1", "--die-with-parent", "--cap-drop", "ALL"]
    for namespace in ("ipc", "pid", "net", "uts", "cgroup-try"):
        command.append(f"--unshare-{namespace}")
    if os.geteuid() != 0:
        command.append("--unshare-user")
    # The warm parent needs these to mount each notebook's scratch folder and, if it is root, to
    # change its user. The notebook's process gives all of them up.
    for capability in (
        "SYS_ADMIN",
        "SETPCAP",
        "SETUID",
        "SETGID",
        "KILL",
        "CHOWN",
        "DAC_OVERRIDE",
        "FOWNER",
    ):
        command += ["--cap-add", f"CAP_{capability}"]
    # Each path must exist where it is named, and where its links lead.
    places: dict[str, str] = {}
    for path in readable:
        for name in (path, os.path.realpath(path)):
            places.setdefault(name, path)
    # Bubblewrap would create the folders above them closed to the user that root runs the code as.
    on_the_way = (
        {str(parent) for name in places for parent in Path(name).parents} - {"/"} - set(places)
    )
    for folder in sorted(on_the_way):
        command += ["--perms", "0755", "--dir", folder]
    for name, path in places.items():
        command += ["--ro-bind", path, name]
    for device in DEVICES:
        command += ["--dev-bind", device, device]
    command += ["--tmpfs", SCRATCH, "--symlink", SCRATCH, "/dev/shm"]
    return [*command, "--remount-ro", "/", "--chdir", "/", "--"]


def mount_own_scratch(folder: str, size: int, user: int) -> None:
    """Give this process alone a scratch folder in memory, which vanishes with the process."""
    _call("unshare", _library.unshare(CLONE_NEWNS))
    _call("mount", _library.mount(None, b"/", None, MS_REC | MS_PRIVATE, None))
    options = f"size={size},nr_inodes={max(64, size // 4096)},mode=0700,uid={user},gid={user}"
    _call(
        "mount",
        _library.mount(b"tmpfs", folder.encode(), b"tmpfs", MS_NOSUID | MS_NODEV, options.encode()),
    )


# ---- Landlock

CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446
EXECUTE, WRITE_FILE, READ_FILE, READ_FOLDER = 1 << 0, 1 << 1, 1 << 2, 1 << 3
MAKE_CHARACTER_DEVICE, MAKE_BLOCK_DEVICE, MAKE_SOCKET, IOCTL_DEVICE = (
    1 << 6,
    1 << 11,
    1 << 9,
    1 << 15,
)


def landlock_version() -> int:
    """Return the version of Landlock's interface; 0 if there is none."""
    return max(
        0,
        int(
            _library.syscall(
                ctypes.c_long(CREATE_RULESET), None, ctypes.c_long(0), ctypes.c_long(1)
            )
        ),
    )


def restrict_files(readable: Iterable[str], scratch: str) -> None:
    """Let this process read `readable`, do anything in `scratch`, and reach no other file."""
    version = landlock_version()
    if version == 0:
        raise IsolationError(errno.ENOSYS, "the kernel has no Landlock")
    # Each right is a bit, in the order in which the versions added them.
    handled = (1 << 13 + (version >= 2) + (version >= 3) + (version >= 5)) - 1
    packed = struct.pack("=QQQ", handled, 3 if version >= 4 else 0, 3 if version >= 6 else 0)
    packed = packed[: 8 if version < 4 else 16 if version < 6 else 24]
    rules = _system_call("landlock", CREATE_RULESET, packed, len(packed), 0)

    def allow(path: str, access: int) -> None:
        try:
            handle = os.open(path, os.O_PATH | os.O_CLOEXEC)
        except OSError:
            # A missing file needs no permission.
            return
        if not stat.S_ISDIR(os.fstat(handle).st_mode):
            access &= EXECUTE | WRITE_FILE | READ_FILE | (1 << 14) | IOCTL_DEVICE
        _system_call(
            "landlock", ADD_RULE, rules, 1, struct.pack("=Qi", access & handled, handle), 0
        )
        os.close(handle)

    for path in readable:
        allow(path, READ_FILE | READ_FOLDER)
    for device in DEVICES:
        allow(device, READ_FILE | WRITE_FILE if device == "/dev/null" else READ_FILE)
    allow(
        scratch,
        handled
        & ~(EXECUTE | MAKE_CHARACTER_DEVICE | MAKE_BLOCK_DEVICE | MAKE_SOCKET | IOCTL_DEVICE),
    )
    _system_call("landlock", RESTRICT_SELF, rules, 0)
    os.close(rules)


# ---- limits and privileges


def limit_resources(limits: Limits, memory_in_use: int, threads_in_use: int) -> None:
    """Lower this process's limits for good.

    Memory and threads are beyond those in use at the start.
    """
    seconds = max(1, round(limits.notebook_seconds))
    for which, value in (
        (resource.RLIMIT_AS, memory_in_use + limits.memory_bytes),
        (resource.RLIMIT_FSIZE, limits.file_bytes),
        (resource.RLIMIT_NOFILE, limits.open_files),
        (resource.RLIMIT_NPROC, threads_in_use + limits.threads),
        # Not 0, for which a program that handles crashes would be started nevertheless; for 1 it is
        # not (core(5)).
        (resource.RLIMIT_CORE, 1),
        (resource.RLIMIT_MEMLOCK, 0),
        (resource.RLIMIT_MSGQUEUE, 0),
    ):
        _, most = resource.getrlimit(which)
        if most != resource.RLIM_INFINITY:
            value = min(value, most)
        resource.setrlimit(which, (value, value))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))


def drop_privileges(user: int) -> None:
    """Become `user` if this is root and can, and give up every capability for good."""
    if os.geteuid() == 0 and user != 0:
        os.setgroups([])
        os.setresgid(user, user, user)
        os.setresuid(user, user, user)
    _call("capset", _library.capset(struct.pack("=Ii", 0x20080522, 0), b"\0" * 24))
    forbid_new_privileges()
    # No other process of this user may look into this one, and a crash handler, perhaps run as
    # root, must not receive its memory. The limit of core files alone does not stop a handler.
    _call("dumpable", _library.prctl(4, 0, 0, 0, 0))


def forbid_new_privileges() -> None:
    """Prevent programs started here from gaining rights, which seccomp requires."""
    _call("no_new_privs", _library.prctl(38, 1, 0, 0, 0))


def user_for_students(preferred: int, uid_map: str) -> int:
    """Return the user that root runs student code as, a user of its own if the system has it.

    Raises
    ------
    RuntimeError
        Root is the only user here.
    """
    if os.geteuid() != 0:
        return os.geteuid()
    known = [tuple(map(int, line.split())) for line in uid_map.splitlines()]
    for user in (preferred, OUTSIDER):
        if any(first <= user < first + count for first, _, count in known):
            return user
    raise RuntimeError(
        "Root is the only user here, as in a container or namespace with one user, so we "
        "cannot run student code as another user. Grade as an ordinary user, or in a "
        "container that has more users (unshare --map-auto, podman --userns=auto)."
    )


def die_with_parent() -> None:
    """Have the kernel end this process when the one that forked it ends."""
    _call("prctl", _library.prctl(1, signal.SIGKILL, 0, 0, 0))


def adopt_orphans() -> None:
    """Adopt descendants that lose their parent, so that none escapes."""
    _call("prctl", _library.prctl(36, 1, 0, 0, 0))


def confine(
    layers: Collection[str],
    *,
    limits: Limits,
    readable: Iterable[str],
    scratch: str,
    own_scratch: bool,
    user: int,
    memory_in_use: int,
    threads_in_use: int,
) -> None:
    """Put `layers` in force on this process, for good; raise if one cannot be."""
    die_with_parent()
    if NAMESPACES in layers and own_scratch:
        mount_own_scratch(scratch, limits.scratch_bytes, user)
    os.chdir(scratch)
    if LIMITS in layers:
        limit_resources(limits, memory_in_use, threads_in_use)
    if PRIVILEGES in layers:
        drop_privileges(user)
        # A change of user cancels it.
        die_with_parent()
    else:
        forbid_new_privileges()
    if LANDLOCK in layers:
        restrict_files(readable, scratch)
    if SECCOMP in layers:
        system_calls.install()


# ---- testing


def _read(target: Target) -> bytes:
    for path in target["files"]:
        with contextlib.suppress(OSError):
            return Path(path).read_bytes()
    raise PermissionError("no file outside can be read")


def _write(target: Target) -> None:
    for path in target["files"]:
        for flags in (os.O_WRONLY, os.O_RDONLY | os.O_TRUNC):
            with contextlib.suppress(OSError):
                return os.close(os.open(path, flags))
        with contextlib.suppress(OSError):
            return os.close(os.open(path + ".new", os.O_WRONLY | os.O_CREAT))
    raise PermissionError("no file outside can be written")


def _change_mode(target: Target) -> None:
    for path in target["files"]:
        with contextlib.suppress(OSError):
            return os.chmod(path, 0o666)
    raise PermissionError("no mode outside can be changed")


def _socket(target: Target) -> None:
    socket.socket(socket.AF_UNIX, socket.SOCK_STREAM).close()


def _tcp(target: Target) -> None:
    socket.create_connection(("127.0.0.1", target["tcp"]), timeout=1).close()


def _udp(target: Target) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.connect(("127.0.0.1", target["udp"]))
        # The second call fails if nobody received the first message.
        for _ in range(2):
            udp.send(b"x")


def _local(target: Target) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as local:
        local.connect("\0" + target["local"])


def _signal(target: Target) -> None:
    # This sends nothing, but checks whether there is any process that could be ended.
    os.kill(-1, 0)


def _process(target: Target) -> None:
    if os.fork() == 0:
        os._exit(0)
    os.wait()


def _program(target: Target) -> None:
    try:
        os.execv("/no/such/program", ["program"])
    except FileNotFoundError:
        # The system looked for the program, so it would have started one that exists.
        return


def _namespace(target: Target) -> None:
    _call("unshare", _library.unshare(CLONE_NEWUSER))


def _trace(target: Target) -> None:
    _call("ptrace", _library.ptrace(0, 0, None, None))


def _privilege(target: Target) -> None:
    # Only a privileged process may give up a capability for good, which harms nobody else.
    _call("prctl", _library.prctl(24, 0, 0, 0, 0))


def _dump(target: Target) -> None:
    if _library.prctl(3, 0, 0, 0, 0) == 0:
        raise PermissionError("its memory is not dumped")


def _memory(target: Target) -> None:
    mmap.mmap(-1, target["limits"].memory_bytes + (1 << 20)).close()


def _file(target: Target) -> None:
    with open("long", "wb") as file:
        file.truncate(target["limits"].file_bytes + 1)


def _files(target: Target) -> None:
    opened = []
    try:
        for _ in range(target["limits"].open_files + 1):
            opened.append(os.dup(2))
    finally:
        for handle in opened:
            os.close(handle)


def _threads(target: Target) -> None:
    done = threading.Event()
    threading.stack_size(64 * 1024)
    started = []
    try:
        # Other processes of the same user may have ended since they were counted.
        for _ in range(target["threads in use"] + target["limits"].threads + 1):
            started.append(threading.Thread(target=done.wait))
            started[-1].start()
    except RuntimeError:
        started.pop()
        raise PermissionError("no more threads") from None
    finally:
        done.set()
        for thread in started:
            thread.join()


#: What student code must not be able to do: the test, and the layers that must each stop it on
#: their own. Tests that change the process itself come last.
ATTEMPTS = {
    "read a file outside": (_read, {NAMESPACES, LANDLOCK}),
    "write a file outside": (_write, {NAMESPACES, LANDLOCK}),
    "change the mode of a file outside": (_change_mode, {NAMESPACES, SECCOMP}),
    "open a socket": (_socket, {SECCOMP}),
    "connect by TCP": (_tcp, {NAMESPACES, SECCOMP}),
    "send by UDP": (_udp, {NAMESPACES, SECCOMP}),
    "connect to a local socket": (_local, {NAMESPACES, SECCOMP}),
    "signal another process": (_signal, {NAMESPACES, SECCOMP}),
    "start a process": (_process, {SECCOMP}),
    "start a program": (_program, {SECCOMP}),
    "use a privilege": (_privilege, {PRIVILEGES}),
    "have its memory dumped": (_dump, {PRIVILEGES}),
    "take more memory than allowed": (_memory, {LIMITS}),
    "write a longer file than allowed": (_file, {LIMITS}),
    "open more files than allowed": (_files, {LIMITS}),
    "start more threads than allowed": (_threads, {LIMITS}),
    "make new namespaces": (_namespace, {SECCOMP}),
    "trace a process": (_trace, {SECCOMP}),
}


def attempt_all(target: Target, names: Iterable[str] | None = None) -> list[str]:
    """Try, in this process, what student code must not do; return the names of what succeeded."""
    succeeded = []
    for name in names or ATTEMPTS:
        attempt, _ = ATTEMPTS[name]
        try:
            attempt(target)
        except (OSError, MemoryError):
            continue
        succeeded.append(name)
    return succeeded


def must_stop(layer: str) -> list[str]:
    """Return the attempts that `layer` must stop on its own to count as in force."""
    return [name for name, (_, layers) in ATTEMPTS.items() if layer in layers]


def lacking(report: Report) -> list[str]:
    """Return a line for each thing that the layers in force do not stop; empty if they suffice."""
    lines = []
    for name in report["not stopped"]:
        if name not in ATTEMPTS:
            lines.append(name)
            continue
        missing = [
            layer
            for layer in LAYERS
            if layer in ATTEMPTS[name][1] and not report["layers"][layer]["in force"]
        ]
        reasons = "; or ".join(
            f"{layer} ({report['layers'][layer]['why not']}): {HOW_TO_GET[layer]}"
            for layer in missing
        )
        lines.append(
            f"student code could {name}. "
            + (f"Missing: {reasons}" if missing else "No layer of isolation stopped it")
        )
    return lines
