"""Sealed data, verbatim, since students' files must open for ever, and the choice of variants."""

import base64
import hashlib
import json
import random
import zlib
from pathlib import Path
from types import SimpleNamespace

import pytest

from coursework.checking import plugins, sealing, variants
from coursework.checking.fields import Misread
from coursework.checking.question import Question, Variant

KEY, OTHER = bytes(range(32)), bytes(range(32, 64))
LOCKERS = "ec1X`SmFiE+_b?>v8}2ByZ3AwB*W*cVTb|6_OglI"
CONTENT = {"b": "é", "a": [1]}
PAGE = "eK>N)P|ckL=SBO?cg#T9r@iIXLo<}<qh7tCKZB)VIrPp9AkoG_HmoKEYDqX4#`aza!rt3P"


def test_what_was_sealed_opens_for_ever():
    mistakes = sealing.locker(KEY, 1, [b"abcd", b"ef"])
    with_page = sealing.locker(OTHER, 0, page=7, page_key=b"12345678")
    assert sealing.pack([mistakes, with_page]) == sealing.pack([with_page, mistakes]) == LOCKERS
    assert sealing.open_locker(LOCKERS, KEY) == (1, None, b"abcdef\0\0")
    assert sealing.open_locker(LOCKERS, OTHER) == (0, 7, b"12345678")
    assert sealing.open_locker(LOCKERS, bytes(32)) is None
    assert sealing.mistakes_in(b"abcdef\0\0") == [b"abcd", b"ef\0\0"]
    assert sealing.mistakes_in(b"\0\0\0\1abcd") == [b"\0\0\0\1", b"abcd"]
    assert sealing.unseal(PAGE, KEY) == CONTENT
    assert sealing.lengthen("ON4L|^HLNJuLJ-", "a word or two") == "a word and é"
    assert sealing.slow_key("salt", "fingerprint é").hex() == (
        "1b5ff1ea43157a7f1ed28847922434f3a4cfa7275731c4fcde6422222b74720c"
    )


def test_what_fills_up_stays_the_same():
    filled = sealing.filled_up(LOCKERS, 4, "secret")
    assert filled == (
        "NR33iv59x@$Fdo{2xchTXHeX91<9{IozVVT-S=wIec1X`SmFiE+_b?>v8}2ByZ3AwB*W*cVTb|6_OglI"
    )
    assert sealing.count_of(filled) == 4 and sealing.open_locker(filled, OTHER)[1] == 7
    empty = [
        "paI_za-w%%`Pog0GG<wpU~+?<<2`1r1-c_!nuZ?Nvk42^cO4+G%a{bf_q1uU6F4F(5d!0&",
        "LGrBm@n{uS^az~8iG&EN8haDanc&kmFT@eH6$*vZGB=dX&<21&1b~5fb3Nag;_YI8z(B)r",
    ]
    assert sealing.pages_filled_up([], 2, "secret") == empty
    longer = sealing.seal([*range(99)], KEY)
    filled = sealing.pages_filled_up(iter([PAGE, longer]), 20, "secret")
    assert filled[:2] == [PAGE, longer] and len(set(filled)) == 20
    assert {len(page) for page in filled[2:]} == {len(PAGE), len(longer)}
    two = [base64.b85encode(bytes(length)).decode() for length in (56, 104)]
    drawn = sealing.pages_filled_up(two, 20, "secret")[2:]
    assert "".join("sl"[len(page) > 70] for page in drawn) == "lssllssllsllllllsl"
    names = [sealing.name_of(KEY), sealing.name_of(OTHER)]
    assert sealing.pack_names([*names, names[0]], 4) == "F!qvwdKo_doEMX@(7xyf"
    assert len(base64.b85decode(sealing.pack_names(names, 2))) == 2 * sealing.NAME
    assert names[0] == b"z\x19>\xff"


@pytest.mark.parametrize("password", [b"", b"password", b"a" * 64, b"b" * 65])
def test_a_browsers_slow_hash_is_everybodys(password):
    right = hashlib.pbkdf2_hmac("sha256", password, b"salt", 3)
    assert sealing.portable_pbkdf2(password, b"salt", 3) == right


def test_what_was_changed_is_refused():
    data = base64.b85decode(PAGE)
    for place in range(len(data)):
        changed = bytearray(data)
        changed[place] ^= 1
        with pytest.raises(ValueError, match="does not match this key"):
            sealing.unseal(base64.b85encode(bytes(changed)).decode(), KEY)
    with pytest.raises(ValueError, match="does not match this key"):
        sealing.unseal(PAGE, OTHER)
    mistakes = sealing.locker(KEY, 1)
    assert sealing.open_locker(sealing.pack([mistakes]), KEY) == (1, None, bytes(8))
    for place in range(sealing.NAME, sealing.LOCKER):
        changed = bytearray(mistakes)
        changed[place] ^= 1
        with pytest.raises(ValueError, match="data has been changed"):
            sealing.open_locker(sealing.pack([bytes(changed)]), KEY)


# ---- variants ----------------------------------------------------------------------------------

PICTURE = '<svg width="9" height="7"><rect width="3"/><text>é &amp; "x"</text></svg>'


