"""A chapter and an exercise as a screen reader reads them, in the browser's order."""

import re

import pytest
from test_site import WIDE, Visit

WALKED = (
    "exercises/simple-orientations.html",
    "chapters/unit-quaternions.html",
)
# Elements that a reader acts on, or that are announced by name only.
NAMED = {
    "button", "link", "textbox", "searchbox", "slider", "spinbutton", "checkbox", "radio",
    "combobox", "img", "image", "listbox", "figure", "navigation", "DisclosureTriangle",
}  # fmt: skip
pytestmark = pytest.mark.long


def spoken_tree(page):
    """Return the nodes of a screen reader in order: role, name and level."""
    nodes = page.context.new_cdp_session(page).send("Accessibility.getFullAXTree")["nodes"]
    by_id = {node["nodeId"]: node for node in nodes}
    spoken_nodes = []

    def walk(node):
        if not node["ignored"]:
            level = next(
                (
                    property_of_node["value"]["value"]
                    for property_of_node in node.get("properties", [])
                    if property_of_node["name"] == "level"
                ),
                None,
            )
            spoken_nodes.append(
                (node["role"]["value"], node.get("name", {}).get("value", "").strip(), level)
            )
        for child in node.get("childIds", []):
            if child in by_id:
                walk(by_id[child])

    walk(nodes[0])
    return spoken_nodes


@pytest.mark.parametrize("name", WALKED)
def test_a_walk_through_the_page(browser, site, name):
    with Visit(browser, site, name, "light", WIDE) as visit:
        page = visit.page
        page.evaluate(
            "document.querySelectorAll('article details').forEach((details) => { details.open = "
            "true; })"
        )
        seen = page.evaluate("""() => ({
          title: document.querySelector('h1').textContent,
          // Replies, and what follows a prediction, are there when that has been made.
          formulas: [...document.querySelectorAll('article .katex')].filter(
            (one) => one.checkVisibility() && !one.closest('[inert]')).length,
          cells: [...document.querySelectorAll('article div.cell .cell_input')].flatMap(
            (one, place) => one.closest('[inert]') ? [] : [place + 1]),
          signs: [...document.querySelectorAll('article [role=img]')].filter(
            (one) => one.getBoundingClientRect().height < 40).map((one) => one.getAttribute('aria-label')),
          code: [...document.querySelectorAll('article pre')].map((one) => one.textContent).join('\\n'),
        })""")
        tree = spoken_tree(page)
    roles = [role for role, _, _ in tree]
    nameless = sorted({role for role, words, _ in tree if role in NAMED and not words})
    assert nameless == [], f"{name}: they have no name"
    assert roles.count("main") == 1 and "navigation" in roles
    # There is one top heading, and no level is skipped on the way down.
    inside = tree[roles.index("main") :]
    levels = [level for role, _, level in inside if role == "heading"]
    assert levels.count(1) == 1 and levels[0] == 1
    assert all(below <= above + 1 for above, below in zip(levels, levels[1:])), levels
    # Formulas are announced as mathematics, each once, without their drawing or source.
    mathematics = [
        place for place, (role, _, _) in enumerate(inside) if role in ("math", "MathMLMath")
    ]
    assert len(mathematics) >= seen["formulas"] > 5
    words = [text for role, text, _ in inside if role == "StaticText"]
    tex = [text for text in words if re.search(r"\\(?:hat|mathbf|frac|begin)", text)]
    assert [text for text in tex if text not in seen["code"]] == []  # a program may contain some
    # Every piece of code has a button to run it, with a name.
    runs = [text for role, text, _ in inside if role == "button" and text.startswith("Run cell")]
    assert [int(re.match(r"Run cell (\d+)", text)[1]) for text in runs] == seen["cells"] and len(
        runs
    ) > 2
    # A figure is named by its number, and its picture has a description.
    figures = [text for role, text, _ in inside if role == "figure"]
    assert len(set(figures)) == len(figures) and all(
        text.startswith("Figure ") for text in figures
    ), figures
    pictures = [
        text for role, text, _ in inside if role in ("img", "image") and text not in seen["signs"]
    ]
    assert all(len(text) > 15 for text in pictures), [text for text in pictures if len(text) <= 15]
    # The page begins with its title and ends with the link to the next one.
    assert next(text for role, text, _ in inside if role == "heading") in seen["title"]
    links = [text for role, text, _ in tree if role == "link"]
    assert links[0] == "Skip to main content"
    assert {"previous", "next"} <= {text.lower().partition(" ")[0] for text in links}
    assert visit.faults == []
