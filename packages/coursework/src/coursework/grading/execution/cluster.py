"""The same grading on a Dask cluster: a job goes out as bytes, a result comes back as JSON.

Each worker has a sandbox of its own for each of its threads, as one machine has for each of its
workers. Verdicts are made where the command was given: right answers never leave that machine. A
worker that is lost is made up for by the others; what comes of a notebook does not depend on where
it was run.
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
from typing import Any

from distributed import Client, Future, WorkerPlugin, as_completed, get_worker, protocol
from distributed import client as client_of_dask
from distributed.client import FutureCancelledError
from distributed.security import Security

from ...checking.fields import Fields, Json, Misread, anything, by_name, text
from ...checking.plain import NotPlain, read_plain
from ..record import Result, read_result
from ..versions import software
from .cluster_keys import CERTIFICATE, KEY
from .sandbox import Job, Limits, Sandbox, WeakIsolation, WorkerDied, given_up

CONNECT_WITHIN = "30s"


class Sandboxes(WorkerPlugin):
    """The sandboxes of one worker; they end with the grading."""

    def __init__(self, name: str, limits: Mapping[str, Any], allow_weak_isolation: bool) -> None:
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
                    Limits(**self.limits), allow_weak_isolation=self.allow_weak_isolation
                )
            return self.made[thread]

    def teardown(self, worker: object) -> None:
        for sandbox in self.made.values():
            sandbox.close()


def run_job(job: bytes, name: str) -> bytes:
    """Run one job, on a worker; whatever happens, the answer is JSON."""
    about: Job = json.loads(job)
    found: dict[str, Json]
    try:
        sandboxes = get_worker().plugins[name]
        assert isinstance(sandboxes, Sandboxes)
        found = {"result": sandboxes.of_this_thread().run(about)}
    except WorkerDied as error:
        found = {"result": given_up(about, str(error))}
    except WeakIsolation as error:
        found = {"weak": str(error)}
    return json.dumps({**found, "software": software()}).encode()


class _PlainData(pickle.Unpickler):
    """Reads pickles of texts, bytes, numbers, lists and the like, which can do
    nothing; Dask wraps some in others.
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
            return super().find_class(module, name)  # how the bytes of an error say what they are
        raise TypeError(
            "We refused a pickle, because whoever sent it could run code on this machine, which "
            "holds the right answers."
        )


def plain_data(data: bytes, *, buffers: Iterable[object] = ()) -> object:
    return _PlainData(io.BytesIO(data), buffers=buffers).load()


@contextlib.contextmanager
def no_pickles() -> Iterator[None]:
    """Have this process, as a client of Dask, run nothing by unpickling what
    a worker or the scheduler sends.

    Naming the serializers of the results is not enough: the types of results, errors and warnings
    come as pickles of their own.
    """
    replaced = (
        (protocol.pickle, "loads", plain_data),
        (client_of_dask, "loads", plain_data),
        (client_of_dask, "pickle", SimpleNamespace(loads=plain_data)),
    )
    before = [getattr(place, name) for place, name, _ in replaced]
    for place, name, value in replaced:
        setattr(place, name, value)
    try:
        yield
    finally:
        for (place, name, _), value in zip(replaced, before, strict=True):
            setattr(place, name, value)


def run_on_cluster(
    jobs: Iterable[Job],
    address: str,
    limits: Limits,
    *,
    keys: Path | None = None,
    allow_weak_isolation: bool = False,
) -> Iterator[Result]:
    """Run jobs on the cluster at an address; give the results as they come.
    ``keys`` is the folder of its keys.

    Raises
    ------
    ValueError
        The cluster cannot be reached or was lost, or its software is not the same as here, so that
        results might differ.
    WeakIsolation
        A worker cannot keep student code apart.
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
            client.register_plugin(Sandboxes(name, vars(limits), allow_weak_isolation), name=name)
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
                # What a worker did comes as a pickle, which stays one: an error of the
                # connection is our own client's.
                if client.status != "running" or isinstance(
                    error, (FutureCancelledError, CancelledError, OSError)
                ):
                    raise ValueError(
                        f"We lost the connection to the scheduler at {address}. The finished "
                        "results are kept. Run the same command again to resume."
                    ) from None
                # An error comes as a pickle, and stays one. That worker after
                # worker died is no secret in it.
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
    """End the sandboxes of the workers. Where the scheduler is gone, its workers
    end with it: nobody is to be told.
    """
    if client.status == "running":
        with contextlib.suppress(OSError):  # it may be lost at this very moment
            client.unregister_worker_plugin(name)


def _demand_sound(answer: object, job: Job, ours: Mapping[str, str]) -> Result:
    """A worker may have been captured by what it ran: what it sends is
    looked at like what a notebook sends.
    """
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
        for one in answers.values():
            if one.outcome == "recorded":
                read_plain(one.plain)
    except (NotPlain, Misread):
        raise ValueError("The cluster sent damaged data.") from None
    return result