def test_who_gets_which_variant_never_changes():
    """A student who comes back, and the grader, find the same one."""
    students = ["Ada@Uni.example ", "ada@uni.example", "eda", ""]
    assert [variants.variant_of(student, "levers/see-saw", 16) for student in students] == [
        11,
        11,
        5,
        0,
    ]
    assert [variants.variant_of("ada", "a/b", count) for count in (0, 1, 2, 7)] == [0, 0, 1, 1]
    assert variants.variant_of("ada", "a/b", 97, "2027") == 41
    plain, named = (
        Variant(count=5, edition="e"),
        Variant(count=5, edition="e", names=tuple("vwxyz")),
    )
    orders = [
        variants.numbers_of_variants(student, "a/b", case, 5)
        for student in ("", " ADA ", "ben")
        for case in (plain, named)
    ]
    assert orders == [
        [0, 1, 2, 3, 4], [0, 1, 2, 3, 4], [1, 2, 3, 4, 0], [0, 3, 2, 1, 4], [1, 2, 3, 4, 0],
        [2, 4, 0, 3, 1],
    ]  # fmt: skip
    for case in (plain, named):
        order = variants.numbers_of_variants("ben", "a/b", case, 5)
        question = Question("vector", variant=case)
        numbers = [variants.own_variant("ben", "a/b", question, place) for place in range(6)]
        assert (
            numbers == [*order, order[0]]
            and variants.own_variant("ben", "a/b", question) == order[0]
        )
    assert variants.own_variant("ben", "a/b", Question("vector"), 1) == 0


def test_names_of_variants_follow_from_what_is_given_and_siblings_are_two():
    full = Variant(given={"b": 1, "a": 2}, shown={"c": "3"})
    names = variants.names_of_variants([full, full, Variant(), full, Variant(given={"c": "3"})])
    first, empty, last = "bb4224fbae1c", "44136fa355b3", "b71907f1f20f"
    assert names == [first, f"{first}+", empty, f"{first}++", last]
    assert [variants.siblings_of("a/b", count) for count in range(5)] == [
        [], [], ["a/b/sibling"], *[["a/b/sibling", "a/b/sibling-2"]] * 2,
    ]  # fmt: skip
    names = {"a/b": ("a/b", 0), "a/b/sibling": ("a/b", 1), "a/b/sibling-9": ("a/b", 9)}
    assert {name: variants.without_sibling(name) for name in names} == names


def test_a_picture_stands_in_the_text_and_its_words_in_plain_text():
    assert zlib.decompress(base64.b85decode(variants.packed(PICTURE, 'Up & "on"'))) == (
        json.dumps([PICTURE, 'Up & "on"']).encode()
    )
    many = "".join(random.Random(4).choice("abc") for _ in range(3000))
    best = base64.b85encode(zlib.compress(json.dumps([many, ""]).encode(), 9)).decode()
    assert variants.packed(many, "") == best
    variant = Variant(
        text="*See* {{picture}}, `{{arm}}` {{arm}} $F$ {{leg}}, `m*g` * 3", shown={"arm": "2"},
        picture=variants.packed(PICTURE, 'Up & "on"'),
    )  # fmt: skip
    text = variants.text_of(variant)
    data = base64.b64encode(PICTURE.encode()).decode()
    assert text == (
        '*See* <p><img alt="Up &amp; &quot;on&quot;" width="9" '
        f'src="data:image/svg+xml;base64,{data}"></p>, `2` 2 $F$ {{{{leg}}}}, `m*g` * 3'
    )
    with pytest.raises(Misread, match="^A picture should be a list of two"):
        variants.text_of(Variant(picture=base64.b85encode(zlib.compress(b"[1]")).decode()))
    shown_variant = variants.Given(text, {"arm": 2, "_leg": 3})
    assert (
        repr(shown_variant) == 'See Up & "on", 2 2 F {{leg}}, m*g * 3'
        and shown_variant._repr_markdown_() == text
    )
    assert shown_variant.arm == shown_variant["arm"] == 2 and not hasattr(shown_variant, "_leg")
    with pytest.raises(AttributeError, match="^_leg$"):
        shown_variant.__getattr__("_leg")
    with pytest.raises(AttributeError, match="gives `arm`, `_leg`, but not `force`"):
        shown_variant.__getattr__("force")


# ---- plug-ins ----------------------------------------------------------------------------------


def test_plug_ins_bring_packages_folders(monkeypatch, tmp_path):
    old = SimpleNamespace(__name__="old.course", PACKAGES=("numpy", "old"))
    new = SimpleNamespace(__name__="new", PACKAGES=("sympy", "numpy"))
    bare = SimpleNamespace(__name__="bare")
    monkeypatch.setattr(plugins, "plugins", lambda: [old, new, bare])
    assert plugins.packages() == ["old", "numpy", "new", "sympy", "bare"]
    monkeypatch.setattr(plugins.resources, "files", lambda module: tmp_path / module.__name__)
    (tmp_path / "new" / "sealed").mkdir(parents=True)
    (tmp_path / "old.course").mkdir()
    assert plugins.sealed_folders() == [tmp_path / "new" / "sealed"]
    folders = plugins.folders_of(["json", "no_such_package", "base64"])
    assert folders == [str(Path(json.__file__).parent)]
