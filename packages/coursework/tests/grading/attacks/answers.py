"""Attacks by answers: notebooks whose answers might earn points without being right.

Each is one cell before the check of one question of the small course, which assigns what is
checked. It knows, as a student may:

    POINTS  the values of the symbols at which the check of ``turns/sum`` compares
    VALUES  the values of a right answer there
    CALLS   the arguments with which the check calls the function of ``turns/doubled``
    TABLE   what a friend's right function returned for them

None may earn a point for its question, or cost the others theirs.
"""

import dataclasses


@dataclasses.dataclass(frozen=True)
class Forged:
    """An answer that is not right.

    Attributes
    ----------
    name : str
    question : str
        The last part of the question's name.
    code : str
        The cell.
    outcome : str
        The expected outcome; "a or b" if either will do.
    beside : dict
        Files that are handed in beside the notebook.
    spoils : bool
        Whether it breaks the tools in its own process, so that its own other answers may be lost.
    """

    name: str
    question: str
    code: str
    outcome: str = "wrong"
    beside: dict = dataclasses.field(default_factory=dict)
    spoils: bool = False


#: Find the reader's own names, as anybody could.
IN_ITS_READER = """
import sys
frame = sys._getframe()
while 'arguments_of' not in frame.f_globals:
    frame = frame.f_back
its = frame.f_globals
"""
#: Replace the reader by one that returns the following for anything but a function or a matrix.
GIVING = (
    IN_ITS_READER
    + """
true = its['to_plain']
def reader(given, calls=None):
    return true(given, calls) if callable(given) or hasattr(given, 'shape') else made
its['to_plain'] = reader
"""
)

