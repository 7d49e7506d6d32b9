"""Formulas that are taken away: compiled and run, they give what
the module gives, in any convention.
"""

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
from orientation_workbench.formulas import CHOICES, FORMULAS, LISTS, SIZES
from orientation_workbench.languages import LANGUAGES, formula_in

CONVENTIONS = [{}, {"matrix": "transposed", "scalar": "last", "unit": "degrees"}]


def jobs():
    """Every formula, those of angles with one sequence of each family, in both conventions."""
    for name, convention in itertools.product(FORMULAS, CONVENTIONS):
        what, allowed = CHOICES.get(name, ("", (None,)))
        for sequence in ("zxy", "zxz") if what == "sequence" else allowed:
            yield name, sequence, convention


JOBS = list(jobs())


def given(name, seed):
    """Arguments in this book's convention: orientations, at gimbal lock and at
    half a turn too, and other numbers.
    """
    random = np.random.default_rng(seed)
    special = [
        np.eye(3),
        np.diag([1.0, -1.0, -1.0]),
        np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]),
    ]
    dcms = [*random_orientations(6, random), *special]
    vectors = [
        *random.uniform(-3, 3, (6, 3)),
        np.array([2.9, 1.2, -3.0]),
        np.array([0.0, 1e-9, 0.0]),
    ]
    if name == "dcm_from_rotation_vector":
        vectors.append(np.zeros(3))
    some = {
        "matrix": dcms,
        "quaternion": [np.array(orientation.quaternion_from_dcm(dcm)) for dcm in dcms],
        "angles": vectors,
        "vector": vectors,
        "angle": [*random.uniform(-4, 4, 5), 0.0, np.pi],
        "number": [0.0, 1.0, *random.uniform(0, 1, 5)],
    }
    kinds = list(FORMULAS[name][0].values())
    return [
        [some[kind][(k + 3 * place) % len(some[kind])] for place, kind in enumerate(kinds)]
        for k in range(9)
    ]


def converted(kind, values, convention):
    values = np.asarray(values, float)
    if kind == "matrix":
        values = values.reshape(3, 3).T if convention.get("matrix") else values
    if kind == "quaternion" and convention.get("scalar"):
        values = np.roll(values, -1)
    if kind in ("angle", "angles") and convention.get("unit"):
        values = np.degrees(values)
    return values.ravel().tolist() if kind in LISTS else float(values)


def expected(name, sequence, convention, arguments):
    function = getattr(orientation, name)
    arguments = [
        argument.tolist() if hasattr(argument, "tolist") else argument for argument in arguments
    ]
    chosen = [sequence] if sequence else []
    result = (
        function(*chosen, *arguments) if name == "simple_dcm" else function(*arguments, *chosen)
    )
    return converted(FORMULAS[name][1], np.array(result, float), convention)


def cases():
    all_cases = []
    for which, (name, sequence, convention) in enumerate(JOBS):
        kinds = list(FORMULAS[name][0].values())
        for arguments in given(name, which):
            numbers = [
                converted(kind, argument, convention) for kind, argument in zip(kinds, arguments)
            ]
            all_cases.append((which, numbers, expected(name, sequence, convention, arguments)))
    return all_cases


def close(result, wanted, name, sequence, convention):
    """Equal, and what has several numbers for one orientation by that orientation."""
    result, wanted = np.array(result), np.array(wanted)
    if name in ("body_fixed_from_dcm", "space_fixed_from_dcm"):
        make = getattr(orientation, "dcm_from_" + name.removesuffix("_from_dcm"))
        result, wanted = (
            make(np.radians(numbers) if convention.get("unit") else numbers, sequence)
            for numbers in (result, wanted)
        )
    if name in ("quaternion_from_dcm", "rotation_vector_from_dcm") and result @ wanted < 0:
        result = -result
    return np.abs(result - wanted).max() <= 1e-11 * max(1, np.abs(wanted).max())


def texts(language):
    for name, sequence, convention in JOBS:
        own = "_".join(filter(None, [name, sequence]))
        yield own, formula_in(language, name, sequence, **convention)


def hold(outputs):
    for (which, numbers, wanted), result in zip(cases(), outputs, strict=True):
        name, sequence, convention = JOBS[which]
        assert close(result, wanted, name, sequence, convention), (
            name,
            sequence,
            convention,
            numbers,
            result,
            wanted,
        )


def test_javascript_gives_the_same():
    functions = ",\n".join(
        f"(() => {{ {text}\nreturn {own}; }})()" for own, text in texts("JavaScript")
    )
    calls = json.dumps([[which, numbers] for which, numbers, _ in cases()])
    program = (
        f"const all = [{functions}];\nconsole.log(JSON.stringify({calls}.map(([k, a]) => "
        "all[k](...a))));"
    )
    done = subprocess.run([NODE, "-e", program], capture_output=True, text=True, check=True)
    hold(json.loads(done.stdout))


