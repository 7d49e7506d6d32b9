"""The templates of pages, in which everything is text unless it is said to
be mathematics or a message of ours.
"""

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
    """A file that lies beside the templates, as it is."""
    return LOADER.get_source(ENVIRONMENT, name)[0]


def page(template: str, **about: object) -> str:
    """A page that is complete in one file, by the template of a name."""
    return ENVIRONMENT.get_template(template).render(
        style=Markup(pages.STYLE), policy=Markup(pages.POLICY), **about
    )
