"""Find small changes of the code that no test notices.

mutmut lists the possible changes. The tests are collected once, and run once to record which lines
each of them reaches. For every change we fork that process, replace the function by the changed
one, and run the tests that reach the changed statement, until one fails. Tests that have noticed
changes there before go first, then the quick ones. A change survives if all of them pass, and is
printed: either a test is missing, or the change has no effect. ``mutants.txt`` lists the changes of
the second kind, each with its reason. We skip those, and report each entry there that no change
matches any more.

    python -m tools.mutants orientation [MODULE...] [--jobs 2]
    python -m tools.mutants coursework.checking [MODULE...]

Some changes are not made. Strings with spaces, or in pieces, are left alone because no test checks
exact wording. So are types, which only a type checker reads; the case of letters in a codec's name;
the codec of a file, which is the machine's default wherever the tests run; and the exact bound of a
comparison with a tolerance or a non-integer, on which a rounded number lies only by chance.
"""

import __future__

import argparse
import ast
import contextlib
import difflib
import importlib
import os
import pickle
import resource
import signal
import sys
import tempfile
import time
from collections import Counter, defaultdict
from pathlib import Path
from typing import NamedTuple

import coverage
import libcst as cst
import pytest
from libcst import matchers
from libcst.metadata import MetadataWrapper, PositionProvider
from mutmut.mutation.file_mutation import create_mutations

#: The packages to change, and the tests that should notice the changes.
PARTS = {
    "orientation": ("src/orientation", ("tests/orientation",)),
    "coursework.checking": (
        "packages/coursework/src/coursework/checking",
        (
            "packages/coursework/src/coursework/checking",
            "packages/coursework/tests/checking",
            "packages/coursework/tests/authoring/test_further_kinds.py",
            "packages/coursework/tests/authoring/test_variants.py",
            "packages/orientation-lab/tests/course/test_checks.py",
            "packages/orientation-lab/tests/course/test_formats.py",
        ),
    ),
}
#: Changes without an effect, with the reasons.
KNOWN = Path(__file__).with_name("mutants.txt")
#: A test counts as endless after this many seconds of processor time, or this many times its usual
#: time.
PATIENCE, TIMES = 2.0, 10.0
MEMORY = 4 << 30
ORDERS = (cst.LessThan, cst.LessThanEqual, cst.GreaterThan, cst.GreaterThanEqual)
NOTICED, PASSED, NO_FUNCTION = 1, 0, 3


class Mutant(NamedTuple):
    """A change of one function.

    Attributes
    ----------
    module : str
    owner : str or None
        The class of a method.
    function : str
    source : str
        The changed function, in its class if it has one.
    lines : range
        Those of the changed statement, in the file.
    shown : str
        The lines that differ.
    """

    def entry(self):
        """Return the entry of this change in the list of known ones."""
        owner = f"{self.owner}." if self.owner else ""
        return f"{self.module}.{owner}{self.function}\n{self.shown}"

    module: str
    owner: str | None
    function: str
    source: str
    lines: range
    shown: str


def mutants_of(path, module):
    """Yield every :class:`Mutant` of a file."""
    text = path.read_text()
    tree, mutations, *_ = create_mutations(str(path), text)
    owners = {
        id(method): statement.name.value
        for statement in tree.body
        if isinstance(statement, cst.ClassDef)
        for method in statement.body.body
    }
    pieces = {
        id(piece)
        for text in matchers.findall(tree, matchers.ConcatenatedString())
        for piece in (text.left, text.right)
    }
    left_of = {}
    for comparison in matchers.findall(tree, matchers.Comparison()):
        left = comparison.left
        for target in comparison.comparisons:
            left_of[id(target)], left = left, target.comparator
    lines = MetadataWrapper(tree, unsafe_skip_copy=True).resolve(PositionProvider)
    statements = _statements(text)
    for mutation in mutations:
        function, node = mutation.contained_by_top_level_function, mutation.original_node
        wording = isinstance(node, cst.SimpleString) and (" " in node.value or id(node) in pieces)
        if not isinstance(function, cst.FunctionDef) or wording:
            continue
        if isinstance(mutation.mutated_node, cst.ComparisonTarget):
            sides = left_of[id(node)], node.comparator
            if isinstance(mutation.mutated_node.operator, ORDERS) and any(map(_is_rounded, sides)):
                continue
        owner = owners.get(id(function))
        changed = function.deep_replace(node, mutation.mutated_node)
        before, after = _source(function, None), _source(changed, None)
        if _as_it_runs(before) == _as_it_runs(after):
            continue
        place = lines.get(node) or lines[function]
        yield Mutant(
            module,
            owner,
            function.name.value,
            _source(changed, owner),
            statements(place.start.line),
            _difference(before, after),
        )


