"""``orientation recording FILE``: the bench, for a terminal."""

import sys
from pathlib import Path

from .bench import examine
from .report import CONVENTIONS, as_csv, as_html
from .table import RecordingError


def add_recording(subcommands):
    """Add the subcommand ``recording``."""
    parser = subcommands.add_parser(
        "recording",
        help="what is in a recording of an instrument that turns, and whether a filter is honest on it",
    )
    parser.add_argument(
        "files",
        nargs="+",
        metavar="FILE",
        help="a table of numbers, a zip or a folder of them; several share one clock",
    )
    parser.add_argument("--rate", type=float, help="samples per second, where the file only counts them")
    parser.add_argument("--html", type=Path, metavar="REPORT", help="write the report with its plots as one page")
    parser.add_argument(
        "--csv", type=Path, metavar="CORRECTED", help="write the corrected recording with the filter's orientation"
    )
    parser.add_argument(
        "--convention", choices=CONVENTIONS, default=CONVENTIONS[0], help="of the orientation in the CSV"
    )
    parser.add_argument("--quick", action="store_true", help="leave the filter out")
    parser.set_defaults(run=run)


def run(asked):
    """Examine, print and write what was asked for."""
    shown = sys.stderr.isatty() and not asked.quick

    def progress(share):
        print(f"\rfilter {'#' * round(30 * share):30} {share:4.0%}", end="", file=sys.stderr, flush=True)

    try:
        source = asked.files if len(asked.files) > 1 else asked.files[0]
        found = examine(
            source,
            ", ".join(Path(one).name for one in asked.files),
            asked.rate,
            not asked.quick,
            progress if shown else None,
        )
    except RecordingError as error:
        print(f"orientation recording: {error}", file=sys.stderr)
        return 1
    if shown:
        print(f"\r{'':45}\r", end="", file=sys.stderr)
    print(found)
    if asked.html:
        asked.html.write_text(as_html(found), "utf8")
    if asked.csv:
        asked.csv.write_text(as_csv(found, asked.convention), "utf8")
    return 0
