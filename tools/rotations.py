"""``python -m tools.rotations``: store the scenes of the essay's stops, from the page's scripts."""

import json
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from notebook_pages.paths import NODE, esbuild
from orientation_figures import rotations
from orientation_figures.moving import bundle

FILE = rotations.FOLDER / "scenes.json"


def written(*arguments):
    """Return the output of ``js/stills.js`` as text."""
    with TemporaryDirectory() as folder:
        page = bundle.with_all_modules("rotations", Path(folder))
        script = esbuild(
            "--bundle", "--platform=node", "--log-level=error", page.with_name("stills.js")
        )
    return subprocess.run(
        [NODE, "-", *arguments], input=script, capture_output=True, text=True, check=True
    ).stdout


def main():
    Path(FILE).write_text(json.dumps(json.loads(written()), separators=(",", ":")) + "\n", "utf8")


if __name__ == "__main__":
    main()
