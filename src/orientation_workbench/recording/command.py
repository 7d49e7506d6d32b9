"""What ``orientation recording FILE`` does."""

import sys
from pathlib import Path

from .bench import examine
from .report import as_csv, as_html

BAD_INPUT = 3


def run(chosen):
    """Examine a recording, print what was found, and write what was asked for."""
    shown = sys.stderr.isatty() and not chosen.quick

    def progress(share):
        print(
            f"\rfilter {'#' * round(30 * share):30} {share:4.0%}",
            end="",
            file=sys.stderr,
            flush=True,
        )

    try:
        source = chosen.files if len(chosen.files) > 1 else chosen.files[0]
        if shown:
            print("reading", end="", file=sys.stderr, flush=True)
        name = ", ".join(Path(one).name for one in chosen.files)
        found = examine(source, name, chosen.rate, not chosen.quick, progress if shown else None)
        if shown:
            print(f"\r{'':45}\r", end="", file=sys.stderr)
        print(found)
        if chosen.html:
            chosen.html.write_text(as_html(found), "utf8")
        if chosen.csv:
            chosen.csv.write_text(as_csv(found, chosen.convention), "utf8")
    except (ValueError, OSError) as error:
        print(f"orientation: {error}", file=sys.stderr)
        return BAD_INPUT
    return 0
