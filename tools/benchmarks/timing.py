"""Times that can be compared: all contestants take turns in one run, and medians are kept."""

import statistics
import time

SHORTEST_SAMPLE = 0.005


def seconds_per_call(contestants, rounds):
    """Median time of one call for each function of a dictionary, None for one that is missing.

    Every round times every function once, starting with another one each time, so that whatever
    else the machine does meets them all.
    """
    present = {name: function for name, function in contestants.items() if function}
    calls = {name: _calls_for_one_sample(function) for name, function in present.items()}
    samples = {name: [] for name in present}
    order = list(present)
    for _ in range(rounds):
        for name in order:
            function, count = present[name], calls[name]
            start = time.process_time()
            for _ in range(count):
                function()
            samples[name].append((time.process_time() - start) / count)
        order.append(order.pop(0))
    return {
        name: statistics.median(samples[name]) if name in samples else None for name in contestants
    }


def _calls_for_one_sample(function):
    function()  # what is done once only, such as filling a cache, is no part of the time
    count = 1
    while True:
        start = time.process_time()
        for _ in range(count):
            function()
        if time.process_time() - start > SHORTEST_SAMPLE:
            return count
        count *= 2