def _is_rounded(side):
    parts = matchers.findall(side, matchers.Float() | matchers.Name())
    return any(
        "tolerance" in part.value.lower() if isinstance(part, cst.Name) else float(part.value) % 1
        for part in parts
    )


def _source(function, owner):
    body = [function.with_changes(leading_lines=[])]
    if owner:
        body = [cst.ClassDef(cst.Name(owner), cst.IndentedBlock(body))]
    return cst.Module(body).code


class _Runs(ast.NodeTransformer):
    """Remove code that is only for a type checker, and normalise the names of codecs."""

    def visit_Call(self, node):
        self.generic_visit(node)
        of_type = isinstance(node.func, ast.Name) and node.func.id == "cast" and len(node.args) == 2
        places = {"read_text": 0, "write_text": 1}
        if isinstance(node.func, ast.Attribute) and node.func.attr in places:
            node.args = node.args[: places[node.func.attr]]
        return node.args[1] if of_type else node

    def visit_Constant(self, node):
        return ast.Constant(node.value.lower()) if node.value in ("UTF8", "ASCII") else node


def _as_it_runs(source):
    return ast.dump(_Runs().visit(ast.parse(source)))


def _difference(before, after):
    lines = difflib.ndiff(before.splitlines(), after.splitlines())
    return "\n".join(
        f"{line[0]} {line[2:].strip()}" for line in lines if line[0] in "-+" and line[2:].strip()
    )


def known():
    """Return the entries of the changes that have no effect."""
    blocks = KNOWN.read_text("utf8").split("\n\n")
    return {"\n".join(line for line in b.splitlines() if line[:1] != "#") for b in blocks} - {""}


def _statements(text):
    """Return a function from a line to the lines of its statement; of a compound one, the head."""
    lines_of_statement = {}

    def look(node):
        for child in ast.iter_child_nodes(node):
            look(child)
        if isinstance(node, (ast.stmt, ast.ExceptHandler)):
            body = getattr(node, "body", None)
            whole = not body or isinstance(node, (ast.FunctionDef, ast.ClassDef))
            end = node.end_lineno if whole else max(node.lineno, body[0].lineno - 1)
            for line in range(node.lineno, end + 1):
                lines_of_statement.setdefault(line, range(node.lineno, end + 1))

    look(ast.parse(text))
    return lambda line: lines_of_statement.get(line, range(line, line + 1))


