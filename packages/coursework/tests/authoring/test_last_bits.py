"""Seals of an answer are the same on every processor, even for a small tolerance."""

import math
import random

import pytest

from coursework.authoring.author import far_from_last_bits
from coursework.checking.evaluate import MP
from coursework.checking.question import Question
from coursework.checking.reading import Reading


@pytest.mark.parametrize("tolerance", [5e-4, 5e-10, 5e-13])
def test_the_last_bits_of_a_number_are_in_no_seal(tolerance):
    """Rounding near an edge cannot be stable, but this is rare, and comparing releases shows it."""
    question, source = Question("expression", tolerance=tolerance), random.Random(1)
    moved = 0
    for _ in range(200):
        number = source.uniform(0.5, 4)
        beside = [number, math.nextafter(number, 9), math.nextafter(number, -9)]
        [sealed] = far_from_last_bits(question, Reading([list(map(MP.mpf, beside))])).numbers
        assert all(abs(value - MP.mpf(number)) < 0.1 * tolerance for value in sealed)
        moved += len(set(sealed)) > 1
    assert moved < 20


def test_numbers_of_two_mathematical_libraries_are_sealed_alike():
    question = Question("expression", tolerance=5e-13)
    for value, other in (
        (2.781885654004837, 2.7818856540048373),
        (3.7091808720064496, 3.70918087200645),
    ):
        readings = [Reading([[MP.mpf(number)]]) for number in (value, other)]
        assert len({str(far_from_last_bits(question, reading)) for reading in readings}) == 1
