"""The hostile corpus: attacks by a notebook on the machine, its neighbours and its marks.

Each attack is one cell of a small notebook, between two honest ones. It knows these names:

    CANARY    a file outside, which it must neither read nor change
    TRAP      a path outside at which nothing may appear
    TCP, UDP  ports, and LOCAL a local socket, whose listeners must receive nothing
    GRADER    the ID of the grading process
    SECRET    two halves of a word that is only in the neighbour's notebook

An attack that succeeds calls `check("loot", "taken")`, or does what `check` would.
"""

import dataclasses

ESCAPES = ("namespaces", "landlock")
SYSTEM = ("namespaces", "landlock", "seccomp")


@dataclasses.dataclass(frozen=True)
class Attack:
    """One attack.

    Attributes
    ----------
    name : str
    code : str
        The cell.
    outcome : str
        The expected outcome of the cell; "a or b" if it depends on the machine.
    without : tuple of str
        The layers without which the same cell succeeds; empty if that cannot be tested.
    forges : bool
        Whether a grader that decides in the student's process would give a mark for it.
    spoils : bool
        Whether it breaks the tools in its own process, so that its own later answers may be lost.
    noticed : bool
        Whether the record must say that something other than records came.
    waits : bool
        Whether only wall time ends it.
    """

    name: str
    code: str
    outcome: str = "error"
    without: tuple = ()
    forges: bool = False
    spoils: bool = False
    noticed: bool = False
    waits: bool = False


