"""The sampled values of symbols, the display of replies, and a page's requests for sealed files."""

import sys
from types import ModuleType, SimpleNamespace

import pytest

from coursework.checking import points, reply
from coursework.checking.elsewhere import fetched
from coursework.checking.evaluate import MP
from coursework.checking.question import Question
from coursework.checking.reply import OUTCOMES, Reply

# --- points -------------------------------------------------------------------------------------


SAMPLED = [
    ["-0.19716267334", "0.134440568718", "0.9909216586", "4.09891366627", "-5.01614031356"],
    ["0.821533235568", "0.00750033025903", "0.999971872127", "5.94539631772", "-7.51633299078"],
    ["-1.67005471749", "0.092175211295", "-0.99574280335", "6.06764606904", "-3.77083385517"],
    ["-0.230494551367", "0.0307244394185", "-0.999527892969", "0.503145512382", "-1.77327908297"],
    ["2.19371958701", "0.0257600704453", "0.999668154325", "2.65150061514", "-4.27920987181"],
]


def test_where_symbols_are_sampled_is_what_it_was():
    """Every sealed file depends on it."""
    question = Question(
        "expression",
        salt="a",
        symbols={
            "phi'": (-3.0, 3.0),
            "b": (0.1, 1.5),
            "c": (-20.0, 90.0),
            "d": (0.0, 12.0),
            "e": (-12.0, -1.0),
        },
        unit=(("b", "c"),),
    )
    sampled = [
        [MP.nstr(point[name], 12) for name in question.symbols] for point in points.points(question)
    ]
    assert sampled == SAMPLED


@pytest.mark.parametrize(
    ("name", "spellings"),
    [
        ("x", []),
        ("phi", ["varphi"]),
        ("x''", []),
        ("X''", []),
        ("X'", ["Xdot", "X_dot", "dot_X", "dX", r"\dot{X}", r"\dot{\X}"]),
        ("x'", ["xdot", "x_dot", "dot_x", "dx", r"\dot{x}", r"\dot{\x}"]),
        ("epsilon''", ["varepsilon''"]),
    ],
)
def test_other_spellings_of_a_symbol(name, spellings):
    assert points.spellings(name) == spellings


def test_all_spellings_of_a_symbol_have_its_value_unless_they_are_another_symbol():
    [point, *_] = points.points(Question("expression", symbols={"phi'": (1, 2), "varphi'": (3, 4)}))
    assert point["phidot"] == point["phi'"] == point["dphi"]
    assert 3 < point["varphi'"] < 4 and point["varphidot"] in (point["varphi'"], point["phi'"])


def test_without_symbols_there_is_one_point_and_none_is_shared():
    assert points.points(Question("expression")) == [{}]
    question = Question("expression", symbols={"x": (1, 2)})
    points.points(question)[0].clear()
    assert "x" in points.points(question)[0]


# --- replies ------------------------------------------------------------------------------------


def shown(**about):
    reply = Reply("levers/<one>", "wrong", "a note", ["Say *so*: $x_1 < 2$.", "And on."])
    vars(reply).update(about)
    return reply


def test_a_reply_as_text():
    assert repr(shown()) == "Not yet: levers/<one>\nSay so: x_1 < 2.\nAnd on."
    solved = Reply("levers/one", "correct", solution="<p>So.</p>")
    assert repr(solved) == (
        "Correct: levers/one\n"
        "A worked solution comes with this reply, in the notebook or on the page."
    )
    assert all(
        repr(Reply("a/b", outcome)) == f"{word}: a/b" for outcome, (_, word, _) in OUTCOMES.items()
    )
    assert {"correct", "recorded"} == {outcome for outcome in OUTCOMES if Reply("a/b", outcome)}
    assert reply.plain_text(r"$\hat{n}_x$ of `A_B`, $\mathbf{R}\cdot\mathrm{d}x$") == (
        "n_x of A_B, R·dx"
    )
    assert reply.plain_text(r"${}^{A}\mathbf{C}^{B}$ ${}^A\mathbf{C}^B$") == "A_C_B A_C_B"
    product = r"$\left({}^A\mathbf{C}^N\right)^T\,{}^B\mathbf{C}^N = 2\cos\tfrac{\theta}{2}$"
    assert reply.plain_text(product) == "(A_C_N)^T B_C_N = 2 cos theta/2"
    rates = r"$\dot\psi, \frac{a + b}{\sqrt{2}}, 90^\circ, \mathbf{r}\times\mathbf{v}$"
    assert reply.plain_text(rates) == "psi', (a + b)/(sqrt(2)), 90°, r×v"


