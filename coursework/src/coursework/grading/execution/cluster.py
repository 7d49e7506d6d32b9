"""The same grading on a Dask cluster: a job goes out as bytes, a result comes back as JSON.

Each worker has a sandbox of its own for each of its threads, as one machine has for each of its workers.
Verdicts are made where the command was given: right answers never leave that machine. A worker that is lost is
made up for by the others; what comes of a notebook does not depend on where it was run.
"""

import contextlib
import io
import json
import pickle
import threading
import uuid
from concurrent.futures import CancelledError
from types import SimpleNamespace

from distributed import Client, WorkerPlugin, as_completed, get_worker, protocol
from distributed import client as client_of_dask
from distributed.client import FutureCancelledError
from distributed.security import Security

from ...checking.plain import NotPlain, read_plain
from ..versions import software
from .cluster_keys import CERTIFICATE, KEY
from .sandbox import given_up

CONNECT_WITHIN = "30s"


class Sandboxes(WorkerPlugin):
    """The sandboxes of one worker; they end with the grading."""

    def __init__(self, name, limits, allow_weak_isolation):
        self.name = name
        self.limits = limits
        self.allow_weak_isolation = allow_weak_isolation

    def setup(self, worker):
        self.made = {}
        self.making = threading.Lock()

    def of_this_thread(self):
        from .sandbox import Limits, Sandbox

        thread = threading.get_ident()
        with self.making:
            if thread not in self.made:
                self.made[thread] = Sandbox(Limits(**self.limits), allow_weak_isolation=self.allow_weak_isolation)
            return self.made[thread]

    def teardown(self, worker):
        for sandbox in self.made.values():
            sandbox.close()


def run_job(job, name):
    """Run one job, on a worker; whatever happens, the answer is JSON."""
    from .sandbox import WeakIsolation, WorkerDied

    job = json.loads(job)
    try:
        found = {"result": get_worker().plugins[name].of_this_thread().run(job)}
    except WorkerDied as error:
        found = {"result": given_up(job, str(error))}
    except WeakIsolation as error:
        found = {"weak": str(error)}
    return json.dumps({**found, "software": software()}).encode()


class _PlainData(pickle.Unpickler):
    """Reads pickles of texts, bytes, numbers, lists and the like, which can do nothing; Dask wraps some in others."""

    def find_class(self, module, name):
        if module == "builtins" and name in ("bytes", "bytearray", "str", "int", "float", "list", "tuple", "dict"):
            return super().find_class(module, name)  # how the bytes of an error say what they are
        raise TypeError("A pickle was refused: whoever sends one could run code here, beside the right answers.")


def plain_data(data, *, buffers=()):
    return _PlainData(io.BytesIO(data), buffers=buffers).load()


@contextlib.contextmanager
def no_pickles():
    """Have this process, as a client of Dask, run nothing by unpickling what a worker or the scheduler sends.

    Naming the serializers of the results is not enough: the types of results, errors and warnings come as
    pickles of their own.
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


def run_on_cluster(jobs, address, limits, *, keys=None, allow_weak_isolation=False):
    """Run jobs on the cluster at an address; give the results as they come. ``keys`` is the folder of its keys.

    Raises
    ------
    ValueError
        The cluster cannot be reached or was lost, or its software is not the same as here, so that results might
        differ.
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
            raise ValueError(f"There is no Dask scheduler to be reached at {address} ({error}).") from None
        try:
            client.register_plugin(Sandboxes(name, vars(limits), allow_weak_isolation), name=name)
        except OSError as error:
            raise ValueError(f"The scheduler at {address} was lost ({error}). The same command goes on.") from None
        stack.callback(_leave, client, name)
        sent = {}
        for job in jobs:
            future = client.submit(run_job, json.dumps(job).encode(), name, key=f"{name} {job['id']}", pure=False)
            sent[future.key] = future, job
        for future in as_completed([future for future, _ in sent.values()], loop=client.loop):
            _, job = sent.pop(future.key)
            try:
                answer = json.loads(future.result())
            except Exception as error:
                # What a worker did comes as a pickle, which stays one: an error of the connection is our own client's.
                if client.status != "running" or isinstance(error, (FutureCancelledError, CancelledError, OSError)):
                    raise ValueError(
                        f"The scheduler at {address} was lost. What was graded is kept; the same command goes on."
                    ) from None
                # An error comes as a pickle, and stays one. That worker after worker died is no secret in it.
                if not any(b"KilledWorker" in part for part in error.args if isinstance(part, bytes)):
                    raise ValueError(
                        f"A worker of the cluster at {address} sent something else than a result. "
                        "Does it have this package, in this version?"
                    ) from None
                yield given_up(job, "worker after worker of the cluster was lost")
                continue
            _demand_sound(answer, job, ours)
            yield answer["result"]


def _security(keys):
    if keys is None:
        return None
    certificate = str(keys / CERTIFICATE)
    return Security(
        tls_ca_file=certificate,
        tls_client_cert=certificate,
        tls_client_key=str(keys / KEY),
        require_encryption=True,
    )


def _leave(client, name):
    """End the sandboxes of the workers. Where the scheduler is gone, its workers end with it: nobody is to be told."""
    if client.status == "running":
        with contextlib.suppress(OSError):  # it may be lost at this very moment
            client.unregister_worker_plugin(name)


def _demand_sound(answer, job, ours):
    """A worker may have been captured by what it ran: what it sends is looked at like what a notebook sends."""
    from .sandbox import WeakIsolation

    if "weak" in answer:
        raise WeakIsolation(str(answer["weak"]))
    if answer["software"] != ours:
        raise ValueError(f"The cluster has other versions than this machine: {answer['software']}, and here {ours}.")
    try:
        if answer["result"]["id"] != job["id"] or set(answer["result"]["answers"]) != set(job["questions"]):
            raise NotPlain
        for found in answer["result"]["answers"].values():
            if found["outcome"] == "recorded":
                read_plain(found["plain"])
    except (NotPlain, KeyError, TypeError):
        raise ValueError("The cluster sent damaged data.") from None
