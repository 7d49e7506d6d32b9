"""The bench: what a recording holds, one question after
another, each answered with its evidence.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from orientation import dcm_from_body_fixed

from .allan import allan_deviation, noise_of
from .content import DEGREES, GRAVITY, places_by_name, read_content, unit_of_field, unit_of_gravity
from .examined import GREEN, RED, UNKNOWN, YELLOW, Examined, Verdict
from .field import FieldFit, fit_ellipsoid, fit_field, uneven_lengths
from .judged import filter_inputs, judge, too_sure
from .motion import (
    ASSIGNMENTS,
    dcm_of_quaternions,
    fit_axes,
    fit_scales,
    readings,
    stretches,
    written,
)

if TYPE_CHECKING:
    from .content import Content, Group
    from .examined import Facts
    from .judged import Judgement
    from .motion import Fit, Reading, ScaleFit, Stretch
    from .table import Array, Source

#: Above this margin the best of 48 assignments is believed.
BELIEVED = 1.3


def examine(
    source: Source,
    name: str | None = None,
    rate: float | None = None,
    columns: str = "",
    judged: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Examined:
    """Put a recording on the bench.

    Parameters
    ----------
    source : path, bytes, str or list of paths
        A table of numbers in any form that :func:`.table.read_tables` takes.
    name : str, optional
        What to call it.
    rate : float, optional
        Samples per second, where the file only counts them.
    columns : str
        What the columns are, where the file does not say it: see
        :func:`~orientation_workbench.recording.content.read_content`.
    judged : bool
        Whether to run the filter, which takes longer than all the rest.
    progress : callable, optional
        Called with the share of the filter's work that is done.

    Returns
    -------
    Examined

    Raises
    ------
    RecordingError
        If the file cannot be read, or holds no instrument.
    """
    content = read_content(source, name, rate, columns)
    bench = _Bench(
        content, name or (str(source) if not isinstance(source, (bytes, list)) else "recording")
    )
    bench.clock()
    bench.gyroscope()
    bench.accelerometer()
    bench.scale_and_bias()
    bench.magnetometer()
    bench.timing()
    bench.orientation()
    if judged:
        bench.filter(progress)
    return bench.examined()


class _Bench:
    """The questions, in the order in which one needs the answers of others."""

    def __init__(self, content: Content, name: str) -> None:
        self.content, self.name = content, name.splitlines()[0][:80] if "\n" in name else name
        self.verdicts: list[Verdict] = []
        self.facts: Facts = {}
        self.judgements: list[Judgement] = []
        self.still: list[Stretch] = []
        groups = content.groups
        first = next(
            groups[kind]
            for kind in ("gyroscope", "accelerometer", "magnetometer")
            if kind in groups
        )
        self.time = first.time
        self.raw = {
            kind: _at(self.time, groups[kind].time, groups[kind].values)
            for kind in ("gyroscope", "accelerometer", "magnetometer")
            if kind in groups
        }
        self.counts = False  # whether the gyroscope's numbers are those of its chip
        self.rates: Array | None = None
        self.forces: Array | None = None
        self.field: Array | None = None
        self.oriented: tuple[Array, Array] | None = None

    def say(
        self,
        about: str,
        light: str,
        words: str,
        evidence: Mapping[str, object] | None = None,
        advice: str = "",
    ) -> None:
        self.verdicts.append(Verdict(about, light, words, dict(evidence or {}), advice))

    # --- what is in it --------------------------------------------------------------------------

    def clock(self) -> None:
        groups, time = self.content.groups, self.time
        for remark in self.content.remarks:
            self.say("rows", YELLOW, remark)
        held = "; ".join(f"{kind}: {', '.join(group.names)}" for kind, group in groups.items())
        unused = f". Not used: {', '.join(self.content.unused)}" if self.content.unused else ""
        self.say("content", GREEN, held + unused)
        for kind, group in groups.items():
            if (
                group.called
                and group.called != kind
                and not (group.called == "angles" and kind == "quaternion")
            ):
                self.say(
                    "headings",
                    RED,
                    f"{', '.join(group.names)} is called {group.called} and behaves like {kind}",
                    {},
                )
        if self.content.counted:
            self.say(
                "time",
                UNKNOWN,
                f"{self.content.clock}: the rate is not known",
                {},
                "Give it: --rate 100.",
            )
            return
        steps = np.diff(time)
        step = float(np.median(steps))
        evidence = {
            "samples": len(time),
            "seconds": round(float(time[-1]), 3),
            "rate": round(1 / step, 2),
        }
        self.say(
            "time",
            GREEN,
            f"{self.content.clock}; {len(time)} samples in {time[-1]:.1f} s, {1 / step:.4g} "
            "per second",
            evidence,
        )
        back = int((steps <= 0).sum())
        long = steps > 2.5 * step
        lost = float(steps[long].sum() / time[-1]) if time[-1] > 0 else 0.0
        evidence = {
            "gaps": int(long.sum()),
            "longest (s)": round(float(steps.max()), 4),
            "share lost": round(lost, 4),
        }
        if back:
            self.say(
                "order of time",
                RED,
                f"time stands still or goes back {back} times",
                {"times": back},
            )
        light = (
            RED
            if lost > 0.02 or steps.max() > max(0.25, 8 * step)
            else YELLOW
            if long.any()
            else GREEN
        )
        words = (
            f"{int(long.sum())} gaps, the longest of {steps.max():.3g} s, {lost:.1%} of the time"
            if long.any()
            else "none"
        )
        self.say(
            "gaps",
            light,
            words,
            evidence,
            "" if light == GREEN else "No filter can know what happened in a gap.",
        )
        every = np.concatenate(list(self.raw.values()), axis=1)
        same = float((np.diff(every, axis=0) == 0).all(axis=1).mean())
        light = RED if same > 0.05 else YELLOW if same > 0.005 else GREEN
        advice = (
            ""
            if light == GREEN
            else "The instrument measures less often than the file says, or rows were filled up."
        )
        self.say(
            "repeated rows",
            light,
            f"{same:.1%} of the rows repeat the one before",
            {"share": round(same, 4)},
            advice,
        )

    # --- the gyroscope --------------------------------------------------------------------------

    def gyroscope(self) -> None:
        if "gyroscope" not in self.raw:
            self.say("gyroscope", UNKNOWN, "there is none in the file")
            return
        group, raw = self.content.groups["gyroscope"], self.raw["gyroscope"]
        self._saturation("gyroscope")
        if self.content.counted:  # of which the clock has asked already
            return
        said = _said_unit(group.names)
        fits, vectors = {}, {}
        for kind in ("accelerometer", "magnetometer"):
            if kind in self.raw:
                vectors[kind] = self.raw[kind]
                # A constant part belongs to the instrument, not to the Earth.
                if kind == "magnetometer":
                    vectors[kind] = vectors[kind] - _centre(vectors[kind])
        whole = bool((raw == raw.round()).all())
        counts = whole and not said
        grid = np.unique(
            np.concatenate([unit * np.geomspace(0.45, 2.3, 8) for unit in DEGREES.values()])
        )
        if whole:  # as a chip has them
            chips = np.radians(np.geomspace(0.002, 0.2, 24))
            grid = chips if counts else np.concatenate([grid, chips])
        still = self._quiet(raw)
        usual = raw[still].mean(axis=0) if still is not None else np.zeros(3)
        for kind, vector in vectors.items():
            rough = fit_axes(self.time, raw - usual, vector, grid, longest=12.0)
            grid_here = rough.scale * np.geomspace(0.8, 1.25, 9)
            choices = [
                fit_axes(self.time, raw - usual, vector, grid_here, seconds)
                for seconds in (0.3, 0.6, 1.2)
            ]
            fits[kind] = max(choices, key=lambda fit: fit.margin)
        fit = max(fits.values(), key=lambda one: one.margin, default=None)
        gravity = fits.get("accelerometer")
        if gravity is not None and gravity.margin > 1.2:
            fit = gravity
        names = {scale: unit for unit, scale in DEGREES.items()}
        if fit is not None and fit.margin > 1.12 and fit.shares.min() < 0.9:
            unit = min(DEGREES.values(), key=lambda one: abs(np.log(fit.scale / one)))
            ratio = fit.scale / unit
            counts = whole and (not said or DEGREES[said] != unit or abs(ratio - 1) > 0.2)
            if counts and abs(ratio - 1) > 0.04 or not 0.4 < ratio < 2.5:
                unit, self.counts = fit.scale, True
            elif said and DEGREES[said] != unit:
                self.say(
                    "unit of the gyroscope",
                    RED,
                    f"its rotations agree with the other sensors only in {names[unit]}; its "
                    f"heading says {said}",
                    {"scale": round(fit.scale, 5)},
                    f"Read it as {names[unit]}.",
                )
            else:
                self.say(
                    "unit of the gyroscope", GREEN, names[unit], {"scale": round(fit.scale, 5)}
                )
        else:
            if not said:
                self.say(
                    "unit of the gyroscope",
                    UNKNOWN,
                    "no heading gives it, and its rotations do not determine it",
                    {},
                    "Give it: --columns 'gyroscope=2-4:deg/s', or rotate it about all its axes.",
                )
                return
            unit = DEGREES[said]
            self.say(
                "unit of the gyroscope",
                UNKNOWN,
                f"{names[unit]} by its heading, which its rotations neither confirm nor refute",
                {},
                "Rotate it about all its axes.",
            )
        self.facts["unit of the gyroscope"] = unit
        most = float(np.degrees(np.percentile(np.linalg.norm(raw, axis=1), 95) * unit))
        if most > 10_000:
            words = (
                f"one value in twenty is above {most:.2g} °/s: nothing that is held or flown "
                "rotates so fast"
            )
            self.say(
                "size of the gyroscope", RED, words, {}, "Is it another column, or another unit?"
            )
        self._axes(fits, raw * unit)

    def _saturation(self, kind: str) -> None:
        """Whether a sensor stays at its largest value, as when driven past its range."""
        raw = self.raw[kind]
        for k, letter in enumerate("xyz"):
            column = raw[:, k]
            for end, where in ((column.max(), "above"), (column.min(), "below")):
                flat = np.abs(column - end) <= 1e-4 * np.abs(end)
                lasting = int((flat[1:] & flat[:-1]).sum())
                # Steps of a coarse instrument pile up as well, but its neighbours do no less.
                others = np.unique(np.abs(column[~flat] - end), return_counts=True)[1]
                if lasting >= 4 and others.size and flat.sum() > 5 * others[:3].max():
                    self.say(
                        f"range of the {kind}",
                        RED,
                        f"{letter} stays at {end:.6g} for {lasting + 1} samples: what was {where} "
                        "that is cut off",
                        {"samples": lasting + 1},
                        "Choose a larger range. No correction can restore what is cut off.",
                    )
                    return

    def _quiet(self, raw: Array) -> slice | None:
        """Samples in which the numbers of a gyroscope vary least, whatever their unit."""
        size = max(12, round(0.5 / max(np.median(np.diff(self.time)), 1e-6)))
        count = len(raw) // size
        if count < 4:
            return None
        spread = raw[: count * size].reshape(count, size, 3).std(axis=1).mean(axis=1)
        if spread.min() > 0.15 * np.percentile(spread, 80):
            return None
        best = int(spread.argmin())
        return slice(best * size, (best + 1) * size)

    def _axes(self, fits: Mapping[str, Fit], rates: Array) -> None:
        """Bring the gyroscope into the axes of the accelerometer, if they
        differ, and find its scale and bias.
        """
        fit, field, plain = fits.get("accelerometer"), fits.get("magnetometer"), np.eye(3)
        best, whose, words = None, "accelerometer", "those of the accelerometer"
        # On a foot pushes drown gravity, which then excludes nothing.
        if fit is not None and field is not None and fit.shares.min() > 0.8:
            fit, whose = field, "magnetometer"
            words = "those of the magnetometer; pushes hide gravity from the accelerometer"
        near = np.flatnonzero(fit.shares <= BELIEVED * fit.shares.min()) if fit is not None else []
        if fit is not None and fit.margin > BELIEVED:
            best = fit.best
            if not np.allclose(best, plain) and field is not None and field.margin > BELIEVED:
                if np.allclose(field.best, plain) and fit is not field:
                    self._odd_accelerometer(best)
                    best = plain
        elif field is not None and field.margin > BELIEVED and field.shares.argmin() in near:
            best = field.best
            words += f"; gravity alone leaves {len(near)} assignments, and the field decides"
        if best is not None:
            if np.allclose(best, plain):
                self.say("axes of the gyroscope", GREEN, words)
            else:
                mirrored = "; one of the two is left-handed" if np.linalg.det(best) < 0 else ""
                self.say(
                    "axes of the gyroscope",
                    RED,
                    f"along the {whose}'s axes it measures {written(best)}{mirrored}",
                    {},
                    f"Use ({written(best)}) of the gyroscope as its x, y, z.",
                )
            self.facts["axes of the gyroscope"] = best
            rates = rates @ best.T
        elif fit is not None:
            ways = [written(ASSIGNMENTS[k]) for k in near[np.argsort(fit.shares[near])]]
            words = f"{len(ways)} assignments fit nearly as well: {'; '.join(ways)}"
            self.say(
                "axes of the gyroscope",
                UNKNOWN,
                "pushes hide gravity, and nothing else determines them"
                if fit.shares.min() > 0.8
                else words,
                {"margin": round(fit.margin, 2)},
                "Rotate the instrument slowly about all three axes.",
            )
        self.rates = rates
        self.still = stretches(self.time, rates)

    def _odd_accelerometer(self, assignment: Array) -> None:
        """The two others agree: it is the accelerometer whose axes are others, or all opposite."""
        back = min(assignment.T, -assignment.T, key=lambda axes: (axes < 0).sum())
        self.say(
            "axes of the accelerometer",
            RED,
            f"gyroscope and magnetometer agree; along their axes it measures {written(back)}, or "
            "the opposite",
            {},
            f"Use ({written(back)}) of the accelerometer as its x, y, z, or the opposite.",
        )
        self.raw["accelerometer"] = self.raw["accelerometer"] @ back.T

    def scale_and_bias(self) -> None:
        """Scale and bias of the gyroscope, by gravity as the accelerometer is corrected to."""
        if self.rates is None:
            return
        lying = [one for one in self.still if one.still]
        held = [one for one in self.still if not one.still]
        seconds = sum(self.time[one.last - 1] - self.time[one.first] for one in lying)
        told = ", ".join(
            f"{self.time[one.first]:.1f} to {self.time[one.last - 1]:.1f} s" for one in lying[:6]
        )
        evidence = {
            "stretches": len(lying),
            "seconds": round(float(seconds), 2),
            "deviation (°/s)": round(
                float(np.degrees(np.median([one.deviation for one in lying]))), 3
            )
            if lying
            else None,
        }
        if lying:
            self.say(
                "stillness",
                GREEN,
                f"it lies still from {told}: its gyroscope shows only white noise there",
                evidence,
            )
        elif held:
            one = min(held, key=lambda stretch: stretch.deviation)
            self.say(
                "stillness",
                YELLOW,
                "it is never still. "
                f"From {self.time[one.first]:.1f} to {self.time[one.last - 1]:.1f} s it is held: "
                f"it wavers by {np.degrees(one.deviation):.1f} °/s, slowly, as a hand does",
                {"deviation (°/s)": round(float(np.degrees(one.deviation)), 2)},
                "A mean over that time is motion, not bias. Lay it down for some seconds.",
            )
        else:
            self.say(
                "stillness", UNKNOWN, "it moves all the time", {}, "Lay it down for some seconds."
            )
        bias, spread = None, None
        if lying:
            bias, spread = self._resting(lying)
            self._noise(max(lying, key=lambda one: one.last - one.first))
        poses = [one for one in self.still if one.last - one.first > 10]
        fitted = None
        if self.forces is not None:
            fitted = fit_scales(self.time, self.rates, self.forces, poses, bias)
        scale: float | Array = 1.0
        if fitted is not None:
            scale = self._scale(fitted, poses)
            if bias is None and fitted.common[1] < 0.03 and fitted.left < 0.25:
                bias, spread = fitted.bias, fitted.bias_spreads
        else:
            self.say(
                "scale of the gyroscope",
                UNKNOWN,
                f"{len(poses)} still pose{'s' * (len(poses) != 1)}: "
                f"{'too few' if len(poses) < 4 else 'too alike'} to follow gravity through",
                {},
                "Hold it still in four poses or more that lean well away from each other.",
            )
        if bias is None:
            self.say(
                "bias of the gyroscope",
                UNKNOWN,
                "it is never still, and its rotations do not determine it",
                {},
                "Lay it down for some seconds.",
            )
        else:
            most = float(np.degrees(np.abs(bias).max()))
            sure = np.degrees(spread.max()) < 0.3
            light = (
                RED if most > 1 and sure else YELLOW if most > 0.3 else GREEN if sure else UNKNOWN
            )
            words = f"{_along(np.degrees(bias))} °/s, ± {np.degrees(spread.max()):.2g}"
            drifts = self._drift(lying, poses, scale)
            known = light in (RED, YELLOW) and not drifts
            advice = f"Subtract {_along(np.degrees(bias))} °/s." if known else ""
            self.say(
                "bias of the gyroscope",
                light,
                words,
                {"°/s": np.degrees(bias).round(4).tolist()},
                advice,
            )
            self.facts["bias of the gyroscope"] = bias
            self.rates = self.rates - bias
        self.rates = self.rates * scale
        self.facts["multiplied"] = scale
        if np.any(scale != 1.0):
            self.still = stretches(self.time, self.rates)

    def _resting(self, lying: Sequence[Stretch]) -> tuple[Array, Array]:
        """Means of the gyroscope where it lies still, and their standard deviations."""
        parts = np.concatenate([self.rates[one.first : one.last] for one in lying])
        return parts.mean(axis=0), parts.std(axis=0) / np.sqrt(len(parts))

    def _scale(self, fitted: ScaleFit, poses: Sequence[Stretch]) -> float | Array:
        """What the gyroscope is to be multiplied by, if that is known."""
        (common, uncertain), left = fitted.common, fitted.left
        carries = f"its turns carry gravity through {len(poses)} poses"
        self.facts["scale of the gyroscope"] = common
        if self.counts:
            unit = self.facts["unit of the gyroscope"] = (
                self.facts["unit of the gyroscope"] * common
            )
            self.say(
                "unit of the gyroscope",
                RED if _said_unit(self.content.groups["gyroscope"].names) else YELLOW,
                f"counts, whatever the heading says: one count is {np.degrees(unit):.4g} "
                f"± {np.degrees(uncertain * unit):.1g} °/s, since then {carries}",
                {"rad/s": unit},
                f"Multiply by {np.degrees(unit):.4g} to have °/s.",
            )
            return common
        off = np.abs(fitted.scales / np.median(fitted.scales) - 1)
        odd = np.flatnonzero(off > np.maximum(0.04, 5 * fitted.spreads))
        cut_off = any(verdict.about == "range of the gyroscope" for verdict in self.verdicts)
        if len(odd) == 1 and not cut_off and left < 0.7 * fitted.left_alike:
            axis, factor = "xyz"[odd[0]], float(fitted.scales[odd[0]])
            self.say(
                "scale of the gyroscope",
                RED,
                f"what it says of {axis} needs another scale than the rest: with {factor:.3f} "
                f"{carries} to {np.degrees(left):.1f}°, and with one scale for all axes to "
                f"{np.degrees(fitted.left_alike):.1f}°",
                {"axis": axis, "scale": round(factor, 4)},
                f"Multiply {axis} by {factor:.3f}.",
            )
            return np.where(np.arange(3) == odd[0], factor, 1.0)
        off = abs(common - 1)
        light = GREEN if off < max(0.02, 3 * uncertain) else YELLOW if off < 0.05 else RED
        if cut_off or uncertain > 0.03 or left > np.radians(3 if off < 0.05 else 6):
            light = UNKNOWN
        self.say(
            "scale of the gyroscope",
            light,
            f"{common:.3f} ± {uncertain:.3f}: {carries} to {np.degrees(left):.1f}°",
            {"scale": round(common, 4), "±": round(uncertain, 4), "poses": len(poses)},
            f"Multiply what it says by {common:.3f}." if light in (RED, YELLOW) else "",
        )
        return common if light in (RED, YELLOW) else 1.0

    def _drift(
        self, lying: Sequence[Stretch], poses: Sequence[Stretch], scale: float | Array
    ) -> bool:
        """Whether the bias is another one each time it lies still, or, where it is never laid down
        later on, in the second half of its poses than in the first.
        """
        if len(lying) > 1 and lying[-1].last - lying[0].first > len(self.time) / 2:
            runs: list[Sequence[Stretch]] = [[one] for one in lying]
            known = [self._resting(run) for run in runs]
            sure, least = 8, np.radians(0.1)
        else:
            runs = [poses[: len(poses) // 2 + 1], poses[len(poses) // 2 :]]
            if self.forces is None:
                return False
            fits = [fit_scales(self.time, self.rates * scale, self.forces, run) for run in runs]
            known = [(fit.bias, fit.bias_spreads) for fit in fits if fit and fit.left < 0.15]
            if len(known) < 2:
                return False
            if lying:
                runs, known = [lying, *runs], [self._resting(lying), *known]
            sure, least = 5, np.radians(0.5)
        biases, doubts = (np.array(each) for each in zip(*known, strict=True))
        middles = np.array([self.time[(run[0].first + run[-1].last) // 2] for run in runs])
        slopes, starts = np.polyfit(middles, biases, 1)
        ends = starts + slopes * middles[[0, -1], None]
        change, doubt = np.abs(ends[1] - ends[0]), np.max(doubts, axis=0)
        worst = int(np.argmax(change / doubt))
        if change[worst] < max(sure * doubt[worst], least):
            return False
        first, last = np.degrees(ends[:, worst])
        words = (
            f"the bias about {'xyz'[worst]} is {first:.2f} °/s at {middles[0]:.0f} s and "
            f"{last:.2f} °/s at {middles[-1]:.0f} s"
        )
        advice = "let the filter estimate the bias, or subtract a line between the still stretches."
        warmth = self.content.temperature
        if warmth is not None:
            at = np.interp(middles, *warmth)
            if np.ptp(at) > 2 and abs(np.corrcoef(at, biases[:, worst])[0, 1]) > 0.95:
                slope = float(np.degrees(np.polyfit(at, biases[:, worst], 1)[0]))
                words += (
                    f". It follows the temperature, {at.min():.0f} to {at.max():.0f} °C, by "
                    f"{slope:.2f} °/s for each degree"
                )
                advice = "subtract a line over the temperature, or let it warm up first."
        self.say(
            "drift of the bias",
            RED if change[worst] > np.radians(0.3) else YELLOW,
            words,
            {"°/s": np.degrees(biases).round(3).tolist()},
            f"Subtracting one number does not cure that: {advice}",
        )
        return True

    def _noise(self, one: Stretch) -> None:
        """What the Allan deviation of the longest still stretch says."""
        step = float(np.median(np.diff(self.time)))
        times, deviations = allan_deviation(np.degrees(self.rates[one.first : one.last]), step)
        noise = noise_of(times, deviations)
        self.facts["Allan deviation"] = times, deviations
        seconds = (one.last - one.first) * step
        if np.isnan(noise.angle_random_walk).any():
            words = (
                f"the {seconds:.0f} s in which it lies still are too few to separate white noise "
                "from the rest"
            )
            self.say("noise of the gyroscope", UNKNOWN, words, {}, "Let it lie for some minutes.")
            return
        walk = float(noise.angle_random_walk.max())
        words = f"angle random walk {walk:.2g} °/√s, {60 * walk:.2g} °/√h"
        evidence = {"°/√s": noise.angle_random_walk.round(4).tolist()}
        if np.isnan(noise.bias_instability).all():
            words += f"; {seconds:.0f} s are too few to measure how steady its bias is"
        else:
            worst = int(np.nanargmax(noise.bias_instability))
            words += (
                f"; bias instability {noise.bias_instability[worst]:.2g} °/s, at "
                f"{noise.time[worst]:.2g} s"
            )
            evidence["bias instability (°/s)"] = noise.bias_instability.round(5).tolist()
        self.facts["angle random walk"] = noise.angle_random_walk
        self.say("noise of the gyroscope", GREEN, words, evidence)

    # --- the accelerometer ----------------------------------------------------------------------

    def accelerometer(self) -> None:
        if "accelerometer" not in self.raw:
            self.say("accelerometer", UNKNOWN, "there is none in the file")
            return
        raw = self.raw["accelerometer"]
        self._saturation("accelerometer")
        quiet = (
            np.concatenate([raw[one.first : one.last] for one in self.still]) if self.still else raw
        )
        unit, gravity, off = unit_of_gravity(quiet)
        self.forces = raw / gravity
        self.facts["gravity"] = gravity
        said = _said_gravity(self.content.groups["accelerometer"].names)
        wrong = bool(said) and abs(np.log(GRAVITY[said] / gravity)) > 0.2
        self.say(
            "unit of the accelerometer",
            RED if wrong else YELLOW if unit.startswith("counts") else GREEN,
            f"{unit}, by gravity's length" + (f"; its heading says {said}" if wrong else ""),
            {"off": round(off, 4)},
            f"Read it as {unit}." if wrong else "",
        )
        lying = [one for one in self.still if one.still]
        for poses in (lying, self.still):  # a hand that holds it pushes it as well
            means = np.array([self.forces[one.first : one.last].mean(axis=0) for one in poses])
            enough = len(means) > 5 and np.linalg.matrix_rank(means, tol=0.5) == 3
            if enough:
                break
        if not enough:
            self.say(
                "accelerometer",
                UNKNOWN,
                f"{len(means)} still pose{'s' * (len(means) != 1)}: too few or too alike to "
                "separate offset and scale",
                {},
                "Hold it still in nine poses, each leaning another way.",
            )
            return
        lengths = np.linalg.norm(means, axis=1)
        uneven = float(np.ptp(lengths))
        light = YELLOW if uneven > 0.04 else GREEN
        words = f"gravity is {lengths.min():.3f} to {lengths.max():.3f} long in {len(means)} poses"
        advice, evidence = "", {"lengths": lengths.round(3).tolist()[:12]}
        cut_off = any(verdict.about == "range of the accelerometer" for verdict in self.verdicts)
        if light != GREEN and cut_off:
            words += ", as where it is cut off"
        elif light != GREEN:
            name, offset, scales, left = uneven_lengths(means)
            spread = float(np.std(lengths))
            explained = left < 0.5 * spread
            words += (
                f". {name} would take their deviation from {spread:.3f} to {left:.3f}, checked on "
                "poses left out of the fit"
                if explained
                else ", and no offset or scale halves their deviation"
            )
            if explained:
                light = RED if uneven > 0.08 else YELLOW
                by = offset * gravity
                subtract = [f"{by[k]:.3g} from {'xyz'[k]}" for k in np.flatnonzero(offset)]
                divide = [f"{'xyz'[k]} by {scales[k]:.3f}" for k in np.flatnonzero(scales != 1)]
                advice = "; ".join(
                    f"{verb} {', '.join(each)}"
                    for verb, each in (("Subtract", subtract), ("Divide", divide))
                    if each
                )
                advice += "."
                self.forces = (self.forces - offset) / scales
                self.facts["offset of the accelerometer"] = by
                self.facts["scales of the accelerometer"] = scales
        self.say("accelerometer", light, words, evidence, advice)

    # --- the magnetometer -----------------------------------------------------------------------

    def magnetometer(self) -> None:
        if "magnetometer" not in self.raw:
            return
        raw = self.raw["magnetometer"]
        fit = fit_field(self.time, self.rates, raw) if self.rates is not None else None
        known = ""
        if fit is not None and not fit.uncertainty < 0.3:
            known = (
                f": a direction would be uncertain by {np.degrees(min(fit.uncertainty, 3)):.0f}°"
            )
            fit = None
        by_lengths = fit is None
        if by_lengths:
            fit = _by_lengths(raw)
        usual = float(np.median(np.linalg.norm(raw, axis=1)))
        unit, length = unit_of_field(usual if fit is None else fit.strength)
        words = f"{unit}: the field is {length:.3g} long"
        self.say("unit of the magnetometer", GREEN, words, {"length": round(length, 3)})
        self.field, self.facts["strength of the field"] = raw / usual, usual
        before, dips = self._unevenness(self.field), self._dips(raw)
        uneven, about = before, "offset of the magnetometer"
        # The length is the field's alone; a dip may also vary with a wrong accelerometer.
        passed = "Iron was near for a while: do not use the field there."
        undecided = (
            "The cause is iron that moves with it, or iron that it passed, and the rotations do "
            "not decide which. Do not use the field, or record a figure of eight far from iron."
        )
        useless = fit is None
        if fit is None:
            words = f"neither rotations nor lengths determine offset and shape{known}"
            advice = "Rotate it slowly through all directions, a figure of eight."
            self.say(about, UNKNOWN, words, {}, advice)
        else:
            corrected = (raw - fit.offset) @ fit.shape.T / fit.strength
            uneven_then, dips_then = self._unevenness(corrected), self._dips(corrected)
            # Neither lengths nor dips were used to fit: a correction that mends none is none.
            useless = bool(dips and dips_then and dips_then[1] > 1.2 * dips[1] + 0.5)
            if useless or uneven_then > 0.8 * before + 0.01:
                words = (
                    f"the correction that fits best changes the spread of the dip from "
                    f"{dips[1]:.1f}° to {dips_then[1]:.1f}°"
                    if useless
                    else f"the length varies by {before:.0%}, and by {uneven_then:.0%} with the "
                    "correction that fits best"
                )
                if before < 0.06 and not (dips and dips[1] > 6):
                    self.say(
                        about, GREEN, "none that shows: no correction makes the field steadier"
                    )
                else:
                    advice = "Rotate it slowly through all directions, far from iron."
                    self.say(about, UNKNOWN, f"{words}: it is not applied", {}, advice)
            else:
                self.field, uneven, dips = corrected, uneven_then, dips_then
                self._corrected_field(fit, by_lengths)
        light = GREEN
        if uneven > 0.06 or (dips and dips[1] > 6):
            light = RED if uneven > 0.12 or (dips and dips[1] > 12) else YELLOW
            light = YELLOW if useless else light
        words = f"its length varies by {uneven:.0%}" + (
            f", its dip by {dips[1]:.0f}° about {dips[0]:.0f}°" if dips else ""
        )
        evidence = {"length varied by": round(before, 3), "corrected by": round(uneven, 3)}
        cause = undecided if useless else passed
        self.say("field", light, words, evidence, cause if uneven > 0.06 else "")
        trouble = {verdict.about for verdict in self.verdicts if verdict.light == RED}
        if dips and dips[0] < -5 and not any("axes" in about for about in trouble):
            self.say(
                "signs",
                UNKNOWN,
                f"the field points up, out of the ground, by {-dips[0]:.0f}°, as it does only "
                "south of the magnetic equator",
                {},
                "If you recorded north of it, the accelerometer's three signs are opposite, as in "
                "iPhones, or those of the magnetometer are.",
            )

    def _corrected_field(self, fit: FieldFit, by_lengths: bool) -> None:
        """Axes, offset and shape, as a fit has them that makes the field steadier."""
        plain = ASSIGNMENTS[np.argmax(np.einsum("kij,ij->k", ASSIGNMENTS, fit.axes))]
        reference = (
            np.eye(3)
            if "accelerometer" in self.raw
            else self.facts.get("axes of the gyroscope", np.eye(3))
        )
        about, advice = "axes of the magnetometer", ""
        if by_lengths:
            light, words = UNKNOWN, "fitted by length alone, which does not determine its axes"
            advice = "Rotate it slowly about all three axes."
        elif np.allclose(plain, reference) or np.allclose(plain, -reference):
            light, words = GREEN, "those of the others, or all three opposite"
        else:
            axes = written(plain)
            light, words = RED, f"along the axes of the others it measures {axes}, or the opposite"
            advice = f"Use ({axes}) of the magnetometer as its x, y, z, or the opposite."
        self.say(about, light, words, {}, advice)
        self.facts |= {
            "axes of the magnetometer": plain,
            "offset of the magnetometer": fit.offset,
            "shape of the magnetometer": fit.shape,
            "strength of the field": fit.strength,
        }
        hard = float(np.linalg.norm(fit.offset) / fit.strength)
        aside = np.degrees(np.arcsin(min(1, hard)))
        doubt = 2 * fit.uncertainty
        rows = "; ".join(" ".join(f"{entry:.3f}" for entry in row) for row in fit.shape)
        for about, size, worst, worse, words, evidence, advice in (
            (
                "offset of the magnetometer",
                hard,
                0.1,
                0.05,
                f"{_along(fit.offset)}, {hard:.0%} of the field: directions are wrong by up to "
                f"{aside:.0f}°",
                {"offset": fit.offset.round(3).tolist()},
                f"Subtract {_along(fit.offset)}.",
            ),
            (
                "shape of the magnetometer",
                fit.stretch - 1,
                0.12,
                0.06,
                f"the longest axis is {fit.stretch:.2f} times the shortest",
                {"matrix": fit.shape.round(3).tolist()},
                f"Then multiply by the matrix {rows}.",
            ),
        ):
            light = RED if size > worst + doubt else YELLOW if size > worse else GREEN
            known = light if doubt < 0.2 or light == RED else UNKNOWN
            self.say(about, known, words, evidence, "" if light == GREEN else advice)

    def _unevenness(self, field: Array) -> float:
        """By how much the length of a field varies, second by
        second, but for its wildest moments.
        """
        own = np.linalg.norm(field, axis=1)
        per_second = max(10, round(1 / np.median(np.diff(self.time))))
        smooth = [np.median(part) for part in np.array_split(own, max(4, len(own) // per_second))]
        return float(np.percentile(smooth, 97) - np.percentile(smooth, 3))

    def _dips(self, values: Array) -> tuple[float, float] | None:
        """Usual dip of a field in the still poses, and by how much it varies, degrees."""
        cut_off = any(verdict.about == "range of the accelerometer" for verdict in self.verdicts)
        if self.forces is None or len(self.still) < 3 or cut_off:
            return None
        found = []
        for one in self.still:
            up, field = (each[one.first : one.last].mean(axis=0) for each in (self.forces, values))
            sine = -up @ field / np.linalg.norm(up) / np.linalg.norm(field)
            found.append(np.degrees(np.arcsin(np.clip(sine, -1, 1))))
        return float(np.median(found)), float(np.percentile(found, 95) - np.percentile(found, 5))

    # --- whether all look at the same moment ----------------------------------------------------

    def timing(self) -> None:
        """Delays between the sensors, and samples that are missing where time was counted on."""
        steps = np.diff(self.time)
        step = float(np.median(steps))
        if self.rates is None or self.content.counted or len(self.time) * step < 3:
            return
        seen = {kind: self.raw[kind] for kind in self.raw if kind != "gyroscope"}
        leaps = np.full(len(self.time) - 1, len(seen) > 1)
        for values in seen.values():
            leaps &= _leaps(self.rates, values, step)
        # A few leaps are gaps; many are another fault, in the unit or the axes.
        # A clock whose steps are not all alike measures time, and does not count it on.
        if 0 < leaps.mean() < 0.02 and np.ptp(steps) < 0.02 * step:
            self.say(
                "missing samples",
                RED,
                f"at {int(leaps.sum())} places, the first at {self.time[1:][leaps][0]:.2f} s, "
                "gravity and field jump further than any rotation between two samples: samples "
                "are missing there, and time was counted on as if none were",
                {"places": int(leaps.sum())},
                "Record the instrument's own time with each sample: no filter can know what was "
                "lost.",
            )
            return
        # What does not tell the axes tells no delay.
        if "axes of the gyroscope" not in self.facts:
            return
        if "magnetometer" not in seen:
            return
        lag, _ = lag_of(self.rates, seen["magnetometer"], step)
        if abs(lag) < max(2, round(0.03 / step)):
            return
        # A push that comes with each turn looks like a delay of the accelerometer, which therefore
        # only says which of the two others is late. That one is early is rare.
        kind = "magnetometer"
        if "accelerometer" in seen:
            _, by_lag = lag_of(self.rates, seen["accelerometer"], step)
            middle = len(by_lag) // 2
            if by_lag[middle + lag] < (1.03 if lag < 0 else 0.97) * by_lag[middle]:
                kind, lag = "gyroscope", -lag
        others = "others" if len(seen) > 1 or kind == "gyroscope" else "gyroscope"
        self.say(
            f"delay of the {kind}",
            RED,
            f"its values fit the rotations of the {others} best {1000 * abs(lag) * step:.0f} ms "
            f"{'earlier' if lag > 0 else 'later'}: it comes {'late' if lag > 0 else 'early'}",
            {"seconds": round(lag * step, 3)},
            f"First of all, shift its times {'back' if lag > 0 else 'forward'} by that much.",
        )

    # --- the orientation ------------------------------------------------------------------------

    def orientation(self) -> None:
        groups = self.content.groups
        if self.rates is None:
            return
        for kind in ("quaternion", "angles"):
            if kind not in groups:
                continue
            group = groups[kind]
            if kind == "quaternion":
                candidates = {
                    order: dcm_of_quaternions(group.values, order)
                    for order in ("scalar first", "scalar last")
                }
            else:
                candidates = _angle_readings(group)
            found = readings(self.time, self.rates, group.time, candidates)
            if not found:
                self.say(
                    kind,
                    UNKNOWN,
                    "it rotates too little to be compared with the gyroscope",
                    {},
                    "Rotate it about all its axes.",
                )
                continue
            self._reading(kind, group, candidates, found)

    def _reading(
        self,
        kind: str,
        group: Group,
        candidates: Mapping[str, Array],
        found: Sequence[Reading],
    ) -> None:
        best = found[0].disagreement
        equal = [one for one in found if one.disagreement < best * 1.02 + 0.003]
        other = next((one for one in found if one.disagreement > best * 1.02 + 0.003), found[-1])
        levels = {id(one): self._level(group.time, _matrices(candidates, one)) for one in equal}
        if self.forces is not None:  # the ground has an axis up, in all programs
            most = max(levels[id(one)][0] for one in equal)
            equal = [one for one in equal if levels[id(one)][0] > most - 0.02]
        upwards = [one for one in equal if levels[id(one)][1] == 2] or equal
        reading = upwards[0]
        level, axis, against = levels[id(reading)]
        called = "-" * against + "xyz"[axis] if level is not None else ""
        words = (
            f"{reading.order}; "
            + (
                "the ground from the body, the conjugate of this book's"
                if reading.conjugate
                else "the body from the ground, as in this book"
            )
            + (
                ""
                if np.allclose(reading.mounting, np.eye(3))
                else f"; its body's x, y, z are the gyroscope's {written(reading.mounting)}"
            )
        )
        evidence = {
            "disagreement": round(best, 3),
            "next": round(other.disagreement, 3),
            "equal readings": len(upwards),
        }
        if level is not None:
            evidence["up along the ground's axes"] = (
                f"{called}, to {np.degrees(np.arccos(min(1, level))):.1f}°"
            )
        self.facts[f"convention of the {kind}"] = reading
        wrong = ""
        if kind == "quaternion":
            letters = [name.strip().lower().rstrip(")]").split("(")[0][-1:] for name in group.names]
            named = "".join(letter for letter in letters if letter in "wxyz")
            says = {"wxyz": "scalar first", "xyzw": "scalar last"}.get(named)
            if says and says != reading.order:
                wrong = f"its headings say {says}"
        if best > 0.6 or other.disagreement < best * 1.2:
            light, advice = (
                (RED, "It does not follow the gyroscope: is it another instrument's, or late?")
                if best > 0.6 and self.facts.get("bias of the gyroscope") is not None
                else (UNKNOWN, "")
            )
        elif wrong:
            light, advice = RED, f"Read it {reading.order}: {wrong}."
        else:
            light, advice = GREEN, ""
        self.say(kind, light, words + (f". But {wrong}" if wrong else ""), evidence, advice)
        matrices = _matrices(candidates, reading)
        if light != UNKNOWN and self.oriented is None:
            self.oriented = (group.time, matrices)
        if level is not None:
            lean = float(np.degrees(np.arccos(min(1, level))))
            advice = "" if lean < 3 else "Was it tared while it was not level?"
            if against:
                advice += (
                    " Either the ground's axis points down, or the accelerometer does, as in "
                    "iPhones: then change "
                )
                advice += "the signs of the latter."
            light = YELLOW if advice else GREEN
            self.say(
                "level",
                light,
                f"up is {lean:.1f}° away from the ground's {called} axis",
                {"°": round(lean, 2)},
                advice.strip(),
            )

    def _level(self, time: Array, matrices: Array) -> tuple[float | None, int | None, bool]:
        """How nearly up is along an axis of the ground, which, and whether against it."""
        if self.forces is None:
            return None, None, False
        forces = _at(time, self.time, self.forces)
        ups = np.einsum("nji,nj->ni", matrices, forces)
        calm = np.abs(np.linalg.norm(forces, axis=1) - 1) < 0.1
        up = np.median(ups[calm] if calm.sum() > 10 else ups, axis=0)
        up = up / max(np.linalg.norm(up), 1e-9)
        axis = int(np.abs(up).argmax())
        return float(abs(up[axis])), axis, bool(up[axis] < 0)

    # --- the filter -----------------------------------------------------------------------------

    def filter(self, progress: Callable[[float], None] | None) -> None:
        if self.time[-1] - self.time[0] < 1 or len(self.time) < 20:
            self.say(
                "filter",
                UNKNOWN,
                f"{len(self.time)} samples in {self.time[-1]:.2g} s are too few to judge it",
            )
            return
        if self.rates is None or self.forces is None or self.content.counted:
            words = "it needs a gyroscope of known unit, an accelerometer, and a clock"
            self.say("filter", UNKNOWN, words)
            return
        trouble = {verdict.about for verdict in self.verdicts if verdict.light == RED}
        field = None if "field" in trouble else self.field
        lying = [one for one in self.still if one.still]
        parts = _parts_to_judge(self.time, self.rates)
        inputs = filter_inputs(self.time, self.rates, self.forces, field, lying, parts)
        for number, given in enumerate(inputs):
            shown = progress and (lambda share, done=number: progress((done + share) / len(inputs)))
            self.judgements.append(judge(given, shown))
        where = ", ".join(f"{one.times[0]:.0f} to {one.times[-1]:.0f} s" for one in self.judgements)
        claimed = float(np.sqrt(np.mean([one.claimed**2 for one in self.judgements])))
        found = float(np.sqrt(np.mean([one.found**2 for one in self.judgements])))
        words = (
            f"from {where} it claims to know the tilt to {claimed:.2f}°, and its forward and "
            f"backward runs differ by {found:.2f}°"
        )
        if self.judgements[0].heading:
            heading = np.sqrt(np.mean([np.square(one.heading) for one in self.judgements], axis=0))
            words += f"; for the heading these are {heading[0]:.2f}° and {heading[1]:.2f}°"
        else:
            words += "; gravity alone gives it no heading"
        squares = {
            name: round(float(np.mean([one.squares[name] for one in self.judgements])), 2)
            for name in self.judgements[0].squares
        }
        worst, high = too_sure(self.judgements)
        light = RED if worst > 5 or high > 5 else YELLOW if worst > 3 or high > 3 else GREEN
        advice = ""
        if light == RED:
            advice = f"Its errors are {max(worst, np.sqrt(high)):.0f} times what it claims. "
            advice += (
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
        if self.judgements[0].heading and (doubtful or max(heading) > 20):
            light = YELLOW if light == GREEN else light
            advice += " Do not use its heading, which may be wrong by up to half a turn: " + (
                f"first settle {', '.join(doubtful)}." if doubtful else "it is too uncertain."
            )
        evidence = {
            "claimed (°)": round(claimed, 3),
            "found (°)": round(found, 3),
            "innovations": squares,
        }
        self.say("filter", light, words, evidence, advice.strip())

    def examined(self) -> Examined:
        return Examined(
            self.name,
            self.verdicts,
            self.time,
            self.rates,
            self.forces,
            self.field,
            self.oriented,
            self.judgements,
            self.still,
            self.facts,
        )


def lag_of(rates: Array, vectors: Array, step: float) -> tuple[int, Array]:
    """By how many samples vectors that stand still in the world come later than the turns.

    With a constant ``c`` that belongs to the instrument, ``dm/dt = -w x (m - c)``.

    Returns
    -------
    lag, and sums of squares of shape ``(2 * most + 1,)``
        0 where no delay shows; what is left by each delay, from 0.4 seconds early to as much late.
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
    # Neighbours share their noise: so many values tell as much as if each stood for itself.
    alone = 3 * count / (2 * half)
    clear = left[most] > (1 + 60 / alone) * left[best]
    clear &= left[best] < 0.6 * np.sum(slopes[inner] ** 2)
    return best - most if clear else 0, left


