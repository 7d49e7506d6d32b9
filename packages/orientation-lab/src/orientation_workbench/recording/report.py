"""The bench's findings as one page, and the corrected recording."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from .allan import noise_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .examined import Examined

#: The ways to write an orientation, by their names in the command.
CONVENTIONS = ("wxyz", "xyzw", "yaw-pitch-roll")


def as_csv(examined: Examined, convention: str = "wxyz") -> str:
    """Return the corrected recording as CSV.

    Parameters
    ----------
    examined : Examined
    convention : str
        The form of the filter's orientation, which is the body's relative to a ground with z up:
        ``wxyz`` or ``xyzw`` for a quaternion with its scalar first or last, ``yaw-pitch-roll`` for
        body fixed z-y-x angles in degrees.

    Returns
    -------
    str
        Angular velocity in radians per second, specific force in multiples of gravity, the field in
        multiples of its length, and the filter's orientation, which is missing where the filter did
        not run.

    Raises
    ------
    ValueError
        If the convention is unknown.
    """
    if convention not in CONVENTIONS:
        raise ValueError(f"unknown convention {convention!r}: choose {', '.join(CONVENTIONS)}")
    from orientation import body_fixed_from_dcm, quaternion_from_dcm

    names, columns = ["time (s)"], [examined.time[:, None]]
    for kind, unit, values in (
        ("angular velocity", "rad/s", examined.rates),
        ("specific force", "g", examined.forces),
        ("field", "1", examined.field),
    ):
        if values is not None:
            columns.append(values)
            names += [f"{kind} {axis} ({unit})" for axis in "xyz"]
    if examined.judgements:
        own = (
            ["yaw (deg)", "pitch (deg)", "roll (deg)"]
            if convention == "yaw-pitch-roll"
            else [f"q{letter}" for letter in convention]
        )
        orientations = np.full((len(examined.time), len(own)), np.nan)
        for judgement in examined.judgements:
            times = judgement.times
            inside = np.flatnonzero((examined.time >= times[0]) & (examined.time <= times[-1]))
            dcms = judgement.dcms[np.searchsorted(times, examined.time[inside])]
            orientations[inside] = (
                np.degrees(body_fixed_from_dcm(dcms, "zyx"))
                if convention == "yaw-pitch-roll"
                else np.roll(quaternion_from_dcm(dcms), -1 * (convention == "xyzw"), axis=1)
            )
        names, columns = [*names, *own], [*columns, orientations]
    lines = [",".join(f"{value:.9g}" for value in row) for row in np.concatenate(columns, axis=1)]
    return "\n".join([",".join(names), *lines]) + "\n"


def as_code(examined: Examined) -> str:
    """Return lines of NumPy that correct a recording of the same instrument.

    They take ``gyroscope``, ``accelerometer`` and ``magnetometer``, arrays of shape ``(n, 3)`` as
    in the file, and compute ``rates`` in radians per second, ``forces`` in multiples of gravity and
    ``field`` in multiples of its length.
    """
    facts, lines = examined.facts, ["import numpy as np", ""]
    lengths = {"g": facts.get("gravity"), "b": facts.get("strength of the field")}
    for values, name, formula in (
        (examined.rates, "unit of the gyroscope", "rates = gyroscope * {}"),
        (examined.rates, "axes of the gyroscope", "rates = rates @ {}.T"),
        (examined.rates, "bias of the gyroscope", "rates = rates - {}"),
        (examined.rates, "multiplied", "rates = rates * {}"),
        (examined.forces, "gravity", "forces = accelerometer / {}"),
        (examined.forces, "offset of the accelerometer", "forces = forces - {} / {g!r}"),
        (examined.forces, "scales of the accelerometer", "forces = forces / {}"),
        (examined.field, "strength of the field", "field = magnetometer / {}"),
        (examined.field, "offset of the magnetometer", "field = field - {} / {b!r}"),
        (examined.field, "shape of the magnetometer", "field = field @ {}.T"),
    ):
        numbers = np.asarray(facts.get(name, 1.0), float)
        if values is not None and name in facts and (name != "multiplied" or (numbers != 1).any()):
            text = f"np.array({numbers.tolist()})" if numbers.ndim else repr(float(numbers))
            lines.append(formula.format(text, **lengths))
    return "\n".join(lines)


def as_fragment(examined: Examined) -> str:
    """Return the report as HTML for another page: verdicts, plots and code."""
    rows = "".join(
        f'<tr class="{verdict.light.replace(" ", "-")}"><td>{verdict.light}</td>'
        f'<th scope="row">{escape(verdict.about)}</th>'
        f"<td>{escape(verdict.words)}"
        + (f"<p><b>{escape(verdict.advice)}</b></p>" if verdict.advice else "")
        + "</td></tr>"
        for verdict in examined.verdicts
    )
    pictures = "".join(
        f"<figure>{picture}<figcaption>{escape(words)}</figcaption></figure>"
        for picture, words in plots(examined)
    )
    return (
        f'<div class="on-the-bench"><style>{STYLE}</style><p>{_in_short(examined)}</p>'
        f"<table>{rows}</table>{pictures}<details><summary>The code that corrects it</summary>"
        f"<pre>{escape(as_code(examined))}</pre></details></div>"
    )


def _in_short(examined: Examined) -> str:
    """List the lights that are not green, the worst first."""
    lit = {
        light: dict.fromkeys(
            verdict.about for verdict in examined.verdicts if verdict.light == light
        )
        for light in ("wrong", "look", "cannot tell")
    }
    lines = (
        f"<b>{light.capitalize()}</b>: {escape(', '.join(about))}."
        for light, about in lit.items()
        if about
    )
    return " ".join(lines) or "Everything is as it should be."


def as_html(examined: Examined, fragment: str | None = None) -> str:
    """Return the report as a self-contained page; give ``fragment`` if its body already exists."""
    name = escape(examined.name)
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" '
        'content="width=device-width">'
        f"<title>{name} on the bench</title><style>{PAGE}</style><h1>{name}</h1>"
        f"{fragment or as_fragment(examined)}</html>\n"
    )


PAGE = """
:root { color-scheme: light dark; font: 16px/1.45 system-ui, sans-serif; }
body { max-width: 60rem; margin: 1rem auto; padding: 0 1rem; }
"""
STYLE = """
.on-the-bench table { border-collapse: collapse; width: 100%; }
.on-the-bench td, .on-the-bench th { text-align: left; vertical-align: top;
padding: .35rem .6rem .35rem 0; border: 0; border-top: 1px solid #8886; overflow-wrap: anywhere; }
.on-the-bench th { font-weight: 600; min-width: 8rem; } .on-the-bench p { margin: .2rem 0; }
.on-the-bench tr > td:first-child { white-space: nowrap; }
.on-the-bench tr.wrong > td:first-child { color: #c62828; font-weight: 700; }
.on-the-bench tr.look > td:first-child { color: #8a5200; font-weight: 700; }
.on-the-bench figure { margin: 1rem 0; background: #fff; color: #222; border-radius: 4px; }
.on-the-bench figure svg { width: 100%; height: auto; }
.on-the-bench figcaption { padding: 0 .8rem .6rem; color: #222; }
.on-the-bench pre { overflow-x: auto; } .on-the-bench summary { cursor: pointer; }
@media (prefers-color-scheme: dark) {
:root:not([data-theme=light]) .on-the-bench tr.wrong > td:first-child { color: #ff8a80; }
:root:not([data-theme=light]) .on-the-bench tr.look > td:first-child { color: #ffb74d; } }
[data-theme=dark] .on-the-bench tr.wrong > td:first-child { color: #ff8a80; }
[data-theme=dark] .on-the-bench tr.look > td:first-child { color: #ffb74d; }
@media (max-width: 40rem) { .on-the-bench :is(table, tbody, tr, td, th) { display: block; }
.on-the-bench :is(td, th) { border: 0; padding: .1rem 0; }
.on-the-bench tr { border-top: 1px solid #8886; padding: .3rem 0; } }
"""


def plots(examined: Examined) -> list[tuple[str, str]]:
    """Return pairs of an SVG and its description, or none without Matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return []
    pictures: list[tuple[str, str]] = []
    few = slice(None, None, max(1, len(examined.time) // 1500))
    blue, red, thin = "#1f5fbf", "#c62828", 0.8

    @contextmanager
    def drawing(height: float, words: str, across: str, up: str) -> Iterator[Axes]:
        # At this size the words in the figure are legible on a phone.
        figure = Figure(figsize=(6.2, height), layout="constrained")
        axes, text = figure.subplots(), io.StringIO()
        axes.set(xlabel=across, ylabel=up)
        yield axes
        figure.savefig(text, format="svg", metadata={"Date": None})
        svg = text.getvalue()
        svg = re.sub(r"<metadata>.*?</metadata>", "", svg[svg.index("<svg") :], flags=re.DOTALL)
        svg = svg.replace("<svg", f'<svg role="img" aria-label="{escape(words, quote=True)}"', 1)
        pictures.append((svg, words))

    if examined.rates is not None:
        still = sum(stretch.still for stretch in examined.still)
        words = (
            "How fast the instrument rotates. Shaded: the stretches in which it lies still "
            f"({still}) and those in which it is held ({len(examined.still) - still})."
        )
        with drawing(2.6, words, "time (s)", "rate (°/s)") as axes:
            axes.plot(
                examined.time[few],
                np.degrees(np.linalg.norm(examined.rates[few], axis=1)),
                color=blue,
                linewidth=thin,
            )
            for stretch in examined.still:
                axes.axvspan(
                    *examined.time[[stretch.first, stretch.last - 1]],
                    color="#2e7d32" if stretch.still else "#a66300",
                    alpha=0.2,
                )
    if "Allan deviation" in examined.facts:
        times, deviations = examined.facts["Allan deviation"]
        noise = noise_of(times, deviations)
        words = (
            "Allan deviation of the gyroscope in its longest still stretch. "
            "Where it halves as the averaging time quadruples, the noise is white, and the value "
            "of that line at one second is the angle random walk. The lowest point is the bias "
            "instability, if the stretch is long enough to show it."
        )
        with drawing(3.2, words, "averaged over (s)", "Allan deviation (°/s)") as axes:
            for values, letter, style in zip(deviations.T, "xyz", ("-", "--", ":"), strict=True):
                axes.loglog(times, values, style, label=letter)
            walk, lowest = noise.angle_random_walk.max(), noise.bias_instability
            marks = []
            if np.isfinite(walk):
                axes.loglog(times, walk / np.sqrt(times), linewidth=0.6, color="#777")
                marks.append((1, walk, "o", (6, 6), f"angle random walk {walk:.2g} °/√s"))
            if np.isfinite(lowest).any():
                k = int(np.nanargmax(lowest))
                told = f"bias instability {lowest[k]:.2g} °/s"
                marks.append((noise.time[k], lowest[k], "s", (6, -12), told))
            for x, y, marker, beside, told in marks:
                axes.plot(x, y, marker, color=red)
                axes.annotate(told, (x, y), beside, textcoords="offset points")
            axes.legend()
    if examined.field is not None and "offset of the magnetometer" in examined.facts:
        facts = examined.facts
        inverse = np.linalg.inv(facts["shape of the magnetometer"])
        offset = facts["offset of the magnetometer"] / facts["strength of the field"]
        before, now = (
            np.linalg.norm(values, axis=1)
            for values in (examined.field[few] @ inverse.T + offset, examined.field[few])
        )
        words = (
            "Strength of the magnetic field, relative to its usual strength. Dashed: as recorded; "
            "solid: corrected."
        )
        with drawing(2.4, words, "time (s)", "strength of the field") as axes:
            axes.plot(examined.time[few], before, "--", color=red, linewidth=thin)
            axes.plot(examined.time[few], now, color=blue, linewidth=thin)
            axes.set_ylim(0, None)
    if examined.judgements:
        words = (
            "Solid: how much the forward and backward runs of the filter differ in tilt. "
            "Dashed: how much they should differ according to the filter."
        )
        with drawing(2.6, words, "time (s)", "tilt (°)") as axes:
            for judgement in examined.judgements:
                axes.plot(judgement.times, judgement.apart, color=blue, linewidth=thin)
                axes.plot(judgement.times, judgement.claims, "--", color=red, linewidth=thin)
            # At either end a run has seen little and claims little, which would dwarf the rest.
            usual = [values for run in examined.judgements for values in (run.apart, run.claims)]
            axes.set_ylim(0, 1.5 * np.percentile(np.concatenate(usual), 98) + 1e-3)
    return pictures
