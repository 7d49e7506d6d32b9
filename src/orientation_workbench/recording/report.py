"""What the bench has found, as a text, as one page, and as the corrected recording."""

import io
import re
from html import escape
from textwrap import wrap

import numpy as np

WIDTH = 88  # of a line of the text
LIGHTS = {"as it should be": "ok  ", "look": "LOOK", "wrong": "RED ", "cannot tell": "?   "}
#: Ways to write an orientation down, by what the command calls them.
CONVENTIONS = ("wxyz", "xyzw", "yaw-pitch-roll")


def as_text(examined):
    """The report as plain text: a line for each verdict, with its evidence and what to do."""
    lines = [f"{examined.name}"]

    def add(words, first, rest):
        lines.extend(wrap(words, WIDTH, initial_indent=first, subsequent_indent=rest, break_long_words=False))

    for verdict in examined.verdicts:
        add(f"{verdict.about}: {verdict.words}", f"{LIGHTS[verdict.light]} ", "     ")
        if verdict.evidence and verdict.light != "as it should be":
            add(", ".join(f"{name} {value}" for name, value in verdict.evidence.items()), "       ", "       ")
        if verdict.advice:
            add(verdict.advice, "  -> ", "     ")
    return "\n".join(lines)


def as_csv(examined, convention="wxyz"):
    """The corrected recording as CSV.

    Parameters
    ----------
    examined : Examined
    convention : str
        Of the filter's orientation, the body's with respect to a ground with z up: ``wxyz`` and ``xyzw`` for a
        quaternion with its scalar first or last, ``yaw-pitch-roll`` for degrees, body fixed z-y-x.

    Returns
    -------
    str
        Angular velocity in radians per second, specific force in multiples of gravity, the field in multiples of its
        length, and the filter's orientation where it ran: elsewhere it is missing.

    Raises
    ------
    ValueError
        If the convention is another.
    """
    if convention not in CONVENTIONS:
        raise ValueError(f"there is no convention {convention!r}: it is {', '.join(CONVENTIONS)}")
    from orientation import body_fixed_from_dcm, quaternion_from_dcm

    names, columns = ["time (s)"], [examined.time[:, None]]
    for kind, unit, values in (
        ("angular velocity", "rad/s", examined.rates),
        ("specific force", "g", examined.forces),
        ("field", "1", examined.field),
    ):
        if values is not None:
            names += [f"{kind} {axis} ({unit})" for axis in "xyz"]
            columns.append(values)
    if examined.judgements:
        if convention == "yaw-pitch-roll":
            names += ["yaw (deg)", "pitch (deg)", "roll (deg)"]
        else:
            names += [f"q{letter}" for letter in convention]
        found = np.full((len(examined.time), len(names) - sum(part.shape[1] for part in columns)), np.nan)
        for one in examined.judgements:
            inside = np.flatnonzero((examined.time >= one.times[0]) & (examined.time <= one.times[-1]))
            dcms = one.dcms[np.searchsorted(one.times, examined.time[inside])]
            if convention == "yaw-pitch-roll":
                found[inside] = np.degrees(body_fixed_from_dcm(dcms, "zyx"))
            else:
                found[inside] = np.roll(quaternion_from_dcm(dcms), -1 * (convention == "xyzw"), axis=1)
        columns.append(found)
    lines = [",".join(f"{value:.9g}" for value in row) for row in np.concatenate(columns, axis=1)]
    return "\n".join([",".join(names), *lines]) + "\n"


def as_html(examined):
    """The report as one page that needs nothing else: verdicts, evidence and plots."""
    rows = "".join(
        f'<tr class="{verdict.light.replace(" ", "-")}"><td>{verdict.light}</td><th>{escape(verdict.about)}</th>'
        f"<td>{escape(verdict.words)}"
        + (f"<p><b>{escape(verdict.advice)}</b></p>" if verdict.advice else "")
        + (
            "<details><summary>evidence</summary>"
            + "<br>".join(f"{escape(str(name))}: {escape(str(value))}" for name, value in verdict.evidence.items())
            + "</details>"
            if verdict.evidence
            else ""
        )
        + "</td></tr>"
        for verdict in examined.verdicts
    )
    pictures = "".join(
        f"<figure>{picture}<figcaption>{escape(words)}</figcaption></figure>" for picture, words in plots(examined)
    )
    code = (
        "from orientation_workbench.recording import examine\n\n"
        f"found = examine({examined.name!r})\nprint(found)\nfound.rates, found.forces, found.field   # corrected"
    )
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
        f"<title>{escape(examined.name)} on the bench</title><style>{STYLE}</style>"
        f"<h1>{escape(examined.name)}</h1><table>{rows}</table>{pictures}"
        f"<h2>The code that made it</h2><pre>{escape(code)}</pre></html>\n"
    )


