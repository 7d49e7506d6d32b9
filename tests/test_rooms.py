"""The rooms of the repository: imports run one way, and courses use coursework by its plug-in."""

import ast
import json
import subprocess
import sys
from functools import cache
from importlib import metadata

import pytest
from places import REPOSITORY

from coursework.checking import plugins, questions
from coursework.checking.question import Question
from notebook_pages.paths import PACKAGES

#: What the modules of a room may import of this repository's packages, the room itself not named.
MAY_IMPORT = {
    "orientation": (),
    "orientation_figures": ("orientation", "orientation_workbench"),
    "orientation_recordings": ("orientation",),
    "orientation_workbench": ("orientation",),
    "coursework.checking": (),
    "coursework.authoring": ("coursework.checking",),
    "coursework.grading": ("coursework.checking", "coursework.authoring"),
    "orientation_course": ("coursework", "orientation", "orientation_figures"),
    "notebook_pages": (),
}
# In grading, each step of a notebook's way uses only earlier steps, and the shared modules.
WAY = ("submissions", "execution", "judging", "reporting", "export")
BESIDE = ("locks", "reading", "record", "store", "tables", "versions", "workers")
PAGES = REPOSITORY / "packages" / "notebook-pages" / "src" / "notebook_pages"
OURS = {*PACKAGES, "notebook_pages"}


def folder_of(room):
    package, *inner = room.split(".")
    return PACKAGES.get(package, PAGES).joinpath(*inner)


@cache
def imports(path):
    """Return the imports of a module, wherever in it they are."""
    nodes = ast.walk(ast.parse(path.read_text("utf8")))
    return [node for node in nodes if isinstance(node, (ast.Import, ast.ImportFrom))]


def imported(path, sources):
    """Iterate over the absolute names that a module imports, including relative imports."""
    package = path.relative_to(sources).parent.parts
    for node in imports(path):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        else:
            start = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join([*start, *([node.module] if node.module else [])])
            # The imported name may be a module itself.
            yield from (f"{module}.{name.name}" for name in node.names)


def foreign(room, allowed):
    """Return a room's imports of our packages that are neither in the room nor allowed."""
    folder, sources = folder_of(room), folder_of(room.partition(".")[0]).parent
    return [
        f"{path.relative_to(sources)} imports {name}"
        for path in folder.rglob("*.py")
        for name in imported(path, sources)
        if name.partition(".")[0] in OURS
        and not any(f"{name}.".startswith(f"{package}.") for package in (room, *allowed))
    ]


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_imports_run_one_way(room):
    of_all = (" imports coursework", " imports coursework.__version__")
    assert [name for name in foreign(room, MAY_IMPORT[room]) if not name.endswith(of_all)] == []


@pytest.mark.parametrize("room", WAY)
def test_grading_follows_a_notebook_on_its_way(room):
    # Gradescope grades there.
    before = [
        *WAY[: WAY.index(room)],
        *BESIDE,
        *(["assignments", "grade"] if room == "export" else []),
    ]
    allowed = [
        "coursework.checking",
        "coursework.authoring",
        *(f"coursework.grading.{name}" for name in before),
    ]
    assert foreign(f"coursework.grading.{room}", allowed) == []


def test_every_package_is_registered():
    """This covers all package folders but the one that makes the pages."""
    folders = {path.parent for path in REPOSITORY.glob("src/*/__init__.py")}
    folders |= {path.parent for path in REPOSITORY.glob("packages/*/src/*/__init__.py")}
    assert folders == {*PACKAGES.values(), PAGES}


