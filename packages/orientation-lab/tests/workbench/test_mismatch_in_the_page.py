"""The search of the page and that of Python say the same of the same text."""

import itertools
import json
import random
import subprocess

import numpy as np
import pytest
from pasted import PASTED
from places import REPOSITORY
from test_mismatch import (
    BAD,
    QUATERNIONS,
    SPELLED,
    SPELLINGS,
    both_sides,
    known,
    printed,
    random_chain,
)

from notebook_pages.paths import NODE
from orientation import quaternion_from_dcm, random_orientations, simple_dcm
from orientation_figures.moving.workbench import EXAMPLES
from orientation_workbench import explain
from orientation_workbench.mismatch import mend, table
from orientation_workbench.mismatch.text import _decimal_points

SCRIPTS = (
    REPOSITORY / "packages" / "orientation-lab" / "src" / "orientation_figures" / "moving" / "js"
)
PROGRAM = """
import { readFileSync } from 'node:fs';
import { explain, formulaOf, mendingLine } from '%s/mismatch.js';
import { decimalPoints } from '%s/mathematics.js';
const { table, cases } = JSON.parse(readFileSync(0, 'utf8'));
const answerTo = ({ first, second, declared, noise, programs }) => {
  try {
    const found = explain(first, second, table, {
      firstDeclared: declared[0], secondDeclared: declared[1], noise,
      firstProgram: programs[0], secondProgram: programs[1] });
    return {
      verdict: found.verdict, faults: found.faults, left: found.chains.length,
      residual: found.residual,
      further: found.furtherPose, question: found.question ?? '',
      names: (found.names ?? []).map((each) => [each.condition, each.faults, each.declare]),
      mended: (found.verdict === 'named' || found.names?.length) && !found.chains[0].relation.inside
        ? [mendingLine, formulaOf].map((write) => write(found.chains[0])) : [] };
  } catch (error) { return { error: error.message }; }
};
console.log(JSON.stringify(cases.map((asked) => ({
  ...answerTo(asked), points: decimalPoints(asked.first) }))));
"""


