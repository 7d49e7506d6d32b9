"""Other ways to write an orientation, and other orientations, to test questions with."""

import sympy
from sympy import Rational
from sympy.physics.mechanics import ReferenceFrame

from coursework.checking.question import Question
from orientation import multiply_quaternions

from .mistakes import Answer, Turns, dcm_of, quaternion_of


def of_dcm(question: Question, answer: Answer) -> list[tuple[str, object]]:
    """Return a symbolic direction cosine matrix as a SymPy reference frame."""
    if not isinstance(answer, sympy.MatrixBase) or not question.symbols:
        return []
    target, source = (ReferenceFrame(name) for name in question.frames)
    target.orient_explicit(source, sympy.ImmutableMatrix(answer).T)
    return [("reference frame", target)]


def of_sequence(question: Question, answer: str) -> list[tuple[str, object]]:
    return [("dashes", "-".join(answer)), ("spaces", " ".join(answer)), ("list", list(answer))]


def _a_turn() -> Turns:
    return [((Rational(2, 3), Rational(-1, 3), Rational(2, 3)), Rational(37, 100))]


def another_dcm(question: Question, answer: Answer) -> Answer:
    if hasattr(answer, "dcm"):
        answer = answer.dcm(next(iter(answer._dcm_dict)))
    return dcm_of(_a_turn()) * sympy.Matrix(
        answer.tolist() if hasattr(answer, "tolist") else answer
    )


def another_quaternion(question: Question, answer: Answer) -> Answer:
    return multiply_quaternions(sympy.Matrix(list(answer)), quaternion_of(_a_turn()))


def another_sequence(question: Question, answer: str) -> str:
    return next(word for word in ("xyx", "yzy", "zxy") if word not in (answer, answer[::-1]))
