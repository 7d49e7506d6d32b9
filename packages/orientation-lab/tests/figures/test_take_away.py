"""Formulas taken away from a page: any function, in a language and a convention, without Python."""

import numpy as np
import pytest
from figure_pages import front_end, open_figure  # noqa: F401

import orientation
from orientation_figures.moving import bundle, take_away
from orientation_workbench.formulas import FORMULAS
from orientation_workbench.languages import LANGUAGES, formula_in

PLACE = (
    '<dl><dt class="sig" id="orientation.body_fixed_from_dcm">body_fixed_from_dcm</dt><dd>Its '
    "words.</dd>"
    '<dt class="sig" id="orientation.check_dcm">check_dcm</dt><dd>No formula.</dd></dl>'
    "<figure class='orientation-figure moving' data-figure='formula' data-state='{}'></figure>"
)


class Formula:
    """The place on a page where formulas are taken away: there is no still."""

    kind = "formula"

    def still(self):
        return PLACE


@pytest.mark.parametrize("language", LANGUAGES)
def test_texts_are_those_of_python(language):
    texts = take_away.texts_in(language)
    assert set(texts) == set(FORMULAS)
    expected = formula_in(
        language, "body_fixed_from_dcm", "zyx", matrix="transposed", unit="degrees"
    )
    assert texts["body_fixed_from_dcm"]["texts"]["zyx transposed degrees"] == expected
    assert all(text for formula in texts.values() for text in formula["texts"].values())


def run_in_page(page, text, name, *arguments):
    return page.evaluate(f"(given) => {{ {text}\nreturn {name}(...given); }}", list(arguments))


def test_a_formula_is_taken_from_the_reference(open_figure):
    page = open_figure(Formula())
    page.locator("button.take-formula").wait_for()
    # Nothing is offered of what is no formula.
    assert page.locator("button.take-formula").count() == 1
    page.click("button.take-formula")
    assert page.locator("select[aria-label=Language] option").all_text_contents() == [*LANGUAGES]
    page.select_option("select[aria-label=Language]", "JavaScript")
    page.select_option("select[aria-label=Sequence]", "zyx")
    page.select_option("select[aria-label=Matrix]", "transposed")
    page.select_option("select[aria-label='Angles in']", "degrees")
    expected = formula_in(
        "JavaScript", "body_fixed_from_dcm", "zyx", matrix="transposed", unit="degrees"
    )
    page.wait_for_function(
        "(text) => document.querySelector('.taken output').textContent.trim() === text",
        arg=expected.strip(),
    )
    assert page.locator("dd .taken").count() == 1  # where the reader is
    text = page.text_content(".taken output")
    dcm = orientation.dcm_from_body_fixed((0.3, -0.4, 1.1), "zyx")
    computed = run_in_page(page, text, "body_fixed_from_dcm_zyx", dcm.T.ravel().tolist())
    assert np.abs(np.array(computed) - np.degrees([0.3, -0.4, 1.1])).max() < 1e-12
    with page.expect_download() as saved:
        page.click("text=Save as a file")
    assert saved.value.suggested_filename == "body_fixed_from_dcm.js"


def test_the_converter_gives_the_formulas_that_it_uses(open_figure):
    page = open_figure("converter")
    page.select_option("select[aria-label=Language]", "JavaScript")
    page.wait_for_function(
        "document.querySelector('.taken output').textContent.includes('body_fixed_from_dcm_zxy')"
    )
    text = page.text_content(".taken output")
    # From SciPy's quaternion, scalar last, to this book's angles.
    quaternion = page.evaluate("document.querySelector('.moving').model.get('quaternion')")
    typed = page.input_value("textarea").replace(",", " ").split()
    computed = run_in_page(page, text, "dcm_from_quaternion", [float(number) for number in typed])
    expected = orientation.dcm_from_quaternion(np.array(quaternion) / np.linalg.norm(quaternion))
    assert np.abs(np.reshape(computed, (3, 3)) - expected).max() < 1e-9
    angles = run_in_page(page, text, "body_fixed_from_dcm_zxy", computed)
    assert np.abs(np.array(angles) - orientation.body_fixed_from_dcm(expected, "zxy")).max() < 1e-9


def test_nothing_is_loaded_before_it_is_asked_for(open_figure):
    page = open_figure("converter")
    assert page.evaluate("globalThis.orientationFormulas === undefined")
    assert max(map(len, take_away.scripts().values())) < 25_000
    assert bundle.beside("triad") == {}
