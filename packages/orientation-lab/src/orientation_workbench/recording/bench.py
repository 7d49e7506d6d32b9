"""The bench: one question after another about a recording, each answered with its evidence."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from orientation import dcm_from_body_fixed

from .allan import allan_deviation, noise_of
from .content import (
    DEGREES,
    GRAVITY,
    SENSORS,
    read_content,
    unit_in_brackets,
    unit_of_field,
    unit_of_gravity,
    unit_of_rates,
)
from .examined import GREEN, RED, UNKNOWN, YELLOW, Examined, Verdict
from .field import FieldFit, fit_ellipsoid, fit_field, spread_of_lengths, uneven_lengths
from .judged import filter_inputs, judge
from .motion import (
    ASSIGNMENTS,
    dcm_of_quaternions,
    fit_axes,
    fit_scales,
    readings,
    stretches,
    written,
)
from .table import number_of

if TYPE_CHECKING:
    from .content import Content, Group
    from .examined import Facts
    from .motion import Fit, Reading, ScaleFit, Stretch
    from .table import Array, Source

#: With a margin above this, we trust the best of the 48 assignments.
BELIEVED = 1.3
#: Degrees per second that nothing exceeds for a twentieth of the time.
FASTEST = 10_000
#: The most assignments that are listed.
FEW = 8
#: What is fitted to a magnetometer using the gyroscope's rotations at the same times.
OF_THE_FIELD = ("offset of the magnetometer", "shape of the magnetometer", "field")


def examine(
    source: Source,
    name: str | None = None,
    rate: float | None = None,
    columns: str = "",
    judged: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Examined:
    """Examine a recording.

    Parameters
    ----------
    source : path, bytes, str or list of paths
        A table of numbers in any form that `table.read_tables` takes.
    name : str, optional
        The name of the recording in the report.
    rate : float, optional
        Samples per second, if the file only counts its samples.
    columns : str
        The meaning of the columns, if the file does not give it: see
        `orientation_workbench.recording.content.read_content`.
    judged : bool
        Whether to run the filter, which takes longer than everything else.
    progress : callable, optional
        Called with the share of the filter's work that is done.

    Returns
    -------
    Examined

    Raises
    ------
    RecordingError
        If the file cannot be read, or contains no sensor.
    """
    content = read_content(source, name, rate, columns)
    bench = _Bench(
        content, name or (str(source) if not isinstance(source, (bytes, list)) else "recording")
    )
    for question in (
        bench.clock,
        bench.gyroscope,
        bench.accelerometer,
        bench.scale_and_bias,
        bench.magnetometer,
        bench.timing,
        bench.orientation,
        *((partial(bench.filter, progress),) if judged else ()),
    ):
        question()
    return Examined(
        bench.name,
        bench.verdicts,
        bench.time,
        bench.rates,
        bench.forces,
        bench.field,
        bench.oriented,
        bench.judgements,
        bench.still,
        bench.facts,
    )


class _Bench:
    """The questions, in an order in which each has the answers it needs."""

    def __init__(self, content: Content, name: str) -> None:
        self.content, self.name = content, name.splitlines()[0][:80] if "\n" in name else name
        self.facts: Facts = {}
        self.verdicts, self.judgements, self.still = [], [], []
        sensors = [content.groups[kind] for kind in SENSORS if kind in content.groups]
        self.time = sensors[0].time
        self.raw = {group.kind: _at(self.time, group.time, group.values) for group in sensors}
        # Whether the gyroscope's values are raw counts.
        self.counts = False
        self.rates = self.forces = self.field = self.oriented = None
        warm = content.groups.get("temperature")
        self.warmth = np.interp(self.time, warm.time, warm.values[:, 0]) if warm else 0 * self.time

    def say(
        self,
        about: str,
        light: str,
        words: str,
        evidence: Mapping[str, object] | None = None,
        advice: str = "",
    ) -> None:
        """Add a verdict; a green one needs no advice."""
        advice = "" if light == GREEN else advice.strip()
        self.verdicts.append(Verdict(about, light, words, dict(evidence or {}), advice))

    def _missing(self, kind: str) -> None:
        advice = f"If the file has one, name its columns: --columns {kind}=2-4."
        article = "an" if kind == "accelerometer" else "a"
        self.say(kind, UNKNOWN, f"no usable column has the name of {article} {kind}", {}, advice)

    # --- what is in it --------------------------------------------------------------------------

    def clock(self) -> None:
        groups, time = self.content.groups, self.time
        for remark in self.content.remarks:
            self.say("rows", YELLOW, remark)
        held = "; ".join(f"{kind}: {', '.join(group.names)}" for kind, group in groups.items())
        unused = f". Not used: {', '.join(self.content.unused)}" if self.content.unused else ""
        self.say("content", GREEN, held + unused)
        if self.content.counted:
            return self.say(
                "time",
                UNKNOWN,
                f"{self.content.clock}: the rate is not known",
                {},
                "Give the rate, such as --rate 100, or the column of the times, such as --columns "
                "time=1.",
            )
        steps = np.diff(time)
        step = float(np.median(steps))
        self.say(
            "time",
            GREEN,
            f"{self.content.clock}; {len(time)} samples in {time[-1]:.1f} s, {1 / step:.4g} "
            "per second",
            {
                "samples": len(time),
                "seconds": round(float(time[-1]), 3),
                "rate": round(1 / step, 2),
            },
        )
        if back := int((steps <= 0).sum()):
            self.say(
                "order of time",
                RED,
                f"time stands still or runs backwards {number_of(back, 'time')}",
                {"times": back},
            )
        long = steps > 2.5 * step
        lost = float(steps[long].sum() / time[-1]) if time[-1] > 0 else 0.0
        words = (
            f"{number_of(int(long.sum()), 'gap')}, the longest of {steps.max():.3g} s; together "
            f"{lost:.1%} of the time"
            if long.any()
            else "none"
        )
        many = lost > 0.02 or steps.max() > max(0.25, 8 * step)
        self.say(
            "gaps",
            RED if many else YELLOW if long.any() else GREEN,
            words,
            {
                "gaps": int(long.sum()),
                "longest (s)": round(float(steps.max()), 4),
                "share lost": round(lost, 4),
            },
            "No filter can know what happened during a gap.",
        )
        same = float(
            (np.diff(np.concatenate(list(self.raw.values()), axis=1), axis=0) == 0)
            .all(axis=1)
            .mean()
        )
        self.say(
            "repeated rows",
            _light(same, 0.005, 0.05),
            f"{same:.1%} of the rows repeat the previous row",
            {"share": round(same, 4)},
            "The instrument samples less often than the file claims, or rows were repeated to fill "
            "gaps.",
        )

    # --- the gyroscope --------------------------------------------------------------------------

    def gyroscope(self) -> None:
        if "gyroscope" not in self.raw:
            return self._missing("gyroscope")
        raw = self.raw["gyroscope"]
        self._saturation("gyroscope")
        # The verdict on the clock has already asked for the rate.
        if self.content.counted:
            return
        said = unit_of_rates(self.content.groups["gyroscope"].names)
        # A chip's raw counts are whole numbers.
        whole = bool((raw == raw.round()).all())
        grid = [unit * np.geomspace(0.45, 2.3, 8) for unit in DEGREES.values() if said or not whole]
        grid = np.concatenate(grid + [np.radians(np.geomspace(0.002, 0.2, 24))] * whole)
        # Nothing that is held or flown rotates faster.
        fast = np.percentile(np.linalg.norm(raw, axis=1), 95) * grid > np.radians(FASTEST)
        turning, fits = raw - self._quiet_mean(raw), {}
        for kind in [kind for kind in self.raw if kind != "gyroscope"]:
            # A constant part of the field belongs to the instrument, not to the Earth.
            vector = self.raw[kind] - (_centre(self.raw[kind]) if kind == "magnetometer" else 0)
            # A vector whose direction hardly changes excludes no axes.
            ways = vector / np.maximum(np.linalg.norm(vector, axis=1, keepdims=True), 1e-12)
            if np.ptp(np.percentile(ways, (5, 95), axis=0), axis=0).max() < 0.15:
                continue
            scales = grid if fast.all() else grid[~fast]
            rough = fit_axes(self.time, turning, vector, scales, longest=12.0)
            finer = rough.scale * np.geomspace(0.8, 1.25, 9)
            choices = [
                fit_axes(self.time, turning, vector, finer, seconds) for seconds in (0.3, 0.6, 1.2)
            ]
            fit = max(choices, key=lambda fit: fit.margin)
            # A poor fit, disturbed by pushes as on a foot, or by iron, must not decide by a small
            # margin.
            if fit.margin > 2 or fit.shares.min() < 0.35:
                fits[kind] = fit
        fit = fits.get("accelerometer")
        if fit is None or fit.margin <= 1.2:
            fit = max(fits.values(), key=lambda fit: fit.margin, default=None)
        names = {scale: unit for unit, scale in DEGREES.items()}
        if fit is not None and fit.margin > 1.12:
            unit = min(DEGREES.values(), key=lambda scale: abs(np.log(fit.scale / scale)))
            ratio = fit.scale / unit
            counts = whole and (not said or DEGREES[said] != unit or abs(ratio - 1) > 0.2)
            if counts and abs(ratio - 1) > 0.04 or not 0.4 < ratio < 2.5:
                unit, self.counts = fit.scale, True
            elif said and DEGREES[said] != unit:
                self.say(
                    "unit of the gyroscope",
                    RED,
                    f"its rotations agree with the other sensors only in {names[unit]}, but its "
                    f"heading says {said}",
                    {"scale": round(fit.scale, 5)},
                    f"Read it as {names[unit]}.",
                )
            else:
                self.say(
                    "unit of the gyroscope", GREEN, names[unit], {"scale": round(fit.scale, 5)}
                )
        elif not said:
            return self.say(
                "unit of the gyroscope",
                UNKNOWN,
                "no heading gives the unit, and the rotations do not determine it",
                {},
                "Give the unit, such as --columns 'gyroscope=2-4:deg/s', or rotate the instrument "
                "about all its axes.",
            )
        else:
            unit = DEGREES[said]
            self.say(
                "unit of the gyroscope",
                UNKNOWN,
                f"{names[unit]} according to its heading, which its rotations neither confirm nor "
                "refute",
                {},
                "Rotate the instrument about all its axes.",
            )
        self.facts["unit of the gyroscope"] = unit
        most = float(np.degrees(np.percentile(np.linalg.norm(raw, axis=1), 95) * unit))
        if most > FASTEST:
            self.say(
                "size of the gyroscope",
                RED,
                f"one value in twenty is above {most:.2g} °/s: nothing hand-held or "
                "airborne rotates that fast",
                {},
                "Are these the wrong columns, or is the unit wrong?",
            )
        self._axes(fits, raw * unit)

    def _pushed(self) -> bool:
        """Check whether pushes are nearly as large as gravity, as on a walking foot."""
        lengths = np.linalg.norm(self.raw["accelerometer"], axis=1)
        return bool(lengths.std() > 0.6 * np.median(lengths))

    def _saturation(self, kind: str) -> None:
        """Report a sensor that stays at its largest value, as if driven out of its range."""
        raw = self.raw[kind]
        for letter, column in zip("xyz", raw.T):
            for end, where in ((column.max(), "above"), (column.min(), "below")):
                away = np.abs(column - end)
                flat = away <= 1e-4 * np.abs(end)
                lasting = int((flat[1:] & flat[:-1]).sum())
                # The peak of a smooth curve is flat too, but it leaves its largest value gradually.
                first, last = ~flat[:-1] & flat[1:], flat[:-1] & ~flat[1:]
                beside = np.concatenate([away[:-1][first], away[1:][last]])
                if not beside.size or np.median(beside) < 1e-3 * np.abs(end):
                    continue
                # Values of a coarse instrument repeat as well, but then so do the neighbouring
                # values.
                others = np.unique(away[~flat], return_counts=True)[1]
                if lasting >= 4 and others.size and flat.sum() > 5 * others[:3].max():
                    return self.say(
                        f"range of the {kind}",
                        RED,
                        f"{letter} stays at {end:.6g} for {lasting + 1} samples: readings "
                        f"{where} this were clipped",
                        {"samples": lasting + 1},
                        "Choose a larger range: no correction can restore what was clipped.",
                    )

    def _cut_off(self, kind: str) -> bool:
        return any(verdict.about == f"range of the {kind}" for verdict in self.verdicts)

    def _quiet_mean(self, raw: Array) -> Array:
        """Return a gyroscope's mean where it varies least, or zeros if it always varies."""
        size = max(12, round(0.5 / max(np.median(np.diff(self.time)), 1e-6)))
        count = len(raw) // size
        blocks = raw[: count * size].reshape(count, size, 3)
        spread = blocks.std(axis=1).mean(axis=1)
        if count < 4 or spread.min() > 0.15 * np.percentile(spread, 80):
            return np.zeros(3)
        return blocks[spread.argmin()].mean(axis=0)

    def _axes(self, fits: Mapping[str, Fit], rates: Array) -> None:
        """Bring the gyroscope into the accelerometer's axes, if they differ."""
        fit, field, plain = fits.get("accelerometer"), fits.get("magnetometer"), np.eye(3)
        best, whose, words = None, "accelerometer", "those of the accelerometer"
        if fit is None and field is not None:
            fit, whose, words = (
                field,
                "magnetometer",
                ("those of the magnetometer; gravity does not determine them"),
            )
        near = np.flatnonzero(fit.shares <= BELIEVED * fit.shares.min()) if fit is not None else []
        if fit is not None and fit.margin > BELIEVED:
            best = fit.best
            agree = field is not None and field.margin > BELIEVED and fit is not field
            if agree and np.allclose(field.best, plain) and not np.allclose(best, plain):
                # The other two agree, so the accelerometer's axes differ or are all reversed.
                back = min(best.T, -best.T, key=lambda axes: (axes < 0).sum())
                self.say(
                    "axes of the accelerometer",
                    RED,
                    "the gyroscope and magnetometer agree; along their axes the accelerometer "
                    f"measures {written(back)}, or the opposite",
                    {},
                    f"Use ({written(back)}) of the accelerometer as its x, y, z, or the opposite.",
                )
                self.raw["accelerometer"] = self.raw["accelerometer"] @ back.T
                best = plain
        elif field is not None and field.margin > BELIEVED and field.shares.argmin() in near:
            best = field.best
            words += (
                f"; gravity alone leaves {len(near)} assignments, and the magnetic field decides "
                "between them"
            )
        if best is not None:
            if not np.allclose(best, plain):
                mirrored = "; one of the two is left-handed" * bool(np.linalg.det(best) < 0)
                words = f"along the {whose}'s axes it measures {written(best)}{mirrored}"
            self.say(
                "axes of the gyroscope",
                GREEN if np.allclose(best, plain) else RED,
                words,
                {},
                f"Use ({written(best)}) of the gyroscope as its x, y, z.",
            )
            self.facts["axes of the gyroscope"] = best
            rates = rates @ best.T
        elif len(self.raw) > 1:
            ways = [written(ASSIGNMENTS[k]) for k in sorted(near, key=lambda k: fit.shares[k])]
            self.say(
                "axes of the gyroscope",
                UNKNOWN,
                "nothing determines them: the instrument rotates too little, or its acceleration "
                "hides gravity"
                if fit is None or len(ways) > FEW
                else f"{len(ways)} assignments fit nearly as well: {'; '.join(ways)}",
                {} if fit is None else {"margin": round(fit.margin, 2)},
                "Rotate the instrument slowly about all three axes.",
            )
        self.rates, self.still = rates, stretches(self.time, rates)

    def scale_and_bias(self) -> None:
        """Find the gyroscope's scale and bias from gravity by the corrected accelerometer."""
        if self.rates is None:
            return
        lying = [stretch for stretch in self.still if stretch.still]
        scale, bias, spread, fitted = 1.0, None, None, None
        if lying:
            between = [(self.time[stretch.first], self.time[stretch.last - 1]) for stretch in lying]
            told = ", ".join(f"{first:.1f} to {last:.1f} s" for first, last in between[:6])
            deviation = np.median([stretch.deviation for stretch in lying])
            self.say(
                "stillness",
                GREEN,
                f"it lies still from {told}: its gyroscope shows only white noise there",
                {
                    "stretches": len(lying),
                    "seconds": round(float(np.diff(between).sum()), 2),
                    "deviation (°/s)": round(float(np.degrees(deviation)), 3),
                },
            )
            bias, spread = self._resting(lying)
            self._noise(max(lying, key=lambda stretch: stretch.last - stretch.first))
        elif self.still:
            calmest = min(self.still, key=lambda stretch: stretch.deviation)
            first, last = self.time[[calmest.first, calmest.last - 1]]
            self.say(
                "stillness",
                YELLOW,
                f"it is never still. From {first:.1f} to {last:.1f} s it is held: it wavers by "
                f"{np.degrees(calmest.deviation):.1f} °/s, slowly, as a hand does",
                {"deviation (°/s)": round(float(np.degrees(calmest.deviation)), 2)},
                "A mean over that time would be motion, not bias. Lay the instrument down for a "
                "few seconds.",
            )
        else:
            self.say(
                "stillness", UNKNOWN, "it moves all the time", {}, "Lay it down for a few seconds."
            )
        poses = [stretch for stretch in self.still if stretch.last - stretch.first > 10]
        # Repeated rests show whether the bias drifts; otherwise gravity may show it.
        at_rest = len(lying) > 1 and lying[-1].last - lying[0].first > len(self.time) / 2
        drift = self._drift_at_rest(lying, bias) if at_rest else np.zeros(3)
        drifting = bool(drift.any())
        if self.forces is not None:
            fitted = fit_scales(self.time, self.rates - drift, self.forces, poses, bias)
        constant = fitted
        if fitted is not None and len(poses) > 4 and not at_rest:
            fitted, drifting = self._drift_between(poses, lying, bias, fitted)
        if fitted is None:
            self.say(
                "scale of the gyroscope",
                UNKNOWN,
                f"{number_of(len(poses), 'nearly still pose')}: "
                f"{'too few' if len(poses) < 4 else 'too alike'} to track gravity from pose to "
                "pose",
                {},
                "Hold it still in at least four poses, tilted well away from each other.",
            )
        else:
            # A drift is sought only with five or more poses, so fewer cannot exclude it.
            scale = self._scale(
                fitted, constant, poses, drifting or (len(poses) < 5 and not at_rest)
            )
            if bias is None and fitted.common[1] < 0.03 and fitted.left < 0.25:
                bias, spread = fitted.bias, fitted.bias_spreads
        if bias is None:
            self.say(
                "bias of the gyroscope",
                UNKNOWN,
                "the instrument is never still, and its rotations do not determine the bias",
                {},
                "Lay it down for a few seconds.",
            )
        else:
            most, doubt = (float(np.degrees(np.abs(each).max())) for each in (bias, spread))
            light = _light(most, 0.5, 1) if doubt < 0.3 else UNKNOWN
            self.say(
                "bias of the gyroscope",
                light,
                f"{_along(np.degrees(bias))} °/s, ± {doubt:.2g}",
                {"°/s": np.degrees(bias).round(4).tolist()},
                "" if drifting or light == UNKNOWN else f"Subtract {_along(np.degrees(bias))} °/s.",
            )
            self.facts["bias of the gyroscope"] = bias
            self.rates = self.rates - bias
        self.facts["multiplied"], self.rates = scale, self.rates * scale
        if np.any(scale != 1.0):
            self.still = stretches(self.time, self.rates)

    def _resting(self, lying: Sequence[Stretch]) -> tuple[Array, Array]:
        """Return the gyroscope's mean at rest, and the standard deviation of that mean."""
        parts = np.concatenate([self.rates[stretch.first : stretch.last] for stretch in lying])
        return parts.mean(axis=0), parts.std(axis=0) / np.sqrt(len(parts))

    def _scale(
        self, fitted: ScaleFit, constant: ScaleFit, poses: Sequence[Stretch], may_drift: bool
    ) -> float | Array:
        """Return the factor to apply to the gyroscope, or 1 if it is not known.

        We trust a separate scale for one axis only if it does not depend on whether the bias may
        drift.
        """
        (common, uncertain), left = fitted.common, fitted.left
        carries = f"its rotations track gravity through {number_of(len(poses), 'pose')}"
        self.facts["scale of the gyroscope"] = common
        if self.counts:
            self.facts["unit of the gyroscope"] *= common
            unit = self.facts["unit of the gyroscope"]
            self.say(
                "unit of the gyroscope",
                RED if unit_of_rates(self.content.groups["gyroscope"].names) else YELLOW,
                f"counts, whatever the heading says. One count is {np.degrees(unit):.4g} "
                f"± {np.degrees(uncertain * unit):.1g} °/s, because then {carries}",
                {"rad/s": unit},
                f"Multiply by {np.degrees(unit):.4g} to get °/s.",
            )
            return common
        both = np.array([fitted.scales, constant.scales])
        off = np.abs(both / np.median(both, axis=1, keepdims=True) - 1).min(axis=0)
        odd = np.flatnonzero(off > np.maximum(0.04, 5 * fitted.spreads))
        # A faulty accelerometer bends the path of gravity as well.
        means = [self.forces[pose.first : pose.last].mean(axis=0) for pose in poses]
        doubtful = np.ptp(np.linalg.norm(means, axis=1)) > 0.08 or self._cut_off("gyroscope")
        # With few poses one scale explains nearly anything.
        sure = len(odd) == 1 and len(poses) > 6 and not doubtful
        if sure and left < min(np.radians(3), 0.37 * fitted.left_alike):
            axis, factor = "xyz"[odd[0]], float(fitted.scales[odd[0]])
            self.say(
                "scale of the gyroscope",
                RED,
                f"the {axis} axis needs its own scale, {factor:.3f}: {carries} with an "
                f"error of {np.degrees(left):.1f}°, but {np.degrees(fitted.left_alike):.1f}° "
                "with one scale for all axes",
                {"axis": axis, "scale": round(factor, 4)},
                f"Multiply {axis} by {factor:.3f}.",
            )
            return np.where(np.arange(3) == odd[0], factor, 1.0)
        off = abs(common - 1)
        light = GREEN if off < max(0.02, 3 * uncertain) else _light(off, 0, 0.05)
        # The remainder of a drift after fitting a line looks like a small error of scale.
        rival = may_drift and light == YELLOW
        if rival or doubtful or uncertain > 0.03 or left > np.radians(3):
            light = UNKNOWN
        self.say(
            "scale of the gyroscope",
            light,
            f"{common:.3f} ± {uncertain:.3f}: {carries} with an error of {np.degrees(left):.1f}°",
            {"scale": round(common, 4), "±": round(uncertain, 4), "poses": len(poses)},
            f"Multiply its values by {common:.3f}." if light in (RED, YELLOW) else "",
        )
        return common if light in (RED, YELLOW) else 1.0

    def _drift_at_rest(self, lying: Sequence[Stretch], bias: Array) -> Array:
        """Return the drift of the bias at each time if it differs between rests, or zeros."""
        biases, doubts = np.array([self._resting([stretch]) for stretch in lying]).swapaxes(0, 1)
        middles = [(stretch.first + stretch.last) // 2 for stretch in lying]
        times, warmth = self.time[middles], self.warmth[middles]
        slopes, starts = np.polyfit(times, biases, 1)
        change, doubt = np.abs(slopes) * np.ptp(times), doubts.max(axis=0)
        worst = int(np.argmax(change / doubt))
        if change[worst] < max(8 * doubt[worst], np.radians(0.3)):
            return np.zeros(3)
        follows = np.ptp(warmth) > 2 and abs(np.corrcoef(warmth, biases[:, worst])[0, 1]) > 0.95
        slope = np.polyfit(warmth, biases[:, worst], 1)[0] if follows else None
        ends = [middles[0], middles[-1]]
        self._say_drift(worst, ends, starts[worst] + slopes[worst] * self.time[ends], slope)
        return _at(self.time, times, biases) - bias

    def _drift_between(
        self,
        poses: Sequence[Stretch],
        lying: Sequence[Stretch],
        bias: Array | None,
        constant: ScaleFit,
    ) -> tuple[ScaleFit, bool]:
        """Return scale and bias, with a drift in time or temperature if that fits much better.

        Without it, the drift would be taken for an error of scale. Also return whether the bias
        surely drifts.
        """
        resting = np.concatenate(
            [np.arange(stretch.first, stretch.last) for stretch in lying or poses]
        )
        courses = [
            (values - values[resting].mean()) / np.ptp(values)
            for values in (self.time, self.warmth)
            if np.ptp(values) > 2
        ]
        fits = [
            fit_scales(self.time, self.rates, self.forces, poses, bias, course)
            for course in courses
        ]
        # If both explain it about equally well, prefer temperature, which is a cause; time is not.
        by_warmth = fits[-1].left < 1.25 * fits[0].left
        fit, course = (fits[-1], courses[-1]) if by_warmth else (fits[0], courses[0])
        if fit.left > min(np.radians(1.5), 0.8 * constant.left):
            return constant, False
        worst = int(np.argmax(np.abs(fit.drift) / fit.drift_spreads))
        line = fit.bias + fit.drift * course[:, None]
        at_rest = [
            self._resting([stretch])[0] - line[(stretch.first + stretch.last) // 2]
            for stretch in lying[1:]
        ]
        if np.abs(at_rest).max(initial=0) > 0.3 * abs(fit.drift[worst]):
            return constant, False
        # With few poses a drift explains nearly anything.
        if len(poses) < 7 or abs(fit.drift[worst]) < max(
            7 * fit.drift_spreads[worst], np.radians(1)
        ):
            return fit, False
        slope = fit.drift[worst] / np.ptp(self.warmth) if len(fits) > 1 and by_warmth else None
        ends = [0, -1]
        self._say_drift(worst, ends, line[ends, worst], slope)
        return fit, True

    def _say_drift(self, axis: int, samples: list[int], biases: Array, slope: float | None) -> None:
        """Report the bias about an axis at two samples, and its change per degree Celsius."""
        ends = zip(np.degrees(biases), self.time[samples], self.warmth[samples], strict=True)
        (bias, time, warmth), (other, later, warmer) = ends
        words = (
            f"the bias about {'xyz'[axis]} is {bias:.2f} °/s at {time:.0f} s and {other:.2f} °/s "
            f"at {later:.0f} s"
        )
        advice = "let the filter estimate the bias, or interpolate it between the still stretches."
        if slope is not None:
            words += (
                f". As the temperature goes from {warmth:.0f} to {warmer:.0f} °C, it changes by "
                f"{np.degrees(slope):.2f} °/s per degree"
            )
            advice = (
                "subtract a straight-line fit against temperature, or let the instrument warm up "
                "first."
            )
        self.say(
            "drift of the bias",
            RED,
            words,
            {"°/s": np.degrees(biases).round(3).tolist()},
            f"Subtracting a constant does not correct this: {advice}",
        )

    def _noise(self, longest: Stretch) -> None:
        """Report what the Allan deviation of the longest still stretch shows."""
        step = float(np.median(np.diff(self.time)))
        rates = np.degrees(self.rates[longest.first : longest.last])
        self.facts["Allan deviation"] = allan_deviation(rates, step)
        noise, seconds = noise_of(*self.facts["Allan deviation"]), len(rates) * step
        walk = float(noise.angle_random_walk.max())
        if np.isnan(walk):
            return self.say(
                "noise of the gyroscope",
                UNKNOWN,
                f"it lies still for only {seconds:.0f} s, which is too short to separate white "
                "noise from other noise",
                {},
                "Let it lie still for a few minutes.",
            )
        words = f"angle random walk {walk:.2g} °/√s, {60 * walk:.2g} °/√h"
        evidence = {"°/√s": noise.angle_random_walk.round(4).tolist()}
        if np.isnan(noise.bias_instability).all():
            words += f"; {seconds:.0f} s is too short to measure its bias instability"
        else:
            worst = int(np.nanargmax(noise.bias_instability))
            words += (
                f"; bias instability {noise.bias_instability[worst]:.2g} °/s, at "
                f"{noise.time[worst]:.2g} s"
            )
            evidence["bias instability (°/s)"] = noise.bias_instability.round(5).tolist()
        self.say("noise of the gyroscope", GREEN, words, evidence)

    # --- the accelerometer ----------------------------------------------------------------------

    def accelerometer(self) -> None:
        if "accelerometer" not in self.raw:
            return self._missing("accelerometer")
        raw = self.raw["accelerometer"]
        self._saturation("accelerometer")
        quiet = [raw[pose.first : pose.last] for pose in self.still] or [raw]
        unit, gravity, off = unit_of_gravity(np.concatenate(quiet))
        said = unit_in_brackets(self.content.groups["accelerometer"].names[0])
        wrong = bool(said) and abs(np.log(GRAVITY[said] / gravity)) > 0.2
        light, why = YELLOW if unit.startswith("counts") else GREEN, "judging by gravity"
        if wrong and not self.still and self._pushed():
            unit, gravity, light = said, GRAVITY[said], UNKNOWN
            why = (
                "according to its heading; it is never still, and its acceleration hides the "
                "strength of gravity"
            )
        elif wrong:
            light, why = RED, f"judging by gravity, but its heading says {said}"
        self.facts["gravity"], self.forces = gravity, raw / gravity
        advice = {RED: f"Read it as {unit}.", UNKNOWN: "Lay it down for a few seconds."}
        self.say(
            "unit of the accelerometer",
            light,
            f"{unit}, {why}",
            {"off": round(off, 4)},
            advice.get(light, ""),
        )
        # A hand that holds the instrument also pushes it, so prefer the poses at rest.
        for poses in ([pose for pose in self.still if pose.still], self.still):
            means = np.array([self.forces[pose.first : pose.last].mean(axis=0) for pose in poses])
            if len(means) > 5 and np.linalg.matrix_rank(means, tol=0.5) == 3:
                break
        else:
            return self.say(
                "accelerometer",
                UNKNOWN,
                f"{number_of(len(means), 'nearly still pose')}: too few or too alike to "
                "separate offset and scale",
                {},
                "Hold it still in nine poses, each tilted a different way.",
            )
        lengths = np.linalg.norm(means, axis=1)
        uneven, spread, advice = float(np.ptp(lengths)), float(np.std(lengths)), ""
        light = YELLOW if uneven > 0.04 else GREEN
        words = (
            f"gravity measures {lengths.min():.3f} to {lengths.max():.3f} g in "
            f"{number_of(len(means), 'pose')}"
        )
        name, offset, scales, left = uneven_lengths(means)
        if light == YELLOW and self._cut_off("accelerometer"):
            words += ", which clipping explains"
        elif light == YELLOW and left >= 0.5 * spread:
            light, advice, words = (
                UNKNOWN,
                "Lay it down in nine poses, each tilted a different way.",
                f"{words}. No offset or scale explains that; the hand that holds it may be the "
                "cause",
            )
        elif light == YELLOW:
            words += (
                f". {name} would reduce their standard deviation from {spread:.3f} to {left:.3f}, "
                "as poses left out of the fit confirm"
            )
            light, by = RED if uneven > 0.08 else YELLOW, offset * gravity
            subtract = [f"{by[k]:.3g} from {'xyz'[k]}" for k in np.flatnonzero(offset)]
            divide = [f"{'xyz'[k]} by {scales[k]:.3f}" for k in np.flatnonzero(scales != 1)]
            what = (("Subtract", subtract), ("Divide", divide))
            advice = "; ".join(f"{verb} {', '.join(each)}" for verb, each in what if each) + "."
            self.forces = (self.forces - offset) / scales
            self.facts |= {"offset of the accelerometer": by, "scales of the accelerometer": scales}
        self.say("accelerometer", light, words, {"lengths": lengths.round(3).tolist()[:12]}, advice)

    # --- the magnetometer -----------------------------------------------------------------------

    def magnetometer(self) -> None:
        if "magnetometer" not in self.raw:
            return
        raw = self.raw["magnetometer"]
        fit = fit_field(self.time, self.rates, raw) if self.rates is not None else None
        by_lengths, known = fit is None or not fit.uncertainty < 0.3, ""
        if by_lengths:
            if fit is not None:
                off = np.degrees(min(fit.uncertainty, 3))
                known = f": a direction would be uncertain by {off:.0f}°"
            fit = _by_lengths(raw)
        usual = float(np.median(np.linalg.norm(raw, axis=1)))
        length = usual if fit is None else fit.strength
        words = f"{unit_of_field(length)}: the strength of the field is {length:.3g}"
        self.say("unit of the magnetometer", GREEN, words, {"length": round(length, 3)})
        self.field, self.facts["strength of the field"] = raw / usual, usual
        before, dips = self._unevenness(self.field), self._dips(raw)
        uneven, useless, about = before, fit is None, "offset of the magnetometer"
        if fit is None:
            words = f"neither rotations nor lengths determine the offset and the shape{known}"
            advice = "Rotate it slowly through all directions, in a figure of eight."
            self.say(about, UNKNOWN, words, {}, advice)
        else:
            corrected = fit.corrected(raw) / fit.strength
            uneven_then, dips_then = self._unevenness(corrected), self._dips(corrected)
            # Neither lengths nor dips were used in the fit, so a correction must improve them to
            # count.
            useless = bool(dips and dips_then and dips_then[1] > 1.2 * dips[1] + 0.5)
            if not useless and uneven_then <= 0.8 * before + 0.01:
                self.field, uneven, dips = corrected, uneven_then, dips_then
                self._corrected_field(fit, by_lengths)
            elif before < 0.06 and not (dips and dips[1] > 6):
                self.say(about, GREEN, "none detectable: no correction makes the field steadier")
            else:
                words = (
                    f"the correction that fits best changes the spread of the dip from "
                    f"{dips[1]:.1f}° to {dips_then[1]:.1f}°"
                    if useless
                    else f"the length varies by {before:.0%}, and by {uneven_then:.0%} with the "
                    "correction that fits best"
                )
                advice = "Rotate it slowly through all directions, far from iron."
                self.say(about, UNKNOWN, f"{words}, so it is not applied", {}, advice)
        # The length depends on the field alone; the dip may also vary with a faulty accelerometer.
        worst = max(uneven, dips[1] / 100 if dips else 0)
        light = YELLOW if useless and worst > 0.06 else _light(worst, 0.06, 0.12)
        words = f"its length varies by {uneven:.0%}" + (
            f", and its dip by {dips[1]:.0f}° around {dips[0]:.0f}°" if dips else ""
        )
        evidence = {"length varied by": round(before, 3), "corrected by": round(uneven, 3)}
        cause = (
            "The cause is iron that moves with the instrument, or iron that it passed, and the "
            "rotations do not show which. Do not use the field, or record a figure of eight far "
            "from iron."
            if useless
            else "There was iron nearby for a while: do not use the field there."
        )
        if light != GREEN:
            self._leave_open((YELLOW,), "changing field")
        self.say("field", light, words, evidence, cause if uneven > 0.06 else "")
        if dips and dips[0] < -5 and not any("axes" in about for about in self._trouble()):
            self.say(
                "signs",
                UNKNOWN,
                f"the field points up, out of the ground, by {-dips[0]:.0f}°, as it does only "
                "south of the magnetic equator",
                {},
                "If you recorded north of it, all three signs of the accelerometer (as in iPhones) "
                "or of the magnetometer are reversed.",
            )

    def _corrected_field(self, fit: FieldFit, by_lengths: bool) -> None:
        """Report axes, offset and shape of a fit that makes the field steadier."""
        nearest = ASSIGNMENTS[np.argmax(np.einsum("kij,ij->k", ASSIGNMENTS, fit.axes))]
        same, axes, advice = np.eye(3), written(nearest), ""
        if "accelerometer" not in self.raw:
            same = self.facts.get("axes of the gyroscope", same)
        if by_lengths:
            light, words = UNKNOWN, "fitted by length alone, which does not determine its axes"
            advice = "Rotate it slowly about all three axes."
        elif np.allclose(nearest, same) or np.allclose(nearest, -same):
            light, words = GREEN, "those of the others, or all three opposite"
        else:
            light, words = RED, f"along the axes of the others it measures {axes}, or the opposite"
            advice = f"Use ({axes}) of the magnetometer as its x, y, z, or the opposite."
        self.say("axes of the magnetometer", light, words, {}, advice)
        self.facts |= {
            "offset of the magnetometer": fit.offset,
            "shape of the magnetometer": fit.shape,
            "strength of the field": fit.strength,
        }
        hard = float(np.linalg.norm(fit.offset) / fit.strength)
        rows = "; ".join(" ".join(f"{entry:.3f}" for entry in row) for row in fit.shape)
        for about, size, worst, worse, words, evidence, advice in (
            (
                "offset of the magnetometer",
                hard,
                0.1,
                0.05,
                f"{_along(fit.offset)}, {hard:.0%} of the field: directions are wrong by up to "
                f"{np.degrees(np.arcsin(min(1, hard))):.0f}°",
                {"offset": fit.offset.round(3).tolist()},
                f"Subtract {_along(fit.offset)}.",
            ),
            (
                "shape of the magnetometer",
                fit.stretch - 1,
                0.12,
                0.1,
                f"the longest axis is {fit.stretch:.2f} times the shortest",
                {"matrix": fit.shape.round(3).tolist()},
                f"Then multiply by the matrix {rows}.",
            ),
        ):
            light = _light(size, worse, worst + 2 * fit.uncertainty)
            known = light == RED or fit.uncertainty < 0.1
            advice = "" if light == GREEN else advice
            self.say(about, light if known else UNKNOWN, words, evidence, advice)

    def _unevenness(self, field: Array) -> float:
        """Return how much a field's length varies between seconds, without the extremes."""
        own = np.linalg.norm(field, axis=1)
        per_second = max(10, round(1 / np.median(np.diff(self.time))))
        smooth = [np.median(part) for part in np.array_split(own, max(4, len(own) // per_second))]
        return float(np.percentile(smooth, 97) - np.percentile(smooth, 3))

    def _dips(self, values: Array) -> tuple[float, float] | None:
        """Return the median dip of a field in the still poses and its variation, in degrees."""
        if self.forces is None or len(self.still) < 3 or self._cut_off("accelerometer"):
            return None
        ups, fields = (
            np.array([each[pose.first : pose.last].mean(axis=0) for pose in self.still])
            for each in (self.forces, values)
        )
        sizes = np.linalg.norm(ups, axis=1) * np.linalg.norm(fields, axis=1)
        dips = np.degrees(np.arcsin(np.clip(-(ups * fields).sum(axis=1) / sizes, -1, 1)))
        return float(np.median(dips)), float(np.percentile(dips, 95) - np.percentile(dips, 5))

    def _trouble(self) -> set[str]:
        return {verdict.about for verdict in self.verdicts if verdict.light == RED}

    # --- whether all look at the same moment ----------------------------------------------------

    def timing(self) -> None:
        """Report delays between the sensors, and samples missing although time was counted on."""
        if self._cut_off("gyroscope"):
            self._leave_open((RED, YELLOW), "clipped rotations")
        steps = np.diff(self.time)
        step = float(np.median(steps))
        if self.rates is None or self.content.counted or len(self.time) * step < 3:
            return
        seen = [kind for kind in self.raw if kind != "gyroscope"]
        leaps = np.all([_leaps(self.rates, self.raw[kind], step) for kind in seen], axis=0)
        # A few leaps are gaps; many are another fault, in the unit or the axes. A clock with
        # unequal steps measures time rather than counting it on. With wrong axes, gravity or field
        # leaps in every rotation.
        along = len(seen) > 1 and not any("axes" in about for about in self._trouble())
        counted_on = np.ptp(steps) < 0.02 * step and along and not self._pushed()
        if counted_on and 0 < leaps.mean() < 0.02:
            self._leave_open((RED, YELLOW), "missing samples")
            return self.say(
                "missing samples",
                RED,
                f"at {number_of(int(leaps.sum()), 'place')}, the first at "
                f"{self.time[1:][leaps][0]:.2f} s, gravity and field jump further than a rotation "
                "between two samples could take them: samples are missing there, although the "
                "times continue as if none were",
                {"places": int(leaps.sum())},
                "Record the instrument's own time with each sample: no filter can reconstruct what "
                "was lost.",
            )
        # Data that do not determine the axes do not determine a delay.
        if "axes of the gyroscope" not in self.facts or "magnetometer" not in self.raw:
            return
        # Without correction, the shape of a magnetometer may look like a delay.
        (lag, _), kind = lag_of(self.rates, self.field, step), "magnetometer"
        if abs(lag) < max(2, round(0.03 / step)):
            return
        # A push that comes with each rotation looks like a delay of the accelerometer, which is
        # therefore used only to decide which of the other two is late. It is rare for one to be
        # early.
        if "accelerometer" in self.raw:
            _, by_lag = lag_of(self.rates, self.raw["accelerometer"], step)
            middle = len(by_lag) // 2
            if by_lag[middle + lag] < (1.03 if lag < 0 else 0.97) * by_lag[middle]:
                kind, lag = "gyroscope", -lag
        self.say(
            f"delay of the {kind}",
            RED,
            f"its values fit the rotations of the {'others' if len(seen) > 1 else 'gyroscope'} "
            f"best when shifted {1000 * abs(lag) * step:.0f} ms "
            f"{'earlier' if lag > 0 else 'later'}: it is {'late' if lag > 0 else 'early'}",
            {"seconds": round(lag * step, 3)},
            f"First of all, shift its times {'back' if lag > 0 else 'forward'} by that much.",
        )
        self._leave_open((RED, YELLOW), "wrong times")

    def _leave_open(self, lights: Sequence[str], cause: str) -> None:
        """Retract what was fitted to the magnetometer if another fault may have caused it."""
        for place, verdict in enumerate(self.verdicts):
            if verdict.about in OF_THE_FIELD and verdict.light in lights:
                words = f"{verdict.words}, which the {cause} may have caused"
                self.verdicts[place] = Verdict(
                    verdict.about, UNKNOWN, words, {}, "Examine it again once that is corrected."
                )
                self.facts.pop(verdict.about, None)

    # --- the orientation ------------------------------------------------------------------------

    def orientation(self) -> None:
        groups = self.content.groups
        if self.rates is None:
            return
        for kind in ("quaternion", "angles"):
            if kind not in groups:
                continue
            group = groups[kind]
            candidates = (
                _angle_readings(group)
                if kind == "angles"
                else {
                    order: dcm_of_quaternions(group.values, order)
                    for order in ("scalar first", "scalar last")
                }
            )
            if ways := readings(self.time, self.rates, group.time, candidates):
                self._reading(kind, group, candidates, ways)
            else:
                self.say(
                    kind,
                    UNKNOWN,
                    "it rotates too little to be compared with the gyroscope",
                    {},
                    "Rotate it about all its axes.",
                )

    def _reading(
        self,
        kind: str,
        group: Group,
        candidates: Mapping[str, Array],
        ways: Sequence[Reading],
    ) -> None:
        best = ways[0].disagreement
        equal = [way for way in ways if way.disagreement < best * 1.02 + 0.003]
        other = next((way for way in ways if way.disagreement > best * 1.02 + 0.003), ways[-1])
        leans = [self._lean(group.time, _matrices(candidates, way)) for way in equal]
        # In all programs an axis of the ground points up.
        level = [k for k, (lean, _) in enumerate(leans) if lean < min(leans)[0] + 0.02]
        level = [k for k in level if leans[k][1].endswith("z")] or level
        reading, (lean, axis) = equal[level[0]], leans[level[0]]
        words = f"{reading.order}; " + (
            "ground from body, the inverse of this book's convention"
            if reading.conjugate
            else "body from ground, as in this book"
        )
        if not np.allclose(reading.mounting, np.eye(3)):
            words += f"; its body's x, y, z are the gyroscope's {written(reading.mounting)}"
        lean = float(np.degrees(np.arccos(min(1, 1 - lean))))
        evidence = {
            "disagreement": round(best, 3),
            "next": round(other.disagreement, 3),
            "equal readings": len(level),
        } | ({"up along the ground's axes": f"{axis}, to {lean:.1f}°"} if axis else {})
        self.facts[f"convention of the {kind}"] = reading
        letters = [name.strip().lower().rstrip(")]").split("(")[0][-1:] for name in group.names]
        named = "".join(letter for letter in letters if letter in "wxyz")
        says = {"wxyz": "scalar first", "xyzw": "scalar last"}.get(named, reading.order)
        light, advice = GREEN, ""
        if kind == "quaternion" and says != reading.order:
            words += f". But its headings say {says}"
            light, advice = RED, f"Read it {reading.order}: its headings say {says}."
        if best > 0.6 and self.facts.get("bias of the gyroscope") is not None:
            light, advice = (
                RED,
                "It does not follow the gyroscope: is it from another instrument, or delayed?",
            )
        elif best > 0.6 or other.disagreement < best * 1.2:
            light, advice = UNKNOWN, ""
        self.say(kind, light, words, evidence, advice)
        if light != UNKNOWN and self.oriented is None:
            self.oriented = (group.time, _matrices(candidates, reading))
        if axis:
            advice = "" if lean < 3 else "Was it zeroed while it was not level? "
            if axis.startswith("-"):
                advice += (
                    "Either the ground's axis points down, or the accelerometer's signs are "
                    "reversed, as in iPhones. In the second case, change the signs."
                )
            words = f"up is {lean:.1f}° away from the ground's {axis} axis"
            light = YELLOW if advice else GREEN
            self.say("level", light, words, {"°": round(lean, 2)}, advice)

    def _lean(self, time: Array, matrices: Array) -> tuple[float, str]:
        """Return how far the cosine between up and the ground's nearest axis is below 1.

        Also return the name of that axis; without an accelerometer, return 0 and an empty name.
        """
        if self.forces is None:
            return 0.0, ""
        forces = _at(time, self.time, self.forces)
        ups = np.einsum("nji,nj->ni", matrices, forces)
        calm = np.abs(np.linalg.norm(forces, axis=1) - 1) < 0.1
        up = np.median(ups[calm] if calm.sum() > 10 else ups, axis=0)
        up = up / max(np.linalg.norm(up), 1e-9)
        axis = int(np.abs(up).argmax())
        return float(1 - abs(up[axis])), "-" * bool(up[axis] < 0) + "xyz"[axis]

    # --- the filter -----------------------------------------------------------------------------

    def filter(self, progress: Callable[[float], None] | None) -> None:
        if self.time[-1] - self.time[0] < 1 or len(self.time) < 20:
            return self.say(
                "filter",
                UNKNOWN,
                f"{len(self.time)} samples in {self.time[-1]:.2g} s are not enough to judge it",
            )
        if self.rates is None or self.forces is None or self.content.counted:
            return self.say(
                "filter",
                UNKNOWN,
                "it needs a gyroscope whose unit is known, an accelerometer, and a clock",
            )
        trouble = self._trouble()
        field = None if "field" in trouble else self.field
        lying = [stretch for stretch in self.still if stretch.still]
        inputs = filter_inputs(
            self.time, self.rates, self.forces, field, lying, _parts_to_judge(self.time, self.rates)
        )
        for number, given in enumerate(inputs):
            shown = progress and (lambda share, done=number: progress((done + share) / len(inputs)))
            self.judgements.append(judge(given, shown))
        runs = self.judgements
        where = ", ".join(f"{run.times[0]:.0f} to {run.times[-1]:.0f} s" for run in runs)
        claimed, differ = _rms([(run.claimed, run.found) for run in runs])
        heading = _rms([run.heading for run in runs]) if runs[0].heading else None
        words = (
            f"from {where} it claims to know the tilt to {claimed:.2f}°, and its forward and "
            f"backward runs differ by {differ:.2f}°; "
        ) + (
            "gravity alone gives it no heading"
            if heading is None
            else f"for the heading these are {heading[0]:.2f}° and {heading[1]:.2f}°"
        )
        squares = {
            name: float(np.mean([run.squares[name] for run in runs])) for name in runs[0].squares
        }
        # The errors of tilt and heading between the runs, and those of each sensor.
        pairs = ((claimed, differ), *(() if heading is None else (heading,)))
        times = [
            *(difference / max(own, 1e-6) for own, difference in pairs),
            *np.sqrt([*squares.values()]),
        ]
        light, advice = _light(max(times), 3, 5), ""
        if light == RED:
            advice = f"Its errors are {max(times):.0f} times what it claims. " + (
                f"First correct what is wrong above: {', '.join(sorted(trouble))}."
                if trouble
                else "First rule out lost samples, delays and a wrong clock; only then raise its "
                "noise."
            )
        doubtful = [
            verdict.about
            for verdict in self.verdicts
            if verdict.light != GREEN
            and re.search("(offset|shape|axes|delay) of the magn|field|signs", verdict.about)
        ]
        if heading is not None and (doubtful or max(heading) > 20):
            light = YELLOW if light == GREEN else light
            advice += " Do not use its heading, which may be wrong by up to 180°: " + (
                f"first settle {', '.join(doubtful)}." if doubtful else "it is too uncertain."
            )
        evidence = {
            "claimed (°)": round(float(claimed), 3),
            "found (°)": round(float(differ), 3),
            "innovations": {name: round(square, 2) for name, square in squares.items()},
        }
        self.say("filter", light, words, evidence, advice)


def _light(size: float, look: float, wrong: float) -> str:
    """Return the light for a fault of this size."""
    return RED if size > wrong else YELLOW if size > look else GREEN


def _rms(values: Sequence[Sequence[float]]) -> Array:
    """Return root mean squares of columns."""
    return np.sqrt(np.mean(np.square(values), axis=0))


def lag_of(rates: Array, vectors: Array, step: float) -> tuple[int, Array]:
    """Return how many samples later than the rotations the vectors fixed in the world are.

    With a constant ``c`` that belongs to the instrument, ``dm/dt = -w x (m - c)``.

    Returns
    -------
    lag, and sums of squares of shape ``(2 * most + 1,)``
        The lag is 0 if no delay is evident. The sums are residuals for each delay, from 0.4 seconds
        early to 0.4 seconds late.
    """
    half, most = max(1, round(0.04 / step)), round(0.4 / step)
    slopes = (vectors[2 * half :] - vectors[: -2 * half]) / (2 * half * step)
    window = np.ones(2 * half + 1) / (2 * half + 1)
    turning, mean = (
        np.stack([np.convolve(column, window, "valid") for column in values.T], axis=1)
        for values in (rates, vectors)
    )
    count, left = len(slopes) - 2 * most, np.empty(2 * most + 1)
    inner = slice(most, most + count)
    for k in range(2 * most + 1):
        w = turning[2 * most - k : 2 * most - k + count]
        rest = slopes[inner] + np.cross(w, mean[inner])
        across = np.cross(w[:, None, :], np.eye(3)).swapaxes(-1, -2).reshape(-1, 3)
        squares, slope = across.T @ across, across.T @ rest.ravel()
        left[k] = np.sum(rest**2) - slope @ np.linalg.solve(squares + 1e-9 * np.eye(3), slope)
    best = int(left.argmin())
    # Neighbours share their noise, so the data are worth only this many independent values.
    clear = left[most] > (1 + 60 / (3 * count / (2 * half))) * left[best]
    clear &= left[best] < 0.6 * np.sum(slopes[inner] ** 2)
    return best - most if clear else 0, left


def _leaps(rates: Array, vectors: Array, step: float) -> Array:
    """Mark where vectors fixed in the world change between samples as no rotation explains."""
    mean = (vectors[1:] + vectors[:-1]) / 2
    left = np.linalg.norm(
        np.diff(vectors, axis=0) + step * np.cross((rates[1:] + rates[:-1]) / 2, mean), axis=1
    )
    return left > np.maximum(8 * np.median(left), 0.06 * np.median(np.linalg.norm(vectors, axis=1)))


def _by_lengths(raw: Array) -> FieldFit | None:
    """Fit a magnetometer's offset and shape to lengths alone, if that is reliable.

    The lengths must improve much, and each four fifths of the recording must give the same offset.
    """
    some = raw[:: max(1, len(raw) // 4000)]
    fit = fit_ellipsoid(some, most=0.05)
    if fit is None or spread_of_lengths(fit.corrected(raw)) > 0.7 * spread_of_lengths(raw) + 0.01:
        return None
    for fifth in np.array_split(np.arange(len(some)), 5):
        again = fit_ellipsoid(np.delete(some, fifth, axis=0))
        if again is None or np.linalg.norm(again.offset - fit.offset) > 0.05 * fit.strength:
            return None
    return fit


def _at(time: Array, source: Array, values: Array) -> Array:
    """Interpolate values linearly at other times."""
    if len(source) == len(time) and np.allclose(source, time, atol=1e-9):
        return values
    return np.stack([np.interp(time, source, column) for column in values.T], axis=-1)


def _along(values: Array) -> str:
    """Return three numbers in words.

    >>> _along(np.array([0.5, -2, 0]))
    'x 0.5, y -2, z 0'
    """
    return ", ".join(f"{axis} {value:.3g}" for axis, value in zip("xyz", values, strict=True))


def _centre(field: Array) -> Array:
    """Return a first estimate of a magnetometer's offset, the centre of a sphere, or zero."""
    solution, *_ = np.linalg.lstsq(
        np.concatenate([2 * field, np.ones((len(field), 1))], axis=1),
        (field**2).sum(axis=1),
        rcond=None,
    )
    centre = solution[:3]
    radius = np.sqrt(max(solution[3] + centre @ centre, 0.0))
    spread = np.linalg.norm(field - centre, axis=1)
    # If the values cover only a small part of the sphere, its centre is undetermined.
    return (
        centre
        if np.linalg.eigvalsh(np.cov(((field - centre) / np.maximum(spread, 1e-12)[:, None]).T))[0]
        > 0.03
        and spread.std() < 0.3 * radius
        else np.zeros(3)
    )


def _matrices(candidates: Mapping[str, Array], reading: Reading) -> Array:
    """Return ``B_C_N``, with the body along the gyroscope's axes."""
    dcms = candidates[reading.order]
    return reading.mounting.T @ (dcms.swapaxes(-1, -2) if reading.conjugate else dcms)


def _angle_readings(group: Group) -> dict[str, Array]:
    """Return the orientations that yaw, pitch and roll may mean, by sequence and signs."""
    degrees = np.abs(group.values).max() > 6.5
    values = np.radians(group.values) if degrees else group.values
    candidates, unit = {}, "degrees" if degrees else "radians"
    for sequence, signs in product(
        ("zyx", "zxy", "xyz", "xzy", "yxz", "yzx"),
        ((1, 1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, -1)),
    ):
        names = ["-" * (sign < 0) + name for sign, name in zip(signs, group.names, strict=True)]
        candidates[f"body fixed {sequence} ({', '.join(names)}), {unit}"] = dcm_from_body_fixed(
            values * signs, sequence
        )
    return candidates


def _parts_to_judge(time: Array, rates: Array, longest: float = 60.0) -> list[tuple[int, int]]:
    """Return the ranges to judge a filter on.

    A long recording is judged on its liveliest, calmest and middle parts.
    """
    if time[-1] - time[0] <= longest * 1.5:
        return [(0, len(time))]
    size = int(longest / 2 / np.median(np.diff(time)))
    starts = np.arange(0, len(time) - size, size)
    lively = [np.linalg.norm(rates[start : start + size], axis=1).mean() for start in starts]
    chosen = starts[np.unique(np.argsort(lively)[[0, len(starts) // 2, -1]])]
    return [(int(start), int(start) + size) for start in chosen]
