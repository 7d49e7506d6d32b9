"""The doors through which an answer reaches a check, each as a process of its
own: run with JSON on standard input.

``laptop`` has NumPy. ``page`` is Python on a page of the book, where ``plain_numpy.py`` stands in
for NumPy until a cell needs the real one; ``notebook interface`` is JupyterLite, where it does so
until a cell imports NumPy and it is fetched. What needs the real one says so, and is run again with
it, as a reader would. The fourth door is the grader's own: see ``test_doors.py``.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

DOORS = ("laptop", "page", "notebook interface")
#: Each public function of the book's module, applied to numbers as an exercise would.
RESULTS = """
angle_between(simple_dcm("z", 0.3), simple_dcm("z", 0.5))
angular_velocity_from_dcm_rate(simple_dcm("y", 0.1), dcm_rate(simple_dcm("y", 0.1), (0, 0, 2.0)))
angular_velocity_matrix((0.1, 0.2, 0.3), "zxy")
axis_angle_from_dcm(dcm_from_axis_angle((1, 2, 2), 1.2))
body_fixed_from_dcm(dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy"), "zxy")
dcm_from_axis_angle((1, 2, 2), 1.2)
dcm_from_directions([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
dcm_from_two_directions([[0.6, 0.8, 0], [0, 0, 1]], [[1, 0, 0], [0, 0, 1]])
dcm_from_body_fixed((0.1, 0.2, 0.3), "zxy")
dcm_from_modified_rodrigues((0.1, 0.2, -0.3))
dcm_from_quaternion((0.6, 0, 0, 0.8))
dcm_from_rodrigues((0.1, 0.2, -0.3))
dcm_from_rotation_vector((0.3, -0.4, 1.2))
dcm_from_space_fixed((0.1, 0.2, 0.3), "zxz")
dcm_rate(simple_dcm("y", 0.1), (0, 0, 2.0))
dcms_after_turns(simple_dcm("x", 0.1), [[0.1, 0, 0], [0, 0.2, 0]])
directions_covariance([[1, 0, 0], [0, 1, 0]], [0.1, 0.2])
gimbal_lock_margin((0.3, 1.4, 0.1), "zxy")
interpolate_quaternions((1, 0, 0, 0), (0.6, 0.8, 0, 0), 0.25)
mean_orientation([simple_dcm("x", 0.1), simple_dcm("x", 0.3)])
modified_rodrigues_from_dcm(simple_dcm("x", 0.2))
multiply_quaternions((0.6, 0, 0, 0.8), (0, 1, 0, 0))
nearest_dcm(simple_dcm("x", 0.2) * 1.001).dcm
quaternion_from_axis_angle((1, 2, 2), 1.2)
quaternion_from_dcm(simple_dcm("x", 3.1))
quaternion_rate((1, 0, 0, 0), (0, 0, 2.0))
random_orientations(2, 3)
rodrigues_from_dcm(simple_dcm("x", 0.2))
rotation_vector_from_dcm(dcm_from_rotation_vector((0.3, -0.4, 1.2)))
rotation_vector_rate((0.1, 0.2, 0.3), (0, 0, 2.0))
same_orientation(simple_dcm("z", 0.3), dcm_from_axis_angle((0, 0, 2), 0.3))
shadow_of_modified_rodrigues((0.1, 0.2, 0.3))
simple_dcm("z", 0.3)
simple_dcm("z", 0.3) @ simple_dcm("x", 0.2).T
[simple_dcm("z", 0.3)[0], simple_dcm("z", 0.3)[0, 1], simple_dcm("z", 0.3)[:2, 1]]
simple_dcm("z", 0.3) > 0.5
simple_dcm("z", 0.3)[0, 0] > 0.5
space_fixed_from_dcm(dcm_from_body_fixed((0.4, 0.7, -0.3), "zxy"), "zxy")
turns_from_angular_velocity(lambda times: [[0, 0, 0.1 * time] for time in times], [0, 0.5, 1])
""".strip().splitlines()
#: The program of all three: the cells of several notebooks, each in names of its
#: own; what each check has replied.
PROGRAM = r"""
import asyncio, json, os, sys

door, folder = sys.argv[1:3]
given = json.load(sys.stdin)
sys.stdout = open(os.devnull, "w")
told, needed = {}, []
import builtins
import coursework.checking.check as checking
from coursework.checking.plain import to_plain
judge = checking.judge
builtins.tell = lambda name, value: told.update({name: to_plain(value)})


def judge_and_tell(name, *asked):
    reply = judge(name, *asked)
    told[name] = [reply.outcome, reply.note]
    return reply


class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("numpy", "matplotlib", "scipy"):
            raise ModuleNotFoundError(f"No module named {name!r}", name="numpy")


def run_plainly(cells):
    names = {"__name__": "__main__"}
    for cell in cells:
        exec(compile(cell, "a cell", "exec"), names)


def run_in_a_notebook(cells):
    from IPython.core.interactiveshell import InteractiveShell

    absent = Absent()
    sys.meta_path.insert(0, absent)
    shell = InteractiveShell()
    shell.history_manager.enabled = False
    shell.run_line_magic("load_ext", "plain_numpy")
    for cell in cells:
        result = shell.run_cell(cell)
        if absent in sys.meta_path and getattr(result.error_in_exec, "name", None) == "numpy":
            needed.append(cell)
            sys.meta_path.remove(absent)
            result = shell.run_cell(cell)
        result.raise_error()
    if absent in sys.meta_path:
        sys.meta_path.remove(absent)


def run_in_the_page(cells):
    import session

    shell = session.start(lambda message: None)
    shell.lack({"numpy": "not loaded", "matplotlib": "not loaded", "scipy": "not loaded"})
    for number, cell in enumerate(cells):
        outcome = json.loads(asyncio.run(shell.run(cell, f"cell {number}")))
        if outcome["status"] == "missing":
            needed.append(cell)
            shell.lack({})
            outcome = json.loads(asyncio.run(shell.run(cell, f"cell {number}")))
        if outcome["status"] != "ok":
            raise RuntimeError(f"{cell}\n{outcome}")
    sys.meta_path.remove(shell.missing)


run = {
    "laptop": run_plainly,
    "page": run_in_the_page,
    "notebook interface": run_in_a_notebook,
}[door]
if door == "page":
    sys.path.insert(0, folder)
elif door == "notebook interface":
    sys.path.append(folder)  # behind the real IPython
elif door == "laptop":
    import numpy  # once, for all that are forked
checking.judge = judge_and_tell
answers = []
for cells in given:
    # Each in a process of its own: a module that has met the real NumPy remembers it.
    reading, writing = os.pipe()
    if not os.fork():
        try:
            run(cells)
            with open(writing, "w") as out:
                json.dump([told, needed], out)
        except BaseException:
            import traceback

            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(0)
    os.close(writing)
    with open(reading) as answer:
        answers.append(answer.read())
    os.wait()
json.dump([json.loads(answer) for answer in answers], sys.__stdout__)
"""


def through(door, notebooks):
    """For each of some notebooks, lists of cells: what each check has replied,
    and the cells that needed NumPy.
    """
    from notebook_pages.live.cells import write_python

    with tempfile.TemporaryDirectory() as folder:
        write_python(Path(folder, "python"))
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, door, "python"],
            cwd=folder, input=json.dumps(notebooks), capture_output=True, text=True,
        )  # fmt: skip
    try:
        return json.loads(done.stdout)
    except ValueError:
        raise AssertionError(f"{door}: {done.stderr}") from None
