"""Translate the pictures of the interactive figures to JavaScript.

The content of a figure is described once, in ``pictures``: functions of its state that use the
methods of a sheet (`orientation_figures.words`) and the functions of `orientation_figures.vectors`.
Python draws stills with them; this module translates them, statement by statement, for the figures
in the page.

A description consists of functions, constants, loops and comprehensions, conditions and lists.
Keyword arguments become an object, and the optional arguments of a method must be passed by name.
Names that begin with ``_``, and functions of a whole ``figure``, stay in Python. In JavaScript an
empty list counts as true, so ask for its length; and a string is not a list until ``list`` makes it
one.
"""

import ast
import re

_NAMES = {"len": "{}.length", "abs": "Math.abs({})", "list": "[...{}]"}
# Methods of a sheet that take their arguments in order, in both languages.
_IN_ORDER = (
    "area", "cylinder", "dot", "dots", "ellipse", "head", "label", "label_beyond", "line", "path",
    "ring", "shadow", "text",
)  # fmt: skip
_METHODS = {
    "append": "push",
    "index": "indexOf",
    "lower": "toLowerCase",
    "startswith": "startsWith",
}
_OPERATORS = {
    ast.Add: ("+", 1), ast.Sub: ("-", 1), ast.Mult: ("*", 2), ast.Div: ("/", 2), ast.Mod: ("%", 2),
    ast.Pow: ("**", 3), ast.Eq: "===", ast.NotEq: "!==", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">",
    ast.GtE: ">=", ast.Is: "===", ast.IsNot: "!==", ast.And: " && ", ast.Or: " || ", ast.Not: "!",
    ast.USub: "-",
}  # fmt: skip
# The precedence of expressions that are not operations on two numbers.
_STRENGTHS = {ast.Compare: 0.9, ast.And: 0.6, ast.Or: 0.5, ast.IfExp: 0, ast.Lambda: 0}


def translated(path):
    """Return the JavaScript module for a file."""
    parts, modules = [], dict.fromkeys(("enumerate", "range", "sum", "zip"), "mathematics")
    for node in ast.parse(path.read_text("utf8")).body:
        match node:
            case ast.ImportFrom(module=module, level=level):
                # A function that is not another picture has a twin in JavaScript under the same
                # name.
                beside = level == 1 and module != "vectors"
                source = f"{module}_picture" if beside else "mathematics"
                modules |= {alias.name: source for alias in node.names}
            case ast.Assign(targets=[ast.Name(id=constant)]) if not constant.startswith("_"):
                parts.append((node, f"export const {constant} = {expression(node.value)};"))
            case ast.FunctionDef() if (
                not node.name.startswith("_") and node.args.args[0].arg != "figure"
            ):
                parts.append(
                    (
                        node,
                        f"\nexport function {camel(node.name)}({parameters(node.args)}) "
                        f"{block(node)}",
                    )
                )
            case ast.ClassDef(name=name):
                methods = [
                    method(child) for child in node.body if isinstance(child, ast.FunctionDef)
                ]
                parts.append((node, f"\nexport class {name} {braces(methods)}"))
    used = {part.id for node, _ in parts for part in ast.walk(node) if isinstance(part, ast.Name)}
    lines = []
    for module in sorted({modules[name] for name in used & set(modules)}):
        names = ", ".join(
            sorted(camel(name) for name in used & set(modules) if modules[name] == module)
        )
        lines.append(f"import {{ {names} }} from './{module}.js';")
    return "\n".join([*lines, *(text for _, text in parts)]) + "\n"


def camel(name):
    return name if name.isupper() else re.sub(r"(?<=.)_(\w)", lambda match: match[1].upper(), name)


def parameters(arguments):
    """Return the parameters of a function; optional ones have defaults, keywords form an object."""
    positional = [camel(argument.arg) for argument in arguments.args]
    for k, default in enumerate(reversed(arguments.defaults), 1):
        positional[-k] += f" = {expression(default)}"
    named = [
        f"{camel(argument.arg)} = {expression(value)}"
        for argument, value in zip(arguments.kwonlyargs, arguments.kw_defaults)
    ]
    return ", ".join(positional + ([f"{{ {', '.join(named)} }} = {{}}"] if named else []))


