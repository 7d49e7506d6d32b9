"""The templates of pages and of files for other systems, which escape everything but HTML."""

import base64
from collections import Counter

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from ..checking.kinds import number_of
from ..checking.reply import mathml, to_html
from .author import to_page

ENVIRONMENT = Environment(
    loader=PackageLoader("coursework.authoring", "templates"),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
ENVIRONMENT.filters |= {
    "counted": Counter,
    "base64": lambda data: base64.b64encode(data).decode("ascii"),
    "message": lambda reply: Markup(to_html(reply, mathml)),
    "number_of": number_of,
    "page": lambda markdown: Markup(to_page(markdown)),
}