STYLE = """
:root { color-scheme: light dark; font: 16px/1.45 system-ui, sans-serif; }
body { max-width: 60rem; margin: 1rem auto; padding: 0 1rem; }
table { border-collapse: collapse; width: 100%; }
td, th { text-align: left; vertical-align: top; padding: .35rem .6rem .35rem 0;
border-top: 1px solid #8886; overflow-wrap: anywhere; } th { font-weight: 600; min-width: 8rem; } p { margin: .2rem 0; }
tr > td:first-child { white-space: nowrap; } tr.wrong > td:first-child { color: #c62828; font-weight: 700; }
tr.look > td:first-child { color: #a66300; font-weight: 700; } tr.cannot-tell > td:first-child { color: #777; }
@media (prefers-color-scheme: dark) { tr.wrong > td:first-child { color: #ff8a80; }
tr.look > td:first-child { color: #ffb74d; } }
figure { margin: 1rem 0; background: #fff; color: #222; border-radius: 4px; } figure svg { width: 100%; height: auto; }
figcaption { padding: 0 .8rem .6rem; } pre { overflow-x: auto; } summary { cursor: pointer; opacity: .75; }
@media (max-width: 40rem) { table, tbody, tr, td, th { display: block; } td, th { border: 0; padding: .1rem 0; }
tr { border-top: 1px solid #8886; padding: .3rem 0; } }
"""


def plots(examined):
    """Pairs of an SVG and of what it shows, in words; none where Matplotlib is missing."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return []
    found = []
    few = slice(None, None, max(1, len(examined.time) // 1500))

    def drawing(height):
        figure = Figure(figsize=(9, height), layout="constrained")
        return figure, figure.subplots()

    def kept(figure, words):
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
        svg = text.getvalue()
        svg = re.sub(r"<metadata>.*?</metadata>", "", svg[svg.index("<svg") :], flags=re.DOTALL)
        svg = svg.replace("<svg", f'<svg role="img" aria-label="{escape(words, quote=True)}"', 1)
        found.append((svg, words))

    if examined.rates is not None:
        figure, axes = drawing(2.6)
        axes.plot(
            examined.time[few], np.degrees(np.linalg.norm(examined.rates[few], axis=1)), linewidth=0.8, color="#1f5fbf"
        )
        for one in examined.still:
            axes.axvspan(
                examined.time[one.first],
                examined.time[one.last - 1],
                color="#2e7d32" if one.still else "#a66300",
                alpha=0.2,
            )
        axes.set(xlabel="time (s)", ylabel="rate (°/s)")
        still = sum(one.still for one in examined.still)
        kept(
            figure,
            f"How fast it turns. Shaded: {still} stretches in which it lies still, "
            f"{len(examined.still) - still} in which it is held.",
        )
        times, deviations = allan_deviation(examined)
        if len(times):
            figure, axes = drawing(3)
            for values, letter, style in zip(np.degrees(deviations).T, "xyz", ("-", "--", ":"), strict=True):
                axes.loglog(times, values, style, label=letter)
            axes.set(xlabel="averaged over (s)", ylabel="Allan deviation (°/s)")
            axes.legend()
            kept(
                figure,
                "Allan deviation of the gyroscope in its longest still stretch. Where it falls by half for four times "
                "the time, it is noise; its lowest point is the instability of its bias.",
            )
    if examined.judgements:
        figure, axes = drawing(2.6)
        for one in examined.judgements:
            axes.plot(one.times, one.apart, linewidth=0.8, color="#1f5fbf")
            axes.plot(one.times, one.claims, "--", linewidth=1, color="#c62828")
        axes.set(xlabel="time (s)", ylabel="tilt (°)", ylim=(0, None))
        kept(
            figure,
            "Solid: by how much the filter run forwards and backwards differ in tilt. Dashed: how much they should by "
            "their own claims.",
        )
    return found


def allan_deviation(examined):
    """Allan deviation of the angular velocity in the longest still stretch.

    Parameters
    ----------
    examined : Examined

    Returns
    -------
    times of shape ``(k,)`` in seconds, deviations of shape ``(k, 3)`` in radians per second
        Empty without a still stretch of two seconds and more.
    """
    still = [one for one in examined.still if one.still]
    step = float(np.median(np.diff(examined.time)))
    longest = max(still, key=lambda one: one.last - one.first, default=None)
    if longest is None or (longest.last - longest.first) * step < 2:
        return np.empty(0), np.empty((0, 3))
    path = np.concatenate([np.zeros((1, 3)), np.cumsum(examined.rates[longest.first : longest.last], axis=0)])
    sizes = np.unique(np.geomspace(1, (len(path) - 1) // 4, 24).astype(int))
    deviations = []
    for size in sizes:  # overlapping: every beginning there is
        change = path[2 * size :] - 2 * path[size:-size] + path[: -2 * size]
        deviations.append(np.sqrt((change**2).mean(axis=0) / 2) / size)
    return sizes * step, np.array(deviations)
