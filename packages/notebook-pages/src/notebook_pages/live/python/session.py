"""Runs the cells of a page and says what they put out: the Python side of code in the page.

The same file runs in the browser, in Pyodide, and at build time, where it finds out which cells
need more than SymPy. Results take the forms that IPython gives them, so that they equal the stored
ones. Everything goes to the page as JSON, through one function.
"""

import ast
import base64
import builtins
import contextlib
import importlib
import inspect
import io
import json
import linecache
import sys
import time
import tokenize
import traceback
import types

import IPython
import plain_numpy
from IPython.display import display
from IPython.lib import pretty

REPRESENTATIONS = {
    "text/html": "_repr_html_",
    "text/markdown": "_repr_markdown_",
    "image/svg+xml": "_repr_svg_",
    "image/png": "_repr_png_",
    "text/latex": "_repr_latex_",
}
WIDGET = "application/vnd.jupyter.widget-view+json"
MOST_CHARACTERS = 60_000  # that one cell may print; a page holds no more with comfort
FIRST_LINES = 50  # sent one by one
PAUSE = 0.1  # seconds between two messages after that


class Missing:
    """First in line to answer an import: names the packages that are not here, and why."""

    def __init__(self):
        self.reasons = {}

    def find_spec(self, name, path=None, target=None):
        top = name.partition(".")[0]
        if top in self.reasons:
            raise ModuleNotFoundError(self.reasons[top], name=top)
        return None

    def cause(self, error):
        """The missing package that ``error`` comes from, or None."""
        while error is not None:
            if isinstance(error, ModuleNotFoundError) and error.name in self.reasons:
                return error.name
            error = error.__cause__ or error.__context__
        return None


class Absent(types.ModuleType):
    """Stands for a missing package until it is used: many a cell imports NumPy for later ones."""

    def __getattr__(self, attribute):
        # Other libraries ask this of any module.
        if attribute in ("__path__", "__file__", "__wrapped__"):
            raise AttributeError(attribute)
        return getattr(importlib.import_module(self.__name__), attribute)


class Formatter:
    """How values of some types are shown in one form: the part of IPython's that SymPy sets."""

    def __init__(self, method=None):
        self.method, self.type_printers = method, {}

    def for_type(self, kind, printer):
        self.type_printers[kind] = printer

    def __call__(self, value):
        for kind in type(value).__mro__:
            if kind in self.type_printers:
                return self.type_printers[kind](value)
        method = getattr(value, self.method, None)
        return method() if callable(method) and not isinstance(value, type) else None


class PlainFormatter(Formatter):
    def __init__(self):
        super().__init__()
        self.type_printers = dict(pretty._type_pprinters)

    def __call__(self, value):
        stream = io.StringIO()
        printer = pretty.RepresentationPrinter(stream, type_pprinters=self.type_printers)
        printer.pretty(value)
        printer.flush()
        return stream.getvalue()


class DisplayFormatter:
    def __init__(self):
        self.formatters = {form: Formatter(method) for form, method in REPRESENTATIONS.items()}
        self.formatters["text/plain"] = PlainFormatter()

    def format(self, value):
        """The forms of ``value``, a dictionary from MIME types."""
        data = {}
        bundle = getattr(value, "_repr_mimebundle_", None)
        if callable(bundle) and not isinstance(value, type):
            data = bundle()
            data = dict(data[0] if isinstance(data, tuple) else data)
            if WIDGET in data:
                data[WIDGET] = data[WIDGET]["model_id"]
        for form, formatter in self.formatters.items():
            if form not in data and (text := formatter(value)) is not None:
                data[form] = base64.b64encode(text).decode() if isinstance(text, bytes) else text
        return {form: text for form, text in data.items() if isinstance(text, str)}


class Printed(io.TextIOBase):
    """Standard output or error of a cell, sent in batches and cut where it grows too long."""

    def __init__(self, shell, name):
        self.shell, self.name = shell, name
        self.start()

    def start(self):
        self.parts, self.room, self.dropped = [], MOST_CHARACTERS, 0
        self.messages, self.sent = 0, time.monotonic()

    def writable(self):
        return True

    def write(self, text):
        if not isinstance(text, str):
            raise TypeError(f"write() argument must be str, not {type(text).__name__}")
        kept = text[: self.room]
        self.room -= len(kept)
        self.dropped += len(text) - len(kept)
        if kept:
            self.parts.append(kept)
            # Send a few lines at once, so that they can be read while the cell works on.
            soon = self.messages < FIRST_LINES and kept.endswith("\n")
            if soon or time.monotonic() - self.sent > PAUSE:
                self.flush()
        return len(text)

    def flush(self):
        if self.parts:
            self.shell.send({"type": "stream", "name": self.name, "text": "".join(self.parts)})
            self.parts, self.messages, self.sent = [], self.messages + 1, time.monotonic()

    def finish(self):
        self.flush()
        if self.dropped:
            text = f"\n... and {self.dropped:,} more characters, which are not shown.\n"
            self.shell.send({"type": "stream", "name": self.name, "text": text})
        self.start()


