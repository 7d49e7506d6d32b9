"""All moving figures in JupyterLab itself: Python's attributes and the figures move together."""

import json
import re
import urllib.request

import pytest
from figure_pages import CHANGES, FIGURES, KINDS, drag
from laboratory import PATIENCE, RUN_ALL, TOKEN
from laboratory import laboratory as start_laboratory

pytest.importorskip("jupyterlab")
from jupyter_client import BlockingKernelClient  # noqa: E402

FIRST_CELL = f"""
from orientation_figures import moving
names = { ({kind: FIGURES[kind].__name__ for kind in KINDS})!r}
figures = {{name: getattr(moving, figure)() for name, figure in names.items()}}
heard = []
for name, figure in figures.items():
    figure.observe(
        lambda change, name=name: heard.append((name, change.name, change.new)),
        list(figure.state()))
"""


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    """The address of a JupyterLab of our own, with a notebook that shows every figure."""
    folder = tmp_path_factory.mktemp("laboratory")
    cells = [
        FIRST_CELL,
        *(f"figures[{kind!r}]" for kind in KINDS),
        "explorer = moving.SequenceExplorer('zyx')\nexplorer",
    ]
    with start_laboratory(folder, cells) as address:
        yield folder, address


class Kernel:
    """The notebook's own kernel, asked directly."""

    def __init__(self, folder, address):
        sessions = json.load(urllib.request.urlopen(f"{address}api/sessions?token={TOKEN}"))
        file = folder / "jupyter_runtime_dir" / f"kernel-{sessions[0]['kernel']['id']}.json"
        self.client = BlockingKernelClient(connection_file=str(file))
        self.client.load_connection_file()
        self.client.start_channels()
        self.client.wait_for_ready(timeout=PATIENCE)

    def run(self, code):
        reply = self.client.execute_interactive(
            code,
            store_history=False,
            timeout=PATIENCE,
            allow_stdin=False,
            # fmt: skip
            output_hook=lambda message: None,
        )["content"]
        assert reply["status"] == "ok", reply

    def value(self, code):
        reply = self.client.execute(
            "",
            store_history=False,
            reply=True,
            timeout=PATIENCE,
            user_expressions={"value": f"__import__('json').dumps({code})"},
        )
        return json.loads(eval(reply["content"]["user_expressions"]["value"]["data"]["text/plain"]))


# The picture and the numbers.
SHOWN = """cell => [...cell.querySelectorAll('.marks path, .number')]
  .map((one) => one.getAttribute('d') ?? one.textContent).join()"""


@pytest.mark.long
def test_python_and_every_figure_move_together(browser, laboratory):
    folder, address = laboratory
    context = browser.new_context(viewport={"width": 1300, "height": 1000})
    context.set_default_timeout(1000 * PATIENCE)
    page, faults, asked = context.new_page(), [], []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on(
        "request",
        lambda request: (
            request.url.startswith((address, "data:", "blob:")) or asked.append(request.url)
        ),
    )
    page.goto(f"{address}lab/tree/figures.ipynb?token={TOKEN}")
    page.wait_for_function(
        "document.querySelectorAll('.jp-CodeCell').length > 7 && window.jupyterapp"
    )
    page.evaluate(RUN_ALL)
    page.wait_for_function(
        "document.querySelectorAll('.jp-OutputArea-output .moving .sheet').length >= 6"
    )
    kernel = Kernel(folder, address)
    cells = page.locator(".jp-CodeCell")

    def until(change, was):
        """Wait until the value in Python is another."""
        for _ in range(1000):
            if (now := kernel.value(change)) != was:
                return now
            page.wait_for_timeout(50)
        pytest.fail(f"{change} stays {was}")

    for number, kind in enumerate(KINDS, start=1):
        cell, (name, value, label, shown) = cells.nth(number), CHANGES[kind]
        element = cell.element_handle()
        cell.locator(".moving").first.scroll_into_view_if_needed()
        before = page.evaluate(SHOWN, element)
        # Python moves the figure.
        kernel.run(f"figures[{kind!r}].{name} = {value!r}")
        if label:
            page.wait_for_function(
                "([field, value]) => Math.abs(field.value - value) < 0.01",
                arg=[cell.get_by_label(label, exact=True).first.element_handle(), shown],
            )
        page.wait_for_function(
            f"([cell, before]) => ({SHOWN})(cell) !== before", arg=[element, before]
        )
        assert kernel.value("heard[-1][:2]") == [kind, name]
        # Keys move Python, and nothing else of the notebook.
        count = kernel.value("len(heard)")
        slider = cell.locator("input:is([type=range], [type=number]):visible, .entries input")
        if slider.count():
            slider.first.focus()
            page.keyboard.press("ArrowDown")
        else:
            cell.get_by_text(re.compile(r"^(\+15°|Exchange the two sides)$")).first.focus()
            page.keyboard.press("Enter")
        count = until("len(heard)", count)
        assert kernel.value("heard[-1][0]") == kind
        assert page.evaluate("document.activeElement.closest('.jp-CodeCell') !== null")
        # A drag turns the view by itself, and moves Python where it takes hold of a part.
        part = cell.locator(".plot" if kind == "motion" else ".grip:not([visibility=hidden])")
        if not part.count():
            continue
        state, drawn = kernel.value(f"figures[{kind!r}].state()"), page.evaluate(SHOWN, element)
        box = cell.locator(".sheet").first.bounding_box()
        drag(page, (box["x"] + 8, box["y"] + box["height"] - 8), (60, 0))
        page.wait_for_function(
            f"([cell, before]) => ({SHOWN})(cell) !== before", arg=[element, drawn]
        )
        assert kernel.value(f"figures[{kind!r}].state()") == state
        box = part.last.bounding_box()
        drag(page, (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2), (-30, 24))
        until("len(heard)", count)
        assert kernel.value("heard[-1][0]") == kind

    explorer = cells.nth(len(KINDS) + 1)
    explorer.get_by_text("z-y-x locks at").first.wait_for()
    explorer.locator("select").first.select_option(label="x-y-x")
    explorer.get_by_text("x-y-x locks at θ = 0").first.wait_for()
    explorer.locator("input[type=text]").nth(1).fill("0")
    explorer.get_by_text("Here it is locked.").first.wait_for()
    assert kernel.value("str(explorer.dcm[0, 0])") == "1"
    kernel.client.stop_channels()
    context.close()
    assert faults == [] and asked == []
