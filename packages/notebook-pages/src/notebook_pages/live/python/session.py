"""Run the cells of a page and report their output: the Python part of code in the page.

The same file runs in the browser, in Pyodide, and at build time, where it determines which cells
need more than SymPy. Results have the forms that IPython gives them, so that they equal the stored
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
# The most characters of one cell, because more would make a page slow.
MOST_CHARACTERS = 60_000
# The first lines of a cell are sent individually.
FIRST_LINES = 50
# Seconds between two messages after that.
PAUSE = 0.1


class Missing:
    """An import hook before all others: it names the packages that are missing, and why."""

    def __init__(self):
        self.reasons = {}

    def find_spec(self, name, path=None, target=None):
        top = name.partition(".")[0]
        if top in self.reasons:
            raise ModuleNotFoundError(self.reasons[top], name=top)
        return None

    def cause(self, error):
        """Return the missing package that caused ``error``, or None."""
        while error is not None:
            if isinstance(error, ModuleNotFoundError) and error.name in self.reasons:
                return error.name
            error = error.__cause__ or error.__context__
        return None


class Absent(types.ModuleType):
    """Replace a missing package until it is used: many cells import NumPy only for later ones."""

    def __getattr__(self, attribute):
        # Other libraries ask any module for these attributes.
        if attribute in ("__path__", "__file__", "__wrapped__"):
            raise AttributeError(attribute)
        return getattr(importlib.import_module(self.__name__), attribute)


class Formatter:
    """The representation of some types in one form: the part of IPython's that SymPy sets."""

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
        """Return the forms of ``value``, a dictionary from MIME types."""
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
    """Standard output or error of a cell, sent in batches and cut off when it grows too long."""

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
        accepted = text[: self.room]
        self.room -= len(accepted)
        self.dropped += len(text) - len(accepted)
        if accepted:
            self.parts.append(accepted)
            # Send the first lines at once, so that they can be read while the cell runs.
            soon = self.messages < FIRST_LINES and accepted.endswith("\n")
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
    """Notify packages when a cell begins and ends, as IPython's shell does."""

    def __init__(self):
        self.listeners = []

    def register(self, event, listener):
        self.listeners.append((event, listener))

    def trigger(self, event, about):
        for name, listener in self.listeners:
            if name == event:
                listener(about)