def test_checking_needs_no_course():
    """Without plug-ins, there are the kinds that no course owns, and a check reports its search."""
    program = (
        "from importlib import metadata\nmetadata.entry_points = lambda **wanted: []\n"
        "import sys, coursework\nfrom coursework.checking.plugins import kinds\n"
        "assert 'expression' in kinds() and 'quaternion' not in kinds()\n"
        "assert not [name for name in sys.modules if name.startswith('orientation')]\n"
        "try:\n    coursework.check('statics/lever', 1)\nexcept KeyError as error:\n"
        "    print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert "no package with sealed questions is installed" in done.stdout


def test_a_folder_beside_the_notebook_comes_first(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    questions.notebook_questions.cache_clear()
    asked = {"statics/lever": {"kind": "expression", "salt": "0", "lockers": ""}}
    (tmp_path / "sealed").mkdir()
    (tmp_path / "sealed" / "statics.json").write_text(
        json.dumps({"format": questions.FORMAT, "questions": asked})
    )
    try:
        assert questions.find_question("statics/lever", "").question == Question("expression", "0")
        assert (
            questions.find_question("simple-orientations/boom", "").question.kind
            == "direction cosine matrix"
        )
        with pytest.raises(questions.NoSuchQuestion, match="Did you mean 'statics/lever'"):
            questions.find_question("statics/level", "")
    finally:
        questions.notebook_questions.cache_clear()


class Broken(metadata.EntryPoint):
    dist = type("Distribution", (), {"name": "statics-course", "version": "1.0"})


def test_a_plugin_that_cannot_be_loaded_is_named(monkeypatch):
    broken = Broken("statics", "no_such_module_of_statics", plugins.GROUP)
    monkeypatch.setattr(metadata, "entry_points", lambda group: [broken])
    with pytest.raises(
        RuntimeError, match="statics.*no_such_module_of_statics.*statics-course 1.0"
    ):
        plugins.plugins.__wrapped__()


def test_a_kind_of_question_has_one_owner(monkeypatch):
    plugin = type("plugin", (), {"__name__": "statics", "KINDS": {"expression": plugins.Kind()}})
    monkeypatch.setattr(plugins, "plugins", lambda: [plugin])
    with pytest.raises(RuntimeError, match="'expression', but another kind already has"):
        plugins.kinds.__wrapped__()


def circles():
    """Return the sets of modules that need each other, including imports within functions."""
    needed = {}
    for folder in (*PACKAGES.values(), PAGES):
        modules = {
            path: path.relative_to(folder.parent).with_suffix("").parts
            for path in folder.rglob("*.py")
        }
        for path, parts in modules.items():
            # The version of the package, which is in the package itself, is no use of its modules.
            names = {
                name for name in imported(path, folder.parent) if not name.endswith(".__version__")
            }
            needed[".".join(parts).removesuffix(".__init__")] = names
    for module, names in needed.items():
        # The imported name is a module, or is in one.
        modules = {name if name in needed else name.rpartition(".")[0] for name in names}
        needed[module] = (modules & needed.keys()) - {module}

    def reached(module):
        reachable, waiting = set(), [module]
        while waiting:
            new = needed[waiting.pop()] - reachable
            reachable |= new
            waiting += new
        return reachable

    all_reached = {module: reached(module) for module in needed}
    return {
        frozenset({module, *(name for name in names if module in all_reached[name])})
        for module, names in all_reached.items()
        if module in names
    }


def test_no_modules_need_each_other():
    """This includes circles that an import within a function hides."""
    assert circles() == set()


def private(name):
    return name.startswith("_") and not name.startswith("__")


def test_no_private_name_crosses_a_room():
    """A private module is for its folder, and a private name for its module."""
    crossings = []
    for folder in (*PACKAGES.values(), PAGES):
        for path in folder.rglob("*.py"):
            for name in imported(path, folder.parent):
                *module, last = name.split(".")
                if name.partition(".")[0] in OURS and (
                    private(last) or any(map(private, module[:-1]))
                ):
                    inside = module == list(path.relative_to(folder.parent).parent.parts)
                    crossings += (
                        [] if inside else [f"{path.relative_to(folder.parent)} imports {name}"]
                    )
    assert crossings == []
