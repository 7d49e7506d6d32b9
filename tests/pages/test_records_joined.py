"""The records of page and notebook on a student's tries are joined without loss."""

import json
import subprocess
import sys
from pathlib import Path

from places import REPOSITORY

NAME = "levers/see-saw"


def test_page_and_notebook_join_no_records_of_different_variants(tmp_path):
    script = REPOSITORY / "packages/notebook-pages/src/notebook_pages/live/js/store.js"
    call = "\nconsole.log(joinProgress(...process.argv.slice(2)));"
    (tmp_path / "join.mjs").write_text(script.read_text("utf8") + call, "utf8")

    def joined(*records):
        texts = [json.dumps({NAME: record}) for record in records]
        node = Path(sys.executable).with_name("node")
        done = subprocess.run(
            [node, tmp_path / "join.mjs", *texts], capture_output=True, check=True, text=True
        )
        return json.loads(done.stdout)[NAME]

    before = {"outcome": "correct", "help": "hint", "answers": ["a"]}
    after = {"outcome": "wrong", "variant": 3, "answers": ["b"]}
    assert joined(before, after) == {**after, "other variants": {"0": before}}
    record = {**after, "other variants": {"0": before}}
    assert joined(record, {**after, "answers": ["c"]}) == {**record, "answers": ["b", "c"]}
    # Two editions have different numbers in the same place, and the record keeps whose they were.
    first = {"outcome": "correct", "variant": 3, "numbers": "aa", "whose": "ada"}
    second = {"outcome": "wrong", "variant": 3, "numbers": "bb", "whose": "ada", "answers": ["d"]}
    everybodys = {**before, "numbers": "00", "whose": ""}
    assert joined(first, second) == {**second, "other variants": {"3": first}}
    assert joined({**everybodys, "other variants": {"3": second}}, first) == {
        **first,
        "other variants": {"0": everybodys, "3": second},
    }
    assert joined({**first, "other variants": {"3": second}}, {**second, "answers": ["e"]}) == {
        **second,
        "answers": ["d", "e"],
        "other variants": {"3": first},
    }
