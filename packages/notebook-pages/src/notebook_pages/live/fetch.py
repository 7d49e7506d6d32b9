"""``make numpy``: fetch the official wheels of NumPy and Matplotlib, to publish them with the site.

Each is fetched once from Pyodide's server and compared with the hash in Pyodide's own list. If
BOOK_NUMPY (or ``numpy_in_the_page`` in ``_config.yml``) names their folder, the pages load nothing
from other servers.
"""

import sys
import urllib.request
from pathlib import Path

from . import runtime


def fetch(folder, packages, address):
    """Fetch the wheels of NumPy, Matplotlib and their dependencies into ``folder``.

    Returns the names of those that were fetched.
    """
    folder.mkdir(parents=True, exist_ok=True)
    fetched = []
    for name in runtime.with_dependencies(runtime.NUMERICAL, packages):
        wheel, print_ = folder / packages[name]["file_name"], packages[name]["sha256"]
        if wheel.is_file() and runtime.sha256(wheel.read_bytes()) == print_:
            continue
        with urllib.request.urlopen(address + wheel.name, timeout=60) as answer:
            content = answer.read()
        if runtime.sha256(content) != print_:
            raise RuntimeError(
                f"{address}{wheel.name} differs from the file in Pyodide's list, so we did not "
                "keep it"
            )
        wheel.write_bytes(content)
        fetched.append(wheel.name)
    return fetched


def main():
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "wheels")
    address = runtime.official_address()
    try:
        fetched = fetch(folder, runtime.official_lock()["packages"], address)
    except (OSError, RuntimeError) as error:
        sys.exit(f"Could not download all the wheels from {address}: {error}")
    size = sum(path.stat().st_size for path in folder.glob("*.whl")) / 1e6
    print(
        f"Wheels downloaded: {len(fetched)}; {folder} holds {size:.0f} MB, each file under its "
        "official name."
    )
    print(f"`BOOK_NUMPY={folder} make book` adds them to the site.")


if __name__ == "__main__":
    main()
