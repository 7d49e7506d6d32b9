"""The warm parent: a process that has loaded the libraries and forks one child for each notebook.

It is started by `exec` with an empty environment. It has no answer and no student's work. The
notebook goes to the child, and the records come back, through handles that this process passes on
without reading, so a child that searches its memory finds nothing of its neighbours.

It exchanges single messages in JSON with the process that started it:

    in   {"start": {...}}                      once: how to isolate, what to try
    out  {"ready": report}
    in   {"run": {...}}                        the limits; with three handles: the job, where
                                               records go, and the secret calls
    out  {"ended": {"signal": n} or {"code": n}, "scratch full": bool}
    in   {"kill": true}                        while a notebook runs
"""

import contextlib
import ctypes
import errno
import gc
import importlib
import json
import os
import select
import signal
import socket
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NoReturn, TypedDict

from coursework.checking.fields import Json
from coursework.checking.plugins import packages
from coursework.grading.execution import isolation, scratch
from coursework.grading.execution.isolation import (
    LAYERS,
    LIMITS,
    NAMESPACES,
    PRIVILEGES,
    IsolationError,
    Layer,
    Limits,
    Report,
    Target,
)

# The handles of a notebook's process, besides discarded input and output. It receives the secret
# calls from the last at its end.
JOB, RECORDS, SECRET = 3, 4, 5
NOT_CONFINED = 120
# Seconds between two checks of how full a scratch folder on disk is.
LOOK_EVERY = 0.05
LONGEST_MESSAGE = 1 << 16
LARGE_PAGE, MADV_COLLAPSE = 2 << 20, 25

#: How to isolate, and what to test.
Start = TypedDict(
    "Start",
    {
        "without": list[str],
        "target": Target,
        "limits": dict[str, Json],
        "base": str,
        "threads in use": int,
        "user": int,
        # Empty within namespaces.
        "why no namespaces": str,
    },
)


class Tried(TypedDict, total=False):
    """The result of testing the layers, one of these."""

    succeeded: list[str]
    failed: str


class Message(TypedDict, total=False):
    """A message from outside, one of these."""

    start: Start
    run: dict[str, Json]
    kill: bool


def load_libraries() -> None:
    """Import what notebooks import, once for all of them."""
    import numpy
    import sympy
    import sympy.physics.mechanics as mechanics

    from coursework.grading.execution import notebook

    for package in packages():
        with contextlib.suppress(ImportError):
            importlib.import_module(package)
    with contextlib.suppress(ImportError):
        import matplotlib.pyplot  # noqa: F401
    # Load what SymPy and the reader of answers import only on first use.
    angle = sympy.Symbol("angle")
    source, target = mechanics.ReferenceFrame("N"), mechanics.ReferenceFrame("A")
    target.orient_axis(source, source.z, angle)
    sympy.simplify(sympy.trigsimp(target.dcm(source) * target.dcm(source).T))
    third = sympy.Rational(1, 3)
    for inverse in (sympy.asin, sympy.acos, sympy.atan, sympy.acot, sympy.asec, sympy.acsc):
        # This builds a table of known values, which takes ten milliseconds.
        inverse(third)
    sympy.atan2(third, 1), sympy.cos(sympy.pi / 5)
    sympy.lambdify(angle, sympy.sin(angle), "numpy")(numpy.zeros(1))
    notebook.warm_up()


def about_itself(processes: int, name: str) -> str:
    """Read this process's own file in /proc by a handle, since the folder may be hidden."""
    with open(os.open(f"self/{name}", os.O_RDONLY, dir_fd=processes)) as file:
        return file.read()


