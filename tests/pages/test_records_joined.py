"""What page and notebook keep of a student's tries is joined, and nothing of it is lost."""

import json
import subprocess
import sys
from pathlib import Path

from places import REPOSITORY

NAME = "levers/see-saw"


def test_page_and_notebook_join_no_records_of_different_variants(tmp_path):
    script = REPOSITORY / "packages/notebook-pages/src/notebook_pages/live/js/store.js"
    said = "\nconsole.log(joinProgress(...process.argv.slice(2)));"
    (tmp_path / "join.mjs").write_text(script.read_text("utf8") + said, "utf8")

    def joined(*records):
        texts = [json.dumps({NAME: record}) for record in records]
        node = Path(sys.executable).with_name("node")
        said = subprocess.run(
            [node, tmp_path / "join.mjs", *texts], capture_output=True, check=True, text=True
        )
        return json.loads(said.stdout)[NAME]

    before = {"outcome": "correct", "help": "hint", "answers": ["a"]}
    after = {"outcome": "wrong", "variant": 3, "answers": ["b"]}
    assert joined(before, after) == {**after, "other variants": {"0": before}}
    kept = {**after, "other variants": {"0": before}}
    assert joined(kept, {**after, "answers": ["c"]}) == {**kept, "answers": ["b", "c"]}
    # Two editions have other numbers under one place; and whose they were is kept.
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
