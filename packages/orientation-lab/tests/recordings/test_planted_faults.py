"""The bench on recordings with one planted fault: is it named, and is nothing else advised?

``python packages/orientation-lab/tests/recordings/test_planted_faults.py [COUNT]`` tries all kinds
on COUNT instruments each, and five times as many honest ones, and prints what was missed.
"""

import re
import sys

import pytest
from planted_faults import KINDS, sample

from orientation_workbench.recording import examine
from orientation_workbench.recording.examined import RED, YELLOW

#: What an answer about the fault is called, and words that must stand in it.
NAMED = {
    "gyroscope saturated": ("range of the gyroscope", "cut off"),
    "gyroscope late": ("delay of the gyroscope", "60 ms"),
    "gyroscope bias": ("bias of the gyroscope", "Subtract"),
    "gyroscope drifts": ("drift of the bias", "One number"),
    "gyroscope follows temperature": ("drift of the bias", "temperature"),
    "gyroscope scale of an axis": ("scale of the gyroscope", "Multiply [xyz] by"),
    "gyroscope axis reversed": ("axes of the gyroscope", "Take"),
    "gyroscope axes exchanged": ("axes of the gyroscope", "Take"),
    "gyroscope in rad/s": ("unit of the gyroscope", "Read it as rad/s"),
    "gyroscope in counts": ("unit of the gyroscope", "counts"),
    "accelerometer axis reversed": ("axes of the accelerometer", "Take"),
    "accelerometer negated": ("signs", "accelerometer"),
    "accelerometer axes exchanged": ("axes of the accelerometer", "Take"),
    "accelerometer in g": ("unit of the accelerometer", "Read it as g"),
    "accelerometer bias": ("accelerometer", "offset of [xyz]"),
    "accelerometer scale of an axis": ("accelerometer", "scale of [xyz]"),
    "accelerometer saturated": ("range of the accelerometer", "cut off"),
    "magnetometer late": ("delay of the magnetometer", "2[01]0 ms|190 ms"),
    "magnetometer hard iron": ("offset of the magnetometer", "Subtract"),
    "magnetometer soft iron": ("shape of the magnetometer", "multiply"),
    "magnetometer axis reversed": ("axes of the magnetometer", "Take"),
    "magnetometer disturbed for a while": ("field", "for a while"),
    "samples lost": ("missing samples", "missing"),
}
#: What a fault may be told as besides: soft iron moves the middle as well.
ALSO = {"magnetometer soft iron": "offset of the magnetometer"}


def judged(kind, seed, with_filter=False):
    """Return whether the fault was named, and what else was advised."""
    verdicts = examine(sample(kind, seed), kind, judged=with_filter).verdicts
    about, words = NAMED.get(kind, ("", "$."))
    told = [one for one in verdicts if one.about == about and one.light != "as it should be"]
    named = any(re.search(words, f"{one.words} {one.advice}") for one in told)
    false = [
        f"{one.about}: {one.words} -> {one.advice}"
        for one in verdicts
        if one.light in (RED, YELLOW) and one.about not in (about, ALSO.get(kind), "filter")
        if one.advice or kind == "none"
    ]
    lights = [one.light for one in verdicts if kind == "none"]
    return named, false, lights


@pytest.mark.sampled(4)
@pytest.mark.parametrize("kind", KINDS)
def test_a_planted_fault_is_named_and_nothing_else_advised(kind):
    named, false, _ = judged(kind, 1000)
    assert named and not false, false


def test_an_honest_recording_has_neither_a_red_nor_a_yellow_light():
    assert {RED, YELLOW}.isdisjoint(judged("none", 1000, True)[2])


def score(count, first=2000):
    """Print how many of each kind were named, and everything that was missed or false."""
    every = 0
    for kind in KINDS:
        tries = [(seed, *judged(kind, seed)) for seed in range(first, first + count)]
        every += sum(named for _, named, _, _ in tries)
        wrong = [(seed, false) for seed, _, false, _ in tries if false]
        missed = [seed for seed, named, _, _ in tries if not named]
        print(f"{count - len(missed):3} of {count} {kind}", f"missed: {missed}" * bool(missed))
        for seed, false in wrong:
            print(f"      false advice, seed {seed}: {'; '.join(false)}", flush=True)
    lights = [judged("none", seed, True)[2] for seed in range(first, first + 5 * count)]
    print(f"named {every} of {count * len(KINDS)} ({every / count / len(KINDS):.0%})")
    for light in (RED, YELLOW):
        print(f"{sum(light in each for each in lights)} of {len(lights)} honest ones are {light}")


if __name__ == "__main__":
    score(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