def method(function):
    """Return a method; optional parameters are passed by name, unless it is listed in _IN_ORDER."""
    arguments = function.args
    arguments.args = arguments.args[1:]
    if function.name not in _IN_ORDER and (defaults := arguments.defaults):
        arguments.kwonlyargs, arguments.kw_defaults = arguments.args[-len(defaults) :], defaults
        arguments.args, arguments.defaults = arguments.args[: -len(defaults)], []
    return f"{camel(function.name)}({parameters(arguments)}) {block(function)}"


def block(function):
    """Return the body of a function; a variable is constant if it is set in one place."""
    together, waiting = [], [*function.body]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Assign | ast.AugAssign):
            together.append(
                names_in(node.targets[0] if isinstance(node, ast.Assign) else node.target)
            )
        if isinstance(node, ast.stmt) and not isinstance(node, ast.FunctionDef):
            waiting += ast.iter_child_nodes(node)
    every = sum(together, [])
    changing = sorted(
        {
            child
            for names in together
            if any(every.count(name) > 1 for name in names)
            for child in names
        }
    )
    first = [f"let {', '.join(map(camel, changing))};"] if changing else []
    return braces(first + [statement(child, changing) for child in function.body])


def braces(lines):
    inside = "".join(f"  {line}\n" for text in lines if text for line in text.split("\n"))
    return f"{{\n{inside}}}"


def names_in(target):
    return [
        part.id
        for part in ast.walk(target)
        if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)
    ]


def statement(node, changing):
    def all_of(body):
        return braces([statement(child, changing) for child in body])

    match node:
        case ast.Expr(value=ast.Constant()):
            return ""  # a docstring
        case ast.Expr():
            return f"{expression(node.value)};"
        case ast.Return(value=ast.Name(id="self")):
            # Methods are not chained in the page.
            return ""
        case ast.Return():
            return f"return {expression(node.value)};" if node.value else "return;"
        case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)) if not (
            set(names_in(node.targets[0])) & set(changing)
        ):
            pairs = zip(map(expression, names), map(expression, values), strict=True)
            return f"const {', '.join(' = '.join(pair) for pair in pairs)};"
        case ast.Assign(targets=[target]):
            names = names_in(target)
            first = "const " if names and not set(names) & set(changing) else ""
            return f"{first}{expression(target)} = {expression(node.value)};"
        case ast.AugAssign():
            return (
                f"{expression(node.target)} {_OPERATORS[type(node.op)][0]}= "
                f"{expression(node.value)};"
            )
        case ast.For():
            return (
                f"for (const {expression(node.target)} of {expression(node.iter)}) "
                f"{all_of(node.body)}"
            )
        case ast.If():
            alternative = ""
            if node.orelse:
                chained = len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If)
                alternative = " else " + (
                    statement(node.orelse[0], changing) if chained else all_of(node.orelse)
                )
            return f"if ({expression(node.test)}) {all_of(node.body)}{alternative}"
        case ast.FunctionDef(body=[ast.Return(value=value)]):
            return f"const {camel(node.name)} = ({parameters(node.args)}) => {expression(value)};"
        case ast.FunctionDef():
            return f"const {camel(node.name)} = ({parameters(node.args)}) => {block(node)};"
        case ast.Continue():
            return "continue;"
    raise ValueError(
        f"a picture uses {ast.unparse(node)!r}, which cannot be translated to JavaScript"
    )


def within(node, least=4):
    """Return an operand, in brackets where it binds less tightly than its context."""
    if isinstance(node, ast.BinOp):
        strength = _OPERATORS[type(node.op)][1]
    else:
        strength = _STRENGTHS.get(type(node.op if isinstance(node, ast.BoolOp) else node), 4)
    return f"({expression(node)})" if strength < least else expression(node)


