"""Grading on a Dask cluster: a job goes out as bytes, and a result comes back as JSON.

Each thread of a worker has a sandbox of its own, like each worker process on one machine. Answers
are judged where the command was given, so right answers never leave that machine. If a worker is
lost, the others take over; a notebook's result does not depend on where it ran.
"""

import contextlib
import io
import json
import pickle
import threading
import uuid
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import CancelledError
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

from distributed import Client, Future, WorkerPlugin, as_completed, get_worker, protocol
from distributed import client as client_of_dask
from distributed.client import FutureCancelledError
from distributed.security import Security

from ...checking.fields import Fields, Json, Misread, anything, by_name, text
from ...checking.plain import NotPlain, read_plain
from ..record import Result, read_result
from ..versions import software
from .cluster_keys import CERTIFICATE, KEY
from .isolation import Limits
from .sandbox import Job, Sandbox, WeakIsolation, WorkerDied, given_up

CONNECT_WITHIN = "30s"


class Sandboxes(WorkerPlugin):
    """The sandboxes of one worker, which end with the grading."""

    def __init__(self, name: str, limits: Mapping[str, Json], allow_weak_isolation: bool) -> None:
        self.name = name
        self.limits = limits
        self.allow_weak_isolation = allow_weak_isolation

    def setup(self, worker: object) -> None:
        self.made: dict[int, Sandbox] = {}
        self.making = threading.Lock()

    def of_this_thread(self) -> Sandbox:
        thread = threading.get_ident()
        with self.making:
            if thread not in self.made:
                self.made[thread] = Sandbox(
                    Limits.from_json(self.limits), allow_weak_isolation=self.allow_weak_isolation
                )
            return self.made[thread]

    def teardown(self, worker: object) -> None:
        for sandbox in self.made.values():
            sandbox.close()


def run_job(job: bytes, name: str) -> bytes:
    """Run one job on a worker; whatever happens, return JSON."""
    about: Job = json.loads(job)
    outcome: dict[str, Json]
    try:
        sandboxes = get_worker().plugins[name]
        assert isinstance(sandboxes, Sandboxes)
        outcome = {"result": sandboxes.of_this_thread().run(about)}
    except WorkerDied as error:
        outcome = {"result": given_up(about, str(error))}
    except WeakIsolation as error:
        outcome = {"weak": str(error)}
    return json.dumps({**outcome, "software": software()}).encode()


class _PlainData(pickle.Unpickler):
    """An unpickler for strings, bytes, numbers, lists and the like, which cannot run code.

    Dask wraps some plain data in pickles.
    """

    def find_class(self, module: str, name: str) -> object:
        if module == "builtins" and name in (
            "bytes",
            "bytearray",
            "str",
            "int",
            "float",
            "list",
            "tuple",
            "dict",
        ):
            # Errors wrap their bytes in one of these types.
            return super().find_class(module, name)
        raise TypeError(
            "We refused a pickle, because whoever sent it could run code on this machine, which "
            "holds the right answers."
        )


def plain_data(data: bytes, *, buffers: Iterable[object] = ()) -> object:
    return _PlainData(io.BytesIO(data), buffers=buffers).load()


@contextlib.contextmanager
def no_pickles() -> Iterator[None]:
    """Prevent Dask's client in this process from running code by unpickling foreign data.

    Naming the serializers of the results is not enough, since the types of results, errors and
    warnings come as separate pickles.
    """
    replaced = (
        (protocol.pickle, "loads", plain_data),
        (client_of_dask, "loads", plain_data),
        (client_of_dask, "pickle", SimpleNamespace(loads=plain_data)),
    )
    with contextlib.ExitStack() as stack:
        for place, name, value in replaced:
            stack.enter_context(mock.patch.object(place, name, value))
        yield