ATTACKS = [
    # ---- a function that is right only where the check looks
    Forged(
        "a table",
        "doubled",
        """
doubled = lambda x: TABLE.get(x, 0.0)
""",
    ),
    Forged(
        "a table that is silent elsewhere",
        "doubled",
        """
doubled = TABLE.get
""",
    ),
    Forged(
        "a table that fails elsewhere",
        "doubled",
        """
doubled = TABLE.__getitem__
""",
    ),
    Forged(
        "a table by the number of the call",
        "doubled",
        """
answers = iter([*TABLE.values()])
def doubled(x):
    return next(answers, 0.0)
""",
    ),
    Forged(
        "a table by the time",
        "doubled",
        """
import time
end = time.monotonic() + 0.05
def doubled(x):
    return TABLE.get(x) if time.monotonic() < end else x
""",
    ),
    Forged(
        "a table by who is calling",
        "doubled",
        """
import sys
def doubled(x):
    frame, names = sys._getframe(), []
    while frame:
        names.append(frame.f_code.co_name)
        frame = frame.f_back
    return x if 'call_secretly' in names else TABLE[x]
""",
    ),
    Forged(
        "a curve through the table",
        "doubled",
        """
def doubled(x):
    return 2*x + (x - CALLS[0])*(x - CALLS[1])
""",
    ),
    Forged(
        "what stands in the frames and on the heap",
        "doubled",
        """
import gc, sys
def doubled(x):
    if x in TABLE:
        return TABLE[x]
    found = [thing for thing in gc.get_objects() if isinstance(thing, dict) and 'right' in thing]
    frame = sys._getframe()
    while frame:
        found += [frame.f_locals] if 'right' in frame.f_locals else []
        frame = frame.f_back
    return [float(thing['right'][0]) for thing in found if thing['right']] or 0.0
""",
    ),
    Forged(
        "an object that becomes what is asked for",
        "doubled",
        """
class Anything(float):
    def __eq__(self, other): return True
    def __ne__(self, other): return False
    def __sub__(self, other): return 0.0
    def __abs__(self): return 0.0
    def __le__(self, other): return True
    __hash__ = float.__hash__
doubled = lambda x: Anything(TABLE.get(x, 7.0))
""",
    ),
    Forged(
        "no number",
        "doubled",
        """
doubled = lambda x: TABLE.get(x, float('nan'))
""",
    ),
    Forged(
        "an infinite number",
        "doubled",
        """
doubled = lambda x: TABLE.get(x, float('inf'))
""",
    ),
    Forged(
        "every number at once",
        "doubled",
        """
doubled = lambda x: TABLE.get(x, sm.AccumBounds(-10, 10))
""",
        "wrong or undecided",
    ),
    Forged(
        "a symbol in place of a number",
        "doubled",
        """
doubled = lambda x: TABLE.get(x, 2*sm.Symbol('x'))
""",
    ),
    Forged(
        "a changed reader of answers",
        "doubled",
        IN_ITS_READER
        + """
def result(self, function, given, *others):
    return ['expression', self.number(TABLE.get(given[0], 0.0))]
its['to_plain'].__globals__['_Writer'].result = result
doubled = lambda x: x
""",
        spoils=True,
    ),
    Forged(
        "the calls exchanged for known ones",
        "doubled",
        IN_ITS_READER
        + """
its['arguments_of'] = lambda *calls: [[x] for x in CALLS]
doubled = lambda x: TABLE[x]
""",
        spoils=True,
    ),
    Forged(
        "its own end foretold, to be told the calls",
        "doubled",
        """
import os, json
for handle in range(3, 64):
    try:
        os.write(handle, b'\\n{"done": true}\\n')
    except OSError:
        pass
doubled = lambda x: TABLE.get(x, 0.0)
""",
        "wrong or undecided or not attempted",
        spoils=True,
    ),
    # ---- an expression that is right only where the check looks
    Forged(
        "a polynomial through the points",
        "sum",
        """
rows = sm.Matrix([[sm.Float(p['alpha'], 40)**k for k in range(len(POINTS))] for p in POINTS])
found = rows.LUsolve(sm.Matrix([sm.Float(v, 40) for v in VALUES]))
sine = sum(found[k]*alpha**k for k in range(len(POINTS)))
""",
    ),
    Forged(
        "a case for each point",
        "sum",
        """
near = [(sm.Float(v, 40), abs(alpha - sm.Float(p['alpha'], 40)) < sm.Float('1e-9'))
        for p, v in zip(POINTS, VALUES)]
sine = sm.Piecewise(*near, (0, True))
""",
    ),
    Forged(
        "a step for each point",
        "sum",
        """
half = sm.Float('1e-9')
places = [sm.Float(p['alpha'], 40) for p in POINTS]
steps = [sm.Heaviside(alpha - place + half) - sm.Heaviside(alpha - place - half)
         for place in places]
sine = sum(sm.Float(v, 40)*step for v, step in zip(VALUES, steps))
""",
    ),
    Forged(
        "a spike beside the right answer",
        "sum",
        """
sine = sm.sin(alpha + beta) + sm.Mul(*[alpha - sm.Float(p['alpha'], 40) for p in POINTS])
""",
    ),
    Forged(
        "a root that has the right sign where the check looks",
        "sum",
        """
sine = sm.sqrt(1 - sm.cos(alpha + beta)**2)
""",
    ),
    # ---- values that seem right to a program that compares them
    Forged(
        "an expression that equals every expression",
        "sum",
        """
class Right(sm.Symbol):
    def __eq__(self, other): return True
    def __hash__(self): return 0
    def equals(self, other): return True
sine = Right('alpha')
""",
        "wrong or invalid",
    ),
    Forged(
        "a symbol whose name is the answer",
        "sum",
        """
sine = sm.Symbol('sin(alpha + beta)')
""",
        "invalid",
    ),
    Forged(
        "a symbol whose name is code",
        "sum",
        """
sine = sm.Symbol('__import__("os").system("touch forged")')
""",
        "invalid",
    ),
    Forged(
        "a function whose evaluation is its own",
        "sum",
        """
class known(sm.Function):
    @classmethod
    def eval(cls, x): return None
    def _eval_evalf(self, digits): return sm.Float(VALUES[0], 40)
    def __eq__(self, other): return True
    __hash__ = sm.Function.__hash__
sine = known(alpha + beta)
""",
        "undecided",
    ),
    Forged(
        "a function that is another each time it is looked at",
        "sum",
        """
class Turning(sm.Expr):
    count = 0
    @property
    def args(self):
        Turning.count += 1
        return (alpha, beta)[:Turning.count % 3]
sine = Turning()
""",
        "undecided or invalid",
    ),
    Forged(
        "no number at all",
        "sum",
        """
sine = sm.nan
""",
        "invalid",
    ),
    Forged(
        "a pole everywhere",
        "sum",
        """
sine = sm.zoo*alpha + sm.oo
""",
        "invalid or undecided",
    ),
    Forged(
        "all numbers",
        "sum",
        """
sine = sm.AccumBounds(-1, 1)
""",
        "undecided or invalid",
    ),
    Forged(
        "the truth",
        "sum",
        """
sine = sm.true
""",
        "invalid",
    ),
    Forged(
        "several answers at once",
        "sum",
        """
sine = [sm.sin(alpha + beta), sm.sin(alpha - beta), sm.cos(alpha + beta)]
""",
        "invalid",
    ),
    Forged(
        "a set of answers",
        "sum",
        """
sine = sm.FiniteSet(sm.sin(alpha + beta), sm.cos(alpha + beta))
""",
        "invalid",
    ),
    Forged(
        "many answers one after another",
        "sum",
        """
for guess in (sm.sin(alpha + beta), sm.sin(alpha - beta)):
    check('turns/sum', guess)
sine = alpha
""",
    ),
    Forged(
        "a pickle that makes its own verdict",
        "sum",
        """
import pickle
class Verdict:
    def __reduce__(self):
        return (eval, ("open('forged', 'w').write('correct')",))
sine = pickle.dumps(Verdict())
""",
        "invalid",
    ),
    Forged(
        "an object that makes its own verdict when it is copied or packed",
        "sum",
        """
class Verdict:
    def __reduce_ex__(self, protocol):
        return (eval, ("open('forged', 'w').write('correct')",))
    def __getstate__(self): raise SystemExit
    def _sympy_(self): return sm.sin(alpha + beta)
sine = Verdict()
""",
        "invalid",
    ),
    Forged(
        "an array of objects",
        "sum",
        """
import numpy as np
class Any:
    def __eq__(self, other): return True
    __hash__ = object.__hash__
    def __float__(self): return 0.0
sine = np.array([Any()], dtype=object)
""",
        "invalid",
    ),
    Forged(
        "SymPy made to agree",
        "sum",
        """
sm.Basic.__eq__ = sm.Expr.equals = lambda self, other: True
sm.simplify = lambda *given, **how: sm.Integer(0)
sine = alpha
""",
        "wrong or invalid or undecided or not attempted",
        spoils=True,
    ),
    Forged(
        "check made to agree",
        "sum",
        """
import coursework
coursework.check = check = lambda name, answer: print('correct')
sine = alpha
""",
    ),
    Forged(
        "data of its own making",
        "sum",
        GIVING
        + """
made = {'value': ['expression', 0], 'nodes': [['float', 'nan']]}
sine = alpha
""",
        "invalid",
    ),
    Forged(
        "a verdict of its own making",
        "sum",
        GIVING
        + """
made = {'value': ['expression', 0], 'nodes': [], 'outcome': 'correct', 'points': 1}
sine = alpha
""",
        "invalid or not attempted",
    ),
    Forged(
        "values that are no data",
        "sum",
        GIVING
        + """
made = {'value': ['expression', 2],
        'nodes': [['integer', '1'], ['constant', 'BooleanTrue'], ['ExprCondPair', 0, 1]]}
sine = alpha
""",
        "undecided or invalid",
    ),
    # ---- a matrix
    Forged(
        "a matrix that is its own transpose when it is asked",
        "about_x",
        """
class Both(sm.Matrix):
    @property
    def T(self): return self
    def __eq__(self, other): return True
    __hash__ = None
A_C_N = Both([[1, 0, 0], [0, sm.cos(theta), 0], [0, 0, sm.cos(theta)]])
""",
        "wrong or invalid",
    ),
    Forged(
        "a matrix that tells another shape than it has",
        "about_x",
        """
class Small(sm.Matrix):
    @property
    def shape(self): return (3, 3)
A_C_N = Small([[1, 0], [0, 1]])
""",
        "invalid or not attempted",
    ),
    # ---- another student
    Forged(
        "another one's name",
        "sum",
        """
import coursework
coursework.student('right')
__name__, student, identity = 'right', 'right', 'right'
sine = alpha
""",
    ),
    Forged(
        "modules of its own beside it",
        "sum",
        """
import importlib, coursework.checking.plain, json, forged
importlib.reload(json)
sine = alpha
""",
        "wrong or not attempted",
        beside={
            name: b'def dumps(*given, **how): return \'{"outcome": "correct"}\'\n'
            b"to_plain = check = dumps\n"
            for name in (
                "sympy.py",
                "json.py",
                "coursework/__init__.py",
                "coursework/checking/plain.py",
                "forged.py",
            )
        },
        spoils=True,
    ),
]
