"""A newer archive beside a student's work: what happens to each file, and the messages."""

import json
import os
import sys
import zipfile
from importlib.metadata import version
from types import SimpleNamespace

import pytest

from coursework.checking import update as module
from coursework.checking.update import ArchiveRefused, digest_of, manifest, update

OLD_WHEEL, NEW_WHEEL = "levers-1.9-py3-none-any.whl", "levers-1.10-py3-none-any.whl"


def notebook(*sources, **more):
    cells = [{"cell_type": "code", "source": source, **more} for source in sources]
    return json.dumps({"cells": cells, **more}).encode()


def zipped(path, files, folder="exercises/"):
    with zipfile.ZipFile(path, "w") as box:
        box.mkdir(folder.rstrip("/") or "empty")
        for name, data in files.items():
            box.writestr(folder + name, data)
    return path


@pytest.fixture
def work(tmp_path):
    folder = tmp_path / "work"
    (folder / "sealed").mkdir(parents=True)
    return folder


def contents(folder):
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


def handed_out(folder, files):
    for name, data in files.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(data)
    (folder / "manifest.json").write_text(manifest(files, "Levers"))


def test_what_becomes_of_each_file(work, tmp_path):
    handed_out(
        work,
        {
            "same.ipynb": notebook("one"), "old.ipynb": notebook("one"), "run.ipynb": notebook("1"),
            "mine.ipynb": notebook("one"), "kept.txt": b"one", "README.txt": b"one",
            "sealed/a.json": b"one", "sealed/b.json": b"one", OLD_WHEEL: b"one",
            "requirements.txt": f"numpy\n./{OLD_WHEEL}\n".encode(),
        },
    )  # fmt: skip
    (work / "run.ipynb").write_bytes(notebook("1", outputs=["2"]))
    (work / "mine.ipynb").write_bytes(notebook("changed"))
    (work / "kept.txt").write_bytes(b"changed")
    (work / "unknown.txt").write_bytes(b"of a student")
    with (work / "requirements.txt").open("a") as file:
        file.write("scipy\n")
    (work / "another-1-py3-none-any.whl").write_bytes(b"")
    (work / "levers.whl").write_bytes(b"")
    files = {
        "same.ipynb": notebook("one"), "old.ipynb": notebook("two"), "run.ipynb": notebook("2"),
        "mine.ipynb": notebook("two"), "kept.txt": b"one", "README.txt": b"two",
        "unknown.txt": b"two", "new.ipynb": notebook("two"), "sealed/a.json": b"two",
        "sealed/b.json": b"one", "sealed/variants/a-1.json": b"two", NEW_WHEEL: b"two",
        "requirements.txt": f"./{NEW_WHEEL}\nnumpy\n".encode(),
    }  # fmt: skip
    archive = zipped(tmp_path / "new.zip", files | {"manifest.json": b"{}"})
    install = f"Now run this:\n\n    {sys.executable} -m pip install {work / NEW_WHEEL}\n"
    assert update(archive, work) == [
        "replaced    README.txt, which you had not changed",
        "kept yours  kept.txt, since the archive has no newer one",
        f"replaced    {OLD_WHEEL}",
        "kept yours  mine.ipynb, and put the new version in mine-new-1.ipynb",
        "added       new.ipynb",
        "replaced    old.ipynb, which you had not changed",
        "changed     requirements.txt",
        "replaced    run.ipynb, which you had not changed",
        "the same    same.ipynb",
        "replaced    sealed/a.json",
        "the same    sealed/b.json",
        "added       sealed/variants/a-1.json",
        "kept yours  unknown.txt, and put the new version in unknown-new-1.txt",
        install,
    ]
    now = contents(work)
    known = json.loads(now.pop("manifest.json"))["files"]
    students_files = {"kept.txt": b"changed", "mine.ipynb": notebook("changed"), "levers.whl": b""}
    students_files |= {"unknown.txt": b"of a student", "another-1-py3-none-any.whl": b""}
    students_files |= {"requirements.txt": f"numpy\n./{NEW_WHEEL}\nscipy\n".encode()}
    beside = {"mine-new-1.ipynb": notebook("two"), "unknown-new-1.txt": b"two"}
    assert now == files | students_files | beside
    digests = {name: digest_of(name, data) for name, data in (files | beside).items()}
    assert known == digests | {OLD_WHEEL: digest_of(OLD_WHEEL, b"one")}
    # A second time, everything is there already.
    again = update(archive, work)
    assert {line[:12] for line in again[:-1]} == {"the same    ", "kept yours  ", "changed     "}
    assert contents(work) | {"manifest.json": b""} == now | {"manifest.json": b""}


