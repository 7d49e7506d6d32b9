"""Kernels that are forked from a process which has loaded what nearly every notebook imports.

The build and nbval take their kernels from here. Each kernel is as clean as one that was started
separately, has its own process and its own names, and starts at once. Only third-party packages are
loaded beforehand; a notebook imports our own packages itself. ``python -m
notebook_pages.notebooks``, which starts kernels the usual way, shows that a notebook imports
everything that it uses.
"""

import contextlib
import gc
import importlib
import json
import os
import signal
import subprocess
import sys
import threading
import uuid

import psutil
from jupyter_client.manager import AsyncKernelManager, KernelManager
from jupyter_client.provisioning import LocalProvisioner

LOADED = (
    "ipykernel.kernelapp",
    "ipykernel.ipkernel",
    "sympy.physics.mechanics",
    "matplotlib.pyplot",
    "anywidget",
)
# Every kernel has these settings.
SETTINGS = {"MPLBACKEND": "module://matplotlib_inline.backend_inline"}


# ---- in the warm process


def main():
    """Fork a kernel for each line of the standard input, and answer with its process ID."""
    for name in LOADED:
        importlib.import_module(name)
    assert threading.active_count() == 1, "a process with threads must not fork"
    gc.collect()
    # Keep the loaded modules in memory that the forks share.
    gc.freeze()
    signal.signal(signal.SIGCHLD, reap)
    for line in sys.stdin:
        if (process := os.fork()) == 0:
            become_kernel(**json.loads(line))
        print(process, flush=True)


def reap(*signalled):
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass


def become_kernel(command, folder, environment):
    os.setsid()
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    for stream in (0, 1, 2):
        os.dup2(os.open(os.devnull, os.O_RDWR), stream)
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    sys.argv = command[command.index("-m") + 1 :]
    from ipykernel.kernelapp import IPKernelApp

    try:
        IPKernelApp.launch_instance()
    finally:
        os._exit(0)


# ---- in the process that runs notebooks


class WarmProcess:
    """The process that forks, started when the first notebook requests a kernel."""

    process = None

    def fork(self, **request):
        if self.process is None:
            self.process = subprocess.Popen(
                [sys.executable, __file__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
                env=os.environ | SETTINGS,
            )
        print(json.dumps(request), file=self.process.stdin, flush=True)
        return int(self.process.stdout.readline())

    def end(self):
        if self.process is not None:
            self.process.communicate()
            self.process = None


class Forked(psutil.Process):
    """A kernel, with the interface that Jupyter expects of the processes that it starts itself."""

    stdin = stdout = stderr = None

    def poll(self):
        return None if self.is_running() else 0


class WarmProvisioner(LocalProvisioner):
    async def launch_kernel(self, cmd, **settings):
        number = warm.fork(
            command=cmd, folder=settings["cwd"], environment=settings["env"] | SETTINGS
        )
        self.process, self.pid, self.pgid = Forked(number), number, number
        return self.connection_info


class FromWarmProcess:
    def start_kernel(self, **settings):
        # On other systems a process that has loaded NumPy cannot fork safely, so start a kernel.
        if sys.platform == "linux":
            self.kernel_id = str(uuid.uuid4())
            self.provisioner = WarmProvisioner(
                kernel_id=self.kernel_id, kernel_spec=self.kernel_spec, parent=self
            )
            # Two kernels that start at once could choose the same port, but not the same socket.
            self.transport = "ipc"
            self.ip = f"{os.environ.get('TMPDIR', '/tmp')}/kernel-{self.kernel_id}"
        return super().start_kernel(**settings)


class WarmKernelManager(FromWarmProcess, KernelManager):
    """A manager for nbval."""


class WarmAsyncKernelManager(FromWarmProcess, AsyncKernelManager):
    """A manager for nbclient."""


warm = WarmProcess()


if __name__ == "__main__":
    main()
