"""Run the newest version of each program on the convention card, and print each answer that
differs from the stored one.

Each program converts two rotations, and runs every line of code that the converter writes for it.
The programs are installed in ``_build/programs``, apart from the book, and each runs in a process
of its own.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import numpy as np

from notebook_pages.paths import NODE, REPOSITORY
from orientation import random_orientations
from orientation_workbench.programs import PROGRAMS

from . import answers
from .converter import converted, sides

HERE = Path(__file__).parent
PLACE = REPOSITORY / "_build" / "programs"
STORED = REPOSITORY / "packages" / "orientation-lab" / "tests" / "workbench" / "answers.json"
#: Two orientations without any special property, each by a unit vector and radians.
ORIENTATIONS = (((0.48, -0.6, 0.64), 1.1), ((-0.36, 0.48, 0.8), -2.0))
#: npm installs three.js, which reads this.
BY_NODE = ("three.js", "glTF", "BVH")
#: Some of them compute in single precision.
ROUNDING = 1e-5


def installed(program):
    """Command that asks one program, once what it takes is installed;
    None if that cannot be had here.
    """
    if program in BY_NODE:
        shutil.copy(HERE / "answers.mjs", PLACE)
        options = ["--silent", "--ignore-scripts", "--no-audit", "--no-fund", "--prefix", PLACE]
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        done = subprocess.run(
            ["npm", "install", *options, "three@latest"], env=os.environ | {"PATH": path}
        )
        return [NODE, PLACE / "answers.mjs", program] if done.returncode == 0 else None
    python = PLACE / "environment" / "bin" / "python"
    if not python.exists():
        venv.create(python.parents[1], with_pip=True)
    package, others, _ = answers.PROGRAMS[program]
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--upgrade"]
    wanted = [["numpy", *others], ["--no-deps", package]] if others else [["numpy", package]]
    if all(subprocess.run([*pip, *names], capture_output=True).returncode == 0 for names in wanted):
        return [python, HERE / "answers.py", program]
    return None


def jobs_of(program):
    """Every line that the converter can write for a program: orientations like any
    other, a half turn, and no turn.
    """
    dcms = [*random_orientations(3, np.random.default_rng(7)), np.diag([1.0, -1, -1]), np.eye(3)]
    return [{"side": side, "dcm": dcm.tolist()} for side in sides(program) for dcm in dcms]


def wrong_lines(program, jobs, lines, made):
    """The lines of which the program does not make the orientation that they were written for."""
    for job, line, matrix in zip(jobs, lines, made, strict=True):
        wanted = np.array(job["dcm"])
        wanted = wanted.T if PROGRAMS[program]["matrix"] == "transposed" else wanted
        if not np.allclose(np.reshape(matrix, (3, 3)), wanted, atol=ROUNDING):
            yield (
                f"{line}: makes {np.round(matrix, 4).tolist()}, not "
                f"{np.round(wanted, 4).ravel().tolist()}"
            )


def ask(program):
    """What a program answers now, as plain data, and the lines that it reads
    otherwise; or why nothing is known.
    """
    if (command := installed(program)) is None:
        return "cannot be installed here", []
    jobs = jobs_of(program)
    lines = [answer["line"] for answer in converted(jobs)]
    given = json.dumps({"orientations": ORIENTATIONS, "lines": lines})
    done = subprocess.run(
        command, input=given, capture_output=True, text=True, cwd=PLACE, timeout=600
    )
    if done.returncode:
        return f"did not answer: {done.stderr.strip()[-400:]}", []
    found = json.loads(done.stdout.splitlines()[-1])
    wrong = list(wrong_lines(program, jobs, lines, found.pop("made")))
    found["lines"] = len(lines)
    for answer in found["answers"]:
        answer["numbers"] = [
            [round(number, 6) + 0.0 for number in numbers] for numbers in answer["numbers"]
        ]
    return found, wrong


def changes(stored, found):
    """What a program answers otherwise than it did, a line each."""
    then, now = (
        {one["asked"]: one["numbers"] for one in each["answers"]} for each in (stored, found)
    )
    for line in sorted(then.keys() | now.keys()):
        if line not in now or line not in then:
            yield f"{line}: asked {'no more' if line in then else 'for the first time'}"
        elif not np.allclose(then[line], now[line], atol=ROUNDING):
            yield f"{line}: was {then[line]}, is {now[line]}"


def main():
    parser = argparse.ArgumentParser(prog="python -m tools.programs", description=__doc__)
    parser.add_argument(
        "programs", nargs="*", metavar="PROGRAM", help="programs to run (default: all)"
    )
    parser.add_argument("--store", action="store_true", help="store the new answers")
    chosen = parser.parse_args()
    PLACE.mkdir(parents=True, exist_ok=True)
    stored, failed = json.loads(STORED.read_text("utf8")) if STORED.exists() else {}, False
    for program in chosen.programs or (*answers.PROGRAMS, *BY_NODE):
        found, wrong = ask(program)
        if isinstance(found, str):
            print(f"{program}: {found}", flush=True)
            continue
        before = stored.get(program, {"version": "nothing", "answers": []})
        changed = [*changes(before, found), *wrong]
        failed |= bool(changed)
        version = found["version"]
        came = "" if version == before["version"] else f" (stored: {before['version']})"
        verdict = "CHANGED" if changed else "answers as stored"
        print(
            f"{program} {version}{came}, {found['lines']} lines run: {verdict}",
            *changed,
            sep="\n    ",
            flush=True,
        )
        stored[program] = found
    if chosen.store:
        STORED.write_text(json.dumps(stored, indent=1, sort_keys=True) + "\n", "utf8")
    sys.exit(failed and not chosen.store)


if __name__ == "__main__":
    main()
