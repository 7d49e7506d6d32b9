"""``python -m notebook_pages.carry_over PREVIOUS [SITE]``: keep old tabs working.

When its code first runs, an open page requests files that are named by their content. ``PREVIOUS``,
the address or the folder of the edition published last, lists them (``lasting.json``). Those that
``SITE``, about to be published there, lacks are copied into it. Files of the edition before that
are not kept: such a page asks its reader to reload it.
"""

import json
import sys
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Callable
from pathlib import Path, PurePosixPath

from .install import BY_CONTENT, LASTING
from .paths import HTML

PATIENCE = 60  # seconds


def reader(previous: str) -> Callable[[str], bytes | None]:
    """Return a function that reads a file of the last edition by its path.

    It returns the bytes, or ``None`` if there is no such file.
    """
    if "://" not in previous:
        return lambda path: (
            (Path(previous) / path).read_bytes() if (Path(previous) / path).is_file() else None
        )

    def read(path: str) -> bytes | None:
        address = urllib.parse.urljoin(previous.rstrip("/") + "/", urllib.parse.quote(path))
        try:
            with urllib.request.urlopen(address, timeout=PATIENCE) as answer:
                content: bytes = answer.read()
                return content
        except urllib.error.HTTPError as error:
            if error.code in (404, 410):
                return None
            raise
        except urllib.error.URLError as error:
            sys.exit(
                f"{previous} cannot be reached: {error.reason}. If nothing is published there yet, "
                "skip this command."
            )

    return read


def carry_over(previous: str, site: Path = HTML) -> list[str] | None:
    """Copy the files that the edition at ``previous`` names by their content into ``site``.

    Returns their paths, or ``None`` if nothing is published there or it has no list, as is the case
    before the first edition that has one.
    """
    read = reader(previous)
    listed = read(LASTING)
    if listed is None:
        return None
    carried = []
    names = json.loads(listed)
    for path in names if isinstance(names, list) else [names]:
        if (
            not isinstance(path, str)
            or not BY_CONTENT.fullmatch(path)
            or ".." in PurePosixPath(path).parts
        ):
            raise ValueError(
                f"{LASTING} of {previous} lists {path!r}, whose name is not a hash of its content"
            )
        place = site / path
        if not place.exists() and (content := read(path)) is not None:
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
            carried.append(path)
    return carried


def main() -> None:
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(
            "usage: python -m notebook_pages.carry_over PREVIOUS [SITE], with the address of the "
            "previous edition and the folder of the new one"
        )
    previous, site = sys.argv[1], Path(*sys.argv[2:]) if sys.argv[2:] else HTML
    carried = carry_over(previous, site)
    if carried is None:
        print(
            f"Nothing to carry over: the edition at {previous} has no list of lasting files "
            f"({LASTING})."
        )
    else:
        size = sum((site / path).stat().st_size for path in carried)
        print(
            f"Kept for readers who still have the previous edition open: {len(carried)} of its "
            f"files ({size / 1e6:.1f} MB)."
        )


if __name__ == "__main__":
    main()
