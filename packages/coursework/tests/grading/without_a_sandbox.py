"""A replacement for the sandbox, for notebooks whose answers can be read off."""

import ast
import re

from coursework.checking.plain import to_plain


def run_without_a_sandbox(jobs, finish, *others):
    """Return the sandbox's results for notebooks whose answers are numbers or function names."""

    def answer(job, name, about):
        call = re.search(
            rf"check\('{name}', (.*)\)", "\n".join(cell["source"] for cell in job["cells"])
        )
        if call is None or call[1] in ("...", "load", "why"):
            return {"outcome": "missing"}
        if not about["calls"]:
            return {
                "outcome": "recorded",
                "plain": to_plain(ast.literal_eval(call[1])),
                "from": "check",
                "cell": 0,
            }
        factor = {"twice": 2, "thrice": 3}[call[1]]
        said = {"outcome": "recorded", "from": "check", "cell": 0}
        for key, calls in (("plain", about["calls"]), ("secret", about["secret calls"])):
            plain = to_plain(lambda x: factor * x, calls["arguments"])
            said[key] = plain if key == "plain" else {"plain": plain}
        return said

    for order in range(len(jobs.work)):
        results = [
            {
                "id": job["id"],
                "finished": True,
                "cells": [{"outcome": "done"}] * len(job["cells"]),
                "answers": {
                    name: answer(job, name, about) for name, about in job["questions"].items()
                },
                "unknown questions": [],
                "notes": [],
                "runs": 1,
                "seed": 0,
                "isolation": {"layers": ["none: nothing was run"], "weak": False},
            }
            for job in jobs.of(order)
        ]
        yield finish(order, results)