def test_what_is_put_beside_takes_no_other_files_place(work, tmp_path):
    (work / "a.txt").write_bytes(b"mine")
    for number, data in enumerate((b"two", b"three", b"four"), 1):
        archive = zipped(tmp_path / "new.zip", {"a.txt": data, "b.ipynb": notebook()})
        line = update(archive, work)[0]
        # An unchanged earlier addition is replaced, while one that somebody changed stays.
        place = 1 if number < 3 else 2
        assert line == f"kept yours  a.txt, and put the new version in a-new-{place}.txt"
        assert (work / f"a-new-{place}.txt").read_bytes() == data
        if number == 2:
            (work / "a-new-1.txt").write_bytes(b"mine, too")
    assert (work / "a-new-1.txt").read_bytes() == b"mine, too"


# Some programs on Windows write backslashes between folders.
@pytest.mark.parametrize("between", "/\\")
def test_an_archive_without_a_folder_and_the_folder_where_one_is(
    between, work, tmp_path, monkeypatch
):
    inside = between.join(["exercises", "sealed", "variants", "a-1.json"])
    zipped(tmp_path / "flat.zip", {"a.ipynb": notebook(), inside: b"", NEW_WHEEL: b""}, folder="")
    (work / "sealed").rmdir()
    (work / NEW_WHEEL.replace("py3", "py2")).write_bytes(b"")  # It has the same version.
    monkeypatch.chdir(work)
    assert update("../flat.zip")[:3] == [
        "added       a.ipynb",
        "added       sealed/variants/a-1.json",
        f"replaced    {NEW_WHEEL.replace('py3', 'py2')}",
    ]
    assert (work / "a.ipynb").read_bytes() == notebook()
    assert [path.name for path in work.glob("*.whl")] == [NEW_WHEEL]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda path: None,
            "new.zip does not exist .the current folder is .*Put the downloaded archive there",
        ),
        (lambda path: path.mkdir(), "new.zip is a folder.*Put the downloaded archive there"),
        (
            lambda path: path.write_text("<html>"),
            "new.zip is not a complete zip archive.*Download it again",
        ),
        (lambda path: zipped(path, {"a.txt": b""}), "contains no notebook.*Download it again"),
        (
            lambda path: zipped(path, {"a.ipynb": b"", "levers-1.8-py3-none-any.whl": b""}),
            "older than this folder: it has version 1.8 of the package, but the folder has 1.10.",
        ),
        (
            lambda path: zipped(path, {"a.ipynb": b"", "levers-1.9.dev7-py3-none-any.whl": b""}),
            "it has version 1.9.dev7 .* the folder has 1.10.",
        ),
    ],
)
def test_what_is_no_newer_archive_changes_nothing(make, words, work, tmp_path):
    handed_out(work, {NEW_WHEEL: b"one"})
    before = contents(work)
    make(tmp_path / "new.zip")
    with pytest.raises(ArchiveRefused, match=f"(?s){words}"):
        update(tmp_path / "new.zip", work)
    assert contents(work) == before


def test_an_archive_of_before_takes_no_newer_ones_place(work, tmp_path):
    """Nothing else shows which is older: the package and the files' times are the same."""
    files = [{"a.ipynb": notebook(word), NEW_WHEEL: b""} for word in ("one", "two", "three")]
    first, second, third = (
        zipped(
            tmp_path / f"{k}.zip", {**these, "manifest.json": manifest(these, "Levers").encode()}
        )
        for k, these in enumerate(files)
    )
    with zipfile.ZipFile(first) as box:
        for entry in box.namelist():
            if not entry.endswith("/"):
                (work / entry.removeprefix("exercises/")).write_bytes(box.read(entry))
    update(first, work)
    assert update(second, work)[0].startswith("replaced")
    before = contents(work)
    with pytest.raises(ArchiveRefused, match="from .*0.zip, and from a newer archive since"):
        update(first, work)
    assert contents(work) == before
    assert [line[:8] for line in update(second, work)[:1]] == ["the same"]
    assert contents(work) == before and update(third, work)[0].startswith("replaced")
    for older in (first, second):
        with pytest.raises(ArchiveRefused, match="You have already updated this folder"):
            update(older, work)
    with pytest.raises(ArchiveRefused, match="There is no folder .*elsewhere"):
        update(third, tmp_path / "elsewhere")
    these = {"b.ipynb": notebook("one")}
    foreign = {**these, "manifest.json": manifest(these, "Gears").encode()}
    with pytest.raises(ArchiveRefused, match="to the course 'Gears', and this folder to 'Levers'"):
        update(zipped(tmp_path / "foreign.zip", foreign), work)