class Events:
    """Tells packages when a cell begins and ends, as IPython's shell does."""

    def __init__(self):
        self.listeners = []

    def register(self, event, listener):
        self.listeners.append((event, listener))

    def trigger(self, event, about):
        for name, listener in self.listeners:
            if name == event:
                listener(about)


class Shell:
    """One run of Python for one page: its names, and how its values are shown."""

    # SymPy asks for this to choose a colour for pictures that nobody draws here.
    colors = "neutral"

    def __init__(self, send):
        self.send = lambda message: send(json.dumps(message))
        self.display_formatter = DisplayFormatter()
        self.events = Events()
        self.missing = Missing()
        self.printed = [Printed(self, "stdout"), Printed(self, "stderr")]
        main = types.ModuleType("__main__")
        self.names = main.__dict__
        self.names["__builtins__"] = vars(builtins) | {
            "__import__": self.import_module,
            "input": cannot_ask,
            "display": display,
            "get_ipython": lambda: self,
        }
        # SymPy looks for it among the names of Python itself.
        builtins.get_ipython = lambda: self
        sys.modules["__main__"] = main
        sys.meta_path.insert(0, self.missing)

    # --- packages -------------------------------------------------------------------------------

    def import_module(self, name, globals=None, locals=None, fromlist=(), level=0):
        try:
            return __import__(name, globals, locals, fromlist, level)
        except ModuleNotFoundError as error:
            if fromlist or level or name not in self.missing.reasons or error.name != name:
                raise
            return Absent(name)

    def lack(self, reasons):
        """Tell which packages are not here: a dictionary from their names to the reasons."""
        self.missing.reasons = reasons
        importlib.invalidate_caches()
        if "numpy" in reasons:
            plain_numpy.stand_in()
        else:
            plain_numpy.step_aside(self.names)
        for name, value in self.names.items():
            if isinstance(value, Absent) and value.__name__ not in reasons:
                self.names[name] = importlib.import_module(value.__name__)

    # --- figures that move ----------------------------------------------------------------------

    def open_line(self):
        """Have widgets talk with the page, through the package that is made for it and now here."""
        import comm
        from comm.base_comm import BaseComm

        class Line(BaseComm):
            def publish_msg(line, msg_type, data=None, metadata=None, buffers=None, **more):
                if buffers:
                    raise TypeError(
                        "a widget on this page can send numbers, text, lists and dictionaries, not "
                        "bytes"
                    )
                self.send({"type": msg_type, "id": line.comm_id, "data": data})

            # The original would report to the events of IPython's shell.
            def handle_msg(line, message):
                line._msg_callback(message)

        comm.create_comm = Line

    def hear(self, name, data):
        """Take what the page says to the widget ``name``: JSON, in the
        form of Jupyter's own messages.
        """
        import comm

        message = {"content": {"comm_id": name, "data": json.loads(data)}, "buffers": []}
        with self.printing():
            comm.get_comm_manager().comm_msg(None, None, message)

    def showtraceback(self):
        """Print the error that is being handled: widgets ask for it where an observer fails."""
        told = traceback.TracebackException.from_exception(sys.exception(), compact=True)
        shorten(told)
        print("".join(told.format()).rstrip(), file=sys.stderr)

    # --- showing --------------------------------------------------------------------------------

    def show(self, value, kind="display"):
        for stream in self.printed:
            stream.flush()
        self.send({"type": kind, "data": self.display_formatter.format(value)})

    def clear(self):
        for stream in self.printed:
            stream.start()
        self.send({"type": "clear"})

    def show_plots(self):
        """Show the figures of Matplotlib that the cell has left open, as Jupyter does."""
        if "matplotlib.pyplot" not in sys.modules:
            return
        import matplotlib.pyplot as plt

        for number in plt.get_fignums():
            picture = io.StringIO()
            with plt.rc_context({"svg.hashsalt": "orientation", "svg.fonttype": "path"}):
                plt.figure(number).savefig(
                    picture, format="svg", bbox_inches="tight", metadata={"Date": None}
                )
            self.send({"type": "display", "data": {"image/svg+xml": picture.getvalue()}})
            plt.close(number)

    # --- running --------------------------------------------------------------------------------

    async def run(self, code, name):
        """Run one cell; return its outcome as JSON.

        The outcome has a ``status``: 'ok' (and whether ``plain`` Python computed in the place of
        NumPy), 'error' (with a ``traceback``), 'interrupted', or 'missing' (with the ``package``
        that is not here, and the reason).
        """
        linecache.cache[name] = (len(code), None, code.splitlines(keepends=True), name)
        plain_numpy.begin()
        self.events.trigger("pre_run_cell", types.SimpleNamespace(raw_cell=code))
        with self.printing():
            try:
                await self.execute(code, name)
                outcome = {"status": "ok", "plain": plain_numpy.work > 0}
            except KeyboardInterrupt:
                outcome = {"status": "interrupted"}
            except BaseException as error:
                outcome = self.explain(error, name)
        succeeded = types.SimpleNamespace(success=outcome["status"] == "ok")
        self.events.trigger("post_run_cell", succeeded)
        return json.dumps(outcome)

    @contextlib.contextmanager
    def printing(self):
        """Send to the page what is printed meanwhile."""
        before = sys.stdout, sys.stderr
        sys.stdout, sys.stderr = self.printed
        try:
            yield
        finally:
            for stream in self.printed:
                stream.finish()
            sys.stdout, sys.stderr = before

    async def execute(self, code, name):
        tree = ast.parse(code, name)
        last = None
        if tree.body and isinstance(tree.body[-1], ast.Expr) and not ends_in_semicolon(code):
            last = ast.Expression(tree.body.pop().value)
        await self.evaluate(tree, name, "exec")
        if last is not None and (value := await self.evaluate(last, name, "eval")) is not None:
            self.show(value, "result")
        self.show_plots()

    async def evaluate(self, tree, name, mode):
        """Run a part of a cell, which may await something outside any function."""
        compiled = compile(tree, name, mode, ast.PyCF_ALLOW_TOP_LEVEL_AWAIT, dont_inherit=True)
        value = eval(compiled, self.names)
        return await value if compiled.co_flags & inspect.CO_COROUTINE else value

    def explain(self, error, name):
        package = self.missing.cause(error)
        if package is None and "numpy" in self.missing.reasons and plain_numpy.is_at_fault(error):
            package = "numpy"
        if package:
            return {
                "status": "missing",
                "package": package,
                "reason": self.missing.reasons[package],
            }
        told = traceback.TracebackException.from_exception(error, compact=True)
        shorten(told)
        if isinstance(error, SyntaxError) and error.filename == name:
            # The parser's own lines do not belong to the cell's traceback.
            told.stack.clear()
        return {
            "status": "error",
            "name": type(error).__name__,
            "traceback": "".join(told.format()).rstrip() + hint(error, name),
        }


