"""The keys of a cluster, and the commands that start one that requires them.

A Dask scheduler runs whatever code it receives. One without keys would run, on all of its machines,
the code of anybody who can reach it, so there is no way here to start one like that.
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
#: A self-signed certificate, which only those who hold it trust.
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
    """An error for keys that are missing or cannot be made; the message says what to do."""


def make_keys(folder: Path) -> bool:
    """Make the keys of a cluster in a private folder, and return whether there were none.

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
    """Return the options for the keys of a Dask scheduler or worker."""
    for name in (CERTIFICATE, KEY):
        if not (folder / name).exists():
            raise NoKeys(
                f"There is no {folder / name}. "
                "Copy the folder from the machine where the scheduler is."
            )
    certificate, key = str(folder / CERTIFICATE), str(folder / KEY)
    return ["--tls-ca-file", certificate, "--tls-cert", certificate, "--tls-key", key]


#: Even without a dashboard, Dask shows its activity to anybody who asks, so it listens to this
#: machine only.
ALONE = ["--no-dashboard", "--dashboard-address", "127.0.0.1:0"]


def scheduler(folder: Path, host: str, port: int = PORT) -> list[str]:
    """Return the command that starts a scheduler, which accepts only those who have its keys."""
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
    """Return the command that starts a machine's workers, each for one notebook at a time."""
    if not address.startswith("tls://"):
        raise NoKeys(
            f"The address of a scheduler with keys begins with tls://; {address!r} does not."
        )
    place = urlsplit(address)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as way:
        # This sends nothing.
        way.connect((place.hostname or "", place.port or PORT))
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
    """Reject a scheduler that accepts anybody, unless only this machine can reach it.

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