def test_a_manifest_that_cannot_be_read_knows_nothing_and_a_newer_one_refuses(work, tmp_path):
    archive = zipped(tmp_path / "new.zip", {"a.ipynb": notebook("two")})
    for text in ("no JSON", "[]", '{"format": 1, "files": 7}', '{"format": "1", "files": {}}'):
        (work / "a.ipynb").write_bytes(notebook("one"))
        (work / "manifest.json").write_text(text)
        assert update(archive, work) == [
            "kept yours  a.ipynb, and put the new version in a-new-1.ipynb"
        ]
    (work / "manifest.json").write_text('{"format": 2, "files": {}}')
    with pytest.raises(ArchiveRefused, match="^manifest.json .* has format 2, .* reads 1[.]"):
        update(archive, work)


def test_the_digest_of_a_notebook_is_of_what_its_cells_say():
    same = [notebook("a\nb", "c"), notebook(["a\n", "b"], ["c"]), notebook("a\nb", "c", outputs=1)]
    assert {digest_of("a.ipynb", data) for data in same} == {"2ee94483cbd98ccc4a6ee492ac20b795"}
    different = [
        notebook("a\nb c"),
        notebook("c", "a\nb"),
        b"",
        b"[]",
        b'{"cells": [1]}',
        b'{"a": 1}',
    ]
    different += [same[0].replace(b"code", b"markdown")]
    assert len({digest_of("a.ipynb", data) for data in same + different}) == 1 + len(different)
    assert digest_of("a.txt", b"text") == "982d9e3eb996f559e633f4d194def376"
    assert len({digest_of("a.txt", data) for data in same}) == 3
    assert manifest({"b": b"text", "a": b"text"}, "Levers") == (
        '{\n"course": "Levers",\n"files": {\n"a": "982d9e3eb996f559e633f4d194def376",\n'
        '"b": "982d9e3eb996f559e633f4d194def376"\n},\n"format": 1\n}\n'
    )


def test_what_is_installed_is_not_installed_again(work, tmp_path, monkeypatch):
    here = f"pytest-{version('pytest')}-py3-none-any.whl"
    files = {"a.ipynb": notebook(), here: b"", "requirements.txt": b""}
    (work / "requirements.txt").write_text("numpy\n")
    assert update(zipped(tmp_path / "new.zip", files), work) == [
        "added       a.ipynb", f"added       {here}", "changed     requirements.txt",
    ]  # fmt: skip
    assert (work / "requirements.txt").read_text() == f"./{here}\nnumpy\n"
    files = {"a.ipynb": notebook(), "pytest-0.1-py3-none-any.whl": b"", NEW_WHEEL: b""}
    folder = tmp_path / "a b"
    folder.mkdir()
    archive = zipped(tmp_path / "new.zip", files)
    both = f'"{folder / NEW_WHEEL}" "{folder / "pytest-0.1-py3-none-any.whl"}"'
    for platform, command in (("linux", '"/a python"'), ("win32", "python")):
        monkeypatch.setattr(
            module, "sys", SimpleNamespace(platform=platform, executable="/a python")
        )
        line = update(archive, folder)[-1]
        assert line == f"Now run this:\n\n    {command} -m pip install {both}\n"


def test_a_newer_download_beside_an_older_one_is_named(work, tmp_path):
    """A browser numbers the second one, and its reader types the name in the README."""
    old = zipped(tmp_path / "exercises.zip", {"one.ipynb": notebook("one")})
    of_a_mac = {".DS_Store": b"0", "._one.ipynb": b"\0\5\26\7"}
    new = zipped(tmp_path / "exercises (1).zip", {"one.ipynb": notebook("two"), **of_a_mac})
    os.utime(old, (1, 1))
    before = contents(work)
    with pytest.raises(ArchiveRefused, match=r'newer archive beside .*"exercises \(1\)\.zip"'):
        update(old, work)
    assert contents(work) == before
    update(new, work)
    assert contents(work)["one.ipynb"] == notebook("two") and not of_a_mac.keys() & contents(work)
