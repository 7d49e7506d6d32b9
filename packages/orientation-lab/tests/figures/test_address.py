"""What an address of the book carries: the same for ever, and in words where it cannot be read."""

import json
import random
import re
import subprocess
import sys
from pathlib import Path

import pytest

from orientation_figures.moving import bundle

NODE = Path(sys.executable).with_name("node")
APPLY = """
import { readFileSync } from 'node:fs';
const functions = { fragmentOf, carriedBy };
const tried = (name, parts) => {
  try { return [functions[name](...parts)]; } catch (error) { return error.message; }
};
const jobs = JSON.parse(readFileSync(0));
console.log(JSON.stringify(jobs.map(([name, ...parts]) => tried(name, parts))));
"""
#: In characters of what is carried, as in ``js/address.js``.
LARGEST = 6000
#: Addresses that somebody may have kept, of each version that there ever
#: was: never changed, only added to.
KEPT = {
    "#fig-gimbal=1.eyJhbmdsZXMiOlswLjUsMCwwXX0": ("fig-gimbal", {"angles": [0.5, 0, 0]}),
    "#workbench=1.eyJhIjoiMSAwIDBcbjAgMSAwXG4wIDAgMSIsImIiOiLOuCA9IDMwwrAsIPCfp60ifQ": (
        "workbench",
        {"a": "1 0 0\n0 1 0\n0 0 1", "b": "\u03b8 = 30\u00b0, \U0001f9ed"},
    ),
}


@pytest.fixture(scope="module")
def in_browser_language(tmp_path_factory):
    script = tmp_path_factory.mktemp("node") / "address.mjs"
    script.write_text(bundle.body("address") + APPLY, "utf8")

    def run(*calls):
        done = subprocess.run(
            [NODE, script], input=json.dumps(calls), capture_output=True, text=True, check=True
        )
        return json.loads(done.stdout)

    return run


def contents(chance, count):
    def text():
        return "".join(
            chance.choice('aZ0 \n"\\<&%#=+/\u00e9\u03b8\u2028\U0001f9ed')
            for _ in range(chance.randrange(30))
        )

    def value(depth=0):
        kinds = [
            text,
            chance.random,
            lambda: chance.uniform(-1e9, 1e9),
            lambda: chance.randrange(-9, 9),
            lambda: None,
        ]
        kinds += [lambda: chance.random() < 0.5]
        if depth < 3:
            kinds += [lambda: [value(depth + 1) for _ in range(chance.randrange(4))]]
            kinds += [lambda: {text(): value(depth + 1) for _ in range(chance.randrange(4))}]
        return chance.choice(kinds)()

    return [{text(): value() for _ in range(chance.randrange(5))} for _ in range(count)]


def test_what_is_written_is_read(in_browser_language):
    chance = random.Random(20)
    samples = contents(chance, 300)
    written = [
        carried
        for (carried,) in in_browser_language(
            *(["fragmentOf", "fig-one", content] for content in samples)
        )
    ]
    for fragment in written:
        assert re.fullmatch(r"#[A-Za-z0-9.=_-]+", fragment), (
            "a program that passes it on would change it"
        )
    # Programs for messages often take what follows an address as its end.
    read = in_browser_language(
        *(["carriedBy", fragment + end] for end in ("", ").", "%3E") for fragment in written)
    )
    assert [carried for (carried,) in read] == 3 * [
        {"place": "fig-one", "content": content} for content in samples
    ]


def test_what_was_kept_is_read_for_ever(in_browser_language):
    read = in_browser_language(*(["carriedBy", fragment] for fragment in KEPT))
    assert [(carried["place"], carried["content"]) for (carried,) in read] == list(KEPT.values())


def test_a_plain_place_carries_nothing(in_browser_language):
    plain = [
        "",
        "#",
        "#fig-gimbal",
        "#section-2",
        "#a=b",
        "#a=1",
        "#Fig=1.abc",
        "#:~:text=1.5",
        "fig-gimbal",
    ]
    assert in_browser_language(*(["carriedBy", fragment] for fragment in plain)) == [[None]] * len(
        plain
    )


def test_what_cannot_be_read_is_said_in_words(in_browser_language):
    content = {"angles": [0.5, 0.25, 1.125], "text": "\u03b8"}
    ((whole,),) = in_browser_language(["fragmentOf", "fig-one", content])
    cut = [whole[:length] for length in range(len("#fig-one=1."), len(whole))]
    no_data = [
        "#a=1.W10",
        "#a=1.MQ",
        "#a=1.bnVsbA",
        "#a=1.%%%",
        "#a=1._w",
        "#a=1." + "A" * (LARGEST + 4),
    ]
    assert all(
        "incomplete" in message
        for message in in_browser_language(*(["carriedBy", fragment] for fragment in cut + no_data))
    )
    assert "newer edition" in in_browser_language(["carriedBy", "#fig-one=2.anything at all"])[0]


def test_too_much_is_refused_when_it_is_written(in_browser_language):
    for length in (LARGEST, 20 * LARGEST):
        assert "too long" in in_browser_language(["fragmentOf", "a", {"text": "x" * length}])[0]
