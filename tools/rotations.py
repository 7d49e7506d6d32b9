"""``python -m tools.rotations``: store the scenes of the essay's stops, from the page's scripts."""

import json
import subprocess
from pathlib import Path

from notebook_pages.paths import NODE, esbuild
from orientation_figures import rotations

FILE = rotations.FOLDER / "scenes.json"


def written(*arguments):
    """Return the output of ``js/stills.js`` as text."""
    script = esbuild(
        "--bundle", "--platform=node", "--log-level=error", rotations.FOLDER / "js" / "stills.js"
    )
    return subprocess.run(
        [NODE, "-", *arguments], input=script, capture_output=True, text=True, check=True
    ).stdout


def main():
    Path(FILE).write_text(json.dumps(json.loads(written()), separators=(",", ":")) + "\n", "utf8")


if __name__ == "__main__":
    main()