class Shell:
    """The Python process of one page: its names, and how its values are shown."""

    # SymPy asks for this to choose a colour for pictures that are not drawn here.
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
            "breakpoint": cannot_ask,
            # Python's own functions would also close the standard input, which help() looks at.
            "exit": sys.exit,
            "quit": sys.exit,
            "display": display,
            "get_ipython": lambda: self,
        }
        # SymPy looks for this among the built-in names.
        builtins.get_ipython = lambda: self
        sys.modules["__main__"] = main
        sys.meta_path.insert(0, self.missing)

    # --- packages -------------------------------------------------------------------------------

    def import_module(self, name, globals=None, locals=None, fromlist=(), level=0):
        try:
            # Only the real NumPy has the list of its names. SymPy, which imports all of NumPy for
            # `lambdify`, does not come here.
            if fromlist and "*" in fromlist and name.partition(".")[0] == "numpy":
                plain_numpy.real()
            return __import__(name, globals, locals, fromlist, level)
        except ModuleNotFoundError as error:
            if fromlist or level or name not in self.missing.reasons or error.name != name:
                raise
            return Absent(name)

    def lack(self, reasons):
        """Record which packages are missing: a dictionary from their names to the reasons."""
        self.missing.reasons = reasons
        importlib.invalidate_caches()
        if "numpy" in reasons:
            plain_numpy.stand_in()
        else:
            plain_numpy.step_aside(self.names)
        self.names.update({
            name: importlib.import_module(value.__name__)
            for name, value in self.names.items()
            if isinstance(value, Absent) and value.__name__ not in reasons
        })  # fmt: skip

    # --- figures that move ----------------------------------------------------------------------

    def open_line(self):
        """Connect widgets with the page, through the package ``comm``, which is now installed."""
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

            # The original method would report to the events of IPython's shell.
            def handle_msg(line, message):
                line._msg_callback(message)

        comm.create_comm = Line

    def hear(self, name, data):
        """Pass a message from the page to the widget ``name``: JSON, in the form of Jupyter's."""
        import comm

        message = {"content": {"comm_id": name, "data": json.loads(data)}, "buffers": []}
        with self.printing():
            comm.get_comm_manager().comm_msg(None, None, message)

    def showtraceback(self):
        """Print the error that is being handled; widgets call this when an observer fails."""
        report = traceback.TracebackException.from_exception(sys.exception(), compact=True)
        shorten(report)
        print("".join(report.format()).rstrip(), file=sys.stderr)

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

        The outcome has a ``status``: 'ok' (and whether ``plain`` Python replaced NumPy), 'error'
        (with a ``traceback``), 'interrupted', or 'missing' (with the ``package`` that is missing,
        and the reason).
        """
        if code.startswith(">>>"):
            # Of a session of Python, copied from a docstring, keep only what was typed.
            code = "\n".join(
                line[4:] for line in code.splitlines() if line.startswith((">>>", "..."))
            )
        linecache.cache[name] = (len(code), None, code.splitlines(keepends=True), name)
        plain_numpy.begin()
        info = types.SimpleNamespace(raw_cell=code, cell_id=name)
        self.events.trigger("pre_run_cell", info)
        with self.printing():
            try:
                await self.execute(code, name)
                outcome = {"status": "ok", "plain": plain_numpy.work > 0}
            except KeyboardInterrupt:
                outcome = {"status": "interrupted"}
            except BaseException as error:
                outcome = self.explain(error, name)
                # IPython stores it there, and packages look there for it.
                sys.last_value = error
            self.events.trigger(
                "post_run_cell",
                types.SimpleNamespace(success=outcome["status"] == "ok", info=info),
            )
        return json.dumps(outcome)

    @contextlib.contextmanager
    def printing(self):
        """Send printed text to the page."""
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
            self.names["_"] = value
            self.show(value, "result")
        self.show_plots()

    async def evaluate(self, tree, name, mode):
        """Run a part of a cell, which may use ``await`` outside any function."""
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
        report = traceback.TracebackException.from_exception(error, compact=True)
        shorten(report)
        if isinstance(error, SyntaxError) and error.filename == name:
            # The parser's own lines do not belong to the cell's traceback.
            report.stack.clear()
        return {
            "status": "error",
            "name": type(error).__name__,
            "traceback": "".join(report.format()).rstrip() + hint(error, name),
        }


ONLY_PYTHON = "Commands that begin with % or ! work only in Jupyter; this page has only Python."
COMMANDS = dict.fromkeys(
    ("pip", "conda"),
    "Nothing can be installed on this page. It has SymPy and this book's own packages.",
) | dict.fromkeys(
    ("time", "timeit"),
    "Commands that begin with % work only in Jupyter. Here, import timeit and call timeit.timeit.",
)


def hint(error, name):
    """Explain to readers what this page lacks: packages, Jupyter's commands, a program to end."""
    if isinstance(error, SystemExit):
        return "\n\nOn this page only the cell ends. Python and all names are still there."
    if isinstance(error, ModuleNotFoundError) and "." not in (error.name or "."):
        return (
            f"\n\n{error.name} is not part of this page's Python, and nothing can be installed "
            "here. This page has the standard library, SymPy, and what this book's own cells use. "
            "Check the spelling, or download the notebook and run it in your own Jupyter."
        )
    if not isinstance(error, SyntaxError) or error.filename != name:
        return ""
    line = (error.text or "").strip()
    if line.startswith(("%", "!")):
        return "\n\n" + COMMANDS.get(line.lstrip("%! ").partition(" ")[0], ONLY_PYTHON)
    if line.endswith("?") or line.startswith("?"):
        return f"\n\nThe question mark works only in Jupyter. Here, write help({line.strip('?')})"
    return ""


def cannot_ask(prompt=""):
    raise RuntimeError(
        "input() and breakpoint() do not work on this page: write the value into the code instead"
    )


def ends_in_semicolon(code):
    tokens = tokenize.generate_tokens(io.StringIO(code).readline)
    skipped = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.ENDMARKER, tokenize.DEDENT)
    return [token.string for token in tokens if token.type not in skipped][-1:] == [";"]


def shorten(report):
    """Keep only the cells' own lines of a traceback.

    The message of a package helps, but not its line of code.
    """
    while report is not None:
        frames = [frame for frame in report.stack if frame.filename != __file__]
        own = [frame for frame in frames if frame.filename.startswith("cell ")]
        # Such a long traceback comes from an infinite recursion.
        if len(own) > 12:
            own = own[:4] + own[-4:]
        report.stack = traceback.StackSummary.from_list(own or frames[-1:])
        report = report.__cause__ or (None if report.__suppress_context__ else report.__context__)


def start(send):
    """Start the only shell of this Python process; ``send`` takes each message, as JSON."""
    IPython.shell = Shell(send)
    return IPython.shell
