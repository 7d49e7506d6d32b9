"""The keys of a cluster, and the commands that start one: who has no key is not listened to.

A scheduler of Dask runs whatever code it is sent. One that asks for no key runs anybody's who can
reach it, on all of its machines, so that there is no way here to start one like that.
"""

import os
import socket
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlsplit

CERTIFICATE, KEY = "cluster.pem", "cluster.key"
DAYS = 365
PORT = 8786
#: One certificate, signed by itself, that is trusted by whoever holds it and by nobody else.
REQUEST = [
    *(
        "openssl",
        "req",
        "-x509",
        "-newkey",
        "ec",
        "-pkeyopt",
        "ec_paramgen_curve:prime256v1",
        "-nodes",
    ),
    *(
        "-days",
        str(DAYS),
        "-subj",
        "/CN=coursework",
        "-addext",
        "basicConstraints=critical,CA:TRUE",
    ),
]
LOOPBACK = ("127.0.0.1", "::1", "localhost")


class NoKeys(ValueError):
    """Keys are missing or cannot be made; the message says what to do."""


def make_keys(folder: Path) -> bool:
    """Make the keys of a cluster in a folder that nobody else can read; whether there were none.

    Raises
    ------
    NoKeys
    """
    if (folder / CERTIFICATE).exists() and (folder / KEY).exists():
        return False
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    before = os.umask(0o077)
    try:
        done = subprocess.run(
            [*REQUEST, "-keyout", str(folder / KEY), "-out", str(folder / CERTIFICATE)],
            capture_output=True,
            text=True,
        )
    except FileNotFoundError:
        raise NoKeys(
            "To create keys for a cluster, install openssl: sudo apt install openssl."
        ) from None
    finally:
        os.umask(before)
    if done.returncode:
        raise NoKeys(f"openssl created no keys in {folder}: {done.stderr.strip()[-300:]}")
    return True


def options(folder: Path) -> list[str]:
    """What a scheduler or worker of Dask is told of its keys."""
    for name in (CERTIFICATE, KEY):
        if not (folder / name).exists():
            raise NoKeys(
                f"There is no {folder / name}. "
                "Copy the folder from the machine where the scheduler is."
            )
    certificate, key = str(folder / CERTIFICATE), str(folder / KEY)
    return ["--tls-ca-file", certificate, "--tls-cert", certificate, "--tls-key", key]


#: Even without a dashboard Dask shows what it does to whoever asks, so it listens to this machine.
ALONE = ["--no-dashboard", "--dashboard-address", "127.0.0.1:0"]


def scheduler(folder: Path, host: str, port: int = PORT) -> list[str]:
    """The command that starts a scheduler, which listens to those alone who have its key."""
    asked = [
        *options(folder),
        "--protocol",
        "tls",
        "--host",
        host,
        "--port",
        str(port),
        *ALONE,
    ]
    return [sys.executable, "-m", "dask", "scheduler", *asked]


def worker(folder: Path, address: str, workers: int) -> list[str]:
    """The command that starts the workers of a machine, each of one notebook at a time."""
    if not address.startswith("tls://"):
        raise NoKeys(
            f"The address of a scheduler with keys begins with tls://; {address!r} does not."
        )
    place = urlsplit(address)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as way:
        way.connect((place.hostname or "", place.port or PORT))  # sends nothing
        own = way.getsockname()[0]
    asked = [
        *options(folder),
        "--protocol",
        "tls",
        "--host",
        own,
        "--nworkers",
        str(workers),
        "--nthreads",
        "1",
        *ALONE,
    ]
    return [sys.executable, "-m", "dask", "worker", address, *asked]


def demand_keys(address: str, folder: Path | None) -> None:
    """Refuse a scheduler that listens to everybody, unless only this machine can reach it.

    Raises
    ------
    NoKeys
    """
    if address.startswith("tls://"):
        if folder is None:
            raise NoKeys("Give the folder of this cluster's keys: --keys FOLDER.")
        options(folder)
    elif urlsplit(address if "://" in address else f"tcp://{address}").hostname not in LOOPBACK:
        raise NoKeys(
            f"The scheduler at {address} does not require a key: anyone who can reach it can run "
            "code on all of its machines, and could send forged results. "
            "Start one with `coursework cluster --keys FOLDER`, and give its address as tls://..."
        )
