"""The command ``orientation recording FILE``."""

from __future__ import annotations

import json
import sys
from argparse import Namespace
from pathlib import Path

from .bench import examine
from .examined import as_data
from .report import as_csv, as_html

BAD_INPUT = 3


def run(chosen: Namespace) -> int:
    """Examine a recording, print the findings, and write the files that the options name."""
    shown = sys.stderr.isatty() and not chosen.quick

    def progress(share: float) -> None:
        print(
            f"\rfilter {'#' * round(30 * share):30} {share:4.0%}",
            end="",
            file=sys.stderr,
            flush=True,
        )

    try:
        # The filter takes a while, so check first that its results can be written.
        if bad := [
            str(file)
            for file in filter(None, (chosen.html, chosen.csv))
            if file.is_dir()
            or not file.parent.is_dir()
            or file.resolve() in (Path(name).resolve() for name in chosen.files)
        ]:
            raise ValueError(
                f"cannot write {bad[0]}: "
                + (
                    "name a file, and not the recording"
                    if Path(bad[0]).parent.is_dir()
                    else f"there is no folder {Path(bad[0]).parent}"
                )
            )
        if shown:
            print("reading", end="", file=sys.stderr, flush=True)
        source, name = (
            (sys.stdin.buffer.read(), "standard input")
            if chosen.files == ["-"]
            else (chosen.files, ", ".join(Path(file).name for file in chosen.files))
        )
        examined = examine(
            source, name, chosen.rate, chosen.columns, not chosen.quick, progress if shown else None
        )
        if shown:
            print(f"\r{'':45}\r", end="", file=sys.stderr)
        print(json.dumps(as_data(examined), indent=2, default=str) if chosen.json else examined)
        if chosen.html:
            chosen.html.write_text(as_html(examined), "utf8")
        if chosen.csv:
            chosen.csv.write_text(as_csv(examined, chosen.convention), "utf8")
    except (ValueError, OSError) as error:
        print(f"orientation: {error}", file=sys.stderr)
        return BAD_INPUT
    return 0