BEGINS = '<div class="coursework-reply" role="status" data-outcome="wrong"'
STYLE = ' style="border-left:.3em solid #b54708;padding:.2em .8em">'
HEAD = (
    '<p style="margin:.3em 0"><strong><span aria-hidden="true">✗</span> Not yet</strong> <span '
    'style="opacity:.8">levers/&lt;one&gt;'
)
SAID = (
    '<p style="margin:.3em 0">Say <em>so</em>: <span class="math">$x_1 &lt; 2$</span>.</p>'
    '<p style="margin:.3em 0">And on.</p></div>'
)


@pytest.mark.parametrize(
    ("about", "known", "tries"),
    [
        ({}, "", ""),
        ({"tries": 1}, ' data-question="levers/&lt;one&gt;" data-tries="1"', ""),
        (
            {"tries": 2, "help": "hint", "sibling": "a>b"},
            ' data-question="levers/&lt;one&gt;" data-tries="2" data-help="hint" '
            'data-sibling="a&gt;b"',
            " · 2 answers so far",
        ),
    ],
)
def test_a_reply_as_a_page(about, known, tries):
    page = shown(**about)._repr_html_()
    assert page == f"{BEGINS}{known}{STYLE}{HEAD}{tries}</span></p>{SAID}"


PAGE = "<p>$$x &lt; 1$$ and $y &amp; z$</p>"


@pytest.mark.parametrize("editor", [None, "VSCODE_PID", "google.colab", "marimo"])
def test_formulas_where_nothing_typesets_them(editor, monkeypatch):
    made = []
    converter = ModuleType("latex2mathml.converter")
    converter.convert = lambda source, display: made.append((source, display)) or f"<math>{display}"
    monkeypatch.setitem(sys.modules, "latex2mathml", ModuleType("latex2mathml"))
    monkeypatch.setitem(sys.modules, "latex2mathml.converter", converter)
    monkeypatch.delenv("VSCODE_PID", raising=False)
    for name in ("google.colab", "marimo"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    if editor == "VSCODE_PID":
        monkeypatch.setenv(editor, "1")
    elif editor:
        monkeypatch.setitem(sys.modules, editor, ModuleType(editor))
    typeset = editor is None
    assert reply.tex_is_typeset() == typeset
    page = shown(solution=PAGE)._repr_html_()
    assert page.count("<math>") == (0 if typeset else 3)
    assert (
        f"<details><summary>The worked solution</summary><div>"
        f"{PAGE if typeset else '<p><math>block and <math>inline</p>'}</div></details></div>"
    ) in page
    if not typeset:
        assert made == [("x_1 < 2", "inline"), ("x < 1", "block"), ("y & z", "inline")]


def test_a_formula_that_cannot_be_converted_is_shown_as_it_is(monkeypatch):
    monkeypatch.setitem(sys.modules, "latex2mathml.converter", None)
    assert reply.mathml("a < b") == "<code>a &lt; b</code>"


def test_what_is_marked_in_a_message_is_shown_so_and_never_obeyed():
    assert reply.to_html("<a> `<b>` *<c>* $<d>$ <e>") == (
        "&lt;a&gt; <code>&lt;b&gt;</code> <em>&lt;c&gt;</em> "
        '<span class="math">$&lt;d&gt;$</span> &lt;e&gt;'
    )
    assert reply.to_html("$x$", str.upper) == "X" and reply.to_html("`a") == "`a"


# --- fetching -----------------------------------------------------------------------------------


@pytest.mark.parametrize("status", [200, 404, None])
def test_what_is_sealed_is_fetched_from_where_the_pages_lie(status, tmp_path, monkeypatch):
    asked = []

    class Request:
        new = classmethod(lambda cls: cls())
        responseText = "{}"

        def open(self, *arguments):
            asked.append(arguments)

        def send(self):
            if status is None:
                raise OSError("no network")
            self.status = status

    monkeypatch.setitem(sys.modules, "js", SimpleNamespace(XMLHttpRequest=Request))
    monkeypatch.setitem(sys.modules, "pyodide_js", SimpleNamespace(lockfileBaseUrl="https://x/"))
    (tmp_path / "where").write_text("pages/ä/", "utf8")
    address = "https://x/pages/ä/one.json"
    if status == 200:
        assert fetched(tmp_path / "where", "one.json") == "{}"
    else:
        why = "the server answered 404" if status else "no network"
        with pytest.raises(RuntimeError) as error:
            fetched(tmp_path / "where", "one.json")
        message = f"We could not fetch your numbers from {address} ({why}). Are you online?"
        assert str(error.value) == message
    assert asked == [("GET", address, False)]