def into_large_pages(maps: str) -> None:
    """Have the kernel move this process's memory to large pages, since forks copy their table.

    With small pages the table has 500 times as many entries, and forking and ending a child would
    take milliseconds longer. ``maps`` is the system's map of the memory. Where this fails,
    everything works as before.
    """
    madvise = ctypes.CDLL(None).madvise
    madvise.argtypes = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
    for line in maps.splitlines():
        place, rights, *rest = line.split()
        if rights.startswith("rw") and rest[3:] in ([], ["[heap]"]):
            start, end = (int(address, 16) for address in place.split("-"))
            for address in range(
                -(-start // LARGE_PAGE) * LARGE_PAGE, end - LARGE_PAGE + 1, LARGE_PAGE
            ):
                madvise(address, LARGE_PAGE, MADV_COLLAPSE)


class WarmParent:
    """The state for starting children, and how they are tested, watched and ended."""

    def __init__(
        self,
        control: socket.socket,
        processes: int,
        start: Start,
        readable: Sequence[str],
    ) -> None:
        self.control = control
        self.off = set(start["without"])
        self.target = start["target"]
        self.target["limits"] = Limits.from_json(start["limits"])
        self.readable = readable
        self.why_no_namespaces = start["why no namespaces"]
        # A process in namespaces does these, even before we know whether they stop enough.
        self.own_scratch = self.first_of_its_namespace = not self.why_no_namespaces
        self.base = isolation.SCRATCH if self.own_scratch else start["base"]
        # Namespaces of an ordinary user count only their own threads.
        self.threads_in_use = 0 if self.own_scratch else start["threads in use"]
        self.user = isolation.user_for_students(start["user"], about_itself(processes, "uid_map"))
        if not self.first_of_its_namespace:
            isolation.adopt_orphans()
        os.environ["MPLCONFIGDIR"] = self.base
        load_libraries()
        gc.collect()
        gc.freeze()
        into_large_pages(about_itself(processes, "maps"))
        self.memory_in_use = int(about_itself(processes, "statm").split()[0]) * os.sysconf(
            "SC_PAGE_SIZE"
        )
        os.close(processes)
        self.layers: list[str] = []
        self.count = 0

    # -- one child

    def new_scratch(self, layers: Collection[str]) -> str:
        """Make the next child's scratch folder: memory mounted over the base, or a folder in it."""
        if self.own_scratch and NAMESPACES in layers:
            return self.base
        self.count += 1
        folder = os.path.join(self.base, f"{self.count}")
        os.mkdir(folder, 0o700)
        # Only root may give the folder away. If root may not, the test of the isolation says so.
        with contextlib.suppress(PermissionError):
            os.chown(folder, self.user, self.user)
        return folder

    def remove_scratch(self, folder: str) -> None:
        # The memory went with its process.
        if folder != self.base:
            scratch.remove_folder(folder)

    def confine(self, layers: Collection[str], limits: Limits, folder: str) -> None:
        isolation.confine(
            layers,
            limits=limits,
            readable=self.readable,
            scratch=folder,
            own_scratch=self.own_scratch,
            user=self.user,
            memory_in_use=self.memory_in_use,
            threads_in_use=self.threads_in_use,
        )

    def end_all(self, child: int) -> int:
        """Kill and reap the child and everything that it may have left. Nothing else reaps."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        status = os.waitpid(child, 0)[1]
        while True:
            if self.first_of_its_namespace:
                with contextlib.suppress(ProcessLookupError):
                    # This kills all of the namespace at once.
                    os.kill(-1, signal.SIGKILL)
            else:
                for orphan in self.children():
                    with contextlib.suppress(ProcessLookupError):
                        os.kill(orphan, signal.SIGKILL)
            try:
                os.waitpid(-1, 0)
            except ChildProcessError:
                return status

    @staticmethod
    def children() -> list[int]:
        path = Path(f"/proc/self/task/{os.getpid()}/children")
        return [int(number) for number in path.read_text().split()] if path.exists() else []

    # -- testing the layers

    def tried(
        self, layers: Collection[str], attempts: Sequence[str] | None, target: Target
    ) -> list[str]:
        """Confine a child by `layers`, and return the names of the attempts that succeeded."""
        folder = self.new_scratch(layers)
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                os.close(reading)
                self.confine(layers, target["limits"], folder)
                succeeded = isolation.attempt_all(target, attempts)
                if attempts is None:
                    succeeded += self.cannot_work()
                answer: Tried = {"succeeded": succeeded}
            except Exception as error:
                answer = {"failed": str(error) or type(error).__name__}
            os.write(writing, json.dumps(answer).encode())
            os._exit(0)
        os.close(writing)
        said = b""
        while select.select([reading], [], [], 20)[0] and (part := os.read(reading, 4096)):
            said += part
        os.close(reading)
        self.end_all(child)
        self.remove_scratch(folder)
        answer = {"failed": "the process that tried it ended early"}
        if said:
            answer = json.loads(said)
        if "failed" in answer:
            raise IsolationError(errno.EPERM, answer["failed"])
        return answer["succeeded"]

    @staticmethod
    def cannot_work() -> list[str]:
        """Return what a notebook needs but lacks under all layers together."""
        import sympy

        problems = []
        try:
            for file in (os.__file__, sympy.__file__):
                Path(file).read_bytes()
        except OSError as error:
            problems.append(
                f"the isolated process cannot read Python's own libraries ({error}). Root "
                "runs it as another user, but only their owner may read them, perhaps "
                "because of a umask such as 077. Let everybody read them, with `chmod -R "
                "o+rX` on their folder, and install bubblewrap or use `chmod o+x` on the "
                "folders above it. Or grade as an ordinary user who has their own Python"
            )
        try:
            Path("trial").write_bytes(b"x" * 100)
        except OSError as error:
            problems.append(f"the isolated process cannot write in its scratch folder ({error})")
        return problems

    def report(self) -> Report:
        """Test every layer on its own, then all that are in force together."""
        self.target["threads in use"] = self.threads_in_use
        with self.file_within() as own:
            everywhere: Target = {**self.target, "files": [*self.target["files"], own]}
            layers: dict[str, Layer] = {}
            for layer in LAYERS:
                why_not = self.why_not(layer, self.target if layer == NAMESPACES else everywhere)
                layers[layer] = {"in force": why_not is None, "why not": why_not or ""}
                if why_not is None:
                    self.layers.append(layer)
            not_stopped = self.not_stopped(everywhere)
        return {
            "layers": layers,
            "not stopped": not_stopped,
            "landlock version": isolation.landlock_version(),
        }

    @contextlib.contextmanager
    def file_within(self) -> Iterator[str]:
        """Make a public file inside the namespaces, which hide the other one from all layers."""
        outside = os.path.join(self.base, f"inside namespaces, {self.user}")
        os.mkdir(outside, 0o777)
        own = os.path.join(outside, "file")
        Path(own).write_text("a file outside")
        os.chmod(own, 0o666)
        os.chmod(outside, 0o777)
        yield own
        scratch.remove_folder(outside)

    def not_stopped(self, target: Target) -> list[str]:
        """Return what the layers in force do not stop together."""
        try:
            return self.tried(self.layers, None, target)
        except IsolationError as error:
            return [f"the layers of isolation do not work together: {error}"]

    def why_not(self, layer: str, target: Target) -> str | None:
        if layer in self.off:
            return "switched off"
        if layer == NAMESPACES and self.why_no_namespaces:
            return self.why_no_namespaces
        # Limits do not bind root, so test them as the user they are for.
        alone = [LIMITS, PRIVILEGES] if layer == LIMITS else [layer]
        try:
            succeeded = self.tried(alone, isolation.must_stop(layer), target)
        except IsolationError as error:
            if layer == NAMESPACES and self.own_scratch:
                self.own_scratch = False
                return self.why_not(layer, target)
            return str(error.strerror)
        return f"it did not stop these attempts: {', '.join(succeeded)}" if succeeded else None

    # -- serving

    def serve(self) -> None:
        while True:
            message, handles = receive(self.control)
            if message is None:
                return
            if "run" not in message:
                # This is a late "kill", for a process that has ended.
                continue
            send(self.control, self.run(Limits.from_json(message["run"]), handles))

    def run(self, limits: Limits, handles: Sequence[int]) -> dict[str, object]:
        folder = self.new_scratch(self.layers)
        parent = os.getpid()
        child = os.fork()
        if child == 0:
            self.be_notebook(parent, limits, handles, folder)
        for handle in handles:
            os.close(handle)
        full = self.wait(child, None if folder == self.base else folder, limits.scratch_bytes)
        status = self.end_all(child)
        self.remove_scratch(folder)
        how = (
            {"signal": os.WTERMSIG(status)}
            if os.WIFSIGNALED(status)
            else {"code": os.WEXITSTATUS(status)}
        )
        return {"ended": how, "scratch full": full}

    def wait(self, child: int, folder: str | None, most_bytes: int) -> bool:
        """Wait until the child ends, has to end, or fills its folder on disk (returns True)."""
        handle = os.pidfd_open(child)
        watched = [handle, self.control.fileno()]
        try:
            while True:
                ready, _, _ = select.select(watched, [], [], LOOK_EVERY if folder else None)
                if ready:
                    # The child ended, a message came, or nobody is there; in any case it has to
                    # end.
                    return False
                if folder and scratch.used_bytes(folder, most_bytes) > most_bytes:
                    return True
        finally:
            os.close(handle)

    def be_notebook(
        self, parent: int, limits: Limits, handles: Sequence[int], folder: str
    ) -> NoReturn:
        """Give up, in the child, what a notebook must not have, and run it. Does not return."""
        code = NOT_CONFINED
        try:
            # Move the handles away from the low numbers first, so that none is overwritten.
            handles = [os.dup2(handle, 200 + order, False) for order, handle in enumerate(handles)]
            for handle, place in zip(handles, (JOB, RECORDS, SECRET), strict=True):
                os.dup2(handle, place, False)
            os.closerange(SECRET + 1, 1 << 20)
            self.confine(self.layers, limits, folder)
            # From here on, only records leave the process.
            os.dup2(1, 2)
            if os.getppid() != parent:
                raise ProcessLookupError("the parent process of the sandbox exited too early")
            os.environ.update(HOME=folder, TMPDIR=folder, MPLCONFIGDIR=folder)
            code = 1
            from coursework.grading.execution import notebook

            notebook.run(JOB, RECORDS, SECRET, limits, folder)
            code = 0
        except Exception as error:
            os.write(2, f"{type(error).__name__}: {error}\n".encode(errors="replace"))
        finally:
            os._exit(code)


def receive(control: socket.socket) -> tuple[Message | None, list[int]]:
    """Return the next message and its handles; (None, []) when the other side is gone."""
    data, handles, _, _ = socket.recv_fds(control, LONGEST_MESSAGE, 3)
    return (json.loads(data) if data else None), handles


def send(control: socket.socket, message: Mapping[str, object]) -> None:
    control.send(json.dumps(message).encode())


def main() -> None:
    control = socket.socket(fileno=int(sys.argv[1]))
    message, _ = receive(control)
    if message is None:
        # The process that started it has ended.
        return
    server = WarmParent(control, int(sys.argv[2]), message["start"], isolation.readable_paths())
    report = server.report()
    gc.collect()
    gc.freeze()
    # The process that started it may have ended.
    with contextlib.suppress(ConnectionError):
        send(control, {"ready": report})
        server.serve()
