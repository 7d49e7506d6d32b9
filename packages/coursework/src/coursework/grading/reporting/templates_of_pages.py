"""The templates of pages, which escape everything except formulas and our own messages."""

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from ...checking.writing import readable
from ..tables import number
from . import pages

LOADER = PackageLoader("coursework.grading.reporting", "templates")
ENVIRONMENT = Environment(
    loader=LOADER,
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
ENVIRONMENT.filters |= {
    "readable": lambda text, most=400: readable(str(text), most),
    "points": number,
    "message": lambda said: Markup(pages.message(said)),
    "capital": lambda text: text[:1].upper() + text[1:],
    "mathematics": lambda plain: Markup(pages.answer_as_mathematics(plain)),
    "count": lambda how_many, one, more: f"{how_many} {one if how_many == 1 else more}",
    "percent": lambda share: f"{100 * share:.0f} %",
}


def source_of(name: str) -> str:
    """Return the source of a file beside the templates."""
    return LOADER.get_source(ENVIRONMENT, name)[0]


def page(template: str, **about: object) -> str:
    """Return a page from a template, complete in one file."""
    return ENVIRONMENT.get_template(template).render(
        style=Markup(pages.STYLE), policy=Markup(pages.POLICY), **about
    )
