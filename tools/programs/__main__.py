"""Run the newest version of each program on the convention card, and print each changed answer.

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
#: Two generic orientations, each as a unit vector and an angle in radians.
ORIENTATIONS = (((0.48, -0.6, 0.64), 1.1), ((-0.36, 0.48, 0.8), -2.0))
#: Programs that run in Node.js, with three.js from npm.
BY_NODE = ("three.js", "glTF", "BVH")
#: The tolerance, since some programs compute in single precision.
ROUNDING = 1e-5


def installed(program):
    """Return the command that asks one program, after installing it; None if that is impossible."""
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
    installs = [["numpy", *others], ["--no-deps", package]] if others else [["numpy", package]]
    if all(
        subprocess.run([*pip, *names], capture_output=True).returncode == 0 for names in installs
    ):
        return [python, HERE / "answers.py", program]
    return None


def jobs_of(program):
    """Return every line that the converter can write for a program.

    The orientations are ordinary ones, a half turn, and no rotation.
    """
    dcms = [*random_orientations(3, np.random.default_rng(7)), np.diag([1.0, -1, -1]), np.eye(3)]
    return [{"side": side, "dcm": dcm.tolist()} for side in sides(program) for dcm in dcms]


def wrong_lines(program, jobs, lines, made):
    """Return the lines with which the program does not make the intended orientation."""
    for job, line, matrix in zip(jobs, lines, made, strict=True):
        expected = np.array(job["dcm"])
        expected = expected.T if PROGRAMS[program]["matrix"] == "transposed" else expected
        if not np.allclose(np.reshape(matrix, (3, 3)), expected, atol=ROUNDING):
            yield (
                f"{line}: makes {np.round(matrix, 4).tolist()}, not "
                f"{np.round(expected, 4).ravel().tolist()}"
            )


def ask(program):
    """Return a program's present answers as plain data and the lines that it reads differently.

    If the answers are unknown, return the reason instead.
    """
    if (command := installed(program)) is None:
        return "cannot be installed here", []
    jobs = jobs_of(program)
    lines = [answer["line"] for answer in converted(jobs)]
    questions = json.dumps({"orientations": ORIENTATIONS, "lines": lines})
    done = subprocess.run(
        command, input=questions, capture_output=True, text=True, cwd=PLACE, timeout=600
    )
    if done.returncode:
        return f"did not answer: {done.stderr.strip()[-400:]}", []
    answers_now = json.loads(done.stdout.splitlines()[-1])
    wrong = list(wrong_lines(program, jobs, lines, answers_now.pop("made")))
    answers_now["lines"] = len(lines)
    for answer in answers_now["answers"]:
        answer["numbers"] = [
            [round(number, 6) + 0.0 for number in numbers] for numbers in answer["numbers"]
        ]
    return answers_now, wrong


def changes(stored, current):
    """Return the changed answers of a program, one line each."""
    then, now = (
        {answer["asked"]: answer["numbers"] for answer in each["answers"]}
        for each in (stored, current)
    )
    for line in sorted(then.keys() | now.keys()):
        if line not in now or line not in then:
            yield f"{line}: {'no longer asked' if line in then else 'asked for the first time'}"
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
        answers_now, wrong = ask(program)
        if isinstance(answers_now, str):
            print(f"{program}: {answers_now}", flush=True)
            continue
        before = stored.get(program, {"version": "nothing", "answers": []})
        changed = [*changes(before, answers_now), *wrong]
        failed |= bool(changed)
        version = answers_now["version"]
        came = "" if version == before["version"] else f" (stored: {before['version']})"
        verdict = "CHANGED" if changed else "answers as stored"
        print(
            f"{program} {version}{came}, {answers_now['lines']} lines run: {verdict}",
            *changed,
            sep="\n    ",
            flush=True,
        )
        stored[program] = answers_now
    if chosen.store:
        STORED.write_text(json.dumps(stored, indent=1, sort_keys=True) + "\n", "utf8")
    sys.exit(failed and not chosen.store)


if __name__ == "__main__":
    main()