def run_on_cluster(
    jobs: Iterable[Job],
    address: str,
    limits: Limits,
    *,
    keys: Path | None = None,
    allow_weak_isolation: bool = False,
) -> Iterator[Result]:
    """Run jobs on the cluster at an address, and yield the results as they come.

    ``keys`` is the folder of its keys.

    Raises
    ------
    ValueError
        The cluster cannot be reached or was lost, or its software differs from that on this
        machine, so that results might differ.
    WeakIsolation
        A worker cannot isolate student code.
    """
    name = f"coursework-{uuid.uuid4().hex}"
    ours = software()
    with contextlib.ExitStack() as stack:
        stack.enter_context(no_pickles())
        try:
            client = stack.enter_context(
                Client(
                    address,
                    security=_security(keys),
                    timeout=CONNECT_WITHIN,
                    set_as_default=False,
                    serializers=["msgpack", "pickle"],
                    deserializers=["msgpack"],
                )
            )
        except OSError as error:
            raise ValueError(f"We cannot reach a Dask scheduler at {address} ({error}).") from None
        try:
            client.register_plugin(
                Sandboxes(name, limits.as_json(), allow_weak_isolation), name=name
            )
        except OSError as error:
            raise ValueError(
                f"We lost the connection to the scheduler at {address} ({error}). Run the same "
                "command again to resume."
            ) from None
        stack.callback(_leave, client, name)
        sent: dict[str, tuple[Future[bytes], Job]] = {}
        for job in jobs:
            future = client.submit(
                run_job, json.dumps(job).encode(), name, key=f"{name} {job['id']}", pure=False
            )
            sent[future.key] = future, job
        for future in as_completed([future for future, _ in sent.values()], loop=client.loop):
            _, job = sent.pop(future.key)
            try:
                answer = json.loads(future.result())
            except Exception as error:
                # A worker's error comes as a pickle, which we do not unpickle. An error of these
                # types is from our own client's connection.
                if client.status != "running" or isinstance(
                    error, (FutureCancelledError, CancelledError, OSError)
                ):
                    raise ValueError(
                        f"We lost the connection to the scheduler at {address}. The finished "
                        "results are kept. Run the same command again to resume."
                    ) from None
                # We do not unpickle it, but the fact that worker after worker died is legible in
                # it.
                if not any(
                    b"KilledWorker" in part for part in error.args if isinstance(part, bytes)
                ):
                    raise ValueError(
                        f"A worker of the cluster at {address} sent something other than a "
                        "result. Does it have this version of the package?"
                    ) from None
                yield given_up(job, "several workers of the cluster were lost, one after another")
                continue
            yield _demand_sound(answer, job, ours)


def _security(keys: Path | None) -> Security | None:
    if keys is None:
        return None
    certificate = str(keys / CERTIFICATE)
    return Security(
        tls_ca_file=certificate,
        tls_client_cert=certificate,
        tls_client_key=str(keys / KEY),
        require_encryption=True,
    )


def _leave(client: Client, name: str) -> None:
    """End the sandboxes of the workers; without a scheduler, the workers have ended already."""
    if client.status == "running":
        # The connection may be lost at this very moment.
        with contextlib.suppress(OSError):
            client.unregister_worker_plugin(name)


def _demand_sound(answer: object, job: Job, ours: Mapping[str, str]) -> Result:
    """Check a worker's result like a notebook's, since what it ran may have captured it."""
    try:
        about = Fields(answer, "what a worker sent")
        if weak := about.maybe("weak", text):
            raise WeakIsolation(weak)
        theirs = about.get("software", by_name(text))
        if theirs != ours:
            raise ValueError(
                f"The versions on the cluster differ from those on this machine: {theirs} "
                f"there, {ours} here."
            )
        result = about.get("result", by_name(anything))
        _, answers = read_result(result, job["id"])
        if result.get("id") != job["id"] or set(answers) != set(job["questions"]):
            raise NotPlain
        for returned in answers.values():
            if returned.outcome == "recorded":
                read_plain(returned.plain)
    except (NotPlain, Misread):
        raise ValueError("The cluster sent damaged data.") from None
    return result
