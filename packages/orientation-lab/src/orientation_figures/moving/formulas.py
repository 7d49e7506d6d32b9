"""Write the formulas of ``orientation`` for the page, in ``js/formulas.js``.

Run it with ``python -m orientation_figures.moving.formulas``. The formulas are recorded from the
module, so that none is written in JavaScript a second time. The file is committed with the others,
as the figures need it where nothing can be recorded.
"""

from dataclasses import replace

from orientation import PROPER_EULER, SEQUENCES, TAIT_BRYAN
from orientation.axis_angle import axis_angle_components
from orientation_workbench.formulas import (
    CHOICES,
    FORMULAS,
    LISTS,
    SIZES,
    applied,
    formula_of,
    variable,
)
from orientation_workbench.languages import LANGUAGES, written

from .bundle import FOLDER
from .tumbling import angular_acceleration

COMMAND = "python -m orientation_figures.moving.formulas"
FILE = FOLDER / "js" / "formulas.js"

# The formulas that figures use, with the sequences or axes that they use them for.
NAMES = {
    "simple_dcm": "xyz",
    "dcm_from_body_fixed": SEQUENCES,
    "body_fixed_from_dcm": SEQUENCES,
    "gimbal_lock_margin": SEQUENCES,
    "angular_velocity_matrix": ("zxy",),
    **dict.fromkeys(
        (
            "dcm_from_axis_angle", "quaternion_from_axis_angle", "dcm_from_quaternion",
            "quaternion_from_dcm", "multiply_quaternions", "dcm_from_rotation_vector", "dcm_rate",
            "quaternion_rate",
        )
    ),
}  # fmt: skip
JAVASCRIPT = replace(
    LANGUAGES["JavaScript"],
    part="const {part} = {value};",
    chosen="const {part} = {condition} ? {yes} : {no};",
)


def text():
    """Return the module; matrices are three rows, as in the other modules of the figures."""
    lines = [
        f"// Written by `{COMMAND}`: the formulas of the module `orientation`. Angles in radians, "
        "quaternions",
        "// scalar first; the rows of a matrix A_C_N are A's unit vectors along N.",
        "",
        *(
            f"export const {name} = [{', '.join(map(repr, value))}];"
            for name, value in CONSTANTS.items()
        ),
        "",
    ]
    for name, choices in NAMES.items():
        takes, gives = FORMULAS[name]
        if choices is None:
            lines.append(f"export const {camel(name)} = {function(name, takes, gives)};")
            continue
        choice_name = CHOICES[name][0]
        rows = (f"  {choice}: {function(name, takes, gives, choice)},\n" for choice in choices)
        lines.append(f"const {camel(name)}By = {{\n{''.join(rows)}}};")
        order = [choice_name, *takes] if name == "simple_dcm" else [*takes, choice_name]
        lines.append(
            f"export const {camel(name)} = ({', '.join(order)}) => "
            f"{camel(name)}By[{choice_name}]({', '.join(takes)});"
        )
    quaternion, (omega, moments) = (
        components("quaternion", "q"),
        (components("vector", letter) for letter in "om"),
    )
    for name, entries, parameters in (
        ("axisAngleComponents", applied(axis_angle_components, *quaternion), [quaternion]),
        ("angularAcceleration", list(angular_acceleration(omega, moments)), [omega, moments]),
    ):
        lines.append(
            f"export const {name} = {arrow(parameters, ['vector'] * 2, entries, 'vector')};"
        )
    return "\n".join(lines) + "\n"


CONSTANTS = {"PROPER_EULER": PROPER_EULER, "TAIT_BRYAN": TAIT_BRYAN}


def camel(name):
    first, *others = name.split("_")
    return first + "".join(map(str.capitalize, others))


def components(kind, letter):
    return [variable(f"{letter}{k}" if kind in LISTS else letter) for k in range(SIZES[kind])]


def function(name, takes, gives, choice=None):
    parameters = [components(kind, letter) for kind, letter in zip(takes.values(), "abc")]
    results = formula_of(name, parameters, choice)
    if gives == "angles":
        # Add zero, as the module does, because -0 would look like a wrong sign.
        results = [result + 0.0 for result in results]
    return arrow(parameters, list(takes.values()), results, gives)


def arrow(parameters, kinds, results, gives):
    """Return a JavaScript function with destructured parameters."""
    names = {entry.parts[0]: entry.parts[0] for entries in parameters for entry in entries}
    lines, values = written(JAVASCRIPT, results, names)
    head = ", ".join(
        shaped([entry.parts[0] for entry in entries], kind)
        for entries, kind in zip(parameters, kinds)
    )
    result = shaped(values, gives)
    return (
        f"({head}) => {{ {' '.join(lines)} return {result}; }}"
        if lines
        else f"({head}) => {result}"
    )


def shaped(texts, kind):
    if kind not in LISTS:
        return texts[0]
    if kind not in ("matrix", "entries"):
        return f"[{', '.join(texts)}]"
    return f"[{', '.join(shaped(texts[k : k + 3], 'vector') for k in (0, 3, 6))}]"


if __name__ == "__main__":
    FILE.write_text(text(), "utf8")
