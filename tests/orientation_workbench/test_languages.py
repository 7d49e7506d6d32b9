"""Formulas that are taken away: compiled and run, they give what the module gives, in any convention."""

import itertools
import json
import re
import shutil
import subprocess

import numpy as np
import pytest

import orientation
from notebook_pages.paths import NODE
from orientation import SEQUENCES, random_orientations
from orientation_workbench.languages import FORMULAS, LANGUAGES, NEED_A_SEQUENCE, SIZES, formula_in

CONVENTIONS = [{}, {"matrix": "transposed", "scalar": "last", "unit": "degrees"}]


def jobs():
    """Every formula, those of angles with one sequence of each family, in both conventions."""
    for name, convention in itertools.product(FORMULAS, CONVENTIONS):
        for sequence in ("zxy", "zxz") if name in NEED_A_SEQUENCE else (None,):
            yield name, sequence, convention


JOBS = list(jobs())


def given(name, seed):
    """Arguments in this book's convention: an orientation, its inverse, one at gimbal lock, one of half a turn."""
    special = [np.eye(3), np.diag([1.0, -1.0, -1.0]), np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])]
    dcms = [*random_orientations(6, np.random.default_rng(seed)), *special]
    if name in ("dcm_from_quaternion", "multiply_quaternions", "quaternion_rate"):
        quaternions = [np.array(orientation.quaternion_from_dcm(dcm)) for dcm in dcms]
        second = {
            "dcm_from_quaternion": [],
            "multiply_quaternions": [quaternions[1]],
            "quaternion_rate": [[0.1, -0.4, 2]],
        }
        return [[one, *map(np.array, second[name])] for one in quaternions]
    if "from_dcm" in name:
        return [[dcm] for dcm in dcms]
    return [[np.array(vector)] for vector in ([0.4, -0.7, 1.1], [2.9, 1.2, -3.0], [0.0, 0.0, 0.0])]


def converted(kind, values, convention):
    values = np.asarray(values, float)
    if kind == "matrix":
        values = values.reshape(3, 3).T if convention.get("matrix") else values
    if kind == "quaternion" and convention.get("scalar"):
        values = np.roll(values, -1)
    if kind == "angles" and convention.get("unit"):
        values = np.degrees(values)
    return values.ravel().tolist()


def expected(name, sequence, convention, arguments):
    function = getattr(orientation, name)
    result = function(*[one.tolist() for one in arguments], *([sequence] if sequence else []))
    return converted(FORMULAS[name][1], np.array(result, float), convention)


def cases():
    found = []
    for which, (name, sequence, convention) in enumerate(JOBS):
        kinds = list(FORMULAS[name][0].values())
        for arguments in given(name, which):
            numbers = [converted(kind, one, convention) for kind, one in zip(kinds, arguments)]
            found.append((which, numbers, expected(name, sequence, convention, arguments)))
    return found


def close(found, wanted, name, sequence, convention):
    """Equal, and what has several numbers for one orientation by that orientation."""
    found, wanted = np.array(found), np.array(wanted)
    if name in ("body_fixed_from_dcm", "space_fixed_from_dcm"):
        make = getattr(orientation, "dcm_from_" + name.removesuffix("_from_dcm"))
        found, wanted = (make(np.radians(one) if convention.get("unit") else one, sequence) for one in (found, wanted))
    if name in ("quaternion_from_dcm", "rotation_vector_from_dcm") and found @ wanted < 0:
        found = -found
    return np.abs(found - wanted).max() <= 1e-11 * max(1, np.abs(wanted).max())


def texts(language):
    for name, sequence, convention in JOBS:
        own = "_".join(filter(None, [name, sequence]))
        yield own, formula_in(language, name, sequence, **convention)


def hold(outputs):
    for (which, numbers, wanted), found in zip(cases(), outputs, strict=True):
        name, sequence, convention = JOBS[which]
        assert close(found, wanted, name, sequence, convention), (name, sequence, convention, numbers, found, wanted)