class Run:
    """A pytest plug-in that tries the changes once the tests are collected."""

    def __init__(self, folder, package, modules, jobs):
        self.folder, self.package, self.wanted, self.jobs = folder, package, modules, jobs
        self.in_child = False
        self.known, self.used, self.counts = known(), set(), Counter()
        self.noticed_by = defaultdict(Counter)  # tests, by function
        self.busy = {}

    def pytest_runtest_logreport(self, report):
        if self.in_child and report.failed:
            os._exit(NOTICED)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session):
        self.items = {item.nodeid: item for item in session.items}
        reached, self.seconds, failed = self._reached_by_tests()
        if failed:
            say("These fail without any change, and are left out:", *sorted(failed), sep="\n  ")
        say(f"{len(self.seconds)} tests, {sum(self.seconds.values()):.0f} s of the processor")
        paths = {path.stem: path for path in sorted(self.folder.glob("*.py"))}
        for path in [paths[name] for name in self.wanted or paths]:
            module = self.package + ("" if path.stem == "__init__" else f".{path.stem}")
            begun, before = time.monotonic(), Counter(self.counts)
            importlib.import_module(module)
            by_line = reached.get(str(path.resolve()), {})
            for mutant in mutants_of(path, module):
                tests = {test for line in mutant.lines for test in by_line.get(line, ())} - failed
                while len(self.busy) >= self.jobs:
                    self._end_one()
                self._try(path, mutant, tests)
            while self.busy:
                self._end_one()
            for change in sorted(self.known - self.used):
                if change.startswith(f"{self.package}.{path.stem}."):
                    self.counts["no longer made"] += 1
                    say(f"NO LONGER MADE, in {KNOWN.name}\n{change}")
            spent = (time.monotonic() - begun) / 60
            counts = self.counts - before
            say(f"== {path.name}: {_told(counts)}; {counts.total() / spent:.0f} a minute")
        say(f"== all: {_told(self.counts)}")
        return True

    def _reached_by_tests(self):
        """Return tests by line by file, seconds by test, and the tests that fail."""
        with tempfile.TemporaryDirectory() as folder:
            results_file = Path(folder) / "told"
            pid = os.fork()
            if not pid:
                with _quiet():
                    results_file.write_bytes(pickle.dumps(self._watched()))
                os._exit(0)
            if os.waitpid(pid, 0)[1]:
                raise SystemExit("The tests ended their own process.")
            return pickle.loads(results_file.read_bytes())

    def _watched(self):
        failed, seconds, items = set(), {}, list(self.items.values())

        class Watch:
            def pytest_runtest_logreport(self, report):
                if report.failed:
                    failed.add(report.nodeid)

        items[0].config.pluginmanager.register(Watch())
        watcher = coverage.Coverage(
            data_file=None, include=[f"{self.folder.resolve()}/*"], config_file=False
        )
        watcher.start()
        for item, following in zip(items, [*items[1:], None]):
            watcher.switch_context(item.nodeid)
            begun = time.process_time()
            item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
            seconds[item.nodeid] = time.process_time() - begun
        watcher.stop()
        data = watcher.get_data()
        return (
            {file: data.contexts_by_lineno(file) for file in data.measured_files()},
            seconds,
            failed,
        )

    def _try(self, path, mutant, tests):
        place = f"{path}:{mutant.lines.start}"
        if mutant.entry() in self.known:
            self.used.add(mutant.entry())
            self.counts["explained"] += 1
            return None
        if not tests:
            self.counts["no test"] += 1
            return say(f"NO TEST {place}\n{mutant.entry()}")
        noticed_by = self.noticed_by[mutant.module, mutant.owner, mutant.function]
        order = sorted(tests, key=lambda test: (-noticed_by[test], self.seconds[test]))
        reading, writing = os.pipe()
        pid = os.fork()
        if not pid:
            os.close(reading)
            with _quiet():
                os._exit(self._child(mutant, order, writing))
        os.close(writing)
        self.busy[pid] = reading, noticed_by, place, mutant

    def _child(self, mutant, order, writing):
        self.in_child = True
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        try:
            if not put_in_place(mutant):
                return NO_FUNCTION
        except Exception:
            # The changed function cannot even be defined.
            return NOTICED
        items = [self.items[test] for test in order]
        for item, following in zip(items, [*items[1:], None]):
            os.write(writing, f"{item.nodeid}\n".encode())
            seconds = PATIENCE + TIMES * self.seconds[item.nodeid]
            signal.setitimer(signal.ITIMER_PROF, seconds)
            signal.setitimer(signal.ITIMER_REAL, 60 + 60 * seconds)
            item.ihook.pytest_runtest_protocol(item=item, nextitem=following)
        return PASSED

    def _end_one(self):
        pid, status = os.wait()
        reading, noticed_by, place, mutant = self.busy.pop(pid)
        with os.fdopen(reading) as reading_end:
            tests = reading_end.read().splitlines()
        code = os.waitstatus_to_exitcode(status)
        if code == PASSED:
            self.counts["survived"] += 1
            say(f"SURVIVED {place}, {len(tests)} tests\n{mutant.entry()}")
        elif code == NO_FUNCTION:
            self.counts["out of reach"] += 1
        else:
            self.counts["noticed" if code == NOTICED else "ended by force"] += 1
            if tests:
                noticed_by[tests[-1]] += 1


def put_in_place(mutant):
    """Give a function the code of its mutant, wherever it has been imported.

    Returns False if there is no such function.
    """
    module = sys.modules[mutant.module]
    names = dict(vars(module))
    flags = __future__.annotations.compiler_flag
    exec(compile(mutant.source, module.__file__, "exec", flags, dont_inherit=True), names)
    right, changed = vars(module), names
    if mutant.owner:
        right, changed = vars(right[mutant.owner]), vars(changed[mutant.owner])
    right, changed = _plain(right.get(mutant.function)), _plain(changed[mutant.function])
    if right is None:
        return False
    right.__code__ = changed.__code__
    right.__defaults__, right.__kwdefaults__ = changed.__defaults__, changed.__kwdefaults__
    return True


def _plain(function):
    return getattr(function, "__func__", function)


@contextlib.contextmanager
def _quiet():
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)
    try:
        yield
    except BaseException:
        os._exit(NOTICED)


def _told(counts):
    whole = counts.total()
    return ", ".join([f"{whole} changes", *(f"{counts[key]} {key}" for key in sorted(counts))])


def say(*words, sep=" "):
    print(*words, sep=sep, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("part", choices=PARTS, help="the package to change")
    parser.add_argument("modules", nargs="*", help="modules to change (default: all)")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count(), help="processes (default: one per processor)"
    )
    parser.add_argument("--tests", nargs="+", help="tests to run (default: all of the package)")
    options = parser.parse_args()
    folder, tests = PARTS[options.part]
    run = Run(Path(folder), options.part, options.modules, options.jobs)
    left_out = [f"-pno:{name}" for name in ("cacheprovider", "times")]
    arguments = ["-q", "-s", "-n0", *left_out, "-m", "not long", *(options.tests or tests)]
    return pytest.main(arguments, plugins=[run]) or any(
        run.counts[outcome] for outcome in ("survived", "no test", "no longer made")
    )


if __name__ == "__main__":
    raise SystemExit(main())
