"""The rooms of the house: imports run one way, and a course meets coursework through its plug-in only."""

import ast
import json
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from coursework.checking import plugins, questions
from website.paths import PACKAGES

SOURCES = Path(__file__).resolve().parent.parent / "src"
#: What the modules of a room may import of this repository's packages, the room itself not named.
MAY_IMPORT = {
    "orientation": (),
    "orientation_figures": ("orientation", "orientation_workbench"),
    "orientation_recordings": (),
    "orientation_workbench": ("orientation",),
    "coursework/checking": (),
    "coursework/authoring": ("coursework.checking",),
    "coursework/grading": ("coursework.checking", "coursework.authoring"),
    "orientation_course": ("coursework", "orientation"),
}
OURS = {*PACKAGES, "website"}


def imported(path):
    """The absolute names that a module imports, those of relative imports made absolute."""
    package = path.relative_to(SOURCES).parent.parts
    for node in ast.walk(ast.parse(path.read_text("utf8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level + 1] if node.level else ()
            yield ".".join([*start, *([node.module] if node.module else [])])


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_imports_run_one_way(room):
    own, found = room.replace("/", "."), []
    for path in (SOURCES / room).rglob("*.py"):
        for name in imported(path):
            allowed = any(f"{name}.".startswith(f"{other}.") for other in (own, *MAY_IMPORT[room]))
            if name.partition(".")[0] in OURS and not allowed and name != "coursework":
                found.append(f"{path.relative_to(SOURCES)} imports {name}")
    assert found == []


def test_one_list_of_packages():
    """That of the site, of the folders, and of the program in Pyodide, which can import neither."""
    folders = {path.parent.name for path in SOURCES.glob("*/__init__.py")}
    assert folders == OURS
    program = ast.parse((SOURCES / "website" / "live" / "compile_wheels.py").read_text("utf8"))
    (ours,) = (one.value for one in program.body if isinstance(one, ast.Assign) and one.targets[0].id == "OURS")
    assert sorted(ast.literal_eval(ours)) == sorted(f"{name}/" for name in PACKAGES)


def test_checking_needs_no_course():
    """Without any plug-in there are the kinds that no course owns, and a check that says where it looked."""
    program = (
        "from importlib import metadata\nmetadata.entry_points = lambda **wanted: []\n"
        "import sys, coursework\nfrom coursework.checking.plugins import kinds\n"
        "assert 'expression' in kinds() and 'quaternion' not in kinds()\n"
        "assert not [name for name in sys.modules if name.startswith('orientation')]\n"
        "try:\n    coursework.check('statics/lever', 1)\nexcept KeyError as error:\n    print(error)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "no package with sealed questions is installed" in done.stdout


def test_a_folder_beside_the_notebook_comes_first(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    questions.notebook_questions.cache_clear()
    asked = {"statics/lever": {"kind": "expression", "salt": "0", "lockers": {}}}
    (tmp_path / "sealed").mkdir()
    (tmp_path / "sealed" / "statics.json").write_text(json.dumps({"format": questions.FORMAT, "questions": asked}))
    try:
        assert questions.find_question("statics/lever") == asked["statics/lever"]
        assert questions.find_question("simple-orientations/boom")["kind"] == "direction cosine matrix"
        with pytest.raises(questions.NoSuchQuestion, match="Did you mean 'statics/lever'"):
            questions.find_question("statics/level")
    finally:
        questions.notebook_questions.cache_clear()


class Broken(metadata.EntryPoint):
    dist = type("Distribution", (), {"name": "statics-course", "version": "1.0"})


def test_a_plugin_that_cannot_be_loaded_is_named(monkeypatch):
    broken = Broken("statics", "no_such_module_of_statics", plugins.GROUP)
    monkeypatch.setattr(metadata, "entry_points", lambda group: [broken])
    with pytest.raises(RuntimeError, match="statics.*no_such_module_of_statics.*statics-course 1.0"):
        plugins.plugins.__wrapped__()


def test_a_kind_of_question_has_one_owner(monkeypatch):
    plugin = type("plugin", (), {"__name__": "statics", "KINDS": {"expression": plugins.Kind()}})
    monkeypatch.setattr(plugins, "plugins", lambda: [plugin])
    with pytest.raises(RuntimeError, match="'expression'; there is one already"):
        plugins.kinds.__wrapped__()
