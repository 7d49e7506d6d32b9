"""The look of the drawings: colours, strokes, and the style sheet that goes with every figure.

Interactive figures need it where there is no NumPy to draw with.
"""

import re

# Each colour has a contrast of 4.5 : 1 or more on its page: LIGHT on white, DARK on #121212.
LIGHT = {
    "N": "#3a3f45",
    "A": "#946200",
    "B": "#b3261e",
    "C": "#1a7431",
    "D": "#1f5fbf",
    "E": "#7b3fa0",
    "F": "#a0306e",
    "Z": "#5a6300",
    "ink": "#1d2125",
    "muted": "#646b73",
    "accent": "#00696f",
}
DARK = {
    "N": "#d0d4da",
    "A": "#f2c14e",
    "B": "#ff8a80",
    "C": "#6fdc8c",
    "D": "#8ab4ff",
    "E": "#cfa3f0",
    "F": "#f39ac7",
    "Z": "#c3d35b",
    "ink": "#eceff2",
    "muted": "#a2a9b1",
    "accent": "#5fd3da",
}
# For a picture on any page: a contrast of 4 : 1 or more on white and on #15181d alike.
EITHER = {
    "N": "#707a86",
    "A": "#a66e00",
    "B": "#dd3e35",
    "C": "#1f8b3b",
    "D": "#3277de",
    "E": "#9c60c0",
    "F": "#c84990",
    "Z": "#748000",
    "ink": "#797979",
    "muted": "#727a83",
    "accent": "#00868e",
}

# Without colour, frames differ in the stroke of their arrows (width, dashes) and in the shape of
# the head.
STROKES = {
    "N": (1.7, "none"),
    "A": (3.4, "none"),
    "B": (2.6, "9 4.5"),
    "C": (2.6, "11 4.5 0.1 4.5"),
    "D": (3.2, "0.1 5.2"),
    "E": (2, "16 4"),
    "F": (4.6, "none"),
    "Z": (2, "5 4"),
    "ink": (2.4, "none"),
    "muted": (1.7, "none"),
    "accent": (2.4, "none"),
}


RULES = {
    " svg": "width:100%;height:auto;fill:none;stroke:currentColor;stroke-width:1.5;"
    "stroke-linecap:round;stroke-linejoin:round",
    " .guide": "stroke-width:1.3;stroke-dasharray:4 4",
    " .faint": "stroke-width:1;stroke-opacity:.45",
    " .thick": "stroke-width:3",
    " .bare": "stroke:none",
    " .tube": "stroke-width:13",
    " .core": "stroke-width:9.5;stroke:color-mix(in srgb,var(--unlit) 40%,var(--lit))",
    " .gleam": "stroke-width:3;stroke:var(--lit)",
    " .paper": "fill:var(--sheet)",
    " .head": "fill:currentColor;stroke:none",
    " .text": "fill:currentColor;stroke:var(--sheet);stroke-width:200;paint-order:stroke",
    " [class*=fill]": "stroke-linecap:butt",
    " [class*=shade]": "stroke-linecap:butt",
    " input": "width:55%;vertical-align:middle",
    " output": "display:block;min-height:3em",
    **{
        f" .fill-{part}": f"fill:color-mix(in srgb,currentColor {part}%,var(--sheet))"
        for part in (8, 16, 26, 38)
    },
    **{
        f" .shade-{part}": f"fill:color-mix(in srgb,var(--unlit) {part}%,var(--lit))"
        for part in range(0, 101, 10)
    },
    **{
        selector: rule
        for name, (width, dashes) in STROKES.items()
        for selector, rule in {
            f" .{name}": f"color:var(--{name})",
            f" .axis.{name}": f"stroke-width:{width};stroke-dasharray:{dashes}",
        }.items()
    },
}


def _lights(lit, unlit):
    """Return how much of its colour, in per cent, a body shows in the light and out of it.

    Light makes a body paler on a light page, and more colourful on a dark one.
    """
    return (
        f"--lit:color-mix(in srgb,currentColor {lit}%,var(--sheet));"
        f"--unlit:color-mix(in srgb,currentColor {unlit}%,var(--sheet));"
    )


def _style():
    """Return the style sheet of every figure; a page may set ``--frame-a`` and so on."""

    def colours(table):
        return "".join(
            f"--{name}:var(--frame-{name.lower()},{colour});" for name, colour in table.items()
        )

    rules = {
        "": colours(LIGHT)
        + _lights(4, 50)
        + "--sheet:var(--pst-color-background,var(--jp-layout-color0,#fff));"
        "margin:1rem auto;text-align:center",
        **RULES,
    }
    dark = ",".join(
        f"{page} .orientation-figure"
        for page in ('html[data-theme="dark"]', 'body[data-jp-theme-light="false"]')
    )
    return (
        "".join(f".orientation-figure{part}{{{rule}}}" for part, rule in rules.items())
        + f"{dark}{{{colours(DARK)}{_lights(46, 6)}}}"
    )


def style_of_picture(classes):
    """Return the style sheet of a picture with these classes, for light pages and dark ones alike.

    Bodies keep white in their colours. Letters have no border, which would be of the page's colour.
    """
    pale = {**EITHER, "lit": "#fff", "unlit": "color-mix(in srgb,currentColor 50%,#fff)"}
    return re.sub(
        r"var\(--(\w+)\)",
        lambda name: pale.get(name[1], "#fff"),
        "".join(
            f"{part[1:]}{{{rule}}}"
            for part, rule in RULES.items()
            if (named := set(re.findall(r"\.([\w-]+)", part))) and named <= classes
        ).replace("stroke:var(--sheet);stroke-width:200;paint-order:stroke", "stroke:none"),
    )


STYLE = _style()