ATTACKS = [
    # ---- to count as right
    Attack(
        "equality that is always true",
        """
class Right:
    def __eq__(self, other): return True
    def __ne__(self, other): return False
    def __hash__(self): return 0
answer = Right()
check("loot", answer)
""",
        "done",
        forges=True,
    ),
    Attack(
        "a number that equals every number",
        """
class Right(int):
    def __eq__(self, other): return True
    __hash__ = int.__hash__
answer = Right(7)
check("loot", answer)
""",
        "done",
        forges=True,
    ),
    Attack(
        "a text that equals every text",
        """
class Right(str):
    def __eq__(self, other): return True
    __hash__ = str.__hash__
    def __str__(self): return self
answer = Right("taken"[::-1])
check("loot", answer)
""",
        "done",
        forges=True,
    ),
    Attack(
        "a matrix that equals every matrix",
        """
class Right(sympy.ImmutableDenseMatrix):
    def __eq__(self, other): return True
    __hash__ = sympy.ImmutableDenseMatrix.__hash__
answer = Right([[1]])
check("loot", answer)
""",
        "done",
        forges=True,
    ),
    Attack(
        "an object that says it is a number",
        """
class Right:
    __class__ = int
    numerator, denominator = 42, 1
    def __eq__(self, other): return True
    def bit_length(self): return 1
    def _sympy_(self): open(TRAP, "w"); return sympy.Integer(42)
    def __index__(self): open(TRAP, "w"); return 42
    def __float__(self): open(TRAP, "w"); return 42.0
answer = Right()
check("loot", answer)
""",
        "done",
        forges=True,
    ),
    Attack(
        "tampering with json",
        """
import json, json.encoder
json.dumps = lambda *a, **k: '{"mark": 1}'
json.JSONEncoder.encode = json.JSONEncoder.iterencode = lambda *a, **k: '{"answer": "loot", "mark": 1}'
json.encoder.encode_basestring_ascii = lambda text: '"taken"'
json.encoder.c_make_encoder = None
answer = 0
check("loot", answer)
""",
        "exited",
        forges=True,
        spoils=True,
    ),
    Attack(
        "tampering with os",
        """
import os
os.write = lambda handle, data: len(data)
os.getpid = lambda: GRADER
os.environ["MARK"] = "1"
check("loot", 0)
""",
        "done",
    ),
    Attack(
        "tampering with SymPy",
        """
sympy.Matrix.__eq__ = sympy.Basic.__eq__ = sympy.core.numbers.Integer.__eq__ = lambda self, other: True
sympy.core.numbers.Integer.__hash__ = lambda self: 0
sympy.Expr.equals = lambda self, other: True
answer = sympy.Integer(7)
check("loot", answer)
""",
        "done",
        forges=True,
        spoils=True,
    ),
    Attack(
        "tampering with the builtins",
        """
import builtins
builtins.isinstance = lambda *a: True
builtins.str = builtins.repr = lambda *a: "taken"
builtins.len = lambda *a: 0
check("loot", 0)
""",
        "exited",
        spoils=True,
    ),
    Attack(
        "tampering with the compiler and the syntax tree",
        """
import ast, builtins
ast.parse = ast.Compare = ast.NodeVisitor.visit = lambda *a, **k: None
original = builtins.compile
builtins.compile = lambda source, *rest, **options: original(
    "check('loot', 'right')" if isinstance(source, str) else source, *rest, **options)
""",
        "done",
        spoils=True,
    ),
    Attack(
        "tampering with the display hook",
        """
import sys
def hook(*arguments): raise SystemExit("displayed")
sys.displayhook = sys.excepthook = sys.unraisablehook = hook
display = print = hook
sys.settrace(lambda *a: None)
sys.setprofile(None)
1/0
""",
    ),
    Attack(
        "tampering with the modules",
        """
import sys
for name in [n for n in sys.modules if n.startswith(("coursework", "json", "sympy"))]:
    sys.modules[name] = None
import gc; gc.disable()
"""[:-1]
        + "\nraise RuntimeError",
        "error",
        spoils=True,
    ),
    Attack(
        "walking the frames and the heap for answers",
        """
import gc, sys
wanted, found, frame = "".join(SECRET), [], sys._getframe()
while frame is not None:
    found += [v for v in {**frame.f_locals, **frame.f_globals}.values() if isinstance(v, (str, bytes))]
    frame = frame.f_back
for thing in gc.get_objects():
    if isinstance(thing, dict): found += [v for v in list(thing.values()) if isinstance(v, (str, bytes))]
    elif isinstance(thing, (list, tuple)): found += [v for v in thing if isinstance(v, (str, bytes))]
if any((wanted if isinstance(v, str) else wanted.encode()) in v for v in found if v is not wanted):
    check("loot", "taken")
""",
        "done",
    ),
    Attack(
        "reading the parent's handles",
        """
import os, fcntl
for handle in range(5, 1024):
    try: data = os.read(handle, 10)
    except OSError: continue
    check("loot", "taken")
raise RuntimeError
""",
    ),
    Attack(
        "a forged verdict in the records",
        """
import os
for line in (b'{"answer": "loot", "from": "check", "cell": 1, "plain": {"value": ["text", "x"], "nodes": []},'
             b' "mark": 1}',
             b'{"question": "loot", "outcome": "correct", "mark": 1}', b'{"done": true, "mark": 1}',
             b'null', b'"', b'\\xff\\xfe',
             b'{"answer": "loot", "from": "check", "cell": 1e9, "plain": {"value": ["blank"], "nodes": []}}',
             b'{"answer": "loot", "from": "check", "cell": 1, "plain": NaN}',
             b'{"answer": "loot", "from": "grader", "cell": 1, "plain": {"value": ["blank"], "nodes": []}}',
             b'{"end": ["cell", 1], "outcome": "<script>alert(1)</script>"}'):
    os.write(4, line + b"\\n")
""",
        "done",
        noticed=True,
    ),
    Attack(
        "records nested a million deep",
        """
import os
data = b'{"answer": "loot", "from": "check", "cell": 1, "plain": ' + b"[" * 1_000_000 + b"\\n"
while data: data = data[os.write(4, data):]
""",
        "done",
        noticed=True,
    ),
    Attack(
        "records without end",
        """
import os
while True: os.write(4, b'{"begin": ["cell", 1]}\\n' * 2000)
""",
        "output",
    ),
    Attack(
        "one record without end",
        """
import os
while True: os.write(4, b"x" * 65536)
""",
        "output",
    ),
    Attack(
        "closing the records",
        """
import os
os.closerange(3, 100)
""",
        "exited",
    ),
    Attack(
        "swallowing the records",
        """
import os
os.dup2(1, 4)
""",
        "exited",
    ),
    Attack(
        "half characters in names",
        """
check("loot", sympy.Symbol("\\ud800"))
""",
        "done",
        noticed=True,
    ),
    Attack(
        "code in a symbol's name",
        """
answer = sympy.Symbol("__import__('os').close(__import__('os').open(TRAP, 66))")
check("loot", [answer, sympy.Function("<script>alert(1)</script>")(answer), sympy.Symbol("=cmd|'/c calc'!A1")])
""",
        "done",
    ),
    Attack(
        "a pickle that runs code",
        """
class Right:
    def __reduce__(self): return open, (TRAP, "w")
    __reduce_ex__ = __getstate__ = lambda self, *a: self.__reduce__()
    def __deepcopy__(self, memo): open(TRAP, "w")
    def __del__(self): pass
import pickle
answer = Right()
check("loot", [pickle.dumps(answer), answer])
""",
        "done",
    ),
    Attack(
        "a __repr__ that runs code",
        """
class Right:
    def __repr__(self): open(TRAP, "w"); return "taken"
    __str__ = __format__ = _repr_html_ = _repr_latex_ = __repr__
answer = Right()
check("loot", answer)
raise ValueError(answer)
""",
    ),
    # ---- to read, write and change what is outside
    Attack(
        "reading a file outside",
        """
if "SEALED" in open(CANARY).read(): check("loot", "taken")
""",
        without=ESCAPES,
    ),
    Attack(
        "reading a file outside by a bare system call",
        """
import ctypes, os
c = ctypes.CDLL(None, use_errno=True)
handle = c.open(CANARY.encode(), os.O_RDONLY)
buffer = ctypes.create_string_buffer(100)
if c.read(handle, buffer, 100) <= 0: raise OSError(ctypes.get_errno())
if b"SEALED" in buffer.value: check("loot", "taken")
""",
        without=ESCAPES,
    ),
    Attack(
        "reading a file outside through a link",
        """
import os
os.symlink(CANARY, "link")
if "SEALED" in open("link").read(): check("loot", "taken")
""",
        without=ESCAPES,
    ),
    Attack(
        "reading the folders of others",
        """
import os
if os.path.basename(CANARY) in os.listdir(os.path.dirname(CANARY)): check("loot", "taken")
""",
        without=ESCAPES,
    ),
    Attack(
        "reading another process",
        """
import os
for name in ("environ", "cmdline", "maps", "mem", "status"):
    try: open(f"/proc/{os.getppid()}/{name}", "rb").read(10)
    except OSError: continue
    check("loot", "taken")
raise RuntimeError
""",
        without=ESCAPES,
    ),
    Attack(
        "reading the environment",
        """
import os
if any("SEALED" in value for value in os.environ.values()): check("loot", "taken")
raise KeyError
""",
    ),
    Attack(
        "writing a file outside",
        """
with open(TRAP, "w") as file: file.write("x")
check("loot", "taken")
""",
        without=ESCAPES,
    ),
    Attack(
        "emptying a file outside",
        """
import os
os.close(os.open(CANARY, os.O_RDONLY | os.O_TRUNC))
check("loot", "taken")
""",
        without=ESCAPES,
    ),
    Attack(
        "removing a file outside",
        """
import os
os.replace(CANARY, CANARY + ".moved")
check("loot", "taken")
""",
        without=ESCAPES,
    ),
    Attack(
        "changing the mode of a file outside",
        """
import os
os.utime(CANARY)
check("loot", "taken")
""",
        without=SYSTEM,
    ),
    Attack(
        "changing a library",
        """
with open(sympy.__file__, "a") as file: file.write("#")
check("loot", "taken")
""",
    ),
    Attack(
        "mounting and changing the root",
        """
import ctypes
c = ctypes.CDLL(None, use_errno=True)
results = [c.unshare(0x10000000), c.mount(b"tmpfs", b"/", b"tmpfs", 0, None), c.chroot(b".")]
if 0 in results: check("loot", "taken")
raise OSError(ctypes.get_errno())
""",
        without=("seccomp",),
    ),
    # ---- to reach the network
    Attack(
        "a TCP connection",
        """
import socket
socket.create_connection(("127.0.0.1", TCP), 2).close()
check("loot", "taken")
""",
        without=SYSTEM,
    ),
    Attack(
        "a UDP packet",
        """
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.connect(("127.0.0.1", UDP))
s.send(b"x"); s.send(b"x")
check("loot", "taken")
""",
        without=SYSTEM,
    ),
    Attack(
        "a local socket",
        """
import socket
socket.socket(socket.AF_UNIX).connect("\\0" + LOCAL)
check("loot", "taken")
""",
        without=SYSTEM,
    ),
    Attack(
        "a bare socket call",
        """
import ctypes
c = ctypes.CDLL(None, use_errno=True)
for family, kind in ((2, 1), (2, 2), (2, 3), (10, 1), (16, 3), (17, 3), (40, 1), (38, 5), (1, 1)):
    if c.socket(family, kind, 0) >= 0: check("loot", "taken")
raise OSError(ctypes.get_errno())
""",
        without=("seccomp",),
    ),
    Attack(
        "fetching a page",
        """
import urllib.request
urllib.request.urlopen(f"http://127.0.0.1:{TCP}/", timeout=2)
check("loot", "taken")
""",
    ),
    Attack(
        "asking for a name",
        """
import socket
socket.getaddrinfo("example.org", 80)
check("loot", "taken")
""",
    ),
    # ---- to start and end processes
    Attack(
        "forks",
        """
import os
for _ in range(4):
    if os.fork() == 0: os._exit(0)
check("loot", "taken")
""",
        without=("seccomp",),
    ),
    Attack(
        "a program",
        """
import subprocess
subprocess.run(["true"])
check("loot", "taken")
""",
    ),
    Attack(
        "a program in its own place",
        """
import os, sys
os.execv(sys.executable, [sys.executable, "-c", "import os; os.open(TRAP, 66)"])
""",
    ),
    Attack(
        "a daemon",
        """
import os
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        import time
        time.sleep(600)
    os._exit(0)
check("loot", "taken")
""",
        without=("seccomp",),
    ),
    Attack(
        "a process by a bare system call",
        """
import ctypes, platform
c = ctypes.CDLL(None, use_errno=True)
number = {"x86_64": 56, "aarch64": 220}[platform.machine()]
result = c.syscall(number, 17, 0, 0, 0, 0)
if result == 0: c._exit(0)
if result > 0: check("loot", "taken")
raise OSError(ctypes.get_errno())
""",
        without=("seccomp",),
    ),
    Attack(
        "threads without end",
        """
import threading, time
stop = threading.Event()
threading.stack_size(65536)
try:
    for _ in range(3000): threading.Thread(target=stop.wait, daemon=True).start()
    check("loot", "taken")
finally: stop.set()
""",
        without=("resource limits",),
    ),
    Attack(
        "a thread that outlives its cell",
        """
import os, threading, time
threading.Thread(target=lambda: (time.sleep(0.05), os._exit(0))).start()
""",
        "done",
    ),
    Attack(
        "ending the parent",
        """
import os, signal
os.kill(os.getppid(), signal.SIGKILL)
check("loot", "taken")
""",
    ),
    Attack(
        "ending the grader",
        """
import os, signal
os.kill(GRADER, 0)
check("loot", "taken")
""",
        without=(*SYSTEM, "no privileges"),
    ),
    Attack(
        "ending everybody",
        """
import os, signal
os.kill(-1, signal.SIGKILL)
check("loot", "taken")
""",
    ),
    Attack(
        "tracing the parent",
        """
import ctypes, os
c = ctypes.CDLL(None, use_errno=True)
if c.ptrace(16, os.getppid(), None, None) == 0: check("loot", "taken")
raise OSError(ctypes.get_errno())
""",
    ),
    Attack(
        "stopping itself",
        """
import os, signal
os.kill(os.getpid(), signal.SIGSTOP)
""",
        "timeout",
        waits=True,
    ),
    Attack(
        "leaving by os._exit",
        """
import os
os._exit(0)
""",
        "exited",
    ),
    Attack(
        "leaving by sys.exit",
        """
import sys
sys.exit(0)
""",
    ),
    Attack(
        "a crash",
        """
import ctypes
ctypes.string_at(0)
""",
        "killed",
    ),
    Attack(
        "aborting",
        """
import os
os.abort()
""",
        "killed",
    ),
    Attack(
        "its own signals",
        """
import os, signal
signal.signal(signal.SIGALRM, signal.SIG_DFL)
signal.setitimer(signal.ITIMER_REAL, 0.01)
while True: pass
""",
        "killed",
    ),
    # ---- to use up time, memory, disk and patience
    Attack(
        "a loop without end",
        """
while True: pass
""",
        "timeout",
    ),
    Attack(
        "sleeping",
        """
import time
time.sleep(600)
""",
        "timeout",
        waits=True,
    ),
    Attack(
        "a loop that catches everything",
        """
while True:
    try:
        while True: pass
    except BaseException: pass
""",
        "timeout",
        waits=True,
    ),
    Attack(
        "a loop that ignores every signal",
        """
import signal
for number in range(1, 65):
    try: signal.signal(number, signal.SIG_IGN)
    except (OSError, ValueError): pass
signal.pthread_sigmask(signal.SIG_BLOCK, range(1, 65))
while True: pass
""",
        "timeout",
        waits=True,
    ),
    Attack(
        "one operation that never ends",
        """
7 ** (7 ** 12)
""",
        "timeout",
        waits=True,
    ),
    Attack(
        "a regular expression that never ends",
        """
import re
re.match("(a+)+$", "a" * 60 + "b")
""",
        "timeout",
        waits=True,
    ),
    Attack(
        "an answer that never ends",
        """
class Long(list):
    def __len__(self): return 1
    def __iter__(self):
        while True: yield 1
check("loot", Long())
""",
        "done",
    ),
    Attack(
        "a __repr__ that never ends",
        """
class Long(Exception):
    def __str__(self):
        while True: pass
    __repr__ = __str__
raise Long
""",
    ),
    Attack(
        "an answer that lies about its class for ever",
        """
class Long:
    @property
    def __class__(self):
        while True: pass
check("loot", Long())
""",
        "done",
    ),
    Attack(
        "memory",
        """
held = [bytes(1 << 20) for _ in range(400)]
check("loot", "taken")
""",
        "memory",
        without=("resource limits",),
    ),
    Attack(
        "memory that is mapped",
        """
import mmap
held = mmap.mmap(-1, 400 << 20)
check("loot", "taken")
""",
        without=("resource limits",),
    ),
    Attack(
        "memory outside the process",
        """
import ctypes, os
c = ctypes.CDLL(None, use_errno=True)
if c.shmget(0, 1 << 16, 0o1600) >= 0: check("loot", "taken")
os.memfd_create("held")
check("loot", "taken")
""",
        without=("seccomp",),
    ),
    Attack(
        "one long file",
        """
with open("long", "wb") as file:
    for _ in range(20): file.write(b"x" * (1 << 20))
check("loot", "taken")
""",
        without=("resource limits",),
    ),
    Attack(
        "many files",
        """
for number in range(20):
    with open(f"file{number}", "wb") as file: file.write(b"x" * (3 << 20))
import time
time.sleep(20)  # a folder on disk is looked at from time to time
check("loot", "taken")
""",
        "error or disk",
    ),
    Attack(
        "a deep tree left behind",
        """
import os
for _ in range(3000):
    os.mkdir("d", 0o700); os.chdir("d")
os.mkdir("closed", 0)
""",
        "done",
    ),
    Attack(
        "open files",
        """
import os
for _ in range(5000): os.dup(1)
check("loot", "taken")
""",
        without=("resource limits",),
    ),
    Attack(
        "output without end",
        """
while True: print("x" * 100_000)
""",
        "timeout",
    ),
    Attack(
        "recursion",
        """
import sys
sys.setrecursionlimit(10 ** 9)
class Deep:
    def __getattr__(self, name): return getattr(self, name + "x")
def deep(n): return sorted([1], key=lambda _: deep(n + 1))
deep(0)
""",
        # Python 3.14 and later notice that the stack is full, and raise an error.
        "killed or error",
    ),
    Attack(
        "taking away its own limits",
        """
import resource
resource.setrlimit(resource.RLIMIT_AS, (1 << 20, 1 << 20))
check("loot", "taken")
""",
        without=("seccomp",),
    ),
    Attack(
        "an enormous answer",
        """
check("loot", 7 ** 100_000)
check("loot", list(range(100_000)))
check("loot", "x" * 1_000_000)
x = sympy.Symbol("x")
for _ in range(200): x = sympy.sin(x)
check("loot", x)
check("loot", sympy.zeros(30, 30))
""",
        "done",
    ),
    Attack(
        "a question that does not exist",
        """
for number in range(2000): check("<script>" + str(number) * 100, 1)
check({}, 1)
""",
        "done",
    ),
    Attack(
        "using magic",
        """
%system touch /tmp/x
!kill -9 1
files = !cat {CANARY}
%run {TRAP}
if files: check("loot", "taken")
""",
        "done",
    ),
]
