"""The same grading on a Dask cluster: a job goes out as bytes, a result comes back as JSON.

Each worker has a sandbox of its own for each of its threads, as one machine has for each of its workers.
Verdicts are made where the command was given: right answers never leave that machine. A worker that is lost is
made up for by the others; what comes of a notebook does not depend on where it was run.
"""

import contextlib
import json
import threading
import uuid

from distributed import Client, WorkerPlugin, as_completed, get_worker
from distributed.scheduler import KilledWorker

from ..checking.plain import NotPlain, read_plain

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
    """Run one job, on a worker."""
    from .grade import given_up, software
    from .sandbox import WorkerDied

    job = json.loads(job)
    try:
        result = get_worker().plugins[name].of_this_thread().run(job)
    except WorkerDied as error:
        result = given_up(job, str(error))
    return json.dumps({"result": result, "software": software()}).encode()


def run_on_cluster(jobs, address, limits, *, allow_weak_isolation=False):
    """Run jobs on the cluster at an address; give the results as they come.

    Raises
    ------
    ValueError
        The cluster cannot be reached, or its software is not the same as here, so that results might differ.
    """
    from .grade import given_up, software

    name = f"coursework-{uuid.uuid4().hex}"
    with contextlib.ExitStack() as stack:
        try:
            client = stack.enter_context(Client(address, timeout=CONNECT_WITHIN, set_as_default=False))
        except OSError as error:
            raise ValueError(f"There is no Dask scheduler to be reached at {address} ({error}).") from None
        client.register_plugin(Sandboxes(name, vars(limits), allow_weak_isolation), name=name)
        stack.callback(client.unregister_worker_plugin, name)
        sent = {}
        for job in jobs:
            future = client.submit(run_job, json.dumps(job).encode(), name, key=f"{name} {job['id']}", pure=False)
            sent[future.key] = future, job
        ours = software()
        for future in as_completed([future for future, _ in sent.values()], loop=client.loop):
            _, job = sent.pop(future.key)
            try:
                answer = json.loads(future.result())
            except KilledWorker as error:
                yield given_up(job, f"{type(error).__name__}: worker after worker was lost")
                continue
            if answer["software"] != ours:
                raise ValueError(
                    f"The cluster has other versions than this machine: {answer['software']}, and here {ours}."
                )
            for found in answer["result"]["answers"].values():
                if found["outcome"] == "recorded":
                    try:
                        read_plain(found["plain"])
                    except NotPlain:
                        raise ValueError("The cluster sent damaged data.") from None
            yield answer["result"]
