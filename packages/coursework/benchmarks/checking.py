"""What it costs to check a wrong answer, in slow hashes: ``python -m benchmarks.checking``, in the
folder ``coursework`` of the book.

Many questions of the course are given an answer that nobody knows: neither right nor a mistake of
the catalogue, so that everything is looked up that can be. Times by the clock depend on the machine
and on what else it does; the slow hash is measured between the answers, and the ratio of the two
depends on that far less. It is given for what is released, and for the same without the lookup that
knows a classmate's answer.
"""

import contextlib
import io
import random
import statistics
import time
from dataclasses import replace

from coursework.authoring.course import find_course
from coursework.authoring.forms import another_answer
from coursework.authoring.source import notebooks_in, read_source
from coursework.checking import sealing
from coursework.checking.plugins import kinds
from coursework.checking.questions import judge, notebook_questions

WRONG, TIMES = 62, 5


def main():
    tried = [*wrong_answers(WRONG)]
    names = ("as released", "without classmates")
    took, hashed = {name: [] for name in names}, []
    for name, question, plain in tried:
        alone = replace(question, others=None)
        hashed.append(least(lambda: sealing.slow_key("a salt of sixteen", "an answer")))
        for how, asked in zip(names, (question, alone), strict=True):
            took[how].append(
                least(lambda name=name, asked=asked, plain=plain: judge(name, asked, plain))
            )
    slow = statistics.median(hashed)
    print(f"{len(tried)} wrong answers; a slow hash takes {1e3 * slow:.1f} ms.")
    for how, times in took.items():
        middle, most = statistics.median(times), max(times)
        print(
            f"{how}: median {1e3 * middle:.1f} ms, {middle / slow:.2f} slow hashes; "
            f"most {1e3 * most:.1f} ms, {most / slow:.2f} slow hashes "
            f"({tried[times.index(most)][0]})."
        )


def wrong_answers(count):
    """The name, the sealed question and a wrong answer, of so many
    questions; those with variants first.
    """
    course, found = find_course(), []
    for path in notebooks_in(course.sources):
        with contextlib.redirect_stdout(io.StringIO()):
            source = read_source(path, edition=course.edition)
        for name, question in source.questions.items():
            if question.public.exam or kinds()[question.public.kind].by_a_person:
                continue
            for seed in range(9):
                plain = question.to_plain(
                    another_answer(question.public, question.answer, random.Random(seed))
                )
                if (
                    question.reply_to(plain).outcome == "wrong"
                    and not question.reply_to(plain).note
                ):
                    found.append((name not in source.rules, name, plain))
                    break
    for _, name, plain in sorted(found, key=lambda one: one[:2])[:count]:
        yield name, notebook_questions(name.partition("/")[0])[name], plain


def least(work):
    """The least of the times that some work takes, in seconds."""
    times = []
    for _ in range(TIMES):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


if __name__ == "__main__":
    main()
