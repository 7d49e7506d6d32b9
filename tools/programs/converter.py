"""The converter of the page, called from Python: all forms and sequences, and lines of code."""

import itertools
import json
import subprocess

from notebook_pages.paths import NODE
from orientation import SEQUENCES
from orientation_figures.moving import bundle
from orientation_figures.moving.converter import FOR_THE_PAGE
from orientation_workbench.programs import FORMS, OTHER, PROGRAMS

APPLY = """
const { readFileSync } = await import('node:fs');
const { programs, jobs } = JSON.parse(readFileSync(0));
const { settled, read, told, line, shown, byAxesOf } = (() => {
BODY
return { settled, read, told, line, shown, byAxesOf };
})();
const attempt = (work) => {
  try { return work(); } catch (error) { return { fault: error.message }; }
};
console.log(JSON.stringify(jobs.map(({ source, side, dcm, text }) => attempt(() => {
  const means = settled(side, programs);
  if (!dcm) return read(means, text);
  const exchanged = source ? byAxesOf(source, side, programs, dcm) : { dcm };
  const numbers = told(means, exchanged.dcm);
  return { text: shown(numbers), line: line(means, numbers, programs), said: exchanged.said };
}))));
"""


def converted(jobs):
    """Return the page's results for each side, with a matrix to write or a text to read.

    Parameters
    ----------
    jobs : list of dict
        ``side``, and ``dcm`` or ``text``. With ``source``, the side the matrix comes from, its axes
        are converted to the side's.
    """
    program = "".join(map(bundle.body, bundle.SHARED)) + APPLY.replace(
        "BODY", bundle.body("converter")
    )
    done = subprocess.run(
        [NODE, "--input-type=module", "-e", program],
        capture_output=True,
        text=True,
        input=json.dumps({"programs": FOR_THE_PAGE, "jobs": jobs}),
    )
    if done.returncode:
        raise RuntimeError(done.stderr[-2000:])
    return json.loads(done.stdout)


def sides(program):
    """Return every form and sequence of a program in the table.

    For another program, return every interpretation as well.
    """
    if program == OTHER:
        names = ("program", "form", "sequence", "matrix", "scalar", "unit")
        readings = itertools.product(
            FORMS,
            ("zxy", "xyx"),
            ("as here", "transposed"),
            ("first", "last"),
            ("radians", "degrees"),
        )
        return [dict(zip(names, (OTHER, *choices))) for choices in readings]
    every_side = []
    for form in PROGRAMS[program]["lines"]:
        allowed = (
            PROGRAMS[program].get("sequences", {}).get(form, SEQUENCES)
            if "angles" in form
            else ["zyx"]
        )
        every_side += [
            {"program": program, "form": form, "sequence": sequence} for sequence in allowed
        ]
    return every_side