def _leaps(rates: Array, vectors: Array, step: float) -> Array:
    """Where vectors that stand still in the world change from one sample to the next as no turn
    explains.
    """
    mean = (vectors[1:] + vectors[:-1]) / 2
    turns = (rates[1:] + rates[:-1]) / 2
    left = np.linalg.norm(np.diff(vectors, axis=0) + step * np.cross(turns, mean), axis=1)
    usual = np.median(np.linalg.norm(vectors, axis=1))
    return left > np.maximum(8 * np.median(left), 0.06 * usual)


def _by_lengths(raw: Array) -> FieldFit | None:
    """A magnetometer's offset and shape from the lengths alone, if
    they are much the better for it.
    """
    fit = fit_ellipsoid(raw[:: max(1, len(raw) // 4000)], most=0.05)
    if fit is None:
        return None
    before, after = (
        np.linalg.norm(values, axis=1) for values in (raw, (raw - fit.offset) @ fit.shape.T)
    )
    if after.std() / after.mean() > 0.7 * before.std() / before.mean() + 0.01:
        return None
    return fit


def _at(time: Array, source: Array, values: Array) -> Array:
    """Values at other times, between samples along a straight line."""
    if len(source) == len(time) and np.allclose(source, time, atol=1e-9):
        return values
    return np.stack([np.interp(time, source, column) for column in values.T], axis=-1)


def _said_unit(names: Sequence[str]) -> str:
    text = " ".join(names).lower()
    if "rad" in text:
        return "mrad/s" if "mrad" in text else "rad/s"
    if "deg" in text or "°" in text or "dps" in text:
        return "m°/s" if "mdps" in text or "mdeg" in text else "°/s"
    return ""


def _along(values: Array) -> str:
    """Three numbers, as one says them.

    >>> _along(np.array([0.5, -2, 0]))
    'x 0.5, y -2, z 0'
    """
    return ", ".join(f"{axis} {value:.3g}" for axis, value in zip("xyz", values, strict=True))


def _said_gravity(names: Sequence[str]) -> str:
    """The unit of acceleration in a heading's brackets, if it is one that is in use."""
    text = names[0].lower().replace("^2", "²").replace("s2", "s²")
    found = re.search(r"[(\[]\s*(m/s²|m?g|cm/s²)\s*[)\]]", text)
    return found[1] if found else ""


def _centre(field: Array) -> Array:
    """A first idea of a magnetometer's offset: the middle of the
    sphere nearest to its values, or zero.
    """
    centre, radius = _sphere(field)
    spread = np.linalg.norm(field - centre, axis=1)
    ways = np.linalg.eigvalsh(np.cov(((field - centre) / np.maximum(spread, 1e-12)[:, None]).T))
    # Where the values cover a small part of the sphere, its middle is anybody's guess.
    return centre if ways[0] > 0.03 and spread.std() < 0.3 * radius else np.zeros(3)


def _sphere(points: Array) -> tuple[Array, float]:
    """Middle and radius of the sphere nearest to points."""
    rows = np.concatenate([2 * points, np.ones((len(points), 1))], axis=1)
    solution, *_ = np.linalg.lstsq(rows, (points**2).sum(axis=1), rcond=None)
    return solution[:3], float(np.sqrt(max(solution[3] + (solution[:3] ** 2).sum(), 0.0)))


def _matrices(candidates: Mapping[str, Array], reading: Reading) -> Array:
    """``B_C_N``, the body taken along the gyroscope's axes."""
    dcms = candidates[reading.order]
    dcms = dcms.swapaxes(-1, -2) if reading.conjugate else dcms
    return reading.mounting.T @ dcms


def _angle_readings(group: Group) -> dict[str, Array]:
    """Three angles as orientations: which is which, about which axes, in degrees or radians."""
    degrees = np.abs(group.values).max() > 6.5
    values = np.radians(group.values) if degrees else group.values
    order = places_by_name(group.names)
    found = {}
    unit = "degrees" if degrees else "radians"
    for sequence in ("zyx", "zxy", "xyz", "xzy", "yxz", "yzx"):
        for places in (
            [order] if order else [(2, 1, 0), (0, 1, 2), (1, 0, 2), (0, 2, 1), (1, 2, 0), (2, 0, 1)]
        ):
            for signs in ((1, 1, 1), (1, -1, 1), (-1, 1, 1), (1, 1, -1)):
                called = ", ".join(
                    ("-" if sign < 0 else "") + group.names[place]
                    for sign, place in zip(signs, places, strict=True)
                )
                found[f"body fixed {sequence} ({called}), {unit}"] = dcm_from_body_fixed(
                    values[:, places] * signs, sequence
                )
    return found


def _parts_to_judge(
    time: Array, rates: Array, longest: float = 60.0, count: int = 3
) -> list[tuple[int, int]]:
    """Where to judge a filter: all of a short recording, or its
    liveliest, calmest and middle parts.
    """
    if time[-1] - time[0] <= longest * 1.5:
        return [(0, len(time))]
    size = int(longest / 2 / np.median(np.diff(time)))
    starts = np.arange(0, len(time) - size, size)
    lively = np.array(
        [np.linalg.norm(rates[start : start + size], axis=1).mean() for start in starts]
    )
    chosen = np.argsort(lively)[[0, len(starts) // 2, -1]][:count]
    return [(int(starts[k]), int(starts[k]) + size) for k in sorted(set(chosen.tolist()))]