def hint(error, name):
    """A word to those who import what is not here, or know Jupyter's own commands, which are not
    Python."""
    if isinstance(error, ModuleNotFoundError) and "." not in (error.name or "."):
        return (
            f"\n\n{error.name} is not part of this page's Python, and nothing can be installed "
            "here: it has the standard library, SymPy, and what this book's own cells use. Check "
            "the spelling, or take the notebook away and run it in your own Jupyter."
        )
    if not isinstance(error, SyntaxError) or error.filename != name:
        return ""
    line = (error.text or "").strip()
    if line.startswith(("%", "!")):
        command = line.lstrip("%!").split()[0] if line.lstrip("%!").split() else ""
        if command in ("pip", "conda"):
            return (
                "\n\nOn this page nothing can be installed: it has SymPy and this book's own "
                "packages."
            )
        if command in ("time", "timeit"):
            return (
                "\n\nCommands that begin with % are Jupyter's. Here: import timeit, and call "
                "timeit.timeit."
            )
        return "\n\nCommands that begin with % or ! are Jupyter's; this page has only Python."
    if line.endswith("?") or line.startswith("?"):
        return f"\n\nThe question mark is Jupyter's. Here: help({line.strip('?')})"
    return ""


def cannot_ask(prompt=""):
    raise RuntimeError("input() cannot ask on this page: write the value into the code instead")


def ends_in_semicolon(code):
    tokens = tokenize.generate_tokens(io.StringIO(code).readline)
    skipped = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.ENDMARKER, tokenize.DEDENT)
    return [token.string for token in tokens if token.type not in skipped][-1:] == [";"]


def shorten(told):
    """Keep of a traceback the cells' own lines: what a package says helps, and
    not the line of it that says so.
    """
    while told is not None:
        frames = [frame for frame in told.stack if frame.filename != __file__]
        own = [frame for frame in frames if frame.filename.startswith("cell ")]
        # This is an infinite recursion.
        if len(own) > 12:
            own = own[:4] + own[-4:]
        told.stack = traceback.StackSummary.from_list(own or frames[-1:])
        told = told.__cause__ or (None if told.__suppress_context__ else told.__context__)


def start(send):
    """Start the one shell of this run of Python; ``send`` takes each message, as JSON."""
    IPython.shell = Shell(send)
    return IPython.shell
