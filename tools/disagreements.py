"""Score a tool on public disagreements: ``python -m tools.disagreements [COMMAND]``.

The raw numbers are in ``appendix/disagreements.json``. The command is called with the numbers of
both sides as its last two arguments and prints JSON with a ``verdict`` (``same``, ``named``,
``undecided`` or ``unrelated``) and ``faults``, a list of phrases.
"""

import json
import re
import shlex
import subprocess
import sys
from collections import Counter
from pathlib import Path

CASES = Path(__file__).parents[1] / "appendix" / "disagreements.json"
OURS = f"{shlex.quote(sys.executable)} -m orientation_workbench explain --json"


def judged(case, verdict, faults):
    """Classify an answer as right, not decided, false, or not read."""
    truth, _, words = case["truth"].partition(": ")
    if verdict == "bad input":
        return "right" if truth == "unreadable" else "not read"
    if verdict == "undecided":
        return "not decided"
    named = verdict == "named" and re.search(words or "$.", "; ".join(faults), re.IGNORECASE)
    return "right" if verdict == truth and (truth != "named" or named) else "FALSE"


def main(command=OURS):
    """Print a line for each case, and the number of right answers."""
    score = Counter()
    for case in json.loads(CASES.read_text("utf8"))["cases"]:
        words = [*shlex.split(command), case["first"], case["second"]]
        answer = json.loads(subprocess.run(words, capture_output=True, text=True).stdout)
        faults = answer.get("faults", [])
        worth = judged(case, answer["verdict"], faults)
        score[worth] += 1
        print(f"{worth:12} {case['address']}")
        if worth != "right":
            explanation = "; ".join(faults) or answer.get("message", "")
            print(
                f"{'':12} found there: {case['found']}\n{'':12} {answer['verdict']}: {explanation}"
            )
    print(", ".join(f"{count} {worth}" for worth, count in score.most_common()))


if __name__ == "__main__":
    main(*sys.argv[1:2])