def expression(node):
    match node:
        case ast.Constant(value=bool() | None):
            return {True: "true", False: "false", None: "null"}[node.value]
        case ast.Constant(value=str()):
            return quoted(node.value, "'")
        case ast.Constant():
            return repr(node.value).removesuffix(".0").replace("e-0", "e-")
        case ast.Name():
            return "this" if node.id == "self" else camel(node.id)
        case ast.JoinedStr():
            return f"`{''.join(filled(part) for part in node.values)}`"
        case ast.Attribute(value=ast.Name(id="math")):
            return {"pi": "Math.PI", "nan": "NaN"}.get(node.attr, f"Math.{node.attr}")
        case ast.Attribute():
            return f"{within(node.value)}.{_METHODS.get(node.attr) or camel(node.attr)}"
        case ast.List() | ast.Tuple():
            return f"[{', '.join(map(expression, node.elts))}]"
        case ast.Starred():
            return f"...{within(node.value)}"
        case ast.Dict():
            return entries((key.value, value) for key, value in zip(node.keys, node.values))
        case ast.Subscript(slice=ast.Slice(lower=lower, upper=upper)):
            ends = [expression(end) for end in (lower or ast.Constant(0), upper) if end]
            return f"{within(node.value)}.slice({', '.join(ends)})"
        case ast.Subscript(slice=ast.UnaryOp()):
            return f"{within(node.value)}.at({expression(node.slice)})"
        case ast.Subscript():
            return f"{within(node.value)}[{expression(node.slice)}]"
        case ast.Call():
            return call(node)
        case ast.BinOp(left=ast.Constant(value=str()), op=ast.Mult()):
            return f"{expression(node.left)}.repeat({expression(node.right)})"
        case ast.BinOp():
            sign, strength = _OPERATORS[type(node.op)]
            return f"{within(node.left, strength)} {sign} {within(node.right, strength + 1)}"
        case ast.UnaryOp():
            return f"{_OPERATORS[type(node.op)]}{within(node.operand)}"
        case ast.BoolOp():
            return _OPERATORS[type(node.op)].join(within(operand, 0.6) for operand in node.values)
        case ast.Compare(ops=[ast.In() | ast.NotIn()], comparators=[known]):
            sign = "!" if isinstance(node.ops[0], ast.NotIn) else ""
            return f"{sign}{within(known)}.includes({expression(node.left)})"
        case ast.Compare(ops=[operator], comparators=[right]):
            return f"{within(node.left, 1)} {_OPERATORS[type(operator)]} {within(right, 1)}"
        case ast.IfExp():
            return f"{within(node.test, 0.5)} ? {within(node.body, 0.5)} : {within(node.orelse, 0)}"
        case ast.Lambda():
            return f"({parameters(node.args)}) => {expression(node.body)}"
        case ast.DictComp(generators=[part]):
            pair = ast.List([node.key, node.value])
            return f"Object.fromEntries({expression(ast.ListComp(pair, [part]))})"
        case ast.ListComp(generators=[first, *others]):
            if others:
                inner = ast.ListComp(node.elt, others)
                return f"{over(first)}.flatMap(({expression(first.target)}) => {expression(inner)})"
            if ast.unparse(first.target) == ast.unparse(node.elt):
                return over(first)
            return f"{over(first)}.map(({expression(first.target)}) => {expression(node.elt)})"
    raise ValueError(
        f"a picture uses {ast.unparse(node)!r}, which cannot be translated to JavaScript"
    )


def over(part):
    conditions = "".join(
        f".filter(({expression(part.target)}) => {expression(condition)})" for condition in part.ifs
    )
    return within(part.iter) + conditions


def call(node):
    arguments = [expression(argument) for argument in node.args]
    if isinstance(node.func, ast.Attribute) and node.func.attr == "get":
        return f"({within(node.func.value)}[{arguments[0]}] ?? {arguments[1]})"
    if node.keywords and not (isinstance(node.func, ast.Name) and node.func.id == "zip"):
        if isinstance(node.func, ast.Attribute) and node.func.attr in _IN_ORDER:
            raise ValueError(
                f"{ast.unparse(node)!r}: pass the arguments of {node.func.attr} by position, "
                "not by name"
            )
        arguments.append(entries((keyword.arg, keyword.value) for keyword in node.keywords))
    if isinstance(node.func, ast.Name) and node.func.id in ("min", "max"):
        return f"Math.{node.func.id}({'...' if len(arguments) == 1 else ''}{', '.join(arguments)})"
    if isinstance(node.func, ast.Name) and node.func.id in _NAMES:
        return _NAMES[node.func.id].format(", ".join(arguments))
    return f"{within(node.func)}({', '.join(arguments)})"


def entries(pairs):
    """Return an object; an entry whose value has the name of its key is written once."""
    pairs = [(camel(key), expression(value)) for key, value in pairs]
    return f"{{ {', '.join(key if key == value else f'{key}: {value}' for key, value in pairs)} }}"


def quoted(text, quote):
    return quote + text.replace("\\", "\\\\").replace(quote, "\\" + quote) + quote


def filled(part):
    if isinstance(part, ast.Constant):
        return quoted(part.value, "`")[1:-1]
    return f"${{{expression(part.value)}}}"