def run_compiled(tmp_path, source, command):
    (tmp_path / "source").write_text(source)
    subprocess.run(
        [*command, "-o", tmp_path / "program"], cwd=tmp_path, check=True, capture_output=True
    )
    done = subprocess.run([tmp_path / "program"], capture_output=True, text=True, check=True)
    hold([[float(number) for number in line.split()] for line in done.stdout.splitlines()])


@pytest.mark.skipif(not shutil.which("cc"), reason="there is no C compiler here")
def test_c_gives_the_same(tmp_path):
    functions, calls = [], []
    for which, (own, text) in enumerate(texts("C")):
        functions.append(text.replace(own, f"f{which}").replace("#include <math.h>", ""))
    for which, numbers, wanted in cases():
        passed = ", ".join(
            "(double[]){" + ", ".join(f"{number:.17g}" for number in argument) + "}"
            if isinstance(argument, list)
            else f"{argument!r}"
            for argument in numbers
        )
        call = (
            f"f{which}({passed}, r)" if isinstance(wanted, list) else f"r[0] = f{which}({passed})"
        )
        calls.append(f"{call}; show(r, {np.size(wanted)});")
    source = (
        "#include <math.h>\n#include <stdio.h>\n" + "\n".join(functions)
        + '\nstatic void show(double *r, int n) { for (int k = 0; k < n; k++) printf("%.17g ", '
            'r[k]); puts(""); }\n'
        + "int main(void) { double r[9];\n" + "\n".join(calls) + "\nreturn 0; }\n"
    )  # fmt: skip
    run_compiled(tmp_path, source, ["cc", "-x", "c", "source", "-lm"])


@pytest.mark.skipif(not shutil.which("c++"), reason="there is no C++ compiler here")
def test_cpp_gives_the_same(tmp_path):
    functions, calls = [], []
    for which, (own, text) in enumerate(texts("C++")):
        functions.append(
            text.replace(own, f"f{which}").replace("#include <array>\n#include <cmath>", "")
        )
    for which, numbers, _ in cases():
        passed = ", ".join(
            f"std::array<double, {len(argument)}>{{"
            + ", ".join(f"{number:.17g}" for number in argument)
            + "}"
            if isinstance(argument, list)
            else f"{argument!r}"
            for argument in numbers
        )
        calls.append(f"show(f{which}({passed}));")
    source = (
        "#include <array>\n#include <cmath>\n#include <cstdio>\n" + "\n".join(functions)
        + '\nvoid show(double x) { std::printf("%.17g\\n", x); }\n'
        + "template <std::size_t n> void show(std::array<double, n> r) {\n"
        + 'for (double x : r) std::printf("%.17g ", x);\nstd::puts(""); }\n'
        + "int main() {\n" + "\n".join(calls) + "\n}\n"
    )  # fmt: skip
    run_compiled(tmp_path, source, ["c++", "-x", "c++", "-std=c++17", "source"])


@pytest.mark.skipif(not shutil.which("rustc"), reason="there is no Rust compiler here")
def test_rust_gives_the_same(tmp_path):
    functions, calls = [], []
    for which, (own, text) in enumerate(texts("Rust")):
        functions.append(text.replace(own, f"f{which}"))
    for which, numbers, wanted in cases():
        passed = ", ".join(
            "&[" + ", ".join(f"{number:.17e}" for number in argument) + "]"
            if isinstance(argument, list)
            else f"{argument:.17e}"
            for argument in numbers
        )
        result = f"f{which}({passed})"
        calls.append(f"show(&{result if isinstance(wanted, list) else f'[{result}]'});")
    show = 'fn show(r: &[f64]) { for x in r { print!("{:e} ", x); } println!(); }'
    source = "\n".join([*functions, show, "fn main() {", *calls, "}"])
    run_compiled(tmp_path, source, ["rustc", "--crate-type", "bin", "source"])


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_writes_every_formula(language):
    for own, text in texts(language):
        assert own in text and "Not supported" not in text and "warning" not in text.lower(), text
        if language == "GLSL":
            assert not re.search(
                r"(?<!e)[-+*/(=] ?\d+(?![\d.\]e])", re.sub(r"\[\d+\]", "", text)
            ), text


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_all_sequences_are_written(sequence):
    assert formula_in("C++", "body_fixed_from_dcm", sequence).count("result[") == SIZES["angles"]


@pytest.mark.parametrize(
    "call, words",
    [(("Cobol", "dcm_from_quaternion"), "'Cobol' is not a language"),
     (("C", "dcm_from_nothing"), "not a formula"),
     (("C", "dcm_from_body_fixed"), "'none' is not a sequence .*xyz"),
     (("C", "dcm_from_quaternion", "zxy"), "not a sequence .*none")],
)  # fmt: skip
def test_what_cannot_be_written_is_said(call, words):
    with pytest.raises(ValueError, match=words):
        formula_in(*call)
