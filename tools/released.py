"""The data that a notebook's release depends on, as short digests."""

import contextlib
import io
import json
from hashlib import sha256
from pathlib import Path

from coursework.authoring.source import read_source


def digests_of(path):
    """Return digests of the sealed content of a notebook with solutions, before the slow hash.

    There is a digest of each question in each variant.
    """
    with contextlib.redirect_stdout(io.StringIO()):
        first = read_source(path)
        digests = {Path(path).stem: digest([figure.picture() for figure in first.figures.values()])}
        for number in range(max((rule.count for rule in first.rules.values()), default=1)):
            source = read_source(path, number) if number else first
            digests |= {
                f"{name}, variant {number}": digest(contents(question))
                for name, question in source.questions.items()
            }
    return digests


def contents(question):
    """Return everything that the seal of a question depends on."""
    known = {
        text: [answer.as_json() for answer in entry.answers]
        for text, entry in question.entries.items()
    }
    return [
        question.public.as_json(),
        known,
        question.near,
        question.solution,
        question.after,
        question.ladder,
    ]


def digest(content):
    return sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()[:16]
