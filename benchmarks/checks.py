"""How long a student waits for `check` after a wrong answer: ``python -m benchmarks.checks``.

Each answer is read, looked up, looked up again with common slips undone, and looked up among the
answers of classmates, since somebody has said who they are. The least of several times is kept:
whatever else the machine does only adds.
"""

import os
import statistics
import tempfile
import time

import sympy as sm

from coursework.checking import questions, sealing
from coursework.checking.check import check
from coursework.checking.identity import student
from coursework.checking.question import Question
from orientation import dcm_from_body_fixed, quaternion_from_axis_angle

COUNT, ROUNDS = 62, 9


def wrong_answer(question: Question):
    """An answer of the right kind to a question, made of its own symbols, that hardly is the right
    one.
    """
    numbers = [sm.Symbol(name) for name in question.symbols] + [
        0.3,
        0.7,
        -0.4,
        1.1,
        0.9,
        -1.3,
        0.2,
        0.6,
        2.1,
    ]
    if question.tolerance is None:
        numbers = [sm.nsimplify(one) for one in numbers]
    rows, columns = question.shape or (3, 3)
    made = {
        "direction cosine matrix": lambda: dcm_from_body_fixed(numbers[:3], "xyz"),
        "matrix": lambda: sm.Matrix(
            rows, columns, lambda row, column: numbers[(row + 2 * column) % len(numbers)]
        ),
        "quaternion": lambda: quaternion_from_axis_angle((1, 2, 2), numbers[0]),
        "vector": lambda: sm.Matrix(numbers[: question.length or 3]),
        "expression": lambda: 3 * numbers[0] + numbers[1],
        "Euler angles": lambda: [0.31, 0.17, 0.29],
        "axis and angle": lambda: [[0.6, 0, 0.8], 0.41],
        "sequence": lambda: "xyx",
        "words": lambda: [
            question.options[k % len(question.options)] for k in range(question.length or 1)
        ],
        "choice": lambda: question.options[-1],
        "truth values": lambda: [True] * (question.length or 1),
    }
    return made[question.kind]() if question.kind in made else None


def answers():
    """Names of questions, and a wrong answer to each."""
    (folder,) = (place for place in questions.places() if place.is_dir())
    for file in sorted(path.name for path in folder.iterdir() if path.name.endswith(".json")):
        for name, sealed in questions.notebook_questions(file.removesuffix(".json")).items():
            if not sealed.question.exam and (answer := wrong_answer(sealed.question)) is not None:
                yield name, answer


def times():
    """For each answer its question, the outcome, milliseconds, and how many slow hashes it took."""
    slow = sealing.pbkdf2
    every = list(answers())
    for name, answer in (every[k * len(every) // COUNT] for k in range(COUNT)):
        hashes = []
        sealing.pbkdf2 = lambda *given: (hashes.append(1), slow(*given))[1]
        outcome = check(name, answer).outcome
        sealing.pbkdf2 = slow
        least = []
        for _ in range(ROUNDS):
            start = time.perf_counter()
            check(name, answer)
            least.append(time.perf_counter() - start)
        yield name, outcome, 1000 * min(least), len(hashes)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # the record of tries is written there
        student("ada@uni.example")
        found = sorted(times(), key=lambda row: row[2])
    for row in found[-12:]:
        print("| {} | {} | {:.1f} ms | {} |".format(*row))
    took = [row[2] for row in found]
    once = min(_slow_hash() for _ in range(ROUNDS))
    middle = statistics.median(took)
    print(
        f"{len(took)} answers: median {middle:.1f} ms, at most {took[-1]:.1f}; one slow hash "
        f"{once:.1f}"
    )


def _slow_hash():
    start = time.perf_counter()
    sealing.slow_key("0" * 16, "an answer")
    return 1000 * (time.perf_counter() - start)


if __name__ == "__main__":
    main()
