"""Comparable times: contestants alternate in one run, and the least time of each counts."""

import time
import timeit

SHORTEST_SAMPLE = 0.005


def seconds_per_call(contestants, rounds):
    """Return the least processor time of one call for each function of a dictionary.

    Every round times every function once, starting with another one each time, so that other
    activity of the machine, which can only add to a time, affects all of them.
    """
    calls = {name: _calls_for_one_sample(function) for name, function in contestants.items()}
    least = dict.fromkeys(contestants, float("inf"))
    order = list(contestants)
    for _ in range(rounds):
        for name in order:
            seconds = _seconds(contestants[name], calls[name]) / calls[name]
            least[name] = min(least[name], seconds)
        order.append(order.pop(0))
    return least


def _seconds(function, count):
    return timeit.timeit(function, timer=time.process_time, number=count)


def _calls_for_one_sample(function):
    # Work that is done only once, such as filling a cache, does not count.
    function()
    count = 1
    while _seconds(function, count) < SHORTEST_SAMPLE:
        count *= 2
    return count
