"""The bench on recordings with one planted fault: is it named, and is nothing false advised?

``python packages/orientation-lab/tests/recordings/test_planted_faults.py [COUNT] [FIRST]`` tries
all kinds with COUNT seeds each, and five times as many honest recordings, and prints every miss.

On 29 November 2026, seeds 103000 to 103019, which nobody had seen before: 450 of 460 were named,
and nothing was advised that was not planted. Missed were 4 with a wrong scale of one axis of the
gyroscope, 2 each with that of the whole gyroscope and of one axis of the accelerometer, and 1 each
with an offset of the accelerometer and with lost samples. Of the honest seeds 103000 to 103099,
none was red and 2 were yellow. On the way there, seeds 100000 and 101000 gave 448 each; 2 and 1
times something else was advised, which was mended, and 1 honest recording of each hundred was red.
"""

import re
import sys

import pytest
from simulated_faults import KINDS, simulate

from orientation_workbench.recording import examine
from orientation_workbench.recording.examined import RED, YELLOW
from orientation_workbench.recording.report import as_code

#: What an answer about the fault is called, and words that must stand in it; in braces what was
#: planted.
NAMED = {
    "gyroscope saturated": ("range of the gyroscope", "clipped"),
    "gyroscope late": ("delay of the gyroscope", "is late"),
    "gyroscope offset": ("bias of the gyroscope", "Subtract"),
    "gyroscope drifts": ("drift of the bias", "about {axis}"),
    "gyroscope drifts with temperature": ("drift of the bias", "about {axis} .*temperature"),
    "gyroscope scale of an axis": ("scale of the gyroscope", "Multiply {axis} by"),
    "gyroscope scale": ("scale of the gyroscope", "Multiply its values by"),
    "gyroscope axis reversed": ("axes of the gyroscope", "-{axis}"),
    "gyroscope axes exchanged": ("axes of the gyroscope", "Use"),
    "gyroscope unit": ("unit of the gyroscope", "Read it as rad/s"),
    "accelerometer saturated": ("range of the accelerometer", "clipped"),
    "accelerometer offset": ("accelerometer", "Subtract .*from {axis}"),
    "accelerometer scale of an axis": ("accelerometer", "Divide .*{axis} by"),
    "accelerometer axis reversed": ("axes of the accelerometer", "Use"),
    "accelerometer axes exchanged": ("axes of the accelerometer", "Use"),
    "accelerometer unit": ("unit of the accelerometer", "Read it as g"),
    "magnetometer late": ("delay of the magnetometer", "is late"),
    "magnetometer hard iron": ("offset of the magnetometer", "Subtract"),
    "magnetometer soft iron": ("shape of the magnetometer", "multiply by the matrix"),
    "magnetometer axis reversed": ("axes of the magnetometer", "Use"),
    "magnetometer axes exchanged": ("axes of the magnetometer", "Use"),
    "magnetic disturbance": ("field", "for a while|that it passed"),
    "samples lost": ("missing samples", "missing"),
}
#: Soft iron moves the middle as well; a small bias or offset is there in many honest instruments.
ALSO = {"magnetometer soft iron": "offset of the magnetometer"}


def judged(kind, seed, with_filter=False):
    """Return whether the fault was named, and what else was advised or, if honest, lit."""
    text, planted = simulate(kind, seed)
    examined = examine(text, "recording", judged=with_filter)
    assert as_code(examined)  # also where no correction is known
    verdicts = examined.verdicts
    about, words = NAMED.get(kind, ("", "$."))
    named = any(
        verdict.about == about
        and verdict.light in (RED, YELLOW)
        and re.search(words.format(**planted), f"{verdict.words} {verdict.advice}")
        for verdict in verdicts
    )
    others = [
        verdict
        for verdict in verdicts
        if verdict.light in (RED, YELLOW) and verdict.about not in (about, ALSO.get(kind))
        # Beside a fault, what counts is what is advised.
        if not kind or (verdict.advice and not true(verdict, planted))
    ]
    return named, [
        f"{verdict.light}: {verdict.about}: {verdict.words} -> {verdict.advice}"
        for verdict in others
    ]


def true(verdict, planted):
    """Whether what is advised is an imperfection that every part has, here a larger one."""
    size = planted.get(verdict.about)
    if size is None or verdict.light == RED:
        return False
    numbers = [float(number) for number in re.findall(r"-?\d+\.?\d*", verdict.advice)]
    return any(abs(number - own) < 0.3 * abs(own) for number in numbers for own in size)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("kind", KINDS)
def test_a_planted_fault_is_named_and_nothing_false_advised(kind):
    named, false = judged(kind, 1000)
    assert named and not false, false


def test_an_honest_recording_has_neither_a_red_nor_a_yellow_light():
    assert not judged(None, 1000, True)[1]


def score(count, first=2000):
    """Print how many of each kind were named, and everything that was missed or false."""
    whole = 0
    for kind in KINDS:
        tries = {seed: judged(kind, seed) for seed in range(first, first + count)}
        missed = [seed for seed, (named, _) in tries.items() if not named]
        whole += count - len(missed)
        print(f"{count - len(missed):3} of {count} {kind}", f"missed: {missed}" * bool(missed))
        for seed, (_, false) in tries.items():
            for words in false:
                print(f"      false advice, seed {seed}: {words}", flush=True)
    print(f"named {whole} of {count * len(KINDS)} ({whole / count / len(KINDS):.0%})", flush=True)
    honest = [judged(None, seed, True)[1] for seed in range(first, first + 5 * count)]
    for light in (RED, YELLOW):
        lit = [each for each in honest if any(words.startswith(light) for words in each)]
        print(f"{len(lit)} of {len(honest)} honest ones are {light}")
        for words in sorted({words for each in lit for words in each if words.startswith(light)}):
            print(f"      {words}")


if __name__ == "__main__":
    score(*map(int, sys.argv[1:]))