def test_javascript_gives_the_same():
    functions = ",\n".join(f"(() => {{ {text}\nreturn {own}; }})()" for own, text in texts("JavaScript"))
    calls = json.dumps([[which, numbers] for which, numbers, _ in cases()])
    program = f"const all = [{functions}];\nconsole.log(JSON.stringify({calls}.map(([k, a]) => all[k](...a))));"
    done = subprocess.run([NODE, "-e", program], capture_output=True, text=True, check=True)
    hold(json.loads(done.stdout))


def run_compiled(tmp_path, source, command):
    (tmp_path / "source").write_text(source)
    subprocess.run([*command, "-o", tmp_path / "program"], cwd=tmp_path, check=True, capture_output=True)
    done = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True)
    hold([[float(number) for number in line.split()] for line in done.stdout.splitlines()])


@pytest.mark.skipif(not shutil.which("cc"), reason="there is no C compiler here")
def test_c_gives_the_same(tmp_path):
    functions, calls = [], []
    for which, (own, text) in enumerate(texts("C")):
        functions.append(text.replace(own, f"f{which}").replace("#include <math.h>", ""))
    for which, numbers, wanted in cases():
        passed = ", ".join("(double[]){" + ", ".join(f"{number:.17g}" for number in one) + "}" for one in numbers)
        calls.append(f"f{which}({passed}, r); show(r, {len(wanted)});")
    source = (
        "#include <math.h>\n#include <stdio.h>\n" + "\n".join(functions)
        + '\nstatic void show(double *r, int n) { for (int k = 0; k < n; k++) printf("%.17g ", r[k]); puts(""); }\n'
        + "int main(void) { double r[9];\n" + "\n".join(calls) + "\nreturn 0; }\n"
    )  # fmt: skip
    run_compiled(tmp_path, source, ["cc", "-x", "c", "source", "-lm"])


@pytest.mark.skipif(not shutil.which("rustc"), reason="there is no Rust compiler here")
def test_rust_gives_the_same(tmp_path):
    functions, calls = [], []
    for which, (own, text) in enumerate(texts("Rust")):
        functions.append(text.replace(own, f"f{which}"))
    for which, numbers, _ in cases():
        passed = ", ".join("&[" + ", ".join(f"{number:.17e}" for number in one) + "]" for one in numbers)
        calls.append(f"show(&f{which}({passed}));")
    show = 'fn show(r: &[f64]) { for x in r { print!("{:e} ", x); } println!(); }'
    source = "\n".join([*functions, show, "fn main() {", *calls, "}"])
    run_compiled(tmp_path, source, ["rustc", "--crate-type", "bin", "source"])


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_writes_every_formula(language):
    for own, text in texts(language):
        assert own in text and "Not supported" not in text and "warning" not in text.lower(), text
        if language == "GLSL":
            assert not re.search(r"[-+*/(=] ?\d+(?![\d.\]e])", re.sub(r"\[\d+\]", "", text)), text


def test_derivatives_are_those_of_the_function():
    name, sequence, at = "dcm_from_body_fixed", "zyx", np.array([0.3, -0.8, 1.4])
    text = formula_in("JavaScript", name, sequence, derivative=True)
    program = f"{text}\nconsole.log(JSON.stringify({name}_{sequence}_derivative({at.tolist()})));"
    found = json.loads(subprocess.run([NODE, "-e", program], capture_output=True, text=True, check=True).stdout)
    make = orientation.dcm_from_body_fixed
    wanted = [(make(at + step, sequence) - make(at - step, sequence)).ravel() / 2e-6 for step in 1e-6 * np.eye(3)]
    assert np.abs(np.array(found).reshape(9, 3) - np.transpose(wanted)).max() < 1e-8


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_all_sequences_are_written(sequence):
    assert formula_in("C++", "body_fixed_from_dcm", sequence).count("result[") == SIZES["angles"]


@pytest.mark.parametrize(
    "call, words",
    [(("Cobol", "dcm_from_quaternion"), "languages"), (("C", "dcm_from_nothing"), "no formula"),
     (("C", "dcm_from_body_fixed"), "needs a sequence"), (("C", "dcm_from_quaternion", "zxy"), "takes no sequence")],
)  # fmt: skip
def test_what_cannot_be_written_is_said(call, words):
    with pytest.raises(ValueError, match=words):
        formula_in(*call)