def in_the_page(cases):
    given = json.dumps({"table": table.whole_table(), "cases": cases})
    done = subprocess.run(
        [NODE, "--input-type=module", "-e", PROGRAM.replace("%s", SCRIPTS.as_uri())],
        input=given,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


def in_python(case):
    try:
        explanation = explain(
            case["first"],
            case["second"],
            first_declared=case["declared"][0],
            second_declared=case["declared"][1],
            noise=case["noise"],
            # fmt: skip
            first_program=case["programs"][0],
            second_program=case["programs"][1],
        )
    except ValueError as error:
        return {"error": str(error), "points": _decimal_points(case["first"])}
    return {
        "points": _decimal_points(case["first"]),
        "verdict": explanation.verdict,
        "faults": list(explanation.faults),
        "left": len(explanation.chains),
        "residual": explanation.residual,
        "further": explanation.further_pose,
        "question": explanation.question,
        "names": [
            [name.condition, list(name.faults), list(name.declare)] for name in explanation.names
        ],
        "mended": [write(explanation.chains[0]) for write in (mend.python_line, mend.formula)]
        if explanation.has_line
        else [],
    }


def case(first, second, declared=({}, {}), noise=0.0, programs=("", "")):
    return {
        "first": first,
        "second": second,
        "declared": list(declared),
        "noise": noise,
        "programs": programs,
    }


def mixtures(count, seed):
    generator, orientations = random.Random(seed), np.random.default_rng(seed)
    for _ in range(count):
        declared = known(generator), known(generator)
        chain = random_chain(generator, declared, generator.randint(1, 3))
        yield case(*map(printed, both_sides(chain, random_orientations(2, orientations))), declared)


TABLES = (
    "qw,qx,qy,qz\n0.9205,0.3602,-0.0702,0.1343",
    "# x y z w\n[0.3602, -0.0702, 0.1343, 0.9205]",
    "t;p_x;p_y;p_z;q_z;q_y;q_x;q_w\n1.5;1;2;3;0.1343;-0.0702;0.3602;0.9205",
    "| w | x | y | z |\n|---|---|---|---|\n| 0.9205 | 0.3602 | -0.0702 | 0.1343 |",
    "time,roll_deg,pitch_deg,yaw_deg\n0.1,10.0,20.0,30.0",
    "r11 r12 r13 r21 r22 r23 r31 r32 r33\n1 0 0 0 1 0 0 0 1",
    "quaternion (x, y, z, w): 0.3602 -0.0702 0.1343 0.9205",
    "x y z\n0.1 0.2 0.3",
    "timestamp,a,q[0],q[1],q[2],q[3],delta_q_reset[0]\n7,7,0.9205,0.3602,-0.0702,0.1343,1",
    "1 0.9205 0.3602 -0.0702 0.1343 -0.7 1.0 3.7 1 P1.JPG\n2362.3 248.4 58396\n",
    "HIERARCHY\nMOTION\n1 2 3",
    "10\t20\t30\n#WERT!\t20\t30",
    '{"rotation": 0.0125, "transform_matrix": [[1, 0, 0, 4], [0, 0.6, -0.8, 5], [0, 0.8, 0.6, 6]]}',
    "w x y z\n0.1 0.2 0.3",
)


#: Commas between digits: those that become points, and those that separate.
COMMAS = {
    "0,9239 0 0 0,3827": "0.9239 0 0 0.3827",
    "0,9239; 0; 0; 0,3827": "0.9239; 0; 0; 0.3827",
    "0,9239\n0\n0\n0,3827": "0.9239\n0\n0\n0.3827",
    "angle 1 = 30,5\nangle 2 = 20,1": "angle 1 = 30.5\nangle 2 = 20.1",
    "3 3\n0,6 0,8 0\n-0,8 0,6 0\n0 0 1": "3 3\n0.6 0.8 0\n-0.8 0.6 0\n0 0 1",
    "1,2 3,4 5,6": "1.2 3.4 5.6",
} | {
    text: text
    for text in ("1,0,0,0", "1,0, 0,0", "[1,2 3,4]", "[1,0, 0\n 0,1, 0\n 0,0, 1]", "0,5 0 0",
                 "0.5,0.5,0.5,0.5", "0,0,1 1,57", "1.5 2,5 3,5")
}  # fmt: skip


def special():
    dcm, poses = (
        np.array(random_orientations(1, np.random.default_rng(2))[0]),
        random_orientations(4, np.random.default_rng(3)),
    )
    constants = random_orientations(2, np.random.default_rng(4))
    for spelling in SPELLINGS.values():
        yield case(spelling.format(*(f"{entry:.6f}" for entry in dcm.ravel())), printed([dcm.T], 6))
    for spelling in QUATERNIONS.values():
        parts = dict(zip("wxyz", (f"{entry:.6f}" for entry in quaternion_from_dcm(dcm))))
        yield case(spelling.format(**parts), printed([dcm], 6))
    for pasted in PASTED:
        yield case(pasted["first"], pasted["second"], pasted["known"])
    for first, second, *_ in EXAMPLES.values():
        yield case(first, second)
    for text in (*SPELLED.values(), *TABLES):
        yield case(text, printed([dcm], 6))
    for first, second in itertools.product(
        ("ROS tf2 (C++)", "Unity", "COLMAP", "nerfstudio"), ("PX4", "Unreal", "COLMAP")
    ):
        yield case(
            printed(quaternion_from_dcm(poses[:2])), printed(poses[:2]), programs=(first, second)
        )
    for text, _ in BAD.values():
        yield case(text, "1 0 0 0")
    yield case(printed([simple_dcm("z", 0.5)]), printed([simple_dcm("z", -0.5)]))
    yield case("1 0 0 0", "1 0 0 0")
    yield case(printed(poses[:3]), printed(constants[0] @ poses[:3]))
    yield case(printed(poses), printed(constants[0] @ poses @ constants[1]))
    yield case(printed(poses[:2]), printed(poses[2:]))
    yield case(
        printed(poses),
        printed(np.array(simple_dcm("x", 0.02)) @ np.swapaxes(poses, 1, 2)),
        noise=0.03,
    )
    yield case(printed([dcm]), printed([dcm @ np.diag([1, 1, -1])]))


def angles_that_fit_in_many_ways():
    """Each takes the search a second: for every night."""
    yield case("roll: 0.1\npitch: 0.2\nyaw: 0.3", "0.3 0.2 0.1", ({}, {"sequence": "zyx"}))
    yield case("0.3 0 0", "0.3 0 0", ({"sequence": "zyx"}, {"sequence": "zyx"}))


def test_both_say_the_same():
    cases = [
        *itertools.islice(special(), 0, None, 2),
        *itertools.islice(angles_that_fit_in_many_ways(), 0, None, 4),
        *mixtures(12, seed=8),
        *(case(text, "") for text in COMMAS),
    ]
    assert [*map(_decimal_points, COMMAS)] == [*COMMAS.values()]
    for asked, answer in zip(cases, in_the_page(cases)):
        wanted = in_python(asked)
        if "residual" in wanted and wanted["residual"] is not None:
            assert answer.pop("residual") == pytest.approx(
                wanted.pop("residual"), rel=1e-6, abs=1e-9
            ), asked
        assert answer == wanted, asked


BITS = [
    "\n",
    *" []()*{}\"',;:=-+#/%|&<>xwijk1\t\u00a0\u2212\u00b0",
    "0.5",
    "e-3",
    "nan",
    "deg",
    "rad",
    "3x3",
    "---",
    "1e9",
]


def broken(generator, text):
    """A text as it comes out of careless hands: something left out, put
    in or exchanged in a few places.
    """
    for _ in range(generator.randint(1, 6)):
        place, other = sorted(generator.randrange(len(text) + 1) for _ in range(2))
        put = generator.choice([generator.choice(BITS), "", text[other : other + 5]])
        text = text[:place] + put + text[place + generator.randint(0, 8) :]
    return text


def test_both_say_the_same_of_broken_text():
    """Whatever is pasted, there is an answer or a word on what was read,
    and both languages say the same.
    """
    generator = random.Random(21)
    texts = [
        *TABLES,
        *SPELLED.values(),
        *SPELLINGS.values(),
        *(pasted[side] for pasted in PASTED for side in ("first", "second")),
    ]
    cases = [
        case(broken(generator, generator.choice(texts)), "0.9205 0.3602 -0.0702 0.1343")
        for _ in range(80)
    ]
    for asked, answer in zip(cases, in_the_page(cases)):
        wanted = in_python(asked)
        if wanted.get("residual") is not None:
            assert answer.pop("residual") == pytest.approx(
                wanted.pop("residual"), rel=1e-6, abs=1e-9
            ), asked
        assert answer == wanted, asked


def test_every_example_of_the_page_shows_what_it_is_there_for():
    verdicts = []
    for first, second, *sides in EXAMPLES.values():
        known = [dict(side) for side in sides] or [{}, {}]
        programs = [side.pop("program", None) for side in known]
        verdicts.append(in_python(case(first, second, known, programs=programs))["verdict"])
    assert verdicts == ["named"] * 7 + ["undecided", "unrelated"]
